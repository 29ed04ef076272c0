//! Forks: copies of an unfinished run that go on by themselves.

use bevy_ecs::prelude::*;

use super::Simulation;
use super::agent::{Agent, AgentOrder};
use super::end::Ended;
use super::fire::{Fires, Ignitions};
use super::line::CrewOrders;
use super::options::{NotForked, RunError, RunOptions};
use super::policies::{Action, ActionOverride, Decision, NamedPolicy, PolicyId, PolicySet};
use super::queue::{SimClock, SimQueue};
use super::recorder::{CpuLog, Recorder};
use super::truck::Truck;
use super::wake::WakeTriggers;
use super::walk_lattices::WalkPlanners;
use super::water::WaterNeeds;
use super::wumpus::Wumpus;
use wildfire_base::geometry::Cell;
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_fire::BushStateKind;
use wildfire_scenario::{Program, Retarget, Scenario, ValueDifference, value_differences};
use wildfire_timeline::{AgentId, Role};

impl Simulation {
    /// Returns a copy of the run at this instant. A copy that nobody interferes with ends as this run does, bit for bit.
    ///
    /// Planners are shared, as their answers do not depend on earlier ones.
    ///
    /// # Errors
    /// If a policy cannot be copied, because another program decides.
    pub fn fork(&self) -> Result<Self, NotForked> {
        let (world, schedule) = super::empty_world();
        let setting = self.setting.clone();
        let cost = self.cost.clone();
        let memory = self.memory.clone();
        let mut fork = Self { world, schedule, setting, cost, has_started: self.has_started, memory };
        copy_world(&self.world, &mut fork.world)?;
        Ok(fork)
    }

    /// Makes this run a copy of another run of the same setting, which is cheaper than a new fork.
    ///
    /// # Errors
    /// As [`Self::fork`]; then this run is as it was.
    pub fn become_fork_of(&mut self, other: &Self) -> Result<(), NotForked> {
        copy_world(&other.world, &mut self.world)?;
        self.has_started = other.has_started;
        Ok(())
    }

    /// Returns a fork in which trucks plan, and agents decide, as another scenario says from now on. Agents that are under
    /// way stay so; the others decide at once.
    ///
    /// # Errors
    /// As [`Self::fork`]; if the scenarios differ in anything that cannot change in the middle of a run; or if a planner
    /// or a policy cannot be made.
    pub fn fork_into(&self, before: &Scenario, after: &Scenario, options: &RunOptions) -> Result<Self, RunError> {
        let values = [&before.with_conduct_of(after), after]
            .map(|scenario| serde_json::to_value(scenario).expect("scenarios hold names, numbers and lists only"));
        // What conduct does not cover is fixed from the start of a run, and named in the error.
        if let Some(ValueDifference { key, .. }) = value_differences(&values[0], &values[1]).into_iter().next() {
            return Err(RunError::FixedInRun { key });
        }
        // A run of the other scenario from its start, of which only planners and policies are used.
        let mut other = Self::with(after, self.setting.seed, options)?;
        let mut fork = self.fork()?;
        let policies = other.world.remove_resource::<PolicySet>().expect("every run has policies");
        let follows = fork.world.resource_mut::<PolicySet>().adopt(policies);
        // Memory counts against the new options' limit.
        fork.world.resource_mut::<Recorder>().count_on(&other.memory.meter);
        let is_team_new = before.dispatch != after.dispatch || before.sight != after.sight;
        let plans_otherwise = before.planner != after.planner || before.traffic != after.traffic;
        // Scenarios that differ in conduct alone have the same agents in the same order.
        let agents = [&fork, &other].map(|run| run.world.resource::<AgentOrder>().0.clone());
        for (&entity, &model) in agents[0].iter().zip(&agents[1]) {
            let model = other.world.entity(model);
            let mut target = fork.world.entity_mut(entity);
            let id = target.get::<Agent>().expect("it is an agent").id;
            let decides_otherwise =
                conduct_of(before, id) != conduct_of(after, id) || id.role.suppresses() && is_team_new;
            let number = usize::from(id.number);
            if let (Some(mut target), Some(model)) = (target.get_mut::<Truck>(), model.get::<Truck>())
                && (plans_otherwise || before.unimog.get(number) != after.unimog.get(number))
            {
                target.plan_like(model);
            }
            if decides_otherwise {
                let follows = follows(*model.get::<PolicyId>().expect("every agent follows a policy"));
                // Which changes wake an agent depends on its policy, so both are exchanged.
                target.insert((follows, model.get::<WakeTriggers>().expect("every agent is woken").clone()));
                fork.let_decide(entity);
            }
        }
        // New planners count on the meter that came with them.
        fork.memory = other.memory;
        Ok(fork)
    }

    /// Lets an agent that stands without a goal decide now.
    fn let_decide(&mut self, entity: Entity) {
        let now = self.now();
        self.world.resource_scope(|world, mut queue: Mut<'_, SimQueue>| {
            let mut agent = world.get_mut::<Agent>(entity).expect("it is an agent");
            if agent.is_free() {
                agent.reconsider(entity, now, &mut queue);
            }
        });
    }

    /// Draws what is left to chance from now on again: the bushes that a random arsonist goes for next, and whether fire
    /// spreads where the model of the fire leaves it to chance. Runs of one seed and one number share their luck.
    pub fn reseed(&mut self, future: u32) {
        let seed = rng::key(self.setting.seed, &format!("future/{future}"));
        self.world.resource_mut::<PolicySet>().reseed(seed);
        self.world.resource_mut::<Fires>().model.reseed(seed);
    }

    /// Gives an agent this choice when it is asked next, in place of its policy's. At that instant its policy does not
    /// change its mind; later it may. What is no option of the agent then has no effect.
    pub fn force(&mut self, agent: AgentId, choice: Action) {
        self.world.resource_mut::<PolicySet>().forced = Some(ActionOverride::new(agent, choice));
    }

    /// Returns when the agent with a [forced](Self::force) choice was given it.
    pub fn forced_at(&self) -> Option<SimTime> {
        self.world.resource::<PolicySet>().forced?.applied_at
    }

    /// Returns the number of bushes that have burned out or burn.
    pub fn lost(&self) -> usize {
        let is_lost =
            |cell: &&Cell| matches!(self.fires().kind(**cell), Some(BushStateKind::Burning | BushStateKind::BurnedOut));
        self.setting.bushes.iter().filter(is_lost).count()
    }

    /// Records the [decisions](Self::decisions) from now on.
    pub fn record_decisions(&mut self) {
        self.world.resource_mut::<PolicySet>().decisions = Some(Vec::new());
    }

    /// Returns the recorded decisions: of agents that had several options and set out for a new goal, or stayed. An agent
    /// that is asked several times at one instant has one, its first.
    pub fn decisions(&self) -> &[Decision] {
        self.world.resource::<PolicySet>().decisions.as_deref().unwrap_or_default()
    }
}

/// Returns how an agent decides: its policy, the table of one that is not built in, and when a truck reconsiders.
fn conduct_of(scenario: &Scenario, agent: AgentId) -> (NamedPolicy<'_>, Option<&Program>, Option<Retarget>) {
    let number = usize::from(agent.number);
    let (policy, retarget) = match agent.role {
        Role::Wumpus => (NamedPolicy::from(&scenario.wumpus[number].goal), None),
        Role::Unimog => (NamedPolicy::from(&scenario.unimog[number].goal), Some(scenario.unimog[number].retarget)),
    };
    let table = match policy {
        NamedPolicy::Custom(name) => scenario.policy.get(name),
        NamedPolicy::BuiltIn(_) => None,
    };
    (policy, table, retarget)
}

/// Copies what a run consists of. A world that holds a run of as many agents is overwritten.
fn copy_world(from: &World, to: &mut World) -> Result<(), NotForked> {
    // First, as this alone can fail and must leave the other world as it was.
    let following = from.resource::<PolicySet>().fork().map_err(NotForked)?;
    let agents = &from.resource::<AgentOrder>().0;
    let existing = to.get_resource::<AgentOrder>().map_or(Vec::new(), |roster| roster.0.clone());
    let copies: Vec<Entity> =
        if existing.len() == agents.len() { existing } else { agents.iter().map(|_| to.spawn_empty().id()).collect() };
    for (&agent, &copy) in agents.iter().zip(&copies) {
        let from = from.entity(agent);
        let mut to = to.entity_mut(copy);
        copy_component::<Agent>(&from, &mut to);
        copy_component::<PolicyId>(&from, &mut to);
        copy_component::<WakeTriggers>(&from, &mut to);
        copy_component::<Wumpus>(&from, &mut to);
        copy_component::<Truck>(&from, &mut to);
    }
    // Events name their agents, which are other entities in the copy.
    to.insert_resource(
        from.resource::<SimQueue>()
            .for_agents(|agent| agents.iter().position(|&other| other == agent).map_or(agent, |number| copies[number])),
    );
    to.insert_resource(AgentOrder(copies));
    to.insert_resource(following);
    copy_resource::<SimClock>(from, to);
    copy_resource::<Ended>(from, to);
    copy_resource::<Fires>(from, to);
    // Optional, and alike in all runs of a setting: there is none to remove.
    from.get_resource::<CrewOrders>().into_iter().for_each(|orders| to.insert_resource(orders.clone()));
    from.get_resource::<WaterNeeds>().into_iter().for_each(|needs| to.insert_resource(needs.clone()));
    copy_resource::<Ignitions>(from, to);
    copy_resource::<WalkPlanners>(from, to);
    copy_resource::<Recorder>(from, to);
    copy_resource::<CpuLog>(from, to);
    Ok(())
}

fn copy_component<T: Component + Clone>(from: &EntityRef<'_>, to: &mut EntityWorldMut<'_>) {
    if let Some(component) = from.get::<T>() {
        to.insert(component.clone());
    }
}

fn copy_resource<T: Resource + Clone>(from: &World, to: &mut World) {
    to.insert_resource(from.resource::<T>().clone());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policies::Policies;
    use crate::run;
    use wildfire_scenario as scenario;
    use wildfire_timeline::{Fact, FireFact, Timeline};

    fn load(name: &str, duration_s: f64) -> Scenario {
        scenario::load(name, &[format!("duration_s={duration_s}")]).expect("the preset loads")
    }

    fn ended(mut simulation: Simulation) -> Timeline {
        simulation.advance_to(SimTime::MAX);
        simulation.finish().timeline
    }

    #[test]
    fn a_fork_of_any_preset_ends_as_its_parent() {
        for (name, duration_s, instants) in [("smoke", 300.0, 20), ("fleet", 200.0, 8), ("river", 200.0, 4)] {
            let scenario = load(name, duration_s);
            let expected = run(&scenario, 3).expect("it takes place").timeline;
            let mut parent = Simulation::new(&scenario, 3).expect("it takes place");
            let mut other = Simulation::new(&scenario, 3).expect("it takes place");
            let end = expected.end_time().as_seconds();
            let mut forks = vec![parent.fork().expect("its policies are built in")];
            for instant in 0..instants {
                parent.advance_to(SimTime::from_seconds(end * f64::from(instant) / f64::from(instants)));
                forks.push(parent.fork().expect("its policies are built in"));
                // It was a fork already, and its Wumpuses had gone for other bushes.
                other.reseed(instant as u32);
                other.advance_to(SimTime::from_seconds(0.5 * end));
                other.become_fork_of(&parent).expect("its policies are built in");
                assert_eq!(other.now(), parent.now());
                assert_eq!(other.facts(), parent.facts());
            }
            // Forks of forks, the last first: what planners have learned since does not matter.
            for fork in forks.iter().rev() {
                assert_eq!(ended(fork.fork().expect("its policies are built in")), expected, "{name}");
            }
            assert_eq!(ended(other), expected, "{name}");
            assert_eq!(ended(parent), expected, "{name}");
            for fork in forks {
                assert_eq!(ended(fork), expected, "{name}");
            }
        }
    }

    fn ignited(timeline: &Timeline) -> Vec<Cell> {
        let ignited = timeline.events.iter().filter_map(|event| match event.fact {
            Fact::Fire(FireFact::Ignited { cell, .. }) => Some(cell),
            _ => None,
        });
        ignited.collect()
    }

    #[test]
    fn futures_share_what_has_happened_and_runs_of_one_number_their_luck() {
        let scenario = load("fleet", 400.0);
        let mut parent = Simulation::new(&scenario, 3).expect("it takes place");
        let middle = SimTime::from_seconds(150.0);
        parent.advance_to(middle);
        let future = |number| {
            let mut fork = parent.fork().expect("its policies are built in");
            fork.reseed(number);
            ended(fork)
        };
        let unchanged = ended(parent.fork().expect("its policies are built in"));
        assert_eq!(future(1), future(1));
        assert!(ignited(&future(1)) != ignited(&future(2)) && ignited(&future(1)) != ignited(&unchanged));
        let until_middle = |timeline: &Timeline| timeline.events.partition_point(|event| event.time <= middle);
        assert_eq!(future(1).events[..until_middle(&unchanged)], unchanged.events[..until_middle(&unchanged)]);
    }

    #[test]
    fn a_forced_choice_is_carried_out_once_and_the_policy_decides_again() {
        for (name, changes) in [("smoke", vec![]), ("fleet", vec!["dispatch.policy=auction".to_owned()])] {
            let scenario = scenario::load(name, &changes).expect("the preset loads");
            let mut noting = Simulation::new(&scenario, 5).expect("it takes place");
            noting.record_decisions();
            noting.advance_to(SimTime::from_seconds(600.0));
            let goes = noting.decisions().iter().rev().filter_map(|decision| match decision.choice {
                Action::Go(cell) if decision.agent.id.role.suppresses() => Some((decision, cell)),
                _ => None,
            });
            let (mut tried, mut carried_out) = (0, 0);
            for (decision, cell) in goes.take(8) {
                let other = *decision.options.iter().find(|&&option| option != cell).expect("there were two");
                let mut fork = Simulation::new(&scenario, 5).expect("it takes place");
                fork.advance_to(decision.time - SimTime::from_nanos(1));
                fork.force(decision.agent.id, Action::Go(other));
                fork.advance_to(decision.time);
                assert_eq!(fork.forced_at(), Some(decision.time), "{name}");
                let agents = fork.agents();
                let agent = agents.iter().find(|agent| agent.id == decision.agent.id).expect("all are seen");
                tried += 1;
                // Others may be in the way there.
                carried_out += u32::from(agent.goal == Some(other));
                let timeline = ended(fork);
                assert!(wildfire_audit::audit_timeline(&timeline, Default::default()).violation.is_none());
            }
            assert!(tried == 8 && carried_out >= 6, "{name}: {carried_out}");
        }
    }

    #[test]
    fn a_policy_that_cannot_be_copied_is_named() {
        struct Foreign;
        impl crate::policies::Policy for Foreign {
            fn choose(&mut self, _: &crate::policies::Observation<'_>, _: &[AgentId]) -> Vec<(AgentId, Action)> {
                Vec::new()
            }
        }
        let make = |_: &crate::policies::PolicyContext<'_>| {
            let policy: Box<dyn crate::policies::Policy> = Box::new(Foreign);
            Ok(policy)
        };
        let policies = Policies::default().with("foreign", make).expect("it is free");
        let options = RunOptions { policies, ..RunOptions::default() };
        let changes = ["policy.foreign.command=[]".to_owned(), "unimog.goal=foreign".to_owned()];
        let scenario = scenario::load("smoke", &changes).expect("it loads");
        let simulation = Simulation::with(&scenario, 1, &options).expect("it takes place");
        let refused = simulation.fork().map(drop).expect_err("nobody can copy it").to_string();
        assert!(refused.starts_with("the policy foreign runs outside"), "{refused}");
    }
}
