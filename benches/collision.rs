//! Costs of the collision layer on a field like the contest's, on the thread's CPU clock: medians over repetitions.
//!
//! `cargo bench --bench collision`

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::hint::black_box;
use std::sync::Arc;

use glam::DVec2;
use rand::RngExt;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{FieldFrame, Pose};
use wildfire::grid::Grid;
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::time::cpu::CpuStopwatch;
use wildfire::vehicle::{Dimensions, Segment};

const REPETITIONS: usize = 21;

fn main() {
    let mut rng = rng::stream(1, "bench/collision");
    let frame = FieldFrame { cols: 50, rows: 50, cell_m: 5.0 };
    let cells = (0..frame.cell_count()).map(|_| rng.random_bool(0.0936)).collect();
    let occupied = Grid::from_values(50, 50, cells);
    let build = median_ns(|| {
        black_box(ClearanceField::new(frame, &occupied));
    });
    println!("clearance field, 50 x 50 cells of 5 m          {:8.3} ms", build / 1e6);

    let field = Arc::new(ClearanceField::new(frame, &occupied));
    let checker = CollisionChecker::new(field.clone(), Dimensions::default());
    let poses: Vec<Pose> = (0..20_000).map(|_| random_pose(&mut rng)).collect();
    let free: Vec<Pose> = poses.iter().copied().filter(|&pose| checker.pose_is_free(pose, 0.5)).collect();
    let share = free.len() as f64 / poses.len() as f64;

    let point = |pose: &Pose| field.lower_bound(pose.position());
    report("field at a point", per_item(&poses, point), "ns");
    report("exact distance of a point", per_item(&poses, |pose| field.distance(pose.position())), "ns");
    report("pose, anywhere", per_item(&poses, |&pose| checker.pose_is_free(pose, 0.5)), "ns");
    report("pose, free ones", per_item(&free, |&pose| checker.pose_is_free(pose, 0.5)), "ns");
    report("clearance of a pose, free ones", per_item(&free, |&pose| checker.clearance(pose)), "ns");
    println!("  ({:.1} % of random poses keep 0.5 m)", 100.0 * share);

    for length_m in [4.0, 15.0] {
        motions(&checker, &free, length_m, &mut rng);
    }
    lines(&field, &mut rng);
}

fn motions(checker: &CollisionChecker, starts: &[Pose], length_m: f64, rng: &mut Xoshiro256PlusPlus) {
    let drawn: Vec<(Pose, Segment)> = starts
        .iter()
        .map(|&start| {
            let curvature = [-1.0, 0.0, 1.0][rng.random_range(0..3)] / 13.0;
            (start, Segment { curvature, length_m: if rng.random_bool(0.5) { length_m } else { -length_m } })
        })
        .collect();
    for floor in [0.1, 0.5, 0.75] {
        let (free, blocked): (Vec<_>, Vec<_>) =
            drawn.iter().partition(|(start, segment)| checker.motion_is_free(*start, *segment, floor));
        let check = |&(start, segment): &(Pose, Segment)| checker.motion_is_free(start, segment, floor);
        let prefix = |&(start, segment): &(Pose, Segment)| checker.motion_prefix_free(start, segment, floor);
        println!("motions of {length_m} m, floor {floor} m: {} free, {} blocked", free.len(), blocked.len());
        report("  free, per metre", per_item(&free, check) / length_m, "ns");
        report("  free, from the start on, per metre", per_item(&free, prefix) / length_m, "ns");
        report("  blocked, each", per_item(&blocked, check), "ns");
    }
}

fn lines(field: &ClearanceField, rng: &mut Xoshiro256PlusPlus) {
    let random_point = |rng: &mut Xoshiro256PlusPlus| random_pose(rng).position();
    let drawn: Vec<(DVec2, DVec2)> = (0..20_000)
        .map(|_| {
            let from = random_point(rng);
            (from, from + 20.0 * random_pose(rng).direction())
        })
        .collect();
    let (free, blocked): (Vec<_>, Vec<_>) = drawn.iter().partition(|(from, to)| field.line_is_free(*from, *to, 2.0));
    let check = |&(from, to): &(DVec2, DVec2)| field.line_is_free(from, to, 2.0);
    println!("lines of 20 m, radius 2 m: {} free, {} blocked", free.len(), blocked.len());
    report("  free, per metre", per_item(&free, check) / 20.0, "ns");
    report("  blocked, each", per_item(&blocked, check), "ns");
}

fn random_pose(rng: &mut Xoshiro256PlusPlus) -> Pose {
    Pose::new(rng.random_range(0.0..250.0), rng.random_range(0.0..250.0), rng.random_range(-3.0..3.0))
}

/// Median cost of a call in nanoseconds, over all items together.
fn per_item<T, R>(items: &[T], mut call: impl FnMut(&T) -> R) -> f64 {
    let pass = || {
        for item in items {
            black_box(call(black_box(item)));
        }
    };
    median_ns(pass) / items.len() as f64
}

fn median_ns(mut work: impl FnMut()) -> f64 {
    let mut costs: Vec<u128> = (0..REPETITIONS)
        .map(|_| {
            let mut watch = CpuStopwatch::start();
            work();
            watch.elapsed_since_last().as_nanos()
        })
        .collect();
    costs.sort_unstable();
    costs[REPETITIONS / 2] as f64
}

fn report(what: &str, value: f64, unit: &str) {
    println!("{what:<46} {value:8.1} {unit}");
}
