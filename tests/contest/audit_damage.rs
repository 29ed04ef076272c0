//! An audit that can fail: runs that were damaged on purpose, one rule each, and the rule that it names.

use wildfire::audit::{Audited, Contact, SampleStep, Violation, ViolationKind, audit_timeline};
use wildfire::geometry::{Cell, Pose};
use wildfire::scenario;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{AgentFact, AgentId, Cause, Event, Fact, FireFact, Timeline, file};
use wildfire::trajectory::{Piece, Trajectory};
use wildfire::vehicle::Segment;

const TRUCK: AgentId = AgentId::unimog(0);

fn run(name: &str, changes: &[&str]) -> Timeline {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    run_with_seed(name, &changes, 1)
}

fn run_with_seed(name: &str, changes: &[String], seed: u64) -> Timeline {
    let scenario = scenario::load(name, changes).expect("built-in scenarios load");
    sim::run(&scenario, seed).expect("it takes place").timeline
}

fn contest() -> Timeline {
    run("contest", &["duration_s=900"])
}

/// A truck that speeds up, brakes and leans within limits.
fn with_limits() -> Timeline {
    let limits = "unimog.limits={ acceleration_mps2 = 1.0, braking_mps2 = 2.0, lateral_mps2 = 3.0 }";
    run("contest", &["duration_s=900", limits])
}

fn audit(timeline: &Timeline) -> Result<Audited, Violation> {
    let verdict = audit_timeline(timeline, SampleStep::default());
    verdict.violation.map_or(Ok(verdict.audited), Err)
}

/// The violation of the run as a file gives it back: what is planted here can stand in a recording.
fn violation(timeline: &Timeline) -> Violation {
    let bytes = file::encode(timeline).expect("damage can be recorded");
    audit(&file::decode(&bytes).expect("and read")).expect_err("the damage is planted")
}

/// Changes the first drive of the first truck that `change` changes.
fn damage_drive(timeline: &mut Timeline, change: impl Fn(&Trajectory) -> Option<Trajectory>) -> SimTime {
    let drives = timeline.events.iter_mut().filter_map(|event| match &mut event.fact {
        Fact::Agent(TRUCK, AgentFact::Planned { trajectory, .. }) => Some((event.time, trajectory)),
        _ => None,
    });
    for (time, trajectory) in drives {
        if let Some(changed) = change(trajectory) {
            *trajectory = changed;
            return time;
        }
    }
    panic!("no drive is fit to be damaged");
}

/// Changes the first piece of a drive that `change` changes.
fn damage_piece(leg: &Trajectory, change: impl Fn(Segment, f64, f64) -> Option<Piece>) -> Option<Trajectory> {
    let changed = |piece: &Piece| match *piece {
        Piece::Drive { segment, speed_mps, acceleration_mps2 } => change(segment, speed_mps, acceleration_mps2),
        _ => None,
    };
    let (place, piece) = leg.pieces().iter().enumerate().find_map(|(place, piece)| Some((place, changed(piece)?)))?;
    let mut pieces = leg.pieces().to_vec();
    pieces[place] = piece;
    Some(Trajectory::new(leg.start_time(), leg.start(), pieces))
}

fn first(timeline: &Timeline, is_it: impl Fn(&Event) -> bool) -> usize {
    timeline.events.iter().position(is_it).expect("the run has such a fact")
}

fn extinction(timeline: &Timeline) -> (usize, Cell) {
    let place = first(timeline, |event| matches!(event.fact, Fact::Fire(FireFact::Extinguished { .. })));
    (place, timeline.events[place].fact.cell().expect("a fire goes out at a cell"))
}

#[test]
fn undamaged_runs_pass() {
    for timeline in [contest(), with_limits(), run("fleet", &["duration_s=600"])] {
        let audited = audit(&timeline).expect("nothing is wrong with it");
        assert!(audited.legs > 20 && audited.poses > 50_000 && audited.extinctions > 10, "{audited:?}");
    }
}

/// A model truck that turns by 4,000 rad/s.
fn swift(seed: u64) -> Timeline {
    let changes = "length_m=1 width_m=0.4 wheelbase_m=0.3 rear_overhang_m=0.3 turning_radius_m=0.25";
    let body = changes.split(' ').map(|change| format!("unimog.vehicle.{change}"));
    let speeds = ["unimog.speed_mps=1000", "unimog.reverse_speed_mps=1000"].map(str::to_owned);
    run_with_seed("smoke", &body.chain(speeds).collect::<Vec<_>>(), seed)
}

/// A Wumpus that walks across a field of this many kilometres.
fn far(kilometres: u32) -> Timeline {
    let size = format!("field.size_m={kilometres}000");
    let start = "wumpus.start_m=[250, 250]";
    let others = ["field.cell_m=500", "fire.spread_radius_m=0", "wumpus.reach_m=800", "duration_s=60000"];
    run("wumpus-alone", &[&[size.as_str(), start], &others[..]].concat())
}

/// Moves the start of an agent's first leg, and so all of it.
fn move_leg(timeline: &mut Timeline, agent: AgentId, metres: f64, radians: f64) {
    let legs = timeline.events.iter_mut().filter_map(|event| match &mut event.fact {
        Fact::Agent(planned, AgentFact::Planned { trajectory, .. }) if *planned == agent => Some(trajectory),
        _ => None,
    });
    let leg = legs.into_iter().next().expect("it has a leg");
    let start = leg.start();
    let moved = Pose::new(start.x + metres, start.y, start.heading + radians);
    *leg = Trajectory::new(leg.start_time(), moved, leg.pieces().to_vec());
}

#[test]
fn a_truck_that_turns_4000_radians_a_second_is_no_violation() {
    for seed in 1..=3 {
        let audited = audit(&swift(seed)).unwrap_or_else(|violation| panic!("seed {seed}: {violation}"));
        assert!(audited.legs > 10 && audited.extinctions > 5, "{audited:?}");
    }
}

#[test]
fn walks_of_tens_of_kilometres_are_no_violation() {
    for kilometres in [30, 50] {
        let audited = audit(&far(kilometres)).unwrap_or_else(|violation| panic!("{kilometres} km: {violation}"));
        assert!(audited.metres > 100_000.0 && audited.metres / audited.legs as f64 > 10_000.0, "{audited:?}");
    }
}

#[test]
fn a_leg_that_begins_micrometres_elsewhere_is_found_in_runs_at_the_limits_too() {
    // The tolerance is 1.01e-6 m and 1.001e-6 rad in the contest; 2e-6 m and 5e-6 rad for the swift truck, and 1.1e-6 m
    // on the far walk.
    let runs =
        [(contest(), TRUCK, 2e-6, 2e-6), (swift(1), TRUCK, 3e-6, 1e-5), (far(50), AgentId::wumpus(0), 2e-6, 0.0)];
    for (proper, agent, metres, radians) in runs {
        let damaged = |metres: f64, radians: f64| {
            let mut timeline = proper.clone();
            move_leg(&mut timeline, agent, metres, radians);
            audit(&timeline)
        };
        let is_found = |audited: &Result<Audited, Violation>| {
            matches!(audited, Err(Violation { kind: ViolationKind::Discontinuous { .. }, .. }))
        };
        assert!(audit(&proper).is_ok());
        let moved = damaged(metres, 0.0);
        assert!(is_found(&moved), "{metres} m: {moved:?}");
        let turned = damaged(0.0, radians);
        assert!(is_found(&turned) || radians == 0.0, "{radians} rad: {turned:?}");
    }
}

#[test]
fn a_pose_moved_into_a_bush_is_found() {
    let mut timeline = contest();
    let bush = timeline.setting.bushes[timeline.setting.bushes.len() / 2];
    let centre = timeline.setting.frame.centre(bush);
    damage_drive(&mut timeline, |leg| {
        let start = Pose::new(centre.x, centre.y, leg.start().heading);
        Some(Trajectory::new(leg.start_time(), start, leg.pieces().to_vec()))
    });
    let events = timeline.events.len();
    assert!(matches!(violation(&timeline).kind, ViolationKind::Discontinuous { .. }), "it jumps there");
    timeline.setting.agents.iter_mut().filter(|agent| agent.id == TRUCK).for_each(|agent| {
        agent.pose = Pose::new(centre.x, centre.y, 0.0);
    });
    timeline.events.retain(|event| event.fact.agent() != Some(TRUCK));
    assert!(timeline.events.len() < events);
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::Touched(Contact::Bush { .. })), "{found}");
}

#[test]
fn a_drive_through_a_bush_is_found_where_it_touches_it() {
    let mut timeline = contest();
    let planned = damage_drive(&mut timeline, |leg| {
        // Three times as far straight on: somewhere ahead is a bush or the border.
        damage_piece(leg, |segment, speed_mps, acceleration_mps2| {
            let segment = Segment { curvature: 0.0, length_m: segment.length_m + 250.0_f64.copysign(segment.length_m) };
            Some(Piece::Drive { segment, speed_mps, acceleration_mps2 })
        })
    });
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::Touched(_)), "{found}");
    assert!(found.time > planned && found.agent == Some(TRUCK), "{found}");
}

#[test]
fn a_sharper_turn_is_found() {
    let mut timeline = contest();
    damage_drive(&mut timeline, |leg| {
        damage_piece(leg, |segment, speed_mps, acceleration_mps2| {
            let segment = Segment { curvature: segment.curvature * 1.001, ..segment };
            (segment.curvature != 0.0).then_some(Piece::Drive { segment, speed_mps, acceleration_mps2 })
        })
    });
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::Curvature { radius_m, .. } if radius_m > 12.9), "{found}");
}

#[test]
fn a_truck_too_fast_is_found() {
    let mut timeline = contest();
    damage_drive(&mut timeline, |leg| {
        damage_piece(leg, |segment, speed_mps, acceleration_mps2| {
            Some(Piece::Drive { segment, speed_mps: speed_mps + 0.01, acceleration_mps2 })
        })
    });
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::Speed { .. }), "{found}");
}

#[test]
fn speeding_up_and_braking_harder_than_the_limit_are_found() {
    for (sign, is_found) in [
        (1.0, (|kind| matches!(kind, ViolationKind::Acceleration { .. })) as fn(ViolationKind) -> bool),
        (-1.0, |kind| matches!(kind, ViolationKind::Braking { .. })),
    ] {
        let mut timeline = with_limits();
        damage_drive(&mut timeline, |leg| {
            damage_piece(leg, |segment, speed_mps, change| {
                let acceleration_mps2 = change * 1.01;
                (change * sign > 0.0).then_some(Piece::Drive { segment, speed_mps, acceleration_mps2 })
            })
        });
        let found = violation(&timeline);
        assert!(is_found(found.kind), "{found}");
    }
}

#[test]
fn leaning_harder_than_the_limit_is_found() {
    let mut timeline = with_limits();
    let truck = timeline.setting.agents.iter_mut().find(|agent| agent.id == TRUCK).expect("it has a truck");
    truck.limits.as_mut().expect("limits are recorded").lateral_mps2 = Some(2.9);
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::Lateral { found_mps2, .. } if found_mps2 > 2.9), "{found}");
}

#[test]
fn a_start_without_speeding_up_is_found() {
    let mut timeline = with_limits();
    damage_drive(&mut timeline, |leg| {
        damage_piece(leg, |segment, speed_mps, _| {
            (speed_mps == 0.0).then_some(Piece::Drive { segment, speed_mps: 1.0, acceleration_mps2: 0.0 })
        })
    });
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::SpeedJump { .. }), "{found}");
}

#[test]
fn a_jump_is_found() {
    let mut timeline = contest();
    damage_drive(&mut timeline, |leg| {
        let start = Pose { x: leg.start().x + 0.01, ..leg.start() };
        Some(Trajectory::new(leg.start_time(), start, leg.pieces().to_vec()))
    });
    let found = violation(&timeline);
    assert!(
        matches!(found.kind, ViolationKind::Discontinuous { metres, .. } if (metres - 0.01).abs() < 1e-9),
        "{found}"
    );
}

#[test]
fn moving_on_past_its_cut_is_found() {
    let mut timeline = contest();
    let is_cut = |event: &Event| {
        let Fact::Agent(TRUCK, AgentFact::Dropped { trajectory, .. }) = &event.fact else { return false };
        !trajectory.pieces().is_empty()
    };
    let place = first(&timeline, is_cut);
    let later: Vec<usize> = (place + 1..timeline.events.len()).collect();
    let next = later.into_iter().find(|&place| match &timeline.events[place].fact {
        Fact::Agent(agent, AgentFact::Planned { trajectory, .. }) => *agent == TRUCK && !trajectory.pieces().is_empty(),
        _ => false,
    });
    let next = next.expect("it drives on");
    // As if the dropped leg had been driven for half a second more.
    timeline.events.remove(place);
    let Fact::Agent(agent, AgentFact::Planned { .. }) = timeline.events[next - 1].fact else {
        panic!("that is the next drive")
    };
    assert_eq!(agent, TRUCK);
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::StillUnderWay { .. } | ViolationKind::Discontinuous { .. }), "{found}");
}

#[test]
fn a_fire_put_out_from_beyond_the_reach_is_found() {
    let mut timeline = contest();
    let (place, cell) = extinction(&timeline);
    let truck = timeline.setting.agents.iter().find(|agent| agent.id == TRUCK).expect("it has a truck");
    let body = match truck.body {
        wildfire::timeline::Body::Truck(body) => body,
        wildfire::timeline::Body::Square { .. } => panic!("trucks have a truck's body"),
    };
    let stand = timeline.state_at(timeline.events[place].time).agents.last().expect("it has agents").pose;
    let metres = (body.body_centre(stand) - timeline.setting.frame.centre(cell)).length();
    timeline.setting.rules.suppression_reach_m = Some(metres - 0.1);
    let found = violation(&timeline);
    let ViolationKind::OutOfReach { metres, reach_m, .. } = found.kind else { panic!("{found}") };
    assert!((metres - reach_m - 0.1).abs() < 1e-9, "{found}");
}

#[test]
fn a_dwell_too_short_is_found() {
    let mut timeline = contest();
    let (place, cell) = extinction(&timeline);
    let event = timeline.events.remove(place);
    let time = SimTime::from_nanos(event.time.as_nanos() - 1);
    let earlier = timeline.events.iter().position(|event| event.time > time).expect("it was not the last fact");
    timeline.events.insert(earlier, Event { time, ..event });
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::NotStanding { cell: of, .. } if of == cell), "{found}");
}

#[test]
fn the_extinction_of_what_does_not_burn_is_found() {
    let mut timeline = contest();
    let (place, cell) = extinction(&timeline);
    let ignition =
        first(&timeline, |event| matches!(event.fact, Fact::Fire(FireFact::Ignited { cell: of, .. }) if of == cell));
    assert!(ignition < place);
    timeline.events.remove(ignition);
    let found = violation(&timeline);
    // What it set on fire may come first.
    let is_reported = match found.kind {
        ViolationKind::NotBurning { cell: of } => of == cell,
        ViolationKind::NoSource { from, .. } | ViolationKind::SparedBySpread { cell: from, .. } => from == cell,
        _ => false,
    };
    assert!(is_reported, "{found}");
}

#[test]
fn a_fire_that_goes_out_twice_is_found() {
    let mut timeline = contest();
    let (place, cell) = extinction(&timeline);
    let event = timeline.events[place].clone();
    timeline.events.insert(place + 1, event);
    let found = violation(&timeline);
    assert_eq!(found.kind, ViolationKind::NotBurning { cell });
}

#[test]
fn fire_that_leaps_farther_than_it_spreads_is_found() {
    let mut timeline = contest();
    timeline.setting.rules.fire.as_mut().expect("it is recorded").spread_radius_m = 29.9;
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::TooFarToSpread { metres, .. } if metres > 29.9), "{found}");
}

#[test]
fn a_wumpus_that_runs_or_lights_in_passing_is_found() {
    let mut timeline = contest();
    let wumpus = timeline.setting.agents.iter_mut().find(|agent| agent.id != TRUCK).expect("it has a Wumpus");
    let id = wumpus.id;
    wumpus.limits.as_mut().expect("limits are recorded").forward_mps = 1.99;
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::Speed { .. }) && found.agent == Some(id), "{found}");
    let mut timeline = contest();
    let is_ignition =
        |event: &Event| matches!(event.fact, Fact::Fire(FireFact::Ignited { cause: Cause::Agent(_), .. }));
    let place = first(&timeline, is_ignition);
    let event = timeline.events.remove(place);
    timeline.events.insert(place, Event { time: timeline.events[place - 1].time, ..event });
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::IgnitedInPassing { .. }), "{found}");
}

#[test]
fn two_trucks_on_one_place_are_found() {
    let mut timeline = run("fleet", &["duration_s=60"]);
    let trucks: Vec<usize> = (0..timeline.setting.agents.len())
        .filter(|&place| timeline.setting.agents[place].id.role.suppresses())
        .collect();
    let at = timeline.setting.agents[trucks[0]].pose;
    let second = timeline.setting.agents[trucks[1]].id;
    timeline.setting.agents[trucks[1]].pose = Pose { x: at.x + 1.0, ..at };
    timeline.events.retain(|event| event.fact.agent() != Some(second));
    let found = violation(&timeline);
    assert!(matches!(found.kind, ViolationKind::Overlap { .. }) && found.time == SimTime::ZERO, "{found}");
}

/// A truck whose tank suffices for three stops.
fn with_water() -> Timeline {
    run("contest", &["duration_s=1800", "water.tank_l=300", "water.place=[{x_m=125,y_m=20},{x_m=20,y_m=230}]"])
}

#[test]
fn water_that_is_not_in_the_tank_is_found() {
    let timeline = with_water();
    audit(&timeline).expect("nothing is wrong yet");
    let is_refill = |event: &Event| matches!(event.fact, Fact::Agent(TRUCK, AgentFact::Refilling { .. }));
    let first = timeline.events.iter().position(is_refill).expect("it fills its tank");
    let change_of_first = |change: &dyn Fn(&mut SimTime)| {
        let mut damaged = timeline.clone();
        if let Fact::Agent(_, AgentFact::Refilling { until }) = &mut damaged.events[first].fact {
            change(until);
        }
        violation(&damaged).kind
    };
    let mut without = timeline.clone();
    without.events.remove(first);
    assert_eq!(violation(&without).kind, ViolationKind::EmptyTank);
    let longer = change_of_first(&|until| *until += SimTime::from_seconds(1.0));
    assert!(matches!(longer, ViolationKind::WrongRefill { .. }), "{longer}");
    let mut elsewhere = timeline.clone();
    elsewhere.setting.water.as_mut().expect("there is water").places.iter_mut().for_each(|place| place.x += 15.0);
    assert!(matches!(violation(&elsewhere).kind, ViolationKind::NoWater { .. }));
    let mut fuller = timeline;
    fuller.setting.water = None;
    assert_eq!(violation(&fuller).kind, ViolationKind::WrongAgent);
}

#[test]
fn water_that_does_not_suffice_for_the_heat_is_found() {
    let heat = ["water.effect=energy", "water.stop_l=1"].map(str::to_owned);
    let timeline = run_with_seed("initial-attack", &heat, 3);
    audit(&timeline).expect("nothing is wrong yet");
    let mut stops = timeline.events.iter().enumerate().filter_map(|(place, event)| match event.fact {
        Fact::Agent(agent, AgentFact::Suppressing { water_units: 2.., cell }) => Some((place, (agent, cell))),
        _ => None,
    });
    // One that puts its goal out.
    let ended = |it: (AgentId, Cell)| Fact::Agent(it.0, AgentFact::SuppressionEnded { cell: it.1 });
    let is_over = |it| timeline.events.iter().any(|event| event.fact == ended(it));
    let (stop, _) = stops.find(|&(_, it)| !is_over(it)).expect("it puts something out");
    let with_water_units = |change: &dyn Fn(u32) -> u32| {
        let mut damaged = timeline.clone();
        if let Fact::Agent(_, AgentFact::Suppressing { water_units, .. }) = &mut damaged.events[stop].fact {
            *water_units = change(*water_units);
        }
        violation(&damaged).kind
    };
    for other in [|water_units| water_units - 1, |water_units| water_units + 1] {
        let found = with_water_units(&other);
        assert!(matches!(found, ViolationKind::TooLittleWater { .. }), "{found}");
    }
    let mut weaker = timeline.clone();
    weaker.setting.water.as_mut().and_then(|water| water.energy.as_mut()).expect("heat matters").jet_m *= 100.0;
    assert!(matches!(violation(&weaker).kind, ViolationKind::TooLittleWater { .. }));
}
