//! What the truck's planner costs and gives: `cargo bench --bench planning`.
//!
//! Random fields of the contest; short goals as a truck meets them (a bush 10 to 40 m away) and far ones. Every drive begins
//! where the last one ended, or at the start after a failure. CPU time of this thread.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::sync::Arc;
use std::time::Duration;

use rand::RngExt;
use rand::seq::IndexedRandom;

use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, Pose};
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::planners::prm_primitives::PrmPrimitives;
use wildfire::planning::reachability::Reachability;
use wildfire::planning::{
    BuildReport, GoalDisc, Plan, PlanFailure, PlannerContext, QueryMonitor, QueryTime, TruckPlanner,
};
use wildfire::rng;
use wildfire::scenario::{Scenario, Terrain, Unimog};
use wildfire::time::cpu::CpuStopwatch;
use wildfire::vehicle::{Dimensions, Path};

const FIELDS: u64 = 40;
/// The flood is asked for every bush of the first fields.
const FLOODED_FIELDS: u64 = 5;
const DRIVES: usize = 200;
const REACH_M: f64 = 10.0;
const START: Pose = Pose { x: 50.0, y: 50.0, heading: 0.0 };

fn main() {
    for coverage in [0.1, 0.2] {
        println!("\n{:.0} % of the cells under bushes, {FIELDS} fields", 100.0 * coverage);
        let mut builds = Builds::default();
        let mut short = Drives::default();
        let mut far = Drives::default();
        for seed in 1..=FIELDS {
            run_field(coverage, seed, &mut builds, &mut short, &mut far);
        }
        builds.print();
        short.print("goals 10 to 40 m away");
        far.print("goals anywhere");
    }
}

fn contest(coverage: f64) -> Scenario {
    let mut scenario: Scenario = toml::from_str("wumpus = [{}]\nunimog = [{}]").expect("a scenario of defaults");
    scenario.field.coverage = coverage;
    scenario
}

fn run_field(coverage: f64, seed: u64, builds: &mut Builds, short: &mut Drives, far: &mut Drives) {
    let terrain = Terrain::from_scenario(&contest(coverage), seed).expect("the coverage leaves room");
    let bushes: Vec<DVec2> = terrain.bushes.iter().map(|&cell| terrain.frame.centre(cell)).collect();
    let mut watch = CpuStopwatch::start();
    let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    builds.field.push(micros(watch.elapsed_since_last()));
    let checker = CollisionChecker::new(field, Dimensions::default());
    let mut rng = rng::stream(seed, "bench");
    let truck = Unimog::default();
    let (memory, settings, stream) = (MemoryMeter::unlimited(), truck.planner_settings(), |_: &str| rng.clone());
    let site = PlannerContext {
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
    };
    let mut planner = PrmPrimitives::build(&site);
    builds.take(planner.build_report());
    if seed <= FLOODED_FIELDS {
        builds.flood(&checker, &bushes);
    }
    for (drives, min, max) in [(short, 10.0, 40.0), (far, 40.0, f64::INFINITY)] {
        let mut pose = START;
        for _ in 0..DRIVES {
            let here = checker.body().body_centre(pose);
            let fits = |bush: &DVec2| (min..max).contains(&bush.distance(here));
            let fitting: Vec<DVec2> = bushes.iter().copied().filter(fits).collect();
            let bush = *fitting.choose(&mut rng).unwrap_or(&bushes[rng.random_range(0..bushes.len())]);
            let mut monitor = QueryMonitor::new(false);
            let plan = planner.plan_observed(pose, GoalDisc { centre: bush, radius_m: REACH_M }.into(), &mut monitor);
            drives.take_time(monitor.finish().time);
            pose = plan.path.as_ref().map_or(START, Path::end);
            drives.take(plan, here.distance(bush) - REACH_M, &checker);
        }
    }
}

#[derive(Default)]
struct Builds {
    field: Vec<f64>,
    sampling: Vec<f64>,
    connecting: Vec<f64>,
    milestones: Vec<f64>,
    edges: Vec<f64>,
    components: Vec<f64>,
    answers: Vec<f64>,
    reached: u32,
}

impl Builds {
    fn take(&mut self, report: BuildReport) {
        self.sampling.push(micros(report.sampling));
        self.connecting.push(micros(report.connecting));
        self.milestones.push(report.samples.into());
        self.edges.push(report.edges.into());
        self.components.push(report.components.into());
    }

    fn flood(&mut self, checker: &CollisionChecker, bushes: &[DVec2]) {
        let mut reachability = Reachability::new(checker, &MemoryMeter::unlimited(), START);
        for &centre in bushes {
            let mut watch = CpuStopwatch::start();
            self.reached += u32::from(reachability.reaches(GoalDisc { centre, radius_m: REACH_M }));
            self.answers.push(micros(watch.elapsed_since_last()));
        }
    }

    fn print(&mut self) {
        println!(
            "flood: {} of {} bushes reached; microseconds an answer mean {:.1}, median {:.1}, max {:.0}",
            self.reached,
            self.answers.len(),
            mean(&self.answers),
            quantile(&mut self.answers, 0.5),
            quantile(&mut self.answers, 1.0),
        );
        println!(
            "build, median microseconds: clearance field {:.0}, sampling {:.0}, connecting {:.0}; \
             {:.0} milestones, {:.0} edges, components mean {:.2}",
            quantile(&mut self.field, 0.5),
            quantile(&mut self.sampling, 0.5),
            quantile(&mut self.connecting, 0.5),
            mean(&self.milestones),
            mean(&self.edges),
            mean(&self.components),
        );
    }
}

#[derive(Default)]
struct Drives {
    roadmap: Vec<f64>,
    local: Vec<f64>,
    total: Vec<f64>,
    roadmap_expansions: Vec<f64>,
    local_expansions: Vec<f64>,
    ratios: Vec<f64>,
    lengths: Vec<f64>,
    cusps: Vec<f64>,
    clearances: Vec<f64>,
    failures: Vec<PlanFailure>,
}

impl Drives {
    fn take_time(&mut self, time: QueryTime) {
        self.roadmap.push(micros(time.roadmap));
        self.local.push(micros(time.local));
        self.total.push(micros(time.roadmap + time.local));
    }

    fn take(&mut self, plan: Plan, straight: f64, checker: &CollisionChecker) {
        self.roadmap_expansions.push(plan.effort.roadmap_expansions.into());
        self.local_expansions.push(plan.effort.local_expansions.into());
        match plan.path {
            Ok(path) if straight > 1.0 => {
                self.ratios.push(path.length_m() / straight);
                self.lengths.push(path.length_m());
                self.cusps.push(path.cusps().into());
                self.clearances.push(least_clearance(&path, checker));
            }
            Ok(_) => {}
            Err(failure) => self.failures.push(failure),
        }
    }

    fn print(&mut self, title: &str) {
        let queries = self.total.len();
        let solved = 100.0 * (1.0 - self.failures.len() as f64 / queries as f64);
        println!("{title}: {queries} queries, {solved:.2} % solved");
        for reason in PlanFailure::ALL {
            let count = self.failures.iter().filter(|&&failure| failure == reason).count();
            if count > 0 {
                println!("  {count} x {reason}");
            }
        }
        for (name, values) in [
            ("total, microseconds", &mut self.total),
            ("roadmap, microseconds", &mut self.roadmap),
            ("local, microseconds", &mut self.local),
            ("roadmap expansions", &mut self.roadmap_expansions),
            ("local expansions", &mut self.local_expansions),
            ("length, metres", &mut self.lengths),
            ("length over straight line", &mut self.ratios),
            ("cusps", &mut self.cusps),
            ("least clearance, metres", &mut self.clearances),
        ] {
            let average = mean(values);
            let [low, median, high, max] = [0.05, 0.5, 0.95, 1.0].map(|share| quantile(values, share));
            println!(
                "  {name:26} mean {average:8.2}  p5 {low:8.2}  median {median:8.2}  p95 {high:8.2}  max {max:9.2}"
            );
        }
    }
}

/// Sampled every 10 cm.
fn least_clearance(path: &Path, checker: &CollisionChecker) -> f64 {
    let samples = path.legs().flat_map(|(pose, segment)| {
        let steps = (segment.length_m.abs() / 0.1).ceil();
        (0..=steps as u32).map(move |k| segment.pose_at(pose, segment.length_m * f64::from(k) / steps))
    });
    samples.map(|pose| checker.clearance(pose)).fold(f64::INFINITY, f64::min)
}

fn micros(span: Duration) -> f64 {
    span.as_secs_f64() * 1e6
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}
