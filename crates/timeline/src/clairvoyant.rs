//! A lower bound of the losses of any dispatcher: those of one that knows from the start where and when everything is
//! lit.
//!
//! What was lit in a run, by Wumpuses and by the scenario, is taken as given. The bound holds for all that trucks with
//! these starts, speeds, reach and dwell could do about it, because every step of it errs on their side. Ways are straight and
//! driven at full speed, trucks wait where they will be needed, and two relaxations look at what is left:
//!
//! 1. *How near is the nearest truck at the start?* In a world where a truck stands at every fire as soon as one can be there,
//!    all burns less, and later, than in any other. What catches fire there by spread, and burns out before the first
//!    truck can be there, is lost in every world.
//! 2. *How many trucks are there?* Two of the things that were lit can be put out by one truck only if it can get from one to the
//!    other, in one order or the other, while both may burn. A truck that puts out several puts out a chain of such pairs, by time of
//!    lighting; so what so many chains as there are trucks cannot cover is lost. That is a flow problem, solved exactly.
//!
//! The second step leaves out that chains have to fit as a whole and what spreads meanwhile, so the bound is below what the best
//! dispatcher would lose, and often zero.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use super::{BushIgnition, Cause, Fact, FireFact, Role, Setting, Timeline};
use wildfire_base::geometry::DVec2;
use wildfire_base::time::SimTime;
use wildfire_fire::FireRules;

/// Times that differ by less are one time; a bound must not hang on rounding.
const TOLERANCE_S: f64 = 1e-6;
/// Distances between cell centres are exact multiples of the cell size; this absorbs the rounding of their product.
const RADIUS_TOLERANCE: f64 = 1e-9;
/// Of more ignitions than this the second relaxation only asks which of them no truck can reach: chains take time with the
/// square of them.
const MAX_CHAINED: usize = 400;
/// And of more pairs of them than this for all trucks together.
const MAX_PAIRS: usize = 1 << 23;
/// Bushes that spreading looks at before it is left out.
const MAX_EXAMINED: usize = 1 << 24;

/// Returns the number of bushes that burn out or burn at the end, at least, whatever the trucks of this run do: if all is lit
/// where and when it was. `None` where only another rule than that of the radius says how fire goes on, where what was put out
/// can burn again, where fire takes whole pieces, or where a recording does not say what trucks can do.
pub fn min_loss(timeline: &Timeline) -> Option<u32> {
    let setting = &timeline.setting;
    // Where fire may come again a fire that is put out is not over, and the bound would not hold.
    let fire = setting.rules.fire.filter(|fire| !fire.reignition)?;
    // A stop that saves a whole piece saves more than the bound counts.
    if setting.spread.is_some() || setting.rules.reignition || !setting.pieces.is_empty() {
        return None;
    }
    let trucks = setting.agents.iter().filter(|agent| agent.id.role == Role::Unimog).map(|start| {
        let limits = start.limits?;
        let centre = start.body.centre(start.pose);
        // The body's middle may move by that much while the axle stands.
        let swing_m = 2.0 * (centre - start.pose.position()).length();
        Some(TruckBound { start: centre, speed_mps: limits.forward_mps.max(limits.reverse_mps), swing_m })
    });
    let trucks = trucks.collect::<Option<Vec<TruckBound>>>()?;
    let acts = source_ignitions(timeline);
    // Without trucks the run itself shows what is lost.
    if trucks.is_empty() {
        let caught = timeline.events.iter().filter(|event| matches!(event.fact, Fact::Fire(FireFact::Ignited { .. })));
        return Some(caught.count() as u32);
    }
    let limits = TruckLimits::new(setting, fire, trucks);
    let jobs = limits.jobs(&acts);
    Some(limits.lost_to_spread(&jobs) + limits.left_uncovered(&jobs))
}

/// Lists what was lit, by Wumpuses and the scenario, in order of time.
fn source_ignitions(timeline: &Timeline) -> Vec<(usize, SimTime)> {
    let ignitions = timeline.events.iter().filter_map(|event| match event.fact.ignition()? {
        BushIgnition { cell, cause: Cause::Agent(_) | Cause::Scheduled } => {
            Some((timeline.setting.bush_index(cell)?, event.time))
        }
        _ => None,
    });
    ignitions.collect()
}

/// A truck as far as it limits what can be saved.
#[derive(Clone, Copy, Debug)]
struct TruckBound {
    /// The middle of its body.
    start: DVec2,
    speed_mps: f64,
    /// The middle of the body may gain this way on the rear axle, whose speed is limited, by turning round.
    swing_m: f64,
}

/// Something that was lit, and when a truck may be of use there.
#[derive(Clone, Copy, Debug)]
struct Job {
    /// Its place among the bushes.
    bush: usize,
    place: DVec2,
    ignited: SimTime,
    /// The earliest time at which it may burn in any world: it may catch fire before it is lit.
    burns_from_s: f64,
    /// When it is burned out, or the run over, in any world.
    due_s: f64,
    /// The earliest time at which a truck can be in reach.
    arrival_s: f64,
}

impl Job {
    /// Returns whether it is certain that it is lit, and has not caught fire before.
    fn is_surely_ignited(&self) -> bool {
        self.burns_from_s == f64::INFINITY
    }

    /// The earliest time at which it may burn, lit or caught.
    fn first_burns_s(&self) -> f64 {
        self.burns_from_s.min(self.ignited.as_seconds())
    }
}

/// The rules, and what they allow.
struct TruckLimits<'a> {
    setting: &'a Setting,
    fire: FireRules,
    trucks: Vec<TruckBound>,
    fastest_mps: f64,
    widest_swing_m: f64,
    reach_m: f64,
    dwell_s: f64,
    end_s: f64,
    /// True if a stop may put out more than one.
    extinguish_all: bool,
}

impl<'a> TruckLimits<'a> {
    fn new(setting: &'a Setting, fire: FireRules, trucks: Vec<TruckBound>) -> Self {
        let rules = &setting.rules;
        Self {
            setting,
            fire,
            fastest_mps: trucks.iter().map(|truck| truck.speed_mps).fold(0.0, f64::max),
            widest_swing_m: trucks.iter().map(|truck| truck.swing_m).fold(0.0, f64::max),
            trucks,
            reach_m: rules.suppression_reach_m.unwrap_or(f64::INFINITY),
            dwell_s: rules.suppression_dwell.as_seconds(),
            end_s: rules.duration.as_seconds(),
            // What a recording does not say is taken in the trucks' favour.
            extinguish_all: rules.extinguishes_all.unwrap_or(true),
        }
    }

    /// True if what is lit ever sets anything on fire: burn-out comes before spread.
    fn spreads(&self) -> bool {
        self.fire.sources_spread && self.fire.burn_out.is_none_or(|span| span > self.fire.spread_delay)
    }

    fn jobs(&self, acts: &[(usize, SimTime)]) -> Vec<Job> {
        let place = |bush: usize| self.setting.frame.centre(self.setting.bushes[bush]);
        let delay_s = self.fire.spread_delay.as_seconds();
        // Fire goes from one to another in steps of the radius at most, each after the delay, if what caught fire spreads on.
        let arrives_s = |from: DVec2, ignited: SimTime, to: DVec2| {
            let steps = ((to - from).length() / self.fire.spread_radius_m - RADIUS_TOLERANCE).ceil().max(1.0);
            let is_possible = self.spreads() && (steps <= 1.0 || self.fire.caught_spreads);
            if is_possible { ignited.as_seconds() + steps * delay_s } else { f64::INFINITY }
        };
        let places: Vec<DVec2> = acts.iter().map(|&(bush, _)| place(bush)).collect();
        let is_small = acts.len() <= MAX_CHAINED;
        (0..acts.len())
            .map(|number: usize| {
                let (bush, ignited) = acts[number];
                // What is lit later spreads later, so only those before matter; of too many it is taken for granted that they do.
                let before = (0..number).map(|other| arrives_s(places[other], acts[other].1, places[number]));
                let first_s = if is_small { before.fold(f64::INFINITY, f64::min) } else { f64::NEG_INFINITY };
                let burns_from_s = if first_s <= ignited.as_seconds() + TOLERANCE_S { first_s } else { f64::INFINITY };
                let place = places[number];
                let arrival_s = self.first_arrival_s(places[number]);
                Job { bush, place, ignited, burns_from_s, due_s: self.due_s(ignited), arrival_s }
            })
            .collect()
    }

    /// When a fire is beyond saving that began at this time, or before.
    fn due_s(&self, ignited: SimTime) -> f64 {
        self.fire.burn_out.map_or(self.end_s, |span| self.end_s.min((ignited + span).as_seconds()))
    }

    /// The earliest time at which a truck can be in reach of a place.
    fn arrival_s(&self, truck: &TruckBound, place: DVec2) -> f64 {
        travel_s((place - truck.start).length() - self.reach_m - truck.swing_m, truck.speed_mps)
    }

    fn first_arrival_s(&self, place: DVec2) -> f64 {
        self.trucks.iter().map(|truck| self.arrival_s(truck, place)).fold(f64::INFINITY, f64::min)
    }

    /// Counts the bushes that are not lit, but catch fire and burn out before any truck can be there.
    fn lost_to_spread(&self, jobs: &[Job]) -> u32 {
        if !self.spreads() {
            return 0;
        }
        let mut jobs_of: BTreeMap<usize, &Job> = BTreeMap::new();
        // Spread comes before ignition at one instant.
        let mut due: BinaryHeap<Reverse<(SimTime, bool, usize)>> = BinaryHeap::new();
        for job in jobs {
            jobs_of.insert(job.bush, job);
            due.push(Reverse((job.ignited, true, job.bush)));
        }
        let mut caught = BTreeSet::new();
        let mut lost = 0;
        let mut examined = 0;
        while let Some(Reverse((now, is_source, bush))) = due.pop() {
            // What is not looked at counts as saved, so the bound holds.
            if now > self.setting.rules.duration || examined > MAX_EXAMINED {
                break;
            }
            let ignited: Vec<usize> = if is_source { vec![bush] } else { self.within_radius(bush, &mut examined) };
            for bush in ignited {
                // A bush catches fire once here.
                if !caught.insert(bush) {
                    continue;
                }
                let place = self.setting.frame.centre(self.setting.bushes[bush]);
                let arrival_s = self.first_arrival_s(place);
                // Bushes that were lit are counted by `left_uncovered`, each in one of both.
                if !jobs_of.contains_key(&bush) {
                    lost += u32::from(arrival_s + self.dwell_s > self.due_s(now) + TOLERANCE_S);
                }
                // Where only what was lit spreads, it does not if in another world it has caught fire before.
                let goes_on = if is_source {
                    self.fire.caught_spreads || jobs_of.get(&bush).is_some_and(|job| job.is_surely_ignited())
                } else {
                    self.fire.caught_spreads
                };
                let out_s = arrival_s.max(now.as_seconds()) + self.dwell_s;
                let spreads_at = now + self.fire.spread_delay;
                // Even the nearest truck would come too late to keep it from spreading.
                if goes_on && out_s > spreads_at.as_seconds() + TOLERANCE_S {
                    due.push(Reverse((spreads_at, false, bush)));
                }
            }
        }
        lost
    }

    /// Lists the bushes that one sets on fire.
    fn within_radius(&self, from: usize, examined: &mut usize) -> Vec<usize> {
        let bushes = &self.setting.bushes;
        let frame = &self.setting.frame;
        let centre = frame.centre(bushes[from]);
        let radius_m = self.fire.spread_radius_m * (1.0 + RADIUS_TOLERANCE);
        let rows = (radius_m / frame.cell_m).ceil().min(f64::from(u16::MAX)) as u16;
        // Bushes come row by row, so those of the rows in reach are one slice.
        let first = bushes.partition_point(|bush| bush.row < bushes[from].row.saturating_sub(rows));
        let last = bushes.partition_point(|bush| bush.row <= bushes[from].row.saturating_add(rows));
        *examined += last - first;
        (first..last).filter(|&bush| (frame.centre(bushes[bush]) - centre).length() <= radius_m).collect()
    }

    /// Counts the jobs that cannot all be covered by chains, one for each truck.
    fn left_uncovered(&self, jobs: &[Job]) -> u32 {
        let can_begin = |truck: &TruckBound, job: &Job| {
            self.arrival_s(truck, job.place).max(job.first_burns_s()) + self.dwell_s <= job.due_s + TOLERANCE_S
        };
        let reachable: Vec<Job> =
            jobs.iter().copied().filter(|job| self.trucks.iter().any(|truck| can_begin(truck, job))).collect();
        let out_of_reach = (jobs.len() - reachable.len()) as u32;
        let pairs = reachable.len() * reachable.len() * self.trucks.len();
        // The matching grows with the cube; a weaker bound is still one.
        if reachable.len() > MAX_CHAINED || pairs > MAX_PAIRS {
            return out_of_reach;
        }
        let firsts: Vec<Vec<usize>> = self
            .trucks
            .iter()
            .map(|truck| (0..reachable.len()).filter(|&job| can_begin(truck, &reachable[job])).collect())
            .collect();
        let nexts: Vec<Vec<usize>> = (0..reachable.len())
            .map(|job| (job + 1..reachable.len()).filter(|&next| self.fit(&reachable[job], &reachable[next])).collect())
            .collect();
        out_of_reach + min_uncovered(&firsts, &nexts)
    }

    /// Returns whether one truck may put out both, in one order or the other.
    fn fit(&self, one: &Job, other: &Job) -> bool {
        let apart_m = (one.place - other.place).length() - 2.0 * self.reach_m;
        let way_s = travel_s(apart_m - self.widest_swing_m, self.fastest_mps);
        let done_s = |job: &Job| {
            if self.extinguish_all {
                // The dwell may have begun for another fire.
                job.first_burns_s().max(job.arrival_s + self.dwell_s)
            } else {
                job.first_burns_s().max(job.arrival_s) + self.dwell_s
            }
        };
        let in_turn = |first: &Job, next: &Job| done_s(first) + way_s + self.dwell_s <= next.due_s + TOLERANCE_S;
        let at_once = self.extinguish_all
            && apart_m <= 0.0
            && one.first_burns_s().max(other.first_burns_s()) <= one.due_s.min(other.due_s) + TOLERANCE_S;
        at_once || in_turn(one, other) || in_turn(other, one)
    }
}

fn travel_s(metres: f64, speed_mps: f64) -> f64 {
    // At no speed a way takes forever, which dividing by zero says.
    if metres > 0.0 { metres / speed_mps.max(0.0) } else { 0.0 }
}

/// Returns the least number of nodes that chains leave uncovered, one chain for each of `firsts`, which lists where it may
/// begin; `nexts` lists where a chain may go on from each node, always to a later one. No node is on two chains.
///
/// It is a matching of least cost: each node is matched with the node or the chain that it follows, or with itself, at a
/// cost of 1, if it is left out. Without chains all are left out. Each chain is one more to be followed, and shortest
/// augmenting paths keep the cost least.
fn min_uncovered(firsts: &[Vec<usize>], nexts: &[Vec<usize>]) -> u32 {
    let count = nexts.len();
    let followers =
        |leader: usize| -> &[usize] { if leader < count { &nexts[leader] } else { &firsts[leader - count] } };
    // Leaders are the nodes, and after them the chains.
    let mut leader_of: Vec<usize> = (0..count).collect();
    let mut left = count as u32;
    for chain in count..count + firsts.len() {
        if left == 0 {
            break;
        }
        // The cost of freeing each leader for the chain that comes in, and whose follower passes on to whom.
        let mut costs = vec![i32::MAX; count + firsts.len()];
        let mut passed_on: Vec<Option<(usize, usize)>> = vec![None; costs.len()];
        costs[chain] = 0;
        // In rounds, as in Bellman and Ford's algorithm: Dijkstra's does not admit the cost of -1.
        let mut changed = vec![chain];
        while !changed.is_empty() {
            let mut next_changed = Vec::new();
            for &leader in &changed {
                let itself = (leader < count).then_some(leader);
                for node in followers(leader).iter().copied().chain(itself) {
                    let freed = leader_of[node];
                    if freed == leader {
                        continue;
                    }
                    // 1 if this leaves a node out, -1 if it takes one in that was left out.
                    let cost = costs[leader] + i32::from(leader == node) - i32::from(freed == node);
                    if cost < costs[freed] {
                        (costs[freed], passed_on[freed]) = (cost, Some((node, leader)));
                        next_changed.push(freed);
                    }
                }
            }
            next_changed.sort_unstable();
            // Several may lower the cost of the same leader.
            next_changed.dedup();
            changed = next_changed;
        }
        // The first of equal ones, so that the answer does not depend on the machine.
        let cheapest = (0..costs.len()).min_by_key(|&leader| costs[leader]).unwrap_or(chain);
        let mut freed = cheapest;
        // At a cost of 0 the chain would only take the place of another.
        while let Some((node, leader)) = passed_on[freed].filter(|_| costs[cheapest] < 0) {
            leader_of[node] = leader;
            freed = leader;
        }
        left = (0..count).filter(|&node| leader_of[node] == node).count() as u32;
    }
    left
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::sample::{at, small_setting};
    use crate::{AgentId, Event, Outcome};
    use wildfire_base::geometry::{FieldFrame, Pose};
    use wildfire_base::rng;

    /// Fires that were lit at these times, on a field of 1 km under the rules of the contest.
    fn with_fires(trucks: &[(f64, f64)], acts: &[(f64, (u16, u16))], bushes: &[(u16, u16)]) -> Timeline {
        let ids: Vec<AgentId> = (0..trucks.len()).map(|number| AgentId::unimog(number as u16)).collect();
        let mut setting = small_setting(&ids);
        setting.frame = FieldFrame { cols: 200, rows: 200, cell_m: 5.0 };
        setting.bushes = acts
            .iter()
            .map(|&(_, cell)| cell)
            .chain(bushes.iter().copied())
            .map(wildfire_base::geometry::Cell::from)
            .collect();
        setting.bushes.sort_unstable_by_key(|cell| (cell.row, cell.col));
        setting.rules.duration = SimTime::from_seconds(3600.0);
        setting.rules.fire = Some(FireRules {
            spread_delay: SimTime::from_seconds(10.0),
            spread_radius_m: 30.0,
            sources_spread: true,
            caught_spreads: false,
            burn_out: Some(SimTime::from_seconds(60.0)),
            reignition: false,
        });
        for (agent, &(x, y)) in setting.agents.iter_mut().zip(trucks) {
            agent.pose = Pose::new(x, y, 0.0);
        }
        let fact = |cell: (u16, u16)| Fact::Fire(FireFact::Ignited { cell: cell.into(), cause: Cause::Scheduled });
        let mut events: Vec<Event> = acts.iter().map(|&(time_s, cell)| at(time_s, fact(cell))).collect();
        events.sort_by_key(|event| event.time);
        Timeline { setting, events, ground: Vec::new() }
    }

    #[test]
    fn what_no_truck_can_reach_in_time_is_lost_with_what_it_sets_on_fire() {
        let neighbours = [(180, 181), (186, 180), (187, 180)];
        let far = |time_s: f64| min_loss(&with_fires(&[(20.0, 20.0)], &[(time_s, (180, 180))], &neighbours));
        assert_eq!(far(0.0), Some(3), "1.2 km take longer than a minute; one bush lies beyond 30 m");
        assert_eq!(far(200.0), Some(0), "a truck that knows is there by then");
        // From about 154 s on a truck can be there: too late for what was lit, in time for some or all of its neighbours.
        assert_eq!((far(91.0), far(95.0)), (Some(2), Some(1)));
    }

    #[test]
    fn one_truck_cannot_be_at_two_places_at_once() {
        let acts = [(500.0, (10, 10)), (500.0, (190, 190))];
        assert_eq!(min_loss(&with_fires(&[(500.0, 500.0)], &acts, &[])), Some(1));
        assert_eq!(min_loss(&with_fires(&[(500.0, 500.0), (510.0, 500.0)], &acts, &[])), Some(0));
        let apart = [(500.0, (10, 10)), (700.0, (190, 190))];
        assert_eq!(min_loss(&with_fires(&[(500.0, 500.0)], &apart, &[])), Some(0));
    }

    #[test]
    fn without_trucks_all_is_lost() {
        let timeline = with_fires(&[], &[(1.0, (10, 10)), (2.0, (50, 50))], &[(90, 90)]);
        assert_eq!(min_loss(&timeline), Some(2));
        assert_eq!(Outcome::new(&timeline).burned(), 2);
    }

    /// The most nodes that chains cover, by trying for each node in turn to end every chain with it, or to leave it.
    fn max_covered(firsts: &[Vec<usize>], nexts: &[Vec<usize>], ends: &mut Vec<Option<usize>>, node: usize) -> u32 {
        if node == nexts.len() {
            return 0;
        }
        let mut max = max_covered(firsts, nexts, ends, node + 1);
        for chain in 0..firsts.len() {
            let end = ends[chain];
            if end.map_or(&firsts[chain], |end| &nexts[end]).contains(&node) {
                ends[chain] = Some(node);
                max = max.max(1 + max_covered(firsts, nexts, ends, node + 1));
                ends[chain] = end;
            }
        }
        max
    }

    #[test]
    fn no_chains_leave_less_uncovered() {
        let mut rng = rng::stream(1, "chains");
        for _ in 0..300 {
            let count = rng.random_range(0..9);
            let chains = rng.random_range(0..4);
            let share = rng.random_range(0.1..0.7);
            let mut some = |from: usize| (from..count).filter(|_| rng.random_bool(share)).collect::<Vec<usize>>();
            let nexts: Vec<_> = (0..count).map(|node| some(node + 1)).collect();
            let firsts: Vec<_> = (0..chains).map(|_| some(0)).collect();
            let covered = max_covered(&firsts, &nexts, &mut vec![None; chains], 0);
            assert_eq!(min_uncovered(&firsts, &nexts), count as u32 - covered, "{firsts:?} {nexts:?}");
        }
    }

    /// The most fires that trucks can put out if all they do is known, ways are straight, and nothing spreads: every order of
    /// every share of the fires for each truck.
    fn max_saved(
        limits: &TruckLimits<'_>,
        jobs: &[Job],
        truck: usize,
        stands: Option<(DVec2, f64)>,
        taken: u32,
    ) -> u32 {
        let Some(reacher) = limits.trucks.get(truck) else { return 0 };
        let mut max = max_saved(limits, jobs, truck + 1, None, taken);
        for (number, job) in jobs.iter().enumerate().filter(|(number, _)| taken & (1 << number) == 0) {
            let arrives_s = match stands {
                None => limits.arrival_s(reacher, job.place),
                // It stands at the fire itself, not at its near side: that is no better than the best.
                Some((place, free_s)) => {
                    free_s + travel_s((job.place - place).length() - limits.reach_m, reacher.speed_mps)
                }
            };
            let out_s = arrives_s.max(job.ignited.as_seconds()) + limits.dwell_s;
            if out_s <= job.due_s {
                let rest = max_saved(limits, jobs, truck, Some((job.place, out_s)), taken | (1 << number));
                max = max.max(1 + rest);
            }
        }
        max
    }

    #[test]
    fn the_bound_is_no_more_than_the_best_of_all_routes_loses() {
        let mut rng = rng::stream(2, "routes");
        let (mut bound_sum, mut loss_sum) = (0, 0);
        for _ in 0..150 {
            let mut coordinate = || f64::from(rng.random_range(10..990_i32));
            let trucks: Vec<(f64, f64)> = (0..2).map(|_| (coordinate(), coordinate())).collect();
            let trucks = &trucks[..rng.random_range(1..=2)];
            let mut acts: Vec<(f64, (u16, u16))> = Vec::new();
            while acts.len() < 5 {
                let cell: (u16, u16) = (rng.random_range(0..200), rng.random_range(0..200));
                let time_s = rng.random_range(0.0..120.0);
                if acts.iter().all(|(_, other)| cell.0.abs_diff(other.0) + cell.1.abs_diff(other.1) > 12) {
                    acts.push((time_s, cell));
                }
            }
            let timeline = with_fires(trucks, &acts, &[]);
            let bound = min_loss(&timeline).expect("the rules are those of the radius");
            let reachers = timeline.setting.agents.iter().map(|start| TruckBound {
                start: start.body.centre(start.pose),
                speed_mps: 8.0,
                swing_m: 0.0,
            });
            let fire = timeline.setting.rules.fire.expect("it is set");
            let limits = TruckLimits::new(&timeline.setting, fire, reachers.collect());
            let jobs = limits.jobs(&source_ignitions(&timeline));
            let loss = 5 - max_saved(&limits, &jobs, 0, None, 0);
            assert!(bound <= loss, "{bound} > {loss}: {trucks:?} {acts:?}");
            (bound_sum, loss_sum) = (bound_sum + bound, loss_sum + loss);
        }
        assert!(2 * bound_sum > loss_sum, "the bound says little: {bound_sum} of {loss_sum}");
    }
}
