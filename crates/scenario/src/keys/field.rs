//! The field as a scenario describes it.

use std::borrow::Cow;
use std::fmt;
use std::path::PathBuf;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::faults::check::{Check, TablePath};
use crate::site::imported::{ImportedField, MAX_CELLS_A_SIDE};
use crate::site::tetromino::Shape;
use wildfire_base::geometry::FieldFrame;
use wildfire_base::ranges;
use wildfire_base::ranges::number_text;
use wildfire_grid::map_files::raster::MAX_RASTER_SIDE;
use wildfire_grid::map_files::{Reading, Tolerance};

/// The largest share of a field's cells that pieces may be asked to cover.
pub const MAX_COVERAGE: f64 = 0.40;

/// The share of a piece by which rounding may lower `coverage * cells / 4`.
const ROUNDING_PIECES: f64 = 1e-9;

/// The field: generated tetrominoes, or a given map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Field {
    /// Side of the square field; a whole number of cells. With a map, the longer side of the map.
    pub size_m: f64,
    pub cell_m: f64,
    /// Share of the cells under bushes, reached from below in whole pieces. With a map, the map's own share.
    pub coverage: f64,
    /// Number of pieces, instead of `coverage`.
    pub pieces: Option<u32>,
    /// The shapes of pieces, chosen at random.
    pub shapes: Vec<Shape>,
    pub overlaps: Overlaps,
    /// No bush within this distance of an agent's body centre at its start.
    pub start_clearance_m: f64,
    /// A given field instead of a generated one: text of `.`/`#` or 0/1, first line north; JSON with `cells_cr`; GeoJSON;
    /// an image, CSV, a NumPy array, a Moving AI map, or the YAML file of a ROS map.
    pub map: Option<PathBuf>,
    /// The grey value up to which pixels of a map that is an image are bushes: 50 if it is left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map_tolerance: Option<MapTolerance>,
    /// Invert the map: use an image's negative, or swap free cells and bushes.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub map_invert: bool,
    /// The content of the file at `map`. Loading fills it in, so that a resolved scenario is complete without the file.
    #[serde(rename = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub imported: Option<ImportedField>,
    /// The frame of a landscape's rasters or image. Loading fills it in.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    pub raster_frame: Option<FieldFrame>,
}

impl Default for Field {
    fn default() -> Self {
        Self {
            size_m: 250.0,
            cell_m: 5.0,
            coverage: 0.1,
            pieces: None,
            shapes: Shape::ALL.to_vec(),
            overlaps: Overlaps::Never,
            start_clearance_m: 10.0,
            map: None,
            map_tolerance: None,
            map_invert: false,
            imported: None,
            raster_frame: None,
        }
    }
}

/// The grey value up to which pixels are bushes, from 0 to 255, or `"auto"` for the one that Otsu's method finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapTolerance(pub Tolerance);

impl Serialize for MapTolerance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            Tolerance::Grey(value) => serializer.serialize_u8(value),
            Tolerance::Auto => serializer.serialize_str("auto"),
        }
    }
}

impl<'de> Deserialize<'de> for MapTolerance {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(MapToleranceVisitor)
    }
}

impl JsonSchema for MapTolerance {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "MapTolerance".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "integer", "minimum": 0, "maximum": 255 }, { "const": "auto" }] })
    }
}

struct MapToleranceVisitor;

impl Visitor<'_> for MapToleranceVisitor {
    type Value = MapTolerance;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a whole number from 0 to 255 or \"auto\"")
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<MapTolerance, E> {
        let grey = u8::try_from(number).map_err(|_| E::invalid_value(Unexpected::Signed(number), &self))?;
        Ok(MapTolerance(Tolerance::Grey(grey)))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<MapTolerance, E> {
        let grey = u8::try_from(number).map_err(|_| E::invalid_value(Unexpected::Unsigned(number), &self))?;
        Ok(MapTolerance(Tolerance::Grey(grey)))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<MapTolerance, E> {
        if word == "auto" {
            Ok(MapTolerance(Tolerance::Auto))
        } else {
            Err(E::invalid_value(Unexpected::Str(word), &self))
        }
    }
}

/// Selects what happens where a new piece would cover an old one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Overlaps {
    /// Pieces are placed at random where they cover no earlier piece.
    Never,
    /// Pieces are placed anywhere; covered cells count once.
    Dropped,
}

impl Field {
    /// Returns the frame of the field's cells in the world: that of the map or of rasters, or a square of whole cells.
    pub fn frame(&self) -> FieldFrame {
        if let Some(frame) = self.imported.as_ref().map(|imported| imported.frame).or(self.raster_frame) {
            return frame;
        }
        let side = (self.size_m / self.cell_m).round() as u16;
        FieldFrame { cols: side, rows: side, cell_m: self.cell_m }
    }

    /// Returns how the map is read.
    pub(crate) fn reading(&self) -> Reading {
        let tolerance = self.map_tolerance.map_or_else(Tolerance::default, |MapTolerance(tolerance)| tolerance);
        Reading { tolerance, inverted: self.map_invert }
    }

    /// Counts the pieces that a generated field gets: `pieces`, or the most whose cells do not exceed `coverage`.
    pub fn wanted_pieces(&self) -> u32 {
        self.pieces.unwrap_or_else(|| {
            let cells = self.frame().cell_count() as f64;
            (self.coverage * cells / 4.0 + ROUNDING_PIECES).floor() as u32
        })
    }
}

impl Field {
    pub(crate) fn check(&self, table: &TablePath) -> Check {
        table.settings(self, &self.frame())?;
        // A field that was read has its own size and bushes, and no value below applies to it.
        if self.imported.is_some() {
            return Ok(());
        }
        let side = self.size_m / self.cell_m;
        // There is a tolerance, as 0.3 / 0.1 is 2.9999999999999996 in floats.
        let is_whole = (side - side.round()).abs() <= 1e-9 * side;
        let sides_fit = |frame: &FieldFrame| {
            let sides = [frame.cols, frame.rows].map(usize::from);
            sides.iter().all(|side| (1..=MAX_RASTER_SIDE).contains(side)) && frame.cell_m == self.cell_m
        };
        if let Some(frame) = &self.raster_frame {
            if !sides_fit(frame) {
                let expected = format!("1 to {MAX_RASTER_SIDE} cells of {} m a side", self.cell_m);
                return table.refuse("raster_frame", format!("{frame:?}"), expected);
            }
        } else if !(is_whole && (1.0..=f64::from(MAX_CELLS_A_SIDE)).contains(&side.round())) {
            let expected = format!("1 to {MAX_CELLS_A_SIDE} whole cells of {} m", self.cell_m);
            return table.refuse("size_m", number_text(self.size_m), expected);
        }
        table.number("coverage", self.coverage, 0.0..=MAX_COVERAGE)?;
        // A count of pieces has the bound of the coverage, since either may be given.
        let max = (MAX_COVERAGE * self.frame().cell_count() as f64 / 4.0) as usize;
        table.count("pieces", self.pieces.unwrap_or(0) as usize, max)?;
        // A shape that is listed twice would be drawn twice as often.
        let is_repeated = (1..self.shapes.len()).any(|n| self.shapes[..n].contains(&self.shapes[n]));
        if self.shapes.is_empty() || is_repeated {
            let expected = "a list of different shapes, at least one".into();
            return table.refuse("shapes", format!("{:?}", self.shapes), expected);
        }
        Ok(())
    }

    pub(crate) fn describe(&self) -> String {
        let frame = self.frame();
        let size = format!(
            "{} x {} m, {} x {} cells of {} m.",
            frame.width_m(),
            frame.height_m(),
            frame.cols,
            frame.rows,
            frame.cell_m
        );
        if self.map.is_some() {
            return format!("{size} The bushes come from the map, the same for every seed.");
        }
        format!("{size} {} tetrominoes.", self.wanted_pieces())
    }
}

ranges! { Field { cell_m: 0.01..=1000.0, start_clearance_m: 0.0..=1e6 } }

/// Converts a share to percent, rounded to hundredths.
pub(crate) fn percent(share: f64) -> f64 {
    (share * 1e4).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(size_m: f64, coverage: f64) -> u32 {
        Field { size_m, coverage, ..Field::default() }.wanted_pieces()
    }

    #[test]
    fn coverage_is_reached_from_below_in_whole_pieces() {
        assert_eq!(pieces(250.0, 0.1), 62);
        for percent in 0..=40_u32 {
            let covered = pieces(250.0, f64::from(percent) / 100.0) * 4;
            let allowed = percent * 25;
            assert!(covered <= allowed && covered + 4 > allowed, "{percent} % gives {covered} cells of {allowed}");
        }
    }

    #[test]
    fn a_count_of_pieces_overrules_the_coverage() {
        assert_eq!(Field { pieces: Some(7), ..Field::default() }.wanted_pieces(), 7);
    }
}
