//! The agents in the course of a run: numbers and goal of each as steps, its legs, stops and searches.
//!
//! Time is added up in whole nanoseconds and becomes seconds once, at the end. A distance is that of the legs before,
//! and of the present one as far as it was followed.

use std::collections::BTreeSet;

use crate::replay::BushChange;
use crate::{
    Activity, AgentFact, AgentOutcome, AgentStart, AgentState, BushState, Event, Fact, FireFact, GroundEvent,
    RestReason, Setting, Timeline,
};
use wildfire_base::geometry::Cell;
use wildfire_base::query::{Effort, FoundBy, PlanFailure};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{MotionState, Piece, Trajectory};

use super::bushes::BushCounts;
use super::ground::GroundIndex;

/// The numbers of an agent up to some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgentStats {
    pub activity: Activity,
    /// By activity, in the order of its variants.
    spent: [SimTime; 6],
    /// Planner queries, including failed ones.
    pub plans: u32,
    pub failures: u32,
    /// The index of the fact of the last failure.
    pub last_failure: Option<usize>,
    /// Nodes expanded by all queries.
    pub expansions: u64,
    /// Cells lit or extinguished by this agent.
    pub cells: u32,
    /// The distance driven or walked, in metres.
    pub distance_m: f64,
}

impl AgentStats {
    pub fn spent(&self, activity: Activity) -> SimTime {
        self.spent[activity as usize]
    }
}

/// A suppression of a truck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SuppressionSpan {
    pub since: SimTime,
    pub cell: Cell,
    pub lasts: SimTime,
}

/// A leg of an agent, for as long as it was followed.
#[derive(Clone, Copy, Debug)]
pub struct FollowedLeg {
    pub from: SimTime,
    /// The time at which the next leg began; [`SimTime::MAX`] for the last one.
    pub until: SimTime,
    fact: usize,
}

impl FollowedLeg {
    /// Returns the place in [`Timeline::events`] of the fact with which it began.
    pub fn fact(self) -> usize {
        self.fact
    }

    /// Returns its path and clock from the timeline it belongs to.
    pub fn trajectory(self, timeline: &Timeline) -> &Trajectory {
        timeline.events[self.fact].fact.trajectory().expect("legs are facts with a trajectory")
    }

    /// Metres along it between the time when it was begun and another one.
    fn distance_m(self, timeline: &Timeline, time: SimTime) -> f64 {
        let leg = self.trajectory(timeline);
        leg.distance_m(time) - leg.distance_m(self.from)
    }
}

/// The numbers of an agent until a time at which something changed, and its goal and leg from then on.
#[derive(Clone, Copy, Debug)]
struct AgentStep {
    time: SimTime,
    /// The distance is that of the legs that were over by then.
    stats: AgentStats,
    goal: Option<Cell>,
    /// Place of the leg that it follows from then on.
    leg: Option<usize>,
}

/// One agent, in order of time.
#[derive(Debug)]
pub(super) struct AgentHistory {
    /// The first is at zero.
    steps: Vec<AgentStep>,
    pub legs: Vec<FollowedLeg>,
    /// The times at which it began to suppress, with the cells.
    pub stops: Vec<(SimTime, Cell, u32)>,
    /// The times of its searches, with the places of the facts.
    pub searches: Vec<(SimTime, usize)>,
}

impl AgentHistory {
    fn new() -> Self {
        let stats = AgentStats {
            activity: Activity::Standing,
            spent: [SimTime::ZERO; 6],
            plans: 0,
            failures: 0,
            last_failure: None,
            expansions: 0,
            cells: 0,
            distance_m: 0.0,
        };
        let first = AgentStep { time: SimTime::ZERO, stats, goal: None, leg: None };
        Self { steps: vec![first], legs: Vec::new(), stops: Vec::new(), searches: Vec::new() }
    }

    /// Returns the numbers up to `time`, which is not after the end.
    pub fn stats_at(&self, timeline: &Timeline, time: SimTime) -> AgentStats {
        let AgentStep { mut stats, leg, .. } = self.last_step(time).later(time);
        if let Some(leg) = leg {
            stats.distance_m += self.legs[leg].distance_m(timeline, time);
        }
        stats
    }

    /// Returns the state at `time`, which is not after the end.
    pub fn state_at(&self, timeline: &Timeline, start: &AgentStart, time: SimTime) -> AgentState {
        let &AgentStep { stats, goal, leg, .. } = self.last_step(time);
        let leg = leg.map(|leg| self.legs[leg].trajectory(timeline));
        let MotionState { pose, speed_mps } = leg.map_or(MotionState::standing(start.pose), |leg| leg.state_at(time));
        AgentState { id: start.id, pose, speed_mps, activity: stats.activity, goal }
    }

    /// Iterates over the times at which something about it changed, including the start, ascending.
    pub fn change_times(&self) -> impl Iterator<Item = SimTime> + '_ {
        self.steps.iter().map(|step| step.time)
    }

    fn last_step(&self, time: SimTime) -> &AgentStep {
        &self.steps[self.steps.partition_point(|step| step.time <= time) - 1]
    }

    /// The step for a time that is not before the last one.
    fn step(&mut self, time: SimTime) -> &mut AgentStep {
        let last = self.steps[self.steps.len() - 1];
        // What happens at one instant is one step, so that a look-up finds all of it.
        if last.time < time {
            self.steps.push(last.later(time));
        }
        self.steps.last_mut().expect("there is a step for time zero")
    }

    /// Ends the present leg and begins another one.
    fn follow(&mut self, timeline: &Timeline, time: SimTime, fact: usize) {
        let next = self.legs.len();
        let ended = self.legs.last_mut().map_or(0.0, |last| {
            last.until = time;
            last.distance_m(timeline, time)
        });
        self.legs.push(FollowedLeg { from: time, until: SimTime::MAX, fact });
        let step = self.step(time);
        step.stats.distance_m += ended;
        step.leg = Some(next);
    }
}

impl AgentStep {
    /// The same at a later time until which nothing changed.
    fn later(&self, time: SimTime) -> Self {
        let mut later = Self { time, ..*self };
        later.stats.spent[self.stats.activity as usize] += time.since(self.time);
        later
    }
}

/// A truck's drive that may yet end in an extinction.
#[derive(Debug)]
struct OpenDrive {
    goal: Cell,
    sets_out: SimTime,
    is_hopeless: bool,
}

/// What burns and who goes for it, during a stretch of time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings<'a> {
    pub now: SimTime,
    pub bushes: &'a BushCounts,
    pub burning_ground: u32,
    /// Places of the bushes that could be lit if they were not wet, which only matter to a Wumpus that stands.
    pub wet_bushes: &'a [usize],
    /// Burning cells that trucks go for, and how many do, which only matter to a truck that stands.
    pub burning_goals: &'a [(Cell, u32)],
    /// The goal of the agent itself.
    pub agent_goal: Option<Cell>,
}

impl Surroundings<'_> {
    /// Burning cells that other trucks go for, each once.
    fn others_goals(&self) -> impl Iterator<Item = Cell> + '_ {
        self.burning_goals
            .iter()
            .filter_map(|&(cell, trucks)| (trucks > u32::from(self.agent_goal == Some(cell))).then_some(cell))
    }
}

/// Cells of ground that an agent ruled out, and when how many of them burn from then on.
#[derive(Debug, Default)]
struct GroundOutOfReach {
    /// In order of rows and columns.
    cells: BTreeSet<(u16, u16)>,
    /// Begins and ends of their burning, ascending.
    begins: Vec<SimTime>,
    ends: Vec<SimTime>,
}

impl GroundOutOfReach {
    fn add(&mut self, cells: impl Iterator<Item = Cell>, ground: &GroundIndex) {
        for cell in cells.filter(|&cell| ground.is_ground(cell)) {
            if self.cells.insert((cell.row, cell.col)) {
                self.begins.extend(ground.burnings_of(cell).iter().map(|burning| burning.ignited));
                self.ends.extend(ground.burnings_of(cell).iter().map(|burning| burning.ends));
            }
        }
        self.begins.sort_unstable();
        self.ends.sort_unstable();
    }

    fn burning_at(&self, time: SimTime) -> u32 {
        let so_far = |times: &[SimTime]| times.partition_point(|&happened| happened <= time);
        (so_far(&self.begins) - so_far(&self.ends)) as u32
    }
}

/// Follows one agent through a run.
#[derive(Debug)]
pub(super) struct AgentReader<'a> {
    timeline: &'a Timeline,
    pub history: AgentHistory,
    outcome: AgentOutcome,
    /// Places among the bushes. Most bushes of a large field are in everybody's reach.
    out_of_reach: BTreeSet<usize>,
    burning_out_of_reach: u32,
    lightable_out_of_reach: u32,
    ground: Option<&'a GroundIndex>,
    ground_out_of_reach: GroundOutOfReach,
    /// Whether it rests because its policy wants it to.
    rests_by_choice: bool,
    /// Whether it has nothing to go for, or is on its way to where it waits.
    has_nothing_to_do: bool,
    without_work: SimTime,
    stuck: SimTime,
    idle: SimTime,
    longest_idle: SimTime,
    drive: Option<OpenDrive>,
}

impl<'a> AgentReader<'a> {
    pub fn new(start: &AgentStart, timeline: &'a Timeline, ground: Option<&'a GroundIndex>) -> Self {
        Self {
            timeline,
            history: AgentHistory::new(),
            outcome: AgentOutcome::idle(start.id),
            out_of_reach: BTreeSet::new(),
            burning_out_of_reach: 0,
            lightable_out_of_reach: 0,
            ground,
            ground_out_of_reach: GroundOutOfReach::default(),
            rests_by_choice: false,
            has_nothing_to_do: false,
            without_work: SimTime::ZERO,
            stuck: SimTime::ZERO,
            idle: SimTime::ZERO,
            longest_idle: SimTime::ZERO,
            drive: None,
        }
    }

    pub fn is_truck(&self) -> bool {
        self.outcome.agent.role.suppresses()
    }

    pub fn record_change(&mut self, BushChange { bush, from, to }: BushChange) {
        if self.out_of_reach.contains(&bush) {
            let reignition = self.timeline.setting.rules.reignition;
            self.burning_out_of_reach = self.burning_out_of_reach - u32::from(from.burns()) + u32::from(to.burns());
            self.lightable_out_of_reach = self.lightable_out_of_reach - u32::from(from.can_ignite(reignition))
                + u32::from(to.can_ignite(reignition));
        }
    }

    /// Records a fact of this agent's, by its place in the timeline; `bushes` are as they are after it.
    pub fn record_fact(&mut self, index: usize, event: &'a Event, bushes: &[BushState]) {
        let now = event.time;
        // Whatever leg was under way ends where a new one begins.
        if event.fact.trajectory().is_some() {
            self.end_leg(now);
            self.history.follow(self.timeline, now, index);
        }
        let stats = &mut self.history.step(now).stats;
        let fact = match &event.fact {
            Fact::Agent(_, fact) => fact,
            Fact::Fire(fact) => {
                // A fact about a fire has an agent only if that agent ignited the cell or put it out.
                stats.cells += 1;
                if let FireFact::Extinguished { cell, .. } = fact {
                    // A drive whose goal is put out was not wasted.
                    self.drive = self.drive.take().filter(|drive| drive.goal != *cell);
                }
                return;
            }
            Fact::Ended { .. } => return,
        };
        self.rests_by_choice = match fact {
            AgentFact::Rested { reason } => {
                // For any of these a truck may stand beside a fire in its reach and is not stuck.
                matches!(
                    reason,
                    RestReason::PolicyWait | RestReason::NoWater | RestReason::TooHot | RestReason::NotReady
                )
            }
            // These are only said about an agent; what it does stays the same.
            AgentFact::OutOfReach { .. } | AgentFact::Searched { .. } | AgentFact::RelocationFailed { .. } => {
                self.rests_by_choice
            }
            _ => false,
        };
        // Unlike resting by choice, this includes drives to places where a truck waits or fills its tank.
        self.has_nothing_to_do = match fact {
            AgentFact::Rested { reason } => {
                use RestReason::{NoWater, NotReady, NothingBurns, PolicyWait, TooHot};
                matches!(reason, PolicyWait | NothingBurns | NoWater | TooHot | NotReady)
            }
            AgentFact::Relocated { .. } | AgentFact::Halted { .. } | AgentFact::Refilling { .. } => true,
            AgentFact::OutOfReach { .. } | AgentFact::Searched { .. } | AgentFact::RelocationFailed { .. } => {
                self.has_nothing_to_do
            }
            _ => false,
        };
        match fact {
            AgentFact::RoadmapBuilt { samples, edges, components } => {
                self.outcome.roadmap_samples = *samples;
                self.outcome.roadmap_edges = *edges;
                self.outcome.roadmap_components = *components;
            }
            AgentFact::OutOfReach { cells } => self.rule_out(cells, &self.timeline.setting, bushes),
            AgentFact::Planned { goal, trajectory, effort, found_by } => {
                self.count_plan(now, *effort);
                self.outcome.lattice_plans += u32::from(found_by.is_some_and(FoundBy::is_after_failure));
                // Before the next one begins, so that a drive that was dropped counts.
                self.end_drive(now);
                // Without pieces it stands in reach already: that is a stop and no drive.
                let drives = self.is_truck() && !trajectory.pieces().is_empty();
                let is_hopeless = drives && self.is_hopeless(*goal, trajectory.end_time(), bushes);
                let sets_out = trajectory.sets_out_at();
                self.drive = drives.then_some(OpenDrive { goal: *goal, sets_out, is_hopeless });
                self.outcome.goals += u32::from(self.is_truck());
            }
            AgentFact::Relocated { effort, .. } => {
                self.count_plan(now, *effort);
                self.end_drive(now);
                self.outcome.relocations += 1;
            }
            AgentFact::RelocationFailed { reason, effort, .. } => {
                self.count_plan(now, *effort);
                // A place that others are in the way to is no failure of the planner.
                if let Some(reason) = reason {
                    let stats = &mut self.history.step(now).stats;
                    stats.failures += 1;
                    stats.last_failure = Some(index);
                    self.count_failure(*reason);
                }
            }
            AgentFact::PlanFailed { reason, effort, .. } => {
                stats.failures += 1;
                stats.last_failure = Some(index);
                self.count_plan(now, *effort);
                self.count_failure(*reason);
            }
            AgentFact::Refilling { .. } => self.outcome.refills += 1,
            AgentFact::LocalMinimum { .. } => self.outcome.local_minima += 1,
            AgentFact::Dropped { .. } => self.end_drive(now),
            AgentFact::GaveWay { .. } => self.outcome.deadlocks += 1,
            AgentFact::Suppressing { cell, water_units } => self.history.stops.push((now, *cell, *water_units)),
            AgentFact::Searched { .. } => self.history.searches.push((now, index)),
            AgentFact::StartMoved { .. }
            | AgentFact::SuppressionEnded { .. }
            | AgentFact::Rested { .. }
            | AgentFact::Halted { .. }
            | AgentFact::Blocked { .. } => {}
        }
    }

    /// Records that it lit or extinguished a cell of ground.
    pub fn record_deed(&mut self, deed: &GroundEvent) {
        self.drive = self.drive.take().filter(|drive| drive.goal != deed.cell);
    }

    /// Records the agent's activity from now on, and its goal.
    pub fn turn_to(&mut self, now: SimTime, activity: Activity, goal: Option<Cell>) {
        let last = &self.history.steps[self.history.steps.len() - 1];
        // Every agent comes here at every instant, and most change nothing.
        if (last.stats.activity, last.goal) != (activity, goal) {
            let step = self.history.step(now);
            (step.stats.activity, step.goal) = (activity, goal);
        }
    }

    /// Records a period of time.
    pub fn account(&mut self, span: SimTime, activity: Activity, around: &Surroundings<'_>) {
        let (anything, in_reach) = self.left_to_do(around);
        let stands = activity == Activity::Standing;
        if stands && in_reach && !self.rests_by_choice {
            self.stuck += span;
        }
        if self.has_nothing_to_do && self.is_truck() {
            self.without_work += span;
        }
        self.idle = if stands && anything { self.idle + span } else { SimTime::ZERO };
        self.longest_idle = self.longest_idle.max(self.idle);
    }

    /// Returns the history and the totals at the end.
    pub fn finish(mut self, end: SimTime) -> (AgentHistory, AgentOutcome) {
        // What is under way counts up to the end.
        self.end_leg(end);
        self.end_drive(end);
        let stats = self.history.stats_at(self.timeline, end);
        let spent_s = |activity: Activity| stats.spent(activity).as_seconds();
        let outcome = AgentOutcome {
            cells: stats.cells,
            plans: stats.plans,
            distance_m: stats.distance_m,
            driving_s: spent_s(Activity::Driving),
            planning_s: spent_s(Activity::Planning),
            suppressing_s: spent_s(Activity::Suppressing),
            standing_s: spent_s(Activity::Standing),
            waiting_s: spent_s(Activity::Waiting),
            refilling_s: spent_s(Activity::Refilling),
            stuck_s: self.stuck.as_seconds(),
            longest_idle_s: self.longest_idle.as_seconds(),
            idle_s: self.without_work.as_seconds(),
            out_of_reach: self.out_of_reach.len() as u32 + self.ground_out_of_reach.cells.len() as u32,
            ..self.outcome
        };
        (self.history, outcome)
    }

    /// Counts the cusps of the present leg as far as it was followed.
    fn end_leg(&mut self, now: SimTime) {
        if let Some(&leg) = self.history.legs.last() {
            self.outcome.cusps += cusps_between(leg.trajectory(self.timeline), leg.from, now);
        }
    }

    /// Counts the present drive as wasted if it has set out.
    fn end_drive(&mut self, now: SimTime) {
        let Some(drive) = self.drive.take().filter(|drive| drive.sets_out < now) else { return };
        self.outcome.wasted_drives += 1;
        self.outcome.hopeless_drives += u32::from(drive.is_hopeless);
    }

    /// Returns true if a bush burns out before a truck that arrives at this time could have put it out.
    fn is_hopeless(&self, goal: Cell, arrives: SimTime, bushes: &[BushState]) -> bool {
        let setting = &self.timeline.setting;
        setting.bush_index(goal).is_some_and(|bush| setting.rules.is_hopeless(bushes[bush], arrives))
    }

    /// Records that another truck's goal is near the one just chosen.
    pub fn record_flock(&mut self) {
        self.outcome.flocked_goals += 1;
    }

    fn count_failure(&mut self, reason: PlanFailure) {
        self.outcome.failures[reason] += 1;
    }

    /// Returns whether there is something to act on anywhere, and in this agent's reach: for a Wumpus bushes, for a truck
    /// whatever burns.
    fn left_to_do(&self, around: &Surroundings<'_>) -> (bool, bool) {
        if !self.is_truck() {
            let lightable = around.bushes.lightable(self.timeline.setting.rules.reignition);
            // A wet bush that is out of reach is in both counts, and is taken off once.
            let wet_in_reach =
                around.wet_bushes.iter().filter(|&bush| !self.out_of_reach.contains(bush)).count() as u32;
            let dry = lightable - around.wet_bushes.len() as u32;
            return (dry > 0, lightable > self.lightable_out_of_reach + wet_in_reach);
        }
        let burning = around.bushes.burning() + around.burning_ground;
        let taken = around.others_goals().count() as u32;
        let rules_nothing_out = self.out_of_reach.is_empty() && self.ground_out_of_reach.cells.is_empty();
        let taken_in_reach = if rules_nothing_out {
            taken
        } else {
            around.others_goals().filter(|&goal| !self.is_out_of_reach(goal)).count() as u32
        };
        let free = burning.saturating_sub(taken);
        let out_of_reach = self.burning_out_of_reach + self.ground_out_of_reach.burning_at(around.now);
        let free_in_reach = burning.saturating_sub(out_of_reach + taken_in_reach);
        (free > 0, free_in_reach > 0)
    }

    fn is_out_of_reach(&self, cell: Cell) -> bool {
        match self.timeline.setting.bush_index(cell) {
            Some(bush) => self.out_of_reach.contains(&bush),
            None => self.ground_out_of_reach.cells.contains(&(cell.row, cell.col)),
        }
    }

    fn rule_out(&mut self, cells: &[Cell], setting: &Setting, bushes: &[BushState]) {
        if let Some(ground) = self.ground {
            self.ground_out_of_reach.add(cells.iter().copied(), ground);
        }
        for bush in cells.iter().filter_map(|&cell| setting.bush_index(cell)) {
            if self.out_of_reach.insert(bush) {
                self.burning_out_of_reach += u32::from(bushes[bush].burns());
                self.lightable_out_of_reach += u32::from(bushes[bush].can_ignite(setting.rules.reignition));
            }
        }
    }

    fn count_plan(&mut self, now: SimTime, effort: Effort) {
        let Effort { roadmap_expansions, local_expansions } = effort;
        let stats = &mut self.history.step(now).stats;
        stats.plans += 1;
        stats.expansions += u64::from(roadmap_expansions) + u64::from(local_expansions);
        self.outcome.roadmap_expansions += u64::from(roadmap_expansions);
        self.outcome.local_expansions += u64::from(local_expansions);
    }
}

/// Changes between forward and reverse at or after `from` and before `until`.
fn cusps_between(leg: &Trajectory, from: SimTime, until: SimTime) -> u32 {
    let from_s = from.since(leg.start_time()).as_seconds();
    let until_s = until.since(leg.start_time()).as_seconds();
    let mut begins_s = 0.0;
    let mut reverse = None;
    let mut cusps = 0;
    for piece in leg.pieces() {
        if let Piece::Drive { segment, .. } = piece {
            let changes = reverse.is_some_and(|last| last != segment.is_reverse());
            cusps += u32::from(changes && (from_s..until_s).contains(&begins_s));
            reverse = Some(segment.is_reverse());
        }
        begins_s += piece.duration_s();
    }
    cusps
}
