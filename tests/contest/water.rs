//! Tanks: trucks never stop at a fire without water for it, and fill up by themselves.

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::geometry::FieldFrame;
use wildfire::grid::Grid;
use wildfire::scenario::{self, ImportedField, Scenario};
use wildfire::sim::{self, Simulation};
use wildfire::time::SimTime;
use wildfire::timeline::{AgentFact, AgentId, Fact, Outcome, RestReason, Timeline, file};

const POLICIES: [&str; 6] = ["nearest", "nearest-savable", "hungarian", "threat-first", "auction", "rollout"];

fn loaded(name: &str, changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    scenario::load(name, &changes).expect("it is right")
}

fn run(scenario: &Scenario, seed: u64) -> Timeline {
    sim::run(scenario, seed).expect("it takes place").timeline
}

fn facts_of(timeline: &Timeline, agent: AgentId) -> impl Iterator<Item = (SimTime, &AgentFact)> {
    timeline.events.iter().filter_map(move |event| match &event.fact {
        Fact::Agent(id, fact) if *id == agent => Some((event.time, fact)),
        _ => None,
    })
}

/// The stops of each truck between its fillings; fails if they are more than a tank suffices for.
fn stops_by_tank(timeline: &Timeline, full_tank: usize) -> Vec<usize> {
    let trucks = timeline.setting.agents.iter().filter(|agent| agent.id.role.suppresses());
    let of_truck = |agent| {
        let mut stops = vec![0];
        for (_, fact) in facts_of(timeline, agent) {
            match fact {
                AgentFact::Suppressing { .. } => *stops.last_mut().expect("one is there") += 1,
                AgentFact::Refilling { .. } => stops.push(0),
                _ => {}
            }
        }
        stops
    };
    let stops: Vec<usize> = trucks.flat_map(|truck| of_truck(truck.id)).collect();
    assert!(stops.iter().all(|&stops| stops <= full_tank), "{stops:?}");
    stops
}

#[test]
fn no_policy_stops_without_water() {
    for policy in POLICIES {
        for seed in 1..4 {
            let policy = format!("dispatch.policy={policy}");
            let places = "water.place=[{x_m=125,y_m=20},{x_m=20,y_m=230}]";
            let changes = ["duration_s=900", "water.tank_l=300", places, "dispatch.rollouts=8", &policy];
            let timeline = run(&loaded("fleet", &changes), seed);
            let verdict = audit_timeline(&timeline, SampleStep::default());
            assert_eq!(verdict.violation, None, "{policy}, seed {seed}");
            assert!(stops_by_tank(&timeline, 3).len() > 6, "{policy}, seed {seed}: hardly anybody fills up");
            let outcome = Outcome::new(&timeline);
            assert_eq!(outcome.truck_stuck_s, 0.0, "{policy}, seed {seed}");
            let bytes = file::encode(&timeline).expect("it can be recorded");
            assert!(file::decode(&bytes).expect("and read") == timeline, "{policy}, seed {seed}");
        }
    }
}

#[test]
fn a_truck_with_a_goal_of_its_own_fills_up_when_its_tank_is_empty() {
    let scenario = loaded("contest", &["duration_s=1800", "water.tank_l=300", "water.fill_lps=10"]);
    for seed in 1..4 {
        let timeline = run(&scenario, seed);
        let stops = stops_by_tank(&timeline, 3);
        let (last, before) = stops.split_last().expect("there is a first tank");
        assert!(before.len() > 3 && before.iter().all(|&stops| stops == 3), "seed {seed}: {stops:?}");
        assert!(*last <= 3);
        for (time, fact) in facts_of(&timeline, AgentId::unimog(0)) {
            if let AgentFact::Refilling { until } = fact {
                assert_eq!(until.since(time), SimTime::from_seconds(30.0));
            }
        }
        let outcome = Outcome::new(&timeline);
        let truck = outcome.agents.iter().find(|agent| agent.agent == AgentId::unimog(0)).expect("it is there");
        let spent = [truck.driving_s, truck.planning_s, truck.suppressing_s, truck.standing_s, truck.waiting_s];
        let total = spent.iter().sum::<f64>() + truck.refilling_s;
        assert!((total - outcome.ended_s).abs() < 1e-6, "seed {seed}: {total} s of {} s", outcome.ended_s);
        assert_eq!(truck.refills as usize, before.len());
        assert!(truck.idle_s >= truck.refilling_s && truck.refilling_s > 0.0);
    }
}

#[test]
fn a_tank_that_never_runs_dry_changes_nothing() {
    for seed in 1..4 {
        let dry = run(&loaded("contest", &[]), seed);
        let wet = run(&loaded("contest", &["water.tank_l=1e6"]), seed);
        assert!(dry.events == wet.events, "seed {seed}");
    }
}

#[test]
fn more_water_saves_no_less_on_the_whole() {
    let saved = |tank: &str| -> u32 {
        let scenario = loaded("contest", &["duration_s=1200", tank]);
        (1..6).map(|seed| Outcome::new(&run(&scenario, seed)).extinguished).sum()
    };
    let (little, much) = (saved("water.tank_l=100"), saved("water.tank_l=1e5"));
    assert!(little < much, "{little} put out with one stop a tank, {much} with a thousand");
}

#[test]
fn a_truck_without_a_way_to_water_rests() {
    // A ring of bushes about the only water.
    let frame = FieldFrame { cols: 30, rows: 30, cell_m: 5.0 };
    let is_ring = |index: usize| {
        let (row, col) = (index / 30, index % 30);
        let (north, east) = (row.abs_diff(15), col.abs_diff(15));
        north.max(east) == 4
    };
    let occupied = Grid::from_values(30, 30, (0..900).map(is_ring).collect());
    let changes = [
        "duration_s=600",
        "unimog.start={x_m=10,y_m=10}",
        "wumpus.start_m=[140,10]",
        "water.tank_l=100",
        "water.reach_m=3",
        "water.place=[{x_m=77.5,y_m=77.5}]",
    ];
    let mut scenario = loaded("contest", &changes);
    scenario.field.imported = Some(ImportedField { frame, occupied, doubts: Vec::new() });
    let timeline = run(&scenario, 1);
    let rests = |(_, fact): (SimTime, &AgentFact)| *fact == AgentFact::Rested { reason: RestReason::NoWater };
    assert!(facts_of(&timeline, AgentId::unimog(0)).any(rests), "it is sent away for water");
    assert_eq!(stops_by_tank(&timeline, 1), [1]);
    assert_eq!(Outcome::new(&timeline).truck_stuck_s, 0.0);
    assert_eq!(audit_timeline(&timeline, SampleStep::default()).violation, None);
}

const HEAT: [&str; 3] = ["water.effect=energy", "water.stop_l=10", "ignition=[{at_s=0,random=3}]"];

#[test]
fn stops_take_the_water_that_the_heat_demands() {
    for (seed, policy) in POLICIES.iter().enumerate() {
        let (seed, policy) = (seed as u64 + 1, format!("dispatch.policy={policy}"));
        let changes = [
            &HEAT[..],
            &[
                "water.stop_l=2",
                "water.tank_l=20",
                "suppression.extinguishes=all-in-reach",
                "dispatch.rollouts=4",
                &policy,
            ],
        ];
        let timeline = run(&loaded("initial-attack", &changes.concat()), seed);
        let verdict = audit_timeline(&timeline, SampleStep::default());
        assert_eq!(verdict.violation, None, "{policy}, seed {seed}");
        let water_units = timeline.events.iter().filter_map(|event| match event.fact {
            Fact::Agent(_, AgentFact::Suppressing { water_units, .. }) => Some(water_units),
            _ => None,
        });
        let water_units: Vec<u32> = water_units.collect();
        assert!(
            water_units.iter().any(|&some| some > 1) && water_units.iter().all(|&some| some <= 10),
            "{water_units:?}"
        );
        assert_eq!(Outcome::new(&timeline).truck_stuck_s, 0.0, "{policy}, seed {seed}");
        let bytes = file::encode(&timeline).expect("it can be recorded");
        assert!(file::decode(&bytes).expect("and read") == timeline, "{policy}, seed {seed}");
    }
}

#[test]
fn a_weak_pump_leaves_what_is_too_hot_for_it() {
    let put_out = |pump: &str| {
        let timeline = run(&loaded("initial-attack", &[&HEAT[..], &[pump]].concat()), 2);
        assert_eq!(audit_timeline(&timeline, SampleStep::default()).violation, None, "{pump}");
        let outcome = Outcome::new(&timeline);
        assert_eq!(outcome.truck_stuck_s, 0.0, "{pump}");
        let is_too_hot = |(_, fact): (SimTime, &AgentFact)| *fact == AgentFact::Rested { reason: RestReason::TooHot };
        let ground = outcome.ground.expect("ground burns");
        let rests = facts_of(&timeline, AgentId::unimog(0)).any(is_too_hot);
        (ground.extinguished, ground.burned, rests)
    };
    let [none, some, max] = ["water.pump_lps=0.001", "water.pump_lps=1", "water.pump_lps=50"].map(put_out);
    assert_eq!((none.0, none.2), (0, true));
    assert!(!max.2 && max.1 < some.1 && some.1 < none.1, "{none:?}, {some:?}, {max:?}");
}

#[test]
fn a_fork_knows_what_fires_take() {
    let scenario = loaded("initial-attack", &HEAT);
    let mut parent = Simulation::new(&scenario, 4).expect("it can run");
    parent.advance_to(SimTime::from_seconds(500.0));
    let mut fork = parent.fork().expect("its policies are built in");
    fork.advance_to(SimTime::MAX);
    assert!(fork.finish().timeline == run(&scenario, 4));
}
