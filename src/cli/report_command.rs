//! `wildfire report`: a page on a batch, and its charts.

use std::process::ExitCode;

use crate::batch::{FinishedBatch, ReportError, write_report};
use crate::cli::args::FolderArguments;
use crate::cli::error::CliError;
use crate::cli::terminal;

pub fn run(arguments: &FolderArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let batch = FinishedBatch::open(&arguments.folder)?;
    let written = write_report(&batch).map_err(failure)?;
    let (page, charts) = (written.page.display(), written.charts_folder.display());
    let refused: String = written.refused.iter().map(|sentence| format!("{sentence}\n")).collect();
    let text = format!("{page}, and {} charts as SVG and PNG in {charts}\n{refused}", written.charts);
    terminal::print(&text)?;
    terminal::note_unknown_letters(written.unknown_letters.as_deref(), quiet);
    Ok(ExitCode::SUCCESS)
}

fn failure(error: ReportError) -> CliError {
    match error {
        ReportError::Finished(error) => error.into(),
        ReportError::Unfinished { folder } => {
            let help = format!("finish it with: wildfire batch --resume {}", folder.display());
            CliError::bad_input(ReportError::Unfinished { folder }, Some(&help))
        }
        ReportError::BadStates { .. } => CliError::bad_input(error, None),
        ReportError::Unwritable { path, source } => CliError::unwritable(&path, &source),
    }
}
