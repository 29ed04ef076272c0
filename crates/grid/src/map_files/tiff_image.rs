//! TIFF images as grey values.
//!
//! They are decoded by the crate `tiff`. Of several pages the first is read, and the orientation tag is applied; notes
//! say so.
//!
//! Source: Adobe Developers Association, "TIFF Revision 6.0", 1992, sections 3 to 8.

use tiff::decoder::DecodingResult;
use tiff::tags::{CompressionMethod, PhotometricInterpretation, SampleFormat, Tag};
use tiff::{ColorType, TiffError, TiffUnsupportedError};

use crate::map_files::Fault;
use crate::map_files::decoded::{GreyImage, check_decoded, turned};
use crate::map_files::error::check_size;
use crate::map_files::pictures::{FIRST_OF_SEVERAL, MAX_DECODED};
use crate::map_files::pixel::{PixelLayout, Pixels, Transparency};
use crate::map_files::raster::tiff_chunks;

const FLOAT_OR_SIGNED: &str = "its samples are floats, or may be negative";

/// Reads the first image of a TIFF file: grey of 1 to 16 bits, or RGB, with alpha or without, of 8 or 16 bits.
pub(super) fn read(bytes: &[u8], transparency: Transparency) -> Result<GreyImage, Fault> {
    let mut decoder =
        tiff_chunks::open(bytes, MAX_DECODED as usize).map_err(|message| Fault::Image { message })?.map_err(damaged)?;
    let (cols, rows) = decoder.dimensions().map_err(damaged)?;
    let size = (rows as usize, cols as usize);
    check_size(size.0, size.1)?;
    let formats = decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).map_err(damaged)?.unwrap_or_default();
    if formats.iter().any(|format| [SampleFormat::Int, SampleFormat::IEEEFP].map(|kind| kind.to_u16()).contains(format))
    {
        return Err(unfit(FLOAT_OR_SIGNED));
    }
    let samples = Samples::of(decoder.colortype().map_err(damaged)?, transparency)?;
    let decoded = rows as u64 * samples.bytes_per_row(size.1) as u64;
    // Refused by its header alone: a small file may unpack to gigabytes.
    check_decoded(decoded, MAX_DECODED, bytes.len() as u64, size)?;
    if decoder.image_buffer_layout().map_err(damaged)?.planes > 1 {
        return Err(unfit("its colours are in separate planes"));
    }
    let orientation = decoder.find_tag_unsigned::<u8>(Tag::Orientation).map_err(damaged)?.map(u64::from);
    let has_several = decoder.more_images();

    let pixels = samples.pixels(decoder.read_image().map_err(damaged)?, size)?;
    let note = samples.layout.note(&samples.name());
    let mut image = turned(pixels.into_image(size.0, size.1, Vec::from_iter(note)), orientation);
    image.notes.extend(has_several.then(|| FIRST_OF_SEVERAL.to_owned()));
    Ok(image)
}

fn damaged(error: TiffError) -> Fault {
    match error {
        TiffError::UnsupportedError(reason) => unfit(&shown_reason(&reason)),
        error => Fault::Image { message: error.to_string() },
    }
}

fn shown_reason(reason: &TiffUnsupportedError) -> String {
    match reason {
        TiffUnsupportedError::InterpretationWithBits(PhotometricInterpretation::RGBPalette, _)
        | TiffUnsupportedError::UnsupportedInterpretation(PhotometricInterpretation::RGBPalette) => {
            "its colours come from a palette".to_owned()
        }
        TiffUnsupportedError::UnsupportedCompressionMethod(CompressionMethod::JPEG | CompressionMethod::ModernJPEG) => {
            "its pixels are compressed as JPEG".to_owned()
        }
        TiffUnsupportedError::UnsupportedCompressionMethod(method) => format!(
            "its pixels are compressed as \
            {method:?}"
        ),
        TiffUnsupportedError::UnsupportedSampleFormat(_) => FLOAT_OR_SIGNED.to_owned(),
        reason => reason.to_string(),
    }
}

fn unfit(reason: &str) -> Fault {
    Fault::Unread { format: "TIFF", reason: format!("{reason}; expected grey or RGB of up to 16 bits per sample") }
}

/// The samples of a pixel and their bits.
struct Samples {
    layout: PixelLayout,
    bits: u8,
}

impl Samples {
    fn of(colour_type: ColorType, transparency: Transparency) -> Result<Self, Fault> {
        let (colour, alpha, bits) = match colour_type {
            ColorType::Gray(bits @ (1 | 2 | 4 | 8 | 16)) => (false, false, bits),
            ColorType::GrayA(bits @ (8 | 16)) => (false, true, bits),
            ColorType::Multiband { bit_depth: bits @ (8 | 16), num_samples: 2 } => (false, true, bits),
            ColorType::RGB(bits @ (8 | 16)) => (true, false, bits),
            ColorType::RGBA(bits @ (8 | 16)) => (true, true, bits),
            ColorType::CMYK(_) | ColorType::CMYKA(_) => return Err(unfit("its colours are CMYK")),
            ColorType::YCbCr(_) => return Err(unfit("its colours are YCbCr")),
            ColorType::Gray(bits) => return Err(unfit(&format!("its samples have {bits} bits"))),
            _ => return Err(unfit(&format!("its pixels are {colour_type:?}"))),
        };
        let max = ((1u32 << bits) - 1) as u16;
        Ok(Self { layout: PixelLayout { colour, alpha: alpha.then_some(transparency), max }, bits })
    }

    fn name(&self) -> String {
        let colours = if self.layout.colour { "RGB" } else { "grey" };
        let alpha = if self.layout.alpha.is_some() { " with alpha" } else { "" };
        format!("TIFF, {}-bit {colours}{alpha}", self.bits)
    }

    fn samples_per_row(&self, cols: usize) -> usize {
        cols * self.layout.channels()
    }

    fn bytes_per_row(&self, cols: usize) -> usize {
        (self.samples_per_row(cols) * usize::from(self.bits)).div_ceil(8)
    }

    fn pixels(&self, decoded: DecodingResult, (rows, cols): (usize, usize)) -> Result<Pixels, Fault> {
        let mut pixels = Pixels::with_room(self.layout, rows * cols)?;
        match decoded {
            DecodingResult::U8(bytes) if self.bits <= 8 => {
                let mut samples = Vec::new();
                for row in bytes.chunks_exact(self.bytes_per_row(cols)).take(rows) {
                    samples.clear();
                    self.unpack(row, self.samples_per_row(cols), &mut samples);
                    pixels.append(&samples);
                }
            }
            DecodingResult::U16(samples) if self.bits == 16 => {
                let all = rows * self.samples_per_row(cols);
                pixels.append(&samples[..all.min(samples.len())]);
            }
            _ => return Err(unfit(FLOAT_OR_SIGNED)),
        }
        if pixels.len() < rows * cols {
            let row = pixels.len() / cols;
            let col = pixels.len() % cols;
            return Err(Fault::Ends { row, col, rows, cols });
        }
        Ok(pixels)
    }

    /// Appends the samples of a row; the leftmost of a byte are its highest bits.
    fn unpack(&self, row: &[u8], samples: usize, unpacked: &mut Vec<u16>) {
        if self.bits == 8 {
            unpacked.extend(row.iter().map(|&byte| u16::from(byte)));
            return;
        }
        let per_byte = 8 / usize::from(self.bits);
        unpacked.extend((0..samples).map(|at| {
            let shift = (per_byte - 1 - at % per_byte) * usize::from(self.bits);
            u16::from(row[at / per_byte] >> shift) & self.layout.max
        }));
    }
}
