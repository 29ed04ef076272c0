//! Pixels from a decoder: their maximum number, and their grey values.

use image::metadata::Orientation;
use image::{ColorType, DynamicImage, GrayImage, ImageDecoder, ImageError};

use crate::Grid;
use crate::map_files::error::with_room;
use crate::map_files::pixel::{PixelLayout, Pixels, Transparency};
use crate::map_files::{Fault, MAX_CELLS};

/// Most bytes of the decoded pixels: 16-bit grey on every cell of the largest map.
pub(super) const MAX_DECODED: u64 = 2 * MAX_CELLS as u64;

/// Most bytes of what is no pixel: colour profiles, texts, a row in the making.
pub(super) const MAX_EXTRAS: u64 = 1 << 24;

/// Deflate packs at most 1032 bytes into one (Jean-loup Gailly, Mark Adler, "zlib Technical Details", section "Maximum
/// Compression Factor"), and a pixel of 1 bit may become 4 bytes. Other ways of packing beat that with blank images only.
const MAX_RATIO: u64 = 1032 * 32;

/// An image as grey values, and what was made of it on the way, in sentences.
pub(super) struct GreyImage {
    pub grey: Grid<u8>,
    /// The transparent pixels, if they are [unknown](Transparency::Unknown).
    pub is_unknown: Option<Grid<bool>>,
    pub notes: Vec<String>,
}

/// Accepts the bytes that a header promises, before memory is taken for them: at most `limit`, and no more than a file
/// of `bytes` bytes can hold.
pub(super) fn check_decoded(decoded: u64, limit: u64, bytes: u64, (rows, cols): (usize, usize)) -> Result<(), Fault> {
    if decoded > limit {
        return Err(Fault::ImageTooLarge { bytes: decoded, limit });
    }
    if decoded / MAX_RATIO > bytes {
        let message = format!("{bytes} bytes cannot hold a height of {rows} and a width of {cols}");
        return Err(Fault::Image { message });
    }
    Ok(())
}

/// Tells an image that is damaged from one of a kind that is not read. Decoders say the latter in an error of its own, or
/// in words alone.
pub(super) fn damaged(error: ImageError) -> Fault {
    let message = error.to_string();
    let text = message.to_lowercase();
    let is_of_unknown_kind = matches!(error, ImageError::Unsupported(_))
        || ["unsupported", "not supported", "unimplemented"].iter().any(|phrase| text.contains(phrase));
    if is_of_unknown_kind { Fault::Unread { format: "image", reason: message } } else { Fault::Image { message } }
}

/// Decodes an image whose size and bytes were checked.
pub(super) fn decode(
    decoder: impl ImageDecoder,
    transparency: Transparency,
    notes: Vec<String>,
) -> Result<GreyImage, Fault> {
    let (cols, rows) = decoder.dimensions();
    let colour_type = decoder.color_type();
    let decoded = decoder.total_bytes() as usize;
    let mut data = with_room(decoded)?;
    data.resize(decoded, 0);
    decoder.read_image(&mut data).map_err(damaged)?;
    let (rows, cols) = (rows as usize, cols as usize);
    // The bytes of the commonest kind of image are its grey values already and need no second copy.
    if colour_type == ColorType::L8 {
        return Ok(GreyImage { grey: Grid::from_values(rows, cols, data), is_unknown: None, notes });
    }
    let layout = layout_of(colour_type, transparency);
    let bytes_per_pixel = usize::from(colour_type.bytes_per_pixel());
    let mut pixels = Pixels::with_room(layout, rows * cols)?;
    let mut samples = Vec::new();
    // Samples are bytes or native 16-bit words.
    for row in data.chunks_exact(cols * bytes_per_pixel) {
        samples.clear();
        if layout.max > 255 {
            samples.extend(row.chunks_exact(2).map(|pair| u16::from_ne_bytes([pair[0], pair[1]])));
        } else {
            samples.extend(row.iter().map(|&byte| u16::from(byte)));
        }
        pixels.append(&samples);
    }
    Ok(pixels.into_image(rows, cols, notes))
}

pub(super) fn layout_of(colour_type: ColorType, transparency: Transparency) -> PixelLayout {
    let is_wide = colour_type.bytes_per_pixel() > colour_type.channel_count();
    let max = if is_wide { u16::MAX } else { 255 };
    PixelLayout { colour: colour_type.has_color(), alpha: colour_type.has_alpha().then_some(transparency), max }
}

/// Turns an image as the tag of its camera or scanner says, so that it is read as programs show it; adds a note if that
/// changes it.
pub(super) fn turned(mut image: GreyImage, orientation: Orientation) -> GreyImage {
    if orientation == Orientation::NoTransforms {
        return image;
    }
    let turn = |grid: Grid<u8>| {
        let cols = grid.cols() as u32;
        let rows = grid.rows() as u32;
        let pixels = GrayImage::from_raw(cols, rows, grid.values().to_vec()).expect("there is a value for every pixel");
        let mut image = DynamicImage::ImageLuma8(pixels);
        image.apply_orientation(orientation);
        let rows = image.height() as usize;
        let cols = image.width() as usize;
        Grid::from_values(rows, cols, image.into_luma8().into_raw())
    };
    image.notes.push("the image was turned as its orientation tag says".to_owned());
    image.grey = turn(image.grey);
    // The mask is turned as an image of zeros and ones.
    image.is_unknown = image.is_unknown.map(|is_unknown| {
        let bytes = is_unknown.values().iter().map(|&pixel| u8::from(pixel)).collect();
        let turned = turn(Grid::from_values(is_unknown.rows(), is_unknown.cols(), bytes));
        let values = turned.values().iter().map(|&byte| byte == 1).collect();
        Grid::from_values(turned.rows(), turned.cols(), values)
    });
    image
}
