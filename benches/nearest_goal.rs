//! What it costs to find the nearest of several fires by drive, and what it saves: `cargo bench --bench nearest_goal`.
//!
//! Random fields of the contest; a truck anywhere, and five bushes that are at most 120 m away. CPU time of this thread.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::sync::Arc;

use rand::seq::SliceRandom;

use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, Pose};
use wildfire::planning::kit::ends::free_poses;
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::{
    Goal, GoalDisc, NullObserver, Plan, Planners, TruckPlanner, TruckPlannerKind, plan_to_nearest,
};
use wildfire::rng;
use wildfire::scenario::{self, Programs, Terrain, TruckPlannerContext};
use wildfire::time::cpu::CpuStopwatch;
use wildfire::vehicle::Dimensions;

const FIELDS: u64 = 40;
const QUERIES: usize = 50;
const GOALS: usize = 5;
const FAR_M: f64 = 120.0;
const REACH_M: f64 = 10.0;

fn main() {
    println!("nearest of {GOALS} bushes up to {FAR_M} m away; {FIELDS} fields, {QUERIES} queries each; CPU ms, metres");
    println!("{:14} {:>9} {:>11} {:>10} {:>10} {:>7}", "planner", "", "CPU, mean", "median", "length", "ratio");
    for kind in [TruckPlannerKind::HybridAstar, TruckPlannerKind::PrmRs] {
        let mut answers: [Answers; 3] = Default::default();
        (1..=FIELDS).for_each(|seed| ask_on_field(kind, seed, &mut answers));
        let one = answers[0].mean_ms();
        for (name, answers) in ["one disc", "at once", "in turn"].into_iter().zip(&mut answers) {
            let (mean, median) = (answers.mean_ms(), answers.median_ms());
            let length_m = answers.length_m / answers.ms.len() as f64;
            println!("{:14} {name:>9} {mean:>11.3} {median:>10.3} {length_m:>10.2} {:>7.2}", kind.name(), mean / one);
        }
    }
}

/// CPU times of queries, and the metres of all drives.
#[derive(Default)]
struct Answers {
    ms: Vec<f64>,
    length_m: f64,
}

impl Answers {
    fn take(&mut self, query: impl FnOnce() -> Option<Plan>) {
        let mut watch = CpuStopwatch::start();
        let plan = query();
        self.ms.push(1e3 * watch.elapsed_since_last().as_secs_f64());
        self.length_m += plan.and_then(|plan| plan.path.ok()).map_or(0.0, |path| path.length_m());
    }

    fn mean_ms(&self) -> f64 {
        self.ms.iter().sum::<f64>() / self.ms.len() as f64
    }

    fn median_ms(&mut self) -> f64 {
        self.ms.sort_by(f64::total_cmp);
        self.ms[self.ms.len() / 2]
    }
}

/// Asks for the disc that is nearest in a straight line, for the nearest by drive in one search, and for one disc after the
/// other.
fn ask_on_field(kind: TruckPlannerKind, seed: u64, [one, at_once, in_turn]: &mut [Answers; 3]) {
    let scenario =
        scenario::load("contest", &[format!("unimog.planner={}", kind.name())]).expect("a built-in scenario");
    let terrain = Terrain::from_scenario(&scenario, seed).expect("the coverage leaves room");
    let bushes: Vec<DVec2> = terrain.bushes.iter().map(|&cell| terrain.frame.centre(cell)).collect();
    let checker =
        CollisionChecker::new(Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied)), Dimensions::default());
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
    let starts: Vec<Pose> = free_poses(&checker, 0.3, &mut rng).take(QUERIES).collect();
    for start in starts {
        let body = *checker.body();
        let here = body.body_centre(start);
        let gap = |bush: &DVec2| bush.distance(here);
        let near = bushes.iter().copied().filter(|bush| (REACH_M..FAR_M).contains(&gap(bush)));
        let mut discs: Vec<GoalDisc> = near.map(|centre| GoalDisc { centre, radius_m: REACH_M }).collect();
        discs.shuffle(&mut rng);
        discs.truncate(GOALS);
        let nearest = discs.iter().min_by(|a, b| gap(&a.centre).total_cmp(&gap(&b.centre)));
        let Some(&nearest) = nearest else { continue };
        one.take(|| Some(planner.plan(start, nearest.into())));
        at_once.take(|| {
            plan_to_nearest(planner.as_mut(), &body, start, &discs, &mut NullObserver).map(|found| found.plan)
        });
        let mut single = OneGoal(planner.as_mut());
        in_turn.take(|| plan_to_nearest(&mut single, &body, start, &discs, &mut NullObserver).map(|found| found.plan));
    }
}

/// A planner that knows one goal at a time.
struct OneGoal<'a>(&'a mut dyn TruckPlanner);

impl TruckPlanner for OneGoal<'_> {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.0.plan(start, goal)
    }
}
