//! The arguments of `wildfire batch`.

use std::env;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;

use super::keeping::KeepingArguments;
use crate::cli::args::{ProgramArguments, parse_jobs};
use crate::cli::error::CliError;
use crate::cli::numbers;
use crate::cli::report::FormArguments;
use crate::cli::why::parse_sample;
use wildfire_base::input_file;
use wildfire_batch::plan::{MAX_SEEDS_BYTES, MAX_SLICES, Record, Seeds, SeedsError, Slice};
use wildfire_batch::stopping::{StopRequest, Until};
use wildfire_scenario::MemoryLimit;

/// The folder, in the current one, that holds a folder for each batch.
pub const RUNS_FOLDER: &str = "runs";

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire batch
  wildfire batch contest --seeds 1..1000 --jobs 2
  wildfire batch my.toml --seeds 1..50,99 --out runs/tuned --force --record all
  wildfire batch --planner prm-rs,hybrid-astar --set field.coverage=0.05,0.10,0.20 --dry-run
  wildfire batch --planner prm-rs,hybrid-astar --until decided
  wildfire batch --resume runs/contest
  wildfire batch --rules official.toml --entry anna.toml ben.toml --out runs/course
  wildfire batch --rules official.toml --entry *.toml --until groups --out runs/course
  wildfire batch plan.toml --shard 2/5 --out runs/cluster
  wildfire batch plan.toml --array-env SGE_TASK_ID --slices 40 --out runs/cluster
  wildfire batch plan.toml --out runs/cluster --slurm > fleet.sh && bash fleet.sh")]
pub struct BatchArguments {
    /// Scenario files, or names of built-in scenarios [default: contest]; or one plan file.
    #[arg(value_name = "SCENARIO|PLAN.toml")]
    pub sources: Vec<String>,
    /// Change a value of the scenarios, or sweep a list `A,B` or a range `FIRST..LAST:STEP`; sweeps of several keys run
    /// all combinations. May be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE[,VALUE...]")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub programs: ProgramArguments,
    /// Planners of the trucks: short for `--set unimog.planner=`.
    #[arg(long, value_name = "NAME[,NAME...]", value_delimiter = ',')]
    pub planner: Vec<String>,
    /// Rules of a course: they fix all values except those they free for entries.
    #[arg(
        long,
        value_name = "FILE.toml",
        requires = "entry",
        conflicts_with_all = ["sources", "set", "planner", "memory", "slice"]
    )]
    pub rules: Option<PathBuf>,
    /// Entry files, with the values that the rules leave free; all run with the same seeds.
    #[arg(long, alias = "agent", value_name = "FILE.toml", num_args = 1.., requires = "rules")]
    pub entry: Vec<PathBuf>,
    /// Skip entries whose files are invalid and run the others; the exit code is then 1.
    #[arg(long, requires = "rules")]
    pub skip_refused: bool,
    /// Seeds: inclusive ranges and lists, such as `1..5`, `1,5,9` or `1..100,200`; or `@FILE` to read them from a file
    /// [default: 1..5].
    #[arg(short, long, allow_hyphen_values = true, value_parser = parse_seeds)]
    pub seeds: Option<SeedsArgument>,
    /// Stop when this is known: `decided`, which of two variants has more of the metric, for each pair; `groups`, which
    /// entries are the best, while those that are worse are dropped; or `METRIC=HALF-WIDTH`, the difference of each pair,
    /// or the mean of each variant. Looks at 20, 30, 40 ... seeds; --seeds are the most [default: 1..1000]. For a fixed
    /// number of seeds see `wildfire compare --power`.
    #[arg(
        long,
        value_name = "WHAT",
        value_parser = Until::from_str,
        conflicts_with_all = ["resume", "slice", "slurm"]
    )]
    pub until: Option<Until>,
    /// The metric of `--until decided` and `groups` [default: saved].
    #[arg(long, value_name = "NAME", requires = "until")]
    pub metric: Option<String>,
    /// With `--until decided` and `groups`: a pair is also decided once it is known to differ by less than this.
    #[arg(long, value_name = "MARGIN", requires = "until", value_parser = parse_margin)]
    pub equivalent: Option<f64>,
    /// Number of threads [default: SLURM_CPUS_PER_TASK in a Slurm task, else the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Memory limit of each run, such as `4GB`, `512MiB` or `4G` (4 GB); a run that would exceed it becomes a failed
    /// row. Every thread runs one run at a time [default: 2GB].
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<MemoryLimit>,
    /// Output folder [default: runs/NAME, or the next free runs/NAME-2, runs/NAME-3 ...].
    #[arg(short, long, value_name = "DIR", group = "shared_folder")]
    pub out: Option<PathBuf>,
    /// Overwrite results in the --out folder, and allow more than 100000 runs.
    #[arg(long)]
    pub force: bool,
    /// Record `all` runs, `failed` runs, or `none` [default: none]; `failed` here means runs in which an agent got
    /// stuck (runs with status `failed` have nothing to record).
    #[arg(long, value_name = "WHICH")]
    pub record: Option<Record>,
    /// Judge this number of decisions of each run when all runs are done, and write decisions.parquet.
    #[arg(long = "decisions", alias = "why", value_name = "N", allow_hyphen_values = true, value_parser = parse_sample)]
    pub why: Option<usize>,
    /// List the planned runs without running them.
    #[arg(long)]
    pub dry_run: bool,
    /// Also print the CPU time of each part.
    #[arg(long)]
    pub profile: bool,
    /// Resume the stopped batch in this folder.
    #[arg(
        long,
        value_name = "DIR",
        group = "shared_folder",
        conflicts_with_all = ["sources", "set", "planner", "rules", "seeds", "memory", "out", "force", "record", "dry_run", "commands"]
    )]
    pub resume: Option<PathBuf>,
    /// Run only slice K of N of the plan, in a folder that all slices share; `wildfire merge` merges them.
    #[arg(long, value_name = "K/N", requires = "shared_folder", group = "slice")]
    pub shard: Option<Slice>,
    /// Run the slice of an array job's task: the variable in which the scheduler passes the number of the task, such as
    /// SLURM_ARRAY_TASK_ID, PBS_ARRAY_INDEX, SGE_TASK_ID or LSB_JOBINDEX.
    #[arg(long, value_name = "VARIABLE", requires_all = ["shared_folder", "slices"], group = "slice")]
    pub array_env: Option<String>,
    /// The number of tasks of the array: one for each slice.
    #[arg(long, value_name = "N", requires = "array_env", value_parser = parse_slices)]
    pub slices: Option<u64>,
    /// The number of the array's first task: 0 for JOB_COMPLETION_INDEX of Kubernetes and AWS_BATCH_JOB_ARRAY_INDEX.
    #[arg(long, value_name = "N", default_value = "1", requires = "array_env", value_parser = parse_first)]
    pub first: u64,
    #[command(flatten)]
    pub keeping: KeepingArguments,
    #[command(flatten)]
    pub slurm: SlurmArguments,
    #[command(flatten)]
    pub form: FormArguments,
}

impl BatchArguments {
    /// Returns the slice that is asked for, by its number or by that of the task that this process is.
    ///
    /// # Errors
    /// If the variable for the task does not hold the number of one.
    pub fn slice(&self) -> Result<Slice, CliError> {
        let (Some(variable), Some(slices)) = (&self.array_env, self.slices) else {
            return Ok(self.shard.unwrap_or(Slice::WHOLE));
        };
        let value = env::var_os(variable);
        let number = value.as_ref().and_then(|value| value.to_str()?.parse::<u64>().ok());
        let place = number.and_then(|number| number.checked_sub(self.first)?.checked_add(1));
        place.and_then(|place| Slice::new(place, slices)).ok_or_else(|| {
            let found = value.map_or("not set".into(), |value| format!("`{}`", value.display()));
            let tasks = format!("from {} to {}", self.first, self.first + slices - 1);
            let help = format!("the scheduler sets it in tasks of an array; number them {tasks}, or see --first");
            let sentence = format!("{variable} is {found}; expected the number of a task, {tasks}");
            CliError::bad_input(sentence, Some(&help))
        })
    }
}

fn parse_margin(text: &str) -> Result<f64, String> {
    let number = numbers::parse::<f64>(text).filter(|number| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "expected a number above zero, in the unit of the metric".into())
}

impl BatchArguments {
    /// Returns what the batch is to know before it stops.
    pub fn stop_request(&self) -> Option<StopRequest> {
        let until = self.until.clone()?;
        Some(StopRequest { until, metric: self.metric.clone(), equivalent: self.equivalent })
    }
}

/// Seeds, or the file that holds them.
#[derive(Clone, Debug)]
pub enum SeedsArgument {
    Listed(Seeds),
    File(PathBuf),
}

impl SeedsArgument {
    /// The seeds; in a file they are between commas, blanks and lines, and `#` begins a comment.
    pub fn seeds(&self) -> Result<Seeds, CliError> {
        let path = match self {
            Self::Listed(seeds) => return Ok(seeds.clone()),
            Self::File(path) => path,
        };
        let text = input_file::read_text(path, MAX_SEEDS_BYTES).map_err(|error| CliError::unreadable(path, &error))?;
        Seeds::from_file_text(&text)
            .map_err(|error| CliError::bad_input(format_args!("{}: {error}", path.display()), None))
    }
}

/// Seeds as they are, or `@FILE`.
pub fn parse_seeds(text: &str) -> Result<SeedsArgument, String> {
    match text.strip_prefix('@') {
        Some(path) => Ok(SeedsArgument::File(path.into())),
        None => text.parse().map(SeedsArgument::Listed).map_err(|error: SeedsError| error.to_string()),
    }
}

/// The tasks of a batch on a cluster.
#[derive(Debug, Args)]
pub struct SlurmArguments {
    /// Print a Slurm script that runs the batch; only a short pilot runs now, to size the tasks.
    #[arg(
        help_heading = "Slurm",
        long,
        conflicts_with_all = ["resume", "slice", "rules", "dry_run", "profile", "report_form"]
    )]
    pub slurm: bool,
    /// Target duration of a task in minutes, or as `h:mm:ss`.
    #[arg(help_heading = "Slurm", long, value_name = "MINUTES", default_value = "30", requires = "slurm", value_parser = parse_minutes)]
    pub target_minutes: f64,
    /// Largest number of tasks; if it is too low, each takes longer.
    #[arg(help_heading = "Slurm", long, value_name = "N", default_value = "200", requires = "slurm", value_parser = parse_tasks)]
    pub max_tasks: u64,
}

fn parse_slices(text: &str) -> Result<u64, String> {
    numbers::parse_within(text, &(1..=MAX_SLICES), "a whole number")
}

fn parse_first(text: &str) -> Result<u64, String> {
    numbers::parse_within(text, &(0..=MAX_SLICES), "a whole number")
}

fn parse_minutes(text: &str) -> Result<f64, String> {
    let minutes = numbers::parse_time(text).filter(|_| text.contains(':')).map(|seconds| (seconds / 60.0).to_string());
    numbers::parse_within(minutes.as_deref().unwrap_or(text), &(0.01..=10_000.0), "minutes")
}

fn parse_tasks(text: &str) -> Result<u64, String> {
    numbers::parse_within(text, &(2..=10_000), "a whole number")
}

#[cfg(test)]
mod tests {
    use super::*;

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
