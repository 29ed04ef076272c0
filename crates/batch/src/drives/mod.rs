//! Drives: queries to planners, and paths that were computed elsewhere, each with its cost, its figures and the result
//! of the independent audit.
//!
//! A [`DriveQuery`] is a row, [`DRIVE_COLUMNS`] are the columns of its table in every form: CSV, JSON, Python.
//! [`DriveTable`] holds the rows with what varies between them, [`PlannerSummary`] is the one summary of a planner's rows,
//! [`DriveRequest`] asks for drives, and [`DriveContrast`] sets two planners against each other by the engine of [`comparison`](super::comparison).

mod attempts;
mod certificates;
mod checked;
mod contrast;
mod documents;
mod error;
#[cfg(any(test, feature = "testing"))]
mod made_up;
mod problems;
mod query;
mod request;
mod summary;
mod table;

pub use attempts::{Attempt, AttemptError, AttemptSettings, attempts};
pub use certificates::{CertificateFile, CertificateReport, MAX_CERTIFICATE_BYTES, gap_sentences};
pub use checked::missed;
pub use contrast::{COMPARED, DriveContrast, contrast_table};
pub use documents::{
    DRIVE_LEGEND, INTERVAL_LEGEND, SHOWN_ROWS, failure_sentences, interval_tables, queries_text, rows_table,
    shortened_field, summary_table, violation_sentences,
};
pub use error::DriveError;
#[cfg(any(test, feature = "testing"))]
pub use made_up::made_up_drives;
pub use problems::DriveProblems;
pub use query::{DRIVE_COLUMNS, DriveColumn, DriveFailure, DriveQuery, QueryCost};
pub use request::{DriveRequest, ask_all, custom_names, expect_planners_exist, requested_planners};
pub use summary::{MEASURES, Measure, PlannerSummary};
pub use table::{DriveTable, MAX_QUERIES};
