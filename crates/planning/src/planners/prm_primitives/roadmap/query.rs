//! Queries of the roadmap: the search for a route from the start into the goal.

use std::num::NonZero;

use glam::DVec2;

use crate::kit::roadmap_graph::Link;

use super::{Roadmap, neighbours_by_distance};
use crate::planners::prm_primitives::{RoadmapGoal, RoadmapSearch};
use crate::{GoalDisc, PlanFailure};
use wildfire_base::geometry::ops;
use wildfire_grid::open_list::{OpenList, Ranked};

/// The number of milestones nearest to the start to which a straight line is tried, in the order of the search.
const START_LINKS: NonZero<usize> = NonZero::new(24).unwrap();
/// From a milestone, the goal is tried straight ahead first, then at this number of places around its centre.
const GOAL_PLACES: u32 = 8;
/// The places lie at this share of the goal's radius.
const GOAL_PLACE_RADIUS: f64 = 0.85;

/// Goal places have the numbers from here on.
const GOAL: u32 = u32::MAX - 1 - GOAL_PLACES;

/// The start, where a milestone's number is asked for.
const START: u32 = u32::MAX;

/// A way to a milestone or a goal place that is still to be judged.
#[derive(Clone, Copy, Debug)]
struct LineCandidate {
    /// Estimated cost of the whole route, by which the search is ordered.
    key: f64,
    cost: f64,
    to: u32,
    from: u32,
}

impl Ranked for LineCandidate {
    type Tie = (u32, u32);

    fn priority(&self) -> f64 {
        self.key
    }

    fn cost(&self) -> f64 {
        self.cost
    }

    fn tie(&self) -> (u32, u32) {
        (self.to, self.from)
    }
}

#[derive(Clone, Copy, Debug)]
struct Visit {
    generation: u32,
    closed: bool,
    cost: f64,
    parent: u32,
}

/// Memory that queries share, so that they need not allocate.
#[derive(Debug, Default)]
pub struct RoadmapScratch {
    generation: u32,
    visits: Vec<Visit>,
    open: OpenList<LineCandidate>,
    near: Vec<(f64, u32)>,
    /// Milestones whose cost is final, in the order in which it became so.
    closed: Vec<u32>,
    /// Milestones expanded by the last query.
    pub expansions: u32,
}

impl RoadmapScratch {
    fn begin(&mut self, milestones: usize) {
        if self.visits.len() != milestones || self.generation == u32::MAX {
            self.visits = vec![Visit { generation: 0, closed: false, cost: 0.0, parent: START }; milestones];
            self.generation = 0;
        }
        self.generation += 1;
        self.open.clear();
        self.closed.clear();
        self.expansions = 0;
    }

    fn visit(&mut self, milestone: u32) -> &mut Visit {
        let visit = &mut self.visits[milestone as usize];
        if visit.generation != self.generation {
            *visit = Visit { generation: self.generation, closed: false, cost: f64::INFINITY, parent: START };
        }
        visit
    }
}

/// A query's answer on the roadmap.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RoadmapRoute {
    /// Positions for the body's centre, in order, without the start; the last one lies in the goal disc, or is the goal
    /// milestone. Empty if the start is already there.
    pub waypoints: Vec<DVec2>,
    /// The length in metres plus the surcharge of the safety map.
    pub cost: f64,
}

/// A query on its way.
struct MilestoneQuery<'a> {
    roadmap: &'a Roadmap,
    start: DVec2,
    goal: GoalDisc,
    /// The only milestone to end at, when the roadmap's goal is a milestone.
    end_milestone: Option<u32>,
}

impl Roadmap {
    /// Finds the best route from a body centre to the goal, in the sense of the settings' search.
    ///
    /// With [`RoadmapSearch::Astar`] and [`RoadmapSearch::Dijkstra`] it is the cheapest one over the start's links to
    /// its nearest milestones, the roadmap's edges and the straight lines from milestones near the goal to some places
    /// in the goal, of which the nearest alone counts if it can be seen. Lines to start and goal are swept only when the
    /// search comes to them. Equal routes: the one that is found nearer to the goal, then lower indices.
    ///
    /// With [`RoadmapGoal::NearestMilestone`] it ends at the milestone in the goal that is nearest to its centre.
    ///
    /// # Errors
    /// [`PlanFailure::GoalBlocked`] when the route is to end at a milestone and none lies in the goal;
    /// [`PlanFailure::Disconnected`] when nothing leads there.
    pub fn route(
        &self,
        start: DVec2,
        goal: GoalDisc,
        scratch: &mut RoadmapScratch,
    ) -> Result<RoadmapRoute, PlanFailure> {
        scratch.begin(self.milestones.len());
        let end_milestone = match self.settings.goal {
            RoadmapGoal::InReach => None,
            RoadmapGoal::NearestMilestone => {
                // In a goal without bounds lies every milestone, unless the roadmap has none.
                let none = if goal.radius_m.is_finite() { PlanFailure::GoalBlocked } else { PlanFailure::Disconnected };
                Some(self.nearest_milestone(goal).ok_or(none)?)
            }
        };
        MilestoneQuery { roadmap: self, start, goal, end_milestone }.search(scratch).ok_or(PlanFailure::Disconnected)
    }

    /// Returns what the last query, which began at `start`, examined: the milestones that it settled, each after its
    /// predecessor, and the start after itself.
    pub fn examined(&self, start: DVec2, scratch: &RoadmapScratch) -> impl Iterator<Item = [DVec2; 2]> {
        let settled = scratch.closed.iter().map(|&milestone| (scratch.visits[milestone as usize].parent, milestone));
        std::iter::once((START, START)).chain(settled).map(move |(from, to)| {
            [from, to].map(move |place| if place == START { start } else { self.milestones[place as usize] })
        })
    }

    /// Returns the milestone in a disc that is nearest to its centre, the lowest index among equals.
    fn nearest_milestone(&self, disc: GoalDisc) -> Option<u32> {
        let distance = |&index: &u32| self.milestones[index as usize].distance_squared(disc.centre);
        let nearest = (0..self.milestones.len() as u32).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (self.milestones[nearest as usize].distance(disc.centre) <= disc.radius_m).then_some(nearest)
    }
}

impl MilestoneQuery<'_> {
    fn search(&self, scratch: &mut RoadmapScratch) -> Option<RoadmapRoute> {
        self.link_start(scratch);
        while let Some(best) = scratch.open.pop() {
            if best.to >= GOAL {
                // Its turn has come: only now is the line worth a sweep.
                if self.line_is_free(best) {
                    return Some(self.route(best, scratch));
                }
                self.offer_other_places(best, scratch);
                continue;
            }
            // Links from the start are swept when their turn comes, so that `visit` does not know their costs.
            let visit = scratch.visit(best.to);
            let outdated = visit.closed || (best.from != START && best.cost > visit.cost);
            if outdated || (best.from == START && !self.line_is_free(best)) {
                continue;
            }
            // With A* and Dijkstra the cost is final: along an edge the estimate falls by no more than the edge costs.
            *visit = Visit { closed: true, cost: best.cost, parent: best.from, ..*visit };
            scratch.closed.push(best.to);
            if self.ends_at(best.to) {
                return Some(self.route(best, scratch));
            }
            scratch.expansions += 1;
            for (_, Link { to, edge }) in self.roadmap.graph.links(best.to) {
                let cost = best.cost + self.roadmap.costs[edge as usize];
                let visit = scratch.visit(to);
                if !visit.closed && cost < visit.cost {
                    visit.cost = cost;
                    let key = self.key(cost, to);
                    scratch.open.push(LineCandidate { key, cost, to, from: best.to });
                }
            }
            // A milestone that is no farther from the goal than edges are long offers a line into it.
            let gap = self.position(best.to).distance(self.goal.centre) - self.goal.radius_m;
            if self.end_milestone.is_none() && gap <= self.roadmap.settings.max_edge_m {
                self.offer(GOAL, best.to, best.cost, scratch);
            }
        }
        None
    }

    /// Offers the straight line into the goal and the lines to the nearest milestones.
    fn link_start(&self, scratch: &mut RoadmapScratch) {
        if self.end_milestone.is_none() {
            self.offer(GOAL, START, 0.0, scratch);
        }
        let roadmap = self.roadmap;
        let Some(tree) = &roadmap.tree else { return };
        let mut near = std::mem::take(&mut scratch.near);
        let max_m = roadmap.settings.max_edge_m;
        neighbours_by_distance(tree, &roadmap.milestones, self.start, max_m, START_LINKS, &mut near);
        for &(_, milestone) in &near {
            let cost = roadmap.space.price(self.start, self.position(milestone));
            let key = self.key(cost, milestone);
            scratch.open.push(LineCandidate { key, cost, to: milestone, from: START });
        }
        scratch.near = near;
    }

    /// Offers the other places after the line straight into the goal was not free.
    fn offer_other_places(&self, failed: LineCandidate, scratch: &mut RoadmapScratch) {
        if failed.to != GOAL {
            return;
        }
        let cost = if failed.from == START { 0.0 } else { scratch.visit(failed.from).cost };
        for place in GOAL + 1..=GOAL + GOAL_PLACES {
            if self.roadmap.space.point_is_free(self.goal_place(place, failed.from)) {
                self.offer(place, failed.from, cost, scratch);
            }
        }
    }

    fn offer(&self, place: u32, from: u32, cost_so_far: f64, scratch: &mut RoadmapScratch) {
        let cost = cost_so_far + self.roadmap.space.price(self.position(from), self.goal_place(place, from));
        // To a greedy search nothing is nearer to the goal than a place in it.
        let key = match self.roadmap.settings.search {
            RoadmapSearch::Greedy => 0.0,
            RoadmapSearch::Astar | RoadmapSearch::Dijkstra => cost,
        };
        scratch.open.push(LineCandidate { key, cost, to: place, from });
    }

    fn key(&self, cost: f64, milestone: u32) -> f64 {
        let ahead = match self.end_milestone {
            Some(end) => self.position(milestone).distance(self.position(end)),
            None => (self.position(milestone).distance(self.goal.centre) - self.goal.radius_m).max(0.0),
        };
        match self.roadmap.settings.search {
            RoadmapSearch::Astar => cost + ahead,
            RoadmapSearch::Dijkstra => cost,
            RoadmapSearch::Greedy => ahead,
        }
    }

    fn ends_at(&self, milestone: u32) -> bool {
        match self.end_milestone {
            Some(end) => milestone == end,
            None => self.position(milestone).distance(self.goal.centre) <= self.goal.radius_m,
        }
    }

    fn position(&self, milestone: u32) -> DVec2 {
        if milestone == START { self.start } else { self.roadmap.milestones[milestone as usize] }
    }

    /// Returns a place in the goal: the first is where the straight line from `from` to its centre enters it.
    fn goal_place(&self, place: u32, from: u32) -> DVec2 {
        let GoalDisc { centre, radius_m } = self.goal;
        if place == GOAL {
            let offset = self.position(from) - centre;
            // A line that begins in the disc has entered it where it begins.
            return centre + offset * (radius_m / offset.length()).min(1.0);
        }
        let around = f64::from(place - GOAL - 1) / f64::from(GOAL_PLACES) * std::f64::consts::TAU;
        centre + DVec2::from(ops::sin_cos(around)) * (radius_m * GOAL_PLACE_RADIUS)
    }

    fn line_is_free(&self, candidate: LineCandidate) -> bool {
        let from = self.position(candidate.from);
        let to = if candidate.to >= GOAL {
            self.goal_place(candidate.to, candidate.from)
        } else {
            self.position(candidate.to)
        };
        if candidate.from == START {
            self.roadmap.space.departure_is_free(from, to)
        } else {
            self.roadmap.space.line_is_free(from, to)
        }
    }

    /// Returns the waypoints that led to a final candidate.
    fn route(&self, last: LineCandidate, scratch: &mut RoadmapScratch) -> RoadmapRoute {
        let mut waypoints = Vec::new();
        if last.to >= GOAL {
            waypoints.push(self.goal_place(last.to, last.from));
        } else {
            waypoints.push(self.position(last.to));
        }
        let mut milestone = last.from;
        while milestone != START {
            waypoints.push(self.position(milestone));
            milestone = scratch.visit(milestone).parent;
        }
        waypoints.reverse();
        RoadmapRoute { waypoints, cost: last.cost }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use petgraph::algo;
    use petgraph::graph::UnGraph;

    use super::*;
    use crate::kit::safety::{Safety, SafetyMap, SafetySettings};
    use crate::planners::prm_primitives::PrmSettings;
    use crate::test_fields::TestField;
    use wildfire_base::rng;

    fn roadmap(field: &TestField, search: RoadmapSearch, goal: RoadmapGoal) -> Roadmap {
        let settings = PrmSettings { samples: 150, search, goal, ..PrmSettings::default() };
        Roadmap::sampled(&field.checker, &settings, &mut rng::stream(7, "prm")).connected()
    }

    /// The shortest length as petgraph finds it, over the roadmap and all links that a query may use.
    fn length_by_petgraph(roadmap: &Roadmap, start: DVec2, goal: GoalDisc) -> Option<f64> {
        let query = MilestoneQuery { roadmap, start, goal, end_milestone: None };
        let count = roadmap.milestones.len() as u32;
        let mut graph = UnGraph::<(), f64>::default();
        let nodes: Vec<_> = (0..count + 2).map(|_| graph.add_node(())).collect();
        let from = nodes[count as usize];
        let to = nodes[count as usize + 1];
        for a in 0..count {
            for (_, Link { to: b, edge }) in roadmap.graph.links(a) {
                graph.update_edge(nodes[a as usize], nodes[b as usize], roadmap.costs[edge as usize]);
            }
        }
        let mut near: Vec<u32> = (0..count).filter(|&m| start.distance(query.position(m)) <= 30.0).collect();
        near.sort_by(|&a, &b| start.distance(query.position(a)).total_cmp(&start.distance(query.position(b))));
        for &milestone in near.iter().take(START_LINKS.get()) {
            let place = query.position(milestone);
            if roadmap.space.departure_is_free(start, place) {
                graph.update_edge(from, nodes[milestone as usize], start.distance(place));
            }
        }
        for link in (0..count).chain([START]) {
            let place = query.position(link);
            if link != START && query.ends_at(link) {
                graph.update_edge(nodes[link as usize], to, 0.0);
            } else if link == START || place.distance(goal.centre) - goal.radius_m <= 30.0 {
                let free = |&number: &u32| {
                    let end = query.goal_place(number, link);
                    (number == GOAL || roadmap.space.point_is_free(end))
                        && query.line_is_free(LineCandidate { key: 0.0, cost: 0.0, to: number, from: link })
                };
                let places = (GOAL..=GOAL + GOAL_PLACES).filter(free);
                let metres = places.map(|number| place.distance(query.goal_place(number, link)));
                let min = metres.fold(f64::INFINITY, f64::min);
                if min < f64::INFINITY {
                    graph.update_edge(if link == START { from } else { nodes[link as usize] }, to, min);
                }
            }
        }
        let dijkstra = algo::dijkstra(&graph, from, Some(to), |edge| *edge.weight()).get(&to).copied();
        let astar = algo::astar(&graph, from, |node| node == to, |edge| *edge.weight(), |_| 0.0);
        assert_eq!(dijkstra.is_some(), astar.is_some());
        dijkstra
    }

    #[test]
    fn astar_costs_what_dijkstra_costs_and_what_petgraph_says() {
        let mut found = 0;
        let mut astar_expansions = 0;
        let mut dijkstra_expansions = 0;
        for seed in 0..12 {
            let mut field = TestField::random(seed, 40);
            let start = field.checker.body().body_centre(field.start);
            let astar = roadmap(&field, RoadmapSearch::Astar, RoadmapGoal::InReach);
            let dijkstra = roadmap(&field, RoadmapSearch::Dijkstra, RoadmapGoal::InReach);
            let mut scratch = RoadmapScratch::default();
            for _ in 0..15 {
                let goal = field.random_goal();
                let a = astar.route(start, goal, &mut scratch).ok().map(|route| route.cost);
                astar_expansions += scratch.expansions;
                let d = dijkstra.route(start, goal, &mut scratch).ok().map(|route| route.cost);
                dijkstra_expansions += scratch.expansions;
                let p = length_by_petgraph(&astar, start, goal);
                assert_eq!((a.is_some(), d.is_some()), (p.is_some(), p.is_some()));
                if let (Some(a), Some(d), Some(p)) = (a, d, p) {
                    assert!((a - p).abs() < 1e-9 && (d - p).abs() < 1e-9, "A* {a}, Dijkstra {d}, petgraph {p}");
                    found += 1;
                }
            }
        }
        assert!(found > 120, "only {found} routes");
        assert!(2 * astar_expansions < dijkstra_expansions);
    }

    #[test]
    fn routes_keep_the_clearance_and_end_in_the_goal() {
        for search in [RoadmapSearch::Astar, RoadmapSearch::Greedy] {
            for seed in 0..10 {
                let mut field = TestField::random(seed, 25);
                let start = field.checker.body().body_centre(field.start);
                let roadmap = roadmap(&field, search, RoadmapGoal::InReach);
                let goal = field.random_goal();
                let Ok(mut route) = roadmap.route(start, goal, &mut RoadmapScratch::default()) else { continue };
                let length = route.cost;
                for tightened in [false, true] {
                    if tightened {
                        roadmap.tighten(start, &mut route);
                        assert!(route.cost <= length + 1e-9);
                    }
                    let mut here = start;
                    for &next in &route.waypoints {
                        for k in 0..=100 {
                            let clearance = field.checker.field().distance(here.lerp(next, f64::from(k) / 100.0));
                            assert!(
                                clearance >= PrmSettings::default().clearance_m,
                                "{clearance} between {here} and {next}"
                            );
                        }
                        here = next;
                    }
                    assert!(here.distance(goal.centre) <= goal.radius_m + 1e-9);
                }
            }
        }
    }

    #[test]
    fn the_nearest_milestone_in_reach_ends_the_route_when_that_is_the_goal() {
        let mut field = TestField::random(2, 15);
        let start = field.checker.body().body_centre(field.start);
        let roadmap = roadmap(&field, RoadmapSearch::Greedy, RoadmapGoal::NearestMilestone);
        let (mut found, mut beyond_reach) = (0, 0);
        for _ in 0..40 {
            let goal = field.random_goal();
            let nearest = roadmap.milestones.iter().map(|m| m.distance(goal.centre)).fold(f64::INFINITY, f64::min);
            for radius_m in [0.5 * nearest, nearest, 10.0, f64::INFINITY] {
                let route = roadmap.route(start, GoalDisc { radius_m, ..goal }, &mut RoadmapScratch::default());
                match route {
                    Ok(route) => {
                        assert_eq!(route.waypoints.last().map(|last| last.distance(goal.centre)), Some(nearest));
                        assert!(nearest <= radius_m);
                        found += 1;
                    }
                    Err(reason) => {
                        assert_eq!(reason == PlanFailure::GoalBlocked, nearest > radius_m, "{nearest} {radius_m}");
                        beyond_reach += u32::from(nearest > radius_m);
                    }
                }
            }
        }
        assert!(found > 40 && beyond_reach >= 40, "{found} found, {beyond_reach} beyond reach");
    }

    #[test]
    fn a_roadmap_without_milestones_has_none_in_reach_and_leads_nowhere() {
        let field = TestField::random(2, 15);
        let goal = RoadmapGoal::NearestMilestone;
        let settings = PrmSettings { samples: 0, goal, ..PrmSettings::default() };
        let roadmap = Roadmap::sampled(&field.checker, &settings, &mut rng::stream(7, "prm")).connected();
        let reason = |radius_m| {
            let goal = GoalDisc { centre: field.bushes[0], radius_m };
            roadmap
                .route(field.start.position(), goal, &mut RoadmapScratch::default())
                .expect_err("nothing leads there")
        };
        assert_eq!(reason(10.0), PlanFailure::GoalBlocked);
        assert_eq!(reason(f64::INFINITY), PlanFailure::Disconnected);
    }

    #[test]
    fn a_roadmap_without_milestones_still_knows_the_straight_line() {
        let field = TestField::drawn(&["................"; 6], wildfire_base::geometry::Pose::new(10.0, 15.0, 0.0));
        let settings = PrmSettings { samples: 0, ..PrmSettings::default() };
        let roadmap = Roadmap::sampled(&field.checker, &settings, &mut rng::stream(7, "prm")).connected();
        let goal = GoalDisc { centre: DVec2::new(60.0, 15.0), radius_m: 10.0 };
        let route = roadmap.route(DVec2::new(11.5, 15.0), goal, &mut RoadmapScratch::default()).expect("a free field");
        assert_eq!(route.waypoints, [DVec2::new(50.0, 15.0)]);
        assert_eq!(route.cost, 38.5);
    }

    #[test]
    fn with_safety_costs_astar_costs_what_dijkstra_costs_and_tightening_makes_no_way_dearer() {
        let (mut found, mut cheaper) = (0, 0);
        for seed in 0..6 {
            let mut field = TestField::random(seed, 40);
            let start = field.checker.body().body_centre(field.start);
            let settings = SafetySettings { map: SafetyMap::Brushfire, weight: 4.0, ..SafetySettings::default() };
            let obstacles = field.checker.field();
            let safety = Safety::new(*obstacles.frame(), obstacles.occupied(), &settings).map(Arc::new);
            let priced = |search| {
                let settings = PrmSettings { samples: 150, search, ..PrmSettings::default() };
                let sampled = Roadmap::sampled(&field.checker, &settings, &mut rng::stream(7, "prm"));
                sampled.priced_by(safety.clone()).connected()
            };
            let astar = priced(RoadmapSearch::Astar);
            let dijkstra = priced(RoadmapSearch::Dijkstra);
            let plain = roadmap(&field, RoadmapSearch::Astar, RoadmapGoal::InReach);
            let mut scratch = RoadmapScratch::default();
            let price = |route: &RoadmapRoute| -> f64 {
                let places: Vec<DVec2> = [start].into_iter().chain(route.waypoints.iter().copied()).collect();
                places.windows(2).map(|line| astar.space.price(line[0], line[1])).sum()
            };
            for _ in 0..10 {
                let goal = field.random_goal();
                let Ok(mut route) = astar.route(start, goal, &mut scratch) else { continue };
                let blind = dijkstra.route(start, goal, &mut scratch).expect("it searches the same roadmap");
                assert!((route.cost - blind.cost).abs() < 1e-9 && (route.cost - price(&route)).abs() < 1e-9);
                let shortest = plain.route(start, goal, &mut scratch).expect("it has the same edges");
                assert!(route.cost <= price(&shortest) + 1e-9 && route.cost >= shortest.cost - 1e-9);
                cheaper += u32::from(route.cost < price(&shortest) - 1.0);
                let before = route.cost;
                astar.tighten(start, &mut route);
                assert!(route.cost <= before + 1e-9 && (route.cost - price(&route)).abs() < 1e-9);
                found += 1;
            }
        }
        assert!(found > 40 && cheaper > 10, "{found} routes, {cheaper} of them cheaper than the shortest");
    }
}
