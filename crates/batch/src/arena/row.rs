//! What a board keeps of a run: its score, its effort, and a hash of all its outcomes.

use std::cmp::Ordering;
use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::ArenaError;
use crate::drives::DriveQuery;
use crate::plan::Value;
use crate::table::{RUN_COLUMNS, RunRecord};

/// The columns of `runs.csv` whose values a row's hash is of. New columns of later versions are not among them, so a published
/// hash stays what it is.
pub const HASHED_COLUMNS: [&str; 46] = [
    "status",
    "obstacles",
    "intact",
    "burning",
    "burned_out",
    "extinguished",
    "lit_by_wumpus",
    "caught_by_spread",
    "truck_stuck_s",
    "wumpus_stuck_s",
    "lit_by_schedule",
    "ended_s",
    "burning_cell_s",
    "peak_burning",
    "mean_response_s",
    "first_fire_s",
    "all_out_s",
    "winner",
    "truck_plans",
    "truck_failed_start_blocked",
    "truck_failed_goal_blocked",
    "truck_failed_disconnected",
    "truck_failed_budget_spent",
    "truck_failed_timed_out",
    "truck_failed_crashed",
    "truck_failed_bad_answer",
    "truck_lattice_plans",
    "truck_roadmap_samples",
    "truck_roadmap_expansions",
    "truck_local_expansions",
    "truck_distance_m",
    "truck_driving_s",
    "truck_planning_s",
    "truck_suppressing_s",
    "truck_cusps",
    "truck_wasted_drives",
    "truck_waiting_s",
    "truck_deadlocks",
    "wumpus_plans",
    "wumpus_failed_plans",
    "wumpus_expansions",
    "wumpus_distance_m",
    "wumpus_walking_s",
    "ground_burned",
    "burned_ha",
    "truck_relocations",
];

pub(super) const HEADINGS: [&str; 6] = ["entry", "condition", "seed", "score", "effort", "hash"];

/// The most bytes of a file of rows, and the most rows.
pub(super) const MAX_BYTES: u64 = 64_000_000;

/// Digits of a hash that a row shows.
const HASH_DIGITS: usize = 16;

/// A run of an entry.
#[derive(Clone, Debug, PartialEq)]
pub struct ArenaRow {
    pub entry: String,
    /// Empty on tracks with only one.
    pub condition: String,
    pub seed: u64,
    /// `None` of a run that failed; it counts as the worst score of all.
    pub score: Option<f64>,
    /// Expansions; of a module, millions of its instructions.
    pub effort: u64,
    /// 16 hexadecimal digits.
    pub hash: String,
}

impl ArenaRow {
    /// Orders rows by what they are found by on a board.
    pub fn cmp_run(&self, other: &Self) -> Ordering {
        let by_entry = self.entry.cmp(&other.entry).then_with(|| self.condition.cmp(&other.condition));
        by_entry.then(self.seed.cmp(&other.seed))
    }

    /// Says in what a row of the same run differs; `None` if in nothing.
    pub fn difference(&self, again: &Self) -> Option<String> {
        let pairs = [
            ("score", score_text(self), score_text(again)),
            ("effort", self.effort.to_string(), again.effort.to_string()),
            ("hash", self.hash.clone(), again.hash.clone()),
        ];
        let differing = pairs.into_iter().filter(|(_, says, gives)| says != gives);
        let differences: Vec<String> =
            differing.map(|(name, says, gives)| format!("{name} {says}, its run gives {gives}")).collect();
        let condition = if self.condition.is_empty() { String::new() } else { format!(", {}", self.condition) };
        (!differences.is_empty())
            .then(|| format!("{}{condition}, seed {}: {}", self.entry, self.seed, differences.join("; ")))
    }

    /// Reads rows as [`write`](Self::write) makes them.
    ///
    /// # Errors
    /// With the line that is wrong.
    pub fn read(path: &Path, bytes: impl Read) -> Result<Vec<Self>, ArenaError> {
        let mut reader = csv::ReaderBuilder::new().from_reader(bytes);
        let wrong = |line, message: String| ArenaError::WrongRow { path: path.to_owned(), line, message };
        let headings = reader.headers().map_err(|error| wrong(1, error.to_string()))?;
        // Columns are read by their place below, so their order matters too.
        if *headings != HEADINGS[..] {
            return Err(wrong(1, format!("expected the columns {}", HEADINGS.join(","))));
        }
        let rows = reader.records().map(|record| {
            let record = record.map_err(|error| {
                wrong(error.position().map_or(1, csv::Position::line), "expected six values".to_owned())
            })?;
            // Below, no index is out of range: the reader refuses records of another length than the headings.
            let line = record.position().map_or(1, csv::Position::line);
            let number = |place: usize| {
                let expected = format!("{} is {:?}; expected a whole number", HEADINGS[place], &record[place]);
                record[place].parse().map_err(|_| wrong(line, expected))
            };
            let score = match &record[3] {
                "" => None,
                text => match text.parse::<f64>() {
                    // Written otherwise, a changed digit might read as the same number.
                    Ok(score) if score.is_finite() && score.to_string() == text => Some(score),
                    _ => {
                        let message = format!("score is {text:?}; expected nothing, or a number in its shortest form");
                        return Err(wrong(line, message));
                    }
                },
            };
            let row = Self {
                entry: record[0].to_owned(),
                condition: record[1].to_owned(),
                seed: number(2)?,
                score,
                effort: number(4)?,
                hash: record[5].to_owned(),
            };
            Ok(row)
        });
        rows.collect()
    }

    /// Returns rows as text, which is read back as the same.
    pub fn write(rows: &[Self]) -> String {
        let mut text = HEADINGS.join(",") + "\n";
        for Self { entry, condition, seed, score, effort, hash } in rows {
            let score = score.map_or(String::new(), |score| score.to_string());
            text += &format!("{entry},{condition},{seed},{score},{effort},{hash}\n");
        }
        text
    }
}

fn score_text(row: &ArenaRow) -> String {
    row.score.map_or("nothing".to_owned(), |score| score.to_string())
}

/// The hash of all rows of an entry: 16 hexadecimal digits of SHA-256 over their lines.
pub fn rows_hash<'a>(rows: impl Iterator<Item = &'a ArenaRow>) -> String {
    let rows: Vec<ArenaRow> = rows.cloned().collect();
    shown_hash(&ArenaRow::write(&rows))
}

/// The hash of a run's outcomes.
pub(super) fn hash_of_run(record: &RunRecord) -> String {
    let values = RUN_COLUMNS.iter().zip(record.values()).filter(|(column, _)| HASHED_COLUMNS.contains(&column.name));
    shown_hash(&values.map(|(column, value)| line(column.name, value)).collect::<String>())
}

/// The hash of a query's outcomes.
pub(super) fn hash_of_query(query: &DriveQuery) -> String {
    let figures = query.figures.as_ref();
    let values = [
        ("solved", Value::Flag(query.solved().is_some())),
        ("length_m", Value::from(figures.map(|it| it.length_m))),
        ("lower_bound_ratio", Value::from(figures.and_then(|it| it.lower_bound_ratio))),
        ("min_clearance_m", Value::from(figures.map(|it| it.min_clearance_m))),
        ("cusps", Value::from(figures.map(|it| u64::from(it.cusps)))),
        ("drive_s", Value::from(figures.map(|it| it.drive_s))),
        ("failure", Value::from(query.failure.map(|failure| failure.to_string()))),
        ("expansions", Value::from(query.cost.map(|cost| cost.expansions))),
    ];
    shown_hash(&values.iter().map(|(name, value)| line(name, value)).collect::<String>())
}

fn line(name: &str, value: &Value) -> String {
    format!("{name}={value}\n")
}

pub(super) fn whole_hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

pub(super) fn shown_hash(text: &str) -> String {
    whole_hash(text)[..HASH_DIGITS].to_owned()
}
