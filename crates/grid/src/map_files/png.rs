//! PNG images as grey values.

use std::io::{BufRead, Read, Seek};

use crate::map_files::Fault;
use crate::map_files::decoded::{GreyImage, ImageHeader, MAX_DECODED, MAX_EXTRAS, check_decoded, damaged};
use crate::map_files::error::check_size;
use crate::map_files::pictures::FIRST_OF_SEVERAL;
use crate::map_files::pixel::{PixelLayout, Transparency};

pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Reads a PNG image from a file of `bytes` bytes, and says how it was converted to 8-bit grey.
///
/// Neither gamma nor a colour profile is applied. Of an animation the first image is read.
pub(super) fn read<R: BufRead + Seek>(
    mut source: R,
    bytes: u64,
    transparency: Transparency,
) -> Result<GreyImage, Fault> {
    let png_header = PngHeader::parse(source.fill_buf()?)?;
    let size = (png_header.rows, png_header.cols);
    check_size(size.0, size.1)?;
    let mut reader = open(source, MAX_EXTRAS)?;
    let header = header_of(&reader, transparency);
    check_decoded(header.bytes(), MAX_DECODED, bytes, size)?;
    let mut notes = Vec::from_iter(png_header.note(header.layout));
    notes.extend(reader.info().animation_control.is_some().then(|| FIRST_OF_SEVERAL.to_owned()));
    header.decode_grey(notes, |pixels| reader.next_frame(pixels).map(drop).map_err(damaged))
}

/// Opens an image whose pixels will be bytes or 16-bit words, and reads the chunks before them. Colour profiles and texts
/// may take `max_extras` bytes.
pub(super) fn open<R: BufRead + Seek>(source: R, max_extras: u64) -> Result<png::Reader<R>, Fault> {
    let mut decoder = png::Decoder::new_with_limits(source, png::Limits { bytes: max_extras as usize });
    decoder.set_transformations(png::Transformations::EXPAND);
    decoder.read_info().map_err(damaged)
}

pub(super) fn header_of<R: BufRead + Seek>(reader: &png::Reader<R>, transparency: Transparency) -> ImageHeader {
    let (colours, depth) = reader.output_color_type();
    let alpha = matches!(colours, png::ColorType::GrayscaleAlpha | png::ColorType::Rgba).then_some(transparency);
    let max = if depth == png::BitDepth::Sixteen { u16::MAX } else { 255 };
    let layout = PixelLayout { colour: colours.samples() >= 3, alpha, max };
    ImageHeader { rows: reader.info().height as usize, cols: reader.info().width as usize, layout }
}

/// Reads all bytes of an image of which the first are known; no more than an image of the size in its header can have.
pub(super) fn read_bytes(mut bytes: Vec<u8>, rest: impl Read) -> Result<Vec<u8>, Fault> {
    let header = PngHeader::parse(&bytes)?;
    check_size(header.rows, header.cols)?;
    let max = header.max_bytes();
    // One byte more than an image may have shows that it goes on.
    rest.take((max + 1).saturating_sub(bytes.len() as u64)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max {
        let message = format!("it continues after {max} bytes, more than an image of its size needs");
        return Err(Fault::Image { message });
    }
    Ok(bytes)
}

/// The header chunk, which comes first in every PNG file.
///
/// Source: "Portable Network Graphics (PNG) Specification", W3C, 2003, section 11.2.2.
struct PngHeader {
    rows: usize,
    cols: usize,
    depth: u8,
    colour_type: u8,
}

impl PngHeader {
    fn parse(start: &[u8]) -> Result<Self, Fault> {
        let Some(&[w3, w2, w1, w0, h3, h2, h1, h0, depth, colour_type]) = start.get(16..26) else {
            return Err(Fault::Image { message: "the file ends within the header".to_owned() });
        };
        let rows = u32::from_be_bytes([h3, h2, h1, h0]) as usize;
        let cols = u32::from_be_bytes([w3, w2, w1, w0]) as usize;
        Ok(Self { rows, cols, depth, colour_type })
    }

    /// An upper bound of the bytes of an image of this size: no image is much larger than its pixels.
    fn max_bytes(&self) -> u64 {
        let channels = match self.colour_type {
            0 | 3 => 1,
            4 => 2,
            2 => 3,
            _ => 4,
        };
        // A greater depth is forged, and must not allow for more bytes.
        let bits = self.cols as u64 * channels * u64::from(self.depth.min(16));
        // An interlaced row may come in two pieces, each with a byte for its filter.
        let pixels = self.rows as u64 * (bits.div_ceil(8) + 2);
        (pixels + pixels / 8).min(MAX_DECODED) + MAX_EXTRAS
    }

    fn note(&self, decoded: PixelLayout) -> Option<String> {
        let is_palette = self.colour_type == 3;
        let max = if is_palette { 255 } else { ((1u32 << self.depth) - 1) as u16 };
        let colours = match (is_palette, decoded.colour) {
            (true, _) => "palette",
            (false, true) => "RGB",
            (false, false) => "grey",
        };
        let alpha = if decoded.alpha.is_some() { " with alpha" } else { "" };
        PixelLayout { max, ..decoded }.note(&format!("{}-bit {colours}{alpha}", self.depth))
    }
}
