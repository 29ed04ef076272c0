use crate::planning::{MotionCost, PrimitiveSettings};
use crate::vehicle::Segment;

/// What motions cost in the local search.
#[derive(Clone, Copy, Debug)]
pub struct Price {
    per_metre: f64,
    turn: f64,
    reverse: f64,
    cusp: f64,
}

impl Price {
    pub fn new(settings: &PrimitiveSettings) -> Self {
        let per_metre = match settings.cost {
            MotionCost::Metres => 1.0,
            MotionCost::Moves => 1.0 / settings.step_m,
        };
        Self { per_metre, turn: settings.turn_cost, reverse: settings.reverse_cost, cusp: settings.cusp_cost }
    }

    /// Cost of a segment driven after another one, or from standstill.
    pub fn of(&self, segment: Segment, after_reverse: Option<bool>) -> f64 {
        let reverse = segment.is_reverse();
        let turn = if segment.curvature == 0.0 { 0.0 } else { self.turn };
        let rate = self.per_metre * (1.0 + turn + if reverse { self.reverse } else { 0.0 });
        let cusp = if after_reverse.is_some_and(|before| before != reverse) { self.cusp } else { 0.0 };
        segment.length_m.abs() * rate + cusp
    }

    /// Cost of segments in a row, from standstill.
    pub fn of_all(&self, segments: &[Segment]) -> f64 {
        let mut before = None;
        segments.iter().map(|&segment| self.of(segment, before.replace(segment.is_reverse()))).sum()
    }
}
