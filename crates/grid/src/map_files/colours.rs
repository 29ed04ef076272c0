//! Images as colours: drawn landscapes.

use std::io::Cursor;
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, Limits};

use super::png::SIGNATURE;
use super::{Fault, MapError};
use crate::Grid;
use wildfire_base::input_file;

/// The most bytes of an image file, and of its pixels.
const MAX_IMAGE_BYTES: u64 = 16_000_000;
const MAX_PIXEL_BYTES: u64 = 80_000_000;

/// Reads a PNG image as red, green and blue, row 0 at the upper edge; transparent pixels are shown on white.
///
/// # Errors
/// If the file is no PNG image or has more than `max` pixels along a side. Sizes are checked before memory is taken.
pub fn read_colours(path: &Path, max: u32) -> Result<Grid<[u8; 3]>, MapError> {
    let read = input_file::read(path, MAX_IMAGE_BYTES).map_err(Fault::from).and_then(|bytes| colours(bytes, max));
    read.map_err(|fault| MapError { path: path.to_owned(), fault })
}

fn colours(bytes: Vec<u8>, max: u32) -> Result<Grid<[u8; 3]>, Fault> {
    let damaged = |error: image::ImageError| Fault::Image { message: error.to_string() };
    if !bytes.starts_with(SIGNATURE) {
        return Err(Fault::Image { message: "it is not a PNG image".into() });
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_PIXEL_BYTES);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(damaged)?;
    let (cols, rows) = decoder.dimensions();
    if cols > max || rows > max || decoder.total_bytes() > MAX_PIXEL_BYTES {
        let message = format!("it has {cols} x {rows} pixels; expected at most {max} along a side");
        return Err(Fault::Image { message });
    }
    let image = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgba8();
    let pixels = image.pixels().map(|pixel| over_white(pixel.0)).collect();
    Ok(Grid::from_values(rows as usize, cols as usize, pixels))
}

/// Returns the colour that a pixel has on white paper.
fn over_white([red, green, blue, alpha]: [u8; 4]) -> [u8; 3] {
    // 127 is half the divisor, so that the quotient is rounded to the nearest.
    let mix = |value: u8| ((u32::from(value) * u32::from(alpha) + 255 * (255 - u32::from(alpha)) + 127) / 255) as u8;
    [mix(red), mix(green), mix(blue)]
}
