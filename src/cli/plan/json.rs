//! The report as one JSON object.

use serde::Serialize;
use std::collections::BTreeMap;

use crate::batch::PROGRAM_VERSION;
use crate::cli::plan::PlanReport;
use crate::cli::plan::attempts::Attempt;
use crate::cli::plan::rows::Row;
use crate::cli::plan::settings;
use crate::cli::plan::summary::Summary;
use crate::planning::Goal;
use crate::scenario::Problem;

/// The members in their order.
#[derive(Serialize)]
struct Object<'a> {
    program_version: &'static str,
    scenario: &'a str,
    seed: u64,
    /// By planner.
    settings: BTreeMap<&'static str, BTreeMap<String, String>>,
    fields: Vec<Field<'a>>,
    rows: Vec<Row<'a>>,
    #[serde(rename = "offences")]
    violations: Vec<Violation<'a>>,
    summary: &'a [Summary],
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
    planner: &'static str,
    #[serde(rename = "offence")]
    violation: &'a str,
}

/// The object on one line.
pub fn to_json(report: &PlanReport) -> String {
    let object = Object {
        program_version: PROGRAM_VERSION,
        scenario: &report.loaded.scenario.name,
        seed: report.seed,
        settings: report
            .planners
            .iter()
            .map(|&p| (p.name(), settings::planner_settings(p, report.loaded).into_iter().collect()))
            .collect(),
        fields: report.problems.iter().map(field).collect(),
        rows: report.attempts.iter().map(Row::new).collect(),
        violations: report.attempts.iter().filter_map(violation).collect(),
        summary: &report.summaries,
    };
    serde_json::to_string(&object).expect("names, numbers and words are JSON") + "\n"
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
