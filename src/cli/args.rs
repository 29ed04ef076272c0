//! The arguments of every command, as clap reads them.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use crate::batch::{Record, Seeds, SeedsError, Slice};
use crate::cli::compare::CompareArguments;
use crate::cli::curve::CurveArguments;
use crate::cli::error::CliError;
use crate::cli::map::MapCommand;
use crate::cli::numbers;
use crate::cli::plan::PlanArguments;
use crate::cli::play::PlayArguments;
use crate::cli::render::RenderArguments;
use crate::cli::report::FormArguments;
use crate::input_file;
use crate::scenario::MemoryLimit;

const EXAMPLES: &str = "\
Examples:
  wildfire batch                              the contest, five runs: two tables
  wildfire batch contest --seeds 1..1000      a thousand runs
  wildfire run contest --seed 7               one run: who won, what took time
  wildfire run --set unimog.prm_rs.samples=1000  another roadmap
  wildfire play contest --seed 7              watch it
  wildfire render --seed 7 --gif film.gif     draw it
  wildfire scenarios --show contest > my.toml && wildfire check my.toml
  wildfire map brushfire map.png --png fire.png   distances to obstacles
  wildfire plan field.json --planner prm-rs,hybrid-astar   compare planners

Exit codes: 0 done, 1 some run failed, 2 bad input, 3 disk or other environment,
4 an audit or a check found a violation, 75 stopped and resumable, 130 stopped.";

/// A wildfire contest between planners: a Wumpus lights bushes, a fire truck puts them out.
#[derive(Debug, Parser)]
#[command(name = "wildfire", version, after_help = EXAMPLES, max_term_width = 100)]
pub struct Arguments {
    /// Print results and errors only: no progress, no notes.
    #[arg(long, global = true)]
    pub quiet: bool,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scenario once and print who won.
    Run(RunArguments),
    /// Watch a run in a window, or two runs side by side.
    Play(PlayArguments),
    /// Draw a run without a screen: a still, a GIF, an MP4.
    Render(RenderArguments),
    /// Run scenarios with many seeds and print the tables of the contest.
    Batch(BatchArguments),
    /// Show how far a batch is.
    Status(StatusArguments),
    /// Put the slices of a batch together: check that all are there, and write its tables.
    Merge(FolderArguments),
    /// Write a report of a batch: a web page, and its charts as SVG and PNG.
    Report(FolderArguments),
    /// Compare batches, or scenarios and planners inside one, in pairs by seed.
    Compare(CompareArguments),
    /// Check finished runs against the rules: recordings, and all runs of batches.
    Audit(AuditArguments),
    /// Write a template with comments: a scenario, or the plan of a batch.
    New(NewArguments),
    /// Print what a file may say, or what columns mean, as JSON Schema.
    Schema(SchemaArguments),
    /// Explain what a scenario means, its defaults, and its terrain.
    Check(CheckArguments),
    /// List the built-in scenarios, or print one.
    Scenarios(ScenariosArguments),
    /// Compute a grid map: occupancy, brushfire, cost, wavefront, potential fields, gradient descent.
    Map {
        #[command(subcommand)]
        command: MapCommand,
    },
    /// Compute the shortest curves of a turning radius between two poses: Reeds-Shepp and Dubins.
    Curve(CurveArguments),
    /// Plan drives of the truck: any planners, on fields of yours or of a scenario, with figures and paths to check.
    Plan(PlanArguments),
    /// Print the script that completes this program's arguments in a shell.
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// A scenario and changes to it.
#[derive(Debug, Args)]
pub struct ScenarioArguments {
    /// A scenario file, or the name of a built-in scenario.
    #[arg(value_name = "SCENARIO", default_value = "contest")]
    pub source: String,
    /// Change a value of the scenario, such as `fire.burn_out_s=30`, `unimog.prm_rs.samples=1000` (all trucks) or
    /// `unimog.0.speed_mps=6` (the first); may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
}

/// Arguments of every command that simulates.
#[derive(Debug, Args)]
pub struct MemoryArguments {
    /// The memory that a run may take, such as `4GB`, `512MiB` or `4G`, which is 4 GB: one that would take more is not
    /// run [default: 2GB, or what the plan of a batch says].
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<MemoryLimit>,
}

impl MemoryArguments {
    pub fn limit(&self) -> MemoryLimit {
        self.memory.unwrap_or_default()
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire run --seed 7
  wildfire run report-2024 --seed 7 --json
  wildfire run --seed 7 --out run.wildfire --events events.csv
  wildfire run --seed 7 --trace trace.csv --step 0.1")]
pub struct RunArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// The seed of everything random in the run.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    #[command(flatten)]
    pub form: FormArguments,
    /// Write a recording of the run, into this file or folder.
    #[arg(long, value_name = "FILE_OR_DIR")]
    pub out: Option<PathBuf>,
    /// Record the searches too, so that they can be shown; the recording becomes about five times as large.
    #[arg(long, requires = "out")]
    pub record_searches: bool,
    /// Write what happened: t_s,event,agent,col,row,detail.
    #[arg(long, value_name = "FILE.csv")]
    pub events: Option<PathBuf>,
    /// Write where every agent was: t_s,agent,x_m,y_m,heading_rad,speed_mps,activity.
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<PathBuf>,
    /// Simulated seconds between two rows of the trace.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.1, requires = "trace", allow_hyphen_values = true, value_parser = parse_trace_step)]
    pub step: f64,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire batch
  wildfire batch contest --seeds 1..1000 --jobs 2
  wildfire batch my.toml --seeds 1..50,99 --out runs/tuned --force --record all
  wildfire batch --planner prm-rs,hybrid-astar --set field.coverage=0.05,0.10,0.20 --dry-run
  wildfire batch --resume runs/contest
  wildfire batch plan.toml --shard 2/5 --out runs/cluster")]
pub struct BatchArguments {
    /// Scenario files, or names of built-in scenarios [default: contest]; or one plan file.
    #[arg(value_name = "SCENARIO|PLAN.toml")]
    pub sources: Vec<String>,
    /// Change a value of the scenarios; with several values between commas, run all of them with each. Sweeps of
    /// several keys are multiplied; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE[,VALUE...]")]
    pub set: Vec<String>,
    /// Planners of the trucks: short for `--set unimog.planner=`.
    #[arg(long, value_name = "NAME[,NAME...]", value_delimiter = ',')]
    pub planner: Vec<String>,
    /// Seeds: ranges with both ends, lists, or both, such as `1..5`, `1,5,9`, `1..100,200`; or `@FILE` that holds
    /// them [default: 1..5].
    #[arg(long, allow_hyphen_values = true, value_parser = parse_seeds)]
    pub seeds: Option<SeedsArgument>,
    /// Threads [default: as many as the machine runs at once].
    #[arg(long, allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// The memory that each run may take, such as `4GB`, `512MiB` or `4G`, which is 4 GB: one that would take more is a
    /// failed row. As many runs as threads take place at once [default: 2GB].
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<MemoryLimit>,
    /// The folder for the results [default: runs/NAME, or the next free runs/NAME-2, runs/NAME-3 ...].
    #[arg(long, value_name = "DIR", group = "shared_folder")]
    pub out: Option<PathBuf>,
    /// Overwrite the results in the folder given with --out, and run more than 100000 runs if asked to.
    #[arg(long)]
    pub force: bool,
    /// Keep recordings of `all` runs, of `failed` ones, or of `none` [default: none]; failed means here that some agent
    /// was stuck: a run whose status is failed has no timeline.
    #[arg(long, value_name = "WHICH")]
    pub record: Option<Record>,
    /// List what would be run, and run nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Also print where the CPU time went, by part.
    #[arg(long)]
    pub profile: bool,
    /// Continue the batch in this folder, which was stopped.
    #[arg(
        long,
        value_name = "DIR",
        group = "shared_folder",
        conflicts_with_all = ["sources", "set", "planner", "seeds", "memory", "out", "force", "record", "dry_run"]
    )]
    pub resume: Option<PathBuf>,
    /// Run slice K of N of the plan only, in a folder that the slices share; `wildfire merge` puts them together.
    #[arg(long, value_name = "K/N", requires = "shared_folder")]
    pub shard: Option<Slice>,
}

#[derive(Debug, Args)]
pub struct NewArguments {
    /// The kind of file.
    pub what: NewFile,
    /// The file to write, which must not be there yet [default: print it].
    pub file: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum NewFile {
    Scenario,
    Plan,
}

#[derive(Debug, Args)]
pub struct SchemaArguments {
    /// Files, or tables that a batch writes.
    pub of: SchemaOf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum SchemaOf {
    Scenario,
    Plan,
    Runs,
    PlannerCalls,
    States,
}

#[derive(Debug, Args)]
pub struct StatusArguments {
    /// The folder of a batch.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    #[command(flatten)]
    pub form: FormArguments,
}

/// The folder of a batch.
#[derive(Debug, Args)]
pub struct FolderArguments {
    /// The folder of a batch.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire audit run.wildfire
  wildfire audit runs/contest runs/dense --jobs 2

It drives every leg once more in small steps, by other means than the planners', and
exits with 4 if a rule is violated: it prints the first violation of every run, with
time, place and rule.")]
pub struct AuditArguments {
    /// Recordings, folders with recordings, or folders of batches; what a batch did not record is simulated again from
    /// its plan.
    #[arg(value_name = "RUN|DIR", required = true)]
    pub paths: Vec<PathBuf>,
    /// Threads [default: as many as the machine runs at once].
    #[arg(long, allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// The most metres between two poses that are checked.
    #[arg(long, value_name = "METRES", default_value_t = 0.02, allow_hyphen_values = true, value_parser = parse_audit_step)]
    pub step: f64,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    /// The memory limit that the estimate is compared with [default: 2GB].
    #[arg(long, value_name = "SIZE", default_value_t, hide_default_value = true)]
    pub memory: MemoryLimit,
}

#[derive(Debug, Args)]
pub struct ScenariosArguments {
    /// Print the file of this built-in scenario.
    #[arg(long, value_name = "NAME")]
    pub show: Option<String>,
}

/// The most threads that a batch starts.
const MAX_JOBS: usize = 1024;

fn parse_jobs(text: &str) -> Result<NonZeroUsize, String> {
    let jobs = numbers::parse::<usize>(text).filter(|&jobs| jobs <= MAX_JOBS).and_then(NonZeroUsize::new);
    jobs.ok_or_else(|| format!("expected a whole number from 1 to {MAX_JOBS}"))
}

/// The most bytes of a file of seeds; with the limit on their number it keeps the memory of reading them below 64 MiB.
const MAX_SEEDS_BYTES: u64 = 8_000_000;

/// Seeds, or the file that holds them.
#[derive(Clone, Debug)]
pub enum SeedsArgument {
    Given(Seeds),
    File(PathBuf),
}

impl SeedsArgument {
    /// The seeds; in a file they are between commas, blanks and lines, and `#` begins a comment.
    pub fn seeds(&self) -> Result<Seeds, CliError> {
        let path = match self {
            Self::Given(seeds) => return Ok(seeds.clone()),
            Self::File(path) => path,
        };
        let text = input_file::read_text(path, MAX_SEEDS_BYTES).map_err(|error| CliError::unreadable(path, &error))?;
        let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
        let words = lines.flat_map(|line| line.split([',', ' ', '\t'])).filter(|word| !word.is_empty());
        Seeds::from_parts(words).map_err(|error| CliError::bad_input(format_args!("{}: {error}", path.display()), None))
    }
}

/// Seeds as they are, or `@FILE`.
fn parse_seeds(text: &str) -> Result<SeedsArgument, String> {
    match text.strip_prefix('@') {
        Some(path) => Ok(SeedsArgument::File(path.into())),
        None => text.parse().map(SeedsArgument::Given).map_err(|error: SeedsError| error.to_string()),
    }
}

pub fn parse_seed(text: &str) -> Result<u64, String> {
    numbers::parse(text).ok_or_else(|| format!("expected a whole number from 0 to {}", u64::MAX))
}

/// Reads the step of a trace; its writer decides how fine it may be.
fn parse_trace_step(text: &str) -> Result<f64, String> {
    numbers::parse(text).ok_or_else(|| "expected a number of seconds".to_owned())
}

/// The distances between checked poses that an audit takes, metres.
const AUDIT_STEPS_M: RangeInclusive<f64> = 0.001..=1.0;

fn parse_audit_step(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &AUDIT_STEPS_M, "metres")
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn arguments_are_defined_without_contradictions() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn seeds_of_a_file_stand_between_commas_blanks_and_lines() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("seeds");
        std::fs::write(&path, "# mine\n1..3, 7\n9 8 # two\n\n").expect("writable");
        let argument = parse_seeds(&format!("@{}", path.display())).expect("any file will do");
        assert_eq!(argument.seeds().expect("these seeds are fine").to_string(), "1..3,7,9,8");
        std::fs::write(&path, "# none\n").expect("writable");
        assert!(argument.seeds().is_err());
    }
}
