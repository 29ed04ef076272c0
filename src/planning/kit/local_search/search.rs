use std::sync::Arc;

use glam::DVec2;

use super::PrimitiveSettings;
use crate::collision::CollisionChecker;
use crate::geometry::{Pose, ops};
use crate::grid::open_list::OpenList;
use crate::planning::kit::best_first;
use crate::planning::kit::safety::Safety;
use crate::planning::memory::{BytesAfter, Growing, Held, MemoryMeter};
use crate::planning::{Goal, GoalDisc};
use crate::vehicle::reeds_shepp::Curve;
use crate::vehicle::{Dimensions, ReedsShepp, Segment};

use super::floor::Floor;
use crate::planning::kit::closed_set::Bins;
use crate::planning::kit::motion_price::Price;
use crate::planning::kit::turn_straight::{Aim, Aiming};

/// An estimate by aims exceeds the straight line by at most this, because lattice motions may know better.
const DETOUR_CAP_M: f64 = 15.0;
/// Waypoints that are aimed at besides the next one.
const AIM_AHEAD: u32 = 1;

const ROOT: u32 = u32::MAX;
const NO_AIM: u32 = u32::MAX;

/// A pose that was reached.
#[derive(Clone, Copy, Debug)]
struct Node {
    pose: Pose,
    parent: u32,
    /// How it was reached from its parent.
    motion: Segment,
    cost: f64,
    /// Estimated cost from here on.
    ahead: f64,
    /// The waypoint that comes next; the last one stands for the goal disc.
    stage: u32,
    /// The best aim at it, in the list of aims, or [`NO_AIM`].
    aim: u32,
}

impl Node {
    /// Whether it was reached in reverse; nothing is said about the start.
    fn reverse(&self) -> Option<bool> {
        (self.parent != ROOT).then(|| self.motion.is_reverse())
    }
}

/// What is still to be judged.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// A reached node is to be expanded.
    Expand,
    /// A lattice motion from the node is to be swept.
    Lattice { index: u8 },
    /// An aim from the node at a waypoint, or at the goal, is to be swept; `aim` is its place in the list of aims.
    Aimed { target: u32, aim: u32 },
    /// The curve from the node to the goal pose is to be swept.
    Curve,
}

type Candidate = best_first::Candidate<Step>;

/// One of the six motions that may follow any pose.
#[derive(Clone, Copy, Debug)]
struct LatticeMotion {
    segment: Segment,
    /// From the body's centre before to the body's centre after, in the body frame before.
    shift: DVec2,
}

impl LatticeMotion {
    fn new(segment: Segment, body: &Dimensions) -> Self {
        let origin = Pose::new(0.0, 0.0, 0.0);
        Self { segment, shift: body.body_centre(segment.end(origin)) - body.body_centre(origin) }
    }

    /// The shift in the world, for a body of this sine and cosine of heading.
    fn centre_shift(&self, sin: f64, cos: f64) -> DVec2 {
        DVec2::new(cos, sin).rotate(self.shift)
    }
}

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    Found,
    /// Everything that the lattice offers was tried.
    Exhausted,
    BudgetSpent,
}

/// What one search is asked.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    pub checker: &'a CollisionChecker,
    pub floor: Floor,
    pub start: Pose,
    /// Places for the body's centre; the last one lies in the goal, or near it if that is a pose.
    pub waypoints: &'a [DVec2],
    pub goal: Goal,
}

impl Task<'_> {
    /// Whether the waypoint of a stage stands for the goal.
    fn is_last(&self, stage: u32) -> bool {
        stage as usize + 1 >= self.waypoints.len()
    }

    /// The goal as a place for the body's centre.
    fn disc(&self) -> GoalDisc {
        match self.goal {
            Goal::Disc(disc) => disc,
            Goal::Pose(end) => GoalDisc { centre: self.checker.body().body_centre(end), radius_m: 0.0 },
        }
    }

    /// Whether the body's centre is in the goal disc. Goal poses are met at the end of curves only.
    fn is_inside(&self, pose: Pose) -> bool {
        let Goal::Disc(disc) = self.goal else { return false };
        self.checker.body().body_centre(pose).distance(disc.centre) <= disc.radius_m + ROUNDING_M
    }
}

/// A* over poses with motion primitives; its memory is kept between searches.
#[derive(Debug)]
pub struct Search {
    settings: PrimitiveSettings,
    price: Price,
    aiming: Aiming,
    curves: ReedsShepp,
    lattice: [LatticeMotion; 6],
    nodes: Vec<Node>,
    aims: Vec<Aim>,
    open: OpenList<Candidate>,
    bins: Bins,
    sequence: u32,
    memory: Held,
    /// Metres from each waypoint along the rest of the route, and what their places cost more.
    tails: Vec<f64>,
    /// Nodes expanded by the last search.
    pub expansions: u32,
}

impl Search {
    pub fn new(
        checker: &CollisionChecker,
        memory: &MemoryMeter,
        settings: &PrimitiveSettings,
        safety: Option<Arc<Safety>>,
    ) -> Self {
        let price = Price::new(settings, checker.body(), safety);
        let body = checker.body();
        Self {
            settings: settings.clone(),
            aiming: Aiming::new(checker.body(), price.clone()),
            price,
            curves: ReedsShepp { radius_m: body.turning_radius_m },
            lattice: best_first::motions(body, settings.step_m).map(|motion| LatticeMotion::new(motion, body)),
            nodes: Vec::new(),
            aims: Vec::new(),
            open: OpenList::default(),
            bins: Bins::new(settings.bin_m, settings.headings),
            sequence: 0,
            memory: memory.holder(Growing::Searches),
            tails: Vec::new(),
            expansions: 0,
        }
    }

    pub fn aiming(&self) -> &Aiming {
        &self.aiming
    }

    /// Searches for a way into the goal; on success the segments are appended to `path`.
    pub fn run(&mut self, task: &Task<'_>, budget: u32, path: &mut Vec<Segment>) -> Ending {
        self.begin(task);
        if task.is_inside(task.start) {
            return Ending::Found;
        }
        let root = Node {
            pose: task.start,
            parent: ROOT,
            motion: Segment { curvature: 0.0, length_m: 0.0 },
            cost: 0.0,
            ahead: 0.0,
            stage: 0,
            aim: NO_AIM,
        };
        self.reach(task, root);
        while let Some(best) = self.open.pop() {
            if !self.has_memory() {
                return Ending::BudgetSpent;
            }
            let reached = match best.step {
                Step::Expand => {
                    if self.expansions == budget {
                        return Ending::BudgetSpent;
                    }
                    self.expand(task, best.node);
                    None
                }
                Step::Lattice { index } => self.drive_lattice(task, best, index),
                Step::Aimed { target, aim } => self.drive_aimed(task, best, target, aim),
                Step::Curve => {
                    if self.drive_curve(task, best.node, path) {
                        return Ending::Found;
                    }
                    None
                }
            };
            if let Some(node) = reached.filter(|&node| task.is_inside(self.nodes[node as usize].pose)) {
                self.trace(node, path);
                return Ending::Found;
            }
        }
        Ending::Exhausted
    }

    /// Says whether there is memory for what one step adds: a turn and a straight, the motions that follow, and aims at
    /// the waypoints ahead.
    fn has_memory(&mut self) -> bool {
        let (nodes, aims) = (self.nodes.bytes_after(2), self.aims.bytes_after(1 + AIM_AHEAD as usize));
        let open = self.open.bytes_after(self.lattice.len() + 2 + AIM_AHEAD as usize);
        self.memory.cover(nodes + aims + open + self.bins.bytes_after(1))
    }

    /// The most bytes that searches take, each of which expands up to this number of nodes.
    pub fn most_bytes(expansions: u32) -> u64 {
        // A node is left by its motions but the one back, and by aims, which are two motions each.
        let motions = 5;
        let aims = 1 + u64::from(AIM_AHEAD);
        let nodes = motions + 2 * aims;
        let entries = nodes + motions + aims + 1;
        let lists = nodes * size_of::<Node>() as u64 + (nodes + aims) * size_of::<Aim>() as u64;
        let open = entries * size_of::<Candidate>() as u64;
        // Lists that double may have room for twice as many.
        2 * u64::from(expansions) * (lists + open) + Bins::most_bytes(u64::from(expansions) * nodes)
    }

    /// Where the poses are that the last search reached, in order, each after the one that it came from.
    pub fn reached(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.nodes.iter().map(|node| {
            let from = if node.parent == ROOT { node } else { &self.nodes[node.parent as usize] };
            [from, node].map(|node| node.pose.position())
        })
    }

    fn begin(&mut self, task: &Task<'_>) {
        self.nodes.clear();
        self.aims.clear();
        self.open.clear();
        self.bins.clear();
        self.sequence = 0;
        self.expansions = 0;
        self.tails.clear();
        self.tails.resize(task.waypoints.len(), 0.0);
        for index in (0..task.waypoints.len().saturating_sub(1)).rev() {
            let (from, to) = (task.waypoints[index], task.waypoints[index + 1]);
            self.tails[index] = self.tails[index + 1] + (from.distance(to) + self.price.of_line(from, to));
        }
    }

    fn push(&mut self, key: f64, cost: f64, node: u32, step: Step) {
        self.open.push(Candidate { key, cost, sequence: self.sequence, node, step });
        self.sequence += 1;
    }

    /// Keeps a node for expansion if its bin knows no way as cheap.
    fn reach(&mut self, task: &Task<'_>, mut node: Node) -> Option<u32> {
        if !task.is_inside(node.pose) && !self.bins.improve(node.pose, node.motion.is_reverse(), node.cost) {
            return None;
        }
        node.stage = self.stage_of(task, &node);
        (node.ahead, node.aim) = self.estimate(task, &node);
        let index = self.nodes.len() as u32;
        self.nodes.push(node);
        self.push(node.cost + self.settings.heuristic_weight * node.ahead, node.cost, index, Step::Expand);
        Some(index)
    }

    /// Skips waypoints that are passed, or behind which the next one can be seen.
    fn stage_of(&self, task: &Task<'_>, node: &Node) -> u32 {
        let centre = task.checker.body().body_centre(node.pose);
        let sight_m = 0.5 * task.checker.body().width_m + self.settings.clearance_m;
        let mut stage = node.stage as usize;
        while stage + 1 < task.waypoints.len()
            && (centre.distance(task.waypoints[stage]) <= self.settings.waypoint_tolerance_m
                || task.checker.field().line_is_free(centre, task.waypoints[stage + 1], sight_m))
        {
            stage += 1;
        }
        stage as u32
    }

    /// Estimated cost from a node to the goal, along the waypoints, and the aim at the next waypoint that it rests on.
    fn estimate(&mut self, task: &Task<'_>, node: &Node) -> (f64, u32) {
        if let Goal::Pose(end) = task.goal
            && task.is_last(node.stage)
        {
            let curve = self.curve(node.pose, end);
            return (self.price.of_way(node.pose, node.reverse(), curve.segments()), NO_AIM);
        }
        let centre = task.checker.body().body_centre(node.pose);
        let (disc, tail) = self.target(task, node.stage);
        let gap = centre.distance(disc.centre);
        let straight = (gap - disc.radius_m).max(0.0);
        let rim = centre.lerp(disc.centre, straight / gap.max(f64::MIN_POSITIVE));
        let straight = straight + self.price.of_line(centre, rim);
        if !self.settings.aimed {
            return (straight + tail, NO_AIM);
        }
        match self.aiming.best_into(node.pose, disc, node.reverse()) {
            Some(aim) => {
                self.aims.push(aim);
                let cost = aim.cost + self.price.of_all_places(node.pose, aim.pieces());
                (cost.min(straight + DETOUR_CAP_M) + tail, self.aims.len() as u32 - 1)
            }
            None => (straight + DETOUR_CAP_M + tail, NO_AIM),
        }
    }

    /// A waypoint as a disc without extent, or the goal, and the metres from there on.
    fn target(&self, task: &Task<'_>, stage: u32) -> (GoalDisc, f64) {
        let index = stage as usize;
        if task.is_last(stage) {
            return (task.disc(), 0.0);
        }
        (GoalDisc { centre: task.waypoints[index], radius_m: 0.0 }, self.tails[index])
    }

    fn expand(&mut self, task: &Task<'_>, index: u32) {
        self.expansions += 1;
        let node = self.nodes[index as usize];
        let weight = self.settings.heuristic_weight;
        let to_pose = matches!(task.goal, Goal::Pose(_));
        if to_pose && task.is_last(node.stage) {
            self.push(node.cost + weight * node.ahead, node.cost, index, Step::Curve);
        }
        if self.settings.aimed {
            if node.aim != NO_AIM {
                self.offer(task, index, node.stage, node.aim);
            }
            let last = task.waypoints.len().saturating_sub(1) as u32;
            let ahead = node.stage + 1..=last.min(node.stage + AIM_AHEAD);
            for target in ahead.filter(|&target| !(to_pose && task.is_last(target))) {
                self.offer_aim(task, index, target);
            }
        }
        let (sin, cos) = ops::sin_cos(node.pose.heading);
        let centre = node.pose.position() + DVec2::new(cos, sin) * task.checker.body().centre_offset_m();
        let (disc, _) = self.target(task, node.stage);
        let gap = centre.distance(disc.centre);
        for (choice, motion) in self.lattice.into_iter().enumerate() {
            let undoes =
                motion.segment.curvature == node.motion.curvature && motion.segment.length_m == -node.motion.length_m;
            if undoes {
                continue;
            }
            let of_places = self.price.of_places(node.pose, motion.segment);
            let cost = node.cost + (self.price.of(motion.segment, node.reverse()) + of_places);
            let gained = gap - (centre + motion.centre_shift(sin, cos)).distance(disc.centre);
            let key = cost + weight * (node.ahead - 0.5 * (self.settings.step_m + gained) - of_places).max(0.0);
            self.push(key, cost, index, Step::Lattice { index: choice as u8 });
        }
    }

    /// Works out the best aim at a target and offers it.
    fn offer_aim(&mut self, task: &Task<'_>, index: u32, target: u32) {
        let node = self.nodes[index as usize];
        let (disc, _) = self.target(task, target);
        if let Some(aim) = self.aiming.best_into(node.pose, disc, node.reverse()) {
            self.aims.push(aim);
            self.offer(task, index, target, self.aims.len() as u32 - 1);
        }
    }

    /// Puts an aim on the list, to be swept when its turn comes.
    fn offer(&mut self, task: &Task<'_>, index: u32, target: u32, aim: u32) {
        let Node { cost, pose, .. } = self.nodes[index as usize];
        let (_, tail) = self.target(task, target);
        let ahead = &self.aims[aim as usize];
        let of_places = self.price.of_all_places(pose, ahead.pieces());
        let key = cost + self.settings.heuristic_weight * ((ahead.cost + of_places) + tail);
        self.push(key, cost, index, Step::Aimed { target, aim });
    }

    fn drive_lattice(&mut self, task: &Task<'_>, from: Candidate, choice: u8) -> Option<u32> {
        let node = self.nodes[from.node as usize];
        let motion = self.lattice[usize::from(choice)].segment;
        let pose = motion.end(node.pose);
        let free = !self.bins.dominates(pose, motion.is_reverse(), from.cost)
            && task.floor.motion_is_free(task.checker, node.pose, motion);
        if !free {
            return None;
        }
        self.reach(task, Node { pose, parent: from.node, motion, cost: from.cost, ..node })
    }

    fn drive_aimed(&mut self, task: &Task<'_>, from: Candidate, target: u32, aim: u32) -> Option<u32> {
        let Aim { turn, straight, .. } = self.aims[aim as usize];
        let start = self.nodes[from.node as usize];
        let turned = turn.end(start.pose);
        // The straight first: it is longer and farther from where the truck is known to fit.
        let is_free = |pose, piece| task.floor.motion_is_free(task.checker, pose, piece);
        if !is_free(turned, straight) || !is_free(start.pose, turn) {
            return None;
        }
        let mut node = Node { stage: target, ..start };
        let mut parent = from.node;
        for motion in [turn, straight] {
            if motion.length_m != 0.0 {
                let of_places = self.price.of_places(node.pose, motion);
                let cost = node.cost + (self.price.of(motion, node.reverse()) + of_places);
                node = Node { pose: motion.end(node.pose), parent, motion, cost, ..node };
                parent = self.nodes.len() as u32;
                self.nodes.push(node);
            }
        }
        // The last one is kept with its estimate instead.
        self.nodes.pop();
        self.reach(task, node)
    }

    /// Appends the way by a node into the goal pose, if the curve there is free.
    fn drive_curve(&self, task: &Task<'_>, index: u32, path: &mut Vec<Segment>) -> bool {
        let Goal::Pose(end) = task.goal else { unreachable!("curves are offered to poses only") };
        let start = self.nodes[index as usize].pose;
        let curve = self.curve(start, end);
        let mut pose = start;
        let is_free = curve.segments().all(|segment| {
            let from = pose;
            pose = segment.end(from);
            task.floor.motion_is_free(task.checker, from, segment)
        });
        if is_free {
            self.trace(index, path);
            path.extend(curve.segments());
        }
        is_free
    }

    /// The cheapest curve between two poses on a field where all places cost the same.
    fn curve(&self, from: Pose, to: Pose) -> Curve {
        self.curves.cheapest(from, to, &self.price.of_curves()).curve
    }

    /// Appends the way to a node.
    fn trace(&self, last: u32, path: &mut Vec<Segment>) {
        let first = path.len();
        let mut index = last;
        while self.nodes[index as usize].parent != ROOT {
            let node = &self.nodes[index as usize];
            path.push(node.motion);
            index = node.parent;
        }
        path[first..].reverse();
    }
}

/// Aims end on the goal's rim, give or take rounding; the caller's margin is larger.
const ROUNDING_M: f64 = 1e-6;
