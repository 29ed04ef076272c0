//! A truck at its start.

use std::sync::Arc;

use bevy_ecs::prelude::*;

use super::Truck;
use super::tracks::Tracks;
use crate::agent::{Activity, Agent, SpawnContext, enlist};
use crate::options::RunError;
use crate::policies::PolicySet;
use crate::recorder::Recorder;
use crate::run::AgentCost;
use crate::shared::Shared;
use crate::wake::WakeTriggers;
use wildfire_base::time::SimTime;
use wildfire_planning::collision::CollisionChecker;
use wildfire_planning::reachability::Reachability;
use wildfire_planning::{BuildReport, QueryMonitor};
use wildfire_scenario::{self as scenario, Extinguishes, Retarget, TruckPlannerContext, free_start};
use wildfire_timeline::{AgentFact, AgentId, AgentStart, Body, RestReason};

/// Places a truck on the free pose that is nearest to its start and builds its planner.
pub fn spawn(
    world: &mut World,
    arena: &SpawnContext<'_>,
    number: u16,
    settings: &scenario::Unimog,
) -> Result<AgentStart, RunError> {
    let id = AgentId::unimog(number);
    let suppression = &arena.scenario.suppression;
    // Trucks are placed in order of number, each beside those before it.
    let parked: Vec<_> = world
        .query::<(&Agent, &Truck)>()
        .iter(world)
        .map(|(agent, truck)| (truck.body, agent.trajectory.start()))
        .collect();
    let checker = CollisionChecker::new(Arc::clone(arena.field), settings.vehicle);
    let wanted = settings.start.pose();
    let start = free_start(&settings.vehicle, wanted, arena.field, &checker, &parked)
        .ok_or(RunError::NoFreeStart { agent: id })?;
    if start != wanted {
        world.resource_mut::<Recorder>().record_agent(SimTime::ZERO, id, AgentFact::StartMoved { from: wanted });
    }
    let ground = settings.ground_speed(arena.ground.as_ref());
    let context = TruckPlannerContext {
        truck: number,
        seed: arena.seed,
        checker: &checker,
        ground: ground.as_ref(),
        memory: arena.memory,
        planners: arena.planners,
        programs: &arena.scenario.planner,
    };
    let mut planner = settings.make_planner(&context).map_err(|reason| RunError::NoPlanner {
        agent: id,
        name: settings.planner.clone(),
        reason,
    })?;
    let report = planner.build_report();
    let BuildReport { samples, edges, components, .. } = report;
    let mut recorder = world.resource_mut::<Recorder>();
    // Planners without a roadmap record none.
    if samples > 0 {
        recorder.record_agent(SimTime::ZERO, id, AgentFact::RoadmapBuilt { samples, edges, components });
    }
    // Drawing a roadmap sweeps all its edges, so only where it is recorded.
    if recorder.records_searches {
        let mut monitor = QueryMonitor::new(true);
        planner.show_roadmap(&mut monitor);
        recorder.record_searches(SimTime::ZERO, id, monitor.finish().searches);
    }
    let truck = Truck {
        body: settings.vehicle,
        speed: settings.speed_limits(),
        ground,
        // Without a rule of distance every place is in reach.
        reach_m: suppression.reach_m.unwrap_or(f64::INFINITY),
        dwell: SimTime::from_seconds(suppression.dwell_s),
        extinguishes_all: suppression.extinguishes == Extinguishes::AllInReach,
        wets: arena.scenario.fire.wet(),
        charge: settings.planning_charge(&arena.scenario.planner),
        planner: Shared::new(planner),
        is_rescued: settings.is_rescued(),
        // From the start, as a truck never leaves the component of free space that it begins in.
        reachability: Shared::new(Reachability::new(&checker, arena.memory, start)),
        failed_goals: Vec::new(),
        out_of_reach: Vec::new(),
        tracks: Tracks::default(),
        checker,
        traffic: arena.scenario.traffic.clone().unwrap_or_default(),
        blocked: Vec::new(),
        deliberation: None,
        water: arena.water.clone(),
        extinguish_set: None,
        closed_posts: Vec::new(),
    };
    let following = world.resource::<PolicySet>();
    let follows = following.policy_of(id);
    // A truck's triggers depend on whether its policy decides for the whole team.
    let woken_by = WakeTriggers::truck(following.asking(follows), settings.retarget == Retarget::OnEvent);
    let mut agent = Agent::standing(id, Body::Truck(settings.vehicle), start);
    agent.busy_until = SimTime::from_seconds(settings.ready_s);
    // It cannot be called before, but its place counts for the others from the start.
    if settings.ready_s > 0.0 {
        agent.activity = Activity::Planning;
        let waits = AgentFact::Rested { reason: RestReason::NotReady };
        world.resource_mut::<Recorder>().record_agent(SimTime::ZERO, id, waits);
    }
    agent.stops_left = arena.water.as_ref().map(|water| water.full_tank);
    let BuildReport { sampling, connecting, starting, elsewhere, .. } = report;
    agent.cost = AgentCost { sampling, connecting, starting, elsewhere, ..agent.cost };
    Ok(enlist(world, agent, settings.speed_limits(), (truck, woken_by, follows)))
}
