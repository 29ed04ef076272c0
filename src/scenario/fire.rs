//! The rules of fire in a scenario: their settings, ranges, description and warnings, and the model that they choose.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::or_none;
use crate::fire::models::Radius;
use crate::fire::{FireModel, FireRules};
use crate::geometry::FieldFrame;
use crate::ranges::{OutOfRange, SettingsTable, check_range, number_text};
use crate::time::SimTime;

/// The most pairs of a burning cell and a neighbour in its radius.
const MAX_SPREAD_PAIRS: f64 = 1e9;

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

impl Fire {
    /// Returns the rules as runs have them.
    pub fn rules(&self) -> FireRules {
        FireRules {
            spread_delay: SimTime::from_seconds(self.spread_delay_s),
            spread_radius_m: self.spread_radius_m,
            lit_spreads: self.spread_from != SpreadFrom::None,
            caught_spreads: self.spread_from == SpreadFrom::All,
            burn_out: self.burn_out_s.map(SimTime::from_seconds),
            relight: self.relight,
        }
    }

    /// Returns the rules that a timeline holds, by which an audit checks spread and burn-out. A model with rules of another
    /// kind has none of these, and is not checked so.
    pub fn recorded_rules(&self) -> Option<FireRules> {
        Some(self.rules())
    }

    /// Makes the model of a run on a field.
    pub fn model(&self, frame: &FieldFrame) -> Box<dyn FireModel> {
        Box::new(Radius::new(frame, self.rules()))
    }

    /// Bounds the memory that the model takes on a field.
    pub(super) fn most_bytes(&self, frame: &FieldFrame) -> u64 {
        Radius::most_bytes(frame, self.spread_radius_m)
    }

    pub(super) fn describe(&self) -> String {
        let spread = match self.spread_from {
            SpreadFrom::None => "Fire does not spread.".into(),
            from => format!(
                "A bush that has burned for {} s sets intact ones on fire whose centres are within {} m; {}.",
                self.spread_delay_s,
                self.spread_radius_m,
                if from == SpreadFrom::All { "every burning bush does so" } else { "only bushes that were lit do so" }
            ),
        };
        let end = self
            .burn_out_s
            .map_or("It burns until it is put out.".into(), |s| format!("A bush burns out after {s} s."));
        let again = if self.relight {
            "An extinguished bush can burn again."
        } else {
            "An extinguished bush is safe for good."
        };
        format!("{spread} {end} {again}")
    }

    /// Adds warnings about rules by which no fire spreads.
    pub(super) fn warn(&self, frame: &FieldFrame, found: &mut Vec<String>) {
        let spreads = self.spread_from != SpreadFrom::None && self.spread_radius_m > 0.0;
        if let Some(burn_out_s) = self.burn_out_s.filter(|&burn_out_s| spreads && burn_out_s <= self.spread_delay_s) {
            let delay_s = self.spread_delay_s;
            found.push(format!(
                "No fire spreads: a bush burns out after {burn_out_s} s, before it would spread at {delay_s} s."
            ));
        }
        if spreads && self.spread_radius_m < frame.cell_m {
            found.push(format!("No fire spreads: no two cells are within {} m of each other.", self.spread_radius_m));
        }
    }
}

impl SettingsTable for Fire {
    fn check(&self, frame: &FieldFrame) -> Result<(), OutOfRange> {
        check_range("spread_delay_s", self.spread_delay_s, 0.0..=1e6)?;
        check_range("spread_radius_m", self.spread_radius_m, 0.0..=1e6)?;
        self.burn_out_s.map_or(Ok(()), |burn_out_s| check_range("burn_out_s", burn_out_s, 0.001..=1e6))?;
        // Spreading looks at every bush in the radius of every burning one.
        let cells = frame.cell_count() as f64;
        let across = 2.0 * self.spread_radius_m / frame.cell_m + 1.0;
        if cells * (across * across).min(cells) <= MAX_SPREAD_PAIRS {
            return Ok(());
        }
        let expected = format!("at most {MAX_SPREAD_PAIRS:e} pairs of a cell and a cell in its radius");
        Err(OutOfRange { name: "spread_radius_m", found: number_text(self.spread_radius_m), expected })
    }
}
