//! `wildfire fork`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use crate::cli::args::{ScenarioArguments, SeededArguments};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::numbers;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::report::FormArguments;
use crate::cli::run::{RunReport, check_agents, write_recording};
use crate::cli::show::{note_beyond_end, parse_agent, source_of_runs};
use crate::cli::terminal;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_base::time::wall::WallStopwatch;
use wildfire_batch::execute::{RunResult, RunRow};
use wildfire_batch::plan::RunLabel;
use wildfire_sim::policies::Action;
use wildfire_sim::{Run, Simulation};
use wildfire_timeline::{AgentId, Outcome};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire fork contest --seed 7 --at 350 --answer unimog/0=35,44 --out other.wildfire
  wildfire fork fleet --seed 7 --at 600 --then dispatch.policy=auction
  wildfire fork runs/fleets --seed 3 --at 600 --answer unimog/1=20,31
  wildfire fork contest --seed 7 --at 900 --then unimog.planner=hybrid-astar --out b.wildfire --parent a.wildfire

Then `wildfire play a.wildfire --with b.wildfire` shows both on one clock.")]
pub struct ForkArguments {
    #[command(flatten)]
    pub run: SeededArguments,
    /// The simulated time from which on the run may differ.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, value_parser = numbers::parse_instant)]
    pub at: f64,
    /// Change a value of the scenario from then on: a planner of trucks, its settings, a policy; may be repeated.
    #[arg(long = "then", value_name = "KEY=VALUE")]
    pub changes: Vec<String>,
    /// Send an agent to this cell when it decides next, such as `unimog/0=35,44` (column, row).
    #[arg(long, value_name = "AGENT=CELL", value_parser = parse_answer)]
    pub answer: Option<(AgentId, Cell)>,
    #[command(flatten)]
    pub form: FormArguments,
    /// Record the forked run into this file.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Record the run as it was without the fork into this file.
    #[arg(long, value_name = "FILE")]
    pub parent: Option<PathBuf>,
}

fn parse_answer(text: &str) -> Result<(AgentId, Cell), String> {
    let answer = text.split_once('=').and_then(|(agent, cell)| {
        let (col, row) = cell.split_once(',')?;
        let col = numbers::parse(col.trim())?;
        let row = numbers::parse(row.trim())?;
        Some((parse_agent(agent).ok()?, Cell { col, row }))
    });
    answer.ok_or_else(|| "expected AGENT=COLUMN,ROW, such as unimog/0=35,44".to_owned())
}

pub fn run(arguments: &ForkArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let ForkArguments { at, answer, .. } = *arguments;
    let ScenarioArguments { source: name, overrides, .. } = &arguments.run.scenario;
    let seed = arguments.run.seed.unwrap_or(1);
    let memory = &arguments.run.memory;
    let source = source_of_runs(name, overrides, memory.memory, context)?;
    let before = source.expect_scenario(name, context)?;
    context.expect_trusted(before)?;
    let after = if arguments.changes.is_empty() {
        before.clone()
    } else {
        // The changes come last, so that they win over those of the parent's scenario.
        let changes = [&overrides[..], &arguments.changes].concat();
        source_of_runs(name, &changes, memory.memory, context)?.expect_scenario(name, context)?.clone()
    };
    context.note_doubts([before, &after]);
    if let Some((agent, _)) = answer {
        check_agents("--answer", &[agent], before)?;
    }
    let files = Files { form: arguments.form, ..Files::default() }
        .writing([(Format::Recording, &arguments.out), (Format::Recording, &arguments.parent)]);
    let stream = files.check()?;

    // A run starts programs and may take long, so files are checked before it.
    let options = context.run_options(false, memory.limit());
    let stopwatch = WallStopwatch::start();
    let mut cpu = CpuStopwatch::start();
    let mut parent = Simulation::with(before, seed, &options).map_err(CliError::run_failed)?;
    if at > 0.0 {
        // One nanosecond less, so that decisions due at that time are still open.
        parent.advance_to(SimTime::from_seconds(at) - SimTime::from_nanos(1));
    }
    if parent.has_ended() && !context.quiet {
        terminal::note(&note_beyond_end("--at", SimTime::from_seconds(at), parent.now()));
    }
    let fork = if arguments.changes.is_empty() {
        parent.fork().map_err(CliError::run_failed)?
    } else {
        parent.fork_into(before, &after, &options).map_err(|error| CliError::bad_input(error, None))?
    };
    let mut fork = ended(fork, answer)?;
    // Parent and fork share the time until the change, so it counts for the fork.
    fork.cost.total = cpu.elapsed_since_last() + fork.cost.elsewhere();
    let row = RunRow::done(RunLabel::from_scenario(&after, seed), result_of(&fork), stopwatch.elapsed());
    // Only now, as the fork is made from its state at the time of the change.
    let parent = ended(parent, None)?;
    let burned = Outcome::new(&fork.timeline).burned();
    let was = Outcome::new(&parent.timeline).burned();
    let verdict = match burned.cmp(&was) {
        std::cmp::Ordering::Less => format!("{} fewer than without the change", was - burned),
        std::cmp::Ordering::Equal => "as many as without the change".to_owned(),
        std::cmp::Ordering::Greater => format!("{} more than without the change", burned - was),
    };
    stream.print(&arguments.form.render(&RunReport { row }))?;
    if arguments.form.is_text() {
        stream.print(&format!("{burned} bushes burned, {verdict}.\n"))?;
    }
    for (path, run) in [(&arguments.out, &fork), (&arguments.parent, &parent)] {
        if let Some(path) = path {
            write_recording(path, &run.timeline)?;
            output_files::note_written(path, context.quiet);
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn result_of(run: &Run) -> RunResult {
    RunResult { asks: run.asks, ..RunResult::new(Outcome::new(&run.timeline), run.cost.clone()) }
}

/// Plays a run to its end, with an answer that an agent is given.
fn ended(mut run: Simulation, answer: Option<(AgentId, Cell)>) -> Result<Run, CliError> {
    if let Some((agent, cell)) = answer {
        run.force(agent, Action::Go(cell));
    }
    run.advance_to(SimTime::MAX);
    run.expect_within_memory().map_err(CliError::run_failed)?;
    match answer {
        Some((agent, cell)) if run.forced_at().is_none() => {
            let sentence = format!(
                "--answer sends {agent} to ({}, {}), which it could not go for when it decided next",
                cell.col, cell.row
            );
            let help = "`wildfire why` lists what each decision chose from; a cell is column and row";
            Err(CliError::bad_input(sentence, Some(help)))
        }
        _ => Ok(run.finish()),
    }
}
