//! Estimators with their uncertainty, and tests of differences, for figures in papers.
//!
//! Everything here is a plain function of numbers that are finite; units are the caller's. Except in tests of equivalence,
//! every interval is a 95 % confidence interval and every p-value is two-sided. Methods were chosen by the coverage that
//! `cargo bench --bench coverage` measures, on normal and on skewed data.
//!
//! | of | value | interval | test |
//! |---|---|---|---|
//! | a mean, or a mean of paired differences | [`estimate_mean`] | studentised bootstrap, or Student's t | that it is zero |
//! | a mean in constant memory | [`Series`] | Student's t, for quantities with a range on the log or logit scale; valid at any time by [`sequence_interval`] | - |
//! | a difference of two means of unpaired numbers | [`welch_interval`] | Welch's t | - |
//! | a quantile | [`quantile`] | [`quantile_interval`], by order statistics | - |
//! | a rate | `hits / trials` | [`wilson_interval`] | - |
//! | paired answers yes or no | [`PairedAnswers`] | adjusted Wald | McNemar, exact |
//! | the same, several of each subject | - | [`mean_rate_difference_interval`] | [`SignedRanks`] |
//! | paired differences by rank | [`SignedRanks`] | - | Wilcoxon |
//! | times, some of them cut off | [`SurvivalCurve`] | Greenwood, on the log-log scale | - |
//! | means under several conditions | - | - | [`RepeatedMeasures`], that they are equal |
//! | a mean within a margin of zero | - | Student's t, 90 % | [`Equivalence`], two one-sided tests |
//! | the power of a paired test | [`paired_power`], [`pairs_for_power`], [`detectable_effect`] | - | - |
//! | a mean, whenever one looks | - | [`sequence_interval`] | - |
//! | several tests at once | - | - | [`holm()`] |

use serde::{Serialize, Serializer};

mod answers;
mod bootstrap;
mod distributions;
mod equivalence;
mod holm;
mod mean;
mod power;
mod quantiles;
mod repeated_measures;
mod sequence;
mod series;
mod signed_ranks;
mod survival;

pub use answers::{PairedAnswers, mean_rate_difference_interval, wilson_interval};
pub use bootstrap::{RESAMPLES, RESOLUTION, studentised_bootstrap};
pub use distributions::t_reach;
pub(crate) use distributions::{t_quantile_above, t_two_sided};
pub use equivalence::Equivalence;
pub use holm::holm;
pub use mean::{cohens_dz, estimate_mean};
pub use power::{POWER, detectable_effect, paired_power, pairs_for_power};
pub use quantiles::{quantile, quantile_interval};
pub use repeated_measures::RepeatedMeasures;
pub use sequence::{first_look, sequence_half_width, sequence_interval};
pub use series::{Series, UNBOUNDED, welch_interval};
pub use signed_ranks::SignedRanks;
pub use survival::{Lifetime, SurvivalCurve, SurvivalStep};

/// The confidence of every interval.
pub const CONFIDENCE: f64 = 0.95;

/// The numbers of observations for which an interval holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Validity {
    /// One that was fixed before.
    #[default]
    AtFixedSize,
    /// All of them together, so that a rule may stop when enough is known.
    AtAnyTime,
}

/// A 95 % confidence interval, both ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub(crate) fn about(centre: f64, half_width: f64) -> Self {
        Self { low: centre - half_width, high: centre + half_width }
    }

    /// Returns whether zero lies outside.
    pub fn excludes_zero(self) -> bool {
        self.low > 0.0 || self.high < 0.0
    }

    /// Returns both ends of an optional interval.
    pub fn ends(interval: Option<Self>) -> [Option<f64>; 2] {
        [interval.map(|interval| interval.low), interval.map(|interval| interval.high)]
    }

    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

impl Serialize for Interval {
    /// Serialises both ends as an array.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.low, self.high].serialize(serializer)
    }
}

/// The method behind an interval or a p-value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeanMethod {
    StudentsT,
    StudentisedBootstrap,
}

/// A mean with its interval and the test that it is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanEstimate {
    pub mean: f64,
    /// The interval; `None` for fewer than two numbers or without spread.
    pub interval: Option<Interval>,
    /// The probability of a mean at least as far from zero if the true mean were zero; `None` as above.
    pub p_value: Option<f64>,
    /// The method of the interval.
    pub method: MeanMethod,
    /// The method of the p-value: Student's t where zero lies beyond every resample.
    pub p_method: MeanMethod,
}

#[cfg(test)]
mod test_support {
    use super::Interval;

    /// Returns whether two numbers agree to nine digits, or to 1e-12 near zero.
    pub fn close(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-9 * expected.abs() + 1e-12
    }

    pub fn assert_close(found: f64, expected: f64) {
        assert!(close(found, expected), "{found} instead of {expected}");
    }

    pub fn assert_interval(found: Option<Interval>, low: f64, high: f64) {
        let found = found.expect("there is an interval");
        assert!(close(found.low, low) && close(found.high, high), "{found:?} instead of {low} to {high}");
    }
}
