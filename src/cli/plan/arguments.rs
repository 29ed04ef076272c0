//! The arguments of `wildfire plan`, and of `wildfire plan report`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::cli::args::{MemoryArguments, PaperArguments, ProgramArguments, parse_jobs, parse_seed};
use crate::cli::batch::{SeedsArgument, parse_seeds};
use crate::cli::numbers;
use crate::cli::report::FormArguments;
use crate::cli::together::TogetherArguments;
use wildfire_batch::drives::DriveProblems;
use wildfire_planning::{PlannerName, TruckPlannerKind};
use wildfire_scenario::MAX_GOALS;

const EXAMPLES: &str = "\
Examples:
  wildfire plan
  wildfire plan --goals 5 --planner prm-rs,hybrid-astar --png drives.png
  wildfire plan --scenario dense --seed 7 --cells 50
  wildfire plan field_*.json --planner hybrid-astar --csv drives.csv
  wildfire plan field.json --set unimog.hybrid.shortcuts=0 --paths paths.csv
  wildfire plan field.json --planner hybrid-astar --certify bounds.json
  wildfire plan --seeds 1..30 --set field.coverage=0.05,0.10 --planner all --out bench
  wildfire plan report bench --pdf
  wildfire plan --together instances --mode benchmark --csv together.csv";

#[derive(Debug, Args)]
#[command(
    after_help = format!("Planners: {}.\n\n{EXAMPLES}", TruckPlannerKind::names()),
    args_conflicts_with_subcommands = true,
    disable_help_subcommand = true
)]
pub struct PlanArguments {
    #[command(subcommand)]
    pub command: Option<PlanCommand>,
    #[command(flatten)]
    pub problems: ProblemArguments,
    /// Planner; several names (with commas or repeated) are compared, and `all` means every known planner [default: the
    /// scenario's].
    #[arg(long = "planner", value_name = "NAME", value_delimiter = ',')]
    pub planners: Vec<PlannerName>,
    /// Scenario whose first truck's settings the planners use: a file, or a built-in name.
    #[arg(long, value_name = "SCENARIO", default_value = "drives")]
    pub scenario: String,
    /// Change a value of the scenario, such as `unimog.hybrid.clearance_m=1`, or sweep a list `A,B`; sweeps of several
    /// keys run all combinations. May be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE[,VALUE...]")]
    pub overrides: Vec<String>,
    /// Several seeds, each with its own field, goals and random numbers: inclusive ranges and lists, such as `1..30` or
    /// `1,5,9`; or `@FILE` to read them from a file.
    #[arg(long, conflicts_with = "seed", allow_hyphen_values = true, value_parser = parse_seeds)]
    pub seeds: Option<SeedsArgument>,
    /// Number of threads of a benchmark; several inflate the CPU times [default: 1].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Write all queries and a page with tables and charts into this folder; `wildfire plan report DIR` writes the page again.
    #[arg(short = 'o', long = "out", alias = "report", value_name = "DIR")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    pub programs: ProgramArguments,
    /// Query all planners twice, programs in a new process, and report whether the answers are bit-identical.
    #[arg(long)]
    pub repeat: bool,
    #[command(flatten)]
    pub memory: MemoryArguments,
    #[command(flatten)]
    pub form: FormArguments,
    /// Write a row for each goal and planner.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Write poses along the paths, at most 5 cm apart: field,goal,planner,s_m,x_m,y_m,heading_rad,direction.
    #[arg(long, value_name = "FILE.csv")]
    pub paths: Option<PathBuf>,
    /// Write an OMPL benchmark log, for Planner Arena.
    #[arg(long, value_name = "FILE.log")]
    pub ompl: Option<PathBuf>,
    /// Draw field and paths; several fields go to separate files, FILE-FIELD.png.
    #[arg(long, value_name = "FILE.png")]
    pub png: Option<PathBuf>,
    /// Write lower bounds on the lengths of all paths to goal poses, with proofs that `wildfire judge --certificate` checks,
    /// and add the column `certified_bound_m`.
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["seeds", "jobs", "report"])]
    pub certify: Option<PathBuf>,
    #[command(flatten)]
    pub together: TogetherArguments,
}

/// Commands on what was planned before.
#[derive(Debug, Subcommand)]
pub enum PlanCommand {
    /// Write a page about a table of queries: medians, box plots, and curves over swept keys.
    Report(PlanReportArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire plan --seeds 1..30 --planner all --csv drives.csv
  wildfire plan report drives.csv --out drives.html
  wildfire plan report bench --pdf --width-mm 88")]
pub struct PlanReportArguments {
    /// A table that `wildfire plan --csv` wrote, or a folder that `wildfire plan --out` filled.
    #[arg(value_name = "FILE.csv|DIR")]
    pub source: PathBuf,
    /// The page [default: FILE.html beside the table, or report.html in the folder]; its charts are in a folder beside it.
    #[arg(short, long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub paper: PaperArguments,
}

/// The fields to plan on, and the goals there.
#[derive(Debug, Args)]
pub struct ProblemArguments {
    /// Field files: JSON with bushes, start and goals [default: the scenario's field for the seed].
    #[arg(value_name = "FIELD.json")]
    pub fields: Vec<PathBuf>,
    /// The seed of everything random.
    #[arg(short, long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    /// Number of random free goal poses on the scenario's field [default: 50].
    #[arg(help_heading = "Goals", long, value_name = "N", conflicts_with = "fields", value_parser = goal_count)]
    pub goals: Option<usize>,
    /// Number of random goal bushes on each field instead; a drive must end near enough to put out a fire there
    /// (`suppression.reach_m`), at any heading.
    #[arg(help_heading = "Goals", long, value_name = "N", conflicts_with = "goals", value_parser = goal_count)]
    pub cells: Option<usize>,
}

impl ProblemArguments {
    pub fn problems(&self) -> DriveProblems {
        DriveProblems { fields: self.fields.clone(), goals: self.goals, cells: self.cells }
    }
}

pub fn goal_count(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(1..=MAX_GOALS), "a whole number")
}
