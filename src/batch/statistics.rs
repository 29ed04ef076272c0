//! Mean, standard deviation and confidence interval of a quantity over the runs of a batch.
//!
//! The interval of the mean is Student's, with n - 1 degrees of freedom (Student, "The probable error of a mean",
//! Biometrika 6, 1908). Formulas of the distribution are quoted from Abramowitz and Stegun, "Handbook of Mathematical
//! Functions", 1964, chapter 26.

use std::f64::consts::PI;

use crate::geometry::ops;

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
}

impl Series {
    pub fn add(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
        self.sum += value;
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// `None` of an empty series.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Standard deviation of the population, estimated from the sample (divisor n - 1); `None` of fewer than two.
    pub fn standard_deviation(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.squares / (self.count - 1) as f64).sqrt())
    }

    /// Half the width of the 95 % confidence interval of the mean; `None` of fewer than two.
    pub fn half_interval_95(&self) -> Option<f64> {
        let deviation = self.standard_deviation()?;
        Some(student_t_quantile_975(self.count - 1) * deviation / (self.count as f64).sqrt())
    }
}

/// Above this many degrees of freedom the expansion in 1/n is exact to the last digits of an f64.
const EXPANSION_FROM: u64 = 2000;

/// The 0.975 quantile of Student's t distribution.
fn student_t_quantile_975(degrees: u64) -> f64 {
    if degrees >= EXPANSION_FROM {
        return expanded_quantile_975(degrees as f64);
    }
    let (mut low, mut high) = (1.9, 12.8);
    while high - low > 1e-13 * high {
        let middle = 0.5 * (low + high);
        if central_probability(middle, degrees) < 0.95 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Probability that |t| is at most `t`: the finite sums 26.7.3 (odd) and 26.7.4 (even degrees of freedom).
fn central_probability(t: f64, degrees: u64) -> f64 {
    let root = (degrees as f64).sqrt();
    let theta = ops::atan(t / root);
    let cosine = root / (degrees as f64 + t * t).sqrt();
    let sine = t / (degrees as f64 + t * t).sqrt();
    let odd = degrees % 2 == 1;
    let (mut term, first) = if odd { (cosine, 3) } else { (1.0, 2) };
    let mut sum = if degrees == 1 { 0.0 } else { term };
    for k in (first..degrees.saturating_sub(1)).step_by(2) {
        term *= cosine * cosine * (k - 1) as f64 / k as f64;
        sum += term;
    }
    if odd { (theta + sine * sum) * 2.0 / PI } else { sine * sum }
}

/// The quantile as an expansion about the normal distribution's, in powers of 1 / degrees: 26.7.5.
fn expanded_quantile_975(degrees: f64) -> f64 {
    const NORMAL_975: f64 = 1.959_963_984_540_054;
    let x = NORMAL_975;
    let x2 = x * x;
    let g1 = (x2 + 1.0) * x / 4.0;
    let g2 = ((5.0 * x2 + 16.0) * x2 + 3.0) * x / 96.0;
    let g3 = (((3.0 * x2 + 19.0) * x2 + 17.0) * x2 - 15.0) * x / 384.0;
    x + (g1 + (g2 + g3 / degrees) / degrees) / degrees
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    fn series(values: &[f64]) -> Series {
        let mut series = Series::default();
        values.iter().for_each(|&value| series.add(value));
        series
    }

    #[test]
    fn published_quantiles_are_met() {
        // Abramowitz and Stegun, table 26.10, column A = 0.95, and the closed forms for 1 and 2 degrees.
        let closed = [(1, ops::tan(0.475 * PI)), (2, 0.95 * (2.0 / (1.0 - 0.95 * 0.95_f64)).sqrt())];
        for (degrees, expected) in closed {
            assert!((student_t_quantile_975(degrees) - expected).abs() < 1e-9, "{degrees}");
        }
        let table = [(3, 3.182), (4, 2.776), (5, 2.571), (10, 2.228), (30, 2.042), (60, 2.000), (120, 1.980)];
        for (degrees, expected) in table {
            assert!((student_t_quantile_975(degrees) - expected).abs() < 5.1e-4, "{degrees}");
        }
    }

    #[test]
    fn quantiles_fall_towards_the_normal_one_and_do_not_jump_where_the_formula_changes() {
        let mut last = f64::INFINITY;
        for degrees in (1..200).chain([500, 1000, 1999, 2000, 2001, 10_000_000]) {
            let quantile = student_t_quantile_975(degrees);
            assert!(quantile < last && quantile > 1.959_963_984, "{degrees}");
            last = quantile;
        }
        let exact = student_t_quantile_975(EXPANSION_FROM - 1);
        assert!((exact - expanded_quantile_975((EXPANSION_FROM - 1) as f64)).abs() < 1e-11);
    }

    #[test]
    fn probability_is_a_distribution() {
        for degrees in 1..50 {
            assert_eq!(central_probability(0.0, degrees), 0.0);
            assert!((central_probability(1e9, degrees) - 1.0).abs() < 1e-8);
            assert!(central_probability(1.0, degrees) < central_probability(1.1, degrees));
        }
        assert!((central_probability(1.0, 1) - ops::atan(1.0) / FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn report_2024_table_gives_its_mean_and_interval() {
        // Ratios of intact obstacles of the five published runs; interval computed with t = 2.776445.
        let published = series(&[67.0 / 237.0, 44.0 / 235.0, 79.0 / 238.0, 85.0 / 234.0, 79.0 / 228.0]);
        assert!((published.mean().expect("five values") - 0.302).abs() < 5e-4);
        let deviation = published.standard_deviation().expect("five values");
        assert!((deviation - 0.071).abs() < 5e-4);
        let half = published.half_interval_95().expect("five values");
        assert!((half - 2.776_445_105 * deviation / 5.0_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn one_value_has_a_mean_and_no_spread() {
        assert_eq!(series(&[]).mean(), None);
        let one = series(&[4.0]);
        assert_eq!((one.mean(), one.standard_deviation(), one.half_interval_95()), (Some(4.0), None, None));
    }

    #[test]
    fn spread_survives_a_large_offset() {
        let shifted = series(&[1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0]);
        assert!((shifted.standard_deviation().expect("three values") - 1.0).abs() < 1e-6);
        assert_eq!(shifted.sum(), 3e9 + 6.0);
    }
}
