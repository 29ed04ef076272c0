//! Medians and other quantiles.

use crate::stats::distributions::binomial_at_most;
use crate::stats::{CONFIDENCE, Interval};

/// Returns the quantile of a sorted sample at `share` from 0 to 1; `None` for an empty sample.
///
/// Linear between order statistics (Hyndman, Fan, "Sample quantiles in statistical packages", The American Statistician
/// 50, 1996, definition 7), as NumPy, R and spreadsheets have it by default.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let below = place.floor() as usize;
    let above = sorted.get(below + 1).unwrap_or(&sorted[below]);
    Some(sorted[below] + (above - sorted[below]) * (place - below as f64))
}

/// Returns the interval of the population's quantile from two order statistics, for any distribution; it is
/// conservative, and more so with ties.
///
/// `None` if the sample is too small for an end to exist: fewer than 6 numbers for a median.
/// Conover, "Practical nonparametric statistics", 1999, section 3.2.
pub fn quantile_interval(sorted: &[f64], share: f64) -> Option<Interval> {
    let n = sorted.len() as u64;
    let outside = 0.5 * (1.0 - CONFIDENCE);
    // The quantile lies below the k-th smallest with the probability of fewer than k numbers below it.
    let low = last_rank(n, |rank| binomial_at_most(rank - 1, n, share) <= outside)?;
    let high = n + 1 - last_rank(n, |rank| binomial_at_most(rank - 1, n, 1.0 - share) <= outside)?;
    Some(Interval { low: sorted[low as usize - 1], high: sorted[high as usize - 1] })
}

/// Finds the largest rank from 1 to `n` that passes, where all below one that passes do too.
fn last_rank(n: u64, passes: impl Fn(u64) -> bool) -> Option<u64> {
    let (mut passed, mut failed) = (0, n + 1);
    while failed - passed > 1 {
        let middle = passed + (failed - passed) / 2;
        if passes(middle) {
            passed = middle;
        } else {
            failed = middle;
        }
    }
    (passed > 0).then_some(passed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::{assert_close, assert_interval};

    const INTERVALS: [(u32, f64, f64, f64); 6] = [
        (6, 0.5, 0.0, 25.0),
        (30, 0.5, 81.0, 400.0),
        (200, 0.5, 7225.0, 12996.0),
        (199, 0.5, 7225.0, 12769.0),
        (100, 0.9, 6889.0, 9025.0),
        (200, 0.05, 9.0, 256.0),
    ];

    const QUANTILES: [(u32, f64, f64); 7] = [
        (1, 0.5, 0.0),
        (4, 0.5, 2.5),
        (11, 0.25, 6.5),
        (30, 0.9, 681.3000000000001),
        (200, 0.025, 24.775000000000006),
        (7, 0.0, 0.0),
        (7, 1.0, 36.0),
    ];

    fn squares(n: u32) -> Vec<f64> {
        (0..n).map(|i| f64::from(i * i)).collect()
    }

    #[test]
    fn quantiles_are_those_of_numpy() {
        // `numpy.quantile(numpy.arange(n) ** 2.0, share)`
        for (n, share, expected) in QUANTILES {
            assert_close(quantile(&squares(n), share).expect("not empty"), expected);
        }
    }

    #[test]
    fn intervals_are_those_of_scipy() {
        // `scipy.stats.quantile_test(numpy.arange(n) ** 2.0, p=share).confidence_interval(0.95)`
        for (n, share, low, high) in INTERVALS {
            assert_interval(quantile_interval(&squares(n), share), low, high);
        }
    }

    #[test]
    fn too_few_numbers_have_no_interval() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile_interval(&[], 0.5), None);
        assert_eq!(quantile_interval(&squares(5), 0.5), None);
        assert!(quantile_interval(&squares(6), 0.5).is_some());
        assert_eq!(quantile_interval(&squares(50), 0.05), None);
    }
}
