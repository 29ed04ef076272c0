//! Trucks keep clear of each other: no two overlap at any time, none is stuck, and deadlocks are broken.

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::geometry::{Cell, OrientedRect, Pose};
use wildfire::scenario::{Ignition, IgnitionCells, ImportedField, Scenario, SpreadFrom, StartPose, Unimog};
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{Activity, AgentFact, AgentId, Body, Fact, Outcome, Replay, Role, Timeline};
use wildfire::trajectory::{Piece, Trajectory};
use wildfire::vehicle::Dimensions;

const SAMPLE_NS: u64 = 50_000_000;

fn load(name: &str, changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    wildfire::scenario::load(name, &changes).expect("the built-in loads")
}

fn run(scenario: &Scenario, seed: u64) -> Timeline {
    sim::run(scenario, seed).unwrap_or_else(|error| panic!("seed {seed}: {error}")).timeline
}

/// Whether a line along a side of the first keeps all corners of the second on its outer side.
fn separates(one: &OrientedRect, other: &OrientedRect) -> bool {
    let corners = one.corners();
    (0..4).any(|side| {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        other.corners().iter().all(|&corner| (to - from).perp_dot(corner - from) < 0.0)
    })
}

/// The first sample at which two trucks overlap, looked for every 50 ms in the facts alone.
fn first_overlap(timeline: &Timeline) -> Option<(SimTime, AgentId, AgentId)> {
    let bodies: Vec<(usize, Dimensions)> = timeline.setting.agents.iter().enumerate().filter_map(truck_body).collect();
    let mut replay = Replay::new(timeline);
    let samples = timeline.end_time().as_nanos() / SAMPLE_NS;
    (0..=samples).map(|sample| SimTime::from_nanos(sample * SAMPLE_NS)).find_map(|time| {
        replay.seek(time);
        let outline = |&(place, body): &(usize, Dimensions)| body.footprint(replay.agent(place).pose);
        let outlines: Vec<OrientedRect> = bodies.iter().map(outline).collect();
        let pairs = (0..outlines.len()).flat_map(|one| (0..one).map(move |other| (other, one)));
        let mut overlapping = pairs.filter(|&(one, other)| overlap(&outlines[one], &outlines[other]));
        let id = |place: usize| timeline.setting.agents[bodies[place].0].id;
        overlapping.next().map(|(one, other)| (time, id(one), id(other)))
    })
}

fn truck_body((place, agent): (usize, &wildfire::timeline::AgentStart)) -> Option<(usize, Dimensions)> {
    if let Body::Truck(body) = agent.body { Some((place, body)) } else { None }
}

fn overlap(one: &OrientedRect, other: &OrientedRect) -> bool {
    let reach = one.half_length + one.half_width + other.half_length + other.half_width;
    let is_near = one.centre.position().distance(other.centre.position()) < reach;
    is_near && !separates(one, other) && !separates(other, one)
}

fn count(timeline: &Timeline, wanted: impl Fn(&Fact) -> bool) -> usize {
    timeline.events.iter().filter(|event| wanted(&event.fact)).count()
}

/// A field of the given cells with trucks and fires that neither spread nor burn out, and nobody else.
fn drill(map: &str, cell_m: f64, trucks: &[(Dimensions, Pose)], fires: &[(f64, Cell)]) -> Scenario {
    let mut scenario = load("contest", &["wumpus=[]", "unimog=[]"]);
    scenario.field.imported = Some(ImportedField::parse(map, cell_m).expect("the map is one"));
    scenario.fire.spread_from = SpreadFrom::None;
    scenario.fire.burn_out_s = None;
    let truck = |&(vehicle, pose): &(Dimensions, Pose)| Unimog {
        vehicle,
        start: StartPose { x_m: pose.x, y_m: pose.y, heading_deg: pose.heading.to_degrees() },
        ..Unimog::default()
    };
    scenario.unimog = trucks.iter().map(truck).collect();
    let ignition =
        |&(at_s, cell): &(f64, Cell)| Ignition { at_s, every_s: None, cells: IgnitionCells::Cells(vec![cell]) };
    scenario.ignition = fires.iter().map(ignition).collect();
    scenario
}

/// All fires are put out, nobody is stuck, nobody overlaps.
fn assert_goes_well(timeline: &Timeline) -> Outcome {
    let outcome = Outcome::new(timeline);
    assert_eq!(first_overlap(timeline), None);
    assert_eq!((outcome.burning, outcome.truck_stuck_s), (0, 0.0), "{:#?}", timeline.events);
    outcome
}

#[test]
fn a_crowd_on_a_dense_field_never_overlaps() {
    let (mut waits, mut drops) = (0, 0);
    for seed in 1..=20 {
        let mut scenario = load("fleet", &["field.coverage=0.2", "duration_s=400"]);
        let more = scenario.unimog.clone();
        scenario.unimog.extend(more.into_iter().map(|truck| Unimog {
            start: StartPose { x_m: 250.0 - truck.start.y_m, y_m: truck.start.x_m + 40.0, ..truck.start },
            retarget: wildfire::scenario::Retarget::OnEvent,
            ..truck
        }));
        let timeline = run(&scenario, seed);
        assert_eq!(first_overlap(&timeline), None, "seed {seed}");
        let outcome = Outcome::new(&timeline);
        assert_eq!(outcome.truck_stuck_s, 0.0, "seed {seed}");
        waits += usize::from(outcome.agents.iter().any(|agent| agent.waiting_s > 0.0));
        drops += count(&timeline, |fact| {
            matches!(fact, Fact::Agent(AgentId { role: Role::Unimog, .. }, AgentFact::Dropped { .. }))
        });
    }
    assert!(waits > 10 && drops > 100, "{waits} runs with waits, {drops} drives broken off");
}

/// A small field that is crowded: six trucks between bushes, half of them with limits of acceleration.
fn crowd(changes: &[&str]) -> Scenario {
    let mut scenario = load("fleet", &[&["duration_s=300"], changes].concat());
    let more = scenario.unimog.clone();
    scenario.unimog.extend(more.into_iter().map(|truck| Unimog {
        start: StartPose { x_m: 250.0 - truck.start.y_m, y_m: truck.start.x_m + 40.0, ..truck.start },
        limits: Unimog::default().limits,
        planner: wildfire::planning::TruckPlannerKind::HybridAstar.into(),
        ..truck
    }));
    scenario
}

#[test]
fn trucks_that_plan_together_keep_clear_of_each_other_and_wait_less() {
    let (alone, together) = (crowd(&[]), crowd(&["traffic.plan=together"]));
    let waiting_s =
        |timeline: &Timeline| Outcome::new(timeline).agents.iter().map(|agent| agent.waiting_s).sum::<f64>();
    let (mut waited_alone_s, mut waited_s) = (0.0, 0.0);
    for seed in 1..=20 {
        waited_alone_s += waiting_s(&run(&alone, seed));
        let timeline = run(&together, seed);
        assert_eq!(first_overlap(&timeline), None, "seed {seed}");
        assert_eq!(audit_timeline(&timeline, SampleStep::default()).violation, None, "seed {seed}");
        assert_eq!(Outcome::new(&timeline).truck_stuck_s, 0.0, "seed {seed}");
        waited_s += waiting_s(&timeline);
        if seed == 1 {
            assert_eq!(run(&together, seed), timeline, "the same seed gives the same run");
            assert_eq!(run(&crowd(&["traffic.plan=alone"]), seed), run(&alone, seed), "the default is to plan alone");
        }
    }
    assert!(waited_s < 0.75 * waited_alone_s, "{waited_s} s instead of {waited_alone_s} s");
}

#[test]
fn eight_trucks_come_through_a_dense_field() {
    let mut scenario = load("contest", &["field.coverage=0.2", "duration_s=1200"]);
    let start = |k: u32| StartPose {
        x_m: 40.0 + 50.0 * f64::from(k % 4),
        y_m: if k < 4 { 60.0 } else { 180.0 },
        heading_deg: 90.0 * f64::from(k % 4),
    };
    scenario.unimog = (0..8).map(|k| Unimog { start: start(k), ..Unimog::default() }).collect();
    let timeline = run(&scenario, 1);
    assert_eq!(first_overlap(&timeline), None);
    let outcome = Outcome::new(&timeline);
    assert_eq!(outcome.truck_stuck_s, 0.0);
    assert!(outcome.extinguished > 20 && outcome.agents.iter().any(|agent| agent.deadlocks > 0), "{outcome:?}");
}

#[test]
fn trucks_that_start_on_top_of_each_other_are_moved_apart() {
    let mut scenario = load("fleet", &["duration_s=60"]);
    for truck in &mut scenario.unimog {
        truck.start = StartPose { x_m: 60.0, y_m: 60.0, heading_deg: 10.0 };
    }
    let timeline = run(&scenario, 1);
    assert_eq!(first_overlap(&timeline), None);
    assert_eq!(count(&timeline, |fact| matches!(fact, Fact::Agent(_, AgentFact::StartMoved { .. }))), 2);
    assert_eq!(timeline.setting.agents[2].pose, Pose::new(60.0, 60.0, 10_f64.to_radians()));
}

/// So many rows of so many free cells, with bushes at these cells.
fn open_field(side: usize, bushes: &[Cell]) -> String {
    let cell = |row: usize, col: usize| Cell { col: col as u16, row: row as u16 };
    let line = |row| (0..side).map(|col| if bushes.contains(&cell(row, col)) { '#' } else { '.' }).collect::<String>();
    (0..side).rev().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn of_two_trucks_whose_ways_cross_one_lets_the_other_pass() {
    let (east, north) = (Cell { col: 23, row: 12 }, Cell { col: 12, row: 23 });
    let body = Dimensions::default();
    let trucks = [(body, Pose::new(20.0, 62.5, 0.0)), (body, Pose::new(62.5, 20.0, std::f64::consts::FRAC_PI_2))];
    let timeline = run(&drill(&open_field(24, &[east, north]), 5.0, &trucks, &[(0.0, east), (0.001, north)]), 1);
    let outcome = assert_goes_well(&timeline);
    assert_eq!((outcome.agents[0].waiting_s, outcome.agents[0].deadlocks, outcome.agents[1].deadlocks), (0.0, 0, 0));
    assert!(outcome.agents[1].waiting_s > 0.0 && outcome.agents[1].waiting_s < 3.0, "{:?}", outcome.agents[1]);
    let mut replay = Replay::new(&timeline);
    replay.seek(SimTime::from_seconds(0.002));
    assert_eq!((replay.activity(0), replay.activity(1)), (Activity::Driving, Activity::Waiting));
}

#[test]
fn a_planted_meeting_is_found() {
    let (east, north) = (Cell { col: 23, row: 12 }, Cell { col: 12, row: 23 });
    let body = Dimensions::default();
    let trucks = [(body, Pose::new(20.0, 62.5, 0.0)), (body, Pose::new(62.5, 20.0, std::f64::consts::FRAC_PI_2))];
    let mut timeline = run(&drill(&open_field(24, &[east, north]), 5.0, &trucks, &[(0.0, east), (0.001, north)]), 1);
    for event in &mut timeline.events {
        if let Fact::Agent(AgentId { role: Role::Unimog, number: 1 }, AgentFact::Planned { trajectory, .. }) =
            &mut event.fact
        {
            let at_once = trajectory.pieces().iter().filter(|piece| !matches!(piece, Piece::Wait { .. })).copied();
            *trajectory = Trajectory::new(trajectory.start_time(), trajectory.start(), at_once.collect());
        }
    }
    let (time, one, other) = first_overlap(&timeline).expect("without its wait it runs into the other");
    assert_eq!((one, other), (AgentId::unimog(0), AgentId::unimog(1)));
    assert!(time.as_seconds() > 3.0 && time.as_seconds() < 7.0, "{time}");
}

/// A corridor 5 m wide of which only a narrow truck reaches the west end, and only a nimble one the corners of the room
/// at its east end. The fires are at the west end and in the room's south-east corner.
fn corridor() -> (String, [Cell; 2]) {
    let is_free = |x: usize, y: usize| {
        let corridor = (20..60).contains(&x) && (18..23).contains(&y);
        let narrow = (2..20).contains(&x) && (20..22).contains(&y);
        let room = (60..98).contains(&x) && (1..40).contains(&y);
        corridor || narrow || room
    };
    let line = |y| (0..100).map(|x| if is_free(x, y) { '.' } else { '#' }).collect::<String>();
    let map = (0..41).rev().map(line).collect::<Vec<_>>().join("\n");
    (map, [Cell { col: 1, row: 20 }, Cell { col: 98, row: 2 }])
}

/// The trucks that drive aside when a nimble truck faces a narrow one, each with its fire behind the other.
fn who_gives_way(nimble_first: bool) -> Vec<AgentId> {
    let nimble = Dimensions { turning_radius_m: 6.0, ..Dimensions::default() };
    let narrow = Dimensions { width_m: 1.4, turning_radius_m: 200.0, ..Dimensions::default() };
    let mut trucks = [(nimble, Pose::new(35.0, 20.5, 0.0)), (narrow, Pose::new(50.0, 21.0, std::f64::consts::PI))];
    if !nimble_first {
        trucks.reverse();
    }
    let (map, [west, east]) = corridor();
    let mut scenario = drill(&map, 1.0, &trucks, &[(1.0, west), (1.0, east)]);
    for truck in &mut scenario.unimog {
        truck.planner = wildfire::planning::TruckPlannerKind::HybridAstar.into();
    }
    let timeline = run(&scenario, 1);
    assert_goes_well(&timeline);
    let mut gave_way = Vec::new();
    for event in &timeline.events {
        if let Fact::Agent(agent, AgentFact::GaveWay { .. }) = event.fact {
            gave_way.push(agent);
        }
    }
    gave_way
}

#[test]
fn of_two_trucks_that_face_each_other_the_larger_number_gives_way() {
    assert_eq!(who_gives_way(true), [AgentId::unimog(1)]);
}

#[test]
fn who_cannot_give_way_is_given_way_to() {
    // The nimble truck stands at the dead end: only the other one can leave.
    assert_eq!(who_gives_way(false), [AgentId::unimog(0)]);
}

#[test]
fn a_truck_that_rests_in_a_gate_gives_way() {
    let (map, [west, _]) = corridor();
    let wide = Dimensions { width_m: 2.6, turning_radius_m: 6.0, ..Dimensions::default() };
    let narrow = Dimensions { width_m: 1.4, turning_radius_m: 6.0, ..Dimensions::default() };
    let gate = Pose::new(56.0, 20.5, 0.0);
    let trucks = [(wide, gate), (narrow, Pose::new(80.0, 21.0, std::f64::consts::PI))];
    let timeline = run(&drill(&map, 1.0, &trucks, &[(1.0, west)]), 1);
    let outcome = assert_goes_well(&timeline);
    assert_eq!((outcome.agents[0].deadlocks, outcome.agents[1].deadlocks), (1, 0));
    assert_eq!((outcome.agents[0].cells, outcome.agents[1].cells), (0, 1));
    let (first, second) = (AgentId::unimog(0), AgentId::unimog(1));
    let blocked = |fact: &Fact| matches!(*fact, Fact::Agent(agent, AgentFact::Blocked { by, .. }) if (agent, by) == (second, first));
    assert_eq!(count(&timeline, blocked), 1);
    let rests_at = timeline.state_at(timeline.end_time()).agents[0].pose;
    assert!(rests_at.position().distance(gate.position()) > 3.0, "{rests_at:?}");
}

#[test]
fn a_truck_that_has_arrived_keeps_its_fire_even_if_another_ignites_at_that_instant() {
    let body = Dimensions::default();
    let trucks = [(body, Pose::new(20.0, 62.5, 0.0))];
    let (far, near) = (Cell { col: 23, row: 12 }, Cell { col: 20, row: 12 });
    let with = |fires: &[(f64, Cell)]| {
        let mut scenario = drill(&open_field(24, &[far, near]), 5.0, &trucks, fires);
        scenario.unimog[0].retarget = wildfire::scenario::Retarget::OnEvent;
        run(&scenario, 1)
    };
    let arrival = |timeline: &Timeline| {
        let mut arrivals =
            timeline.events.iter().filter(|event| matches!(event.fact, Fact::Agent(_, AgentFact::Suppressing { .. })));
        arrivals.next().expect("it arrives").time
    };
    let alone = arrival(&with(&[(0.0, far)]));
    let timeline = with(&[(0.0, far), (alone.as_seconds(), near)]);
    assert_eq!(arrival(&timeline), alone);
    assert_eq!(
        count(&timeline, |fact| matches!(fact, Fact::Agent(_, AgentFact::Dropped { .. }))),
        0,
        "{:#?}",
        timeline.events
    );
    assert_goes_well(&timeline);
}
