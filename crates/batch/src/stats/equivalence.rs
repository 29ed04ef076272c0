//! Tests of equivalence: whether a mean lies within a margin around zero.

use crate::stats::Interval;
use crate::stats::distributions::{t_above, t_quantile_above};

/// The level of the tests.
const LEVEL: f64 = 0.05;

/// The two one-sided t-tests that a mean lies above `-margin` and below `margin`.
///
/// Schuirmann, "A comparison of the two one-sided tests procedure and the power approach for assessing the equivalence
/// of average bioavailability", Journal of Pharmacokinetics and Biopharmaceutics 15, 1987.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equivalence {
    /// The margin, above zero.
    pub margin: f64,
    /// Student's 90 % interval of the mean, which lies within the margin if the tests find equivalence.
    pub interval: Interval,
    /// The larger of the two p-values.
    pub p_value: f64,
}

impl Equivalence {
    /// Tests the mean of this number of values with this standard deviation; `None` for fewer than two, or without
    /// spread.
    pub fn new(mean: f64, deviation: f64, count: u64, margin: f64) -> Option<Self> {
        let degrees = count.checked_sub(1).filter(|&degrees| degrees > 0)? as f64;
        let error = Some(deviation / (count as f64).sqrt()).filter(|&error| error > 0.0 && error.is_finite())?;
        let p_value = [mean + margin, margin - mean].map(|distance| t_above(distance / error, degrees));
        Some(Self {
            margin,
            interval: Interval::about(mean, t_quantile_above(LEVEL, degrees) * error),
            p_value: p_value[0].max(p_value[1]),
        })
    }

    pub fn is_equivalent(&self) -> bool {
        self.p_value <= LEVEL
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::Series;
    use crate::stats::test_support::{assert_close, assert_interval};

    const FEW: [f64; 5] = [3.0, -1.5, 4.0, 2.5, 0.5];
    const SMALL: [f64; 8] = [0.2, -0.3, 0.1, 0.4, -0.2, 0.0, 0.3, -0.1];

    fn equivalence(values: &[f64], margin: f64) -> Option<Equivalence> {
        let series = Series::from_values(values);
        Equivalence::new(series.mean()?, series.standard_deviation()?, series.count(), margin)
    }

    #[test]
    fn tests_and_interval_are_those_of_statsmodels() {
        // `d = DescrStatsW(x); d.ttost_mean(-margin, margin)[0]; d.tconfint_mean(alpha=0.1)`, statsmodels 0.15
        for (values, margin, p_value, [low, high]) in [
            (&FEW[..], 5.0, 0.0141614633201038, [-0.39420718773436314, 3.7942071877343633]),
            (&SMALL[..], 0.5, 0.0006291601169681517, [-0.11407532014744311, 0.21407532014744313]),
            (&SMALL[..], 0.1, 0.2908941172958721, [-0.11407532014744311, 0.21407532014744313]),
        ] {
            let found = equivalence(values, margin).expect("they differ");
            assert_close(found.p_value, p_value);
            assert_interval(Some(found.interval), low, high);
        }
    }

    #[test]
    fn means_are_equivalent_where_their_interval_lies_within_the_margin() {
        for step in 1..60 {
            let margin = f64::from(step) * 0.1;
            for values in [&FEW[..], &SMALL[..]] {
                let found = equivalence(values, margin).expect("they differ");
                let is_within = -margin <= found.interval.low && found.interval.high <= margin;
                assert_eq!(found.is_equivalent(), is_within, "{found:?}");
                let mirrored: Vec<f64> = values.iter().map(|value| -value).collect();
                assert_close(equivalence(&mirrored, margin).expect("they differ").p_value, found.p_value);
            }
        }
    }

    #[test]
    fn numbers_without_spread_are_not_tested() {
        assert_eq!([equivalence(&[1.0], 2.0), equivalence(&[1.0, 1.0], 2.0), equivalence(&[], 2.0)], [None; 3]);
    }
}
