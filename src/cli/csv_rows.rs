//! Tables of other programs, read row by row: a file of any size, or one that is broken, takes no more memory than a line.
//!
//! Fields are between commas, semicolons or tabs: whichever the header has most of, or what a line `sep=` before it names,
//! as spreadsheets write. Those in double quotes may hold separators, but no line ends. Between semicolons or tabs, numbers
//! may have a decimal comma. Blank lines are passed over.

use std::borrow::Cow;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;
use std::str::FromStr;

use crate::cli::numbers;
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
    /// Known from the header on.
    separator: Option<u8>,
    /// True once a number had a decimal comma.
    has_decimal_commas: bool,
}

/// What may be between fields; of equals the first.
const SEPARATORS: [u8; 3] = [b',', b';', b'\t'];

impl CsvRows {
    /// Opens a file, or stdin.
    pub fn open(path: &Path) -> io::Result<Self> {
        Ok(Self {
            source: BufReader::new(TextReader::new(input_file::open(path)?)),
            row: Vec::new(),
            line: 0,
            separator: None,
            has_decimal_commas: false,
        })
    }

    /// Reads the next line that is not blank; says whether there is one.
    pub fn advance(&mut self) -> Result<bool, RowFault> {
        loop {
            self.row.clear();
            // It reads one byte more than allowed, to distinguish a line of the greatest length from a longer one.
            let mut limited = self.source.by_ref().take(LONGEST_LINE as u64 + 1);
            if limited.read_until(b'\n', &mut self.row).map_err(RowFault::Unreadable)? == 0 {
                return Ok(false);
            }
            self.line += 1;
            if self.row.len() > LONGEST_LINE {
                return Err(RowFault::TooLong { line: self.line });
            }
            // A tab at the end may be before an empty field.
            let last = self.row.iter().rposition(|byte| !b"\r\n ".contains(byte));
            self.row.truncate(last.map_or(0, |last| last + 1));
            if self.row.trim_ascii().is_empty() {
                continue;
            }
            // It is found on the first line that is not blank, as the names of columns hold no numbers with decimal commas.
            if self.separator.is_none() {
                if let Some(named) = named_separator(&self.row) {
                    self.separator = Some(named);
                    continue;
                }
                self.separator = Some(likely_separator(&self.row));
            }
            if self.separator != Some(b'\t') {
                self.row.truncate(self.row.trim_ascii_end().len());
            }
            return Ok(true);
        }
    }

    /// Returns the places of the fields that are this name in the line that was read last.
    pub fn places(&self, name: &str) -> Vec<usize> {
        let named = self.fields().enumerate().filter(|(_, field)| *field == name.as_bytes());
        named.map(|(place, _)| place).collect()
    }

    /// Returns the fields of that line, without spaces and double quotes around them.
    pub fn fields(&self) -> impl Iterator<Item = &[u8]> {
        fields(&self.row, self.separator.unwrap_or(SEPARATORS[0]))
    }

    /// Reads a field of it as a number.
    pub fn number<T: FromStr>(&self, field: &[u8]) -> Option<T> {
        let text = std::str::from_utf8(field).ok()?;
        numbers::parse(&self.with_decimal_point(text))
    }

    /// Returns the text of a number with a point where it may have a comma.
    fn with_decimal_point<'a>(&self, text: &'a str) -> Cow<'a, str> {
        let may_have_comma = self.separator.is_some_and(|separator| separator != b',');
        if may_have_comma && text.contains(',') && !text.contains('.') {
            text.replace(',', ".").into()
        } else {
            text.into()
        }
    }

    /// Writes that line with more fields behind it, in its own notation; `added` has commas between fields, and points.
    pub fn write_with(&mut self, table: &mut impl Write, added: &str) -> io::Result<()> {
        table.write_all(&self.row)?;
        let separator = self.separator.unwrap_or(SEPARATORS[0]);
        if separator == b',' {
            return writeln!(table, ",{added}");
        }
        let has_comma = self.fields().any(|field| field.contains(&b',') && self.number::<f64>(field).is_some());
        self.has_decimal_commas |= has_comma;
        for field in added.split(',') {
            let is_number = field.parse::<f64>().is_ok();
            let field = if is_number && self.has_decimal_commas { field.replace('.', ",") } else { field.to_owned() };
            write!(table, "{}{field}", char::from(separator))?;
        }
        writeln!(table)
    }

    /// Returns the number of that line; the first is 1.
    pub fn line(&self) -> u64 {
        self.line
    }
}

/// Returns the separator that a line `sep=;` names, which spreadsheets write before the header.
fn named_separator(row: &[u8]) -> Option<u8> {
    let (name, separator) = row.split_at_checked(4)?;
    let [separator] = *separator else { return None };
    (name.eq_ignore_ascii_case(b"sep=") && SEPARATORS.contains(&separator)).then_some(separator)
}

fn likely_separator(header: &[u8]) -> u8 {
    SEPARATORS.into_iter().rev().max_by_key(|separator| fields(header, *separator).count()).unwrap_or(SEPARATORS[0])
}

fn fields(row: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
    let mut is_quoted = false;
    let fields = row.split(move |&byte| {
        is_quoted ^= byte == b'"';
        byte == separator && !is_quoted
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
    fn separators_are_those_of_the_header_or_named_before_it() {
        for (header, separator) in
            [("a,b;c,d", b','), ("a;b;\"c,,,d\"", b';'), ("a\tb\tc,d", b'\t'), ("a", b','), ("a,b;c", b',')]
        {
            assert_eq!(likely_separator(header.as_bytes()), separator, "{header}");
        }
        let named = ["sep=;", "SEP=,", "sep=\t", "sep=", "sep=|", "sep=;;", "separator"];
        let found = named.map(|line| named_separator(line.as_bytes()).map(char::from));
        assert_eq!(found, [Some(';'), Some(','), Some('\t'), None, None, None, None]);
    }

    #[test]
    fn fields_in_quotes_hold_commas() {
        let found: Vec<&[u8]> = fields(b"1, 2 ,\"a,\"\"b\",,\"3\"", b',').collect();
        assert_eq!(found, [b"1".as_slice(), b"2", b"a,\"\"b", b"", b"3"]);
        assert_eq!(fields(b"\"never closed,1,2", b',').count(), 1);
    }
}
