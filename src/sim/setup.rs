//! From a scenario and a seed to the world at time 0.

use std::collections::BTreeSet;
use std::sync::Arc;

use bevy::prelude::*;
use glam::DVec2;
use rand::seq::SliceRandom;

use crate::collision::{ClearanceField, CollisionChecker};
use crate::fire::FireField;
use crate::geometry::{Cell, FieldFrame, Pose};
use crate::planning::memory::MemoryMeter;
use crate::planning::reachability::Reachability;
use crate::planning::walk::{WalkCosts, WalkLattice, WalkPlanner};
use crate::planning::{BuildReport, QueryMonitor, Safety};
use crate::rng;
use crate::scenario::{Extinguishes, Retarget, Scenario, StepCost, StepTime, Terrain, WumpusGoal};
use crate::time::SimTime;
use crate::time::cpu::CpuStopwatch;
use crate::timeline::{AgentFact, AgentId, AgentStart, Body, CpuSample, Fact, Rules, Setting};
use crate::trajectory::SpeedLimits;
use crate::vehicle::Dimensions;

use super::agenda::{Agenda, Due, SimClock};
use super::agent::{Agent, Ledger, Log, Roster};
use super::fires::Ignitions;
use super::stage::{Fires, Frame};
use super::tracks::Tracks;
use super::traffic::keep_apart;
use super::truck::Truck;
use super::wumpus::{Wumpus, step_times_by_distance};
use super::{AgentCost, Ended, RunCost, RunError};
use crate::scenario;

/// Clearance that a truck's start has at least, in metres.
const START_CLEARANCE_M: f64 = 0.05;

/// The world with everybody at the start and the first decisions due, what the timeline says of it, and its cost.
pub fn build(
    scenario: &Scenario,
    seed: u64,
    memory: &MemoryMeter,
    records_searches: bool,
) -> Result<(World, Setting, RunCost), RunError> {
    let mut cost = RunCost::default();
    let mut stopwatch = CpuStopwatch::start();
    let terrain = Terrain::from_scenario(scenario, seed)?;
    cost.terrain = stopwatch.lap();
    let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    cost.clearance_field = stopwatch.lap();

    let mut world = World::new();
    let mut log = Log::new(memory, records_searches);
    let mut ledger = Ledger::default();
    let mut roster = Roster::default();
    let mut starts = Vec::new();
    for (number, settings) in scenario.wumpus.iter().enumerate() {
        let id = AgentId::wumpus(number as u16);
        let (agent, wumpus) = place_wumpus(id, settings, &terrain, seed, &mut log)?;
        let body = Body::Square { size_m: settings.size_m };
        let limits = Some(wumpus_limits(settings));
        starts.push(AgentStart { id, pose: agent.trajectory.start(), body, limits });
        ledger.0.push(CpuSample { time: SimTime::ZERO, agent: id, cpu: wumpus.cost.total() });
        roster.wumpuses.push(world.spawn((agent, wumpus)).id());
    }
    let mut parked = Vec::new();
    for (number, settings) in scenario.unimog.iter().enumerate() {
        let id = AgentId::unimog(number as u16);
        let (agent, mut truck) = place_truck(id, (settings, scenario), (&field, memory), &parked, seed, &mut log)?;
        if records_searches {
            let mut monitor = QueryMonitor::new(true);
            truck.planner.show_roadmap(&mut monitor);
            log.add_searches(SimTime::ZERO, id, monitor.finish().1);
        }
        parked.push((settings.vehicle, agent.trajectory.start()));
        let (body, limits) = (Body::Truck(settings.vehicle), Some(truck.speed));
        starts.push(AgentStart { id, pose: agent.trajectory.start(), body, limits });
        ledger.0.push(CpuSample { time: SimTime::ZERO, agent: id, cpu: truck.cost.total() });
        roster.trucks.push(world.spawn((agent, truck)).id());
    }
    let setting = setting(scenario, seed, &terrain, starts);
    world.insert_resource(SimClock::default());
    world.insert_resource(first_entries(scenario, &setting.rules, &roster));
    world.insert_resource(Fires {
        field: FireField::new(terrain.frame, &terrain.bushes, scenario.fire.relight),
        model: scenario.fire.model(&terrain.frame),
    });
    world.insert_resource(Frame(terrain.frame));
    world.insert_resource(ignitions(scenario, &terrain, seed));
    world.insert_resource(roster);
    world.insert_resource(log);
    world.insert_resource(ledger);
    world.insert_resource(Ended::default());
    Ok((world, setting, cost))
}

fn setting(scenario: &Scenario, seed: u64, terrain: &Terrain, agents: Vec<AgentStart>) -> Setting {
    Setting {
        scenario: scenario.name.clone(),
        seed,
        program_version: env!("CARGO_PKG_VERSION").into(),
        frame: terrain.frame,
        bushes: terrain.bushes.clone(),
        agents,
        rules: Rules {
            duration: SimTime::from_seconds(scenario.duration_s),
            suppression_reach_m: scenario.suppression.reach_m,
            suppression_dwell: SimTime::from_seconds(scenario.suppression.dwell_s),
            extinguishes_all: Some(scenario.suppression.extinguishes == Extinguishes::AllInReach),
            fire: Some(scenario.fire.rules()),
            relight: scenario.fire.relight,
            score_wumpus_ignited: scenario.score.wumpus_ignited,
            score_wumpus_burned_out: scenario.score.wumpus_burned_out,
            score_truck_extinguished: scenario.score.truck_extinguished,
        },
    }
}

/// Ignitions of the scenario, everybody's first decision, and the end.
fn first_entries(scenario: &Scenario, rules: &Rules, roster: &Roster) -> Agenda {
    let mut agenda = Agenda::default();
    for (number, ignition) in scenario.ignition.iter().enumerate() {
        agenda.add(SimTime::from_seconds(ignition.at_s), Due::Scheduled(number));
    }
    for agent in roster.all() {
        agenda.add(SimTime::ZERO, Due::Decision(super::agenda::Call { agent, revision: 0 }));
    }
    agenda.add(rules.duration, Due::End);
    agenda
}

fn ignitions(scenario: &Scenario, terrain: &Terrain, seed: u64) -> Ignitions {
    let entries: Vec<_> =
        scenario.ignition.iter().map(|entry| (SimTime::from_seconds(entry.at_s), entry.cells.clone())).collect();
    let mut permutation = terrain.bushes.clone();
    permutation.shuffle(&mut rng::stream(seed, "ignition"));
    Ignitions { pending: entries.len(), entries, permutation }
}

fn place_wumpus(
    id: AgentId,
    settings: &scenario::Wumpus,
    terrain: &Terrain,
    seed: u64,
    log: &mut Log,
) -> Result<(Agent, Wumpus), RunError> {
    let start = DVec2::from(settings.start_m);
    let frame = terrain.frame;
    let lattice = WalkLattice::new(frame, &terrain.occupied, settings.lattice_shape(&frame));
    let step_m = lattice.step_m();
    let point = lattice.nearest_free(start).ok_or(RunError::NoFreeStart { agent: id })?;
    let here = lattice.position(point);
    // On cell centres a start anywhere in a cell means that cell; only a move to another one is worth a word.
    if (here - start).abs().max_element() > 0.5 * step_m * (1.0 + 1e-9) {
        log.add(SimTime::ZERO, Fact::Agent(id, AgentFact::StartMoved { from: Pose::new(start.x, start.y, 0.0) }));
    }
    let reached = lattice.reachable_from(point);
    let (mut targets, walled_in): (Vec<Cell>, Vec<Cell>) =
        terrain.bushes.iter().partition(|&&cell| lattice.points_of_reach(cell, settings.reach_m).any(|p| reached[p]));
    if !walled_in.is_empty() {
        log.add(SimTime::ZERO, Fact::Agent(id, AgentFact::OutOfReach { cells: walled_in }));
    }
    if settings.goal == WumpusGoal::RandomIntact {
        let mut permutation = terrain.bushes.clone();
        permutation.shuffle(&mut rng::stream(seed, &id.to_string()));
        permutation.retain(|cell| targets.binary_search_by_key(&frame.index(*cell), |c| frame.index(*c)).is_ok());
        targets = permutation;
    }
    let planner = WalkPlanner::new(&lattice, settings.walk_method(), walk_costs(settings, terrain, &lattice));
    let wumpus = Wumpus {
        reach_m: settings.reach_m,
        policy: settings.goal,
        keeps_goal: settings.keep_goal,
        step_times: step_times(settings, step_m),
        seconds_per_expansion: settings.seconds_per_expansion,
        lattice,
        planner,
        point,
        walk: Vec::new(),
        is_stuck: false,
        failed: BTreeSet::new(),
        targets,
        next_target: 0,
        cost: AgentCost::nothing(id),
    };
    Ok((Agent::standing(id, Pose::new(here.x, here.y, 0.0)), wumpus))
}

fn step_times(settings: &scenario::Wumpus, step_m: f64) -> (f64, f64) {
    let (orthogonal, diagonal) = step_times_by_distance(step_m, settings.speed_mps);
    match settings.step_time {
        StepTime::Distance => (orthogonal, diagonal),
        StepTime::Uniform => (orthogonal, orthogonal),
    }
}

/// Where diagonal steps take no longer than others, they are faster than its speed.
fn wumpus_limits(settings: &scenario::Wumpus) -> SpeedLimits {
    let fastest = match settings.step_time {
        StepTime::Distance => settings.speed_mps,
        StepTime::Uniform => settings.speed_mps * std::f64::consts::SQRT_2,
    };
    SpeedLimits::new(fastest, 0.0)
}

fn walk_costs(settings: &scenario::Wumpus, terrain: &Terrain, lattice: &WalkLattice) -> WalkCosts {
    let step_m = lattice.step_m();
    let steps = match settings.step_cost {
        StepCost::Metres => (step_m, step_m * std::f64::consts::SQRT_2),
        StepCost::Moves => (1.0, 1.0),
    };
    let factors = Safety::new(terrain.frame, &terrain.occupied, &settings.safety)
        .map(|safety| (0..lattice.points()).map(|point| 1.0 + safety.surcharge_at(lattice.position(point))).collect());
    WalkCosts { steps, factors }
}

fn place_truck(
    id: AgentId,
    (settings, scenario): (&scenario::Unimog, &Scenario),
    (field, memory): (&Arc<ClearanceField>, &MemoryMeter),
    parked: &[(Dimensions, Pose)],
    seed: u64,
    log: &mut Log,
) -> Result<(Agent, Truck), RunError> {
    let checker = CollisionChecker::new(Arc::clone(field), settings.vehicle);
    let wanted = Pose::new(settings.start.x_m, settings.start.y_m, settings.start.heading_deg.to_radians());
    let is_free = |pose: &Pose| {
        let apart = |other: &(Dimensions, Pose)| keep_apart((&settings.vehicle, *pose), (&other.0, other.1));
        checker.pose_is_free(*pose, START_CLEARANCE_M) && parked.iter().all(apart)
    };
    let start = nearest_free_pose(field.frame(), wanted, is_free).ok_or(RunError::NoFreeStart { agent: id })?;
    if start != wanted {
        log.add(SimTime::ZERO, Fact::Agent(id, AgentFact::StartMoved { from: wanted }));
    }
    let planner = settings.build_planner(&checker, memory, seed, id.number.into());
    let report = planner.build_report();
    if report.samples > 0 {
        let BuildReport { samples, edges, components, .. } = report;
        log.add(SimTime::ZERO, Fact::Agent(id, AgentFact::RoadmapBuilt { samples, edges, components }));
    }
    let truck = Truck {
        body: settings.vehicle,
        speed: settings.speed_limits(),
        policy: settings.goal,
        retargets: settings.retarget == Retarget::OnEvent,
        reach_m: scenario.suppression.reach_m.unwrap_or(f64::INFINITY),
        dwell: SimTime::from_seconds(scenario.suppression.dwell_s),
        extinguishes_all: scenario.suppression.extinguishes == Extinguishes::AllInReach,
        charge: settings.planner.maker().charge(&settings.planner_settings()),
        planner,
        reachability: Reachability::new(&checker, memory, start),
        set_aside: Vec::new(),
        out_of_reach: Vec::new(),
        tracks: Tracks::default(),
        checker,
        blocked: Vec::new(),
        cost: AgentCost { sampling: report.sampling, connecting: report.connecting, ..AgentCost::nothing(id) },
    };
    Ok((Agent::standing(id, start), truck))
}

/// The free pose nearest to a wanted one: places on rings half a metre apart, headings from the wanted one outwards.
fn nearest_free_pose(frame: &FieldFrame, wanted: Pose, is_free: impl Fn(&Pose) -> bool) -> Option<Pose> {
    const RING_M: f64 = 0.5;
    const HEADINGS: i32 = 16;
    if is_free(&wanted) {
        return Some(wanted);
    }
    let rings = (2.0 * frame.width_m().max(frame.height_m()) / RING_M).ceil() as i32;
    (0..rings).find_map(|ring| {
        let radius = f64::from(ring) * RING_M;
        let spokes = (8 * ring).clamp(1, 64);
        (0..spokes).find_map(|spoke| {
            let bearing = std::f64::consts::TAU * f64::from(spoke) / f64::from(spokes);
            let place = wanted.position() + Pose::new(0.0, 0.0, bearing).direction() * radius;
            let turned = |k: i32| {
                let steps = if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 };
                wanted.heading + std::f64::consts::TAU * f64::from(steps) / f64::from(HEADINGS)
            };
            (0..HEADINGS).map(|k| Pose::new(place.x, place.y, turned(k))).find(&is_free)
        })
    })
}
