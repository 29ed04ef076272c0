//! PNG images as grey values.

use std::io::{BufRead, Read, Seek};

use image::codecs::png::PngDecoder;
use image::{ColorType, ImageDecoder, Limits};

use crate::map_files::Fault;
use crate::map_files::decoded::{GreyImage, MAX_DECODED, MAX_EXTRAS, check_decoded, damaged, decode, layout_of};
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
    let header = PngHeader::parse(source.fill_buf()?)?;
    let size = (header.rows, header.cols);
    check_size(header.rows, header.cols)?;
    // This limit is for what a file holds beside its pixels, whose size is checked below.
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_EXTRAS);
    let decoder = PngDecoder::with_limits(source, limits).map_err(damaged)?;
    let colour_type = decoder.color_type();
    check_decoded(decoder.total_bytes(), MAX_DECODED, bytes, size)?;
    let has_several = decoder.is_apng().map_err(damaged)?;
    let mut notes = Vec::from_iter(header.note(colour_type, transparency));
    notes.extend(has_several.then(|| FIRST_OF_SEVERAL.to_owned()));
    decode(decoder, transparency, notes)
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

    fn note(&self, decoded: ColorType, transparency: Transparency) -> Option<String> {
        let is_palette = self.colour_type == 3;
        let max = if is_palette { 255 } else { ((1u32 << self.depth) - 1) as u16 };
        let colours = match (is_palette, decoded.has_color()) {
            (true, _) => "palette",
            (false, true) => "RGB",
            (false, false) => "grey",
        };
        let alpha = if decoded.has_alpha() { " with alpha" } else { "" };
        PixelLayout { max, ..layout_of(decoded, transparency) }.note(&format!("{}-bit {colours}{alpha}", self.depth))
    }
}
