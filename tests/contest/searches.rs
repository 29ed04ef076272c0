//! Runs that record what their searches looked at: nothing else about them changes, and the graphs fit the plans.

use std::time::Duration;

use rand::RngExt;
use wildfire::geometry::Pose;
use wildfire::planning::{MAX_SEARCH_EDGES, SearchGraph, SearchPhase};
use wildfire::rng;
use wildfire::scenario::{self, Escape, Scenario, StartPose, TruckPlannerKind, Unimog, Wumpus, WumpusPlanner};
use wildfire::sim::{self, Run, Simulation};
use wildfire::time::SimTime;
use wildfire::timeline::{AgentFact, AgentId, Event, Fact, Outcome, Timeline, file};

/// A quarter of an hour of the contest.
fn contest() -> Scenario {
    let mut contest = scenario::load("contest-1", &[]).expect("the built-in loads");
    contest.duration_s = 900.0;
    contest
}

fn driven_by(planner: TruckPlannerKind) -> Scenario {
    let mut scenario = contest();
    scenario.unimog[0].planner = planner.into();
    scenario.field.coverage = 0.2;
    scenario
}

/// Two trucks and a Wumpus of every planner.
fn crowd() -> Scenario {
    let mut scenario = contest();
    scenario.unimog.push(Unimog {
        planner: TruckPlannerKind::PrmPrimitives.into(),
        start: StartPose { x_m: 60.0, y_m: 200.0, heading_deg: 90.0 },
        ..Unimog::default()
    });
    scenario.wumpus.push(Wumpus { planner: WumpusPlanner::Wavefront, ..Wumpus::default() });
    scenario.wumpus.push(Wumpus { planner: WumpusPlanner::Potential, ..Wumpus::default() });
    scenario.wumpus.push(Wumpus { planner: WumpusPlanner::Potential, ..Wumpus::default() });
    scenario.wumpus[2].potential.escape = Escape::None;
    scenario.wumpus[3].potential.escape = Escape::Wavefront;
    scenario
}

fn record(scenario: &Scenario, seed: u64) -> Run {
    sim::run_recording_searches(scenario, seed).expect("the scenario can be run")
}

fn without_searches(timeline: &Timeline) -> Timeline {
    let mut timeline = timeline.clone();
    timeline.events.retain(|event| !matches!(event.fact, Fact::Agent(_, AgentFact::Searched { .. })));
    timeline
}

/// A place as graphs hold it.
fn place(pose: Pose) -> (i32, i32) {
    let centimetres = (pose.position() * 100.0).round();
    (centimetres.x as i32, centimetres.y as i32)
}

/// Whether a graph leads from its first place to all others.
fn is_connected(graph: &SearchGraph) -> bool {
    let mut reached = vec![false; graph.places.len()];
    reached[0] = true;
    for &(from, to) in &graph.edges {
        reached[to as usize] |= reached[from as usize];
    }
    reached.into_iter().all(|reached| reached)
}

/// What one agent's plan looked at, and the fact that tells of the plan.
fn plans(timeline: &Timeline, of: AgentId) -> Vec<(Vec<(SearchPhase, &SearchGraph)>, &Event)> {
    let mut plans = Vec::new();
    let mut graphs = Vec::new();
    for event in timeline.events.iter().filter(|event| event.fact.agent() == Some(of)) {
        match &event.fact {
            Fact::Agent(_, AgentFact::Searched { phase, graph, .. }) => graphs.push((*phase, graph)),
            Fact::Agent(_, AgentFact::RoadmapBuilt { .. }) | Fact::Agent(_, AgentFact::LocalMinimum { .. }) => {}
            _ => plans.push((std::mem::take(&mut graphs), event)),
        }
    }
    plans
}

#[test]
fn recording_changes_nothing_but_adds_searches() {
    let mut scenarios: Vec<Scenario> = TruckPlannerKind::ALL.map(driven_by).into();
    scenarios.push(crowd());
    for (number, scenario) in scenarios.iter().enumerate() {
        let plain = sim::run(scenario, 3).expect("the scenario can be run").timeline;
        let recorded = record(scenario, 3).timeline;
        assert!(!plain.events.iter().any(|event| matches!(event.fact, Fact::Agent(_, AgentFact::Searched { .. }))));
        assert!(recorded.events.len() > plain.events.len() + 20, "scenario {number}");
        let rest = without_searches(&recorded);
        assert!(rest == plain, "scenario {number}");
        assert!(Outcome::new(&recorded) == Outcome::new(&plain), "scenario {number}");
        let bytes = |timeline| file::encode(timeline).expect("it can be recorded");
        assert!(bytes(&rest) == bytes(&plain), "scenario {number}: not bit for bit");
        assert!(file::decode(&bytes(&recorded)).expect("it was recorded") == recorded, "scenario {number}");
    }
}

#[test]
fn graphs_hold_their_edges_places_and_keep_to_the_limit() {
    let timeline = record(&crowd(), 4).timeline;
    let mut phases = Vec::new();
    for Event { fact, .. } in &timeline.events {
        let Fact::Agent(_, AgentFact::Searched { phase, graph, .. }) = fact else { continue };
        assert!(graph.edges.iter().flat_map(|&(from, to)| [from, to]).all(|end| (end as usize) < graph.places.len()));
        assert!(!graph.places.is_empty() && graph.edges.len() <= MAX_SEARCH_EDGES);
        assert_eq!(graph.lines().count(), graph.edges.len());
        if !phases.contains(phase) {
            phases.push(*phase);
        }
    }
    assert_eq!(phases.len(), 4, "only {phases:?}");
}

#[test]
fn searches_stand_right_before_what_they_led_to() {
    let timeline = record(&crowd(), 5).timeline;
    let mut last: Option<(SimTime, AgentId)> = None;
    for Event { time, fact } in &timeline.events {
        if let Some((searched_at, by)) = last {
            assert_eq!((*time, fact.agent()), (searched_at, Some(by)), "{fact:?} comes between");
        }
        let goes_on = match fact {
            Fact::Agent(_, AgentFact::Searched { phase: SearchPhase::Roadmap, .. }) => false,
            Fact::Agent(_, AgentFact::Searched { .. }) => true,
            _ if last.is_some() => {
                let is_answer = matches!(
                    fact,
                    Fact::Agent(_, AgentFact::Planned { .. })
                        | Fact::Agent(_, AgentFact::PlanFailed { .. })
                        | Fact::Agent(_, AgentFact::Blocked { .. })
                );
                assert!(is_answer || matches!(fact, Fact::Agent(_, AgentFact::LocalMinimum { .. })), "{fact:?}");
                !is_answer
            }
            _ => false,
        };
        last = fact.agent().filter(|_| goes_on).map(|agent| (*time, agent));
    }
}

#[test]
fn local_searches_begin_where_the_truck_stands_and_hang_together() {
    for planner in TruckPlannerKind::ALL {
        let timeline = record(&driven_by(planner), 2).timeline;
        let mut searched = 0;
        for (graphs, event) in plans(&timeline, AgentId::unimog(0)) {
            let Some((_, graph)) = graphs.iter().find(|(phase, _)| *phase == SearchPhase::Local) else { continue };
            let stands = timeline.state_at(event.time).agents[1].pose;
            assert_eq!(graph.places[0], place(stands), "{planner} at {}", event.time);
            if let Fact::Agent(_, AgentFact::Planned { trajectory, .. }) = &event.fact {
                assert_eq!(graph.places[0], place(trajectory.start()));
            }
            // The others also search from the goal.
            if matches!(planner, TruckPlannerKind::PrmPrimitives | TruckPlannerKind::Lattice) {
                assert!(is_connected(graph), "{planner} at {}", event.time);
            }
            searched += 1;
        }
        assert!(searched > 10, "{planner}: {searched} local searches");
    }
}

#[test]
fn a_walks_graph_has_an_edge_for_every_expansion_and_leads_to_where_it_ends() {
    let timeline = record(&contest(), 6).timeline;
    let mut walks = 0;
    for (graphs, event) in plans(&timeline, AgentId::wumpus(0)) {
        let Fact::Agent(_, AgentFact::Planned { trajectory, effort, .. }) = &event.fact else { continue };
        let [(SearchPhase::Walk, graph)] = graphs[..] else { panic!("one search for a walk") };
        assert_eq!(graph.edges.len() as u32, effort.local_expansions);
        assert_eq!(graph.places[0], place(trajectory.start()));
        assert_eq!(graph.places.last(), Some(&place(trajectory.end())));
        assert!(is_connected(graph));
        walks += 1;
    }
    assert!(walks > 10, "{walks} walks");
}

#[test]
fn all_that_a_wave_settles_leads_back_to_where_it_began() {
    let timeline = record(&crowd(), 6).timeline;
    let (mut waves, mut descents) = (0, 0);
    for (graphs, event) in plans(&timeline, AgentId::wumpus(1)) {
        let Fact::Agent(_, AgentFact::Planned { trajectory, effort, .. }) = &event.fact else { continue };
        let [(SearchPhase::Walk, graph)] = graphs[..] else { panic!("one search for a walk") };
        assert_eq!(graph.places.len() as u32, effort.local_expansions);
        // Every point is led to but for those in reach of the goal, where the wave begins.
        let mut is_led_to = vec![false; graph.places.len()];
        graph.edges.iter().for_each(|&(_, to)| is_led_to[to as usize] = true);
        let beginnings = is_led_to.iter().filter(|&&is_led_to| !is_led_to).count();
        assert!((1..=8).contains(&beginnings), "{beginnings} points of reach");
        assert!(graph.places.contains(&place(trajectory.start())) && graph.places.contains(&place(trajectory.end())));
        waves += 1;
    }
    for (graphs, event) in plans(&timeline, AgentId::wumpus(2)) {
        let Fact::Agent(_, AgentFact::Planned { trajectory, .. }) = &event.fact else { continue };
        let [(SearchPhase::Walk, graph)] = graphs[..] else { panic!("one descent for a walk") };
        assert!(is_connected(graph));
        assert_eq!(
            (graph.places.first(), graph.places.last()),
            (Some(&place(trajectory.start())), Some(&place(trajectory.end())))
        );
        descents += 1;
    }
    assert!(waves > 10 && descents > 5, "{waves} waves, {descents} descents");
}

#[test]
fn queries_settle_what_they_expand_and_the_roadmap_is_told_with_its_size() {
    for planner in [TruckPlannerKind::PrmPrimitives, TruckPlannerKind::PrmRs] {
        let timeline = record(&driven_by(planner), 7).timeline;
        let is_built = |event: &Event| matches!(event.fact, Fact::Agent(_, AgentFact::RoadmapBuilt { .. }));
        let built = timeline.events.iter().position(is_built).expect("it has a roadmap");
        let [
            Fact::Agent(_, AgentFact::RoadmapBuilt { samples, edges, .. }),
            Fact::Agent(_, AgentFact::Searched { phase, graph, .. }),
        ] = [&timeline.events[built].fact, &timeline.events[built + 1].fact]
        else {
            panic!("the roadmap comes right after its size")
        };
        assert_eq!(*phase, SearchPhase::Roadmap);
        let max = (*edges as usize).min(MAX_SEARCH_EDGES);
        assert!(graph.places.len() as u32 <= *samples && graph.edges.len() <= max, "{planner}");
        assert!(planner == TruckPlannerKind::PrmRs || graph.edges.len() == max, "its lines are all free");
        assert!(graph.edges.len() > 1_000, "{planner}: {} of {edges} edges", graph.edges.len());
        let mut queries = 0;
        for (graphs, event) in plans(&timeline, AgentId::unimog(0)) {
            let (Fact::Agent(_, AgentFact::Planned { effort, .. })
            | Fact::Agent(_, AgentFact::PlanFailed { effort, .. })) = event.fact
            else {
                continue;
            };
            let Some((_, graph)) = graphs.iter().find(|(phase, _)| *phase == SearchPhase::Query) else { continue };
            // A milestone in the goal is settled and not expanded; prm-rs settles one in both directions of driving.
            assert!(graph.edges.len() as u32 <= effort.roadmap_expansions + 1, "{planner} at {}", event.time);
            assert!(3 * graph.edges.len() as u32 >= effort.roadmap_expansions, "{planner} at {}", event.time);
            queries += 1;
        }
        assert!(queries > 10, "{planner}: {queries} queries");
    }
}

#[test]
fn cutting_time_into_slices_changes_no_search() {
    let scenario = crowd();
    let whole = record(&scenario, 8).timeline;
    let mut slices = rng::stream(8, "slices");
    let mut sliced = Simulation::recording_searches(&scenario, 8).expect("the scenario can be run");
    let mut until = SimTime::ZERO;
    while until < SimTime::from_seconds(scenario.duration_s) {
        sliced.advance_to(until);
        until += SimTime::from_seconds(slices.random_range(0.0..20.0));
    }
    sliced.advance_to(SimTime::MAX);
    assert!(sliced.finish().timeline == whole);
}

#[test]
fn what_decisions_cost_adds_up_to_what_the_agents_cost() {
    for scenario in [contest(), crowd()] {
        let run = sim::run(&scenario, 1).expect("the scenario can be run");
        assert!(run.cpu_samples.is_sorted_by_key(|sample| sample.time));
        for cost in &run.cost.agents {
            let samples: Vec<_> = run.cpu_samples.iter().filter(|sample| sample.agent == cost.agent).collect();
            assert_eq!(samples.iter().map(|sample| sample.cpu).sum::<Duration>(), cost.total());
            assert_eq!((samples[0].time, samples[0].cpu), (SimTime::ZERO, cost.sampling + cost.connecting));
            assert!(samples.len() > 10 && samples[1..].iter().all(|sample| !sample.cpu.is_zero()));
        }
    }
}
