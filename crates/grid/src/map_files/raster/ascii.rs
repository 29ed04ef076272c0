//! ESRI ASCII grids.
//!
//! A head of keys and numbers, `ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or `yllcenter`, `cellsize` and
//! perhaps `NODATA_value`, in any order and in upper or lower case; then the values, the north row first, with any
//! whitespace between them: where lines end says nothing. Decimals may have a comma.

use std::borrow::Cow;

use super::crs::Coordinates;
use super::{Raster, RasterFault, check_place, check_size, with_room};
use wildfire_base::untrusted::visible_start;

/// The keys of a head.
const KEYS: [&str; 10] =
    ["ncols", "nrows", "xllcorner", "xllcenter", "yllcorner", "yllcenter", "cellsize", "nodata_value", "dx", "dy"];

const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Returns whether a file begins as grids do: with one of the keys.
pub(super) fn is_start(bytes: &[u8]) -> bool {
    // A file without white space is a single word, and keys are short.
    let word = Tokens::new(bytes).next().map(|word| &word[..word.len().min(16)]);
    word.is_some_and(|word| key_of(word).is_some())
}

pub(super) fn parse(bytes: &[u8], coordinates: Option<Coordinates>) -> Result<Raster, RasterFault> {
    let mut tokens = Tokens::new(bytes);
    let head = AsciiHead::read(&mut tokens)?;
    let rows = head.whole("nrows")?;
    let cols = head.whole("ncols")?;
    check_size(rows, cols)?;
    let (rows, cols) = (rows as usize, cols as usize);
    let cell_m = head.cell_m()?;
    let west_m = head.edge(["xllcorner", "xllcenter"], cell_m)?;
    let south_m = head.edge(["yllcorner", "yllcenter"], cell_m)?;
    check_place([west_m, south_m], [cols, rows], cell_m, coordinates)?;
    let nodata = head.get("nodata_value").map(|value| value.clamp(f32::MIN.into(), f32::MAX.into()) as f32);

    let cells = rows * cols;
    // A value takes at least a digit and what parts it from the next one.
    let max = tokens.left().div_ceil(2);
    if max < cells {
        let at = tokens.count();
        return Err(RasterFault::Ends { row: at / cols, col: at % cols, rows, cols });
    }
    let mut values = with_room(cells)?;
    values.resize(cells, 0.0);
    for index in 0..cells {
        let (row, col) = (index / cols, index % cols);
        let word = tokens.next().ok_or(RasterFault::Ends { row, col, rows, cols })?;
        let value = number(word).ok_or_else(|| RasterFault::Cell { row, col, found: shown(word) })?;
        // The file begins in the north, a raster in the south.
        values[(rows - 1 - row) * cols + col] = value;
    }
    if tokens.next().is_some() {
        return Err(RasterFault::GoesOn { row: rows - 1, col: cols - 1, rows, cols });
    }
    Ok(Raster { rows, cols, west_m, south_m, cell_m, values, nodata, crs: None })
}

/// Returns the text of a number, in which some programs write a comma as their users do.
fn decimal(word: &[u8]) -> Option<Cow<'_, str>> {
    let text = std::str::from_utf8(word).ok()?;
    let has_comma = text.contains(',') && !text.contains('.') && text.matches(',').count() == 1;
    Some(if has_comma { text.replace(',', ".").into() } else { text.into() })
}

/// Reads a value: a finite number, or `nan`, which some programs write where there is none.
fn number(word: &[u8]) -> Option<f32> {
    let text = decimal(word)?;
    let value = text.parse::<f32>().ok()?;
    (value.is_finite() || text.eq_ignore_ascii_case("nan") || text.eq_ignore_ascii_case("-nan")).then_some(value)
}

fn shown(word: &[u8]) -> String {
    format!("`{}`", visible_start(&String::from_utf8_lossy(&word[..word.len().min(256)])))
}

fn key_of(word: &[u8]) -> Option<&'static str> {
    KEYS.into_iter().find(|key| word.eq_ignore_ascii_case(key.as_bytes()))
}

/// The numbers of a head, each with its key.
struct AsciiHead(Vec<(&'static str, f64)>);

impl AsciiHead {
    /// Reads keys and their numbers up to the first word that is a number or `nan`.
    fn read(tokens: &mut Tokens) -> Result<Self, RasterFault> {
        let mut head = Vec::new();
        while let Some(word) = tokens.peek() {
            // No key begins like a number, so the first word that does is the first cell.
            let begins_a_number = word[0].is_ascii_digit() || b"+-.".contains(&word[0]);
            if begins_a_number || word.eq_ignore_ascii_case(b"nan") {
                break;
            }
            let line = tokens.line();
            let wrong = |message: String| Err(RasterFault::Header { line, message });
            let Some(key) = key_of(word) else {
                return wrong(format!("found {}, expected one of {}", shown(word), KEYS.join(", ")));
            };
            if head.iter().any(|(earlier, _)| *earlier == key) {
                return wrong(format!("`{key}` is given twice"));
            }
            tokens.next();
            let Some(word) = tokens.next() else { return wrong(format!("`{key}` has no number")) };
            let number = decimal(word).and_then(|text| text.parse::<f64>().ok());
            // Infinities and `nan` are errors in all keys but this one.
            let is_none = key == "nodata_value" && number.is_some_and(f64::is_nan);
            match number.filter(|number| number.is_finite() || is_none) {
                Some(number) => head.push((key, number)),
                None => return wrong(format!("`{key}` is {}, expected a number", shown(word))),
            }
        }
        Ok(Self(head))
    }

    fn get(&self, key: &str) -> Option<f64> {
        self.0.iter().find(|(found, _)| *found == key).map(|&(_, number)| number)
    }

    fn whole(&self, key: &'static str) -> Result<u64, RasterFault> {
        let number = self.get(key).ok_or(RasterFault::NoKey { key })?;
        if number.fract() == 0.0 && (0.0..=1e15).contains(&number) {
            return Ok(number as u64);
        }
        Err(RasterFault::Header { line: 1, message: format!("`{key}` is {number}, expected a whole number") })
    }

    fn cell_m(&self) -> Result<f64, RasterFault> {
        match (self.get("cellsize"), self.get("dx"), self.get("dy")) {
            (Some(cell_m), None, None) => Ok(cell_m),
            (None, Some(x), Some(y)) if x == y => Ok(x),
            (None, Some(x), Some(y)) => Err(RasterFault::NotSquare { x, y }),
            _ => Err(RasterFault::NoKey { key: "cellsize" }),
        }
    }

    /// Returns the west or south edge, of which the head gives the corner or the centre of the first cell.
    fn edge(&self, [corner, centre]: [&'static str; 2], cell_m: f64) -> Result<f64, RasterFault> {
        match (self.get(corner), self.get(centre)) {
            (Some(edge), None) => Ok(edge),
            (None, Some(centre)) => Ok(centre - 0.5 * cell_m),
            (None, None) => Err(RasterFault::NoKey { key: corner }),
            (Some(_), Some(_)) => {
                Err(RasterFault::Header { line: 1, message: format!("it has both `{corner}` and `{centre}`") })
            }
        }
    }
}

/// The words of a text.
struct Tokens<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes), at: 0 }
    }

    fn skip_space(&mut self) {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    /// Returns the next word without leaving it behind; it is never empty.
    fn peek(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        (end > 0).then(|| &rest[..end])
    }

    fn next(&mut self) -> Option<&'a [u8]> {
        let word = self.peek()?;
        self.at += word.len();
        Some(word)
    }

    /// Counts the bytes that are left.
    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Counts the words that are left.
    fn count(&mut self) -> usize {
        std::iter::from_fn(|| self.next()).count()
    }

    /// Returns the line of the next word, from 1.
    fn line(&self) -> usize {
        1 + self.bytes[..self.at].iter().filter(|&&byte| byte == b'\n').count()
    }
}

pub(super) fn to_text(raster: &Raster) -> String {
    let Raster { rows, cols, west_m, south_m, cell_m, .. } = raster;
    let mut text = format!("ncols {cols}\nnrows {rows}\nxllcorner {west_m}\nyllcorner {south_m}\ncellsize {cell_m}\n");
    if let Some(nodata) = raster.nodata {
        text += &format!("NODATA_value {nodata}\n");
    }
    for row in raster.values.chunks_exact(raster.cols).rev() {
        for (col, value) in row.iter().enumerate() {
            if col > 0 {
                text.push(' ');
            }
            append(*value, &mut text);
        }
        text.push('\n');
    }
    text
}

/// Appends a value in the fewest digits that give it back, with an exponent where it would be long without.
fn append(value: f32, text: &mut String) {
    use std::fmt::Write as _;
    let is_long = value != 0.0 && !(1e-5..1e9).contains(&value.abs()) && value.is_finite();
    let written = if is_long { write!(text, "{value:e}") } else { write!(text, "{value}") };
    written.expect("a text takes what is written to it");
}
