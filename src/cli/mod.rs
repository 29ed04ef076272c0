//! The command line: arguments, dispatch, exit codes, errors for people.
//!
//! Results go to stdout, progress, notes and errors to stderr. Nothing is written before all arguments are checked.

mod arena;
mod args;
mod assignment;
mod attain;
mod audit;
mod batch;
mod cite;
#[cfg(test)]
mod command_lines;
mod compare;
mod completion;
mod context;
mod csv_rows;
mod curve;
mod demo;
mod error;
mod export;
mod fire;
mod fork;
#[cfg(test)]
#[path = "../../tests/fuzz/mod.rs"]
mod fuzz;
mod grade;
mod help;
mod interrupt;
mod judge;
mod lessons;
mod map;
mod map_of;
mod next_command;
mod number_table;
mod numbers;
mod options;
mod output_files;
mod page;
#[cfg(test)]
#[path = "../../tests/fuzz/phrases.rs"]
mod phrases;
mod plan;
mod play;
mod rank;
mod render;
mod report;
mod run;
mod scenarios;
mod shell;
mod show;
mod terminal;
mod together;
mod why;

use std::env;
use std::ffi::OsString;
use std::process::ExitCode;

use clap::builder::FalseyValueParser;
use clap::error::{ContextKind, ContextValue};
use clap::{ArgAction, CommandFactory, FromArgMatches, Parser, Subcommand};

use arena::ArenaCommand;
use attain::AttainArguments;
use audit::AuditArguments;
use batch::{BatchArguments, MergeArguments, ReportArguments, StatusArguments};
use cite::CiteArguments;
use compare::CompareArguments;
use context::CommandContext;
use curve::CurveArguments;
use demo::DemoArguments;
use error::CliError;
use export::ExportArguments;
use fire::FireCommand;
use fork::ForkArguments;
use grade::GradeArguments;
use judge::JudgeArguments;
use lessons::LessonsArguments;
use map::MapCommand;
use map_of::MapOfArguments;
use page::PageArguments;
use plan::PlanArguments;
use play::PlayArguments;
use rank::RankArguments;
use render::RenderArguments;
use run::RunArguments;
use scenarios::{CheckArguments, NewArguments, ScenariosArguments, SchemaArguments};
use shell::{CompletionsArguments, ManArguments};
use why::WhyArguments;

use wildfire_base::untrusted::visible;
use wildfire_batch::plan::LONG_VERSION;
use wildfire_scenario::nearest_name;
use wildfire_sim::CustomRegistry;
#[cfg(unix)]
use wildfire_sim::programs::supervisor;

const EXAMPLES: &str = "\
Examples:
  wildfire demo                               a tour in a minute
  wildfire batch contest --seeds 1..1000      a thousand runs: two tables
  wildfire run contest --seed 7               one run: who won, what took time
  wildfire page -o play.html                  a page to play in a browser
  wildfire run --set unimog.prm_rs.samples=1000  another roadmap
  wildfire play contest --seed 7              watch it
  wildfire render --seed 7 --gif film.gif     draw it
  wildfire export --seed 7 -o run.mcap        look at it in Foxglove
  wildfire new scenario my.toml && wildfire check my.toml
  wildfire map brushfire map.png --png fire.png   distances to obstacles
  wildfire fire behavior --fuel GR2 --wind 5   how fast grass burns
  wildfire map-of runs/contest --burn-probability --png probability.png
  wildfire plan field.json --planner prm-rs,hybrid-astar   compare planners

Exit codes: 0 done, 1 a run failed, 2 bad input, 3 disk or other environment,
4 an audit or a check found a violation, 75 stopped and resumable, 130 stopped.";

/// A contest between planners: a Wumpus lights bushes, a fire truck puts them out.
#[derive(Debug, Parser)]
#[command(
    name = "wildfire", version, long_version = LONG_VERSION, after_help = EXAMPLES, max_term_width = 100,
    disable_help_flag = true
)]
pub struct Arguments {
    /// Print only results and errors, no progress or notes.
    #[arg(short, long, global = true, env = "WILDFIRE_QUIET", value_parser = FalseyValueParser::new())]
    pub quiet: bool,
    /// Print help.
    #[arg(short, long, global = true, action = ArgAction::Help)]
    pub help: Option<bool>,
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Tour the program in a minute: fill a folder with pictures and pages.
    Demo(DemoArguments),
    /// Run a scenario once and print who won.
    Run(RunArguments),
    /// Watch a run in a window, or two runs side by side.
    Play(PlayArguments),
    /// Write a page that computes runs in a browser: watch them, or play the arsonist or the dispatcher.
    Page(PageArguments),
    /// Write seven interactive lessons for a course, with questions, and their index.
    Lessons(LessonsArguments),
    /// Draw a run without a screen: a still, a GIF, an MP4.
    Render(RenderArguments),
    /// Export a run to other tools: JSON, NumPy arrays, MCAP for Foxglove, CSV.
    Export(ExportArguments),
    /// Run scenarios with many seeds and print contest tables.
    Batch(BatchArguments),
    /// Show a batch's progress.
    Status(StatusArguments),
    /// Merge the slices of a batch: check that all are complete and write its tables.
    Merge(MergeArguments),
    /// Write a report of a batch: a web page, and its charts as SVG and PNG.
    Report(ReportArguments),
    /// Compare batches, or scenarios and planners within a batch, paired by seed.
    Compare(CompareArguments),
    /// Rank entries, all against all: batches, or planners and policies within them.
    Rank(RankArguments),
    /// Enter frozen tracks: play entries, rank them on a board, recompute what a board says.
    Arena {
        #[command(subcommand)]
        command: ArenaCommand,
    },
    /// Grade an entry of a course: points for tests and for its score, as course platforms read them.
    Grade(GradeArguments),
    /// Rerun up to a time, then change a decision, a policy or a planner.
    Fork(ForkArguments),
    /// Judge the decisions of a run: what every other choice would have cost or saved.
    Why(WhyArguments),
    /// Search for the fewest bushes that trucks who know the future could have lost.
    Attain(AttainArguments),
    /// Audit finished runs against the rules: recordings, or all runs of batches.
    Audit(AuditArguments),
    /// Write a commented template: a scenario, the plan of a batch, a planner, a course.
    New(NewArguments),
    /// Print the JSON Schema of a file format or of a table's columns.
    Schema(SchemaArguments),
    /// Explain a scenario: its values, defaults and terrain.
    Check(CheckArguments),
    /// List the built-in scenarios, or print one.
    Scenarios(ScenariosArguments),
    /// Compute a grid map: occupancy, brushfire, cost, wavefront, potential fields, gradient descent.
    Map {
        #[command(subcommand)]
        command: MapCommand,
    },
    /// Map arrival, intensity, burn probability and what trucks change.
    MapOf(MapOfArguments),
    /// Compute the shortest curves with a turning radius between two poses: Reeds-Shepp and Dubins.
    Curve(CurveArguments),
    /// Compute fire behavior and spread without agents: from fuel, wind, slope and moisture.
    Fire {
        #[command(subcommand)]
        command: FireCommand,
    },
    /// Plan drives of the truck with any planners, on your own fields or a scenario's; report figures and paths.
    Plan(PlanArguments),
    /// Judge paths from any source by the rules for planners, also next to built-in planners.
    Judge(JudgeArguments),
    /// Print a BibTeX entry for the program and a batch.
    Cite(CiteArguments),
    /// Print a shell completion script.
    Completions(CompletionsArguments),
    /// Print the man page, or write the man pages of all commands.
    Man(ManArguments),
}

/// Reads the arguments of the process and does what they say.
pub fn main() -> ExitCode {
    main_with(CustomRegistry::default())
}

/// Does the same with custom planners, or custom planners and policies, besides the built-in ones: the whole program, and
/// they are known by their names wherever a name may stand.
pub fn main_with(registry: impl Into<CustomRegistry>) -> ExitCode {
    main_from(env::args_os().collect(), registry)
}

/// Does the same with other words than the arguments of the process; the first is the program's name.
pub fn main_from(args: Vec<OsString>, registry: impl Into<CustomRegistry>) -> ExitCode {
    #[cfg(unix)]
    if let Some(code) = supervisor::run_if_requested(args.get(1..).unwrap_or_default()) {
        return ExitCode::from(code);
    }
    interrupt::install();
    if args.get(1..).is_some_and(|args| args == ["help", "--all"]) {
        let all = program().render_long_help().to_string();
        return terminal::print(&all).map_or_else(CliError::print, |()| ExitCode::SUCCESS);
    }
    let arguments = match parse(&args) {
        Ok(arguments) => arguments,
        Err(error) => match help::mistake(&args, &error, &program()) {
            Some(mistake) => return mistake.print(),
            None => refuse(&args, &error),
        },
    };
    let context = CommandContext::new(arguments.quiet, registry.into());
    dispatch(&arguments, &context).unwrap_or_else(CliError::print)
}

/// Returns the program with all commands, as the command line has it.
pub fn program() -> clap::Command {
    options::arranged(Arguments::command())
}

/// Reads arguments; the help of the program itself is the overview.
fn parse(args: &[OsString]) -> Result<Arguments, clap::Error> {
    let program = options::arranged_for(Arguments::command(), args);
    let overview = help::overview(&program);
    let matches = program.override_help(overview).try_get_matches_from(args)?;
    Arguments::from_arg_matches(&matches)
}

/// Says what is wrong with the arguments, or prints what they ask for instead of a command, and ends the process.
///
/// The message quotes arguments. So that nothing in them acts on the terminal, it is made once more from arguments in
/// which that is escaped, and which are wrong for the same reason.
fn refuse(args: &[OsString], error: &clap::Error) -> ! {
    let args: Vec<OsString> = args.iter().map(|word| visible(&word.to_string_lossy()).into_owned().into()).collect();
    match parse(&args) {
        Err(same) if same.kind() == error.kind() => without_misleading_tips(same).exit(),
        _ => error.exit(),
    }
}

/// Leaves out tips that lead astray: other options that merely share some letters, such as `--trust` in place of `--rules`,
/// and the advice to pass an unknown option as a value.
fn without_misleading_tips(mut error: clap::Error) -> clap::Error {
    let named = [ContextKind::InvalidArg, ContextKind::SuggestedArg].map(|kind| match error.get(kind) {
        Some(ContextValue::String(text)) => text.clone(),
        _ => String::new(),
    });
    let [unknown, suggested] = named;
    if unknown.starts_with("--") {
        error.remove(ContextKind::Suggested);
    }
    if nearest_name(&unknown, [&suggested[..]]).is_none() || !has_common_start(&unknown, &suggested) {
        error.remove(ContextKind::SuggestedArg);
        // It is that of the suggestion.
        error.remove(ContextKind::Usage);
    }
    error
}

/// Says whether two options begin with the same two letters.
fn has_common_start(one: &str, other: &str) -> bool {
    one.bytes().zip(other.bytes()).take_while(|(one, other)| one == other).count() >= "--ab".len()
}

fn dispatch(arguments: &Arguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    match &arguments.command {
        Command::Demo(demo) => demo::run(demo, context, &|args, context| {
            let arguments = parse(&args).expect("the demonstration's commands are right");
            dispatch(&Arguments { quiet: context.quiet, ..arguments }, context)
        }),
        Command::Run(run) => run::run(run, &context.with_programs(&run.scenario.programs)),
        Command::Play(play) => play::run(play, &context.with_programs(&play.show.programs)),
        Command::Page(page) => page::run(page, arguments.quiet),
        Command::Lessons(lessons) => lessons::write(&lessons.folder, arguments.quiet).map(|()| ExitCode::SUCCESS),
        Command::Render(render) => render::run(render, &context.with_programs(&render.show.programs)),
        Command::Export(export) => export::run(export, &context.with_programs(&export.programs)),
        Command::Batch(batch) => batch::run(batch, &context.with_programs(&batch.programs)),
        Command::Report(report) => batch::report(report, &context.with_programs(&report.programs)),
        Command::Compare(compare) => compare::run(compare, arguments.quiet),
        Command::Rank(rank) => rank::run(rank, &context.with_trust(rank.trust)),
        Command::Arena { command } => arena::run(command, context),
        Command::Grade(grade) => grade::run(grade, context),
        Command::Fork(fork) => fork::run(fork, &context.with_programs(&fork.run.scenario.programs)),
        Command::Why(why) => why::run(why, &context.with_programs(&why.run.scenario.programs)),
        Command::Attain(attain) => attain::run(attain, &context.with_programs(&attain.scenario.programs)),
        Command::Audit(audit) => audit::run(audit, &context.with_trust(audit.trust)),
        Command::Status(folder) => batch::status(folder),
        Command::Merge(folder) => batch::merge(folder, arguments.quiet),
        Command::New(new) => scenarios::new(new, arguments.quiet),
        Command::Schema(schema) => scenarios::schema(schema),
        Command::Check(check) => scenarios::check(check, &context.with_programs(&check.scenario.programs)),
        Command::Scenarios(scenarios) => scenarios::list_or_show(scenarios),
        Command::Map { command } => map::run(command, arguments.quiet),
        Command::MapOf(map) => map_of::run(map, &context.with_programs(&map.programs)),
        Command::Curve(curve) => curve::run(curve, arguments.quiet),
        Command::Fire { command } => fire::run(command, arguments.quiet),
        Command::Plan(plan) => plan::run(plan, &context.with_programs(&plan.programs)),
        Command::Judge(judge) => judge::run(judge, &context.with_programs(&judge.programs)),
        Command::Cite(cite) => cite::run(cite),
        Command::Completions(completions) => shell::completions(completions, program()),
        Command::Man(man) => shell::man(man, program()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_defined_without_contradictions() {
        program().debug_assert();
    }

    #[test]
    fn options_of_one_name_have_one_letter_and_html_is_a_form_everywhere() {
        let mut commands = vec![program()];
        let mut seen = 0;
        while let Some(command) = commands.pop() {
            commands.extend(command.get_subcommands().cloned());
            for argument in command.get_arguments() {
                let is_flag = !argument.get_action().takes_values();
                let (expected, about) = match (argument.get_long(), argument.get_short()) {
                    (Some("out"), short) => (short == Some('o'), "-o"),
                    (Some("seed"), short) => (short == Some('s'), "-s"),
                    (Some("jobs"), short) => (short == Some('j'), "-j"),
                    (Some("html"), _) => (is_flag, "a flag"),
                    (_, Some('o')) => (false, "no -o but for --out"),
                    _ => continue,
                };
                seen += 1;
                assert!(expected, "{}, {argument}: expected {about}", command.get_name());
            }
        }
        assert!(seen > 40, "{seen} of these options");
    }

    #[test]
    fn earlier_names_of_options_are_still_taken() {
        for line in ["render --html x.html", "plan --report x", "batch --seed 1..3", "run -s 2", "export -s 2 -o x.csv"]
        {
            let args: Vec<OsString> = ["wildfire"].into_iter().chain(line.split(' ')).map(OsString::from).collect();
            let parsed = parse(&args);
            assert!(parsed.is_ok(), "{line}: {parsed:?}");
        }
    }
}
