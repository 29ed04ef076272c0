//! Random fields and drives for the tests of the planners.

use std::sync::Arc;

use glam::DVec2;
use rand::{Rng, RngExt};

use crate::collision::{ClearanceField, CollisionChecker, MOTION_TOLERANCE_M};
use wildfire_base::geometry::{FieldFrame, Pose, ops};
use wildfire_base::rng::{self, Xoshiro256PlusPlus};
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::{Dimensions, Path, ReedsShepp};
use wildfire_grid::Grid;

use super::kit::drive_cost::DriveCost;
use super::memory::MemoryMeter;
use super::reachability::Reachability;
use super::registry::{OwnedSettings, PlannerContext};
use super::{Goal, GoalDisc, TruckPlanner};

/// A field of 30 x 30 cells with walks of four cells about it, the truck on it, and places to drive to.
pub struct TestField {
    pub checker: CollisionChecker,
    pub start: Pose,
    /// Centres of the bushes.
    pub bushes: Vec<DVec2>,
    pub rng: Xoshiro256PlusPlus,
}

impl TestField {
    pub fn random(seed: u64, walks: u32) -> Self {
        let mut rng = rng::stream(seed, "planning/test");
        let frame = FieldFrame { cols: 30, rows: 30, cell_m: 5.0 };
        let start = Pose::new(50.0, 50.0, 0.0);
        let body = Dimensions::default();
        let mut occupied = Grid::filled(30, 30, false);
        for _ in 0..walks {
            let mut row = rng.random_range(0..30usize);
            let mut col = rng.random_range(0..30usize);
            for _ in 0..4 {
                let centre = DVec2::new(col as f64 + 0.5, row as f64 + 0.5) * frame.cell_m;
                occupied[(row, col)] |= centre.distance(body.body_centre(start)) > 14.0;
                if rng.random_bool(0.5) {
                    row = (row + 1).min(29);
                } else {
                    col = if rng.random_bool(0.5) { col.saturating_sub(1) } else { (col + 1).min(29) };
                }
            }
        }
        Self::new(frame, &occupied, start, rng)
    }

    /// A field of `#` and `.`, cells of 5 m, north edge first; the truck starts at `start`.
    pub fn drawn(picture: &[&str], start: Pose) -> Self {
        let (rows, cols) = (picture.len(), picture[0].len());
        let frame = FieldFrame { cols: cols as u16, rows: rows as u16, cell_m: 5.0 };
        let bushes = picture.iter().rev().flat_map(|line| line.bytes().map(|byte| byte == b'#')).collect();
        Self::new(frame, &Grid::from_values(rows, cols, bushes), start, rng::stream(0, "planning/drawn"))
    }

    /// The same field, with its truck, in other units of length.
    pub fn scaled(&self, scale: f64) -> Self {
        let frame = *self.checker.field().frame();
        let frame = FieldFrame { cell_m: scale * frame.cell_m, ..frame };
        let field = Arc::new(ClearanceField::new(frame, self.checker.field().occupied()));
        let start = Pose { x: scale * self.start.x, y: scale * self.start.y, ..self.start };
        let bushes = self.bushes.iter().map(|&centre| scale * centre).collect();
        let checker = CollisionChecker::new(field, scaled_body(self.checker.body(), scale));
        Self { checker, start, bushes, rng: self.rng.clone() }
    }

    fn new(frame: FieldFrame, occupied: &Grid<bool>, start: Pose, rng: Xoshiro256PlusPlus) -> Self {
        let bushes = (0..frame.cell_count()).filter(|&i| occupied.values()[i]).map(|i| frame.centre(frame.cell(i)));
        let bushes = bushes.collect();
        let field = Arc::new(ClearanceField::new(frame, occupied));
        Self { checker: CollisionChecker::new(field, Dimensions::default()), start, bushes, rng }
    }

    /// Makes a planner on the field, whose random streams come from a seed.
    pub fn make<T>(&self, settings: &OwnedSettings, seed: u64, make: impl FnOnce(&PlannerContext<'_>) -> T) -> T {
        let stream = |name: &str| rng::stream(seed, name);
        let memory = MemoryMeter::unlimited();
        make(&PlannerContext {
            truck: 0,
            body: self.checker.body(),
            limits: &SpeedLimits::new(8.0, 8.0),
            cost: DriveCost::Length,
            ground: None,
            checker: &self.checker,
            custom_settings: &serde_json::Value::Null,
            stream: &stream,
            memory: &memory,
            settings: &settings.all(),
        })
    }

    /// The disc about a random bush from which a truck with a reach of 10 m puts it out.
    pub fn random_goal(&mut self) -> GoalDisc {
        let bush = self.rng.random_range(0..self.bushes.len());
        GoalDisc { centre: self.bushes[bush], radius_m: 10.0 }
    }
}

fn scaled_body(body: &Dimensions, scale: f64) -> Dimensions {
    Dimensions {
        length_m: scale * body.length_m,
        width_m: scale * body.width_m,
        wheelbase_m: scale * body.wheelbase_m,
        rear_overhang_m: scale * body.rear_overhang_m,
        turning_radius_m: scale * body.turning_radius_m,
        ..*body
    }
}

/// The least clearance along a path, sampled every 2 cm.
pub fn least_clearance(checker: &CollisionChecker, path: &Path) -> f64 {
    let samples = path.legs().flat_map(|(pose, segment)| {
        let steps = (segment.length_m.abs() / 0.02).ceil();
        (0..=steps as u32).map(move |k| segment.pose_at(pose, segment.length_m * f64::from(k) / steps.max(1.0)))
    });
    samples.map(|pose| checker.clearance(pose)).fold(checker.clearance(path.start), f64::min)
}

/// Panics unless a path leads from `start` into the disc, as sharp as the truck can turn, and touches nothing.
pub fn assert_drivable(checker: &CollisionChecker, path: &Path, start: Pose, goal: GoalDisc) {
    assert_eq!(path.start, start);
    let gap = checker.body().body_centre(path.end()).distance(goal.centre);
    assert!(gap < goal.radius_m, "ends {gap} m from the goal's centre");
    let sharpest = checker.body().max_curvature() + 1e-12;
    assert!(path.segments.iter().all(|segment| segment.curvature.abs() <= sharpest));
    let clearance = least_clearance(checker, path);
    assert!(clearance > 0.0, "clearance {clearance}");
}

/// Panics unless a path ends in its goal.
pub fn assert_ends_in(checker: &CollisionChecker, path: &Path, goal: Goal) {
    let end = path.end();
    match goal {
        Goal::Pose(pose) => {
            assert!(end.position().distance(pose.position()) < 1e-6, "{end:?}, not {pose:?}");
            assert!(ops::wrap_angle(end.heading - pose.heading).abs() < 1e-6, "{end:?}, not {pose:?}");
        }
        Goal::Disc(disc) => {
            let gap = checker.body().body_centre(end).distance(disc.centre);
            assert!(gap <= disc.radius_m + 1e-6, "ends {gap} m from the goal's centre");
        }
    }
}

/// A random pose in a field that keeps a clearance.
pub fn random_free_pose(field: &mut TestField, clearance_m: f64) -> Pose {
    loop {
        let pose = random_pose(&mut field.rng, 150.0);
        if field.checker.pose_is_free(pose, clearance_m) {
            return pose;
        }
    }
}

/// A court with one gate: as wide as a cell, or shut, or open at a corner only.
pub fn court_with_gate(gate: &'static str) -> TestField {
    let picture = [
        "....................",
        "....................",
        "........########....",
        "........#......#....",
        "........#......#....",
        gate,
        "........#......#....",
        "........########....",
        "....................",
        "....................",
    ];
    TestField::drawn(&picture, Pose::new(12.0, 22.0, 0.0))
}

/// A field with a court that has no gate; the truck is outside.
pub fn shut_court() -> TestField {
    court_with_gate("........#......#....")
}

/// A random pose, free or not.
pub fn random_pose(rng: &mut impl Rng, side_m: f64) -> Pose {
    Pose::new(rng.random_range(0.0..side_m), rng.random_range(0.0..side_m), rng.random_range(-3.1..3.1))
}

/// The numbers of drives by their ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drives {
    pub solved: u32,
    /// Refused by the planner and by the flood.
    pub unreachable: u32,
    /// Refused by the planner, though the flood reaches the goal.
    pub missed: u32,
}

/// Eighteen drives on each of `fields` random fields, each from where the last one ended.
///
/// # Panics
/// If a path is not drivable.
pub fn drives_in_a_row(fields: u64, walks: u32, planner: impl Fn(&TestField, u64) -> Box<dyn TruckPlanner>) -> Drives {
    let mut drives = Drives::default();
    for seed in 0..fields {
        let mut field = TestField::random(seed, walks);
        let mut planner = planner(&field, seed);
        let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
        let mut pose = field.start;
        for _ in 0..18 {
            let goal = field.random_goal();
            match planner.plan(pose, goal.into()).path {
                Ok(path) => {
                    assert_drivable(&field.checker, &path, pose, goal);
                    pose = path.end();
                    drives.solved += 1;
                }
                Err(_) if reachability.reaches(goal) => drives.missed += 1,
                Err(_) => drives.unreachable += 1,
            }
        }
    }
    drives
}

/// Counts the solved ones of `each` drives from the start to free poses, on each of `fields` random fields.
///
/// # Panics
/// If a path does not lead from start to end, turns too sharply, meets a bush, or is shorter than on an empty field.
pub fn drives_to_poses(fields: u64, each: u32, planner: impl Fn(&TestField, u64) -> Box<dyn TruckPlanner>) -> u32 {
    let mut solved = 0;
    for seed in 0..fields {
        let mut field = TestField::random(seed, 40);
        let curves = ReedsShepp { radius_m: field.checker.body().turning_radius_m };
        let mut planner = planner(&field, seed);
        for _ in 0..each {
            let start = field.start;
            let end = random_free_pose(&mut field, 0.3);
            let Ok(path) = planner.plan(start, Goal::Pose(end)).path else { continue };
            assert_eq!(path.start, start);
            assert_ends_in(&field.checker, &path, Goal::Pose(end));
            assert!(path.segments.iter().all(|segment| segment.curvature.abs() <= 1.0 / curves.radius_m));
            assert!(least_clearance(&field.checker, &path) > 0.0);
            assert!(path.length_m() >= curves.length_m(start, end) - 1e-9);
            solved += 1;
        }
    }
    solved
}

/// Counts the paths that keep a clearance among those to forty random poses of which some have it.
pub fn paths_that_keep(clearance_m: f64, planner: impl Fn(&TestField, u64) -> Box<dyn TruckPlanner>) -> u32 {
    let field = TestField::random(4, 15);
    let mut planner = planner(&field, 4);
    let mut rng = rng::stream(4, "goals");
    let mut kept = 0;
    for _ in 0..40 {
        let goal = random_pose(&mut rng, 150.0);
        if field.checker.pose_is_free(goal, 1.0)
            && let Ok(path) = planner.plan(field.start, Goal::Pose(goal)).path
        {
            kept += u32::from(least_clearance(&field.checker, &path) > clearance_m - MOTION_TOLERANCE_M);
        }
    }
    kept
}
