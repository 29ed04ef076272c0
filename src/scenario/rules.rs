//! The rules: spread and end of fire, suppression, scores, and what ignites by itself.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use super::or_none;
use crate::geometry::Cell;

/// Rules by which fire spreads and ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Fire {
    pub spread_delay_s: f64,
    /// Between cell centres, inclusive.
    pub spread_radius_m: f64,
    pub spread_from: SpreadFrom,
    /// From ignition to burned out; `"none"`: it burns for ever.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub burn_out_s: Option<f64>,
    /// Lets extinguished cells burn again.
    pub relight: bool,
}

impl Default for Fire {
    fn default() -> Self {
        Self {
            spread_delay_s: 10.0,
            spread_radius_m: 30.0,
            spread_from: SpreadFrom::Lit,
            burn_out_s: Some(60.0),
            relight: false,
        }
    }
}

/// Selects the burning cells that set others on fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpreadFrom {
    All,
    /// Only what a Wumpus or an `[[ignition]]` lit.
    Lit,
    None,
}

/// Rules by which a truck puts fires out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Suppression {
    /// From the truck's body centre to the cell's centre, inclusive; `"none"`: no rule of distance.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub reach_m: Option<f64>,
    /// Time that the truck must stand still for it, uninterrupted.
    pub dwell_s: f64,
    pub extinguishes: Extinguishes,
}

impl Default for Suppression {
    fn default() -> Self {
        Self { reach_m: Some(10.0), dwell_s: 5.0, extinguishes: Extinguishes::One }
    }
}

/// Selects what one stop puts out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Extinguishes {
    One,
    /// Everything that burns in reach when the dwell ends.
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

/// Cells that catch fire by themselves at a given time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "IgnitionEntry", into = "IgnitionEntry")]
pub struct Ignition {
    pub at_s: f64,
    pub cells: IgnitionCells,
}

/// The cells that an [`Ignition`] lights.
#[derive(Clone, Debug, PartialEq)]
pub enum IgnitionCells {
    /// These cells, where they are intact bushes.
    Cells(Vec<Cell>),
    /// This number of bush cells, drawn from the stream `ignition`.
    Random(u32),
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
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Vec<(u16, u16)>>")]
    cells: Option<Vec<Cell>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    random: Option<u32>,
}

impl TryFrom<IgnitionEntry> for Ignition {
    type Error = &'static str;

    fn try_from(entry: IgnitionEntry) -> Result<Self, Self::Error> {
        let cells = match (entry.cells, entry.random) {
            (Some(cells), None) => IgnitionCells::Cells(cells),
            (None, Some(count)) => IgnitionCells::Random(count),
            _ => return Err("an ignition needs either `cells` or `random`"),
        };
        Ok(Self { at_s: entry.at_s, cells })
    }
}

impl From<Ignition> for IgnitionEntry {
    fn from(ignition: Ignition) -> Self {
        let (cells, random) = match ignition.cells {
            IgnitionCells::Cells(cells) => (Some(cells), None),
            IgnitionCells::Random(count) => (None, Some(count)),
        };
        Self { at_s: ignition.at_s, cells, random }
    }
}
