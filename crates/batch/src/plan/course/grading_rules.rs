//! The marks of a course: points for tests, and a table of scores and their points.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use wildfire_planning::PlannerName;

/// The most rows of the table of marks, and the most baselines.
const MAX_MARKS: usize = 100;
const MAX_BASELINES: usize = 10;

/// The table `[grading]` of a rules file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct GradingRules {
    /// The metric whose mean over all runs is the score of an entry; one of those of `wildfire rank`.
    pub metric: String,
    /// Scores in rising order, each with its points: `[[40, 0], [110, 30]]`. Points are linear between two rows, and those of
    /// the first and the last row beyond them.
    pub marks: Vec<[f64; 2]>,
    /// Entries to beat: names of built-in planners, or entry files beside this file.
    pub baselines: Vec<String>,
    /// Points for beating some of them, by name, in place of `points.baseline`.
    pub baseline_points: BTreeMap<String, f64>,
    /// The most expansions per run, averaged over all runs.
    pub max_expansions: Option<f64>,
    pub points: TestPoints,
}

/// Points of the tests that are passed or failed.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TestPoints {
    /// The entry's file is valid.
    pub valid: f64,
    /// All runs finished, and no query crashed, timed out or had an answer that is not valid.
    pub no_crash: f64,
    /// The audit of all runs found no violation.
    pub no_violation: f64,
    /// The score is better than that of a baseline, by whatever amount; points for each of them.
    pub baseline: f64,
    /// The effort is at most `max_expansions`.
    pub effort: f64,
}

impl Default for GradingRules {
    fn default() -> Self {
        Self {
            metric: "saved".into(),
            marks: Vec::new(),
            baselines: Vec::new(),
            baseline_points: BTreeMap::new(),
            max_expansions: None,
            points: TestPoints::default(),
        }
    }
}

impl Default for TestPoints {
    fn default() -> Self {
        Self { valid: 10.0, no_crash: 10.0, no_violation: 10.0, baseline: 10.0, effort: 10.0 }
    }
}

/// What is wrong with the table `[grading]`: a key of it, and a sentence.
pub(super) struct GradingFault {
    pub key: &'static str,
    pub message: String,
}

impl GradingRules {
    /// Refuses values that give no points.
    pub(super) fn check(&self) -> Result<(), GradingFault> {
        let TestPoints { valid, no_crash, no_violation, baseline, effort } = self.points;
        let all = [valid, no_crash, no_violation, baseline, effort];
        if all.iter().chain(self.baseline_points.values()).any(|points| !(0.0..=1e6).contains(points)) {
            return fault("points", "expected points from 0 to 1000000");
        }
        if let Some(name) = self.baseline_points.keys().find(|name| !self.baselines.contains(name)) {
            return fault("baseline_points", &format!("`{name}` is not one of the baselines"));
        }
        // Points between two marks are interpolated, which needs an order.
        let is_rising = self.marks.windows(2).all(|rows| rows[0][0] < rows[1][0]);
        let is_valid = self.marks.iter().all(|[score, points]| score.is_finite() && (0.0..=1e6).contains(points));
        if !is_rising || !is_valid || self.marks.len() > MAX_MARKS {
            let message = format!("expected at most {MAX_MARKS} pairs [score, points], scores rising, points from 0");
            return fault("marks", &message);
        }
        if self.baselines.len() > MAX_BASELINES {
            return fault("baselines", &format!("expected at most {MAX_BASELINES} baselines"));
        }
        match self.baselines.iter().find(|name| !name.ends_with(".toml") && !is_built_in_planner(name)) {
            Some(name) => {
                fault("baselines", &format!("`{name}` is no built-in planner; expected one, or a file NAME.toml"))
            }
            None => Ok(()),
        }
    }

    /// Returns the points of a score by the table of marks; `None` without a table.
    pub fn points_of(&self, score: f64) -> Option<f64> {
        let [first, last] = [self.marks.first()?, self.marks.last()?];
        if score <= first[0] {
            return Some(first[1]);
        }
        let above = self.marks.windows(2).find(|rows| score <= rows[1][0]);
        Some(above.map_or(last[1], |rows| {
            let share = (score - rows[0][0]) / (rows[1][0] - rows[0][0]);
            rows[0][1] + share * (rows[1][1] - rows[0][1])
        }))
    }

    /// Returns the points for a score that is better than that of a baseline.
    pub fn points_of_baseline(&self, name: &str) -> f64 {
        self.baseline_points.get(name).copied().unwrap_or(self.points.baseline)
    }

    /// Returns the most points that the table of marks gives.
    pub fn max_points_of_score(&self) -> f64 {
        self.marks.iter().fold(0.0, |max, row| max.max(row[1]))
    }
}

fn fault(key: &'static str, message: &str) -> Result<(), GradingFault> {
    Err(GradingFault { key, message: message.to_owned() })
}

fn is_built_in_planner(name: &str) -> bool {
    PlannerName::new(name).is_ok_and(|name| name.built_in().is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_linear_between_rows_and_constant_beyond() {
        let rules = GradingRules { marks: vec![[40.0, 0.0], [100.0, 30.0], [120.0, 40.0]], ..GradingRules::default() };
        let points = [0.0, 40.0, 70.0, 100.0, 110.0, 120.0, 500.0].map(|score| rules.points_of(score));
        assert_eq!(points, [0.0, 0.0, 15.0, 30.0, 35.0, 40.0, 40.0].map(Some));
        assert_eq!(rules.max_points_of_score(), 40.0);
        assert_eq!(GradingRules::default().points_of(3.0), None);
    }

    #[test]
    fn single_baselines_can_have_other_points() {
        let rules: GradingRules = toml::from_str(
            r#"baselines = ["lattice", "prm-rs"]
            baseline_points = { prm-rs = 20 }"#,
        )
        .expect("rules");
        assert!(rules.check().is_ok());
        assert_eq!(["lattice", "prm-rs"].map(|name| rules.points_of_baseline(name)), [10.0, 20.0]);
        let baseline_points = BTreeMap::from([("hybrid-astar".to_owned(), 20.0)]);
        let refused = GradingRules { baseline_points, ..rules }.check().expect_err("it is no baseline");
        assert_eq!(
            (refused.key, refused.message.as_str()),
            ("baseline_points", "`hybrid-astar` is not one of the baselines")
        );
    }
}
