//! The board of a track as a document.

use super::{BoardEntry, TrackBoard};
use crate::comparison::{decimals, ranks};
use crate::stats::Interval;
use wildfire_base::document::number::{count, optional, probability, rounded, two_digits};
use wildfire_base::document::{Block, Document, Figure, Table};
use wildfire_base::untrusted::visible_start;
use wildfire_picture::charts::{BarChart, BarPanel, BarSeries, Estimate, ForestChart, SCREEN_WIDTH, STYLES, Titles};

/// The most decimals of a score.
const MAX_DECIMALS: usize = 4;

const LEGEND: &str = "\
Rank: the ranks that an entry may have with 95 % confidence. Score: the mean of what decides, with its 95 % interval. \
Next − this: the mean paired difference of the next entry from this one, its 95 % interval, and p, adjusted by Holm's method \
over all pairs. Effort: mean expansions a run; of a module, millions of its instructions. Entries marked * are timed: their programs \
run beside and report their effort themselves.";

impl From<&TrackBoard> for Document {
    fn from(board: &TrackBoard) -> Self {
        let ranking = &board.ranking;
        let entries = count(ranking.entries.len(), "entry");
        let mut document = Self::new(format!("Track `{}`: {entries}", board.track.name));
        document.add_list(facts(board));
        document.add(ranks_table(board));
        // A single entry has nothing to differ from.
        if ranking.entries.len() > 1 {
            document.add(chart(board));
        }
        if board.entries[0].by_condition.len() > 1 {
            document.add(conditions_table(board));
            conditions_chart(board).into_iter().for_each(|figure| document.add(figure));
        }
        document.add(hashes_table(board));
        document.add(Block::Text(LEGEND.into()));
        document
    }
}

fn facts(board: &TrackBoard) -> Vec<String> {
    let ranking = &board.ranking;
    let decides = match (board.track.worst_decides, ranking.strata) {
        (true, _) => "the worst condition decides",
        (false, 1) => "the mean decides",
        (false, _) => "the mean over all conditions decides",
    };
    let metric = visible_start(&ranking.metric.name);
    let mut lines = vec![
        format!("Score: {metric}, {} is better; {decides}", ranking.better.name()),
        format!("Each entry: {}", count(ranking.runs, "run")),
    ];
    let floor = board.noise_floor.map(|floor| rounded(floor, two_digits(floor)));
    lines
        .extend(floor.map(|floor| {
            format!("Noise floor: two entries must differ by about {floor} for a significant difference")
        }));
    let failed = ranking.entries.iter().filter(|entry| entry.failed > 0);
    lines.extend(failed.map(|entry| format!("{}: {} failed", entry.name, count(entry.failed, "run"))));
    lines
}

fn name(entry: &BoardEntry) -> String {
    let mark = if entry.class == super::Class::Timed { "*" } else { "" };
    format!("{}{mark}", entry.card.name)
}

fn ends(interval: Option<Interval>, decimals: usize) -> [String; 2] {
    Interval::ends(interval).map(|end| optional(end, decimals))
}

fn ranks_table(board: &TrackBoard) -> Table {
    let ranking = &board.ranking;
    let decimals = decimals(ranking).min(MAX_DECIMALS);
    let rows = board.entries.iter().zip(&ranking.entries).enumerate().map(|(place, (entry, ranked))| {
        // The difference from the next entry decides whether the order of two neighbours means anything.
        let next = ranking.pair(place, place + 1);
        let mut cells = vec![name(entry), ranks(ranked.ranks), rounded(ranked.mean, decimals)];
        let reach = entry.interval.map(|interval| 0.5 * (interval.high - interval.low));
        cells.push(optional(reach, decimals));
        cells.push(optional(next.map(|pair| pair.contrast.difference), decimals));
        cells.extend(ends(next.and_then(|pair| pair.contrast.interval), decimals));
        cells.push(next.and_then(|pair| pair.p_adjusted).map_or("-".into(), probability));
        cells.push(rounded(entry.effort, 0));
        cells
    });
    let headings = ["Entry", "Rank", "Score", "± 95%", "Next\n− this", "95%\nlow", "95%\nhigh", "p", "Effort"];
    Table::new(&headings, rows.collect())
}

/// Draws how the entries differ from the first.
fn chart(board: &TrackBoard) -> Block {
    let ranking = &board.ranking;
    let decimals = decimals(ranking);
    let rows = ranking.entries.iter().enumerate().skip(1).filter_map(|(place, entry)| {
        let pair = ranking.pair(0, place)?;
        Some(pair.contrast.forest_row(entry.name.clone(), decimals, pair.is_significant))
    });
    let titles = Titles {
        title: format!("Difference from {}, 95 % intervals", ranking.entries[0].name),
        note: "Paired by seed. Filled: significantly different from it.".into(),
        x: format!("{} minus the first's", visible_start(&ranking.metric.name)),
        y: String::new(),
    };
    let chart = ForestChart { titles, rows: rows.collect() };
    figure(chart.draw(SCREEN_WIDTH).to_svg())
}

/// Entries against conditions: the mean score of each, the worst marked, and by how much it is worse than the mean.
fn conditions_table(board: &TrackBoard) -> Table {
    let decimals = decimals(&board.ranking).min(3);
    // Names of conditions are long; a break at each hyphen keeps the columns narrow.
    let names = board.entries[0].by_condition.iter().map(|(name, ..)| name.replace('-', "\n"));
    let headings: Vec<String> =
        std::iter::once("Entry".to_owned()).chain(names).chain(["Worst\n− mean".to_owned()]).collect();
    let rows = board.entries.iter().map(|entry| {
        let means = entry.by_condition.iter().map(|(_, mean, _)| *mean);
        // Each condition has the same weight, as each has the same seeds.
        let mean = means.clone().sum::<f64>() / entry.by_condition.len() as f64;
        let cells = means.clone().enumerate().map(|(place, mean)| {
            let mark = if place == entry.worst { "!" } else { "" };
            format!("{mark}{}", rounded(mean, decimals))
        });
        let exploited = rounded(entry.by_condition[entry.worst].1 - mean, decimals);
        std::iter::once(name(entry)).chain(cells).chain([exploited]).collect()
    });
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let table = Table::new(&headings, rows.collect());
    table.with_caption("Mean scores under each condition; ! marks the worst of an entry")
}

/// The same as bars with intervals, of the best entries.
fn conditions_chart(board: &TrackBoard) -> Vec<Block> {
    let series = board.entries.iter().zip(STYLES).map(|(entry, style)| BarSeries {
        name: name(entry),
        style,
        bars: entry
            .by_condition
            .iter()
            .map(|(_, mean, interval)| Some(Estimate { value: *mean, interval: interval.map(|it| (it.low, it.high)) }))
            .collect(),
    });
    let titles = Titles {
        title: "Mean score under each condition, 95 % intervals".into(),
        note: "Intervals are of each mean by itself; those of paired differences are narrower.".into(),
        x: String::new(),
        y: visible_start(&board.ranking.metric.name),
    };
    let groups = board.entries[0].by_condition.iter().map(|(name, ..)| name.clone()).collect();
    let chart = BarChart { titles, groups, panels: vec![BarPanel { name: String::new(), series: series.collect() }] };
    chart.draw(SCREEN_WIDTH).iter().map(|sheet| figure(sheet.to_svg())).collect()
}

fn figure(svg: String) -> Block {
    Block::Figure(Figure { svg, file: None, more_files: Vec::new() })
}

fn hashes_table(board: &TrackBoard) -> Table {
    let rows = board
        .entries
        .iter()
        .map(|entry| {
            let class = entry.class.name().to_owned();
            vec![name(entry), class, entry.rows_hash.clone(), entry.entry_hash.clone()]
        })
        .collect();
    let table = Table { text_columns: 4, ..Table::new(&["Entry", "Class", "All rows", "Files"], rows) };
    table.with_caption("SHA-256, the first 16 digits")
}
