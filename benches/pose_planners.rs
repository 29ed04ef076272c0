//! What the truck's planners cost and give: `cargo bench --bench pose_planners`, or with `-- prm-rs hybrid-astar` those
//! two alone.
//!
//! Goal poses are those of the reference problems (of `tests/data/reference`, or of `$WILDFIRE_REFERENCE`), and random
//! free poses on random fields of the contest; disc goals are about the nearest cells of bushes. Arguments with an equals
//! sign change settings: `unimog.hybrid.shortcuts=50`. CPU time of this thread.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use rand::RngExt;
use serde::Deserialize;

use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, FieldFrame, Pose};
use wildfire::grid::Grid;
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::{
    Goal, GoalDisc, Plan, PlanFailure, PlannerContext, QueryMonitor, QueryTime, TruckPlannerKind,
};
use wildfire::rng;
use wildfire::scenario::{self, Scenario, Terrain, Unimog};
use wildfire::time::cpu::CpuStopwatch;
use wildfire::vehicle::{Dimensions, Path, ReedsShepp};

const START: Pose = Pose { x: 50.0, y: 50.0, heading: 0.0 };
const GENERATED_FIELDS: u64 = 20;
const GENERATED_GOALS: usize = 50;
const REACH_M: f64 = 10.0;
/// The bound is tight for so many goals of each field.
const BOUNDED_GOALS: usize = 3;

/// A field and poses to drive to.
struct Problem {
    checker: CollisionChecker,
    start: Pose,
    goals: Vec<Pose>,
    /// Centres of the bushes.
    bushes: Vec<DVec2>,
}

#[expect(clippy::print_stderr, reason = "a benchmark prints what is wrong with its arguments")]
fn main() -> ExitCode {
    match truck_and_planners() {
        Ok((truck, planners)) => {
            measure_all(&truck, &planners);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// The settings, and the planners, that the command line asks for.
fn truck_and_planners() -> Result<(Unimog, Vec<TruckPlannerKind>), String> {
    let arguments = std::env::args().skip(1).filter(|argument| !argument.starts_with("--"));
    let (changes, names): (Vec<String>, Vec<String>) = arguments.partition(|argument| argument.contains('='));
    let scenario = scenario::load("contest", &changes).map_err(|error| error.to_string())?;
    let mut planners = names.iter().map(|name| name.parse()).collect::<Result<Vec<_>, String>>()?;
    if planners.is_empty() {
        planners = vec![TruckPlannerKind::PrmRs, TruckPlannerKind::HybridAstar];
    }
    Ok((scenario.unimog[0].clone(), planners))
}

fn measure_all(truck: &Unimog, planners: &[TruckPlannerKind]) {
    let reference = reference_problems();
    if reference.is_empty() {
        println!("the reference problems are not there");
    } else {
        measure("reference problems", &reference, truck, planners);
    }
    for coverage in [0.1, 0.15, 0.2] {
        let problems: Vec<_> = (1..=GENERATED_FIELDS).map(|seed| generated_problem(coverage, seed)).collect();
        measure(&format!("{:.0} % of the cells under bushes", 100.0 * coverage), &problems, truck, planners);
    }
}

fn measure(title: &str, problems: &[Problem], truck: &Unimog, planners: &[TruckPlannerKind]) {
    for &kind in planners {
        println!("\n{kind}, {title}, {} fields", problems.len());
        measure_planner(kind, problems, truck);
    }
}

fn measure_planner(kind: TruckPlannerKind, problems: &[Problem], truck: &Unimog) {
    let (mut poses, mut discs) = (Drives::default(), Drives::default());
    let mut builds = Vec::new();
    for problem in problems {
        let mut watch = CpuStopwatch::start();
        let field = Arc::new(ClearanceField::new(*problem.checker.field().frame(), problem.checker.field().occupied()));
        let checker = CollisionChecker::new(field, *problem.checker.body());
        let stream = |name: &str| rng::stream(1, &format!("bench/{name}"));
        let (memory, settings) = (MemoryMeter::unlimited(), truck.planner_settings());
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
        let mut planner = kind.maker().make(&site);
        builds.push(watch.elapsed_since_last().as_secs_f64() * 1e3);
        let curves = ReedsShepp { radius_m: checker.body().turning_radius_m };
        for (number, &goal) in problem.goals.iter().enumerate() {
            let bound_m = curves.length_m(problem.start, goal);
            let mut monitor = QueryMonitor::new(false);
            let plan = planner.plan_observed(problem.start, Goal::Pose(goal), &mut monitor);
            poses.take_time(monitor.finish().time);
            poses.take(plan, (number < BOUNDED_GOALS).then_some(bound_m), &checker);
        }
        for &centre in problem.bushes.iter().take(GENERATED_GOALS) {
            let gap_m = checker.body().body_centre(problem.start).distance(centre) - REACH_M;
            let goal = Goal::Disc(GoalDisc { centre, radius_m: REACH_M - 0.01 });
            let mut monitor = QueryMonitor::new(false);
            let plan = planner.plan_observed(problem.start, goal, &mut monitor);
            discs.take_time(monitor.finish().time);
            discs.take(plan, (gap_m > REACH_M).then_some(gap_m), &checker);
        }
    }
    println!("build, median ms: {:.2}", quantile(&mut builds, 0.5));
    poses.print("goal poses");
    discs.print("goal discs");
}

#[derive(Default)]
struct Drives {
    milliseconds: Vec<f64>,
    roadmap_expansions: Vec<f64>,
    local_expansions: Vec<f64>,
    ratios: Vec<f64>,
    clearances: Vec<f64>,
    cusps: Vec<f64>,
    failures: Vec<PlanFailure>,
}

impl Drives {
    fn take_time(&mut self, time: QueryTime) {
        self.milliseconds.push((time.roadmap + time.local).as_secs_f64() * 1e3);
    }

    fn take(&mut self, plan: Plan, bound_m: Option<f64>, checker: &CollisionChecker) {
        self.roadmap_expansions.push(plan.effort.roadmap_expansions.into());
        self.local_expansions.push(plan.effort.local_expansions.into());
        match plan.path {
            Ok(path) => {
                self.ratios.extend(bound_m.map(|bound_m| path.length_m() / bound_m));
                self.cusps.push(path.cusps().into());
                self.clearances.push(least_clearance(&path, checker));
            }
            Err(failure) => self.failures.push(failure),
        }
    }

    fn print(&mut self, title: &str) {
        let queries = self.milliseconds.len();
        println!("{title}: {} of {queries} solved", queries - self.failures.len());
        for reason in PlanFailure::ALL {
            let count = self.failures.iter().filter(|&&failure| failure == reason).count();
            if count > 0 {
                println!("  {count} x {reason}");
            }
        }
        for (name, values) in [
            ("milliseconds", &mut self.milliseconds),
            ("expansions, roadmap", &mut self.roadmap_expansions),
            ("expansions, local", &mut self.local_expansions),
            ("length over bound", &mut self.ratios),
            ("least clearance, metres", &mut self.clearances),
            ("cusps", &mut self.cusps),
        ] {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let [low, median, high, max] = [0.05, 0.5, 0.95, 1.0].map(|share| quantile(values, share));
            println!("  {name:24} mean {mean:8.3}  p5 {low:8.3}  median {median:8.3}  p95 {high:8.3}  max {max:9.3}");
        }
    }
}

#[derive(Deserialize)]
struct FieldFile {
    cells_cr: Vec<[usize; 2]>,
    n: u16,
    cell_m: f64,
    start: [f64; 3],
    goals: Vec<GoalFile>,
}

#[derive(Deserialize)]
struct GoalFile {
    pose: [f64; 3],
}

fn reference_problems() -> Vec<Problem> {
    let folder = std::env::var_os("WILDFIRE_REFERENCE")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference"), PathBuf::from);
    (0..5)
        .filter_map(|number| std::fs::read(folder.join(format!("plan/field_{number:02}.json"))).ok())
        .map(|text| problem_of(&serde_json::from_slice(&text).expect("a field file")))
        .collect()
}

fn problem_of(file: &FieldFile) -> Problem {
    let frame = FieldFrame { cols: file.n, rows: file.n, cell_m: file.cell_m };
    let mut occupied = Grid::filled(file.n.into(), file.n.into(), false);
    for &[col, row] in &file.cells_cr {
        occupied[(row, col)] = true;
    }
    let pose = |[x, y, heading]: [f64; 3]| Pose::new(x, y, heading);
    problem(frame, &occupied, pose(file.start), file.goals.iter().map(|goal| pose(goal.pose)).collect())
}

fn generated_problem(coverage: f64, seed: u64) -> Problem {
    let mut scenario: Scenario = toml::from_str("wumpus = [{}]\nunimog = [{}]").expect("a scenario of defaults");
    scenario.field.coverage = coverage;
    let terrain = Terrain::from_scenario(&scenario, seed).expect("the coverage leaves room");
    let mut problem = problem(terrain.frame, &terrain.occupied, START, Vec::new());
    let mut rng = rng::stream(seed, "bench/hybrid/goals");
    while problem.goals.len() < GENERATED_GOALS {
        let side_m = terrain.frame.width_m();
        let pose = Pose::new(rng.random_range(0.0..side_m), rng.random_range(0.0..side_m), rng.random_range(0.0..TAU));
        if problem.checker.pose_is_free(pose, 0.5) {
            problem.goals.push(pose);
        }
    }
    problem
}

fn problem(frame: FieldFrame, occupied: &Grid<bool>, start: Pose, goals: Vec<Pose>) -> Problem {
    let field = Arc::new(ClearanceField::new(frame, occupied));
    let bushes = (0..frame.cell_count()).filter(|&i| occupied.values()[i]).map(|i| frame.centre(frame.cell(i)));
    let bushes = bushes.collect();
    Problem { checker: CollisionChecker::new(field, Dimensions::default()), start, goals, bushes }
}

/// Sampled every 10 cm.
fn least_clearance(path: &Path, checker: &CollisionChecker) -> f64 {
    path.samples(0.1).map(|(_, pose)| checker.clearance(pose)).fold(f64::INFINITY, f64::min)
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}
