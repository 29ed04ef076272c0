//! The arena: frozen tracks that entries play, and boards whose every number anybody recomputes.
//!
//! A track is a course whose rules, seeds and scenario are part of the program and never change. Its golden rows say what the
//! reference entries did when it was frozen. A board is a folder with the entries and a row for each of their runs; ranks and
//! intervals follow from the rows.

mod board;
mod card;
mod document;
mod entry;
mod play;
mod row;
mod submission;
mod track;

pub use board::{Board, BoardEntry, TrackBoard};
pub use entry::{ArenaEntry, Class};
pub(crate) use play::{AuditedRun, audited_run};
pub use play::{Played, Players, play};
pub use row::{ArenaRow, HASHED_COLUMNS, rows_hash};
pub use submission::{SubmissionCheck, TrackCheck, total_failure};
pub use track::{ARENA_VERSION, TRACKS, Track, TrackKind};

use std::path::PathBuf;

use thiserror::Error;

use crate::drives::DriveError;
use crate::execute::BatchError;
use crate::plan::{CourseRefusal, SeedsError};

/// A reason for which something in the arena cannot be done.
#[derive(Debug, Error)]
pub enum ArenaError {
    #[error("there is no track `{name}`; expected one of {}", TRACKS.each_ref().map(|track| track.name).join(", "))]
    NoTrack { name: String },
    #[error("{}: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{}: {message}", path.display())]
    Wrong { path: PathBuf, message: String },
    #[error("{}:{line}: {message}", path.display())]
    WrongRow { path: PathBuf, line: u64, message: String },
    #[error(transparent)]
    Refused(#[from] CourseRefusal),
    #[error("{}: {source}", path.display())]
    Seeds { path: PathBuf, source: SeedsError },
    #[error(transparent)]
    Batch(#[from] BatchError),
    #[error(transparent)]
    Drive(#[from] DriveError),
}
