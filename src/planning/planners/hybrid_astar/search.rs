use glam::DVec2;

use super::HybridSettings;
use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::grid::open_list::OpenList;
use crate::planning::Goal;
use crate::planning::kit::best_first;
use crate::planning::kit::clearance_profile::ClearanceFloor;
use crate::planning::kit::closed_set::Bins;
use crate::planning::kit::local_search::Ending;
use crate::planning::memory::{BytesAfter, Growing, Held, MemoryMeter};
use crate::planning::reachability::Lattice;
use crate::vehicle::{Dimensions, Path, Segment};

use crate::planning::kit::heuristic::{Approach, Lookout};
use crate::planning::kit::holonomic::{Cells, Wave};

const ROOT: u32 = u32::MAX;

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
    approach: Option<Approach>,
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
    /// The approach from a reached node to the goal is to be swept.
    Approach,
    /// A reached node is to be expanded.
    Expand,
    /// A lattice motion from the node is to be swept.
    Lattice { index: u8 },
}

type Candidate = best_first::Candidate<Step>;

/// What one search is asked.
#[derive(Debug)]
pub struct Task<'a> {
    pub checker: &'a CollisionChecker,
    pub lookout: &'a Lookout,
    pub floor: &'a ClearanceFloor,
    pub goal: Goal,
    pub cells: &'a Cells,
    /// Towards the goal.
    pub wave: &'a mut Wave,
}

/// A* over poses with lattice motions; its memory is kept between searches.
///
/// A search can be carried on where its budget let it end.
#[derive(Debug)]
pub struct Search {
    step_m: f64,
    cusp_cost: f64,
    weight: f64,
    motions: [Segment; 6],
    nodes: Vec<Node>,
    open: OpenList<Candidate>,
    bins: Bins,
    sequence: u32,
    memory: Held,
}

impl Search {
    pub fn new(settings: &HybridSettings, lattice: Lattice, body: &Dimensions, memory: &MemoryMeter) -> Self {
        Self {
            step_m: lattice.step_m,
            cusp_cost: settings.cusp_cost,
            weight: settings.heuristic_weight,
            motions: best_first::motions(body, lattice.step_m),
            nodes: Vec::new(),
            open: OpenList::default(),
            bins: Bins::new(lattice.bin_m, lattice.headings),
            sequence: 0,
            memory: memory.holder(Growing::Searches),
        }
    }

    /// Begins a search from any of some poses; of several in a bin, the first counts.
    pub fn begin(&mut self, task: &mut Task<'_>, starts: impl IntoIterator<Item = Pose>) {
        self.nodes.clear();
        self.open.clear();
        self.bins.clear();
        self.sequence = 0;
        let motion = Segment { curvature: 0.0, length_m: 0.0 };
        for pose in starts {
            if !self.bins.dominates(pose, false, 0.0) {
                self.reach(task, Node { pose, parent: ROOT, motion, cost: 0.0, ahead: 0.0, approach: None });
            }
        }
    }

    /// Carries the search for a way into the goal on by up to `budget` expansions, and tells how many it took.
    pub fn carry_on(&mut self, task: &mut Task<'_>, budget: u32) -> (Result<Path, Ending>, u32) {
        let mut spent = 0;
        while let Some(best) = self.open.pop() {
            if !self.has_memory() {
                return (Err(Ending::BudgetSpent), spent);
            }
            match best.step {
                Step::Approach => {
                    if let Some(path) = self.arrive(task, best.node) {
                        return (Ok(path), spent);
                    }
                }
                Step::Expand if spent == budget => {
                    self.open.push(best);
                    return (Err(Ending::BudgetSpent), spent);
                }
                Step::Expand => {
                    spent += 1;
                    self.expand(best.node);
                }
                Step::Lattice { index } => self.drive(task, best, index),
            }
        }
        (Err(Ending::Exhausted), spent)
    }

    /// Says whether there is memory for what one step adds: a pose with its approach, or the motions that follow one.
    fn has_memory(&mut self) -> bool {
        let lists = self.nodes.bytes_after(1) + self.open.bytes_after(self.motions.len());
        self.memory.cover(lists + self.bins.bytes_after(1))
    }

    /// The most bytes that a search takes if it expands up to this number of nodes.
    pub fn most_bytes(expansions: u32) -> u64 {
        // A node is left by all motions but the one back; each new one waits twice, for its approach and to be
        // expanded.
        let (nodes, entries) = (5, 5 + 2 * 5);
        let lists = nodes * size_of::<Node>() as u64 + entries * size_of::<Candidate>() as u64;
        // Lists that double may have room for twice as many.
        2 * u64::from(expansions) * lists + Bins::most_bytes(nodes * u64::from(expansions))
    }

    /// Where the poses are that the search reached, in order, each after the one that it came from.
    pub fn reached(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.nodes.iter().map(|node| {
            let from = if node.parent == ROOT { node } else { &self.nodes[node.parent as usize] };
            [from, node].map(|node| node.pose.position())
        })
    }

    fn push(&mut self, key: f64, cost: f64, node: u32, step: Step) {
        self.open.push(Candidate { key, cost, sequence: self.sequence, node, step });
        self.sequence += 1;
    }

    /// Keeps a node for its approach, and for expansion.
    fn reach(&mut self, task: &mut Task<'_>, mut node: Node) {
        self.bins.improve(node.pose, node.motion.is_reverse(), node.cost);
        let outlook = task.lookout.outlook(node.pose, node.reverse(), task.goal, (task.cells, task.wave));
        (node.ahead, node.approach) = (outlook.to_go, outlook.approach);
        let index = self.nodes.len() as u32;
        self.nodes.push(node);
        if let Some(approach) = outlook.approach {
            self.push(node.cost + self.weight * approach.cost, node.cost, index, Step::Approach);
        }
        // What no walker reaches, no truck does.
        if outlook.to_go < f64::INFINITY {
            self.push(node.cost + self.weight * outlook.to_go, node.cost, index, Step::Expand);
        }
    }

    /// Offers the motions from a node with the node's own estimate, so that most are never swept.
    fn expand(&mut self, index: u32) {
        let node = self.nodes[index as usize];
        for (choice, motion) in self.motions.into_iter().enumerate() {
            let undoes = motion.curvature == node.motion.curvature && motion.length_m == -node.motion.length_m;
            if !undoes {
                let cost = self.cost_after(&node, motion);
                let key = cost + self.weight * (node.ahead - self.step_m).max(0.0);
                self.push(key, cost, index, Step::Lattice { index: choice as u8 });
            }
        }
    }

    fn cost_after(&self, node: &Node, motion: Segment) -> f64 {
        let turns_back = node.reverse().is_some_and(|reverse| reverse != motion.is_reverse());
        node.cost + motion.length_m.abs() + if turns_back { self.cusp_cost } else { 0.0 }
    }

    fn drive(&mut self, task: &mut Task<'_>, from: Candidate, choice: u8) {
        let motion = self.motions[usize::from(choice)];
        let start = self.nodes[from.node as usize].pose;
        let pose = motion.end(start);
        let is_known = self.bins.dominates(pose, motion.is_reverse(), from.cost);
        if !is_known && task.floor.motion_is_free(task.checker, start, motion) {
            self.reach(task, Node { pose, parent: from.node, motion, cost: from.cost, ahead: 0.0, approach: None });
        }
    }

    /// The whole path by way of a node, if its approach is free.
    fn arrive(&self, task: &Task<'_>, index: u32) -> Option<Path> {
        let node = &self.nodes[index as usize];
        let approach = node.approach.expect("only approaches that exist are offered");
        if !task.floor.way_is_free(task.checker, node.pose, approach.segments()) {
            return None;
        }
        let mut segments = Vec::new();
        let mut index = index;
        while self.nodes[index as usize].parent != ROOT {
            let node = &self.nodes[index as usize];
            segments.push(node.motion);
            index = node.parent;
        }
        segments.reverse();
        segments.extend(approach.segments());
        Some(Path { start: self.nodes[index as usize].pose, segments })
    }
}
