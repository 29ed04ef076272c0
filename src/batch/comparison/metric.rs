//! What runs are compared by.

use crate::batch::comparison::error::ComparisonError;
use crate::batch::comparison::runs_file::{Field, RunsFile};
use crate::batch::comparison::words::{Phrase, shown};
use crate::scenario::nearest_name;

/// A quantity of a run, with how it is found and how it is spoken of.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    pub name: String,
    pub kind: MetricKind,
    pub phrase: Phrase,
}

/// How a metric is found from the columns of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum MetricKind {
    /// The sum of these columns.
    Sum(Vec<String>),
    /// A time, cut off where the run ended before; there is none in a run in which it never began to count.
    Time { event: String, end: String, begun: String },
    /// Whether the column holds this word.
    Answer { column: String, yes: &'static str },
}

/// What is compared if nothing else is asked for.
const DEFAULTS: &[&str] =
    &["saved", "truck_won", "all_out_s", "mean_response_s", "burning_cell_s", "cpu_unimog_total_s"];

/// Metrics that have names of their own, and what they are of the columns.
pub const NAMED_METRICS: &[(&str, &str)] = &[
    ("saved", "intact + extinguished"),
    ("burned", "burning + burned_out"),
    ("truck_won", "winner is unimog"),
    ("wumpus_won", "winner is wumpus"),
    ("all_out_s", "cut off at ended_s"),
];

impl Metric {
    /// The metrics of these names, or the usual ones that the files have columns for; each once.
    pub fn choose(names: &[String], files: &[RunsFile]) -> Result<Vec<Self>, ComparisonError> {
        let in_all = |metric: &Self| metric.columns().all(|column| files.iter().all(|file| file.has(column)));
        if names.is_empty() {
            return Ok(DEFAULTS.iter().map(|name| Self::named(name)).filter(in_all).collect());
        }
        let mut metrics: Vec<Self> = Vec::new();
        for name in names {
            let metric = Self::named(name);
            if !in_all(&metric) {
                return Err(unknown(name, files));
            }
            if !metrics.contains(&metric) {
                metrics.push(metric);
            }
        }
        Ok(metrics)
    }

    fn named(name: &str) -> Self {
        let sum = |columns: &[&str]| MetricKind::Sum(columns.iter().map(|&column| column.into()).collect());
        let won = |yes| MetricKind::Answer { column: "winner".into(), yes };
        let kind = match name {
            "saved" => sum(&["intact", "extinguished"]),
            "burned" => sum(&["burning", "burned_out"]),
            "truck_won" => won("unimog"),
            "wumpus_won" => won("wumpus"),
            "all_out_s" => MetricKind::Time { event: name.into(), end: "ended_s".into(), begun: "first_fire_s".into() },
            _ => sum(&[name]),
        };
        Self { name: name.into(), kind, phrase: Phrase::of(name) }
    }

    fn columns(&self) -> impl Iterator<Item = &String> {
        let columns = match &self.kind {
            MetricKind::Sum(columns) => columns.iter().collect(),
            MetricKind::Time { event, end, begun } => vec![event, end, begun],
            MetricKind::Answer { column, .. } => vec![column],
        };
        columns.into_iter()
    }

    /// What has to be read for it, in the order of its columns.
    pub fn fields(&self) -> Vec<Field> {
        match &self.kind {
            MetricKind::Answer { column, yes } => vec![Field::Is(column.clone(), yes)],
            _ => self.columns().cloned().map(Field::Number).collect(),
        }
    }
}

fn unknown(name: &str, files: &[RunsFile]) -> ComparisonError {
    let named = || NAMED_METRICS.iter().map(|(name, _)| *name);
    let columns = files.iter().flat_map(RunsFile::columns).map(String::as_str);
    ComparisonError::UnknownMetric {
        name: shown(name),
        nearest: nearest_name(name, named().chain(columns)).map(|name| shown(&name)),
        known: named().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
    }
}
