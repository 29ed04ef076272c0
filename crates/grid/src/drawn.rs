//! Generated maps, for examples, tests and benchmarks.
//!
//! Occupied cells are `true`. Everything is computed in integers from the draws of the given generator, so a seed names
//! the same map on every machine.

use std::ops::{Range, RangeInclusive};

use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};

use super::{Connectivity, CornerCutting, Grid, Place, TieOrder, place};

/// Generates cells that are occupied with probability `share`, independently.
///
/// # Panics
/// If `share` is not between 0 and 1.
pub fn random(rows: usize, cols: usize, share: f64, rng: &mut impl Rng) -> Grid<bool> {
    Grid::from_values(rows, cols, (0..rows * cols).map(|_| rng.random_bool(share)).collect())
}

/// Generates discs with uniformly random centres among all cells and uniformly random radii, in cells, from `radii`.
///
/// A disc holds the cells whose centres are at most its radius from its own. Discs may overlap and reach over the edge.
///
/// # Panics
/// If the map has no cells or `radii` is empty.
pub fn blobs(rows: usize, cols: usize, count: usize, radii: RangeInclusive<usize>, rng: &mut impl Rng) -> Grid<bool> {
    let mut map = Grid::filled(rows, cols, false);
    for _ in 0..count {
        let centre = (rng.random_range(0..rows), rng.random_range(0..cols));
        let radius = rng.random_range(radii.clone());
        fill_disc(&mut map, centre, radius);
    }
    map
}

/// Generates one occupied cell, at a quarter of the height and three quarters of the width.
///
/// # Panics
/// If the map has no cells.
pub fn single_obstacle(rows: usize, cols: usize) -> Grid<bool> {
    let mut map = Grid::filled(rows, cols, false);
    map[(rows / 4, 3 * cols / 4)] = true;
    map
}

/// Generates a maze in which exactly one path joins any two free cells, were its corridors one cell wide.
///
/// Square rooms of `corridor` cells a side stand in a lattice, with walls and a border of one cell. The walls that are
/// opened form a spanning tree, found by depth-first search in random order ("recursive backtracker": Buck, "Mazes for
/// Programmers", 2015, chapter 5). What is left over at the last rows and columns, if a side is not a multiple of
/// `corridor + 1`, plus 1, stays occupied.
///
/// # Panics
/// If `corridor` is 0.
pub fn maze(rows: usize, cols: usize, corridor: usize, rng: &mut impl Rng) -> Grid<bool> {
    assert!(corridor > 0, "a corridor is at least 1 cell wide");
    let pitch = corridor + 1;
    let mut map = Grid::filled(rows, cols, true);
    // Each room takes one wall with it, and the border needs one cell more.
    let mut is_joined = Grid::filled(rows.saturating_sub(1) / pitch, cols.saturating_sub(1) / pitch, false);
    if is_joined.values().is_empty() {
        return map;
    }
    is_joined[(0, 0)] = true;
    clear_rooms(&mut map, pitch, (0, 0), (0, 0));
    let mut trail = vec![(0, 0)];
    while let Some(&room) = trail.last() {
        let neighbours = TieOrder::CrossFirst.steps(Connectivity::Four).iter();
        // Rooms that are joined count as occupied, so that a step never leads to one of them.
        let to_join = neighbours.filter_map(|&step| place::step(&is_joined, room, step, CornerCutting::Allowed));
        match to_join.collect::<Vec<_>>().choose(rng) {
            Some(&next) => {
                is_joined[next] = true;
                // Neighbours differ in one coordinate only, so the smaller pair is the room in the north or west.
                clear_rooms(&mut map, pitch, room.min(next), room.max(next));
                trail.push(next);
            }
            None => _ = trail.pop(),
        }
    }
    map
}

/// Generates two rooms side by side within a border, with a door in the wall between them.
///
/// The door is an eighth of the height, at least one cell, and lies below the middle, so that most ways bend. Maps of
/// fewer than 3 rows or 5 columns have no room for all this and are full.
pub fn two_rooms(rows: usize, cols: usize) -> Grid<bool> {
    let mut map = Grid::filled(rows, cols, true);
    if rows >= 3 && cols >= 5 {
        let wall = cols / 2;
        let door = 5 * rows / 8;
        fill(&mut map, 1..rows - 1, 1..wall, false);
        fill(&mut map, 1..rows - 1, wall + 1..cols - 1, false);
        fill(&mut map, door..door + (rows / 8).max(1), wall..wall + 1, false);
    }
    map
}

/// Generates a U-shaped trap that opens to the west, in the middle third of the width and the middle half of the
/// height; everything else is free.
///
/// What slides straight from the west edge to a goal at the east edge, in the middle row, is caught. The walls are one
/// cell wide.
pub fn u_trap(rows: usize, cols: usize) -> Grid<bool> {
    let mut map = Grid::filled(rows, cols, false);
    let (north, south) = (rows / 4, 3 * rows / 4);
    let (west, east) = (cols / 3, 2 * cols / 3);
    fill(&mut map, north..south, west..east, true);
    fill(&mut map, north + 1..south.saturating_sub(1), west..east.saturating_sub(1), false);
    map
}

fn fill(map: &mut Grid<bool>, rows: Range<usize>, cols: Range<usize>, value: bool) {
    for row in rows {
        map.row_mut(row)[cols.clone()].fill(value);
    }
}

fn fill_disc(map: &mut Grid<bool>, (row, col): Place, radius: usize) {
    let last_row = (row + radius).min(map.rows() - 1);
    for r in row.saturating_sub(radius)..=last_row {
        let half_width = (radius * radius - row.abs_diff(r) * row.abs_diff(r)).isqrt();
        let end = (col + half_width + 1).min(map.cols());
        fill(map, r..r + 1, col.saturating_sub(half_width)..end, true);
    }
}

/// Clears the rectangle from one room of the lattice to another, walls between them included.
fn clear_rooms(map: &mut Grid<bool>, pitch: usize, first: Place, last: Place) {
    let cells = |first: usize, last: usize| first * pitch + 1..(last + 1) * pitch;
    fill(map, cells(first.0, last.0), cells(first.1, last.1), false);
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::rng;

    fn picture(map: &Grid<bool>) -> Vec<String> {
        (0..map.rows()).map(|row| map.row(row).iter().map(|&cell| if cell { '#' } else { '.' }).collect()).collect()
    }

    fn free_count(map: &Grid<bool>) -> usize {
        map.values().iter().filter(|&&occupied| !occupied).count()
    }

    /// Returns how many free cells four-neighbour steps reach from `start`, itself included.
    fn reached_from(map: &Grid<bool>, start: Place) -> usize {
        let mut open = map.clone();
        open[start] = true;
        let mut stack = vec![start];
        let mut count = 0;
        while let Some(here) = stack.pop() {
            count += 1;
            for &step in TieOrder::CrossFirst.steps(Connectivity::Four) {
                if let Some(next) = place::step(&open, here, step, CornerCutting::Allowed) {
                    open[next] = true;
                    stack.push(next);
                }
            }
        }
        count
    }

    #[test]
    fn a_seed_names_the_same_maps_everywhere() {
        let mut rng = rng::stream(1, "grid/drawn");
        assert_eq!(picture(&random(3, 12, 0.3, &mut rng)), ["##..#.......", ".##...#.....", "..####....##"]);
        let discs = ["..#.........", ".###........", "#####.......", ".###....#...", "..#....###..", "........#..."];
        assert_eq!(picture(&blobs(6, 12, 3, 0..=2, &mut rng)), discs);
        let tree = ["##########", "#.#.....##", "#.#####.##", "#.#...#.##", "#.#.#.#.##", "#...#...##", "##########"];
        assert_eq!(picture(&maze(7, 10, 1, &mut rng)), tree);
    }

    #[test]
    fn maps_without_chance_look_as_described() {
        assert_eq!(picture(&single_obstacle(4, 8)), ["........", "......#.", "........", "........"]);
        assert_eq!(picture(&two_rooms(5, 7)), ["#######", "#..#..#", "#..#..#", "#.....#", "#######"]);
        let trap = ["............", "....####....", ".......#....", ".......#....", "....####....", "............"];
        assert_eq!(picture(&u_trap(6, 12))[..2], trap[..2]);
        assert_eq!(picture(&u_trap(8, 12))[2..6], trap[1..5]);
    }

    #[test]
    fn the_share_of_a_random_map_is_near_the_requested_one() {
        let mut rng = rng::stream(2, "grid/drawn");
        for share in [0.0, 0.1, 0.3, 1.0] {
            let free = free_count(&random(100, 100, share, &mut rng)) as f64;
            // Four standard deviations of the widest of these.
            assert!((free / 1e4 - (1.0 - share)).abs() < 0.02, "{share}");
        }
    }

    #[test]
    fn a_disc_holds_exactly_the_cells_within_its_radius() {
        for radius in 0..7 {
            for centre in [(5, 5), (0, 0), (9, 3)] {
                let mut map = Grid::filled(10, 11, false);
                fill_disc(&mut map, centre, radius);
                for row in 0..10 {
                    for col in 0..11 {
                        let square = centre.0.abs_diff(row).pow(2) + centre.1.abs_diff(col).pow(2);
                        assert_eq!(map[(row, col)], square <= radius * radius, "{centre:?} {radius} {row} {col}");
                    }
                }
            }
        }
    }

    #[test]
    fn mazes_are_connected_trees_of_rooms_within_a_border() {
        let mut rng = rng::stream(3, "grid/drawn");
        for (rows, cols, corridor) in [(21, 31, 1), (28, 46, 8), (30, 50, 8), (40, 13, 3), (2, 9, 1)] {
            let map = maze(rows, cols, corridor, &mut rng);
            let rooms = ((rows - 1) / (corridor + 1)) * ((cols - 1) / (corridor + 1));
            // A tree opens one wall fewer than it has rooms.
            let expected = (rooms * corridor * (corridor + 1)).saturating_sub(corridor);
            assert_eq!(free_count(&map), expected, "{rows} x {cols}, {corridor}");
            assert_eq!(if rooms > 0 { reached_from(&map, (1, 1)) } else { 0 }, expected);
            let column = |col| (0..rows).map(move |row| (row, col));
            let border = column(0).chain(column(cols - 1)).all(|place| map[place]);
            assert!(border && !map.row(0).contains(&false) && !map.row(rows - 1).contains(&false));
        }
    }

    #[test]
    fn two_rooms_are_joined_by_their_door_alone() {
        for (rows, cols) in [(3, 5), (4, 6), (40, 60), (41, 61)] {
            let mut map = two_rooms(rows, cols);
            assert_eq!(reached_from(&map, (1, 1)), free_count(&map), "{rows} x {cols}");
            fill(&mut map, 0..rows, cols / 2..cols / 2 + 1, true);
            assert_eq!(reached_from(&map, (1, 1)), (rows - 2) * (cols / 2 - 1));
        }
    }

    #[test]
    fn maps_of_every_small_size_are_drawn() {
        let mut rng = rng::stream(4, "grid/drawn");
        for (rows, cols) in (1..9).flat_map(|rows| (1..9).map(move |cols| (rows, cols))) {
            let maps = [
                random(rows, cols, 0.5, &mut rng),
                blobs(rows, cols, 2, 0..=9, &mut rng),
                single_obstacle(rows, cols),
                maze(rows, cols, 2, &mut rng),
                two_rooms(rows, cols),
                u_trap(rows, cols),
            ];
            assert!(maps.iter().all(|map| (map.rows(), map.cols()) == (rows, cols)));
        }
    }
}
