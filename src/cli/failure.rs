//! What a command says when it cannot do what was asked, and with which exit code it ends.

use std::fmt;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use miette::{Diagnostic, Report};
use thiserror::Error;

use crate::batch::{AuditsError, BatchError, FinishedError};
use crate::cli::exit;
use crate::map_files::MapError;
use crate::scenario::ScenarioError;

/// An error for people, and the exit code that goes with it.
#[derive(Debug)]
pub struct Failure {
    report: Report,
    code: u8,
}

/// A sentence, and what to do about it.
#[derive(Debug, Error, Diagnostic)]
#[error("{sentence}")]
struct Complaint {
    sentence: String,
    #[help]
    help: Option<String>,
}

impl Failure {
    /// What was asked cannot be done as it was asked.
    pub fn bad_input(sentence: impl fmt::Display, help: Option<&str>) -> Self {
        Self::new(sentence, help, exit::BAD_INPUT)
    }

    /// What was asked is fine, the machine is not.
    pub fn environment(sentence: impl fmt::Display) -> Self {
        Self::new(sentence, None, exit::ENVIRONMENT)
    }

    pub fn unwritable(path: &Path, error: &io::Error) -> Self {
        Self::environment(format_args!("cannot write {}: {error}", path.display()))
    }

    /// A run that could not take place.
    pub fn of_run(sentence: impl fmt::Display) -> Self {
        Self::new(sentence, None, exit::RUN_FAILED)
    }

    fn new(sentence: impl fmt::Display, help: Option<&str>, code: u8) -> Self {
        let complaint = Complaint { sentence: sentence.to_string(), help: help.map(str::to_owned) };
        Self { report: complaint.into(), code }
    }

    /// Prints the error to stderr and returns the exit code.
    pub fn conclude(self) -> ExitCode {
        // When even stderr is closed, the exit code is all that is left to say.
        let _ = writeln!(io::stderr(), "{:?}", self.report);
        ExitCode::from(self.code)
    }
}

impl From<Box<ScenarioError>> for Failure {
    fn from(error: Box<ScenarioError>) -> Self {
        Self { report: Report::new(*error), code: exit::BAD_INPUT }
    }
}

impl From<MapError> for Failure {
    fn from(error: MapError) -> Self {
        Self::bad_input(error, None)
    }
}

impl From<FinishedError> for Failure {
    fn from(error: FinishedError) -> Self {
        Self::bad_input(error, None)
    }
}

impl From<AuditsError> for Failure {
    fn from(error: AuditsError) -> Self {
        match error {
            AuditsError::Finished(error) => error.into(),
            AuditsError::Batch(error) => error.into(),
        }
    }
}

impl From<BatchError> for Failure {
    fn from(error: BatchError) -> Self {
        match error {
            BatchError::HoldsResults { .. } => {
                Self::bad_input(error, Some("name another folder with --out, or overwrite the results with --force"))
            }
            BatchError::NotAFolder { .. } => Self::bad_input(error, None),
            BatchError::Unwritable { .. } | BatchError::Unrecordable { .. } | BatchError::NoWorkers { .. } => {
                Self::environment(error)
            }
        }
    }
}
