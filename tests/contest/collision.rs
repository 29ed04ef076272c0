//! The collision layer, whose clearances others computed too.

use std::sync::Arc;

use serde::Deserialize;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{FieldFrame, Pose};
use wildfire::grid::Grid;
use wildfire::vehicle::Dimensions;

use crate::reference::both;

#[derive(Deserialize)]
struct Field {
    n: u16,
    cell_m: f64,
    cells_cr: Vec<(usize, usize)>,
    start: [f64; 3],
    goals: Vec<Goal>,
}

#[derive(Deserialize)]
struct Goal {
    pose: [f64; 3],
    /// How far the truck stands from the next bush and from the border, by another library.
    clearance_m: Option<f64>,
}

#[test]
fn starts_and_goals_of_the_reference_fields_keep_half_a_metre() {
    let mut min = f64::INFINITY;
    let files =
        both("plan").flat_map(|folder| (0..5).map(move |number| folder.join(format!("field_{number:02}.json"))));
    for file in files.filter(|file| file.exists()) {
        let text = std::fs::read_to_string(file).expect("it can be read");
        let field: Field = serde_json::from_str(&text).expect("the field is well formed");
        let mut occupied = Grid::filled(field.n.into(), field.n.into(), false);
        for &(col, row) in &field.cells_cr {
            occupied[(row, col)] = true;
        }
        let frame = FieldFrame { cols: field.n, rows: field.n, cell_m: field.cell_m };
        let clearances = Arc::new(ClearanceField::new(frame, &occupied));
        let checker = CollisionChecker::new(clearances, Dimensions::default());
        for goal in &field.goals {
            let [x, y, heading] = goal.pose;
            let found_m = checker.clearance(Pose::new(x, y, heading));
            let expected_m = goal.clearance_m.unwrap_or(found_m);
            // Below one metre it is the distance, beyond that a lower bound of it.
            let apart_m = found_m.min(1.0) - expected_m.min(1.0);
            assert!(
                apart_m.abs() < 1e-9 && found_m < expected_m + 1e-9,
                "{:?}: {found_m}, not {expected_m}",
                goal.pose
            );
        }
        for [x, y, heading] in field.goals.iter().map(|goal| goal.pose).chain([field.start]) {
            min = min.min(checker.clearance(Pose::new(x, y, heading)));
        }
    }
    assert!((0.499..0.7).contains(&min), "the tightest pose keeps {min} m");
}
