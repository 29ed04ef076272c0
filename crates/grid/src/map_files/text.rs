//! Maps as text: rows of 0 and 1 or of `.` and `#`, and tables of the numbers 0 and 1.
//!
//! 0 and `.` are a free cell, 1 and `#` an occupied one. Lines may end in CR LF, the text may begin with a byte order
//! mark, and some lines may be [`Comments`].

use std::io::BufRead;

use crate::Grid;
use crate::map_files::Fault;
use crate::map_files::error::shown_letter;
use crate::map_files::rows::{BadCell, Comments, TextLines, read_rows};

pub(super) const EXPECTED: &str = "0 (free) or 1 (occupied)";

/// Most letters of a wrong value that an error quotes.
const QUOTED: usize = 20;

/// What stands between the values of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    /// Any number of spaces and tabs.
    Blanks,
}

impl Separator {
    /// Detects a table by its first line; rows of cells have no separators.
    pub fn of_first_line(line: &[u8]) -> Option<Self> {
        let line = line.trim_ascii();
        if line.contains(&b',') {
            Some(Self::Comma)
        } else if line.contains(&b';') {
            Some(Self::Semicolon)
        } else {
            line.iter().any(|&byte| is_blank(byte)).then_some(Self::Blanks)
        }
    }

    fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Blanks => b' ',
        }
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// Reads rows of cells with nothing between them: all of 0 and 1, or all of `.` and `#`.
pub(super) fn read_text(source: impl BufRead, bytes: u64, comments: Comments) -> Result<Grid<bool>, Fault> {
    let mut letters = None;
    read_rows(&mut TextLines::new(source, comments), bytes, None, |line, cells| {
        let letters = letters.get_or_insert_with(|| TextLetters::of_first_line(line));
        text_cells(line, *letters, cells)
    })
}

/// Reads rows of numbers that are 0 or 1, such as `1`, `1.0` or `1e0`; spaces about the values do not matter.
pub(super) fn read_table(source: impl BufRead, bytes: u64, separator: Separator) -> Result<Grid<bool>, Fault> {
    let mut lines = TextLines::new(source, Comments::Everywhere);
    read_rows(&mut lines, bytes, None, |line, cells| table_cells(line, separator, cells))
}

/// The letters of rows of cells.
#[derive(Clone, Copy)]
struct TextLetters {
    free: u8,
    occupied: u8,
    expected: &'static str,
}

impl TextLetters {
    fn of_first_line(line: &[u8]) -> Self {
        match line.first() {
            Some(b'.' | b'#') => Self { free: b'.', occupied: b'#', expected: ". (free) or # (occupied)" },
            _ => Self { free: b'0', occupied: b'1', expected: EXPECTED },
        }
    }
}

fn text_cells(line: &[u8], letters: TextLetters, cells: &mut Vec<bool>) -> Result<(), BadCell> {
    let TextLetters { free, occupied, expected } = letters;
    let is_cell = |byte: u8| (byte == free) | (byte == occupied);
    // No early exit, so that many bytes are looked at in one instruction.
    let all_cells = line.iter().fold(true, |all, &byte| all & is_cell(byte));
    if !all_cells {
        let col = line.iter().position(|&byte| !is_cell(byte)).expect("one is none");
        return Err(BadCell { col, found: shown_letter(&line[col..]), expected });
    }
    cells.extend(line.iter().map(|&byte| byte == occupied));
    Ok(())
}

fn table_cells(line: &[u8], separator: Separator, cells: &mut Vec<bool>) -> Result<(), BadCell> {
    // Without spaces every value is one byte and every other byte stands between them, which is quick to see.
    let between = separator.byte();
    if line.len() % 2 == 1
        && line.chunks(2).all(|pair| pair[0] | 1 == b'1' && pair.get(1).is_none_or(|&byte| byte == between))
    {
        cells.extend(line.iter().step_by(2).map(|&byte| byte == b'1'));
        return Ok(());
    }
    let mut push = |col: usize, field: &[u8]| {
        cells.push(cell(field).ok_or_else(|| BadCell { col, found: quoted(field), expected: EXPECTED })?);
        Ok(())
    };
    match separator {
        Separator::Blanks => {
            let fields = line.split(|&byte| is_blank(byte)).filter(|field| !field.is_empty());
            fields.enumerate().try_for_each(|(col, field)| push(col, field))
        }
        Separator::Comma | Separator::Semicolon => {
            let fields = line.split(|&byte| byte == between).map(<[u8]>::trim_ascii);
            fields.enumerate().try_for_each(|(col, field)| push(col, field))
        }
    }
}

/// The cell that a number stands for: `None` if it is neither 0 nor 1.
fn cell(field: &[u8]) -> Option<bool> {
    match field {
        b"0" => Some(false),
        b"1" => Some(true),
        _ => match str::from_utf8(field).ok()?.parse::<f64>().ok()? {
            0.0 => Some(false),
            1.0 => Some(true),
            _ => None,
        },
    }
}

/// A value in quotes, or the first of its bytes that is no letter to print.
fn quoted(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    let is_strange = |letter: char| letter.is_control() || letter == char::REPLACEMENT_CHARACTER;
    // Up to the first such letter the text has the bytes of the field.
    if let Some((at, _)) = text.char_indices().take(QUOTED).find(|&(_, letter)| is_strange(letter)) {
        return format!("byte 0x{:02X}", field[at]);
    }
    match text.char_indices().nth(QUOTED) {
        None => format!("{text:?}"),
        Some((end, _)) => format!("{:?} and more", &text[..end]),
    }
}
