//! The gate, and the judge in it, against those who know better: what it lets pass, the audit does not fault, however a
//! path came about; and it refuses no path of a built-in planner.

use std::sync::Arc;

use rand::{Rng, RngExt};
use wildfire::audit::{AuditField, MotionLimits, Outline, SampleStep, audit_leg};
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{Pose, ops};
use wildfire::planning::judge::{BadPath, Judge};
use wildfire::planning::kit::ends::free_poses;
use wildfire::planning::memory::MemoryMeter;
use wildfire::planning::{Goal, GoalDisc, MakeError, PlannerContext, Planners, TruckPlanner, TruckPlannerKind};
use wildfire::rng;
use wildfire::scenario::{self, Problem, Programs, Terrain, TruckPlannerContext, Unimog};
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{AgentFact, Body, Fact};
use wildfire::trajectory::{Piece, SpeedLimits, Trajectory};
use wildfire::vehicle::{Dimensions, Path, Segment};

/// A field and the drives that were planned on it.
struct DrivenField {
    judge: Judge,
    audit_field: AuditField,
    body: Dimensions,
    drives: Vec<(Path, Goal)>,
}

impl DrivenField {
    /// The field of a scenario's run, and all drives that its trucks' planners found.
    fn new(name: &str, changes: &[&str], seed: u64) -> Self {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let scenario = scenario::load(name, &changes).expect("built-in scenarios load");
        let terrain = Terrain::from_scenario(&scenario, seed).expect("there is room");
        let body = scenario.unimog[0].vehicle;
        let checker = CollisionChecker::new(Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied)), body);
        let run = sim::run(&scenario, seed).expect("built-in scenarios run");
        let reach_m = scenario.suppression.reach_m.expect("they have a reach");
        let drives = run.timeline.events.iter().filter_map(|event| match &event.fact {
            Fact::Agent(_, AgentFact::Planned { goal, trajectory, found_by: Some(_), .. }) => {
                let disc = GoalDisc { centre: terrain.frame.centre(*goal), radius_m: reach_m };
                Some((path(trajectory), disc.into()))
            }
            _ => None,
        });
        Self {
            judge: Judge::new(checker),
            audit_field: AuditField::new(terrain.frame, &terrain.bushes, Outline::new(&Body::Truck(body))),
            body,
            drives: drives.filter(|(path, _): &(Path, Goal)| !path.segments.is_empty()).collect(),
        }
    }

    /// Returns what the audit says of a path from a pose to a goal.
    fn fault(&self, start: Pose, goal: Goal, path: &Path, limits: SpeedLimits) -> Option<String> {
        let trajectory = Trajectory::from_path(path, SimTime::ZERO, limits);
        let motion = MotionLimits { turning_radius_m: Some(self.body.turning_radius_m), limits: Some(limits) };
        let audited = audit_leg(&self.audit_field, &motion, &trajectory, SampleStep::default());
        let end = trajectory.end();
        let misses = match goal {
            Goal::Pose(goal) => {
                let turn = ops::wrap_angle(end.heading - goal.heading).abs();
                end.position().distance(goal.position()) > 1.001e-3 || turn > 1.001e-3
            }
            Goal::Disc(disc) => self.body.body_centre(end).distance(disc.centre) > disc.radius_m + 2e-6,
        };
        let misses = misses.then(|| format!("it ends at {end:?}"));
        let jumps = (trajectory.start() != start).then(|| "it begins elsewhere".to_owned());
        audited.err().map(|violation| violation.to_string()).or(misses).or(jumps)
    }
}

fn path(trajectory: &Trajectory) -> Path {
    let segments = trajectory.pieces().iter().filter_map(Piece::segment).collect();
    Path { start: trajectory.start(), segments }.joined()
}

/// Numbers at which arithmetic breaks, if it does.
const STRANGE: [f64; 12] =
    [f64::NAN, f64::INFINITY, -0.0, 5e-324, 3e-323, 1e-310, f64::MIN_POSITIVE, 1e-300, 1e-12, -1e-9, 1e16, f64::MAX];

/// A path with its question.
struct Query {
    start: Pose,
    goal: Goal,
    path: Path,
}

/// Changes a path that a planner found in a few ways, and sometimes what it was asked for.
fn mutate(query: &mut Query, rng: &mut impl Rng) {
    for _ in 0..rng.random_range(1..4) {
        change(query, rng);
    }
}

fn change(Query { start, goal, path }: &mut Query, rng: &mut impl Rng) {
    // A change of any size between a millionth and a metre.
    let small = |rng: &mut dyn Rng| {
        let size = ops::exp(rng.random_range(-14.0..0.0));
        if rng.random_bool(0.5) { size } else { -size }
    };
    let count = path.segments.len();
    let selected = (count > 0).then(|| rng.random_range(0..count));
    match (rng.random_range(0..13), selected) {
        (0, Some(selected)) => path.segments[selected].length_m += small(rng),
        (1, Some(selected)) => path.segments[selected].curvature *= 1.0 + 1e-3 * small(rng),
        (2, Some(selected)) => path.segments[selected].curvature += 0.1 * small(rng),
        (3, Some(selected)) => path.segments[selected].curvature *= -1.0,
        (4, Some(selected)) => path.segments[selected].length_m *= -1.0,
        (5, Some(selected)) => drop(path.segments.remove(selected)),
        (6, Some(selected)) => path.segments.swap(selected, count - 1),
        (7, Some(selected)) => path.segments[selected].length_m = STRANGE[rng.random_range(0..STRANGE.len())],
        (8, Some(selected)) => path.segments[selected].curvature = STRANGE[rng.random_range(0..STRANGE.len())],
        // The truck itself stands elsewhere: nearer to bushes than planners go.
        (9 | 10, _) => {
            let (x, y) = (3.0 * small(rng), 3.0 * small(rng));
            *start = Pose::new(start.x + x, start.y + y, start.heading + small(rng));
            path.start = *start;
        }
        (11, _) => path.start.x += 1e-3 * small(rng),
        (_, _) => {
            let curvature = f64::from(rng.random_range(-1..=1)) / 13.0;
            path.segments.push(Segment { curvature, length_m: rng.random_range(-9.0..9.0) });
        }
    }
    // Most goals move along, so that other rules than that of the end are asked.
    let end = path.end();
    *goal = match rng.random_range(0..6) {
        0 => *goal,
        1 => Pose::new(end.x + 2e-3 * small(rng), end.y, end.heading + 2e-3 * small(rng)).into(),
        2 => GoalDisc { centre: end.position(), radius_m: rng.random_range(0.0..2.0) }.into(),
        _ => end.into(),
    };
}

#[test]
fn no_mutated_path_passes_that_the_audit_faults() {
    judge_mutated_paths(10_000);
}

#[test]
#[ignore = "tier 2: ten times as many paths"]
fn no_mutated_path_of_many_passes_that_the_audit_faults() {
    judge_mutated_paths(100_000);
}

#[expect(clippy::print_stdout, reason = "the test prints what it counted")]
fn judge_mutated_paths(paths: usize) {
    let sites = [
        DrivenField::new("contest", &[], 1),
        DrivenField::new("contest", &["unimog.planner=hybrid-astar"], 2),
        DrivenField::new("dense", &[], 3),
        DrivenField::new("fleet", &[], 4),
    ];
    let limits = [
        SpeedLimits::new(8.0, 8.0),
        SpeedLimits {
            acceleration_mps2: Some(1.5),
            braking_mps2: Some(3.0),
            lateral_mps2: Some(4.0),
            ..SpeedLimits::new(8.0, 3.0)
        },
    ];
    let mut rng = rng::stream(1, "tests/gate");
    let (mut passed, mut refused, mut faulted) = (0_u32, [0_u32; 7], 0_u32);
    for number in 0..paths {
        let site = &sites[number % sites.len()];
        let (path, goal) = site.drives[rng.random_range(0..site.drives.len())].clone();
        let mut query = Query { start: path.start, goal, path };
        assert_eq!(site.judge.check(query.start, goal, &query.path), Ok(()), "it was planned");
        mutate(&mut query, &mut rng);
        let Query { start, goal, path } = query;
        let verdict = site.judge.check(start, goal, &path);
        // One in ten of those that are refused is enough to see that the audit would have said so too.
        if verdict.is_err() && number % 10 > 0 {
            refused[kind(&verdict)] += 1;
            continue;
        }
        let fault = site.fault(start, goal, &path, limits[number % limits.len()]);
        match verdict {
            Ok(()) => {
                assert_eq!(fault, None, "path {number} from {start:?} to {goal:?}: {path:?}");
                passed += 1;
            }
            Err(_) => {
                refused[kind(&verdict)] += 1;
                faulted += u32::from(fault.is_some());
            }
        }
    }
    let all: u32 = refused.iter().sum();
    println!("{paths} mutated paths: {passed} pass and none of them is faulted, {all} are refused");
    println!("refused by start, number, length, curvature, clearance, disc, pose: {refused:?}");
    println!("of {} refused ones that were audited, the audit faults {faulted}", all / 10);
    assert!(
        passed as usize > paths / 10 && refused.iter().all(|&count| count as usize > paths / 3333),
        "{passed} passed, {refused:?}"
    );
}

/// Returns the rule that a path was refused by.
fn kind(verdict: &Result<(), BadPath>) -> usize {
    match verdict {
        Err(BadPath::OtherStart { .. }) => 0,
        Err(BadPath::NotANumber { .. }) => 1,
        Err(BadPath::TooLong { .. } | BadPath::TooManySegments { .. }) => 2,
        Err(BadPath::TooSharp { .. }) => 3,
        Err(BadPath::TooNear { .. }) => 4,
        Err(BadPath::MissesDisc { .. }) => 5,
        Err(BadPath::MissesPose { .. }) => 6,
        Ok(()) => unreachable!("it was refused"),
    }
}

#[test]
fn every_drive_of_a_run_passes() {
    for (name, seed) in [("contest", 5), ("dense", 6), ("fleet", 7)] {
        let site = DrivenField::new(name, &[], seed);
        for (path, goal) in &site.drives {
            let verdict = site.judge.check(path.start, *goal, path).map_err(|bad| bad.to_string());
            assert_eq!(verdict, Ok(()), "{name}, seed {seed}, to {goal:?}: {path:?}");
        }
        assert!(site.drives.len() > 20, "{} drives", site.drives.len());
    }
}

/// The truck of a scenario's run, with a planner of this name.
struct QueriedField {
    problem: Problem,
    checker: CollisionChecker,
    seed: u64,
}

impl QueriedField {
    /// A field with as many goals as asked for: every other one a pose, the others the reach of a bush.
    fn new(name: &str, seed: u64, goals: usize) -> Self {
        let scenario = scenario::load(name, &[]).expect("built-in scenarios load");
        let mut problem = Problem::from_scenario(&scenario, seed).expect("there is room").expect("there is a truck");
        let field = ClearanceField::new(problem.terrain.frame, &problem.terrain.occupied);
        let checker = CollisionChecker::new(Arc::new(field), problem.truck.vehicle);
        let mut rng = rng::stream(seed, "tests/gate/goals");
        let poses: Vec<Pose> = free_poses(&checker, 0.3, &mut rng).take(goals.div_ceil(2)).collect();
        let bushes = &problem.terrain.bushes;
        let disc = |centre| GoalDisc { centre, radius_m: 10.0 };
        let discs = (0..goals / 2).map(|_| bushes[rng.random_range(0..bushes.len())]);
        let discs: Vec<Goal> = discs.map(|cell| disc(problem.terrain.frame.centre(cell)).into()).collect();
        problem.goals = poses.into_iter().map(Goal::from).chain(discs).collect();
        Self { problem, checker, seed }
    }

    fn planner(&self, name: &str, planners: &Planners) -> Box<dyn TruckPlanner> {
        let truck = Unimog { planner: name.parse().expect("a name"), ..self.problem.truck.clone() };
        let (memory, programs) = (MemoryMeter::unlimited(), Programs::new());
        let context = TruckPlannerContext {
            ground: None,
            truck: 0,
            seed: self.seed,
            checker: &self.checker,
            memory: &memory,
            planners,
            programs: &programs,
        };
        truck.make_planner(&context).expect("it can be built")
    }
}

#[test]
fn no_path_of_a_built_in_planner_is_refused_or_changed() {
    let fields = [("contest", 1, 50), ("contest", 2, 50), ("dense", 3, 50), ("dense", 4, 50), ("fleet", 5, 50)];
    let fields = fields.map(|(name, seed, goals)| QueriedField::new(name, seed, goals));
    for kind in TruckPlannerKind::ALL {
        let inside = move |site: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
            Ok(kind.maker().make(site))
        };
        let planners = Planners::default().with("inside", inside).expect("the name is free");
        let (mut found, mut failed) = (0, 0);
        for field in &fields {
            let mut bare = field.planner(kind.name(), &planners);
            let mut gated = field.planner("inside", &planners);
            for &goal in &field.problem.goals {
                let start = field.problem.start;
                let [alone, passed] = [bare.plan(start, goal), gated.plan(start, goal)];
                assert_eq!(passed.path, alone.path, "{kind} to {goal:?}: {:?}", passed.message);
                if passed.path.is_ok() { found += 1 } else { failed += 1 }
            }
        }
        println!("{kind}: {found} paths pass the gate as they are, {failed} goals without a path");
        assert_eq!(found + failed, 250);
        assert!(found > 200, "{kind}: {found} paths");
    }
}
