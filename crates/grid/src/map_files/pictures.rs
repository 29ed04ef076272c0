//! JPEG, WebP, GIF and BMP images as grey values.
//!
//! Of an animation the first image is read, and an orientation tag is applied; notes say so. Colour profiles are not
//! applied.

use std::io::Cursor;

use image_webp::WebPDecoder;
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use crate::map_files::Fault;
use crate::map_files::bmp::Bmp;
use crate::map_files::decoded::{GreyImage, ImageHeader, check_decoded, damaged, turned};
use crate::map_files::error::{check_size, with_room};
use crate::map_files::pixel::{PixelLayout, Transparency};
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
        match self {
            Self::Jpeg => read_jpeg(bytes),
            Self::WebP => read_webp(bytes, transparency),
            Self::Gif => read_gif(bytes, transparency),
            Self::Bmp => {
                let bmp = Bmp::parse(bytes)?;
                let alpha = bmp.has_alpha().then_some(transparency);
                let layout = PixelLayout { colour: true, alpha, max: 255 };
                let header = ImageHeader { rows: bmp.rows, cols: bmp.cols, layout };
                self.read_pixels(header, bytes, |pixels| bmp.decode(pixels))
            }
        }
    }

    /// Decodes pixels whose header was read, if there are not too many.
    fn read_pixels(
        self,
        header: ImageHeader,
        bytes: &[u8],
        read: impl FnOnce(&mut [u8]) -> Result<(), Fault>,
    ) -> Result<GreyImage, Fault> {
        check_size(header.rows, header.cols)?;
        check_decoded(header.bytes(), MAX_DECODED, bytes.len() as u64, (header.rows, header.cols))?;
        let colours = if header.layout.colour { "RGB" } else { "grey" };
        let alpha = if header.layout.alpha.is_some() { " with alpha" } else { "" };
        let note = header.layout.note(&format!("{}, {colours}{alpha}", self.name()));
        header.decode_grey(Vec::from_iter(note), read)
    }
}

fn read_jpeg(bytes: &[u8]) -> Result<GreyImage, Fault> {
    // The decoder fills up what a file that was cut off lacks, and such a map would have false cells.
    if !reaches_its_end(bytes) {
        return Err(Fault::Image { message: "the file ends before the image does".to_owned() });
    }
    // Minor faults of a file do not matter, and sizes are checked below.
    let options = DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(damaged)?;
    let (cols, rows) = decoder.dimensions().expect("the header was read");
    let is_grey = decoder.input_colorspace() == Some(ColorSpace::Luma);
    // Everything else becomes RGB.
    decoder.set_options(if is_grey { options.jpeg_set_out_colorspace(ColorSpace::Luma) } else { options });
    let header = ImageHeader { rows, cols, layout: PixelLayout { colour: !is_grey, alpha: None, max: 255 } };
    let orientation = decoder.exif().and_then(|exif| exif_orientation(exif));
    let image =
        PictureFormat::Jpeg.read_pixels(header, bytes, |pixels| decoder.decode_into(pixels).map_err(damaged))?;
    Ok(turned(image, orientation))
}

fn read_webp(bytes: &[u8], transparency: Transparency) -> Result<GreyImage, Fault> {
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(damaged)?;
    // No chunk is longer than the file, whatever it says.
    decoder.set_memory_limit(bytes.len());
    let (cols, rows) = decoder.dimensions();
    let layout = PixelLayout { colour: true, alpha: decoder.has_alpha().then_some(transparency), max: 255 };
    let header = ImageHeader { rows: rows as usize, cols: cols as usize, layout };
    if decoder.is_animated() && first_frame_fits(bytes) != Some(true) {
        return Err(Fault::Image { message: "its first frame has another size than its pixels".to_owned() });
    }
    let image = PictureFormat::WebP.read_pixels(header, bytes, |pixels| decoder.read_image(pixels).map_err(damaged))?;
    let orientation = decoder.exif_metadata().map_err(damaged)?.and_then(|exif| exif_orientation(&exif));
    Ok(with_several_noted(turned(image, orientation), decoder.is_animated()))
}

/// Returns whether the first frame of a WebP animation is as large as its pixels; `None` if it ends early.
///
/// The decoder does not look where alpha is apart from lossy pixels, and panics (image-webp 0.2.4).
///
/// Source: Google, "WebP Container Specification", 2025, section "Animation"; J. Bankoski et al., "VP8 Data Format and
/// Decoding Guide", RFC 6386, 2011, section 9.1.
fn first_frame_fits(bytes: &[u8]) -> Option<bool> {
    let mut chunks = bytes.get(12..)?;
    let frame = loop {
        if let (b"ANMF", frame) = split_chunk(&mut chunks)? {
            break frame;
        }
    };
    let (place, mut parts) = frame.split_at_checked(16)?;
    let (b"ALPH", _) = split_chunk(&mut parts)? else { return Some(true) };
    let (_, pixels) = split_chunk(&mut parts)?;
    // A frame's sides are stored less 1, in 24 bits; above the 14 bits of a side of pixels is a scale.
    let mut sides = place[6..12].chunks_exact(3).zip(pixels.get(6..10)?.chunks_exact(2));
    Some(sides.all(|(frame, pixels)| {
        u32::from_le_bytes([frame[0], frame[1], frame[2], 0]) + 1
            == u32::from_le_bytes([pixels[0], pixels[1] & 0x3F, 0, 0])
    }))
}

/// Splits off the next chunk of a WebP file, its name and its data.
fn split_chunk<'a>(rest: &mut &'a [u8]) -> Option<(&'a [u8], &'a [u8])> {
    let (name, size) = rest.split_off(..8)?.split_at(4);
    let size = u32::from_le_bytes(*size.first_chunk()?) as usize;
    let data = &rest[..size.min(rest.len())];
    *rest = rest.get(size.next_multiple_of(2)..).unwrap_or_default();
    Some((name, data))
}

fn read_gif(bytes: &[u8], transparency: Transparency) -> Result<GreyImage, Fault> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).map_err(damaged)?;
    let layout = PixelLayout { colour: true, alpha: Some(transparency), max: 255 };
    let header = ImageHeader { rows: decoder.height().into(), cols: decoder.width().into(), layout };
    let image =
        PictureFormat::Gif.read_pixels(header, bytes, |pixels| read_gif_frame(&mut decoder, header.cols, pixels))?;
    Ok(with_several_noted(image, has_several_frames(bytes)))
}

/// Decodes the first frame of a GIF image into the pixels of its canvas, which are transparent and in rows of `cols`.
fn read_gif_frame(decoder: &mut gif::Decoder<&[u8]>, cols: usize, canvas: &mut [u8]) -> Result<(), Fault> {
    let Some(frame) = decoder.next_frame_info().map_err(damaged)? else {
        return Err(Fault::Image { message: "it has no frame".to_owned() });
    };
    let [left, top, width, height] = [frame.left, frame.top, frame.width, frame.height].map(usize::from);
    let bytes = 4 * width as u64 * height as u64;
    if [left, top] == [0, 0] && width == cols && bytes == canvas.len() as u64 {
        return decoder.read_into_buffer(canvas).map_err(damaged);
    }
    // A frame may be larger than its canvas.
    if bytes > MAX_DECODED {
        return Err(Fault::ImageTooLarge { bytes, limit: MAX_DECODED });
    }
    let mut pixels = with_room(bytes as usize)?;
    pixels.resize(bytes as usize, 0);
    decoder.read_into_buffer(&mut pixels).map_err(damaged)?;
    let left = left.min(cols);
    let visible = width.min(cols - left);
    let rows = canvas.chunks_exact_mut(4 * cols).skip(top);
    for (row, pixels) in rows.zip(pixels.chunks_exact(4 * width.max(1))) {
        row[4 * left..4 * (left + visible)].copy_from_slice(&pixels[..4 * visible]);
    }
    Ok(())
}

fn with_several_noted(mut image: GreyImage, has_several: bool) -> GreyImage {
    image.notes.extend(has_several.then(|| FIRST_OF_SEVERAL.to_owned()));
    image
}

/// Finds the orientation in Exif data, which begin as a TIFF image does. What is damaged elsewhere does not matter.
fn exif_orientation(exif: &[u8]) -> Option<u64> {
    // The number of the tag, its type, a word of 16 bits, and their count.
    let (is_little, tag) = match exif.get(..4)? {
        b"II*\0" => (true, b"\x12\x01\x03\0\x01\0\0\0"),
        b"MM\0*" => (false, b"\x01\x12\0\x03\0\0\0\x01"),
        _ => return None,
    };
    let list = exif.get(exif_number(exif.get(4..8)?, is_little) as usize..)?;
    let (count, tags) = list.split_at_checked(2)?;
    let mut tags = tags.chunks_exact(12).take(exif_number(count, is_little) as usize);
    Some(exif_number(&tags.find(|entry| entry.starts_with(tag))?[8..10], is_little))
}

fn exif_number(bytes: &[u8], is_little: bool) -> u64 {
    let join = |number: u64, &byte: &u8| number << 8 | u64::from(byte);
    if is_little { bytes.iter().rev().fold(0, join) } else { bytes.iter().fold(0, join) }
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
