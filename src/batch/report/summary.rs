//! What a finished batch says besides its files: tables and tally of each variant, and means of all.

use crate::batch::execute::RunRow;
use crate::batch::report::notes::notes;
use crate::batch::report::profile::Profile;
use crate::batch::report::tables::Tables;
use crate::batch::report::tally::Tally;
use crate::batch::table::{RunRecord, run_column};
use crate::batch::text_table::TextTable;
use crate::scenario::Scenario;
use crate::stats::Series;

/// A report of each variant, in the order of the plan.
#[derive(Clone, Debug, Default)]
pub struct BatchReport {
    pub variants: Vec<VariantReport>,
}

/// What is reported of one variant.
#[derive(Clone, Debug, Default)]
pub struct VariantReport {
    pub title: String,
    pub tables: Tables,
    pub tally: Tally,
    /// Whether the scenario has agents on both sides.
    is_contest: bool,
    /// Of each of [`MEANS`].
    means: [Series; MEANS.len()],
    profile: Profile,
}

/// A mean that the overview of several variants shows, over runs that are done.
struct Mean {
    heading: [&'static str; 2],
    column: usize,
    scale: f64,
    decimals: usize,
}

const MEANS: [Mean; 5] = [
    Mean { heading: ["Intact", "ratio"], column: run_column("intact_ratio"), scale: 1.0, decimals: 3 },
    Mean { heading: ["Burned", "ratio"], column: run_column("burned_ratio"), scale: 1.0, decimals: 3 },
    Mean { heading: ["Exting.", "ratio"], column: run_column("extinguished_ratio"), scale: 1.0, decimals: 3 },
    Mean { heading: ["Truck", "stuck s"], column: run_column("truck_stuck_s"), scale: 1.0, decimals: 1 },
    Mean { heading: ["Unimog", "CPU ms"], column: run_column("cpu_unimog_total_s"), scale: 1e3, decimals: 2 },
];

impl VariantReport {
    /// The report of a variant, without any run yet.
    pub fn new(title: String, scenario: &Scenario) -> Self {
        let is_contest = !scenario.wumpus.is_empty() && !scenario.unimog.is_empty();
        Self { title, is_contest, ..Self::default() }
    }

    /// Adds the next run of the plan.
    pub fn add(&mut self, run: &RunRecord) {
        self.tables.add(run);
        self.tally.add(run, self.is_contest);
        for (series, mean) in self.means.iter_mut().zip(&MEANS) {
            run.number(mean.column).into_iter().for_each(|number| series.add(number * mean.scale));
        }
    }

    /// Adds what a run's row in a table does not say: notes on its agents, and how much CPU time its facts took.
    pub fn add_detail(&mut self, row: &RunRow) {
        let Some(result) = &row.result else { return };
        self.tally.add_notes(row.label.seed, notes(result));
        self.profile.add(row);
    }
}

impl BatchReport {
    /// Runs without a result.
    pub fn not_done(&self) -> u64 {
        self.variants.iter().map(|variant| variant.tally.not_done()).sum()
    }

    /// Tables and tally of each variant, under its title if there are several.
    pub fn to_markdown(&self) -> String {
        let part = |variant: &VariantReport| format!("{}\n{}\n", variant.tables.to_markdown(), variant.tally);
        match self.variants.as_slice() {
            [one] => part(one),
            several => {
                let titled = |variant: &VariantReport| format!("## {}\n\n{}", variant.title, part(variant));
                several.iter().map(titled).collect::<Vec<_>>().join("\n")
            }
        }
    }

    /// For each variant where its CPU time went.
    pub fn profile(&self) -> String {
        let part = |variant: &VariantReport| format!("CPU time of {}\n\n{}", variant.title, variant.profile.to_text());
        self.variants.iter().map(part).collect::<Vec<_>>().join("\n")
    }

    /// A line for each variant: how many runs are done, and means over them; and what there is to note of any.
    pub fn overview(&self) -> String {
        let titles = self.variants.iter().enumerate();
        let titles: String = titles.map(|(index, variant)| format!("{}: {}\n", index + 1, variant.title)).collect();
        let table = self.overview_table().to_text();
        let noted = self.variants.iter().enumerate().map(|(index, variant)| (index + 1, variant.tally.notes()));
        let noted = noted.filter(|(_, notes)| !notes.is_empty());
        let notes: String = noted.map(|(number, notes)| format!("\n{number}: {}", notes.join("\n"))).collect();
        format!("{titles}\n{table}\nMeans of the runs that are done. tables.md has the tables of each variant.{notes}")
    }

    /// The same as a table, in which variants are numbers from 1.
    pub fn overview_table(&self) -> TextTable {
        let first = [&["Variant"][..], &["Runs", "done"], &["Not", "done"]];
        let headings = first.into_iter().chain(MEANS.iter().map(|mean| &mean.heading[..]));
        let headings = headings.map(|lines| lines.iter().map(|&line| line.to_owned()).collect()).collect();
        let rows = self.variants.iter().enumerate().map(|(index, variant)| variant.overview_row(index + 1)).collect();
        TextTable { headings, rows, rules_before: Vec::new() }
    }
}

impl VariantReport {
    fn overview_row(&self, number: usize) -> Vec<String> {
        let counts = [number as u64, self.tally.done, self.tally.not_done()].map(|count| count.to_string());
        let mean = |(series, mean): (&Series, &Mean)| match series.mean() {
            Some(number) => format!("{number:.0$}", mean.decimals),
            None => "-".into(),
        };
        counts.into_iter().chain(self.means.iter().zip(&MEANS).map(mean)).collect()
    }
}
