//! Teams of trucks: decisions for all at once, drives to places where they wait, and what a team may see.

use std::sync::{Arc, Mutex};

use glam::DVec2;
use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::scenario::{self, Scenario};
use wildfire::sim::policies::{Action, Observation, Policy, PolicyScope};
use wildfire::sim::{self, Simulation};
use wildfire::time::SimTime;
use wildfire::timeline::{Activity, AgentFact, AgentId, Fact, Outcome, Replay, RestReason, Timeline, file};

fn load(name: &str, changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    scenario::load(name, &changes).unwrap_or_else(|error| panic!("{name} {changes:?}: {error}"))
}

fn run(scenario: &Scenario, seed: u64) -> Timeline {
    sim::run(scenario, seed).unwrap_or_else(|error| panic!("seed {seed}: {error}")).timeline
}

fn trucks(scenario: &Scenario) -> Vec<AgentId> {
    (0..).take(scenario.unimog.len()).map(AgentId::unimog).collect()
}

fn led_by(scenario: &Scenario, seed: u64, policy: impl Policy + 'static) -> Timeline {
    let mut simulation = Simulation::new(scenario, seed).expect("it takes place");
    simulation.follow(&trucks(scenario), Box::new(policy));
    simulation.advance_to(SimTime::MAX);
    assert!(simulation.has_ended());
    simulation.finish().timeline
}

fn count(timeline: &Timeline, wanted: impl Fn(&AgentFact) -> bool) -> usize {
    timeline.events.iter().filter(|event| matches!(&event.fact, Fact::Agent(_, fact) if wanted(fact))).count()
}

/// Drives along, facts that a recording holds, states of a replay: nothing of it may depend on who leads the trucks.
fn assert_is_sound(timeline: &Timeline) {
    let verdict = audit_timeline(timeline, SampleStep::default());
    assert!(verdict.violation.is_none(), "{:?}", verdict.violation);
    let bytes = file::encode(timeline).expect("it is a possible run");
    assert!(file::decode(&bytes).expect("it was just written") == *timeline);
    assert_eq!(Outcome::new(timeline).truck_stuck_s, 0.0);
}

#[test]
fn trucks_drive_to_the_fire_that_is_nearest_by_drive() {
    let plain = load("contest", &["duration_s=900", "dispatch.policy=nearest"]);
    let by_drive = load("contest", &["duration_s=900", "dispatch.policy=nearest-by-drive"]);
    let goal = load("contest", &["duration_s=900", "unimog.goal=nearest-by-drive"]);
    let metres = |timeline: &Timeline| {
        let outcome = Outcome::new(timeline);
        let truck = outcome.agents.iter().find(|agent| agent.agent.role.suppresses()).expect("there is a truck");
        truck.distance_m / f64::from(truck.plans)
    };
    let (mut straight_m, mut driven_m) = (0.0, 0.0);
    for seed in 1..=6 {
        let (one, other) = (run(&plain, seed), run(&by_drive, seed));
        assert_is_sound(&other);
        assert!(run(&goal, seed) == other, "the goal is the policy of its name, seed {seed}");
        straight_m += metres(&one);
        driven_m += metres(&other);
    }
    assert!(driven_m < straight_m, "{driven_m} m to the nearest by drive, {straight_m} m to the nearest by air");
    for planner in ["hybrid-astar", "prm+primitives", "lattice"] {
        let planner = format!("unimog.planner={planner}");
        for idle in ["stay", "centroids"] {
            let idle = format!("dispatch.idle={idle}");
            let changes = ["duration_s=400", "dispatch.policy=nearest-by-drive", &idle, &planner];
            assert_is_sound(&run(&load("fleet", &changes), 2));
        }
    }
}

#[test]
fn the_nearest_fire_by_dispatch_is_the_nearest_fire_by_goal() {
    for (name, changes, seed) in [
        ("smoke", &[][..], 1),
        ("contest-1", &["duration_s=900"], 4),
        ("fleet", &["duration_s=900"], 2),
        ("fleet", &["duration_s=600", "unimog.retarget=on-event"], 3),
    ] {
        let by_goal = run(&load(name, changes), seed);
        let dispatched = load(name, &[changes, &["dispatch.policy=nearest"]].concat());
        assert!(run(&dispatched, seed) == by_goal, "{name} {changes:?}");
    }
}

/// A number that looks drawn and follows from the ones before.
struct Draws(u64);

impl Draws {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % count as u64) as usize
    }
}

/// Never knows its own mind: sends trucks to any fire, to any place, or lets them wait, and changes that at every event.
struct Fickle(Draws);

impl Policy for Fickle {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        let draws = &mut self.0;
        let mut choices = Vec::new();
        for &agent in queried {
            let options = seen.options(agent);
            let choice = match draws.below(4) {
                0 if !options.is_empty() => Action::Go(options[draws.below(options.len())]),
                1 | 2 => Action::Move(DVec2::new(draws.below(250) as f64, draws.below(250) as f64)),
                _ => Action::Wait,
            };
            choices.push((agent, choice));
        }
        choices
    }

    fn asking(&self) -> PolicyScope {
        PolicyScope::Team { replans: true }
    }
}

#[test]
fn whatever_a_team_is_told_its_drives_are_sound_and_the_run_ends() {
    let scenario = load("fleet", &["duration_s=900", "dispatch.policy=auction", "unimog.speed_mps=10"]);
    for seed in 1..=3 {
        let timeline = led_by(&scenario, seed, Fickle(Draws(seed)));
        assert_is_sound(&timeline);
        let relocations = count(&timeline, |fact| matches!(fact, AgentFact::Relocated { .. }));
        let halts = count(&timeline, |fact| matches!(fact, AgentFact::Halted { .. }));
        assert!(relocations > 10 && halts > 0 && halts <= relocations, "{relocations} relocations, {halts} halts");
        let outcome = Outcome::new(&timeline);
        let counted: u32 = outcome.agents.iter().map(|agent| agent.relocations).sum();
        assert_eq!(counted as usize, relocations);
    }
}

/// Sends all trucks to one place when nothing is to be done, and notes whom it was asked about.
struct Gathering {
    place: DVec2,
    queried: Arc<Mutex<Vec<Vec<AgentId>>>>,
}

impl Policy for Gathering {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        self.queried.lock().expect("nobody panicked").push(queried.to_vec());
        let mut left: Vec<_> = queried.first().map_or_else(Vec::new, |&first| seen.options(first));
        let choose = |&agent: &AgentId| {
            let options = seen.options(agent);
            let place = left.iter().position(|cell| options.contains(cell));
            (agent, place.map_or(Action::Move(self.place), |place| Action::Go(left.remove(place))))
        };
        queried.iter().map(choose).collect()
    }

    fn asking(&self) -> PolicyScope {
        PolicyScope::Team { replans: false }
    }
}

#[test]
fn a_truck_on_its_way_to_wait_is_called_to_a_fire_and_one_that_waits_is_idle() {
    let scenario = load("fleet", &["duration_s=1200", "unimog.0.retarget=never"]);
    let queried = Arc::new(Mutex::new(Vec::new()));
    let gathering = Gathering { place: DVec2::new(200.0, 60.0), queried: Arc::clone(&queried) };
    let timeline = led_by(&scenario, 1, gathering);
    assert_is_sound(&timeline);
    let queried = queried.lock().expect("nobody panicked");
    assert!(queried[0].len() == scenario.unimog.len(), "all are free at first: {:?}", queried[0]);
    assert!(queried.iter().all(|agents| agents.is_sorted()), "whoever is asked comes by number");
    let called = timeline.events.windows(2).any(|pair| {
        matches!(&pair[0].fact, Fact::Agent(_, AgentFact::Halted { .. }))
            && pair[1..].iter().any(|next| matches!(&next.fact, Fact::Agent(_, AgentFact::Planned { .. })))
    });
    assert!(called, "none was called off on its way and set out for a fire next");
    let outcome = Outcome::new(&timeline);
    for truck in outcome.agents.iter().filter(|agent| agent.agent.role.suppresses()) {
        assert!(truck.idle_s > 0.0 && truck.stuck_s == 0.0, "{truck:?}");
        let spent = truck.driving_s + truck.planning_s + truck.suppressing_s + truck.standing_s + truck.waiting_s;
        assert!((spent - outcome.ended_s).abs() < 1e-6 && truck.idle_s <= outcome.ended_s);
    }
}

/// Lets everybody wait.
struct Lazy;

impl Policy for Lazy {
    fn choose(&mut self, _: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        queried.iter().map(|&agent| (agent, Action::Wait)).collect()
    }

    fn asking(&self) -> PolicyScope {
        PolicyScope::Team { replans: true }
    }
}

#[test]
fn a_team_that_waits_by_choice_is_idle_and_not_stuck() {
    let scenario = load("fleet", &["duration_s=600"]);
    let timeline = led_by(&scenario, 1, Lazy);
    assert!(count(&timeline, |fact| matches!(fact, AgentFact::Rested { reason: RestReason::PolicyWait })) >= 3);
    let outcome = Outcome::new(&timeline);
    assert_eq!((outcome.truck_stuck_s, outcome.extinguished), (0.0, 0));
    for truck in outcome.agents.iter().filter(|agent| agent.agent.role.suppresses()) {
        assert_eq!((truck.idle_s, truck.standing_s), (outcome.ended_s, outcome.ended_s));
    }
}

/// Sends everybody to a place that nobody can get to.
struct Hopeful;

impl Policy for Hopeful {
    fn choose(&mut self, _: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        queried.iter().map(|&agent| (agent, Action::Move(DVec2::new(-500.0, -500.0)))).collect()
    }

    fn asking(&self) -> PolicyScope {
        PolicyScope::Team { replans: true }
    }
}

#[test]
fn a_place_without_a_way_is_tried_once() {
    let scenario = load("fleet", &["duration_s=600"]);
    let timeline = led_by(&scenario, 1, Hopeful);
    let failures = count(&timeline, |fact| matches!(fact, AgentFact::RelocationFailed { .. }));
    assert_eq!(failures, scenario.unimog.len(), "they never move, so each fails once");
    assert_eq!(Outcome::new(&timeline).truck_stuck_s, 0.0);
}

#[test]
fn a_relocating_truck_is_seen_to_drive_and_has_no_goal() {
    let scenario = load("fleet", &["duration_s=600"]);
    let queried = Arc::new(Mutex::new(Vec::new()));
    let timeline = led_by(&scenario, 1, Gathering { place: DVec2::new(200.0, 60.0), queried });
    let relocated = timeline.events.iter().find_map(|event| match &event.fact {
        Fact::Agent(agent, AgentFact::Relocated { trajectory, .. }) => Some((*agent, trajectory.clone())),
        _ => None,
    });
    let (agent, leg) = relocated.expect("they gather at first");
    let place = timeline.setting.agent_index(agent).expect("it is in the setting");
    let mut replay = Replay::new(&timeline);
    replay.seek(leg.sets_out_at() + SimTime::from_seconds(0.1));
    assert_eq!((replay.activity(place), replay.goal(place)), (Activity::Driving, None));
}

#[test]
fn a_decision_that_costs_time_delays_those_that_set_out() {
    let free = load("fleet", &["duration_s=600", "dispatch.policy=nearest-savable"]);
    let charged =
        load("fleet", &["duration_s=600", "dispatch.policy=nearest-savable", "dispatch.seconds_per_evaluation=0.5"]);
    let delay_of_first = |scenario: &Scenario| {
        let timeline = run(scenario, 1);
        let first = timeline.events.iter().find_map(|event| match &event.fact {
            Fact::Agent(agent, AgentFact::Planned { trajectory, .. }) if agent.role.suppresses() => {
                Some((trajectory.start_time() - event.time).as_seconds())
            }
            _ => None,
        });
        first.expect("something burns")
    };
    assert_eq!(delay_of_first(&free), 0.0);
    assert!(delay_of_first(&charged) >= 0.5);
}

#[test]
fn what_is_decided_follows_from_the_seed_alone() {
    for policy in ["nearest-savable", "hungarian", "threat-first", "auction", "rollout"] {
        for idle in ["stay", "centroids", "regions"] {
            let changes = [format!("dispatch.policy={policy}"), format!("dispatch.idle={idle}")];
            let changes = [&["duration_s=300"], &changes.each_ref().map(String::as_str)[..]].concat();
            let scenario = load("fleet", &changes);
            let timeline = run(&scenario, 7);
            assert!(run(&scenario, 7) == timeline, "{policy} {idle}");
            let mut simulation = Simulation::new(&scenario, 7).expect("it takes place");
            for slice in 1..=100_u32 {
                simulation.advance_to(SimTime::from_seconds(3.7 * f64::from(slice)));
            }
            simulation.advance_to(SimTime::MAX);
            assert!(simulation.finish().timeline == timeline, "{policy} {idle} in slices");
            assert_is_sound(&timeline);
        }
    }
}

#[test]
fn a_change_dispatches_trucks_that_have_goals_and_a_file_may_not_say_both() {
    let refusal = |changes: &[&str]| {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        scenario::load("contest", &changes).expect_err("both say where trucks go").to_string()
    };
    let refused = refusal(&["dispatch.policy=auction", "unimog.goal=oldest"]);
    assert!(refused.contains("`unimog.goal` cannot be combined with `dispatch`"), "{refused}");
    assert!(refusal(&["dispatch.policy=auctoin"]).contains("auction"));
    assert!(refusal(&["dispatch.rollouts=0"]).contains("dispatch.rollouts"));
    assert!(refusal(&["sight.radius_m=-1"]).contains("sight.radius_m"));
    let dispatched = load("contest", &["dispatch.policy=auction", "dispatch.idle=centroids"]);
    assert_eq!(dispatched.dispatch.map(|dispatch| dispatch.label()).as_deref(), Some("auction+centroids"));
}
