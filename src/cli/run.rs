//! `wildfire run`: one run, its report, and the files that were asked for.

use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use serde::{Serialize, Serializer};

use crate::cli::args::{MemoryArguments, ScenarioArguments, parse_seed};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::export::write_export;
use crate::cli::numbers;
use crate::cli::output_files::{self, Files, Format, ReportStream};
use crate::cli::page::read_game;
use crate::cli::report::FormArguments;
use crate::cli::show::parse_agent;
use wildfire_base::document::number::{percent, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::time::wall::WallStopwatch;
use wildfire_batch::execute::{RunResult, RunRow, Status, file_name_of};
use wildfire_batch::plan::RunLabel;
use wildfire_batch::report::{Failures, RunObject, notes};
use wildfire_batch::table::RunRecord;
use wildfire_scenario::{self as scenario, Scenario};
use wildfire_sim::RunOptions;
use wildfire_sim::game::Unanswered;
use wildfire_timeline::export::{FINEST_STEP_S, Sampling, write_events, write_trace};
use wildfire_timeline::{AgentId, GroundOutcome, Outcome, Role, Timeline, Winner, file};

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  wildfire run --seed 7
  wildfire run report-2024 --seed 7 --format json
  wildfire run --seed 7 --out run.wildfire --events events.csv
  wildfire run --seed 7 --trace trace.csv --every 0.1 --agent unimog/0")]
pub struct RunArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// The seed of everything random in the run.
    #[arg(short, long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    /// Replay a game saved from a page, instead of a scenario and a seed.
    #[arg(long = "game", alias = "answers", value_name = "FILE.json", conflicts_with_all = ["source", "overrides", "seed"])]
    pub answers: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
    /// Record the run into this file or folder.
    #[arg(short, long, value_name = "FILE_OR_DIR")]
    pub out: Option<PathBuf>,
    /// Also record the planners' searches; makes the recording about five times as large.
    #[arg(long, requires = "out")]
    pub record_searches: bool,
    /// Write the events: t_s,event,agent,col,row,detail.
    #[arg(long, value_name = "FILE.csv")]
    pub events: Option<PathBuf>,
    /// Write the trace of every agent: t_s,agent,x_m,y_m,heading_rad,speed_mps,activity.
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<PathBuf>,
    /// Simulated seconds between two rows of the trace.
    #[arg(long = "every", alias = "step", value_name = "SECONDS", default_value_t = 0.1, requires = "trace", allow_hyphen_values = true, value_parser = parse_trace_step)]
    pub step: f64,
    /// Keep only this agent in the trace, such as `unimog/0`; may be repeated.
    #[arg(long = "agent", value_name = "AGENT", requires = "trace", value_parser = parse_agent)]
    pub agents: Vec<AgentId>,
}

/// Reads the step of a trace; its writer decides how fine it may be.
fn parse_trace_step(text: &str) -> Result<f64, String> {
    numbers::parse_time(text).ok_or_else(|| "expected seconds, or h:mm:ss".to_owned())
}

pub fn run(arguments: &RunArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let mut options = context.run_options(arguments.record_searches, arguments.memory.limit());
    let (scenario, seed, replay) = match &arguments.answers {
        None => {
            let changes = context.with_custom_names(&arguments.scenario.overrides);
            (scenario::load(&arguments.scenario.source, &changes)?, arguments.seed, None)
        }
        Some(path) => {
            let game = read_game(path)?;
            let unanswered = Unanswered::default();
            // A game brings its own scenario, seed and answers.
            options.policies = game.replayed(&unanswered);
            (game.load()?.scenario, game.seed, Some((path, unanswered)))
        }
    };
    // Programs of the scenario start with the run, so that consent comes before.
    context.expect_trusted(&scenario)?;
    context.note_doubts([&scenario]);
    // Names of files are checked before the run, which may take minutes.
    let (outputs, stream) = RunOutputs::checked(arguments, &scenario, seed)?;
    let (row, timeline) = run_once(&scenario, seed, &options)?;
    if let Some((path, question)) = replay.and_then(|(path, unanswered)| Some((path, unanswered.take()?))) {
        let sentence = format!("{}: the game stops before the end of the run: {question}", path.display());
        return Err(CliError::bad_input(sentence, Some("a game played with another version may not fit this one")));
    }
    let report = RunReport { row };
    // A run that failed is an object too, but says nothing to people besides its error.
    let is_printed = arguments.form.is_json() || report.row.result.is_some();
    let printed = if is_printed { stream.print(&arguments.form.render(&report)) } else { Ok(()) };
    // Whatever cannot be written, all else of the run is kept.
    let written = timeline.map_or(Ok(()), |timeline| outputs.write(&timeline, context.quiet));
    printed.and(written)?;
    match report.row.result {
        Some(_) => Ok(ExitCode::SUCCESS),
        None => Err(CliError::run_failed(report.row.message)),
    }
}

fn run_once(scenario: &Scenario, seed: u64, options: &RunOptions) -> Result<(RunRow, Option<Timeline>), CliError> {
    let stopwatch = WallStopwatch::start();
    // The panic has been printed by then, with a backtrace if one was asked for.
    let caught = panic::catch_unwind(AssertUnwindSafe(|| wildfire_sim::run_with_options(scenario, seed, options)));
    let wall = stopwatch.elapsed();
    let label = RunLabel::from_scenario(scenario, seed);
    match caught.map_err(|_| CliError::run_failed("the run panicked: this is a bug in wildfire"))? {
        Ok(run) => {
            let result = RunResult { asks: run.asks, ..RunResult::new(Outcome::new(&run.timeline), run.cost) };
            let row = RunRow { message: run.messages.to_string(), ..RunRow::done(label, result, wall) };
            Ok((row, Some(run.timeline)))
        }
        Err(error) => Ok((RunRow::not_done(label, Status::Failed, error.to_string(), wall), None)),
    }
}

/// The files that one run was asked for.
struct RunOutputs<'a> {
    recording: Option<PathBuf>,
    events: Option<&'a Path>,
    trace: Option<&'a Path>,
    step_s: f64,
    agents: &'a [AgentId],
}

impl<'a> RunOutputs<'a> {
    /// Checks what can be checked before the run, and returns where its words go.
    fn checked(arguments: &'a RunArguments, scenario: &Scenario, seed: u64) -> Result<(Self, ReportStream), CliError> {
        let step_s = arguments.step;
        if !(step_s.is_finite() && step_s >= FINEST_STEP_S) {
            let sentence = format!("--every is {step_s}; expected seconds, at least {FINEST_STEP_S}");
            return Err(CliError::bad_input(sentence, None));
        }
        // An agent that the scenario does not have would give an empty trace after a whole run.
        check_agents("--agent", &arguments.agents, scenario)?;
        let recording = arguments.out.as_deref().map(|path| recording_path(path, scenario, seed));
        let inputs = vec![arguments.answers.as_deref().unwrap_or(Path::new(&arguments.scenario.source))];
        let files = Files { inputs, form: arguments.form, ..Files::default() }.writing([
            (Format::Recording, &recording),
            (Format::Csv, &arguments.events),
            (Format::Csv, &arguments.trace),
        ]);
        let stream = files.check()?;
        let events = arguments.events.as_deref();
        let trace = arguments.trace.as_deref();
        Ok((Self { recording, events, trace, step_s, agents: &arguments.agents }, stream))
    }

    /// Tries all files; the error is the first.
    fn write(&self, timeline: &Timeline, quiet: bool) -> Result<(), CliError> {
        let recording = self.recording.as_deref().map(|path| (path, write_recording(path, timeline)));
        let events = self.events.map(|path| (path, write_export(path, |to| write_events(timeline, to))));
        let trace = self.trace.map(|path| {
            let sampling = Sampling::new(timeline, self.step_s, self.agents);
            (path, write_export(path, |to| write_trace(timeline, &sampling?, to)))
        });
        // A full disk for one file is no reason to lose the others.
        let mut all = Ok(());
        for (path, written) in [recording, events, trace].into_iter().flatten() {
            if written.is_ok() {
                output_files::note_written(path, quiet);
            }
            all = all.and(written);
        }
        all
    }
}

/// Refuses names that no agent of the scenario has.
pub fn check_agents(option: &str, named: &[AgentId], scenario: &Scenario) -> Result<(), CliError> {
    let count = |role| match role {
        Role::Wumpus => scenario.wumpus.len(),
        Role::Unimog => scenario.unimog.len(),
    };
    let Some(stranger) = named.iter().find(|agent| usize::from(agent.number) >= count(agent.role)) else {
        return Ok(());
    };
    let role = stranger.role.name();
    let found = count(stranger.role);
    let sentence = format!(
        "{option} names {stranger}; the scenario has {found} of this kind, expected {role}/N with N below that"
    );
    Err(CliError::bad_input(sentence, None))
}

/// The recording's own name in a folder; the path itself if it names a file.
fn recording_path(path: &Path, scenario: &Scenario, seed: u64) -> PathBuf {
    let names_a_folder = path.is_dir() || path.as_os_str().to_string_lossy().ends_with(std::path::is_separator);
    if names_a_folder {
        path.join(format!("{}-seed-{seed}.wildfire", file_name_of(&scenario.name)))
    } else {
        path.to_owned()
    }
}

pub fn write_recording(path: &Path, timeline: &Timeline) -> Result<(), CliError> {
    file::write(timeline, path)
        .map_err(|error| CliError::environment(format_args!("cannot write {}: {error}", path.display())))
}

/// The result of a run.
pub struct RunReport {
    pub row: RunRow,
}

impl Serialize for RunReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        RunObject::new(&self.row).serialize(serializer)
    }
}

impl From<&RunReport> for Document {
    /// The outcome, the winner, the agents and the CPU time, at most 80 columns wide.
    fn from(RunReport { row }: &RunReport) -> Self {
        let Some(result) = &row.result else { return Self::new(row.message.clone()) };
        let (label, outcome) = (&row.label, &result.outcome);
        let ended_s = rounded(outcome.ended_s, 1);
        let record = RunRecord::from_row(row);
        let failures =
            [Failures::of_queries(&record).of_planner(&label.planner), Failures::of_asks(&record).of_policies(None)];
        let notes = notes(result).into_iter().map(|note| format!("Note: {note}"));
        let notes = notes.chain(failures.into_iter().flatten()).chain(record.queries().sentences(&label.planner));
        let sentences = fires(outcome).into_iter().chain(ground(outcome)).chain(verdict(result)).chain(notes).collect();
        let heading = format!("{}, seed {}: ended after {ended_s} s", label.scenario, label.seed);
        // What a run without bushes, or without agents, has none of is left out: a fire on the ground is told in hectares.
        let (has_bushes, has_agents) = (outcome.obstacles > 0, !outcome.agents.is_empty());
        Self::new(heading)
            .with(has_bushes.then(|| states(outcome)))
            .with([Block::List(sentences)])
            .with(has_agents.then(|| agents(outcome)))
            .with([cpu_times(result)])
            .with(has_agents.then(|| Block::Text(cpu_per_plan(result))))
    }
}

fn states(outcome: &Outcome) -> Table {
    let rows = vec![
        state_row("intact", outcome.intact, outcome.intact_ratio()),
        state_row("burned", outcome.burned(), outcome.burned_ratio()),
        state_row("extinguished", outcome.extinguished, outcome.extinguished_ratio()),
        vec!["all".into(), outcome.obstacles.to_string(), String::new()],
    ];
    Table { rules_before: vec![rows.len() - 1], ..Table::new(&["Obstacles", "total", "ratio"], rows) }
}

fn state_row(state: &str, count: u32, ratio: f64) -> Vec<String> {
    vec![state.to_owned(), count.to_string(), rounded(ratio, 3)]
}

/// Tells of the fires of bushes, where there are bushes.
fn fires(outcome: &Outcome) -> Option<String> {
    if outcome.obstacles == 0 {
        return None;
    }
    let Outcome { lit_by_wumpus, caught_by_spread, lit_by_schedule, peak_burning, .. } = outcome;
    let schedule = if *lit_by_schedule > 0 { format!(", {lit_by_schedule} by schedule") } else { String::new() };
    let first = outcome.first_fire_s.map(|first_s| format!(", the first at {} s", rounded(first_s, 1)));
    let response = outcome.mean_response_s.map(|mean_s| format!("; put out after {} s on average", rounded(mean_s, 1)));
    Some(format!(
        "Fires: {lit_by_wumpus} lit by the Wumpus, {caught_by_spread} caught by spread{schedule}; at most \
         {peak_burning} at once{}{}.",
        first.unwrap_or_default(),
        response.unwrap_or_default()
    ))
}

/// Tells of the ground, where there is some that burns.
fn ground(outcome: &Outcome) -> Option<String> {
    let GroundOutcome { cells, burned, extinguished, spotted, burned_ha, reached_edge_s, line, .. } = outcome.ground?;
    let embers = if spotted > 0 { format!(", {spotted} fires by embers") } else { String::new() };
    let built = line.map(|line| {
        let built_m = rounded(line.built_m, 0);
        let lost_m = rounded(line.lost_m, 0);
        format!(" Line: {built_m} m built, {lost_m} m of it lost.")
    });
    let area = if outcome.obstacles > 0 { ", with bushes" } else { "," };
    let edge = reached_edge_s.map(|edge_s| format!("; at the edge of the field after {} s", rounded(edge_s, 1)));
    Some(format!(
        "Ground: {burned} of {cells} cells caught fire{area} {} ha; {extinguished} put out{embers}{}.{}",
        rounded(burned_ha, 2),
        edge.unwrap_or_default(),
        built.unwrap_or_default()
    ))
}

/// Tells who won, where anybody can have points.
fn verdict(result: &RunResult) -> Option<String> {
    let outcome = &result.outcome;
    if outcome.obstacles == 0 {
        return None;
    }
    let wumpus = outcome.wumpus_score;
    let truck = outcome.truck_score;
    let has_trucks = result.trucks().next().is_some();
    let has_wumpuses = result.wumpuses().next().is_some();
    Some(match (has_wumpuses, has_trucks, outcome.winner()) {
        (false, false, _) => "No contest: nobody takes part.".to_owned(),
        (false, true, _) => format!("No contest: no Wumpus takes part. Points: Unimog {truck}."),
        (true, false, _) => format!("No contest: no truck takes part. Points: Wumpus {wumpus}."),
        (true, true, Winner::Wumpus) => format!("The Wumpus wins, {wumpus} points to {truck}."),
        (true, true, Winner::Unimog) => format!("The Unimog wins, {truck} points to {wumpus}."),
        (true, true, Winner::Tie) => format!("A tie, {truck} points each."),
    })
}

fn agents(outcome: &Outcome) -> Table {
    let rows = outcome.agents.iter().map(|agent| {
        let failed = agent.failures.sum();
        let counts = [agent.cells, agent.plans, failed].map(|count| count.to_string());
        let measures =
            [agent.distance_m, agent.driving_s, agent.planning_s, agent.suppressing_s, agent.standing_s, agent.stuck_s];
        let measures = measures.map(|measure| rounded(measure, 1));
        [agent.agent.to_string()].into_iter().chain(counts).chain(measures).collect()
    });
    let headings = [
        "Agent",
        "cells",
        "plans",
        "failed",
        "distance\nm",
        "moving\ns",
        "planning\ns",
        "suppress.\ns",
        "standing\ns",
        "stuck\ns",
    ];
    Table::new(&headings, rows.collect())
}

/// The phases that only some runs have: with a dispatched team, with planners or policies that are not built in.
const OPTIONAL: [&str; 4] = ["custom planner: start", "custom planner: queries", "dispatch", "custom policies"];

/// The phases that no planner has but those with roadmaps.
const ROADMAP: [&str; 3] = ["PRM sampling", "PRM map generation", "roadmap search"];

/// The other phases that no run has without trucks, or without Wumpuses.
const OF_TRUCKS: [&str; 2] = ["local search", "reachability"];
const OF_WUMPUSES: &str = "Wumpus search";

fn cpu_times(result: &RunResult) -> Table {
    let cpu = &result.cpu;
    let parts = [
        ("terrain", cpu.terrain_s),
        ("clearance field", cpu.clearance_field_s),
        (ROADMAP[0], cpu.sampling_s),
        (ROADMAP[1], cpu.map_generation_s),
        (ROADMAP[2], cpu.roadmap_search_s),
        (OF_TRUCKS[0], cpu.local_search_s),
        (OF_TRUCKS[1], cpu.reachability_s),
        (OPTIONAL[0], cpu.custom_start_s),
        (OPTIONAL[1], cpu.custom_queries_s),
        (OPTIONAL[2], cpu.dispatch_s),
        (OF_WUMPUSES, cpu.wumpus_s),
        (OPTIONAL[3], cpu.policy_s),
        ("everything else", cpu.rest_s()),
        ("whole run", cpu.run_s),
    ];
    let has_trucks = result.trucks().next().is_some();
    let has_wumpuses = result.wumpuses().next().is_some();
    let shown = parts.into_iter().filter(|&(phase, seconds)| {
        let is_foreign = OPTIONAL.contains(&phase)
            || ROADMAP.contains(&phase) && (cpu.has_custom_planner() || !has_trucks)
            || OF_TRUCKS.contains(&phase) && !has_trucks
            || phase == OF_WUMPUSES && !has_wumpuses;
        seconds > 0.0 || !is_foreign
    });
    let rows = shown.map(|(phase, seconds)| {
        let share = if cpu.run_s > 0.0 { percent(seconds / cpu.run_s) } else { "-".into() };
        vec![phase.to_owned(), rounded(seconds * 1e3, 3), share]
    });
    let rows: Vec<_> = rows.collect();
    Table { rules_before: vec![rows.len() - 1], ..Table::new(&["Phase", "CPU\nms", "%"], rows) }
}

fn cpu_per_plan(result: &RunResult) -> String {
    let truck_plans = result.trucks().map(|agent| agent.plans).sum();
    let wumpus_plans = result.wumpuses().map(|agent| agent.plans).sum();
    let queries_s = result.cpu.roadmap_search_s + result.cpu.local_search_s + result.cpu.custom_queries_s;
    let truck = us_per_plan(queries_s, truck_plans);
    let wumpus = us_per_plan(result.cpu.wumpus_s, wumpus_plans);
    format!("CPU per plan: truck {truck} us ({truck_plans} plans), Wumpus {wumpus} us ({wumpus_plans} plans).")
}

fn us_per_plan(cpu_s: f64, plans: u32) -> String {
    rounded(1e6 * cpu_s / f64::from(plans.max(1)), 1)
}
