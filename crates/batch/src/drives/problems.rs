//! Planning problems from files, or on the field of a scenario.

use std::path::PathBuf;
use std::sync::Arc;

use rand::seq::SliceRandom;

use crate::drives::error::DriveError;
use wildfire_base::rng;
use wildfire_planning::collision::{ClearanceField, CollisionChecker};
use wildfire_planning::kit::ends::free_poses;
use wildfire_planning::{Goal, GoalDisc};
use wildfire_scenario::{MAX_GOALS, Problem, Scenario, Unimog};

/// Goal poses on a scenario's field, unless a number is given.
const GOALS: usize = 50;

/// The clearance of random goal poses from bushes and border, metres.
const GOAL_CLEARANCE_M: f64 = 0.5;

/// The fields and goals of drives.
#[derive(Clone, Debug, Default)]
pub struct DriveProblems {
    /// The field files; without any, the field of the scenario.
    pub fields: Vec<PathBuf>,
    /// The number of random free poses of the scenario's field to drive to.
    pub goals: Option<usize>,
    /// Number of random goal bushes on each field instead; a drive must end near enough to put out a fire there
    /// (`suppression.reach_m`), at any heading.
    pub cells: Option<usize>,
}

impl DriveProblems {
    /// Returns the least possible number of goals, which is known before any field is.
    pub fn min_goals(&self) -> usize {
        let is_drawn = self.fields.is_empty() && self.cells.is_none();
        if is_drawn { self.goals.unwrap_or(GOALS) } else { self.fields.len().max(1) }
    }

    /// Returns the problems of the files, or that of the scenario; each has a unique name and at least one goal.
    pub fn load(&self, scenario: &Scenario, seed: u64) -> Result<Vec<Problem>, DriveError> {
        // The check comes before any file is read: a number of goals is an option, whatever the files hold.
        if let Some(found) = self.goals.or(self.cells).filter(|count| !(1..=MAX_GOALS).contains(count)) {
            return Err(DriveError::GoalCount { found });
        }
        if self.goals.is_some() && (self.cells.is_some() || !self.fields.is_empty()) {
            return Err(DriveError::OtherGoals);
        }
        let truck = scenario.unimog.first().ok_or_else(|| no_truck(scenario))?;
        let mut problems = if self.fields.is_empty() {
            vec![on_the_scenario(self, scenario, seed)?]
        } else {
            from_files(self, truck)?
        };
        if let Some(count) = self.cells {
            let reach_m = scenario.suppression.reach_m.ok_or(DriveError::NoReach)?;
            // Goals at bushes replace those of the files, which may have none.
            problems.iter_mut().for_each(|problem| problem.goals = bushes(problem, count, reach_m, seed));
        }
        // A table without rows would look like a planner that solved everything.
        match problems.iter().find(|problem| problem.goals.is_empty()) {
            None => Ok(problems),
            Some(problem) => {
                let what = if self.cells.is_some() { "bushes" } else { "goals" };
                Err(DriveError::NoGoals { field: problem.name.clone(), what })
            }
        }
    }
}

fn no_truck(scenario: &Scenario) -> DriveError {
    DriveError::NoTruck { scenario: scenario.name.clone() }
}

fn from_files(requested: &DriveProblems, truck: &Unimog) -> Result<Vec<Problem>, DriveError> {
    let mut problems: Vec<Problem> = Vec::new();
    for path in &requested.fields {
        let problem = Problem::open(path, truck)?;
        if problems.iter().any(|other| other.name == problem.name) {
            return Err(DriveError::SameName { path: path.clone(), name: problem.name });
        }
        problems.push(problem);
    }
    Ok(problems)
}

fn on_the_scenario(requested: &DriveProblems, scenario: &Scenario, seed: u64) -> Result<Problem, DriveError> {
    let problem = Problem::from_scenario(scenario, seed)?;
    let mut problem = problem.ok_or_else(|| no_truck(scenario))?;
    if requested.cells.is_none() {
        problem.goals = goal_poses(&problem, requested.goals.unwrap_or(GOALS), seed)?;
    }
    Ok(problem)
}

fn goal_poses(problem: &Problem, count: usize, seed: u64) -> Result<Vec<Goal>, DriveError> {
    let field = Arc::new(ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied));
    let checker = CollisionChecker::new(field, problem.truck.vehicle);
    let mut rng = rng::stream(seed, "plan/goals");
    let goals: Vec<Goal> = free_poses(&checker, GOAL_CLEARANCE_M, &mut rng).take(count).map(Goal::Pose).collect();
    if goals.len() < count {
        return Err(DriveError::NoRoom { field: problem.name.clone() });
    }
    Ok(goals)
}

/// Discs about random bushes, no bush twice.
fn bushes(problem: &Problem, count: usize, reach_m: f64, seed: u64) -> Vec<Goal> {
    let mut bushes = problem.terrain.bushes.clone();
    bushes.shuffle(&mut rng::stream(seed, "plan/cells"));
    bushes.truncate(count);
    bushes
        .into_iter()
        .map(|cell| Goal::Disc(GoalDisc { centre: problem.terrain.frame.centre(cell), radius_m: reach_m }))
        .collect()
}
