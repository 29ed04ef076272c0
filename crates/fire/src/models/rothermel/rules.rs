//! The choices that the model leaves to its user.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::embers::Embers;
use crate::surface::SurfaceOptions;
use crate::surface::crown::CrownRules;
use wildfire_base::time::SimTime;

/// The number of cells around one that fire reaches from it in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "u8", into = "u8")]
#[schemars(with = "u8")]
pub enum Neighbours {
    Eight,
    Sixteen,
    #[default]
    ThirtyTwo,
}

impl Neighbours {
    pub fn count(self) -> usize {
        usize::from(u8::from(self))
    }

    /// Returns the farthest of them, in columns or rows.
    pub fn reach(self) -> i32 {
        match self {
            Self::Eight => 1,
            Self::Sixteen => 2,
            Self::ThirtyTwo => 3,
        }
    }
}

impl TryFrom<u8> for Neighbours {
    type Error = String;

    fn try_from(count: u8) -> Result<Self, String> {
        match count {
            8 => Ok(Self::Eight),
            16 => Ok(Self::Sixteen),
            32 => Ok(Self::ThirtyTwo),
            _ => Err(format!("{count} neighbours, expected 8, 16 or 32")),
        }
    }
}

impl From<Neighbours> for u8 {
    fn from(neighbours: Neighbours) -> Self {
        match neighbours {
            Neighbours::Eight => 8,
            Neighbours::Sixteen => 16,
            Neighbours::ThirtyTwo => 32,
        }
    }
}

/// How fire behaves under Rothermel's equations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RothermelRules {
    pub options: SurfaceOptions,
    pub neighbours: Neighbours,
    /// True if fire also spreads in directions between those to the neighbours where it is too narrow for these. Older
    /// recordings do not say so.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub refined: bool,
    /// From a truck's stop until what it has wetted is dry.
    pub wet: SimTime,
    /// The least time that a cell flames, which is otherwise the residence time of its fuel; `None` flames forever.
    pub burn_out: Option<SimTime>,
    /// Embers besides the front; `None`: there are none.
    pub embers: Option<Embers>,
    /// Fire in the crowns of the landscape's trees; `None`: there are no trees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crowns: Option<CrownRules>,
}

impl Default for RothermelRules {
    fn default() -> Self {
        let wet = SimTime::from_seconds(120.0);
        let burn_out = Some(SimTime::ZERO);
        Self {
            options: SurfaceOptions::default(),
            neighbours: Neighbours::default(),
            refined: true,
            wet,
            burn_out,
            embers: None,
            crowns: None,
        }
    }
}
