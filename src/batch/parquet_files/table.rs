//! A Parquet file of named columns, written some thousand rows at a time.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type};

use crate::batch::disk::{Disk, Whole};
use crate::batch::{BatchError, Value};

/// What a column holds; any value of it may be missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Unsigned, 64 bits.
    Count,
    Real,
    Text,
    Flag,
}

/// A value to be written. A text is cheap to clone.
#[derive(Clone, Debug)]
pub enum Field {
    Missing,
    Count(u64),
    Real(f64),
    Text(ByteArray),
    Flag(bool),
}

impl From<&Value> for Field {
    fn from(value: &Value) -> Self {
        match value {
            Value::Missing => Self::Missing,
            Value::Count(count) => Self::Count(*count),
            Value::Real(number) => Self::Real(*number),
            Value::Text(text) => Self::text(text),
        }
    }
}

impl Field {
    pub fn text(text: &str) -> Self {
        Self::Text(text.into())
    }
}

/// A file that appears when it is finished.
pub struct ParquetTable {
    path: PathBuf,
    writer: SerializedFileWriter<Box<dyn Whole>>,
    columns: Vec<Buffer>,
    rows: usize,
    rows_a_group: usize,
}

/// Rows of a column that are not written yet: levels say which are there.
enum Buffer {
    Count { levels: Vec<i16>, values: Vec<i64> },
    Real { levels: Vec<i16>, values: Vec<f64> },
    Text { levels: Vec<i16>, values: Vec<ByteArray> },
    Flag { levels: Vec<i16>, values: Vec<bool> },
}

impl ParquetTable {
    /// Begins a file; `rows_a_group` rows are held in memory at most.
    pub fn create(
        path: PathBuf,
        disk: &dyn Disk,
        columns: &[(String, Kind)],
        rows_a_group: usize,
    ) -> Result<Self, BatchError> {
        let file = disk.whole_file(&path).map_err(|source| BatchError::unwritable(&path, source))?;
        let properties = properties(columns);
        let writer =
            schema(columns).and_then(|schema| SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)));
        let writer = writer.map_err(|error| unwritable(&path, error))?;
        let columns = columns.iter().map(|(_, kind)| Buffer::of(*kind)).collect();
        Ok(Self { path, writer, columns, rows: 0, rows_a_group })
    }

    /// Takes a row, a field for each column.
    pub fn add(&mut self, fields: impl IntoIterator<Item = Field>) -> Result<(), BatchError> {
        let mut columns = self.columns.iter_mut();
        fields.into_iter().zip(columns.by_ref()).for_each(|(field, column)| column.push(field));
        assert!(columns.next().is_none(), "a row has a field for each column");
        self.rows += 1;
        if self.rows < self.rows_a_group { Ok(()) } else { self.write_group() }
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
        let written = write_columns(&mut self.writer, &mut self.columns);
        written.map_err(|error| unwritable(&self.path, error))
    }
}

/// Looking numbers up in a dictionary costs more than it saves, beside the compression.
fn properties(columns: &[(String, Kind)]) -> WriterProperties {
    let numbers = columns.iter().filter(|(_, kind)| *kind != Kind::Text);
    let builder = WriterProperties::builder().set_compression(Compression::SNAPPY);
    let plain = |builder: WriterPropertiesBuilder, (name, _): &(String, Kind)| {
        builder.set_column_dictionary_enabled(ColumnPath::new(vec![name.clone()]), false)
    };
    numbers.fold(builder, plain).build()
}

fn schema(columns: &[(String, Kind)]) -> Result<Type, ParquetError> {
    let field = |(name, kind): &(String, Kind)| {
        let (physical, logical) = match kind {
            Kind::Count => (Physical::INT64, Some(LogicalType::integer(64, false))),
            Kind::Real => (Physical::DOUBLE, None),
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Flag => (Physical::BOOLEAN, None),
        };
        let field = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
        field.with_logical_type(logical).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("wildfire").with_fields(fields).build()
}

fn write_columns(
    writer: &mut SerializedFileWriter<Box<dyn Whole>>,
    columns: &mut [Buffer],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for column in columns {
        let mut writer = group.next_column()?.expect("the schema has all columns");
        column.write(&mut writer)?;
        writer.close()?;
    }
    group.close().map(drop)
}

impl Buffer {
    fn of(kind: Kind) -> Self {
        match kind {
            Kind::Count => Self::Count { levels: Vec::new(), values: Vec::new() },
            Kind::Real => Self::Real { levels: Vec::new(), values: Vec::new() },
            Kind::Text => Self::Text { levels: Vec::new(), values: Vec::new() },
            Kind::Flag => Self::Flag { levels: Vec::new(), values: Vec::new() },
        }
    }

    fn push(&mut self, field: Field) {
        match (self, field) {
            (Self::Count { levels, values }, Field::Count(count)) => push(levels, values, Some(count.cast_signed())),
            (Self::Real { levels, values }, Field::Real(number)) => push(levels, values, Some(number)),
            (Self::Text { levels, values }, Field::Text(text)) => push(levels, values, Some(text)),
            (Self::Flag { levels, values }, Field::Flag(flag)) => push(levels, values, Some(flag)),
            // A sweep may take 1 and 2.5, or 1 and "none".
            (Self::Real { levels, values }, Field::Count(count)) => push(levels, values, Some(count as f64)),
            (text @ Self::Text { .. }, Field::Count(count)) => text.push(Field::text(&count.to_string())),
            (text @ Self::Text { .. }, Field::Real(number)) => text.push(Field::text(&number.to_string())),
            (column, _) => column.push_missing(),
        }
    }

    fn push_missing(&mut self) {
        let (Self::Count { levels, .. }
        | Self::Real { levels, .. }
        | Self::Text { levels, .. }
        | Self::Flag { levels, .. }) = self;
        levels.push(0);
    }

    /// Writes all rows and forgets them.
    fn write(&mut self, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        match self {
            Self::Count { levels, values } => {
                writer.typed::<Int64Type>().write_batch(values, Some(levels), None)?;
                levels.clear();
                values.clear();
            }
            Self::Real { levels, values } => {
                writer.typed::<DoubleType>().write_batch(values, Some(levels), None)?;
                levels.clear();
                values.clear();
            }
            Self::Text { levels, values } => {
                writer.typed::<ByteArrayType>().write_batch(values, Some(levels), None)?;
                levels.clear();
                values.clear();
            }
            Self::Flag { levels, values } => {
                writer.typed::<BoolType>().write_batch(values, Some(levels), None)?;
                levels.clear();
                values.clear();
            }
        }
        Ok(())
    }
}

fn push<T>(levels: &mut Vec<i16>, values: &mut Vec<T>, value: Option<T>) {
    levels.push(value.is_some().into());
    values.extend(value);
}

fn unwritable(path: &Path, error: ParquetError) -> BatchError {
    let source = match error {
        ParquetError::External(error) => error.downcast().map_or_else(io::Error::other, |error| *error),
        other => io::Error::other(other),
    };
    BatchError::unwritable(path, source)
}
