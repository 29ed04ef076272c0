//! Grey values of pixels that are not 8-bit grey already.

use crate::Grid;
use crate::map_files::Fault;
use crate::map_files::decoded::GreyImage;
use crate::map_files::error::with_room;

/// The meaning of pixels with an alpha below the largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Transparency {
    /// They lie over white.
    OverWhite,
    /// Their cells are unknown, whatever their colour.
    Unknown,
    /// They count as if they were opaque.
    Ignored,
}

/// The layout of a pixel: its channels, and the value that stands for white or opaque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PixelLayout {
    pub colour: bool,
    /// The meaning of the last channel; `None` without an alpha channel.
    pub alpha: Option<Transparency>,
    pub max: u16,
}

/// The pixels of an image, row by row.
pub(super) struct Pixels {
    layout: PixelLayout,
    grey: Vec<u8>,
    /// Empty unless transparency is [`Transparency::Unknown`].
    is_unknown: Vec<bool>,
}

impl Pixels {
    pub fn with_room(layout: PixelLayout, pixels: usize) -> Result<Self, Fault> {
        let is_unknown = if layout.alpha == Some(Transparency::Unknown) { with_room(pixels)? } else { Vec::new() };
        Ok(Self { layout, grey: with_room(pixels)?, is_unknown })
    }

    /// Appends whole pixels from their samples.
    pub fn append(&mut self, samples: &[u16]) {
        let layout = self.layout;
        if layout == PixelLayout::EIGHT_BIT_GREY {
            self.grey.extend(samples.iter().map(|&sample| sample as u8));
            return;
        }
        let pixels = samples.chunks_exact(layout.channels());
        if layout.alpha == Some(Transparency::Unknown) {
            self.is_unknown.extend(pixels.clone().map(|pixel| pixel.last().is_some_and(|&alpha| alpha < layout.max)));
        }
        self.grey.extend(pixels.map(|pixel| layout.grey(pixel)));
    }

    pub fn len(&self) -> usize {
        self.grey.len()
    }

    /// Returns the image of all pixels, of which there must be as many as it has.
    pub fn into_image(self, rows: usize, cols: usize, notes: Vec<String>) -> GreyImage {
        let is_unknown = Some(self.is_unknown).filter(|pixels| !pixels.is_empty());
        GreyImage {
            grey: Grid::from_values(rows, cols, self.grey),
            is_unknown: is_unknown.map(|pixels| Grid::from_values(rows, cols, pixels)),
            notes,
        }
    }
}

impl PixelLayout {
    pub const EIGHT_BIT_GREY: Self = Self { colour: false, alpha: None, max: 255 };

    pub fn channels(self) -> usize {
        (if self.colour { 3 } else { 1 }) + usize::from(self.alpha.is_some())
    }

    /// The 8-bit grey value of a pixel, rounded once, to nearest.
    ///
    /// Luma is 0.299 R + 0.587 G + 0.114 B (ITU-R Recommendation BT.601, "Studio encoding parameters of digital
    /// television", section 2.5.1). Where alpha says so, a pixel lies over white.
    fn grey(self, samples: &[u16]) -> u8 {
        let max = u64::from(self.max);
        let luma_1000 = match *samples {
            [red, green, blue, ..] => 299 * u64::from(red) + 587 * u64::from(green) + 114 * u64::from(blue),
            _ => 1000 * u64::from(samples[0]),
        };
        let is_over_white = self.alpha == Some(Transparency::OverWhite);
        let alpha = if is_over_white { u64::from(samples[self.channels() - 1]) } else { max };
        let over_white = luma_1000 * alpha + 1000 * max * (max - alpha);
        let whole = 1000 * max * max;
        u8::try_from((over_white * 255 + whole / 2) / whole).expect("no sample exceeds the maximum")
    }

    /// Returns what was converted in an image of this kind, such as "2-bit grey"; `None` if nothing was.
    pub fn note(self, kind: &str) -> Option<String> {
        let alpha = self.alpha.map(|alpha| match alpha {
            Transparency::OverWhite => "laid over white".to_owned(),
            Transparency::Unknown => "transparent pixels are unknown".to_owned(),
            Transparency::Ignored => "alpha was ignored".to_owned(),
        });
        let colour = self.colour.then(|| "grey = 0.299 R + 0.587 G + 0.114 B".to_owned());
        let scale = (self.max != 255).then(|| format!("values 0 to {} scaled to 0 to 255", self.max));
        let steps: Vec<String> = [alpha, colour, scale].into_iter().flatten().collect();
        (!steps.is_empty()).then(|| format!("the image ({kind}) was converted to 8-bit grey: {}", steps.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GREY: PixelLayout = PixelLayout::EIGHT_BIT_GREY;

    #[test]
    fn grey_of_eight_bits_stays_as_it_is() {
        for value in 0..=255 {
            assert_eq!(u16::from(GREY.grey(&[value])), value);
        }
        assert_eq!(GREY.note("8-bit grey"), None);
    }

    #[test]
    fn sixteen_bits_are_scaled_to_nearest() {
        let wide = PixelLayout { max: u16::MAX, ..GREY };
        let reckoned = |value: u16| (f64::from(value) / 257.0).round() as u8;
        assert!((0..=u16::MAX).all(|value| wide.grey(&[value]) == reckoned(value)));
    }

    #[test]
    fn colours_are_weighed_as_bt_601_says() {
        let colour = PixelLayout { colour: true, ..GREY };
        let primaries = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255], [7, 7, 7]];
        assert_eq!(primaries.map(|rgb| colour.grey(&rgb)), [76, 150, 29, 255, 7]);
    }

    #[test]
    fn transparent_black_is_white_and_half_of_it_is_grey() {
        for max in [1, 255, u16::MAX] {
            let layout = PixelLayout { alpha: Some(Transparency::OverWhite), max, ..GREY };
            assert_eq!((layout.grey(&[0, 0]), layout.grey(&[0, max])), (255, 0));
        }
        let layout = PixelLayout { colour: true, alpha: Some(Transparency::OverWhite), max: 255 };
        assert_eq!(layout.grey(&[0, 0, 0, 128]), 127);
    }
}
