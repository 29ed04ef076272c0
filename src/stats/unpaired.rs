//! The difference between the means of two samples that are not paired.

use crate::stats::distributions::t_reach;
use crate::stats::{Interval, Series};

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
    fn interval_is_that_of_scipy() {
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
