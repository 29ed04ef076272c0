//! Drives as tables and sentences, shared by all commands that plan or judge drives.

use std::collections::BTreeMap;

use crate::drives::query::{DriveFailure, DriveQuery};
use crate::drives::summary::{
    CLEARANCE, CPU_BUILD, CPU_QUERY, CUSPS, DRIVE_TIME, LOWER_BOUND_RATIO, Measure, PlannerSummary,
};
use crate::drives::table::DriveTable;
use wildfire_base::document::number::{count, optional, rounded};
use wildfire_base::document::{Block, Table};
use wildfire_base::untrusted::visible_start;
use wildfire_picture::charts::Estimate;

/// The most rows that are shown one by one.
pub const SHOWN_ROWS: usize = 60;

/// The most variants whose tables are shown, and the most sentences of a kind.
const SHOWN_VARIANTS: usize = 50;
const SHOWN_SENTENCES: usize = 10;

/// Characters of a field's name, and of a planner's in a table with intervals.
const LONGEST_FIELD: usize = 10;
const LONGEST_PLANNER: usize = 14;

/// The legend of [`summary_table`].
pub const DRIVE_LEGEND: [&str; 3] = [
    "Solved: goals with a path that the independent audit accepts (body sampled every 2 cm); it rejects violations.",
    "Query, build: CPU time in ms; building the clearance field counts as building.",
    "Len./bound: length over a lower bound on the length of any path. Length, clearance, cusps: of solved goals.",
];

/// The legend of [`interval_tables`].
pub const INTERVAL_LEGEND: [&str; 3] = [
    "Solved: queries with a path that the independent audit accepts, with the interval of their percentage.",
    "Other columns: medians, with intervals by order statistics (Conover, 1999).",
    "Len./bound, clearance: of solved queries. CPU: of all queries.",
];

/// A column of a table: its heading, and its cells.
type TextColumn<T> = (&'static str, fn(&T) -> String);

fn table<T>(columns: &[TextColumn<T>], rows: &[T]) -> Table {
    let headings: Vec<_> = columns.iter().map(|(heading, _)| *heading).collect();
    Table::new(&headings, rows.iter().map(|row| columns.iter().map(|(_, cell)| cell(row)).collect()).collect())
}

/// Returns a row for each goal and planner, with the cost of queries if all have one, otherwise a verdict.
pub fn rows_table(rows: &[DriveQuery]) -> Table {
    let mut columns: Vec<TextColumn<DriveQuery>> = Vec::new();
    // Paths that came from a file have no planning time.
    let has_cost = rows.iter().all(|row| row.cost.is_some());
    // Without rows nothing is compared, and the first one is not needed.
    let differs = |is_same: fn(&DriveQuery, &DriveQuery) -> bool| rows.iter().any(|row| !is_same(row, &rows[0]));
    // A column that is the same in all rows takes the width that a terminal of 80 characters needs for figures.
    if !has_cost || differs(|one, other| one.planner == other.planner) {
        columns.push(("Planner", |row| visible_start(&row.planner)));
    }
    if differs(|one, other| one.field == other.field) {
        columns.push(("Field", |row| shortened_field(&row.field)));
    }
    columns.push(("Goal", |row| row.goal.to_string()));
    if has_cost {
        columns.push(("Query\nms", |row| row.cost.map_or_else(String::new, |cost| milliseconds(cost.cpu_query_s))));
        columns.push(("Expan-\nsions", |row| row.cost.map_or_else(String::new, |cost| cost.expansions.to_string())));
    }
    columns.extend::<[TextColumn<DriveQuery>; 5]>([
        ("Length\nm", |row| optional(row.figures.map(|path| path.length_m), 2)),
        ("Len./\nbound", |row| optional(row.figures.and_then(|path| path.printed_ratio()), 3)),
        ("Clear.\nm", |row| optional(row.figures.map(|path| path.min_clearance_m), 2)),
        ("Cusps", |row| optional(row.figures.map(|path| path.cusps.into()), 0)),
        ("Drive\ns", |row| optional(row.figures.map(|path| path.drive_s), 1)),
    ]);
    if !has_cost {
        columns.push(("Verdict", |row| match (&row.violation, row.failure) {
            (Some(_), _) => "violation".into(),
            (None, Some(failure)) => failure.to_string(),
            (None, None) => "sound".into(),
        }));
    }
    table(&columns, rows)
}

/// Returns a row for each planner; headings name the statistic of each figure.
pub fn summary_table(summaries: &[PlannerSummary]) -> Table {
    let mut columns: Vec<TextColumn<PlannerSummary>> = vec![
        ("Planner", |row| visible_start(&row.planner)),
        ("Solved", |row| format!("{}/{}", row.solved, row.queries)),
    ];
    let has_cost = summaries.iter().all(|row| !row.values(&CPU_QUERY).is_empty());
    if has_cost {
        columns.extend::<[TextColumn<PlannerSummary>; 4]>([
            ("Query\nmedian", |row| milliseconds_at(row, &CPU_QUERY, 0.5)),
            ("p95", |row| milliseconds_at(row, &CPU_QUERY, 0.95)),
            ("max", |row| milliseconds_at(row, &CPU_QUERY, 1.0)),
            ("Build\nmedian", |row| milliseconds_at(row, &CPU_BUILD, 0.5)),
        ]);
    }
    columns.extend::<[TextColumn<PlannerSummary>; 3]>([
        ("Len./\nbound\nmean", |row| optional(row.mean(&LOWER_BOUND_RATIO), 3)),
        ("Clear.\nmedian\nm", |row| optional(row.quantile(&CLEARANCE, 0.5), 2)),
        ("Cusps\nmean", |row| optional(row.mean(&CUSPS), 2)),
    ]);
    if !has_cost {
        columns.push(("Drive\nmean\ns", |row| optional(row.mean(&DRIVE_TIME), 1)));
    }
    columns.push(("Viola-\ntions", |row| row.violations.to_string()));
    table(&columns, summaries)
}

/// CPU time in milliseconds, with decimals where they count.
fn milliseconds(seconds: f64) -> String {
    let milliseconds = 1e3 * seconds;
    rounded(milliseconds, if milliseconds < 100.0 { 2 } else { 0 })
}

fn milliseconds_at(summary: &PlannerSummary, measure: &Measure, share: f64) -> String {
    summary.quantile(measure, share).map_or_else(|| "-".into(), milliseconds)
}

/// Returns a table for each variant, with a row for each planner: medians with their intervals.
pub fn interval_tables(drives: &DriveTable, summaries: &[PlannerSummary]) -> Vec<Block> {
    let variants: Vec<_> = summaries.chunk_by(|one, next| one.variant == next.variant).collect();
    let shown = variants.iter().take(SHOWN_VARIANTS);
    let mut blocks: Vec<Block> = shown.map(|of_variant| interval_table(drives, of_variant).into()).collect();
    let more = variants.len().saturating_sub(SHOWN_VARIANTS);
    if more > 0 {
        blocks.push(Block::Text(format!("{} more are not shown.", count(more, "variant"))));
    }
    blocks
}

fn interval_table(drives: &DriveTable, summaries: &[PlannerSummary]) -> Table {
    let headings = [
        "Planner",
        "Solved",
        "95 %",
        "Len./\nbound\nmedian",
        "95 %",
        "CPU ms\nmedian",
        "95 %",
        "Clear.\nmedian\nm",
        "95 %",
    ];
    let rows = summaries.iter().map(|summary| {
        let percent = scaled(summary.solved_share(), 100.0);
        let mut cells = vec![shortened(&summary.planner, LONGEST_PLANNER), summary.solved.to_string()];
        // Only the interval: its estimate is the count in the cell before.
        cells.extend(cells_of(Some(percent), 0).into_iter().skip(1));
        cells.extend(median_cells(summary, &LOWER_BOUND_RATIO, |_| 2));
        // Digits fall with size, so the column keeps its width from microseconds to minutes.
        cells.extend(median_cells(summary, &CPU_QUERY, |ms| if ms < 10.0 { 2 } else { usize::from(ms < 100.0) }));
        cells.extend(median_cells(summary, &CLEARANCE, |metres| if metres < 10.0 { 2 } else { 1 }));
        cells
    });
    let counts: Vec<u64> = summaries.iter().map(|summary| summary.queries).collect();
    let of_each = match counts.as_slice() {
        [first, others @ ..] if others.iter().all(|other| other == first) => {
            format!("{} of each planner", queries_text(*first))
        }
        several => queries_text(several.iter().sum()),
    };
    let title = drives.title(summaries[0].variant);
    let caption = if title.is_empty() { of_each } else { format!("{title}: {of_each}") };
    Table::new(&headings, rows.collect()).with_caption(&caption)
}

fn median_cells(summary: &PlannerSummary, measure: &Measure, decimals: fn(f64) -> usize) -> [String; 2] {
    let median = summary.median(measure).map(|median| scaled(median, measure.scale));
    cells_of(median, median.map_or(0, |median| decimals(median.value)))
}

fn scaled(Estimate { value, interval }: Estimate, factor: f64) -> Estimate {
    Estimate { value: factor * value, interval: interval.map(|(low, high)| (factor * low, factor * high)) }
}

/// An estimate and its interval; dashes for what is not there.
fn cells_of(estimate: Option<Estimate>, decimals: usize) -> [String; 2] {
    let interval = estimate.and_then(|estimate| estimate.interval);
    let range = interval.map(|(low, high)| format!("{}-{}", rounded(low, decimals), rounded(high, decimals)));
    [optional(estimate.map(|estimate| estimate.value), decimals), range.unwrap_or_else(|| "-".into())]
}

/// Returns a number of queries in words.
pub fn queries_text(queries: u64) -> String {
    if queries == 1 { "1 query".into() } else { format!("{queries} queries") }
}

/// Returns a sentence for each planner and reason of its failures.
pub fn failure_sentences(drives: &DriveTable) -> Vec<String> {
    let mut found: BTreeMap<(&str, DriveFailure), (&DriveQuery, usize)> = BTreeMap::new();
    for row in &drives.rows {
        if let Some(failure) = row.failure {
            // The first query with a reason is the example of all.
            found.entry((&row.planner, failure)).or_insert((row, 0)).1 += 1;
        }
    }
    let sentences = found.iter().map(|((planner, failure), (first, times))| {
        let message = first.message.as_ref().map_or(String::new(), |message| format!(": {message}"));
        let times = if *times == 1 { String::new() } else { format!(" {times} times, first") };
        format!("{}: {failure}{times} {}{message}.", visible_start(planner), place(drives, first))
    });
    sentences.collect()
}

/// Returns the first violations, and the number of others.
pub fn violation_sentences(drives: &DriveTable) -> Vec<String> {
    let mut all: Vec<String> = drives
        .rows
        .iter()
        .filter_map(|row| {
            let violation = row.violation.as_ref()?;
            Some(format!("{}: violation {}: {violation}", visible_start(&row.planner), place(drives, row)))
        })
        .collect();
    let hidden = all.len().saturating_sub(SHOWN_SENTENCES);
    all.truncate(SHOWN_SENTENCES);
    all.extend((hidden > 0).then(|| format!("... and {}.", count(hidden, "more violation"))));
    all
}

fn place(drives: &DriveTable, row: &DriveQuery) -> String {
    let seed = row.seed.map(|seed| format!("seed {seed}"));
    let circumstances: Vec<String> =
        [drives.title(row.variant)].into_iter().chain(seed).filter(|it| !it.is_empty()).collect();
    let place = format!("on field {}, goal {}", shortened_field(&row.field), row.goal);
    if circumstances.is_empty() { place } else { format!("{place} ({})", circumstances.join(", ")) }
}

/// Returns the beginning of a field's name, for tables and sentences.
pub fn shortened_field(name: &str) -> String {
    shortened(&visible_start(name), LONGEST_FIELD)
}

fn shortened(name: &str, longest: usize) -> String {
    if name.chars().count() <= longest {
        return name.to_owned();
    }
    name.chars().take(longest - 1).chain(['~']).collect()
}
