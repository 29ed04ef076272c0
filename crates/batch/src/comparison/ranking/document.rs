//! A ranking as a document.

use crate::comparison::{Contrast, EntryAudit, RankedEntry, Ranking, p_text};
use crate::stats::Interval;
use wildfire_base::document::number::{count, optional, percent, probability, rounded, two_digits};
use wildfire_base::document::{Block, Document, Figure, Table};
use wildfire_base::untrusted::visible_start;
use wildfire_picture::charts::{ForestChart, SCREEN_WIDTH, Titles};

/// The most pairs that are all shown; of more, each entry with the next one.
const MAX_PAIRS: usize = 15;

/// The most entries whose differences from the first are drawn.
const MAX_DRAWN: usize = 60;

/// The most characters of a name in a table.
const LONGEST_NAME: usize = 24;

const LEGEND: &str = "\
Rank: the ranks that an entry may have, given the pairs that differ; all ranges together contain the true ranks with \
95 % confidence (Mogstad, Romano, Shaikh, Wilhelm, 2024). Group: entries that share a letter are not significantly \
different (Piepho, 2004). Differences are paired by seed; their 95 % intervals, by the method of `wildfire compare`, are \
not adjusted. p is adjusted by Holm's method over all pairs; pairs with p ≤ 0.05 count as different.";

const STOPPED_LEGEND: &str = "\
Rank: the ranks that an entry may have, given the pairs that differ. Group: entries that share a letter are not known to \
differ. A rule stopped the runs when enough was known, so the 95 % intervals are those of a confidence sequence \
(Waudby-Smith et al., 2024), which hold at every number of seeds, for all pairs together; pairs whose interval excludes \
zero differ. Differences are paired by seed; the mean of an entry with fewer seeds is that of the best and its difference \
from it.";

impl From<&Ranking> for Document {
    fn from(ranking: &Ranking) -> Self {
        let better = ranking.better.name();
        let entries = count(ranking.entries.len(), "entry");
        let metric = visible_start(&ranking.metric.name);
        let mut document = Self::new(format!("{entries} by {metric}, {better} is better"));
        document.add_list(played(ranking));
        document.add(table(ranking));
        document.add_list(remarks(ranking));
        // A single entry has no differences, and the legend speaks of nothing else.
        if ranking.entries.len() > 1 {
            document.add(forest(ranking));
            document.add(pairs(ranking));
            document.add_list(notes(ranking));
            document.add(Block::Text(if ranking.stop.is_some() { STOPPED_LEGEND.into() } else { LEGEND.into() }));
        }
        document
    }
}

/// What every entry played.
fn played(ranking: &Ranking) -> Vec<String> {
    let seeds = visible_start(&ranking.seeds);
    let bound = if ranking.has_stopped_entries() { "at most " } else { "" };
    let mut lines = vec![format!("Each entry: {bound}{}, seeds {seeds}", count(ranking.runs, "run"))];
    lines.extend(ranking.stop.as_ref().map(|stop| format!("Stopping rule: {}", visible_start(stop))));
    if ranking.strata > 1 {
        let columns: Vec<String> = ranking.columns.iter().map(|column| visible_start(column)).collect();
        lines.push(format!("Each mean is over {} values of {}", ranking.strata, columns.join(" and ")));
    }
    lines
}

fn name(entry: &RankedEntry) -> String {
    let letters = entry.name.chars().count();
    match letters > LONGEST_NAME {
        true => entry.name.chars().take(LONGEST_NAME - 1).chain(['…']).collect(),
        false => entry.name.clone(),
    }
}

pub fn ranks([first, last]: [usize; 2]) -> String {
    if first == last { first.to_string() } else { format!("{first}-{last}") }
}

/// Returns the decimals that show the smallest uncertainty of the differences from the first entry with two digits.
pub fn decimals(ranking: &Ranking) -> usize {
    let of_first = ranking.pairs.iter().filter(|pair| pair.places[0] == 0);
    let widths = of_first.filter_map(|pair| pair.contrast.interval).map(|it| 0.5 * (it.high - it.low));
    let narrowest = widths.filter(|&width| width > 0.0).fold(f64::INFINITY, f64::min);
    let largest = ranking.entries.iter().map(|entry| entry.mean.abs()).fold(0.0, f64::max);
    if narrowest.is_finite() { two_digits(narrowest).min(6) } else { two_digits(largest * 1e-2).min(6) }
}

/// The entries, best first, each with its difference from the first.
fn table(ranking: &Ranking) -> Table {
    // Columns that are zero for all entries are left out: most rankings have no failures, and a page has room for few columns.
    let has_failed = ranking.entries.iter().any(|entry| entry.failed > 0);
    let has_failed_queries = ranking.entries.iter().any(|entry| entry.queries.failed > 0);
    let has_failed_asks = ranking.entries.iter().any(|entry| entry.queries.failed_asks > 0);
    let has_rescued = ranking.entries.iter().any(|entry| entry.queries.rescued > 0);
    let has_groups = ranking.entries.len() > 1 && ranking.entries.iter().all(|entry| entry.groups.is_some());
    let decimals = decimals(ranking);
    let mut headings = vec!["Entry", "Rank"];
    headings.extend(has_groups.then_some("Group"));
    headings.extend(ranking.has_stopped_entries().then_some("Runs"));
    headings.extend(["Mean", "− first", "95%\nlow", "95%\nhigh"]);
    headings.extend(has_failed.then_some("Failed\nruns %"));
    headings.extend(has_failed_queries.then_some("Failed\nqueries %"));
    headings.extend(has_failed_asks.then_some("Failed\nasks %"));
    headings.extend(has_rescued.then_some("Rescued\ndrives %"));
    let rows = ranking.entries.iter().enumerate().map(|(place, entry)| {
        let against_first = ranking.pair(0, place).map(|pair| &pair.contrast);
        let interval = against_first.and_then(|contrast| contrast.interval);
        let mut cells = vec![name(entry), ranks(entry.ranks)];
        cells.extend(entry.groups.clone().filter(|_| has_groups));
        cells.extend(ranking.has_stopped_entries().then(|| entry.runs.to_string()));
        cells.extend([
            rounded(entry.mean, decimals),
            optional(against_first.map(|contrast| contrast.difference), decimals),
        ]);
        cells.extend(Interval::ends(interval).map(|end| optional(end, decimals)));
        cells.extend(has_failed.then(|| percent(entry.failed as f64 / entry.runs as f64)));
        let queries = &entry.queries;
        // A failed query is not counted as a drive, so that the whole is the sum of both.
        cells.extend(has_failed_queries.then(|| share_text(queries.failed, queries.drives + queries.failed)));
        cells.extend(has_failed_asks.then(|| share_text(queries.failed_asks, queries.asks)));
        cells.extend(has_rescued.then(|| share_text(queries.rescued, queries.drives)));
        cells
    });
    Table::new(&headings, rows.collect())
}

fn share_text(part: u64, all: u64) -> String {
    if all > 0 { percent(part as f64 / all as f64) } else { "-".into() }
}

/// Draws how the entries differ from the first.
fn forest(ranking: &Ranking) -> Block {
    let decimals = decimals(ranking);
    let rows = ranking.entries.iter().enumerate().skip(1).filter_map(|(place, entry)| {
        let pair = ranking.pair(0, place)?;
        Some(pair.contrast.forest_row(visible_start(&entry.name), decimals, pair.is_significant))
    });
    let symbol = ranking.metric.about.unit.symbol();
    let metric = visible_start(&ranking.metric.name);
    let unit = if symbol.is_empty() { "1" } else { symbol };
    let titles = Titles {
        title: format!("Difference from {}, 95 % intervals", name(&ranking.entries[0])),
        note: "Differences from the first, paired by seed. Filled: significantly different from it.".into(),
        x: format!("{metric} minus the first's ({unit})"),
        y: String::new(),
    };
    // A chart of hundreds of rows cannot be read; the table has them all.
    let chart = ForestChart { titles, rows: rows.take(MAX_DRAWN).collect() };
    Block::Figure(Figure { svg: chart.draw(SCREEN_WIDTH).to_svg(), file: None, more_files: Vec::new() })
}

/// What the reader of the table must know of runs that are not as they should be.
fn remarks(ranking: &Ranking) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(worst) = ranking.worst {
        let worst = wildfire_base::document::number::short(worst);
        lines.push(format!("Runs that failed, or have no value, count as {worst}, the worst value of all"));
    }
    lines.extend(ranking.entries.iter().filter_map(|entry| {
        let reason = entry.first_failure.as_ref()?;
        Some(format!("{}: {} of {} failed; the first: {reason}", name(entry), entry.failed, count(entry.runs, "run")))
    }));
    let metric = visible_start(&ranking.metric.name);
    lines.extend(ranking.entries.iter().filter(|entry| entry.without_value > 0).map(|entry| {
        let runs = count(entry.without_value, "run");
        format!("{}: {runs} finished without a value of {metric}", name(entry))
    }));
    lines.extend(ranking.entries.iter().filter_map(|entry| entry.queries.machine_sentence(&name(entry))));
    lines.extend(audit_lines(ranking));
    if ranking.entries.iter().any(|entry| entry.groups.is_none()) {
        lines.push("More groups than letters: see the ranks, or the pairs in --format json".into());
    }
    lines
}

/// Says what the audit found, if there was one: a sentence for each entry with a violation.
fn audit_lines(ranking: &Ranking) -> Vec<String> {
    let audits: Vec<(&RankedEntry, &EntryAudit)> =
        ranking.entries.iter().filter_map(|entry| Some((entry, entry.audit.as_ref()?))).collect();
    let repeated: u64 = audits.iter().map(|(_, audit)| audit.runs).sum();
    let violated = audits.iter().filter(|(_, audit)| audit.violations > 0);
    let mut lines: Vec<String> = violated
        .map(|(entry, audit)| {
            let EntryAudit { runs, violations, first_violation } = audit;
            let first = first_violation.as_deref().unwrap_or_default();
            format!(
                "{}: {violations} of {runs} audited runs violate a rule or give a different row: {first}",
                name(entry)
            )
        })
        .collect();
    // That nothing was found is said only if something was looked at.
    if lines.is_empty() && !audits.is_empty() {
        lines.push(format!("Audit: {} repeated, no violation.", count(repeated as usize, "run")));
    }
    lines
}

fn shows_all(ranking: &Ranking) -> bool {
    ranking.pairs.len() <= MAX_PAIRS
}

/// Pairs of entries: all, or of many each with the next.
fn pairs(ranking: &Ranking) -> Table {
    let headings = ["First", "Second", "Differ", "Second\n− first", "95%\nlow", "95%\nhigh", "p"];
    let shown = ranking.pairs.iter().filter(|pair| shows_all(ranking) || pair.places[0] + 1 == pair.places[1]);
    let rows = shown.map(|pair| {
        let [first, second] = pair.places.map(|place| name(&ranking.entries[place]));
        let Contrast { difference, interval, .. } = &pair.contrast;
        let decimals = interval.map_or_else(|| decimals(ranking), |it| two_digits(0.5 * (it.high - it.low)));
        let differs = if pair.is_significant { "yes" } else { "no" };
        let ends = Interval::ends(*interval).map(|end| optional(end, decimals));
        let cells = [first, second, differs.into(), rounded(*difference, decimals)];
        cells.into_iter().chain(ends).chain([pair.p_adjusted.map_or("-".into(), probability)]).collect()
    });
    Table { text_columns: 3, ..Table::new(&headings, rows.collect()) }
}

fn notes(ranking: &Ranking) -> Vec<String> {
    if shows_all(ranking) {
        return Vec::new();
    }
    let apart = ranking.pairs.iter().filter(|pair| pair.is_significant);
    let min = apart.clone().filter_map(|pair| pair.p_adjusted).fold(0.0, f64::max);
    let mut lines = vec![format!("Only neighbours are shown; --format json has all {} pairs", ranking.pairs.len())];
    let differing = apart.count();
    if differing > 0 {
        lines.push(format!("{differing} pairs differ significantly, the least certain with {}", p_text(min)));
    }
    lines
}
