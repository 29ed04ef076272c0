//! The report of a batch: one page that needs no other file and no network, and its charts as SVG and PNG, with what they
//! show as CSV; for papers also as PDF and PGF.
//!
//! Everything in it is read from the batch's folder: plan, `runs.csv`, `states.parquet`, `machines.json`. The same batch
//! gives the same bytes. Means have Student's 95 % intervals, as in the batch's tables.

mod collected;
mod facets;
mod figures;
mod labels;
mod notable;
mod over_time;
mod page;
mod quantities;
mod sweeps;
mod words;

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use notable::{NotableRun, notable_runs};
pub use quantities::{ChartChoice, ChosenQuantities};

use crate::batch::execute::{BatchError, CHARTS_FOLDER, Machine, Machines, REPORT_FILE};
use crate::batch::plan::BatchPlan;
use crate::batch::report::summary::BatchReport;
use crate::batch::table::{FinishedBatch, FinishedError};
use crate::picture::charts::{Language, PaperSize, SCREEN_WIDTH};
use crate::picture::unknown_letters;
use crate::whole_file::WholeFile;
use collected::Collected;
use figures::{ChartData, Figure, FigureSource, Figures};
use over_time::StateCurves;
use page::{Origin, Page};

/// The files of a report that was written.
#[derive(Clone, Debug)]
pub struct WrittenReport {
    pub page: PathBuf,
    pub charts_folder: PathBuf,
    /// The names of the charts' files, without their endings.
    pub charts: Vec<String>,
    /// The tables of the batch.
    pub tables: BatchReport,
    /// The machines that worked on it, as far as they are known.
    pub machines: Vec<Machine>,
    /// Charts that are not drawn since they would have too many panels: a sentence for each.
    pub refused: Vec<String>,
    /// Letters in charts that the font of pictures lacks.
    pub unknown_letters: String,
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

/// Reads a batch that is over, and writes `report.html` and a folder of charts beside its tables. `playing` are the runs whose
/// pages are there, for links to them. The words of the page are English, and so is what files of data say, whatever language
/// the charts have.
pub fn write_report(
    batch: &FinishedBatch,
    playing: &[NotableRun],
    choice: &ChartChoice,
    paper: &PaperCharts,
) -> Result<WrittenReport, ReportError> {
    let folder = batch.folder();
    let rows = batch.rows()?.ok_or_else(|| ReportError::Unfinished { folder: folder.to_owned() })?;
    let collected = Collected::read(batch.plan(), rows, &choice.quantities)?;
    let states = StateCurves::read(folder, batch.plan())?;
    let origin = Origin::read(folder)?;
    let source = FigureSource { plan: batch.plan(), collected: &collected, states: states.as_deref() };
    let figures = source.draw(choice, SCREEN_WIDTH);
    let english = ChartChoice { language: Language::English, ..choice.clone() };
    let data = if *choice == english { None } else { Some(source.draw(&english, SCREEN_WIDTH).data) };
    let charts_folder = folder.join(CHARTS_FOLDER);
    fs::create_dir_all(&charts_folder).map_err(|source| unwritable(&charts_folder, source))?;
    for figure in &figures.drawn {
        write_chart(&charts_folder, figure)?;
    }
    for data in data.as_ref().unwrap_or(&figures.data) {
        write_data(&charts_folder, data)?;
    }
    if paper.pdf || paper.pgf {
        let drawn = source.draw(choice, paper.size.units()).drawn;
        drawn.iter().try_for_each(|figure| write_paper(&charts_folder, figure, paper))?;
    }
    let page = folder.join(REPORT_FILE);
    let contents = Page { batch, collected: &collected, figures: &figures, playing, origin: &origin, choice };
    write_whole(&page, contents.to_document().to_html().as_bytes())?;
    let Figures { drawn, refused, .. } = figures;
    let texts = drawn.iter().flat_map(|figure| figure.drawing.texts());
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

fn write_chart(folder: &Path, figure: &Figure) -> Result<(), ReportError> {
    write_whole(&folder.join(format!("{}.svg", figure.file)), figure.drawing.to_svg().as_bytes())?;
    let path = folder.join(format!("{}.png", figure.file));
    figure.drawing.paint().write_png(&path).map_err(|source| unwritable(&path, source))
}

fn write_data(folder: &Path, data: &ChartData) -> Result<(), ReportError> {
    let path = folder.join(format!("{}.csv", data.file));
    let write = || {
        let mut table = csv::Writer::from_writer(WholeFile::create(&path)?);
        data.rows.iter().try_for_each(|row| table.serialize(row))?;
        table.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
    };
    write().map_err(|source| unwritable(&path, source))
}

fn write_paper(folder: &Path, figure: &Figure, paper: &PaperCharts) -> Result<(), ReportError> {
    if paper.pdf {
        write_whole(&folder.join(format!("{}.pdf", figure.file)), &figure.drawing.to_pdf(paper.size))?;
    }
    if paper.pgf {
        write_whole(&folder.join(format!("{}.pgf", figure.file)), figure.drawing.to_pgf(paper.size).as_bytes())?;
    }
    Ok(())
}

fn write_whole(path: &Path, contents: &[u8]) -> Result<(), ReportError> {
    let write = || {
        let mut file = WholeFile::create(path)?;
        file.write_all(contents)?;
        file.finish()
    };
    write().map_err(|source| unwritable(path, source))
}

fn unwritable(path: &Path, source: io::Error) -> ReportError {
    ReportError::Unwritable { path: path.to_owned(), source }
}
