//! Tables I and II of a batch: obstacle states, and CPU time by planner, run by run with mean and spread.
//!
//! They hold what the tables of the contest's reports hold, and beside each mean its standard deviation and its 95 %
//! confidence interval (Student's t). Rows of single runs are kept for the first of a batch only; the statistics are
//! of all runs that are done.

use crate::batch::execute::{RunResult, RunRow};
use crate::batch::text_table::TextTable;
use crate::stats::Series;

/// The most runs that a table shows one by one.
pub const SHOWN_RUNS: usize = 20;

/// The width that tables are fitted to, in characters.
const WIDTH: usize = 80;

/// A column of a table: a number of every run.
#[derive(Debug)]
struct Quantity {
    heading: &'static [&'static str],
    /// Decimals of a run's number, and of statistics.
    decimals: [usize; 2],
    of: fn(&RunResult) -> f64,
}

/// What a table shows.
#[derive(Debug)]
struct Layout {
    title: &'static str,
    quantities: &'static [Quantity],
    shows_seeds: bool,
    shows_sums: bool,
}

static OBSTACLE_STATES: Layout = Layout {
    title: "TABLE I. Obstacle states at the end of each run; burned: burning or burned out.",
    shows_seeds: true,
    shows_sums: false,
    quantities: &[
        Quantity { heading: &["Total"], decimals: [0, 2], of: |r| r.outcome.obstacles.into() },
        Quantity { heading: &["Intact", "total"], decimals: [0, 2], of: |r| r.outcome.intact.into() },
        Quantity { heading: &["Intact", "ratio"], decimals: [3, 3], of: |r| r.outcome.intact_ratio() },
        Quantity { heading: &["Burned", "total"], decimals: [0, 2], of: |r| r.outcome.burned().into() },
        Quantity { heading: &["Burned", "ratio"], decimals: [3, 3], of: |r| r.outcome.burned_ratio() },
        Quantity { heading: &["Exting.", "total"], decimals: [0, 2], of: |r| r.outcome.extinguished.into() },
        Quantity { heading: &["Exting.", "ratio"], decimals: [3, 3], of: |r| r.outcome.extinguished_ratio() },
    ],
};

static CPU_TIMES: Layout = Layout {
    title: "TABLE II. CPU time of each run in milliseconds.",
    shows_seeds: false,
    shows_sums: true,
    quantities: &[
        Quantity { heading: &["Clear.", "field"], decimals: [3, 3], of: |r| r.cpu.clearance_field_s * 1e3 },
        Quantity { heading: &["Samp-", "ling"], decimals: [3, 3], of: |r| r.cpu.sampling_s * 1e3 },
        Quantity { heading: &["Map", "gener."], decimals: [3, 3], of: |r| r.cpu.map_generation_s * 1e3 },
        Quantity { heading: &["Roadmap", "search"], decimals: [3, 3], of: |r| r.cpu.roadmap_search_s * 1e3 },
        Quantity { heading: &["Local", "search"], decimals: [3, 3], of: |r| r.cpu.local_search_s * 1e3 },
        Quantity { heading: &["Reacha-", "bility"], decimals: [3, 3], of: |r| r.cpu.reachability_s * 1e3 },
        Quantity { heading: &["PRM", "only"], decimals: [3, 3], of: |r| r.cpu.prm_total_s() * 1e3 },
        Quantity { heading: &["Unimog", "total"], decimals: [3, 3], of: |r| r.cpu.unimog_total_s() * 1e3 },
        Quantity { heading: &["Wumpus", "search"], decimals: [3, 3], of: |r| r.cpu.wumpus_s * 1e3 },
    ],
};

const LEGEND: &str = "\
PRM only: clearance field, sampling, map generation and roadmap search.
Unimog total: that, local search and reachability.
Intervals are Student's t and may leave the possible range.
";

/// Collects rows, in the order of the plan, and prints the two tables.
#[derive(Clone, Debug)]
pub struct Tables([Table; 2]);

impl Default for Tables {
    fn default() -> Self {
        Self([Table::new(&OBSTACLE_STATES), Table::new(&CPU_TIMES)])
    }
}

impl Tables {
    pub fn add(&mut self, row: &RunRow) {
        self.0.iter_mut().for_each(|table| table.add(row));
    }

    /// Both tables with their titles, with as many decimals as a terminal has room for.
    pub fn titled(&self) -> [(&'static str, TextTable); 2] {
        self.0.each_ref().map(|table| (table.layout.title, table.fitted()))
    }

    /// What else is to be said of them: runs that are not shown one by one, and what columns mean.
    pub fn notes(&self) -> String {
        format!("{}\n{LEGEND}", self.0[0].hidden_note())
    }

    /// Both tables for a terminal, at most 80 columns wide.
    pub fn to_text(&self) -> String {
        self.written(|table| format!("{}\n\n{}", table.layout.title, table.fitted().to_text()))
    }

    pub fn to_markdown(&self) -> String {
        self.written(|table| format!("**{}**\n\n{}", table.layout.title, table.fitted().to_markdown()))
    }

    fn written(&self, write: impl Fn(&Table) -> String) -> String {
        let [states, times] = self.0.each_ref();
        let note = states.hidden_note();
        format!("{}{note}\n{}{note}\n{LEGEND}", write(states), write(times))
    }
}

#[derive(Clone, Debug)]
struct Table {
    layout: &'static Layout,
    /// Seed and numbers of the first runs; `None` of a run that is not done.
    shown: Vec<(u64, Option<Vec<f64>>)>,
    series: Vec<Series>,
    runs: u64,
}

impl Table {
    fn new(layout: &'static Layout) -> Self {
        Self { layout, shown: Vec::new(), series: vec![Series::default(); layout.quantities.len()], runs: 0 }
    }

    fn add(&mut self, row: &RunRow) {
        self.runs += 1;
        let numbers_of = |result| self.layout.quantities.iter().map(|quantity| (quantity.of)(result)).collect();
        let numbers: Option<Vec<f64>> = row.result.as_ref().map(numbers_of);
        for (series, &number) in self.series.iter_mut().zip(numbers.iter().flatten()) {
            series.add(number);
        }
        if self.shown.len() < SHOWN_RUNS {
            self.shown.push((row.label.seed, numbers));
        }
    }

    fn hidden_note(&self) -> String {
        match self.runs - self.shown.len() as u64 {
            0 => String::new(),
            hidden => format!("\n{hidden} more runs are in runs.csv; the statistics are of all runs that are done.\n"),
        }
    }

    /// With as many decimals as the width allows, at most three.
    fn fitted(&self) -> TextTable {
        let fits = |table: &TextTable| table.to_text().lines().all(|line| line.chars().count() <= WIDTH);
        let rounded = (1..=3).rev().map(|decimals| self.rounded_to(decimals));
        rounded.into_iter().find(fits).unwrap_or_else(|| self.rounded_to(0))
    }

    fn rounded_to(&self, most_decimals: usize) -> TextTable {
        let mut rows = Vec::new();
        for (index, (seed, numbers)) in self.shown.iter().enumerate() {
            let number = |column: usize| numbers.as_ref().map(|numbers| numbers[column]);
            let decimals = |quantity: &Quantity| quantity.decimals[0].min(most_decimals);
            rows.push(self.row((index + 1).to_string(), seed.to_string(), decimals, number));
        }
        for (label, statistic) in STATISTICS.iter().filter(|(label, _)| self.layout.shows_sums || *label != "Sum") {
            let number = |column: usize| statistic(&self.series[column]);
            let decimals = |quantity: &Quantity| quantity.decimals[1].min(most_decimals);
            rows.push(self.row((*label).to_owned(), String::new(), decimals, number));
        }
        TextTable { headings: self.headings(), rows, rules_before: vec![self.shown.len()] }
    }

    fn headings(&self) -> Vec<Vec<String>> {
        let lines = |lines: &[&str]| lines.iter().map(|&line| line.to_owned()).collect();
        let labels: &[&[&str]] = if self.layout.shows_seeds { &[&["Run"], &["Seed"]] } else { &[&["Run"]] };
        let quantities = self.layout.quantities.iter().map(|quantity| quantity.heading);
        labels.iter().copied().chain(quantities).map(lines).collect()
    }

    fn row(
        &self,
        label: String,
        seed: String,
        decimals: impl Fn(&Quantity) -> usize,
        number: impl Fn(usize) -> Option<f64>,
    ) -> Vec<String> {
        let cell = |(column, quantity)| match number(column) {
            Some(number) => rounded(number, decimals(quantity)),
            None => "-".into(),
        };
        let cells = self.layout.quantities.iter().enumerate().map(cell);
        [label].into_iter().chain(self.layout.shows_seeds.then_some(seed)).chain(cells).collect()
    }
}

/// The number with so many decimals, zero without a sign.
fn rounded(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let is_zero = text.chars().all(|letter| "-0.".contains(letter));
    if is_zero { text.trim_start_matches('-').into() } else { text }
}

type Statistic = fn(&Series) -> Option<f64>;

const STATISTICS: &[(&str, Statistic)] = &[
    ("Mean", Series::mean),
    ("Std dev", Series::standard_deviation),
    ("95% low", |series| Some(series.mean_interval()?.low)),
    ("95% high", |series| Some(series.mean_interval()?.high)),
    ("Sum", |series| (series.count() > 0).then(|| series.sum())),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(rounded(-0.001, 2), "0.00");
        assert_eq!(rounded(-0.0, 0), "0");
        assert_eq!(rounded(-0.01, 2), "-0.01");
        assert_eq!(rounded(-10.0, 0), "-10");
    }
}
