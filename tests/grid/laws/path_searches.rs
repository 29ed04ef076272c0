//! Laws of the searches, and of the trees and roadmaps of points.

use wildfire::grid::path_search::{
    Heuristic, PathSearch, SearchOrder, jump_point_search, search_best_first, theta_star,
};
use wildfire::grid::place::octile_length;
use wildfire::grid::sampling::{
    PointGraph, PointRoute, PrmSettings, RrtSettings, TreeKind, grow_tree, probabilistic_roadmap,
};
use wildfire::grid::segment::{GridPoint, is_free_segment, line_length};
use wildfire::grid::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route};

use super::problems::{WAYS, Way, assert_is_walk, free_places, lengths_by_petgraph, map, random_problem};

const CORNERS: [CornerCutting; 2] = [CornerCutting::Allowed, CornerCutting::Forbidden];

fn search(occupied: &Grid<bool>, ends: (Place, Place), order: SearchOrder, way: Way) -> PathSearch {
    search_best_first(occupied, ends.0, ends.1, order, way.0, way.1).expect("both ends are free")
}

fn greedy_order(connectivity: Connectivity) -> SearchOrder {
    SearchOrder::Greedy { heuristic: Heuristic::exact(connectivity) }
}

fn cells(search: &PathSearch) -> &[Place] {
    match &search.route {
        Route::Found(cells) => cells,
        _ => &[],
    }
}

#[test]
fn astar_dijkstra_and_jumps_cost_what_another_dijkstra_says() {
    let mut saved = (0, 0);
    for seed in 0..200 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let expected = lengths_by_petgraph(&occupied, start, way).get(&goal).copied();
            let mut found = vec![
                search(&occupied, (start, goal), SearchOrder::astar(way.0), way),
                search(&occupied, (start, goal), SearchOrder::Dijkstra, way),
            ];
            if way.0 == Connectivity::Eight {
                found.push(jump_point_search(&occupied, start, goal, way.1).expect("both ends are free"));
            }
            for search in &found {
                let case = format!("seed {seed}, {way:?}");
                assert_eq!(search.cost.is_some(), expected.is_some(), "{case}");
                // Counted in steps of either kind: the same number, bit for bit.
                assert_eq!(search.cost, found[0].cost, "{case}");
                if let Some(cost) = search.cost {
                    assert!((cost - expected.expect("there is a way")).abs() < 1e-9, "{case}");
                    assert_is_walk(&occupied, cells(search), start, goal, way);
                    assert_eq!(octile_length(cells(search)), cost, "{case}");
                }
            }
            saved.0 += found[1].expanded.len() - found[0].expanded.len().min(found[1].expanded.len());
            saved.1 += found.get(2).map_or(0, |jumps| usize::from(jumps.expanded.len() < found[0].expanded.len()));
        }
    }
    assert!(
        saved.0 > 1000 && saved.1 > 100,
        "an estimate saved {} expansions, jumps were fewer {} times",
        saved.0,
        saved.1
    );
}

#[test]
fn costs_of_what_was_expanded_are_the_lengths_of_shortest_walks() {
    for seed in 0..60 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let lengths = lengths_by_petgraph(&occupied, start, way);
            for order in [SearchOrder::astar(way.0), SearchOrder::Dijkstra] {
                let found = search(&occupied, (start, goal), order, way);
                let reached = found.costs.values().iter().filter(|cost| cost.is_finite()).count();
                assert_eq!(reached, found.touched, "seed {seed}");
                for &index in &found.expanded {
                    let place = (index as usize / occupied.cols(), index as usize % occupied.cols());
                    assert!((found.costs[place] - lengths[&place]).abs() < 1e-9, "seed {seed}, {place:?}, {way:?}");
                }
                let mut once = found.expanded.clone();
                once.sort_unstable();
                once.dedup();
                assert_eq!(once.len(), found.expanded.len(), "no cell is expanded twice");
            }
        }
    }
}

#[test]
fn greedy_search_arrives_where_astar_does_and_costs_no_less() {
    let mut longer = 0;
    for seed in 0..150 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let greedy = search(&occupied, (start, goal), greedy_order(way.0), way);
            let astar = search(&occupied, (start, goal), SearchOrder::astar(way.0), way);
            assert_eq!(greedy.cost.is_some(), astar.cost.is_some(), "seed {seed}, {way:?}");
            if let Some((cost, min)) = greedy.cost.zip(astar.cost) {
                assert_is_walk(&occupied, cells(&greedy), start, goal, way);
                assert!(cost >= min && cost == octile_length(cells(&greedy)), "seed {seed}, {way:?}");
                longer += usize::from(cost > min);
            }
        }
    }
    assert!(longer > 10, "greedy paths were longer {longer} times");
}

#[test]
fn weighted_astar_keeps_its_bound_and_a_zero_estimate_is_dijkstras() {
    let (mut longer, mut fewer) = (0, 0);
    for seed in 0..150 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let dijkstra = search(&occupied, (start, goal), SearchOrder::Dijkstra, way);
            let astar = search(&occupied, (start, goal), SearchOrder::astar(way.0), way);
            assert!(astar.expanded.len() <= dijkstra.expanded.len(), "seed {seed}, {way:?}");
            for heuristic in [Heuristic::Zero, Heuristic::Euclidean, Heuristic::Octile, Heuristic::Manhattan] {
                for weight in [0.0, 0.5, 1.0, 1.5, 4.0, 1000.0] {
                    let case = format!("seed {seed}, {way:?}, {heuristic:?}, weight {weight}");
                    let order = SearchOrder::AStar { heuristic, weight };
                    let found = search(&occupied, (start, goal), order, way);
                    assert_eq!(found.cost.is_some(), dijkstra.cost.is_some(), "{case}");
                    if heuristic == Heuristic::Zero || weight == 0.0 {
                        assert_eq!(found, dijkstra, "{case}");
                    }
                    let Some((cost, min)) = found.cost.zip(dijkstra.cost) else { continue };
                    assert_is_walk(&occupied, cells(&found), start, goal, way);
                    let bound = order.cost_bound(way.0).expect("A* has a bound");
                    assert!(cost >= min && cost <= bound * min + 1e-9, "{case}: {cost} and {min}");
                    assert!(bound > 1.0 || cost == min, "{case}: {cost} and {min}");
                    longer += usize::from(cost > min);
                    fewer += usize::from(weight > 1.0 && found.expanded.len() < astar.expanded.len());
                }
            }
        }
    }
    assert!(longer > 100 && fewer > 500, "{longer} paths were longer, {fewer} searches expanded less");
    let refused = SearchOrder::AStar { heuristic: Heuristic::Octile, weight: -1.0 }.check();
    assert!(refused.is_err_and(|problem| problem.to_string().contains("the weight")));
}

#[test]
fn any_angle_paths_are_free_and_cost_no_more_than_steps() {
    let mut shorter = 0;
    for seed in 0..200 {
        let (occupied, start, goal) = random_problem(seed);
        for corners in CORNERS {
            let found = theta_star(&occupied, start, goal, corners).expect("both ends are free");
            let astar = search(
                &occupied,
                (start, goal),
                SearchOrder::astar(Connectivity::Eight),
                (Connectivity::Eight, corners),
            );
            assert_eq!(found.cost.is_some(), astar.cost.is_some(), "seed {seed}, {corners:?}");
            let Some((cost, in_steps)) = found.cost.zip(astar.cost) else { continue };
            assert!(cost <= in_steps + 1e-9, "seed {seed}, {corners:?}: {cost} and {in_steps}");
            shorter += usize::from(cost < in_steps - 1e-9);
            let path = cells(&found);
            assert_eq!((path[0], path[path.len() - 1]), (start, goal));
            assert!((line_length(path) - cost).abs() < 1e-9);
            for pair in path.windows(2) {
                let ends = [pair[0], pair[1]].map(GridPoint::centre);
                assert!(is_free_segment(&occupied, ends[0], ends[1], corners), "seed {seed}, {pair:?}");
            }
        }
    }
    assert!(shorter > 40, "turning at any angle was shorter {shorter} times");
}

#[test]
fn wrong_ends_are_refused_and_an_occupied_start_is_an_answer() {
    let wall = map(&[".#."]);
    let searches = |(start, goal): (Place, Place)| {
        let way = (Connectivity::Eight, CornerCutting::Allowed);
        vec![
            search_best_first(&wall, start, goal, SearchOrder::astar(way.0), way.0, way.1).map(|found| found.route),
            search_best_first(&wall, start, goal, greedy_order(way.0), way.0, way.1).map(|found| found.route),
            theta_star(&wall, start, goal, way.1).map(|found| found.route),
            jump_point_search(&wall, start, goal, way.1).map(|found| found.route),
        ]
    };
    let all = |ends, expected: &Result<Route, BadPlace>| assert!(searches(ends).iter().all(|found| found == expected));
    all(((0, 0), (0, 1)), &Err(BadPlace::Occupied { place: (0, 1) }));
    all(((0, 0), (1, 0)), &Err(BadPlace::Outside { place: (1, 0), rows: 1, cols: 3 }));
    all(((2, 0), (0, 0)), &Err(BadPlace::Outside { place: (2, 0), rows: 1, cols: 3 }));
    all(((0, 1), (0, 0)), &Ok(Route::StartOccupied));
    all(((0, 0), (0, 2)), &Ok(Route::Unreachable));
    all(((0, 0), (0, 0)), &Ok(Route::Found(vec![(0, 0)])));
}

fn tree(samples: u32) -> RrtSettings {
    RrtSettings { seed: 7, samples, step: 3.0, goal_bias: 0.05, neighbours: None, radius: None }
}

/// Checks that all edges are free, and that costs are lengths along the path.
fn assert_is_sound(occupied: &Grid<bool>, graph: &PointGraph, (start, goal): (Place, Place), longest: f64) {
    for edge in &graph.edges {
        let [from, to] = edge.map(|number| graph.points[number as usize]);
        assert!(is_free_segment(occupied, from, to, CornerCutting::Forbidden));
        assert!(from.distance(to) <= longest);
    }
    assert_eq!(graph.cost.is_some(), graph.answer == PointRoute::Found);
    assert_eq!(graph.path.is_empty(), graph.cost.is_none());
    let Some(cost) = graph.cost else { return };
    let (first, last) = (graph.path[0], graph.path[graph.path.len() - 1]);
    assert_eq!((first, last), (GridPoint::centre(start), GridPoint::centre(goal)));
    assert!(graph.path.windows(2).all(|pair| is_free_segment(occupied, pair[0], pair[1], CornerCutting::Forbidden)));
    let length: f64 = graph.path.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    assert!((length - cost).abs() < 1e-9 && cost >= first.distance(last) - 1e-9);
}

#[test]
fn trees_and_roadmaps_are_free_and_their_costs_are_lengths() {
    let mut found = [0; 3];
    for seed in 0..60 {
        let (occupied, start, goal) = random_problem(seed);
        let ends = (start, goal);
        let settings = RrtSettings { seed, ..tree(400) };
        let rrt = grow_tree(&occupied, start, goal, TreeKind::Rrt, &settings).expect("both ends are free");
        let star = grow_tree(&occupied, start, goal, TreeKind::RrtStar, &settings).expect("both ends are free");
        let prm = PrmSettings { seed, samples: 300, neighbours: None, radius: Some(9.0) };
        let prm = probabilistic_roadmap(&occupied, start, goal, &prm).expect("both ends are free");
        assert_eq!(rrt, grow_tree(&occupied, start, goal, TreeKind::Rrt, &settings).expect("the same"));
        assert_is_sound(&occupied, &rrt, ends, 3.01);
        // An edge that was joined again may be longer than a step.
        assert_is_sound(&occupied, &star, ends, f64::INFINITY);
        assert_is_sound(&occupied, &prm, ends, 9.0);
        for (count, graph) in found.iter_mut().zip([rrt, star, prm]) {
            // A point that touches nothing goes wherever steps between four neighbours do.
            let way = (Connectivity::Four, CornerCutting::Forbidden);
            let is_joined = lengths_by_petgraph(&occupied, start, way).contains_key(&goal);
            assert!(is_joined || graph.cost.is_none(), "seed {seed}");
            *count += usize::from(graph.cost.is_some());
        }
    }
    assert!(found.iter().all(|&count| count > 15), "{found:?} of 60 found");
}

#[test]
fn paths_of_a_growing_rrt_star_get_shorter_and_lead_from_end_to_end() {
    let occupied = map(&["..........", "..######..", "..######..", "..........", "....##....", "....##...."]);
    let (start, goal) = ((0, 0), (5, 9));
    let graph = grow_tree(&occupied, start, goal, TreeKind::RrtStar, &tree(3000)).expect("both ends are free");
    let length = |path: &[GridPoint]| path.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
    let lengths: Vec<f64> = graph.earlier.iter().map(|earlier| length(&earlier.path)).collect();
    assert!(lengths.len() > 1 && lengths.windows(2).all(|pair| pair[1] < pair[0]), "{lengths:?}");
    assert!(lengths[lengths.len() - 1] >= graph.cost.expect("found") - 1e-9);
    assert!(graph.earlier.windows(2).all(|pair| pair[0].edges < pair[1].edges));
    for earlier in &graph.earlier {
        let ends = (earlier.path[0], earlier.path[earlier.path.len() - 1]);
        assert_eq!(ends, (GridPoint::centre(start), GridPoint::centre(goal)));
        assert!(earlier.edges <= graph.edges.len());
    }
    // The first one comes early: that is what a film of the tree shows.
    assert!(graph.earlier[0].edges < graph.edges.len() / 2, "{} of {}", graph.earlier[0].edges, graph.edges.len());
}

#[test]
fn cost_of_rrt_star_falls_with_samples_and_nears_the_shortest() {
    let occupied = map(&["..........", "..######..", "..######..", "..........", "....##....", "....##...."]);
    let start = (0, 0);
    let goal = (5, 9);
    let cost = |samples| {
        grow_tree(&occupied, start, goal, TreeKind::RrtStar, &tree(samples)).expect("both ends are free").cost
    };
    let costs: Vec<f64> =
        [500, 1000, 2000, 4000, 8000].into_iter().map(|samples| cost(samples).expect("found")).collect();
    assert!(costs.windows(2).all(|pair| pair[1] <= pair[0]) && costs[4] < costs[0], "{costs:?}");
    let theta = theta_star(&occupied, start, goal, CornerCutting::Forbidden).expect("both ends are free").cost;
    assert!(costs[4] < 1.05 * theta.expect("found"), "{costs:?} and {theta:?}");
}

#[test]
fn every_free_cell_of_an_open_map_is_found_by_trees() {
    let occupied = map(&["....", ".##.", "...."]);
    for goal in free_places(&occupied) {
        let found = grow_tree(&occupied, (0, 0), goal, TreeKind::Rrt, &tree(2000)).expect("both ends are free");
        assert_eq!(found.answer, PointRoute::Found, "{goal:?}");
    }
}
