//! The report as text for people.

use crate::batch::TextTable;
use crate::cli::plan::PlanReport;
use crate::cli::plan::attempts::Attempt;
use crate::cli::plan::drive::Drive;
use crate::cli::plan::settings;
use crate::cli::plan::summary::Summary;
use crate::cli::scenario_commands::wrapped;
use crate::planning::{PlanFailure, TruckPlannerKind};

/// The width of a terminal's line.
const WIDTH: usize = 80;

/// The most rows, and violations, that are shown one by one.
const SHOWN_ROWS: usize = 60;
const SHOWN_VIOLATIONS: usize = 10;

/// Characters of a field's name.
const LONGEST_NAME: usize = 10;

/// Settings, a row for each goal and planner if they are not too many, a line for each planner, and what went wrong.
pub fn to_text(report: &PlanReport) -> String {
    let rows = if report.attempts.len() <= SHOWN_ROWS { rows(report).to_text() + "\n" } else { String::new() };
    format!("{}\n{rows}{}\n{}", heading(report), summary(&report.summaries).to_text(), faults(report))
}

fn heading(report: &PlanReport) -> String {
    let fields = match report.problems {
        [problem] => format!("Field `{}`", shortened(&problem.name)),
        problems => format!("{} fields", problems.len()),
    };
    let goals = match report.problems.iter().map(|problem| problem.goals.len()).sum() {
        1 => "1 goal".to_owned(),
        goals => format!("{goals} goals"),
    };
    let (seed, scenario) = (report.seed, &report.loaded.scenario.name);
    let changes: String = report.changes.iter().map(|change| format!(", {change}")).collect();
    let sentence = format!("{fields}, {goals}, seed {seed}; settings of the scenario `{scenario}`{changes}.");
    let budget =
        |planner: &TruckPlannerKind| format!("Budget of {planner}: {}.", settings::budget(*planner, report.loaded));
    let sentences = std::iter::once(sentence).chain(report.planners.iter().map(budget));
    sentences.flat_map(|sentence| wrapped(&sentence, WIDTH)).map(|line| line + "\n").collect()
}

/// A column of a table: its heading, and its cells.
type TextColumn<T> = (&'static str, fn(&T) -> String);

fn table<T>(columns: &[TextColumn<T>], rows: &[T]) -> TextTable {
    let headings = columns.iter().map(|(heading, _)| heading.split(' ').map(str::to_owned).collect()).collect();
    let cells = |row: &T| columns.iter().map(|(_, cell)| cell(row)).collect();
    TextTable { headings, rows: rows.iter().map(cells).collect(), rules_before: Vec::new() }
}

/// A row for each goal and planner.
fn rows(report: &PlanReport) -> TextTable {
    let mut columns: Vec<TextColumn<Attempt>> = Vec::new();
    if report.planners.len() > 1 {
        columns.push(("Planner", |row| row.planner.to_string()));
    }
    if report.problems.len() > 1 {
        columns.push(("Field", |row| shortened(&row.problem.name)));
    }
    columns.extend::<[TextColumn<Attempt>; 8]>([
        ("Goal", |row| row.goal.to_string()),
        ("Query ms", |row| milliseconds(row.query.as_secs_f64())),
        ("Expan- sions", |row| row.expansions.to_string()),
        ("Length m", |row| drive_cell(row, |drive| Some(drive.length_m), 2)),
        ("Len./ bound", |row| drive_cell(row, |drive| drive.lower_bound_ratio, 3)),
        ("Clear. m", |row| drive_cell(row, |drive| Some(drive.min_clearance_m), 2)),
        ("Cusps", |row| drive_cell(row, |drive| Some(drive.cusps.into()), 0)),
        ("Drive s", |row| drive_cell(row, |drive| Some(drive.drive_s), 1)),
    ]);
    table(&columns, &report.attempts)
}

fn drive_cell(row: &Attempt, figure: fn(&Drive) -> Option<f64>, decimals: usize) -> String {
    optional(row.drive.as_ref().ok().and_then(figure), decimals)
}

/// A line for each planner.
fn summary(summaries: &[Summary]) -> TextTable {
    let columns: [TextColumn<Summary>; 11] = [
        ("Planner", |row| row.planner.to_string()),
        ("Reached", |row| format!("{}/{}", row.reached, row.goals)),
        ("Query median", |row| milliseconds(row.cpu_query_median_s)),
        ("p95", |row| milliseconds(row.cpu_query_p95_s)),
        ("max", |row| milliseconds(row.cpu_query_max_s)),
        ("Build ms", |row| milliseconds(row.cpu_build_median_s)),
        ("Len./ bound", |row| optional(row.lower_bound_ratio_mean, 3)),
        ("goals 0-2", |row| optional(row.first_lower_bound_ratio_mean, 3)),
        ("Clear. m", |row| optional(row.min_clearance_median_m, 2)),
        ("Cusps", |row| optional(row.cusps_mean, 2)),
        ("Viola- tions", |row| row.violations.to_string()),
    ];
    table(&columns, summaries)
}

/// Lists how often planners failed and why, the first violations, and what the columns mean.
fn faults(report: &PlanReport) -> String {
    let sentences = failures(report).chain(violations(report));
    let lines: String = sentences.flat_map(|fault| wrapped(&fault, WIDTH)).map(|line| line + "\n").collect();
    let gap = if lines.is_empty() { "" } else { "\n" };
    format!("{lines}{gap}{LEGEND}")
}

/// A sentence for each planner and reason.
fn failures(report: &PlanReport) -> impl Iterator<Item = String> {
    let kinds = report.planners.iter().flat_map(|&planner| PlanFailure::ALL.map(|reason| (planner, reason)));
    kinds.filter_map(|(planner, reason)| {
        let is_one = |attempt: &&Attempt| attempt.planner == planner && attempt.drive.as_ref().err() == Some(&reason);
        let failed: Vec<&Attempt> = report.attempts.iter().filter(is_one).collect();
        let place = place(failed.first()?);
        Some(match failed.len() {
            1 => format!("{planner}: {reason} {place}."),
            times => format!("{planner}: {reason} {times} times, first {place}."),
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

const LEGEND: &str = "\
Query, build: CPU time in ms; building the clearance field counts as building.
Len./bound: over the shortest that could be, mean; clearance: median of minima.
Violations: paths that a check by other shapes every 2 cm found fault with.
";

fn milliseconds(seconds: f64) -> String {
    let milliseconds = 1e3 * seconds;
    if milliseconds < 100.0 { format!("{milliseconds:.2}") } else { format!("{milliseconds:.0}") }
}

fn optional(figure: Option<f64>, decimals: usize) -> String {
    figure.map_or("-".into(), |figure| format!("{figure:.decimals$}"))
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST_NAME {
        return name.to_owned();
    }
    name.chars().take(LONGEST_NAME - 1).chain(['~']).collect()
}
