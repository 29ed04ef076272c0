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
use crate::map_files::pixel::Transparency;
use crate::map_files::{MAX_CELLS, decoded};

/// Most bytes of the decoded pixels, for which decoders may take a few times as much: 8-bit grey on every cell of the
/// largest map.
pub(super) const MAX_DECODED: u64 = MAX_CELLS as u64;

/// Most bytes of a file, all of which are kept.
pub(super) const MAX_FILE: u64 = MAX_DECODED + decoded::MAX_EXTRAS;

/// What a note says of an animation or of a file of several pages.
pub(super) const FIRST_OF_SEVERAL: &str = "the file holds several images; the first was read";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureFormat {
    Jpeg,
    WebP,
    Gif,
    Bmp,
}

wildfire_base::names! { PictureFormat { Jpeg: "JPEG", WebP: "WebP", Gif: "GIF", Bmp: "BMP" } }

impl PictureFormat {
    /// Detects the format from the first bytes of a file.
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

    /// Reads an image.
    pub fn read(self, bytes: &[u8], transparency: Transparency) -> Result<GreyImage, Fault> {
        let source = Cursor::new(bytes);
        let has_several;
        let mut image = match self {
            Self::Jpeg => {
                has_several = false;
                // The decoder fills up what a file that was cut off lacks, and such a map would have false cells.
                if !reaches_its_end(bytes) {
                    return Err(Fault::Image { message: "the file ends before the image does".to_owned() });
                }
                self.read_with(JpegDecoder::new(source).map_err(damaged)?, bytes.len(), transparency)
            }
            Self::WebP => {
                let decoder = WebPDecoder::new(source).map_err(damaged)?;
                has_several = decoder.has_animation();
                self.read_with(decoder, bytes.len(), transparency)
            }
            Self::Gif => {
                has_several = has_several_frames(bytes);
                self.read_with(GifDecoder::new(source).map_err(damaged)?, bytes.len(), transparency)
            }
            Self::Bmp => {
                has_several = false;
                self.read_with(BmpDecoder::new(source).map_err(damaged)?, bytes.len(), transparency)
            }
        }?;
        image.notes.extend(has_several.then(|| FIRST_OF_SEVERAL.to_owned()));
        Ok(image)
    }

    fn read_with(
        self,
        mut decoder: impl ImageDecoder,
        bytes: usize,
        transparency: Transparency,
    ) -> Result<GreyImage, Fault> {
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
        // Asked first, as decoding uses the decoder up.
        let orientation = decoder.orientation().map_err(damaged)?;
        let note = layout_of(colour_type, transparency).note(&format!("{}, {colours}{alpha}", self.name()));
        Ok(turned(decode(decoder, transparency, Vec::from_iter(note))?, orientation))
    }
}

/// Returns whether a JPEG image has its end, which the decoder does not miss: it fills up what a file that was cut off
/// lacks. What cameras and scanners add behind the end does not matter.
///
/// Source: ITU-T Recommendation T.81, "Digital Compression and Coding of Continuous-Tone Still Images", 1992, annex B,
/// sections B.1.1 and B.2.
fn reaches_its_end(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xDA;
    const END_OF_IMAGE: u8 = 0xD9;
    let (mut rest, mut has_scan) = (bytes, false);
    // Between segments and in the data of a scan alike: a byte FF with another behind it that is neither 0, which makes it
    // a byte of the data, nor FF, which fills up, is a marker.
    while let Some(at) = rest.windows(2).position(|pair| pair[0] == 0xFF && !matches!(pair[1], 0 | 0xFF)) {
        let marker = rest[at + 1];
        rest = &rest[at + 2..];
        match marker {
            END_OF_IMAGE if has_scan => return true,
            // Markers that stand alone: restarts, the start, an end before any scan.
            0x01 | 0xD0..=0xD9 => {}
            _ => {
                has_scan |= marker == START_OF_SCAN;
                let length = rest.first_chunk().map(|length| usize::from(u16::from_be_bytes(*length)));
                let Some(behind) = length.and_then(|length| rest.get(length..)) else { return false };
                rest = behind;
            }
        }
    }
    false
}

/// Returns whether a GIF image has a second frame; frames are passed over, not decoded.
fn has_several_frames(bytes: &[u8]) -> bool {
    let mut options = gif::DecodeOptions::new();
    options.skip_frame_decoding(true);
    let Ok(mut decoder) = options.read_info(bytes) else { return false };
    (0..2).all(|_| matches!(decoder.next_frame_info(), Ok(Some(_))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_of_an_image_is_behind_its_scans() {
        // An application segment that holds an end marker, a scan with a stuffed FF and a restart, fill bytes, the end.
        let whole = [
            &b"\xFF\xD8\xFF\xE1\x00\x04\xFF\xD9"[..],
            b"\xFF\xDA\x00\x03\x01\x12\xFF\x00\x34\xFF\xD0\x56",
            b"\xFF\xDA\x00\x03\x01\x78\xFF\xFF\xD9",
        ]
        .concat();
        assert!(reaches_its_end(&whole));
        assert!(reaches_its_end(&[&whole[..], b"\0\0 what a scanner adds \xFF\xDA"].concat()));
        assert!((0..whole.len()).all(|end| !reaches_its_end(&whole[..end])));
        assert!(!reaches_its_end(b"\xFF\xD8\xFF\xD9"), "there is no scan");
    }
}
