//! Paths of many car-like vehicles at once, free of each other and of obstacles.
//!
//! The problem and its constants are those of the CL-MAPF benchmark (L. Wen, Y. Liu, H. Li, "CL-MAPF: Multi-Agent Path
//! Finding for Car-Like robots with kinematic and spatiotemporal constraints", Robotics and Autonomous Systems 150, 2022):
//! all vehicles set out together, each has a goal pose of its own, and one that has arrived stays there and blocks. Time
//! goes in steps; in a step a vehicle waits, or drives up to [`STEP_M`] straight or along an arc of [`RADIUS_M`], forward
//! or in reverse.
//!
//! [`plan`] gives every vehicle a route around those planned before it, in space and time (prioritised planning: M.
//! Erdmann, T. Lozano-Perez, "On multiple moving objects", Algorithmica 2, 1987), and where that fails repairs by
//! conflicts (`repair`). `route` plans one vehicle among the others, `world` says what touches what. [`judge`] checks
//! solutions with code of its own, [`files`] reads and writes them.
//!
//! World frame: metres, x to the right, y up, the origin in the map's corner; headings counter-clockwise.

pub mod files;
pub mod judge;
#[cfg(test)]
mod laws;
mod repair;
mod route;
mod world;

pub use repair::{PlanTogether, RepairEffort, RepairMethod, Unsolved, plan};

use glam::DVec2;
use serde::Serialize;

use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Dimensions, ReedsShepp, Segment};

/// Smallest turning radius; arcs have exactly this one.
pub const RADIUS_M: f64 = 3.0;
/// Longest drive within a step: a turn by 0.706 rad.
pub const STEP_M: f64 = 0.706 * RADIUS_M;
/// From the rear axle to the front end.
pub const FRONT_M: f64 = 2.0;
/// From the rear axle to the rear end.
pub const BACK_M: f64 = 1.0;
/// Width of the body.
pub const WIDTH_M: f64 = 2.0;
/// Radius of every obstacle.
pub const OBSTACLE_M: f64 = 0.8;
/// Cost factors of the benchmark: of an arc, of reverse gear, of a change between forward and reverse.
const COST_FACTORS: [f64; 3] = [1.5, 2.0, 2.0];

/// The curves of the benchmark's vehicle.
const CURVES: ReedsShepp = ReedsShepp { radius_m: RADIUS_M };

/// The body of the benchmark's vehicle. Its wheelbase decides nothing here.
const BODY: Dimensions = Dimensions {
    length_m: FRONT_M + BACK_M,
    width_m: WIDTH_M,
    wheelbase_m: FRONT_M,
    rear_overhang_m: BACK_M,
    turning_radius_m: RADIUS_M,
    steering_rate_deg_s: None,
};

/// The rules of what touches what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// The benchmark's own: at whole steps only, a circle about each rear axle, and bodies grown by the obstacles' radius
    /// with square corners. Starts are not compared with obstacles.
    Benchmark,
    /// Bodies are rectangles and obstacles discs, at all times.
    Exact,
}

wildfire_base::names! { Mode { Benchmark: "benchmark", Exact: "exact" } }

/// A vehicle: its name, and the poses of its rear axle.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    pub name: String,
    pub start: Pose,
    pub goal: Pose,
}

/// A map with vehicles.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Extents of the map along x and y. Rear axles stay on it, bodies may stick out.
    pub size_m: DVec2,
    /// Centres.
    pub obstacles: Vec<DVec2>,
    pub vehicles: Vec<Vehicle>,
}

/// The way of one vehicle: a segment for each step from the start on, of length 0 where it waits. After its last step the
/// vehicle stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    pub start: Pose,
    pub steps: Vec<Segment>,
}

impl Route {
    /// Returns the metres driven, a wait counted as [`STEP_M`].
    pub fn flowtime_m(&self) -> f64 {
        // The sum of no steps is -0.
        self.steps.iter().map(|&step| step_price_m(step)).sum::<f64>() + 0.0
    }

    /// Returns the cost by the benchmark's factors.
    pub fn cost(&self) -> f64 {
        let [arc, reverse, change] = COST_FACTORS;
        let mut was_reverse = None;
        let mut cost = 0.0;
        for &step in &self.steps {
            let mut price = step_price_m(step);
            // A wait has no direction, and does not hide that the next drive has another one.
            if step.length_m != 0.0 {
                price *= if step.curvature == 0.0 { 1.0 } else { arc };
                price *= if step.is_reverse() { reverse } else { 1.0 };
                price *= if was_reverse.is_some_and(|was| was != step.is_reverse()) { change } else { 1.0 };
                was_reverse = Some(step.is_reverse());
            }
            cost += price;
        }
        cost
    }

    /// Returns the pose at every whole step.
    pub fn poses(&self) -> impl Iterator<Item = Pose> + '_ {
        let after = self.steps.iter().scan(self.start, |pose, step| {
            *pose = step.end(*pose);
            Some(*pose)
        });
        std::iter::once(self.start).chain(after)
    }
}

/// The metres that a step counts.
fn step_price_m(step: Segment) -> f64 {
    if step.length_m == 0.0 { STEP_M } else { step.length_m.abs() }
}

impl Instance {
    /// Returns the sum and the maximum over the vehicles of the shortest drives without any obstacle: lower bounds of the
    /// sum and the maximum of [`Route::flowtime_m`].
    pub fn bounds_m(&self) -> (f64, f64) {
        let lengths = self.vehicles.iter().map(|vehicle| CURVES.length_m(vehicle.start, vehicle.goal));
        lengths.fold((0.0, 0.0), |(sum, max), length| (sum + length, f64::max(max, length)))
    }
}
