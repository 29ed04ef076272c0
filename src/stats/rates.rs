//! Rates: how often something happens.

use crate::stats::Interval;
use crate::stats::distributions::normal_reach;

/// Returns the interval of the rate of `hits` in `trials`, within 0 to 1; `None` without trials.
///
/// Wilson, "Probable inference, the law of succession, and statistical inference", JASA 22, 1927: all rates that the
/// normal test with their own standard error does not refuse.
pub fn wilson_interval(hits: u64, trials: u64) -> Option<Interval> {
    if trials == 0 {
        return None;
    }
    let (n, rate) = (trials as f64, hits as f64 / trials as f64);
    let z = normal_reach();
    let weight = z * z / n;
    let centre = (rate + 0.5 * weight) / (1.0 + weight);
    let half_width = z * (rate * (1.0 - rate) / n + 0.25 * weight / n).sqrt() / (1.0 + weight);
    let low = if hits == 0 { 0.0 } else { centre - half_width };
    let high = if hits == trials { 1.0 } else { centre + half_width };
    Some(Interval { low, high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::assert_interval;

    const CASES: [(u64, u64, f64, f64); 7] = [
        (0, 30, 0.0, 0.11351339317396875),
        (1, 30, 0.005908590381612441, 0.16670390991409173),
        (15, 30, 0.3315412564053377, 0.6684587435946623),
        (30, 30, 0.8864866068260312, 1.0),
        (3, 5, 0.23072428127601297, 0.8823792257673521),
        (187, 200, 0.891980920700931, 0.9616236453508471),
        (1, 100000, 1.765247730378316e-06, 5.664709659040965e-05),
    ];

    #[test]
    fn intervals_are_those_of_scipy() {
        // `scipy.stats.binomtest(k, n).proportion_ci(method="wilson")`
        for (hits, trials, low, high) in CASES {
            assert_interval(wilson_interval(hits, trials), low, high);
        }
    }

    #[test]
    fn rate_of_nothing_has_no_interval() {
        assert_eq!(wilson_interval(0, 0), None);
    }
}
