//! The page of a benchmark, which needs no other file, and its charts as files beside it.

use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::cli::plan::benchmark::charts::{ChartSheet, Charts};
use wildfire_base::document::number::count;
use wildfire_base::document::{Block, Document, Figure};
use wildfire_base::whole_file::WholeFile;
use wildfire_batch::drives::{DriveTable, INTERVAL_LEGEND, PlannerSummary, interval_tables};
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_batch::report::{PaperCharts, ReportError, write_chart, write_chart_data, write_paper_chart};
use wildfire_picture::charts::SCREEN_WIDTH;

/// The page that was written.
#[derive(Debug)]
pub struct WrittenPage {
    pub charts_folder: PathBuf,
    pub charts: usize,
    /// Omitted charts: a sentence for each.
    pub refused: Vec<String>,
    /// All text in charts.
    pub texts: Vec<String>,
}

/// Returns the folder of a page's charts: `report-charts` of `report.html`.
pub fn charts_folder_of(page: &Path) -> PathBuf {
    let mut name = page.file_stem().map_or_else(|| OsString::from("report"), OsString::from);
    name.push("-charts");
    page.with_file_name(name)
}

/// Writes the page and its charts. The same queries give the same bytes.
pub fn write_page(
    queries: &DriveTable,
    title: &str,
    page: &Path,
    paper: &PaperCharts,
) -> Result<WrittenPage, CliError> {
    let groups = PlannerSummary::all(queries);
    let charts = Charts::new(queries, &groups, SCREEN_WIDTH);
    let folder = charts_folder_of(page);
    fs::create_dir_all(&folder).map_err(|error| CliError::unwritable(&folder, &error))?;
    let sheets = || charts.boxes.iter().chain(&charts.curves);
    // Charts come before the page, which links them.
    sheets().try_for_each(|sheet| write_chart(&folder, &sheet.file, &sheet.drawing)).map_err(from_report_error)?;
    charts.data.iter().try_for_each(|data| write_chart_data(&folder, data)).map_err(from_report_error)?;
    if paper.pdf || paper.pgf {
        let on_paper = Charts::new(queries, &groups, paper.size.units());
        on_paper
            .boxes
            .iter()
            .chain(&on_paper.curves)
            .try_for_each(|sheet| write_paper_chart(&folder, &sheet.file, &sheet.drawing, paper))
            .map_err(from_report_error)?;
    }
    let html = document(queries, &groups, &charts, title, &folder).to_html();
    let written = WholeFile::create(page).and_then(|mut file| {
        file.write_all(html.as_bytes())?;
        file.finish()
    });
    written.map_err(|error| CliError::unwritable(page, &error))?;
    let texts = sheets().flat_map(|sheet| sheet.drawing.texts()).map(str::to_owned).collect();
    let drawn = sheets().count();
    Ok(WrittenPage { charts_folder: folder, charts: drawn, refused: charts.refused, texts })
}

fn from_report_error(error: ReportError) -> CliError {
    match error {
        ReportError::Unwritable { path, source } => CliError::unwritable(&path, &source),
        other => CliError::bad_input(other, None),
    }
}

fn document(queries: &DriveTable, groups: &[PlannerSummary], charts: &Charts, title: &str, folder: &Path) -> Document {
    let mut seeds: Vec<u64> = queries.rows.iter().filter_map(|query| query.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let mut parts = vec![
        count(queries.planners().len(), "planner"),
        count(queries.variants.len(), "variant"),
        count(seeds.len(), "seed"),
    ];
    // A table without seeds has no number of them.
    parts.retain(|word| word != "0 seeds");
    let rows = queries.rows.len();
    let summary = format!("{}: {rows} queries. wildfire {PROGRAM_VERSION}.", parts.join(", "));
    let figures = |sheets: &[ChartSheet]| -> Vec<Block> {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let blocks = sheets.iter().map(|sheet| {
            Block::Figure(Figure {
                svg: sheet.drawing.to_svg(),
                file: Some(format!("{name}/{}", sheet.file)),
                more_files: vec![format!("{name}/{}.csv", sheet.data)],
            })
        });
        blocks.collect()
    };
    let mut tables = interval_tables(queries, groups);
    tables.push(Block::List(INTERVAL_LEGEND.map(str::to_owned).to_vec()));
    let sections = [
        ("Tables", tables),
        ("Boxes", figures(&charts.boxes)),
        ("Medians over swept keys", figures(&charts.curves)),
        ("Omitted charts", charts.refused.iter().cloned().map(Block::Text).collect()),
        ("How to read this page", vec![Block::List(notes())]),
    ];
    let mut document = Document::new(title).with([Block::Text(summary), Block::Contents]);
    for (heading, blocks) in sections {
        if !blocks.is_empty() {
            document = document.with([Block::Heading(heading.into())]).with(blocks);
        }
    }
    document
}

fn notes() -> Vec<String> {
    let lines = [
        "All planners planned the same drives: one field, start and set of goals for each variant and seed.",
        "Intervals assume independent queries. Goals on one field share its bushes: one goal per seed (--goals 1) is \
         safe.",
        "Only CPU times differ between machines and, slightly, between runs.",
    ];
    lines.map(str::to_owned).to_vec()
}
