//! The results of a finished batch, as `batch`, `merge` and `report` print them.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use wildfire_base::document::{Block, Document};
use wildfire_batch::execute::{Machine, OutputFolder};
use wildfire_batch::plan::{BatchPlan, COMMIT, COMPILER, PROGRAM_VERSION, Record, RunPlace, shell_word};
use wildfire_batch::report::{BatchReport, Tally, VariantReport, WrittenReport};
use wildfire_batch::stats::{Interval, Series};
use wildfire_batch::stopping::Look;
use wildfire_batch::table::RUN_COLUMNS;

/// The JSON object that `wildfire batch --format json` and `wildfire merge --format json` print, and the beginning of that of
/// `wildfire report --format json`; the members in their order.
#[derive(Serialize, JsonSchema)]
pub struct BatchObject {
    program_version: &'static str,
    /// The commit that the program was built from; null if unknown.
    commit: Option<&'static str>,
    compiler: &'static str,
    /// The folder of the batch.
    folder: String,
    /// The hash of the plan, which determines all outcomes.
    content_sha256: String,
    seeds: String,
    runs: u64,
    /// Runs without a result.
    not_done: u64,
    /// In the order of the plan.
    variants: Vec<VariantObject>,
}

/// A variant of the batch.
#[derive(Serialize, JsonSchema)]
struct VariantObject {
    title: String,
    scenario: String,
    /// The changes made to the scenario, `key=value`.
    changes: Vec<String>,
    done: u64,
    failed: u64,
    panicked: u64,
    won_by_truck: u64,
    won_by_wumpus: u64,
    /// Runs in which an agent got stuck.
    stuck_runs: u64,
    /// The findings as sentences.
    sentences: Vec<String>,
    /// The numeric columns of `runs.csv`, over finished runs; columns without values are omitted.
    columns: BTreeMap<&'static str, ColumnObject>,
}

/// A column over the runs that have it.
#[derive(Serialize, JsonSchema)]
struct ColumnObject {
    runs: u64,
    mean: Option<f64>,
    standard_deviation: Option<f64>,
    /// The 95 % interval of the mean, from `low` to `high`, within the column's range.
    low: Option<f64>,
    high: Option<f64>,
}

impl ColumnObject {
    fn new(series: &Series, interval: Option<Interval>) -> Self {
        Self {
            runs: series.count(),
            mean: series.mean(),
            standard_deviation: series.standard_deviation(),
            low: interval.map(|ends| ends.low),
            high: interval.map(|ends| ends.high),
        }
    }
}

impl BatchObject {
    pub fn new(plan: &BatchPlan, folder: &Path, report: &BatchReport) -> Self {
        let variants = plan.variants.iter().zip(&report.variants).map(|(variant, found)| {
            let VariantReport { title, tally, .. } = found;
            let Tally { done, failed, panicked, won_by_truck, won_by_wumpus, stuck_runs, .. } = *tally;
            let columns = RUN_COLUMNS.iter().enumerate().filter(|(_, column)| column.holds_numbers());
            let columns = columns
                .filter(|(place, _)| found.column(*place).count() > 0)
                .map(|(place, column)| (column.name, ColumnObject::new(found.column(place), found.interval(place))));
            VariantObject {
                title: title.clone(),
                scenario: variant.scenario.name.clone(),
                changes: variant.changes.clone(),
                done,
                failed,
                panicked,
                won_by_truck,
                won_by_wumpus,
                stuck_runs,
                sentences: tally.sentences(),
                columns: columns.collect(),
            }
        });
        Self {
            program_version: PROGRAM_VERSION,
            commit: COMMIT,
            compiler: COMPILER,
            folder: folder.display().to_string(),
            content_sha256: plan.content_sha256(),
            seeds: plan.seeds.to_string(),
            runs: plan.count(),
            not_done: report.not_done(),
            variants: variants.collect(),
        }
    }
}

/// Words the result of a finished batch: the answer first, then the tables, and last the command that shows a run.
pub fn summary(plan: &BatchPlan, folder: &OutputFolder, report: &BatchReport, look: Option<&Look>) -> Document {
    let path = shell_word(&folder.path().display().to_string());
    let (title, tables, sentences) = match report.variants.as_slice() {
        [one] => (format!("{}, seeds {}", one.title, plan.seeds), one.tables.blocks(), one.tally.sentences()),
        // One variant shows its own tables; several are compared in an overview.
        _ => {
            let sentences = report.notes().into_iter().chain(report.failure_sentences()).collect();
            // Variants that stopped before others have the first of them.
            let has_all = plan.count() == plan.variants.len() as u64 * plan.seeds.count();
            let title = match has_all {
                true => format!("Seeds {} of each variant", plan.seeds),
                false => format!("Seeds {}, {} of them by variant", plan.seeds, plan.seeds_text()),
            };
            (title, report.overview(), sentences)
        }
    };
    let files = format!("Files: {}", folder.path().display());
    let opening = Block::Text(report.opening(plan));
    let sentences = Block::List(sentences.into_iter().chain([files]).collect());
    // Commands are copied, so that their lines are not broken.
    let page = page_command(plan, &path, report).map(|command| Block::Verbatim(format!("Watch a run: {command}")));
    let charts = page.as_ref().map(|_| Block::Verbatim(format!("Page with charts: wildfire report {path}")));
    let compare =
        charts.as_ref().filter(|_| plan.variants.len() > 1).map(|_| format!("Differences: wildfire compare {path}"));
    let estimates = look.map(|look| Block::List(look.sentences(plan)));
    let commands = charts.into_iter().chain(compare.map(Block::Verbatim));
    let blocks = [opening].into_iter().chain(estimates).chain(commands).chain(tables).chain([sentences]).chain(page);
    Document::new(title).with(blocks)
}

/// Returns the command that writes a page of a run in the batch at this path, a word of the shell: of the first run that
/// finished; `None` if none did.
fn page_command(plan: &BatchPlan, path: &str, report: &BatchReport) -> Option<String> {
    let mut finished = report.variants.iter().enumerate();
    let (variant, seed) = finished.find_map(|(index, variant)| Some((index, variant.first_done?)))?;
    if variant > 0 {
        // Commands on a batch show its first variant, so a run of another one is simulated.
        let place = RunPlace { variant, seed: plan.seeds.iter().position(|other| other == seed)? as u64 };
        let run = plan.run(plan.number(place));
        return Some(format!("wildfire render {} --page seed-{seed}.html", run.repeating_args()));
    }
    // A run that was not recorded is simulated again.
    let is_simulated = plan.record != Record::All;
    let needs_trust = is_simulated && plan.variants.iter().any(|variant| variant.scenario.needs_trust());
    let trust = if needs_trust { " --trust" } else { "" };
    Some(format!("wildfire render {path} --seed {seed}{trust} --page seed-{seed}.html"))
}

/// The tables of a batch for a paper, and the files of a report.
#[derive(Serialize, JsonSchema)]
pub struct ReportAnswer {
    #[serde(flatten)]
    batch: BatchObject,
    /// The page that was written.
    page: String,
    /// The folder of the charts.
    charts_folder: String,
    /// The charts, by the names of their files without endings.
    charts: Vec<String>,
    /// Charts omitted because they would have too many panels, one sentence each.
    refused: Vec<String>,
    /// The machines that worked on the batch, if known.
    machines: Vec<Machine>,
}

impl ReportAnswer {
    pub fn new(plan: &BatchPlan, folder: &Path, written: &WrittenReport) -> Self {
        let WrittenReport { tables, charts, refused, machines, page, charts_folder, .. } = written;
        Self {
            batch: BatchObject::new(plan, folder, tables),
            page: page.display().to_string(),
            charts_folder: charts_folder.display().to_string(),
            charts: charts.clone(),
            refused: refused.clone(),
            machines: machines.clone(),
        }
    }
}

/// The tables that a report prints: means, unless others were asked for.
#[derive(Clone, Copy, Debug)]
pub struct ShownTables<'a> {
    /// The places of columns that were asked for, each of which has a table, instead of all else.
    pub columns: &'a [usize],
    /// Shows single runs too.
    pub rows: bool,
}

impl ShownTables<'_> {
    /// Says what was written, with the tables that were asked for.
    pub fn document(self, plan: &BatchPlan, folder: &Path, written: &WrittenReport) -> Document {
        let WrittenReport { tables, refused, .. } = written;
        let Self { columns, rows } = self;
        let mut document = Document::new(format!("{}, seeds {}", folder.display(), plan.seeds));
        if columns.is_empty() {
            if tables.variants.len() > 1 {
                let overview = tables.overview_table(|index| tables.variants[index].title.clone());
                document.add(overview.with_caption("Means over finished runs"));
                document.add_list(tables.notes());
            }
            for variant in tables.variants.iter().filter(|_| rows || tables.variants.len() == 1) {
                document.add(Block::Heading(variant.title.clone()));
                document = document.with(if rows { variant.first_rows() } else { variant.means() });
            }
            document = document.with(tables.fleets_table());
        } else {
            document = document.with(tables.column_tables(columns));
        }
        document.add_list(tables.machine_notes());
        document.add_list(refused.clone());
        document
    }
}

/// A plan that is not run yet, or a slice that is.
#[derive(Serialize, JsonSchema)]
pub struct PlanAnswer {
    pub program_version: &'static str,
    pub content_sha256: String,
    pub seeds: String,
    pub runs: u64,
    /// The titles of all variants, in the order of the plan.
    pub variants: Vec<String>,
}

/// A slice of a batch whose runs are over.
#[derive(Serialize, JsonSchema)]
pub struct SliceAnswer {
    pub program_version: &'static str,
    pub folder: String,
    pub slice: String,
    pub runs: u64,
    pub not_done: u64,
    /// The command that puts the slices together when all are done.
    pub merge: String,
}

impl From<&SliceAnswer> for Document {
    fn from(answer: &SliceAnswer) -> Self {
        let SliceAnswer { slice, runs, not_done, merge, .. } = answer;
        let command = format!(
            "Slice {slice}: {} finished, {not_done} failed. When all slices are finished: {merge}",
            runs - not_done
        );
        // The command is copied, so that its line is not broken.
        Self::default().with([Block::Verbatim(command)])
    }
}
