//! The errors of commands: messages for people, each with the exit code that goes with it.

use std::fmt;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

use annotate_snippets::{Level, Renderer};
use terminal_size::{Width, terminal_size_of};

use crate::cli::next_command::help_on_unfinished;
use wildfire_base::untrusted::visible;
use wildfire_batch::drives::DriveError;
use wildfire_batch::execute::{BatchError, JournalError};
use wildfire_batch::plan::{PLAN_KEYS, PlanError, RequestError};
use wildfire_batch::report::AuditsError;
use wildfire_batch::table::{FinishedError, TableError};
use wildfire_grid::map_files::{self, MapError};
use wildfire_scenario::{Fault, ScenarioError, SourceLocation, nearest_name};
use wildfire_timeline::export::ExportError;

/// The program's exit codes; those of its arguments' own errors are clap's, which are the same.
pub mod exit {
    pub const RUN_FAILED: u8 = 1;
    pub const BAD_INPUT: u8 = 2;
    pub const ENVIRONMENT: u8 = 3;
    pub const VIOLATION: u8 = 4;
    pub const RESUMABLE: u8 = 75;
    pub const INTERRUPTED: u8 = 130;
}

/// The width of what is shown where it goes to no terminal, as of clap's messages.
const USUAL_WIDTH: usize = 100;

/// An error for people, and the exit code that goes with it; no character of its texts acts on a terminal.
#[derive(Debug)]
pub struct CliError {
    sentence: String,
    location: Option<SourceLocation>,
    help: Option<String>,
    code: u8,
}

impl CliError {
    /// The request itself is wrong: exit code 2.
    pub fn bad_input(sentence: impl fmt::Display, help: Option<&str>) -> Self {
        Self::new(sentence, help, exit::BAD_INPUT)
    }

    /// The request is fine, but disk, display or another part of the machine is not: exit code 3.
    pub fn environment(sentence: impl fmt::Display) -> Self {
        Self::new(sentence, None, exit::ENVIRONMENT)
    }

    /// An input that was named cannot be read.
    pub fn unreadable(path: &Path, error: &io::Error) -> Self {
        let path = path.display();
        let sentence = match error.kind() {
            ErrorKind::NotFound => format!("{path} does not exist"),
            _ => format!("cannot read {path}: {error}"),
        };
        Self::from_input_error(sentence, error.kind())
    }

    /// An input cannot be used, for a reason that the caller puts into words.
    pub fn from_input_error(sentence: impl fmt::Display, kind: ErrorKind) -> Self {
        Self::new(sentence, None, code_of_input(kind))
    }

    pub fn unwritable(path: &Path, error: &io::Error) -> Self {
        Self::environment(format_args!("cannot write {}: {error}", path.display()))
    }

    /// A batch that has begun ends early; `resume` is the command that continues it.
    pub fn from_batch_error(error: BatchError, resume: &str) -> Self {
        let help = format!("resume with: {resume}");
        match error {
            // This is no failure: a scheduler reads this code as a request to queue the task again.
            BatchError::Stopped => Self::new(error, Some(&help), exit::RESUMABLE),
            BatchError::Unwritable { .. } | BatchError::Unrecordable { .. } | BatchError::NoWorkers { .. } => {
                Self::new(error, Some(&help), exit::ENVIRONMENT)
            }
            BatchError::Journal(JournalError::Rewritten { .. }) => {
                let help = format!("a participating program may have done it; to repeat all runs, {help}");
                Self::new(error, Some(&help), exit::ENVIRONMENT)
            }
            BatchError::Journal(JournalError::Changed { .. }) => {
                Self::new(error, Some(&format!("restore it and {help}")), exit::ENVIRONMENT)
            }
            _ => error.into(),
        }
    }

    /// A run cannot be written in the form that was asked for.
    pub fn from_export_error(path: &Path, error: ExportError) -> Self {
        match error {
            ExportError::Write(error) => Self::unwritable(path, &error),
            ExportError::Step { .. }
            | ExportError::NoSuchAgent { .. }
            | ExportError::TooManySamples { .. }
            | ExportError::FieldTooLarge { .. } => Self::bad_input(error, None),
        }
    }

    /// A run did not take place: exit code 1.
    pub fn run_failed(sentence: impl fmt::Display) -> Self {
        Self::new(sentence, None, exit::RUN_FAILED)
    }

    /// Ctrl-C stopped what cannot be resumed.
    pub fn stopped() -> Self {
        Self::new("stopped: no film was written", None, exit::INTERRUPTED)
    }

    fn new(sentence: impl fmt::Display, help: Option<&str>, code: u8) -> Self {
        let sentence = visible(&sentence.to_string()).into_owned();
        Self { sentence, location: None, help: help.map(|help| visible(help).into_owned()), code }
    }

    /// Says first what it is about.
    pub fn about(self, what: &str) -> Self {
        Self { sentence: format!("{}: {}", visible(what), self.sentence), ..self }
    }

    /// The message without place, help and colours.
    pub fn sentence(&self) -> String {
        self.sentence.clone()
    }

    /// Prints the error to stderr and returns the exit code.
    pub fn print(self) -> ExitCode {
        let report = Level::ERROR
            .primary_title(self.sentence)
            .elements(self.location.as_ref().map(SourceLocation::snippet))
            .elements(self.help.map(|help| Level::HELP.message(help)));
        let width = terminal_size_of(io::stderr()).map_or(USUAL_WIDTH, |(Width(width), _)| width.into());
        // When even stderr is closed, the exit code is all that is left to say.
        let _ = writeln!(anstream::stderr(), "{}", Renderer::styled().term_width(width).render(&[report]));
        ExitCode::from(self.code)
    }
}

/// The exit code of an input that cannot be used, whatever command was to read it.
///
/// A name that leads to nothing or to another kind of thing, and contents that are wrong or too large, are bad input;
/// an input that is there and cannot be read, for lack of permission or of a working disk, is a fault of the
/// environment.
fn code_of_input(kind: ErrorKind) -> u8 {
    match kind {
        ErrorKind::NotFound
        | ErrorKind::NotADirectory
        | ErrorKind::IsADirectory
        | ErrorKind::InvalidFilename
        | ErrorKind::InvalidInput
        | ErrorKind::InvalidData
        | ErrorKind::UnexpectedEof
        | ErrorKind::FileTooLarge => exit::BAD_INPUT,
        _ => exit::ENVIRONMENT,
    }
}

fn code_of_plan(error: &PlanError) -> u8 {
    match error {
        PlanError::Unreadable { source, .. } => code_of_input(source.kind()),
        _ => exit::BAD_INPUT,
    }
}

impl From<Box<ScenarioError>> for CliError {
    fn from(error: Box<ScenarioError>) -> Self {
        let code = match error.fault {
            Fault::Unreadable { kind, .. } => code_of_input(kind),
            _ => exit::BAD_INPUT,
        };
        let help = match &error.fault {
            Fault::UnknownField { name, table, .. } if table.is_empty() && PLAN_KEYS.contains(&name.as_str()) => Some(
                "a file with this key is a plan: `wildfire batch FILE` plays it, `--dry-run` lists its runs".to_owned(),
            ),
            fault => fault.advice(),
        };
        Self { location: error.location, ..Self::new(error.fault, help.as_deref(), code) }
    }
}

impl From<MapError> for CliError {
    fn from(error: MapError) -> Self {
        let kind = match &error.fault {
            map_files::Fault::Unreadable(source) => source.kind(),
            _ => ErrorKind::InvalidData,
        };
        Self::from_input_error(error, kind)
    }
}

/// What to do without the folder of a batch.
const NO_BATCH: &str = "`wildfire batch` makes such a folder, and prints its name, such as runs/contest";

impl From<FinishedError> for CliError {
    fn from(error: FinishedError) -> Self {
        let code = match &error {
            FinishedError::Unreadable { source, .. } => code_of_input(source.kind()),
            FinishedError::Plan(error) => code_of_plan(error),
            FinishedError::Strange(_)
            | FinishedError::OtherRows { .. }
            | FinishedError::Damaged { .. }
            | FinishedError::WrongTable(_) => exit::BAD_INPUT,
        };
        let help = matches!(error, FinishedError::Plan(PlanError::Missing { .. })).then_some(NO_BATCH);
        Self::new(error, help, code)
    }
}

impl From<AuditsError> for CliError {
    fn from(error: AuditsError) -> Self {
        match error {
            AuditsError::Finished(error) => error.into(),
            AuditsError::Batch(error) => error.into(),
        }
    }
}

impl From<TableError> for CliError {
    fn from(error: TableError) -> Self {
        let code = match &error {
            TableError::Unreadable { source, .. } => code_of_input(source.kind()),
            _ => exit::BAD_INPUT,
        };
        Self::new(error, None, code)
    }
}

impl From<RequestError> for CliError {
    fn from(error: RequestError) -> Self {
        match error {
            RequestError::Scenario(error) => error.into(),
            error => Self::bad_input(error, None),
        }
    }
}

impl From<DriveError> for CliError {
    fn from(error: DriveError) -> Self {
        let help = match &error {
            DriveError::NoTruck { .. } => "planners take their settings from its first [[unimog]]".to_owned(),
            DriveError::SameName { .. } => "tables identify a field by `field`, or by its file's name".to_owned(),
            DriveError::NoGoals { what: "bushes", .. } => "leave out --cells, to drive to poses".to_owned(),
            DriveError::NoGoals { .. } => "list `goals`, or drive to bushes with --cells".to_owned(),
            DriveError::UnknownPlanner { name, valid } => {
                let nearest = nearest_name(name.name(), valid.iter().map(String::as_str));
                let nearest = nearest.map_or(String::new(), |nearest| format!("did you mean `{nearest}`? "));
                format!(
                    "{nearest}expected one of {}; register a program with --command {name}='PROGRAM ...'",
                    valid.join(", ")
                )
            }
            _ => {
                return match error {
                    DriveError::Scenario(error) => error.into(),
                    DriveError::Failed { .. } => Self::run_failed(error),
                    error => Self::bad_input(error, None),
                };
            }
        };
        Self::bad_input(error, Some(&help))
    }
}

impl From<BatchError> for CliError {
    fn from(error: BatchError) -> Self {
        let help;
        let help = match &error {
            BatchError::HoldsResults { .. } => {
                Some("name another folder with --out, resume it with --resume, or overwrite the results with --force")
            }
            BatchError::Plan(PlanError::Missing { .. }) => Some(NO_BATCH),
            BatchError::Plan(PlanError::OtherVersion { .. }) => Some(
                "continue with that version, or start a new \
                batch",
            ),
            BatchError::Plan(PlanError::SourceChanged { .. }) => {
                Some("undo the change to resume this batch, or start a new one")
            }
            BatchError::Journal(JournalError::NoLock { .. }) => Some(
                "this file system does not support the lock; with --lock none, make sure that no other process works \
                 on this slice",
            ),
            BatchError::Journal(JournalError::Damaged { .. }) => {
                Some("delete that line and all after it to repeat those runs")
            }
            BatchError::OtherSlices { path, requested, .. } if requested.is_whole() => {
                help = help_on_unfinished(path);
                help.as_deref()
            }
            BatchError::OtherSlices { .. } => Some("all slices of a batch are K/N with one N"),
            BatchError::NotStarted { .. } => Some("start the batch again, with --out and this folder"),
            BatchError::NoJournal { .. } => Some("start a new batch, with --force to replace the old results"),
            _ => None,
        };
        let code = match &error {
            BatchError::Unreadable { source, .. } | BatchError::Journal(JournalError::Unreadable { source, .. }) => {
                code_of_input(source.kind())
            }
            BatchError::Plan(error) => code_of_plan(error),
            BatchError::Unwritable { .. }
            | BatchError::Unrecordable { .. }
            | BatchError::NoWorkers { .. }
            | BatchError::OtherOutcome { .. }
            | BatchError::Journal(
                JournalError::Locked { .. }
                | JournalError::NoLock { .. }
                | JournalError::Changed { .. }
                | JournalError::Rewritten { .. },
            ) => exit::ENVIRONMENT,
            BatchError::Stopped => exit::RESUMABLE,
            _ => exit::BAD_INPUT,
        };
        Self::new(error, help, code)
    }
}
