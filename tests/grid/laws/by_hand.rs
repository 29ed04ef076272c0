//! Small maps whose answers were reckoned by hand.

use wildfire::grid::brushfire::brushfire;
use wildfire::grid::octile::shortest_path;
use wildfire::grid::wavefront::wavefront;
use wildfire::grid::{Connectivity, Route};

use super::problems::{WAYS, Way, map};

#[test]
fn a_small_map_has_the_values_reckoned_by_hand() {
    let room = map(&[
        "......", //
        ".##...", //
        ".#....", //
        "....#.",
    ]);
    let four = brushfire(&room, Connectivity::Four).unwrap();
    #[rustfmt::skip]
    assert_eq!(four.values(), [
        3, 2, 2, 3, 4, 5,
        2, 1, 1, 2, 3, 4,
        2, 1, 2, 3, 2, 3,
        3, 2, 3, 2, 1, 2,
    ]);
    let eight = brushfire(&room, Connectivity::Eight).unwrap();
    #[rustfmt::skip]
    assert_eq!(eight.values(), [
        2, 2, 2, 2, 3, 4,
        2, 1, 1, 2, 3, 3,
        2, 1, 2, 2, 2, 2,
        2, 2, 2, 2, 1, 2,
    ]);
    let steps = |way: Way| wavefront(&room, (2, 2), way.0, way.1).unwrap();
    #[rustfmt::skip]
    assert_eq!(steps(WAYS[0]).values(), [
        8, 7, 6, 5, 6, 7,
        7, 1, 1, 4, 5, 6,
        6, 1, 2, 3, 4, 5,
        5, 4, 3, 4, 1, 6,
    ]);
    #[rustfmt::skip]
    assert_eq!(steps(WAYS[1]).values(), [
        6, 5, 4, 4, 4, 5,
        5, 1, 1, 3, 4, 5,
        4, 1, 2, 3, 4, 5,
        4, 3, 3, 3, 1, 5,
    ]);
    #[rustfmt::skip]
    assert_eq!(steps(WAYS[2]).values(), [
        8, 7, 6, 5, 5, 5,
        7, 1, 1, 4, 4, 5,
        6, 1, 2, 3, 4, 5,
        5, 4, 3, 3, 1, 6,
    ]);
}

#[test]
fn a_small_map_has_the_paths_found_by_hand() {
    let wall = map(&[
        "....", //
        ".##.", //
        "....",
    ]);
    let path = |way: Way| shortest_path(&wall, (0, 0), (2, 3), way.0, way.1);
    let south_about = vec![(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (2, 3)];
    assert_eq!(path(WAYS[0]), Ok(Route::Found(south_about.clone())));
    assert_eq!(path(WAYS[1]), Ok(Route::Found(vec![(0, 0), (1, 0), (2, 1), (2, 2), (2, 3)])));
    assert_eq!(path(WAYS[2]), Ok(Route::Found(south_about)));
}
