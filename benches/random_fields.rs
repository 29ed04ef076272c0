//! How often the truck's planners find a way on random fields of five densities, whether their paths are sound, and how
//! slow the slowest answer is: `cargo bench --bench random_fields`, or with `-- 2000 prm-rs hybrid-astar` that many fields a
//! density and those planners alone.
//!
//! A field has the bushes of `drives` at another coverage, and one drive: from a random free pose to another, half a metre
//! from everything at least. Arguments with an equals sign change settings: `unimog.hybrid.shortcuts=50`.
//!
//! A drive that no planner found is asked of the floods, from both ends, for any heading within a metre of the other end. If
//! neither gets there it counts as *no way*, otherwise as *missed*: then a way may be there, as where another planner has
//! found one. Every path is audited by shapes that no planner uses. CPU time of this thread. It ends with exit code 1 if a
//! path is not sound.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::Arc;

use wildfire::audit::{AuditField, MotionLimits, Outline, SampleStep, audit_leg};
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::Pose;
use wildfire::planning::kit::ends::free_poses;
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::reachability::Reachability;
use wildfire::planning::{Goal, GoalDisc, PlanFailure, PlannerContext, TruckPlannerKind};
use wildfire::rng;
use wildfire::scenario::{self, Scenario, Terrain, Unimog};
use wildfire::time::SimTime;
use wildfire::time::cpu::CpuStopwatch;
use wildfire::timeline::Body;
use wildfire::trajectory::Trajectory;
use wildfire::vehicle::Path;

const FIELDS: u64 = 200;
const COVERAGES: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.3];
const MIN_ROOM_M: f64 = 0.5;
/// What the floods are asked for: the body's centre this near to where the drive should end.
const NEAR_M: f64 = 1.0;

/// A field and the drive on it.
struct Problem {
    seed: u64,
    terrain: Terrain,
    checker: CollisionChecker,
    start: Pose,
    goal: Pose,
}

/// What one planner did on the fields of one density.
#[derive(Default)]
struct Answers {
    /// Milliseconds of each query, and the seed of its field.
    queries: Vec<(f64, u64)>,
    slowest_build_ms: f64,
    failures: BTreeMap<PlanFailure, usize>,
    no_way: usize,
    violations: Vec<String>,
}

#[expect(clippy::print_stderr, reason = "a benchmark prints what is wrong with its arguments")]
fn main() -> ExitCode {
    let (fields, scenario, planners) = match arguments() {
        Ok(parsed) => parsed,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    println!("{fields} fields a density; CPU time in ms, and the seed of the slowest query");
    println!(
        "{:>8} {:14} {:>7} {:>7} {:>7} {:>10} {:>8} {:>8} {:>8} {:>6} {:>8}",
        "coverage", "planner", "reached", "no way", "missed", "violations", "median", "p99", "slowest", "seed", "build"
    );
    let mut are_sound = true;
    for coverage in COVERAGES {
        let answers = ask_all(fields, coverage, &scenario, &planners);
        for (planner, answers) in planners.iter().zip(answers) {
            are_sound &= answers.violations.is_empty();
            answers.print(coverage, *planner);
        }
    }
    if are_sound { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The number of fields, the settings, and the planners that the command line asks for.
fn arguments() -> Result<(u64, Scenario, Vec<TruckPlannerKind>), String> {
    let args = std::env::args().skip(1).filter(|argument| !argument.starts_with("--"));
    let (changes, names): (Vec<String>, Vec<String>) = args.partition(|argument| argument.contains('='));
    let (numbers, names): (Vec<String>, Vec<String>) = names.into_iter().partition(|word| word.parse::<u64>().is_ok());
    let fields = numbers.first().and_then(|number| number.parse().ok()).unwrap_or(FIELDS);
    let scenario = scenario::load("drives", &changes).map_err(|error| error.to_string())?;
    let named = names.iter().map(|name| name.parse()).collect::<Result<Vec<_>, String>>()?;
    Ok((fields, scenario, if named.is_empty() { TruckPlannerKind::ALL.to_vec() } else { named }))
}

fn ask_all(fields: u64, coverage: f64, scenario: &Scenario, planners: &[TruckPlannerKind]) -> Vec<Answers> {
    let mut scenario = scenario.clone();
    scenario.field.coverage = coverage;
    let truck = &scenario.unimog[0];
    let mut all: Vec<Answers> = planners.iter().map(|_| Answers::default()).collect();
    for seed in 1..=fields {
        let problem = Problem::new(&scenario, seed);
        let mut failed = Vec::new();
        for (planner, answers) in planners.iter().zip(&mut all) {
            match answers.ask(*planner, &problem, truck) {
                Ok(path) => answers.violations.extend(problem.violation(&path, truck)),
                Err(failure) => failed.push((answers, failure)),
            }
        }
        // Where one planner has found a way there is one, and nobody needs to ask whether.
        let has_no_way = failed.len() == planners.len() && !problem.floods_get_there();
        for (answers, failure) in failed {
            if has_no_way {
                answers.no_way += 1;
            } else {
                *answers.failures.entry(failure).or_default() += 1;
            }
        }
    }
    all
}

impl Problem {
    fn new(scenario: &Scenario, seed: u64) -> Self {
        let terrain = Terrain::from_scenario(scenario, seed).expect("the coverage leaves room");
        let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
        let checker = CollisionChecker::new(field, scenario.unimog[0].vehicle);
        let mut rng = rng::stream(seed, "bench/random-fields");
        let ends: Vec<Pose> = free_poses(&checker, MIN_ROOM_M, &mut rng).take(2).collect();
        let &[start, goal] = ends.as_slice() else { panic!("the field of seed {seed} has no room") };
        Self { seed, terrain, checker, start, goal }
    }

    /// Says whether the floods, from one of the ends, come near the other; every drive can be driven back.
    fn floods_get_there(&self) -> bool {
        [(self.start, self.goal), (self.goal, self.start)].into_iter().any(|(from, to)| {
            let disc = GoalDisc { centre: self.checker.body().body_centre(to), radius_m: NEAR_M };
            Reachability::new(&self.checker, &MemoryMeter::unlimited(), from).reaches(disc)
        })
    }

    /// Returns what is wrong with a path, by the audit's shapes or at its ends.
    fn violation(&self, path: &Path, truck: &Unimog) -> Option<String> {
        let body = self.checker.body();
        let field = AuditField::new(self.terrain.frame, &self.terrain.bushes, Outline::new(&Body::Truck(*body)));
        let limits = truck.speed_limits();
        let motion = MotionLimits { turning_radius_m: Some(body.turning_radius_m), limits: Some(limits) };
        let trajectory = Trajectory::from_path(path, SimTime::ZERO, limits);
        let is_between_the_ends =
            Goal::Pose(self.start).is_met(path.start, body) && Goal::Pose(self.goal).is_met(path.end(), body);
        let audited = audit_leg(&field, &motion, &trajectory, SampleStep::default());
        let on_the_way = audited.err().map(|violation| violation.to_string());
        let wrong = on_the_way.or_else(|| (!is_between_the_ends).then(|| "it leads elsewhere".to_owned()));
        wrong.map(|wrong| format!("seed {}: {wrong}", self.seed))
    }
}

impl Answers {
    fn ask(&mut self, planner: TruckPlannerKind, problem: &Problem, truck: &Unimog) -> Result<Path, PlanFailure> {
        let mut watch = CpuStopwatch::start();
        let field = Arc::new(ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied));
        let checker = CollisionChecker::new(field, truck.vehicle);
        let stream = |name: &str| rng::stream(problem.seed, &format!("bench/random-fields/{name}"));
        let (memory, settings) = (MemoryMeter::unlimited(), truck.planner_settings());
        let mut made = planner.maker().make(&PlannerContext {
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
        });
        self.slowest_build_ms = self.slowest_build_ms.max(watch.elapsed_since_last().as_secs_f64() * 1e3);
        let plan = made.plan(problem.start, Goal::Pose(problem.goal));
        self.queries.push((watch.elapsed_since_last().as_secs_f64() * 1e3, problem.seed));
        plan.path
    }

    fn print(mut self, coverage: f64, planner: TruckPlannerKind) {
        self.queries.sort_by(|one, other| one.0.total_cmp(&other.0));
        let [median, p99, slowest] =
            [0.5, 0.99, 1.0].map(|share| self.queries[((self.queries.len() - 1) as f64 * share).round() as usize]);
        let missed: usize = self.failures.values().sum();
        println!(
            "{coverage:8} {planner:14} {:7} {:7} {missed:7} {:10} {:8.2} {:8.2} {:8.1} {:6} {:8.1}",
            self.queries.len() - self.no_way - missed,
            self.no_way,
            self.violations.len(),
            median.0,
            p99.0,
            slowest.0,
            slowest.1,
            self.slowest_build_ms
        );
        self.failures.iter().for_each(|(reason, count)| println!("{:23} {count} x {reason}", ""));
        self.violations.iter().take(3).for_each(|violation| println!("{:23} {violation}", ""));
    }
}
