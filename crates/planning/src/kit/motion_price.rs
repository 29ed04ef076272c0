//! The costs of motions: by metre, turn, direction and cusp, and by the places they pass.

use std::sync::Arc;

use glam::DVec2;

use super::local_search::{MotionCost, PrimitiveSettings};
use super::safety::Safety;
use wildfire_base::geometry::Pose;
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::{CurvePrice, Dimensions, Segment};

/// The price list of motions.
#[derive(Clone, Debug)]
pub struct MotionPrice {
    per_metre: f64,
    turn: f64,
    reverse: f64,
    cusp: f64,
    safety: Option<Arc<Safety>>,
    /// From the axle forward to the body's centre, whose place counts for safety.
    ahead_m: f64,
}

impl MotionPrice {
    pub fn new(settings: &PrimitiveSettings, body: &Dimensions, safety: Option<Arc<Safety>>) -> Self {
        let per_metre = match settings.cost {
            MotionCost::Metres => 1.0,
            MotionCost::Moves => 1.0 / settings.step_m,
        };
        Self {
            per_metre,
            turn: settings.turn_cost,
            reverse: settings.reverse_cost,
            cusp: settings.cusp_cost,
            safety,
            ahead_m: body.centre_offset_m(),
        }
    }

    /// Creates a list that charges only for metres and cusps.
    pub fn in_metres(cusp_m: f64, body: &Dimensions) -> Self {
        Self { per_metre: 1.0, turn: 0.0, reverse: 0.0, cusp: cusp_m, safety: None, ahead_m: body.centre_offset_m() }
    }

    /// Creates a list in metres at the greatest forward speed: each metre costs the time that it takes at its greatest
    /// speed, a turn that of the tightest, and a cusp the time lost by stopping and starting again.
    pub fn in_time(limits: &SpeedLimits, body: &Dimensions) -> Self {
        let pace =
            |curvature: f64, length_m: f64| limits.forward_mps / limits.speed_on(&Segment { curvature, length_m });
        let lost_at = |speed_mps| lost_s(speed_mps, limits.braking_mps2) + lost_s(speed_mps, limits.acceleration_mps2);
        // One side of a cusp is in reverse, the other forward.
        let cusp_s = 0.5 * (lost_at(limits.forward_mps) + lost_at(limits.reverse_mps));
        Self {
            turn: pace(body.max_curvature(), 1.0) - 1.0,
            reverse: pace(0.0, -1.0) - 1.0,
            ..Self::in_metres(cusp_s * limits.forward_mps, body)
        }
    }

    /// Returns the cost of a metre of a segment, without the surcharge of places.
    pub fn rate(&self, segment: Segment) -> f64 {
        let turn = if segment.curvature == 0.0 { 0.0 } else { self.turn };
        self.per_metre * (1.0 + turn + if segment.is_reverse() { self.reverse } else { 0.0 })
    }

    /// Returns the cost of a cusp.
    pub fn cusp(&self) -> f64 {
        self.cusp
    }

    /// Returns the cost of a segment driven after another one, or from standstill, without the surcharge of places.
    pub fn cost(&self, segment: Segment, after_reverse: Option<bool>) -> f64 {
        let reverse = segment.is_reverse();
        let rate = self.rate(segment);
        let cusp = if after_reverse.is_some_and(|before| before != reverse) { self.cusp } else { 0.0 };
        segment.length_m.abs() * rate + cusp
    }

    /// Returns the surcharge of the places that a segment from a pose passes.
    pub fn surcharge(&self, pose: Pose, segment: Segment) -> f64 {
        let Some(safety) = &self.safety else { return 0.0 };
        self.per_metre
            * safety.surcharge_along(segment.length_m.abs(), |share| {
                let pose = segment.pose_at(pose, share * segment.length_m);
                pose.position() + pose.direction() * self.ahead_m
            })
    }

    /// Returns the surcharge of consecutive segments.
    pub fn way_surcharge(&self, mut pose: Pose, segments: impl IntoIterator<Item = Segment>) -> f64 {
        if self.safety.is_none() {
            return 0.0;
        }
        segments
            .into_iter()
            .map(|segment| {
                let from = pose;
                pose = segment.end(from);
                self.surcharge(from, segment)
            })
            .sum()
    }

    /// Returns the surcharge of the places that a straight line of the body's centre passes.
    pub fn line_surcharge(&self, from: DVec2, to: DVec2) -> f64 {
        let Some(safety) = &self.safety else { return 0.0 };
        self.per_metre * safety.surcharge_along(from.distance(to), |share| from.lerp(to, share))
    }

    /// Returns whether a place may be left out on the way to the next, which can be seen: where ground is slow, only if that
    /// costs no more.
    pub fn may_skip(&self, from: DVec2, place: DVec2, next: DVec2) -> bool {
        let cost = |a: DVec2, b: DVec2| a.distance(b) + self.line_surcharge(a, b);
        let prices_ground = self.safety.as_ref().is_some_and(|safety| safety.prices_ground);
        !prices_ground || cost(from, next) <= cost(from, place) + cost(place, next)
    }

    /// Returns the cost of consecutive segments from a pose, from standstill.
    pub fn path_cost(&self, pose: Pose, segments: &[Segment]) -> f64 {
        self.way_cost(pose, None, segments.iter().copied())
    }

    /// Returns the cost of consecutive segments for a truck that came to the pose forward or in reverse.
    pub fn way_cost(
        &self,
        pose: Pose,
        after_reverse: Option<bool>,
        segments: impl Iterator<Item = Segment> + Clone,
    ) -> f64 {
        let mut before = after_reverse;
        let motions: f64 =
            segments.clone().map(|segment| self.cost(segment, before.replace(segment.is_reverse()))).sum();
        motions + self.way_surcharge(pose, segments)
    }

    /// Returns the price that decides between curves: this list without turns and places.
    pub fn curve_price(&self) -> CurvePrice {
        // Curves are priced in metres, whatever the unit of this list is.
        CurvePrice { reverse_factor: 1.0 + self.reverse, cusp_m: self.cusp / self.per_metre }
    }
}

/// Returns the seconds that a change between rest and a speed costs beside driving at that speed.
// While a truck brakes from a speed or gains it, it drives half as far as it would at that speed.
fn lost_s(speed_mps: f64, limit: Option<f64>) -> f64 {
    limit.map_or(0.0, |mps2| 0.5 * speed_mps / mps2)
}
