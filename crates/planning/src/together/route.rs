//! The route of one vehicle among the others' routes.
//!
//! Most vehicles need no search in space and time: their shortest drives past the standing obstacles are found once, and
//! only the waits along them depend on the others (path-velocity decomposition: K. Kant, S. Zucker, "Toward efficient
//! trajectory planning", International Journal of Robotics Research 5(3), 1986). The rest search over poses and steps
//! with Reeds-Shepp curves as heuristic and as last piece (hybrid A*: D. Dolgov et al., "Practical search techniques in
//! path planning for autonomous driving", 2008). A conflict costs metres instead of being forbidden, so that there is
//! always a route to repair.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

use super::world::{Motion, StaticMap, Traffic, steps_of};
use super::{CURVES, RADIUS_M, Route, STEP_M, Vehicle, step_price_m};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{CurvePrice, Segment};

/// The wait of a step.
const WAIT: Segment = Segment { curvature: 0.0, length_m: 0.0 };
/// Most drives that a vehicle keeps.
const MAX_DRIVES: usize = 8;
/// Most waits along a drive.
const MAX_WAITS: usize = 40;
/// Expansions between two looks at the limit.
const EXPANSIONS_A_LOOK: u32 = 16;
/// Nodes of one search with the same bin of place, heading and step compete.
const BIN_M: f64 = 1.0;
const HEADING_BINS: f64 = 18.0;
/// Curves tried from a node near the goal, where more than the shortest matter.
const NEAR_GOAL_M: f64 = 12.0;

/// A drive past the standing obstacles, without waits.
#[derive(Clone, Debug)]
pub struct StaticDrive {
    pub length_m: f64,
    start: Pose,
    motions: Vec<Motion>,
}

impl StaticDrive {
    fn new(start: Pose, steps: impl IntoIterator<Item = Segment>) -> Self {
        let mut from = start;
        let motions: Vec<Motion> = steps
            .into_iter()
            .map(|step| {
                let motion = Motion { from, step };
                from = step.end(from);
                motion
            })
            .collect();
        Self { length_m: motions.iter().map(|motion| motion.step.length_m.abs()).sum(), start, motions }
    }

    /// Returns the route without waits.
    pub fn route(&self) -> Route {
        Route { start: self.start, steps: self.motions.iter().map(|motion| motion.step).collect() }
    }

    /// Returns the pose after so many steps.
    fn pose(&self, at: usize) -> Pose {
        let last = self.motions.last().map_or(self.start, |motion| motion.step.end(motion.from));
        self.motions.get(at).map_or(last, |motion| motion.from)
    }
}

/// A route and its price: metres by [`Route::flowtime_m`] and the conflicts' penalties.
#[derive(Clone, Debug)]
pub struct CostedRoute {
    pub route: Route,
    pub price_m: f64,
}

/// What a vehicle meets: the others, the conflicts of arriving at any step, the metres that a conflict costs.
pub struct Others<'a> {
    pub traffic: &'a Traffic,
    pub at_goal: Vec<u32>,
    /// Whether the vehicle may wait at its start, which the benchmark does not compare with obstacles until then.
    pub may_wait_at_start: bool,
    pub penalty_m: f64,
}

impl Others<'_> {
    fn price_m(&self, at: usize, motion: &Motion) -> f64 {
        self.penalty_m * f64::from(self.traffic.conflicts(at, motion))
    }

    fn arrival_price_m(&self, at: usize) -> f64 {
        self.penalty_m * f64::from(self.at_goal[at.min(self.at_goal.len() - 1)])
    }
}

/// Finds the waits along a drive that cost the least, and less than `bound_m`.
///
/// Layers of one wait more each; a layer whose cheapest way on cannot win with a further wait is the last.
pub fn wait_along(drive: &StaticDrive, others: &Others, bound_m: f64) -> Option<CostedRoute> {
    let steps = drive.motions.len();
    // What is left to drive bounds every price from below.
    let mut ahead_m = vec![0.0; steps + 1];
    for at in (0..steps).rev() {
        ahead_m[at] = ahead_m[at + 1] + drive.motions[at].step.length_m.abs();
    }
    let mut prices = vec![f64::INFINITY; steps + 1];
    prices[0] = 0.0;
    let mut waited: Vec<Vec<bool>> = Vec::new();
    let (mut best_m, mut best_waits) = (bound_m, None);
    // A table of (steps driven, waits), a row of waits at a time.
    for waits in 0..=MAX_WAITS {
        let mut waited_at = vec![false; steps + 1];
        let mut min_m = f64::INFINITY;
        for at in 0..=steps {
            let arrived = at + waits;
            let mut price_m = if waits == 0 && at == 0 { 0.0 } else { f64::INFINITY };
            let may_wait = at > 0 || others.may_wait_at_start;
            // At the goal no wait is needed: arriving is priced for all time.
            if waits > 0 && at < steps && may_wait && prices[at] + STEP_M + ahead_m[at] < best_m {
                let motion = Motion::standing(drive.motions[at].from);
                price_m = prices[at] + STEP_M + others.price_m(arrived - 1, &motion);
                waited_at[at] = true;
            }
            if at > 0 && prices[at - 1] + ahead_m[at - 1] < best_m {
                let motion = &drive.motions[at - 1];
                let driven_m = prices[at - 1] + motion.step.length_m.abs();
                // The test of conflicts is costly, so only for what can still be cheaper.
                if driven_m < price_m {
                    let driven_m = driven_m + others.price_m(arrived - 1, motion);
                    if driven_m < price_m {
                        (price_m, waited_at[at]) = (driven_m, false);
                    }
                }
            }
            prices[at] = price_m;
            if at < steps {
                min_m = min_m.min(price_m + ahead_m[at]);
            }
        }
        waited.push(waited_at);
        let price_m = prices[steps] + others.arrival_price_m(steps + waits);
        if price_m < best_m {
            (best_m, best_waits) = (price_m, Some(waits));
        }
        // One more wait costs at least a step.
        if min_m + STEP_M >= best_m {
            break;
        }
    }
    let mut waits = best_waits?;
    let mut at = steps;
    let mut route = Vec::with_capacity(steps + waits);
    while at > 0 || waits > 0 {
        if waited[waits][at] {
            waits -= 1;
            route.push(WAIT);
        } else {
            at -= 1;
            route.push(drive.motions[at].step);
        }
    }
    route.reverse();
    Some(CostedRoute { route: Route { start: drive.start, steps: route }, price_m: best_m })
}

/// Finds drives past the standing obstacles, the shortest first; none if a search of `expansions` finds no way.
pub fn drives(
    ground: &StaticMap,
    vehicle: &Vehicle,
    search: &mut Search,
    expansions: u32,
    is_stopped: &mut dyn FnMut() -> bool,
) -> Vec<StaticDrive> {
    let mut found: Vec<StaticDrive> = Vec::new();
    let mut curves = Vec::new();
    CURVES.candidates(vehicle.start, vehicle.goal, &CurvePrice::LENGTH, &mut curves);
    let shortest_m = curves[0].price;
    // Curves that are much longer would rarely be worth it.
    for curve in curves.iter().take_while(|curve| curve.price < 1.2 * shortest_m + 4.0 * RADIUS_M) {
        // Room is left for what searches find.
        if found.len() == MAX_DRIVES - 2 {
            break;
        }
        let drive = StaticDrive::new(vehicle.start, steps_of(curve.curve.segments()));
        if drive.motions.iter().all(|motion| ground.allows(motion)) {
            found.push(drive);
        }
    }
    // No drive is shorter than the shortest curve.
    if found.first().is_none_or(|drive| drive.length_m > shortest_m + 1e-6) {
        let bound_m = found.first().map_or(f64::INFINITY, |drive| drive.length_m);
        let query = Query { ground, vehicle, others: None, bound_m, expansions };
        if let Some(priced) = search.find(&query, is_stopped) {
            keep(&mut found, shortened(ground, priced.route, is_stopped));
        }
    }
    found
}

/// Adds a drive to those of a vehicle; the longest of too many goes.
pub fn keep(drives: &mut Vec<StaticDrive>, drive: StaticDrive) {
    if drives.iter().any(|existing: &StaticDrive| {
        existing.motions.len() == drive.motions.len() && (existing.length_m - drive.length_m).abs() < 1e-9
    }) {
        return;
    }
    let place = drives.partition_point(|existing| existing.length_m <= drive.length_m);
    drives.insert(place, drive);
    drives.truncate(MAX_DRIVES);
}

/// Shortens a route's drive by Reeds-Shepp curves between its poses, until it is stopped, and drops its waits.
pub fn shortened(ground: &StaticMap, route: Route, is_stopped: &mut dyn FnMut() -> bool) -> StaticDrive {
    let driven = route.steps.iter().copied().filter(|step| step.length_m != 0.0);
    let whole = StaticDrive::new(route.start, driven.clone());
    // Cut at half steps: more poses for curves to begin and end at.
    let halves = driven.flat_map(|step| std::iter::repeat_n(step.with_length(0.5 * step.length_m.abs()), 2));
    let mut drive = StaticDrive::new(route.start, halves);
    let mut span = drive.motions.len();
    // Long cuts first: they gain most and leave fewer short ones.
    while span >= 2 && !is_stopped() {
        let mut from = 0;
        while from + span <= drive.motions.len() {
            let start = drive.pose(from);
            let end = drive.pose(from + span);
            let parts = &drive.motions[from..from + span];
            let driven_m: f64 = parts.iter().map(|motion| motion.step.length_m.abs()).sum();
            // A cut that gains next to nothing costs steps.
            if let Some(length_m) = CURVES.length_below(start, end, driven_m - 0.02) {
                let cut = StaticDrive::new(start, steps_of(CURVES.shortest(start, end).segments()));
                if cut.motions.iter().all(|motion| ground.allows(motion)) && length_m < driven_m {
                    let steps: Vec<Segment> = drive.motions.iter().map(|motion| motion.step).collect();
                    let steps = steps[..from].iter().copied().chain(cut.motions.iter().map(|motion| motion.step));
                    let rest = drive.motions[from + span..].iter().map(|motion| motion.step);
                    drive = StaticDrive::new(route.start, steps.chain(rest));
                }
            }
            // Overlapping cuts, so that none depends on where the first began.
            from += (span / 4).max(1);
        }
        span = if span > 8 { span * 3 / 4 } else { span - 1 };
    }
    // Joined where it goes on as before, so that it takes no more steps than it must.
    let path = wildfire_base::vehicle::Path {
        start: route.start,
        segments: drive.motions.iter().map(|motion| motion.step).collect(),
    };
    let joined = StaticDrive::new(route.start, steps_of(path.joined().segments.into_iter()));
    // Other cuts have other whole steps, at which obstacles may be met that were passed between steps before.
    [joined, drive].into_iter().find(|drive| drive.motions.iter().all(|motion| ground.allows(motion))).unwrap_or(whole)
}

/// A search for one vehicle.
pub struct Query<'a> {
    pub ground: &'a StaticMap<'a>,
    pub vehicle: &'a Vehicle,
    /// The others; without them nothing waits.
    pub others: Option<&'a Others<'a>>,
    /// Routes must cost less.
    pub bound_m: f64,
    pub expansions: u32,
}

#[derive(Clone, Copy, Debug)]
struct RouteNode {
    pose: Pose,
    at: u32,
    parent: u32,
    step: Segment,
    price_m: f64,
}

/// The memory of searches, kept from one to the next.
#[derive(Debug, Default)]
pub struct Search {
    nodes: Vec<RouteNode>,
    open: BinaryHeap<Reverse<(u64, Reverse<u64>, u32)>>,
    bins: Bins,
    /// Nodes expanded by all searches.
    pub expanded: u64,
}

/// The weight of the estimate: routes cost at most this factor more than the cheapest of the lattice.
const WEIGHT: f64 = 1.1;

impl Search {
    /// Finds a route that costs less than the bound, the cheapest that the expansions allow for; none if it is stopped.
    pub fn find(&mut self, query: &Query, is_stopped: &mut dyn FnMut() -> bool) -> Option<CostedRoute> {
        let Query { ground, vehicle, others, bound_m, expansions } = *query;
        self.nodes.clear();
        self.open.clear();
        self.bins.clear();
        // The curve without obstacles: admissible.
        let ahead_m = |pose: Pose| CURVES.length_m(pose, vehicle.goal);
        let root = RouteNode { pose: vehicle.start, at: 0, parent: u32::MAX, step: WAIT, price_m: 0.0 };
        self.push(root, ahead_m(root.pose));
        let mut best_m = bound_m;
        let mut best: Option<(u32, Vec<Segment>)> = None;
        let mut curves = Vec::new();
        for expansion in 0..expansions {
            // Looking at a clock each time would cost more than an expansion.
            if expansion % EXPANSIONS_A_LOOK == 0 && is_stopped() {
                return None;
            }
            let Some(Reverse((key, _, index))) = self.open.pop() else { break };
            // Keys are positive, so their bits are in the order of the numbers.
            if f64::from_bits(key) >= best_m {
                break;
            }
            self.expanded += 1;
            let node = self.nodes[index as usize];
            // A cheaper way to its bin was found since it was pushed.
            if self.bins.best(bin_of(&node, others.is_some())) < node.price_m {
                continue;
            }
            CURVES.candidates(node.pose, vehicle.goal, &CurvePrice::LENGTH, &mut curves);
            // Near the goal a longer curve may pass where the shortest is blocked.
            let tried = if curves[0].price < NEAR_GOAL_M { 4 } else { 1 };
            for curve in curves.iter().take(tried) {
                if node.price_m + curve.price >= best_m {
                    break;
                }
                let steps: Vec<Segment> = steps_of(curve.curve.segments()).collect();
                if let Some(price_m) = try_shot(query, &node, &steps, best_m) {
                    best_m = price_m;
                    best = Some((index, steps));
                }
            }
            for step in moves(others.is_some()) {
                let motion = Motion { from: node.pose, step };
                let mut child = RouteNode {
                    pose: step.end(node.pose),
                    at: node.at + 1,
                    parent: index,
                    step,
                    price_m: node.price_m + step_price_m(step),
                };
                // Cheap refusals come first: prices only rise from here.
                let bin = bin_of(&child, others.is_some());
                if self.bins.best(bin) <= child.price_m || !ground.allows(&motion) {
                    continue;
                }
                // Gives up as soon as the length exceeds what could still win.
                let ahead_m = CURVES.length_below(child.pose, vehicle.goal, best_m - child.price_m);
                let Some(ahead_m) = ahead_m else { continue };
                if let Some(others) = others {
                    child.price_m += others.price_m(node.at as usize, &motion);
                }
                // Bins are improved last, so that refused children leave no mark.
                if child.price_m + ahead_m < best_m && self.bins.improve(bin, child.price_m) {
                    self.push(child, ahead_m);
                }
            }
        }
        let (mut index, shot) = best?;
        let mut steps = Vec::new();
        while index != 0 {
            let node = &self.nodes[index as usize];
            steps.push(node.step);
            index = node.parent;
        }
        steps.reverse();
        steps.extend(shot);
        Some(CostedRoute { route: Route { start: vehicle.start, steps }, price_m: best_m })
    }

    fn push(&mut self, node: RouteNode, ahead_m: f64) {
        let key = (node.price_m + WEIGHT * ahead_m).to_bits();
        // Of equals the one that is farther on, then the older.
        self.open.push(Reverse((key, Reverse(node.price_m.to_bits()), self.nodes.len() as u32)));
        self.nodes.push(node);
    }
}

/// Returns the price of a route that ends by these steps, if that is less than the bound.
fn try_shot(query: &Query, node: &RouteNode, steps: &[Segment], bound_m: f64) -> Option<f64> {
    let mut from = node.pose;
    let mut at = node.at as usize;
    let mut price_m = node.price_m + steps.iter().map(|step| step.length_m.abs()).sum::<f64>();
    for &step in steps {
        let motion = Motion { from, step };
        if !query.ground.allows(&motion) {
            return None;
        }
        if let Some(others) = query.others {
            price_m += others.price_m(at, &motion);
            // Prices only rise along the way.
            if price_m >= bound_m {
                return None;
            }
        }
        from = step.end(from);
        at += 1;
    }
    price_m += query.others.map_or(0.0, |others| others.arrival_price_m(at));
    (price_m < bound_m).then_some(price_m)
}

/// The actions of a step, straight ones first.
fn moves(with_wait: bool) -> impl Iterator<Item = Segment> {
    let turns = [0.0, 1.0 / RADIUS_M, -1.0 / RADIUS_M];
    let drives =
        [STEP_M, -STEP_M].into_iter().flat_map(move |length_m| turns.map(|curvature| Segment { curvature, length_m }));
    drives.chain(with_wait.then_some(WAIT))
}

/// Returns the number of the bin of a node's place, heading and step.
fn bin_of(node: &RouteNode, is_timed: bool) -> u64 {
    let col = (node.pose.x / BIN_M) as u64;
    let row = (node.pose.y / BIN_M) as u64;
    let turn = (node.pose.heading / TAU * HEADING_BINS).round().rem_euclid(HEADING_BINS) as u64;
    let at = if is_timed { u64::from(node.at) } else { 0 };
    (((at << 5 | turn) << 20 | row) << 20 | col) + 1
}

/// The lowest price met in each bin: open addressing, by a multiplicative hash (D. Knuth, "The art of computer
/// programming", volume 3, section 6.4).
#[derive(Debug, Default)]
struct Bins {
    /// Bins and their prices; bin 0 is none.
    slots: Vec<(u64, f64)>,
    used: usize,
}

impl Bins {
    fn clear(&mut self) {
        self.used = 0;
        self.slots.clear();
        self.slots.resize(1 << 12, (0, f64::INFINITY));
    }

    fn slot(&self, bin: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut slot = (bin.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & mask;
        while self.slots[slot].0 != 0 && self.slots[slot].0 != bin {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn best(&self, bin: u64) -> f64 {
        self.slots[self.slot(bin)].1
    }

    /// Says whether a price is the lowest of its bin, and keeps it.
    fn improve(&mut self, bin: u64, price: f64) -> bool {
        // Half of the slots stay empty, so that every look-up soon comes to one.
        if 2 * self.used >= self.slots.len() {
            let grown = vec![(0, f64::INFINITY); 4 * self.slots.len()];
            for (bin, price) in std::mem::replace(&mut self.slots, grown).into_iter().filter(|slot| slot.0 != 0) {
                let slot = self.slot(bin);
                self.slots[slot] = (bin, price);
            }
        }
        let slot = self.slot(bin);
        if self.slots[slot].1 <= price {
            return false;
        }
        self.used += usize::from(self.slots[slot].0 == 0);
        self.slots[slot] = (bin, price);
        true
    }
}
