//! A contest played from outside, one decision at a time: the basis of environments for learning.
//!
//! Agents that are *played* are asked where the policy that their scenario names would be asked; all others follow the
//! scenario. A step carries out the answers of one question and lasts until the next. Answers are carried out one agent
//! after the other, as those of a rule for one agent are: if an answer is no option any more once those before it have
//! acted, if there is something new to choose from, or a plan fails, the agents are asked again at the same instant. So
//! whoever answers as the built-in rule does plays the built-in rule's run, fact by fact.

use super::game::ExternalPolicy;
use super::policies::{Action, AgentView};
use super::{RunError, RunOptions, Simulation};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::FireField;
use wildfire_scenario::Scenario;
use wildfire_timeline::{AgentId, Event, Fact, FireFact, Setting, Timeline};

/// An agent that waits for an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct PendingAgent {
    pub agent: AgentId,
    /// The cells that it may choose, by cell index.
    pub options: Vec<Cell>,
}

impl PendingAgent {
    /// Returns whether it may go for nothing now that it could not go for before.
    fn adds_nothing_to(&self, before: &Self) -> bool {
        // Both come in one order.
        let mut existing = before.options.iter();
        self.options.iter().all(|cell| existing.any(|other| other == cell))
    }
}

/// The points of both sides under the scenario's rules.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Points {
    pub wumpuses: f64,
    pub trucks: f64,
}

impl Points {
    /// Returns the points of the agent's side minus those of the other.
    pub fn lead_of(&self, agent: AgentId) -> f64 {
        if agent.role.lights() { self.wumpuses - self.trucks } else { self.trucks - self.wumpuses }
    }
}

/// An unfinished contest that is played from outside.
pub struct Episode {
    simulation: Simulation,
    /// In the order in which they are to be answered; nobody at the end.
    pending: Vec<PendingAgent>,
    agents: Vec<AgentView>,
    points: Points,
    /// The number of facts whose points are counted.
    counted: usize,
}

impl Episode {
    /// Creates a contest and advances it to the first question.
    ///
    /// # Errors
    /// If it cannot take place, or comes to the limit of its memory.
    pub fn new(scenario: &Scenario, seed: u64, options: &RunOptions, played: &[AgentId]) -> Result<Self, RunError> {
        let mut simulation = Simulation::with(scenario, seed, options)?;
        simulation.follow(played, Box::new(ExternalPolicy));
        let mut episode =
            Self { simulation, pending: Vec::new(), agents: Vec::new(), points: Points::default(), counted: 0 };
        episode.go_on()?;
        Ok(episode)
    }

    /// Returns a copy of the contest at this instant; what is left to chance afterwards is drawn again if a future has a
    /// number, see [`Simulation::reseed`].
    ///
    /// # Errors
    /// If an agent that is not played follows a policy that cannot be copied.
    pub fn fork(&self, future: Option<u32>) -> Result<Self, RunError> {
        let mut simulation = self.simulation.fork()?;
        if let Some(future) = future {
            simulation.reseed(future);
        }
        let Self { pending, agents, points, counted, .. } = self;
        Ok(Self { simulation, pending: pending.clone(), agents: agents.clone(), points: *points, counted: *counted })
    }

    /// Lists the agents that wait for an answer, in the order in which they act; empty once the contest is over.
    pub fn pending(&self) -> &[PendingAgent] {
        &self.pending
    }

    /// Carries out answers, in the order of [`Self::pending`] as far as they go, and advances to the next question.
    /// Agents without an answer are asked again, except the first, which waits.
    ///
    /// # Errors
    /// If the contest comes to the limit of its memory.
    pub fn answer(&mut self, choices: &[(AgentId, Action)]) -> Result<(), RunError> {
        let now = self.simulation.now();
        let mut pending = choices.to_vec();
        // The agents that the caller saw when it answered; `pending` changes as the answers are carried out.
        let shown = self.pending.clone();
        let mut is_first = true;
        loop {
            let Some(next) = self.pending.first() else { return Ok(()) };
            let place = pending.iter().position(|&(agent, _)| agent == next.agent);
            let (agent, choice) = match place {
                Some(place) => pending.swap_remove(place),
                None if is_first => (next.agent, Action::Wait),
                None => return Ok(()),
            };
            // What another one took since is asked about again; what never was an option lets the agent wait.
            let is_gone = matches!(choice, Action::Go(cell) if !next.options.contains(&cell));
            if !is_first
                && (is_gone || !shown.iter().any(|before| before.agent == agent && next.adds_nothing_to(before)))
            {
                return Ok(());
            }
            is_first = false;
            self.simulation.answer(vec![(agent, choice)]);
            self.go_on()?;
            // Time has passed, so what is left of the answers is about an instant that is over.
            if self.simulation.now() > now {
                return Ok(());
            }
        }
    }

    fn go_on(&mut self) -> Result<(), RunError> {
        self.simulation.advance_to(SimTime::MAX);
        self.simulation.expect_within_memory()?;
        let question = self.simulation.observe(|seen, agents| {
            let pending = agents.iter().map(|&agent| PendingAgent { agent, options: seen.options(agent) });
            (pending.collect(), seen.agents.to_vec())
        });
        (self.pending, self.agents) = question.unwrap_or_else(|| (Vec::new(), self.simulation.agents()));
        self.count_points();
        Ok(())
    }

    fn count_points(&mut self) {
        let rules = &self.simulation.setting().rules;
        let facts = self.simulation.facts();
        for event in &facts[self.counted..] {
            match event.fact {
                Fact::Fire(FireFact::Ignited { .. }) => self.points.wumpuses += rules.score_wumpus_ignited,
                Fact::Fire(FireFact::BurnedOut { .. }) => self.points.wumpuses += rules.score_wumpus_burned_out,
                Fact::Fire(FireFact::Extinguished { .. }) => self.points.trucks += rules.score_truck_extinguished,
                Fact::Agent(..) | Fact::Ended { .. } => {}
            }
        }
        self.counted = facts.len();
    }

    /// Returns the points so far.
    pub fn points(&self) -> Points {
        self.points
    }

    /// Returns what policies see of the agents, by name.
    pub fn agents(&self) -> &[AgentView] {
        &self.agents
    }

    pub fn now(&self) -> SimTime {
        self.simulation.now()
    }

    pub fn has_ended(&self) -> bool {
        self.simulation.has_ended()
    }

    pub fn fires(&self) -> &FireField {
        self.simulation.fires()
    }

    pub fn setting(&self) -> &Setting {
        self.simulation.setting()
    }

    pub fn facts(&self) -> &[Event] {
        self.simulation.facts()
    }

    /// Returns the timeline so far.
    pub fn timeline(&self) -> Timeline {
        Timeline {
            setting: self.setting().clone(),
            events: self.facts().to_vec(),
            ground: self.simulation.ground().to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_scenario as scenario;
    use wildfire_timeline::Outcome;

    fn load(name: &str, changes: &[&str]) -> Scenario {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        scenario::load(name, &changes).expect("the preset loads")
    }

    fn agents(scenario: &Scenario) -> Vec<AgentId> {
        let wumpuses = (0..scenario.wumpus.len() as u16).map(AgentId::wumpus);
        wumpuses.chain((0..scenario.unimog.len() as u16).map(AgentId::unimog)).collect()
    }

    /// Chooses as the rules of the nearest do.
    fn nearest(episode: &Episode, agent_pending: &PendingAgent) -> Action {
        let agents = episode.agents();
        let place = agents.iter().find(|agent| agent.id == agent_pending.agent).expect("all agents are seen").place;
        let best = agent_pending.options.iter().copied().min_by(episode.fires().frame().by_distance(place));
        best.map_or(Action::Wait, Action::Go)
    }

    #[test]
    fn who_answers_as_the_rule_does_plays_the_rules_run() {
        let changes = ["duration_s=400", "wumpus.goal=nearest-intact", "unimog.retarget=on-event"];
        for (name, changes) in [("smoke", &changes[1..2]), ("fleet", &changes[..2]), ("fleet", &changes[..])] {
            let scenario = load(name, changes);
            let expected = crate::run(&scenario, 3).expect("it takes place").timeline;
            let played = agents(&scenario);
            let mut episode = Episode::new(&scenario, 3, &RunOptions::default(), &played).expect("it takes place");
            let mut together = 0;
            while !episode.pending().is_empty() {
                together = together.max(episode.pending().len());
                let choices: Vec<_> =
                    episode.pending().iter().map(|pending| (pending.agent, nearest(&episode, pending))).collect();
                episode.answer(&choices).expect("memory suffices");
            }
            assert!(episode.has_ended());
            assert!(name == "smoke" || together > 1, "all who are free answer together");
            let outcome = Outcome::new(&expected);
            assert_eq!(episode.points(), Points { wumpuses: outcome.wumpus_score, trucks: outcome.truck_score });
            assert_eq!(episode.timeline(), expected, "{name}");
        }
    }

    #[test]
    fn a_truck_that_waits_is_queried_again_in_time_and_is_not_stuck() {
        let scenario = load("smoke", &[]);
        let truck = AgentId::unimog(0);
        let mut episode = Episode::new(&scenario, 1, &RunOptions::default(), &[truck]).expect("it takes place");
        let (mut last, mut steps) = (SimTime::ZERO, 0);
        while !episode.pending().is_empty() {
            assert!(episode.now() >= last, "time goes on");
            last = episode.now();
            steps += 1;
            // A time that has passed is put off, so that the contest ends.
            let until = if steps % 2 == 0 { SimTime::ZERO } else { last + SimTime::from_seconds(10.0) };
            episode.answer(&[(truck, Action::WaitUntil(until))]).expect("memory suffices");
            let min = last + SimTime::from_nanos(1);
            assert!(episode.now() >= min || episode.has_ended());
            assert!(steps % 2 == 0 || episode.now() <= until || episode.pending().is_empty());
        }
        let outcome = Outcome::new(&episode.timeline());
        assert_eq!((outcome.extinguished, outcome.truck_stuck_s), (0, 0.0));
        assert!(steps > 10 && outcome.agents[1].standing_s > 100.0 && outcome.agents[1].longest_idle_s > 10.0);
        assert!(wildfire_audit::audit_timeline(&episode.timeline(), Default::default()).violation.is_none());
        let recorded = wildfire_timeline::file::encode(&episode.timeline()).expect("it fits");
        assert_eq!(wildfire_timeline::file::decode(&recorded).expect("it was just written"), episode.timeline());
    }
}
