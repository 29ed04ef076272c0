//! What a finished batch says besides its files: tables and tally of each variant, and means of all.

use crate::batch::execute::RunRow;
use crate::batch::report::fleets::{Fleet, fleets_table};
use crate::batch::report::notes::notes;
use crate::batch::report::profile::Profile;
use crate::batch::report::tables::Tables;
use crate::batch::report::tally::Tally;
use crate::batch::table::{RunRecord, run_column};
use crate::document::number::optional;
use crate::document::{Block, Document, Table};
use crate::scenario::Scenario;
use crate::stats::Series;

/// A report of each variant, in the order of the plan.
#[derive(Clone, Debug, Default)]
pub struct BatchReport {
    pub variants: Vec<VariantReport>,
}

/// The report of one variant.
#[derive(Clone, Debug, Default)]
pub struct VariantReport {
    pub title: String,
    pub tables: Tables,
    pub tally: Tally,
    /// True if the scenario has agents on both sides.
    is_contest: bool,
    /// A series for each of [`MEANS`].
    means: [Series; MEANS.len()],
    profile: Profile,
    /// Present where a scenario has more than one truck.
    fleet: Option<Fleet>,
}

/// A mean that the overview of several variants shows, over runs that are done.
struct Mean {
    heading: &'static str,
    column: usize,
    scale: f64,
    decimals: usize,
}

const MEANS: [Mean; 5] = [
    Mean { heading: "Intact\nratio", column: run_column("intact_ratio"), scale: 1.0, decimals: 3 },
    Mean { heading: "Burned\nratio", column: run_column("burned_ratio"), scale: 1.0, decimals: 3 },
    Mean { heading: "Exting.\nratio", column: run_column("extinguished_ratio"), scale: 1.0, decimals: 3 },
    Mean { heading: "Truck\nstuck s", column: run_column("truck_stuck_s"), scale: 1.0, decimals: 1 },
    Mean { heading: "Unimog\nCPU ms", column: run_column("cpu_unimog_total_s"), scale: 1e3, decimals: 2 },
];

impl VariantReport {
    /// The report of a variant, without any run yet.
    pub fn new(title: String, scenario: &Scenario) -> Self {
        let is_contest = !scenario.wumpus.is_empty() && !scenario.unimog.is_empty();
        Self { title, is_contest, fleet: Fleet::new(scenario), ..Self::default() }
    }

    /// Adds the next run of the plan.
    pub fn add(&mut self, run: &RunRecord) {
        self.tables.add(run);
        self.tally.add(run, self.is_contest);
        self.fleet.iter_mut().for_each(|fleet| fleet.add(run));
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

    /// Returns the tables and the tally of each variant, under its title if there are several.
    pub fn to_document(&self) -> Document {
        match self.variants.as_slice() {
            [one] => Document::new(one.title.clone()).with(one.blocks()),
            several => several.iter().fold(Document::new("Tables of a batch"), |document, variant| {
                document.with([Block::Heading(variant.title.clone())]).with(variant.blocks())
            }),
        }
    }

    /// Returns a line for each variant, and how many of its runs are done with means over them.
    pub fn overview(&self) -> Vec<Block> {
        let number = |index: usize| (index + 1).to_string();
        let titles = self.variants.iter().enumerate();
        let titles = titles.map(|(index, variant)| format!("{}: {}", number(index), variant.title)).collect();
        let means = "Means of the runs that are done. tables.md has the tables of each variant.".to_owned();
        vec![Block::List(titles), Block::Table(self.overview_table(number)), Block::Text(means)]
    }

    /// Returns the table of the overview, in which variants have these names.
    pub fn overview_table(&self, name: impl Fn(usize) -> String) -> Table {
        let counts = ["Variant", "Runs\ndone", "Not\ndone"];
        let headings: Vec<&str> = counts.into_iter().chain(MEANS.iter().map(|mean| mean.heading)).collect();
        let variants = self.variants.iter().enumerate();
        Table::new(&headings, variants.map(|(index, variant)| variant.overview_row(name(index))).collect())
    }

    /// Returns how the fleets worked, of variants that have one.
    pub fn fleets_table(&self) -> Option<Table> {
        let variants = self.variants.iter();
        fleets_table(variants.filter_map(|variant| Some((variant.title.as_str(), variant.fleet.as_ref()?))))
    }

    /// Returns what there is to note of any variant, by its number.
    pub fn notes(&self) -> Vec<String> {
        let notes = self.variants.iter().enumerate();
        notes.filter_map(|(index, variant)| Some(format!("{}: {}", index + 1, variant.tally.note()?))).collect()
    }

    /// Returns for each variant where its CPU time went.
    pub fn profile(&self) -> Document {
        Document::default().with(self.variants.iter().flat_map(|variant| variant.profile.blocks(&variant.title)))
    }
}

impl VariantReport {
    /// Returns the tables and the tally.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = self.tables.blocks();
        blocks.push(Block::List(self.tally.sentences()));
        blocks
    }

    fn overview_row(&self, name: String) -> Vec<String> {
        let counts = [self.tally.done, self.tally.not_done()].map(|count| count.to_string());
        let means = self.means.iter().zip(&MEANS).map(|(series, mean)| optional(series.mean(), mean.decimals));
        [name].into_iter().chain(counts).chain(means).collect()
    }
}
