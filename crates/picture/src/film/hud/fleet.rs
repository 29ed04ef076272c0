//! Agents that are too many to be told of one by one: how many of each role do what, and what they have done so far.

use crate::colours::agent_colour;
use crate::film::RunView;
use crate::film::hud::HudView;
use crate::film::hud::blocks::{heading, values};
use crate::film::hud::panel::{LineMark, PanelBlock, PanelLine};
use crate::film::hud::pen::TextFace;
use crate::film::hud::stories::{FIRST_AGENT_RANK, cells_word};
use wildfire_base::time::SimTime;
use wildfire_timeline::{Activity, AgentId, AgentState, Role, State};

/// The sums of a run's agents of one role at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct RoleSums {
    agents: u32,
    /// Under way to a cell.
    toward_goal: u32,
    /// Under way without one: to a place to wait at, out of another's way, or to a stop.
    elsewhere: u32,
    suppressing: u32,
    /// For others that are in the way.
    waiting: u32,
    planning: u32,
    refilling: u32,
    standing: u32,
    /// Goes for, or suppresses, a fire that ends by itself before.
    too_late: u32,
    /// Cells lit, or put out.
    cells: u32,
    plans: u32,
    failures: u32,
}

impl RoleSums {
    fn new(run: &RunView, state: &State, role: Role, time: SimTime) -> Self {
        let mut sums = Self::default();
        for (index, agent) in state.agents.iter().enumerate().filter(|(_, agent)| agent.id.role == role) {
            let does = match (agent.activity, agent.goal) {
                (Activity::Driving, Some(_)) => &mut sums.toward_goal,
                (Activity::Driving, None) => &mut sums.elsewhere,
                (Activity::Suppressing, _) => &mut sums.suppressing,
                (Activity::Waiting, _) => &mut sums.waiting,
                (Activity::Planning, _) => &mut sums.planning,
                (Activity::Refilling, _) => &mut sums.refilling,
                (Activity::Standing, _) => &mut sums.standing,
            };
            *does += 1;
            let stats = run.stats_at(index, time);
            sums.agents += 1;
            sums.too_late += u32::from(is_too_late(run, state, index, agent));
            sums.cells += stats.cells;
            sums.plans += stats.plans;
            sums.failures += stats.failures;
        }
        sums
    }
}

/// Returns whether the fire that a truck goes for, or suppresses, ends by itself before; false where that is not known.
fn is_too_late(run: &RunView, state: &State, index: usize, agent: &AgentState) -> bool {
    let setting = &run.timeline().setting;
    let Some(bush) = agent.goal.and_then(|goal| setting.bush_index(goal)).filter(|_| agent.id.role.suppresses()) else {
        return false;
    };
    let arrives = if agent.activity == Activity::Suppressing {
        run.index().stop_at(index, state.time).map(|stop| stop.since)
    } else {
        run.index().leg_at(index, state.time).map(|leg| leg.trajectory(run.timeline()).end_time())
    };
    arrives.is_some_and(|arrives| setting.rules.is_hopeless(state.bushes[bush], arrives))
}

/// The blocks that sum up trucks, then Wumpuses; where there is little room, what most of them do is left.
pub fn fleet_blocks(view: &HudView) -> Vec<PanelBlock> {
    let roles = [(AgentId::unimog(0), FIRST_AGENT_RANK), (AgentId::wumpus(0), FIRST_AGENT_RANK + 1)];
    let min = |any: AgentId| usize::from(view.is_comparison()) + if any.role.drives() { 4 } else { 2 };
    roles
        .into_iter()
        .filter_map(|(any, rank)| Some(PanelBlock::new(rank, role_lines(view, any)?).with_min(min(any))))
        .collect()
}

/// `any` is an agent of the role; `None` if no run has one.
fn role_lines(view: &HudView, any: AgentId) -> Option<Vec<PanelLine>> {
    let sums: Vec<RoleSums> =
        view.runs.iter().zip(view.states).map(|(run, state)| RoleSums::new(run, state, any.role, view.time)).collect();
    let max = sums.iter().map(|sums| sums.agents).max().filter(|&agents| agents > 0)?;
    let face = TextFace { colour: agent_colour(any), ..TextFace::STRONG };
    let line = |name: &str, count: fn(&RoleSums) -> u32| {
        let counts = values(sums.iter().map(|sums| count(sums).to_string()), TextFace::STRONG);
        PanelLine::new([LineMark::left(name, TextFace::PLAIN)].into_iter().chain(counts).collect())
    };
    let noun = if any.role.drives() { "trucks" } else { "Wumpuses" };
    let title = if view.is_comparison() {
        heading(view, LineMark::left(noun, face))
    } else {
        let done = format!("{} {}", sums[0].cells, cells_word(any));
        PanelLine::new(vec![
            LineMark::left(format!("{max} {noun}"), face),
            LineMark::right(done, TextFace { colour: agent_colour(any), ..TextFace::STRONG }),
        ])
    };
    let mut lines = vec![title];
    if view.is_comparison() {
        lines.push(line(cells_word(any), |sums| sums.cells));
    }
    if any.role.drives() {
        lines.push(line("driving to a fire", |sums| sums.toward_goal));
        lines.push(line("suppressing", |sums| sums.suppressing));
        lines.push(line("standing", |sums| sums.standing));
        lines.push(line("waiting for others", |sums| sums.waiting));
        lines.push(line("planning", |sums| sums.planning));
        lines.push(line("driving elsewhere", |sums| sums.elsewhere));
        if view.runs.iter().any(|run| run.timeline().setting.water.is_some()) {
            lines.push(line("refilling", |sums| sums.refilling));
        }
        let late = values(sums.iter().map(|sums| sums.too_late.to_string()), TextFace::faint());
        let name = LineMark::left("too late for their fire", TextFace::faint());
        lines.push(PanelLine::new([name].into_iter().chain(late).collect()));
    } else {
        lines.push(line("walking", |sums| sums.toward_goal + sums.elsewhere));
        lines.push(line("standing or planning", |sums| sums.standing + sums.waiting + sums.planning));
    }
    if let [sums] = sums.as_slice() {
        let plans = format!("{} routes planned, {} failed", sums.plans, sums.failures);
        lines.push(PanelLine::new(vec![LineMark::left(plans, TextFace::faint())]));
    }
    Some(lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FrameRequest, ViewOptions};
    use wildfire_timeline::{Fact, FireFact, Timeline, sample};

    /// A run with a random story of its first agents, and that many in all.
    fn timeline(seed: u64, agents: u16) -> Timeline {
        let mut timeline = sample::random(seed, SimTime::from_seconds(300.0));
        let existing = timeline.setting.agents.len() as u16;
        let last = *timeline.setting.agents.last().expect("there is a truck");
        let others =
            (existing..agents).map(|number| wildfire_timeline::AgentStart { id: AgentId::unimog(number), ..last });
        timeline.setting.agents.extend(others);
        timeline
    }

    fn blocks(run: &RunView, time_s: f64) -> Vec<PanelBlock> {
        let time = SimTime::from_seconds(time_s);
        let options = ViewOptions::default();
        let runs = [run];
        let states = [run.state_at(time)];
        let request = FrameRequest { runs: &runs, time, options: &options };
        crate::film::hud::stories::agent_blocks(&HudView::new(&request, &states))
    }

    #[test]
    fn every_agent_is_counted_once_by_what_it_does() {
        let mut works = 0;
        for seed in 0..4 {
            let run = RunView::new(timeline(seed, 12), None);
            for time_s in [0.0, 1.0, 30.0, 77.7, 150.0, 299.0] {
                let state = run.state_at(SimTime::from_seconds(time_s));
                for role in [Role::Wumpus, Role::Unimog] {
                    let sums = RoleSums::new(&run, &state, role, state.time);
                    let all = state.agents.iter().filter(|agent| agent.id.role == role).count();
                    let RoleSums { toward_goal, elsewhere, suppressing, waiting, .. } = sums;
                    let RoleSums { planning, refilling, standing, .. } = sums;
                    let counted = toward_goal + elsewhere + suppressing + waiting + planning + refilling + standing;
                    assert_eq!((counted, sums.agents), (all as u32, all as u32), "{role:?} at {time_s}: {sums:?}");
                    assert!(sums.too_late <= toward_goal + suppressing + waiting + planning + standing);
                    works += counted - standing;
                }
            }
        }
        assert!(works > 10, "these runs cannot tell");
    }

    #[test]
    fn cells_are_those_that_the_facts_name() {
        for seed in 0..4 {
            let run = RunView::new(timeline(seed, 12), None);
            for time_s in [50.0, 300.0] {
                let state = run.state_at(SimTime::from_seconds(time_s));
                let until = |fact: fn(&Fact) -> bool| {
                    let events = run.timeline().events.iter();
                    events.filter(|event| event.time <= state.time && fact(&event.fact)).count() as u32
                };
                let put_out = until(|fact| matches!(fact, Fact::Fire(FireFact::Extinguished { .. })));
                assert_eq!(RoleSums::new(&run, &state, Role::Unimog, state.time).cells, put_out);
            }
        }
    }

    #[test]
    fn a_truck_is_too_late_if_its_fire_burns_out_before() {
        use sample::{A, TRUCK, at, ignited, leg, planned};
        let dwell_s = 5.0;
        for (drive_s, is_late) in [(54.9, false), (55.1, true)] {
            let mut timeline = sample::by_hand();
            let truck = timeline.setting.agents[1].pose;
            timeline.events = vec![at(0.0, ignited(A)), at(0.0, planned(TRUCK, A, leg(0.0, truck, 1.0, &[drive_s])))];
            assert_eq!(timeline.setting.rules.suppression_dwell, SimTime::from_seconds(dwell_s));
            let run = RunView::new(timeline, None);
            let state = run.state_at(SimTime::from_seconds(20.0));
            let sums = RoleSums::new(&run, &state, Role::Unimog, state.time);
            assert_eq!((sums.toward_goal, sums.too_late), (1, u32::from(is_late)), "{drive_s} s");
        }
    }

    #[test]
    fn few_agents_have_separate_blocks_and_many_are_summed_up() {
        assert_eq!(blocks(&RunView::new(timeline(1, 8), None), 100.0).len(), 8);
        let crowd = RunView::new(timeline(1, 9), None);
        assert!(crowd.is_crowded());
        assert_eq!(blocks(&crowd, 100.0).len(), 2);
    }
}
