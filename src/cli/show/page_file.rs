//! Writing a page that plays runs.

use std::io::Write;
use std::path::Path;

use crate::cli::error::CliError;
use wildfire_base::whole_file::WholeFile;
use wildfire_picture::film::{FrameRequest, MAX_GROUND_CELLS, RunView, page};

/// Refuses runs with more ground than a page has room for.
pub fn check_grounds(runs: &[&RunView]) -> Result<(), CliError> {
    let cells = |run: &&RunView| run.index().ground().map_or(0, |_| run.timeline().setting.frame.cell_count());
    let Some(cells) = runs.iter().map(cells).max().filter(|&cells| cells > MAX_GROUND_CELLS) else { return Ok(()) };
    let sentence = format!("the field has {cells} cells of ground; expected at most {MAX_GROUND_CELLS} for a page");
    Err(CliError::bad_input(sentence, Some("write a still or a film instead")))
}

/// Writes a page that begins at the request's time, seen as its options say.
pub fn write_page(request: &FrameRequest<'_>, path: &Path) -> Result<(), CliError> {
    let written = WholeFile::create(path).and_then(|mut file| {
        file.write_all(page(request).as_bytes())?;
        file.finish()
    });
    written.map_err(|error| CliError::unwritable(path, &error))
}
