//! The best-first search over poses that all planners with lattice motions share.
//!
//! Forward search over a lattice of (x, y, heading) with exact arcs and straights, as in D. Dolgov, S. Thrun,
//! M. Montemerlo, J. Diebel, "Path planning for autonomous vehicles in unknown semi-structured environments", IJRR 29(5),
//! 2010, section 3. Motions are swept only when their turn comes (R. Bohlin, L. E. Kavraki, "Path planning using lazy
//! PRM", ICRA 2000), and analytic expansions wait in the same queue, at what the whole path would cost.
//!
//! What a planner adds is a [`SearchSpace`]: its heuristic, what follows a pose, and steps of its own. It is a type
//! parameter, so that the compiler knows all of it in the inner loop. Poses are those of the rear axle; world frame,
//! metres.

use glam::DVec2;

use crate::memory::{CapacityBytes, MemoryKind, MemoryMeter, MemoryShare};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Dimensions, Path, Segment};
use wildfire_grid::open_list::{OpenList, Ranked};

use super::clearance_profile::longest_first;
use super::closed_set::ClosedSet;
use super::lattice::{Lattice, motions};
use super::motion_price::MotionPrice;

/// The parent of a start.
pub const ROOT: u32 = u32::MAX;

/// Segments of the longest Reeds-Shepp word.
const MAX_SEGMENTS: usize = 5;

/// The motion of a node that no lattice motion led to.
pub const NO_MOTION: Segment = Segment { curvature: 0.0, length_m: 0.0 };

/// A path into the goal that may collide: a Reeds-Shepp curve, or a turn and a straight into a disc.
#[derive(Clone, Copy, Debug)]
pub struct AnalyticExpansion {
    segments: [Segment; MAX_SEGMENTS],
    count: usize,
    /// The cost of its motions and cusps, including a first cusp after the drive so far.
    pub cost: f64,
}

impl AnalyticExpansion {
    pub fn new(way: impl IntoIterator<Item = Segment>, cost: f64) -> Self {
        let mut expansion = Self { segments: [NO_MOTION; MAX_SEGMENTS], count: 0, cost };
        for (place, segment) in expansion.segments.iter_mut().zip(way) {
            *place = segment;
            expansion.count += 1;
        }
        expansion
    }

    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        self.segments[..self.count].iter().copied()
    }
}

/// A reached pose; `M` is the search space's mark on it.
#[derive(Clone, Copy, Debug)]
pub struct Node<M> {
    pub pose: Pose,
    /// The node that it was reached from, or [`ROOT`].
    pub parent: u32,
    /// The motion from its parent.
    pub motion: Segment,
    /// The direction in which it was reached; `None` for a start.
    pub reverse: Option<bool>,
    pub cost: f64,
    /// Estimated cost from here to the goal.
    pub cost_to_go: f64,
    pub mark: M,
}

impl<M> Node<M> {
    fn start(pose: Pose, mark: M) -> Self {
        Self { pose, parent: ROOT, motion: NO_MOTION, reverse: None, cost: 0.0, cost_to_go: 0.0, mark }
    }

    /// Returns whether a drive that goes on in this direction has a cusp here.
    pub fn turns_back(&self, departs_reverse: bool) -> bool {
        self.reverse.is_some_and(|reverse| reverse != departs_reverse)
    }

    /// Returns whether a motion leads back to the parent.
    pub fn is_undone_by(&self, motion: Segment) -> bool {
        motion.curvature == self.motion.curvature && motion.length_m == -self.motion.length_m
    }
}

/// A step from a node that has not been tested yet.
#[derive(Clone, Copy, Debug)]
pub enum Step<S> {
    /// Sweep the node's analytic expansion.
    Arrive,
    /// Offer the steps that may follow the node.
    Expand,
    /// Sweep a motion of the lattice. So many of those after it have the same key and cost, and come after it in order.
    Motion { index: u8, alike: u8 },
    /// A step defined by the search space.
    Custom(S),
}

/// The step type of search spaces that define none.
#[derive(Clone, Copy, Debug)]
pub enum Never {}

/// A step waiting in the open list.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<S> {
    pub key: f64,
    pub cost: f64,
    /// Order of insertion, which decides between equals.
    sequence: u32,
    pub node: u32,
    pub step: Step<S>,
}

impl<S> Candidate<S> {
    /// Returns the same at another cost so far.
    pub fn at_cost(self, cost: f64) -> Self {
        Self { cost, ..self }
    }
}

impl<S> Ranked for Candidate<S> {
    type Tie = u32;

    fn priority(&self) -> f64 {
        self.key
    }

    fn cost(&self) -> f64 {
        self.cost
    }

    fn tie(&self) -> u32 {
        self.sequence
    }
}

/// The reason why a search found no path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchFailure {
    /// All motions of the lattice were tried.
    Exhausted,
    BudgetSpent,
}

/// The search of a space.
pub type SearchOf<P> = PoseSearch<<P as SearchSpace>::Mark, <P as SearchSpace>::Custom>;

/// The problem that a [`PoseSearch`] searches.
pub trait SearchSpace: Sized {
    /// The notes about a node.
    type Mark: Copy;
    /// Steps besides motions of the lattice.
    type Custom: Copy;

    /// True for a search without cost-to-go: it offers what follows a node as soon as the node is reached, so that the
    /// queue holds motions alone, and may come back to its start.
    const IS_UNINFORMED: bool = false;

    /// Returns whether there is memory for what one step adds.
    fn has_room(&mut self, search: &mut SearchOf<Self>) -> bool;

    /// Returns what costs-to-go are multiplied with in the keys of the open list.
    fn weight(&self) -> f64;

    /// Fills in a node's cost-to-go and mark; returns the cost of its analytic expansion, if that is to wait for its
    /// turn from now on.
    fn estimate(&mut self, node: &mut Node<Self::Mark>) -> Option<f64>;

    /// Returns the analytic expansion of a node for which one was offered.
    fn analytic_expansion(&self, node: &Node<Self::Mark>) -> AnalyticExpansion;

    /// Offers what may follow a node.
    fn offer_successors(&mut self, search: &mut SearchOf<Self>, from: Candidate<Self::Custom>);

    /// Returns whether the body may drive a motion.
    fn motion_is_free(&self, from: Pose, motion: Segment) -> bool;

    /// Takes a step of its own; returns the node that it reaches, if that is a goal.
    fn take(&mut self, search: &mut SearchOf<Self>, from: Candidate<Self::Custom>, step: Self::Custom) -> Option<u32>;

    /// Returns whether a pose is a goal. Starts are not asked.
    fn is_goal(&mut self, _pose: Pose) -> bool {
        false
    }

    /// Appends the segments that lead from a node's parent to the node.
    fn append_way(&mut self, node: &Node<Self::Mark>, segments: &mut Vec<Segment>) {
        segments.push(node.motion);
    }
}

/// A* over poses; its memory is kept between searches. `M` marks nodes, `S` are steps besides motions.
///
/// A search can be resumed where its budget ended.
#[derive(Debug)]
pub struct PoseSearch<M, S> {
    pub motions: [Segment; 6],
    nodes: Vec<Node<M>>,
    open: OpenList<Candidate<S>>,
    closed: ClosedSet,
    sequence: u32,
    memory: MemoryShare,
    /// The nodes expanded since the search began.
    pub expansions: u32,
}

impl<M: Copy, S: Copy> PoseSearch<M, S> {
    pub fn new(body: &Dimensions, lattice: Lattice, memory: &MemoryMeter) -> Self {
        Self {
            motions: motions(body, lattice.step_m),
            nodes: Vec::new(),
            open: OpenList::default(),
            closed: ClosedSet::new(lattice.bin_m, lattice.headings),
            sequence: 0,
            memory: memory.holder(MemoryKind::Searches),
            expansions: 0,
        }
    }

    /// Begins a search from any of some poses with their marks; of several in a bin, the first counts.
    pub fn begin<P: SearchSpace<Mark = M, Custom = S>>(
        &mut self,
        space: &mut P,
        starts: impl IntoIterator<Item = Pose>,
        mark: M,
    ) {
        self.nodes.clear();
        self.open.clear();
        self.closed.clear();
        self.sequence = 0;
        self.expansions = 0;
        // An uninformed search may come back to its start, so the start does not take its bin.
        for pose in starts {
            if P::IS_UNINFORMED || self.closed.improve(pose, false, 0.0) {
                self.keep(space, Node::start(pose, mark));
            }
        }
    }

    /// Continues the search until it has found a path or expanded `limit` nodes in all.
    ///
    /// # Errors
    /// The reason why there is no path, or none yet.
    pub fn run<P: SearchSpace<Mark = M, Custom = S>>(
        &mut self,
        space: &mut P,
        limit: u32,
    ) -> Result<Path, SearchFailure> {
        // What comes next without having been in the open list.
        let mut next = None;
        while let Some(best) = next.take().or_else(|| self.open.pop()) {
            // Memory is asked for before the step, which could otherwise exceed it; a refusal ends like a spent budget.
            if !space.has_room(self) {
                return Err(SearchFailure::BudgetSpent);
            }
            let at_goal = match best.step {
                Step::Arrive => {
                    // The whole way into the goal is as cheap as anything else promises to be: if it is free, it wins.
                    if let Some(path) = self.arrive(space, best.node) {
                        return Ok(path);
                    }
                    None
                }
                Step::Expand if self.expansions == limit => {
                    // The step goes back, so that a resumed search expands this node first.
                    self.open.push(best);
                    return Err(SearchFailure::BudgetSpent);
                }
                Step::Expand => {
                    self.expansions += 1;
                    space.offer_successors(self, best);
                    None
                }
                Step::Motion { index, alike } => {
                    let at_goal = self.drive(space, best, index);
                    if alike > 0 {
                        let step = Step::Motion { index: index + 1, alike: alike - 1 };
                        // The rest keeps the place in the order that it would have had as a candidate of its own.
                        let rest = Candidate { sequence: best.sequence + 1, step, ..best };
                        // Mostly nothing comes in between, which saves a push and a pop.
                        if self.open.is_next(&rest) {
                            next = Some(rest);
                        } else {
                            self.open.push(rest);
                        }
                    }
                    at_goal
                }
                Step::Custom(step) => space.take(self, best, step),
            };
            if let Some(node) = at_goal {
                return Ok(self.path_to(space, node));
            }
        }
        Err(SearchFailure::Exhausted)
    }

    /// Adds a step to the open list.
    pub fn push(&mut self, key: f64, cost: f64, node: u32, step: Step<S>) {
        self.open.push(Candidate { key, cost, sequence: self.sequence, node, step });
        self.sequence += 1;
    }

    /// Offers the motions of the lattice from a node.
    ///
    /// Their keys rest on the node's own cost-to-go, from which a motion takes off no more than it costs: most are
    /// never swept, and none is worked out before.
    pub fn offer_motions(&mut self, index: u32, price: &MotionPrice, weight: f64) {
        let node = &self.nodes[index as usize];
        let mut alike: Option<Candidate<S>> = None;
        // Straight back lies the parent, which was reached at less cost.
        for (choice, motion) in (0..).zip(self.motions).filter(|&(_, motion)| !node.is_undone_by(motion)) {
            let length_price = motion.length_m.abs() * price.rate(motion);
            let cost = node.cost + length_price + if node.turns_back(motion.is_reverse()) { price.cusp() } else { 0.0 };
            // Close to the goal a motion is longer than what is left, and no key may fall below the cost.
            let key = cost + weight * (node.cost_to_go - length_price).max(0.0);
            match &mut alike {
                Some(Candidate {
                    key: its_key, cost: its_cost, step: Step::Motion { index: first, alike }, ..
                }) if key == *its_key && cost == *its_cost && choice == *first + *alike + 1 => {
                    *alike += 1;
                }
                waiting => {
                    let step = Step::Motion { index: choice, alike: 0 };
                    let next = Candidate { key, cost, sequence: self.sequence, node: index, step };
                    self.open.extend(waiting.replace(next));
                }
            }
            self.sequence += 1;
        }
        self.open.extend(alike);
    }

    /// Returns true if the bin of a pose is known to be reached as cheaply.
    pub fn is_dominated(&self, pose: Pose, reverse: bool, cost: f64) -> bool {
        self.closed.dominates(pose, reverse, cost)
    }

    /// Keeps a node unless its bin is known to be reached as cheaply; returns its index if it is a goal.
    pub fn reach<P: SearchSpace<Mark = M, Custom = S>>(&mut self, space: &mut P, node: Node<M>) -> Option<u32> {
        // A goal ends the search even if its bin was reached before at less cost.
        if space.is_goal(node.pose) {
            return Some(self.add(node));
        }
        if self.closed.improve(node.pose, node.reverse == Some(true), node.cost) {
            self.keep(space, node);
        }
        None
    }

    /// Adds a node that is not examined any further.
    pub fn add(&mut self, node: Node<M>) -> u32 {
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    pub fn node(&self, index: u32) -> &Node<M> {
        &self.nodes[index as usize]
    }

    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Returns the nodes in the order in which they were reached, each after its parent's position.
    pub fn nodes(&self) -> impl Iterator<Item = (&Node<M>, [DVec2; 2])> {
        self.nodes.iter().map(|node| {
            let from = if node.parent == ROOT { node } else { self.node(node.parent) };
            (node, [from, node].map(|node| node.pose.position()))
        })
    }

    /// Returns where the reached poses are, in order, each after the one that it came from.
    pub fn lines(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.nodes().map(|(_, line)| line)
    }

    /// Returns the bytes in use after adding these numbers of nodes and candidates, and one bin.
    pub fn bytes_after(&self, nodes: usize, candidates: usize) -> usize {
        self.nodes.bytes_after(nodes) + self.open.bytes_after(candidates) + self.closed.bytes_after(1)
    }

    /// Returns whether it may hold this many bytes.
    pub fn may_hold(&mut self, bytes: usize) -> bool {
        self.memory.cover(bytes)
    }

    fn keep<P: SearchSpace<Mark = M, Custom = S>>(&mut self, space: &mut P, mut node: Node<M>) {
        let analytic = space.estimate(&mut node);
        let Node { cost, cost_to_go, .. } = node;
        let index = self.add(node);
        // Without an estimate each expansion would be popped at once: offering it here saves a push and a pop.
        if P::IS_UNINFORMED {
            let step = Step::Expand;
            space.offer_successors(self, Candidate { key: cost, cost, sequence: self.sequence, node: index, step });
            return;
        }
        if let Some(analytic) = analytic {
            // It waits like everything else: a sweep of a curve that costs more than another way would be wasted.
            self.push(cost + space.weight() * analytic, cost, index, Step::Arrive);
        }
        // A pose from which the heuristic knows no way is no use.
        if cost_to_go < f64::INFINITY {
            self.push(cost + space.weight() * cost_to_go, cost, index, Step::Expand);
        }
    }

    fn drive<P: SearchSpace<Mark = M, Custom = S>>(
        &mut self,
        space: &mut P,
        from: Candidate<S>,
        index: u8,
    ) -> Option<u32> {
        let motion = self.motions[usize::from(index)];
        let Node { pose: start, mark, .. } = self.nodes[from.node as usize];
        let pose = motion.end(start);
        let reverse = motion.is_reverse();
        // The bin is asked first, because a sweep costs much more.
        if self.is_dominated(pose, reverse, from.cost) || !space.motion_is_free(start, motion) {
            return None;
        }
        let (parent, cost) = (from.node, from.cost);
        // The parent's mark goes along; `estimate` replaces it where the space has one of its own.
        self.reach(space, Node { pose, parent, motion, reverse: Some(reverse), cost, cost_to_go: 0.0, mark })
    }

    /// Returns the whole path by way of a node, if its analytic expansion is free.
    fn arrive<P: SearchSpace<Mark = M, Custom = S>>(&mut self, space: &mut P, index: u32) -> Option<Path> {
        let expansion = space.analytic_expansion(self.node(index));
        // Most are in the way of something, above all in their long segments.
        let mut segments = longest_first(self.node(index).pose, expansion.segments());
        if !segments.all(|(from, segment)| space.motion_is_free(from, segment)) {
            return None;
        }
        let mut path = self.path_to(space, index);
        path.segments.extend(expansion.segments());
        Some(path)
    }

    /// Returns the way from a start to a node.
    fn path_to<P: SearchSpace<Mark = M, Custom = S>>(&self, space: &mut P, last: u32) -> Path {
        let mut way = Vec::new();
        let mut index = last;
        while self.node(index).parent != ROOT {
            way.push(index);
            index = self.node(index).parent;
        }
        let mut segments = Vec::with_capacity(way.len());
        for &node in way.iter().rev() {
            space.append_way(self.node(node), &mut segments);
        }
        Path { start: self.node(index).pose, segments }
    }
}
