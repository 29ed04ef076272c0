//! The cost by which a truck's drives are compared: length or duration.
//!
//! Searches add up prices of single motions, so they need a cost that adds up: a [`MotionPrice`]. The time of a drive does
//! not, since a truck that must slow down for a bend does so before it. So searches estimate: a metre takes what it takes
//! at the greatest speed that is allowed on it, a cusp what stopping from that speed and setting out again takes longer.
//! Finished paths are compared by the time of the very profile that the truck drives by ([`SpeedLimits::drive_s`]).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion_price::MotionPrice;
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::{Dimensions, Segment};

/// The cost of a truck's drives: metres or seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DriveCost {
    /// Length, plus the planner's `cusp_cost` for each cusp.
    #[default]
    Length,
    /// Duration within the truck's limits of speed and acceleration.
    Time,
}

/// The cost of drives of one truck, in metres, or in seconds times its greatest speed forward.
#[derive(Clone, Copy, Debug)]
pub enum CostModel {
    /// Metres, with a surcharge for every cusp.
    Length {
        cusp_m: f64,
    },
    Time {
        limits: SpeedLimits,
    },
}

impl CostModel {
    /// Creates the model; `cusp_m` is the cost of a cusp where length counts.
    pub fn new(cost: DriveCost, limits: &SpeedLimits, cusp_m: f64) -> Self {
        match cost {
            DriveCost::Length => Self::Length { cusp_m },
            // Corners at which the wheels turn are made smooth when the path is there.
            DriveCost::Time => Self::Time { limits: SpeedLimits { steering: None, ..*limits } },
        }
    }

    /// Returns the cost of a whole drive.
    pub fn of(&self, segments: &[Segment]) -> f64 {
        match self {
            Self::Length { cusp_m } => {
                let metres: f64 = segments.iter().map(|segment| segment.length_m.abs()).sum();
                let cusps = segments.windows(2).filter(|pair| pair[0].is_reverse() != pair[1].is_reverse()).count();
                metres + cusp_m * cusps as f64
            }
            Self::Time { limits } => limits.drive_s(segments) * limits.forward_mps,
        }
    }

    /// Returns a lower bound of the cost of a metre.
    pub fn min_per_metre(&self) -> f64 {
        match self {
            Self::Length { .. } => 1.0,
            Self::Time { limits } => (limits.forward_mps / limits.reverse_mps).min(1.0),
        }
    }

    /// Returns the prices of single motions, which searches add up.
    pub fn motion_price(&self, body: &Dimensions) -> MotionPrice {
        match self {
            Self::Length { cusp_m } => MotionPrice::in_metres(*cusp_m, body),
            Self::Time { limits } => MotionPrice::in_time(limits, body),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::Pose;

    const LADEN: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 4.0,
        acceleration_mps2: Some(2.0),
        braking_mps2: Some(4.0),
        lateral_mps2: Some(3.0),
        steering: None,
    };

    fn segment(curvature: f64, length_m: f64) -> Segment {
        Segment { curvature, length_m }
    }

    #[test]
    fn no_metre_costs_less_than_the_least() {
        let limits = [LADEN, SpeedLimits::new(8.0, 8.0), SpeedLimits { reverse_mps: 12.0, ..LADEN }];
        for cost in
            limits.map(|limits| CostModel::Time { limits }).into_iter().chain([CostModel::Length { cusp_m: 2.0 }])
        {
            for way in
                [vec![segment(0.0, 40.0)], vec![segment(0.0, -40.0)], vec![segment(0.07, 9.0), segment(0.0, -3.0)]]
            {
                let metres: f64 = way.iter().map(|segment| segment.length_m.abs()).sum();
                assert!(cost.of(&way) >= cost.min_per_metre() * metres - 1e-9, "{cost:?} {way:?}");
            }
        }
    }

    #[test]
    fn prices_of_motions_are_the_time_of_a_long_drive_but_for_its_ends() {
        let body = Dimensions::default();
        let cost = CostModel::Time { limits: LADEN };
        let price = cost.motion_price(&body);
        let to = segment(0.0, 100.0);
        let back = segment(0.0, -60.0);
        // Speeding up and braking take so much longer than driving on, first at the start, then at the end.
        let at_ends_s = [0.5 * 8.0 / 2.0 + 0.5 * 4.0 / 4.0, 0.5 * 4.0 / 2.0 + 0.5 * 8.0 / 4.0];
        let ways = [[to, back], [back, to]];
        let priced: f64 = ways.iter().map(|way| price.path_cost(Pose::default(), way)).sum();
        let whole: f64 = ways.iter().map(|way| cost.of(way)).sum();
        assert!((whole - priced - 8.0 * (at_ends_s[0] + at_ends_s[1])).abs() < 1e-9, "{whole}, priced {priced}");
    }

    #[test]
    fn where_length_counts_a_metre_is_a_metre() {
        let price = CostModel::new(DriveCost::Length, &LADEN, 2.0).motion_price(&Dimensions::default());
        assert_eq!((price.rate(segment(0.07, -3.0)), price.cusp()), (1.0, 2.0));
    }
}
