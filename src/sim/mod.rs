//! The world of one run: agents decide, plan, drive, light and extinguish.
//!
//! The clock jumps from instant to instant. [`Simulation::advance_to`] takes what is due next, runs one schedule whose
//! systems follow the [order of one instant](agenda::Rank), and repeats until nothing is due before its target; into
//! which slices the time is cut changes nothing. Agents are entities; what happened is appended to the timeline.

mod agenda;
mod agent;
mod fires;
mod setup;
mod situation;
mod stage;
mod tracks;
mod traffic;
mod truck;
mod wumpus;

use std::time::Duration;

use bevy::ecs::schedule::{LogLevel, Schedule, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::planning::memory::MemoryMeter;
use crate::scenario::{MemoryEstimate, MemoryExceeded, MemoryLimit, Scenario, TerrainError};
use crate::time::SimTime;
use crate::time::cpu::CpuStopwatch;
use crate::timeline::{AgentId, CpuSample, EndReason, Fact, Setting, Timeline};

use agenda::{Agenda, Due, Rank, SimClock};
use agent::{Ledger, Log, Roster};
use fires::Ignitions;
use situation::Situation;
use stage::Stage;
use traffic::{Traffic, standoff};
use truck::Truck;
use wumpus::Wumpus;

/// CPU time of one agent's planning over a run. What does not concern its kind is zero.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AgentCost {
    pub agent: AgentId,
    /// The truck's roadmap: drawing samples, and connecting them.
    pub sampling: Duration,
    pub connecting: Duration,
    pub roadmap_search: Duration,
    /// The truck's local search, or the Wumpus's search.
    pub local_search: Duration,
    /// Reachability floods and the lattice searches that follow them.
    pub reachability: Duration,
}

impl AgentCost {
    fn nothing(agent: AgentId) -> Self {
        let zero = Duration::ZERO;
        Self { agent, sampling: zero, connecting: zero, roadmap_search: zero, local_search: zero, reachability: zero }
    }

    pub fn total(&self) -> Duration {
        self.sampling + self.connecting + self.roadmap_search + self.local_search + self.reachability
    }
}

/// CPU time of a run; never part of its outcome.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RunCost {
    pub terrain: Duration,
    pub clearance_field: Duration,
    /// In the order of the timeline's agents.
    pub agents: Vec<AgentCost>,
    pub total: Duration,
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Run {
    /// What happened.
    pub timeline: Timeline,
    /// CPU time, by part.
    pub cost: RunCost,
    /// The same by decision, in order of time: first one entry an agent for building its planner, then one for every
    /// decision that took some.
    pub cpu_samples: Vec<CpuSample>,
}

/// The options of a run. They change nothing that happens in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunOptions {
    /// True if the timeline also holds what the searches looked at, as [`AgentFact::Searched`]. CPU times include recording
    /// it.
    pub records_searches: bool,
    /// The limit of memory. A run that would take more does not take place, or ends early, as [`RunError::Memory`].
    pub memory: MemoryLimit,
}

/// Why a run could not take place.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RunError {
    #[error(transparent)]
    Memory(#[from] MemoryExceeded),
    #[error(transparent)]
    Terrain(#[from] TerrainError),
    #[error("{agent} cannot start: no free place was found for it on this field")]
    NoFreeStart { agent: AgentId },
}

/// Runs a scenario with a seed to its end.
pub fn run(scenario: &Scenario, seed: u64) -> Result<Run, RunError> {
    run_with(scenario, seed, RunOptions::default())
}

/// Does the same as [`run`], and the timeline also holds what the searches looked at.
pub fn run_recording_searches(scenario: &Scenario, seed: u64) -> Result<Run, RunError> {
    run_with(scenario, seed, RunOptions { records_searches: true, ..RunOptions::default() })
}

/// Does the same as [`run`], with other options.
pub fn run_with(scenario: &Scenario, seed: u64, options: RunOptions) -> Result<Run, RunError> {
    let mut clock = CpuStopwatch::start();
    let mut simulation = Simulation::with(scenario, seed, options)?;
    simulation.advance_to(SimTime::MAX);
    simulation.expect_within_memory()?;
    let mut run = simulation.finish();
    run.cost.total = clock.lap();
    Ok(run)
}

/// All systems of the simulation, in the order of one instant.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Instant;

/// When the run ended.
#[derive(Resource, Debug, Default)]
struct Ended(bool);

/// A run in the making.
pub struct Simulation {
    world: World,
    schedule: Schedule,
    setting: Setting,
    cost: RunCost,
    /// Whether time 0 has happened. It does in every run, even if nobody is there to have something due.
    has_begun: bool,
    memory: Memory,
}

/// The memory that a run may take, was estimated to take, and holds in what grows.
struct Memory {
    limit: MemoryLimit,
    estimate: MemoryEstimate,
    meter: MemoryMeter,
}

impl Simulation {
    /// The world at time 0, before anything happened.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Self, RunError> {
        Self::with(scenario, seed, RunOptions::default())
    }

    /// The same world, which also tells what searches looked at.
    pub fn recording_searches(scenario: &Scenario, seed: u64) -> Result<Self, RunError> {
        Self::with(scenario, seed, RunOptions { records_searches: true, ..RunOptions::default() })
    }

    /// Makes the same world with other options.
    ///
    /// # Errors
    /// If it cannot be, or would take more memory than the limit; then nothing was allocated for it.
    pub fn with(scenario: &Scenario, seed: u64, options: RunOptions) -> Result<Self, RunError> {
        let estimate = MemoryEstimate::new(scenario);
        let meter = estimate.meter(options.memory)?;
        let (world, setting, cost) = setup::build(scenario, seed, &meter, options.records_searches)?;
        let memory = Memory { limit: options.memory, estimate, meter };
        let simulation = Self { world, schedule: schedule(), setting, cost, has_begun: false, memory };
        simulation.expect_within_memory()?;
        Ok(simulation)
    }

    /// Refuses a run that came to the limit of its memory: its facts after that are not to be used.
    pub fn expect_within_memory(&self) -> Result<(), RunError> {
        let Memory { limit, estimate, meter } = &self.memory;
        estimate.overrun(meter, *limit).map_or(Ok(()), |exceeded| Err(exceeded.into()))
    }

    /// Lets everything happen that is due up to `target`, which is included, unless the run comes to the limit of its
    /// memory before.
    pub fn advance_to(&mut self, target: SimTime) {
        while !self.world.resource::<Ended>().0 && self.memory.meter.overrun().is_none() {
            let next = if self.has_begun { self.world.resource::<Agenda>().next_time() } else { Some(SimTime::ZERO) };
            let Some(next) = next.filter(|&next| next <= target) else { break };
            self.has_begun = true;
            self.world.resource_mut::<SimClock>().0 = next;
            self.schedule.run(&mut self.world);
        }
    }

    /// The facts so far and the cost of getting there.
    pub fn finish(mut self) -> Run {
        let mut agents = Vec::new();
        let roster: Vec<Entity> = self.world.resource::<Roster>().all().collect();
        for entity in roster {
            let cost = self.world.get::<Wumpus>(entity).map(|wumpus| wumpus.cost.clone());
            let cost = cost.or_else(|| self.world.get::<Truck>(entity).map(|truck| truck.cost.clone()));
            agents.extend(cost);
        }
        self.cost.agents = agents;
        let events = std::mem::take(&mut self.world.resource_mut::<Log>().events);
        let cpu_samples = std::mem::take(&mut self.world.resource_mut::<Ledger>().0);
        Run { timeline: Timeline { setting: self.setting, events }, cost: self.cost, cpu_samples }
    }
}

/// All systems, in the order of one instant.
fn schedule() -> Schedule {
    let mut schedule = Schedule::new(Instant);
    schedule.set_executor(SingleThreadedExecutor::new());
    schedule.set_build_settings(ScheduleBuildSettings { ambiguity_detection: LogLevel::Error, ..Default::default() });
    schedule.add_systems(
        (
            fires::extinguish,
            fires::burn_out,
            fires::spread,
            fires::ignite,
            truck::arrive,
            finish_planning,
            decide,
            standoff::break_deadlocks,
            end,
        )
            .chain(),
    );
    schedule
}

/// Charged planning time is over: the agent moves, or decides again if its plan had failed.
fn finish_planning(mut stage: Stage) {
    while let Some(due) = stage.take(Rank::PlanningDone) {
        let Due::PlanningDone(call) = due else { unreachable!("ranks and events go together") };
        let now = stage.now();
        let (mut agent, ..) = stage.agents.get_mut(call.agent).expect("agents live for the whole run");
        if agent.revision != call.revision {
            continue;
        }
        if agent.goal.is_some() {
            agent.activity = agent::Activity::Moving;
        } else {
            agent.activity = agent::Activity::Idle;
            agent.reconsider(call.agent, now, &mut stage.agenda);
        }
    }
}

/// Agents whose turn it is choose what to do.
fn decide(mut stage: Stage) {
    while let Some(due) = stage.take(Rank::Decision) {
        let Due::Decision(call) = due else { unreachable!("ranks and events go together") };
        let had = stage.goal_of(call.agent);
        let is_void = stage.agents.get(call.agent).expect("agents live for the whole run").0.revision != call.revision;
        if is_void {
            continue;
        }
        let (claimed, centres) = stage.other_trucks(call.agent);
        let reservations = stage.reservations();
        let traffic = Traffic::new(&reservations, call.agent);
        let now = stage.now();
        let (mut agent, wumpus, truck) = stage.agents.get_mut(call.agent).expect("agents live for the whole run");
        if let Some(mut wumpus) = wumpus {
            let spent = wumpus.cost.total();
            let seen = (&stage.frame.0, &stage.fires.field, centres.as_slice());
            wumpus::decide((call.agent, &mut agent, &mut wumpus), now, seen, &mut stage.agenda, &mut stage.log);
            stage.ledger.add(now, agent.id, wumpus.cost.total() - spent);
        } else if let Some(mut truck) = truck {
            let situation =
                Situation { now, frame: &stage.frame.0, fires: &stage.fires.field, claimed: &claimed, traffic };
            let before = (agent.revision, agent.rests, truck.is_blocked());
            let spent = truck.cost.total();
            truck::decide((call.agent, &mut agent, &mut truck), &situation, &mut stage.agenda, &mut stage.log);
            stage.ledger.add(now, agent.id, truck.cost.total() - spent);
            let drops_goal = had.is_some() && agent.goal != had;
            let is_changed = before != (agent.revision, agent.rests, truck.is_blocked());
            if drops_goal {
                stage.call_resting(call.agent);
            } else if is_changed {
                stage.call_blocked(call.agent);
            }
        }
    }
}

/// The run is over at its time, or when nothing burns, nothing will be lit, and nobody has anything left to do.
fn end(mut stage: Stage, ignitions: Res<Ignitions>, mut ended: ResMut<Ended>) {
    let now = stage.now();
    let reason = if stage.take(Rank::End).is_some() {
        EndReason::Duration
    } else {
        let instant_is_over = stage.agenda.next_time() > Some(now);
        let arsonists_rest = || {
            stage.roster.wumpuses.iter().all(|&entity| {
                let (agent, wumpus, _) = stage.agents.get(entity).expect("the roster lists living agents");
                let wumpus = wumpus.expect("the roster knows its wumpuses");
                agent.rests.is_some() && !wumpus.has_something_to_light(&stage.fires.field)
            })
        };
        let is_over =
            instant_is_over && stage.fires.field.burning().len() == 0 && ignitions.pending == 0 && arsonists_rest();
        if !is_over {
            return;
        }
        EndReason::NothingLeft
    };
    stage.log.add(now, Fact::Ended { reason });
    ended.0 = true;
}
