//! Maps written as text: read line by line, with a limit on the length of lines, and assembled into rows of cells.

use std::io::{BufRead, Read};

use crate::Grid;
use crate::map_files::error::{check_size, with_room};
use crate::map_files::{Fault, MAX_CELLS, MAX_SIDE};

/// A wrong cell: its column, what was found there, and what was expected.
pub(super) struct BadCell {
    pub col: usize,
    pub found: String,
    pub expected: &'static str,
}

/// Reads rows to the end of the text; `cells_of` appends the cells of a line.
///
/// All rows have the width of the first one, or are as many and as wide as `declared` (rows, columns). Blank lines may
/// follow the last row. `bytes` is the size of the text, from which the room for the cells is guessed.
pub(super) fn read_rows<R: BufRead>(
    lines: &mut TextLines<R>,
    bytes: u64,
    declared: Option<(usize, usize)>,
    mut cells_of: impl FnMut(&[u8], &mut Vec<bool>) -> Result<(), BadCell>,
) -> Result<Grid<bool>, Fault> {
    let mut map = TextRows { cells: Vec::new(), rows: 0, cols: declared.map(|(_, cols)| cols) };
    let max_rows = declared.map(|(rows, _)| rows);
    let mut blank = false;
    while let Some(line) = lines.next()? {
        if line.is_empty() {
            blank = true;
            continue;
        }
        // Blank lines are allowed at the end, so only the row after one shows that it was in the middle.
        if blank {
            return Err(Fault::Blank { row: map.rows });
        }
        if max_rows == Some(map.rows) {
            return Err(Fault::GoesOn { rows: map.rows });
        }
        // The number of rows is guessed from the first line, before which its width is unknown.
        if map.rows == 0 {
            map.cells = with_room(guessed_cells(line, bytes))?;
        }
        map.push(line, &mut cells_of)?;
    }
    map.finish(declared)
}

/// Guesses how many cells the text holds, which is right if all its lines are like the first one.
fn guessed_cells(line: &[u8], bytes: u64) -> usize {
    let separators = line.iter().filter(|&&byte| matches!(byte, b',' | b';' | b' ' | b'\t')).count();
    let cols = if separators > 0 { separators + 1 } else { line.len() };
    let rows = usize::try_from(bytes).unwrap_or(usize::MAX) / line.len() + 1;
    rows.saturating_mul(cols).min(MAX_CELLS)
}

struct TextRows {
    cells: Vec<bool>,
    rows: usize,
    cols: Option<usize>,
}

impl TextRows {
    fn push(
        &mut self,
        line: &[u8],
        cells_of: &mut impl FnMut(&[u8], &mut Vec<bool>) -> Result<(), BadCell>,
    ) -> Result<(), Fault> {
        let row = self.rows;
        if row == MAX_SIDE {
            return Err(Fault::Beyond { row, col: 0 });
        }
        let before = self.cells.len();
        // No format has more cells in a line than bytes.
        self.cells.try_reserve(line.len()).map_err(|_| Fault::Memory { cells: before + line.len() })?;
        cells_of(line, &mut self.cells).map_err(|BadCell { col, found, expected }| Fault::Cell {
            row,
            col,
            found,
            expected: expected.to_owned(),
        })?;
        let found = self.cells.len() - before;
        // Without a declared size the first row decides the width of all.
        let expected = *self.cols.get_or_insert(found);
        if expected > MAX_SIDE {
            return Err(Fault::Beyond { row, col: MAX_SIDE });
        }
        if found != expected {
            return Err(Fault::Ragged { row, found, expected });
        }
        if self.cells.len() > MAX_CELLS {
            return Err(Fault::Beyond { row, col: MAX_CELLS - before });
        }
        self.rows += 1;
        Ok(())
    }

    fn finish(self, declared: Option<(usize, usize)>) -> Result<Grid<bool>, Fault> {
        let Self { cells, rows: found, cols } = self;
        if let Some((rows, cols)) = declared.filter(|&(rows, _)| found < rows) {
            return Err(Fault::Ends { row: found, col: 0, rows, cols });
        }
        let cols = cols.ok_or(Fault::Empty)?;
        check_size(found, cols)?;
        Ok(Grid::from_values(found, cols, cells))
    }
}

/// Longest accepted line in bytes: the widest row of CSV with room for 14 spaces about every value.
const LONGEST_LINE: usize = 16 * MAX_SIDE;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// The lines of a text that are comments, as `numpy.savetxt` writes headers and footers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comments {
    None,
    /// Those before the first row that begin with `# `; a row of `.` and `#` has no spaces.
    BeforeRows,
    /// All that begin with `#`.
    Everywhere,
}

impl Comments {
    fn has(self, line: &[u8]) -> bool {
        match self {
            Self::None => false,
            Self::BeforeRows => line.starts_with(b"# "),
            Self::Everywhere => line.starts_with(b"#"),
        }
    }

    /// Returns the comments of a text.
    pub fn of_text(text: &[u8]) -> Self {
        let of_numbers = Self::Everywhere.first_row(text);
        if of_numbers.first().is_some_and(|&letter| letter.is_ascii_digit() || matches!(letter, b'+' | b'-')) {
            return Self::Everywhere;
        }
        if Self::BeforeRows.has(Self::None.first_row(text)) { Self::BeforeRows } else { Self::None }
    }

    /// Returns the first line of a text that is not such a comment.
    pub fn first_row(self, text: &[u8]) -> &[u8] {
        let mut lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
        lines.find(|line| !self.has(line)).unwrap_or_default()
    }
}

/// The lines of a text, without their ends and without spaces before these.
pub(super) struct TextLines<R> {
    source: R,
    line: Vec<u8>,
    comments: Comments,
    /// The number of the last line that was read, from 1.
    pub number: usize,
}

impl<R: BufRead> TextLines<R> {
    pub fn new(source: R, comments: Comments) -> Self {
        Self { source, line: Vec::new(), comments, number: 0 }
    }

    /// Returns the next line that is no comment; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<&[u8]>, Fault> {
        while self.advance()? {
            let start = if self.number == 1 { without_mark(&self.line).len() } else { self.line.len() };
            let start = self.line.len() - start;
            if self.comments.has(&self.line[start..]) {
                continue;
            }
            // After the first row a `#` is an occupied cell.
            if self.comments == Comments::BeforeRows {
                self.comments = Comments::None;
            }
            return Ok(Some(self.line[start..].trim_ascii_end()));
        }
        Ok(None)
    }

    /// Reads the next line, if there is one.
    fn advance(&mut self) -> Result<bool, Fault> {
        self.line.clear();
        let limit = LONGEST_LINE as u64 + 1;
        if self.source.by_ref().take(limit).read_until(b'\n', &mut self.line)? == 0 {
            return Ok(false);
        }
        self.number += 1;
        if self.line.len() > LONGEST_LINE {
            let message = format!("the line is longer than {LONGEST_LINE} bytes, the limit for a row of a map");
            return Err(Fault::Line { line: self.number, message });
        }
        Ok(true)
    }
}

/// A text without the byte order mark that some editors put at its start.
pub(super) fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text)
}
