//! A field measured in vehicles.
//!
//! The lattices, steps and clearances of searches are metres that suit the contest's truck. A field that is scaled until
//! the vehicle is as long as that truck is the same problem at every size, and its paths are scaled back.

use std::sync::Arc;

use glam::DVec2;

use crate::collision::{ClearanceField, CollisionChecker, MIN_CLEARANCE_M};
use crate::observer::{PlanningObserver, PlanningWork};
use crate::{Goal, GoalDisc};
use wildfire_base::geometry::{FieldFrame, Pose};
use wildfire_base::query::SearchPhase;
use wildfire_base::vehicle::{Dimensions, Path, Segment};

/// The share of a length that rounding may take: sizes nearer to each other are equal, and the least clearance gains it.
const ROUNDING: f64 = 1e-6;

/// The scaled field with the scaled vehicle on it.
#[derive(Debug)]
pub struct VehicleUnits {
    /// Scaled metres of a metre.
    scale: f64,
    pub checker: CollisionChecker,
    max_curvature: f64,
}

impl VehicleUnits {
    /// Scales a field and a vehicle; `None` if the vehicle is as long as the contest's truck.
    pub fn new(checker: &CollisionChecker) -> Option<Self> {
        let body = checker.body();
        let scale = Dimensions::default().length_m / body.length_m;
        if (scale - 1.0).abs() < ROUNDING {
            return None;
        }
        let frame = checker.field().frame();
        let frame = FieldFrame { cell_m: scale * frame.cell_m, ..*frame };
        let scaled_body = Dimensions {
            length_m: scale * body.length_m,
            width_m: scale * body.width_m,
            wheelbase_m: scale * body.wheelbase_m,
            rear_overhang_m: scale * body.rear_overhang_m,
            turning_radius_m: scale * body.turning_radius_m,
            steering_rate_deg_s: body.steering_rate_deg_s,
        };
        let field = Arc::new(ClearanceField::new(frame, checker.field().occupied()));
        // Scaled back, it must still be 1 cm after rounding.
        let min_m = MIN_CLEARANCE_M * (scale * (1.0 + ROUNDING)).max(1.0);
        let checker = CollisionChecker::new(field, scaled_body).with_min_clearance(min_m);
        Some(Self { scale, checker, max_curvature: body.max_curvature() })
    }

    pub fn pose(&self, pose: Pose) -> Pose {
        Pose { x: self.scale * pose.x, y: self.scale * pose.y, heading: pose.heading }
    }

    pub fn disc(&self, disc: GoalDisc) -> GoalDisc {
        GoalDisc { centre: self.scale * disc.centre, radius_m: self.scale * disc.radius_m }
    }

    pub fn goal(&self, goal: Goal) -> Goal {
        match goal {
            Goal::Pose(end) => Goal::Pose(self.pose(end)),
            Goal::Disc(disc) => Goal::Disc(self.disc(disc)),
        }
    }

    /// Scales a path back that begins at the image of `start`.
    pub fn path_from(&self, start: Pose, scaled: &Path) -> Path {
        let back = |segment: &Segment| Segment {
            // Rounding must not make a turn sharper than the vehicle can.
            curvature: (self.scale * segment.curvature).clamp(-self.max_curvature, self.max_curvature),
            length_m: segment.length_m / self.scale,
        };
        Path { start, segments: scaled.segments.iter().map(back).collect() }
    }
}

/// Shows an observer the lines of a scaled search at their places.
pub struct UnscaledLines<'a> {
    pub observer: &'a mut dyn PlanningObserver,
    pub units: &'a VehicleUnits,
}

impl PlanningObserver for UnscaledLines<'_> {
    fn begins(&mut self, work: Option<PlanningWork>) {
        self.observer.begins(work);
    }

    fn on_edges_examined(&mut self, phase: SearchPhase, lines: &mut dyn Iterator<Item = [DVec2; 2]>) {
        self.observer.on_edges_examined(phase, &mut lines.map(|line| line.map(|place| place / self.units.scale)));
    }
}
