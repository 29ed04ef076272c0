//! The local search: A* with motion primitives along the waypoints of a route.

use std::sync::Arc;

use glam::DVec2;

use crate::collision::CollisionChecker;
use crate::kit::best_first::{
    AnalyticExpansion, Candidate, Node, PoseSearch, SearchFailure, SearchOf, SearchSpace, Step,
};
use crate::kit::clearance_profile::ClearanceProfile;
use crate::kit::lattice::Lattice;
use crate::kit::motion_price::MotionPrice;
use crate::kit::safety::Safety;
use crate::kit::turn_straight::{TurnStraight, TurnStraightSteering};
use crate::memory::{CapacityBytes, MemoryMeter};
use crate::{Goal, GoalDisc};
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::reeds_shepp::Curve;
use wildfire_base::vehicle::{Dimensions, Path, ReedsShepp, Segment};

use super::PrimitiveSettings;

/// An estimate by turns and straights exceeds the straight line by at most this, because lattice motions may know better.
const DETOUR_CAP_M: f64 = 15.0;
/// Waypoints that are steered to besides the next one.
const AIM_AHEAD: u32 = 1;
/// Ways end on the goal's rim, give or take rounding; the caller's margin is larger.
const ROUNDING_M: f64 = 1e-6;

const NO_WAY: u32 = u32::MAX;

/// The progress of a reached pose along the waypoints.
#[derive(Clone, Copy, Debug)]
pub struct WaypointProgress {
    /// The waypoint that comes next; the last one stands for the goal disc.
    waypoint: u32,
    /// The best turn and straight to it, in the list of ways, or [`NO_WAY`].
    way: u32,
}

/// A turn and a straight to a waypoint, or into the goal, that has to be swept; `way` is its index in the list of
/// paths.
#[derive(Clone, Copy, Debug)]
pub struct Steered {
    waypoint: u32,
    way: u32,
}

/// A query to one search.
#[derive(Clone, Copy, Debug)]
pub struct PrimitiveQuery<'a> {
    pub checker: &'a CollisionChecker,
    pub profile: &'a ClearanceProfile,
    pub start: Pose,
    /// Positions for the body's centre; the last one lies in the goal, or near it if that is a pose.
    pub waypoints: &'a [DVec2],
    pub goal: Goal,
}

impl PrimitiveQuery<'_> {
    /// Returns whether a waypoint stands for the goal.
    fn is_last(&self, waypoint: u32) -> bool {
        waypoint as usize + 1 >= self.waypoints.len()
    }

    /// Returns whether the body's centre is in the goal disc. Goal poses are met at the end of curves only.
    fn is_inside(&self, pose: Pose) -> bool {
        let Goal::Disc(disc) = self.goal else { return false };
        self.checker.body().body_centre(pose).distance(disc.centre) <= disc.radius_m + ROUNDING_M
    }
}

/// A* over poses with motion primitives; its memory is kept between searches.
#[derive(Debug)]
pub struct PrimitiveSearch {
    search: PoseSearch<WaypointProgress, Steered>,
    primitives: Primitives,
}

/// The motions of one body, their prices, and what is remembered of them during a search.
#[derive(Debug)]
struct Primitives {
    settings: PrimitiveSettings,
    price: MotionPrice,
    steering: TurnStraightSteering,
    curves: ReedsShepp,
    /// For each motion of the lattice, from the body's centre before to the one after, in the body frame before.
    shifts: [DVec2; 6],
    ways: Vec<TurnStraight>,
    /// Metres from each waypoint along the rest of the route, and what their places cost more.
    tails: Vec<f64>,
}

impl PrimitiveSearch {
    pub fn new(
        checker: &CollisionChecker,
        memory: &MemoryMeter,
        settings: &PrimitiveSettings,
        safety: Option<Arc<Safety>>,
    ) -> Self {
        let body = checker.body();
        let price = MotionPrice::new(settings, body, safety);
        let lattice = Lattice { bin_m: settings.bin_m, headings: settings.headings, step_m: settings.step_m };
        let search = PoseSearch::new(body, lattice, memory);
        let primitives = Primitives {
            settings: settings.clone(),
            steering: TurnStraightSteering::new(body, price.clone()),
            price,
            curves: ReedsShepp { radius_m: body.turning_radius_m },
            shifts: search.motions.map(|motion| centre_shift(motion, body)),
            ways: Vec::new(),
            tails: Vec::new(),
        };
        Self { search, primitives }
    }

    pub fn steering(&self) -> &TurnStraightSteering {
        &self.primitives.steering
    }

    /// Returns the nodes that the last search expanded.
    pub fn expansions(&self) -> u32 {
        self.search.expansions
    }

    /// Returns the positions that the last search reached, in order, each after its predecessor.
    pub fn lines(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.search.lines()
    }

    /// Searches for a path into the goal and expands at most `budget` nodes.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn run(&mut self, query: &PrimitiveQuery<'_>, budget: u32) -> Result<Path, SearchFailure> {
        self.primitives.begin(query.waypoints);
        let mut space = PrimitiveSpace { query, primitives: &mut self.primitives };
        // Searches never ask whether a start is a goal.
        if query.is_inside(query.start) {
            // It is begun without a start, so that the lines of the last query are not shown again.
            self.search.begin(&mut space, [], WaypointProgress { waypoint: 0, way: NO_WAY });
            return Ok(Path::standing(query.start));
        }
        self.search.begin(&mut space, [query.start], WaypointProgress { waypoint: 0, way: NO_WAY });
        self.search.run(&mut space, budget)
    }
}

/// Returns how far a motion shifts the body's centre, in the body frame before.
fn centre_shift(motion: Segment, body: &Dimensions) -> DVec2 {
    let origin = Pose::new(0.0, 0.0, 0.0);
    body.body_centre(motion.end(origin)) - body.body_centre(origin)
}

impl Primitives {
    fn begin(&mut self, waypoints: &[DVec2]) {
        self.ways.clear();
        self.tails.clear();
        self.tails.resize(waypoints.len(), 0.0);
        for index in (0..waypoints.len().saturating_sub(1)).rev() {
            let from = waypoints[index];
            let to = waypoints[index + 1];
            self.tails[index] = self.tails[index + 1] + (from.distance(to) + self.price.line_surcharge(from, to));
        }
    }

    /// Returns the cheapest curve between two poses on a field where all places cost the same.
    fn curve(&self, from: Pose, to: Pose) -> Curve {
        self.curves.cheapest_word(from, to, &self.price.curve_price()).curve
    }

    fn add_way(&mut self, way: TurnStraight) -> u32 {
        self.ways.push(way);
        self.ways.len() as u32 - 1
    }
}

/// A query and the primitives that answer it.
struct PrimitiveSpace<'a> {
    query: &'a PrimitiveQuery<'a>,
    primitives: &'a mut Primitives,
}

impl PrimitiveSpace<'_> {
    /// Skips waypoints that are passed, or behind which the next one can be seen.
    fn next_waypoint(&self, pose: Pose, from: u32) -> u32 {
        let Self { query, primitives } = self;
        let centre = query.checker.body().body_centre(pose);
        let sight_m = 0.5 * query.checker.body().width_m + primitives.settings.clearance_m;
        // It never goes back to an earlier waypoint, so that a search makes progress along the route.
        let mut next = from as usize;
        while next + 1 < query.waypoints.len()
            && (centre.distance(query.waypoints[next]) <= primitives.settings.waypoint_tolerance_m
                || (query.checker.field().line_is_free(centre, query.waypoints[next + 1], sight_m)
                    && primitives.price.may_skip(centre, query.waypoints[next], query.waypoints[next + 1])))
        {
            next += 1;
        }
        next as u32
    }

    /// Returns a waypoint as a disc without extent, or the goal, and the metres from there on.
    fn target(&self, waypoint: u32) -> (GoalDisc, f64) {
        let Self { query, primitives } = self;
        if query.is_last(waypoint) {
            return (query.goal.disc(query.checker.body()), 0.0);
        }
        let index = waypoint as usize;
        (GoalDisc { centre: query.waypoints[index], radius_m: 0.0 }, primitives.tails[index])
    }

    /// Puts a turn and a straight on the open list, to be swept when their turn comes.
    fn offer(&self, search: &mut SearchOf<Self>, index: u32, steered: Steered) {
        let Node { cost, pose, .. } = *search.node(index);
        let (_, tail) = self.target(steered.waypoint);
        let way = &self.primitives.ways[steered.way as usize];
        let surcharge = self.primitives.price.way_surcharge(pose, way.pieces());
        let key = cost + self.weight() * ((way.cost + surcharge) + tail);
        search.push(key, cost, index, Step::Custom(steered));
    }
}

impl SearchSpace for PrimitiveSpace<'_> {
    type Mark = WaypointProgress;
    type Custom = Steered;

    /// One step adds a turn and a straight, the motions that follow, and ways to the waypoints ahead.
    fn has_room(&mut self, search: &mut SearchOf<Self>) -> bool {
        let ways = self.primitives.ways.bytes_after(1 + AIM_AHEAD as usize);
        let bytes = search.bytes_after(2, search.motions.len() + 2 + AIM_AHEAD as usize);
        search.may_hold(bytes + ways)
    }

    fn weight(&self) -> f64 {
        self.primitives.settings.heuristic_weight
    }

    /// Estimates the cost along the waypoints to the goal. The curve into a goal pose waits until the node is expanded.
    fn estimate(&mut self, node: &mut Node<WaypointProgress>) -> Option<f64> {
        let waypoint = self.next_waypoint(node.pose, node.mark.waypoint);
        node.mark = WaypointProgress { waypoint, way: NO_WAY };
        // To a pose the curve's own length is the estimate, as turning into the heading may cost more than the way.
        if let Goal::Pose(end) = self.query.goal
            && self.query.is_last(waypoint)
        {
            let curve = self.primitives.curve(node.pose, end);
            node.cost_to_go = self.primitives.price.way_cost(node.pose, node.reverse, curve.segments());
            return None;
        }
        let centre = self.query.checker.body().body_centre(node.pose);
        let (disc, tail) = self.target(waypoint);
        let Primitives { price, settings, steering, .. } = &*self.primitives;
        let gap = centre.distance(disc.centre);
        let straight = (gap - disc.radius_m).max(0.0);
        // The divisor is never 0 at the disc's centre, where the straight way is 0 too.
        let rim = centre.lerp(disc.centre, straight / gap.max(f64::MIN_POSITIVE));
        let straight = straight + price.line_surcharge(centre, rim);
        if !settings.aimed {
            node.cost_to_go = straight + tail;
            return None;
        }
        match steering.best_into(node.pose, disc, node.reverse) {
            Some(way) => {
                let cost = way.cost + price.way_surcharge(node.pose, way.pieces());
                // A turn that must first back out would look as if the disc were far away; the cap keeps such poses in
                // the race.
                node.cost_to_go = cost.min(straight + DETOUR_CAP_M) + tail;
                node.mark.way = self.primitives.add_way(way);
            }
            None => node.cost_to_go = straight + DETOUR_CAP_M + tail,
        }
        None
    }

    fn analytic_expansion(&self, node: &Node<WaypointProgress>) -> AnalyticExpansion {
        let Goal::Pose(end) = self.query.goal else { unreachable!("curves are offered to poses only") };
        AnalyticExpansion::new(self.primitives.curve(node.pose, end).segments(), node.cost_to_go)
    }

    fn offer_successors(&mut self, search: &mut SearchOf<Self>, from: Candidate<Steered>) {
        let index = from.node;
        let node = *search.node(index);
        let weight = self.weight();
        let WaypointProgress { waypoint, way } = node.mark;
        // A pose is reached by its curve, not by aiming at its place.
        let to_pose = matches!(self.query.goal, Goal::Pose(_));
        if to_pose && self.query.is_last(waypoint) {
            search.push(node.cost + weight * node.cost_to_go, node.cost, index, Step::Arrive);
        }
        if self.primitives.settings.aimed {
            if way != NO_WAY {
                self.offer(search, index, Steered { waypoint, way });
            }
            // Aiming past the next waypoints cuts corners that the roadmap's milestones only happen to have.
            let last = self.query.waypoints.len().saturating_sub(1) as u32;
            let ahead = waypoint + 1..=last.min(waypoint + AIM_AHEAD);
            for waypoint in ahead.filter(|&ahead| !(to_pose && self.query.is_last(ahead))) {
                let (disc, _) = self.target(waypoint);
                if let Some(way) = self.primitives.steering.best_into(node.pose, disc, node.reverse) {
                    let way = self.primitives.add_way(way);
                    self.offer(search, index, Steered { waypoint, way });
                }
            }
        }
        // A motion that comes nearer to the next waypoint by all its length is worth that length; one that comes no
        // nearer half of it.
        let (sin, cos) = ops::sin_cos(node.pose.heading);
        let centre = node.pose.position() + DVec2::new(cos, sin) * self.query.checker.body().centre_offset_m();
        let (disc, _) = self.target(waypoint);
        let gap = centre.distance(disc.centre);
        let Primitives { price, settings, shifts, .. } = &*self.primitives;
        for (choice, motion) in search.motions.into_iter().enumerate() {
            if node.is_undone_by(motion) {
                continue;
            }
            // The cost-to-go holds the surcharges of the way ahead, so that of this motion is taken off it.
            let surcharge = price.surcharge(node.pose, motion);
            let cost = node.cost + (price.cost(motion, node.reverse) + surcharge);
            let gained = gap - (centre + DVec2::new(cos, sin).rotate(shifts[choice])).distance(disc.centre);
            let key = cost + weight * (node.cost_to_go - 0.5 * (settings.step_m + gained) - surcharge).max(0.0);
            search.push(key, cost, index, Step::Motion { index: choice as u8, alike: 0 });
        }
    }

    fn motion_is_free(&self, from: Pose, motion: Segment) -> bool {
        self.query.profile.motion_is_free(self.query.checker, from, motion)
    }

    /// Sweeps a turn and a straight, and keeps a node after each.
    fn take(&mut self, search: &mut SearchOf<Self>, from: Candidate<Steered>, steered: Steered) -> Option<u32> {
        let TurnStraight { turn, straight, .. } = self.primitives.ways[steered.way as usize];
        let start = *search.node(from.node);
        // The straight first: it is longer and farther from where the truck is known to fit.
        if !self.motion_is_free(turn.end(start.pose), straight) || !self.motion_is_free(start.pose, turn) {
            return None;
        }
        let mut node = Node { mark: WaypointProgress { waypoint: steered.waypoint, way: NO_WAY }, ..start };
        let mut parent = from.node;
        // A piece without length would be a node at its parent's pose.
        let pieces = [turn, straight].map(|piece| (piece.length_m != 0.0).then_some(piece));
        let last = if pieces[1].is_some() { 1 } else { 0 };
        for (place, motion) in pieces.into_iter().enumerate().filter_map(|(place, piece)| Some((place, piece?))) {
            let price = &self.primitives.price;
            let cost = node.cost + (price.cost(motion, node.reverse) + price.surcharge(node.pose, motion));
            node =
                Node { pose: motion.end(node.pose), parent, motion, reverse: Some(motion.is_reverse()), cost, ..node };
            if place < last {
                parent = search.add(node);
            }
        }
        search.reach(self, node)
    }

    fn is_goal(&mut self, pose: Pose) -> bool {
        self.query.is_inside(pose)
    }
}
