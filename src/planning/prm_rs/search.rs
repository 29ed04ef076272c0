use crate::collision::CollisionChecker;
use crate::geometry::{Pose, ops};
use crate::grid::open_list::OpenList;
use crate::planning::Goal;
use crate::planning::clearance_floor::ClearanceFloor;
use crate::planning::hybrid_astar::outlook::{Approach, Lookout};
use crate::planning::lattice_search;
use crate::vehicle::reeds_shepp::PricedCurve;
use crate::vehicle::{Path, Segment};

use super::roadmap::{Level, Roadmap};

/// Nodes as near as this to the start, or to the goal, are tried for a way from or to there.
const LINK_M: f64 = 40.0;
/// A goal with a free way from one of so many nodes about it is worth a search.
const GOAL_TRIES: usize = 60;
const WEIGHT: f64 = 1.0;

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

/// A node reached forward or in reverse.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    generation: u32,
    is_closed: bool,
    cost: f64,
    /// Estimated cost from here on.
    ahead: f64,
    parent: Option<Via>,
    /// Index of the way to the goal on an empty field.
    approach: Option<u32>,
}

/// How a state was reached.
#[derive(Clone, Copy, Debug)]
enum Via {
    /// By a curve from the start.
    Start {
        curve: u32,
    },
    Link {
        from: u32,
        link: u32,
    },
}

/// What is still to be judged.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// A curve from the start to a node is to be worked out.
    Leave,
    /// A state is to be entered.
    Enter(Via),
    /// An approach from a closed state to the goal is to be swept.
    Approach(u32),
}

type Candidate = lattice_search::Candidate<Step>;

/// A* over the nodes of a roadmap and the direction in which they are reached; its memory is kept between searches.
#[derive(Debug, Default)]
pub struct Search {
    states: Vec<State>,
    generation: u32,
    open: OpenList<Candidate>,
    sequence: u32,
    near: Vec<(f64, u32)>,
    starts: Vec<PricedCurve>,
    approaches: Vec<Approach>,
    /// States expanded by the last search.
    pub expansions: u32,
}

fn state_of(node: u32, reverse: bool) -> u32 {
    2 * node + u32::from(reverse)
}

impl Search {
    /// Searches for a way into the goal.
    pub fn run(&mut self, task: &Task<'_>, roadmap: &mut Roadmap) -> Option<Path> {
        self.begin(roadmap);
        if !self.goal_is_open(task, roadmap) {
            return None;
        }
        self.leave(task, roadmap);
        while let Some(best) = self.open.pop() {
            match best.step {
                Step::Leave => self.depart(task, roadmap, best),
                Step::Enter(via) => self.enter(task, roadmap, best, via),
                Step::Approach(approach) => {
                    let pose = roadmap.poses()[best.node as usize / 2];
                    let segments = self.approaches[approach as usize].segments();
                    if task.floor.way_is_free(task.checker, pose, segments) {
                        return Some(self.path(task, roadmap, best.node, approach));
                    }
                }
            }
        }
        None
    }

    fn begin(&mut self, roadmap: &Roadmap) {
        self.generation = self.generation.wrapping_add(1);
        if self.generation == 1 {
            self.states = vec![State::default(); 2 * roadmap.poses().len()];
        }
        self.open.clear();
        self.sequence = 0;
        self.starts.clear();
        self.approaches.clear();
        self.expansions = 0;
    }

    fn push(&mut self, key: f64, cost: f64, node: u32, step: Step) {
        self.open.push(Candidate { key, cost, sequence: self.sequence, node, step });
        self.sequence += 1;
    }

    /// Whether a free way leads to the goal from a node about it.
    fn goal_is_open(&mut self, task: &Task<'_>, roadmap: &Roadmap) -> bool {
        let (place, reach_m) = match task.goal {
            Goal::Pose(pose) => (pose.position(), LINK_M),
            Goal::Disc(disc) => (disc.centre, disc.radius_m + LINK_M),
        };
        roadmap.near(place, reach_m, &mut self.near);
        self.near.iter().take(GOAL_TRIES).any(|&(_, node)| {
            let pose = roadmap.poses()[node as usize];
            let approach = task.lookout.without_bushes(pose, None, task.goal).approach;
            approach.is_some_and(|approach| task.floor.way_is_free(task.checker, pose, approach.segments()))
        })
    }

    /// Offers curves to the nodes about the start.
    fn leave(&mut self, task: &Task<'_>, roadmap: &Roadmap) {
        let mut near = std::mem::take(&mut self.near);
        roadmap.near(task.start.position(), LINK_M, &mut near);
        let radius_m = roadmap.curves().0.radius_m;
        for &(distance, node) in &near {
            let pose = roadmap.poses()[node as usize];
            let turn = ops::wrap_angle(pose.heading - task.start.heading).abs();
            let bound = distance.max(radius_m * turn);
            self.push(bound + WEIGHT * least_ahead(task, pose), bound, node, Step::Leave);
        }
        self.near = near;
    }

    fn depart(&mut self, task: &Task<'_>, roadmap: &Roadmap, from: Candidate) {
        let pose = roadmap.poses()[from.node as usize];
        let (curves, price) = roadmap.curves();
        let way = curves.cheapest(task.start, pose, price);
        let reverse = way.curve.segments().last().is_some_and(|segment| segment.is_reverse());
        let state = state_of(from.node, reverse);
        self.starts.push(way);
        let via = Via::Start { curve: self.starts.len() as u32 - 1 };
        self.push((from.key - from.cost) + way.price, way.price, state, Step::Enter(via));
    }

    fn enter(&mut self, task: &Task<'_>, roadmap: &mut Roadmap, offer: Candidate, via: Via) {
        let index = offer.node;
        let node = index / 2;
        let pose = roadmap.poses()[node as usize];
        if self.states[index as usize].generation != self.generation {
            let outlook = task.lookout.without_bushes(pose, Some(index % 2 == 1), task.goal);
            let approach = outlook.approach.map(|approach| {
                self.approaches.push(approach);
                self.approaches.len() as u32 - 1
            });
            self.states[index as usize] =
                State { generation: self.generation, ahead: outlook.to_go, approach, ..State::default() };
        }
        let state = self.states[index as usize];
        if state.is_closed {
            return;
        }
        let key = offer.cost + WEIGHT * state.ahead;
        if key > offer.key + 1e-9 {
            self.push(key, offer.cost, index, offer.step);
            return;
        }
        let is_free = match via {
            Via::Start { curve } => {
                let segments = self.starts[curve as usize].curve.segments();
                task.floor.way_is_free(task.checker, task.start, segments)
            }
            Via::Link { link, .. } => roadmap.is_free(roadmap.link(link).edge, task.level),
        };
        if is_free {
            self.close(task, roadmap, offer, via);
        }
    }

    fn close(&mut self, task: &Task<'_>, roadmap: &Roadmap, offer: Candidate, via: Via) {
        self.expansions += 1;
        let index = offer.node;
        let state = &mut self.states[index as usize];
        (state.is_closed, state.cost, state.parent) = (true, offer.cost, Some(via));
        let (cost, key) = (state.cost, offer.key);
        if let Some(approach) = state.approach {
            let key = cost + WEIGHT * self.approaches[approach as usize].cost;
            self.push(key, cost, index, Step::Approach(approach));
        }
        let reverse = index % 2 == 1;
        let cusp_m = roadmap.curves().1.cusp_m;
        for (number, link) in roadmap.links(index / 2) {
            let to = state_of(link.to, link.arrives_reverse);
            let next = self.states[to as usize];
            let is_known = next.generation == self.generation;
            if is_known && next.is_closed {
                continue;
            }
            let cost = cost + link.cost + if link.departs_reverse == reverse { 0.0 } else { cusp_m };
            let ahead = if is_known { next.ahead } else { least_ahead(task, roadmap.poses()[link.to as usize]) };
            self.push(key.max(cost + WEIGHT * ahead), cost, to, Step::Enter(Via::Link { from: index, link: number }));
        }
    }

    fn path(&self, task: &Task<'_>, roadmap: &Roadmap, last: u32, approach: u32) -> Path {
        let mut vias = Vec::new();
        let mut via = self.states[last as usize].parent;
        while let Some(step) = via {
            vias.push(step);
            via = match step {
                Via::Start { .. } => None,
                Via::Link { from, .. } => self.states[from as usize].parent,
            };
        }
        let mut segments: Vec<Segment> = Vec::new();
        for via in vias.into_iter().rev() {
            match via {
                Via::Start { curve } => segments.extend(self.starts[curve as usize].curve.segments()),
                Via::Link { link, .. } => roadmap.append(roadmap.link(link), &mut segments),
            }
        }
        segments.extend(self.approaches[approach as usize].segments());
        Path { start: task.start, segments }
    }
}

/// What no way from a pose to the goal is shorter than.
fn least_ahead(task: &Task<'_>, pose: Pose) -> f64 {
    match task.goal {
        Goal::Pose(end) => {
            let turn = ops::wrap_angle(end.heading - pose.heading).abs();
            pose.position().distance(end.position()).max(task.checker.body().turning_radius_m * turn)
        }
        Goal::Disc(disc) => {
            let ahead_m = task.checker.body().centre_offset_m();
            (pose.position().distance(disc.centre) - ahead_m - disc.radius_m).max(0.0)
        }
    }
}
