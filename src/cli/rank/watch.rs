//! A page for the wall of a class: a ranking that is computed again as batches finish.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, SystemTime};

use crate::cli::error::CliError;
use crate::cli::{interrupt, terminal};
use wildfire_base::document::{Block, Document};
use wildfire_base::whole_file::write_whole;
use wildfire_batch::comparison::{RankingRequest, rank};
use wildfire_batch::execute::RUNS_FILE;

/// The time between two looks, and after which a browser loads the page again.
const LOOK: Duration = Duration::from_secs(1);
const RENEWED_AFTER_S: u32 = 5;

/// Writes the page, and again whenever a table of runs is new or has changed, until a signal ends that.
pub fn keep_page(
    page: &Path,
    batches: &[PathBuf],
    request: &RankingRequest,
    quiet: bool,
) -> Result<ExitCode, CliError> {
    let watch = interrupt::watch(interrupt::USUAL_TIDYING);
    let mut shown = None;
    while !watch.stop().load(Ordering::Relaxed) {
        let tables: Vec<FoundTable> = batches.iter().flat_map(|batch| tables_below(batch)).collect();
        if shown.as_ref() != Some(&tables) {
            let document = board(&tables, request, quiet);
            write_whole(page, renewing(&document).as_bytes()).map_err(|error| CliError::unwritable(page, &error))?;
            if shown.is_none() && !quiet {
                terminal::note(&format!("open {} in a browser; Ctrl-C ends", page.display()));
            }
            shown = Some(tables);
        }
        #[expect(clippy::disallowed_methods, reason = "other processes work in real time")]
        thread::sleep(LOOK);
    }
    Ok(ExitCode::SUCCESS)
}

/// A table of runs, and when it was written.
#[derive(PartialEq)]
struct FoundTable {
    path: PathBuf,
    written: Option<SystemTime>,
}

impl FoundTable {
    fn new(path: PathBuf) -> Self {
        Self { written: fs::metadata(&path).and_then(|it| it.modified()).ok(), path }
    }
}

/// Finds the table of a batch, or those of the batches in a folder, in the order of their names. There may be none yet.
fn tables_below(path: &Path) -> Vec<FoundTable> {
    if path.is_file() {
        return vec![FoundTable::new(path.to_owned())];
    }
    let table = path.join(RUNS_FILE);
    if table.is_file() {
        return vec![FoundTable::new(table)];
    }
    let mut below: Vec<PathBuf> =
        fs::read_dir(path).into_iter().flatten().flatten().map(|it| it.path().join(RUNS_FILE)).collect();
    below.retain(|path| path.is_file());
    below.sort();
    below.into_iter().map(FoundTable::new).collect()
}

/// The ranking without what students must not read, or why there is none yet.
fn board(tables: &[FoundTable], request: &RankingRequest, quiet: bool) -> Document {
    if tables.is_empty() {
        return Document::new("No batch has finished yet");
    }
    let paths: Vec<PathBuf> = tables.iter().map(|table| table.path.clone()).collect();
    match rank(&paths, request) {
        Ok(mut ranking) => {
            ranking.seeds = "not shown".into();
            ranking.entries.iter_mut().for_each(|entry| entry.first_failure = None);
            Document::from(&ranking)
        }
        Err(error) => {
            if !quiet {
                terminal::note(&format!("no ranking: {error}"));
            }
            // The reason may have paths and seeds, so only the instructor reads it.
            Document::new("No ranking").with([Block::Text("These batches cannot be ranked together.".into())])
        }
    }
}

/// The page of a document, with what makes a browser load it again.
fn renewing(document: &Document) -> String {
    let again = format!("<meta charset=\"utf-8\">\n<meta http-equiv=\"refresh\" content=\"{RENEWED_AFTER_S}\">");
    document.to_html().replacen("<meta charset=\"utf-8\">", &again, 1)
}
