//! Tables of other programs, read row by row: a file of any size, or one that is broken, takes no more memory than a line.
//!
//! Fields are between commas; those in double quotes may hold commas, but no line ends. Blank lines are passed over.

use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use wildfire_base::input_file::{self, InputFile, TextReader};

/// The most bytes of a line.
pub const LONGEST_LINE: usize = 1 << 16;

/// Why a row cannot be read.
#[derive(Debug)]
pub enum RowFault {
    Unreadable(io::Error),
    /// A line of more than [`LONGEST_LINE`] bytes.
    TooLong {
        line: u64,
    },
}

/// The rows of a table, of which one is kept at a time.
pub struct CsvRows {
    source: BufReader<TextReader<InputFile>>,
    row: Vec<u8>,
    line: u64,
}

impl CsvRows {
    /// Opens a file, or stdin.
    pub fn open(path: &Path) -> io::Result<Self> {
        Ok(Self { source: BufReader::new(TextReader::new(input_file::open(path)?)), row: Vec::new(), line: 0 })
    }

    /// Reads the next line that is not blank; says whether there is one.
    pub fn advance(&mut self) -> Result<bool, RowFault> {
        loop {
            self.row.clear();
            let mut limited = self.source.by_ref().take(LONGEST_LINE as u64 + 1);
            if limited.read_until(b'\n', &mut self.row).map_err(RowFault::Unreadable)? == 0 {
                return Ok(false);
            }
            self.line += 1;
            if self.row.len() > LONGEST_LINE {
                return Err(RowFault::TooLong { line: self.line });
            }
            self.row.truncate(self.row.trim_ascii_end().len());
            if !self.row.is_empty() {
                return Ok(true);
            }
        }
    }

    /// Returns the line that was read last, as it is in the file, without its end.
    pub fn row(&self) -> &[u8] {
        &self.row
    }

    /// Returns the places of the fields of that line that are this name.
    pub fn places(&self, name: &str) -> Vec<usize> {
        let named = fields(&self.row).enumerate().filter(|(_, field)| *field == name.as_bytes());
        named.map(|(place, _)| place).collect()
    }

    /// Returns the number of that line; the first is 1.
    pub fn line(&self) -> u64 {
        self.line
    }
}

/// The fields of a row, without spaces and double quotes around them.
pub fn fields(row: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut is_quoted = false;
    let fields = row.split(move |&byte| {
        is_quoted ^= byte == b'"';
        byte == b',' && !is_quoted
    });
    fields.map(|field| {
        let field = field.trim_ascii();
        field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\"")).unwrap_or(field)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_in_quotes_hold_commas() {
        let found: Vec<&[u8]> = fields(b"1, 2 ,\"a,\"\"b\",,\"3\"").collect();
        assert_eq!(found, [b"1".as_slice(), b"2", b"a,\"\"b", b"", b"3"]);
        assert_eq!(fields(b"\"never closed,1,2").count(), 1);
    }
}
