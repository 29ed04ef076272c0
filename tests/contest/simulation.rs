//! Laws of the simulation: the same seed gives the same facts however the time is cut, events of one instant have
//! their order, bodies move without jumps, and no two trucks go for one fire.

use std::collections::BTreeMap;

use rand::RngExt;
use wildfire::geometry::Cell;
use wildfire::planning::PlanFailure;
use wildfire::rng;
use wildfire::scenario::{
    Escape, Extinguishes, FireUnit, Ignition, IgnitionCells, Limits, Retarget, Scenario, SpreadFrom, StartPose,
    TruckGoal, Unimog, Wumpus, WumpusGoal, WumpusPlanner,
};
use wildfire::sim::{self, Simulation};
use wildfire::time::SimTime;
use wildfire::timeline::{
    AgentFact, AgentId, Cause, EndReason, Event, Fact, FireFact, Outcome, RestReason, Role, Timeline, file,
};

/// The contest with nobody on the field.
fn empty_contest() -> Scenario {
    wildfire::scenario::load("contest", &["wumpus=[]".into(), "unimog=[]".into()]).expect("the built-in loads")
}

fn contest() -> Scenario {
    Scenario { wumpus: vec![Wumpus::default()], unimog: vec![Unimog::default()], ..empty_contest() }
}

/// One truck, and so many random ignitions a minute apart.
fn ignitions(count: usize) -> Scenario {
    let ignition = |k| Ignition { at_s: 60.0 * k as f64, every_s: None, cells: IgnitionCells::Random(1) };
    let mut scenario = Scenario { unimog: vec![Unimog::default()], ..empty_contest() };
    scenario.ignition = (0..count).map(ignition).collect();
    scenario.fire.spread_from = SpreadFrom::None;
    scenario.fire.burn_out_s = None;
    scenario
}

/// Scenarios that together use every option that changes the order or kind of events.
fn variety() -> Vec<(&'static str, Scenario)> {
    let mut crowd = contest();
    crowd.wumpus.push(Wumpus { start_m: [202.5, 47.5], goal: WumpusGoal::FarthestFromTruck, ..Wumpus::default() });
    crowd.unimog.push(Unimog {
        goal: TruckGoal::LargestCluster,
        retarget: Retarget::OnEvent,
        start: StartPose { x_m: 60.0, y_m: 200.0, heading_deg: 90.0 },
        limits: Limits { acceleration_mps2: Some(2.0), braking_mps2: Some(4.0), lateral_mps2: Some(3.0) },
        ..Unimog::default()
    });
    crowd.ignition = vec![Ignition { at_s: 5.0, every_s: None, cells: IgnitionCells::Random(3) }];
    crowd.suppression.extinguishes = Extinguishes::AllInReach;
    crowd.fire.spread_from = SpreadFrom::All;

    let mut thinkers = contest();
    thinkers.wumpus[0].seconds_per_expansion = 0.1;
    thinkers.unimog[0].prm_rs.seconds_per_expansion = 0.2;
    thinkers.unimog[0].hybrid.seconds_per_expansion = 0.3;
    thinkers.unimog[0].goal = TruckGoal::Oldest;
    thinkers.fire.relight = true;
    thinkers.duration_s = 900.0;

    let mut descents = contest();
    descents.wumpus[0].planner = WumpusPlanner::Potential;
    descents.wumpus.push(Wumpus { start_m: [202.5, 47.5], planner: WumpusPlanner::Potential, ..Wumpus::default() });
    descents.wumpus[1].potential.escape = Escape::None;
    descents.wumpus[1].seconds_per_expansion = 0.1;
    descents.wumpus.push(Wumpus { planner: WumpusPlanner::Wavefront, ..Wumpus::default() });

    let mut pieces = contest();
    pieces.fire.unit = FireUnit::Piece;
    pieces.fire.relight = true;
    pieces.ignition = vec![Ignition { at_s: 30.0, every_s: Some(45.0), cells: IgnitionCells::Random(2) }];
    pieces.duration_s = 1200.0;

    vec![("contest", contest()), ("crowd", crowd), ("thinkers", thinkers), ("descents", descents), ("pieces", pieces)]
}

fn run(scenario: &Scenario, seed: u64) -> Timeline {
    sim::run(scenario, seed).expect("the scenario can be run").timeline
}

fn first(timeline: &Timeline, wanted: impl Fn(&Fact) -> bool) -> Option<SimTime> {
    timeline.events.iter().find(|event| wanted(&event.fact)).map(|event| event.time)
}

/// Equal bit for bit; the message shows the first fact that differs.
fn assert_same(a: &Timeline, b: &Timeline, name: &str) {
    for (left, right) in a.events.iter().zip(&b.events) {
        assert_eq!(left, right, "{name}");
    }
    assert_eq!(a.events.len(), b.events.len(), "{name}");
    assert!(a.setting == b.setting, "{name}");
}

#[test]
fn whole_pieces_are_in_one_state_whenever_an_instant_is_over() {
    let scenario = variety().pop().expect("the last one is of pieces").1;
    let timeline = run(&scenario, 4);
    let setting = &timeline.setting;
    assert_eq!(setting.pieces.len(), setting.bushes.len());
    assert!(file::decode(&file::encode(&timeline).expect("it is a run")).expect("just written") == timeline);
    let mut extinguished = 0;
    for instant in timeline.events.chunk_by(|one, next| one.time == next.time) {
        let mut counts: BTreeMap<_, [usize; 3]> = BTreeMap::new();
        for event in instant {
            let Fact::Fire(fact) = event.fact else { continue };
            let [ignited, extinguished, burned_out] = counts.entry(setting.piece(fact.cell())).or_default();
            *match fact {
                FireFact::Ignited { .. } => ignited,
                FireFact::Extinguished { .. } => extinguished,
                FireFact::BurnedOut { .. } => burned_out,
            } += 1;
        }
        assert!(counts.values().flatten().all(|count| count % 4 == 0), "{counts:?}");
        extinguished += counts.values().map(|[_, extinguished, _]| extinguished / 4).sum::<usize>();
    }
    assert!(extinguished >= 3, "{extinguished} pieces went out");
}

#[test]
fn an_ignition_repeats_to_the_end_of_the_run() {
    let mut scenario = empty_contest();
    scenario.duration_s = 100.0;
    scenario.fire.spread_from = SpreadFrom::None;
    scenario.ignition = vec![Ignition { at_s: 10.0, every_s: Some(30.0), cells: IgnitionCells::Random(1) }];
    let timeline = run(&scenario, 1);
    let lit = timeline.events.iter().filter(|event| matches!(event.fact, Fact::Fire(FireFact::Ignited { .. })));
    assert_eq!(lit.map(|event| event.time.as_seconds()).collect::<Vec<_>>(), [10.0, 40.0, 70.0, 100.0]);
    let mut shorter = scenario.clone();
    shorter.duration_s = 80.0;
    let is_before = |event: &&Event| event.time < SimTime::from_seconds(80.0);
    let events = timeline.events.iter().filter(is_before);
    assert!(events.eq(run(&shorter, 1).events.iter().filter(is_before)), "what comes later changes nothing before");
}

#[test]
fn cutting_time_into_slices_changes_nothing() {
    for (name, scenario) in variety() {
        for seed in 1..=3 {
            let whole = run(&scenario, seed);
            let mut slices = rng::stream(seed, "slices");
            let mut sliced = Simulation::new(&scenario, seed).expect("the scenario can be run");
            let mut until = SimTime::ZERO;
            while until <= SimTime::from_seconds(scenario.duration_s) {
                sliced.advance_to(until);
                // Mostly short slices, some of length zero, some long.
                let longest = [0, 1_000, 3_000_000_000, 200_000_000_000][slices.random_range(0..4)];
                until += SimTime::from_nanos(slices.random_range(0..=longest).max(u64::from(longest == 0)));
                if slices.random_bool(0.9) {
                    until += SimTime::from_seconds(1.0);
                }
            }
            sliced.advance_to(SimTime::MAX);
            assert_same(&sliced.finish().timeline, &whole, &format!("{name}, seed {seed}"));
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_facts_and_another_seed_others() {
    for (name, scenario) in variety() {
        assert_same(&run(&scenario, 7), &run(&scenario, 7), name);
        assert!(run(&scenario, 7).events != run(&scenario, 8).events, "{name}");
    }
}

#[test]
fn facts_come_in_order_of_time_and_end_with_the_end() {
    for (name, scenario) in variety() {
        let timeline = run(&scenario, 2);
        assert!(timeline.events.is_sorted_by_key(|event| event.time), "{name}");
        let ends = timeline.events.iter().filter(|event| matches!(event.fact, Fact::Ended { .. })).count();
        assert_eq!(ends, 1, "{name}");
        assert!(matches!(timeline.events.last().map(|event| &event.fact), Some(Fact::Ended { .. })), "{name}");
    }
}

#[test]
fn every_leg_starts_where_and_when_the_last_one_allows() {
    for (name, scenario) in variety() {
        let timeline = run(&scenario, 4);
        for start in &timeline.setting.agents {
            let (mut pose, mut free_at) = (start.pose, SimTime::ZERO);
            let mut legs = 0;
            for Event { time, fact } in &timeline.events {
                match fact {
                    Fact::Agent(agent, AgentFact::Planned { trajectory, .. }) if *agent == start.id => {
                        assert_eq!(trajectory.start(), pose, "{name}: {agent} at {time}");
                        assert!(*time >= free_at, "{name}: {agent} plans while it moves");
                        assert!(trajectory.start_time() >= *time);
                        (pose, free_at) = (trajectory.end(), trajectory.end_time());
                        legs += 1;
                    }
                    Fact::Agent(agent, AgentFact::Dropped { trajectory, .. }) if *agent == start.id => {
                        assert!(trajectory.end_time() <= free_at, "{name}: a leg cut short is not longer");
                        (pose, free_at) = (trajectory.end(), trajectory.end_time());
                    }
                    _ => {}
                }
            }
            assert!(legs > 1, "{name}: {} made {legs} legs", start.id);
        }
    }
}

#[test]
fn two_trucks_never_have_the_same_goal() {
    let mut scenario = contest();
    scenario.unimog = (0..3)
        .map(|k| Unimog {
            start: StartPose { x_m: 50.0, y_m: 50.0 + 30.0 * f64::from(k), heading_deg: 0.0 },
            ..Unimog::default()
        })
        .collect();
    for seed in 1..=5 {
        let mut goals: Vec<(AgentId, Cell)> = Vec::new();
        for Event { fact, time } in run(&scenario, seed).events {
            match fact {
                Fact::Agent(agent @ AgentId { role: Role::Unimog, .. }, AgentFact::Planned { goal, .. }) => {
                    assert!(goals.iter().all(|&(_, other)| other != goal), "seed {seed} at {time}: {goal} twice");
                    goals.push((agent, goal));
                }
                Fact::Agent(agent, AgentFact::Dropped { .. })
                | Fact::Fire(FireFact::Extinguished { by: agent, .. })
                | Fact::Agent(agent, AgentFact::SuppressionEnded { .. }) => goals.retain(|&(other, _)| other != agent),
                _ => {}
            }
        }
    }
}

#[test]
fn at_one_instant_extinction_comes_before_burn_out() {
    let mut scenario = ignitions(1);
    let free = run(&scenario, 3);
    let out =
        first(&free, |fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. }))).expect("one fire, one truck");
    scenario.fire.burn_out_s = Some(out.as_seconds());
    let together = run(&scenario, 3);
    assert_eq!(first(&together, |fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. }))), Some(out));
    assert_eq!(first(&together, |fact| matches!(fact, Fact::Fire(FireFact::BurnedOut { .. }))), None);
    scenario.fire.burn_out_s = Some(SimTime::from_nanos(out.as_nanos() - 1).as_seconds());
    let earlier = run(&scenario, 3);
    assert_eq!(first(&earlier, |fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. }))), None);
    assert!(first(&earlier, |fact| matches!(fact, Fact::Agent(_, AgentFact::SuppressionEnded { .. }))).is_some());
}

#[test]
fn at_one_instant_burn_out_comes_before_spread() {
    let mut scenario = ignitions(1);
    scenario.unimog.clear();
    scenario.fire.spread_from = SpreadFrom::Ignited;
    let caught = |timeline: &Timeline| {
        let spread =
            |event: &&Event| matches!(event.fact, Fact::Fire(FireFact::Ignited { cause: Cause::Spread(_), .. }));
        timeline.events.iter().filter(spread).count()
    };
    scenario.fire.burn_out_s = Some(10.0);
    assert_eq!(caught(&run(&scenario, 3)), 0);
    scenario.fire.burn_out_s = Some(10.000_000_001);
    assert!(caught(&run(&scenario, 3)) > 0);
}

#[test]
fn what_is_due_exactly_at_the_end_happens() {
    let mut scenario = ignitions(1);
    let out =
        first(&run(&scenario, 3), |fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. }))).expect("one fire");
    let put_out = |scenario: &Scenario| {
        first(&run(scenario, 3), |fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. }))).is_some()
    };
    scenario.duration_s = out.as_seconds();
    assert!(put_out(&scenario));
    scenario.duration_s = SimTime::from_nanos(out.as_nanos() - 1).as_seconds();
    assert!(!put_out(&scenario));
}

#[test]
fn a_run_ends_early_when_nothing_is_left_to_happen() {
    let scenario = ignitions(2);
    let timeline = run(&scenario, 1);
    let last = timeline.events.last().expect("a run has facts");
    assert!(last.time >= SimTime::from_seconds(60.0) && last.time < SimTime::from_seconds(3600.0));
    assert!(matches!(last.fact, Fact::Ended { reason: EndReason::NothingLeft }));
}

#[test]
fn a_truck_that_reconsiders_never_drops_a_goal_to_choose_it_again() {
    let mut scenario = contest();
    scenario.unimog[0].retarget = Retarget::OnEvent;
    scenario.field.coverage = 0.2;
    let mut drops = 0;
    for seed in 1..=4 {
        let mut dropped = None;
        for Event { time, fact } in run(&scenario, seed).events {
            match fact {
                Fact::Agent(AgentId { role: Role::Unimog, .. }, AgentFact::Dropped { goal, .. }) => {
                    dropped = Some(goal);
                }
                // Another goal seemed better until its plan failed.
                Fact::Agent(_, AgentFact::PlanFailed { .. }) => dropped = None,
                Fact::Agent(AgentId { role: Role::Unimog, .. }, AgentFact::Planned { goal, .. }) => {
                    drops += u32::from(dropped.is_some());
                    assert_ne!(dropped.take(), Some(goal), "seed {seed} at {time}");
                }
                _ => {}
            }
        }
    }
    assert!(drops > 20, "only {drops} goals were dropped");
}

#[test]
fn a_run_without_anybody_ends_at_once() {
    let timeline = run(&empty_contest(), 1);
    assert_eq!(timeline.events.len(), 1);
    assert_eq!(timeline.events[0].time, SimTime::ZERO);
}

#[test]
fn nobody_acts_before_its_planning_time_is_over() {
    let (_, scenario) = variety().remove(2);
    let timeline = run(&scenario, 5);
    let mut charged = 0;
    for Event { time, fact } in &timeline.events {
        if let Fact::Agent(AgentId { role: Role::Unimog, .. }, AgentFact::Planned { trajectory, effort, .. }) = fact {
            let seconds = 0.2 * f64::from(effort.roadmap_expansions) + 0.3 * f64::from(effort.local_expansions);
            assert_eq!(trajectory.start_time(), *time + SimTime::from_seconds(seconds));
            charged += u32::from(seconds > 0.0);
        }
    }
    assert!(charged > 3, "{charged} plans were charged");
}

#[test]
fn a_wumpus_that_drops_its_goal_stops_on_its_lattice() {
    let timeline = run(&contest(), 6);
    let mut drops = 0;
    for Event { fact, .. } in &timeline.events {
        if let Fact::Agent(AgentId { role: Role::Wumpus, .. }, AgentFact::Dropped { trajectory, .. }) = fact {
            let end = trajectory.end().position();
            let centre = timeline.setting.frame.centre(timeline.setting.frame.cell_at(end).expect("on the field"));
            assert!((end - centre).length() < 1e-9, "{end} is not a cell's centre");
            drops += 1;
        }
    }
    assert!(drops > 0, "spread took none of its goals");
}

#[test]
fn planners_do_not_change_the_arsonists_order_of_goals() {
    let alone = Scenario { unimog: Vec::new(), ..contest() };
    let ignitions = |timeline: &Timeline| {
        timeline.events.iter().find_map(|event| match event.fact {
            Fact::Agent(AgentId { role: Role::Wumpus, number: 0 }, AgentFact::Planned { goal, .. }) => Some(goal),
            _ => None,
        })
    };
    for seed in 1..=5 {
        let with_truck = run(&contest(), seed);
        let mut other = contest();
        other.unimog[0].prm.samples = 50;
        assert_eq!(ignitions(&with_truck), ignitions(&run(&other, seed)));
        // The field keeps clear of the truck's start, so a contest without a truck has another field.
        assert!(ignitions(&run(&alone, seed)).is_some());
    }
}

/// A Wumpus with this planner and nobody else.
fn arsonist(planner: WumpusPlanner, escape: Escape) -> Scenario {
    let mut scenario = Scenario { unimog: Vec::new(), ..contest() };
    scenario.wumpus[0].planner = planner;
    scenario.wumpus[0].potential.escape = escape;
    scenario
}

#[test]
fn an_arsonist_on_a_wavefront_walks_as_far_as_one_with_astar_for_every_goal() {
    for seed in 1..=3 {
        let first_walk = |planner| {
            let timeline = run(&arsonist(planner, Escape::None), seed);
            timeline.events.into_iter().find_map(|event| match event.fact {
                Fact::Agent(_, AgentFact::Planned { goal, trajectory, effort, .. }) => {
                    Some((goal, trajectory.distance_m(SimTime::MAX), effort))
                }
                _ => None,
            })
        };
        let (goal, metres, effort) = first_walk(WumpusPlanner::Astar).expect("it sets out");
        let (same_goal, same_metres, more_effort) = first_walk(WumpusPlanner::Wavefront).expect("it sets out");
        assert_eq!(goal, same_goal);
        assert!((metres - same_metres).abs() < 1e-9, "seed {seed}: {metres} and {same_metres} m");
        assert!(more_effort.local_expansions > effort.local_expansions);
    }
}

#[test]
fn an_arsonist_that_escapes_from_local_minima_is_never_stuck_and_burns_all_that_it_could() {
    for seed in 1..=3 {
        let astar = Outcome::new(&run(&arsonist(WumpusPlanner::Astar, Escape::None), seed));
        let descent = Outcome::new(&run(&arsonist(WumpusPlanner::Potential, Escape::Wavefront), seed));
        assert_eq!((descent.intact, descent.wumpus_stuck_s), (astar.intact, 0.0));
        assert!(descent.agents[0].local_minima > 0 && descent.agents[0].failures.sum() == 0);
    }
}

#[test]
fn without_an_escape_no_goal_is_tried_twice_from_one_place_and_giving_all_up_counts_as_stuck() {
    let (mut failed, mut gave_up) = (0, 0);
    for seed in 1..=12 {
        let timeline = run(&arsonist(WumpusPlanner::Potential, Escape::None), seed);
        let (mut fails, mut tries) = (0, Vec::new());
        let mut rests_from = None;
        for Event { time, fact } in &timeline.events {
            match fact {
                Fact::Agent(_, AgentFact::Planned { goal, trajectory, .. }) => {
                    let attempt = (*goal, trajectory.start().position());
                    assert!(!tries.contains(&attempt), "seed {seed} at {time}: {goal} failed here before");
                    tries.push(attempt);
                }
                Fact::Agent(_, AgentFact::LocalMinimum { .. }) => fails += 1,
                Fact::Agent(_, AgentFact::PlanFailed { reason, .. }) => assert_eq!(*reason, PlanFailure::LocalMinimum),
                Fact::Agent(_, AgentFact::Rested { reason: RestReason::LocalMinima, .. }) => rests_from = Some(*time),
                _ => {}
            }
        }
        let outcome = Outcome::new(&timeline);
        let arsonist = &outcome.agents[0];
        assert_eq!((arsonist.local_minima, arsonist.failures[PlanFailure::LocalMinimum]), (fails, fails));
        let rested_s = rests_from.map_or(0.0, |from| (timeline.end_time() - from).as_seconds());
        assert_eq!(outcome.wumpus_stuck_s, rested_s, "seed {seed}");
        failed += fails;
        gave_up += u32::from(rests_from.is_some());
    }
    assert!(failed > 100 && gave_up > 0, "{failed} failed plans, {gave_up} gave up");
}

/// An arsonist that nothing attracts: out of a bush's repulsion it stands in a local minimum, whatever it goes for.
fn stuck_arsonist() -> Scenario {
    let mut scenario = arsonist(WumpusPlanner::Potential, Escape::None);
    scenario.wumpus[0].potential.scale = Some(0.0);
    scenario
}

#[test]
fn the_run_is_over_when_others_have_burned_what_a_stuck_arsonist_could_not_approach() {
    let mut scenario = stuck_arsonist();
    scenario.wumpus.push(Wumpus::default());
    let timeline = run(&scenario, 1);
    let rests = |fact: &Fact| matches!(fact, Fact::Agent(_, AgentFact::Rested { reason: RestReason::LocalMinima, .. }));
    assert!(timeline.events.iter().any(|event| rests(&event.fact)));
    let last = timeline.events.last().expect("a run ends");
    assert!(matches!(last.fact, Fact::Ended { reason: EndReason::NothingLeft }), "{last:?}");
}

#[test]
fn an_arsonist_that_fails_on_all_goals_rests_after_the_planning_time_of_all() {
    let mut scenario = stuck_arsonist();
    scenario.wumpus[0].seconds_per_expansion = 2.0;
    let timeline = run(&scenario, 1);
    let (mut until, mut tries_in_a_row) = (SimTime::ZERO, 0);
    for Event { time, fact } in &timeline.events {
        match fact {
            Fact::Agent(_, AgentFact::PlanFailed { until: ready, .. }) => {
                tries_in_a_row += 1;
                until = until.max(*time) + SimTime::from_seconds(2.0);
                assert_eq!(*ready, until);
            }
            Fact::Agent(_, AgentFact::Planned { .. }) => tries_in_a_row = 0,
            Fact::Agent(_, AgentFact::Rested { reason, .. }) => {
                assert_eq!((*reason, *time), (RestReason::LocalMinima, until));
                assert!(tries_in_a_row > 100, "{tries_in_a_row} tries");
                return;
            }
            _ => {}
        }
    }
    panic!("it never rests");
}
