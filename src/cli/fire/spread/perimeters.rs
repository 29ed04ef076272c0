//! Perimeters of a fire after equal times, as GeoJSON: what has burned by then, along the sides of cells.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::ground::Ground;
use crate::cli::error::CliError;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_grid::map_files::raster::GeoKeys;

/// The most perimeters of a file.
const MOST: f64 = 1000.0;

#[derive(Debug, Args)]
pub struct PerimeterArguments {
    /// Write what has burned by the hour as polygons, in the coordinates of the rasters.
    #[arg(help_heading = "Output", long, value_name = "FILE.geojson")]
    pub perimeters: Option<PathBuf>,
    /// Time between two perimeters.
    #[arg(
        help_heading = "Output", long, value_name = "TIME", default_value = "3600", requires = "perimeters",
        allow_hyphen_values = true, value_parser = super::time_s
    )]
    pub every: f64,
}

impl PerimeterArguments {
    /// Lists the times of the perimeters: after each interval, and at the end.
    pub fn times_s(&self, duration_s: f64) -> Result<Vec<f64>, CliError> {
        if self.perimeters.is_some() && self.every * MOST < duration_s {
            let expected = format!("expected at least {} s, a thousandth of the duration", duration_s / MOST);
            return Err(CliError::bad_input(format!("--every is {} s; {expected}", self.every), None));
        }
        let mut times: Vec<f64> =
            (1..).map(|number| f64::from(number) * self.every).take_while(|&at| at < duration_s).collect();
        times.push(duration_s);
        Ok(times)
    }
}

/// Writes a feature for each time at which something has burned, with the time, the area and the length of the perimeter.
pub fn write(path: &Path, ground: &Ground, arrivals: &[f64], times_s: &[f64]) -> io::Result<()> {
    let frame = ground.landscape.frame;
    let features = times_s.iter().filter_map(|&time_s| {
        let burned: Vec<bool> = arrivals.iter().map(|&arrival| arrival <= time_s).collect();
        let cells = burned.iter().filter(|burned| **burned).count();
        let polygons = polygons(frame, &burned);
        let sides: i64 = polygons.iter().flatten().map(|ring| length(ring)).sum();
        let place = |&(col, row): &Corner| {
            [ground.place.west_m + frame.cell_m * col as f64, ground.place.south_m + frame.cell_m * row as f64]
        };
        let rings = |polygon: &Vec<Ring>| -> Vec<Vec<[f64; 2]>> {
            polygon.iter().map(|ring| ring.iter().chain(ring.first()).map(place).collect()).collect()
        };
        (cells > 0).then(|| {
            json!({
                "type": "Feature",
                "properties": {
                    "time_s": time_s,
                    "area_ha": cells as f64 * frame.cell_m * frame.cell_m / 10_000.0,
                    "perimeter_m": sides as f64 * frame.cell_m,
                },
                "geometry": {"type": "MultiPolygon", "coordinates": polygons.iter().map(rings).collect::<Vec<_>>()},
            })
        })
    });
    let mut collection = json!({"type": "FeatureCollection", "features": features.collect::<Vec<Value>>()});
    if let Some(epsg) = ground.place.crs.as_ref().and_then(GeoKeys::epsg) {
        let name = format!("urn:ogc:def:crs:EPSG::{epsg}");
        collection["crs"] = json!({"type": "name", "properties": {"name": name}});
    }
    fs::write(path, collection.to_string())
}

/// A corner of cells: column and row.
type Corner = (i64, i64);
/// Corners at which a border turns, the inside on the left; closed without repeating the first.
type Ring = Vec<Corner>;

fn length(ring: &[Corner]) -> i64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| (a.0 - b.0).abs() + (a.1 - b.1).abs()).sum()
}

/// Twice the area, above 0 of a ring that runs counter-clockwise.
fn doubled_area(ring: &[Corner]) -> i64 {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum()
}

/// Returns the polygons of the cells inside: for each group of cells that touch along sides its outer ring, then its holes.
///
/// No ring meets itself: one that comes to a corner again, where two cells touch there only, is two.
fn polygons(frame: FieldFrame, inside: &[bool]) -> Vec<Vec<Ring>> {
    let groups = groups(frame, inside);
    let group = |col: i64, row: i64| {
        let is_on = (0..i64::from(frame.cols)).contains(&col) && (0..i64::from(frame.rows)).contains(&row);
        if is_on { groups[(row * i64::from(frame.cols) + col) as usize] } else { None }
    };
    // Sides with the inside on the left, by the corner at which they begin: where they lead, and of which group they are.
    let mut sides: BTreeMap<Corner, Vec<(Corner, usize)>> = BTreeMap::new();
    for (index, own) in groups.iter().enumerate() {
        let Some(own) = *own else { continue };
        let Cell { col, row } = frame.cell(index);
        let (c, r) = (i64::from(col), i64::from(row));
        for (beside, from, to) in [
            ((c, r - 1), (c, r), (c + 1, r)),
            ((c + 1, r), (c + 1, r), (c + 1, r + 1)),
            ((c, r + 1), (c + 1, r + 1), (c, r + 1)),
            ((c - 1, r), (c, r + 1), (c, r)),
        ] {
            if group(beside.0, beside.1).is_none() {
                sides.entry(from).or_default().push((to, own));
            }
        }
    }
    let mut rings: BTreeMap<usize, Vec<Ring>> = BTreeMap::new();
    while let Some((&first, _)) = sides.first_key_value() {
        let mut trail: Vec<Corner> = vec![first];
        while let Some(&at) = trail.last() {
            let Some(leaving) = sides.get_mut(&at) else { break };
            // Where two sides lead on, the one to the left belongs to the same cell.
            let left = trail.iter().rev().nth(1).map(|before| (at.0 - (at.1 - before.1), at.1 + (at.0 - before.0)));
            let place = leaving.iter().position(|(to, _)| Some(*to) == left).unwrap_or(0);
            let (to, group) = leaving.swap_remove(place);
            if leaving.is_empty() {
                sides.remove(&at);
            }
            if let Some(start) = trail.iter().position(|&corner| corner == to) {
                rings.entry(group).or_default().push(turns(&trail[start..]));
                trail.truncate(start + 1);
            } else {
                trail.push(to);
            }
        }
    }
    let mut polygons: Vec<Vec<Ring>> = rings.into_values().collect();
    polygons.iter_mut().for_each(|rings| rings.sort_by_key(|ring| doubled_area(ring) < 0));
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

/// Leaves out the corners at which a closed trail goes straight on.
fn turns(trail: &[Corner]) -> Ring {
    let count = trail.len();
    let is_turn = |&at: &usize| {
        let [before, own, after] = [count - 1, 0, 1].map(|step| trail[(at + step) % count]);
        (own.0 - before.0, own.1 - before.1) != (after.0 - own.0, after.1 - own.1)
    };
    (0..count).filter(is_turn).map(|at| trail[at]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polygons of a drawing whose first line is the north row.
    fn of(drawing: &[&str]) -> Vec<Vec<Ring>> {
        let frame = FieldFrame { cols: drawing[0].len() as u16, rows: drawing.len() as u16, cell_m: 1.0 };
        let inside: Vec<bool> = drawing.iter().rev().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
        polygons(frame, &inside)
    }

    #[test]
    fn a_cell_is_a_square_and_a_hole_runs_the_other_way() {
        assert_eq!(of(&["#"]), [[[(0, 0), (1, 0), (1, 1), (0, 1)]]]);
        let ring = of(&["###", "#.#", "###"]);
        assert_eq!(ring.len(), 1);
        assert_eq!(ring[0].iter().map(|ring| doubled_area(ring)).collect::<Vec<_>>(), [18, -2]);
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
            let cells = drawing.iter().flat_map(|row| row.bytes()).filter(|&byte| byte == b'#').count() as i64;
            let polygons = of(drawing);
            let doubled: i64 = polygons.iter().flatten().map(|ring| doubled_area(ring)).sum();
            assert_eq!(doubled, 2 * cells, "{drawing:?}: {polygons:?}");
            for polygon in &polygons {
                assert!(doubled_area(&polygon[0]) > 0, "{polygon:?}");
                assert!(polygon[1..].iter().all(|hole| doubled_area(hole) < 0), "{polygon:?}");
                for ring in polygon {
                    let mut corners = ring.clone();
                    corners.sort_unstable();
                    corners.dedup();
                    assert_eq!(corners.len(), ring.len(), "{ring:?}");
                }
            }
        }
    }
}
