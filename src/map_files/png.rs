//! PNG images as grey values.

use std::io::{BufRead, Read, Seek};

use image::codecs::png::PngDecoder;
use image::{ColorType, ImageDecoder, ImageError, Limits};

use crate::grid::Grid;
use crate::map_files::error::{check_size, with_room};
use crate::map_files::pixel::PixelLayout;
use crate::map_files::{Fault, MAX_CELLS};

pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Most bytes of the decoded pixels: 16-bit grey on every cell of the largest map.
const MAX_DECODED: u64 = 2 * MAX_CELLS as u64;

/// Deflate packs at most 1032 bytes into one (Jean-loup Gailly, Mark Adler, "zlib Technical Details", section "Maximum
/// Compression Factor"), and a pixel of 1 bit may become 4 bytes.
const MAX_RATIO: u64 = 1032 * 32;

/// Most bytes of what is no pixel: colour profiles, texts, a row in the making.
const MAX_EXTRAS: u64 = 1 << 24;

/// Reads a PNG image from a file of `bytes` bytes, and says how it was converted to 8-bit grey.
///
/// Neither gamma nor a colour profile is applied. Of an animation the first image is read.
pub(super) fn read<R: BufRead + Seek>(mut source: R, bytes: u64) -> Result<(Grid<u8>, Option<String>), Fault> {
    let header = PngHeader::parse(source.fill_buf()?)?;
    check_size(header.rows, header.cols)?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_EXTRAS);
    let decoder = PngDecoder::with_limits(source, limits).map_err(damaged)?;
    let colour_type = decoder.color_type();
    let decoded = decoder.total_bytes();
    check_decoded(decoded, bytes, &header)?;

    let mut data = with_room(decoded as usize)?;
    data.resize(decoded as usize, 0);
    decoder.read_image(&mut data).map_err(damaged)?;
    let values = grey_values(data, colour_type, &header)?;
    Ok((Grid::from_values(header.rows, header.cols, values), header.note(colour_type)))
}

/// Reads all bytes of an image of which the first are known; no more than an image of the size in its header can have.
pub(super) fn read_bytes(mut bytes: Vec<u8>, rest: impl Read) -> Result<Vec<u8>, Fault> {
    let header = PngHeader::parse(&bytes)?;
    check_size(header.rows, header.cols)?;
    let most = header.most_bytes();
    rest.take((most + 1).saturating_sub(bytes.len() as u64)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let message = format!("it goes on after {most} bytes, more than an image of its size has");
        return Err(Fault::Image { message });
    }
    Ok(bytes)
}

/// Accepts the bytes that the header promises, before memory is taken for them.
fn check_decoded(decoded: u64, bytes: u64, header: &PngHeader) -> Result<(), Fault> {
    if decoded > MAX_DECODED {
        return Err(Fault::ImageTooLarge { bytes: decoded, limit: MAX_DECODED });
    }
    if decoded / MAX_RATIO > bytes {
        let message = format!("{bytes} bytes cannot hold a height of {} and a width of {}", header.rows, header.cols);
        return Err(Fault::Image { message });
    }
    Ok(())
}

fn damaged(error: ImageError) -> Fault {
    Fault::Image { message: error.to_string() }
}

/// The grey values of decoded pixels, whose samples are bytes or native 16-bit words.
fn grey_values(data: Vec<u8>, colour_type: ColorType, header: &PngHeader) -> Result<Vec<u8>, Fault> {
    if colour_type == ColorType::L8 {
        return Ok(data);
    }
    let layout = layout_of(colour_type);
    let mut values = with_room(header.rows * header.cols)?;
    let mut samples = Vec::new();
    for row in data.chunks_exact(header.cols * usize::from(colour_type.bytes_per_pixel())) {
        samples.clear();
        if layout.max > 255 {
            samples.extend(row.chunks_exact(2).map(|pair| u16::from_ne_bytes([pair[0], pair[1]])));
        } else {
            samples.extend(row.iter().map(|&byte| u16::from(byte)));
        }
        layout.append_grey(&samples, &mut values);
    }
    Ok(values)
}

fn layout_of(colour_type: ColorType) -> PixelLayout {
    let is_wide = colour_type.bytes_per_pixel() > colour_type.channel_count();
    let max = if is_wide { u16::MAX } else { 255 };
    PixelLayout { colour: colour_type.has_color(), alpha: colour_type.has_alpha(), max }
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
        let side = |bytes| u32::from_be_bytes(bytes) as usize;
        Ok(Self { rows: side([h3, h2, h1, h0]), cols: side([w3, w2, w1, w0]), depth, colour_type })
    }

    /// An upper bound of the bytes of an image of this size: no image is much larger than its pixels.
    fn most_bytes(&self) -> u64 {
        let channels = match self.colour_type {
            0 | 3 => 1,
            4 => 2,
            2 => 3,
            _ => 4,
        };
        let bits = self.cols as u64 * channels * u64::from(self.depth.min(16));
        // An interlaced row may come in two pieces, each with a byte for its filter.
        let pixels = self.rows as u64 * (bits.div_ceil(8) + 2);
        (pixels + pixels / 8).min(MAX_DECODED) + MAX_EXTRAS
    }

    fn note(&self, decoded: ColorType) -> Option<String> {
        let is_palette = self.colour_type == 3;
        let max = if is_palette { 255 } else { ((1u32 << self.depth) - 1) as u16 };
        let colours = match (is_palette, decoded.has_color()) {
            (true, _) => "palette",
            (false, true) => "RGB",
            (false, false) => "grey",
        };
        let alpha = if decoded.has_alpha() { " with alpha" } else { "" };
        PixelLayout { max, ..layout_of(decoded) }.note(&format!("{}-bit {colours}{alpha}", self.depth))
    }
}
