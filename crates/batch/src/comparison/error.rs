//! Errors of comparisons.

use std::path::PathBuf;

use thiserror::Error;

use crate::execute::UnexpectedFile;
use crate::table::TableError;

/// The reason why batches cannot be compared. Text from files is shown as
/// [`visible_start`](wildfire_base::untrusted::visible_start) makes it.
#[derive(Debug, Error)]
pub enum ComparisonError {
    #[error(transparent)]
    Table(#[from] TableError),
    #[error("{}: expected a folder with a runs.csv, or such a file", path.display())]
    NoBatch { path: PathBuf },
    #[error("{} has no runs.csv yet: the tables of its batch are not written", folder.display())]
    Stopped { folder: PathBuf },
    #[error(transparent)]
    Strange(#[from] UnexpectedFile),
    #[error("{}: expected a table that `wildfire batch` wrote: there is no column `{column}`", path.display())]
    NotATableOfRuns { path: PathBuf, column: &'static str },
    #[error("{}: more than {limit} rows; expected no more", path.display())]
    TooManyRows { path: PathBuf, limit: u64 },
    #[error("{} has no runs to compare", path.display())]
    NoRows { path: PathBuf },
    #[error("there is no metric `{name}`: {}expected {valid}, or a column of numbers in runs.csv", did_you_mean(.nearest.as_deref()))]
    UnknownMetric { name: String, nearest: Option<String>, valid: String },
    #[error("{option} is for a number of seeds that was fixed before; a rule stopped these runs when enough was known")]
    StoppedByRule { option: &'static str },
    #[error(
        "`{name}` is measured and differs from machine to machine; expected a metric that the outcome of a run decides"
    )]
    MeasuredMetric { name: String },
    #[error("{}: there is no column `{column}` to choose runs by: {}{}", path.display(), did_you_mean(.nearest.as_deref()), offered(.valid))]
    UnknownCondition { path: PathBuf, column: String, nearest: Option<String>, valid: Vec<String> },
    #[error("{}: no run has {column} `{value}`: {}", path.display(), offered(.valid))]
    UnknownLevel { path: PathBuf, column: String, value: String, valid: Vec<String> },
    #[error("{}: {}", path.display(), nothing_to_compare(.varying))]
    WhatToCompare { path: PathBuf, varying: Vec<String> },
    #[error("{}: all runs have {column} `{value}`; expected at least two values to compare", path.display())]
    OneLevel { path: PathBuf, column: String, value: String },
    #[error("{}: seed {seed} occurs twice; expected every seed once under the same conditions", path.display())]
    SeedTwice { path: PathBuf, seed: u64 },
    #[error("A and {other} share no seed{}, so no runs can be paired", under_equal(.varying))]
    NoPairs { other: char, varying: Vec<String> },
    #[error("{option} {amount}: no metric has this unit; expected one of {}", .units.join(", "))]
    NoSuchUnit { option: &'static str, amount: String, units: Vec<String> },
    #[error("{count} batches are too many; expected at most {limit}")]
    TooManySides { count: usize, limit: usize },
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or(String::new(), |nearest| format!("did you mean `{nearest}`? "))
}

fn listed(names: &[String]) -> String {
    /// More names than this do not help.
    const MAX: usize = 12;
    let shown: Vec<_> = names.iter().take(MAX).map(|name| format!("`{name}`")).collect();
    let rest = if names.len() > MAX { " and others" } else { "" };
    format!("{}{rest}", shown.join(", "))
}

fn offered(names: &[String]) -> String {
    if names.is_empty() { "there is none".into() } else { format!("expected {}", listed(names)) }
}

fn nothing_to_compare(varying: &[String]) -> String {
    match varying {
        [] => "all its runs are of one scenario and planner; expected a second batch to compare with".into(),
        varying => format!("several things vary in it, {}; choose one with --by", listed(varying)),
    }
}

fn under_equal(varying: &[String]) -> String {
    if varying.is_empty() { String::new() } else { format!(" under equal {}", listed(varying)) }
}
