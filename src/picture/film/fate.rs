//! What has become of a bush, without the when: as it is counted, coloured and named.

use crate::picture::Rgb;
use crate::picture::colours::{BURNED_OUT, BURNING, EXTINGUISHED, INTACT};
use crate::timeline::BushState;

/// The state of a bush without its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    Intact,
    Burning,
    BurnedOut,
    Extinguished,
}

impl Fate {
    pub const ALL: [Self; 4] = [Self::Intact, Self::Burning, Self::BurnedOut, Self::Extinguished];

    pub fn of(bush: BushState) -> Self {
        match bush {
            BushState::Intact => Self::Intact,
            BushState::Burning { .. } => Self::Burning,
            BushState::BurnedOut => Self::BurnedOut,
            BushState::Extinguished => Self::Extinguished,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Intact => "intact",
            Self::Burning => "burning",
            Self::BurnedOut => "burned out",
            Self::Extinguished => "extinguished",
        }
    }

    pub fn colour(self) -> Rgb {
        match self {
            Self::Intact => INTACT,
            Self::Burning => BURNING,
            Self::BurnedOut => BURNED_OUT,
            Self::Extinguished => EXTINGUISHED,
        }
    }
}
