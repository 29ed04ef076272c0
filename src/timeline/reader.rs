//! Reads a run once from its facts to its outcome.

use super::ledger::{AgentLedger, BushLedger};
use super::{Activity, Cause, Event, Fact, FireFact, Outcome, Replay, Timeline};
use crate::time::SimTime;

/// Goes through a timeline once, instant by instant, and keeps the books.
#[derive(Debug)]
pub struct Reader<'a> {
    timeline: &'a Timeline,
    replay: Replay<'a>,
    bushes: BushLedger,
    agents: Vec<AgentLedger<'a>>,
    outcome: Outcome,
    burned_out: u32,
    extinctions: u32,
}

impl<'a> Reader<'a> {
    pub fn new(timeline: &'a Timeline) -> Self {
        let setting = &timeline.setting;
        Self {
            timeline,
            replay: Replay::before_all(timeline),
            bushes: BushLedger::new(setting),
            agents: setting.agents.iter().map(|agent| AgentLedger::new(agent.id, setting)).collect(),
            outcome: Outcome::default(),
            burned_out: 0,
            extinctions: 0,
        }
    }

    pub fn read(mut self) -> Outcome {
        let end = self.timeline.end_time();
        loop {
            self.read_instant();
            let now = self.replay.time();
            let until = self.replay.next_change().map_or(end, |change| change.min(end));
            if until <= now {
                break;
            }
            self.account(now, until);
            self.replay.wait_until(until);
        }
        for ledger in &mut self.agents {
            ledger.end_leg(end);
            ledger.end_drive(end);
        }
        self.conclude()
    }

    /// Lets all facts of the present instant happen.
    fn read_instant(&mut self) {
        let now = self.replay.time();
        while let Some((event, change)) = self.replay.step(now) {
            if let Some(change) = change {
                self.bushes.record(change, now);
                self.agents.iter_mut().for_each(|ledger| ledger.record_change(change));
            }
            self.record(event);
        }
        self.bushes.end_instant();
    }

    fn record(&mut self, event: &'a Event) {
        match event.fact {
            Fact::Fire(FireFact::Ignited { cause: Cause::Lit(_), .. }) => self.outcome.lit_by_wumpus += 1,
            Fact::Fire(FireFact::Ignited { cause: Cause::Spread(_), .. }) => self.outcome.caught_by_spread += 1,
            Fact::Fire(FireFact::Ignited { cause: Cause::Scheduled, .. }) => self.outcome.lit_by_schedule += 1,
            Fact::Fire(FireFact::BurnedOut { .. }) => self.burned_out += 1,
            Fact::Fire(FireFact::Extinguished { .. }) => self.extinctions += 1,
            _ => {}
        }
        let setting = &self.timeline.setting;
        if let Some(agent) = event.fact.agent().and_then(|id| setting.agent_index(id)) {
            self.agents[agent].record_fact(event, setting, self.replay.bushes());
        }
    }

    /// Books a stretch of time in which nothing changes.
    fn account(&mut self, now: SimTime, until: SimTime) {
        let span = until - now;
        self.bushes.account(span);
        for index in 0..self.agents.len() {
            let activity = self.replay.activity(index);
            let matters = activity == Activity::Standing && self.agents[index].is_truck();
            let others_goals = if matters { self.burning_goals_of_other_trucks(index) } else { Vec::new() };
            self.agents[index].account(span, activity, &self.bushes, &others_goals);
        }
    }

    /// Burning bushes that other trucks go for, each once.
    fn burning_goals_of_other_trucks(&self, agent: usize) -> Vec<usize> {
        let mut goals: Vec<usize> = (0..self.agents.len())
            .filter(|&other| other != agent && self.agents[other].is_truck())
            .filter_map(|other| self.timeline.setting.bush_index(self.replay.goal(other)?))
            .filter(|&bush| self.replay.bushes()[bush].burns())
            .collect();
        goals.sort_unstable();
        goals.dedup();
        goals
    }

    fn conclude(self) -> Outcome {
        let rules = &self.timeline.setting.rules;
        let agents: Vec<_> = self.agents.into_iter().map(AgentLedger::conclude).collect();
        let stuck_s = |truck: bool| {
            let of_kind = agents.iter().filter(|agent| agent.agent.role.suppresses() == truck);
            // Not `sum`, which makes -0 of nothing.
            of_kind.fold(0.0, |total, agent| total + agent.stuck_s)
        };
        let ignitions = self.outcome.lit_by_wumpus + self.outcome.caught_by_spread + self.outcome.lit_by_schedule;
        let outcome = Outcome {
            truck_stuck_s: stuck_s(true),
            wumpus_stuck_s: stuck_s(false),
            ended_s: self.timeline.end_time().as_seconds(),
            wumpus_score: rules.score_wumpus_ignited * f64::from(ignitions)
                + rules.score_wumpus_burned_out * f64::from(self.burned_out),
            truck_score: rules.score_truck_extinguished * f64::from(self.extinctions),
            agents,
            ..self.outcome
        };
        self.bushes.conclude(outcome, self.replay.bushes())
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::{self, seconds};
    use super::*;
    use crate::timeline::{AgentFact, AgentId, BushState};

    /// All times at which facts, legs or charged planning begin or end, the end of the run last.
    fn instants(timeline: &Timeline) -> Vec<SimTime> {
        let end = timeline.end_time();
        let of_fact = |event: &Event| {
            let leg = event.fact.trajectory().map(|leg| [leg.start_time(), leg.end_time()]);
            let charge =
                if let Fact::Agent(_, AgentFact::PlanFailed { until, .. }) = event.fact { Some(until) } else { None };
            [event.time].into_iter().chain(leg.into_iter().flatten()).chain(charge).collect::<Vec<_>>()
        };
        let mut instants: Vec<_> = timeline.events.iter().flat_map(of_fact).filter(|&time| time <= end).collect();
        instants.extend([SimTime::ZERO, end]);
        instants.sort_unstable();
        instants.dedup();
        instants
    }

    #[test]
    fn the_books_agree_with_a_look_at_every_state() {
        let mut total_stuck_s = 0.0;
        for seed in 0..4 {
            let timeline = sample::random(seed, seconds(400.0));
            let outcome = Outcome::new(&timeline);
            total_stuck_s += outcome.truck_stuck_s;
            let ruled_out = |agent: AgentId, bush: usize, now: SimTime| {
                let cell = timeline.setting.bushes[bush];
                timeline.events.iter().take_while(|event| event.time <= now).any(|event| match &event.fact {
                    Fact::Agent(of, AgentFact::OutOfReach { cells }) => *of == agent && cells.contains(&cell),
                    _ => false,
                })
            };
            let (mut stuck_s, mut idle_s) = ([0.0; 2], [0.0_f64; 2]);
            let (mut longest_idle_s, mut burning_cell_s, mut peak) = ([0.0_f64; 2], 0.0, 0);
            for pair in instants(&timeline).windows(2) {
                let (state, span_s) = (timeline.state_at(pair[0]), (pair[1] - pair[0]).as_seconds());
                let burning = state.bushes.iter().filter(|bush| bush.burns()).count();
                burning_cell_s += burning as f64 * span_s;
                peak = peak.max(burning);
                for (index, agent) in state.agents.iter().enumerate() {
                    let wanted: Vec<_> = (0..state.bushes.len())
                        .filter(|&bush| {
                            if agent.id.role.suppresses() {
                                state.bushes[bush].burns()
                            } else {
                                state.bushes[bush] == BushState::Intact
                            }
                        })
                        .collect();
                    let stands = agent.activity == Activity::Standing;
                    if stands && wanted.iter().any(|&bush| !ruled_out(agent.id, bush, pair[0])) {
                        stuck_s[index] += span_s;
                    }
                    idle_s[index] = if stands && !wanted.is_empty() { idle_s[index] + span_s } else { 0.0 };
                    longest_idle_s[index] = longest_idle_s[index].max(idle_s[index]);
                }
            }
            let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * (1.0 + b);
            assert!(close(outcome.burning_cell_s, burning_cell_s), "{} {burning_cell_s}", outcome.burning_cell_s);
            assert_eq!(outcome.peak_burning as usize, peak);
            for (index, agent) in outcome.agents.iter().enumerate() {
                assert!(close(agent.stuck_s, stuck_s[index]), "{agent:?} {stuck_s:?}");
                assert!(close(agent.longest_idle_s, longest_idle_s[index]), "{agent:?} {longest_idle_s:?}");
            }
        }
        assert!(total_stuck_s > 0.0, "these runs cannot tell");
    }

    #[test]
    fn distances_are_the_sums_of_what_was_driven() {
        for seed in 0..4 {
            let timeline = sample::random(seed, seconds(400.0));
            for agent in Outcome::new(&timeline).agents {
                let mut driven = vec![0.0];
                for event in timeline.events.iter().filter(|event| event.fact.agent() == Some(agent.agent)) {
                    match &event.fact {
                        Fact::Agent(_, AgentFact::Planned { trajectory, .. }) => {
                            driven.push(trajectory.distance_m(timeline.end_time()))
                        }
                        Fact::Agent(_, AgentFact::Dropped { trajectory, .. }) => {
                            *driven.last_mut().expect("it is never empty") = trajectory.distance_m(timeline.end_time());
                        }
                        _ => {}
                    }
                }
                let sum: f64 = driven.iter().sum();
                assert!((agent.distance_m - sum).abs() < 1e-6, "{} {sum}", agent.distance_m);
            }
        }
    }

    #[test]
    fn times_by_activity_add_up_to_the_whole_run() {
        for seed in 0..20 {
            let outcome = Outcome::new(&sample::random(seed, seconds(600.0)));
            for agent in &outcome.agents {
                let sum = [agent.driving_s, agent.planning_s, agent.suppressing_s, agent.standing_s, agent.waiting_s];
                let sum: f64 = sum.iter().sum();
                assert!((sum - outcome.ended_s).abs() < 1e-6, "{sum} of {}", outcome.ended_s);
                assert!(agent.stuck_s <= agent.standing_s && agent.longest_idle_s <= agent.standing_s);
            }
        }
    }
}
