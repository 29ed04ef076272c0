//! The alphabet of the words of Dubins and of Reeds and Shepp.

use std::fmt;

use crate::vehicle::Segment;

/// The direction of the steering wheel: to a stop, or straight ahead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steering {
    Left,
    Straight,
    Right,
}

/// The direction of driving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gear {
    Forward,
    Reverse,
}

/// One letter of a word: a steering held in one gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Letter {
    pub steering: Steering,
    pub gear: Gear,
}

impl Letter {
    /// The mirror image in the axis of the vehicle: left becomes right.
    pub fn reflected(self) -> Self {
        let steering = match self.steering {
            Steering::Left => Steering::Right,
            Steering::Straight => Steering::Straight,
            Steering::Right => Steering::Left,
        };
        Self { steering, ..self }
    }

    /// The same steering in the other gear.
    pub fn flipped(self) -> Self {
        let gear = match self.gear {
            Gear::Forward => Gear::Reverse,
            Gear::Reverse => Gear::Forward,
        };
        Self { gear, ..self }
    }

    /// The stretch of `length_m` (not negative) at the smallest turning radius.
    pub fn segment(self, length_m: f64, radius_m: f64) -> Segment {
        let curvature = match self.steering {
            Steering::Left => 1.0 / radius_m,
            Steering::Straight => 0.0,
            Steering::Right => -1.0 / radius_m,
        };
        let length_m = match self.gear {
            Gear::Forward => length_m,
            Gear::Reverse => -length_m,
        };
        Segment { curvature, length_m }
    }
}

/// As in `L`.
impl fmt::Display for Steering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "L",
            Self::Straight => "S",
            Self::Right => "R",
        })
    }
}

/// As in `L+` or `R-`.
impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let steering = self.steering;
        let gear = match self.gear {
            Gear::Forward => '+',
            Gear::Reverse => '-',
        };
        write!(f, "{steering}{gear}")
    }
}
