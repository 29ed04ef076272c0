//! Errors of rankings.

use std::path::PathBuf;

use thiserror::Error;

use crate::comparison::ComparisonError;
use crate::plan::FreeKeysError;

/// The reason why batches cannot be ranked.
#[derive(Debug, Error)]
pub enum RankingError {
    #[error(transparent)]
    Comparison(#[from] ComparisonError),
    #[error("{0}")]
    Free(#[from] FreeKeysError),
    #[error("the rules of {} are not known: {reason}", path.display())]
    RulesUnknown { path: PathBuf, reason: String },
    #[error("{} and {} do not have the same seeds: {} and {}; expected all entries to have the same", names[0], names[1], seeds[0], seeds[1])]
    OtherSeeds { names: [String; 2], seeds: [String; 2] },
    #[error("{} and {} do not have the same combinations of {columns}; expected all entries to have the same", names[0], names[1])]
    OtherConditions { names: [String; 2], columns: String },
    #[error("{entry} has no column `{column}`, in which the runs of other entries differ")]
    NoColumn { entry: String, column: String },
    #[error("{} and {} did not play by the same rules: {differences}", names[0], names[1])]
    OtherRules { names: [String; 2], differences: String },
    #[error(
        "{entry} has `reuse = true` in [{table}]: its program is kept from run to run, so knowledge may pass between them; \
         expected a program for each run"
    )]
    Reuse { entry: String, table: String },
    #[error("{entry}, seed {seed}: {reason}, so no run wrote this row")]
    Impossible { entry: String, seed: u64, reason: String },
    #[error("there is no entry `{name}`{}", .nearest.as_ref().map_or(String::new(), |nearest| format!(": did you mean `{nearest}`?")))]
    NoEntry { name: String, nearest: Option<String> },
    #[error("no entry is left; expected at least one that is not left out")]
    NobodyLeft,
    #[error("{name} is given twice; expected every entry once")]
    EntryTwice { name: String },
    #[error("{count} or more entries are too many; expected at most {limit}")]
    TooMany { count: usize, limit: usize },
    #[error("`{metric}` has no built-in better side: add `--better higher` or `--better lower`")]
    WhichIsBetter { metric: String },
    #[error("no run has a value of `{metric}`; expected another metric")]
    NoValues { metric: String },
}
