//! Exports of a run for other tools.
//!
//! | form | what it is | for |
//! |---|---|---|
//! | [`write_events`], [`write_trace`] | tables, CSV | spreadsheets, data frames |
//! | [`write_json`] | one object with all that a recording holds | programs in any language |
//! | [`write_npz`] | arrays | NumPy |
//!
//! Equal runs give equal files, byte for byte. Formats of all runs are here; pictures of them, and scenes for
//! viewers, are made by `wildfire-picture`.

mod arrays;
mod changes;
mod object;
mod sampling;
mod tables;
mod zip;

use std::io;

use thiserror::Error;

use super::AgentId;

pub use arrays::write_npz;
pub use changes::{ExportedChange, cell_changes};
pub use object::{schema, write_json};
pub use sampling::{FINEST_STEP_S, MAX_SAMPLES, Sampling};
pub use tables::{EventText, event_text, ground_event_text, write_events, write_trace};

/// The reason why a run was not written.
#[derive(Debug, Error)]
pub enum ExportError {
    #[error("samples need a step of {FINEST_STEP_S} s or more, found {found}")]
    Step { found: f64 },
    #[error("there is no {found} in this run, only {existing}")]
    NoSuchAgent { found: AgentId, existing: String },
    #[error("{found} samples of agents; expected at most {MAX_SAMPLES}: choose a longer step, or fewer agents")]
    TooManySamples { found: u64 },
    #[error("the field has {found} cells; expected at most {limit} for this format")]
    FieldTooLarge { found: usize, limit: usize },
    #[error(transparent)]
    Write(#[from] io::Error),
}

impl From<csv::Error> for ExportError {
    fn from(error: csv::Error) -> Self {
        Self::Write(error.into())
    }
}

impl From<serde_json::Error> for ExportError {
    fn from(error: serde_json::Error) -> Self {
        Self::Write(error.into())
    }
}
