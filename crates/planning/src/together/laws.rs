//! Laws of planning together: what is planned passes the independent check, the same seed gives the same bits, and what
//! cannot be solved is said in a sentence.

use std::f64::consts::{PI, TAU};

use rand::{Rng, RngExt};

use super::files::{read_instance, read_solution, write_solution};
use super::judge::{self, RuleBreach, Schedule, ScheduleCheck};
use super::world::{Motion, Traffic};
use super::*;
use wildfire_base::geometry::ops;
use wildfire_base::rng;

const BOTH: [Mode; 2] = [Mode::Benchmark, Mode::Exact];

fn settings(mode: Mode, seed: u64) -> PlanTogether {
    PlanTogether { mode, method: RepairMethod::Repair, seed, rounds: 300, polish: 1 }
}

fn solve(instance: &Instance, settings: &PlanTogether) -> Result<Vec<Route>, Unsolved> {
    plan(instance, settings, &mut || false, &mut RepairEffort::default())
}

fn schedules(instance: &Instance, routes: &[Route]) -> Vec<Schedule> {
    read_solution(&write_solution(instance, routes, 0.0)).expect("own solutions can be read")
}

fn vehicle(name: &str, start: Pose, goal: Pose) -> Vehicle {
    Vehicle { name: name.to_owned(), start, goal }
}

/// A map of 30 m by 30 m with vehicles at random.
fn random_instance(seed: u64, vehicles: usize, obstacles: usize) -> Instance {
    let mut random = rng::stream(seed, "together/laws");
    let ends = |random: &mut dyn Rng| {
        let mut poses: Vec<Pose> = Vec::new();
        while poses.len() < vehicles {
            let pose = Pose::new(
                random.random_range(2.0..28.0),
                random.random_range(2.0..28.0),
                f64::from(random.random_range(0..4)) * 1.57,
            );
            if poses.iter().all(|other| (other.position() - pose.position()).length() > 5.0) {
                poses.push(pose);
            }
        }
        poses
    };
    let starts = ends(&mut random);
    let goals = ends(&mut random);
    let mut centres: Vec<DVec2> = Vec::new();
    while centres.len() < obstacles {
        let centre = DVec2::new(random.random_range(0.0..30.0), random.random_range(0.0..30.0));
        if starts.iter().chain(&goals).all(|pose| (pose.position() - centre).length() > 4.0) {
            centres.push(centre);
        }
    }
    let named = starts.into_iter().zip(goals).enumerate();
    let vehicles = named.map(|(index, (start, goal))| vehicle(&format!("agent{index}"), start, goal)).collect();
    Instance { size_m: DVec2::splat(30.0), obstacles: centres, vehicles }
}

#[test]
fn solutions_pass_the_independent_check() {
    for mode in BOTH {
        let mut solved = 0;
        for seed in 0..24 {
            // Few vehicles among many obstacles, and the other way round.
            let (vehicles, obstacles) = if seed % 3 == 0 { (8, 6) } else { (3, 30) };
            let mut instance = random_instance(seed, vehicles, obstacles);
            if mode == Mode::Benchmark {
                // The benchmark lets a vehicle start on an obstacle, and leave it at once.
                let Pose { x, y, heading } = instance.vehicles[0].start;
                let (sin, cos) = ops::sin_cos(heading);
                instance.obstacles.push(DVec2::new(x - 1.5 * cos, y - 1.5 * sin));
            }
            let Ok(routes) = solve(&instance, &settings(mode, seed)) else { continue };
            solved += 1;
            let ScheduleCheck { faults, routes: back } = judge::check(&instance, mode, &schedules(&instance, &routes));
            assert_eq!(faults, [], "{mode:?}, seed {seed}");
            for (read, planned) in back.expect("all steps can be driven").iter().zip(&routes) {
                assert!((read.flowtime_m() - planned.flowtime_m()).abs() < 1e-6);
                assert!((read.cost() - planned.cost()).abs() < 1e-6);
            }
            let (bound_m, _) = instance.bounds_m();
            assert!(routes.iter().map(Route::flowtime_m).sum::<f64>() > bound_m - 1e-6);
        }
        assert!(solved >= 16, "{mode:?}: {solved} of 24");
    }
}

#[test]
fn the_same_seed_gives_the_same_routes() {
    for method in [RepairMethod::Prioritised, RepairMethod::Repair] {
        let instance = random_instance(3, 9, 4);
        let settings = PlanTogether { method, ..settings(Mode::Benchmark, 7) };
        let bits = || {
            let mut effort = RepairEffort::default();
            let routes = plan(&instance, &settings, &mut || false, &mut effort);
            (format!("{routes:?}"), effort)
        };
        assert_eq!(bits(), bits());
    }
}

/// Two vehicles meet in a corridor, and one stands at its goal in another's way.
#[test]
fn vehicles_make_way_for_each_other() {
    let at = |x: f64, heading: f64| Pose::new(x, 4.5, heading);
    let facing = vec![vehicle("one", at(5.0, 0.0), at(40.0, 0.0)), vehicle("other", at(40.0, PI), at(5.0, PI))];
    let parked = vec![vehicle("still", at(20.0, 0.0), at(20.0, 0.0)), vehicle("mover", at(5.0, 0.0), at(40.0, 0.0))];
    for vehicles in [facing, parked] {
        let instance = Instance { size_m: DVec2::new(45.0, 9.0), obstacles: Vec::new(), vehicles };
        for (mode, method) in
            BOTH.into_iter().flat_map(|mode| [(mode, RepairMethod::Prioritised), (mode, RepairMethod::Repair)])
        {
            let routes =
                solve(&instance, &PlanTogether { method, ..settings(mode, 1) }).expect("there is room to pass");
            assert_eq!(judge::check(&instance, mode, &schedules(&instance, &routes)).faults, []);
        }
    }
}

#[test]
fn what_cannot_be_solved_is_reported() {
    let reason = |instance: &Instance| solve(instance, &settings(Mode::Exact, 1)).expect_err("no solution").to_string();
    let start = Pose::new(5.0, 15.0, 0.0);
    let goal = Pose::new(20.0, 15.0, 0.0);
    let alone = Instance { vehicles: vec![vehicle("car", start, goal)], ..random_instance(1, 1, 0) };
    let with = |obstacles: Vec<DVec2>| Instance { obstacles, ..alone.clone() };
    let blocked = reason(&with(vec![DVec2::new(22.0, 15.0)]));
    assert_eq!(blocked, "the goal of car is blocked: an obstacle or the border is too near");
    let ring = (0..16).map(|part| {
        let (sin, cos) = ops::sin_cos(f64::from(part) * TAU / 16.0);
        DVec2::new(20.5 + 5.0 * cos, 15.0 + 5.0 * sin)
    });
    let enclosed = reason(&with(ring.collect()));
    assert_eq!(enclosed, "no drive of car past the obstacles was found, even without the other vehicles");
    let near = vehicle("van", Pose::new(25.0, 25.0, 0.0), Pose::new(20.5, 16.0, 0.0));
    let crowded = reason(&Instance { vehicles: vec![alone.vehicles[0].clone(), near], ..alone.clone() });
    assert_eq!(crowded, "the goals of car and van are too near to each other");
    // Nobody can let the other pass where the map is hardly wider than a car.
    let ends = [(5.0, 0.0), (25.0, PI)].map(|(x, heading)| Pose::new(x, 1.0, heading));
    let goals = [(20.0, 0.0), (10.0, PI)].map(|(x, heading)| Pose::new(x, 1.0, heading));
    let vehicles = vec![vehicle("one", ends[0], goals[0]), vehicle("other", ends[1], goals[1])];
    let narrow = Instance { size_m: DVec2::new(30.0, 2.0), obstacles: Vec::new(), vehicles };
    let narrow = solve(&narrow, &PlanTogether { rounds: 8, ..settings(Mode::Exact, 1) }).expect_err("no room");
    assert_eq!(narrow.to_string(), "1 pair of vehicles still conflicts after all rounds");
    let stopped = plan(&alone, &settings(Mode::Exact, 1), &mut || true, &mut RepairEffort::default());
    let stopped = stopped.expect_err("it was stopped");
    assert_eq!(stopped.to_string(), "the limit on CPU time ended the search");
}

/// Drives of 10 m past something that touches the body, or hardly not: the drive is found and the judge agrees, whatever
/// the gap.
#[test]
fn contact_is_decided_whatever_the_gap() {
    let ahead = |name: &str, y: f64| vehicle(name, Pose::new(5.0, y, 0.0), Pose::new(15.0, y, 0.0));
    let solved_m = |obstacles: Vec<DVec2>, vehicles: Vec<Vehicle>| {
        let instance = Instance { size_m: DVec2::splat(30.0), obstacles, vehicles };
        let routes = solve(&instance, &settings(Mode::Exact, 1)).expect("a drive straight ahead is free");
        assert_eq!(judge::check(&instance, Mode::Exact, &schedules(&instance, &routes)).faults, []);
        routes.iter().map(Route::flowtime_m).fold(0.0, f64::max)
    };
    for gap_m in [-4e-4, 0.0, 1e-12, 1e-8, 1e-4, 1e-2] {
        let beside = |x: f64| DVec2::new(x, 15.0 + 0.5 * WIDTH_M + OBSTACLE_M + gap_m);
        let behind = DVec2::new(5.0 - BACK_M - OBSTACLE_M - gap_m, 15.0);
        for obstacles in [vec![beside(5.5)], vec![beside(15.5)], vec![beside(5.5), beside(10.0)], vec![behind]] {
            let driven_m = solved_m(obstacles, vec![ahead("car", 15.0)]);
            assert!((driven_m - 10.0).abs() < 1e-9, "{driven_m} m, {gap_m} m from an obstacle");
        }
        // Where neither end is as tight, a way round leaves the margin.
        assert!(solved_m(vec![beside(10.0)], vec![ahead("car", 15.0)]) < 12.0);
        let pair = vec![ahead("left", 15.0 + WIDTH_M + gap_m), ahead("right", 15.0)];
        assert!((solved_m(Vec::new(), pair) - 10.0).abs() < 1e-9, "{gap_m} m from each other");
        if gap_m >= 0.0 {
            let along_border = solved_m(Vec::new(), vec![ahead("car", gap_m)]);
            assert!((along_border - 10.0).abs() < 1e-9, "{gap_m} m from the border");
            let turn = vehicle("car", Pose::new(5.0, gap_m, 0.0), Pose::new(9.0, 4.0, 0.5 * PI));
            assert!(solved_m(Vec::new(), vec![turn]) < 7.0, "{gap_m} m from the border");
        }
    }
    let overlap = DVec2::new(5.5, 15.0 + 0.5 * WIDTH_M + OBSTACLE_M - 0.002);
    let instance =
        Instance { obstacles: vec![overlap], vehicles: vec![ahead("car", 15.0)], ..random_instance(1, 1, 0) };
    assert!(matches!(solve(&instance, &settings(Mode::Exact, 1)), Err(Unsolved::Blocked { is_goal: false, .. })));
}

/// Whenever the limit is reached, hardly a node more is expanded, and routes that are given are sound.
#[test]
fn every_method_stops_at_its_limit() {
    let instance = random_instance(4, 6, 30);
    for method in [RepairMethod::Prioritised, RepairMethod::Repair] {
        let mut stopped = 0;
        for max_calls in 0..60 {
            let mut calls = 0;
            let mut is_stopped = || {
                calls += 1;
                calls > max_calls
            };
            let settings = PlanTogether { method, ..settings(Mode::Exact, 1) };
            let mut effort = RepairEffort::default();
            let found = plan(&instance, &settings, &mut is_stopped, &mut effort);
            assert!(effort.expansions <= 16 * max_calls, "{effort:?} after {max_calls} looks at the limit");
            match found {
                Ok(routes) => {
                    assert_eq!(judge::check(&instance, Mode::Exact, &schedules(&instance, &routes)).faults, []);
                }
                Err(reason) => {
                    assert_eq!(reason, Unsolved::Stopped);
                    stopped += 1;
                }
            }
        }
        assert!(stopped > 5, "{stopped} of 60 were stopped");
    }
}

/// The judge, the planner's test and dense sampling of corners agree on two vehicles in a step.
#[test]
fn planner_and_judge_agree_with_samples() {
    let mut random = rng::stream(5, "together/laws");
    let (mut touching, mut free) = (0, 0);
    for _ in 0..3000 {
        let mut motion = || {
            let from = Pose::new(
                random.random_range(8.0..13.0),
                random.random_range(8.0..13.0),
                random.random_range(-3.1..3.1),
            );
            let curvature = f64::from(random.random_range(-1..=1)) / RADIUS_M;
            Motion { from, step: Segment { curvature, length_m: random.random_range(-STEP_M..STEP_M) } }
        };
        let motions = [motion(), motion()];
        let routes = motions.map(|motion| Route { start: motion.from, steps: vec![motion.step] });
        let ends = |name: &str, route: &Route| vehicle(name, route.start, route.poses().last().expect("an end"));
        let vehicles = vec![ends("a", &routes[0]), ends("b", &routes[1])];
        let instance = Instance { size_m: DVec2::splat(30.0), obstacles: Vec::new(), vehicles };
        let mut traffic = Traffic::new(Mode::Exact, 2);
        traffic.insert(0, &routes[0]);
        let is_planned_free = traffic.conflicts(0, &motions[1]) == 0;
        let faults = judge::check(&instance, Mode::Exact, &schedules(&instance, &routes)).faults;
        let sampled = (0..=100).any(|part| {
            let corners = motions.map(|motion| {
                let pose = motion.step.pose_at(motion.from, f64::from(part) / 100.0 * motion.step.length_m);
                (pose, BODY.footprint(pose).corners())
            });
            let inside = |(pose, _): &(Pose, [DVec2; 4]), corner: &DVec2| {
                let offset = *corner - pose.position();
                let along = offset.dot(pose.direction());
                let across = pose.direction().perp_dot(offset);
                along > -BACK_M && along < FRONT_M && across.abs() < 0.5 * WIDTH_M
            };
            let [one, other] = &corners;
            one.1.iter().any(|corner| inside(other, corner)) || other.1.iter().any(|corner| inside(one, corner))
        });
        if is_planned_free {
            free += 1;
            assert!(faults.is_empty() && !sampled, "{motions:?}: {faults:?}");
        }
        if !faults.is_empty() {
            touching += 1;
            assert!(matches!(faults[..], [RuleBreach::Vehicles { .. }]), "{faults:?}");
        }
    }
    assert!(touching > 300 && free > 300, "{touching} touch, {free} are free");
}

#[test]
fn the_judge_finds_what_is_wrong() {
    let instance = random_instance(2, 6, 5);
    let routes = solve(&instance, &settings(Mode::Exact, 1)).expect("there is room");
    let good = schedules(&instance, &routes);
    let found = |change: &dyn Fn(&mut Vec<Schedule>)| {
        let mut schedules = good.clone();
        change(&mut schedules);
        let faults = judge::check(&instance, Mode::Exact, &schedules).faults;
        faults.iter().map(RuleBreach::to_string).collect::<Vec<_>>().join("\n")
    };
    let none = found(&|_| {});
    assert_eq!(none, "");
    let missing = found(&|schedules| drop(schedules.remove(2)));
    assert_eq!(missing, "agent2 has no schedule");
    let empty = found(&|schedules| schedules[2].poses.clear());
    assert_eq!(empty, "agent2 has no schedule");
    let short = found(&|schedules| schedules[1].poses.truncate(2));
    assert!(short.contains("agent1 ends at a distance from its goal"), "{short}");
    let jump = found(&|schedules| schedules[3].poses[2].x += 0.3);
    assert!(jump.contains("agent3 cannot drive from its pose at step 1"), "{jump}");
    let nowhere = found(&|schedules| schedules[3].poses[2].x = f64::NAN);
    assert!(nowhere.contains("agent3 cannot drive"), "{nowhere}");
    let at_once = found(&|schedules| {
        // A vehicle that stands on another's start.
        let pose = schedules[0].poses[0];
        schedules[5].poses = vec![pose];
    });
    assert!(at_once.contains("agent0 and agent5 overlap by"), "{at_once}");
    let off = Instance { size_m: DVec2::new(30.0, 12.0), ..instance.clone() };
    let faults = judge::check(&off, Mode::Benchmark, &good).faults;
    assert!(faults.iter().any(|fault| fault.to_string().contains("leaves the map at step")), "{faults:?}");
    let on_path = good[0].poses[good[0].poses.len() / 2].position();
    let hit = Instance { obstacles: vec![on_path], ..instance.clone() };
    for mode in BOTH {
        let faults = judge::check(&hit, mode, &good).faults;
        assert!(faults.iter().any(|fault| fault.to_string().contains("agent0 overlaps obstacle 0 by")), "{faults:?}");
    }
}

#[test]
fn files_are_read_and_refused_with_their_line() {
    let good = "agents:\n  - start: [3, 4, 1.57]\n    name: agent0\n    goal: [8, 9, -1.57]\nmap:\n  \
                dimensions: [20, 10]\n  obstacles:\n    - [-1, -1]\n    - [5.5, 6]\n";
    let read = read_instance(good).expect("a good file");
    assert_eq!(read.vehicles, [vehicle("agent0", Pose::new(3.0, 4.0, -1.57), Pose::new(8.0, 9.0, 1.57))]);
    assert_eq!((read.size_m, read.obstacles), (DVec2::new(20.0, 10.0), vec![DVec2::new(5.5, 6.0)]));
    let refused = |from: &str, to: &str| read_instance(&good.replace(from, to)).expect_err(to).to_string();
    let cases = [
        ("[3, 4, 1.57]", "[3, 4]", "line 2: `start` is a list of 2; expected a list of 3 numbers"),
        ("[3, 4, 1.57]", "[3, 4, nan]", "line 2: `start` is nan; expected a number from -1000000 to 1000000"),
        ("[3, 4, 1.57]", "[3, 40, 0]", "line 2: `start` is a list of 3; expected a place on the map"),
        ("[20, 10]", "[20, 1e9]", "line 6: `dimensions` is 1e9; expected a number from 1 to 2000"),
        ("    name: agent0\n", "", "line 2: there is no `name` here"),
        ("agent0", "'a b'", "line 3: `name` is a b; expected at most 60 letters, digits, and `_`, `-` or `.`"),
        ("    name: agent0\n", "    goal: [1, 2, 0]\n", "line 2: `goal` stands twice; expected it once"),
        ("agent0", "*x", "line 3: while parsing node, found unknown anchor"),
        ("map:", "mop:", "line 1: there is no `map` here"),
        (
            "[5.5, 6]",
            "[[[[[[[[[[1]]]]]]]]]]",
            "line 9: lists and mappings are nested too deep for an instance or a solution",
        ),
    ];
    for (from, to, expected) in cases {
        assert_eq!(refused(from, to), expected);
    }
    let empty = read_instance("").expect_err("empty").to_string();
    assert_eq!(empty, "line 1: the file is empty; expected an instance or a solution");
    let skipped = "schedule:\n  agent0:\n    - {x: 1, y: 2, yaw: 0, t: 0}\n    - {x: 1, y: 2, yaw: 0, t: 2}\n";
    let skipped = read_solution(skipped).expect_err("a step is left out").to_string();
    assert_eq!(skipped, "line 4: `t` is 2; expected 1, since steps count 0, 1, 2 and so on");
    for cut in 0..good.len() {
        // Whatever is cut off, the answer is a sentence.
        let _ = read_instance(&good[..cut]);
        let _ = read_solution(&good[cut..]);
    }
}
