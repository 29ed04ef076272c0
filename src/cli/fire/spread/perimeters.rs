//! Perimeters of a fire, and those after equal times as GeoJSON: where the front is by then.
//!
//! Fire is in the middle of a cell when it arrives there. Between the middles of two cells its time is taken to be linear, so
//! that a perimeter is a contour line of arrival times; along the sides of cells it would be longer by up to a third, however
//! small cells are. Where fire never comes to the next cell, the perimeter runs along the side between both.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::ground::GroundOnEarth;
use crate::cli::error::CliError;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_grid::map_files::raster::GeoKeys;

/// The most perimeters of a file.
const MAX: f64 = 1000.0;

#[derive(Debug, Args)]
pub struct PerimeterArguments {
    /// Write what has burned by the hour as polygons, in the coordinates of the rasters.
    #[arg(long, value_name = "FILE.geojson")]
    pub perimeters: Option<PathBuf>,
    /// Time between two perimeters.
    #[arg(
        long, value_name = "TIME", default_value = "3600", requires = "perimeters",
        allow_hyphen_values = true, value_parser = super::time_s
    )]
    pub every: f64,
}

impl PerimeterArguments {
    /// Lists the times of the perimeters: after each interval, and at the end.
    pub fn times_s(&self, duration_s: f64) -> Result<Vec<f64>, CliError> {
        if self.perimeters.is_some() && self.every * MAX < duration_s {
            let expected = format!("expected at least {} s, a thousandth of the duration", duration_s / MAX);
            return Err(CliError::bad_input(format!("--every is {} s; {expected}", self.every), None));
        }
        let mut times: Vec<f64> =
            (1..).map(|number| f64::from(number) * self.every).take_while(|&at| at < duration_s).collect();
        times.push(duration_s);
        Ok(times)
    }
}

/// Writes a feature for each time at which something has burned, with the time, the area and the length of the perimeter.
/// `expected` is when fire comes to each cell, after the end too; not a number where it does not.
pub fn write(path: &Path, ground: &GroundOnEarth, expected: &[f64], times_s: &[f64]) -> io::Result<()> {
    let frame = ground.landscape.frame;
    let features = times_s.iter().filter_map(|&time_s| {
        let cells = expected.iter().filter(|arrival| **arrival <= time_s).count();
        let polygons = polygons(frame, expected, time_s);
        let rings = |polygon: &Vec<Ring>| -> Vec<Vec<[f64; 2]>> {
            polygon
                .iter()
                .map(|ring| {
                    ring.iter()
                        // A ring of GeoJSON ends with the point that it begins with.
                        .chain(ring.first())
                        .map(|&[x, y]| {
                            [ground.place.west_m + frame.cell_m * x, ground.place.south_m + frame.cell_m * y]
                        })
                        .collect()
                })
                .collect()
        };
        (cells > 0).then(|| {
            json!({
                "type": "Feature",
                "properties": {
                    "time_s": time_s,
                    "area_ha": cells as f64 * frame.cell_m * frame.cell_m / 10_000.0,
                    "perimeter_m": frame.cell_m * length(&polygons),
                },
                "geometry": {"type": "MultiPolygon", "coordinates": polygons.iter().map(rings).collect::<Vec<_>>()},
            })
        })
    });
    let mut collection = json!({"type": "FeatureCollection", "features": features.collect::<Vec<Value>>()});
    // Without this member of an older GeoJSON, readers take all coordinates for degrees.
    if let Some(epsg) = ground.place.crs.as_ref().and_then(GeoKeys::epsg) {
        let name = format!("urn:ogc:def:crs:EPSG::{epsg}");
        collection["crs"] = json!({"type": "name", "properties": {"name": name}});
    }
    fs::write(path, collection.to_string())
}

/// Returns the length of the perimeter at a time in metres.
pub fn perimeter_m(frame: FieldFrame, expected: &[f64], time_s: f64) -> f64 {
    frame.cell_m * length(&polygons(frame, expected, time_s))
}

/// A place in cells from the corner of the field: (0.5, 0.5) is the middle of the first cell.
type RingPoint = [f64; 2];
/// Points at which a border turns, the inside on the left; closed without repeating the first.
type Ring = Vec<RingPoint>;

/// The nearest to a middle, in cells, that a border comes.
const NEAREST: f64 = 1e-6;

fn length(polygons: &[Vec<Ring>]) -> f64 {
    polygons
        .iter()
        .flatten()
        .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)))
        .map(|(a, b)| ((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])).sqrt())
        .sum()
}

/// Twice the area, above 0 of a ring that runs counter-clockwise.
fn doubled_area(ring: &[RingPoint]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum()
}

/// Columns and rows to the cell beside one: east, north, west, south.
const BESIDE: [(i64, i64); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Returns the polygons of the cells that fire has reached at a time: for each group of cells that touch along sides its
/// outer ring, then its holes. No ring meets itself or another one.
fn polygons(frame: FieldFrame, expected: &[f64], time_s: f64) -> Vec<Vec<Ring>> {
    let inside: Vec<bool> = expected.iter().map(|&arrival| arrival <= time_s).collect();
    let groups = groups(frame, &inside);
    let beside = |index: usize, side: usize| {
        let (cols, rows) = BESIDE[side];
        frame.offset(frame.cell(index), cols as i32, rows as i32).map(|cell| frame.index(cell))
    };
    let next_inside = |index: usize, side: usize| beside(index, side).filter(|&near| inside[near]);
    // Between a cell inside and the one on a side of it that is not.
    let mut crossings: BTreeSet<(usize, usize)> = BTreeSet::new();
    for index in (0..inside.len()).filter(|&index| inside[index]) {
        crossings.extend((0..4).filter(|&side| next_inside(index, side).is_none()).map(|side| (index, side)));
    }
    let point = |(index, side): (usize, usize)| {
        let Cell { col, row } = frame.cell(index);
        let other = beside(index, side).map_or(f64::NAN, |near| expected[near]);
        let share = (time_s - expected[index]) / (other - expected[index]);
        // It is never at a middle itself, where two borders would meet in a point.
        let share = if other.is_finite() { share.clamp(NEAREST, 1.0 - NEAREST) } else { 0.5 };
        let (cols, rows) = BESIDE[side];
        [f64::from(col) + 0.5 + share * cols as f64, f64::from(row) + 0.5 + share * rows as f64]
    };
    let mut rings: BTreeMap<usize, Vec<Ring>> = BTreeMap::new();
    while let Some(&first) = crossings.first() {
        let mut ring = Vec::new();
        let mut at = first;
        // Each crossing belongs to one ring, so removing it also finds the end of the ring.
        while crossings.remove(&at) {
            ring.push(point(at));
            let (index, side) = at;
            let left = (side + 1) % 4;
            // Cells that touch at a corner only are not joined.
            at = match next_inside(index, left) {
                None => (index, left),
                Some(ahead) => match next_inside(ahead, side) {
                    None => (ahead, side),
                    Some(around) => (around, (side + 3) % 4),
                },
            };
        }
        rings.entry(groups[first.0].expect("it is inside")).or_default().push(turns(&ring));
    }
    let mut polygons: Vec<Vec<Ring>> = rings.into_values().collect();
    // Outer rings go against the clock and holes with it, which GeoJSON wants in this order.
    polygons.iter_mut().for_each(|rings| rings.sort_by_key(|ring| doubled_area(ring) < 0.0));
    polygons
}

/// Numbers the cells inside by group.
fn groups(frame: FieldFrame, inside: &[bool]) -> Vec<Option<usize>> {
    let mut groups = vec![None; inside.len()];
    for first in (0..inside.len()).filter(|&index| inside[index]) {
        let mut open = vec![first];
        while let Some(index) = open.pop() {
            if groups[index].is_some() || !inside[index] {
                continue;
            }
            groups[index] = Some(first);
            let beside =
                [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|(cols, rows)| frame.offset(frame.cell(index), cols, rows));
            open.extend(beside.into_iter().flatten().map(|cell| frame.index(cell)));
        }
    }
    groups
}

/// Leaves out the points at which a ring goes straight on.
fn turns(ring: &[RingPoint]) -> Ring {
    let count = ring.len();
    let turns = (0..count).filter(|&at| {
        let [before, corner, after] = [count - 1, 0, 1].map(|step| ring[(at + step) % count]);
        let [to, from] = [[corner[0] - before[0], corner[1] - before[1]], [after[0] - corner[0], after[1] - corner[1]]];
        to[0] * from[1] != to[1] * from[0]
    });
    turns.map(|at| ring[at]).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Polygons of a drawing whose first line is the north row.
    fn of(drawing: &[&str]) -> Vec<Vec<Ring>> {
        let frame = FieldFrame { cols: drawing[0].len() as u16, rows: drawing.len() as u16, cell_m: 1.0 };
        let cells = drawing.iter().rev().flat_map(|row| row.bytes());
        let expected: Vec<f64> = cells.map(|byte| if byte == b'#' { 0.0 } else { f64::NAN }).collect();
        polygons(frame, &expected, 1.0)
    }

    #[test]
    fn a_cell_alone_is_cut_at_its_sides_and_a_hole_runs_the_other_way() {
        assert_eq!(of(&["#"]), [[[[1.0, 0.5], [0.5, 1.0], [0.0, 0.5], [0.5, 0.0]]]]);
        let ring = of(&["###", "#.#", "###"]);
        assert_eq!(ring.len(), 1);
        // Squares of 9 cells and of one, of which corners of an eighth of a cell are cut off.
        assert_eq!(ring[0].iter().map(|ring| doubled_area(ring)).collect::<Vec<_>>(), [17.0, -1.0]);
    }

    #[test]
    fn perimeters_are_those_of_ellipses_at_any_size_of_cells() {
        // Three times as long as wide, at an angle; on cells from 1/20 to 1/160 of the length.
        for cells in [20.0, 40.0, 160.0] {
            let side = (1.2 * cells) as u16;
            let frame = FieldFrame { cols: side, rows: side, cell_m: 300.0 / cells };
            let middle = 0.5 * f64::from(side);
            let time = |index: usize| {
                let Cell { col, row } = frame.cell(index);
                let x = f64::from(col) + 0.5 - middle;
                let y = f64::from(row) + 0.5 - middle;
                let [along, across] = [0.8 * x + 0.6 * y, 3.0 * (0.8 * y - 0.6 * x)];
                frame.cell_m * (along * along + across * across).sqrt()
            };
            let times: Vec<f64> = (0..frame.cell_count()).map(time).collect();
            // Ramanujan's second approximation for half axes of 150 and 50 m.
            let h: f64 = 100.0 * 100.0 / (200.0 * 200.0);
            let exact = PI * 200.0 * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()));
            let found = perimeter_m(frame, &times, 150.0);
            assert!((found / exact - 1.0).abs() < 0.4 / cells, "{cells}: {found} m, not {exact} m");
        }
    }

    #[test]
    fn rings_enclose_all_cells_and_none_meets_itself() {
        let drawings: [&[&str]; 7] = [
            &["#.", ".#"],
            &["##..", "#.#.", "###.", "...#"],
            &["####", "#.##", "##.#", "####"],
            &["..#..", ".###.", "##.##", ".###.", "..#.."],
            &["#####", "#...#", "#.#.#", "#...#", "#####"],
            &["##.##", "#.#.#", ".#.#.", "#.#.#", "##.##"],
            &["#####", "##.##", "#.#.#", "##.##", "#####"],
        ];
        for drawing in drawings {
            let polygons = of(drawing);
            let mut points = BTreeSet::new();
            for polygon in &polygons {
                assert!(doubled_area(&polygon[0]) > 0.0, "{polygon:?}");
                assert!(polygon[1..].iter().all(|hole| doubled_area(hole) < 0.0), "{polygon:?}");
                for point in polygon.iter().flatten() {
                    assert!(points.insert(point.map(|x| (2.0 * x) as i64)), "{drawing:?}: {point:?} twice");
                }
            }
            // By rays to the east: the middle of a cell is inside an odd number of rings, that of another an even one.
            for (row, line) in drawing.iter().rev().enumerate() {
                for (col, byte) in line.bytes().enumerate() {
                    let x = col as f64 + 0.5;
                    let y = row as f64 + 0.5 + 1e-3;
                    let crossed =
                        polygons.iter().flatten().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
                    let crossed = crossed.filter(|(a, b)| {
                        (a[1] > y) != (b[1] > y) && a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x
                    });
                    assert_eq!(crossed.count() % 2 == 1, byte == b'#', "{drawing:?}: {col}, {row}");
                }
            }
        }
    }
}
