//! The reader of Parquet files that this program wrote, one row group after the other.

use std::fs::File;

use parquet::column::reader::get_typed_column_reader;
use parquet::data_type::{DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};

use crate::execute::panics;

/// The most rows of a group; this program writes some ten thousand.
const MAX_GROUP_ROWS: usize = 1 << 20;

/// A file of rows.
pub struct ParquetReader(SerializedFileReader<File>);

/// A group of rows of a file.
pub struct RowGroup<'a>(Box<dyn RowGroupReader + 'a>);

impl ParquetReader {
    /// Reads an open file by `read`, or describes what is wrong with it.
    pub fn read<T>(file: File, read: impl FnOnce(&Self) -> Result<T, String>) -> Result<T, String> {
        // Damage can make the library panic.
        let caught = panics::catch(|| read(&Self(SerializedFileReader::new(file).map_err(to_message)?)));
        caught.unwrap_or_else(|_| Err("it is damaged".into()))
    }

    pub fn groups(&self) -> impl Iterator<Item = Result<RowGroup<'_>, String>> {
        (0..self.0.num_row_groups()).map(|index| Ok(RowGroup(self.0.get_row_group(index).map_err(to_message)?)))
    }
}

impl RowGroup<'_> {
    /// Returns the integers in a column, none of which may be missing or negative.
    pub fn counts(&self, column: &str) -> Result<Vec<u64>, String> {
        let counts = self.values::<Int64Type>(column)?.into_iter().map(u64::try_from);
        counts.collect::<Result<_, _>>().map_err(|_| format!("a value of `{column}` is below zero"))
    }

    /// Returns the numbers in a column, none of which may be missing.
    pub fn numbers(&self, column: &str) -> Result<Vec<f64>, String> {
        self.values::<DoubleType>(column)
    }

    fn values<T: DataType>(&self, name: &str) -> Result<Vec<T::T>, String> {
        let schema = self.0.metadata().schema_descr();
        let index = (0..schema.num_columns()).find(|&index| {
            let column = schema.column(index);
            column.name() == name && column.physical_type() == T::get_physical_type()
        });
        let index = index.ok_or_else(|| format!("it has no column `{name}` of the expected kind"))?;
        // A damaged file may claim any number of rows.
        let rows = usize::try_from(self.0.metadata().num_rows()).ok().filter(|&rows| rows <= MAX_GROUP_ROWS);
        let rows = rows.ok_or("its groups of rows are too large")?;
        let mut reader = get_typed_column_reader::<T>(self.0.get_column_reader(index).map_err(to_message)?);
        let mut levels = Vec::new();
        let mut values = Vec::new();
        reader.read_records(rows, Some(&mut levels), None, &mut values).map_err(to_message)?;
        if values.len() == rows { Ok(values) } else { Err(format!("values of `{name}` are missing")) }
    }
}

fn to_message(error: ParquetError) -> String {
    error.to_string()
}
