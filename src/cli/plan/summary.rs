//! The results of a planner over all goals, in a few numbers.

use serde::Serialize;

use crate::cli::plan::attempts::Attempt;
use crate::cli::plan::drive::Drive;
use crate::planning::TruckPlannerKind;

/// Goals of each field that `first_lower_bound_ratio_mean` counts: comparisons with planners that take seconds for a goal
/// can afford no more.
pub const FIRST_GOALS: usize = 3;

/// Figures of one planner. Times are of all queries, the rest is of the paths that were found.
///
/// A quantile is the value of the rank nearest to it.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    pub planner: TruckPlannerKind,
    pub goals: usize,
    pub reached: usize,
    pub cpu_query_median_s: f64,
    pub cpu_query_p95_s: f64,
    pub cpu_query_max_s: f64,
    /// Over the fields.
    pub cpu_build_median_s: f64,
    pub lower_bound_ratio_mean: Option<f64>,
    /// Over the first three goals of each field.
    pub first_lower_bound_ratio_mean: Option<f64>,
    pub min_clearance_median_m: Option<f64>,
    pub cusps_mean: Option<f64>,
    pub drive_mean_s: Option<f64>,
    /// Paths with something wrong.
    #[serde(rename = "offences")]
    pub violations: usize,
}

impl Summary {
    /// The figures of a planner that was asked at least once.
    pub fn new(planner: TruckPlannerKind, attempts: &[Attempt]) -> Self {
        let own: Vec<&Attempt> = attempts.iter().filter(|attempt| attempt.planner == planner).collect();
        let drives: Vec<&Drive> = own.iter().filter_map(|attempt| attempt.drive.as_ref().ok()).collect();
        let queries = sorted(own.iter().map(|attempt| attempt.query.as_secs_f64()));
        let builds = own.iter().filter(|attempt| attempt.goal == 0).map(|attempt| attempt.build.as_secs_f64());
        let first = own.iter().filter(|attempt| attempt.goal < FIRST_GOALS);
        let first = first.filter_map(|attempt| attempt.drive.as_ref().ok()?.lower_bound_ratio);
        Self {
            planner,
            goals: own.len(),
            reached: drives.len(),
            cpu_query_median_s: quantile(&queries, 0.5).unwrap_or(0.0),
            cpu_query_p95_s: quantile(&queries, 0.95).unwrap_or(0.0),
            cpu_query_max_s: quantile(&queries, 1.0).unwrap_or(0.0),
            cpu_build_median_s: quantile(&sorted(builds), 0.5).unwrap_or(0.0),
            lower_bound_ratio_mean: mean(drives.iter().filter_map(|drive| drive.lower_bound_ratio)),
            first_lower_bound_ratio_mean: mean(first),
            min_clearance_median_m: quantile(&sorted(drives.iter().map(|drive| drive.min_clearance_m)), 0.5),
            cusps_mean: mean(drives.iter().map(|drive| drive.cusps.into())),
            drive_mean_s: mean(drives.iter().map(|drive| drive.drive_s)),
            violations: drives.iter().filter(|drive| drive.violation.is_some()).count(),
        }
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rank is a place in the list")]
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[(last as f64 * share).round() as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_of_the_list() {
        let values = sorted([5.0, 1.0, 4.0, 2.0, 3.0].into_iter());
        assert_eq!([0.0, 0.5, 0.95, 1.0].map(|share| quantile(&values, share)), [1.0, 3.0, 5.0, 5.0].map(Some));
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(mean([1.0, 2.0].into_iter()), Some(1.5));
        assert_eq!(mean(std::iter::empty()), None);
    }
}
