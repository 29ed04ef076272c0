//! The report of a batch: one page that needs no other file and no network, and its charts as SVG and PNG, with what they
//! show as CSV; for papers also as PDF and PGF.
//!
//! Everything in it is read from the batch's folder: plan, `runs.csv`, `states.parquet`. The same batch gives the same
//! bytes. Means have Student's 95 % intervals, as in the batch's tables; charts show the part of them that is possible.

mod answer;
mod chart_files;
mod collected;
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
use std::path::PathBuf;

use thiserror::Error;

pub use chart_files::{ChartData, write_chart, write_chart_data, write_paper_chart};
pub use facets::{Facet, FacetSeries, MOST_PANELS, word_facets};
pub use notable::{NotableRun, notable_runs};

use crate::batch::execute::{CHARTS_FOLDER, REPORT_FILE};
use crate::batch::table::{FinishedBatch, FinishedError};
use crate::picture::charts::{PaperSize, SCREEN_WIDTH};
use crate::picture::unknown_letters;
use chart_files::{unwritable, write_whole};
use collected::Collected;
use figures::Figures;
use over_time::StateCurves;

/// The files of a report that was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenReport {
    pub page: PathBuf,
    pub charts_folder: PathBuf,
    pub charts: usize,
    /// Charts that are not drawn since they would have too many panels: a sentence for each.
    pub refused: Vec<String>,
    /// Letters in charts that the font of pictures lacks.
    pub unknown_letters: String,
}

/// What a report is made of besides the files of its batch.
#[derive(Clone, Debug)]
pub struct ReportParts<'a> {
    /// The runs whose pages are there, for links to them.
    pub playing: &'a [NotableRun],
    /// The field at the end of the median run, where the batch is of one variant and has that run.
    pub field: Option<FieldPicture>,
    pub paper: PaperCharts,
}

/// A picture of a field, and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    pub caption: String,
    /// The bytes of a PNG file.
    pub png: Vec<u8>,
}

/// The charts for a paper that are written too.
#[derive(Clone, Copy, Debug)]
pub struct PaperCharts {
    pub size: PaperSize,
    pub pdf: bool,
    pub pgf: bool,
}

/// A reason for which a batch has no report.
#[derive(Debug, Error)]
pub enum ReportError {
    #[error(transparent)]
    Finished(#[from] FinishedError),
    #[error("the batch in {} has no table of runs yet", folder.display())]
    Unfinished { folder: PathBuf },
    #[error("cannot write {}: {source}", path.display())]
    Unwritable { path: PathBuf, source: io::Error },
}

/// Reads a batch that is over, and writes `report.html` and a folder of charts beside its tables.
pub fn write_report(batch: &FinishedBatch, parts: &ReportParts<'_>) -> Result<WrittenReport, ReportError> {
    let paper = &parts.paper;
    let folder = batch.folder();
    let rows = batch.rows()?.ok_or_else(|| ReportError::Unfinished { folder: folder.to_owned() })?;
    let collected = Collected::read(batch.plan(), rows)?;
    let states = StateCurves::read(folder, batch.plan())?;
    let draw = |width| Figures::new(batch.plan(), &collected, states.as_deref(), width);
    let figures = draw(SCREEN_WIDTH);
    let charts_folder = folder.join(CHARTS_FOLDER);
    fs::create_dir_all(&charts_folder).map_err(|source| unwritable(&charts_folder, source))?;
    for figure in &figures.drawn {
        write_chart(&charts_folder, &figure.file, &figure.drawing)?;
    }
    for data in &figures.data {
        write_chart_data(&charts_folder, data)?;
    }
    if paper.pdf || paper.pgf {
        let write = |figure: &figures::Figure| write_paper_chart(&charts_folder, &figure.file, &figure.drawing, paper);
        draw(paper.size.units()).drawn.iter().try_for_each(write)?;
    }
    let page = folder.join(REPORT_FILE);
    write_whole(&page, page::page(batch, &collected, &figures, parts).to_html().as_bytes())?;
    let Figures { drawn, refused, .. } = figures;
    let texts = drawn.iter().flat_map(|figure| figure.drawing.texts());
    let unknown: BTreeSet<char> = texts.flat_map(unknown_letters).collect();
    Ok(WrittenReport {
        page,
        charts_folder,
        charts: drawn.len(),
        refused,
        unknown_letters: unknown.into_iter().collect(),
    })
}
