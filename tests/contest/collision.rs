//! The collision layer on fields that others made, where they are at hand.

use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{FieldFrame, Pose};
use wildfire::grid::Grid;
use wildfire::vehicle::Dimensions;

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
}

#[test]
fn starts_and_goals_of_the_reference_fields_keep_half_a_metre() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/reference/plan");
    if !folder.is_dir() {
        eprintln!("skipped: no reference fields here");
        return;
    }
    let mut least = f64::INFINITY;
    for number in 0..5 {
        let text = std::fs::read_to_string(folder.join(format!("field_{number:02}.json"))).expect("the field is there");
        let field: Field = serde_json::from_str(&text).expect("the field is well formed");
        let mut occupied = Grid::filled(field.n.into(), field.n.into(), false);
        for &(col, row) in &field.cells_cr {
            occupied[(row, col)] = true;
        }
        let frame = FieldFrame { cols: field.n, rows: field.n, cell_m: field.cell_m };
        let clearances = Arc::new(ClearanceField::new(frame, &occupied));
        let checker = CollisionChecker::new(clearances, Dimensions::default());
        for [x, y, heading] in field.goals.iter().map(|goal| goal.pose).chain([field.start]) {
            least = least.min(checker.clearance(Pose::new(x, y, heading)));
        }
    }
    assert!((0.499..0.7).contains(&least), "the tightest pose keeps {least} m");
}
