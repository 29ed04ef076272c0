//! Tables I and II of a batch: obstacle states, and CPU time by planner, run by run with mean and spread.
//!
//! They hold what the tables of the contest's reports hold, and beside each mean its standard deviation and its 95 %
//! confidence interval, within the range of the quantity. Single runs have rows where there are few of them; the
//! statistics are of all runs that are done.

use crate::stats::{Interval, Series, Validity};
use crate::table::{RunRecord, run_column};
use wildfire_base::document::number::optional;
use wildfire_base::document::{Block, Table};

/// The maximum number of runs that tables show individually.
pub const SHOWN_RUNS: usize = 20;

/// A column of a table: a number of every run.
#[derive(Debug)]
struct TableQuantity {
    heading: &'static str,
    /// Decimals of a run's number, and of statistics.
    decimals: [usize; 2],
    /// Columns of runs whose sum it is.
    columns: &'static [usize],
    scale: f64,
    /// The largest number that it can have; `None` for that of the first quantity.
    max: Option<f64>,
}

impl TableQuantity {
    /// A count of cells, which is the sum of these columns.
    const fn cells(heading: &'static str, columns: &'static [usize]) -> Self {
        Self { heading, decimals: [0, 2], columns, scale: 1.0, max: None }
    }

    const fn ratio(heading: &'static str, columns: &'static [usize]) -> Self {
        Self { heading, decimals: [3, 3], columns, scale: 1.0, max: Some(1.0) }
    }

    const fn milliseconds(heading: &'static str, columns: &'static [usize]) -> Self {
        Self { heading, decimals: [3, 3], columns, scale: 1e3, max: Some(f64::INFINITY) }
    }

    /// Returns the number of a run; `None` of a run that is not done.
    fn number(&self, run: &RunRecord) -> Option<f64> {
        let numbers: Option<Vec<f64>> = self.columns.iter().map(|&column| run.number(column)).collect();
        Some(numbers?.iter().sum::<f64>() * self.scale)
    }

    /// The same, and nothing for columns that tables of older programs lack.
    fn number_or_nothing(&self, run: &RunRecord) -> Option<f64> {
        self.number(run).or(CUSTOM.contains(&self.heading).then_some(0.0))
    }
}

/// The contents of a table.
#[derive(Debug)]
struct TableLayout {
    title: &'static str,
    quantities: &'static [TableQuantity],
    shows_seeds: bool,
    shows_sums: bool,
}

static OBSTACLE_STATES: TableLayout = TableLayout {
    title: "TABLE I. Obstacle states at the end of each run; burned: burning or burned out.",
    shows_seeds: true,
    shows_sums: false,
    quantities: &[
        TableQuantity { max: Some(f64::INFINITY), ..TableQuantity::cells("Total", &[run_column("obstacles")]) },
        TableQuantity::cells("Intact\ntotal", &[run_column("intact")]),
        TableQuantity::ratio("Intact\nratio", &[run_column("intact_ratio")]),
        TableQuantity::cells("Burned\ntotal", &[run_column("burning"), run_column("burned_out")]),
        TableQuantity::ratio("Burned\nratio", &[run_column("burned_ratio")]),
        TableQuantity::cells("Exting.\ntotal", &[run_column("extinguished")]),
        TableQuantity::ratio("Exting.\nratio", &[run_column("extinguished_ratio")]),
    ],
};

static CPU_TIMES: TableLayout = TableLayout {
    title: "TABLE II. CPU time of each run in milliseconds.",
    shows_seeds: false,
    shows_sums: true,
    quantities: &[
        TableQuantity::milliseconds("Clear.\nfield", &[run_column("cpu_clearance_field_s")]),
        TableQuantity::milliseconds(ROADMAP[0], &[run_column("cpu_sampling_s")]),
        TableQuantity::milliseconds(ROADMAP[1], &[run_column("cpu_map_generation_s")]),
        TableQuantity::milliseconds(ROADMAP[2], &[run_column("cpu_roadmap_search_s")]),
        TableQuantity::milliseconds("Local\nsearch", &[run_column("cpu_local_search_s")]),
        TableQuantity::milliseconds("Reacha-\nbility", &[run_column("cpu_reachability_s")]),
        TableQuantity::milliseconds(CUSTOM[0], &[run_column("cpu_custom_start_s")]),
        TableQuantity::milliseconds(CUSTOM[1], &[run_column("cpu_custom_queries_s")]),
        TableQuantity::milliseconds(PRM_ONLY, &[run_column("cpu_prm_total_s")]),
        TableQuantity::milliseconds("Unimog\ntotal", &[run_column("cpu_unimog_total_s")]),
        TableQuantity::milliseconds("Wumpus\nsearch", &[run_column("cpu_wumpus_s")]),
    ],
};

const LEGEND: [&str; 3] = [
    "PRM only: clearance field, sampling, map generation and roadmap search.",
    "Unimog total: these, local search and reachability.",
    "Intervals are Student's t on a log scale, for shares on a logit scale; none where most numbers are 0.",
];

/// The last line of the legend of a batch that a rule stopped.
const ANY_TIME_LEGEND: &str = "Intervals are those of a confidence sequence, which hold at every number of runs, on a log scale, for shares on \
                               a logit scale; none where most numbers are 0.";

/// Columns that are there only where trucks have planners that are not built in.
const CUSTOM: [&str; 2] = ["Custom\nstart", "Custom\nqueries"];

/// Columns that are left out where such planners are all that there is.
const ROADMAP: [&str; 3] = ["Samp-\nling", "Map\ngener.", "Roadmap\nsearch"];
const PRM_ONLY: &str = "PRM\nonly";

const CUSTOM_LEGEND: &str = "Custom: starts of custom planners, and queries to them.";
const CUSTOM_TOTAL: &str = "Unimog total: these, clearance field, local search and reachability.";

/// Collects rows, in the order of the plan, and creates the two tables.
#[derive(Clone, Debug)]
pub struct Tables([RunTable; 2]);

impl Default for Tables {
    fn default() -> Self {
        Self::new(Validity::AtFixedSize)
    }
}

impl Tables {
    pub fn new(validity: Validity) -> Self {
        Self([&OBSTACLE_STATES, &CPU_TIMES].map(|layout| RunTable::new(layout, validity)))
    }

    pub fn add(&mut self, run: &RunRecord) {
        self.0.iter_mut().for_each(|table| table.add(run));
    }

    /// Returns both tables with statistics only, without rows of single runs.
    pub fn means(&self) -> Vec<Block> {
        self.blocks_with(false, None)
    }

    /// Returns both tables under their captions, with notes: where to find single runs if there are too many to show,
    /// and the meaning of columns. No line is wider than a terminal.
    pub fn blocks(&self) -> Vec<Block> {
        match self.0[0].runs {
            runs if runs <= SHOWN_RUNS as u64 => self.blocks_with(true, None),
            runs => self.blocks_with(false, Some(format!("All {runs} runs are in runs.csv, one row each."))),
        }
    }

    /// Returns the same with the rows of the first runs, whatever their number.
    pub fn first_rows(&self) -> Vec<Block> {
        self.blocks_with(true, self.0[0].hidden_note())
    }

    fn blocks_with(&self, shows_runs: bool, note: Option<String>) -> Vec<Block> {
        let [states, times] = self.0.each_ref().map(|table| match shows_runs {
            true => Block::Table(table.fitted()),
            false => Block::Table(RunTable { shown: Vec::new(), ..table.clone() }.fitted()),
        });
        let mut legend = match (self.0[1].has_any(&CUSTOM), self.0[1].has_any(&ROADMAP)) {
            (false, _) => LEGEND.to_vec(),
            (true, true) => [CUSTOM_LEGEND].into_iter().chain(LEGEND).collect(),
            (true, false) => vec![CUSTOM_LEGEND, CUSTOM_TOTAL, LEGEND[2]],
        };
        if self.0[0].validity == Validity::AtAnyTime {
            *legend.last_mut().expect("the last line is there always") = ANY_TIME_LEGEND;
        }
        let legend = note.into_iter().chain(legend.into_iter().map(str::to_owned)).collect();
        vec![states, times, Block::List(legend)]
    }
}

/// A table that is being collected.
#[derive(Clone, Debug)]
struct RunTable {
    layout: &'static TableLayout,
    /// Seed and numbers of the first runs; `None` of a run that is not done.
    shown: Vec<(u64, Option<Vec<f64>>)>,
    series: Vec<Series>,
    runs: u64,
    validity: Validity,
}

impl RunTable {
    fn new(layout: &'static TableLayout, validity: Validity) -> Self {
        Self { layout, shown: Vec::new(), series: vec![Series::default(); layout.quantities.len()], runs: 0, validity }
    }

    fn add(&mut self, run: &RunRecord) {
        self.runs += 1;
        let numbers: Option<Vec<f64>> = self.layout.quantities.iter().map(|it| it.number_or_nothing(run)).collect();
        for (series, &number) in self.series.iter_mut().zip(numbers.iter().flatten()) {
            series.add(number);
        }
        if self.shown.len() < SHOWN_RUNS {
            self.shown.push((run.seed(), numbers));
        }
    }

    /// Returns whether one of these columns has a number other than zero.
    fn has_any(&self, headings: &[&str]) -> bool {
        let columns = self.layout.quantities.iter().zip(&self.series);
        columns.filter(|(quantity, _)| headings.contains(&quantity.heading)).any(|(_, series)| series.sum() > 0.0)
    }

    /// Lists the places of the columns that are shown.
    fn shown_columns(&self) -> Vec<usize> {
        let has_custom = self.has_any(&CUSTOM);
        let has_roadmap = self.has_any(&ROADMAP);
        let shown = (0..self.layout.quantities.len()).filter(|&place| match self.layout.quantities[place].heading {
            heading if CUSTOM.contains(&heading) => has_custom,
            heading if ROADMAP.contains(&heading) || heading == PRM_ONLY => has_roadmap || !has_custom,
            _ => true,
        });
        shown.collect()
    }

    fn hidden_note(&self) -> Option<String> {
        let hidden = self.runs - self.shown.len() as u64;
        (hidden > 0).then(|| format!("{hidden} more runs are in runs.csv; the statistics cover all finished runs."))
    }

    /// The table with as many decimals as a terminal has room for, at most three.
    fn fitted(&self) -> Table {
        let rounded = (1..=3).rev().map(|decimals| self.rounded_to(decimals));
        rounded.into_iter().find(Table::fits_a_terminal).unwrap_or_else(|| self.rounded_to(0))
    }

    fn rounded_to(&self, max_decimals: usize) -> Table {
        let mut rows = Vec::new();
        for (index, (seed, numbers)) in self.shown.iter().enumerate() {
            rows.push(self.row(
                (index + 1).to_string(),
                seed.to_string(),
                |quantity| quantity.decimals[0].min(max_decimals),
                |column| numbers.as_ref().map(|numbers| numbers[column]),
            ));
        }
        // CPU times add up to a total; a sum of shares means nothing.
        for (label, statistic) in STATISTICS.iter().filter(|(label, _)| self.layout.shows_sums || *label != "Sum") {
            rows.push(self.row(
                (*label).to_owned(),
                String::new(),
                |quantity| quantity.decimals[1].min(max_decimals),
                |column| statistic(&self.series[column], self.interval(column)),
            ));
        }
        let labels: &[&str] = match (self.shown.is_empty(), self.layout.shows_seeds) {
            (true, _) => &["Over runs"],
            (false, true) => &["Run", "Seed"],
            (false, false) => &["Run"],
        };
        let shown = self.shown_columns();
        let quantities = shown.iter().map(|&place| self.layout.quantities[place].heading);
        let headings: Vec<&str> = labels.iter().copied().chain(quantities).collect();
        let table = Table { rules_before: vec![self.shown.len()], ..Table::new(&headings, rows) };
        table.with_caption(self.layout.title)
    }

    fn interval(&self, column: usize) -> Option<Interval> {
        let max = self.layout.quantities[column].max.or_else(|| self.series[0].largest())?;
        self.series[column].mean_interval_for(self.validity, (0.0, max))
    }

    fn row(
        &self,
        label: String,
        seed: String,
        decimals: impl Fn(&TableQuantity) -> usize,
        number: impl Fn(usize) -> Option<f64>,
    ) -> Vec<String> {
        let cells = self
            .shown_columns()
            .into_iter()
            .map(|column| optional(number(column), decimals(&self.layout.quantities[column])));
        let has_seeds = self.layout.shows_seeds && !self.shown.is_empty();
        [label].into_iter().chain(has_seeds.then_some(seed)).chain(cells).collect()
    }
}

/// A number of a series and the interval of its mean.
type Statistic = fn(&Series, Option<Interval>) -> Option<f64>;

const STATISTICS: &[(&str, Statistic)] = &[
    ("Mean", |series, _| series.mean()),
    ("Std dev", |series, _| series.standard_deviation()),
    ("95% low", |_, interval| Some(interval?.low)),
    ("95% high", |_, interval| Some(interval?.high)),
    ("Sum", |series, _| (series.count() > 0).then(|| series.sum())),
];
