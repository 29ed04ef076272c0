//! Running mean, standard deviation and confidence interval of numbers, and of the difference of two means.
//!
//! The interval of the mean is Student's, with n - 1 degrees of freedom (Student, "The probable error of a mean",
//! Biometrika 6, 1908), on the scale of the numbers or on one that keeps the interval in the range of a quantity.

use crate::stats::distributions::t_reach;
use crate::stats::sequence::sequence_interval;
use crate::stats::{CONFIDENCE, Interval, Validity};
use wildfire_base::geometry::ops;

/// The range of a difference.
pub const UNBOUNDED: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Running mean and spread of a series of numbers, in one pass and constant memory.
///
/// Welford's update ("Note on a method for calculating corrected sums of squares and products", Technometrics 4,
/// 1962), which does not lose the spread of numbers that are large beside it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Series {
    count: u64,
    mean: f64,
    squares: f64,
    sum: f64,
    smallest: f64,
    largest: f64,
    /// Counts of the smallest number and of the largest.
    at_ends: [u64; 2],
}

impl Series {
    pub fn from_values(values: &[f64]) -> Self {
        let mut series = Self::default();
        values.iter().for_each(|&value| series.add(value));
        series
    }

    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
        self.sum += value;
        if self.count == 1 || value < self.smallest {
            self.smallest = value;
            self.at_ends[0] = 0;
        }
        if self.count == 1 || value > self.largest {
            self.largest = value;
            self.at_ends[1] = 0;
        }
        self.at_ends[0] += u64::from(value == self.smallest);
        self.at_ends[1] += u64::from(value == self.largest);
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// Returns the largest number; `None` for an empty series.
    pub fn largest(&self) -> Option<f64> {
        (self.count > 0).then_some(self.largest)
    }

    /// Returns the mean; `None` for an empty series.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Returns the standard deviation of the population, estimated from the sample (divisor n - 1); `None` for fewer
    /// than two.
    pub fn standard_deviation(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.squares / (self.count - 1) as f64).sqrt())
    }

    /// Returns the standard error of the mean; `None` for fewer than two.
    pub fn standard_error(&self) -> Option<f64> {
        Some(self.standard_deviation()? / (self.count as f64).sqrt())
    }

    /// Returns Student's 95 % confidence interval of the mean; `None` for fewer than two. If all are equal its width is
    /// zero, which is right for a frozen format only: elsewhere [`Self::mean_interval_within`] has none then.
    pub fn mean_interval(&self) -> Option<Interval> {
        let error = self.standard_error()?;
        Some(Interval::about(self.mean, t_reach((self.count - 1) as f64) * error))
    }

    /// Returns the 95 % confidence interval of the mean of a quantity from `min` to `max`, which never leaves that
    /// range; differences are [`UNBOUNDED`]. `None` for fewer than two, or if all are equal: a few equal numbers do not
    /// show how much others would vary. `None` too if more than half of the numbers are an end of the range: the delta
    /// method needs an error that is small beside the distance of the mean from that end.
    ///
    /// Student's interval on the log scale of the distance from `min`, or on the logit scale if `max` is finite too,
    /// with the standard error by the delta method (Oehlert, "A note on the delta method", The American Statistician 46,
    /// 1992). The upper end for two numbers without a finite `max` is that of Student's plain interval: on the log scale
    /// it can be 300,000 times the mean. Without a finite `min` the whole interval is the plain one.
    pub fn mean_interval_within(&self, range: (f64, f64)) -> Option<Interval> {
        self.mean_interval_for(Validity::AtFixedSize, range)
    }

    /// Returns [`Self::mean_interval_within`], or an interval made in the same way from that of a confidence sequence.
    pub fn mean_interval_for(&self, validity: Validity, (min, max): (f64, f64)) -> Option<Interval> {
        let plain = match validity {
            // Equal numbers say nothing about numbers that have not been seen.
            Validity::AtFixedSize => self.mean_interval().filter(|plain| plain.low < plain.high)?,
            Validity::AtAnyTime => sequence_interval(self, 1.0 - CONFIDENCE)?,
        };
        let reach = plain.high - self.mean;
        let below = self.mean - min;
        let above = max - self.mean;
        let [at_least, at_most] = [(self.smallest, min), (self.largest, max)].map(|(value, end)| value == end);
        let is_mostly = |is_at_end: bool, numbers: u64| is_at_end && 2 * numbers > self.count;
        if is_mostly(at_least, self.at_ends[0]) || is_mostly(at_most, self.at_ends[1]) {
            return None;
        }
        // With numbers from outside the range there is nothing to keep.
        if below <= 0.0 || above <= 0.0 || below.is_infinite() {
            return Some(plain);
        }
        // Logarithms where only the lower end is bounded, and the logarithm of odds where both are.
        if above.is_infinite() {
            let factor = ops::exp(reach / below);
            let high = if self.count == 2 { plain.high } else { min + below * factor };
            return Some(Interval { low: min + below / factor, high });
        }
        let width = max - min;
        let factor = ops::exp(reach * width / (below * above));
        // The share of the range at the mean's odds times a factor, written so that no infinity is divided by another.
        let end = |odds: f64| min + width / (1.0 + 1.0 / odds);
        Some(Interval { low: end(below / above / factor), high: end(below / above * factor) })
    }
}

/// Returns the interval of the mean of `b` minus the mean of `a`, for unequal variances; `None` if either has fewer
/// than two numbers, or neither has any spread.
///
/// Welch, "The generalization of Student's problem when several different population variances are involved",
/// Biometrika 34, 1947.
pub fn welch_interval(a: &Series, b: &Series) -> Option<Interval> {
    let [(error_a, degrees_a), (error_b, degrees_b)] = [squared_error(a)?, squared_error(b)?];
    let error = error_a + error_b;
    if error == 0.0 {
        return None;
    }
    let degrees = error * error / (error_a * error_a / degrees_a + error_b * error_b / degrees_b);
    Some(Interval::about(b.mean()? - a.mean()?, t_reach(degrees) * error.sqrt()))
}

/// Returns the square of the standard error of the mean, and its degrees of freedom.
fn squared_error(series: &Series) -> Option<(f64, f64)> {
    let deviation = series.standard_deviation()?;
    Some((deviation * deviation / series.count() as f64, (series.count() - 1) as f64))
}

#[cfg(test)]
mod tests {
    use rand::{Rng, RngExt};

    use super::*;
    use crate::stats::test_support::assert_interval;
    use wildfire_base::rng;

    #[test]
    fn report_2024_table_gives_its_mean_and_interval() {
        // Ratios of intact obstacles of the five published runs.
        let published = Series::from_values(&[67.0 / 237.0, 44.0 / 235.0, 79.0 / 238.0, 85.0 / 234.0, 79.0 / 228.0]);
        assert!((published.mean().expect("five values") - 0.302).abs() < 5e-4);
        let deviation = published.standard_deviation().expect("five values");
        assert!((deviation - 0.071).abs() < 5e-4);
        // `scipy.stats.t.interval(0.95, 4, numpy.mean(x), scipy.stats.sem(x))`
        assert_interval(published.mean_interval(), 0.21415017353784147, 0.39049235803071936);
    }

    #[test]
    fn one_value_has_a_mean_and_no_spread() {
        assert_eq!(Series::from_values(&[]).mean(), None);
        let one = Series::from_values(&[4.0]);
        assert_eq!((one.mean(), one.standard_deviation(), one.mean_interval()), (Some(4.0), None, None));
    }

    #[test]
    fn interval_in_a_range_is_that_of_the_scale() {
        let few = Series::from_values(&[1.0, 2.0, 9.0]);
        let factor = ops::exp((few.mean_interval().expect("three values").high - 4.0) / 4.0);
        assert_interval(few.mean_interval_within((0.0, f64::INFINITY)), 4.0 / factor, 4.0 * factor);
        let shares = Series::from_values(&[0.0, 0.1, 0.5]);
        let reach = (shares.mean_interval().expect("three values").high - 0.2) / (0.2 * 0.8);
        let end = |sign: f64| 1.0 / (1.0 + ops::exp(-(ops::ln(0.25) + sign * reach)));
        assert_interval(shares.mean_interval_within((0.0, 1.0)), end(-1.0), end(1.0));
    }

    #[test]
    fn intervals_stay_in_the_range_and_hold_the_mean_however_few_the_numbers() {
        let share = (0.0, 1.0);
        let positive = (0.0, f64::INFINITY);
        for (numbers, range) in [
            (&[0.0, 1.0][..], share),
            (&[0.0, 1e-9], share),
            (&[1.0, 1.0 - 1e-9], share),
            (&[0.0, 0.0, 0.1, 0.4], share),
            (&[1.0, 0.9, 0.7], share),
            (&[0.0, 2000.0], positive),
            (&[0.0, 0.5, 5.0], positive),
            (&[26.0, 8000.0], (0.0, 10_000.0)),
        ] {
            let series = Series::from_values(numbers);
            let mean = series.mean().expect("numbers");
            let plain = series.mean_interval().expect("two numbers");
            let Interval { low, high } = series.mean_interval_within(range).expect("two numbers");
            assert!(range.0 < low && low < mean && mean < high && high <= range.1, "{numbers:?}: {low} to {high}");
            assert!(plain.low < range.0 || plain.high > range.1, "{numbers:?}");
        }
        assert_eq!(Series::from_values(&[0.3]).mean_interval_within(share), None);
        let points = Series::from_values(&[-3.0, 5.0]);
        assert_eq!(points.mean_interval_within((f64::NEG_INFINITY, f64::INFINITY)), points.mean_interval());
    }

    #[test]
    fn numbers_that_are_equal_or_mostly_an_end_of_the_range_have_no_interval() {
        let within = |numbers: &[f64], range| Series::from_values(numbers).mean_interval_within(range);
        let share = (0.0, 1.0);
        let positive = (0.0, f64::INFINITY);
        for (numbers, range) in [
            (&[0.0, 0.0][..], share),
            (&[0.3, 0.3, 0.3], share),
            (&[12.0; 5], positive),
            (&[0.0, 0.0, 0.0, 5.0], positive),
            (&[7.0, 0.0, 0.0], positive),
            (&[1.0, 0.7, 1.0], share),
        ] {
            assert_eq!(within(numbers, range), None, "{numbers:?}");
        }
        // Half of them is not most of them, and the smallest are not at an end.
        assert!(within(&[0.0, 0.0, 0.2, 0.4], share).is_some() && within(&[0.1, 0.1, 0.1, 0.4], share).is_some());
        assert_eq!((within(&[4.0; 9], UNBOUNDED), within(&[0.0, 0.0, 0.0, 1.0], UNBOUNDED).is_some()), (None, true));
    }

    #[test]
    fn intervals_in_a_range_hold_the_mean_of_skewed_numbers_more_often_than_students() {
        // Exponential numbers: of 1000 samples 950 should hold the mean 1; with five numbers some 930 do.
        let sample = |trial: u64| {
            let random = &mut rng::stream(trial, "test/range");
            let uniform = |bits: u64| ((bits >> 11) as f64 + 1.0) / (1_u64 << 53) as f64;
            Series::from_values(&[(); 5].map(|()| -ops::ln(uniform(random.next_u64()))))
        };
        let covered = |interval: fn(&Series) -> Option<Interval>| {
            let holds = |trial: &u64| interval(&sample(*trial)).is_some_and(|interval| interval.contains(1.0));
            (0..1000).filter(holds).count()
        };
        let within = covered(|it| it.mean_interval_within((0.0, f64::INFINITY)));
        let plain = covered(Series::mean_interval);
        assert!((905..=960).contains(&within) && within > plain + 20, "{within} and {plain} of 1000");
    }

    #[test]
    fn intervals_that_are_valid_at_any_time_are_wider_and_keep_the_range() {
        let mut random = rng::stream(5, "stats/any time");
        for range in [UNBOUNDED, (0.0, f64::INFINITY), (0.0, 1.0)] {
            let values: Vec<f64> = (0..30).map(|_| random.random_range(0.0..1.0)).collect();
            let series = Series::from_values(&values);
            let at = |validity| series.mean_interval_for(validity, range).expect("thirty numbers");
            let (fixed, any_time) = (at(Validity::AtFixedSize), at(Validity::AtAnyTime));
            assert!(any_time.low < fixed.low && fixed.high < any_time.high, "{fixed:?} {any_time:?}");
            assert!(range.0 <= any_time.low && any_time.high <= range.1, "{any_time:?}");
        }
        let mean = Series::from_values(&[1.0, 2.0, 4.0]);
        assert_eq!(mean.mean_interval_for(Validity::AtAnyTime, UNBOUNDED), sequence_interval(&mean, 1.0 - CONFIDENCE));
    }

    #[test]
    fn spread_survives_a_large_offset() {
        let shifted = Series::from_values(&[1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0]);
        assert!((shifted.standard_deviation().expect("three values") - 1.0).abs() < 1e-6);
        assert_eq!(shifted.sum(), 3e9 + 6.0);
    }

    #[test]
    fn interval_of_a_difference_is_that_of_scipy() {
        // `scipy.stats.ttest_ind(b, a, equal_var=False).confidence_interval()`
        let a = Series::from_values(&[0.28, 0.19, 0.33, 0.36, 0.35]);
        let b = Series::from_values(&[0.41, 0.22, 0.30, 0.37, 0.52, 0.48, 0.29, 0.44]);
        assert_interval(welch_interval(&a, &b), -0.029017419451460427, 0.18251741945146027);
    }

    #[test]
    fn samples_without_spread_have_no_interval() {
        let constant = Series::from_values(&[1.0, 1.0]);
        assert_eq!(welch_interval(&constant, &constant), None);
        assert_eq!(welch_interval(&constant, &Series::from_values(&[2.0])), None);
    }
}
