//! From a scenario and a seed to the world at time 0.

use std::sync::{Arc, LazyLock};

use bevy_ecs::prelude::*;
use rand::seq::SliceRandom;
use serde_json::Value;

use wildfire_base::geometry::Cell;
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_fire::FireField;
use wildfire_fire::models::Radius;
use wildfire_planning::collision::ClearanceField;
use wildfire_planning::memory::MemoryMeter;
use wildfire_scenario::{
    self as scenario, Extinguishes, GroundKinds, Ignition, IgnitionCells, LineHolds, Scenario, Terrain, Unimog,
    WaterEffect,
};
use wildfire_timeline::{
    AgentId, AgentStart, CrewRules, LineRules, Rules, Setting, SpreadSetting, WaterEnergy, WaterRules,
};

use super::agent::{AgentOrder, SpawnContext};
use super::fire::{Fires, Ignitions, Pieces, ScheduledIgnition};
use super::options::{RunError, RunOptions};
use super::policies::{NamedPolicy, Policies, PolicyContext, PolicySet, RuleContext, dispatch};
use super::queue::{Due, SimClock, SimQueue};
use super::recorder::{CpuLog, Recorder};
use super::run::RunCost;
use super::walk_lattices::WalkLattices;
use super::water::WaterNeeds;
use super::{line, truck, wumpus};

/// Sets up the world with everybody at the start and the first decisions due. Returns the setting for the timeline.
pub fn fill(
    world: &mut World,
    scenario: &Scenario,
    seed: u64,
    memory: &MemoryMeter,
    options: &RunOptions,
    cost: &mut RunCost,
) -> Result<Setting, RunError> {
    // First, as a program that may not be started ends the run before any work.
    let (planners, policies_by_name) = options.registry_of(scenario)?;
    let mut stopwatch = CpuStopwatch::start();
    // The terrain comes first: all else is placed on it, and a scenario without room fails here.
    let terrain = Terrain::from_scenario(scenario, seed)?;
    cost.terrain = stopwatch.elapsed_since_last();
    let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    cost.clearance_field = stopwatch.elapsed_since_last();

    let spread = spread_setting(scenario, seed, &terrain);
    world.insert_resource(Fires {
        field: FireField::new(terrain.frame, &terrain.bushes, scenario.fire.relight).with_ground(terrain.with_fuel()),
        model: match &spread {
            Some(spread) => spread.model(seed),
            None => Box::new(Radius::new(&terrain.frame, scenario.fire.rules())),
        },
        pieces: Pieces::new(&terrain.frame, &terrain.bushes, &terrain.pieces),
    });
    world.insert_resource(ignitions(scenario, &terrain, seed));
    let mut queue = SimQueue::default();
    for (number, ignition) in scenario.ignition.iter().enumerate() {
        queue.push(SimTime::from_seconds(ignition.at_s), Due::Scheduled(number));
    }
    queue.push(SimTime::from_seconds(scenario.duration_s), Due::End);
    world.insert_resource(queue);
    // It puts the crews' first order into the queue, so that has to be there.
    line::order(world, scenario, seed, spread.as_ref());
    let needs = WaterNeeds::new(water_rules(scenario).as_ref(), spread.as_ref());
    needs.into_iter().for_each(|needs| world.insert_resource(needs));
    world.insert_resource(Recorder::new(memory, options.records_searches));
    world.init_resource::<SimClock>();
    world.init_resource::<CpuLog>();
    world.init_resource::<AgentOrder>();
    // Before the agents, which look up the policy that they follow.
    world.insert_resource(policies(scenario, seed, &terrain, &policies_by_name)?);

    let water = water_rules(scenario).map(Arc::new);
    // Kinds of ground take memory per cell, so only if a truck asks for them.
    let slows = scenario.unimog.iter().any(|truck| !truck.speed_by_ground.is_empty());
    let ground = slows.then(|| GroundKinds::new(&terrain)).flatten();
    let arena =
        SpawnContext { scenario, seed, field: &field, ground: &ground, water: &water, memory, planners: &planners };
    let mut starts = Vec::new();
    let mut grounds = WalkLattices::new(&terrain, terrain.lightable(scenario.fire.lights_ground()));
    // Wumpuses before trucks: the order of agents decides ties and is part of a recording.
    for (number, settings) in scenario.wumpus.iter().enumerate() {
        starts.push(wumpus::spawn(world, &mut grounds, number as u16, settings)?);
    }
    // Only now, as each Wumpus may have added a planner.
    world.insert_resource(grounds.into_planners());
    for (number, settings) in scenario.unimog.iter().enumerate() {
        starts.push(truck::spawn(world, &arena, number as u16, settings)?);
    }
    Ok(setting(scenario, seed, &terrain, starts, spread))
}

/// Makes the policies of a run: one for all agents of a name, and for crews that follow it.
fn policies(scenario: &Scenario, seed: u64, terrain: &Terrain, registry: &Policies) -> Result<PolicySet, RunError> {
    let wumpuses = scenario.wumpus.iter().map(|wumpus| NamedPolicy::from(&wumpus.goal));
    let trucks = scenario.unimog.iter().map(|truck| NamedPolicy::from(&truck.goal));
    let ids = (0..).map(AgentId::wumpus).zip(wumpuses).chain((0..).map(AgentId::unimog).zip(trucks));
    let (agents, mut named): (Vec<AgentId>, Vec<NamedPolicy>) = ids.unzip();
    // Crews come after the agents.
    named.extend(scenario.custom_line_policy().map(NamedPolicy::Custom));
    let lightable = terrain.lightable(scenario.fire.lights_ground());
    let spread_m = scenario.fire.spread_radius_m;
    let rule_site = RuleContext {
        frame: &terrain.frame,
        lightable: &lightable,
        spread_m,
        seed,
        learned: scenario.learned.as_ref(),
    };
    let mut following = PolicySet::default();
    let of_team = dispatch::policy_of(scenario, terrain, water_rules(scenario));
    // The team's policy replaces what trucks name themselves.
    let is_dispatched =
        |agent: &usize| of_team.is_some() && agents.get(*agent).is_some_and(|agent| agent.role.suppresses());
    for (first, policy) in named.iter().enumerate() {
        let is_meant = |agent: &usize| named.get(*agent) == Some(policy) && !is_dispatched(agent);
        // One policy object for all that name it, made for the first of them.
        if !is_meant(&first) || (0..first).any(|agent| is_meant(&agent)) {
            continue;
        }
        let plays: Vec<AgentId> = (0..agents.len()).filter(is_meant).map(|agent| agents[agent]).collect();
        let made = match *policy {
            NamedPolicy::BuiltIn(rule) => rule.make(&rule_site),
            NamedPolicy::Custom(name) => {
                // A registered policy need not have a table of its own in the scenario.
                let custom = scenario.policy.get(name).map(|program| Value::Object(program.settings.clone()));
                let site = PolicyContext {
                    name,
                    scenario: &scenario.name,
                    seed,
                    duration: SimTime::from_seconds(scenario.duration_s),
                    frame: terrain.frame,
                    bushes: &terrain.bushes,
                    agents: &agents,
                    plays: &plays,
                    custom_settings: custom.as_ref().unwrap_or(&Value::Null),
                    // The policy's name is part of the stream: two policies never share random numbers.
                    stream: &|stream: &str| rng::stream(seed, &format!("policy/{name}/{stream}")),
                };
                let mut stopwatch = CpuStopwatch::start();
                let made = registry.make(&site).map_err(|reason| RunError::NoPolicy { name: name.clone(), reason })?;
                following.add_custom(&plays, name, made, stopwatch.elapsed_since_last());
                // The number after the last agent's stands for the crews.
                if is_meant(&agents.len()) {
                    following.lead_crews();
                }
                continue;
            }
        };
        following.add_for(&plays, made);
    }
    if let Some(of_team) = of_team {
        let trucks: Vec<AgentId> = agents.iter().copied().filter(|agent| agent.role.suppresses()).collect();
        following.add_for(&trucks, of_team);
    }
    Ok(following)
}

/// Returns the water rules of a run, if it has any.
pub fn water_rules(scenario: &Scenario) -> Option<WaterRules> {
    let water = scenario.water.as_ref()?;
    let places = water.places(scenario);
    let full_tank = water.full_tank();
    let fill_per_stop = water.fill_per_stop();
    let reach_m = water.reach_m;
    let energy = (water.effect == WaterEffect::Energy).then_some(WaterEnergy {
        portion_l: water.stop_l,
        pump_lps: water.pump_lps,
        jet_m: water.jet_m,
        applied: water.applied,
    });
    (!places.is_empty()).then_some(WaterRules { full_tank, fill_per_stop, reach_m, places, energy })
}

/// Returns what bounds the work of crews in a run, if there are any.
fn line_rules(scenario: &Scenario) -> Option<LineRules> {
    let crews = scenario.crew.iter().map(|crew| CrewRules {
        at_ns: SimTime::from_seconds(crew.at_s).as_nanos(),
        start_m: [crew.x_m, crew.y_m],
        walking_mps: crew.speed_mps,
        rate_mps: crew.max_mps(),
    });
    let can_be_lost = scenario.line.as_ref().is_some_and(|line| line.holds == LineHolds::Flame);
    (!scenario.crew.is_empty()).then(|| LineRules { crews: crews.collect(), can_be_lost })
}

/// Returns the shares of their speed that trucks keep by ground, if some of them are slowed.
fn ground_shares(scenario: &Scenario) -> Vec<(AgentId, Vec<f64>)> {
    let shares =
        |(number, truck): (usize, &Unimog)| Some((AgentId::unimog(number as u16), truck.ground_shares()?.to_vec()));
    scenario.unimog.iter().enumerate().filter_map(shares).collect()
}

/// Returns how fire goes over the ground of a run, where it does.
fn spread_setting(scenario: &Scenario, seed: u64, terrain: &Terrain) -> Option<SpreadSetting> {
    let landscape = terrain.landscape.clone()?;
    let weather = Arc::new(scenario::weather_on(scenario, seed, &landscape));
    if let Some(rules) = scenario.fire.rothermel_rules(seed) {
        return Some(SpreadSetting::Rothermel { landscape, weather, rules });
    }
    let rules = scenario.fire.alexandridis_rules()?;
    Some(SpreadSetting::Alexandridis { landscape, weather, rules })
}

fn setting(
    scenario: &Scenario,
    seed: u64,
    terrain: &Terrain,
    agents: Vec<AgentStart>,
    spread: Option<SpreadSetting>,
) -> Setting {
    Setting {
        scenario: scenario.name.clone(),
        seed,
        // Other versions may run the same scenario differently.
        program_version: env!("CARGO_PKG_VERSION").into(),
        frame: terrain.frame,
        bushes: terrain.bushes.clone(),
        blocked: terrain.blocked.clone(),
        spread,
        water: water_rules(scenario),
        ground_shares: ground_shares(scenario),
        line: line_rules(scenario),
        pieces: terrain.pieces.clone(),
        agents,
        rules: Rules {
            duration: SimTime::from_seconds(scenario.duration_s),
            suppression_reach_m: scenario.suppression.reach_m,
            suppression_dwell: SimTime::from_seconds(scenario.suppression.dwell_s),
            // `None` is for recordings from before there was this rule.
            extinguishes_all: Some(scenario.suppression.extinguishes == Extinguishes::AllInReach),
            fire: scenario.fire.recorded_rules(),
            reignition: scenario.fire.relight,
            score_wumpus_ignited: scenario.score.wumpus_ignited,
            score_wumpus_burned_out: scenario.score.wumpus_burned_out,
            score_truck_extinguished: scenario.score.truck_extinguished,
        },
    }
}

fn ignitions(scenario: &Scenario, terrain: &Terrain, seed: u64) -> Ignitions {
    // Shuffled only if an entry asks for random cells, and once, so that entries take from one order.
    let permutation = LazyLock::new(|| -> Arc<[Cell]> {
        // A field without bushes has nothing but ground that could be lit.
        let mut cells = terrain.lightable(scenario.fire.lights_ground() || terrain.bushes.is_empty());
        cells.shuffle(&mut rng::stream(seed, "ignition"));
        cells.into()
    });
    let entries: Vec<_> = scenario
        .ignition
        .iter()
        .enumerate()
        .map(|(number, entry): (usize, &Ignition)| match &entry.cells {
            IgnitionCells::Cells(cells) => ScheduledIgnition::Named(cells.clone()),
            // Of a perimeter only what can burn: roads and water inside need no note each.
            IgnitionCells::Area(area) => {
                let inside = area.by_cell(&terrain.frame);
                let mut cells: Vec<Cell> = terrain.with_fuel().chain(terrain.bushes.iter().copied()).collect();
                cells.retain(|&cell| inside[terrain.frame.index(cell)]);
                // A bush on ground with fuel is in both lists.
                cells.sort_unstable_by_key(|&cell| terrain.frame.index(cell));
                cells.dedup();
                ScheduledIgnition::Named(cells)
            }
            IgnitionCells::Points(_) => unreachable!("places are cells once they are loaded"),
            IgnitionCells::Random(count) => ScheduledIgnition::FirstOf { order: permutation.clone(), count: *count },
            IgnitionCells::Density(density) => {
                let order = density.order(&terrain.frame, seed, number).into();
                ScheduledIgnition::FirstOf { order, count: density.count }
            }
        })
        .collect();
    Ignitions {
        pending: entries.len(),
        entries,
        every: scenario.ignition.iter().map(|entry| entry.every_s.map(SimTime::from_seconds)).collect(),
        end: SimTime::from_seconds(scenario.duration_s),
    }
}
