//! The planning problems: from files, or on the field of a scenario.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use rand::seq::SliceRandom;

use crate::cli::args::parse_seed;
use crate::cli::error::CliError;
use crate::cli::numbers;
use wildfire_base::rng;
use wildfire_planning::collision::{ClearanceField, CollisionChecker};
use wildfire_planning::{Goal, GoalDisc, free_poses};
use wildfire_sim::scenario::{MAX_GOALS, Problem, Scenario, Unimog};

/// Goal poses on a scenario's field, unless a number is given.
const GOALS: usize = 50;

/// The clearance of random goal poses from bushes and border, metres.
const GOAL_CLEARANCE_M: f64 = 0.5;

/// The fields to plan on, and the goals there.
#[derive(Debug, Args)]
pub struct ProblemArguments {
    /// Field files: JSON with bushes, start and goals [default: the field of the scenario, drawn with the seed].
    #[arg(value_name = "FIELD.json")]
    pub fields: Vec<PathBuf>,
    /// The seed of everything random.
    #[arg(short, long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    /// The number of random free poses of the scenario's field to drive to [default: 50].
    #[arg(help_heading = "Goals", long, value_name = "N", conflicts_with = "fields", value_parser = goal_count)]
    pub goals: Option<usize>,
    /// The number of random bushes of each field to drive to instead: near enough to put out a fire there
    /// (`suppression.reach_m`), at any heading.
    #[arg(help_heading = "Goals", long, value_name = "N", conflicts_with = "goals", value_parser = goal_count)]
    pub cells: Option<usize>,
}

pub fn goal_count(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(1..=MAX_GOALS), "a whole number")
}

impl ProblemArguments {
    /// Returns the least number of goals that there can be, which is known before any field is.
    pub fn least_goals(&self) -> usize {
        let is_drawn = self.fields.is_empty() && self.cells.is_none();
        if is_drawn { self.goals.unwrap_or(GOALS) } else { self.fields.len().max(1) }
    }

    /// Returns the problems of the files, or the one of the scenario; each has a name of its own and at least one goal.
    pub fn load(&self, scenario: &Scenario) -> Result<Vec<Problem>, CliError> {
        self.load_with_seed(scenario, self.seed)
    }

    /// Does the same with another seed.
    pub fn load_with_seed(&self, scenario: &Scenario, seed: u64) -> Result<Vec<Problem>, CliError> {
        let truck = scenario.unimog.first().ok_or_else(|| no_truck(scenario))?;
        let mut problems = if self.fields.is_empty() {
            vec![on_the_scenario(self, scenario, seed)?]
        } else {
            from_files(self, truck)?
        };
        if let Some(count) = self.cells {
            let reach_m = scenario.suppression.reach_m.ok_or_else(no_reach)?;
            problems.iter_mut().for_each(|problem| problem.goals = bushes(problem, count, reach_m, seed));
        }
        match problems.iter().find(|problem| problem.goals.is_empty()) {
            None => Ok(problems),
            Some(problem) => {
                let (what, help) = match self.cells {
                    Some(_) => ("bushes", "leave out --cells, to drive to poses"),
                    None => ("goals", "list `goals`, or drive to bushes with --cells"),
                };
                Err(CliError::bad_input(format_args!("the field `{}` has no {what}", problem.name), Some(help)))
            }
        }
    }
}

/// Returns the error of a scenario that has nobody to plan for.
pub fn no_truck(scenario: &Scenario) -> CliError {
    CliError::bad_input(
        format_args!("the scenario `{}` has no truck", scenario.name),
        Some("planners take their settings from its first [[unimog]]"),
    )
}

fn no_reach() -> CliError {
    CliError::bad_input("--cells needs a reach, and `suppression.reach_m` is \"none\"", None)
}

fn from_files(arguments: &ProblemArguments, truck: &Unimog) -> Result<Vec<Problem>, CliError> {
    let mut problems: Vec<Problem> = Vec::new();
    for path in &arguments.fields {
        let problem = Problem::open(path, truck)?;
        if problems.iter().any(|other| other.name == problem.name) {
            let sentence = format!("{}: another field is called `{}` too", path.display(), problem.name);
            return Err(CliError::bad_input(
                sentence,
                Some("tables tell fields apart by `field`, or by the file's name"),
            ));
        }
        problems.push(problem);
    }
    Ok(problems)
}

fn on_the_scenario(arguments: &ProblemArguments, scenario: &Scenario, seed: u64) -> Result<Problem, CliError> {
    let problem = Problem::from_scenario(scenario, seed).map_err(|error| CliError::bad_input(error, None))?;
    let mut problem = problem.ok_or_else(|| no_truck(scenario))?;
    if arguments.cells.is_none() {
        problem.goals = goal_poses(&problem, arguments.goals.unwrap_or(GOALS), seed)?;
    }
    Ok(problem)
}

fn goal_poses(problem: &Problem, count: usize, seed: u64) -> Result<Vec<Goal>, CliError> {
    let field = Arc::new(ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied));
    let checker = CollisionChecker::new(field, problem.truck.vehicle);
    let mut rng = rng::stream(seed, "plan/goals");
    let goals: Vec<Goal> = free_poses(&checker, GOAL_CLEARANCE_M, &mut rng).take(count).map(Goal::Pose).collect();
    if goals.len() < count {
        return Err(CliError::bad_input(format_args!("the field `{}` has no room for goals", problem.name), None));
    }
    Ok(goals)
}

/// Discs about random bushes, no bush twice.
fn bushes(problem: &Problem, count: usize, reach_m: f64, seed: u64) -> Vec<Goal> {
    let mut bushes = problem.terrain.bushes.clone();
    bushes.shuffle(&mut rng::stream(seed, "plan/cells"));
    bushes.truncate(count);
    let disc = |cell| Goal::Disc(GoalDisc { centre: problem.terrain.frame.centre(cell), radius_m: reach_m });
    bushes.into_iter().map(disc).collect()
}
