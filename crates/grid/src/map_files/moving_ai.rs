//! Maps of the Moving AI benchmarks.
//!
//! Source: Nathan R. Sturtevant, "Benchmarks for Grid-Based Pathfinding", IEEE Transactions on Computational Intelligence
//! and AI in Games 4(2), 2012, section II, "Map format": a header of lines `type octile`, `height ROWS`,
//! `width COLUMNS`, `map`, then the rows, one letter a cell.

use std::io::BufRead;

use crate::Grid;
use crate::map_files::Fault;
use crate::map_files::error::{check_size, shown_letter};
use crate::map_files::rows::{BadCell, Comments, TextLines, read_rows};

/// Reads a Moving AI map and says what it made of swamp and water.
///
/// `.` and `G` are free, every other letter is occupied. That holds for `S` (swamp) and `W` (water) too, which some
/// games let units enter: a cell is free here or it is not.
pub(super) fn read(source: impl BufRead, bytes: u64) -> Result<(Grid<bool>, Option<String>), Fault> {
    let mut lines = TextLines::new(source, Comments::None);
    let size = read_header(&mut lines)?;
    let mut wet_cells = 0;
    let occupied = read_rows(&mut lines, bytes, Some(size), |line, cells| {
        if let Some(col) = line.iter().position(|byte| !byte.is_ascii_graphic()) {
            return Err(BadCell { col, found: shown_letter(&line[col..]), expected: "a letter of a Moving AI map" });
        }
        wet_cells += line.iter().filter(|&byte| matches!(byte, b'S' | b'W')).count();
        cells.extend(line.iter().map(|byte| !matches!(byte, b'.' | b'G')));
        Ok(())
    })?;
    let note = (wet_cells > 0).then(|| format!("swamp (S) and water (W) count as occupied (cells: {wet_cells})"));
    Ok((occupied, note))
}

/// (rows, columns) as the header declares them.
fn read_header<R: BufRead>(lines: &mut TextLines<R>) -> Result<(usize, usize), Fault> {
    let (mut rows, mut cols) = (None, None);
    loop {
        let line = lines.next()?.map(|line| String::from_utf8_lossy(line).into_owned());
        let fault = |message| Fault::Line { line: lines.number, message };
        let Some(line) = line else {
            return Err(fault("the file ends before a line `map`".to_owned()));
        };
        let tokens: Vec<&str> = line.split_ascii_whitespace().collect();
        match tokens[..] {
            ["type", _] => {}
            ["height", number] if rows.is_none() => rows = Some(side(number).map_err(fault)?),
            ["width", number] if cols.is_none() => cols = Some(side(number).map_err(fault)?),
            [name @ ("height" | "width"), _] => return Err(fault(format!("`{name}` stands twice; expected it once"))),
            ["map"] => break,
            _ => return Err(fault("expected `type octile`, `height ROWS`, `width COLUMNS` or `map`".to_owned())),
        }
    }
    let missing = |name| Fault::Line { line: lines.number, message: format!("the header has no `{name}`") };
    let size = (rows.ok_or_else(|| missing("height"))?, cols.ok_or_else(|| missing("width"))?);
    check_size(size.0, size.1)?;
    Ok(size)
}

fn side(number: &str) -> Result<usize, String> {
    number.parse().map_err(|_| format!("expected a size in whole cells, found {number:?}"))
}
