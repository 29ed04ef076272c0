//! What each agent and each fire did over a run, in order of time, so that any moment of it is found quickly.

use std::collections::BTreeMap;

use crate::geometry::Cell;
use crate::planning::{SearchGraph, SearchPhase};
use crate::time::SimTime;
use crate::timeline::{AgentFact, Cause, Fact, FireFact, Setting, Timeline};
use crate::trajectory::Trajectory;

/// What a timeline tells, ordered by who did it. Facts are kept by their place in the timeline.
#[derive(Debug)]
pub struct AgentTracks {
    /// By place in [`Setting::agents`].
    agents: Vec<AgentTrack>,
    spreads: Vec<Spread>,
}

#[derive(Debug, Default)]
struct AgentTrack {
    legs: Vec<Leg>,
    stops: Vec<(SimTime, Cell)>,
    searches: Vec<(SimTime, usize)>,
}

/// A leg of an agent as long as it was followed.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    pub from: SimTime,
    /// When the next one began; [`SimTime::MAX`] of the last one.
    pub until: SimTime,
    fact: usize,
}

/// A burning cell sets on fire what is near, if anything is.
#[derive(Debug, PartialEq)]
pub struct Spread {
    pub time: SimTime,
    pub from: Cell,
    /// In the order in which they caught fire.
    pub caught: Vec<Cell>,
}

impl Leg {
    /// The way and the clock of it, from the timeline that it is of.
    pub fn trajectory(self, timeline: &Timeline) -> &Trajectory {
        timeline.events[self.fact].fact.trajectory().expect("legs are facts with a trajectory")
    }
}

impl AgentTracks {
    pub fn new(timeline: &Timeline) -> Self {
        let mut agents: Vec<AgentTrack> = timeline.setting.agents.iter().map(|_| AgentTrack::default()).collect();
        for (index, event) in timeline.events.iter().enumerate() {
            let agent = event.fact.agent().and_then(|agent| timeline.setting.agent_index(agent));
            if let Some(agent) = agent {
                agents[agent].record(index, event.time, &event.fact);
            }
        }
        Self { agents, spreads: spreads(timeline) }
    }

    /// Legs of an agent that it followed between two times, both included, the last one first.
    pub fn legs_between(&self, agent: usize, from: SimTime, to: SimTime) -> impl Iterator<Item = Leg> + '_ {
        let legs = &self.agents[agent].legs;
        let begun = legs.partition_point(|leg| leg.from <= to);
        legs[..begun].iter().rev().take_while(move |leg| leg.until >= from).copied()
    }

    /// The leg that an agent follows, or has followed to its end.
    pub fn leg_at(&self, agent: usize, time: SimTime) -> Option<Leg> {
        self.legs_between(agent, time, time).next()
    }

    /// Since when an agent suppresses, and which cell, if it does at that time.
    pub fn stop_at(&self, agent: usize, time: SimTime) -> Option<(SimTime, Cell)> {
        let stops = &self.agents[agent].stops;
        stops[..stops.partition_point(|(from, _)| *from <= time)].last().copied()
    }

    /// Moments of spreading after `from` up to `to`.
    pub fn spreads_between(&self, from: SimTime, to: SimTime) -> &[Spread] {
        let before = |time: SimTime| self.spreads.partition_point(|spread| spread.time <= time);
        &self.spreads[before(from)..before(to).max(before(from))]
    }

    /// The last search of an agent and phase that was recorded up to a time: its place among the facts, and itself.
    pub fn search_at<'a>(
        &self,
        timeline: &'a Timeline,
        agent: usize,
        phase: SearchPhase,
        time: SimTime,
    ) -> Option<(usize, &'a SearchGraph)> {
        let searches = self.agents[agent].searches.iter().rev().skip_while(|(at, _)| *at > time);
        searches.into_iter().find_map(|&(_, fact)| match &timeline.events[fact].fact {
            Fact::Agent(_, AgentFact::Searched { phase: of, graph, .. }) if *of == phase => Some((fact, graph)),
            _ => None,
        })
    }
}

impl AgentTrack {
    fn record(&mut self, index: usize, time: SimTime, fact: &Fact) {
        if fact.trajectory().is_some() {
            if let Some(last) = self.legs.last_mut() {
                last.until = time;
            }
            self.legs.push(Leg { from: time, until: SimTime::MAX, fact: index });
        }
        match fact {
            Fact::Agent(_, AgentFact::Suppressing { cell, .. }) => self.stops.push((time, *cell)),
            Fact::Agent(_, AgentFact::Searched { .. }) => self.searches.push((time, index)),
            _ => {}
        }
    }
}

/// When the rules let which burning cells spread, and what caught fire from them; where the rules are not known, only
/// what did light something.
fn spreads(timeline: &Timeline) -> Vec<Spread> {
    let mut caught: BTreeMap<(SimTime, u16, u16), Vec<Cell>> = BTreeMap::new();
    for (time, from) in due_spreads(timeline) {
        caught.insert((time, from.row, from.col), Vec::new());
    }
    for event in &timeline.events {
        if let Fact::Fire(FireFact::Ignited { cell, cause: Cause::Spread(from) }) = event.fact {
            caught.entry((event.time, from.row, from.col)).or_default().push(cell);
        }
    }
    let spread = |((time, row, col), caught)| Spread { time, from: Cell { col, row }, caught };
    caught.into_iter().map(spread).collect()
}

/// Cells that burn still when their delay is over. At one instant fires end before they spread.
fn due_spreads(timeline: &Timeline) -> Vec<(SimTime, Cell)> {
    let Setting { bushes, rules, .. } = &timeline.setting;
    let Some(fire) = rules.fire else { return Vec::new() };
    let mut due: Vec<Option<SimTime>> = vec![None; bushes.len()];
    let mut spreads = Vec::new();
    for event in &timeline.events {
        let Some(bush) = event.fact.cell().and_then(|cell| timeline.setting.bush_index(cell)) else { continue };
        match event.fact {
            Fact::Fire(FireFact::Ignited { cause, .. }) => {
                let may = if matches!(cause, Cause::Spread(_)) { fire.caught_spreads } else { fire.lit_spreads };
                due[bush] = may.then_some(event.time + fire.spread_delay);
            }
            Fact::Fire(FireFact::BurnedOut { .. }) | Fact::Fire(FireFact::Extinguished { .. }) => {
                spreads.extend(due[bush].take().filter(|&due| due < event.time).map(|due| (due, bushes[bush])));
            }
            _ => {}
        }
    }
    let end = timeline.end_time();
    let lasting = due.iter().zip(bushes).filter_map(|(due, &bush)| Some((due.filter(|&due| due <= end)?, bush)));
    spreads.extend(lasting);
    spreads
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::picture::film::field::tests::setting;
    use crate::planning::Effort;
    use crate::timeline::{AgentId, AgentStart, Body, Event};

    const CELLS: [Cell; 4] =
        [Cell { col: 1, row: 1 }, Cell { col: 2, row: 1 }, Cell { col: 3, row: 1 }, Cell { col: 5, row: 5 }];
    const TRUCK: AgentId = AgentId::unimog(0);

    fn seconds(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds)
    }

    fn timeline(facts: Vec<(f64, Fact)>) -> Timeline {
        let start = AgentStart { id: TRUCK, pose: Pose::default(), body: Body::Square { size_m: 1.0 }, limits: None };
        let setting = Setting { bushes: CELLS.to_vec(), agents: vec![start], ..setting() };
        let events = facts.into_iter().map(|(time_s, fact)| Event { time: seconds(time_s), fact });
        Timeline { setting, events: events.collect() }
    }

    fn lit(cell: usize) -> Fact {
        Fact::Fire(FireFact::Ignited { cell: CELLS[cell], cause: Cause::Scheduled })
    }

    fn caught(cell: usize, from: usize) -> Fact {
        Fact::Fire(FireFact::Ignited { cell: CELLS[cell], cause: Cause::Spread(CELLS[from]) })
    }

    #[test]
    fn what_burns_still_after_the_delay_spreads_once() {
        let timeline = timeline(vec![
            (0.0, lit(0)),
            (1.0, lit(1)),
            (10.0, caught(2, 0)),
            (11.0, Fact::Fire(FireFact::Extinguished { cell: CELLS[1], by: TRUCK })),
            (40.0, Fact::Fire(FireFact::BurnedOut { cell: CELLS[0] })),
            (89.0, lit(3)),
        ]);
        let spread = |time_s: f64, from: usize, caught: &[usize]| Spread {
            time: seconds(time_s),
            from: CELLS[from],
            caught: caught.iter().map(|&cell| CELLS[cell]).collect(),
        };
        // What is put out at the very instant does not spread, nor does what caught fire; the last one lights nothing.
        let courses = AgentTracks::new(&timeline);
        assert_eq!(courses.spreads, [spread(10.0, 0, &[2]), spread(99.0, 3, &[])]);
        assert_eq!(courses.spreads_between(seconds(10.0), seconds(99.0)), &courses.spreads[1..]);
        assert_eq!(courses.spreads_between(seconds(5.0), seconds(10.0)), &courses.spreads[..1]);
    }

    #[test]
    fn without_rules_only_what_lit_something_has_spread() {
        let mut timeline = timeline(vec![(0.0, lit(0)), (0.0, lit(3)), (7.0, caught(1, 0)), (7.0, caught(2, 0))]);
        timeline.setting.rules.fire = None;
        let expected = Spread { time: seconds(7.0), from: CELLS[0], caught: CELLS[1..3].to_vec() };
        assert_eq!(AgentTracks::new(&timeline).spreads, [expected]);
    }

    #[test]
    fn a_leg_is_followed_until_the_next_one() {
        let leg = |time_s: f64| {
            let trajectory = Trajectory::new(seconds(time_s), Pose::default(), Vec::new());
            let effort = Effort { roadmap_expansions: 0, local_expansions: 0 };
            Fact::Agent(TRUCK, AgentFact::Planned { goal: CELLS[0], trajectory, effort, found_by: None })
        };
        let timeline = timeline([5.0, 20.0, 40.0].map(|time_s| (time_s, leg(time_s))).to_vec());
        let courses = AgentTracks::new(&timeline);
        assert!(courses.leg_at(0, seconds(4.9)).is_none());
        for (time_s, from_s) in [(5.0, 5.0), (19.9, 5.0), (20.0, 20.0), (90.0, 40.0)] {
            assert_eq!(courses.leg_at(0, seconds(time_s)).expect("there is one").from, seconds(from_s));
        }
        let between = courses.legs_between(0, seconds(19.0), seconds(30.0)).map(|leg| leg.from);
        assert_eq!(between.collect::<Vec<_>>(), [seconds(20.0), seconds(5.0)]);
    }
}
