//! Reads text line by line, none of them longer than a map's row can be.

use std::io::{BufRead, Read};

use super::Fault;

/// Longest accepted line in bytes: the widest row of CSV with room for 14 spaces about every value.
const LONGEST_LINE: usize = 16 * super::MAX_SIDE;

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// The lines of a text, without their ends and without spaces before these.
pub(super) struct Lines<R> {
    source: R,
    line: Vec<u8>,
    /// Number of the last line that was read, from 1.
    pub number: usize,
}

impl<R: BufRead> Lines<R> {
    pub fn new(source: R) -> Self {
        Self { source, line: Vec::new(), number: 0 }
    }

    /// The next line; `None` at the end of the file.
    pub fn next(&mut self) -> Result<Option<&[u8]>, Fault> {
        self.line.clear();
        let limit = LONGEST_LINE as u64 + 1;
        if self.source.by_ref().take(limit).read_until(b'\n', &mut self.line)? == 0 {
            return Ok(None);
        }
        self.number += 1;
        if self.line.len() > LONGEST_LINE {
            let message = format!("the line is longer than {LONGEST_LINE} bytes; no row of a map is");
            return Err(Fault::Line { line: self.number, message });
        }
        let start = if self.number == 1 { without_mark(&self.line) } else { &self.line };
        Ok(Some(start.trim_ascii_end()))
    }
}

/// A text without the byte order mark that some editors put at its start.
pub(super) fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text)
}
