//! JPEG, WebP, GIF and BMP images as grey values.
//!
//! They are decoded by the crate `image`. Of an animation the first image is read, and an orientation tag is applied;
//! notes say so. Colour profiles are not applied.

use std::io::Cursor;

use image::codecs::bmp::BmpDecoder;
use image::codecs::gif::GifDecoder;
use image::codecs::jpeg::JpegDecoder;
use image::codecs::webp::WebPDecoder;
use image::{ImageDecoder, Limits};

use crate::map_files::Fault;
use crate::map_files::decoded::{GreyImage, check_decoded, damaged, decode, layout_of, turned};
use crate::map_files::error::check_size;
use crate::map_files::{MAX_CELLS, decoded};

/// Most bytes of the decoded pixels, for which decoders may take a few times as much: 8-bit grey on every cell of the
/// largest map.
pub(super) const MAX_DECODED: u64 = MAX_CELLS as u64;

/// Most bytes of a file, all of which are kept.
pub(super) const MAX_FILE: u64 = MAX_DECODED + decoded::MAX_EXTRAS;

/// What a note says of an animation or of a file of several pages.
pub(super) const FIRST_OF_SEVERAL: &str = "the file holds several images, of which the first was read";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureFormat {
    Jpeg,
    WebP,
    Gif,
    Bmp,
}

impl PictureFormat {
    /// Tells the format from the first bytes of a file.
    pub fn from_first_bytes(start: &[u8]) -> Option<Self> {
        if start.starts_with(b"\xFF\xD8\xFF") {
            Some(Self::Jpeg)
        } else if start.starts_with(b"RIFF") && start.get(8..12) == Some(b"WEBP") {
            Some(Self::WebP)
        } else if start.starts_with(b"GIF87a") || start.starts_with(b"GIF89a") {
            Some(Self::Gif)
        } else if start.starts_with(b"BM") {
            Some(Self::Bmp)
        } else {
            None
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Jpeg => "JPEG",
            Self::WebP => "WebP",
            Self::Gif => "GIF",
            Self::Bmp => "BMP",
        }
    }

    /// Reads an image.
    pub fn read(self, bytes: &[u8]) -> Result<GreyImage, Fault> {
        let source = Cursor::new(bytes);
        let has_several;
        let mut image = match self {
            Self::Jpeg => {
                has_several = false;
                self.read_with(JpegDecoder::new(source).map_err(damaged)?, bytes.len())
            }
            Self::WebP => {
                let decoder = WebPDecoder::new(source).map_err(damaged)?;
                has_several = decoder.has_animation();
                self.read_with(decoder, bytes.len())
            }
            Self::Gif => {
                has_several = has_several_frames(bytes);
                self.read_with(GifDecoder::new(source).map_err(damaged)?, bytes.len())
            }
            Self::Bmp => {
                has_several = false;
                self.read_with(BmpDecoder::new(source).map_err(damaged)?, bytes.len())
            }
        }?;
        image.notes.extend(has_several.then(|| FIRST_OF_SEVERAL.to_owned()));
        Ok(image)
    }

    fn read_with(self, mut decoder: impl ImageDecoder, bytes: usize) -> Result<GreyImage, Fault> {
        let (cols, rows) = decoder.dimensions();
        let size = (rows as usize, cols as usize);
        check_size(size.0, size.1)?;
        check_decoded(decoder.total_bytes(), MAX_DECODED, bytes as u64, size)?;
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(MAX_DECODED);
        decoder.set_limits(limits).map_err(damaged)?;
        let colour_type = decoder.color_type();
        let colours = if colour_type.has_color() { "RGB" } else { "grey" };
        let alpha = if colour_type.has_alpha() { " with alpha" } else { "" };
        let orientation = decoder.orientation().map_err(damaged)?;
        let mut notes = Vec::from_iter(layout_of(colour_type).note(&format!("{}, {colours}{alpha}", self.name())));
        let grey = turned(decode(decoder)?, orientation, &mut notes);
        Ok(GreyImage { grey, notes })
    }
}

/// Says whether a GIF image has a second frame; frames are passed over, not decoded.
fn has_several_frames(bytes: &[u8]) -> bool {
    let mut options = gif::DecodeOptions::new();
    options.skip_frame_decoding(true);
    let Ok(mut decoder) = options.read_info(bytes) else { return false };
    (0..2).all(|_| matches!(decoder.next_frame_info(), Ok(Some(_))))
}
