use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::grid::open_list::OpenList;
use crate::planning::Goal;
use crate::planning::clearance_floor::ClearanceFloor;
use crate::planning::hybrid_astar::outlook::{Approach, Lookout};
use crate::planning::lattice_search;
use crate::planning::primitives::Bins;
use crate::vehicle::reeds_shepp::PricedCurve;
use crate::vehicle::{Dimensions, Path, Segment};

use super::knob;
use super::roadmap::{Level, Roadmap, least_length_m};

/// Milestones as near as this to the start, or to the goal, are tried for a way from or to there.
const LINK_M: f64 = 40.0;
/// A goal with a free way from one of so many milestones about it is worth a search over the roadmap.
const GOAL_TRIES: usize = 60;

const ROOT: u32 = u32::MAX;

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

/// A milestone and a direction in which it is reached, as the search sees it.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    generation: u32,
    is_closed: bool,
    ahead: f64,
    approach: Option<u32>,
}

/// A pose that was reached.
#[derive(Clone, Copy, Debug)]
struct Reached {
    pose: Pose,
    /// Whether it was reached in reverse; nothing is said about the start.
    reverse: Option<bool>,
    parent: u32,
    via: Via,
    cost: f64,
    /// Estimated cost from here on.
    ahead: f64,
    /// Index of the way to the goal on an empty field.
    approach: Option<u32>,
}

/// How a pose was reached.
#[derive(Clone, Copy, Debug)]
enum Via {
    Motion(Segment),
    /// A curve of this search.
    Curve(u32),
    /// A link of the roadmap.
    Link(u32),
}

/// What is still to be judged, from a pose that was reached.
#[derive(Clone, Copy, Debug)]
enum Step {
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

type Candidate = lattice_search::Candidate<Step>;

/// A* over the nodes of a roadmap and the direction in which they are reached, and over lattice motions about the start; its
/// memory is kept between searches.
#[derive(Debug)]
pub struct Search {
    motions: [Segment; 6],
    states: Vec<State>,
    generation: u32,
    reached: Vec<Reached>,
    bins: Bins,
    open: OpenList<Candidate>,
    sequence: u32,
    near: Vec<(f64, u32)>,
    curves: Vec<PricedCurve>,
    approaches: Vec<Approach>,
    roadmap_serves: Option<bool>,
    /// Milestones and other poses expanded by the last search.
    pub roadmap_expansions: u32,
    pub local_expansions: u32,
}

fn state_of(node: u32, reverse: bool) -> u32 {
    2 * node + u32::from(reverse)
}

impl Search {
    pub fn new(body: &Dimensions, roadmap: &Roadmap) -> Self {
        Self {
            motions: lattice_search::motions(body, knob(2, 4.0)),
            states: vec![State::default(); 2 * roadmap.node_count()],
            generation: 0,
            reached: Vec::new(),
            bins: Bins::new(2.5, 24),
            open: OpenList::default(),
            sequence: 0,
            near: Vec::new(),
            curves: Vec::new(),
            approaches: Vec::new(),
            roadmap_serves: None,
            roadmap_expansions: 0,
            local_expansions: 0,
        }
    }

    /// Searches for a way into the goal.
    pub fn run(&mut self, task: &Task<'_>, roadmap: &mut Roadmap) -> Option<Path> {
        self.begin();
        let outlook = task.lookout.without_bushes(task.start, None, task.goal);
        let via = Via::Motion(Segment { curvature: 0.0, length_m: 0.0 });
        let approach = self.keep(outlook.approach);
        let root =
            Reached { pose: task.start, reverse: None, parent: ROOT, via, cost: 0.0, ahead: outlook.to_go, approach };
        self.bins.improve(task.start, false, 0.0);
        self.reach(root);
        self.push(0.0, 0.0, 0, Step::Expand);
        while let Some(best) = self.open.pop() {
            match best.step {
                Step::Approach => {
                    let reached = &self.reached[best.node as usize];
                    let approach = reached.approach.expect("only approaches that exist are offered");
                    let segments = self.approaches[approach as usize].segments();
                    if task.floor.way_is_free(task.checker, reached.pose, segments) {
                        return Some(self.path(task, roadmap, best.node));
                    }
                }
                Step::Expand => self.expand(task, roadmap, best),
                Step::Motion { index } => self.drive(task, best, index),
                Step::Curve { to } => {
                    if *self.roadmap_serves.get_or_insert_with(|| goal_is_open(task, roadmap, &mut self.near)) {
                        self.work_out_curve(task, roadmap, best, to);
                    }
                }
                Step::Link { link } => self.work_out_link(task, roadmap, best, link),
                Step::Enter { state, via } => self.enter(task, roadmap, best, state, via),
            }
        }
        None
    }

    fn begin(&mut self) {
        self.generation = self.generation.wrapping_add(1);
        self.reached.clear();
        self.bins.clear();
        self.open.clear();
        self.sequence = 0;
        self.curves.clear();
        self.approaches.clear();
        self.roadmap_serves = None;
        (self.roadmap_expansions, self.local_expansions) = (0, 0);
    }

    fn push(&mut self, key: f64, cost: f64, node: u32, step: Step) {
        self.open.push(Candidate { key, cost, sequence: self.sequence, node, step });
        self.sequence += 1;
    }

    fn keep(&mut self, approach: Option<Approach>) -> Option<u32> {
        approach.map(|approach| {
            self.approaches.push(approach);
            self.approaches.len() as u32 - 1
        })
    }

    /// Keeps a pose for its approach.
    fn reach(&mut self, reached: Reached) -> u32 {
        let index = self.reached.len() as u32;
        self.reached.push(reached);
        if let Some(approach) = reached.approach {
            let key = reached.cost + knob(0, 1.5) * self.approaches[approach as usize].cost;
            self.push(key, reached.cost, index, Step::Approach);
        }
        index
    }

    /// Offers the motions from a pose, and curves to milestones about it.
    fn expand(&mut self, task: &Task<'_>, roadmap: &Roadmap, from: Candidate) {
        self.local_expansions += 1;
        let here = self.reached[from.node as usize];
        if self.local_expansions <= knob(1, 100.0) as u32 && here.cost < knob(3, 30.0) {
            for (choice, motion) in self.motions.into_iter().enumerate() {
                let undoes = matches!(here.via, Via::Motion(last)
                    if motion.curvature == last.curvature && motion.length_m == -last.length_m);
                if !undoes {
                    let turns_back = here.reverse.is_some_and(|reverse| reverse != motion.is_reverse());
                    let step_m = motion.length_m.abs();
                    let cost = here.cost + step_m + if turns_back { roadmap.curves().1.cusp_m } else { 0.0 };
                    let key = cost + knob(0, 1.5) * (here.ahead - step_m).max(0.0);
                    self.push(key, cost, from.node, Step::Motion { index: choice as u8 });
                }
            }
        }
        if from.node == 0 || knob(4, 0.0) > 0.0 {
            let reach_m = if from.node == 0 { LINK_M } else { knob(4, 0.0) };
            roadmap.near(here.pose.position(), reach_m, &mut self.near);
            for number in 0..self.near.len() {
                let to = self.near[number].1;
                let pose = roadmap.pose(to);
                let cost = here.cost + least_length_m(task.checker.body().turning_radius_m, here.pose, pose);
                let key = cost + knob(0, 1.5) * least_ahead(task, pose);
                self.push(key.max(from.key), cost, from.node, Step::Curve { to });
            }
        }
    }

    fn drive(&mut self, task: &Task<'_>, from: Candidate, choice: u8) {
        let motion = self.motions[usize::from(choice)];
        let start = self.reached[from.node as usize].pose;
        let pose = motion.end(start);
        let reverse = motion.is_reverse();
        if self.bins.dominates(pose, reverse, from.cost) || !task.floor.motion_is_free(task.checker, start, motion) {
            return;
        }
        self.bins.improve(pose, reverse, from.cost);
        let outlook = task.lookout.without_bushes(pose, Some(reverse), task.goal);
        let approach = self.keep(outlook.approach);
        let index = self.reach(Reached {
            pose,
            reverse: Some(reverse),
            parent: from.node,
            via: Via::Motion(motion),
            cost: from.cost,
            ahead: outlook.to_go,
            approach,
        });
        self.push(from.cost + knob(0, 1.5) * outlook.to_go, from.cost, index, Step::Expand);
    }

    fn work_out_curve(&mut self, task: &Task<'_>, roadmap: &Roadmap, from: Candidate, to: u32) {
        let here = self.reached[from.node as usize];
        let (curves, price) = roadmap.curves();
        let way = curves.cheapest(here.pose, roadmap.pose(to), price);
        let mut segments = way.curve.segments();
        let Some(first) = segments.next().map(|segment| segment.is_reverse()) else { return };
        let last = segments.last().map_or(first, |segment| segment.is_reverse());
        let turns_back = here.reverse.is_some_and(|reverse| reverse != first);
        let cost = here.cost + way.price + if turns_back { price.cusp_m } else { 0.0 };
        self.curves.push(way);
        let via = Via::Curve(self.curves.len() as u32 - 1);
        self.offer(task, roadmap, (from.node, from.key), (state_of(to, last), via, cost));
    }

    fn work_out_link(&mut self, task: &Task<'_>, roadmap: &mut Roadmap, from: Candidate, link: u32) {
        let here = self.reached[from.node as usize];
        let to = roadmap.link(link);
        let passage = roadmap.passage(to);
        let turns_back = here.reverse.is_some_and(|reverse| reverse != passage.departs_reverse);
        let cost = here.cost + passage.cost + if turns_back { roadmap.curves().1.cusp_m } else { 0.0 };
        let state = state_of(to.to, passage.arrives_reverse);
        self.offer(task, roadmap, (from.node, from.key), (state, Via::Link(link), cost));
    }

    /// Offers a state at the estimate of the whole way.
    fn offer(
        &mut self,
        task: &Task<'_>,
        roadmap: &Roadmap,
        (parent, least_key): (u32, f64),
        (index, via, cost): (u32, Via, f64),
    ) {
        if self.states[index as usize].generation != self.generation {
            let outlook = task.lookout.without_bushes(roadmap.pose(index / 2), Some(index % 2 == 1), task.goal);
            let approach = self.keep(outlook.approach);
            self.states[index as usize] =
                State { generation: self.generation, is_closed: false, ahead: outlook.to_go, approach };
        }
        let state = &self.states[index as usize];
        if !state.is_closed {
            let key = (cost + knob(0, 1.5) * state.ahead).max(least_key);
            self.push(key, cost, parent, Step::Enter { state: index, via });
        }
    }

    fn enter(&mut self, task: &Task<'_>, roadmap: &mut Roadmap, from: Candidate, index: u32, via: Via) {
        let state = self.states[index as usize];
        if state.is_closed {
            return;
        }
        let is_free = match via {
            Via::Curve(curve) => {
                let segments = self.curves[curve as usize].curve.segments();
                task.floor.way_is_free(task.checker, self.reached[from.node as usize].pose, segments)
            }
            Via::Link(link) => roadmap.is_free(roadmap.link(link).edge, task.level),
            Via::Motion(_) => unreachable!("motions lead to no milestone"),
        };
        if !is_free {
            return;
        }
        self.states[index as usize].is_closed = true;
        self.roadmap_expansions += 1;
        let node = index / 2;
        let State { ahead, approach, .. } = state;
        let pose = roadmap.pose(node);
        let reverse = Some(index % 2 == 1);
        let reached = self.reach(Reached { pose, reverse, parent: from.node, via, cost: from.cost, ahead, approach });
        for (number, link) in roadmap.links(node) {
            let closed = |reverse| {
                let state = &self.states[state_of(link.to, reverse) as usize];
                state.generation == self.generation && state.is_closed
            };
            if closed(false) && closed(true) {
                continue;
            }
            let cost = from.cost + roadmap.least_m(node, link.to);
            let key = cost + knob(0, 1.5) * least_ahead(task, roadmap.pose(link.to));
            self.push(key.max(from.key), cost, reached, Step::Link { link: number });
        }
    }

    /// The whole path by way of a pose and its approach.
    fn path(&self, task: &Task<'_>, roadmap: &mut Roadmap, last: u32) -> Path {
        let mut way = Vec::new();
        let mut index = last;
        while index != ROOT {
            way.push(index);
            index = self.reached[index as usize].parent;
        }
        let mut segments: Vec<Segment> = Vec::new();
        for &index in way.iter().rev().skip(1) {
            match self.reached[index as usize].via {
                Via::Motion(motion) => segments.push(motion),
                Via::Curve(curve) => segments.extend(self.curves[curve as usize].curve.segments()),
                Via::Link(link) => roadmap.append(roadmap.link(link), &mut segments),
            }
        }
        let approach = self.reached[last as usize].approach.expect("it was taken");
        segments.extend(self.approaches[approach as usize].segments());
        Path { start: task.start, segments }
    }
}

/// Whether a free way leads to the goal from a milestone about it.
fn goal_is_open(task: &Task<'_>, roadmap: &Roadmap, near: &mut Vec<(f64, u32)>) -> bool {
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
