//! Errors of maps.

use std::path::PathBuf;

use thiserror::Error;

use crate::execute::BatchError;
use crate::table::FinishedError;
use wildfire_base::geometry::FieldFrame;
use wildfire_timeline::file::FileError;

/// The reason why there is no map. Messages are sentences that name the folder, the file or the run.
#[derive(Debug, Error)]
pub enum MapsError {
    #[error(transparent)]
    Finished(#[from] FinishedError),
    #[error(transparent)]
    Batch(#[from] BatchError),
    #[error("{} has no column `{column}`; expected one of those in which its variants differ: {valid}",
folder.display())]
    UnknownColumn { folder: PathBuf, column: String, valid: String },
    #[error("{} has {} that match: {}; expected a single variant, chosen by {columns}", folder.display(),
many(*count), list(titles))]
    WhichVariant { folder: PathBuf, count: usize, titles: Vec<String>, columns: String },
    #[error("{} has no seed {seed}; its seeds are {seeds}", folder.display())]
    NoSuchSeed { folder: PathBuf, seed: u64, seeds: String },
    #[error("{} has the seeds {}, {} has {}; expected seeds that are in both", first.0, first.1, second.0, second.1)]
    NoPairs { first: (String, String), second: (String, String) },
    #[error(
        "{run} has a field of {}, the first run one of {}; expected the same size for all",
        size(other),
        size(first)
    )]
    OtherField { run: String, other: FieldFrame, first: FieldFrame },
    #[error(
        "the runs of seed {seed} are on different ground; expected the same bushes and the same fuel on both sides"
    )]
    OtherGround { seed: u64 },
    #[error(
        "{run} has no intensities: only bushes burn there, without a rate; expected ground and the fire model `rothermel`"
    )]
    NoIntensity { run: String },
    #[error("{}: {source}", path.display())]
    Unreadable { path: PathBuf, source: FileError },
    #[error("{} is of {scenario}, seed {seed}; expected the run of seed {expected} of its batch", path.display())]
    OtherRun { path: PathBuf, scenario: String, seed: u64, expected: u64 },
    #[error("no run could start")]
    NoRuns,
}

/// The most variants that are listed.
const LISTED: usize = 12;

fn list(titles: &[String]) -> String {
    let listed = titles.iter().take(LISTED).map(String::as_str).collect::<Vec<_>>().join("; ");
    if titles.len() > LISTED { format!("{listed}; ... and {} more", titles.len() - LISTED) } else { listed }
}

fn many(count: usize) -> String {
    if count == 0 { "no variants".into() } else { format!("{count} variants") }
}

fn size(frame: &FieldFrame) -> String {
    format!("{} x {} cells of {} m", frame.cols, frame.rows, frame.cell_m)
}
