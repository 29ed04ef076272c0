//! The report on a benchmark: an object of all queries, and a document of what they come to.

use std::collections::BTreeMap;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::batch::{PROGRAM_VERSION, Value};
use crate::cli::plan::benchmark::ask::AskedProblem;
use crate::cli::plan::benchmark::queries::Queries;
use crate::cli::plan::benchmark::summary::{
    CLEARANCE, CPU_QUERY, EstimateMember, Group, LOWER_BOUND_RATIO, MEASURES, Measure,
};
use crate::cli::plan::query::Query;
use crate::cli::plan::tables::Row;
use crate::document::number::{count, rounded};
use crate::document::{Block, Document, Table};
use crate::picture::charts::Estimate;
use crate::planning::PlanFailure;
use crate::untrusted::visible_start;

/// The most variants whose tables are shown, and the most sentences of a kind.
const SHOWN_VARIANTS: usize = 50;
const SHOWN_SENTENCES: usize = 20;

/// Characters of a planner's name in a table.
const LONGEST_NAME: usize = 14;

/// The question and all answers.
pub struct BenchmarkReport<'a> {
    /// The name of the scenario.
    pub scenario: String,
    /// Changed and swept values, as on the command line.
    pub changes: &'a [String],
    pub seeds: String,
    pub queries: Queries,
    pub groups: Vec<Group>,
    pub problems: Vec<AskedProblem>,
    /// By the place of the query.
    pub violations: Vec<(usize, String)>,
    pub messages: Vec<(usize, String)>,
}

/// The members in their order.
#[derive(Serialize)]
struct Object<'a> {
    program_version: &'static str,
    scenario: &'a str,
    changes: &'a [String],
    seeds: &'a str,
    keys: &'a [String],
    rows: Vec<RowMember<'a>>,
    violations: Vec<ViolationMember<'a>>,
    summary: Vec<GroupMember<'a>>,
}

/// A query with its seed and the values of its variant.
struct RowMember<'a> {
    keys: &'a [String],
    values: &'a [Value],
    query: &'a Query,
}

impl Serialize for RowMember<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Whole<'a> {
            seed: Option<u64>,
            #[serde(flatten)]
            swept: Swept<'a>,
            #[serde(flatten)]
            row: Row<'a>,
        }
        let swept = Swept { keys: self.keys, values: self.values };
        Whole { seed: self.query.seed, swept, row: Row::from_query(self.query) }.serialize(serializer)
    }
}

/// The values of a variant, as members with the names of their keys.
struct Swept<'a> {
    keys: &'a [String],
    values: &'a [Value],
}

impl Serialize for Swept<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.keys.len()))?;
        self.keys.iter().zip(self.values).try_for_each(|(key, value)| map.serialize_entry(key, value))?;
        map.end()
    }
}

#[derive(Serialize)]
struct ViolationMember<'a> {
    row: usize,
    violation: &'a str,
}

#[derive(Serialize)]
struct GroupMember<'a> {
    #[serde(flatten)]
    swept: Swept<'a>,
    planner: &'a str,
    queries: u64,
    solved: u64,
    solved_ratio: EstimateMember,
    /// By column.
    medians: BTreeMap<&'static str, Option<EstimateMember>>,
    violations: usize,
}

fn row_member<'a>(queries: &'a Queries, query: &'a Query) -> RowMember<'a> {
    RowMember { keys: &queries.keys, values: &queries.variants[query.variant], query }
}

fn group_member<'a>(report: &'a BenchmarkReport<'_>, group: &'a Group) -> GroupMember<'a> {
    GroupMember {
        swept: Swept { keys: &report.queries.keys, values: &report.queries.variants[group.variant] },
        planner: &group.planner,
        queries: group.queries,
        solved: group.solved,
        solved_ratio: group.solved_share().into(),
        medians: MEASURES.iter().map(|it| (it.column, group.median(it).map(Into::into))).collect(),
        violations: report.violations_of(group),
    }
}

impl Serialize for BenchmarkReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let queries = &self.queries;
        let row = |query| row_member(queries, query);
        let group = |group| group_member(self, group);
        let object = Object {
            program_version: PROGRAM_VERSION,
            scenario: &self.scenario,
            changes: self.changes,
            seeds: &self.seeds,
            keys: &queries.keys,
            rows: queries.rows.iter().map(row).collect(),
            violations: self
                .violations
                .iter()
                .map(|(row, words)| ViolationMember { row: *row, violation: words })
                .collect(),
            summary: self.groups.iter().map(group).collect(),
        };
        object.serialize(serializer)
    }
}

impl BenchmarkReport<'_> {
    fn violations_of(&self, group: &Group) -> usize {
        let is_own = |(place, _): &&(usize, String)| {
            let query = &self.queries.rows[*place];
            query.variant == group.variant && query.planner == group.planner
        };
        self.violations.iter().filter(is_own).count()
    }

    fn place(&self, query: &Query) -> String {
        let mut words = vec![self.queries.title(query.variant)];
        words.extend(query.seed.map(|seed| format!("seed {seed}")));
        words.extend([format!("field {}", visible_start(&query.field)), format!("goal {}", query.goal)]);
        words.retain(|word| !word.is_empty());
        words.join(", ")
    }

    /// A sentence for each planner and reason.
    fn failures(&self) -> Vec<String> {
        let mut found: BTreeMap<(&str, usize), (usize, usize)> = BTreeMap::new();
        for (place, query) in self.queries.rows.iter().enumerate() {
            let Err(reason) = query.outcome else { continue };
            let reason = PlanFailure::ALL.iter().position(|known| *known == reason).expect("all reasons are listed");
            found.entry((&query.planner, reason)).or_insert((place, 0)).1 += 1;
        }
        let sentence = |((planner, reason), (first, times)): (&(&str, usize), &(usize, usize))| {
            let place = self.place(&self.queries.rows[*first]);
            let message = self.messages.iter().find(|(place, _)| place == first);
            let message = message.map_or(String::new(), |(_, words)| format!(": {words}"));
            let times = if *times == 1 { String::new() } else { format!(" {times} times, first") };
            format!("{planner}: {}{times} with {place}{message}.", PlanFailure::ALL[*reason])
        };
        found.iter().map(sentence).take(SHOWN_SENTENCES).collect()
    }

    fn violation_sentences(&self) -> Vec<String> {
        let sentence = |(place, words): &(usize, String)| {
            let query = &self.queries.rows[*place];
            format!("{}: violation with {}: {words}", query.planner, self.place(query))
        };
        self.violations.iter().map(sentence).take(SHOWN_SENTENCES).collect()
    }
}

impl From<&BenchmarkReport<'_>> for Document {
    /// The settings, a table for each variant, and what went wrong.
    fn from(report: &BenchmarkReport<'_>) -> Self {
        let planners = count(report.queries.planners().len(), "planner");
        let title =
            format!("Benchmark of {planners}, seeds {}: {}", report.seeds, queries_words(report.queries.rows.len()));
        let changes: String = report.changes.iter().map(|change| format!(", {change}")).collect();
        let settings = format!("Settings of the scenario `{}`{changes}.", report.scenario);
        let mut document =
            Self::new(title).with([Block::List(vec![settings])]).with(tables(&report.queries, &report.groups));
        document.add_list(report.failures().into_iter().chain(report.violation_sentences()).collect());
        document.with([Block::List(legend())])
    }
}

fn queries_words(queries: usize) -> String {
    if queries == 1 { "1 query".into() } else { format!("{queries} queries") }
}

/// Sentences on how to read the tables.
pub fn legend() -> Vec<String> {
    let lines = [
        "Solved: queries that found a drive; the interval is that of their percentage.",
        "All else: medians, with intervals by order statistics (Conover, 1999).",
        "Len./bound, clearance: of drives that were found. CPU ms: of all queries.",
    ];
    lines.map(str::to_owned).to_vec()
}

/// A table for each variant, with a row for each planner.
pub fn tables(queries: &Queries, groups: &[Group]) -> Vec<Block> {
    let variants: Vec<&[Group]> = groups.chunk_by(|one, next| one.variant == next.variant).collect();
    let mut blocks: Vec<Block> = variants.iter().take(SHOWN_VARIANTS).map(|own| table(queries, own).into()).collect();
    let more = variants.len().saturating_sub(SHOWN_VARIANTS);
    if more > 0 {
        blocks.push(Block::Text(format!("{} more are not shown.", count(more, "variant"))));
    }
    blocks
}

fn table(queries: &Queries, groups: &[Group]) -> Table {
    let headings = ["Planner", "Solved", "95 %", "Len./\nbound", "95 %", "CPU\nms", "95 %", "Clear.\nm", "95 %"];
    let row = |group: &Group| {
        let share = group.solved_share();
        let percent = Estimate {
            value: 100.0 * share.value,
            interval: share.interval.map(|(low, high)| (100.0 * low, 100.0 * high)),
        };
        let mut cells = vec![short_name(&group.planner), group.solved.to_string()];
        cells.extend(cells_of(Some(percent), 0).into_iter().skip(1));
        cells.extend(median_cells(group, &LOWER_BOUND_RATIO, |_| 2));
        cells.extend(median_cells(group, &CPU_QUERY, |ms| if ms < 10.0 { 2 } else { usize::from(ms < 100.0) }));
        cells.extend(median_cells(group, &CLEARANCE, |metres| if metres < 10.0 { 2 } else { 1 }));
        cells
    };
    let asked: Vec<u64> = groups.iter().map(|group| group.queries).collect();
    let of_each = match asked.as_slice() {
        [first, others @ ..] if others.iter().all(|other| other == first) => {
            format!("{} of each planner", queries_words(usize::try_from(*first).unwrap_or(usize::MAX)))
        }
        several => format!("{} queries", several.iter().sum::<u64>()),
    };
    let title = queries.title(groups[0].variant);
    let caption = if title.is_empty() { of_each } else { format!("{title}: {of_each}") };
    Table::new(&headings, groups.iter().map(row).collect()).with_caption(&caption)
}

fn median_cells(group: &Group, measure: &Measure, decimals: fn(f64) -> usize) -> [String; 2] {
    let scaled = |number: f64| measure.scale * number;
    let median = group.median(measure).map(|median| Estimate {
        value: scaled(median.value),
        interval: median.interval.map(|(low, high)| (scaled(low), scaled(high))),
    });
    cells_of(median, median.map_or(0, |median| decimals(median.value)))
}

/// An estimate and its interval; dashes for what is not there.
fn cells_of(estimate: Option<Estimate>, decimals: usize) -> [String; 2] {
    let interval = estimate.and_then(|estimate| estimate.interval);
    [
        estimate.map_or_else(|| "-".into(), |estimate| rounded(estimate.value, decimals)),
        interval.map_or_else(
            || "-".into(),
            |(low, high)| format!("{}-{}", rounded(low, decimals), rounded(high, decimals)),
        ),
    ]
}

fn short_name(name: &str) -> String {
    if name.chars().count() <= LONGEST_NAME {
        return name.to_owned();
    }
    name.chars().take(LONGEST_NAME - 1).chain(['~']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::plan::benchmark::summary::tests::made_up;

    #[test]
    fn answer_fits_eighty_columns_and_says_what_failed() {
        let queries = made_up();
        let groups = Group::all(&queries);
        let report = BenchmarkReport {
            scenario: "drives".into(),
            changes: &["field.coverage=0.05,0.1,1".to_owned()],
            seeds: "0..19".into(),
            queries,
            groups,
            problems: Vec::new(),
            violations: vec![(1, "it ends elsewhere".into())],
            messages: vec![(1, "no more".into())],
        };
        let text = Document::from(&report).to_text();
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert!(text.starts_with("Benchmark of 2 planners, seeds 0..19: 240 queries\n"), "{text}");
        for words in [
            "field.coverage 0.05, fire.model -so: 40 queries of each planner",
            "own: budget spent 30 times, first with field.coverage 0.05",
            "own: violation with field.coverage 0.05",
        ] {
            assert!(text.contains(words), "{words}: {text}");
        }
        let object = serde_json::to_value(&report).expect("it is JSON");
        let row = &object["rows"][1];
        assert_eq!((&row["seed"], &row["field.coverage"], &row["planner"]), (&0.into(), &0.05.into(), &"own".into()));
        assert_eq!(object["rows"].as_array().map(Vec::len), Some(240));
        let group = &object["summary"][1];
        assert_eq!((&group["planner"], &group["solved"], &group["violations"]), (&"own".into(), &30.into(), &1.into()));
        assert_eq!(group["medians"]["expansions"]["value"], 19.5);
    }
}
