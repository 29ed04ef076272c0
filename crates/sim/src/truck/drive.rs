//! How a truck gets to a goal: by its planner, by the reachability flood, or around the trucks that block it.

use super::tracks::RetracedPath;
use super::{Blocked, Drive, Truck};
use crate::recorder::Recorder;
use crate::run::AgentCost;
use crate::traffic::{Meeting, Traffic, after_waiting};
use wildfire_base::geometry::{Cell, FieldFrame, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_base::trajectory::Trajectory;
use wildfire_planning::traffic::{BlockedLeg, plan_among, replan_around};
use wildfire_planning::{
    CpuSource, Effort, Found, FoundBy, GoalDisc, NearestPlan, Plan, PlanFailure, QueryMonitor, QueryRecord,
    plan_to_nearest,
};
use wildfire_scenario::TrafficPlan;

/// Legs that a truck backs out of a pocket before it goes all the way back to its start.
const BACKED_OUT_LEGS: usize = 8;

/// Where a scenario has no rule of distance, the flood still drives this near to the fire: the contest's reach.
const REACH_WITHOUT_RULE_M: f64 = 10.0;

/// The position and the field from which a truck plans.
#[derive(Clone, Copy, Debug)]
pub struct DepartureContext<'a> {
    pub now: SimTime,
    pub pose: Pose,
    pub frame: &'a FieldFrame,
    pub traffic: Traffic<'a>,
    /// The planning time of its team that delays its departure.
    pub delay: SimTime,
}

/// A drive, and its leg.
#[derive(Debug)]
pub struct Departure {
    pub drive: Drive,
    pub leg: Trajectory,
}

impl Truck {
    fn disc(&self, frame: &FieldFrame, cell: Cell) -> GoalDisc {
        GoalDisc { centre: frame.centre(cell), radius_m: self.reach_m }
    }

    /// Plans a drive to a goal, or returns why there is none and what that took.
    ///
    /// `spent` is the effort so far of this decision's plans that other trucks were in the way of; it is passed on.
    pub fn plan(
        &mut self,
        goal: Cell,
        outset: DepartureContext<'_>,
        spent: &mut Effort,
        cost: &mut AgentCost,
        recorder: &mut Recorder,
    ) -> Result<Drive, (PlanFailure, Effort)> {
        let disc = self.disc(outset.frame, goal);
        let Found { path, by: found_by } = self.query(disc, outset, spent, cost, recorder)?;
        Ok(Drive { goal, path, back_m: 0.0, effort: *spent, found_by })
    }

    /// Plans a drive to whichever of some goals is nearest by drive, likewise. `None` if no path leads to any.
    pub fn plan_to_nearest(
        &mut self,
        goals: &[Cell],
        outset: DepartureContext<'_>,
        spent: &mut Effort,
        cost: &mut AgentCost,
        recorder: &mut Recorder,
    ) -> Option<Drive> {
        let discs: Vec<GoalDisc> = goals.iter().map(|&goal| self.disc(outset.frame, goal)).collect();
        let mut monitor = QueryMonitor::new(recorder.records_searches);
        let planner = &mut **self.planner.lock();
        let NearestPlan { index, plan } = plan_to_nearest(planner, &self.body, outset.pose, &discs, &mut monitor)?;
        let Found { path, by: found_by } = finish_query(plan, monitor, outset.now, spent, cost, recorder).ok()?;
        Some(Drive { goal: goals[index], path, back_m: 0.0, effort: *spent, found_by })
    }

    /// Asks the planner for a path to a disc, likewise.
    pub fn query(
        &mut self,
        disc: GoalDisc,
        outset: DepartureContext<'_>,
        spent: &mut Effort,
        cost: &mut AgentCost,
        recorder: &mut Recorder,
    ) -> Result<Found, (PlanFailure, Effort)> {
        let mut monitor = QueryMonitor::new(recorder.records_searches);
        let plan = self.planner.lock().plan_observed(outset.pose, disc.into(), &mut monitor);
        finish_query(plan, monitor, outset.now, spent, cost, recorder).map_err(|reason| (reason, std::mem::take(spent)))
    }

    /// Finds a drive to a goal that the planner failed on; `None` if the reachability flood does not reach it.
    pub fn plan_by_flood(&mut self, goal: Cell, outset: DepartureContext<'_>, cost: &mut AgentCost) -> Option<Drive> {
        let mut stopwatch = CpuStopwatch::start();
        let drive = self.find_by_flood(goal, outset, cost);
        cost.reachability += stopwatch.elapsed_since_last();
        drive
    }

    fn find_by_flood(&mut self, goal: Cell, outset: DepartureContext<'_>, cost: &mut AgentCost) -> Option<Drive> {
        let DepartureContext { pose, frame, .. } = outset;
        let disc = self.disc(frame, goal);
        let near = if disc.radius_m.is_finite() { disc } else { GoalDisc { radius_m: REACH_WITHOUT_RULE_M, ..disc } };
        // The flood is exact enough for a no: then no search is tried.
        if !self.reachability.lock().reaches(near) {
            return None;
        }
        let mut effort = Effort::default();
        let path = self.reachability.lock().search(pose, near, &mut effort.local_expansions);
        if let Some(path) = path {
            return Some(Drive { goal, path, back_m: 0.0, effort, found_by: FoundBy::Reachability });
        }
        // Where it cannot turn it came in another way: back along its own tracks to where one of the last legs began, and
        // planned from there. The planner keeps to the scenario's rule, so it may end farther away where there is none.
        for legs in 1..=self.tracks.legs().min(BACKED_OUT_LEGS) {
            let plan = self.planner.lock().plan(self.tracks.start_of_last(legs), disc.into());
            effort += plan.effort;
            // What this thread did is in the time of the whole.
            if let Some(cpu) = plan.cpu.filter(|cpu| cpu.source != CpuSource::Thread) {
                cost.add_query(cpu);
            }
            if let Ok(path) = plan.path {
                let RetracedPath { path, back_m } = self.tracks.retrace(pose, legs, path);
                return Some(Drive { goal, path, back_m, effort, found_by: FoundBy::BackingOut });
            }
        }
        let path = self.reachability.lock().path_to(near)?;
        let RetracedPath { path, back_m } = self.tracks.retrace(pose, self.tracks.legs(), path);
        Some(Drive { goal, path, back_m, effort, found_by: FoundBy::WayHome })
    }

    /// Returns the drive with its leg, which begins as soon as the other trucks allow.
    pub fn depart(&self, drive: Drive, outset: DepartureContext<'_>) -> Result<Departure, Blocked> {
        let ready = outset.now + outset.delay + self.charge(&drive.effort);
        let leg = self.leg(&drive.path, ready);
        match outset.traffic.departure(&self.body, &leg) {
            Ok(leg) => Ok(Departure { drive, leg }),
            Err(by) => Err(Blocked { drive, by }),
        }
    }

    /// Finds a drive to the same goal that the trucks which block it leave free.
    pub fn detour(&mut self, blocked: &Drive, outset: DepartureContext<'_>, cost: &mut AgentCost) -> Option<Departure> {
        match self.traffic.plan {
            TrafficPlan::Alone => self.replan_around(blocked, outset, cost),
            TrafficPlan::Together => self.plan_among(blocked, outset, cost),
        }
    }

    /// Finds a drive to the same goal around the trucks that block it.
    fn replan_around(
        &mut self,
        blocked: &Drive,
        outset: DepartureContext<'_>,
        cost: &mut AgentCost,
    ) -> Option<Departure> {
        let disc = self.disc(outset.frame, blocked.goal);
        // Without a rule of distance there is no disc to plan into.
        if disc.radius_m.is_infinite() {
            return None;
        }
        let mut stopwatch = CpuStopwatch::start();
        // Only places matter here: what stands on the path stands there at any time.
        let leg = self.leg(&blocked.path, SimTime::ZERO);
        let free_m = outset.traffic.free_m(&self.body, &leg)?;
        let checker = outset.traffic.with_others_standing(&self.checker);
        let mut effort = blocked.effort;
        let path = replan_around(&checker, &blocked.path, free_m, disc, &mut effort);
        cost.local_search += stopwatch.elapsed_since_last();
        self.depart(Drive { path: path?, effort, ..blocked.clone() }, outset).ok()
    }

    /// Finds a drive to the same goal among the motions of the others, with the earliest arrival of those found.
    pub fn plan_among(
        &mut self,
        blocked: &Drive,
        outset: DepartureContext<'_>,
        cost: &mut AgentCost,
    ) -> Option<Departure> {
        let disc = self.disc(outset.frame, blocked.goal);
        if disc.radius_m.is_infinite() {
            return None;
        }
        let mut stopwatch = CpuStopwatch::start();
        let mut effort = blocked.effort;
        // As if nobody were there: it shows where the truck meets others, and when.
        let direct = self.leg(&blocked.path, outset.now + outset.delay + self.charge(&effort));
        let others = outset.traffic.predicted_for(&self.body);
        let mut found = Vec::new();
        for Meeting { wait_s, leg, meets_at } in outset.traffic.meetings(&self.body, &direct) {
            let blocked_leg = BlockedLeg { path: &blocked.path, leg: &leg, meets_at };
            let path = plan_among(&self.checker, &others, blocked_leg, &self.speed, disc, &mut effort);
            found.extend(path.map(|path| (path, wait_s)));
        }
        cost.local_search += stopwatch.elapsed_since_last();
        // Only now, when the effort of all searches is known, which delays every departure.
        let legs = found.into_iter().filter_map(|(path, wait_s)| {
            let leg = after_waiting(&self.leg(&path, outset.now + outset.delay + self.charge(&effort)), wait_s);
            let leg = outset.traffic.departure(&self.body, &leg).ok()?;
            Some(Departure { drive: Drive { path, effort, ..blocked.clone() }, leg })
        });
        // The first of equal ones, which waits least.
        legs.min_by_key(|departure| departure.leg.end_time())
    }
}

/// Books what a query took, and returns the path that it found.
fn finish_query(
    plan: Plan,
    monitor: QueryMonitor,
    now: SimTime,
    spent: &mut Effort,
    cost: &mut AgentCost,
    recorder: &mut Recorder,
) -> Result<Found, PlanFailure> {
    let QueryRecord { time, searches } = monitor.finish();
    match plan.cpu {
        // A planner that ran elsewhere says what it took; this thread only waited.
        Some(cpu) => cost.add_query(cpu),
        None => {
            cost.roadmap_search += time.roadmap;
            cost.local_search += time.local;
        }
    }
    // Failed plans too, as their effort is charged with the failure.
    *spent += plan.effort;
    recorder.record_searches(now, cost.agent, searches);
    match plan.path {
        Ok(path) => Ok(Found { path, by: plan.found_by.expect("a plan with a path says what found it") }),
        Err(reason) => {
            recorder.note_failure(now, cost.agent, reason, plan.message.as_deref());
            Err(reason)
        }
    }
}
