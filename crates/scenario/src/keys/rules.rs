//! The other rules of a scenario: suppression, scores, and what ignites by itself.

use std::borrow::Cow;
use std::path::PathBuf;

use rand::RngExt;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use crate::faults::check::{Check, TablePath};
use crate::faults::path::PathStep;
use crate::site::layers::{PackedLayer, Weights};
use wildfire_base::geometry::{Cell, FieldFrame, ops};
use wildfire_base::or_none;
use wildfire_base::ranges;
use wildfire_base::rng;

/// The most `[[ignition]]` entries, and the most cells that they name in all.
const MAX_IGNITIONS: usize = 10_000;

/// Rules for extinguishing fires.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Suppression {
    /// From the truck's body centre to the cell's centre, inclusive; `"none"`: no rule of distance.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub reach_m: Option<f64>,
    /// Time that the truck must stand still, without interruption.
    pub dwell_s: f64,
    pub extinguishes: Extinguishes,
}

impl Default for Suppression {
    fn default() -> Self {
        Self { reach_m: Some(10.0), dwell_s: 5.0, extinguishes: Extinguishes::One }
    }
}

ranges! { Suppression { reach_m: 0.0..=1e6, dwell_s: 0.1..=1e6 } }

/// Selects what one stop extinguishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Extinguishes {
    One,
    /// Every burning cell within reach when the dwell ends.
    AllInReach,
}

/// Points per cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Score {
    /// To the Wumpuses, for every cell that catches fire, by spread too.
    pub wumpus_ignited: f64,
    pub wumpus_burned_out: f64,
    pub truck_extinguished: f64,
}

impl Default for Score {
    fn default() -> Self {
        Self { wumpus_ignited: 1.0, wumpus_burned_out: 1.0, truck_extinguished: 2.0 }
    }
}

ranges! { Score { wumpus_ignited: -1e6..=1e6, wumpus_burned_out: -1e6..=1e6, truck_extinguished: -1e6..=1e6 } }

/// Cells that catch fire by themselves at a given time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "IgnitionEntry", into = "IgnitionEntry")]
pub struct Ignition {
    pub at_s: f64,
    /// The time after which it lights again what can burn then, over and over; `None` if it lights once.
    pub every_s: Option<f64>,
    pub cells: IgnitionCells,
}

/// The cells that an [`Ignition`] lights.
#[derive(Clone, Debug, PartialEq)]
pub enum IgnitionCells {
    /// These cells, where they are intact bushes.
    Cells(Vec<Cell>),
    /// This number of bush cells, drawn from the stream `ignition`.
    Random(u32),
    Density(Box<IgnitionDensity>),
    /// All that can burn inside a perimeter.
    Area(Box<IgnitionArea>),
    /// The cells at places in metres, in the coordinates of the landscape's rasters; loading turns them into cells.
    Points(Vec<[f64; 2]>),
}

/// The cells inside the polygons of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct IgnitionArea {
    pub file: PathBuf,
    /// 1 for the cells inside, 0 for others; loading fills it in.
    pub inside: Option<PackedLayer>,
}

impl IgnitionArea {
    /// Says of each cell by index whether it is inside.
    pub fn by_cell(&self, frame: &FieldFrame) -> Vec<bool> {
        let bytes = self.inside.as_ref().and_then(|inside| inside.bytes(frame.cell_count()));
        bytes.map_or_else(|| vec![false; frame.cell_count()], |bytes| bytes.iter().map(|&byte| byte == 1).collect())
    }
}

/// A number of cells, drawn by weights that a raster gives.
#[derive(Clone, Debug, PartialEq)]
pub struct IgnitionDensity {
    pub file: PathBuf,
    pub count: u32,
    /// What the file says; loading fills it in.
    pub weights: Option<Weights>,
}

impl IgnitionDensity {
    /// Returns all cells with a weight in the order in which they are drawn in the run with this seed.
    ///
    /// The least of `-ln(u) / weight` comes first, u being drawn for every cell: each time one of those left, in proportion
    /// to the weights (Efraimidis and Spirakis, "Weighted random sampling with a reservoir", Information Processing Letters
    /// 97, 2006). `number` is that of the entry, which has a stream of its own.
    pub fn order(&self, frame: &FieldFrame, seed: u64, number: usize) -> Vec<Cell> {
        let weights = self.weights.as_ref().and_then(|weights| weights.by_cell(frame)).unwrap_or_default();
        let mut rng = rng::stream(seed, &format!("ignition/density/{number}"));
        // The logarithm is of 1 - u, as u may be 0; cells without a weight draw too, or a weight would shift later draws.
        let keys: Vec<f64> =
            weights.iter().map(|&weight| -ops::ln(1.0 - rng.random::<f64>()) / f64::from(weight)).collect();
        let mut order: Vec<usize> = (0..weights.len()).filter(|&index| weights[index] > 0.0).collect();
        order.sort_by(|&one, &other| keys[one].total_cmp(&keys[other]).then(one.cmp(&other)));
        order.into_iter().map(|index| frame.cell(index)).collect()
    }
}

impl JsonSchema for Ignition {
    fn schema_name() -> Cow<'static, str> {
        "Ignition".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        IgnitionEntry::json_schema(generator)
    }
}

/// An `[[ignition]]` as it is written: flat, so that a wrong value keeps its place.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct IgnitionEntry {
    at_s: f64,
    /// Time after which the ignition repeats, over and over; without it, it lights once.
    #[serde(skip_serializing_if = "Option::is_none")]
    every_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Vec<(u16, u16)>>")]
    cells: Option<Vec<Cell>>,
    /// Places instead of cells, in metres of the landscape's rasters or, without any, of the field.
    #[serde(skip_serializing_if = "Option::is_none")]
    points_m: Option<Vec<[f64; 2]>>,
    /// A GeoJSON file whose polygons burn, in the same coordinates.
    #[serde(skip_serializing_if = "Option::is_none")]
    perimeter: Option<PathBuf>,
    /// The cells inside. Loading fills it in.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    inside: Option<PackedLayer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    random: Option<u32>,
    /// A raster of weights, by which the `random` cells are drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    density: Option<PathBuf>,
    /// What the file at `density` says. Loading fills it in.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(skip)]
    weights: Option<Weights>,
}

impl TryFrom<IgnitionEntry> for Ignition {
    type Error = &'static str;

    fn try_from(entry: IgnitionEntry) -> Result<Self, Self::Error> {
        if let Some(file) = entry.perimeter {
            if entry.cells.is_some() || entry.points_m.is_some() || entry.random.is_some() || entry.density.is_some() {
                return Err("an ignition with `perimeter` lights all inside, and needs no other cells");
            }
            let cells = IgnitionCells::Area(Box::new(IgnitionArea { file, inside: entry.inside }));
            return Ok(Self { at_s: entry.at_s, every_s: entry.every_s, cells });
        }
        let has_others = entry.cells.is_some() || entry.random.is_some() || entry.density.is_some();
        if let Some(points) = entry.points_m.filter(|_| !has_others) {
            return Ok(Self { at_s: entry.at_s, every_s: entry.every_s, cells: IgnitionCells::Points(points) });
        }
        let cells = match (entry.cells, entry.random, entry.density) {
            (Some(cells), None, None) => IgnitionCells::Cells(cells),
            (None, Some(count), None) => IgnitionCells::Random(count),
            (None, Some(count), Some(file)) => {
                IgnitionCells::Density(Box::new(IgnitionDensity { file, count, weights: entry.weights }))
            }
            (None, None, Some(_)) => return Err("`density` also needs `random`, the number of cells that it lights"),
            _ => return Err("an ignition needs one of `cells`, `points_m`, `perimeter` and `random`"),
        };
        Ok(Self { at_s: entry.at_s, every_s: entry.every_s, cells })
    }
}

impl From<Ignition> for IgnitionEntry {
    fn from(ignition: Ignition) -> Self {
        let Ignition { at_s, every_s, .. } = ignition;
        let mut entry = Self {
            at_s,
            every_s,
            cells: None,
            points_m: None,
            perimeter: None,
            inside: None,
            random: None,
            density: None,
            weights: None,
        };
        match ignition.cells {
            IgnitionCells::Cells(cells) => entry.cells = Some(cells),
            IgnitionCells::Random(count) => entry.random = Some(count),
            IgnitionCells::Points(points) => entry.points_m = Some(points),
            IgnitionCells::Area(area) => {
                let IgnitionArea { file, inside } = *area;
                (entry.perimeter, entry.inside) = (Some(file), inside);
            }
            IgnitionCells::Density(density) => {
                let IgnitionDensity { file, count, weights } = *density;
                (entry.random, entry.density, entry.weights) = (Some(count), Some(file), weights);
            }
        }
        entry
    }
}

/// Checks all entries of `[[ignition]]`.
pub(crate) fn check_ignitions(ignitions: &[Ignition], frame: &FieldFrame) -> Check {
    let top = TablePath::named("");
    top.count("ignition", ignitions.len(), MAX_IGNITIONS)?;
    let mut named = 0;
    for (number, ignition) in ignitions.iter().enumerate() {
        let table = TablePath::entry("ignition", number);
        table.number("at_s", ignition.at_s, 0.0..=1e6)?;
        if let Some(every_s) = ignition.every_s {
            table.number("every_s", every_s, 1.0..=1e6)?;
        }
        match &ignition.cells {
            IgnitionCells::Random(count) => {
                table.number("random", (*count).into(), 1.0..=frame.cell_count() as f64)?;
            }
            IgnitionCells::Density(density) => {
                table.number("random", density.count.into(), 1.0..=frame.cell_count() as f64)?;
                if density.weights.as_ref().is_some_and(|weights| weights.by_cell(frame).is_none()) {
                    return table.refuse("density", "damaged".into(), "a weight for each cell of the field".into());
                }
            }
            IgnitionCells::Area(area) => {
                if area.inside.as_ref().is_some_and(|inside| inside.bytes(frame.cell_count()).is_none()) {
                    return table.refuse("inside", "damaged".into(), "a value for each cell of the field".into());
                }
            }
            // Places are cells once they are loaded.
            IgnitionCells::Points(points) => {
                return table.refuse("points_m", format!("{} places", points.len()), "cells".into());
            }
            IgnitionCells::Cells(cells) => {
                // The limit is on all entries together, as each of them may name every cell.
                named += cells.len();
                top.count("ignition", named, MAX_IGNITIONS)?;
                let outside = cells.iter().position(|cell| cell.col >= frame.cols || cell.row >= frame.rows);
                if let Some(index) = outside {
                    let expected =
                        format!("a cell of the field of {} x {} cells, counted from 0", frame.cols, frame.rows);
                    return table.inner("cells").refuse_step(
                        PathStep::Index(index),
                        cells[index].to_string(),
                        expected,
                    );
                }
            }
        }
    }
    Ok(())
}

/// Sums up all entries of `[[ignition]]`; there is one at least.
pub(crate) fn describe_ignitions(ignitions: &[Ignition]) -> String {
    let mut random = 0_u64;
    let mut named = 0;
    let mut drawn = 0_u64;
    let mut areas = 0;
    for ignition in ignitions {
        match &ignition.cells {
            IgnitionCells::Random(count) => random += u64::from(*count),
            IgnitionCells::Cells(cells) => named += cells.len(),
            IgnitionCells::Density(density) => drawn += u64::from(density.count),
            IgnitionCells::Area(_) => areas += 1,
            IgnitionCells::Points(points) => named += points.len(),
        }
    }
    let times = ignitions.iter().map(|ignition| ignition.at_s);
    // Entries need not be in the order of their times.
    let first = times.clone().fold(f64::INFINITY, f64::min);
    let last = times.fold(0.0, f64::max);
    let count = ignitions.len();
    let by_density =
        if drawn > 0 { format!(", and {drawn} chosen at random by maps of weights") } else { String::new() };
    let by_density = match areas {
        0 => by_density,
        1 => format!("{by_density}, and a perimeter"),
        _ => format!("{by_density}, and {areas} perimeters"),
    };
    let repeated = match ignitions.iter().filter(|ignition| ignition.every_s.is_some()).count() {
        0 => String::new(),
        repeated => format!(" {repeated} of them repeated to the end of the run."),
    };
    format!("{count} from {first} s to {last} s: {random} random bushes and {named} named cells{by_density}.{repeated}")
}
