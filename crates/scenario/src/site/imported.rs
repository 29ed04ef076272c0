//! Given fields: maps as text or as JSON, and what `map_files` reads.
//!
//! A text map has a line per row, first line north, `.` or `0` for a free cell and `#` or `1` for a bush. A JSON map
//! lists its bushes as `cells_cr`, pairs of column and row from the south-west corner, with `n` cells along a side (or
//! `size_m`) and `cell_m`; or it is GeoJSON, whose polygons are bushes. Rows are turned over here and nowhere else: row 0
//! of the simulation is the south edge.

use std::fmt;
use std::ops::Range;

use serde::de::{DeserializeSeed, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use thiserror::Error;

use super::geojson;
use crate::faults::error::MapFault;
use crate::faults::json_location::{character_at, offset};
use crate::faults::path::FieldPath;
use crate::faults::wording::fault_from_message;
use wildfire_base::geometry::FieldFrame;
use wildfire_base::input_file::list_of_at_most;
use wildfire_grid::Grid;
use wildfire_grid::map_files::MapFile;

/// The most cells along a side of a field, generated or given.
pub const MAX_CELLS_A_SIDE: u16 = 4096;

/// A field that a map gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MapRows", into = "MapRows")]
pub struct ImportedField {
    pub frame: FieldFrame,
    /// A value per cell, row 0 at the south edge.
    pub occupied: Grid<bool>,
    /// What of its file may have been misread or was left out, in sentences; a plan of a batch does not keep them.
    pub doubts: Vec<String>,
}

/// A given field as a resolved scenario writes it: rows of `.` and `#`, first row north.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MapRows {
    cell_m: f64,
    #[serde(deserialize_with = "list_of_at_most::<5_000, _, _>")]
    rows: Vec<String>,
}

/// A fault, and the bytes of the map at which it is.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{fault}")]
pub struct MapError {
    pub fault: MapFault,
    pub span: Range<usize>,
}

const TOO_LARGE: MapFault = MapFault::TooLarge { max: MAX_CELLS_A_SIDE };

impl MapFault {
    fn at(self, span: Range<usize>) -> MapError {
        MapError { fault: self, span }
    }
}

impl ImportedField {
    /// Reads a map; a text map's cells have the side `cell_m`, a JSON map's may say their own.
    ///
    /// # Errors
    /// Fails if the map is empty, ragged, too large, or not in one of the two forms; with the place.
    pub fn parse(text: &str, cell_m: f64) -> Result<Self, MapError> {
        // Rows of a map cannot begin with a brace.
        if !text.trim_start().starts_with('{') {
            return parse_rows(text, cell_m);
        }
        if !geojson::is_geojson(text) {
            return parse_json(text, cell_m);
        }
        // The size of a cell decides how many of them the polygons cover, so it is checked first.
        if !(cell_m > 0.0 && cell_m.is_finite()) {
            return Err(MapFault::CellSize { found: cell_m }.at(0..0));
        }
        let field = geojson::parse(text, cell_m, MAX_CELLS_A_SIDE)
            .map_err(|error| json_fault(text, &error, FieldPath::default()))?;
        let (frame, occupied, left_out) = field.map_err(|fault| fault.at(0..0))?;
        Ok(Self {
            frame,
            occupied,
            doubts: (left_out > 0)
                .then(|| format!("Ignored {} of the GeoJSON file: only polygons become bushes.", objects(left_out)))
                .into_iter()
                .collect(),
        })
    }

    /// Takes the cells of a map whose first row is north; their side is the map's own, or `cell_m`.
    ///
    /// # Errors
    /// Fails if the map is too large.
    pub fn from_map_file(map: &MapFile, cell_m: f64) -> Result<Self, MapFault> {
        let rows = map.occupied.rows();
        let cols = map.occupied.cols();
        let frame = frame_from(cols, rows, map.place.map_or(cell_m, |place| place.cell_m))?;
        let cells = (0..rows).rev().flat_map(|row| map.occupied.row(row)).copied().collect();
        // Advice names the keys of scenarios.
        let key = |doubt: String| {
            let doubt = doubt.replace("--tolerance auto", "`field.map_tolerance = \"auto\"`");
            doubt.replace("--tolerance", "`field.map_tolerance`").replace("--invert", "`field.map_invert`")
        };
        let doubts = map.doubts().into_iter().map(key).collect();
        Ok(Self { frame, occupied: Grid::from_values(rows, cols, cells), doubts })
    }

    /// Computes the share of the cells that are bushes.
    pub fn coverage(&self) -> f64 {
        let bushes = self.occupied.values().iter().filter(|&&occupied| occupied).count();
        bushes as f64 / self.frame.cell_count() as f64
    }
}

impl TryFrom<MapRows> for ImportedField {
    type Error = MapError;

    fn try_from(map: MapRows) -> Result<Self, MapError> {
        parse_rows(&map.rows.join("\n"), map.cell_m)
    }
}

impl From<ImportedField> for MapRows {
    fn from(field: ImportedField) -> Self {
        let write_row = |row: &[bool]| row.iter().map(|&occupied| if occupied { '#' } else { '.' }).collect();
        let rows = (0..field.occupied.rows()).rev().map(|row| write_row(field.occupied.row(row))).collect();
        Self { cell_m: field.frame.cell_m, rows }
    }
}

/// Counts what has no inside, in words.
fn objects(count: usize) -> String {
    if count == 1 { "1 point or line".to_owned() } else { format!("{count} points and lines") }
}

fn parse_rows(text: &str, cell_m: f64) -> Result<ImportedField, MapError> {
    let body = text.trim_end();
    let mut cells: Vec<Vec<bool>> = Vec::new();
    let mut start = 0;
    // `lines` would not do: it drops carriage returns, and spans are counted in bytes.
    for line in body.split('\n') {
        let row = parse_row(line, start)?;
        let expected = cells.first().map_or(row.len(), Vec::len);
        let span = start..start + line.trim_end().len();
        if row.is_empty() && cells.is_empty() {
            return Err(MapFault::Empty.at(span));
        }
        // While reading, so that a file of gigabytes is refused early.
        if row.len() > MAX_CELLS_A_SIDE.into() || cells.len() >= MAX_CELLS_A_SIDE.into() {
            return Err(TOO_LARGE.at(span));
        }
        if row.len() != expected {
            return Err(MapFault::Ragged { found: row.len(), expected }.at(span));
        }
        cells.push(row);
        start += line.len() + 1;
    }
    let (rows, cols) = (cells.len(), cells[0].len());
    // Text has north at the top, a field has row 0 in the south.
    let occupied = Grid::from_values(rows, cols, cells.into_iter().rev().flatten().collect());
    let frame = frame_from(cols, rows, cell_m).map_err(|fault| fault.at(0..0))?;
    Ok(ImportedField { frame, occupied, doubts: Vec::new() })
}

fn parse_row(line: &str, start: usize) -> Result<Vec<bool>, MapError> {
    line.trim_end()
        .char_indices()
        .map(|(at, found): (usize, char)| match found {
            '.' | '0' => Ok(false),
            '#' | '1' => Ok(true),
            _ => Err(MapFault::UnknownCharacter { found }.at(start + at..start + at + found.len_utf8())),
        })
        .collect()
}

fn frame_from(cols: usize, rows: usize, cell_m: f64) -> Result<FieldFrame, MapFault> {
    if !(cell_m > 0.0 && cell_m.is_finite()) {
        return Err(MapFault::CellSize { found: cell_m });
    }
    Ok(FieldFrame { cols: side(cols)?, rows: side(rows)?, cell_m })
}

fn side(cells: usize) -> Result<u16, MapFault> {
    u16::try_from(cells).ok().filter(|&side| side <= MAX_CELLS_A_SIDE).ok_or(TOO_LARGE)
}

/// The members of a JSON map that say how large it is.
#[derive(Deserialize)]
struct SizeMembers {
    n: Option<u32>,
    size_m: Option<f64>,
    cell_m: Option<f64>,
}

impl SizeMembers {
    fn frame(&self, cell_m: f64) -> Result<FieldFrame, MapFault> {
        let cell_m = self.cell_m.unwrap_or(cell_m);
        let side = match (self.n, self.size_m) {
            (Some(n), None) => f64::from(n),
            (None, Some(size_m)) => size_m / cell_m,
            (Some(n), Some(size_m)) if f64::from(n) * cell_m == size_m => f64::from(n),
            _ => return Err(MapFault::NoSize),
        };
        if !(side >= 1.0 && side.fract() == 0.0) {
            return Err(MapFault::NoSize);
        }
        frame_from(side as usize, side as usize, cell_m)
    }
}

fn parse_json(text: &str, cell_m: f64) -> Result<ImportedField, MapError> {
    let mut json = serde_json::Deserializer::from_str(text);
    let measures: SizeMembers = serde_path_to_error::deserialize(&mut json)
        .map_err(|error| json_fault(text, error.inner(), FieldPath::from_serde(error.path())))?;
    let located = |error: serde_json::Error| json_fault(text, &error, FieldPath::default());
    json.end().map_err(located)?;
    let frame = measures.frame(cell_m).map_err(|fault| fault.at(0..0))?;
    let mut json = serde_json::Deserializer::from_str(text);
    let occupied = Bushes(frame).deserialize(&mut json).map_err(located)?;
    Ok(ImportedField { frame, occupied, doubts: Vec::new() })
}

/// Turns an error of the JSON reader into a fault; one about a member uses the words of all other values.
pub(crate) fn json_fault(text: &str, error: &serde_json::Error, path: FieldPath) -> MapError {
    let at = offset(text, error.line(), error.column());
    let message = error.to_string();
    let sentence = message.rsplit_once(" at line ").map_or(message.as_str(), |(sentence, _)| sentence);
    let is_of_a_member = error.is_data() && path != FieldPath::default();
    let message =
        if is_of_a_member { fault_from_message(sentence, path).fault.to_string() } else { sentence.to_owned() };
    MapFault::Json { message }.at(character_at(text, at))
}

/// Reads the bushes of a JSON map whose size is known, so that a cell outside is reported at its place in the text.
struct Bushes(FieldFrame);

impl<'de> DeserializeSeed<'de> for Bushes {
    type Value = Grid<bool>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Grid<bool>, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Bushes {
    type Value = Grid<bool>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a map with `cells_cr`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Grid<bool>, A::Error> {
        let mut occupied = None;
        while let Some(key) = map.next_key::<String>()? {
            if key == "cells_cr" {
                occupied = Some(map.next_value_seed(CellList(self.0))?);
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        occupied.ok_or_else(|| A::Error::missing_field("cells_cr"))
    }
}

struct CellList(FieldFrame);

impl<'de> DeserializeSeed<'de> for CellList {
    type Value = Grid<bool>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Grid<bool>, D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for CellList {
    type Value = Grid<bool>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of cells, each a pair of column and row")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Grid<bool>, A::Error> {
        let (cols, rows) = (self.0.cols, self.0.rows);
        let mut occupied = Grid::filled(rows.into(), cols.into(), false);
        while let Some((col, row)) = seq.next_element::<(u16, u16)>()? {
            if col >= cols || row >= rows {
                let message = format!("cell [{col}, {row}] lies outside a field of {cols} x {rows} cells");
                return Err(A::Error::custom(message));
            }
            occupied[(row.into(), col.into())] = true;
        }
        Ok(occupied)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> (MapFault, usize) {
        let error = ImportedField::parse(text, 5.0).expect_err("this map is wrong");
        (error.fault, error.span.start)
    }

    #[test]
    fn the_first_line_is_the_north_edge() {
        let field = ImportedField::parse("##.\n...\r\n#.1\n\n", 4.0).unwrap();
        assert_eq!((field.frame.cols, field.frame.rows, field.frame.cell_m), (3, 3, 4.0));
        assert_eq!(field.occupied.row(2), [true, true, false]);
        assert_eq!(field.occupied.row(0), [true, false, true]);
        assert_eq!(field.coverage(), 4.0 / 9.0);
    }

    #[test]
    fn zeros_and_ones_say_the_same_as_dots_and_hashes() {
        assert_eq!(ImportedField::parse("010\n001", 5.0), ImportedField::parse(".#.\n..#\n", 5.0));
    }

    #[test]
    fn a_json_map_counts_rows_from_the_south() {
        let text =
            r#"{"n": 3, "cell_m": 2, "size_m": 6, "cells_cr": [[0, 0], [2, 1], [0, 0]], "goals": [1, {"a": []}]}"#;
        let json = ImportedField::parse(text, 5.0).unwrap();
        assert_eq!(json, ImportedField::parse("...\n..#\n#..", 2.0).unwrap());
    }

    #[test]
    fn an_imported_field_survives_being_written() {
        let field = ImportedField::parse("#..#\n....\n.##.", 2.5).unwrap();
        let written = serde_json::to_string(&field).unwrap();
        assert_eq!(serde_json::from_str::<ImportedField>(&written).unwrap(), field);
    }

    #[test]
    fn faults_in_text_maps_are_located() {
        assert_eq!(fault(""), (MapFault::Empty, 0));
        assert_eq!(fault("\n \n"), (MapFault::Empty, 0));
        assert_eq!(fault("..#\n..\n..."), (MapFault::Ragged { found: 2, expected: 3 }, 4));
        assert_eq!(fault("..#\n\n..."), (MapFault::Ragged { found: 0, expected: 3 }, 4));
        assert_eq!(fault("..#\n.x."), (MapFault::UnknownCharacter { found: 'x' }, 5));
        assert_eq!(fault("..é"), (MapFault::UnknownCharacter { found: 'é' }, 2));
        assert_eq!(fault(&".".repeat(4097)), (TOO_LARGE, 0));
        assert_eq!(fault(&".\n".repeat(4097)), (TOO_LARGE, 8192));
        assert!(ImportedField::parse(&".\n".repeat(4096), 5.0).is_ok());
    }

    #[test]
    fn faults_in_json_are_located() {
        let (found, at) = fault("{\"n\": 3,\n \"cells_cr\": [[0, 0],\n [3, 1]]}");
        assert!(matches!(&found, MapFault::Json { message } if message.contains("[3, 1] lies outside")), "{found}");
        assert!((31..=38).contains(&at), "the third line is bytes 31 to 39, not {at}");
        let (found, _) = fault("{\"n\": 3}");
        assert!(found.to_string().contains("missing field `cells_cr`"), "{found}");
        let (found, at) = fault("{\"n\": 3,\n \"cells_cr\": [[0, -1]]}");
        assert!(found.to_string().contains("invalid value"), "{found}");
        assert!(at > 9);
        let (found, at) = fault("{\"n\": 2.5, \"cells_cr\": []}");
        assert!(found.to_string().contains("`n` is 2.5; expected a whole number"), "{found}");
        assert!((6..=8).contains(&at), "{at}");
        assert!(matches!(fault("{\"n\": 3, \"cells_cr\": []} 4").0, MapFault::Json { .. }));
        assert_eq!(fault("{\"cells_cr\": []}").0, MapFault::NoSize);
        assert_eq!(fault("{\"n\": 0, \"cells_cr\": []}").0, MapFault::NoSize);
        assert_eq!(fault("{\"n\": 3, \"size_m\": 11, \"cells_cr\": []}").0, MapFault::NoSize);
        assert_eq!(fault("{\"n\": 3, \"cell_m\": -1, \"cells_cr\": []}").0, MapFault::CellSize { found: -1.0 });
        assert_eq!(fault("{\"n\": 4000000000, \"cells_cr\": []}").0, TOO_LARGE);
        assert!(matches!(fault("{\"n\": 3, \"cells_cr\": [").0, MapFault::Json { .. }));
    }
}
