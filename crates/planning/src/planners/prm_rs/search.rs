//! The search of the roadmap for one query, together with motions around the start.

use glam::DVec2;

use crate::collision::CollisionChecker;
use crate::kit::best_first::{
    AnalyticExpansion, Candidate, NO_MOTION, Node, PoseSearch, ROOT, SearchFailure, SearchOf, SearchSpace, Step,
};
use crate::kit::clearance_profile::ClearanceProfile;
use crate::kit::heuristic::PoseHeuristic;
use crate::kit::lattice::Lattice;
use crate::kit::target::Target;
use crate::memory::{CapacityBytes, MemoryMeter};
use crate::{Effort, GoalDisc};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::reeds_shepp::PricedCurve;
use wildfire_base::vehicle::{Dimensions, Path, Segment};

use super::roadmap::{ClearanceLevel, Roadmap, min_length_m};

/// Milestones as near as this to the start, or to the goal, are tried for a way from or to there.
const LINK_M: f64 = 40.0;
/// A goal with a free way from one of this number of milestones about it is worth a search over the roadmap.
const GOAL_TRIES: usize = 60;
/// Costs-to-go are multiplied with this.
const WEIGHT: f64 = 1.2;
/// Poses off the roadmap that are expanded, and how far from the start at most.
const MAX_LOCAL_EXPANSIONS: u32 = 50;
const LOCAL_M: f64 = 30.0;
/// A roadmap that grows is joined as it is searched, which costs more than searching: its searches are greedier,
const WEIGHT_GROWING: f64 = 1.3;
/// and enter no more milestones than this, and this number for every metre of the straight line. Most drives that it
/// serves take less; others are served better by the lattice search.
const MAX_EXPANSIONS: f64 = 30.0;
const MAX_EXPANSIONS_PER_METRE: f64 = 0.1;
/// The lattice of poses about the start.
const LATTICE: Lattice = Lattice { bin_m: 2.5, headings: 24, step_m: 4.0 };

/// A query to one search.
#[derive(Clone, Copy, Debug)]
pub struct RoadmapQuery<'a> {
    pub checker: &'a CollisionChecker,
    pub heuristic: &'a PoseHeuristic,
    pub profile: &'a ClearanceProfile,
    pub level: ClearanceLevel,
    pub start: Pose,
    pub target: Target<'a>,
}

/// The way by which a pose was reached, and its analytic expansion.
#[derive(Clone, Copy, Debug)]
struct Mark {
    via: NodeEntry,
    /// Its place in the list of expansions.
    expansion: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NodeEntry {
    /// A motion of the lattice, or nothing at the start.
    Motion,
    /// A curve of this search to a milestone.
    Curve(u32),
    /// A link of the roadmap to a milestone.
    Link(u32),
}

/// A step along the roadmap that is still to be judged.
#[derive(Clone, Copy, Debug)]
enum RoadmapStep {
    /// Compute the curve to a milestone.
    Curve { to: u32 },
    /// Compute the curve of a link.
    Link { link: u32 },
    /// Sweep a curve to a milestone.
    Enter { state: u32, via: NodeEntry },
}

/// A milestone and a direction in which it is reached, as a search sees it.
#[derive(Clone, Copy, Debug, Default)]
struct DirectedMilestone {
    /// The search that wrote the rest.
    generation: u64,
    is_closed: bool,
    cost_to_go: f64,
    expansion: Option<u32>,
}

/// A* over the milestones of a roadmap, each in both directions of driving, and over motions around the start.
///
/// Knowledge of the roadmap's edges from earlier searches saves time and changes no answer: candidates are ordered by
/// what holds for an edge whether it is known or not.
#[derive(Debug)]
pub struct RoadmapSearch {
    search: PoseSearch<Mark, RoadmapStep>,
    notes: Notes,
}

/// The memory of a search besides poses.
#[derive(Debug)]
struct Notes {
    /// Two for each milestone.
    states: Vec<DirectedMilestone>,
    generation: u64,
    curves: Vec<PricedCurve>,
    expansions: Vec<AnalyticExpansion>,
    /// True if a way leads to the goal from a milestone, where that was asked.
    roadmap_serves: Option<bool>,
    /// True if the path that was found leads over a milestone.
    used_roadmap: bool,
    near: Vec<(f64, u32)>,
    effort: Effort,
}

impl RoadmapSearch {
    pub fn new(body: &Dimensions, memory: &MemoryMeter, roadmap: &Roadmap) -> Self {
        let notes = Notes {
            states: vec![DirectedMilestone::default(); 2 * roadmap.node_count()],
            generation: 0,
            curves: Vec::new(),
            expansions: Vec::new(),
            roadmap_serves: None,
            used_roadmap: false,
            near: Vec::new(),
            effort: Effort::default(),
        };
        Self { search: PoseSearch::new(body, LATTICE, memory), notes }
    }

    /// Searches for a path into the goal.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn run(&mut self, query: &RoadmapQuery<'_>, roadmap: &mut Roadmap) -> Result<Path, SearchFailure> {
        self.notes.begin();
        let limits = if roadmap.is_lazy() {
            let straight_m = query.target.straight_m(query.start.position());
            let max_expansions = (MAX_EXPANSIONS + MAX_EXPANSIONS_PER_METRE * straight_m) as u32;
            SearchLimits { weight: WEIGHT_GROWING, max_expansions }
        } else {
            SearchLimits { weight: WEIGHT, max_expansions: u32::MAX }
        };
        let mut space = RoadmapSpace { query, roadmap, notes: &mut self.notes, limits };
        self.search.begin(&mut space, [query.start], Mark { via: NodeEntry::Motion, expansion: None });
        self.search.run(&mut space, u32::MAX)
    }

    /// Returns the milestones, and the poses off the roadmap, that the last search expanded.
    pub fn effort(&self) -> Effort {
        self.notes.effort
    }

    /// Returns whether the path that the last search found leads over a milestone.
    pub fn used_roadmap(&self) -> bool {
        self.notes.used_roadmap
    }

    /// Returns the positions that the last search reached by motions, or by curves to milestones and links between
    /// them, in order, each after its predecessor.
    pub fn lines(&self, by_motions: bool) -> impl Iterator<Item = [DVec2; 2]> {
        let reached = self.search.nodes().filter(move |(node, _)| (node.mark.via == NodeEntry::Motion) == by_motions);
        reached.map(|(_, line)| line)
    }
}

impl Notes {
    fn begin(&mut self) {
        self.generation += 1;
        self.curves.clear();
        self.expansions.clear();
        self.roadmap_serves = None;
        self.used_roadmap = false;
        self.effort = Effort::default();
    }

    /// Makes room for the milestones that a roadmap has come to have.
    fn know(&mut self, roadmap: &Roadmap) {
        if self.states.len() < 2 * roadmap.node_count() {
            self.states.resize(2 * roadmap.node_count(), DirectedMilestone::default());
        }
    }

    fn is_closed(&self, node: u32, reverse: bool) -> bool {
        let state = &self.states[state_of(node, reverse) as usize];
        state.generation == self.generation && state.is_closed
    }
}

/// Returns the index of a milestone's state.
fn state_of(node: u32, reverse: bool) -> u32 {
    2 * node + u32::from(reverse)
}

/// A query, the roadmap, and what is remembered.
struct RoadmapSpace<'a> {
    query: &'a RoadmapQuery<'a>,
    roadmap: &'a mut Roadmap,
    notes: &'a mut Notes,
    limits: SearchLimits,
}

/// The greed and the effort of a search.
#[derive(Clone, Copy, Debug)]
struct SearchLimits {
    /// Costs-to-go are multiplied with this.
    weight: f64,
    max_expansions: u32,
}

impl RoadmapSpace<'_> {
    /// Estimates the cost of the way from a pose to the goal, and notes the analytic expansion there.
    fn value(&mut self, pose: Pose, after_reverse: Option<bool>) -> (f64, Option<u32>) {
        let value = self.query.heuristic.without_bushes(pose, after_reverse, self.query.target);
        let expansion = value.expansion.map(|expansion| {
            self.notes.expansions.push(expansion);
            self.notes.expansions.len() as u32 - 1
        });
        (value.cost_to_go, expansion)
    }

    /// Returns what no way from a pose to the goal is shorter than.
    fn min_cost_to_go(&self, pose: Pose) -> f64 {
        let body = self.query.checker.body();
        match self.query.target {
            Target::Pose(end) => min_length_m(body.turning_radius_m, pose, end),
            Target::Discs(discs) => {
                let min = |disc: &GoalDisc| {
                    (pose.position().distance(disc.centre) - body.centre_offset_m() - disc.radius_m).max(0.0)
                };
                discs.iter().map(min).fold(f64::INFINITY, f64::min)
            }
        }
    }

    fn cusp_cost(&self, here: &Node<Mark>, departs_reverse: bool) -> f64 {
        if here.turns_back(departs_reverse) { self.roadmap.curve_price().cusp_m } else { 0.0 }
    }

    /// Offers curves from the start to the milestones about it, at what they cannot cost less than.
    fn offer_milestones(&mut self, search: &mut SearchOf<Self>, from: Candidate<RoadmapStep>) {
        let start = self.query.start;
        self.roadmap.near(start.position(), LINK_M, &mut self.notes.near);
        self.notes.know(self.roadmap);
        for &(_, to) in &self.notes.near {
            let pose = self.roadmap.pose(to);
            let cost = min_length_m(self.query.checker.body().turning_radius_m, start, pose);
            let key = cost + self.limits.weight * self.min_cost_to_go(pose);
            search.push(key.max(from.key), cost, from.node, Step::Custom(RoadmapStep::Curve { to }));
        }
    }

    /// Returns whether a free way leads to the goal from a milestone about it.
    fn leads_to_goal(&mut self) -> bool {
        let Self { query, roadmap, notes, .. } = self;
        let mut leads_from_about = |position: DVec2, reach_m: f64| {
            roadmap.near(position, reach_m, &mut notes.near);
            // Each try is a sweep, so only some of the nearest are asked.
            notes.near.iter().take(GOAL_TRIES).any(|&(_, node)| {
                let pose = roadmap.pose(node);
                let expansion = query.heuristic.without_bushes(pose, None, query.target).expansion;
                expansion.is_some_and(|way| query.profile.way_is_free(query.checker, pose, way.segments()))
            })
        };
        match query.target {
            Target::Pose(end) => leads_from_about(end.position(), LINK_M),
            Target::Discs(discs) => discs.iter().any(|disc| leads_from_about(disc.centre, disc.radius_m + LINK_M)),
        }
    }

    fn work_out_curve(&mut self, search: &mut SearchOf<Self>, from: Candidate<RoadmapStep>, to: u32) {
        // Whether any milestone leads into the goal is the same for all links, so it is asked once, when first needed.
        let serves = match self.notes.roadmap_serves {
            Some(cached) => cached,
            None => self.leads_to_goal(),
        };
        self.notes.roadmap_serves = Some(serves);
        if !serves {
            return;
        }
        let here = *search.node(from.node);
        let curves = self.roadmap.curves();
        let price = self.roadmap.curve_price();
        let way = curves.cheapest_word(here.pose, self.roadmap.pose(to), price);
        // A curve without segments leads to a milestone at this very pose, which is no progress.
        let mut segments = way.curve.segments();
        let Some(first) = segments.next().map(|segment| segment.is_reverse()) else { return };
        let last = segments.last().map_or(first, |segment| segment.is_reverse());
        let cost = here.cost + way.price + self.cusp_cost(&here, first);
        self.notes.curves.push(way);
        let via = NodeEntry::Curve(self.notes.curves.len() as u32 - 1);
        self.offer(search, from.at_cost(cost), state_of(to, last), via);
    }

    fn work_out_link(&mut self, search: &mut SearchOf<Self>, from: Candidate<RoadmapStep>, number: u32) {
        let here = *search.node(from.node);
        let link = self.roadmap.link(number);
        let bridge = self.roadmap.bridge(link);
        let cost = here.cost + bridge.cost + self.cusp_cost(&here, bridge.departs_reverse);
        let state = state_of(link.to, bridge.arrives_reverse);
        self.offer(search, from.at_cost(cost), state, NodeEntry::Link(number));
    }

    /// Offers a state at the estimate of the whole way by it.
    fn offer(&mut self, search: &mut SearchOf<Self>, from: Candidate<RoadmapStep>, index: u32, via: NodeEntry) {
        let generation = self.notes.generation;
        // Every way that arrives in this direction has the same estimate, so it is worked out once.
        if self.notes.states[index as usize].generation != generation {
            let (cost_to_go, expansion) = self.value(self.roadmap.pose(index / 2), Some(index % 2 == 1));
            self.notes.states[index as usize] =
                DirectedMilestone { generation, is_closed: false, cost_to_go, expansion };
        }
        let state = &self.notes.states[index as usize];
        if !state.is_closed {
            let key = (from.cost + self.limits.weight * state.cost_to_go).max(from.key);
            search.push(key, from.cost, from.node, Step::Custom(RoadmapStep::Enter { state: index, via }));
        }
    }

    /// Closes a state if the way to it is free, and offers the links from there.
    fn enter(&mut self, search: &mut SearchOf<Self>, from: Candidate<RoadmapStep>, index: u32, via: NodeEntry) {
        let DirectedMilestone { is_closed, cost_to_go, expansion, .. } = self.notes.states[index as usize];
        // The closed state is asked first, because a sweep costs much more.
        if is_closed || !self.way_is_free(search, from.node, via) {
            return;
        }
        // Only now: a way that collides must not keep another from entering.
        self.notes.states[index as usize].is_closed = true;
        self.notes.effort.roadmap_expansions += 1;
        let node = index / 2;
        let reached = search.add(Node {
            pose: self.roadmap.pose(node),
            parent: from.node,
            motion: NO_MOTION,
            reverse: Some(index % 2 == 1),
            cost: from.cost,
            cost_to_go,
            mark: Mark { via, expansion },
        });
        if let Some(expansion) = expansion {
            let key = from.cost + self.limits.weight * self.notes.expansions[expansion as usize].cost;
            search.push(key, from.cost, reached, Step::Arrive);
        }
        // A lazy roadmap has links only of nodes that a search comes to.
        self.roadmap.grow_from(node);
        self.notes.know(self.roadmap);
        for number in self.roadmap.link_numbers(node) {
            let link = self.roadmap.link(number);
            // Both directions of arrival are states; the link is useless only if both are closed.
            if self.notes.is_closed(link.to, false) && self.notes.is_closed(link.to, true) {
                continue;
            }
            // What a link costs at least holds whether its curve is known or not.
            let cost = from.cost + self.roadmap.min_m(node, link.to);
            let key = cost + self.limits.weight * self.min_cost_to_go(self.roadmap.pose(link.to));
            // Keys never fall along a path, whatever the estimate says.
            search.push(key.max(from.key), cost, reached, Step::Custom(RoadmapStep::Link { link: number }));
        }
    }

    fn way_is_free(&mut self, search: &SearchOf<Self>, from: u32, via: NodeEntry) -> bool {
        match via {
            NodeEntry::Curve(curve) => {
                let way = self.notes.curves[curve as usize].curve.segments();
                self.query.profile.way_is_free(self.query.checker, search.node(from).pose, way)
            }
            NodeEntry::Link(link) => self.roadmap.is_free(self.roadmap.link(link).edge, self.query.level),
            NodeEntry::Motion => unreachable!("motions lead to no milestone"),
        }
    }
}

impl SearchSpace for RoadmapSpace<'_> {
    type Mark = Mark;
    type Custom = RoadmapStep;

    /// One step adds a pose, a curve, two expansions, and what is offered from there. A search that has entered as many
    /// milestones as it may ends as one without memory does, and the planner asks for less.
    fn has_room(&mut self, search: &mut SearchOf<Self>) -> bool {
        let Self { roadmap, notes, .. } = self;
        if notes.effort.roadmap_expansions >= self.limits.max_expansions {
            return false;
        }
        let offered = search.motions.len().max(roadmap.max_links());
        let lists = notes.curves.bytes_after(1) + notes.expansions.bytes_after(2) + notes.near.bytes_after(0);
        let states = if roadmap.is_lazy() { notes.states.bytes_after(0) } else { 0 };
        let bytes = search.bytes_after(1, offered) + lists + states;
        roadmap.has_memory_for(1) && search.may_hold(bytes)
    }

    fn weight(&self) -> f64 {
        self.limits.weight
    }

    fn estimate(&mut self, node: &mut Node<Mark>) -> Option<f64> {
        let (cost_to_go, expansion) = self.value(node.pose, node.reverse);
        node.cost_to_go = cost_to_go;
        node.mark = Mark { via: NodeEntry::Motion, expansion };
        expansion.map(|expansion| self.notes.expansions[expansion as usize].cost)
    }

    fn analytic_expansion(&self, node: &Node<Mark>) -> AnalyticExpansion {
        self.notes.expansions[node.mark.expansion.expect("only expansions that exist are offered") as usize]
    }

    /// Offers the motions from a pose near the start, and from the start curves to the milestones about it.
    fn offer_successors(&mut self, search: &mut SearchOf<Self>, from: Candidate<RoadmapStep>) {
        let Node { parent, cost, .. } = *search.node(from.node);
        if parent == ROOT {
            self.offer_milestones(search, from);
        }
        if self.notes.effort.local_expansions < MAX_LOCAL_EXPANSIONS && cost < LOCAL_M {
            self.notes.effort.local_expansions += 1;
            search.offer_motions(from.node, self.query.heuristic.motion_price(), self.limits.weight);
        }
    }

    fn motion_is_free(&self, from: Pose, motion: Segment) -> bool {
        self.query.profile.motion_is_free(self.query.checker, from, motion)
    }

    fn take(&mut self, search: &mut SearchOf<Self>, from: Candidate<RoadmapStep>, step: RoadmapStep) -> Option<u32> {
        match step {
            RoadmapStep::Curve { to } => self.work_out_curve(search, from, to),
            RoadmapStep::Link { link } => self.work_out_link(search, from, link),
            RoadmapStep::Enter { state, via } => self.enter(search, from, state, via),
        }
        None
    }

    fn append_way(&mut self, node: &Node<Mark>, segments: &mut Vec<Segment>) {
        self.notes.used_roadmap |= node.mark.via != NodeEntry::Motion;
        match node.mark.via {
            NodeEntry::Motion => segments.push(node.motion),
            NodeEntry::Curve(curve) => segments.extend(self.notes.curves[curve as usize].curve.segments()),
            NodeEntry::Link(link) => self.roadmap.append(self.roadmap.link(link), segments),
        }
    }
}
