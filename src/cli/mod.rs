//! The command line: arguments, dispatch, exit codes, errors for people.
//!
//! Results go to stdout, progress, notes and errors to stderr. Nothing is written before all arguments are checked.

mod args;
mod audit;
mod batch;
#[cfg(test)]
mod command_lines;
mod compare;
mod curve;
mod error;
#[cfg(test)]
#[path = "../../tests/fuzz/mod.rs"]
mod fuzz;
mod interrupt;
mod map;
mod numbers;
mod output_files;
#[cfg(test)]
#[path = "../../tests/fuzz/phrases.rs"]
mod phrases;
mod plan;
mod play;
mod render;
mod report;
mod run;
mod scenarios;
mod show;
mod terminal;

use std::env;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Arguments, Command};
use error::CliError;

use crate::untrusted::visible;

/// The program's exit codes; those of its arguments' own errors are clap's, which are the same.
mod exit {
    pub const RUN_FAILED: u8 = 1;
    pub const BAD_INPUT: u8 = 2;
    pub const ENVIRONMENT: u8 = 3;
    pub const VIOLATION: u8 = 4;
    pub const RESUMABLE: u8 = 75;
    pub const INTERRUPTED: u8 = 130;
}

/// Reads the arguments of the process and does what they say.
pub fn main() -> ExitCode {
    interrupt::install();
    let arguments = Arguments::try_parse().unwrap_or_else(|error| refuse(&error));
    dispatch(&arguments).unwrap_or_else(CliError::print)
}

/// Says what is wrong with the arguments, or prints what they ask for instead of a command, and ends the process.
///
/// The message quotes arguments. So that nothing in them acts on the terminal, it is made once more from arguments in
/// which that is escaped, and which are wrong for the same reason.
fn refuse(error: &clap::Error) -> ! {
    let words = env::args_os().map(|word| visible(&word.to_string_lossy()).into_owned());
    match Arguments::try_parse_from(words) {
        Err(same) if same.kind() == error.kind() => same.exit(),
        _ => error.exit(),
    }
}

fn dispatch(arguments: &Arguments) -> Result<ExitCode, CliError> {
    match &arguments.command {
        Command::Run(run) => run::run(run, arguments.quiet),
        Command::Play(play) => play::run(play, arguments.quiet),
        Command::Render(render) => render::run(render, arguments.quiet),
        Command::Batch(batch) => batch::run(batch, arguments.quiet),
        Command::Report(folder) => batch::report(folder, arguments.quiet),
        Command::Compare(compare) => compare::run(compare),
        Command::Audit(audit) => audit::run(audit, arguments.quiet),
        Command::Status(folder) => batch::status(folder),
        Command::Merge(folder) => batch::merge(folder, arguments.quiet),
        Command::New(new) => scenarios::new(new),
        Command::Schema(schema) => scenarios::schema(schema),
        Command::Check(check) => scenarios::check(check),
        Command::Scenarios(scenarios) => scenarios::list_or_show(scenarios),
        Command::Map { command } => map::run(command, arguments.quiet),
        Command::Curve(curve) => curve::run(curve, arguments.quiet),
        Command::Plan(plan) => plan::run(plan, arguments.quiet),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Arguments::command(), "wildfire", &mut script);
            terminal::print(&String::from_utf8(script).expect("scripts are text"))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}
