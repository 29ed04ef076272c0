//! Attempts as a benchmark log of OMPL, the Open Motion Planning Library, which its statistics script puts into a
//! database for Planner Arena (M. Moll, I. A. Șucan, L. E. Kavraki, "Benchmarking Motion Planning Algorithms", IEEE
//! Robotics & Automation Magazine 22(3), 2015).
//!
//! A log is a head of lines in a fixed order, then for each planner its settings, the names and types of what is known of
//! a run, a line of values for each run, and a full stop.

use std::io::{self, Write};
use std::path::Path;

use crate::batch::PROGRAM_VERSION;
use crate::cli::plan::attempts::Attempt;
use crate::cli::plan::drive::Drive;
use crate::cli::plan::report::{PlanReport, planner_settings};
use crate::planning::PlanFailure;
use crate::whole_file::WholeFile;

/// OMPL's own words for the ends of a run, by their numbers there.
const STATUSES: [&str; 10] = [
    "Unknown status",
    "Invalid start",
    "Invalid goal",
    "Unrecognized goal type",
    "Timeout",
    "Approximate solution",
    "Exact solution",
    "Crash",
    "Abort",
    "Infeasible",
];

/// A property of a run: its name and type, and its value, `None` where there is none.
type Property = (&'static str, fn(&Attempt, &PlanReport) -> Option<String>);

const PROPERTIES: [Property; 13] = [
    ("approximate solution BOOLEAN", |_, _| boolean(false)),
    ("build time REAL", |attempt, _| Some(attempt.build.as_secs_f64().to_string())),
    ("correct solution BOOLEAN", |attempt, _| boolean(attempt.drive.as_ref().is_ok_and(|d| d.violation.is_none()))),
    ("cusps INTEGER", |attempt, _| figure(attempt, |drive| Some(drive.figures.cusps.into()))),
    ("drive time REAL", |attempt, _| figure(attempt, |drive| Some(drive.figures.drive_s))),
    ("expansions INTEGER", |attempt, _| Some(attempt.expansions.to_string())),
    ("goal INTEGER", |attempt, _| Some(attempt.goal.to_string())),
    ("lower bound ratio REAL", |attempt, _| figure(attempt, |drive| drive.figures.lower_bound_ratio)),
    ("problem INTEGER", |attempt, report| Some(report.number_of(attempt.problem).to_string())),
    ("solution clearance REAL", |attempt, _| figure(attempt, |drive| Some(drive.figures.min_clearance_m))),
    ("solution length REAL", |attempt, _| figure(attempt, |drive| Some(drive.figures.length_m))),
    ("solved BOOLEAN", |attempt, _| boolean(attempt.drive.is_ok())),
    ("time REAL", |attempt, _| Some(attempt.query.as_secs_f64().to_string())),
];

/// Writes the log. Where OMPL has limits of time and memory, and a day, it has zeros: effort is counted here, and nothing
/// depends on the day.
pub fn write_log(path: &Path, report: &PlanReport) -> io::Result<()> {
    let mut log = WholeFile::create(path)?;
    write_head(&mut log, report)?;
    for planner in report.planners {
        writeln!(log, "{}", planner.name())?;
        let settings = planner_settings(planner, report.loaded);
        writeln!(log, "{} common properties", settings.len())?;
        settings.iter().try_for_each(|(name, value)| writeln!(log, "{name} = {value}"))?;
        writeln!(log, "{} properties for each run", PROPERTIES.len() + 1)?;
        PROPERTIES.iter().try_for_each(|(name, _)| writeln!(log, "{name}"))?;
        writeln!(log, "status ENUM")?;
        let runs: Vec<_> = report.attempts.iter().filter(|attempt| attempt.planner == *planner).collect();
        writeln!(log, "{} runs", runs.len())?;
        runs.into_iter().try_for_each(|run| write_run(&mut log, run, report))?;
        writeln!(log, ".")?;
    }
    log.finish()
}

fn write_head(log: &mut impl Write, report: &PlanReport) -> io::Result<()> {
    writeln!(log, "wildfire version {PROGRAM_VERSION}")?;
    writeln!(log, "Experiment {}", report.loaded.scenario.name.replace(char::is_whitespace, "_"))?;
    writeln!(log, "0 experiment properties")?;
    writeln!(log, "Running on UNKNOWN")?;
    writeln!(log, "Starting at 1970-01-01T00:00:00")?;
    writeln!(log, "<<<|")?;
    for (number, problem) in report.problems.iter().enumerate() {
        let (frame, goals) = (problem.terrain.frame, problem.goals.len());
        let (width_m, height_m) = (frame.width_m(), frame.height_m());
        writeln!(log, "problem {number}: field {}, {width_m} x {height_m} m, {goals} goals", problem.name)?;
    }
    writeln!(log, "|>>>")?;
    let runs = report.attempts.len() / report.planners.len();
    let seconds: f64 = report.attempts.iter().map(|attempt| attempt.query.as_secs_f64()).sum();
    writeln!(log, "{} is the random seed", report.seed)?;
    writeln!(log, "0 seconds per run")?;
    writeln!(log, "0 MB per run")?;
    writeln!(log, "{runs} runs per planner")?;
    writeln!(log, "{seconds} seconds spent to collect the data")?;
    writeln!(log, "1 enum type")?;
    writeln!(log, "status|{}", STATUSES.join("|"))?;
    writeln!(log, "{} planners", report.planners.len())
}

fn write_run(log: &mut impl Write, run: &Attempt, report: &PlanReport) -> io::Result<()> {
    for (_, value) in &PROPERTIES {
        write!(log, "{}; ", value(run, report).unwrap_or_default())?;
    }
    writeln!(log, "{}; ", status(run))
}

/// The number of the word in [`STATUSES`].
fn status(run: &Attempt) -> usize {
    let word = match &run.drive {
        Ok(_) => "Exact solution",
        Err(PlanFailure::StartBlocked) => "Invalid start",
        Err(PlanFailure::GoalBlocked) => "Invalid goal",
        Err(PlanFailure::BudgetSpent | PlanFailure::TimedOut) => "Timeout",
        Err(PlanFailure::Disconnected) => "Infeasible",
        Err(PlanFailure::Crashed) => "Crash",
        Err(PlanFailure::LocalMinimum | PlanFailure::BadAnswer) => "Unknown status",
    };
    STATUSES.iter().position(|status| *status == word).expect("every word is one of them")
}

fn figure(attempt: &Attempt, figure: fn(&Drive) -> Option<f64>) -> Option<String> {
    attempt.drive.as_ref().ok().and_then(figure).map(|figure| figure.to_string())
}

#[expect(clippy::unnecessary_wraps, reason = "properties may have no value")]
fn boolean(value: bool) -> Option<String> {
    Some(u8::from(value).to_string())
}
