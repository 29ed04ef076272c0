//! The summary of a finished batch: tables and tally of each variant, and means over all.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::execute::RunRow;
use crate::plan::{BatchPlan, Value, Variant, planner_of};
use crate::report::failures::Failures;
use crate::report::notes::notes;
use crate::report::profile::Profile;
use crate::report::tables::Tables;
use crate::report::tally::Tally;
use crate::stats::{Interval, Series, Validity};
use crate::table::{RUN_COLUMNS, RunRecord, run_column};
use wildfire_base::document::number::optional;
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::untrusted::spreadsheet_cell;

/// The reports of all variants, in the order of the plan.
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
    /// The seed of the first finished run.
    pub first_done: Option<u64>,
    /// A series for each of the columns of runs; of those without numbers it is empty.
    columns: Vec<Series>,
    validity: Validity,
    profile: Profile,
    /// The folders and hashes of custom planners, by name.
    files: BTreeMap<String, (PathBuf, BTreeMap<String, String>)>,
}

/// A mean that a table of several variants shows, over runs that are done.
struct MeanRow {
    heading: &'static str,
    column: usize,
    scale: f64,
    decimals: usize,
}

const OBSTACLES: usize = run_column("obstacles");

/// The states of bushes, of which no more can be in one than there are.
const STATES: [usize; 4] =
    [run_column("intact"), run_column("burning"), run_column("burned_out"), run_column("extinguished")];

const fn mean(heading: &'static str, column: &str, scale: f64, decimals: usize) -> MeanRow {
    MeanRow { heading, column: run_column(column), scale, decimals }
}

const MEANS: [MeanRow; 5] = [
    mean("Intact\nratio", "intact_ratio", 1.0, 3),
    mean("Burned\nratio", "burned_ratio", 1.0, 3),
    mean("Exting.\nratio", "extinguished_ratio", 1.0, 3),
    mean("Truck\nstuck s", "truck_stuck_s", 1.0, 1),
    mean("Unimog\nCPU ms", "cpu_unimog_total_s", 1e3, 2),
];

/// Means over teams of trucks: drives, waiting times, wasted drives.
const FLEET_MEANS: [MeanRow; 9] = [
    mean("Burned\nratio", "burned_ratio", 1.0, 3),
    mean("Goals", "truck_goals", 1.0, 1),
    mean("Wasted\ndrives", "truck_wasted_drives", 1.0, 1),
    mean("Hope-\nless", "truck_hopeless_drives", 1.0, 1),
    mean("Flock\nratio", "truck_flock_ratio", 1.0, 3),
    mean("Driven\nkm", "truck_distance_m", 1e-3, 2),
    mean("Waiting\ns", "truck_waiting_s", 1.0, 1),
    mean("Idle\ns", "truck_idle_s", 1.0, 1),
    mean("Dispatch\nCPU ms", "cpu_dispatch_s", 1e3, 2),
];

/// Returns for what the intervals of means over a plan's runs hold.
pub fn validity_of(plan: &BatchPlan) -> Validity {
    if plan.until.is_some() { Validity::AtAnyTime } else { Validity::AtFixedSize }
}

impl VariantReport {
    /// Creates the report of a variant without runs.
    pub fn new(plan: &BatchPlan, variant: &Variant) -> Self {
        let title = plan.title(variant);
        let scenario = &variant.scenario;
        let validity = validity_of(plan);
        let columns = vec![Series::default(); RUN_COLUMNS.len()];
        let deadline_s = (scenario.wumpus.is_empty() && !scenario.unimog.is_empty()).then_some(scenario.duration_s);
        let entry = plan.entry(variant);
        let tally = Tally { entry, deadline_s, ..Tally::new(scenario.unimog.len(), scenario.wumpus.len()) };
        let custom = scenario.planner.iter().filter(|(_, table)| table.is_external());
        let files =
            custom.map(|(name, table)| (name.to_string(), (table.works_in.clone(), table.sha256.clone()))).collect();
        Self { title, tally, columns, files, validity, tables: Tables::new(validity), ..Self::default() }
    }

    /// Creates a report in which all finished runs have the same numbers in some columns, by their places.
    #[cfg(test)]
    pub(crate) fn of_numbers(tally: Tally, numbers: &[(usize, f64)]) -> Self {
        let mut columns = vec![Series::default(); RUN_COLUMNS.len()];
        numbers.iter().for_each(|&(place, number)| (0..tally.done).for_each(|_| columns[place].add(number)));
        Self { tally, columns, ..Self::default() }
    }

    /// Adds the next run of the plan.
    pub fn add(&mut self, run: &RunRecord) {
        self.tables.add(run);
        self.tally.add(run);
        self.first_done = self.first_done.or(run.is_done().then(|| run.seed()));
        for (place, series) in self.columns.iter_mut().enumerate().filter(|_| run.is_done()) {
            run.number(place).into_iter().for_each(|number| series.add(number));
        }
    }

    /// Returns the numbers of a column, by its place among [`RUN_COLUMNS`], over the finished runs.
    pub fn column(&self, place: usize) -> &Series {
        &self.columns[place]
    }

    /// Returns the 95 % interval of the mean of a column, within the range of its values.
    pub fn interval(&self, place: usize) -> Option<Interval> {
        let (min, max) = RUN_COLUMNS[place].range();
        let bushes = self.column(OBSTACLES).largest().filter(|_| STATES.contains(&place));
        self.column(place).mean_interval_for(self.validity, (min, bushes.unwrap_or(max)))
    }

    /// Adds what a run's row in a table lacks: notes on its agents, and the CPU time per fact.
    pub fn add_detail(&mut self, row: &RunRow) {
        let Some(result) = &row.result else { return };
        self.tally.add_notes(row.label.seed, notes(result));
        self.profile.add(row);
    }
}

impl BatchReport {
    /// Returns the number of runs without a result.
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

    /// Returns a line for each variant, with the number of finished runs and means over them.
    pub fn overview(&self) -> Vec<Block> {
        let titles = self.variants.iter().enumerate();
        let titles = titles.map(|(index, variant)| format!("{}: {}", variant_number(index), variant.title)).collect();
        let means = "Means over finished runs. tables.md has the tables of each variant.".to_owned();
        vec![Block::List(titles), Block::Table(self.overview_table(variant_number)), Block::Text(means)]
    }

    /// Returns the table of the overview, with these names of variants.
    pub fn overview_table(&self, name: impl Fn(usize) -> String) -> Table {
        let counts = ["Variant", "Finished", "Failed"];
        let headings: Vec<&str> = counts.into_iter().chain(MEANS.iter().map(|mean| mean.heading)).collect();
        let variants = self.variants.iter().enumerate();
        Table::new(&headings, variants.map(|(index, variant)| variant.overview_row(name(index))).collect())
    }

    /// Returns a line of CSV for each variant: its values, the numbers of finished and failed runs, and for every
    /// numeric column that some run has, its mean and the ends of the mean's 95 % interval.
    pub fn to_csv(&self, plan: &BatchPlan) -> Vec<u8> {
        // A column without a value in any variant would be three empty columns.
        let places: Vec<usize> = (0..RUN_COLUMNS.len())
            .filter(|place| {
                RUN_COLUMNS[*place].holds_numbers()
                    && self.variants.iter().any(|variant| variant.column(*place).count() > 0)
            })
            .collect();
        let mut table = csv::Writer::from_writer(Vec::new());
        let mut add = |cells: Vec<String>| table.write_record(&cells).expect("memory takes everything");
        let labels = ["variant", "scenario", "planner"].into_iter().chain(plan.swept_keys.iter().map(String::as_str));
        let means =
            places.iter().flat_map(|&place| ["", "_low", "_high"].map(|end| RUN_COLUMNS[place].name.to_owned() + end));
        add(labels.chain(["finished", "failed"]).map(cell_text).chain(means).collect());
        for (index, (variant, report)) in plan.variants.iter().zip(&self.variants).enumerate() {
            // Cells that begin like a formula are guarded, as a spreadsheet would evaluate them.
            let swept = variant.swept.iter().map(|value| match value {
                Value::Text(value) => cell_text(value),
                number => number.to_string(),
            });
            let labels =
                [(index + 1).to_string(), cell_text(&variant.scenario.name), cell_text(&planner_of(&variant.scenario))];
            let counts = [report.tally.done, report.tally.not_done()].map(|count| count.to_string());
            let means = places.iter().flat_map(|&place| {
                let [low, high] = Interval::ends(report.interval(place));
                [report.column(place).mean(), low, high]
            });
            let means = means.map(|number| number.map_or_else(String::new, |number| number.to_string()));
            add(labels.into_iter().chain(swept).chain(counts).chain(means).collect());
        }
        table.into_inner().expect("memory takes everything")
    }

    /// Returns statistics of fleets, for variants with more than one truck; `None` if there are none.
    pub fn fleets_table(&self) -> Option<Table> {
        let fleets = self.variants.iter().filter(|variant| variant.tally.trucks > 1);
        let rows = fleets.map(|variant| {
            let labels = [variant.title.clone(), variant.tally.trucks.to_string()];
            labels.into_iter().chain(variant.mean_cells(&FLEET_MEANS)).collect()
        });
        let rows: Vec<Vec<String>> = rows.collect();
        let headings: Vec<&str> =
            ["Variant", "Trucks"].into_iter().chain(FLEET_MEANS.map(|mean| mean.heading)).collect();
        (!rows.is_empty()).then(|| Table::new(&headings, rows))
    }

    /// Returns a table for each of these columns, by their places among [`RUN_COLUMNS`]: a line for each variant.
    pub fn column_tables(&self, places: &[usize]) -> Vec<Block> {
        let tables = places.iter().map(|&place| {
            let about = &RUN_COLUMNS[place];
            let unit = Some(about.unit.symbol()).filter(|symbol| !["", "1"].contains(symbol));
            let unit = unit.map_or_else(String::new, |symbol| format!(" ({symbol})"));
            let headings = ["Variant", "Runs", "Mean", "Std dev", "95% low", "95% high"];
            let rows = self.variants.iter().map(|variant| {
                let series = variant.column(place);
                let interval = variant.interval(place);
                let [low, high] = Interval::ends(interval);
                let numbers = [series.mean(), series.standard_deviation(), low, high];
                let decimals = decimals_of(numbers);
                let numbers = numbers.map(|number| optional(number, decimals));
                [variant.title.clone(), series.count().to_string()].into_iter().chain(numbers).collect()
            });
            Table::new(&headings, rows.collect())
                .with_caption(&format!("{}{unit}: {}", about.name, about.description))
                .into()
        });
        tables.collect()
    }

    /// Returns notes on any variant, by its number or the name of its entry: first why runs failed.
    pub fn notes(&self) -> Vec<String> {
        let notes = self.variants.iter().enumerate().flat_map(|(index, variant)| {
            let reason = variant.tally.reason_of_failures();
            let notes = reason.into_iter().chain(variant.tally.note()).chain(variant.tally.machine_sentences());
            let name = variant.tally.entry.clone().unwrap_or_else(|| variant_number(index));
            notes.map(move |note| format!("{name}: {note}")).collect::<Vec<_>>()
        });
        notes.collect()
    }

    /// Returns, by the title of each variant if there are several, whether a limit of time or memory changed an
    /// outcome.
    pub fn machine_notes(&self) -> Vec<String> {
        self.variants
            .iter()
            .flat_map(|variant| {
                let title = if self.variants.len() > 1 { format!("{}: ", variant.title) } else { String::new() };
                variant.tally.machine_sentences().map(move |note| format!("{title}{note}")).collect::<Vec<_>>()
            })
            .collect()
    }

    /// Describes the failures of each planner, and of custom policies, over all variants. Custom planners of one name with
    /// different files are described by variant.
    pub fn failure_sentences(&self) -> Vec<String> {
        let mut sum = Tally::default();
        let mut asks: BTreeMap<Option<&str>, Failures> = BTreeMap::new();
        let mut sentences = Vec::new();
        for (variant, number) in self.variants.iter().zip(1..) {
            for (planner, failures) in &variant.tally.failures {
                let files = variant.files.get(planner);
                // Two custom planners of one name are two planners; a common sentence would blame both for the faults of one.
                if self.variants.iter().any(|it| it.files.get(planner).is_some_and(|other| Some(other) != files)) {
                    sentences.extend(failures.of_planner(&format!("{planner} (variant {number})")));
                } else {
                    *sum.failures.entry(planner.clone()).or_default() += failures.clone();
                }
            }
            *asks.entry(variant.tally.entry.as_deref()).or_default() += variant.tally.failed_asks.clone();
        }
        sentences.extend(sum.failure_sentences());
        sentences.extend(asks.iter().filter_map(|(entry, failures)| failures.of_policies(*entry)));
        sentences
    }

    /// Returns the CPU time of each variant by part.
    pub fn profile(&self) -> Document {
        Document::default().with(self.variants.iter().flat_map(|variant| variant.profile.blocks(&variant.title)))
    }
}

fn cell_text(text: &str) -> String {
    spreadsheet_cell(text).into_owned()
}

fn variant_number(index: usize) -> String {
    (index + 1).to_string()
}

/// The decimals by which the largest of some numbers has four digits.
fn decimals_of(numbers: [Option<f64>; 4]) -> usize {
    let largest = numbers.into_iter().flatten().fold(0.0_f64, |largest, number| largest.max(number.abs()));
    [(100.0, 1), (10.0, 2), (1.0, 3), (0.01, 4)].into_iter().find(|(min, _)| largest >= *min).map_or(6, |found| found.1)
}

impl VariantReport {
    /// Returns the tables and the tally.
    pub fn blocks(&self) -> Vec<Block> {
        let mut blocks = self.tables.blocks();
        blocks.push(Block::List(self.tally.sentences()));
        blocks
    }

    /// Returns the tables with the rows of the first runs, whatever their number, and the tally.
    pub fn first_rows(&self) -> Vec<Block> {
        self.tables.first_rows().into_iter().chain([Block::List(self.tally.sentences())]).collect()
    }

    /// Returns the statistics of the tables, without single runs, and the tally.
    pub fn means(&self) -> Vec<Block> {
        self.tables.means().into_iter().chain([Block::List(self.tally.sentences())]).collect()
    }

    fn overview_row(&self, name: String) -> Vec<String> {
        let counts = [self.tally.done, self.tally.not_done()].map(|count| count.to_string());
        [name].into_iter().chain(counts).chain(self.mean_cells(&MEANS)).collect()
    }

    fn mean_cells(&self, means: &[MeanRow]) -> impl Iterator<Item = String> {
        means
            .iter()
            .map(|mean| optional(self.column(mean.column).mean().map(|value| value * mean.scale), mean.decimals))
    }
}
