//! Chart files: SVG and PNG, the data as CSV, and PDF and PGF for papers.

use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use super::{PaperCharts, ReportError};
use wildfire_base::untrusted::spreadsheet_cell;
use wildfire_base::whole_file::WholeFile;
use wildfire_picture::charts::{ChartRow, Drawing};

/// The data of a chart, for all of its sheets, and the file name without an extension.
#[derive(Debug)]
pub struct ChartData {
    file: String,
    rows: Vec<ChartValues>,
}

/// A row of such a file.
#[derive(Debug, Serialize)]
struct ChartValues {
    panel: String,
    series: String,
    x: String,
    value: f64,
    low: Option<f64>,
    high: Option<f64>,
}

impl From<ChartRow<'_>> for ChartValues {
    fn from(row: ChartRow<'_>) -> Self {
        Self {
            panel: spreadsheet_cell(row.panel).into_owned(),
            series: spreadsheet_cell(row.series).into_owned(),
            x: spreadsheet_cell(&row.x).into_owned(),
            value: row.value,
            low: row.interval.map(|(low, _)| low),
            high: row.interval.map(|(_, high)| high),
        }
    }
}

impl ChartData {
    pub fn new<'a>(file: &str, rows: impl Iterator<Item = ChartRow<'a>>) -> Self {
        Self { file: file.to_owned(), rows: rows.map(ChartValues::from).collect() }
    }

    /// Returns the file name without an extension.
    pub fn file(&self) -> &str {
        &self.file
    }
}

/// Writes a sheet of a chart as SVG and PNG; `file` is its name without an extension.
pub fn write_chart(folder: &Path, file: &str, drawing: &Drawing) -> Result<(), ReportError> {
    write_whole(&folder.join(format!("{file}.svg")), drawing.to_svg().as_bytes())?;
    let path = folder.join(format!("{file}.png"));
    drawing.paint().write_png(&path).map_err(|source| unwritable(&path, source))
}

/// Writes the data of a chart as CSV.
pub fn write_chart_data(folder: &Path, data: &ChartData) -> Result<(), ReportError> {
    let path = folder.join(format!("{}.csv", data.file));
    write_rows(&path, data).map_err(|source| unwritable(&path, source))
}

fn write_rows(path: &Path, data: &ChartData) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(WholeFile::create(path)?);
    data.rows.iter().try_for_each(|row| table.serialize(row))?;
    table.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
}

/// Writes a sheet of a chart, drawn at the width of the paper, as PDF and PGF if requested.
pub fn write_paper_chart(folder: &Path, file: &str, drawing: &Drawing, paper: &PaperCharts) -> Result<(), ReportError> {
    if paper.pdf {
        write_whole(&folder.join(format!("{file}.pdf")), &drawing.to_pdf(paper.size))?;
    }
    if paper.pgf {
        write_whole(&folder.join(format!("{file}.pgf")), drawing.to_pgf(paper.size).as_bytes())?;
    }
    Ok(())
}

pub fn write_whole(path: &Path, contents: &[u8]) -> Result<(), ReportError> {
    let written = WholeFile::create(path).and_then(|mut file| {
        file.write_all(contents)?;
        file.finish()
    });
    written.map_err(|source| unwritable(path, source))
}

pub fn unwritable(path: &Path, source: io::Error) -> ReportError {
    ReportError::Unwritable { path: path.to_owned(), source }
}
