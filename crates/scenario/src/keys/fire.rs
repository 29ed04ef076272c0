//! The rules of fire in a scenario: their settings, ranges, description and warnings, and the model that they choose.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::alexandridis::AlexandridisSettings;
use super::rothermel::RothermelSettings;
use wildfire_base::geometry::FieldFrame;
use wildfire_base::or_none;
use wildfire_base::ranges;
use wildfire_base::ranges::OutOfRange;
use wildfire_base::time::SimTime;
use wildfire_fire::FireRules;
use wildfire_fire::embers::{EmberSettings, Embers};
use wildfire_fire::models::{AlexandridisRules, RothermelRules};
use wildfire_fire::surface::crown::CrownSettings;

/// The most pairs of a burning cell and a piece of a row in its radius.
const MAX_SPREAD_PAIRS: f64 = 1e9;

/// Cells of a row that are looked at together.
const PIECE_CELLS: f64 = 64.0;

/// Rules by which fire spreads and ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Fire {
    /// The spread model. The other values are for `radius`, except that `burn_out_s` and `relight` apply to all models:
    /// under `rothermel` a cell flames for `burn_out_s`, or for the residence time of its fuel if that is longer.
    pub model: FireModelName,
    pub spread_delay_s: f64,
    /// Distance between cell centres, inclusive.
    pub spread_radius_m: f64,
    pub spread_from: SpreadFrom,
    /// Time from ignition to burned out; `"none"`: it burns forever.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub burn_out_s: Option<f64>,
    /// Whether extinguished cells can burn again.
    pub relight: bool,
    /// What catches fire and goes out together, under the model `radius`.
    #[serde(skip_serializing_if = "FireUnit::is_bush")]
    pub unit: FireUnit,
    /// Settings of the model `rothermel`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rothermel: Option<RothermelSettings>,
    /// Settings of the model `alexandridis`; ground and slope are those of `rothermel`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alexandridis: Option<AlexandridisSettings>,
    /// Embers of the model `rothermel`; without this table there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub embers: Option<EmberSettings>,
    /// Trees of the model `rothermel` and fire in their crowns; without this table there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crowns: Option<CrownSettings>,
}

/// The fire models by their names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FireModelName {
    /// Bushes ignite other bushes within a radius, after a delay.
    #[default]
    Radius,
    /// Fronts by Rothermel's equations, through bushes and ground.
    Rothermel,
    /// The automaton of Alexandridis and others, 2008, on bushes and ground.
    Alexandridis,
}

impl Default for Fire {
    fn default() -> Self {
        Self {
            model: FireModelName::Radius,
            spread_delay_s: 10.0,
            spread_radius_m: 30.0,
            spread_from: SpreadFrom::Ignited,
            burn_out_s: Some(60.0),
            relight: false,
            unit: FireUnit::Bush,
            rothermel: None,
            alexandridis: None,
            embers: None,
            crowns: None,
        }
    }
}

/// What catches fire and goes out together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FireUnit {
    /// A cell with its bush.
    #[default]
    Bush,
    /// A whole piece: a tetromino of a generated field, or bushes of a given field that join along sides.
    Piece,
}

impl FireUnit {
    // Serde asks with a reference.
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature is serde's")]
    fn is_bush(&self) -> bool {
        *self == Self::Bush
    }
}

/// Selects the burning cells that spread fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpreadFrom {
    All,
    /// Only cells lit by a Wumpus or an `[[ignition]]`.
    #[serde(rename = "lit")]
    Ignited,
    None,
}

impl Fire {
    /// Gives the model that is chosen its settings where the scenario says nothing of them.
    pub(crate) fn fill_in_model(&mut self) {
        match self.model {
            FireModelName::Radius => {}
            FireModelName::Rothermel => {
                self.rothermel.get_or_insert_default();
            }
            FireModelName::Alexandridis => {
                self.rothermel.get_or_insert_default();
                self.alexandridis.get_or_insert_default();
            }
        }
    }

    /// Bounds the work of spreading, which looks at every bush in the radius of every burning one, at up to 64 cells of a
    /// row at once.
    fn check_work(&self, frame: &FieldFrame) -> Result<(), OutOfRange> {
        let cells = frame.cell_count() as f64;
        let across = 2.0 * self.spread_radius_m / frame.cell_m + 1.0;
        let rows = across.min(f64::from(frame.rows));
        let pairs = cells * rows * (across.min(f64::from(frame.cols)) / PIECE_CELLS + 1.0);
        if pairs <= MAX_SPREAD_PAIRS {
            return Ok(());
        }
        let expected = format!(
            "at most {MAX_SPREAD_PAIRS:e} pairs of a cell and {PIECE_CELLS} cells in a row in its radius; here they are \
             {pairs:.2e}"
        );
        Err(OutOfRange::new("spread_radius_m", self.spread_radius_m, expected))
    }

    /// Returns the settings of the model `rothermel`, if that is chosen; ground and slope hold for other models too.
    pub(crate) fn rothermel(&self) -> Option<&RothermelSettings> {
        if self.model == FireModelName::Rothermel { self.rothermel.as_ref() } else { None }
    }

    /// Returns the trees and the fire in their crowns, in the model `rothermel`.
    pub(crate) fn crowns(&self) -> Option<&CrownSettings> {
        self.crowns.as_ref().filter(|_| self.model == FireModelName::Rothermel)
    }

    /// Returns true if fire takes and leaves whole pieces.
    pub fn takes_pieces(&self) -> bool {
        self.model == FireModelName::Radius && self.unit == FireUnit::Piece
    }

    /// Returns true if Wumpuses light ground as well as bushes.
    pub fn lights_ground(&self) -> bool {
        self.rothermel().is_some_and(|settings| settings.lights_ground)
    }

    /// Returns for how long a truck's stop wets what does not burn in its reach, if it does.
    pub fn wet(&self) -> Option<SimTime> {
        let wet_s = self.rothermel()?.wet_s;
        (wet_s > 0.0).then(|| SimTime::from_seconds(wet_s))
    }

    /// Returns the rules of the model `rothermel` in the run of a seed, if that is chosen.
    pub fn rothermel_rules(&self, seed: u64) -> Option<RothermelRules> {
        let settings = self.rothermel()?;
        Some(RothermelRules {
            options: settings.options(),
            neighbours: settings.neighbours,
            refined: settings.refined,
            wet: SimTime::from_seconds(settings.wet_s),
            burn_out: self.burn_out_s.map(SimTime::from_seconds),
            embers: self.embers.map(|settings| Embers { settings, seed }),
            crowns: self.crowns.as_ref().map(CrownSettings::rules),
        })
    }

    /// Returns the rules of the model `alexandridis`, if that is chosen.
    pub fn alexandridis_rules(&self) -> Option<AlexandridisRules> {
        if self.model != FireModelName::Alexandridis {
            return None;
        }
        self.alexandridis.as_ref().map(AlexandridisSettings::rules)
    }

    /// Returns the rules of the radius as runs have them.
    pub fn rules(&self) -> FireRules {
        FireRules {
            spread_delay: SimTime::from_seconds(self.spread_delay_s),
            spread_radius_m: self.spread_radius_m,
            sources_spread: self.spread_from != SpreadFrom::None,
            caught_spreads: self.spread_from == SpreadFrom::All,
            burn_out: self.burn_out_s.map(SimTime::from_seconds),
            reignition: self.relight,
        }
    }

    /// Returns the rules that a timeline holds, by which an audit checks spread and burn-out. A model with rules of another
    /// kind has none of these, and is not checked so.
    pub fn recorded_rules(&self) -> Option<FireRules> {
        (self.model == FireModelName::Radius).then(|| self.rules())
    }

    /// Names the settings that the chosen model does not use.
    pub(crate) fn unused(&self) -> &'static [&'static str] {
        match self.model {
            FireModelName::Radius => &["rothermel", "alexandridis", "embers", "crowns"],
            FireModelName::Rothermel => &["spread_delay_s", "spread_radius_m", "spread_from", "unit", "alexandridis"],
            FireModelName::Alexandridis => {
                &["spread_delay_s", "spread_radius_m", "spread_from", "unit", "embers", "crowns"]
            }
        }
    }

    /// Adds warnings about rules by which no fire spreads.
    pub(crate) fn warn(&self, frame: &FieldFrame, found: &mut Vec<String>) {
        if self.embers.is_some() && self.model != FireModelName::Rothermel {
            found.push("`[fire.embers]` has no effect: only the model `rothermel` has embers.".to_owned());
        }
        if self.crowns.is_some() && self.model != FireModelName::Rothermel {
            found.push("`[fire.crowns]` has no effect: only the model `rothermel` has trees.".to_owned());
        }
        if self.model != FireModelName::Radius {
            if self.unit == FireUnit::Piece {
                found.push(
                    "`fire.unit` has no effect: only under the model `radius` fire takes whole pieces.".to_owned(),
                );
            }
            return;
        }
        let spreads = self.spread_from != SpreadFrom::None && self.spread_radius_m > 0.0;
        // An arrival after the burn-out is void, so a burning time equal to the delay already prevents all spread.
        if let Some(burn_out_s) = self.burn_out_s.filter(|&burn_out_s| spreads && burn_out_s <= self.spread_delay_s) {
            let delay_s = self.spread_delay_s;
            found.push(format!(
                "No fire spreads: a bush burns out after {burn_out_s} s, before it would spread at {delay_s} s."
            ));
        }
        // The centres of neighbouring cells are a whole side apart.
        if spreads && self.spread_radius_m < frame.cell_m {
            found.push(format!("No fire spreads: no two cells are within {} m of each other.", self.spread_radius_m));
        }
    }
}

ranges! { Fire {
    spread_delay_s: 0.0..=1e6, spread_radius_m: 0.0..=1e6, burn_out_s: 0.001..=1e6;
    rothermel, alexandridis, embers, crowns
} and Self::check_work }
