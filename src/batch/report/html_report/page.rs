//! The page itself.

use std::fmt::Write;

use super::collected::{Collected, ToldRun};
use super::figures::{Figure, Figures, Section};
use crate::batch::execute::CHARTS_FOLDER;
use crate::batch::html::{escaped, head, table};
use crate::batch::plan::{BatchPlan, PROGRAM_VERSION};
use crate::batch::report::summary::VariantReport;
use crate::batch::table::FinishedBatch;
use crate::batch::text_table::TextTable;

/// The most variants whose tables stand in the page.
const SHOWN_TABLES: usize = 50;

/// The longest plan that stands in the page.
const LONGEST_PLAN: usize = 200_000;

const STYLE: &str = "<style>svg{max-width:100%;height:auto}figure{margin:1.5em 0;break-inside:avoid}\
                     figcaption,.note{color:#555;font-size:.85em}pre{overflow-x:auto;white-space:pre-wrap}\
                     .wide{overflow-x:auto}summary{cursor:pointer;font-weight:bold}\
                     .told td{text-align:left;vertical-align:top}</style>\n";

pub fn page(batch: &FinishedBatch, collected: &Collected, figures: &Figures) -> String {
    let plan = batch.plan();
    let name = batch.folder().canonicalize().ok();
    let name = name.as_deref().unwrap_or(batch.folder()).file_name();
    let title = format!("Batch {}", name.map_or_else(String::new, |name| name.to_string_lossy().into_owned()));
    let parts = [
        head(&title),
        STYLE.into(),
        summary(plan, collected, figures),
        section("Means", &charts(&figures.drawn, Section::Means)),
        section("Tables", &tables(collected)),
        section("Distributions", &charts(&figures.drawn, Section::Distributions)),
        section("States over time", &charts(&figures.drawn, Section::OverTime)),
        section("Sweeps", &charts(&figures.drawn, Section::Sweeps)),
        section("Runs without a result", &failures(plan, collected)),
        section("Runs in which an agent was stuck", &stuck(plan, collected)),
        section("Plan and version", &plan_part(plan)),
    ];
    parts.concat() + "</html>\n"
}

/// Nothing if there is nothing in it.
fn section(heading: &str, body: &str) -> String {
    if body.is_empty() { String::new() } else { format!("<h2>{heading}</h2>\n{body}") }
}

fn summary(plan: &BatchPlan, collected: &Collected, figures: &Figures) -> String {
    let (variants, seeds) = (plan.variants.len(), plan.seeds.count());
    let mut text = match variants {
        1 => format!("<p>{seeds} runs of {}.</p>\n", escaped(&plan.title(&plan.variants[0]))),
        _ => format!("<p>{variants} variants with {seeds} seeds each: {} runs.</p>\n", plan.count()),
    };
    if let [only] = collected.report.variants.as_slice() {
        return text + &tally(only);
    }
    text += &overview(collected);
    for sentence in &figures.refused {
        push(&mut text, format_args!("<p>{}</p>\n", escaped(sentence)));
    }
    text
}

/// The means of all variants, which are named in it.
fn overview(collected: &Collected) -> String {
    let mut overview: TextTable = collected.report.overview_table();
    for (row, variant) in overview.rows.iter_mut().zip(&collected.report.variants) {
        row[0].clone_from(&variant.title);
    }
    format!("<div class=\"wide\">{}</div>\n<p class=\"note\">Means of the runs that are done.</p>\n", table(&overview))
}

fn tally(variant: &VariantReport) -> String {
    let lines = variant.tally.to_string();
    let items: String = lines.lines().map(|line| format!("<li>{}</li>\n", escaped(line))).collect();
    format!("<ul>\n{items}</ul>\n")
}

fn tables(collected: &Collected) -> String {
    let both = |variant: &VariantReport| {
        let tables = variant.tables.titled();
        let tables = tables
            .map(|(title, one)| format!("<p>{}</p>\n<div class=\"wide\">{}</div>\n", escaped(title), table(&one)));
        let notes = escaped(variant.tables.notes().trim()).replace('\n', "<br>\n");
        format!("{}<p class=\"note\">{notes}</p>\n", tables.concat())
    };
    match collected.report.variants.as_slice() {
        [only] => both(only),
        several => {
            let folded = |variant: &VariantReport| {
                let title = escaped(&variant.title);
                format!("<details><summary>{title}</summary>\n{}{}</details>\n", tally(variant), both(variant))
            };
            let shown: String = several.iter().take(SHOWN_TABLES).map(folded).collect();
            match several.len().saturating_sub(SHOWN_TABLES) {
                0 => shown,
                more => format!("{shown}<p>tables.md has those of {more} more variants.</p>\n"),
            }
        }
    }
}

fn charts(figures: &[Figure], section: Section) -> String {
    let figure = |figure: &Figure| {
        let (svg, file) = (figure.drawing.to_svg(), escaped(&figure.file));
        format!("<figure>\n{svg}<figcaption>{CHARTS_FOLDER}/{file}.svg, {file}.png</figcaption>\n</figure>\n")
    };
    figures.iter().filter(|figure| figure.section == section).map(figure).collect()
}

fn failures(plan: &BatchPlan, collected: &Collected) -> String {
    match collected.report.not_done() {
        0 => "<p>None.</p>\n".into(),
        count => told(plan, &collected.failures, count, "Why"),
    }
}

fn stuck(plan: &BatchPlan, collected: &Collected) -> String {
    match collected.stuck_runs {
        0 => "<p>None.</p>\n".into(),
        count => told(plan, &collected.stuck, count as u64, "For"),
    }
}

/// A table of runs, each with the command that shows it again.
fn told(plan: &BatchPlan, runs: &[ToldRun], count: u64, heading: &str) -> String {
    let mut text = match count - runs.len() as u64 {
        0 => format!("<p>{count} of {} runs.</p>\n", plan.count()),
        _ => format!("<p>{count} of {} runs; {} of them:</p>\n", plan.count(), runs.len()),
    };
    push(&mut text, format_args!("<div class=\"wide\"><table class=\"told\">\n"));
    push(&mut text, format_args!("<tr><th>Run</th><th>Seed</th><th>{heading}</th><th>Shown again by</th></tr>\n"));
    for told in runs {
        let run = plan.run(told.number);
        let (words, command) = (escaped(&told.words), escaped(&run.repeating_command()));
        let cells =
            format!("<td>{}</td><td>{}</td><td>{words}</td><td><code>{command}</code></td>", told.number, run.seed);
        push(&mut text, format_args!("<tr>{cells}</tr>\n"));
    }
    text + "</table></div>\n"
}

fn plan_part(plan: &BatchPlan) -> String {
    let lines = [
        format!("wildfire {PROGRAM_VERSION}"),
        format!("Plan {}: its outcomes depend on nothing else than what has this SHA-256", plan.content_sha256()),
        format!("Seeds {}", plan.seeds),
    ];
    let mut text: String = lines.iter().map(|line| format!("<li>{}</li>\n", escaped(line))).collect();
    for variant in &plan.variants {
        let changes: String = variant.changes.iter().map(|change| format!(" --set {change}")).collect();
        let (title, source) = (escaped(&plan.title(variant)), escaped(&variant.source));
        push(&mut text, format_args!("<li>{title}: <code>{source}{}</code></li>\n", escaped(&changes)));
    }
    let json = plan.to_json();
    let frozen = if json.len() <= LONGEST_PLAN {
        format!("<details><summary>plan.json</summary>\n<pre>{}</pre></details>\n", escaped(&json))
    } else {
        "<p>All settings are in plan.json.</p>\n".into()
    };
    format!("<ul>\n{text}</ul>\n{frozen}")
}

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("a string takes any text");
}
