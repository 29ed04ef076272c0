//! The space of the roadmap: free positions, and the costs of lines.

use std::sync::Arc;

use glam::DVec2;

use crate::collision::{ClearanceField, CollisionChecker};
use crate::kit::safety::Safety;
use crate::planners::prm_primitives::{ClearanceTo, PrmSettings};
use wildfire_base::geometry::FieldFrame;

/// About a start that is tighter than the roadmap, this number of metres may be as tight as the start.
const TIGHT_START_M: f64 = 12.0;
/// Lines from there need a little less than the clearance of the start, so that rounding does not decide.
const ROUNDING_M: f64 = 0.01;

/// The space in which milestones and edges may lie: every point keeps the roadmap's clearance.
#[derive(Clone, Debug)]
pub struct FreeSpace {
    checker: CollisionChecker,
    clearance_m: f64,
    clearance_to: ClearanceTo,
    safety: Option<Arc<Safety>>,
}

impl FreeSpace {
    pub fn new(checker: &CollisionChecker, settings: &PrmSettings) -> Self {
        Self {
            checker: checker.clone(),
            clearance_m: settings.clearance_m,
            clearance_to: settings.clearance_to,
            safety: None,
        }
    }

    /// Returns the same space with a safety map that prices lines.
    #[must_use]
    pub fn priced_by(self, safety: Option<Arc<Safety>>) -> Self {
        Self { safety, ..self }
    }

    /// Returns the cost of a straight line: its metres plus the surcharge of its places.
    pub fn price(&self, from: DVec2, to: DVec2) -> f64 {
        let metres = from.distance(to);
        match &self.safety {
            None => metres,
            Some(safety) => metres + safety.surcharge_along(metres, |share| from.lerp(to, share)),
        }
    }

    /// Returns whether a shortcut over some positions costs no more than the longer path over others, both between the
    /// same ends.
    pub fn costs_no_more(&self, from: DVec2, shortcut: &[DVec2], way: &[DVec2]) -> bool {
        let price = |places: &[DVec2]| -> f64 {
            let mut here = from;
            places.iter().map(|&next| self.price(std::mem::replace(&mut here, next), next)).sum()
        };
        self.safety.is_none() || price(shortcut) <= price(way)
    }

    pub fn frame(&self) -> &FieldFrame {
        self.field().frame()
    }

    fn field(&self) -> &ClearanceField {
        self.checker.field()
    }

    /// Returns the width and height of the field in metres.
    pub fn size_m(&self) -> DVec2 {
        DVec2::new(self.field().frame().width_m(), self.field().frame().height_m())
    }

    pub fn point_is_free(&self, point: DVec2) -> bool {
        self.clearance_at(point) >= self.clearance_m
    }

    /// Returns the clearance of a point in metres, as [`ClearanceTo`] defines it; more than the roadmap's clearance may
    /// be reported as infinite.
    pub fn clearance_at(&self, point: DVec2) -> f64 {
        match self.clearance_to {
            ClearanceTo::Cells => self.field().lower_bound(point),
            ClearanceTo::CellCentres if self.field().frame().border_distance(point) < 0.0 => f64::NEG_INFINITY,
            ClearanceTo::CellCentres => self.centre_distance(point, point),
        }
    }

    /// Returns whether all points of a straight line are free.
    pub fn line_is_free(&self, from: DVec2, to: DVec2) -> bool {
        self.line_keeps(from, to, self.clearance_m)
    }

    /// Returns whether a straight line from a truck's position is free; its first metres may be as tight as the
    /// position itself.
    pub fn departure_is_free(&self, from: DVec2, to: DVec2) -> bool {
        let here = self.clearance_at(from) - ROUNDING_M;
        if here >= self.clearance_m {
            return self.line_keeps(from, to, self.clearance_m);
        }
        let length = from.distance(to);
        if length <= TIGHT_START_M {
            return self.line_keeps(from, to, here);
        }
        let out = from.lerp(to, TIGHT_START_M / length);
        self.line_keeps(from, out, here) && self.line_keeps(out, to, self.clearance_m)
    }

    /// Returns whether all points of a straight line keep `clearance` metres, which is at most the roadmap's.
    pub fn line_keeps(&self, from: DVec2, to: DVec2, clearance: f64) -> bool {
        match self.clearance_to {
            ClearanceTo::Cells => self.field().line_is_free(from, to, clearance),
            ClearanceTo::CellCentres => {
                let inside = |point| self.field().frame().border_distance(point) >= 0.0;
                inside(from) && inside(to) && self.centre_distance(from, to) >= clearance
            }
        }
    }

    /// Metres from a straight line to the nearest centre of a bush cell, or infinity when none is within the clearance.
    fn centre_distance(&self, from: DVec2, to: DVec2) -> f64 {
        let frame = self.field().frame();
        let margin = DVec2::splat(self.clearance_m);
        let low = ((from.min(to) - margin) / frame.cell_m).floor().max(DVec2::ZERO);
        let high = ((from.max(to) + margin) / frame.cell_m).floor().max(DVec2::ZERO);
        let cols = low.x as usize..=(high.x as usize).min(usize::from(frame.cols) - 1);
        let rows = low.y as usize..=(high.y as usize).min(usize::from(frame.rows) - 1);
        let mut nearest = f64::INFINITY;
        for row in rows {
            for col in cols.clone() {
                if self.field().occupied()[(row, col)] {
                    let centre = DVec2::new(col as f64 + 0.5, row as f64 + 0.5) * frame.cell_m;
                    nearest = nearest.min(distance_to_line(centre, from, to));
                }
            }
        }
        nearest
    }
}

/// Metres from a point to the nearest point of a straight line between two others.
fn distance_to_line(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let along = to - from;
    let length_squared = along.length_squared();
    let share = if length_squared > 0.0 { ((point - from).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (point - from - along * share).length()
}
