//! The arguments of every command, as clap reads them.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use crate::batch::{Record, Seeds};
use crate::cli::compare::CompareArguments;
use crate::cli::curve::CurveArguments;
use crate::cli::map::MapCommand;
use crate::cli::plan::PlanArguments;

const EXAMPLES: &str = "\
Examples:
  wildfire batch                              the contest, five runs: two tables
  wildfire batch contest --seeds 1..1000      a thousand runs
  wildfire run contest --seed 7               one run: who won, what took time
  wildfire run --set unimog.prm_rs.samples=1000  another roadmap
  wildfire scenarios --show contest > my.toml && wildfire check my.toml
  wildfire map brushfire map.png --png fire.png   distances to obstacles
  wildfire plan field.json --planner prm-rs,hybrid-astar   compare planners

Exit codes: 0 done, 1 some run failed, 2 bad input, 3 disk or other environment,
4 an audit or a check found an offence, 130 stopped with Ctrl-C.";

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
    /// Run a scenario with many seeds and print the tables of the contest.
    Batch(BatchArguments),
    /// Compare batches, or scenarios and planners inside one, in pairs by seed.
    Compare(CompareArguments),
    /// Hold finished runs against the rules: recordings, and all runs of batches.
    Audit(AuditArguments),
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

/// What every command that takes a scenario takes.
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
    /// The seed from which all that is random in the run follows.
    #[arg(long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    /// Print the result as one JSON object.
    #[arg(long)]
    pub json: bool,
    /// Write a recording of the run, into this file or folder.
    #[arg(long, value_name = "FILE_OR_DIR")]
    pub out: Option<PathBuf>,
    /// Write what happened: t_s,event,agent,col,row,detail.
    #[arg(long, value_name = "FILE.csv")]
    pub events: Option<PathBuf>,
    /// Write where every agent was: t_s,agent,x_m,y_m,heading_rad,speed_mps,activity.
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<PathBuf>,
    /// Simulated seconds between two rows of the trace.
    #[arg(long, value_name = "SECONDS", default_value_t = 0.1, requires = "trace", allow_hyphen_values = true)]
    pub step: f64,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire batch
  wildfire batch contest --seeds 1..1000 --jobs 2
  wildfire batch my.toml --seeds 1..50,99 --out runs/tuned --force --record all")]
pub struct BatchArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    /// Seeds: ranges with both ends, lists, or both, such as `1..5`, `1,5,9`, `1..100,200`.
    #[arg(long, default_value = "1..5", allow_hyphen_values = true)]
    pub seeds: Seeds,
    /// Threads [default: as many as the machine runs at once].
    #[arg(long, allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// The folder for the results [default: runs/NAME, or the next free runs/NAME-2, runs/NAME-3 ...].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Overwrite the results in the folder given with --out.
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Keep recordings of `all` runs, of `failed` ones, or of `none`; failed means here that some agent was stuck: a run
    /// whose status is failed has no timeline.
    #[arg(long, value_name = "WHICH", default_value = "none")]
    pub record: Record,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire audit run.wildfire
  wildfire audit runs/contest runs/dense --jobs 2

It drives every leg once more in small steps, by other means than the planners', and
exits with 4 if something is wrong: it prints the first offence of every run, with time,
place and rule.")]
pub struct AuditArguments {
    /// Recordings, folders with recordings, or folders of batches; what a batch did not record is simulated again from
    /// its plan.
    #[arg(value_name = "RUN|DIR", required = true)]
    pub paths: Vec<PathBuf>,
    /// Threads [default: as many as the machine runs at once].
    #[arg(long, allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Metres between two looks at a body on its way, at most.
    #[arg(long, value_name = "METRES", default_value_t = 0.02, allow_hyphen_values = true, value_parser = parse_audit_step)]
    pub step: f64,
}

#[derive(Debug, Args)]
pub struct CheckArguments {
    /// A scenario file, or the name of a built-in scenario.
    #[arg(value_name = "SCENARIO")]
    pub source: String,
    /// Change a value of the scenario before it is checked; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
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
    let jobs = text.parse::<usize>().ok().filter(|&jobs| jobs <= MAX_JOBS).and_then(NonZeroUsize::new);
    jobs.ok_or_else(|| format!("expected a whole number from 1 to {MAX_JOBS}"))
}

pub fn parse_seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("expected a whole number from 0 to {}", u64::MAX))
}

/// Looks of an audit are at least and at most so far apart, in metres.
const AUDIT_STEPS_M: RangeInclusive<f64> = 0.001..=1.0;

fn parse_audit_step(text: &str) -> Result<f64, String> {
    let step = text.parse().ok().filter(|step| AUDIT_STEPS_M.contains(step));
    step.ok_or_else(|| format!("expected metres from {} to {}", AUDIT_STEPS_M.start(), AUDIT_STEPS_M.end()))
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
    fn batch_without_arguments_is_the_contest_with_five_seeds() {
        let arguments = Arguments::try_parse_from(["wildfire", "batch"]).expect("nothing is required");
        let Command::Batch(batch) = arguments.command else { panic!("batch was asked for") };
        assert_eq!(batch.scenario.source, "contest");
        assert_eq!(batch.seeds.iter().collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
        assert_eq!(batch.record, Record::None);
    }
}
