//! Sheets of a ranking: one for each entry, with what its author wants to know and nothing about how the other entries went,
//! and one for the instructor, with everything.
//!
//! The seeds of a course are secret, so authors read which of their runs was bad, and which command replays seeds of their own.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::cli::error::CliError;
use wildfire_base::document::number::{count, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::untrusted::visible_start;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::comparison::{RankedEntry, Ranking, WorstRun, decimals, ranks};
use wildfire_batch::grading::Redaction;
use wildfire_batch::plan::{BatchPlan, PlannedRun};

/// The name of the instructor's sheet, without its ending.
const INSTRUCTOR: &str = "instructor";

/// What an author runs to see runs by the same rules, with seeds that are not secret.
const REPLAY: &str = "\
wildfire batch --rules rules.toml --entry entry.toml --seeds 1..20 --out runs/mine
wildfire render runs/mine --seed 1 --page seed-1.html
";

/// Writes the sheets as `NAME.md`.
pub fn write(folder: &Path, ranking: &Ranking) -> Result<(), CliError> {
    fs::create_dir_all(folder).map_err(|error| CliError::unwritable(folder, &error))?;
    let mut taken = BTreeSet::from([INSTRUCTOR.to_owned()]);
    let mut instructor = Document::new("Sheet for the instructor: it has secret seeds");
    for (place, entry) in ranking.entries.iter().enumerate() {
        // Names may be paths, and may differ in letters only that files cannot have.
        let letter = |letter: char| if letter.is_alphanumeric() || "-+.".contains(letter) { letter } else { '_' };
        let mut name: String = entry.name.chars().take(60).map(letter).collect();
        // Names are compared in lower case, as some file systems have one file for both; a dot in front would hide one.
        if name.starts_with('.') || !taken.insert(name.to_lowercase()) {
            name = format!("entry-{}-{name}", place + 1);
        }
        let plan = entry.table.parent().and_then(|folder| BatchPlan::read(folder).ok());
        write_sheet(folder, &name, &sheet(ranking, place, entry, plan.as_ref()))?;
        instructor.add(Block::Heading(format!("{} ({})", visible_start(&entry.name), entry.description)));
        instructor = instructor.with(everything(ranking, entry, plan.as_ref()));
    }
    write_sheet(folder, INSTRUCTOR, &instructor)
}

fn write_sheet(folder: &Path, name: &str, sheet: &Document) -> Result<(), CliError> {
    let path = folder.join(format!("{name}.md"));
    write_whole(&path, sheet.to_markdown().as_bytes()).map_err(|error| CliError::unwritable(&path, &error))
}

fn sheet(ranking: &Ranking, place: usize, entry: &RankedEntry, plan: Option<&BatchPlan>) -> Document {
    let metric = visible_start(&ranking.metric.name);
    let digits = decimals(ranking);
    let redaction = Redaction::new(plan.into_iter().flat_map(|plan| plan.seeds.iter()));
    let name = redaction.of(&visible_start(&entry.name));
    let title = format!("{name}: rank {} of {}", ranks(entry.ranks), ranking.entries.len());
    let mut lines = vec![format!("Mean {metric} over {}: {}", count(entry.runs, "run"), rounded(entry.mean, digits))];
    if let Some(contrast) = ranking.pair(0, place).map(|pair| &pair.contrast) {
        let interval = contrast.interval.map(|it| (rounded(it.low, digits), rounded(it.high, digits)));
        let interval = interval.map_or_else(String::new, |(low, high)| format!(" (95 % interval: {low} to {high})"));
        lines.push(format!("Difference from the first: {}{interval}", rounded(contrast.difference, digits)));
    }
    let reason = entry.first_failure.as_ref().map(|reason| format!("; the first: {}", redaction.of(reason)));
    lines.push(format!("Failed runs: {}{}", entry.failed, reason.unwrap_or_default()));
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
    let first_run = entry.run_numbers.iter().min().copied().unwrap_or_default();
    sheet.add(Block::Heading("Worst runs".into()));
    sheet.add(Table::new(
        &["Run", &metric],
        entry
            .worst_runs
            .iter()
            .map(|run| vec![(run.row as u64 + 2).saturating_sub(first_run).to_string(), rounded(run.value, digits)])
            .collect(),
    ));
    let planned = plan.filter(|plan| !plan.free.is_empty());
    let trust = planned.is_some_and(|plan| {
        plan.variants
            .iter()
            .any(|variant| plan.entry(variant).as_ref() == Some(&entry.name) && variant.scenario.needs_trust())
    });
    match planned {
        Some(_) => {
            sheet.add(Block::Text(
                "Runs are numbered in the order of their seeds, which this page does not name. These commands play seeds 1 to 20 \
                 by the same rules:"
                    .into(),
            ));
            sheet.add(Block::Verbatim(if trust {
                REPLAY.replace(" --out", " --trust --out").replace(" --page", " --trust --page")
            } else {
                REPLAY.to_owned()
            }));
        }
        None => sheet = sheet.with(replayed(entry, plan)),
    }
    sheet
}

/// What the instructor reads of an entry: worst runs with their seeds and commands, and all messages as they are.
fn everything(ranking: &Ranking, entry: &RankedEntry, plan: Option<&BatchPlan>) -> Vec<Block> {
    let digits = decimals(ranking);
    let violation = entry.audit.as_ref().and_then(|audit| audit.first_violation.as_ref());
    let lines = violation
        .map(|violation| format!("Violation: {violation}"))
        .into_iter()
        .chain(
            entry
                .first_failure
                .as_ref()
                .map(|reason| format!("{} failed; the first: {reason}", count(entry.failed, "run"))),
        )
        .collect::<Vec<_>>();
    let worst = entry.worst_runs.iter().map(|run| vec![run.seed.to_string(), rounded(run.value, digits)]).collect();
    let table = Table::new(&["Seed of a worst run", &visible_start(&ranking.metric.name)], worst);
    let lines = Some(Block::List(lines.clone())).filter(|_| !lines.is_empty());
    lines.into_iter().chain([Block::Table(table)]).chain(replayed(entry, plan)).collect()
}

/// The commands that write pages of the worst runs; none if the plan of the runs is not there, or is another.
fn replayed(entry: &RankedEntry, plan: Option<&BatchPlan>) -> Vec<Block> {
    let Some(plan) = plan else { return Vec::new() };
    let runs = entry.worst_runs.iter().filter_map(|worst| run_of(plan, worst));
    let command =
        |run: PlannedRun<'_>| format!("wildfire render {} --page seed-{}.html\n", run.repeating_args(), run.seed);
    let commands: String = runs.map(command).collect();
    if commands.is_empty() {
        return Vec::new();
    }
    vec![
        Block::Text("These commands simulate the runs again and write a page of each:".into()),
        Block::Verbatim(commands),
    ]
}

fn run_of<'a>(plan: &'a BatchPlan, worst: &WorstRun) -> Option<PlannedRun<'a>> {
    let number = worst.row as u64 + 1;
    let run = (number <= plan.count()).then(|| plan.run(number))?;
    (run.seed == worst.seed).then_some(run)
}
