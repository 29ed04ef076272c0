//! The page itself.

use super::collected::{Collected, ListedRun};
use super::figures::{Figures, Section};
use super::notable::NotableRun;
use super::quantities::ChartChoice;
use crate::batch::execute::{CHARTS_FOLDER, Machine};
use crate::batch::plan::{BatchPlan, PlanWriter};
use crate::batch::table::FinishedBatch;
use crate::document::{Block, Document, Figure, Table};

/// The most variants whose tables are in the page.
const SHOWN_TABLES: usize = 50;

/// The longest plan that is in the page.
pub const LONGEST_PLAN: u64 = 200_000;

/// What is known of how the batch was made, besides its rows.
pub struct Origin {
    pub writer: PlanWriter,
    /// The text of `plan.json`, if it is short.
    pub plan: Option<String>,
    pub machines: Vec<Machine>,
}

/// What is on the page.
pub struct Page<'a> {
    pub batch: &'a FinishedBatch,
    pub collected: &'a Collected,
    pub figures: &'a Figures,
    /// The runs whose pages are there.
    pub playing: &'a [NotableRun],
    pub origin: &'a Origin,
    pub choice: &'a ChartChoice,
}

impl Page<'_> {
    pub fn to_document(&self) -> Document {
        let Self { batch, collected, figures, playing, origin, choice } = *self;
        let plan = batch.plan();
        let name = batch.folder().canonicalize().ok();
        let name = name.as_deref().unwrap_or(batch.folder()).file_name();
        let title = format!("Batch {}", name.map_or_else(String::new, |name| name.to_string_lossy().into_owned()));
        let stuck_runs = collected.stuck_runs as u64;
        let sections = [
            ("Runs to play", runs_to_play(plan, playing)),
            ("Means", charts(figures, Section::Means)),
            ("Columns that were asked for", asked_columns(collected, choice)),
            ("Tables", tables(collected)),
            ("Fleets", fleets(collected)),
            ("Distributions", charts(figures, Section::Distributions)),
            ("States over time", charts(figures, Section::OverTime)),
            ("Sweeps", charts(figures, Section::Sweeps)),
            ("Runs without a result", runs(plan, &collected.failures, collected.report.not_done(), "Why")),
            ("Runs in which an agent was stuck", runs(plan, &collected.stuck, stuck_runs, "For")),
            ("Plan and version", plan_part(plan, origin)),
        ];
        let mut document = Document::new(title).with(summary(plan, collected, figures));
        for (heading, blocks) in sections {
            if !blocks.is_empty() {
                document = document.with([Block::Heading(heading.into())]).with(blocks);
            }
        }
        document
    }
}

fn summary(plan: &BatchPlan, collected: &Collected, figures: &Figures) -> Vec<Block> {
    let seeds = plan.seeds.count();
    if let [only] = collected.report.variants.as_slice() {
        let runs = Block::Text(format!("{seeds} runs of {}.", only.title));
        return vec![runs, Block::List(only.tally.sentences())];
    }
    let variants = plan.variants.len();
    let overview = collected.report.overview_table(|index| collected.report.variants[index].title.clone());
    let blocks = vec![
        Block::Text(format!("{variants} variants with {seeds} seeds each: {} runs.", plan.count())),
        Block::Table(overview),
        Block::Text("Means of the runs that are done.".into()),
    ];
    blocks.into_iter().chain(figures.refused.iter().cloned().map(Block::Text)).collect()
}

/// Links to the pages that play runs.
fn runs_to_play(plan: &BatchPlan, playing: &[NotableRun]) -> Vec<Block> {
    let link = |notable: &NotableRun| {
        let run = plan.run(notable.number);
        let (title, percent) = (plan.title(run.variant), 100.0 * notable.burned_ratio);
        let text = format!("{}: {title}, seed {}, {percent:.1} % of the bushes burned", notable.word, run.seed);
        (text, notable.page())
    };
    if playing.is_empty() { Vec::new() } else { vec![Block::Links(playing.iter().map(link).collect())] }
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
                blocks.push(Block::Text(format!("tables.md has those of {more} more variants.")));
            }
            blocks
        }
    }
}

fn asked_columns(collected: &Collected, choice: &ChartChoice) -> Vec<Block> {
    collected.report.column_tables(&choice.quantities.places())
}

fn fleets(collected: &Collected) -> Vec<Block> {
    let Some(table) = collected.report.fleets_table() else { return Vec::new() };
    let words = "Means of the runs that are done, over all trucks of a run. A drive is wasted if it ends without an \
                 extinction, and hopeless if its fire had to burn out before; the flock ratio is the share of goals with \
                 another truck's goal within 60 m.";
    vec![Block::Table(table), Block::Text(words.into())]
}

fn charts(figures: &Figures, section: Section) -> Vec<Block> {
    let own = figures.drawn.iter().filter(|figure| figure.section == section);
    let block = own.map(|figure| {
        let file = format!("{CHARTS_FOLDER}/{}", figure.file);
        Block::Figure(Figure { svg: figure.drawing.to_svg(), file })
    });
    block.collect()
}

/// A table of runs, each with the command that shows it again; `count` is how many there are in all.
fn runs(plan: &BatchPlan, shown: &[ListedRun], count: u64, heading: &str) -> Vec<Block> {
    let all = plan.count();
    let text = match count - shown.len() as u64 {
        _ if count == 0 => return vec![Block::Text("None.".into())],
        0 => format!("{count} of {all} runs."),
        _ => format!("{count} of {all} runs; {} of them:", shown.len()),
    };
    let row = |listed: &ListedRun| {
        let run = plan.run(listed.number);
        vec![listed.number.to_string(), run.seed.to_string(), listed.words.clone(), run.repeating_command()]
    };
    let headings = ["Run", "Seed", heading, "Shown again by"];
    let table = Table { text_columns: 4, ..Table::new(&headings, shown.iter().map(row).collect()) };
    vec![Block::Text(text), Block::Table(table)]
}

fn plan_part(plan: &BatchPlan, origin: &Origin) -> Vec<Block> {
    let mut lines = vec![
        origin.writer.words(),
        format!("Plan {}: its outcomes depend on nothing else than what has this SHA-256", plan.content_sha256()),
        format!("Seeds {}", plan.seeds),
    ];
    lines.extend(plan.variants.iter().map(|variant| {
        let changes: String = variant.changes.iter().map(|change| format!(" --set {change}")).collect();
        format!("{}: {}{changes}", plan.title(variant), variant.source)
    }));
    lines.extend(origin.machines.iter().map(|machine| format!("Machine: {}", machine.words())));
    let settings = match &origin.plan {
        Some(json) => Block::Folded("plan.json".into(), vec![Block::Verbatim(json.clone())]),
        None => Block::Text("All settings are in plan.json.".into()),
    };
    vec![Block::List(lines), settings]
}
