//! A sheet for each entry of a ranking: what its author wants to know, and nothing about how the other entries went.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::cli::error::CliError;
use wildfire_base::document::number::{count, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::untrusted::visible_start;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::comparison::{RankedEntry, Ranking, decimals, ranks};
use wildfire_batch::plan::BatchPlan;

/// Writes the sheets as `NAME.md`.
pub fn write(folder: &Path, ranking: &Ranking) -> Result<(), CliError> {
    fs::create_dir_all(folder).map_err(|error| CliError::unwritable(folder, &error))?;
    let mut taken = BTreeSet::new();
    for (place, entry) in ranking.entries.iter().enumerate() {
        // Names may be paths, and may differ in letters only that files cannot have.
        let letter = |letter: char| if letter.is_alphanumeric() || "-+.".contains(letter) { letter } else { '_' };
        let mut name: String = entry.name.chars().take(60).map(letter).collect();
        // Names are compared in lower case, as some file systems have one file for both; a dot in front would hide one.
        if name.starts_with('.') || !taken.insert(name.to_lowercase()) {
            name = format!("entry-{}-{name}", place + 1);
        }
        let path = folder.join(format!("{name}.md"));
        let text = sheet(ranking, place, entry).to_markdown();
        write_whole(&path, text.as_bytes()).map_err(|error| CliError::unwritable(&path, &error))?;
    }
    Ok(())
}

fn sheet(ranking: &Ranking, place: usize, entry: &RankedEntry) -> Document {
    let metric = visible_start(&ranking.metric.name);
    let digits = decimals(ranking);
    let title = format!("{}: rank {} of {}", visible_start(&entry.name), ranks(entry.ranks), ranking.entries.len());
    let mut lines = vec![format!("Mean {metric} over {}: {}", count(entry.runs, "run"), rounded(entry.mean, digits))];
    if let Some(contrast) = ranking.pair(0, place).map(|pair| &pair.contrast) {
        let interval = contrast.interval.map(|it| (rounded(it.low, digits), rounded(it.high, digits)));
        let interval = interval.map_or_else(String::new, |(low, high)| format!(" (95 % interval: {low} to {high})"));
        lines.push(format!("Difference from the first: {}{interval}", rounded(contrast.difference, digits)));
    }
    lines.push(format!("Failed runs: {}", entry.failed));
    let queries = entry.queries.drives + entry.queries.failed;
    lines.push(format!("Failed queries: {} of {queries}", entry.queries.failed));
    let mut sheet = Document::new(title).with([Block::List(lines)]);
    if !entry.failures.is_empty() {
        sheet.add(Block::Heading("Failed queries by reason".into()));
        sheet.add(Table::new(
            &["Reason", "Queries"],
            entry.failures.iter().map(|(reason, number)| vec![reason.replace('_', " "), number.to_string()]).collect(),
        ));
    }
    sheet.add(Block::Heading("Worst runs".into()));
    sheet.add(Table::new(
        &["Seed", &metric],
        entry.worst_runs.iter().map(|run| vec![run.seed.to_string(), rounded(run.value, digits)]).collect(),
    ));
    let commands = commands(entry);
    if !commands.is_empty() {
        sheet.add(Block::Text("These commands simulate the runs again and write a page of each:".into()));
        sheet.add(Block::Verbatim(commands));
    }
    sheet
}

/// The commands that write pages of the worst runs; none if the plan of the runs is not there, or is another.
fn commands(entry: &RankedEntry) -> String {
    let Some(plan) = entry.table.parent().and_then(|folder| BatchPlan::read(folder).ok()) else { return String::new() };
    let runs = entry.worst_runs.iter().map(|worst| (worst.row as u64 + 1, worst.seed));
    let runs = runs.filter(|(number, _)| *number <= plan.count()).map(|(number, seed)| (plan.run(number), seed));
    let runs = runs.filter(|(run, seed)| run.seed == *seed);
    runs.map(|(run, seed)| format!("wildfire render {} --html seed-{seed}.html\n", run.repeating_args())).collect()
}
