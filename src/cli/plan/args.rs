//! The arguments of `wildfire plan`, as clap reads them.

use std::path::PathBuf;

use clap::Args;

use crate::cli::args::{MemoryArguments, parse_seed};
use crate::cli::numbers;
use crate::planning::TruckPlannerKind;
use crate::scenario::MAX_GOALS;

const EXAMPLES: &str = "\
Examples:
  wildfire plan
  wildfire plan --goals 5 --planner prm-rs,hybrid-astar --png drives.png
  wildfire plan --scenario dense --seed 7 --cells 50
  wildfire plan field_*.json --planner hybrid-astar --csv drives.csv
  wildfire plan field.json --set unimog.hybrid.shortcuts=0 --paths paths.csv";

#[derive(Debug, Args)]
#[command(after_help = format!("Planners: {}.\n\n{EXAMPLES}", TruckPlannerKind::names()))]
pub struct PlanArguments {
    /// Field files: JSON with bushes, start and goals [default: the field of the scenario, drawn with the seed].
    #[arg(value_name = "FIELD.json")]
    pub fields: Vec<PathBuf>,
    /// The planner; several names, with commas or repeated, are compared [default: the scenario's].
    #[arg(long = "planner", value_name = "NAME", value_delimiter = ',')]
    pub planners: Vec<TruckPlannerKind>,
    /// The seed of everything random.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    /// The scenario whose first truck's settings planners have: a file, or a built-in name.
    #[arg(long, value_name = "SCENARIO", default_value = "contest")]
    pub scenario: String,
    /// Change a value of the scenario, such as `unimog.hybrid.clearance_m=1`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// The number of random free poses of the scenario's field to drive to [default: 50].
    #[arg(help_heading = "Goals", long, value_name = "N", conflicts_with = "fields", value_parser = goal_count)]
    pub goals: Option<usize>,
    /// The number of random bushes of each field to drive to instead: near enough to put out a fire there
    /// (`suppression.reach_m`), at any heading.
    #[arg(help_heading = "Goals", long, value_name = "N", conflicts_with = "goals", value_parser = goal_count)]
    pub cells: Option<usize>,
    /// Print the answer as one JSON object.
    #[arg(help_heading = "Output", long)]
    pub json: bool,
    /// Write a row for each goal and planner.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write poses along the paths, at most 5 cm apart: field,goal,planner,s_m,x_m,y_m,heading_rad,direction.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub paths: Option<PathBuf>,
    /// Write a benchmark log of OMPL, for Planner Arena.
    #[arg(help_heading = "Output", long, value_name = "FILE.log")]
    pub ompl: Option<PathBuf>,
    /// Draw field and paths; of several fields into a file each, FILE-FIELD.png.
    #[arg(help_heading = "Output", long, value_name = "FILE.png")]
    pub png: Option<PathBuf>,
}

fn goal_count(text: &str) -> Result<usize, String> {
    let count = numbers::parse(text).filter(|count| (1..=MAX_GOALS).contains(count));
    count.ok_or_else(|| format!("expected a whole number from 1 to {MAX_GOALS}"))
}
