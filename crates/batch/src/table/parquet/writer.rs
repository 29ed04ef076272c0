//! A Parquet file of named columns, written a few thousand rows at a time.

use std::io;
use std::iter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type};

use crate::execute::{BatchError, Disk, Whole};
use crate::plan::Value;
use crate::table::column::{FileColumn, Kind};

/// A file that appears when it is complete.
pub struct ParquetWriter {
    path: PathBuf,
    writer: SerializedFileWriter<Box<dyn Whole>>,
    columns: Vec<FileColumn>,
    /// A buffer for each column.
    buffers: Vec<Buffer>,
    rows: usize,
    rows_a_group: usize,
}

/// Rows of a column that are not written yet.
struct Buffer {
    /// 1 for each row that has a value, 0 for each that has none; the format calls them definition levels.
    levels: Vec<i16>,
    values: ColumnValues,
}

/// The values that are there.
enum ColumnValues {
    Whole(Vec<i64>),
    Real(Vec<f64>),
    Text(Vec<ByteArray>),
    Flag(Vec<bool>),
}

impl ParquetWriter {
    /// Begins a file; at most `rows_a_group` rows are held in memory. `metadata` are keys and values of the whole file.
    pub fn create(
        path: PathBuf,
        disk: &dyn Disk,
        columns: Vec<FileColumn>,
        metadata: &[(&str, String)],
        rows_a_group: usize,
    ) -> Result<Self, BatchError> {
        let file = disk.whole_file(&path).map_err(|source| BatchError::unwritable(&path, source))?;
        let properties = properties(&columns, metadata);
        let writer =
            schema(&columns).and_then(|schema| SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)));
        let writer = writer.map_err(|error| unwritable(&path, error))?;
        let buffers = columns.iter().map(|column| Buffer::new(column.kind)).collect();
        Ok(Self { path, writer, columns, buffers, rows: 0, rows_a_group })
    }

    /// Adds a row, with a value for each column.
    ///
    /// # Errors
    /// If a value does not go with its column: it is missing and required, of another kind, or a number that the
    /// column's kind cannot hold. Nothing is ever written as another value.
    pub fn add<'a>(&mut self, values: impl IntoIterator<Item = &'a Value>) -> Result<(), BatchError> {
        let mut columns = self.columns.iter().zip(&mut self.buffers);
        for (value, (column, buffer)) in values.into_iter().zip(columns.by_ref()) {
            if !buffer.push(column, value) {
                return Err(refuse(&self.path, column, value));
            }
        }
        assert!(columns.next().is_none(), "a row has a value for each column");
        self.rows += 1;
        if self.rows < self.rows_a_group { Ok(()) } else { self.write_group() }
    }

    /// Adds rows that begin with the same values, column by column, which is much faster than adding them individually;
    /// `value_of` returns the value of each row in each following column.
    pub fn add_alike<'a>(
        &mut self,
        shared: impl Iterator<Item = &'a Value> + Clone,
        rows: usize,
        value_of: impl Fn(usize, usize) -> Value,
    ) -> Result<(), BatchError> {
        let mut begin = 0;
        while begin < rows {
            // It takes no more rows than the group has room for: its buffers are all that the writer holds in memory.
            let end = rows.min(begin + self.rows_a_group - self.rows);
            let mut columns = self.columns.iter().zip(&mut self.buffers);
            for (value, (column, buffer)) in shared.clone().zip(columns.by_ref()) {
                if !buffer.push_times(column, value, end - begin) {
                    return Err(refuse(&self.path, column, value));
                }
            }
            for (number, (column, buffer)) in columns.enumerate() {
                for row in begin..end {
                    // Values go column by column, so each buffer is written in one go.
                    let value = value_of(row, number);
                    if !buffer.push(column, &value) {
                        return Err(refuse(&self.path, column, &value));
                    }
                }
            }
            self.rows += end - begin;
            begin = end;
            if self.rows == self.rows_a_group {
                self.write_group()?;
            }
        }
        Ok(())
    }

    pub fn finish(mut self) -> Result<(), BatchError> {
        if self.rows > 0 {
            self.write_group()?;
        }
        let file = self.writer.into_inner().map_err(|error| unwritable(&self.path, error))?;
        file.finish().map_err(|source| BatchError::unwritable(&self.path, source))
    }

    fn write_group(&mut self) -> Result<(), BatchError> {
        self.rows = 0;
        let written = write_columns(&mut self.writer, &mut self.buffers);
        written.map_err(|error| unwritable(&self.path, error))
    }
}

fn refuse(path: &Path, column: &FileColumn, value: &Value) -> BatchError {
    let reason = format!("{value:?} is no value of the column `{}`, {:?}", column.name, column.kind);
    BatchError::unwritable(path, io::Error::other(reason))
}

/// Sets compression and metadata. Dictionaries are for text only: of numbers they cost more than they save.
fn properties(columns: &[FileColumn], metadata: &[(&str, String)]) -> WriterProperties {
    let numbers = columns.iter().filter(|column| column.kind != Kind::Text);
    let metadata = metadata.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
    let builder = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(metadata.collect()));
    numbers
        .fold(builder, |builder, column| {
            builder.set_column_dictionary_enabled(ColumnPath::new(vec![column.name.clone().into_owned()]), false)
        })
        .build()
}

fn schema(columns: &[FileColumn]) -> Result<Type, ParquetError> {
    let fields = columns.iter().map(|column| {
        let (physical, logical) = match column.kind {
            Kind::Count => (Physical::INT64, None),
            // The physical type has a sign; the logical one says that these numbers have none.
            Kind::LargeCount => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Kind::Real => (Physical::DOUBLE, None),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Flag => (Physical::BOOLEAN, None),
        };
        let repetition = if column.is_required { Repetition::REQUIRED } else { Repetition::OPTIONAL };
        let field = Type::primitive_type_builder(&column.name, physical).with_repetition(repetition);
        field.with_logical_type(logical).build().map(Arc::new)
    });
    Type::group_type_builder("wildfire").with_fields(fields.collect::<Result<_, _>>()?).build()
}

fn write_columns(
    writer: &mut SerializedFileWriter<Box<dyn Whole>>,
    buffers: &mut [Buffer],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for buffer in buffers {
        let mut writer = group.next_column()?.expect("the schema has all columns");
        buffer.write(&mut writer)?;
        writer.close()?;
    }
    group.close().map(drop)
}

impl Buffer {
    fn new(kind: Kind) -> Self {
        let values = match kind {
            Kind::Count | Kind::LargeCount => ColumnValues::Whole(Vec::new()),
            Kind::Real => ColumnValues::Real(Vec::new()),
            Kind::Text => ColumnValues::Text(Vec::new()),
            Kind::Flag => ColumnValues::Flag(Vec::new()),
        };
        Self { levels: Vec::new(), values }
    }

    /// Takes a value, unless the column cannot hold it.
    fn push(&mut self, column: &FileColumn, value: &Value) -> bool {
        match (&mut self.values, value) {
            (_, Value::Missing) if column.is_required => return false,
            (_, Value::Missing) => {}
            (ColumnValues::Whole(values), Value::Count(count)) => match (column.kind, i64::try_from(*count)) {
                (_, Ok(count)) => values.push(count),
                // The column says that these are the bits of an unsigned number.
                (Kind::LargeCount, Err(_)) => values.push(count.cast_signed()),
                (_, Err(_)) => return false,
            },
            (ColumnValues::Real(values), Value::Real(number)) => values.push(*number),
            (ColumnValues::Text(values), Value::Text(text)) => values.push(text.as_str().into()),
            (ColumnValues::Flag(values), Value::Flag(flag)) => values.push(*flag),
            // A sweep may take 1 and 2.5, or 1 and "none".
            (ColumnValues::Real(values), Value::Count(count)) => values.push(*count as f64),
            (ColumnValues::Text(values), Value::Count(count)) => values.push(count.to_string().as_str().into()),
            (ColumnValues::Text(values), Value::Real(number)) => values.push(number.to_string().as_str().into()),
            _ => return false,
        }
        // Levels say which rows have a value; the values themselves have no gaps.
        self.levels.push((!matches!(value, Value::Missing)).into());
        true
    }

    /// Takes a value for as many rows, at least one, unless the column cannot hold it.
    fn push_times(&mut self, column: &FileColumn, value: &Value, rows: usize) -> bool {
        if !self.push(column, value) {
            return false;
        }
        let level = *self.levels.last().expect("a value was pushed");
        self.levels.resize(self.levels.len() + rows - 1, level);
        if level == 1 {
            match &mut self.values {
                ColumnValues::Whole(values) => repeat_last(values, rows),
                ColumnValues::Real(values) => repeat_last(values, rows),
                // Equal texts share their letters.
                ColumnValues::Text(values) => repeat_last(values, rows),
                ColumnValues::Flag(values) => repeat_last(values, rows),
            }
        }
        true
    }

    /// Writes all rows and forgets them.
    fn write(&mut self, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        match &mut self.values {
            ColumnValues::Whole(values) => write_values::<Int64Type>(writer, values, &self.levels),
            ColumnValues::Real(values) => write_values::<DoubleType>(writer, values, &self.levels),
            ColumnValues::Text(values) => write_values::<ByteArrayType>(writer, values, &self.levels),
            ColumnValues::Flag(values) => write_values::<BoolType>(writer, values, &self.levels),
        }?;
        self.levels.clear();
        Ok(())
    }
}

/// Makes the last value the last of so many that are the same.
fn repeat_last<T: Clone>(values: &mut Vec<T>, times: usize) {
    let last = values.last().expect("a value was pushed").clone();
    values.extend(iter::repeat_n(last, times - 1));
}

fn write_values<T: DataType>(
    writer: &mut SerializedColumnWriter<'_>,
    values: &mut Vec<T::T>,
    levels: &[i16],
) -> Result<(), ParquetError> {
    writer.typed::<T>().write_batch(values, Some(levels), None)?;
    values.clear();
    Ok(())
}

fn unwritable(path: &Path, error: ParquetError) -> BatchError {
    let source = match error {
        ParquetError::External(error) => error.downcast().map_or_else(io::Error::other, |error| *error),
        other => io::Error::other(other),
    };
    BatchError::unwritable(path, source)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execute::RealDisk;

    fn column(name: &'static str, kind: Kind, is_required: bool) -> FileColumn {
        FileColumn { is_required, ..FileColumn::swept(name, kind) }
    }

    fn refusal(column: FileColumn, value: Value) -> Option<String> {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("a.parquet");
        let mut table = ParquetWriter::create(path, &RealDisk, vec![column], &[], 10).expect("the folder is writable");
        table.add([&value]).err().map(|error| error.to_string())
    }

    #[test]
    fn number_that_a_column_cannot_hold_is_refused_and_never_wraps() {
        let largest = i64::MAX.unsigned_abs();
        for (kind, number, is_taken) in [
            (Kind::Count, largest, true),
            (Kind::Count, largest + 1, false),
            (Kind::LargeCount, largest + 1, true),
            (Kind::LargeCount, u64::MAX, true),
        ] {
            let refusal = refusal(column("seed", kind, true), Value::Count(number));
            assert_eq!(refusal.is_none(), is_taken, "{kind:?} {number}: {refusal:?}");
            let names_it = |message: String| message.contains("`seed`") && message.contains(&number.to_string());
            assert!(refusal.is_none_or(names_it));
            assert_eq!(Kind::holding_up_to(number) == Kind::Count, number <= largest);
        }
    }

    #[test]
    fn rows_that_begin_alike_are_those_that_are_taken_one_by_one() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let columns = || {
            vec![
                column("text", Kind::Text, true),
                column("none", Kind::Real, false),
                column("flag", Kind::Flag, true),
                column("own", Kind::Count, false),
                column("other", Kind::Real, true),
            ]
        };
        let shared = [Value::Text("one".into()), Value::Missing, Value::Flag(true)];
        let value_of = |row: usize, number: usize| match number {
            0 if row.is_multiple_of(3) => Value::Missing,
            0 => Value::Count(row as u64),
            _ => Value::Real(row as f64 / 2.0),
        };
        let write = |name: &str, is_alike: bool| {
            let path = scratch.path().join(name);
            // Groups of seven rows end within those that begin alike.
            let mut table = ParquetWriter::create(path.clone(), &RealDisk, columns(), &[], 7).expect("writable");
            for rows in [0, 1, 6, 25, 3] {
                if is_alike {
                    table.add_alike(shared.iter(), rows, value_of).expect("they are values of their columns");
                } else {
                    for row in 0..rows {
                        let values = [value_of(row, 0), value_of(row, 1)];
                        table.add(shared.iter().chain(&values)).expect("they are values of their columns");
                    }
                }
            }
            table.finish().expect("writable");
            std::fs::read(path).expect("it was just written")
        };
        assert!(write("alike.parquet", true) == write("single.parquet", false));
    }

    #[test]
    fn required_column_takes_no_row_without_a_value() {
        assert!(refusal(column("a", Kind::Text, true), Value::Missing).is_some());
        assert!(refusal(column("a", Kind::Text, false), Value::Missing).is_none());
        assert!(refusal(column("a", Kind::Flag, false), Value::Real(1.0)).is_some());
    }
}
