//! The report of a batch: one page that needs no other file and no network, and its charts as SVG and PNG with their
//! data as CSV; for papers also as PDF and PGF.
//!
//! Everything in it is read from the batch's folder: plan, `runs.csv`, `states.parquet`, `machines.json`. The same batch
//! gives the same bytes. Means have the 95 % intervals of the batch's tables, differences those of comparisons.

mod answer;
mod chart_files;
mod collected;
mod compared;
mod facets;
mod figures;
mod labels;
mod notable;
mod over_time;
mod page;
mod quantities;
mod sweeps;

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use chart_files::{ChartData, write_chart, write_chart_data, write_paper_chart};
pub use facets::{Facet, FacetSeries, MAX_PANELS, word_facets};
pub(in crate::report) use labels::Labels;
pub use notable::{NotableRun, notable_runs, runs_with_pages};
pub use quantities::SelectedQuantities;

use crate::execute::{BatchError, CHARTS_FOLDER, Machine, Machines, REPORT_FILE};
use crate::plan::BatchPlan;
use crate::report::summary::BatchReport;
use crate::table::{FinishedBatch, FinishedError};
use chart_files::{unwritable, write_whole};
use collected::Collected;
use figures::{FigureSource, Figures};
use over_time::StateCurves;
use page::{Origin, Page};
use wildfire_picture::charts::{PaperSize, SCREEN_WIDTH};
use wildfire_picture::unknown_letters;

/// The files of a written report.
#[derive(Clone, Debug)]
pub struct WrittenReport {
    pub page: PathBuf,
    pub charts_folder: PathBuf,
    /// The file names of the charts, without extensions.
    pub charts: Vec<String>,
    /// The tables of the batch.
    pub tables: BatchReport,
    /// The machines that worked on it, as far as known.
    pub machines: Vec<Machine>,
    /// A sentence for each chart that is not drawn because it would have too many panels.
    pub refused: Vec<String>,
    /// Characters in charts that the font of pictures lacks.
    pub unknown_letters: String,
}

/// The charts of a page in the window of a phone.
const PHONE: PaperSize = PaperSize { width_mm: 88.0, font_pt: 8.0 };

/// The parts of a report besides the files of its batch.
#[derive(Clone, Debug)]
pub struct ReportParts<'a> {
    /// The runs that have pages, for links to them.
    pub playing: &'a [NotableRun],
    /// The field at the end of the median run, if the batch has one variant and that run exists.
    pub field: Option<FieldPicture>,
    pub quantities: &'a SelectedQuantities,
    pub paper: PaperCharts,
}

/// A picture of a field, and its description.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    pub caption: String,
    /// The bytes of the PNG file.
    pub png: Vec<u8>,
}

/// The charts that are also written for a paper.
#[derive(Clone, Copy, Debug)]
pub struct PaperCharts {
    pub size: PaperSize,
    pub pdf: bool,
    pub pgf: bool,
}

/// The reason why a batch has no report.
#[derive(Debug, Error)]
pub enum ReportError {
    #[error(transparent)]
    Finished(#[from] FinishedError),
    #[error("the batch in {} has no table of runs yet", folder.display())]
    Unfinished { folder: PathBuf },
    #[error("cannot write {}: {source}", path.display())]
    Unwritable { path: PathBuf, source: io::Error },
    #[error("there is no column `{name}` in runs.csv{}; expected one of its columns of numbers", likely(.nearest.as_deref()))]
    UnknownColumn { name: String, nearest: Option<String> },
    #[error("the column `{name}` of runs.csv holds no numbers that a chart could show; expected one that does")]
    NoNumbers { name: String },
    #[error(transparent)]
    Batch(#[from] BatchError),
}

fn likely(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |nearest| format!(" (did you mean `{nearest}`?)"))
}

/// Reads a finished batch, and writes `report.html` and a folder of charts beside its tables.
pub fn write_report(batch: &FinishedBatch, parts: &ReportParts<'_>) -> Result<WrittenReport, ReportError> {
    let ReportParts { quantities, paper, .. } = parts;
    let folder = batch.folder();
    let rows = batch.rows()?.ok_or_else(|| ReportError::Unfinished { folder: folder.to_owned() })?;
    let collected = Collected::read(batch.plan(), rows, quantities)?;
    let states = StateCurves::read(folder, batch.plan())?;
    let origin = Origin::read(folder)?;
    let source = FigureSource { plan: batch.plan(), collected: &collected, states: states.as_deref() };
    let figures = source.draw(quantities, SCREEN_WIDTH);
    let charts_folder = folder.join(CHARTS_FOLDER);
    fs::create_dir_all(&charts_folder).map_err(|source| unwritable(&charts_folder, source))?;
    // Charts come first: a page that an interruption leaves behind must not link to files that do not exist.
    for figure in &figures.drawn {
        write_chart(&charts_folder, &figure.file, &figure.drawing)?;
    }
    for data in &figures.data {
        write_chart_data(&charts_folder, data)?;
    }
    // Charts are drawn again at the width of a column of print: scaled down, letters would be too small to read.
    if paper.pdf || paper.pgf {
        source
            .draw(quantities, paper.size.units())
            .drawn
            .iter()
            .try_for_each(|figure| write_paper_chart(&charts_folder, &figure.file, &figure.drawing, paper))?;
    }
    let page = folder.join(REPORT_FILE);
    // A phone shows its own drawings, as text of a wide chart that is scaled to 88 mm cannot be read.
    let narrow = source.draw(quantities, PHONE.units());
    let contents = Page { batch, collected: &collected, figures: &figures, narrow: &narrow, parts, origin: &origin };
    write_whole(&page, contents.to_document().to_html().as_bytes())?;
    let Figures { drawn, refused, .. } = figures;
    let texts = drawn.iter().flat_map(|figure| figure.drawing.texts());
    // The font draws letters that it lacks as boxes, which the caller reports.
    let unknown: BTreeSet<char> = texts.flat_map(unknown_letters).collect();
    Ok(WrittenReport {
        page,
        charts_folder,
        charts: drawn.into_iter().map(|figure| figure.file).collect(),
        tables: collected.report,
        machines: origin.machines,
        refused,
        unknown_letters: unknown.into_iter().collect(),
    })
}

impl Origin {
    fn read(folder: &Path) -> Result<Self, ReportError> {
        let about_plan = |error| ReportError::Finished(FinishedError::Plan(error));
        Ok(Self {
            writer: BatchPlan::read_writer(folder).map_err(about_plan)?,
            plan: BatchPlan::read_text(folder, page::LONGEST_PLAN).map_err(about_plan)?,
            machines: Machines::read(folder)?.machines,
        })
    }
}
