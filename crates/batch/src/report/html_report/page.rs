//! The page of a report.

use super::answer::ReportAnswer;
use super::collected::{Collected, ListedRun};
use super::figures::{Figure, Figures, Section};
use super::notable::NotableRun;
use super::{FieldPicture, PaperCharts, ReportParts};
use crate::execute::{
    AGENTS_FILE, CALLS_PARQUET, CHARTS_FOLDER, DECISIONS_PARQUET, MACHINES_FILE, Machine, RUNS_FILE, RUNS_PARQUET,
    STATES_PARQUET, SUMMARY_FILE, TABLES_FILE,
};
use crate::plan::{BatchPlan, PLAN_FILE, PlanWriter};
use crate::table::FinishedBatch;
use wildfire_base::document::{self, Block, Document, Table};

/// The most variants whose tables are in the page.
const SHOWN_TABLES: usize = 50;

/// The maximum length of a plan that is included in the page.
pub const LONGEST_PLAN: u64 = 200_000;

/// The files beside a page that it links, and what they hold.
const FILES: [(&str, &str); 10] = [
    (RUNS_FILE, "a row for each run"),
    (AGENTS_FILE, "a row for each agent of a run"),
    (RUNS_PARQUET, "the rows of runs, with types and units"),
    (CALLS_PARQUET, "a row for each query of a planner"),
    (STATES_PARQUET, "the states of the bushes over time"),
    (DECISIONS_PARQUET, "what decisions were worth"),
    (TABLES_FILE, "the tables of all variants"),
    (SUMMARY_FILE, "the means of each variant"),
    (PLAN_FILE, "scenarios, seeds and settings"),
    (MACHINES_FILE, "the machines that ran it"),
];

/// The known origin of the batch, besides its rows.
pub struct Origin {
    pub writer: PlanWriter,
    /// The text of `plan.json`, if it is short.
    pub plan: Option<String>,
    pub machines: Vec<Machine>,
}

/// The contents of the page.
pub struct Page<'a> {
    pub batch: &'a FinishedBatch,
    pub collected: &'a Collected,
    pub figures: &'a Figures,
    /// The same charts at the width of a paper's column, for phones.
    pub narrow: &'a Figures,
    pub parts: &'a ReportParts<'a>,
    pub origin: &'a Origin,
}

impl Page<'_> {
    /// Creates the document: the answer, a picture of it, links to all sections, and the sections.
    pub fn to_document(&self) -> Document {
        let Self { batch, collected, figures, narrow, parts, origin } = *self;
        let plan = batch.plan();
        // The name of `.` is that of the folder that it stands for.
        let name = batch.folder().canonicalize().ok();
        let name = name.as_deref().unwrap_or(batch.folder()).file_name();
        let title = format!("Batch {}", name.map_or_else(String::new, |name| name.to_string_lossy().into_owned()));
        let stuck_runs = collected.stuck_runs as u64;
        let charts = PageCharts::new(figures, narrow, parts);
        let constant = (!figures.constant.is_empty()).then(|| Block::List(figures.constant.clone()));
        let sections = [
            ("Overview", summary(plan, collected, figures)),
            ("Runs to play", runs_to_play(plan, parts.playing)),
            ("Means", charts.of(Section::Means)),
            ("Requested columns", collected.report.column_tables(&parts.quantities.places())),
            ("Tables", tables(collected)),
            ("Fleets", fleets(collected)),
            ("Distributions", charts.of(Section::Distributions).into_iter().chain(constant).collect()),
            ("States over time", charts.of(Section::OverTime)),
            ("Sweeps", charts.of(Section::Sweeps)),
            ("Runs without a result", runs(plan, &collected.failures, collected.report.not_done(), "Reason")),
            ("Runs in which an agent got stuck", runs(plan, &collected.stuck, stuck_runs, "Stuck for")),
            ("Files", files(batch)),
            ("Plan and version", plan_part(plan, origin)),
        ];
        let ReportAnswer { sentence, more } = ReportAnswer::new(plan, collected);
        let mut document = Document::new(title).with([Block::Text(sentence)]);
        document.add_list(more);
        document = document.with(charts.lead()).with([Block::Contents]);
        for (heading, blocks) in sections {
            // A heading with nothing below it would look like a part that is missing.
            if !blocks.is_empty() {
                document = document.with([Block::Heading(heading.into())]).with(blocks);
            }
        }
        document
    }
}

/// The charts of a page; those that lead it are nowhere else.
struct PageCharts<'a> {
    figures: &'a Figures,
    narrow: &'a Figures,
    field: Option<&'a FieldPicture>,
    paper: &'a PaperCharts,
    /// The name of the data of the leading chart.
    leading: Option<&'a str>,
}

impl<'a> PageCharts<'a> {
    /// Chooses what leads: the field, what variants are compared by, the states over time, or those at the end.
    fn new(figures: &'a Figures, narrow: &'a Figures, parts: &'a ReportParts<'_>) -> Self {
        let field = parts.field.as_ref();
        let leading = [Section::Answer, Section::OverTime, Section::Means]
            .into_iter()
            .find_map(|section| figures.drawn.iter().find(|figure| figure.section == section))
            .filter(|_| field.is_none());
        Self { figures, narrow, field, paper: &parts.paper, leading: leading.map(|figure| figure.data.as_str()) }
    }

    fn lead(&self) -> Vec<Block> {
        if let Some(FieldPicture { caption, png }) = self.field {
            return vec![Block::Image { caption: caption.clone(), png: png.clone() }];
        }
        self.figures
            .drawn
            .iter()
            .filter(|figure| Some(figure.data.as_str()) == self.leading)
            .map(|figure| self.block(figure))
            .collect()
    }

    fn of(&self, section: Section) -> Vec<Block> {
        self.figures
            .drawn
            .iter()
            .filter(|figure| figure.section == section && Some(figure.data.as_str()) != self.leading)
            .map(|figure| self.block(figure))
            .collect()
    }

    fn block(&self, figure: &Figure) -> Block {
        let path = |name: &str| format!("{CHARTS_FOLDER}/{name}");
        let for_paper =
            [(self.paper.pdf, "pdf"), (self.paper.pgf, "pgf")].into_iter().filter(|(is_requested, _)| *is_requested);
        let for_paper = for_paper.map(|(_, ending)| path(&format!("{}.{ending}", figure.file)));
        // All narrow sheets of a chart stand where its first sheet does.
        let drawn = self.narrow.drawn.iter();
        let narrow = drawn.filter(|narrow| figure.file == figure.data && narrow.data == figure.data);
        let narrow = narrow.map(|narrow| narrow.drawing.to_svg());
        Block::Figure(document::Figure {
            svg: document::wide_and_narrow(&figure.drawing.to_svg(), &narrow.collect::<String>()),
            file: Some(path(&figure.file)),
            more_files: [path(&format!("{}.csv", figure.data))].into_iter().chain(for_paper).collect(),
        })
    }
}

fn summary(plan: &BatchPlan, collected: &Collected, figures: &Figures) -> Vec<Block> {
    let seeds = plan.seeds_text();
    if let [only] = collected.report.variants.as_slice() {
        let runs = Block::Text(format!("{seeds} runs of {}.", only.title));
        return vec![runs, Block::List(only.tally.sentences())];
    }
    let variants = plan.variants.len();
    let overview = collected.report.overview_table(|index| collected.report.variants[index].title.clone());
    let blocks = vec![
        Block::Text(format!("{variants} variants with {seeds} seeds each: {} runs.", plan.count())),
        Block::Table(overview),
        Block::Text("Means over finished runs.".into()),
    ];
    let notes = Some(collected.report.machine_notes()).filter(|notes| !notes.is_empty()).map(Block::List);
    blocks.into_iter().chain(notes).chain(figures.refused.iter().cloned().map(Block::Text)).collect()
}

/// Links to the files of the batch that are there.
fn files(batch: &FinishedBatch) -> Vec<Block> {
    let there = FILES.into_iter().filter(|(name, _)| batch.folder().join(name).is_file());
    let links: Vec<_> = there.map(|(name, what)| (format!("{name}: {what}"), name.to_owned())).collect();
    if links.is_empty() { Vec::new() } else { vec![Block::Links(links)] }
}

/// Links to the pages that play runs.
fn runs_to_play(plan: &BatchPlan, playing: &[NotableRun]) -> Vec<Block> {
    let links = playing.iter().map(|notable| {
        let run = plan.run(notable.number);
        let title = plan.title(run.variant);
        let percent = 100.0 * notable.burned_ratio;
        let text = format!("{}: {title}, seed {}, {percent:.1} % of the bushes burned", notable.word, run.seed);
        (text, notable.page())
    });
    if playing.is_empty() { Vec::new() } else { vec![Block::Links(links.collect())] }
}

fn tables(collected: &Collected) -> Vec<Block> {
    match collected.report.variants.as_slice() {
        [only] => only.tables.blocks(),
        several => {
            let shown = several.iter().take(SHOWN_TABLES);
            let mut blocks: Vec<_> =
                shown.map(|variant| Block::Folded(variant.title.clone(), variant.blocks())).collect();
            let more = several.len().saturating_sub(SHOWN_TABLES);
            if more > 0 {
                blocks.push(Block::Text(format!("tables.md has the tables of {more} more variants.")));
            }
            blocks
        }
    }
}

fn fleets(collected: &Collected) -> Vec<Block> {
    let Some(table) = collected.report.fleets_table() else { return Vec::new() };
    let caption = "Means over finished runs and all trucks of a run. A drive is wasted if it ends without an \
                 extinction, and hopeless if its fire was bound to burn out first; the flock ratio is the share of goals with \
                 another truck's goal within 60 m.";
    vec![Block::Table(table), Block::Text(caption.into())]
}

/// A table of runs, each with the command that shows it again; `count` is how many there are in all.
fn runs(plan: &BatchPlan, shown: &[ListedRun], count: u64, heading: &str) -> Vec<Block> {
    let all = plan.count();
    let text = match count - shown.len() as u64 {
        _ if count == 0 => return vec![Block::Text("None.".into())],
        0 => format!("{count} of {all} runs."),
        _ => format!("{count} of {all} runs; {} of them:", shown.len()),
    };
    let headings = ["Run", "Seed", heading, "Command to replay it"];
    let table = Table {
        text_columns: 4,
        ..Table::new(
            &headings,
            shown
                .iter()
                .map(|listed| {
                    let run = plan.run(listed.number);
                    vec![
                        listed.number.to_string(),
                        run.seed.to_string(),
                        listed.reason.clone(),
                        run.repeating_command(),
                    ]
                })
                .collect(),
        )
    };
    vec![Block::Text(text), Block::Table(table)]
}

fn plan_part(plan: &BatchPlan, origin: &Origin) -> Vec<Block> {
    let mut lines = vec![
        origin.writer.description(),
        format!("Plan {}: the outcomes depend only on the data with this SHA-256", plan.content_sha256()),
        format!("Seeds {}", plan.seeds),
    ];
    lines.extend(plan.variants.iter().map(|variant| {
        let changes: String = variant.changes.iter().map(|change| format!(" --set {change}")).collect();
        format!("{}: {}{changes}", plan.title(variant), variant.source)
    }));
    lines.extend(origin.machines.iter().map(|machine| format!("Machine: {}", machine.description())));
    let settings = match &origin.plan {
        Some(json) => Block::Folded("plan.json".into(), vec![Block::Verbatim(json.clone())]),
        None => Block::Text("All settings are in plan.json.".into()),
    };
    vec![Block::List(lines), settings]
}
