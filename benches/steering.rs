//! What wheels that take their time to turn cost a drive, and what smooth curvature saves of it:
//! `cargo bench --bench steering`.
//!
//! Random fields of the contest, the truck of `fleet`, random bushes one after the other. Every path is planned as if
//! wheels turned at once, and then driven with stops at its corners, and made smooth. CPU time of this thread.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::sync::Arc;

use rand::RngExt;

use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::DVec2;
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::smooth_steering::CurvatureSmoother;
use wildfire::planning::{Goal, GoalDisc, Planners};
use wildfire::rng;
use wildfire::scenario::{self, Programs, Scenario, Terrain, TruckPlannerContext};
use wildfire::time::cpu::CpuStopwatch;
use wildfire::trajectory::SpeedLimits;
use wildfire::vehicle::{Dimensions, Path};

const FIELDS: u64 = 20;
const DRIVES: usize = 50;
const REACH_M: f64 = 10.0;
/// Degrees a second of the front wheels.
const RATES: [f64; 4] = [40.0, 20.0, 10.0, 5.0];

fn main() {
    let paths: Vec<(CollisionChecker, Vec<Path>)> = (1..=FIELDS).map(planned).collect();
    let drives: usize = paths.iter().map(|(_, paths)| paths.len()).sum();
    let fleet = scenario::load("fleet", &[]).expect("a built-in scenario").unimog[0].speed_limits();
    let at_once_s: f64 = paths.iter().flat_map(|(_, paths)| paths).map(|path| fleet.drive_s(&path.segments)).sum();
    println!("{drives} drives on {FIELDS} fields; means");
    println!("wheels that turn at once: {:.2} s a drive", at_once_s / drives as f64);
    println!("deg/s  with stops, s  smooth, s  stops before  after  at cusps  smoothing, CPU us");
    for rate in RATES {
        let (mut stops_s, mut smooth_s, mut before, mut after, mut cusps, mut cpu_s) = (0.0, 0.0, 0, 0, 0, 0.0);
        for (checker, paths) in &paths {
            let body = Dimensions { steering_rate_deg_s: Some(rate), ..*checker.body() };
            let limits = SpeedLimits { steering: body.steering_limits(), ..fleet };
            let smoother = CurvatureSmoother::new(checker, &limits).expect("its wheels take their time");
            for path in paths {
                let mut watch = CpuStopwatch::start();
                let smooth = smoother.smooth(path, false);
                cpu_s += watch.elapsed_since_last().as_secs_f64();
                stops_s += limits.drive_s(&path.segments);
                smooth_s += limits.drive_s(&smooth.segments);
                before += stops_at_corners(path, &limits);
                after += stops_at_corners(&smooth, &limits);
                cusps += path.cusps();
            }
        }
        let mean = |sum: f64| sum / drives as f64;
        println!(
            "{rate:>5} {:>14.2} {:>10.2} {:>13.2} {:>6.2} {:>9.2} {:>18.0}",
            mean(stops_s),
            mean(smooth_s),
            mean(before.into()),
            mean(after.into()),
            mean(cusps.into()),
            1e6 * mean(cpu_s)
        );
    }
}

/// Counts where a truck stands on its way, cusps aside.
fn stops_at_corners(path: &Path, limits: &SpeedLimits) -> u32 {
    let steering = limits.steering.expect("its wheels take their time");
    let pairs = path.segments.windows(2);
    let stops = pairs.filter(|pair| {
        pair[0].is_reverse() == pair[1].is_reverse() && !steering.is_step(pair[0].curvature, pair[1].curvature)
    });
    stops.count() as u32
}

/// Returns drives from one random bush to another on the field of a seed, each from where the last one ended.
fn planned(seed: u64) -> (CollisionChecker, Vec<Path>) {
    let scenario: Scenario = scenario::load("contest", &[]).expect("a built-in scenario");
    let terrain = Terrain::from_scenario(&scenario, seed).expect("the coverage leaves room");
    let bushes: Vec<DVec2> = terrain.bushes.iter().map(|&cell| terrain.frame.centre(cell)).collect();
    let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    let checker = CollisionChecker::new(field, scenario.unimog[0].vehicle);
    let context = TruckPlannerContext {
        ground: None,
        truck: 0,
        seed,
        checker: &checker,
        memory: &MemoryMeter::unlimited(),
        planners: &Planners::default(),
        programs: &Programs::new(),
    };
    let mut planner = scenario.unimog[0].make_planner(&context).expect("a built-in planner");
    let mut rng = rng::stream(seed, "bench");
    let mut pose = scenario.unimog[0].start.pose();
    let mut paths = Vec::new();
    for _ in 0..DRIVES {
        let disc = GoalDisc { centre: bushes[rng.random_range(0..bushes.len())], radius_m: REACH_M };
        if let Ok(path) = planner.plan(pose, Goal::Disc(disc)).path {
            pose = path.end();
            paths.push(path);
        }
    }
    (checker, paths)
}
