//! The report on judged paths: an object, a table and a document, with differences to planners that were asked too.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use serde::Serialize;

use crate::batch::PROGRAM_VERSION;
use crate::cli::plan::{mean, quantile, shortened};
use crate::document::number::{count, optional, probability, rounded, two_digits};
use crate::document::{Block, Document, Table};
use crate::planning::judge::DriveFigures;
use crate::rng;
use crate::stats::{PairedAnswers, estimate_mean, holm};
use crate::untrusted::{spreadsheet_cell, visible_start};
use crate::whole_file::WholeFile;

/// The most rows, and violations, that are shown one by one.
const SHOWN_ROWS: usize = 60;
const SHOWN_VIOLATIONS: usize = 10;

/// Every comparison draws from the streams of this seed: the same files give the same figures.
const SEED: u64 = 1;

/// A goal, and what became of somebody's path to it. The columns in their order.
#[derive(Clone, Debug, Serialize)]
pub struct Row<'a> {
    pub field: Cow<'a, str>,
    pub goal: usize,
    pub planner: Cow<'a, str>,
    /// There is a path and nothing is wrong with it.
    pub success: bool,
    /// Why there is no path to the goal.
    pub reason: Option<Cow<'a, str>>,
    pub length_m: Option<f64>,
    pub lower_bound_ratio: Option<f64>,
    pub min_clearance_m: Option<f64>,
    pub cusps: Option<u32>,
    pub drive_s: Option<f64>,
    /// The first thing that is wrong with the path.
    pub violation: Option<Cow<'a, str>>,
}

impl<'a> Row<'a> {
    /// A goal that somebody has no path to, for this reason.
    pub fn without_path(field: &'a str, goal: usize, planner: &'a str, reason: String) -> Self {
        Self {
            field: field.into(),
            goal,
            planner: planner.into(),
            success: false,
            reason: Some(reason.into()),
            length_m: None,
            lower_bound_ratio: None,
            min_clearance_m: None,
            cusps: None,
            drive_s: None,
            violation: None,
        }
    }

    /// A path to a goal, with its figures and what is wrong with it.
    pub fn with_path(
        (field, goal, planner): (&'a str, usize, &'a str),
        figures: DriveFigures,
        violation: Option<String>,
    ) -> Self {
        Self {
            success: violation.is_none(),
            reason: None,
            length_m: Some(figures.length_m),
            lower_bound_ratio: figures.lower_bound_ratio,
            min_clearance_m: Some(figures.min_clearance_m),
            cusps: Some(figures.cusps),
            drive_s: Some(figures.drive_s),
            violation: violation.map(Cow::Owned),
            ..Self::without_path(field, goal, planner, String::new())
        }
    }

    /// The same path if it was broken off, for this reason.
    pub fn broken_off(self, reason: String) -> Self {
        Self { success: false, reason: Some(reason.into()), ..self }
    }

    /// The same for a CSV file, where texts are cells.
    fn in_table(&self) -> Row<'_> {
        Row {
            field: spreadsheet_cell(&self.field),
            planner: spreadsheet_cell(&self.planner),
            reason: self.reason.as_deref().map(spreadsheet_cell),
            violation: self.violation.as_deref().map(spreadsheet_cell),
            ..*self
        }
    }
}

/// Writes a row for each goal and planner; numbers read back as the same `f64`, and no spreadsheet computes a name.
pub fn write_rows(path: &Path, rows: &[Row]) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(WholeFile::create(path)?);
    for row in rows {
        table.serialize(row.in_table())?;
    }
    table.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
}

/// A figure that is compared: its name, its heading, and its value on a path.
type Metric = (&'static str, &'static str, fn(&Row) -> Option<f64>);

const METRICS: [Metric; 5] = [
    ("length_m", "length, m", |row| row.length_m),
    ("lower_bound_ratio", "length / bound", |row| row.lower_bound_ratio),
    ("min_clearance_m", "clearance, m", |row| row.min_clearance_m),
    ("cusps", "cusps", |row| row.cusps.map(f64::from)),
    ("drive_s", "drive, s", |row| row.drive_s),
];

/// The figures of one planner, over the goals that it has a sound path to.
#[derive(Clone, Debug, Serialize)]
pub struct Summary<'a> {
    pub planner: &'a str,
    pub goals: usize,
    pub reached: usize,
    /// Paths with something wrong.
    pub violations: usize,
    pub lower_bound_ratio_mean: Option<f64>,
    pub min_clearance_median_m: Option<f64>,
    pub cusps_mean: Option<f64>,
    pub drive_mean_s: Option<f64>,
}

impl<'a> Summary<'a> {
    fn new(planner: &'a str, rows: &[Row]) -> Self {
        let own: Vec<&Row> = rows.iter().filter(|row| row.planner == planner).collect();
        let sound: Vec<&Row> = own.iter().copied().filter(|row| row.success).collect();
        let mut clearances: Vec<f64> = sound.iter().filter_map(|row| row.min_clearance_m).collect();
        clearances.sort_by(f64::total_cmp);
        Self {
            planner,
            goals: own.len(),
            reached: sound.len(),
            violations: own.iter().filter(|row| row.violation.is_some()).count(),
            lower_bound_ratio_mean: mean(sound.iter().filter_map(|row| row.lower_bound_ratio)),
            min_clearance_median_m: quantile(&clearances, 0.5),
            cusps_mean: mean(sound.iter().filter_map(|row| row.cusps.map(f64::from))),
            drive_mean_s: mean(sound.iter().filter_map(|row| row.drive_s)),
        }
    }
}

/// A figure of one planner beside that of another, over the goals that both have a sound path to.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison<'a> {
    pub planner: &'a str,
    pub against: &'a str,
    pub metric: &'static str,
    #[serde(skip)]
    heading: &'static str,
    /// Goals that count.
    pub goals: usize,
    pub mean: f64,
    pub against_mean: f64,
    /// The first less the second, with its 95 % interval.
    pub difference: f64,
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// That there is no difference, adjusted over all that is compared.
    pub p: Option<f64>,
}

/// Compares one planner with another, goal by goal.
fn compare<'a>(planner: &'a str, against: &'a str, rows: &[Row]) -> Vec<Comparison<'a>> {
    let by_goal = |name: &str| -> BTreeMap<(&str, usize), &Row> {
        rows.iter().filter(|row| row.planner == name).map(|row| ((&*row.field, row.goal), row)).collect()
    };
    let theirs = by_goal(against);
    let pairs: Vec<[&Row; 2]> =
        by_goal(planner).into_iter().filter_map(|(goal, row)| Some([row, *theirs.get(&goal)?])).collect();
    let mut answers = PairedAnswers::default();
    pairs.iter().for_each(|[ours, theirs]| answers.add(theirs.success, ours.success));
    let rate = |yes: u64| yes as f64 / answers.pairs() as f64;
    let interval = answers.rate_difference_interval();
    let success = answers.rate_difference().map(|difference| Comparison {
        planner,
        against,
        metric: "success",
        heading: "success",
        goals: pairs.len(),
        mean: rate(answers.second_yes()),
        against_mean: rate(answers.first_yes()),
        difference,
        low: interval.map(|it| it.low),
        high: interval.map(|it| it.high),
        p: Some(answers.mcnemar_p_value()),
    });
    let sound: Vec<[&Row; 2]> = pairs.into_iter().filter(|pair| pair.iter().all(|row| row.success)).collect();
    let of_metric = |(metric, heading, value): Metric| {
        let values: Vec<[f64; 2]> =
            sound.iter().filter_map(|[ours, theirs]| Some([value(ours)?, value(theirs)?])).collect();
        let differences: Vec<f64> = values.iter().map(|[ours, theirs]| ours - theirs).collect();
        let estimate =
            estimate_mean(&differences, &mut rng::stream(SEED, &format!("judge/{planner}/{against}/{metric}")))?;
        Some(Comparison {
            planner,
            against,
            metric,
            heading,
            goals: values.len(),
            mean: mean(values.iter().map(|pair| pair[0]))?,
            against_mean: mean(values.iter().map(|pair| pair[1]))?,
            difference: estimate.mean,
            low: estimate.interval.map(|it| it.low),
            high: estimate.interval.map(|it| it.high),
            p: estimate.p_value,
        })
    };
    success.into_iter().chain(METRICS.into_iter().filter_map(of_metric)).collect()
}

/// All paths, and what was found.
#[derive(Clone, Debug, Serialize)]
pub struct JudgeReport<'a> {
    program_version: &'static str,
    /// What the paths are of, for the title.
    #[serde(skip)]
    title: String,
    pub rows: Vec<Row<'a>>,
    pub summary: Vec<Summary<'a>>,
    pub comparisons: Vec<Comparison<'a>>,
}

impl<'a> JudgeReport<'a> {
    /// `judged` are those who computed the paths, `against` those that they are set beside.
    pub fn new(title: String, judged: &'a [String], against: &'a [String], rows: Vec<Row<'a>>) -> Self {
        let pairs = judged.iter().flat_map(|ours| against.iter().map(move |theirs| (ours, theirs)));
        let mut comparisons: Vec<_> = pairs.flat_map(|(ours, theirs)| compare(ours, theirs, &rows)).collect();
        let p_values: Vec<f64> = comparisons.iter().filter_map(|comparison| comparison.p).collect();
        let adjusted = holm(&p_values);
        for (comparison, p) in comparisons.iter_mut().filter(|comparison| comparison.p.is_some()).zip(adjusted) {
            comparison.p = Some(p);
        }
        let summary = judged.iter().chain(against).map(|planner| Summary::new(planner, &rows)).collect();
        Self { program_version: PROGRAM_VERSION, title, rows, summary, comparisons }
    }

    pub fn has_violations(&self) -> bool {
        self.rows.iter().any(|row| row.violation.is_some())
    }
}

const LEGEND: [&str; 3] = [
    "Reached: goals with a path that nothing is wrong with; the other figures are of these paths.",
    "Len./bound: over the shortest that could be, mean; clearance: median of minima.",
    "Violations: paths that a check by other shapes every 2 cm found fault with.",
];

const COMPARED: &str = "\
Differences are the first less the second, of means over goals that both reached, of success over all goals, with 95 % \
intervals; p is adjusted by Holm's method over all that is compared.";

impl From<&JudgeReport<'_>> for Document {
    /// A row for each goal if they are not too many, a row for each planner, what is wrong, and differences.
    fn from(report: &JudgeReport) -> Self {
        let mut document = Self::new(report.title.clone());
        if report.rows.len() <= SHOWN_ROWS {
            document.add(rows(report));
        }
        document.add(summary(report));
        document.add_list(missing(report).into_iter().chain(violations(report)).collect());
        document.add(Block::List(LEGEND.map(str::to_owned).to_vec()));
        for pair in report.comparisons.chunk_by(|a, b| (a.planner, a.against) == (b.planner, b.against)) {
            let (planner, against) = (visible_start(pair[0].planner), visible_start(pair[0].against));
            document.add(Block::Heading(format!("{planner} against {against}")));
            document.add(differences(pair));
        }
        if !report.comparisons.is_empty() {
            document.add(Block::Text(COMPARED.into()));
        }
        document
    }
}

fn rows(report: &JudgeReport) -> Table {
    let has_fields = report.rows.iter().any(|row| row.field != report.rows[0].field);
    let mut headings = vec!["Planner"];
    headings.extend(has_fields.then_some("Field"));
    headings.extend(["Goal", "Length\nm", "Len./\nbound", "Clear.\nm", "Cusps", "Drive\ns", "Verdict"]);
    let row = |row: &Row| {
        let verdict = match (&row.violation, &row.reason) {
            (Some(_), _) => "violation",
            (None, Some(reason)) => reason,
            (None, None) => "sound",
        };
        let cells = [
            row.goal.to_string(),
            optional(row.length_m, 2),
            optional(row.lower_bound_ratio, 3),
            optional(row.min_clearance_m, 2),
            optional(row.cusps.map(f64::from), 0),
            optional(row.drive_s, 1),
            verdict.to_owned(),
        ];
        let names = std::iter::once(visible_start(&row.planner)).chain(has_fields.then(|| shortened(&row.field)));
        names.chain(cells).collect()
    };
    Table::new(&headings, report.rows.iter().map(row).collect())
}

fn summary(report: &JudgeReport) -> Table {
    let headings = ["Planner", "Reached", "Len./\nbound", "Clear.\nm", "Cusps", "Drive\ns", "Viola-\ntions"];
    let row = |row: &Summary| {
        vec![
            visible_start(row.planner),
            format!("{}/{}", row.reached, row.goals),
            optional(row.lower_bound_ratio_mean, 3),
            optional(row.min_clearance_median_m, 2),
            optional(row.cusps_mean, 2),
            optional(row.drive_mean_s, 1),
            row.violations.to_string(),
        ]
    };
    Table::new(&headings, report.summary.iter().map(row).collect())
}

/// A sentence for each planner and reason.
fn missing(report: &JudgeReport) -> Vec<String> {
    let mut reasons: BTreeMap<(&str, &str), Vec<&Row>> = BTreeMap::new();
    for row in &report.rows {
        if let Some(reason) = &row.reason {
            reasons.entry((&row.planner, reason)).or_default().push(row);
        }
    }
    let sentence = |((planner, reason), rows): ((&str, &str), Vec<&Row>)| {
        let (planner, place) = (visible_start(planner), place(rows[0]));
        match rows.len() {
            1 => format!("{planner}: {reason} {place}."),
            times => format!("{planner}: {reason} {times} times, first {place}."),
        }
    };
    reasons.into_iter().map(sentence).collect()
}

fn violations(report: &JudgeReport) -> Vec<String> {
    let violation = |row: &Row| {
        let violation = row.violation.as_ref()?;
        Some(format!("{}: violation {}: {violation}", visible_start(&row.planner), place(row)))
    };
    let all: Vec<String> = report.rows.iter().filter_map(violation).collect();
    let hidden = all.len().saturating_sub(SHOWN_VIOLATIONS);
    let hidden = (hidden > 0).then(|| format!("... and {}.", count(hidden, "more violation")));
    all.into_iter().take(SHOWN_VIOLATIONS).chain(hidden).collect()
}

fn place(row: &Row) -> String {
    format!("on field {}, goal {}", shortened(&row.field), row.goal)
}

fn differences(pair: &[Comparison]) -> Table {
    let (ours, theirs) = (visible_start(pair[0].planner), visible_start(pair[0].against));
    let headings = ["Figure", "Goals", &ours, &theirs, "Differ-\nence", "95% low", "95% high", "p"];
    let row = |row: &Comparison| {
        let width = row.low.zip(row.high).map_or(row.difference.abs(), |(low, high)| 0.5 * (high - low));
        // Where nothing differs there is no uncertainty to show.
        let decimals = if width > 0.0 { two_digits(width).min(4) } else { 3 };
        vec![
            row.heading.to_owned(),
            row.goals.to_string(),
            rounded(row.mean, decimals),
            rounded(row.against_mean, decimals),
            rounded(row.difference, decimals),
            optional(row.low, decimals),
            optional(row.high, decimals),
            row.p.map_or_else(|| "-".into(), probability),
        ]
    };
    Table::new(&headings, pair.iter().map(row).collect())
}
