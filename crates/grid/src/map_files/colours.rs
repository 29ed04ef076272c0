//! Images as colours: drawn landscapes.

use std::io::Cursor;
use std::path::Path;

use super::decoded::{ImageHeader, damaged};
use super::error::with_room;
use super::pixel::Transparency;
use super::{Fault, MapError, png};
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
    if !bytes.starts_with(png::SIGNATURE) {
        return Err(Fault::Image { message: "it is not a PNG image".into() });
    }
    let mut reader = png::open(Cursor::new(bytes), MAX_PIXEL_BYTES)?;
    let header = png::header_of(&reader, Transparency::OverWhite);
    let ImageHeader { rows, cols, layout } = header;
    if rows.max(cols) > max as usize || header.bytes() > MAX_PIXEL_BYTES {
        let message = format!("it has {cols} x {rows} pixels; expected at most {max} along a side");
        return Err(Fault::Image { message });
    }
    let data = header.decode(|pixels| reader.next_frame(pixels).map(drop).map_err(damaged))?;
    let mut colours = with_room(rows * cols)?;
    let mut samples = Vec::new();
    for row in data.chunks_exact(header.bytes_per_row() as usize) {
        header.unpack(row, &mut samples);
        colours.extend(samples.chunks_exact(layout.channels()).map(|pixel| over_white(pixel, layout.max)));
    }
    Ok(Grid::from_values(rows, cols, colours))
}

/// Returns the colour that a pixel has on white paper, from its grey value or colours and its alpha.
fn over_white(pixel: &[u16], max: u16) -> [u8; 3] {
    let [red, green, blue, alpha] = match *pixel {
        [red, green, blue, alpha] => [red, green, blue, alpha],
        [red, green, blue] => [red, green, blue, max],
        [grey, alpha] => [grey, grey, grey, alpha],
        _ => [pixel[0], pixel[0], pixel[0], max],
    }
    .map(|sample| rounded(u32::from(sample) * 255, max.into()));
    [red, green, blue].map(|value| rounded(value * alpha + 255 * (255 - alpha), 255) as u8)
}

/// The quotient, rounded to the nearest.
fn rounded(value: u32, divisor: u32) -> u32 {
    (value + divisor / 2) / divisor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_that_another_reader_finds() {
        // All words, each with others beside it.
        let bytes: Vec<u8> = (0..=u16::MAX).flat_map(u16::to_be_bytes).collect();
        for (kind, depth) in [
            (::png::ColorType::Grayscale, ::png::BitDepth::Sixteen),
            (::png::ColorType::Grayscale, ::png::BitDepth::Two),
            (::png::ColorType::GrayscaleAlpha, ::png::BitDepth::Eight),
            (::png::ColorType::Rgb, ::png::BitDepth::Eight),
            (::png::ColorType::Rgba, ::png::BitDepth::Eight),
            (::png::ColorType::Rgba, ::png::BitDepth::Sixteen),
        ] {
            let row_bytes = 64 * kind.samples() * depth as usize / 8;
            let rows = bytes.len() / row_bytes;
            let mut file = Vec::new();
            let mut encoder = ::png::Encoder::new(&mut file, 64, rows as u32);
            encoder.set_color(kind);
            encoder.set_depth(depth);
            let mut writer = encoder.write_header().expect("it can be encoded");
            writer.write_image_data(&bytes[..rows * row_bytes]).expect("it can be encoded");
            writer.finish().expect("it can be encoded");
            let image = image::load_from_memory(&file).expect("an image").into_rgba8();
            let expected: Vec<[u8; 3]> = image.pixels().map(|pixel| over_white(&pixel.0.map(u16::from), 255)).collect();
            assert!(colours(file, 8192).expect("an image").values() == expected, "{kind:?} of {depth:?} bits");
        }
    }
}
