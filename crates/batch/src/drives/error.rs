//! Errors of planning drives.

use std::path::PathBuf;

use thiserror::Error;

use crate::drives::attempts::AttemptError;
use wildfire_planning::{NameError, PlannerName};
use wildfire_scenario::{MAX_GOALS, ScenarioError, TerrainError};

/// The reason why nothing is planned.
#[derive(Debug, Error)]
pub enum DriveError {
    #[error("{}", .0.fault)]
    Scenario(#[from] Box<ScenarioError>),
    #[error("the scenario `{scenario}` has no truck")]
    NoTruck { scenario: String },
    #[error("--cells needs a reach, but `suppression.reach_m` is \"none\"")]
    NoReach,
    #[error("{found} goals; expected a whole number from 1 to {MAX_GOALS}")]
    GoalCount { found: usize },
    #[error("a number of random poses excludes field files and a number of bushes")]
    OtherGoals,
    #[error("{}: another field is also named `{name}`", .path.display())]
    SameName { path: PathBuf, name: String },
    #[error("the field `{field}` has no {what}")]
    NoGoals { field: String, what: &'static str },
    #[error("the field `{field}` has no room for goals")]
    NoRoom { field: String },
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    /// The name belongs to no built-in or registered planner, and to no table of the scenario.
    #[error("--planner names `{name}`, but no planner of this name is known")]
    UnknownPlanner { name: PlannerName, valid: Vec<String> },
    #[error(transparent)]
    TakenName(#[from] NameError),
    #[error("planning on the field {field}: {source}")]
    Failed { field: String, source: AttemptError },
}
