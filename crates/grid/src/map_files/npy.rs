//! Maps as NumPy arrays of two dimensions, of 0 (free) and 1 (occupied), in either order of their axes. The numbers may be
//! floats.
//!
//! Source: "NEP 1 - A Simple File Format for NumPy Arrays", format versions 1.0, 2.0 and 3.0.

use std::io::{BufRead, Read};

use crate::Grid;
use crate::map_files::Fault;
use crate::map_files::error::{check_size, with_room};
use wildfire_base::document::number::count;

pub(super) const SIGNATURE: &[u8] = b"\x93NUMPY";

/// Most bytes of the dictionary that describes an array.
const MAX_HEADER: u32 = 1 << 16;

/// Which of 0 and 255 are obstacles, only who made the array knows.
const EXPECTED: &str = "0 (free) or 1 (occupied); `array == 0` or `array > 0` converts it, depending on which value \
    is an obstacle";

/// Reads an array from a file of at least `bytes` bytes.
pub(super) fn read(mut source: impl BufRead, bytes: u64) -> Result<Grid<bool>, Fault> {
    let header = ArrayHeader::read(&mut source)?;
    let ArrayHeader { rows, cols, .. } = header;
    let (lines, length) = if header.is_by_columns { (cols, rows) } else { (rows, cols) };
    // Each value takes a byte or more, so a short file gets no more room than its bytes can fill.
    let mut cells = with_room(usize::try_from(bytes).unwrap_or(usize::MAX).min(rows * cols))?;
    // A line at a time: the raw bytes of a whole array may take eight times the room of its cells.
    let mut line_bytes = Vec::new();
    for line in 0..lines {
        let place = |at| if header.is_by_columns { (at, line) } else { (line, at) };
        line_bytes.clear();
        source.by_ref().take((length * header.size) as u64).read_to_end(&mut line_bytes)?;
        for (at, number) in line_bytes.chunks_exact(header.size).enumerate() {
            let cell = header.cell(number).ok_or_else(|| {
                let (row, col) = place(at);
                Fault::Cell { row, col, found: header.shown(number), expected: EXPECTED.to_owned() }
            })?;
            cells.push(cell);
        }
        let found = line_bytes.len() / header.size;
        if found < length {
            let (row, col) = place(found);
            return Err(Fault::Ends { row, col, rows, cols });
        }
    }
    if !source.fill_buf()?.is_empty() {
        return Err(Fault::GoesOn { rows });
    }
    // Fortran's order has whole columns one after the other, while a grid is row by row.
    if header.is_by_columns {
        let by_columns = Grid::from_values(cols, rows, cells);
        cells = with_room(rows * cols)?;
        cells.extend((0..rows).flat_map(|row| (0..cols).map(move |col| (col, row))).map(|place| by_columns[place]));
    }
    Ok(Grid::from_values(rows, cols, cells))
}

/// The layout of an array: its size, the order of its values, and the bytes of each.
struct ArrayHeader {
    rows: usize,
    cols: usize,
    /// Fortran's order: column after column.
    is_by_columns: bool,
    size: usize,
    is_big_endian: bool,
    kind: NumberKind,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum NumberKind {
    Unsigned,
    Signed,
    Float,
}

impl ArrayHeader {
    fn read(source: &mut impl BufRead) -> Result<Self, Fault> {
        let mut start = [0; 8];
        read_whole(source, &mut start)?;
        // Version 1 has 16 bits for the length of the header, later ones have 32.
        let length = if start[6] == 1 {
            let mut length = [0; 2];
            read_whole(source, &mut length)?;
            u32::from(u16::from_le_bytes(length))
        } else {
            let mut length = [0; 4];
            read_whole(source, &mut length)?;
            u32::from_le_bytes(length)
        };
        if !(1..=3).contains(&start[6]) {
            let found = format!("has format version {}.{}", start[6], start[7]);
            return Err(Fault::Array { found, expected: "version 1.0, 2.0 or 3.0" });
        }
        if length > MAX_HEADER {
            let found = format!("has a header of {length} bytes");
            return Err(Fault::Array { found, expected: "65536 at most" });
        }
        let mut dictionary = vec![0; length as usize];
        read_whole(source, &mut dictionary)?;
        Self::parse(&String::from_utf8_lossy(&dictionary))
    }

    /// Takes the three members of the dictionary, a literal of Python, in any order.
    fn parse(dictionary: &str) -> Result<Self, Fault> {
        let (is_big_endian, kind, size) = value_type(member(dictionary, "descr")?)?;
        let order = member(dictionary, "fortran_order")?;
        let is_by_columns = order.starts_with("True");
        if !is_by_columns && !order.starts_with("False") {
            return Err(no_member("fortran_order"));
        }
        let shape = member(dictionary, "shape")?;
        let inner = shape.strip_prefix('(').and_then(|rest| rest.split_once(')')).ok_or_else(|| no_member("shape"))?.0;
        let sides: Vec<&str> = inner.split(',').map(str::trim).filter(|side| !side.is_empty()).collect();
        let [rows, cols] = sides[..] else {
            let found = format!("has {}", count(sides.len(), "dimension"));
            return Err(Fault::Array { found, expected: "two, rows and columns" });
        };
        let side = |text: &str| text.parse::<usize>().map_err(|_| no_member("shape"));
        let (rows, cols) = (side(rows)?, side(cols)?);
        check_size(rows, cols)?;
        Ok(Self { rows, cols, is_by_columns, size, is_big_endian, kind })
    }

    /// The cell that a number stands for: `None` if it is neither 0 nor 1.
    fn cell(&self, number: &[u8]) -> Option<bool> {
        if self.kind == NumberKind::Float {
            return match self.float(number) {
                0.0 => Some(false),
                1.0 => Some(true),
                _ => None,
            };
        }
        let lowest = if self.is_big_endian { self.size - 1 } else { 0 };
        let is_small = number.iter().enumerate().all(|(at, &byte)| byte == 0 || (at == lowest && byte == 1));
        is_small.then_some(number[lowest] == 1)
    }

    /// The number in decimal.
    fn shown(&self, number: &[u8]) -> String {
        let bits = self.bits(number);
        let spare_bits = 64 - 8 * self.size as u32;
        match self.kind {
            NumberKind::Unsigned => bits.to_string(),
            NumberKind::Signed => ((bits << spare_bits).cast_signed() >> spare_bits).to_string(),
            NumberKind::Float => self.float(number).to_string(),
        }
    }

    fn bits(&self, number: &[u8]) -> u64 {
        if self.is_big_endian { number.iter().fold(0, join) } else { number.iter().rev().fold(0, join) }
    }

    fn float(&self, number: &[u8]) -> f64 {
        let bits = self.bits(number);
        if self.size == 4 { f32::from_bits(bits as u32).into() } else { f64::from_bits(bits) }
    }
}

fn join(sum: u64, byte: &u8) -> u64 {
    sum << 8 | u64::from(*byte)
}

/// Byte order, kind and bytes of a type such as `'<i4'`.
fn value_type(descr: &str) -> Result<(bool, NumberKind, usize), Fault> {
    let quote = descr.chars().next().filter(|quote| matches!(quote, '\'' | '"'));
    let name = quote.and_then(|quote| descr[1..].split_once(quote)).map(|(name, _)| name);
    let unfit = || {
        let shown: String = name.unwrap_or("several members").chars().take(20).collect();
        let found = format!("holds values of type {shown:?}");
        let is_of_strings =
            name.is_some_and(|name| name.trim_start_matches(['<', '>', '|', '=']).starts_with(['U', 'S']));
        let expected = if is_of_strings {
            "bool, integers or floats of 32 or 64 bits: `array.astype(int)` makes numbers of digits"
        } else {
            "bool, integers or floats of 32 or 64 bits: `array.astype(bool)` makes them so"
        };
        Fault::Array { found, expected }
    };
    // Every type that is read has three letters; longer names are texts, dates, records or wide floats.
    let [order, kind, size] = *name.unwrap_or_default().as_bytes() else { return Err(unfit()) };
    let is_big_endian = match order {
        // A single byte has no order, for which numpy writes `|`.
        b'<' | b'|' => false,
        b'>' => true,
        b'=' => cfg!(target_endian = "big"),
        _ => return Err(unfit()),
    };
    let kind = match (kind, size) {
        (b'b', b'1') | (b'u', b'1' | b'2' | b'4' | b'8') => NumberKind::Unsigned,
        (b'i', b'1' | b'2' | b'4' | b'8') => NumberKind::Signed,
        (b'f', b'4' | b'8') => NumberKind::Float,
        _ => return Err(unfit()),
    };
    Ok((is_big_endian, kind, usize::from(size - b'0')))
}

/// The text behind a key of the dictionary.
fn member<'a>(dictionary: &'a str, name: &str) -> Result<&'a str, Fault> {
    let found = ['\'', '"'].iter().find_map(|quote| dictionary.split_once(&format!("{quote}{name}{quote}")));
    let value = found.and_then(|(_, rest)| rest.trim_start().strip_prefix(':'));
    value.map(str::trim_start).ok_or_else(|| no_member(name))
}

fn no_member(name: &str) -> Fault {
    let found = format!("has a header without a proper `{name}`");
    Fault::Array { found, expected: "a dictionary of `descr`, `fortran_order` and `shape`" }
}

fn read_whole(source: &mut impl Read, bytes: &mut [u8]) -> Result<(), Fault> {
    source.read_exact(bytes).map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => {
            Fault::Array { found: "ends within its header".to_owned(), expected: "the whole of it" }
        }
        _ => error.into(),
    })
}
