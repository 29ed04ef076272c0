//! Plans drives on a map from a file and draws them: `cargo run --example plan_on_my_map [MAP.txt [OUT.png]]`.
//!
//! A map is text with one line per row, northernmost first, `.` for free ground and `#` for a bush. A cell is 5 m wide.

#![expect(clippy::print_stdout, reason = "an example prints what it finds")]

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{FieldFrame, Pose};
use wildfire::grid::Grid;
use wildfire::picture::{DriveScene, DrivenWays, draw_drives};
use wildfire::planning::Goal;
use wildfire::scenario::{Terrain, Unimog};

const CELL_M: f64 = 5.0;
const MY_MAP: &str = "\
....................
....................
.....##########.....
..............#.....
..............#.....
..............#.....
.....##########.....
....................
....................
....................
";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let text = arguments.next().map_or_else(|| Ok(MY_MAP.to_owned()), fs::read_to_string)?;
    // Row 0 of a field is its southernmost row, the last line of the text.
    let rows: Vec<Vec<bool>> = text.lines().rev().map(|line| line.chars().map(|cell| cell == '#').collect()).collect();
    let cols = rows.first().map_or(0, Vec::len);
    let frame = FieldFrame { cols: u16::try_from(cols)?, rows: u16::try_from(rows.len())?, cell_m: CELL_M };
    let terrain = Terrain::from_occupied(frame, Grid::from_values(rows.len(), cols, rows.concat()));

    let truck = Unimog::default();
    let field = Arc::new(ClearanceField::new(frame, &terrain.occupied));
    let checker = CollisionChecker::new(field, truck.vehicle);
    let mut planner = truck.build_planner(&checker, 1)?;

    // From the south-west corner to the middle of the field, and to the north-east corner.
    let (width_m, height_m) = (frame.width_m(), frame.height_m());
    let start = Pose::new(0.1 * width_m, 0.15 * height_m, 0.0);
    let goals = [(0.5, 0.5), (0.85, 0.8)].map(|(x, y)| Goal::Pose(Pose::new(x * width_m, y * height_m, 0.0)));
    let plans = goals.map(|goal| planner.plan(start, goal).path);
    for plan in &plans {
        match plan {
            Ok(path) => println!("{:6.1} m with {} cusps", path.length_m(), path.cusps()),
            Err(failure) => println!("no path: {failure}"),
        }
    }

    if let Some(name) = arguments.next() {
        let scene = DriveScene {
            title: "my map",
            frame,
            bushes: &terrain.bushes,
            start,
            goals: &[0, 1].map(|index| (goals[index], plans[index].is_ok())),
            ways: &[DrivenWays { name: truck.planner.to_string(), paths: plans.iter().flatten().collect() }],
        };
        draw_drives(&scene).write_png(Path::new(&name))?;
    }
    Ok(())
}
