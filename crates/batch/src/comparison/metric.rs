//! The metrics by which runs are compared.

use crate::comparison::error::ComparisonError;
use crate::comparison::runs_table::Field;
use crate::table::Better::{self, Higher, Lower};
use crate::table::{Column, Kind, Phrase, RUN_COLUMNS, TableReader, Unit, about, columns};
use wildfire_base::untrusted::visible_start;
use wildfire_sim::scenario::nearest_name;

/// A quantity of a run, with how it is found and how it is spoken of.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    pub name: String,
    pub kind: MetricKind,
    /// [`Unit::None`] of counts, and of columns that are not the program's own.
    pub unit: Unit,
    /// The side of the better values, from where the trucks stand; `None` if it is not known.
    pub better: Option<Better>,
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

/// A metric that is not just a column.
pub type NamedMetric = Column<fn(()) -> MetricKind>;

/// The metrics that are not just columns.
#[rustfmt::skip]
pub const NAMED_METRICS: &[NamedMetric] = columns! { NamedMetric, _run;
    saved: Count Cells "bush cells that did not burn, or were put out" = sum(&["intact", "extinguished"]), title("Saved"),
        better(Higher), phrase("saves", "more obstacles per run", "fewer obstacles per run"),
        aim("saved the most bushes", ["saved", " of the bushes"], "points more");
    burned: Count Cells "bush cells that burn or have burned out" = sum(&["burning", "burned_out"]), better(Lower),
        phrase("loses", "more obstacles per run", "fewer obstacles per run");
    truck_won: Flag Share "whether the trucks won" = MetricKind::Answer { column: "winner", yes: "unimog" },
        better(Higher), phrase("wins for the truck", "more runs of a hundred", "fewer runs of a hundred"), in_hundreds();
    wumpus_won: Flag Share "whether the Wumpuses won" = MetricKind::Answer { column: "winner", yes: "wumpus" },
        better(Lower), phrase("wins for the Wumpus", "more runs of a hundred", "fewer runs of a hundred"), in_hundreds();
    all_out_s: optional Real Seconds "end of the last fire of a bush; the end of the run, if one burned then"
        = MetricKind::Time { event: "all_out_s", end: "ended_s", begun: "first_fire_s" }, better(Lower),
        phrase("has all fires out", "s later", "s sooner");
};

fn sum(columns: &[&str]) -> MetricKind {
    MetricKind::Sum(columns.iter().map(|&column| column.to_owned()).collect())
}

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
        let named = NAMED_METRICS.iter().find(|metric| metric.name == name);
        let named = named.map(|metric| (metric.without_value(), (metric.value)(())));
        let column = || RUN_COLUMNS.iter().find(|column| column.name == name);
        match named.or_else(|| column().map(|column| (column.without_value(), sum(&[name])))) {
            Some((Column { unit, better, phrase, .. }, kind)) => {
                Self { name: name.to_owned(), kind, unit, better, phrase }
            }
            None => Self::unknown(name.to_owned(), sum(&[name])),
        }
    }

    /// Makes a metric of which nothing but its name is known.
    pub fn unknown(name: String, kind: MetricKind) -> Self {
        Self { name, kind, unit: Unit::None, better: None, phrase: None }
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
