//! The tolerance that separates dark from light best, by Otsu's method.
//!
//! Source: Nobuyuki Otsu, "A Threshold Selection Method from Gray-Level Histograms", IEEE Transactions on Systems, Man, and
//! Cybernetics 9(1), 1979, section II, equations (2) to (18).

use std::ops::RangeInclusive;

const LEVELS: usize = 256;

/// The number of pixels of an image by grey value. It is counted once, since images can have millions of pixels, and
/// answers all that follows.
pub(super) struct Histogram {
    counts: [u64; LEVELS],
}

impl Histogram {
    /// Counts the grey values of an image's pixels.
    pub fn from_grey(grey: &[u8]) -> Self {
        let mut counts = [0; LEVELS];
        grey.iter().for_each(|&value| counts[usize::from(value)] += 1);
        Self { counts }
    }

    /// Returns the number of pixels with these values, and the sum of their values.
    pub fn count_and_sum(&self, values: RangeInclusive<u8>) -> (f64, f64) {
        values.fold((0.0, 0.0), |(count, sum), value| {
            let more = self.counts[usize::from(value)] as f64;
            (count + more, sum + more * f64::from(value))
        })
    }

    /// Returns the grey value k at which the variance between the pixels up to k and those above it is greatest. Of
    /// consecutive equally good values, as between black and white, it is the middle one.
    ///
    /// `None` where all pixels have one grey value, which nothing separates.
    pub fn threshold(&self) -> Option<u8> {
        let (total, sum) = self.count_and_sum(0..=u8::MAX);
        let (mut dark, mut dark_sum) = (0.0, 0.0);
        let (mut best, mut first, mut last) = (0.0, 0, 0);
        for (value, &count) in self.counts.iter().enumerate() {
            dark += count as f64;
            dark_sum += value as f64 * count as f64;
            let light = total - dark;
            // A class without pixels has no mean.
            if dark == 0.0 || light == 0.0 {
                continue;
            }
            let apart = dark_sum / dark - (sum - dark_sum) / light;
            let variance = dark * light * apart * apart;
            // Between two grey values that occur, the same number comes out to the last bit.
            if variance > best {
                (best, first, last) = (variance, value, value);
            } else if variance == best && last + 1 == value {
                last = value;
            }
        }
        (best > 0.0).then_some((usize::midpoint(first, last)) as u8)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    fn threshold(grey: &[u8]) -> Option<u8> {
        Histogram::from_grey(grey).threshold()
    }

    #[test]
    fn two_levels_are_parted_in_the_middle() {
        assert_eq!(threshold(&[0, 255]), Some(127));
        assert_eq!(threshold(&[10, 10, 10, 11]), Some(10));
        assert_eq!(threshold(&[100, 200, 200]), Some(149));
        assert_eq!(threshold(&[7; 9]), None);
        assert_eq!(threshold(&[]), None);
    }

    /// The variance within the classes, which is least where that between them is greatest: equation (15).
    fn variance_within(grey: &[u8], tolerance: u8) -> f64 {
        let (dark, light): (Vec<f64>, Vec<f64>) =
            grey.iter().map(|&value| f64::from(value)).partition(|&value| value <= f64::from(tolerance));
        let squares = |class: &[f64]| {
            let mean = class.iter().sum::<f64>() / class.len() as f64;
            class.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>()
        };
        squares(&dark) + squares(&light)
    }

    #[test]
    fn no_other_value_leaves_less_variance_within_the_classes() {
        let mut rng = rng::stream(1, "otsu");
        for _ in 0..60 {
            let dark = rng.random_range(0..120);
            let light = rng.random_range(120..=255);
            let spread = rng.random_range(1..40);
            let grey: Vec<u8> = (0..rng.random_range(2..300))
                .map(|_| {
                    let centre: u8 = if rng.random_bool(0.3) { dark } else { light };
                    centre.saturating_add(rng.random_range(0..spread))
                })
                .collect();
            let Some(selected) = threshold(&grey) else { continue };
            let low = *grey.iter().min().expect("some");
            let high = *grey.iter().max().expect("some");
            let within = variance_within(&grey, selected);
            assert!((low..high).all(|other| within <= variance_within(&grey, other) + 1e-6), "{grey:?}");
        }
    }
}
