//! The books that [`super::Outcome`] is read from: what happened to the bushes, and what each agent did.
//!
//! Time is added up in whole nanoseconds and becomes seconds once, at the end.

use super::replay::BushChange;
use super::{Activity, AgentFact, AgentId, AgentOutcome, BushState, Event, Fact, FireFact, Outcome, Setting};
use crate::geometry::Cell;
use crate::planning::{Effort, FoundBy, PlanFailure};
use crate::time::SimTime;
use crate::trajectory::{Piece, Trajectory};

const NANOS_PER_SECOND: f64 = 1e9;

/// Counts of bushes, and what fire did to them.
#[derive(Debug)]
pub struct BushLedger {
    pub burning: u32,
    pub lightable: u32,
    relight: bool,
    peak_burning: u32,
    burning_cell_ns: u128,
    response_ns: u128,
    responses: u32,
    first_fire: Option<SimTime>,
    last_end_of_fire: Option<SimTime>,
}

impl BushLedger {
    pub fn new(setting: &Setting) -> Self {
        Self {
            burning: 0,
            lightable: setting.bushes.len() as u32,
            relight: setting.rules.relight,
            peak_burning: 0,
            burning_cell_ns: 0,
            response_ns: 0,
            responses: 0,
            first_fire: None,
            last_end_of_fire: None,
        }
    }

    pub fn record(&mut self, change: BushChange, now: SimTime) {
        self.burning = self.burning - u32::from(change.from.burns()) + u32::from(change.to.burns());
        self.lightable = self.lightable - u32::from(change.from.can_be_lit(self.relight))
            + u32::from(change.to.can_be_lit(self.relight));
        if change.to.burns() {
            self.first_fire = self.first_fire.or(Some(now));
        } else {
            self.last_end_of_fire = Some(now);
        }
        if let (BushState::Burning { since }, BushState::Extinguished) = (change.from, change.to) {
            self.response_ns += u128::from((now - since).as_nanos());
            self.responses += 1;
        }
    }

    pub fn end_instant(&mut self) {
        self.peak_burning = self.peak_burning.max(self.burning);
    }

    pub fn account(&mut self, span: SimTime) {
        self.burning_cell_ns += u128::from(self.burning) * u128::from(span.as_nanos());
    }

    /// Fills in the outcome's fields about bushes.
    pub fn conclude(&self, outcome: Outcome, bushes: &[BushState]) -> Outcome {
        let count = |what: BushState| bushes.iter().filter(|&&bush| bush == what).count() as u32;
        let mean_response_s = self.response_ns as f64 / NANOS_PER_SECOND / f64::from(self.responses);
        Outcome {
            obstacles: bushes.len() as u32,
            intact: count(BushState::Intact),
            burning: self.burning,
            burned_out: count(BushState::BurnedOut),
            extinguished: count(BushState::Extinguished),
            burning_cell_s: self.burning_cell_ns as f64 / NANOS_PER_SECOND,
            peak_burning: self.peak_burning,
            mean_response_s: (self.responses > 0).then_some(mean_response_s),
            first_fire_s: self.first_fire.map(SimTime::as_seconds),
            all_out_s: self.last_end_of_fire.filter(|_| self.burning == 0).map(SimTime::as_seconds),
            ..outcome
        }
    }
}

/// A truck's drive that may yet end in an extinction.
#[derive(Debug)]
struct PendingDrive {
    goal: Cell,
    sets_out: SimTime,
}

/// What one agent did so far.
#[derive(Debug)]
pub struct AgentLedger<'a> {
    outcome: AgentOutcome,
    relight: bool,
    /// By place among the bushes.
    out_of_reach: Vec<bool>,
    burning_out_of_reach: u32,
    lightable_out_of_reach: u32,
    /// By activity, in the order of its variants.
    spent: [SimTime; 5],
    stuck: SimTime,
    idle: SimTime,
    longest_idle: SimTime,
    /// The leg that the agent follows, and the time from which on it counts.
    leg: Option<(&'a Trajectory, SimTime)>,
    drive: Option<PendingDrive>,
}

impl<'a> AgentLedger<'a> {
    pub fn new(agent: AgentId, setting: &Setting) -> Self {
        Self {
            outcome: AgentOutcome::idle(agent),
            relight: setting.rules.relight,
            out_of_reach: vec![false; setting.bushes.len()],
            burning_out_of_reach: 0,
            lightable_out_of_reach: 0,
            spent: [SimTime::ZERO; 5],
            stuck: SimTime::ZERO,
            idle: SimTime::ZERO,
            longest_idle: SimTime::ZERO,
            leg: None,
            drive: None,
        }
    }

    pub fn is_truck(&self) -> bool {
        self.outcome.agent.role.suppresses()
    }

    pub fn record_change(&mut self, BushChange { bush, from, to }: BushChange) {
        if self.out_of_reach[bush] {
            self.burning_out_of_reach = self.burning_out_of_reach - u32::from(from.burns()) + u32::from(to.burns());
            self.lightable_out_of_reach = self.lightable_out_of_reach - u32::from(from.can_be_lit(self.relight))
                + u32::from(to.can_be_lit(self.relight));
        }
    }

    /// Books a fact of this agent's.
    pub fn record_fact(&mut self, event: &'a Event, setting: &Setting, bushes: &[BushState]) {
        let now = event.time;
        match &event.fact {
            Fact::Agent(_, AgentFact::RoadmapBuilt { samples, edges, components, .. }) => {
                self.outcome.roadmap_samples = *samples;
                self.outcome.roadmap_edges = *edges;
                self.outcome.roadmap_components = *components;
            }
            Fact::Agent(_, AgentFact::OutOfReach { cells, .. }) => self.rule_out(cells, setting, bushes),
            Fact::Agent(_, AgentFact::Planned { goal, trajectory, effort, found_by, .. }) => {
                self.count_plan(*effort);
                self.outcome.lattice_plans += u32::from(found_by.is_some_and(FoundBy::is_after_failure));
                self.end_leg(now);
                self.end_drive(now);
                self.leg = Some((trajectory, now));
                let drives = self.is_truck() && !trajectory.pieces().is_empty();
                self.drive = drives.then_some(PendingDrive { goal: *goal, sets_out: trajectory.sets_out_at() });
            }
            Fact::Agent(_, AgentFact::PlanFailed { reason, effort, .. }) => {
                self.count_plan(*effort);
                let place = PlanFailure::ALL.iter().position(|known| known == reason);
                self.outcome.failures[place.expect("all reasons are listed")] += 1;
            }
            Fact::Agent(_, AgentFact::LocalMinimum { .. }) => self.outcome.local_minima += 1,
            Fact::Agent(_, AgentFact::Dropped { trajectory, .. }) => {
                self.end_leg(now);
                self.end_drive(now);
                self.leg = Some((trajectory, now));
            }
            Fact::Agent(_, AgentFact::GaveWay { trajectory, .. }) => {
                self.outcome.deadlocks += 1;
                self.end_leg(now);
                self.leg = Some((trajectory, now));
            }
            Fact::Fire(FireFact::Ignited { .. }) => self.outcome.cells += 1,
            Fact::Fire(FireFact::Extinguished { cell, .. }) => {
                self.outcome.cells += 1;
                self.drive = self.drive.take().filter(|drive| drive.goal != *cell);
            }
            _ => {}
        }
    }

    /// Books a stretch of time; `others_goals` are burning bushes that other trucks go for, which only matter to a
    /// truck that stands.
    pub fn account(&mut self, span: SimTime, activity: Activity, bushes: &BushLedger, others_goals: &[usize]) {
        self.spent[activity as usize] += span;
        let (anything, in_reach) = self.left_to_do(bushes, others_goals);
        let stands = activity == Activity::Standing;
        if stands && in_reach {
            self.stuck += span;
        }
        self.idle = if stands && anything { self.idle + span } else { SimTime::ZERO };
        self.longest_idle = self.longest_idle.max(self.idle);
    }

    /// Adds the part of the present leg that is done at `now`.
    pub fn end_leg(&mut self, now: SimTime) {
        if let Some((leg, from)) = self.leg.take() {
            self.outcome.distance_m += leg.distance_m(now) - leg.distance_m(from);
            self.outcome.cusps += cusps_between(leg, from, now);
        }
    }

    /// Gives up hope for the present drive.
    pub fn end_drive(&mut self, now: SimTime) {
        let set_out = self.drive.take().is_some_and(|drive| drive.sets_out < now);
        self.outcome.wasted_drives += u32::from(set_out);
    }

    pub fn conclude(self) -> AgentOutcome {
        let spent_s = |activity: Activity| self.spent[activity as usize].as_seconds();
        AgentOutcome {
            driving_s: spent_s(Activity::Driving),
            planning_s: spent_s(Activity::Planning),
            suppressing_s: spent_s(Activity::Suppressing),
            standing_s: spent_s(Activity::Standing),
            waiting_s: spent_s(Activity::Waiting),
            stuck_s: self.stuck.as_seconds(),
            longest_idle_s: self.longest_idle.as_seconds(),
            out_of_reach: self.out_of_reach.iter().filter(|&&ruled_out| ruled_out).count() as u32,
            ..self.outcome
        }
    }

    /// Whether there is a bush to act on anywhere, and in this agent's reach.
    fn left_to_do(&self, bushes: &BushLedger, others_goals: &[usize]) -> (bool, bool) {
        if !self.is_truck() {
            return (bushes.lightable > 0, bushes.lightable > self.lightable_out_of_reach);
        }
        let taken_in_reach = others_goals.iter().filter(|&&bush| !self.out_of_reach[bush]).count() as u32;
        let free = bushes.burning - others_goals.len() as u32;
        let free_in_reach = bushes.burning - self.burning_out_of_reach - taken_in_reach;
        (free > 0, free_in_reach > 0)
    }

    fn rule_out(&mut self, cells: &[Cell], setting: &Setting, bushes: &[BushState]) {
        for bush in cells.iter().filter_map(|&cell| setting.bush_index(cell)) {
            if !std::mem::replace(&mut self.out_of_reach[bush], true) {
                self.burning_out_of_reach += u32::from(bushes[bush].burns());
                self.lightable_out_of_reach += u32::from(bushes[bush].can_be_lit(self.relight));
            }
        }
    }

    fn count_plan(&mut self, effort: Effort) {
        self.outcome.plans += 1;
        self.outcome.roadmap_expansions += u64::from(effort.roadmap_expansions);
        self.outcome.local_expansions += u64::from(effort.local_expansions);
    }
}

/// Changes between forward and reverse at or after `from` and before `until`.
fn cusps_between(leg: &Trajectory, from: SimTime, until: SimTime) -> u32 {
    let (from_s, until_s) = (from.since(leg.start_time()).as_seconds(), until.since(leg.start_time()).as_seconds());
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
