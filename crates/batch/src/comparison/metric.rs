//! The metrics by which runs are compared.

use crate::comparison::error::ComparisonError;
use crate::comparison::runs_table::Field;
use crate::table::{Phrase, RUN_COLUMNS, TableReader, Unit};
use wildfire_base::untrusted::visible_start;
use wildfire_sim::scenario::nearest_name;

/// A quantity of a run, with how it is found and how it is spoken of.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    pub name: String,
    pub kind: MetricKind,
    pub phrase: Option<Phrase>,
}

/// The way in which a metric is found from the columns of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum MetricKind {
    /// The sum of these columns.
    Sum(Vec<String>),
    /// A time, cut off where the run ended before; there is none in a run in which it never began to count.
    Time { event: &'static str, end: &'static str, begun: &'static str },
    /// Yes if the column holds this word, else no.
    Answer { column: &'static str, yes: &'static str },
}

/// The metrics that are compared if no others are asked for.
const DEFAULTS: &[&str] =
    &["saved", "truck_won", "all_out_s", "mean_response_s", "burning_cell_s", "cpu_unimog_total_s"];

/// The side on which a metric's better values are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    Higher,
    Lower,
}

/// The metrics and columns of which a higher value is better for the trucks.
const HIGHER_IS_BETTER: &[&str] =
    &["saved", "truck_won", "intact", "extinguished", "intact_ratio", "extinguished_ratio", "truck_score"];

/// Those of which a lower value is, besides columns that begin like these.
const LOWER_IS_BETTER: &[&str] = &[
    "burned",
    "wumpus_won",
    "all_out_s",
    "burning",
    "burned_out",
    "burned_ratio",
    "caught_by_spread",
    "burning_cell_s",
    "peak_burning",
    "mean_response_s",
    "wumpus_score",
    "regret",
    "truck_stuck_s",
    "truck_lattice_plans",
    "truck_planning_s",
    "truck_standing_s",
    "truck_longest_idle_s",
    "truck_cusps",
    "truck_distance_m",
    "truck_wasted_drives",
    "truck_waiting_s",
    "truck_deadlocks",
    "truck_roadmap_expansions",
    "truck_local_expansions",
];
const LOWER_IS_BETTER_FROM: &[&str] = &["truck_failed_", "cpu_", "wall_"];

/// A metric that is not just a column.
pub struct NamedMetric {
    pub name: &'static str,
    unit: Unit,
    find: Find,
    phrase: Phrase,
}

enum Find {
    Sum([&'static str; 2]),
    Winner(&'static str),
    Time { event: &'static str, end: &'static str, begun: &'static str },
}

/// The metrics that are not just columns.
pub static NAMED_METRICS: [NamedMetric; 5] = [
    NamedMetric {
        name: "saved",
        unit: Unit::Cells,
        find: Find::Sum(["intact", "extinguished"]),
        phrase: Phrase::new("saves", "more obstacles per run", "fewer obstacles per run"),
    },
    NamedMetric {
        name: "burned",
        unit: Unit::Cells,
        find: Find::Sum(["burning", "burned_out"]),
        phrase: Phrase::new("loses", "more obstacles per run", "fewer obstacles per run"),
    },
    NamedMetric {
        name: "truck_won",
        unit: Unit::Share,
        find: Find::Winner("unimog"),
        phrase: Phrase::new("wins for the truck", "more runs of a hundred", "fewer runs of a hundred").in_hundreds(),
    },
    NamedMetric {
        name: "wumpus_won",
        unit: Unit::Share,
        find: Find::Winner("wumpus"),
        phrase: Phrase::new("wins for the Wumpus", "more runs of a hundred", "fewer runs of a hundred").in_hundreds(),
    },
    NamedMetric {
        name: "all_out_s",
        unit: Unit::Seconds,
        find: Find::Time { event: "all_out_s", end: "ended_s", begun: "first_fire_s" },
        phrase: Phrase::new("has all fires out", "s later", "s sooner"),
    },
];

impl Metric {
    /// Returns the metrics of these names, or the usual ones that the tables have columns for; each once.
    pub fn choose(names: &[String], tables: &[TableReader]) -> Result<Vec<Self>, ComparisonError> {
        let in_all = |metric: &Self| {
            metric.columns().iter().all(|column| tables.iter().all(|table| table.place(column).is_some()))
        };
        if names.is_empty() {
            return Ok(DEFAULTS.iter().map(|name| Self::from_name(name)).filter(in_all).collect());
        }
        let mut metrics: Vec<Self> = Vec::new();
        for name in names {
            let metric = Self::from_name(name);
            if !in_all(&metric) {
                return Err(unknown(name, tables));
            }
            if !metrics.contains(&metric) {
                metrics.push(metric);
            }
        }
        Ok(metrics)
    }

    /// Returns the metric of this name: one of [`NAMED_METRICS`], or a column.
    pub fn from_name(name: &str) -> Self {
        let Some(metric) = NAMED_METRICS.iter().find(|metric| metric.name == name) else {
            let column = RUN_COLUMNS.iter().find(|column| column.name == name);
            let kind = MetricKind::Sum(vec![name.to_owned()]);
            return Self { name: name.to_owned(), kind, phrase: column.and_then(|column| column.phrase) };
        };
        let kind = match metric.find {
            Find::Sum(columns) => MetricKind::Sum(columns.map(str::to_owned).to_vec()),
            Find::Winner(yes) => MetricKind::Answer { column: "winner", yes },
            Find::Time { event, end, begun } => MetricKind::Time { event, end, begun },
        };
        Self { name: name.to_owned(), kind, phrase: Some(metric.phrase) }
    }

    /// Returns the side of the better values, from where the trucks stand; `None` if the metric does not say it.
    pub fn better(&self) -> Option<Better> {
        let name = self.name.as_str();
        match () {
            () if HIGHER_IS_BETTER.contains(&name) => Some(Better::Higher),
            () if LOWER_IS_BETTER.contains(&name) => Some(Better::Lower),
            () if LOWER_IS_BETTER_FROM.iter().any(|start| name.starts_with(start)) => Some(Better::Lower),
            () => None,
        }
    }

    /// Returns the unit of its values; [`Unit::None`] of counts, and of columns that are not the program's own.
    pub fn unit(&self) -> Unit {
        let named = NAMED_METRICS.iter().find(|metric| metric.name == self.name).map(|metric| metric.unit);
        let of_column = || RUN_COLUMNS.iter().find(|column| column.name == self.name).map(|column| column.unit);
        named.or_else(of_column).unwrap_or(Unit::None)
    }

    fn columns(&self) -> Vec<&str> {
        match &self.kind {
            MetricKind::Sum(columns) => columns.iter().map(String::as_str).collect(),
            MetricKind::Time { event, end, begun } => vec![event, end, begun],
            MetricKind::Answer { column, .. } => vec![column],
        }
    }

    /// Returns what has to be read for it, in the order of its columns.
    pub fn fields(&self) -> Vec<Field> {
        match self.kind {
            MetricKind::Answer { column, yes } => vec![Field::Is(column.to_owned(), yes)],
            _ => self.columns().into_iter().map(|column| Field::Number(column.to_owned())).collect(),
        }
    }
}

fn unknown(name: &str, tables: &[TableReader]) -> ComparisonError {
    let named = || NAMED_METRICS.iter().map(|metric| metric.name);
    let columns = tables.iter().flat_map(TableReader::columns).map(String::as_str);
    ComparisonError::UnknownMetric {
        name: visible_start(name),
        nearest: nearest_name(name, named().chain(columns)).map(|name| visible_start(&name)),
        known: named().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
    }
}
