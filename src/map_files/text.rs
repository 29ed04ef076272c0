//! Maps as text: rows of 0 and 1, with or without commas between them.
//!
//! 0 is a free cell, 1 an occupied one. Lines may end in CR LF, and the text may begin with a byte order mark.

use std::io::BufRead;

use crate::grid::Grid;
use crate::map_files::Fault;
use crate::map_files::error::shown_letter;
use crate::map_files::rows::{BadCell, TextLines, read_rows};

const EXPECTED: &str = "0 (free) or 1 (occupied)";

/// Most letters of a wrong value that an error quotes.
const QUOTED: usize = 20;

/// Reads rows of 0 and 1 with nothing between them.
pub(super) fn read_text(source: impl BufRead, bytes: u64) -> Result<Grid<bool>, Fault> {
    read_rows(&mut TextLines::new(source), bytes, None, text_cells)
}

/// Reads rows of 0 and 1 with commas between them; spaces about the values do not matter.
pub(super) fn read_csv(source: impl BufRead, bytes: u64) -> Result<Grid<bool>, Fault> {
    read_rows(&mut TextLines::new(source), bytes, None, csv_cells)
}

fn text_cells(line: &[u8], cells: &mut Vec<bool>) -> Result<(), BadCell> {
    let is_cell = |byte: u8| byte | 1 == b'1';
    // No early exit, so that many bytes are looked at in one instruction.
    let all_cells = line.iter().fold(true, |all, &byte| all & is_cell(byte));
    if !all_cells {
        let col = line.iter().position(|&byte| !is_cell(byte)).expect("one is none");
        return Err(BadCell { col, found: shown_letter(&line[col..]), expected: EXPECTED });
    }
    cells.extend(line.iter().map(|&byte| byte == b'1'));
    Ok(())
}

fn csv_cells(line: &[u8], cells: &mut Vec<bool>) -> Result<(), BadCell> {
    // Without spaces every value is one byte and every other byte a comma, which is quick to see.
    let is_plain = |pair: &[u8]| pair[0] | 1 == b'1' && pair.get(1).is_none_or(|&byte| byte == b',');
    if line.len() % 2 == 1 && line.chunks(2).all(is_plain) {
        cells.extend(line.iter().step_by(2).map(|&byte| byte == b'1'));
        return Ok(());
    }
    for (col, field) in line.split(|&byte| byte == b',').enumerate() {
        match field.trim_ascii() {
            b"0" => cells.push(false),
            b"1" => cells.push(true),
            other => return Err(BadCell { col, found: quoted(other), expected: EXPECTED }),
        }
    }
    Ok(())
}

fn quoted(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    match text.char_indices().nth(QUOTED) {
        None => format!("{text:?}"),
        Some((end, _)) => format!("{:?} and more", &text[..end]),
    }
}
