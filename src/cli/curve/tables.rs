//! Tables of curves as CSV files: lengths and words of many pairs of poses, and poses along a few curves.
//!
//! Numbers are the shortest decimals that read back as the same `f64`.

use std::io::{self, ErrorKind, Write};
use std::ops::RangeInclusive;
use std::path::Path as FilePath;

use thiserror::Error;

use crate::cli::csv_rows::{CsvRows, LONGEST_LINE, RowFault, fields};
use crate::cli::curve::report::{FoundCurve, direction};
use crate::cli::error::CliError;
use crate::cli::numbers;
use crate::geometry::Pose;
use crate::vehicle::{Dubins, Path, ReedsShepp};
use crate::whole_file::WholeFile;

/// The range of coordinates in metres, and of headings in degrees or radians. Within this and the range of turning radii a curve ends
/// within 1e-8 m and 1e-11 turning radii of its goal.
pub const COORDINATES: RangeInclusive<f64> = -1e6..=1e6;

/// Columns that are written after all that are there.
const ADDED: [&str; 4] = ["reeds_shepp_m", "reeds_shepp_word", "dubins_m", "dubins_word"];

/// Writes the rows of a table of pairs, each with the lengths and words of its shortest curves after its own columns,
/// which stay as they are; tells how many rows.
///
/// Numbers are the shortest decimals that read back as the same `f64`. A row is read, written and forgotten before the
/// next.
pub fn write_lengths(input: &FilePath, output: &FilePath, radius_m: f64) -> Result<u64, CliError> {
    let bad = |fault: Fault| CliError::from_input_error(format_args!("{}: {fault}", input.display()), fault.kind());
    let unwritable = |error: io::Error| CliError::unwritable(output, &error);
    let (reeds_shepp, dubins) = (ReedsShepp { radius_m }, Dubins { radius_m });
    let mut pairs = PairTable::open(input, &ADDED).map_err(bad)?;
    let mut table = WholeFile::create(output).map_err(unwritable)?;
    write_row(&mut table, pairs.row(), format_args!("{}", ADDED.join(","))).map_err(unwritable)?;
    let mut rows = 0;
    while let Some((from, to)) = pairs.next().map_err(bad)? {
        let (best, forward) = (reeds_shepp.shortest(from, to), dubins.shortest(from, to));
        let added = format_args!("{},{},{},{}", best.length_m, best.word, forward.length_m, forward.word);
        write_row(&mut table, pairs.row(), added).map_err(unwritable)?;
        rows += 1;
    }
    table.finish().map_err(unwritable)?;
    Ok(rows)
}

fn write_row(table: &mut WholeFile, row: &[u8], added: std::fmt::Arguments) -> io::Result<()> {
    table.write_all(row)?;
    writeln!(table, ",{added}")
}

/// Columns that are read, by their names in the header: metres and radians.
const COLUMNS: [&str; 6] = ["x0", "y0", "th0", "x1", "y1", "th1"];
/// The most characters that are shown of a field that is no number.
const SHOWN: usize = 40;

/// A fault of a table of pairs: a sentence to follow its path. Lines are counted from 1.
#[derive(Debug, Error)]
enum Fault {
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    #[error("the file is empty; expected a header with the columns {}", COLUMNS.join(","))]
    Empty,
    #[error("line {line}: the column {column} is missing; expected a header with {}", COLUMNS.join(","))]
    Missing { line: u64, column: &'static str },
    #[error("line {line}: the column {column} is there twice; expected it once")]
    Twice { line: u64, column: &'static str },
    #[error("line {line}: the column {column} is there already; expected a table without the columns that are added")]
    Taken { line: u64, column: &'static str },
    #[error("line {line}: it is longer than {LONGEST_LINE} bytes; expected a pair of poses")]
    TooLong { line: u64 },
    #[error("line {line}: found {found} columns, expected {expected} as in the header")]
    Ragged { line: u64, found: usize, expected: usize },
    #[error("line {line}, column {column}: found {found:?}, expected a number {}", numbers::range_words(&COORDINATES))]
    Number { line: u64, column: &'static str, found: String },
}

impl Fault {
    /// Returns the kind of error of an input that has this fault.
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable(error) => error.kind(),
            _ => ErrorKind::InvalidData,
        }
    }
}

impl From<RowFault> for Fault {
    fn from(fault: RowFault) -> Self {
        match fault {
            RowFault::Unreadable(error) => Self::Unreadable(error),
            RowFault::TooLong { line } => Self::TooLong { line },
        }
    }
}

/// A table of pairs, of which one row is kept at a time.
struct PairTable {
    rows: CsvRows,
    /// The number of columns of the header.
    width: usize,
    /// The index of each of [`COLUMNS`] in a row.
    places: [usize; COLUMNS.len()],
}

impl PairTable {
    /// Reads the header, which must have all of [`COLUMNS`] and none of `taken`.
    fn open(path: &FilePath, taken: &[&'static str]) -> Result<Self, Fault> {
        let mut table = Self { rows: CsvRows::open(path)?, width: 0, places: [0; COLUMNS.len()] };
        if !table.rows.advance()? {
            return Err(Fault::Empty);
        }
        table.width = fields(table.row()).count();
        let line = table.rows.line();
        if let Some(&column) = taken.iter().find(|column| !table.named(column).is_empty()) {
            return Err(Fault::Taken { line, column });
        }
        for (index, column) in COLUMNS.into_iter().enumerate() {
            table.places[index] = match table.named(column)[..] {
                [place] => place,
                [] => return Err(Fault::Missing { line, column }),
                _ => return Err(Fault::Twice { line, column }),
            };
        }
        Ok(table)
    }

    /// The line that was read last, as it is in the file.
    fn row(&self) -> &[u8] {
        self.rows.row()
    }

    /// The poses of the next row; `None` at the end of the file.
    fn next(&mut self) -> Result<Option<(Pose, Pose)>, Fault> {
        if !self.rows.advance()? {
            return Ok(None);
        }
        let mut numbers = [None; COLUMNS.len()];
        let mut found = 0;
        for (place, field) in fields(self.row()).enumerate() {
            found += 1;
            if let Some(index) = self.places.iter().position(|&column| column == place) {
                numbers[index] = Some(self.number(field, COLUMNS[index])?);
            }
        }
        match numbers {
            [Some(x0), Some(y0), Some(th0), Some(x1), Some(y1), Some(th1)] if found == self.width => {
                Ok(Some((Pose::new(x0, y0, th0), Pose::new(x1, y1, th1))))
            }
            _ => Err(Fault::Ragged { line: self.rows.line(), found, expected: self.width }),
        }
    }

    /// Returns the indices of the columns of that name.
    fn named(&self, column: &str) -> Vec<usize> {
        let names = fields(self.row()).enumerate().filter(|(_, name)| *name == column.as_bytes());
        names.map(|(place, _)| place).collect()
    }

    fn number(&self, field: &[u8], column: &'static str) -> Result<f64, Fault> {
        let number = std::str::from_utf8(field).ok().and_then(numbers::parse);
        number.filter(|number| COORDINATES.contains(number)).ok_or_else(|| Fault::Number {
            line: self.rows.line(),
            column,
            found: String::from_utf8_lossy(field).chars().take(SHOWN).collect(),
        })
    }
}

/// The most rows of a table.
const MOST_ROWS: f64 = 1e6;

/// Refuses steps that would make the table longer than anybody reads.
pub fn check_samples(curves: &[FoundCurve], step_m: f64) -> Result<(), CliError> {
    let rows = curves.iter().map(|curve| curve.length_m / step_m).sum::<f64>();
    if rows <= MOST_ROWS {
        return Ok(());
    }
    let sentence = format!("--step is {step_m} m: the curves have {rows:.0} steps, expected at most {MOST_ROWS}");
    Err(CliError::bad_input(sentence, Some("give a longer --step")))
}

/// Writes `curve,s_m,x_m,y_m,heading_rad,direction`, the samples of [`poses_along`]. Numbers are the shortest decimals that read
/// back as the same `f64`.
pub fn write_samples(path: &FilePath, curves: &[FoundCurve], step_m: f64) -> io::Result<()> {
    let mut table = WholeFile::create(path)?;
    writeln!(table, "curve,s_m,x_m,y_m,heading_rad,direction")?;
    for curve in curves {
        for (driven_m, Pose { x, y, heading }, direction) in poses_along(&curve.path, step_m) {
            writeln!(table, "{},{driven_m},{x},{y},{heading},{direction}", curve.kind)?;
        }
    }
    table.finish()
}

/// Metres driven so far, the pose there, and whether the truck came there `forward` or in `reverse`; of the start, how it
/// leaves. The start, every joint and the end are there, and equal steps of at most `step_m` between them.
pub fn poses_along(path: &Path, step_m: f64) -> impl Iterator<Item = (f64, Pose, &'static str)> {
    let directions = path.segments.iter().map(direction);
    let first = (0.0, path.start, directions.clone().next().unwrap_or("forward"));
    let mut driven_m = 0.0;
    let legs = path.legs().zip(directions).flat_map(move |((start, segment), direction)| {
        let before_m = driven_m;
        driven_m += segment.length_m.abs();
        let leg = Path { start, segments: vec![segment] };
        leg.samples(step_m).skip(1).map(|(s, pose)| (before_m + s, pose, direction)).collect::<Vec<_>>()
    });
    std::iter::once(first).chain(legs)
}
