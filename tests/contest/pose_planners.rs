//! The planners `prm-rs` and `hybrid-astar` on problems that others solved too, judged by a check of its own.

use std::sync::Arc;

use serde::Deserialize;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, FieldFrame, OrientedRect, Pose, ops};
use wildfire::grid::Grid;
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::{Goal, GoalDisc, PlannerContext, TruckPlanner, TruckPlannerKind};
use wildfire::rng;
use wildfire::scenario::Unimog;
use wildfire::vehicle::{Dimensions, Path};

use crate::reference::both;

/// Spacing of the poses that are looked at.
const SPACING_M: f64 = 0.02;
const MAX_CURVATURE: f64 = 1.0 / 13.0;
const REACH_M: f64 = 10.0;
const PLANNERS: [TruckPlannerKind; 2] = [TruckPlannerKind::PrmRs, TruckPlannerKind::HybridAstar];

#[derive(Clone, Deserialize)]
struct FieldFile {
    cells_cr: Vec<[u16; 2]>,
    n: u16,
    cell_m: f64,
    start: [f64; 3],
    goals: Vec<GoalFile>,
}

#[derive(Clone, Deserialize)]
struct GoalFile {
    pose: [f64; 3],
}

impl FieldFile {
    fn start(&self) -> Pose {
        pose(self.start)
    }

    fn frame(&self) -> FieldFrame {
        FieldFrame { cols: self.n, rows: self.n, cell_m: self.cell_m }
    }

    fn occupied(&self) -> Grid<bool> {
        let mut occupied = Grid::filled(self.n.into(), self.n.into(), false);
        for &[col, row] in &self.cells_cr {
            occupied[(row.into(), col.into())] = true;
        }
        occupied
    }

    fn planner(&self, kind: TruckPlannerKind) -> Box<dyn TruckPlanner> {
        let field = Arc::new(ClearanceField::new(self.frame(), &self.occupied()));
        let checker = CollisionChecker::new(field, Dimensions::default());
        let (truck, memory) = (Unimog::default(), MemoryMeter::unlimited());
        let (settings, stream) = (truck.planner_settings(), |name: &str| rng::stream(1, name));
        kind.maker().make(&PlannerContext {
            ground: None,
            truck: 0,
            body: checker.body(),
            limits: &truck.speed_limits(),
            cost: truck.cost,
            checker: &checker,
            custom_settings: &serde_json::Value::Null,
            stream: &stream,
            memory: &memory,
            settings: &settings,
        })
    }
}

fn pose([x, y, heading]: [f64; 3]) -> Pose {
    Pose::new(x, y, heading)
}

fn reference_fields() -> Vec<FieldFile> {
    let paths =
        both("plan").flat_map(|folder| (0..5).map(move |number| folder.join(format!("field_{number:02}.json"))));
    let texts: Vec<_> = paths.filter_map(|path| std::fs::read(path).ok()).collect();
    texts.iter().map(|text| serde_json::from_slice(text).expect("a field file")).collect()
}

/// Whether the body overlaps a bush or leaves the field, by the separating axes of rectangle and squares.
fn collides(occupied: &Grid<bool>, frame: &FieldFrame, body: &OrientedRect) -> bool {
    let corners = body.corners();
    let (low, high) = corners.iter().fold((corners[0], corners[0]), |(low, high), &c| (low.min(c), high.max(c)));
    if low.min_element() < 0.0 || high.x > frame.width_m() || high.y > frame.height_m() {
        return true;
    }
    let index = |metres: f64| (metres / frame.cell_m) as usize;
    let rows = index(low.y)..=index(high.y).min(occupied.rows() - 1);
    rows.flat_map(|row| (index(low.x)..=index(high.x).min(occupied.cols() - 1)).map(move |col| (row, col)))
        .any(|(row, col)| occupied[(row, col)] && overlaps_cell(body, row, col, frame.cell_m))
}

/// The cell meets the box about the body; only the body's own axes can still separate them.
fn overlaps_cell(body: &OrientedRect, row: usize, col: usize, cell_m: f64) -> bool {
    let centre = DVec2::new(col as f64 + 0.5, row as f64 + 0.5) * cell_m;
    let axis = body.centre.direction();
    [(axis, body.half_length), (axis.perp(), body.half_width)].into_iter().all(|(axis, half)| {
        let reach = half + 0.5 * cell_m * (axis.x.abs() + axis.y.abs());
        (centre - body.centre.position()).dot(axis).abs() < reach
    })
}

fn assert_clean(field: &FieldFile, occupied: &Grid<bool>, path: &Path, what: &str) {
    assert_eq!(path.start, field.start(), "{what}");
    assert!(path.segments.iter().all(|segment| segment.curvature.abs() <= MAX_CURVATURE), "{what}: too sharp");
    let (body, frame) = (Dimensions::default(), field.frame());
    for (driven_m, pose) in path.samples(SPACING_M) {
        assert!(!collides(occupied, &frame, &body.footprint(pose)), "{what}: collides after {driven_m} m");
    }
}

/// Every field with every planner, and words that say which.
fn cases() -> impl Iterator<Item = (FieldFile, TruckPlannerKind, String)> {
    let fields = reference_fields().into_iter().enumerate();
    fields.flat_map(|(number, field)| PLANNERS.map(|kind| (field.clone(), kind, format!("{kind}, field {number}"))))
}

#[test]
fn all_problems_of_the_reference_are_solved_and_every_path_is_clean() {
    for (field, kind, what) in cases() {
        let (mut planner, occupied) = (field.planner(kind), field.occupied());
        for (index, goal) in field.goals.iter().enumerate() {
            let what = format!("{what}, goal {index}");
            let goal = pose(goal.pose);
            let path = planner.plan(field.start(), Goal::Pose(goal)).path.unwrap_or_else(|why| panic!("{what}: {why}"));
            assert_clean(&field, &occupied, &path, &what);
            let end = path.end();
            assert!(end.position().distance(goal.position()) < 1e-3, "{what}: ends elsewhere");
            assert!(ops::wrap_angle(end.heading - goal.heading).abs() < 1e-3, "{what}: ends turned");
        }
    }
}

#[test]
fn every_bush_of_the_reference_is_reached_by_clean_paths() {
    for (field, kind, what) in cases() {
        let (mut planner, occupied) = (field.planner(kind), field.occupied());
        // Every fifth, to be quick.
        for &[col, row] in field.cells_cr.iter().step_by(5) {
            let what = format!("{what}, bush ({col}, {row})");
            let centre = DVec2::new(f64::from(col) + 0.5, f64::from(row) + 0.5) * field.cell_m;
            let plan = planner.plan(field.start(), Goal::Disc(GoalDisc { centre, radius_m: REACH_M }));
            let path = plan.path.unwrap_or_else(|why| panic!("{what}: {why}"));
            assert_clean(&field, &occupied, &path, &what);
            assert!(Dimensions::default().body_centre(path.end()).distance(centre) <= REACH_M, "{what}: too far away");
        }
    }
}

#[test]
fn the_check_of_these_tests_sees_collisions() {
    let frame = FieldFrame { cols: 10, rows: 10, cell_m: 5.0 };
    let mut occupied = Grid::filled(10, 10, false);
    occupied[(4, 4)] = true;
    let body = Dimensions::default();
    let at = |x, y, heading| collides(&occupied, &frame, &body.footprint(Pose::new(x, y, heading)));
    assert!(at(22.0, 22.0, 1.0) && at(16.1, 22.0, 0.0) && at(27.0, 18.89, 3.1) && at(0.9, 10.0, 0.0));
    assert!(!at(16.0, 22.0, 0.0) && !at(22.0, 18.89, 0.0) && !at(0.96, 10.0, 0.0) && !at(26.0, 17.0, -0.785));
}
