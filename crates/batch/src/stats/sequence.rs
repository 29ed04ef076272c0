//! Intervals that hold at every number of observations at once, so that one may stop when one is sure.

use crate::stats::{Interval, Series};
use wildfire_base::geometry::ops;

/// The number of observations near which the sequence is narrowest.
const NARROWEST_AT: f64 = 30.0;

/// Skewed numbers need more observations before their standard deviation can be trusted.
const GREATEST_SKEWNESS: f64 = 1.0;
const FIRST: usize = 20;
const FIRST_IF_SKEWED: usize = 40;

/// Returns the interval of a mean in an asymptotic confidence sequence: all its intervals together contain the mean with
/// probability 1 - `alpha`, however it was decided to look. `None` for fewer than two numbers, or if all are equal, which
/// shows nothing about others.
///
/// Waudby-Smith, Arbour, Sinha, Kennedy and Ramdas, "Time-uniform central limit theory and asymptotic confidence
/// sequences", Annals of Statistics 52(6), 2024, with the parameter of their section on tuning at 30 observations.
pub fn sequence_interval(series: &Series, alpha: f64) -> Option<Interval> {
    let half_width = sequence_half_width(series.count(), series.standard_deviation()?, alpha)?;
    Some(Interval::about(series.mean()?, half_width))
}

/// Returns half the width of [`sequence_interval`] for so many numbers with this standard deviation; `None` if that is
/// zero or beyond all numbers.
pub fn sequence_half_width(count: u64, deviation: f64, alpha: f64) -> Option<f64> {
    let t = count as f64;
    let twice = -2.0 * ops::ln(alpha);
    let tuned = t * (twice + ops::ln(twice) + 1.0) / NARROWEST_AT;
    let boundary = 2.0 * (tuned + 1.0) / (t * tuned) * ops::ln((tuned + 1.0).sqrt() / alpha);
    (deviation > 0.0 && deviation.is_finite()).then(|| deviation * boundary.sqrt())
}

/// Returns the number of observations from which on [`sequence_interval`] may be trusted for numbers that begin like
/// these: 20, or 40 if the first 20 are skewed. `None` for fewer than 20.
pub fn first_look(values: &[f64]) -> Option<usize> {
    let first = values.get(..FIRST)?;
    let mean = first.iter().sum::<f64>() / FIRST as f64;
    let deviations = first.iter().map(|value| value - mean);
    let second = deviations.clone().map(|deviation| deviation * deviation).sum::<f64>() / FIRST as f64;
    let third = deviations.map(|deviation| deviation * deviation * deviation).sum::<f64>() / FIRST as f64;
    // The moment estimator of skewness; of equal numbers it is none, which is not trusted either.
    let skewness = third / (second * second.sqrt());
    Some(if skewness.abs() <= GREATEST_SKEWNESS { FIRST } else { FIRST_IF_SKEWED })
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::stats::test_support::assert_interval;
    use wildfire_base::rng;

    #[test]
    fn interval_is_that_of_the_formula() {
        // m +- s sqrt(2 (t r + 1) / (t^2 r) ln(sqrt(t r + 1) / alpha)) in Python, r = (-2 ln alpha + ln(-2 ln alpha) + 1) / 30
        let values: Vec<f64> = (0..20).map(f64::from).collect();
        assert_interval(sequence_interval(&Series::from_values(&values), 0.05), 5.47259780814468, 13.52740219185532);
        assert_eq!(sequence_interval(&Series::from_values(&[3.0; 50]), 0.05), None);
        assert_eq!(sequence_interval(&Series::from_values(&[3.0]), 0.05), None);
    }

    #[test]
    fn skewed_numbers_wait_longer() {
        let symmetric: Vec<f64> = (0..30).map(f64::from).collect();
        let skewed: Vec<f64> = (0..30).map(|i| f64::from(u8::from(i % 10 == 0))).collect();
        let found = [&symmetric[..], &skewed, &symmetric[..19], &[2.0; 20]].map(first_look);
        assert_eq!(found, [Some(20), Some(40), None, Some(40)]);
    }

    /// Sums of four uniform numbers, of mean zero: looked at from 20 to 400 every 10.
    #[test]
    fn looking_often_seldom_misleads() {
        let random = &mut rng::stream(1, "sequence/test");
        let mut misled = 0;
        for _ in 0..400 {
            let mut series = Series::default();
            misled += u32::from((1..=400).any(|t| {
                series.add((0..4).map(|_| random.random::<f64>()).sum::<f64>() - 2.0);
                t >= 20 && t % 10 == 0 && sequence_interval(&series, 0.05).is_some_and(Interval::excludes_zero)
            }));
        }
        // 20 of 400 are allowed; Student's interval would mislead in more than 80.
        assert!(misled <= 20, "{misled} of 400");
    }
}
