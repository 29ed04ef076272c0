//! `wildfire why`.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

use clap::Args;

use crate::cli::args::{ScenarioArguments, SeededArguments, jobs_or_all, parse_jobs};
use crate::cli::batch::{SeedsArgument, parse_seeds, play_plan};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::output_files;
use crate::cli::report::FormArguments;
use crate::cli::run::check_agents;
use crate::cli::show::{Source, parse_agent, source_of_runs};
use crate::cli::terminal::Progress;
use crate::cli::{numbers, terminal};
use serde::{Serialize, Serializer};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::object;
use wildfire_base::time::SimTime;
use wildfire_batch::decisions::{DecisionTally, JudgeError, JudgeProgress, SelectedDecisions, judge_batch};
use wildfire_batch::execute::{DECISIONS_PARQUET, limit_threads};
use wildfire_batch::plan::BatchRequest;
use wildfire_batch::table::FinishedBatch;
use wildfire_scenario::ScenarioText;
use wildfire_sim::RunOptions;
use wildfire_timeline::AgentId;

/// The parts of CreditBench: a name, a plan, and the number of decisions of each run that are judged.
const CREDIT_BENCH: [(&str, &str, usize); 3] = [
    ("solo", include_str!("../../assets/credit/solo.toml"), 60),
    ("fleet", include_str!("../../assets/credit/fleet.toml"), 4),
    ("duel", include_str!("../../assets/credit/duel.toml"), 1),
];
const CREDIT_BENCH_CHOICES: usize = 10;
const CREDIT_BENCH_FUTURES: u32 = 8;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire why fleet --seed 7 --decisions 40
  wildfire why contest --seed 7 --agent unimog/0 --from 600 --to 900
  wildfire why contest --seed 7 --agent wumpus/0 --format json > worth.json
  wildfire why runs/fleets --decisions 5
  wildfire why --bench credit --seeds 1..2

The run is forked before each decision and goes on with the nearest other choices, in
several resampled futures, the same ones for all choices.

Without --seed all runs of the folder of a batch are judged, and decisions.parquet in it gets a row for each
choice that was not taken; `batch --decisions` does the same when its runs are done. --bench makes
CreditBench: runs of the program's own plans, judged.")]
pub struct WhyArguments {
    #[command(flatten)]
    pub run: SeededArguments,
    /// Judge the decisions of this agent, such as `unimog/0`; may be repeated [default: all trucks].
    #[arg(long = "agent", value_name = "AGENT", value_parser = parse_agent)]
    pub agents: Vec<AgentId>,
    /// Judge decisions from this simulated time on.
    #[arg(long, value_name = "SECONDS", default_value = "0", allow_hyphen_values = true, value_parser = numbers::parse_instant)]
    pub from: f64,
    /// Judge decisions up to this simulated time [default: the end].
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = numbers::parse_instant)]
    pub to: Option<f64>,
    /// The most decisions that are judged, spread evenly over the run.
    #[arg(long = "decisions", alias = "sample", value_name = "N", allow_hyphen_values = true, value_parser = parse_sample)]
    pub sample: Option<usize>,
    /// The most choices of a decision that are played: the one that was taken, and the cells nearest to the agent.
    #[arg(long, default_value_t = SelectedDecisions::CHOICES, allow_hyphen_values = true, value_parser = parse_choices)]
    pub choices: usize,
    /// The most futures in which each choice is played.
    #[arg(long, default_value_t = SelectedDecisions::FUTURES, allow_hyphen_values = true, value_parser = parse_futures)]
    pub futures: u32,
    /// Play the runs of CreditBench and judge their decisions, into the new folders DIR/solo, DIR/fleet and DIR/duel.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["source", "overrides", "seed", "agents", "choices", "futures"])]
    pub bench: Option<PathBuf>,
    /// Play only these seeds of CreditBench [default: 1..32].
    #[arg(long, requires = "bench", allow_hyphen_values = true, value_parser = parse_seeds)]
    pub seeds: Option<SeedsArgument>,
    /// Number of threads [default: the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    pub form: FormArguments,
}

pub fn parse_sample(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(1..=1_000_000), "a whole number")
}

fn parse_choices(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(2..=1000), "a whole number")
}

fn parse_futures(text: &str) -> Result<u32, String> {
    numbers::parse_within(text, &(4..=10_000), "a whole number")
}

/// Lists which decisions are judged, and how closely.
fn selection(arguments: &WhyArguments) -> SelectedDecisions {
    SelectedDecisions {
        agents: arguments.agents.clone(),
        from: SimTime::from_seconds(arguments.from),
        to: arguments.to.map_or(SimTime::MAX, SimTime::from_seconds),
        sample: arguments.sample,
        choices: arguments.choices,
        futures: arguments.futures,
    }
}

pub fn run(arguments: &WhyArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let ScenarioArguments { source: name, overrides, .. } = &arguments.run.scenario;
    limit_threads(jobs_or_all(arguments.jobs));
    if let Some(folder) = &arguments.bench {
        arguments.form.expect_no_json_with("--bench", true)?;
        return make_credit_bench(folder, arguments, context);
    }
    let source = source_of_runs(name, overrides, arguments.run.memory.memory, context)?;
    // Without a seed a folder of a batch means all of its runs.
    if let (Source::Batch { batch, options, .. }, None) = (&source, arguments.run.seed) {
        context.expect_trusted_plan(batch.plan())?;
        batch.plan().variants.iter().try_for_each(|it| check_agents("--agent", &arguments.agents, &it.scenario))?;
        judge_runs(batch, &selection(arguments), options, arguments.form, context)?;
        return Ok(ExitCode::SUCCESS);
    }
    let scenario = source.expect_scenario(name, context)?;
    context.expect_trusted(scenario)?;
    context.note_doubts([scenario]);
    check_agents("--agent", &arguments.agents, scenario)?;
    let options = context.run_options(false, arguments.run.memory.limit());
    let progress = Progress::new(0, "decisions", context.quiet);
    let started = AtomicU64::new(0);
    let futures = arguments.futures;
    let judged =
        selection(arguments).judge(scenario, arguments.run.seed.unwrap_or(1), &options, |judging| match judging {
            JudgeProgress::Begins { decisions } => {
                let decisions = decisions as u64;
                // Rounds follow one another, and how many decisions the next one has is known only when it begins.
                progress.expect(started.fetch_add(decisions, Ordering::Relaxed) + decisions);
            }
            JudgeProgress::Played => progress.advance(),
            JudgeProgress::Interim { futures: played, report } if arguments.form.is_text() => {
                let text = Document::from(report).to_text();
                progress.preview(&format!("So far, after {played} of at most {futures} futures:\n{text}\n"));
            }
            JudgeProgress::Interim { .. } => {}
        });
    progress.end();
    let report = judged.map_err(CliError::run_failed)?;
    terminal::print(&arguments.form.render(&report))?;
    Ok(ExitCode::SUCCESS)
}

/// Plays and judges the runs of CreditBench, each part in a folder of its own.
fn make_credit_bench(folder: &Path, arguments: &WhyArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    for (name, text, decisions) in CREDIT_BENCH {
        let text = ScenarioText::from_bytes(&format!("{name}.toml"), Ok(text.as_bytes().to_vec()))?;
        let mut request = BatchRequest::from_text(&text)?.expect("it is a plan");
        if let Some(seeds) = &arguments.seeds {
            request.seeds = Some(seeds.seeds()?);
        }
        let batch = play_plan(request.resolve(false)?, &folder.join(name), jobs_or_all(arguments.jobs), context)?;
        let choices = CREDIT_BENCH_CHOICES;
        let decisions = arguments.sample.unwrap_or(decisions);
        let selection =
            SelectedDecisions { choices, futures: CREDIT_BENCH_FUTURES, ..SelectedDecisions::sample(decisions) };
        let options = context.run_options(false, batch.plan().memory);
        judge_runs(&batch, &selection, &options, arguments.form, context)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Judges decisions of all runs of a batch, writes their table, and prints how many were mistakes.
pub fn judge_runs(
    batch: &FinishedBatch,
    selection: &SelectedDecisions,
    options: &RunOptions,
    form: FormArguments,
    context: &CommandContext,
) -> Result<(), CliError> {
    let progress = Progress::new(batch.count(), "runs", context.quiet);
    let judged = judge_batch(batch, selection, options, || progress.advance());
    progress.end();
    let tallies = judged.map_err(|error| match error {
        JudgeError::Run(error) => CliError::run_failed(error),
        JudgeError::File(error) => CliError::environment(error),
    })?;
    let names = batch.plan().variants.iter().map(|variant| batch.plan().title(variant));
    let report = JudgedRuns { tallies: names.zip(tallies).collect() };
    terminal::print(&form.render(&report))?;
    output_files::note_written(&batch.folder().join(DECISIONS_PARQUET), context.quiet);
    Ok(())
}

/// Numbers of judged decisions by variant.
struct JudgedRuns {
    tallies: Vec<(String, DecisionTally)>,
}

impl From<&JudgedRuns> for Document {
    fn from(report: &JudgedRuns) -> Self {
        let rows = report.tallies.iter().map(|(name, tally)| {
            let DecisionTally { runs, decisions, mistakes, good } = *tally;
            let numbers = [runs, decisions, mistakes, good].map(|number| number.to_string());
            [name.clone()].into_iter().chain(numbers).collect()
        });
        Self::new("What decisions were worth")
            .with([Block::from(Table::new(&["Variant", "Runs", "Decisions", "Mistakes", "Good"], rows.collect()))])
    }
}

impl Serialize for JudgedRuns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let variants = self.tallies.iter().map(|(variant, tally)| {
            let DecisionTally { runs, decisions, mistakes, good } = *tally;
            object!(JudgedVariant { variant: variant.clone(), runs, decisions, mistakes, good })
        });
        object!(JudgedBatch { variants: variants.collect::<Vec<_>>() }).serialize(serializer)
    }
}
