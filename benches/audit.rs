//! What the audit costs on free legs of a field like the contest's, on the thread's CPU clock.
//!
//! `cargo bench --bench audit`

use std::sync::Arc;

use rand::RngExt;
use wildfire::audit::{Audited, Ground, Manners, Outline, Step, audit_leg};
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{Cell, FieldFrame, Pose};
use wildfire::grid::Grid;
use wildfire::rng;
use wildfire::time::SimTime;
use wildfire::time::cpu::CpuStopwatch;
use wildfire::timeline::Body;
use wildfire::trajectory::{SpeedLimits, Trajectory};
use wildfire::vehicle::{Dimensions, Path, Segment};

const LEGS: usize = 500;

#[expect(clippy::print_stdout, reason = "a benchmark prints its figures")]
fn main() {
    let mut rng = rng::stream(1, "bench/audit");
    let frame = FieldFrame { cols: 50, rows: 50, cell_m: 5.0 };
    let bushes: Vec<Cell> =
        (0..frame.cell_count()).filter(|_| rng.random_bool(0.0936)).map(|index| frame.cell(index)).collect();
    let mut occupied = Grid::filled(50, 50, false);
    for &cell in &bushes {
        occupied.values_mut()[frame.index(cell)] = true;
    }
    let checker = CollisionChecker::new(Arc::new(ClearanceField::new(frame, &occupied)), Dimensions::default());
    let limits = SpeedLimits::of_speed(8.0, 8.0);
    let mut legs = Vec::new();
    while legs.len() < LEGS {
        let start = Pose::new(rng.random_range(0.0..250.0), rng.random_range(0.0..250.0), rng.random_range(-3.0..3.0));
        let mut path = Path::standing(start);
        for _ in 0..5 {
            let curvature = f64::from(rng.random_range(-1..=1)) / 13.0;
            let segment = Segment { curvature, length_m: rng.random_range(-8.0..8.0) };
            if checker.motion_is_free(path.end(), segment, 0.1) {
                path.segments.push(segment);
            }
        }
        if path.length_m() > 10.0 {
            legs.push(Trajectory::along(&path, SimTime::ZERO, limits));
        }
    }

    let ground = Ground::new(frame, &bushes, Outline::of(&Body::Truck(*checker.body())));
    let manners = Manners { turning_radius_m: Some(checker.body().turning_radius_m), limits: Some(limits) };
    let mut watch = CpuStopwatch::start();
    let mut audited = Audited::default();
    for leg in &legs {
        audited += audit_leg(&ground, &manners, leg, Step::default()).expect("free legs pass");
    }
    let seconds = watch.lap().as_secs_f64();
    println!("{} legs, {:.0} m, {} poses", audited.legs, audited.metres, audited.poses);
    println!("{:8.1} ns a pose", 1e9 * seconds / audited.poses as f64);
    println!("{:8.1} us a metre", 1e6 * seconds / audited.metres);
    let thousand_runs_m = 1000.0 * 150.0 * 20.0;
    println!("{:8.1} min for 1000 runs of 150 legs of 20 m", seconds / audited.metres * thousand_runs_m / 60.0);
}
