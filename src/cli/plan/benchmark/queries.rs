//! The queries of a benchmark, and the table that holds them: a row for each, with the seed and what was swept.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;
use std::sync::Arc;

use crate::batch::{MAX_VARIANTS, Setting, TableError, TableReader, Value};
use crate::cli::error::CliError;
use crate::cli::plan::query::Query;
use crate::cli::plan::tables::Row;
use crate::planning::PlanFailure;
use crate::planning::judge::DriveFigures;
use crate::untrusted::spreadsheet_cell;
use crate::whole_file::WholeFile;

/// The most queries of a benchmark; they are all kept in memory.
pub const MAX_QUERIES: u64 = 1_000_000;

/// The most columns of a table that are taken for keys.
const MAX_KEYS: usize = 100;

/// The most bytes of all different names and values of a table.
const MAX_TEXT_BYTES: usize = 20_000_000;

/// The column of the seed, and those of a query, in their order.
const SEED: &str = "seed";
const COLUMNS: [&str; 13] = [
    "field",
    "goal",
    "planner",
    "success",
    "reason",
    "cpu_build_s",
    "cpu_query_s",
    "length_m",
    "lower_bound_ratio",
    "min_clearance_m",
    "cusps",
    "drive_s",
    "expansions",
];

/// Queries, and what was varied between them.
#[derive(Debug, Default)]
pub struct Queries {
    /// Keys that differ.
    pub keys: Vec<String>,
    /// A value for each key, in the order in which they are first met.
    pub variants: Vec<Vec<Value>>,
    /// Variant by variant, seed by seed, goal by goal, planner by planner.
    pub rows: Vec<Query>,
}

impl Queries {
    /// Names a variant by its values; empty where nothing differs.
    pub fn title(&self, variant: usize) -> String {
        let words = self.keys.iter().zip(&self.variants[variant]).map(|(key, value)| format!("{key} {value}"));
        words.collect::<Vec<_>>().join(", ")
    }

    /// Lists the planners, in the order in which they are first met.
    pub fn planners(&self) -> Vec<Arc<str>> {
        let mut seen = BTreeSet::new();
        self.rows.iter().map(|row| &row.planner).filter(|name| seen.insert(Arc::clone(name))).cloned().collect()
    }

    /// Writes a row for each query; numbers read back as the same `f64`, and no spreadsheet computes a name.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut table = csv::WriterBuilder::new().has_headers(false).from_writer(WholeFile::create(path)?);
        let has_seeds = self.rows.iter().any(|row| row.seed.is_some());
        let keys = self.keys.iter().map(|key| spreadsheet_cell(key));
        let seed = has_seeds.then_some(SEED.into());
        table.write_record(seed.into_iter().chain(keys).chain(COLUMNS.map(Into::into)).map(Cow::into_owned))?;
        let cell = |value: &Value| match value {
            Value::Text(text) => Value::Text(spreadsheet_cell(text).into_owned()),
            other => other.clone(),
        };
        let values: Vec<Vec<Value>> = self.variants.iter().map(|values| values.iter().map(cell).collect()).collect();
        for query in &self.rows {
            let row = Row::from_query(query).in_table();
            match query.seed {
                Some(seed) => table.serialize((seed, &values[query.variant], row))?,
                None => table.serialize((&values[query.variant], row))?,
            }
        }
        table.into_inner().map_err(csv::IntoInnerError::into_error)?.finish()
    }

    /// Reads a table that this program wrote, with or without seeds. Columns that it does not know are keys.
    ///
    /// # Errors
    /// If it is none, holds nothing, or more than is kept in memory.
    pub fn read(path: &Path) -> Result<Self, CliError> {
        Reading::open(path)?.finish()
    }
}

/// A table that is being read.
struct Reading<'a> {
    path: &'a Path,
    reader: TableReader,
    seed: Option<usize>,
    keys: Vec<usize>,
    /// The places of [`COLUMNS`].
    columns: [usize; COLUMNS.len()],
    variants: BTreeMap<Vec<String>, usize>,
    /// Different names, each kept once.
    names: BTreeSet<Arc<str>>,
    text_bytes: usize,
    queries: Queries,
}

impl<'a> Reading<'a> {
    fn open(path: &'a Path) -> Result<Self, CliError> {
        let reader = TableReader::open(path)?;
        let mut columns = [0; COLUMNS.len()];
        for (place, name) in columns.iter_mut().zip(COLUMNS) {
            *place = reader.place(name).ok_or_else(|| {
                let sentence = format!("{}: there is no column `{name}`", path.display());
                CliError::bad_input(sentence, Some("expected a table that `wildfire plan --csv` wrote"))
            })?;
        }
        let seed = reader.place(SEED);
        let is_known = |place: &usize| columns.contains(place) || seed == Some(*place);
        let keys: Vec<usize> = (0..reader.columns().len()).filter(|place| !is_known(place)).collect();
        if keys.len() > MAX_KEYS {
            let sentence = format!("{}: {} columns of keys; expected at most {MAX_KEYS}", path.display(), keys.len());
            return Err(CliError::bad_input(sentence, None));
        }
        let names = keys.iter().map(|&place| reader.columns()[place].clone()).collect();
        let queries = Queries { keys: names, ..Queries::default() };
        let (variants, names) = (BTreeMap::new(), BTreeSet::new());
        Ok(Self { path, reader, seed, keys, columns, variants, names, text_bytes: 0, queries })
    }

    fn finish(mut self) -> Result<Queries, CliError> {
        while self.reader.next_row()? {
            if self.queries.rows.len() as u64 == MAX_QUERIES {
                return Err(self.too_much(&format!("more than {MAX_QUERIES} queries")));
            }
            let row = self.row()?;
            self.queries.rows.push(row);
        }
        if self.queries.rows.is_empty() {
            let sentence = format!("{}: there are no queries in it; expected rows", self.path.display());
            return Err(CliError::bad_input(sentence, None));
        }
        Ok(self.queries)
    }

    fn too_much(&self, what: &str) -> CliError {
        CliError::bad_input(format_args!("{}: {what}; expected fewer", self.path.display()), None)
    }

    fn row(&mut self) -> Result<Query, CliError> {
        let seed = self.seed.map(|place| self.reader.count(place, "a seed")).transpose()?;
        let variant = self.variant()?;
        let [field, goal, planner, success, reason, build, query, length, ratio, clearance, cusps, drive, expansions] =
            self.columns;
        let reader = &self.reader;
        let small = |place: usize| u32::try_from(reader.count(place, "a whole number")?).map_err(|_| self.wrong(place));
        let outcome = match reader.bytes(success) {
            b"true" => Ok(DriveFigures {
                length_m: self.number(length)?,
                lower_bound_ratio: reader.number(ratio)?.map(|_| self.number(ratio)).transpose()?,
                min_clearance_m: self.number(clearance)?,
                cusps: small(cusps)?,
                drive_s: self.number(drive)?,
            }),
            b"false" => {
                let is_it = |known: &PlanFailure| known.to_string().as_bytes() == reader.bytes(reason);
                let known = PlanFailure::ALL.into_iter().find(is_it);
                Err(known.ok_or_else(|| reader.wrong_value(reason, "a reason why there is no path"))?)
            }
            _ => return Err(reader.wrong_value(success, "true or false").into()),
        };
        let (cpu_build_s, cpu_query_s) = (self.number(build)?, self.number(query)?);
        let (goal, expansions) = (small(goal)? as usize, reader.count(expansions, "a whole number")?);
        let (field, planner) = (self.name(field)?, self.name(planner)?);
        Ok(Query { seed, variant, field, goal, planner, cpu_build_s, cpu_query_s, expansions, outcome })
    }

    fn wrong(&self, place: usize) -> TableError {
        self.reader.wrong_value(place, "a smaller number")
    }

    /// Reads a number that is finite and not negative, which all figures are.
    fn number(&self, place: usize) -> Result<f64, TableError> {
        let number = self.reader.number(place)?.filter(|number| number.is_finite() && *number >= 0.0);
        // Zero has no sign.
        number.map(|number| number + 0.0).ok_or_else(|| self.reader.wrong_value(place, "a number from 0 up"))
    }

    /// Reads a name; equal ones are one in memory.
    fn name(&mut self, place: usize) -> Result<Arc<str>, CliError> {
        let name = String::from_utf8_lossy(self.reader.bytes(place));
        if let Some(known) = self.names.get(&*name) {
            return Ok(Arc::clone(known));
        }
        let name: Arc<str> = (*name).into();
        self.hold(name.len())?;
        self.names.insert(Arc::clone(&name));
        Ok(name)
    }

    fn variant(&mut self) -> Result<usize, CliError> {
        let text = |&place: &usize| String::from_utf8_lossy(self.reader.bytes(place)).into_owned();
        let texts: Vec<String> = self.keys.iter().map(text).collect();
        if let Some(&known) = self.variants.get(&texts) {
            return Ok(known);
        }
        let number = self.variants.len();
        if number as u64 == MAX_VARIANTS {
            return Err(
                self.too_much(&format!("more than {MAX_VARIANTS} combinations of {}", self.queries.keys.join(", ")))
            );
        }
        self.hold(texts.iter().map(String::len).sum())?;
        self.queries.variants.push(texts.iter().map(|text| Setting::parse(text).value).collect());
        self.variants.insert(texts, number);
        Ok(number)
    }

    fn hold(&mut self, bytes: usize) -> Result<(), CliError> {
        self.text_bytes += bytes;
        if self.text_bytes > MAX_TEXT_BYTES {
            let sentence = format!("names and values of more than {} MB", MAX_TEXT_BYTES / 1_000_000);
            return Err(self.too_much(&sentence));
        }
        Ok(())
    }
}
