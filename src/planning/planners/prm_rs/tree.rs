use glam::DVec2;

use crate::geometry::Pose;
use crate::grid::open_list::OpenList;
use crate::planning::kit::best_first;
use crate::planning::kit::heuristic::Approach;
use crate::planning::memory::BytesAfter;
use crate::vehicle::reeds_shepp::PricedCurve;
use crate::vehicle::{Path, Segment};

use super::roadmap::Roadmap;

/// The parent of the start.
const NOBODY: u32 = u32::MAX;

/// A pose that was reached.
#[derive(Clone, Copy, Debug)]
pub struct Reached {
    pub pose: Pose,
    /// Whether it was reached in reverse; nothing is said about the start.
    pub reverse: Option<bool>,
    pub parent: u32,
    pub via: Via,
    pub cost: f64,
    /// Estimated cost from here on.
    pub ahead: f64,
    /// Index of the way to the goal on an empty field.
    pub approach: Option<u32>,
}

/// How a pose was reached.
#[derive(Clone, Copy, Debug)]
pub enum Via {
    Motion(Segment),
    /// A curve of this search.
    Curve(u32),
    /// A link of the roadmap.
    Link(u32),
}

impl Reached {
    /// A start of which nothing is estimated.
    pub fn start(pose: Pose) -> Self {
        let via = Via::Motion(Segment { curvature: 0.0, length_m: 0.0 });
        Self { pose, reverse: None, parent: NOBODY, via, cost: 0.0, ahead: 0.0, approach: None }
    }

    pub fn is_start(&self) -> bool {
        self.parent == NOBODY
    }

    /// Whether a drive that goes on like this changes its direction here.
    pub fn turns_back(&self, departs_reverse: bool) -> bool {
        self.reverse.is_some_and(|reverse| reverse != departs_reverse)
    }
}

/// What is still to be judged, from a pose that was reached.
#[derive(Clone, Copy, Debug)]
pub enum Step {
    /// The approach to the goal is to be swept.
    Approach,
    /// Motions are to be offered.
    Expand,
    /// A motion is to be swept.
    Motion { index: u8 },
    /// The curve to a milestone is to be worked out.
    Curve { to: u32 },
    /// The curve of a link is to be worked out.
    Link { link: u32 },
    /// A curve to a milestone is to be swept.
    Enter { state: u32, via: Via },
}

pub type Candidate = best_first::Candidate<Step>;

/// The poses that a search reached, how, and what waits to be judged; its memory is kept.
#[derive(Debug, Default)]
pub struct Tree {
    reached: Vec<Reached>,
    curves: Vec<PricedCurve>,
    approaches: Vec<Approach>,
    open: OpenList<Candidate>,
    sequence: u32,
}

impl Tree {
    pub fn clear(&mut self) {
        self.reached.clear();
        self.curves.clear();
        self.approaches.clear();
        self.open.clear();
        self.sequence = 0;
    }

    /// Bytes that it takes once a step has added a pose, a curve, two approaches and this number of candidates.
    pub fn bytes_after(&self, candidates: usize) -> usize {
        let lists = self.reached.bytes_after(1) + self.curves.bytes_after(1) + self.approaches.bytes_after(2);
        lists + self.open.bytes_after(candidates)
    }

    /// The most bytes that reached poses with their approaches, and candidates, take in these numbers, in lists that
    /// double.
    pub fn most_bytes(reached: u64, candidates: u64) -> u64 {
        let of_each = size_of::<Reached>() + size_of::<PricedCurve>() + size_of::<Approach>();
        2 * (reached * of_each as u64 + candidates * size_of::<Candidate>() as u64)
    }

    pub fn push(&mut self, key: f64, cost: f64, node: u32, step: Step) {
        self.open.push(Candidate { key, cost, sequence: self.sequence, node, step });
        self.sequence += 1;
    }

    pub fn pop(&mut self) -> Option<Candidate> {
        self.open.pop()
    }

    pub fn add(&mut self, reached: Reached) -> u32 {
        self.reached.push(reached);
        self.reached.len() as u32 - 1
    }

    pub fn reached(&self, index: u32) -> &Reached {
        &self.reached[index as usize]
    }

    pub fn add_curve(&mut self, curve: PricedCurve) -> u32 {
        self.curves.push(curve);
        self.curves.len() as u32 - 1
    }

    pub fn curve(&self, index: u32) -> impl Iterator<Item = Segment> {
        self.curves[index as usize].curve.segments()
    }

    pub fn add_approach(&mut self, approach: Approach) -> u32 {
        self.approaches.push(approach);
        self.approaches.len() as u32 - 1
    }

    pub fn approach(&self, index: u32) -> &Approach {
        &self.approaches[index as usize]
    }

    /// Where the poses are that were reached by motions, or by curves to milestones and links between them, in order,
    /// each after the one that it came from.
    pub fn lines(&self, by_motions: bool) -> impl Iterator<Item = [DVec2; 2]> {
        let reached = self.reached.iter().filter(move |pose| matches!(pose.via, Via::Motion(_)) == by_motions);
        reached.map(|pose| {
            let from = if pose.is_start() { pose } else { self.reached(pose.parent) };
            [from, pose].map(|reached| reached.pose.position())
        })
    }

    /// The way from the start to a pose.
    pub fn path_to(&self, last: u32, roadmap: &mut Roadmap) -> Path {
        let mut way = Vec::new();
        let mut index = last;
        while !self.reached(index).is_start() {
            way.push(self.reached(index).via);
            index = self.reached(index).parent;
        }
        let mut segments = Vec::new();
        for via in way.into_iter().rev() {
            match via {
                Via::Motion(motion) => segments.push(motion),
                Via::Curve(curve) => segments.extend(self.curve(curve)),
                Via::Link(link) => roadmap.append(roadmap.link(link), &mut segments),
            }
        }
        Path { start: self.reached(index).pose, segments }
    }
}
