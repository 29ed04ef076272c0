use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::planning::Goal;
use crate::planning::kit::best_first;
use crate::planning::kit::clearance_profile::ClearanceFloor;
use crate::planning::kit::closed_set::Bins;
use crate::planning::kit::heuristic::Lookout;
use crate::planning::memory::{BytesAfter, Growing, Held, MemoryMeter};
use crate::planning::reachability::Lattice;
use crate::vehicle::{Dimensions, Path, Segment};

use super::roadmap::{Level, Roadmap, least_length_m};
use super::tree::{Candidate, Reached, Step, Tree, Via};

/// Milestones as near as this to the start, or to the goal, are tried for a way from or to there.
const LINK_M: f64 = 40.0;
/// A goal with a free way from one of so many milestones about it is worth a search over the roadmap.
const GOAL_TRIES: usize = 60;
/// What estimates are multiplied with.
const WEIGHT: f64 = 1.2;
/// Poses off the roadmap that are expanded, and how far from the start at most.
const MAX_LOCAL_EXPANSIONS: u32 = 50;
const LOCAL_M: f64 = 30.0;
/// The lattice of poses about the start.
const LATTICE: Lattice = Lattice { bin_m: 2.5, headings: 24, step_m: 4.0 };

/// What one search is asked.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    pub checker: &'a CollisionChecker,
    pub lookout: &'a Lookout,
    pub floor: &'a ClearanceFloor,
    pub level: Level,
    pub start: Pose,
    pub goal: Goal,
}

/// A milestone and a direction in which it is reached, as a search sees it.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// The search that wrote the rest.
    generation: u64,
    is_closed: bool,
    ahead: f64,
    approach: Option<u32>,
}

/// A* over the milestones of a roadmap, each in both directions of driving, and over motions about the start.
///
/// What is known of the roadmap's edges from earlier searches saves time and changes no answer: candidates are ordered by
/// what holds for an edge whether it is known or not.
#[derive(Debug)]
pub struct Search {
    motions: [Segment; 6],
    tree: Tree,
    /// Two for each milestone.
    states: Vec<State>,
    generation: u64,
    /// Whether the path that the last search found leads over a milestone.
    used_roadmap: bool,
    /// Of the poses off the roadmap.
    bins: Bins,
    /// Whether a way leads to the goal from a milestone, where that was asked.
    roadmap_serves: Option<bool>,
    near: Vec<(f64, u32)>,
    memory: Held,
    /// Milestones, and poses off the roadmap, that the last search expanded.
    pub roadmap_expansions: u32,
    pub local_expansions: u32,
}

impl Search {
    pub fn new(body: &Dimensions, memory: &MemoryMeter, roadmap: &Roadmap) -> Self {
        Self {
            motions: best_first::motions(body, LATTICE.step_m),
            tree: Tree::default(),
            states: vec![State::default(); 2 * roadmap.node_count()],
            generation: 0,
            used_roadmap: false,
            bins: Bins::new(LATTICE.bin_m, LATTICE.headings),
            roadmap_serves: None,
            near: Vec::new(),
            memory: memory.holder(Growing::Searches),
            roadmap_expansions: 0,
            local_expansions: 0,
        }
    }

    /// Searches for a way into the goal.
    pub fn run(&mut self, task: &Task<'_>, roadmap: &mut Roadmap) -> Option<Path> {
        self.begin(task);
        while let Some(best) = self.tree.pop() {
            if !self.has_memory(roadmap) {
                return None;
            }
            match best.step {
                Step::Approach => {
                    if let Some(path) = self.arrive(task, roadmap, best.node) {
                        return Some(path);
                    }
                }
                Step::Expand => self.expand(task, roadmap, best),
                Step::Motion { index } => self.drive(task, best, index),
                Step::Curve { to } => self.work_out_curve(task, roadmap, best, to),
                Step::Link { link } => self.work_out_link(task, roadmap, best, link),
                Step::Enter { state, via } => self.enter(task, roadmap, best, state, via),
            }
        }
        None
    }

    /// Says whether there is memory for what one step adds: a pose, and what is offered from there.
    fn has_memory(&mut self, roadmap: &mut Roadmap) -> bool {
        let offered = self.motions.len().max(roadmap.most_links());
        let bytes = self.tree.bytes_after(offered) + self.near.bytes_after(0) + self.bins.bytes_after(1);
        roadmap.has_memory_for(1) && self.memory.cover(bytes)
    }

    /// Bytes that it takes for a roadmap of this number of nodes, before it searches.
    pub fn bytes(nodes: u64) -> u64 {
        2 * nodes * size_of::<State>() as u64
    }

    /// The most bytes that it takes on top of that while it searches a roadmap of these numbers of nodes and edges.
    pub fn most_bytes_at_work(nodes: u64, edges: u64) -> u64 {
        let local = u64::from(MAX_LOCAL_EXPANSIONS);
        // A node is reached in both directions of driving; each offers its links, each link the way by it.
        let (reached, candidates) = (2 * nodes + 6 * local, 2 * 2 * 2 * edges + nodes + 12 * local);
        Tree::most_bytes(reached, candidates) + Bins::most_bytes(6 * local)
    }

    /// Says whether the path that the last search found leads over a milestone.
    pub fn used_roadmap(&self) -> bool {
        self.used_roadmap
    }

    /// What the last search reached, and how.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    fn begin(&mut self, task: &Task<'_>) {
        self.generation += 1;
        self.tree.clear();
        self.bins.clear();
        self.roadmap_serves = None;
        (self.roadmap_expansions, self.local_expansions) = (0, 0);
        self.reach_off_roadmap(task, Reached::start(task.start));
    }

    /// What is estimated of the way from a pose to the goal, and the approach there.
    fn outlook(&mut self, task: &Task<'_>, pose: Pose, after_reverse: Option<bool>) -> (f64, Option<u32>) {
        let outlook = task.lookout.without_bushes(pose, after_reverse, task.goal);
        (outlook.to_go, outlook.approach.map(|approach| self.tree.add_approach(approach)))
    }

    /// Keeps a pose for its approach.
    fn reach(&mut self, reached: Reached) -> u32 {
        let index = self.tree.add(reached);
        if let Some(approach) = reached.approach {
            let key = reached.cost + WEIGHT * self.tree.approach(approach).cost;
            self.tree.push(key, reached.cost, index, Step::Approach);
        }
        index
    }

    /// Keeps a pose for its approach, and for motions from there.
    fn reach_off_roadmap(&mut self, task: &Task<'_>, reached: Reached) {
        self.bins.improve(reached.pose, reached.reverse == Some(true), reached.cost);
        let (ahead, approach) = self.outlook(task, reached.pose, reached.reverse);
        let index = self.reach(Reached { ahead, approach, ..reached });
        self.tree.push(reached.cost + WEIGHT * ahead, reached.cost, index, Step::Expand);
    }

    /// The whole path by way of a pose, if its approach is free.
    fn arrive(&mut self, task: &Task<'_>, roadmap: &mut Roadmap, index: u32) -> Option<Path> {
        let reached = self.tree.reached(index);
        let approach = reached.approach.expect("only approaches that exist are offered");
        if !task.floor.way_is_free(task.checker, reached.pose, self.tree.approach(approach).segments()) {
            return None;
        }
        self.used_roadmap = !matches!(reached.via, Via::Motion(_));
        let mut path = self.tree.path_to(index, roadmap);
        path.segments.extend(self.tree.approach(approach).segments());
        Some(path)
    }

    /// Offers the motions from a pose off the roadmap, and from the start curves to the milestones about it.
    fn expand(&mut self, task: &Task<'_>, roadmap: &Roadmap, from: Candidate) {
        let here = *self.tree.reached(from.node);
        if here.is_start() {
            self.offer_milestones(task, roadmap, from);
        }
        if self.local_expansions == MAX_LOCAL_EXPANSIONS || here.cost >= LOCAL_M {
            return;
        }
        self.local_expansions += 1;
        for (choice, motion) in self.motions.into_iter().enumerate() {
            let undoes = matches!(here.via, Via::Motion(last)
                if motion.curvature == last.curvature && motion.length_m == -last.length_m);
            if !undoes {
                let step_m = motion.length_m.abs();
                let cost = here.cost + step_m + cusp_cost(&here, motion.is_reverse(), roadmap);
                let key = cost + WEIGHT * (here.ahead - step_m).max(0.0);
                self.tree.push(key, cost, from.node, Step::Motion { index: choice as u8 });
            }
        }
    }

    fn offer_milestones(&mut self, task: &Task<'_>, roadmap: &Roadmap, from: Candidate) {
        roadmap.near(task.start.position(), LINK_M, &mut self.near);
        for &(_, to) in &self.near {
            let pose = roadmap.pose(to);
            let cost = least_length_m(task.checker.body().turning_radius_m, task.start, pose);
            let key = cost + WEIGHT * least_ahead(task, pose);
            self.tree.push(key.max(from.key), cost, from.node, Step::Curve { to });
        }
    }

    fn drive(&mut self, task: &Task<'_>, from: Candidate, choice: u8) {
        let motion = self.motions[usize::from(choice)];
        let start = self.tree.reached(from.node).pose;
        let (pose, reverse) = (motion.end(start), motion.is_reverse());
        let is_known = self.bins.dominates(pose, reverse, from.cost);
        if !is_known && task.floor.motion_is_free(task.checker, start, motion) {
            let (parent, via, cost) = (from.node, Via::Motion(motion), from.cost);
            let reached = Reached { pose, reverse: Some(reverse), parent, via, cost, ahead: 0.0, approach: None };
            self.reach_off_roadmap(task, reached);
        }
    }

    fn work_out_curve(&mut self, task: &Task<'_>, roadmap: &Roadmap, from: Candidate, to: u32) {
        if !*self.roadmap_serves.get_or_insert_with(|| leads_to_goal(task, roadmap, &mut self.near)) {
            return;
        }
        let here = *self.tree.reached(from.node);
        let (curves, price) = roadmap.curves();
        let way = curves.cheapest(here.pose, roadmap.pose(to), price);
        let mut segments = way.curve.segments();
        let Some(first) = segments.next().map(|segment| segment.is_reverse()) else { return };
        let last = segments.last().map_or(first, |segment| segment.is_reverse());
        let cost = here.cost + way.price + cusp_cost(&here, first, roadmap);
        let via = Via::Curve(self.tree.add_curve(way));
        self.offer(task, roadmap, Candidate { cost, ..from }, state_of(to, last), via);
    }

    fn work_out_link(&mut self, task: &Task<'_>, roadmap: &mut Roadmap, from: Candidate, number: u32) {
        let here = *self.tree.reached(from.node);
        let link = roadmap.link(number);
        let passage = roadmap.passage(link);
        let cost = here.cost + passage.cost + cusp_cost(&here, passage.departs_reverse, roadmap);
        let state = state_of(link.to, passage.arrives_reverse);
        self.offer(task, roadmap, Candidate { cost, ..from }, state, Via::Link(number));
    }

    /// Offers a state at the estimate of the whole way by it.
    fn offer(&mut self, task: &Task<'_>, roadmap: &Roadmap, from: Candidate, index: u32, via: Via) {
        if self.states[index as usize].generation != self.generation {
            let (ahead, approach) = self.outlook(task, roadmap.pose(index / 2), Some(index % 2 == 1));
            self.states[index as usize] = State { generation: self.generation, is_closed: false, ahead, approach };
        }
        let state = &self.states[index as usize];
        if !state.is_closed {
            let key = (from.cost + WEIGHT * state.ahead).max(from.key);
            self.tree.push(key, from.cost, from.node, Step::Enter { state: index, via });
        }
    }

    fn enter(&mut self, task: &Task<'_>, roadmap: &mut Roadmap, from: Candidate, index: u32, via: Via) {
        let State { is_closed, ahead, approach, .. } = self.states[index as usize];
        if is_closed || !self.is_free(task, roadmap, from.node, via) {
            return;
        }
        self.states[index as usize].is_closed = true;
        self.roadmap_expansions += 1;
        let node = index / 2;
        let (pose, reverse) = (roadmap.pose(node), Some(index % 2 == 1));
        let (parent, cost) = (from.node, from.cost);
        let reached = self.reach(Reached { pose, reverse, parent, via, cost, ahead, approach });
        for (number, link) in roadmap.links(node) {
            if self.is_closed(link.to, false) && self.is_closed(link.to, true) {
                continue;
            }
            let cost = from.cost + roadmap.least_m(node, link.to);
            let key = cost + WEIGHT * least_ahead(task, roadmap.pose(link.to));
            self.tree.push(key.max(from.key), cost, reached, Step::Link { link: number });
        }
    }

    fn is_free(&self, task: &Task<'_>, roadmap: &mut Roadmap, from: u32, via: Via) -> bool {
        match via {
            Via::Curve(curve) => {
                task.floor.way_is_free(task.checker, self.tree.reached(from).pose, self.tree.curve(curve))
            }
            Via::Link(link) => roadmap.is_free(roadmap.link(link).edge, task.level),
            Via::Motion(_) => unreachable!("motions lead to no milestone"),
        }
    }

    fn is_closed(&self, node: u32, reverse: bool) -> bool {
        let state = &self.states[state_of(node, reverse) as usize];
        state.generation == self.generation && state.is_closed
    }
}

/// The index of a milestone's state.
fn state_of(node: u32, reverse: bool) -> u32 {
    2 * node + u32::from(reverse)
}

fn cusp_cost(here: &Reached, departs_reverse: bool, roadmap: &Roadmap) -> f64 {
    if here.turns_back(departs_reverse) { roadmap.curves().1.cusp_m } else { 0.0 }
}

/// Whether a free way leads to the goal from a milestone about it.
fn leads_to_goal(task: &Task<'_>, roadmap: &Roadmap, near: &mut Vec<(f64, u32)>) -> bool {
    let (place, reach_m) = match task.goal {
        Goal::Pose(pose) => (pose.position(), LINK_M),
        Goal::Disc(disc) => (disc.centre, disc.radius_m + LINK_M),
    };
    roadmap.near(place, reach_m, near);
    near.iter().take(GOAL_TRIES).any(|&(_, node)| {
        let pose = roadmap.pose(node);
        let approach = task.lookout.without_bushes(pose, None, task.goal).approach;
        approach.is_some_and(|approach| task.floor.way_is_free(task.checker, pose, approach.segments()))
    })
}

/// What no way from a pose to the goal is shorter than.
fn least_ahead(task: &Task<'_>, pose: Pose) -> f64 {
    let body = task.checker.body();
    match task.goal {
        Goal::Pose(end) => least_length_m(body.turning_radius_m, pose, end),
        Goal::Disc(disc) => (pose.position().distance(disc.centre) - body.centre_offset_m() - disc.radius_m).max(0.0),
    }
}
