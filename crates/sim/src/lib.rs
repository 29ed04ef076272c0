#![doc = include_str!("../README.md")]
//!
//! The world of one run: agents decide, plan, drive, light and extinguish.
//!
//! The clock jumps from instant to instant. [`Simulation::advance_to`] moves it to the next due event and makes
//! [passes](schedule::Pass) over the world until nothing more is due at that instant, in the order of [ranks](queue::Rank).
//! The division of time into slices does not affect the run. Agents are entities; events are appended to the timeline.
//!
//! Each concern is a plugin: [fire](fire::FirePlugin), [triggers of agents](wake::WakePlugin), the
//! [Wumpus](wumpus::WumpusPlugin), the [truck](truck::TruckPlugin), [traffic](deadlock::TrafficPlugin) and the
//! [end](end::EndPlugin). [Policies](policies) decide which agent goes where.

mod agent;
mod deadlock;
mod end;
mod episode;
mod fire;
mod fork;
pub mod game;
mod line;
mod options;
pub mod policies;
#[cfg(not(target_family = "wasm"))]
pub mod programs;
mod queue;
mod recorder;
mod run;
mod schedule;
mod setup;
mod shared;
mod traffic;
mod truck;
mod wake;
mod walk_lattices;
mod water;
mod wumpus;

use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::Schedules;

use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_fire::FireField;
use wildfire_planning::Planners;
use wildfire_planning::memory::MemoryMeter;
use wildfire_scenario::{MemoryEstimate, MemoryLimit, Scenario};
use wildfire_timeline::{AgentId, Event, GroundEvent, Setting, Timeline};

pub use episode::{Episode, PendingAgent, Points};
pub use options::{CustomRegistry, NotForked, RunError, RunOptions, StartPrograms};
pub use run::{AgentCost, FailureMessages, PolicyTally, Run, RunCost};

use agent::{Agent, AgentOrder};
use end::Ended;
use fire::Fires;
use policies::{Action, AgentView, CustomPolicyStats, Observation, PendingDecision, Policy, PolicyScope, PolicySet};
use queue::{SimClock, SimQueue};
use recorder::{CpuLog, Recorder};
use schedule::Pass;
use wake::WakeTriggers;

/// Runs a scenario with a seed to its end.
pub fn run(scenario: &Scenario, seed: u64) -> Result<Run, RunError> {
    run_with_options(scenario, seed, &RunOptions::default())
}

/// Runs a scenario like [`run`]; the timeline also holds what the searches examined.
pub fn run_recording_searches(scenario: &Scenario, seed: u64) -> Result<Run, RunError> {
    run_with_options(scenario, seed, &RunOptions { records_searches: true, ..RunOptions::default() })
}

/// Runs a scenario like [`run`] with custom planners, whose names the scenario may give to its trucks.
///
/// # Errors
/// As [`run`], and if a truck's planner is not known or cannot be built.
pub fn run_with(scenario: &Scenario, seed: u64, planners: &Planners) -> Result<Run, RunError> {
    run_with_options(scenario, seed, &RunOptions { planners: planners.clone(), ..RunOptions::default() })
}

/// Runs a scenario like [`run`] with other options.
pub fn run_with_options(scenario: &Scenario, seed: u64, options: &RunOptions) -> Result<Run, RunError> {
    let mut stopwatch = CpuStopwatch::start();
    let mut simulation = Simulation::with(scenario, seed, options)?;
    // Agents whose policy passes the answer to the caller wait: there is no caller to answer.
    while let Some(queried) = simulation.advance_to_question(SimTime::MAX).map(<[_]>::to_vec) {
        simulation.answer(queried.into_iter().map(|agent| (agent, Action::Wait)).collect());
    }
    simulation.expect_within_memory()?;
    let mut run = simulation.finish();
    run.cost.total = stopwatch.elapsed_since_last() + run.cost.elsewhere();
    Ok(run)
}

/// An unfinished run.
pub struct Simulation {
    world: World,
    schedule: Schedule,
    setting: Setting,
    cost: RunCost,
    /// Whether time 0 has happened. It does in every run, even if nobody is there to have something due.
    has_started: bool,
    memory: Memory,
}

/// The memory that a run may take, was estimated to take, and holds in what grows.
#[derive(Clone)]
struct Memory {
    limit: MemoryLimit,
    estimate: MemoryEstimate,
    meter: MemoryMeter,
}

impl Simulation {
    /// Creates the world at time 0, before the first event.
    pub fn new(scenario: &Scenario, seed: u64) -> Result<Self, RunError> {
        Self::with(scenario, seed, &RunOptions::default())
    }

    /// Creates the same world with the recording of searches switched on.
    pub fn recording_searches(scenario: &Scenario, seed: u64) -> Result<Self, RunError> {
        Self::with(scenario, seed, &RunOptions { records_searches: true, ..RunOptions::default() })
    }

    /// Creates the same world with custom planners.
    ///
    /// # Errors
    /// As [`Self::new`], and if a truck's planner is not known or cannot be built.
    pub fn with_planners(scenario: &Scenario, seed: u64, planners: &Planners) -> Result<Self, RunError> {
        Self::with(scenario, seed, &RunOptions { planners: planners.clone(), ..RunOptions::default() })
    }

    /// Creates the same world with other options.
    ///
    /// # Errors
    /// If it cannot be, or would take more memory than the limit; then nothing was allocated for it.
    pub fn with(scenario: &Scenario, seed: u64, options: &RunOptions) -> Result<Self, RunError> {
        let estimate = MemoryEstimate::new(scenario);
        let meter = estimate.meter(options.memory)?;
        let (mut world, schedule) = empty_world();
        let mut cost = RunCost::default();
        let setting = setup::fill(&mut world, scenario, seed, &meter, options, &mut cost)?;
        let memory = Memory { limit: options.memory, estimate, meter };
        let simulation = Self { world, schedule, setting, cost, has_started: false, memory };
        simulation.expect_within_memory()?;
        Ok(simulation)
    }

    /// Lets agents follow a custom policy from now on.
    pub fn follow(&mut self, agents: &[AgentId], policy: Box<dyn Policy>) {
        let asking = policy.asking();
        let follows = self.world.resource_mut::<PolicySet>().add(policy);
        // Cloned, as the loop changes the world that the order is in.
        for &entity in &self.world.resource::<AgentOrder>().0.clone() {
            let Some(agent) = self.world.get::<Agent>(entity).filter(|agent| agents.contains(&agent.id)) else {
                continue;
            };
            let was_in_team = self.world.get::<WakeTriggers>(entity).is_some_and(WakeTriggers::is_in_team);
            let is_in_team = asking != PolicyScope::Each && agent.id.role.suppresses();
            let mut followers = self.world.entity_mut(entity);
            followers.insert(follows);
            // Agents that decide alone keep the triggers of their kind; those that leave a team must lose the team's.
            if is_in_team || was_in_team {
                followers.insert(WakeTriggers::truck(asking, false));
            }
        }
    }

    /// Refuses a run that has reached its memory limit: its facts after that are unusable.
    pub fn expect_within_memory(&self) -> Result<(), RunError> {
        let Memory { limit, estimate, meter } = &self.memory;
        estimate.overrun(meter, *limit).map_or(Ok(()), |exceeded| Err(exceeded.into()))
    }

    /// Advances to `target`, inclusive, unless the run reaches its memory limit before, or a policy answers
    /// [later](Self::advance_to_question).
    pub fn advance_to(&mut self, target: SimTime) {
        while !self.world.resource::<Ended>().0
            && self.memory.meter.overrun().is_none()
            && self.world.resource::<PolicySet>().question.is_none()
        {
            let next =
                if self.has_started { self.world.resource::<SimQueue>().next_time() } else { Some(SimTime::ZERO) };
            let Some(next) = next.filter(|&next| next <= target) else { break };
            self.has_started = true;
            self.world.resource_mut::<SimClock>().0 = next;
            self.schedule.run(&mut self.world);
        }
    }

    /// Advances like [`advance_to`](Self::advance_to) and returns the agents that wait for an [answer](Self::answer),
    /// if a policy passes the decision to the caller. Until it is answered the world stands still.
    pub fn advance_to_question(&mut self, target: SimTime) -> Option<&[AgentId]> {
        self.advance_to(target);
        self.world.resource::<PolicySet>().question.as_ref().map(|question| &question.queried[..])
    }

    /// Shows the caller the world as a policy would see it that is asked the waiting question.
    pub fn observe<T>(&self, look: impl FnOnce(&Observation<'_>, &[AgentId]) -> T) -> Option<T> {
        let PendingDecision { queried, agents, options } = self.world.resource::<PolicySet>().question.as_ref()?;
        let options_of =
            |agent: AgentId| queried.iter().position(|&id| id == agent).map_or(Vec::new(), |i| options[i].clone());
        let now = self.world.resource::<SimClock>().0;
        let fires = &self.world.resource::<Fires>().field;
        Some(look(&Observation { now, fires, agents, options_of: &options_of }, queried))
    }

    /// Answers for agents that wait; agents without a choice are asked again. With an invalid choice an agent waits.
    pub fn answer(&mut self, choices: Vec<(AgentId, Action)>) {
        let mut following = self.world.resource_mut::<PolicySet>();
        following.question = None;
        following.answer = choices;
    }

    /// Returns the current instant of the world.
    pub fn now(&self) -> SimTime {
        self.world.resource::<SimClock>().0
    }

    /// Returns true if the run is over.
    pub fn has_ended(&self) -> bool {
        self.world.resource::<Ended>().0
    }

    /// Returns the state of every bush.
    pub fn fires(&self) -> &FireField {
        &self.world.resource::<Fires>().field
    }

    /// Returns what policies see of the agents, by name.
    pub fn agents(&self) -> Vec<AgentView> {
        let agents = self.world.resource::<AgentOrder>().0.iter().filter_map(|&entity| self.world.get::<Agent>(entity));
        agents.map(|agent| agent.view(self.now())).collect()
    }

    /// Returns the setting of the facts.
    pub fn setting(&self) -> &Setting {
        &self.setting
    }

    /// Returns the facts so far.
    pub fn facts(&self) -> &[Event] {
        &self.world.resource::<Recorder>().events
    }

    /// Returns the changes of the ground so far.
    pub fn ground(&self) -> &[GroundEvent] {
        &self.world.resource::<Recorder>().ground
    }

    /// Returns the facts so far and their cost.
    pub fn finish(mut self) -> Run {
        let agents = self.world.resource::<AgentOrder>().0.iter().filter_map(|&entity| self.world.get::<Agent>(entity));
        self.cost.agents = agents.map(|agent| agent.cost.clone()).collect();
        let mut following = self.world.resource_mut::<PolicySet>();
        self.cost.dispatch = following.team_cpu;
        let CustomPolicyStats { tally: asks, messages: of_policies, cpu, elsewhere } =
            std::mem::take(&mut following.custom_stats);
        (self.cost.policies, self.cost.policies_elsewhere) = (cpu, elsewhere);
        let mut recorder = self.world.resource_mut::<Recorder>();
        let events = std::mem::take(&mut recorder.events);
        let mut messages = std::mem::take(&mut recorder.messages);
        messages.append(of_policies);
        let ground = std::mem::take(&mut recorder.ground);
        let answer_cpu = std::mem::take(&mut recorder.answer_cpu);
        let cpu_samples = std::mem::take(&mut self.world.resource_mut::<CpuLog>().0);
        let timeline = Timeline { setting: self.setting, events, ground };
        Run { timeline, cost: self.cost, cpu_samples, answer_cpu, messages, asks }
    }
}

/// Returns a world in which there is nothing, and the schedule for it.
fn empty_world() -> (World, Schedule) {
    let mut world = std::mem::take(app().world_mut());
    let schedules = world.remove_resource::<Schedules>().and_then(|mut schedules| schedules.remove(Pass));
    (world, schedules.expect("a plugin made the schedule"))
}

/// Builds the schedule out of its plugins.
fn app() -> App {
    let mut app = App::empty();
    app.add_plugins((
        schedule::SchedulePlugin,
        fire::FirePlugin,
        wake::WakePlugin,
        wumpus::WumpusPlugin,
        truck::TruckPlugin,
        deadlock::TrafficPlugin,
        end::EndPlugin,
    ));
    app
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;
    use policies::{NamedPolicy, RuleContext};
    use schedule::SimSystems;
    use wildfire_base::geometry::Cell;
    use wildfire_scenario as scenario;
    use wildfire_timeline::{AgentFact, Fact, FireFact, Role};

    fn load(name: &str, duration_s: f64) -> Scenario {
        scenario::load(name, &[format!("duration_s={duration_s}")]).expect("the preset loads")
    }

    fn is_ambiguous(add: impl FnOnce(&mut App)) -> bool {
        let mut app = app();
        add(&mut app);
        app.world_mut().schedule_scope(Pass, |world, schedule| schedule.initialize(world).is_err())
    }

    #[test]
    fn a_system_whose_turn_is_not_specified_is_refused() {
        fn intruder(_queue: ResMut<SimQueue>) {}
        assert!(!is_ambiguous(|_| {}));
        assert!(is_ambiguous(|app| _ = app.add_systems(Pass, intruder)));
        assert!(is_ambiguous(|app| _ = app.add_systems(Pass, intruder.in_set(SimSystems::Truck))));
        assert!(!is_ambiguous(|app| _ = app.add_systems(Pass, intruder.after(SimSystems::End))));
    }

    /// Leaves every choice to somebody outside.
    struct Elsewhere;

    impl Policy for Elsewhere {
        fn choose(&mut self, _: &Observation<'_>, _: &[AgentId]) -> Vec<(AgentId, Action)> {
            Vec::new()
        }
    }

    #[test]
    fn a_policy_that_answers_later_gives_the_run_of_one_that_answers_at_once() {
        for (name, duration_s) in [("smoke", 300.0), ("fleet", 300.0)] {
            let scenario = load(name, duration_s);
            let at_once = run(&scenario, 5).expect("it takes place").timeline;
            let mut simulation = Simulation::new(&scenario, 5).expect("it takes place");
            let agents: Vec<AgentId> = at_once.setting.agents.iter().map(|agent| agent.id).collect();
            simulation.follow(&agents, Box::new(Elsewhere));
            let setting = &at_once.setting;
            let site = RuleContext {
                frame: &setting.frame,
                lightable: &setting.bushes,
                spread_m: 30.0,
                seed: 5,
                learned: None,
            };
            let make = |policy: NamedPolicy<'_>| match policy {
                NamedPolicy::BuiltIn(rule) => rule.make(&site),
                NamedPolicy::Custom(name) => panic!("{name} is not built in"),
            };
            let mut wumpus = make((&scenario.wumpus[0].goal).into());
            let mut truck = make((&scenario.unimog[0].goal).into());
            let mut questions = 0;
            while let Some(queried) = simulation.advance_to_question(SimTime::MAX).map(<[_]>::to_vec) {
                let facts = simulation.world.resource::<Recorder>().events.len();
                assert_eq!(simulation.advance_to_question(SimTime::MAX), Some(&queried[..]), "the world stands still");
                assert_eq!(simulation.world.resource::<Recorder>().events.len(), facts);
                let policy = if queried[0].role == Role::Wumpus { &mut wumpus } else { &mut truck };
                let choices = simulation.observe(|seen, queried| policy.choose(seen, queried));
                simulation.answer(choices.expect("a question waits"));
                questions += 1;
            }
            assert!(questions > 10, "{name}: {questions} questions");
            assert_eq!(simulation.finish().timeline, at_once, "{name}");
        }
    }

    /// Sends all that are asked to the first option of the first, and notes how many were asked.
    struct Together(Arc<Mutex<Vec<usize>>>);

    impl Policy for Together {
        fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
            self.0.lock().expect("nobody panicked").push(queried.len());
            let options = seen.options(queried[0]);
            queried
                .iter()
                .map(|&agent| (agent, options.first().map_or(Action::Wait, |&cell| Action::Go(cell))))
                .collect()
        }
    }

    #[test]
    fn a_policy_chooses_for_all_who_are_free_and_a_fire_still_goes_to_one_truck() {
        let mut simulation = Simulation::new(&load("fleet", 600.0), 2).expect("it takes place");
        let counts = Arc::new(Mutex::new(Vec::new()));
        let trucks = [0, 1, 2].map(AgentId::unimog);
        simulation.follow(&trucks, Box::new(Together(Arc::clone(&counts))));
        simulation.advance_to(SimTime::MAX);
        let timeline = simulation.finish().timeline;
        assert!(counts.lock().expect("nobody panicked").contains(&3), "all three wait when the first fire is lit");
        let mut goals = Vec::<(AgentId, Cell)>::new();
        let mut plans = 0;
        for event in &timeline.events {
            match event.fact {
                Fact::Agent(agent, AgentFact::Planned { goal, .. }) if agent.role.suppresses() => {
                    assert!(goals.iter().all(|&(_, other)| other != goal), "two trucks after {goal} at {}", event.time);
                    goals.push((agent, goal));
                    plans += 1;
                }
                Fact::Agent(agent, AgentFact::Dropped { .. }) => goals.retain(|&(by, _)| by != agent),
                Fact::Fire(FireFact::Extinguished { cell, .. } | FireFact::BurnedOut { cell }) => {
                    goals.retain(|&(_, goal)| goal != cell);
                }
                _ => {}
            }
        }
        assert!(plans > 3, "those who waited look again: {plans} plans");
    }

    #[test]
    fn a_run_goes_on_without_agents_that_are_no_longer_there() {
        let mut simulation = Simulation::new(&load("fleet", 600.0), 2).expect("it takes place");
        simulation.advance_to(SimTime::from_seconds(200.0));
        let gone = [simulation.world.resource::<AgentOrder>().0[0], simulation.world.resource::<AgentOrder>().0[2]];
        for entity in gone {
            assert!(simulation.world.despawn(entity));
        }
        simulation.advance_to(SimTime::MAX);
        assert!(simulation.world.resource::<Ended>().0);
    }
}
