//! Mean, standard deviation and confidence interval of numbers that come one by one, and of the difference of two such
//! means.
//!
//! The interval of the mean is Student's, with n - 1 degrees of freedom (Student, "The probable error of a mean",
//! Biometrika 6, 1908).

use crate::stats::Interval;
use crate::stats::distributions::t_reach;

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
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// Returns the mean; `None` of an empty series.
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }

    /// Returns the standard deviation of the population, estimated from the sample (divisor n - 1); `None` of fewer
    /// than two.
    pub fn standard_deviation(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.squares / (self.count - 1) as f64).sqrt())
    }

    /// Returns the standard deviation of the mean, estimated from the sample; `None` of fewer than two.
    pub fn standard_error(&self) -> Option<f64> {
        Some(self.standard_deviation()? / (self.count as f64).sqrt())
    }

    /// Returns Student's 95 % confidence interval of the mean; `None` of fewer than two.
    pub fn mean_interval(&self) -> Option<Interval> {
        let error = self.standard_error()?;
        Some(Interval::about(self.mean, t_reach((self.count - 1) as f64) * error))
    }
}

/// Returns the interval of the mean of `b` less the mean of `a`, whatever their spreads; `None` if either has fewer
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
    use super::*;
    use crate::stats::test_support::assert_interval;

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
