//! The metrics by which runs are compared and which reports show.

use std::borrow::Cow;
use std::sync::LazyLock;

use crate::comparison::error::ComparisonError;
use crate::comparison::runs_table::RowField;
use crate::table::Better::{Higher, Lower};
use crate::table::{Column, Kind, RUN_COLUMNS, RunRecord, TableReader, Unit, about, columns, is_measured, run_column};
use wildfire_base::untrusted::visible_start;
use wildfire_scenario::nearest_name;

/// A metric of a run: how it is computed, and its description as in the lists of columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    pub name: Cow<'static, str>,
    pub kind: MetricKind,
    /// Unit, title and better side; unknown for a column that the program did not write.
    pub about: Column<()>,
}

/// The source of a metric in the columns of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MetricKind {
    /// The column at this place among [`RUN_COLUMNS`].
    Column(usize),
    /// The sum of these columns.
    Sum(&'static [usize]),
    /// The column of the metric's name, which only the table has.
    Unknown,
    /// A time, censored at the end of the run; a run in which it never began to count has none.
    Time { event: &'static str, end: &'static str, start: &'static str },
    /// Yes if the column has this word, otherwise no.
    Answer { column: &'static str, yes: &'static str },
}

/// A metric for each of [`RUN_COLUMNS`].
static COLUMN_METRICS: LazyLock<Vec<Metric>> =
    LazyLock::new(|| (0..RUN_COLUMNS.len()).map(Metric::of_column).collect());

/// The metrics that are compared if no others are asked for.
const DEFAULTS: &[&str] =
    &["saved", "truck_won", "all_out_s", "mean_response_s", "burning_cell_s", "cpu_unimog_total_s"];

const SAVED: &[usize] = &[run_column("intact"), run_column("extinguished")];
const BURNED: &[usize] = &[run_column("burning"), run_column("burned_out")];

/// A metric that is not just a column.
pub type NamedMetric = Column<fn(()) -> MetricKind>;

/// The metrics that are not just columns.
#[rustfmt::skip]
pub const NAMED_METRICS: &[NamedMetric] = columns! { NamedMetric, _run;
    saved: Count Cells "bush cells that did not burn, or were put out" = MetricKind::Sum(SAVED), title("Saved"),
        better(Higher), phrase("$ saves", "more bushes per run", "fewer bushes per run"),
        aim("saved the most bushes", ["saved", " of the bushes"], "points more");
    burned: Count Cells "bush cells that burn or have burned out" = MetricKind::Sum(BURNED), better(Lower),
        phrase("$ loses", "more bushes per run", "fewer bushes per run");
    truck_won: Flag Share "whether the trucks won" = MetricKind::Answer { column: "winner", yes: "unimog" },
        better(Higher), phrase("with $ the truck wins", "more runs in 100", "fewer runs in 100"), scaled_by(100.0);
    wumpus_won: Flag Share "whether the Wumpuses won" = MetricKind::Answer { column: "winner", yes: "wumpus" },
        better(Lower), phrase("with $ the Wumpus wins", "more runs in 100", "fewer runs in 100"), scaled_by(100.0);
    all_out_s: optional Real Seconds "end of the last fire of a bush; the end of the run, if one burned then"
        = MetricKind::Time { event: "all_out_s", end: "ended_s", start: "first_fire_s" }, better(Lower),
        phrase("with $ all fires are out", "s later", "s sooner");
};

impl Metric {
    /// Returns the metrics of these names, or the default ones for which the tables have columns; without duplicates.
    pub fn choose(names: &[String], tables: &[TableReader]) -> Result<Vec<Self>, ComparisonError> {
        let in_all = |metric: &Self| {
            metric.columns().iter().all(|column| tables.iter().all(|table| table.place(column).is_some()))
        };
        if names.is_empty() {
            // Files of older versions lack some of the defaults, which is an error only if a metric is asked for by name.
            return Ok(DEFAULTS.iter().map(|name| Self::from_name(name)).filter(in_all).collect());
        }
        let mut metrics: Vec<Self> = Vec::new();
        for name in names {
            let metric = Self::from_name(name);
            if !in_all(&metric) {
                return Err(unknown(name, tables));
            }
            // A metric named twice would count twice in Holm's adjustment and weaken all others.
            if !metrics.contains(&metric) {
                metrics.push(metric);
            }
        }
        Ok(metrics)
    }

    /// Returns the metric of this name: one of [`NAMED_METRICS`], or a column.
    pub fn from_name(name: &str) -> Self {
        let named = NAMED_METRICS.iter().find(|metric| metric.name == name);
        let named = named.map(|metric| {
            let kind = (metric.value)(());
            let about = metric.without_value();
            Self { name: Cow::Borrowed(metric.name), kind, about }
        });
        named
            .or_else(|| COLUMN_METRICS.iter().find(|column| column.name == name).cloned())
            .unwrap_or_else(|| Self::unknown(name.to_owned(), MetricKind::Unknown))
    }

    /// Returns the metric of this name that the outcome of every run decides: neither unknown nor a measured time.
    ///
    /// # Errors
    /// [`ComparisonError::UnknownMetric`], or [`ComparisonError::MeasuredMetric`].
    pub fn of_outcomes(name: &str) -> Result<Self, ComparisonError> {
        let metric = Self::from_name(name);
        match metric.kind {
            MetricKind::Unknown => Err(unknown(name, &[])),
            MetricKind::Column(place) if !RUN_COLUMNS[place].holds_numbers() => Err(unknown(name, &[])),
            MetricKind::Column(_) if is_measured(name) => {
                Err(ComparisonError::MeasuredMetric { name: metric.name.into_owned() })
            }
            _ => Ok(metric),
        }
    }

    /// Makes the metric of a column, by its place among [`RUN_COLUMNS`].
    pub const fn of_column(place: usize) -> Self {
        let about = RUN_COLUMNS[place].without_value();
        Self { name: Cow::Borrowed(about.name), kind: MetricKind::Column(place), about }
    }

    /// Returns the metric of each column.
    pub fn of_columns() -> &'static [Self] {
        &COLUMN_METRICS
    }

    /// Creates a metric of which only the name is known.
    pub fn unknown(name: String, kind: MetricKind) -> Self {
        Self { name: name.into(), kind, about: Column::UNKNOWN }
    }

    /// Returns a run's number in a column or a sum of columns; `None` where the run has none.
    pub fn number(&self, run: &RunRecord) -> Option<f64> {
        match self.kind {
            MetricKind::Column(place) => run.number(place),
            MetricKind::Sum(places) => places.iter().map(|&place| run.number(place)).sum(),
            MetricKind::Unknown | MetricKind::Time { .. } | MetricKind::Answer { .. } => None,
        }
    }

    /// Returns a run's value, whatever its kind: an answer is 1 for yes and 0 for no, and a time that was cut off ends with
    /// the run. `None` of a run that is not done, or has none.
    pub fn value(&self, run: &RunRecord) -> Option<f64> {
        match self.kind {
            _ if !run.is_done() => None,
            MetricKind::Answer { column, yes } => Some(f64::from(u8::from(run.text(run_column(column)) == yes))),
            MetricKind::Time { event, end, start } => {
                run.number(run_column(start))?;
                run.number(run_column(event)).or_else(|| run.number(run_column(end)))
            }
            _ => self.number(run),
        }
    }

    fn columns(&self) -> Vec<&str> {
        match self.kind {
            MetricKind::Column(_) | MetricKind::Unknown => vec![&self.name],
            MetricKind::Sum(places) => places.iter().map(|&place| RUN_COLUMNS[place].name).collect(),
            MetricKind::Time { event, end, start } => vec![event, end, start],
            MetricKind::Answer { column, .. } => vec![column],
        }
    }

    /// Returns the fields to read for the metric, in the order of its columns.
    pub fn fields(&self) -> Vec<RowField> {
        match self.kind {
            MetricKind::Answer { column, yes } => vec![RowField::Is(column.to_owned(), yes)],
            _ => self.columns().into_iter().map(|column| RowField::Number(column.to_owned())).collect(),
        }
    }
}

fn unknown(name: &str, tables: &[TableReader]) -> ComparisonError {
    let named = NAMED_METRICS.iter().map(|metric| metric.name);
    let written = tables.iter().flat_map(TableReader::columns).map(String::as_str);
    let columns = written.chain(RUN_COLUMNS.iter().map(|column| column.name));
    ComparisonError::UnknownMetric {
        name: visible_start(name),
        nearest: nearest_name(name, named.clone().chain(columns)).map(|name| visible_start(&name)),
        valid: named.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
    }
}
