//! Laws of the grid maps on random maps, small cases reckoned by hand, and the maps on which naive programs never end.

mod by_hand;
mod endless;
mod path_searches;
mod problems;

use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;

use wildfire::grid::brushfire::brushfire;
use wildfire::grid::descent::{Descent, Escape, descend, descend_or_escape};
use wildfire::grid::octile::{cost_to_go, legal_moves, shortest_path};
use wildfire::grid::place::octile_length;
use wildfire::grid::potential::RepulsionDistance;
use wildfire::grid::wavefront::{GOAL, OBSTACLE, UNREACHED, descend_wavefront, wavefront};
use wildfire::grid::{Connectivity, Place, Route, TieOrder};

use problems::{
    WAYS, assert_is_walk, free_places, lengths_by_petgraph, neighbours, places, potential, random_problem,
    route_by_wavefront,
};

#[test]
fn brushfire_equals_brute_force() {
    for seed in 0..60 {
        let (occupied, ..) = random_problem(seed);
        let obstacles: Vec<Place> = places(&occupied).into_iter().filter(|&place| occupied[place]).collect();
        for connectivity in [Connectivity::Four, Connectivity::Eight] {
            let distance = |a: Place, b: Place| {
                let (rows, cols) = (a.0.abs_diff(b.0), a.1.abs_diff(b.1));
                if connectivity == Connectivity::Four { rows + cols } else { rows.max(cols) }
            };
            let nearest = |place| obstacles.iter().map(|&obstacle| distance(place, obstacle)).min();
            let found = brushfire(&occupied, connectivity);
            assert_eq!(found.is_none(), obstacles.is_empty(), "seed {seed}");
            for place in places(&occupied).into_iter().filter(|_| !obstacles.is_empty()) {
                let value = found.as_ref().map(|values| usize::from(values[place]));
                assert_eq!(value, nearest(place).map(|distance| distance + 1), "seed {seed}, {place:?}");
            }
        }
    }
}

#[test]
fn wavefront_falls_by_one_along_the_path_and_reaches_what_a_graph_search_does() {
    for seed in 0..60 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let values = wavefront(&occupied, goal, way.0, way.1).unwrap();
            for order in [TieOrder::CrossFirst, TieOrder::WestFirst] {
                match descend_wavefront(&values, start, way.0, way.1, order) {
                    Route::Found(path) => {
                        assert_is_walk(&occupied, &path, start, goal, way);
                        assert!(path.windows(2).all(|pair| values[pair[0]] == values[pair[1]] + 1), "seed {seed}");
                    }
                    other => assert_eq!((other, values[start]), (Route::Unreachable, UNREACHED), "seed {seed}"),
                }
            }
            let graph = lengths_by_petgraph(&occupied, goal, way);
            for place in places(&occupied) {
                let is_reached = values[place] >= GOAL;
                assert_eq!(graph.contains_key(&place), is_reached, "seed {seed}, {place:?}, {way:?}");
                assert_eq!(values[place] == OBSTACLE, occupied[place], "seed {seed}, {place:?}");
            }
        }
    }
}

/// A step changes the value by one at most, and from everywhere but the goal some step lowers it: only the numbers of
/// fewest steps do that.
#[test]
fn wavefront_counts_the_fewest_steps() {
    for seed in 0..60 {
        let (occupied, _, goal) = random_problem(seed);
        for way in WAYS {
            let values = wavefront(&occupied, goal, way.0, way.1).unwrap();
            assert_eq!(values[goal], GOAL);
            for place in places(&occupied).into_iter().filter(|&place| values[place] >= GOAL) {
                let around: Vec<u32> = neighbours(&occupied, place, way).map(|to| values[to]).collect();
                assert!(
                    around.iter().all(|value| value.abs_diff(values[place]) <= 1),
                    "seed {seed}, {place:?}, {way:?}"
                );
                let is_next = around.contains(&(values[place] - 1));
                assert_eq!(is_next, place != goal, "seed {seed}, {place:?}, {way:?}");
            }
        }
    }
}

#[test]
fn shortest_paths_are_as_long_as_another_dijkstra_says() {
    let mut longer_by_wavefront = 0;
    for seed in 0..150 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let expected = lengths_by_petgraph(&occupied, goal, way).get(&start).copied();
            match shortest_path(&occupied, start, goal, way.0, way.1).unwrap() {
                Route::Found(path) => {
                    assert_is_walk(&occupied, &path, start, goal, way);
                    let length = octile_length(&path);
                    assert!((length - expected.expect("there is a way")).abs() < 1e-9, "seed {seed}, {way:?}");
                    if let Route::Found(steps) = route_by_wavefront(&occupied, start, goal, way) {
                        assert!(steps.len() <= path.len() && octile_length(&steps) > length - 1e-9, "seed {seed}");
                        longer_by_wavefront += usize::from(octile_length(&steps) > length + 1e-9);
                    }
                }
                other => assert_eq!((other, expected), (Route::Unreachable, None), "seed {seed}, {way:?}"),
            }
        }
    }
    assert!(longer_by_wavefront > 5, "fewest steps were shortest on all but {longer_by_wavefront} maps");
}

#[test]
fn of_several_shortest_paths_the_one_with_the_first_steps_is_taken() {
    for seed in 0..150 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let to_go = lengths_by_petgraph(&occupied, goal, way);
            let Route::Found(path) = shortest_path(&occupied, start, goal, way.0, way.1).unwrap() else { continue };
            for pair in path.windows(2) {
                let by_way_of = |to: Place| to_go[&to] + octile_length(&[pair[0], to]);
                let first =
                    neighbours(&occupied, pair[0], way).find(|&to| (by_way_of(to) - to_go[&pair[0]]).abs() < 1e-9);
                assert_eq!(first, Some(pair[1]), "seed {seed}, {way:?}");
            }
        }
    }
}

#[test]
fn costs_to_go_are_the_lengths_of_shortest_walks() {
    for seed in 0..60 {
        let (occupied, other, goal) = random_problem(seed);
        let index = |place: Place| place.0 * occupied.cols() + place.1;
        for way in WAYS {
            let moves = legal_moves(&occupied, way.0, way.1);
            let costs = cost_to_go(&moves, [index(goal), index(other)], (1.0, SQRT_2));
            let (to_goal, to_other) =
                (lengths_by_petgraph(&occupied, goal, way), lengths_by_petgraph(&occupied, other, way));
            for place in places(&occupied) {
                let length = |to: &BTreeMap<Place, f64>| to.get(&place).copied().unwrap_or(f64::INFINITY);
                let expected = length(&to_goal).min(length(&to_other));
                let found = costs[place];
                assert!(found == expected || (found - expected).abs() < 1e-9, "seed {seed}, {place:?}, {way:?}");
            }
        }
    }
}

#[test]
fn steps_between_four_neighbours_bound_those_between_eight() {
    for seed in 0..60 {
        let (occupied, _, goal) = random_problem(seed);
        if let (Some(four), Some(eight)) =
            (brushfire(&occupied, Connectivity::Four), brushfire(&occupied, Connectivity::Eight))
        {
            for place in places(&occupied) {
                let (four, eight) = (four[place] - 1, eight[place] - 1);
                assert!(eight <= four && four <= 2 * eight, "seed {seed}, {place:?}");
            }
        }
        let [four, cut, kept] = WAYS.map(|way| wavefront(&occupied, goal, way.0, way.1).unwrap());
        for place in free_places(&occupied) {
            // Where no corner may be cut, every diagonal step has two orthogonal ones in its place.
            assert_eq!(four[place] == UNREACHED, kept[place] == UNREACHED, "seed {seed}, {place:?}");
            if four[place] != UNREACHED {
                let (four, cut, kept) = (four[place] - GOAL, cut[place] - GOAL, kept[place] - GOAL);
                assert!(cut <= kept && kept <= four && four <= 2 * kept, "seed {seed}, {place:?}");
            }
        }
    }
}

#[test]
fn descent_never_climbs_and_ends_at_the_goal_or_a_minimum() {
    let (mut reached, mut stuck) = (0, 0);
    for seed in 0..150 {
        let (occupied, start, goal) = random_problem(seed);
        for (way, distance) in
            WAYS.into_iter().zip([RepulsionDistance::Brushfire, RepulsionDistance::True, RepulsionDistance::Brushfire])
        {
            let potential = potential(&occupied, goal, way.0, distance);
            let (path, is_reached) = match descend(&potential, &occupied, start, goal, way.0, way.1).unwrap() {
                Descent::Reached(path) => (path, true),
                Descent::Stuck(path) => (path, false),
                Descent::StartOccupied => panic!("the start is free"),
            };
            let end = path[path.len() - 1];
            assert_is_walk(&occupied, &path, start, end, way);
            assert!(path.windows(2).all(|pair| potential[pair[1]] < potential[pair[0]]), "seed {seed}");
            assert_eq!(end == goal, is_reached, "seed {seed}");
            let is_minimum = neighbours(&occupied, end, way).all(|to| potential[to] >= potential[end]);
            assert!(is_reached || is_minimum, "seed {seed}");
            *(if is_reached { &mut reached } else { &mut stuck }) += 1;
        }
    }
    assert!(reached > 50 && stuck > 50, "{reached} descents reached their goal, {stuck} were stuck");
}

#[test]
fn an_escape_arrives_wherever_the_goal_can_be_reached() {
    let mut handed_over = 0;
    for seed in 0..150 {
        let (occupied, start, goal) = random_problem(seed);
        for way in WAYS {
            let potential = potential(&occupied, goal, way.0, RepulsionDistance::Brushfire);
            let is_reachable = route_by_wavefront(&occupied, start, goal, way) != Route::Unreachable;
            match descend_or_escape(&potential, &occupied, start, goal, way.0, way.1).unwrap() {
                Escape::NotNeeded(path) => assert_is_walk(&occupied, &path, start, goal, way),
                Escape::HandedOver { descent, wavefront } => {
                    handed_over += 1;
                    assert_is_walk(&occupied, &descent, start, wavefront[0], way);
                    assert_is_walk(&occupied, &wavefront, descent[descent.len() - 1], goal, way);
                }
                Escape::Unreachable(descent) => {
                    assert!(!is_reachable, "seed {seed}, {way:?}");
                    assert_is_walk(&occupied, &descent, start, descent[descent.len() - 1], way);
                }
                Escape::StartOccupied => panic!("the start is free"),
            }
        }
    }
    assert!(handed_over > 50, "only {handed_over} descents were handed over");
}
