//! A table of drives with seeds and varied keys, and its CSV file.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use crate::drives::query::{CERTIFIED_COLUMN, DRIVE_COLUMNS, DriveColumn, DriveFailure, DriveQuery, QueryCost};
use crate::plan::{MAX_VARIANTS, Setting, Value};
use crate::table::{CsvLines, TableError, TableReader};
use wildfire_base::object::Members;
use wildfire_base::untrusted::visible_start;
use wildfire_base::whole_file::WholeFile;
use wildfire_planning::judge::DriveFigures;

/// The maximum number of queries of a table, which is kept in memory.
pub const MAX_QUERIES: u64 = 1_000_000;

/// The most columns of a table that are taken for keys.
const MAX_KEYS: usize = 100;

/// The most bytes of all different names and values of a table.
const MAX_TEXT_BYTES: usize = 20_000_000;

/// The column of the seed.
const SEED: &str = "seed";

/// The column that older tables lack.
const VIOLATION: &str = "violation";

/// Drives, with the keys that were varied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriveTable {
    /// The keys that differ.
    pub keys: Vec<String>,
    /// A value for each key, in the order of first occurrence.
    pub variants: Vec<Vec<Value>>,
    /// The rows: by variant, then seed, goal and planner.
    pub rows: Vec<DriveQuery>,
}

impl DriveTable {
    /// Creates a table without varied keys.
    pub fn of_one_variant(rows: Vec<DriveQuery>) -> Self {
        Self { keys: Vec::new(), variants: vec![Vec::new()], rows }
    }

    /// Returns a variant's values as its name; empty where nothing varies.
    pub fn title(&self, variant: usize) -> String {
        let values = self.keys.iter().zip(&self.variants[variant]).map(|(key, value)| format!("{key} {value}"));
        values.collect::<Vec<_>>().join(", ")
    }

    /// Lists the planners, in the order of first occurrence.
    pub fn planners(&self) -> Vec<Arc<str>> {
        let mut seen = BTreeSet::new();
        self.rows.iter().map(|row| &row.planner).filter(|name| seen.insert(Arc::clone(name))).cloned().collect()
    }

    /// Returns the columns: that of certified bounds only if a row has one.
    fn columns(&self) -> impl Iterator<Item = DriveColumn> {
        let is_certified = self.rows.iter().any(|row| row.certified_bound_m.is_some());
        DRIVE_COLUMNS.iter().copied().chain(is_certified.then_some(CERTIFIED_COLUMN))
    }

    /// Returns the rows as members of JSON: the seed and the values of the variant if there are any, then the columns.
    pub fn members(&self) -> Vec<impl Serialize> {
        let members = self.rows.iter().map(|query| {
            let seed = query.seed.map(|seed| (SEED.to_owned(), seed.into()));
            let swept = self.keys.iter().cloned().zip(self.variants[query.variant].iter().cloned());
            let of_query = self.columns().map(|column| (column.name.to_owned(), (column.value)(query)));
            Members(seed.into_iter().chain(swept).chain(of_query).collect())
        });
        members.collect()
    }

    /// Writes a row for each query; numbers read back as the same `f64`, and no spreadsheet evaluates a name.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let has_seeds = self.rows.iter().any(|row| row.seed.is_some());
        let mut lines = CsvLines::default();
        let names = has_seeds.then_some(SEED).into_iter().chain(self.keys.iter().map(String::as_str));
        let names = names.chain(self.columns().map(|column| column.name));
        names.for_each(|name| lines.add_field(&Value::Text(name.to_owned())));
        lines.end();
        for query in &self.rows {
            if has_seeds {
                lines.add_field(&query.seed.into());
            }
            self.variants[query.variant].iter().for_each(|value| lines.add_field(value));
            self.columns().for_each(|column| lines.add_field(&(column.value)(query)));
            lines.end();
        }
        // The file appears when it is whole, so an interruption leaves no half table.
        let mut file = WholeFile::create(path)?;
        file.write_all(&lines.into_bytes())?;
        file.finish()
    }

    /// Reads a table that this program wrote, with or without seeds. Unknown columns are keys.
    ///
    /// # Errors
    /// If it is none, holds nothing, or more than is kept in memory.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        TableReading::open(path)?.finish()
    }
}

/// A table that is being read.
struct TableReading<'a> {
    path: &'a Path,
    reader: TableReader,
    seed: Option<usize>,
    keys: Vec<usize>,
    /// The places of [`DRIVE_COLUMNS`]; beyond the row for one that is not there.
    columns: [usize; DRIVE_COLUMNS.len()],
    certified: Option<usize>,
    variants: BTreeMap<Vec<String>, usize>,
    /// Different names, each kept once.
    names: BTreeSet<Arc<str>>,
    text_bytes: usize,
    table: DriveTable,
}

impl<'a> TableReading<'a> {
    fn open(path: &'a Path) -> Result<Self, TableError> {
        let reader = TableReader::open(path)?;
        // No column has this place; it stays where the file lacks one that it may lack.
        let mut columns = [usize::MAX; DRIVE_COLUMNS.len()];
        for (place, column) in columns.iter_mut().zip(DRIVE_COLUMNS) {
            match reader.place(column.name) {
                Some(found) => *place = found,
                // Tables that older versions wrote have no violations.
                None if column.name == VIOLATION => {}
                None => {
                    let expected = "expected a table that `wildfire plan --csv` or `wildfire judge --csv` wrote";
                    return Err(unfit(path, format!("there is no column `{}`; {expected}", column.name)));
                }
            }
        }
        let seed = reader.place(SEED);
        let certified = reader.place(CERTIFIED_COLUMN.name);
        // A column unknown to the program is a key that was swept: its name is the user's.
        let keys: Vec<usize> = (0..reader.columns().len())
            .filter(|place| !(columns.contains(place) || [seed, certified].contains(&Some(*place))))
            .collect();
        if keys.len() > MAX_KEYS {
            return Err(unfit(path, format!("{} columns of keys; expected at most {MAX_KEYS}", keys.len())));
        }
        let names = keys.iter().map(|&place| reader.columns()[place].clone()).collect();
        let table = DriveTable { keys: names, ..DriveTable::default() };
        let variants = BTreeMap::new();
        let names = BTreeSet::new();
        Ok(Self { path, reader, seed, keys, columns, certified, variants, names, text_bytes: 0, table })
    }

    fn finish(mut self) -> Result<DriveTable, TableError> {
        while self.reader.next_row()? {
            if self.table.rows.len() as u64 == MAX_QUERIES {
                return Err(self.too_much(&format!("more than {MAX_QUERIES} queries")));
            }
            let row = self.row()?;
            self.table.rows.push(row);
        }
        if self.table.rows.is_empty() {
            return Err(unfit(self.path, "it has no queries; expected rows".into()));
        }
        Ok(self.table)
    }

    fn too_much(&self, what: &str) -> TableError {
        unfit(self.path, format!("{what}; expected fewer"))
    }

    fn row(&mut self) -> Result<DriveQuery, TableError> {
        let seed = self.seed.map(|place| self.reader.count(place, "a seed")).transpose()?;
        let variant = self.variant()?;
        let reader = &self.reader;
        let [success, reason, violation] = ["success", "reason", VIOLATION].map(|column| self.place(column));
        let success = match reader.bytes(success) {
            b"true" => true,
            b"false" => false,
            _ => return Err(reader.wrong_value(success, "true or false")),
        };
        let mut violation = self.has_value(violation).then(|| String::from_utf8_lossy(reader.bytes(violation)).into());
        // A drive that is neither a success nor a violation must say why, or it would count as failed for no reason.
        let failure = (!success && violation.is_none() || self.has_value(reason))
            .then(|| {
                let failure = DriveFailure::parse(reader.bytes(reason));
                failure.ok_or_else(|| reader.wrong_value(reason, "a reason for having no path"))
            })
            .transpose()?;
        // A refused path violates nothing: nobody drove it.
        let message = violation.take_if(|_| failure.is_some_and(DriveFailure::is_refusal));
        // A drive whose path breaks the rules has no success, but its path has a length.
        let has_figures = success || self.has_value(self.place("length_m"));
        let figures = has_figures.then(|| self.figures()).transpose()?;
        let cost = self.has_value(self.place("cpu_query_s")).then(|| self.cost()).transpose()?;
        let certified = self.certified.filter(|&place| self.has_value(place));
        let certified_bound_m = certified.map(|place| self.number(place)).transpose()?;
        let goal = self.small_count("goal")? as usize;
        let [field, planner] = ["field", "planner"].map(|column| self.place(column));
        let field = self.name(field)?;
        let planner = self.name(planner)?;
        Ok(DriveQuery {
            seed,
            variant,
            field,
            goal,
            planner,
            cost,
            figures,
            failure,
            violation,
            certified_bound_m,
            message,
        })
    }

    /// Reads a number that is finite and not negative, which all figures are.
    fn number(&self, place: usize) -> Result<f64, TableError> {
        let number = self.reader.number(place)?.filter(|number| number.is_finite() && *number >= 0.0);
        // Zero has no sign.
        number.map(|number| number + 0.0).ok_or_else(|| self.reader.wrong_value(place, "a number from 0 up"))
    }

    /// Place of a column of drives; `usize::MAX` if the table has none.
    fn place(&self, column: &str) -> usize {
        self.columns[drive_column(column)]
    }

    fn has_value(&self, place: usize) -> bool {
        place != usize::MAX && !self.reader.bytes(place).is_empty()
    }

    fn small_count(&self, column: &str) -> Result<u32, TableError> {
        let place = self.place(column);
        let count = self.reader.count(place, "a whole number")?;
        u32::try_from(count).map_err(|_| self.reader.wrong_value(place, "a smaller number"))
    }

    fn figures(&self) -> Result<DriveFigures, TableError> {
        let ratio = self.place("lower_bound_ratio");
        Ok(DriveFigures {
            length_m: self.number(self.place("length_m"))?,
            lower_bound_ratio: self.has_value(ratio).then(|| self.number(ratio)).transpose()?,
            min_clearance_m: self.number(self.place("min_clearance_m"))?,
            cusps: self.small_count("cusps")?,
            drive_s: self.number(self.place("drive_s"))?,
        })
    }

    fn cost(&self) -> Result<QueryCost, TableError> {
        Ok(QueryCost {
            cpu_build_s: self.number(self.place("cpu_build_s"))?,
            cpu_query_s: self.number(self.place("cpu_query_s"))?,
            expansions: self.reader.count(self.place("expansions"), "a whole number")?,
        })
    }

    /// Reads a name; equal ones are one in memory.
    fn name(&mut self, place: usize) -> Result<Arc<str>, TableError> {
        let name = String::from_utf8_lossy(self.reader.bytes(place));
        if let Some(existing) = self.names.get(&*name) {
            return Ok(Arc::clone(existing));
        }
        let name: Arc<str> = (*name).into();
        self.hold(name.len())?;
        self.names.insert(Arc::clone(&name));
        Ok(name)
    }

    fn variant(&mut self) -> Result<usize, TableError> {
        let texts: Vec<String> =
            self.keys.iter().map(|&place| String::from_utf8_lossy(self.reader.bytes(place)).into_owned()).collect();
        if let Some(&existing) = self.variants.get(&texts) {
            return Ok(existing);
        }
        let number = self.variants.len();
        if number as u64 == MAX_VARIANTS {
            let keys = visible_start(&self.table.keys.join(", "));
            return Err(self.too_much(&format!("more than {MAX_VARIANTS} combinations of {keys}")));
        }
        self.hold(texts.iter().map(String::len).sum())?;
        // Numbers become numbers again, so that keys sort by value in charts.
        self.table.variants.push(texts.iter().map(|text| Setting::parse(text).value).collect());
        self.variants.insert(texts, number);
        Ok(number)
    }

    fn hold(&mut self, bytes: usize) -> Result<(), TableError> {
        self.text_bytes += bytes;
        if self.text_bytes > MAX_TEXT_BYTES {
            let sentence = format!("names and values of more than {} MB", MAX_TEXT_BYTES / 1_000_000);
            return Err(self.too_much(&sentence));
        }
        Ok(())
    }
}

/// Returns the place of a column among [`DRIVE_COLUMNS`].
fn drive_column(name: &str) -> usize {
    DRIVE_COLUMNS.iter().position(|column| column.name == name).expect("there is such a column")
}

fn unfit(path: &Path, complaint: String) -> TableError {
    TableError::Unfit { path: path.to_owned(), complaint }
}
