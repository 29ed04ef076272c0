//! The report on planned drives: an object, a document and pictures of all answers.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use crate::batch::PROGRAM_VERSION;
use crate::cli::plan::attempts::Attempt;
use crate::cli::plan::drive::Drive;
use crate::cli::plan::repeat::Repeat;
use crate::cli::plan::tables::Row;
use crate::document::number::{count, optional, rounded};
use crate::document::{Block, Document, Table};
use crate::picture::{DriveScene, DrivenWays, Picture, draw_drives};
use crate::planning::{Goal, PlanFailure, PlannerName, TruckPlannerKind};
use crate::scenario::{LoadedScenario, Problem};
use crate::vehicle::Path;

/// The most rows, and violations, that are shown one by one.
const SHOWN_ROWS: usize = 60;
const SHOWN_VIOLATIONS: usize = 10;

/// Characters of a field's name.
const LONGEST_NAME: usize = 10;

/// Goals of each field that `first_lower_bound_ratio_mean` counts: comparisons with planners that take seconds for a goal
/// can afford no more.
pub const FIRST_GOALS: usize = 3;

/// The question and all answers.
pub struct PlanReport<'a> {
    pub loaded: &'a LoadedScenario,
    /// Changed values, as on the command line.
    pub changes: &'a [String],
    pub seed: u64,
    pub problems: &'a [Problem],
    pub planners: &'a [PlannerName],
    /// Problem by problem, goal by goal, planner by planner.
    pub attempts: Vec<Attempt<'a>>,
    /// Whether answers repeat, in the order of the planners, if they were asked twice.
    pub repeats: Option<Vec<Repeat>>,
    /// In the order of the planners.
    pub summaries: Vec<Summary>,
}

impl PlanReport<'_> {
    /// The place of a problem of the list.
    pub fn number_of(&self, problem: &Problem) -> usize {
        self.problems.iter().position(|other| std::ptr::eq(other, problem)).expect("it is in the list")
    }
}

/// Figures of one planner. Times are of all queries, the rest is of the paths that were found.
///
/// A quantile is the value of the rank nearest to it.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    pub planner: PlannerName,
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
    pub fn new(planner: &PlannerName, attempts: &[Attempt]) -> Self {
        let own: Vec<&Attempt> = attempts.iter().filter(|attempt| attempt.planner == *planner).collect();
        let drives: Vec<&Drive> = own.iter().filter_map(|attempt| attempt.drive.as_ref().ok()).collect();
        let queries = sorted(own.iter().map(|attempt| attempt.query.as_secs_f64()));
        let builds = own.iter().filter(|attempt| attempt.goal == 0).map(|attempt| attempt.build.as_secs_f64());
        let first = own.iter().filter(|attempt| attempt.goal < FIRST_GOALS);
        let first = first.filter_map(|attempt| attempt.drive.as_ref().ok()?.figures.lower_bound_ratio);
        Self {
            planner: planner.clone(),
            goals: own.len(),
            reached: drives.len(),
            cpu_query_median_s: quantile(&queries, 0.5).unwrap_or(0.0),
            cpu_query_p95_s: quantile(&queries, 0.95).unwrap_or(0.0),
            cpu_query_max_s: quantile(&queries, 1.0).unwrap_or(0.0),
            cpu_build_median_s: quantile(&sorted(builds), 0.5).unwrap_or(0.0),
            lower_bound_ratio_mean: mean(drives.iter().filter_map(|drive| drive.figures.lower_bound_ratio)),
            first_lower_bound_ratio_mean: mean(first),
            min_clearance_median_m: quantile(&sorted(drives.iter().map(|drive| drive.figures.min_clearance_m)), 0.5),
            cusps_mean: mean(drives.iter().map(|drive| drive.figures.cusps.into())),
            drive_mean_s: mean(drives.iter().map(|drive| drive.figures.drive_s)),
            violations: drives.iter().filter(|drive| drive.violation.is_some()).count(),
        }
    }
}

/// Returns the mean, if there is a value.
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Returns the value of the nearest rank.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rank is a place in the list")]
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[(last as f64 * share).round() as usize])
}

/// The values of a planner's settings of the first truck, by names such as `hybrid.shortcuts`; of one that is not built
/// in, those of its table.
pub fn planner_settings(planner: &PlannerName, loaded: &LoadedScenario) -> Vec<(String, String)> {
    let tables = planner.built_in().map_or(&[][..], |kind| TruckPlannerKind::maker(kind).tables());
    let of_program = format!("planner.{planner}.");
    let own = |name: String| {
        if let Some(setting) = name.strip_prefix(&of_program) {
            return Some(setting.to_owned());
        }
        let name = name.strip_prefix("unimog.0.")?;
        let table = name.split_once('.')?.0;
        tables.contains(&table).then(|| name.to_owned())
    };
    loaded.values().into_iter().filter_map(|(name, value)| Some((own(name)?, value))).collect()
}

/// Settings that bound a planner's effort: expansions, samples, tries.
const BUDGETS: [&str; 3] = ["max_expansions", "samples", "shortcuts"];

/// The settings that bound a planner's effort, as text.
fn budget(planner: &PlannerName, loaded: &LoadedScenario) -> String {
    let is_budget = |name: &str| BUDGETS.iter().any(|budget| name.rsplit('.').next() == Some(budget));
    let budgets = planner_settings(planner, loaded).into_iter().filter(|(name, _)| is_budget(name));
    let budgets: Vec<_> = budgets.map(|(name, value)| format!("{name}={value}")).collect();
    if budgets.is_empty() { "none".into() } else { budgets.join(", ") }
}

/// The members in their order.
#[derive(Serialize)]
struct Object<'a> {
    program_version: &'static str,
    scenario: &'a str,
    seed: u64,
    /// By planner.
    settings: BTreeMap<&'a str, BTreeMap<String, String>>,
    fields: Vec<Field<'a>>,
    rows: Vec<Row<'a>>,
    #[serde(rename = "offences")]
    violations: Vec<Violation<'a>>,
    summary: &'a [Summary],
    #[serde(skip_serializing_if = "Option::is_none")]
    repeats: Option<&'a [Repeat]>,
}

#[derive(Serialize)]
struct Field<'a> {
    field: &'a str,
    start: [f64; 3],
    goals: Vec<GoalMember>,
}

/// As a field file has it.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum GoalMember {
    Pose([f64; 3]),
    Disc([f64; 3]),
}

#[derive(Serialize)]
struct Violation<'a> {
    field: &'a str,
    goal: usize,
    planner: &'a str,
    #[serde(rename = "offence")]
    violation: &'a str,
}

impl Serialize for PlanReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let object = Object {
            program_version: PROGRAM_VERSION,
            scenario: &self.loaded.scenario.name,
            seed: self.seed,
            settings: (self.planners.iter())
                .map(|planner| (planner.name(), planner_settings(planner, self.loaded).into_iter().collect()))
                .collect(),
            fields: self.problems.iter().map(field).collect(),
            rows: self.attempts.iter().map(Row::new).collect(),
            violations: self.attempts.iter().filter_map(violation).collect(),
            summary: &self.summaries,
            repeats: self.repeats.as_deref(),
        };
        object.serialize(serializer)
    }
}

fn field(problem: &Problem) -> Field<'_> {
    let goal = |goal: &Goal| match *goal {
        Goal::Pose(pose) => GoalMember::Pose([pose.x, pose.y, pose.heading]),
        Goal::Disc(disc) => GoalMember::Disc([disc.centre.x, disc.centre.y, disc.radius_m]),
    };
    let start = [problem.start.x, problem.start.y, problem.start.heading];
    Field { field: &problem.name, start, goals: problem.goals.iter().map(goal).collect() }
}

fn violation<'a>(attempt: &'a Attempt) -> Option<Violation<'a>> {
    let violation = attempt.drive.as_ref().ok()?.violation.as_deref()?;
    Some(Violation { field: &attempt.problem.name, goal: attempt.goal, planner: attempt.planner.name(), violation })
}

impl From<&PlanReport<'_>> for Document {
    /// The settings, a row for each goal and planner if they are not too many, a row for each planner, and what went
    /// wrong.
    fn from(report: &PlanReport) -> Self {
        let fields = match report.problems {
            [problem] => format!("Field `{}`", shortened(&problem.name)),
            problems => format!("{} fields", problems.len()),
        };
        let goals = count(report.problems.iter().map(|problem| problem.goals.len()).sum(), "goal");
        let changes: String = report.changes.iter().map(|change| format!(", {change}")).collect();
        let settings = format!("Settings of the scenario `{}`{changes}.", report.loaded.scenario.name);
        let budget = |planner: &PlannerName| format!("Budget of {planner}: {}.", budget(planner, report.loaded));
        let settings = std::iter::once(settings).chain(report.planners.iter().map(budget)).collect();
        let mut document = Self::new(format!("{fields}, {goals}, seed {}", report.seed)).with([Block::List(settings)]);
        if report.attempts.len() <= SHOWN_ROWS {
            document.add(rows(report));
        }
        document.add(summary(&report.summaries));
        let repeats = report.repeats.iter().flatten().map(Repeat::sentence);
        document.add_list(failures(report).chain(violations(report)).chain(repeats).collect());
        document.with([Block::List(LEGEND.map(str::to_owned).to_vec())])
    }
}

const LEGEND: [&str; 3] = [
    "Query, build: CPU time in ms; building the clearance field counts as building.",
    "Len./bound: over the shortest that could be, mean; clearance: median of minima.",
    "Violations: paths that a check by other shapes every 2 cm found fault with.",
];

/// A column of a table: its heading, and its cells.
type TextColumn<T> = (&'static str, fn(&T) -> String);

fn table<T>(columns: &[TextColumn<T>], rows: &[T]) -> Table {
    let headings: Vec<_> = columns.iter().map(|(heading, _)| *heading).collect();
    let cells = |row: &T| columns.iter().map(|(_, cell)| cell(row)).collect();
    Table::new(&headings, rows.iter().map(cells).collect())
}

/// A row for each goal and planner.
fn rows(report: &PlanReport) -> Table {
    let mut columns: Vec<TextColumn<Attempt>> = Vec::new();
    if report.planners.len() > 1 {
        columns.push(("Planner", |row| row.planner.to_string()));
    }
    if report.problems.len() > 1 {
        columns.push(("Field", |row| shortened(&row.problem.name)));
    }
    columns.extend::<[TextColumn<Attempt>; 8]>([
        ("Goal", |row| row.goal.to_string()),
        ("Query\nms", |row| milliseconds(row.query.as_secs_f64())),
        ("Expan-\nsions", |row| row.expansions.to_string()),
        ("Length\nm", |row| drive_cell(row, |drive| Some(drive.figures.length_m), 2)),
        ("Len./\nbound", |row| drive_cell(row, |drive| drive.figures.lower_bound_ratio, 3)),
        ("Clear.\nm", |row| drive_cell(row, |drive| Some(drive.figures.min_clearance_m), 2)),
        ("Cusps", |row| drive_cell(row, |drive| Some(drive.figures.cusps.into()), 0)),
        ("Drive\ns", |row| drive_cell(row, |drive| Some(drive.figures.drive_s), 1)),
    ]);
    table(&columns, &report.attempts)
}

fn drive_cell(row: &Attempt, figure: fn(&Drive) -> Option<f64>, decimals: usize) -> String {
    optional(row.drive.as_ref().ok().and_then(figure), decimals)
}

/// A line for each planner.
fn summary(summaries: &[Summary]) -> Table {
    let columns: [TextColumn<Summary>; 10] = [
        ("Planner", |row| row.planner.to_string()),
        ("Reached", |row| format!("{}/{}", row.reached, row.goals)),
        ("Query\nmedian", |row| milliseconds(row.cpu_query_median_s)),
        ("p95", |row| milliseconds(row.cpu_query_p95_s)),
        ("max", |row| milliseconds(row.cpu_query_max_s)),
        ("Build\nms", |row| milliseconds(row.cpu_build_median_s)),
        ("Len./\nbound", |row| optional(row.lower_bound_ratio_mean, 3)),
        ("Clear.\nm", |row| optional(row.min_clearance_median_m, 2)),
        ("Cusps", |row| optional(row.cusps_mean, 2)),
        ("Viola-\ntions", |row| row.violations.to_string()),
    ];
    table(&columns, summaries)
}

/// A sentence for each planner and reason.
fn failures(report: &PlanReport) -> impl Iterator<Item = String> {
    let kinds = report.planners.iter().flat_map(|planner| PlanFailure::ALL.map(|reason| (planner, reason)));
    kinds.filter_map(|(planner, reason)| {
        let is_one = |attempt: &&Attempt| attempt.planner == *planner && attempt.drive.as_ref().err() == Some(&reason);
        let failed: Vec<&Attempt> = report.attempts.iter().filter(is_one).collect();
        let first = failed.first()?;
        let place = place(first);
        let message = first.message.as_ref().map_or(String::new(), |message| format!(": {message}"));
        Some(match failed.len() {
            1 => format!("{planner}: {reason} {place}{message}."),
            times => format!("{planner}: {reason} {times} times, first {place}{message}."),
        })
    })
}

fn violations(report: &PlanReport) -> impl Iterator<Item = String> {
    let violation = |attempt: &Attempt| {
        let violation = attempt.drive.as_ref().ok()?.violation.as_ref()?;
        Some(format!("{}: violation {}: {violation}", attempt.planner, place(attempt)))
    };
    report.attempts.iter().filter_map(violation).take(SHOWN_VIOLATIONS)
}

fn place(attempt: &Attempt) -> String {
    format!("on field {}, goal {}", shortened(&attempt.problem.name), attempt.goal)
}

/// CPU time in milliseconds, with decimals where they count.
fn milliseconds(seconds: f64) -> String {
    let milliseconds = 1e3 * seconds;
    rounded(milliseconds, if milliseconds < 100.0 { 2 } else { 0 })
}

/// Returns the beginning of a field's name, for tables and sentences.
pub fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST_NAME {
        return name.to_owned();
    }
    name.chars().take(LONGEST_NAME - 1).chain(['~']).collect()
}

impl PlanReport<'_> {
    /// Draws the paths of all planners on one field.
    pub fn draw(&self, problem: &Problem) -> Picture {
        let own: Vec<&Attempt> = self.attempts.iter().filter(|a| std::ptr::eq(a.problem, problem)).collect();
        let by = |planner: &PlannerName| {
            let paths = own.iter().filter(|attempt| attempt.planner == *planner);
            let paths: Vec<&Path> = paths.filter_map(|attempt| Some(&attempt.drive.as_ref().ok()?.path)).collect();
            DrivenWays { name: format!("{planner}, {} of {}", paths.len(), problem.goals.len()), paths }
        };
        let is_reached = |goal| own.iter().any(|attempt| attempt.goal == goal && attempt.drive.is_ok());
        draw_drives(&DriveScene {
            title: &format!("Drives on field {}", problem.name),
            frame: problem.terrain.frame,
            bushes: &problem.terrain.bushes,
            start: problem.start,
            goals: &problem.goals.iter().enumerate().map(|(n, &goal)| (goal, is_reached(n))).collect::<Vec<_>>(),
            ways: &self.planners.iter().map(by).collect::<Vec<_>>(),
        })
    }
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
