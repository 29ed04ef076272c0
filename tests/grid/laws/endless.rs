//! Maps on which naive programs loop for ever or divide by zero.

use wildfire::grid::brushfire::brushfire;
use wildfire::grid::cost_map::{TwoZones, cost_map};
use wildfire::grid::descent::{Escape, descend_or_escape};
use wildfire::grid::octile::shortest_path;
use wildfire::grid::potential::{Attraction, Repulsion, RepulsionDistance, attraction, repulsion};
use wildfire::grid::wavefront::{descend_wavefront, wavefront};
use wildfire::grid::{BadPlace, Connectivity, Grid, Place, Route, TieOrder};

use super::problems::{WAYS, map, potential};

/// What every function says of a map between two places, so that each has had its chance to loop for ever.
fn everything(
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
) -> Vec<(Result<Route, BadPlace>, Result<Escape, BadPlace>)> {
    let answers = WAYS.map(|way| {
        let potential = potential(occupied, goal, way.0, RepulsionDistance::True);
        let shortest = shortest_path(occupied, start, goal, way.0, way.1);
        let steps = wavefront(occupied, goal, way.0, way.1)
            .map(|values| descend_wavefront(&values, start, way.0, way.1, TieOrder::WestFirst));
        let found = |route: &Result<Route, BadPlace>| matches!(route, Ok(Route::Found(_)));
        assert!(shortest == steps || (found(&shortest) && found(&steps)), "{shortest:?}, but {steps:?}");
        (shortest, descend_or_escape(&potential, occupied, start, goal, way.0, way.1))
    });
    answers.into()
}

#[test]
fn a_map_without_obstacles_is_a_state_of_its_own() {
    let open = map(&["...", "..."]);
    for connectivity in [Connectivity::Four, Connectivity::Eight] {
        assert_eq!(brushfire(&open, connectivity), None);
    }
    let nothing = Grid::filled(2, 3, 0);
    assert_eq!(cost_map(&nothing, &TwoZones::default()), Grid::filled(2, 3, 0.0));
    assert_eq!(repulsion(&nothing, &Repulsion::default()), Grid::filled(2, 3, 0.0));
    for (route, escape) in everything(&open, (0, 0), (1, 2)) {
        assert!(matches!(route, Ok(Route::Found(_))), "{route:?}");
        assert!(matches!(escape, Ok(Escape::NotNeeded(_))), "{escape:?}");
    }
}

#[test]
fn a_full_map_is_all_obstacle_and_has_no_goal() {
    let full = map(&["###", "###"]);
    for connectivity in [Connectivity::Four, Connectivity::Eight] {
        assert_eq!(brushfire(&full, connectivity), Some(Grid::filled(2, 3, 1)));
    }
    for (route, escape) in everything(&full, (0, 0), (1, 2)) {
        assert_eq!(route, Err(BadPlace::Occupied { place: (1, 2) }));
        assert_eq!(escape, Err(BadPlace::Occupied { place: (1, 2) }));
    }
}

#[test]
fn an_enclosed_goal_is_unreachable() {
    let enclosed = map(&[".....", ".###.", ".#.#.", ".###.", "....."]);
    for (route, escape) in everything(&enclosed, (0, 0), (2, 2)) {
        assert_eq!(route, Ok(Route::Unreachable));
        assert!(matches!(escape, Ok(Escape::Unreachable(_))), "{escape:?}");
    }
}

#[test]
fn a_start_in_an_obstacle_is_an_answer_and_a_place_outside_an_error() {
    let wall = map(&[".#."]);
    for (route, escape) in everything(&wall, (0, 1), (0, 2)) {
        assert_eq!((route, escape), (Ok(Route::StartOccupied), Ok(Escape::StartOccupied)));
    }
    let outside = BadPlace::Outside { place: (1, 0), rows: 1, cols: 3 };
    for way in WAYS {
        assert_eq!(shortest_path(&wall, (1, 0), (0, 2), way.0, way.1), Err(outside.clone()));
        assert_eq!(shortest_path(&wall, (0, 2), (1, 0), way.0, way.1), Err(outside.clone()));
        assert_eq!(wavefront(&wall, (1, 0), way.0, way.1), Err(outside.clone()));
    }
}

#[test]
fn a_map_of_one_cell_is_its_own_path() {
    let one = map(&["."]);
    for (route, escape) in everything(&one, (0, 0), (0, 0)) {
        assert_eq!(route, Ok(Route::Found(vec![(0, 0)])));
        assert_eq!(escape, Ok(Escape::NotNeeded(vec![(0, 0)])));
    }
    assert_eq!(attraction(1, 1, (0, 0), Attraction::default(), Some(10.0)).values(), [0.0]);
}
