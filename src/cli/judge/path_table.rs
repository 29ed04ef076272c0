//! Tables of paths, as `wildfire plan --paths` writes them and others can: read path by path.
//!
//! A row is a pose of the rear axle, with the gear in which the truck arrives there. A path is the rows of one field, goal
//! and planner, one after the other. Whatever is no such table is refused with its line.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::{self, ErrorKind};
use std::ops::RangeInclusive;
use std::path::Path;

use thiserror::Error;

use crate::cli::csv_rows::{CsvRows, LONGEST_LINE, RowFault};
use crate::cli::numbers;
use wildfire_base::document::number::beside_limit;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::untrusted::{bytes_of_cell, visible_start};
use wildfire_scenario::Problem;

/// Two poses in a row are no farther apart than this, metres.
pub const MAX_APART_M: f64 = 0.5;

/// Decimals of coordinates may make a step longer by so much, metres.
const ROUNDING_M: f64 = 1e-6;

/// A pose may be this far on the wrong side of the one before it, metres: rounding.
const MAX_BACKWARDS_M: f64 = 1e-3;

/// The range of coordinates in metres, and of headings in radians.
const NUMBERS: RangeInclusive<f64> = -1e6..=1e6;

/// The most poses of a path, and planners of a table.
const MAX_POSES: usize = 1_000_000;
const MAX_PLANNERS: usize = 50;

/// The most characters of a planner's name.
const LONGEST_NAME: usize = 100;

/// The name of who computed the paths of a table that does not say.
const NO_NAME: &str = "paths";

/// The columns that are read, by their names in the header.
const COLUMNS: [&str; 7] = ["field", "goal", "planner", "x_m", "y_m", "heading_rad", "direction"];
const FIELD: usize = 0;
const GOAL: usize = 1;
const PLANNER: usize = 2;
const X: usize = 3;
const Y: usize = 4;
const HEADING: usize = 5;
const DIRECTION: usize = 6;

/// A fault of a table of paths: a sentence to follow its path. Lines are counted from 1.
#[derive(Debug, Error)]
pub enum PathTableError {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("the file is empty; expected a header with the columns {}", COLUMNS.join(","))]
    Empty,
    #[error("the file has no row after its header; expected the poses of at least one path")]
    NoRows,
    #[error("line {line}: the column {column} is missing; expected a header with {}", COLUMNS.join(","))]
    Missing { line: u64, column: &'static str },
    #[error("line {line}: the column field is missing, which identifies one of {fields} fields")]
    NoField { line: u64, fields: usize },
    #[error("line {line}: the column {column} appears twice; expected it once")]
    Twice { line: u64, column: &'static str },
    #[error("line {line}: the line is longer than {LONGEST_LINE} bytes; expected a pose")]
    TooLong { line: u64 },
    #[error("line {line}: found {found} columns, expected {expected} as in the header")]
    Ragged { line: u64, found: usize, expected: usize },
    #[error("line {line}, column {column}: found {found:?}, expected a number {}", numbers::range_text(&NUMBERS))]
    Number { line: u64, column: &'static str, found: String },
    #[error("line {line}, column field: found {found:?}, expected {expected}")]
    Field { line: u64, found: String, expected: String },
    #[error(
        "line {line}, column goal: found {found:?}, expected a whole number from 0 to {last}, a goal of the field {field}"
    )]
    Goal { line: u64, found: String, field: String, last: usize },
    #[error("line {line}, column planner: found {found:?}, expected a name of 1 to {LONGEST_NAME} characters")]
    Planner { line: u64, found: String },
    #[error("line {line}: this is planner number {}; expected at most {MAX_PLANNERS}", MAX_PLANNERS + 1)]
    TooManyPlanners { line: u64 },
    #[error("line {line}, column direction: found {found:?}, expected forward or reverse")]
    Direction { line: u64, found: String },
    #[error(
        "line {line}: it is {} m from the pose of line {before}; expected at most {MAX_APART_M} m",
        beside_limit(*metres, MAX_APART_M, 3)[0]
    )]
    Apart { line: u64, before: u64, metres: f64 },
    #[error(
        "line {line}: it is {metres:.3} m {found} the pose of line {before}, and its direction is {direction}; \
         expected poses in driving order, each with the direction in which the truck arrives there"
    )]
    WrongSide { line: u64, before: u64, metres: f64, found: &'static str, direction: &'static str },
    #[error(
        "line {line}: the path of {planner} to goal {goal} of the field {field} begins again; expected its rows in \
         one block"
    )]
    Again { line: u64, planner: String, goal: usize, field: String },
    #[error("line {line}: the path has more than {MAX_POSES} poses; expected fewer")]
    TooManyPoses { line: u64 },
}

impl PathTableError {
    /// Returns the kind of error of an input that has this fault.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable(error) => error.kind(),
            _ => ErrorKind::InvalidData,
        }
    }
}

impl From<RowFault> for PathTableError {
    fn from(fault: RowFault) -> Self {
        match fault {
            RowFault::Unreadable(error) => Self::Unreadable(error),
            RowFault::TooLong { line } => Self::TooLong { line },
        }
    }
}

/// A pose of the rear axle, and the line that says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TablePose {
    pub line: u64,
    pub pose: Pose,
    /// The gear in which the truck arrives there.
    pub is_reverse: bool,
}

/// A path to a goal, with at least one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct TablePath {
    /// Who computed it: a place in [`PathTable::planners`].
    pub planner: usize,
    /// The place of its field in the list.
    pub problem: usize,
    pub goal: usize,
    pub poses: Vec<TablePose>,
}

/// Planner, problem and goal of a row.
type PathKey = (usize, usize, usize);

/// A table of paths, of which one path is kept at a time.
pub struct PathTable<'a> {
    rows: CsvRows,
    problems: &'a [Problem],
    /// Those that had a row, in the order of their first.
    planners: Vec<String>,
    /// The number of columns of the header.
    width: usize,
    /// The index of each of [`COLUMNS`] in a row, if it is there.
    places: [Option<usize>; COLUMNS.len()],
    /// The first row of the next path, if it has been read.
    next: Option<(PathKey, TablePose)>,
    /// All paths that have begun.
    started: BTreeSet<PathKey>,
}

impl<'a> PathTable<'a> {
    /// Reads the header of a table of paths on these fields.
    pub fn open(path: &Path, problems: &'a [Problem]) -> Result<Self, PathTableError> {
        let mut rows = CsvRows::open(path)?;
        if !rows.advance()? {
            return Err(PathTableError::Empty);
        }
        let line = rows.line();
        let mut places = [None; COLUMNS.len()];
        for (index, column) in COLUMNS.into_iter().enumerate() {
            places[index] = match rows.places(column)[..] {
                [place] => Some(place),
                // A table of one field or of one planner need not name it.
                [] if index == PLANNER || index == FIELD && problems.len() == 1 => None,
                [] if index == FIELD && !rows.places("goal").is_empty() => {
                    return Err(PathTableError::NoField { line, fields: problems.len() });
                }
                [] => return Err(PathTableError::Missing { line, column }),
                _ => return Err(PathTableError::Twice { line, column }),
            };
        }
        let width = rows.fields().count();
        Ok(Self { rows, problems, planners: Vec::new(), width, places, next: None, started: BTreeSet::new() })
    }

    /// Returns the planners that had a row so far.
    pub fn into_planners(self) -> Vec<String> {
        self.planners
    }

    /// Reads the next path; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<TablePath>, PathTableError> {
        let first = match self.next.take() {
            Some(row) => Some(row),
            None => self.read_row()?,
        };
        let Some((key, pose)) = first else {
            return if self.started.is_empty() { Err(PathTableError::NoRows) } else { Ok(None) };
        };
        let (planner, problem, goal) = key;
        // A path in two parts would be judged as two paths, of which neither reaches its goal.
        if !self.started.insert(key) {
            let name = visible_start(&self.planners[planner]);
            let field = visible_start(&self.problems[problem].name);
            return Err(PathTableError::Again { line: pose.line, planner: name, goal, field });
        }
        let mut poses = vec![pose];
        while let Some((found, pose)) = self.read_row()? {
            if found != key {
                self.next = Some((found, pose));
                break;
            }
            check_step(&poses[poses.len() - 1], &pose)?;
            // The length is checked while reading, as a file may be one path without end.
            if poses.len() == MAX_POSES {
                return Err(PathTableError::TooManyPoses { line: pose.line });
            }
            poses.push(pose);
        }
        Ok(Some(TablePath { planner, problem, goal, poses }))
    }

    fn read_row(&mut self) -> Result<Option<(PathKey, TablePose)>, PathTableError> {
        if !self.rows.advance()? {
            return Ok(None);
        }
        let line = self.rows.line();
        let mut cells: [&[u8]; COLUMNS.len()] = [b""; COLUMNS.len()];
        let mut found = 0;
        for (place, cell) in self.rows.fields().enumerate() {
            found += 1;
            if let Some(index) = self.places.iter().position(|&column| column == Some(place)) {
                cells[index] = cell;
            }
        }
        // A row with a field too few would shift all later values by a column.
        if found != self.width {
            return Err(PathTableError::Ragged { line, found, expected: self.width });
        }
        let number = |index: usize| {
            let number = self.rows.number(cells[index]);
            number.filter(|number| NUMBERS.contains(number)).ok_or_else(|| PathTableError::Number {
                line,
                column: COLUMNS[index],
                found: shown(cells[index]),
            })
        };
        let pose = Pose::new(number(X)?, number(Y)?, number(HEADING)?);
        let is_reverse = match cells[DIRECTION] {
            b"forward" => false,
            b"reverse" => true,
            other => return Err(PathTableError::Direction { line, found: shown(other) }),
        };
        let problem = if self.places[FIELD].is_some() { problem(self.problems, line, cells[FIELD])? } else { 0 };
        let goals = self.problems[problem].goals.len();
        let goal = self.rows.number(cells[GOAL]).filter(|&goal| goal < goals);
        let goal = goal.ok_or_else(|| PathTableError::Goal {
            line,
            found: shown(cells[GOAL]),
            field: visible_start(&self.problems[problem].name),
            last: goals - 1,
        })?;
        let name = if self.places[PLANNER].is_some() { text(cells[PLANNER]) } else { Cow::Borrowed(NO_NAME) };
        let planner = planner(&mut self.planners, line, &name)?;
        Ok(Some(((planner, problem, goal), TablePose { line, pose, is_reverse })))
    }
}

fn problem(problems: &[Problem], line: u64, cell: &[u8]) -> Result<usize, PathTableError> {
    let name = text(cell);
    problems.iter().position(|problem| problem.name == name).ok_or_else(|| {
        let expected = match problems {
            [only] => visible_start(&only.name),
            [first, .., last] => {
                format!("one of the given fields, {} to {}", visible_start(&first.name), visible_start(&last.name))
            }
            [] => "a field".into(),
        };
        PathTableError::Field { line, found: shown(cell), expected }
    })
}

/// Returns the place of a planner's name in the list, to which a new one is added.
fn planner(planners: &mut Vec<String>, line: u64, name: &str) -> Result<usize, PathTableError> {
    if let Some(existing) = planners.iter().rposition(|planner| planner == name) {
        return Ok(existing);
    }
    if name.is_empty() || name.chars().count() > LONGEST_NAME {
        return Err(PathTableError::Planner { line, found: visible_start(name) });
    }
    if planners.len() == MAX_PLANNERS {
        return Err(PathTableError::TooManyPlanners { line });
    }
    planners.push(name.to_owned());
    Ok(planners.len() - 1)
}

/// Returns the text of a cell: double quotes in it are written twice, and a sign may keep spreadsheets from computing it.
fn text(cell: &[u8]) -> Cow<'_, str> {
    let text = String::from_utf8_lossy(bytes_of_cell(cell));
    if text.contains("\"\"") { text.replace("\"\"", "\"").into() } else { text }
}

/// Returns the beginning of a cell for a message.
fn shown(cell: &[u8]) -> String {
    visible_start(&String::from_utf8_lossy(cell))
}

/// Refuses two poses that nothing can be said to have happened between.
fn check_step(from: &TablePose, to: &TablePose) -> Result<(), PathTableError> {
    let (line, before) = (to.line, from.line);
    let step = to.pose.position() - from.pose.position();
    let metres = step.length();
    if metres > MAX_APART_M + ROUNDING_M {
        return Err(PathTableError::Apart { line, before, metres });
    }
    let turn = ops::wrap_angle(to.pose.heading - from.pose.heading);
    // The chord of an arc points along the mean of the headings at its ends.
    let ahead_m = step.dot(Pose { heading: from.pose.heading + 0.5 * turn, ..from.pose }.direction());
    match to.is_reverse {
        false if ahead_m < -MAX_BACKWARDS_M => {
            Err(PathTableError::WrongSide { line, before, metres: -ahead_m, found: "behind", direction: "forward" })
        }
        true if ahead_m > MAX_BACKWARDS_M => {
            Err(PathTableError::WrongSide { line, before, metres: ahead_m, found: "ahead of", direction: "reverse" })
        }
        _ => Ok(()),
    }
}
