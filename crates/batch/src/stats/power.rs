//! The power of Student's paired t-test: the number of pairs that detects a difference, and the difference that a
//! number of pairs detects.
//!
//! The test is two-sided at 5 %. Its power is exact for differences of pairs that are normal and independent, by the
//! noncentral t distribution (Cohen, "Statistical power analysis for the behavioral sciences", 1988, section 2.3.5).
//! Effects are mean differences in standard deviations of the differences, Cohen's d'z, and above zero.

use crate::stats::distributions::{noncentral_t_two_sided, t_reach};

/// The power for which sample sizes are chosen.
pub const POWER: f64 = 0.8;

/// More pairs than this are not counted.
const MAX_PAIRS: u64 = 1_000_000_000;

/// Returns the probability that the test with this number of pairs detects an effect; `None` for fewer than two pairs.
pub fn paired_power(effect: f64, pairs: u64) -> Option<f64> {
    let degrees = pairs.checked_sub(1).filter(|&degrees| degrees > 0)? as f64;
    Some(noncentral_t_two_sided(t_reach(degrees), degrees, effect * (pairs as f64).sqrt()))
}

/// Returns the least number of pairs, at least two, with which the test detects an effect with a probability of
/// [`POWER`]; `None` beyond a thousand million.
pub fn pairs_for_power(effect: f64) -> Option<u64> {
    let suffices = |pairs| paired_power(effect, pairs).is_some_and(|power| power >= POWER);
    // Doubled until it suffices and then narrowed down by halves, as power rises with the number of pairs.
    let (mut too_few, mut enough) = (1, 2);
    while !suffices(enough) {
        (too_few, enough) = (enough, 2 * enough);
        if too_few >= MAX_PAIRS {
            return None;
        }
    }
    while enough - too_few > 1 {
        let between = too_few + (enough - too_few) / 2;
        if suffices(between) { enough = between } else { too_few = between }
    }
    Some(enough)
}

/// Returns the least effect that the test with this number of pairs detects with a probability of [`POWER`]; `None` for
/// fewer than two pairs.
pub fn detectable_effect(pairs: u64) -> Option<f64> {
    let suffices = |effect: f64| paired_power(effect, pairs).is_some_and(|power| power >= POWER);
    paired_power(1.0, pairs)?;
    let (mut too_small, mut enough) = (0.0, 1.0);
    while !suffices(enough) {
        (too_small, enough) = (enough, 2.0 * enough);
    }
    // Halved until both ends are neighbours among all numbers, or nearly so.
    for _ in 0..60 {
        let between = 0.5 * (too_small + enough);
        if suffices(between) { enough = between } else { too_small = between }
    }
    Some(enough)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::test_support::assert_close;

    #[test]
    fn power_is_that_of_statsmodels() {
        // `statsmodels.stats.power.TTestPower().power(effect, n, 0.05)`, statsmodels 0.15
        for (effect, pairs, expected) in [
            (0.5, 10, 0.2931756065140767),
            (0.5, 34, 0.8077775012792737),
            (0.2, 200, 0.8036666605857853),
            (1.5, 5, 0.7107026739256754),
        ] {
            assert_close(paired_power(effect, pairs).expect("there are pairs"), expected);
        }
        assert_eq!([paired_power(0.5, 0), paired_power(0.5, 1)], [None, None]);
    }

    #[test]
    fn numbers_of_pairs_and_detectable_effects_are_those_of_statsmodels() {
        // `TTestPower().solve_power(effect_size=effect, power=0.8, alpha=0.05)`, statsmodels 0.15, rounded up from
        // 4.22, 33.37, 198.15, 3141.47 and 78490.53
        for (effect, pairs) in [(2.0, 5), (0.5, 34), (0.2, 199), (0.05, 3142), (0.01, 78_491)] {
            assert_eq!(pairs_for_power(effect), Some(pairs), "{effect}");
        }
        // `TTestPower().solve_power(nobs=n, power=0.8, alpha=0.05)`, whose search stops after five or six digits
        for (pairs, expected) in [(2, 11.549889754978167), (5, 1.6819970833), (50, 0.4041829997), (200, 0.1990646595)] {
            let found = detectable_effect(pairs).expect("there are pairs");
            assert!((found - expected).abs() < 1e-5 * expected, "{found} instead of {expected}");
        }
        assert_eq!(detectable_effect(1), None);
        assert_eq!(pairs_for_power(1e-9), None, "as many as nobody runs");
    }

    #[test]
    fn power_grows_with_pairs_and_effect_from_the_level_of_the_test_to_one() {
        for pairs in [2, 3, 10, 400, 1_000_000] {
            let power = |effect: f64| paired_power(effect, pairs).expect("there are pairs");
            // With a million pairs, Student's quantile itself has nine digits.
            assert!((power(0.0) - 0.05).abs() < 1e-8, "{pairs} pairs: {}", power(0.0));
            let mut last = power(0.0);
            for step in 1..=40 {
                let next = power(f64::from(step) / (pairs as f64).sqrt());
                assert!(next >= last && next <= 1.0, "{pairs} pairs, step {step}: {next} after {last}");
                last = next;
            }
            assert!(last > 0.99, "{pairs} pairs: {last}");
        }
        let powers = (2..300).map(|pairs| paired_power(0.3, pairs).expect("there are pairs"));
        assert!(powers.collect::<Vec<_>>().is_sorted());
    }

    #[test]
    fn numbers_of_pairs_and_effects_are_each_others_inverse() {
        for pairs in [3, 7, 60, 1234] {
            let effect = detectable_effect(pairs).expect("there are pairs");
            assert_eq!(pairs_for_power(effect), Some(pairs));
            assert_eq!(pairs_for_power(effect * (1.0 - 1e-9)), Some(pairs + 1));
        }
    }
}
