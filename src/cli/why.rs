//! `wildfire why`.

use std::num::NonZeroUsize;
use std::process::ExitCode;

use clap::Args;

use crate::cli::args::{MemoryArguments, ScenarioArguments, jobs_or_all, parse_jobs, parse_seed};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::report::FormArguments;
use crate::cli::run::check_agents;
use crate::cli::show::parse_agent;
use crate::cli::terminal::Progress;
use crate::cli::{numbers, terminal};
use wildfire_base::time::SimTime;
use wildfire_batch::{ChosenDecisions, limit_threads};
use wildfire_sim::scenario;
use wildfire_timeline::AgentId;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire why fleet --seed 7 --sample 40
  wildfire why contest --seed 7 --agent unimog/0 --from 600 --to 900
  wildfire why contest --seed 7 --agent wumpus/0 --json > worth.json

The run is forked before each decision and goes on with every other choice there was, in
several futures: what is left to chance afterwards is drawn again, alike for all choices.")]
pub struct WhyArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// The seed of everything random in the run.
    #[arg(short, long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    /// Judge the decisions of this agent, such as `unimog/0`; may be repeated [default: all trucks].
    #[arg(long = "agent", value_name = "AGENT", value_parser = parse_agent)]
    pub agents: Vec<AgentId>,
    /// Judge decisions from this simulated time on.
    #[arg(long, value_name = "SECONDS", default_value = "0", allow_hyphen_values = true, value_parser = numbers::parse_instant)]
    pub from: f64,
    /// Judge decisions up to this simulated time [default: the end].
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = numbers::parse_instant)]
    pub to: Option<f64>,
    /// Judge at most so many decisions, spread evenly over the run.
    #[arg(long, value_name = "DECISIONS", allow_hyphen_values = true, value_parser = parse_sample)]
    pub sample: Option<usize>,
    /// Play at most so many choices of a decision: the one that was taken, and the cells nearest to the agent.
    #[arg(long, default_value_t = 5, allow_hyphen_values = true, value_parser = parse_choices)]
    pub choices: usize,
    /// Play each choice in at most so many futures.
    #[arg(long, default_value_t = 20, allow_hyphen_values = true, value_parser = parse_futures)]
    pub futures: u32,
    /// Number of threads [default: the number of processors].
    #[arg(short, long, env = "WILDFIRE_JOBS", allow_hyphen_values = true, value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    #[command(flatten)]
    pub form: FormArguments,
}

fn parse_sample(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(1..=1_000_000), "a whole number")
}

fn parse_choices(text: &str) -> Result<usize, String> {
    numbers::parse_within(text, &(2..=1000), "a whole number")
}

fn parse_futures(text: &str) -> Result<u32, String> {
    numbers::parse_within(text, &(4..=10_000), "a whole number")
}

pub fn run(arguments: &WhyArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let changes = context.with_own_names(&arguments.scenario.overrides);
    let scenario = scenario::load(&arguments.scenario.source, &changes)?;
    context.expect_trusted(&scenario)?;
    context.note_doubts([&scenario]);
    check_agents("--agent", &arguments.agents, &scenario)?;
    let chosen = ChosenDecisions {
        agents: arguments.agents.clone(),
        from: SimTime::from_seconds(arguments.from),
        to: arguments.to.map_or(SimTime::MAX, SimTime::from_seconds),
        sample: arguments.sample,
        choices: arguments.choices,
        futures: arguments.futures,
    };
    limit_threads(jobs_or_all(arguments.jobs));
    let options = context.run_options(false, arguments.memory.limit());
    let progress = Progress::new(0, "decisions", context.quiet);
    let judged = chosen.judge(&scenario, arguments.seed, &options, |count| {
        progress.expect(count as u64);
        progress.advance();
    });
    progress.end();
    let report = judged.map_err(CliError::run_failed)?;
    terminal::print(&arguments.form.render(&report))?;
    Ok(ExitCode::SUCCESS)
}
