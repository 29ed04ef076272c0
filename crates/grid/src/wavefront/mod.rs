//! Wavefront: the number of steps from every cell to the goal, and paths that descend its values.
//!
//! The values are those of NF1 (Barraquand, Langlois, Latombe, "Numerical potential field techniques for robot path
//! planning", IEEE Transactions on Systems, Man, and Cybernetics 22(2), 1992), that is, of a breadth-first search.
//!
//! A queue of cells would spend its time on guesses and on memory. Here a map is cut into tiles of 16 x 16 cells
//! ([`tiles`]). Inside a tile the wave moves all cells of a level at once, as bits ([`cells`], [`moves`], [`flood`]);
//! between tiles only the steps at the cells along their sides count. A tile comes again when a neighbour has found
//! shorter ways to its sides, the earliest first ([`tile_queue`]; the buckets are those of Meyer, Sanders, "Delta-stepping:
//! a parallelizable shortest path algorithm", Journal of Algorithms 49, 2003, section 2). In the open each tile comes
//! once, among obstacles twice or so. What its last flood found out about its cells is kept as a byte for each
//! ([`codes`]), in the memory of the result ([`records`]). When nothing improves any more, the values are written in
//! the order of memory.

mod cells;
mod codes;
mod flood;
mod moves;
mod records;
mod tile_queue;
mod tiles;

use std::collections::VecDeque;

use cells::SIDE;
use moves::{AnyDiagonal, FAR, Moves, OpenDiagonal, Straight};
use tiles::Tiles;

use crate::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder, place};

/// The value of occupied cells.
pub const OBSTACLE: u32 = 1;
/// The value of the goal; a cell `n` steps away has `GOAL + n`.
pub const GOAL: u32 = 2;
/// The value of free cells from which no steps lead to the goal.
pub const UNREACHED: u32 = 0;

/// Computes the fewest steps from every cell to the goal: [`OBSTACLE`], [`GOAL`] plus the steps, or [`UNREACHED`].
///
/// Without diagonal steps `corners` has no say. Beside its result it needs about 1.2 bytes a cell while it runs.
///
/// # Panics
/// If the map has 2^30 cells or more.
pub fn wavefront(
    occupied: &Grid<bool>,
    goal: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
) -> Result<Grid<u32>, BadPlace> {
    let mut values = Grid::filled(0, 0, UNREACHED);
    wavefront_into(occupied, goal, connectivity, corners, &mut values)?;
    Ok(values)
}

/// Computes [`wavefront`] into a grid that is reused for several maps; its size and content do not matter.
///
/// On an error the grid stays as it was.
pub fn wavefront_into(
    occupied: &Grid<bool>,
    goal: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
    values: &mut Grid<u32>,
) -> Result<(), BadPlace> {
    place::check_free(occupied, goal)?;
    if (values.rows(), values.cols()) != (occupied.rows(), occupied.cols()) {
        *values = Grid::filled(occupied.rows(), occupied.cols(), UNREACHED);
    }
    match (connectivity, corners) {
        _ if occupied.rows().min(occupied.cols()) < SIDE => {
            fill_by_queue(occupied, goal, connectivity, corners, values);
        }
        (Connectivity::Four, _) => fill_by_tiles::<Straight>(occupied, goal, values),
        (Connectivity::Eight, CornerCutting::Allowed) => fill_by_tiles::<AnyDiagonal>(occupied, goal, values),
        (Connectivity::Eight, CornerCutting::Forbidden) => fill_by_tiles::<OpenDiagonal>(occupied, goal, values),
    }
    Ok(())
}

fn fill_by_tiles<M: Moves>(occupied: &Grid<bool>, goal: Place, values: &mut Grid<u32>) {
    assert!(occupied.values().len() <= FAR as usize, "steps are counted below {FAR}");
    let mut tiles = Tiles::new(occupied, goal, values);
    tiles.settle::<M>();
    tiles.write::<M>();
}

/// Finds a path from `start` to the goal of a wavefront, by the first neighbour in order whose value is one less.
pub fn descend_wavefront(
    values: &Grid<u32>,
    start: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
    order: TieOrder,
) -> Route {
    match values[start] {
        OBSTACLE => return Route::StartOccupied,
        UNREACHED => return Route::Unreachable,
        _ => {}
    }
    let mut path = vec![start];
    let mut here = start;
    while values[here] != GOAL {
        // A wave reaches a cell from one whose value is one less, over a step that can be made back.
        let next_value = values[here] - 1;
        let steps = order.steps(connectivity).iter();
        here = steps
            .filter_map(|&offset| place::step_where(values, |&value| value != OBSTACLE, here, offset, corners))
            .find(|&to| values[to] == next_value)
            .expect("a wave came from somewhere");
        path.push(here);
    }
    Route::Found(path)
}

pub fn fill_by_queue(
    occupied: &Grid<bool>,
    goal: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
    values: &mut Grid<u32>,
) {
    for (value, &is_occupied) in values.values_mut().iter_mut().zip(occupied.values()) {
        *value = if is_occupied { OBSTACLE } else { UNREACHED };
    }
    values[goal] = GOAL;
    // First in, first out: levels follow one another, so the first value that a cell gets is its least.
    let mut front = VecDeque::from([goal]);
    while let Some(from) = front.pop_front() {
        for &offset in TieOrder::CrossFirst.steps(connectivity) {
            if let Some(to) = place::step(occupied, from, offset, corners)
                && values[to] == UNREACHED
            {
                values[to] = values[from] + 1;
                front.push_back(to);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;

    use crate::drawn;
    use wildfire_base::rng::{Xoshiro256PlusPlus, stream};

    const RULES: [(Connectivity, CornerCutting); 3] = [
        (Connectivity::Four, CornerCutting::Allowed),
        (Connectivity::Eight, CornerCutting::Allowed),
        (Connectivity::Eight, CornerCutting::Forbidden),
    ];

    /// Maps of every kind, sparse and dense, with corridors narrower and wider than a tile.
    fn maps(rows: usize, cols: usize, rng: &mut Xoshiro256PlusPlus) -> Vec<Grid<bool>> {
        vec![
            Grid::filled(rows, cols, false),
            drawn::random(rows, cols, 0.1, rng),
            drawn::random(rows, cols, 0.3, rng),
            drawn::random(rows, cols, 0.45, rng),
            drawn::blobs(rows, cols, rows * cols / 200, 2..=6, rng),
            drawn::maze(rows, cols, 1, rng),
            drawn::maze(rows, cols, 3, rng),
            drawn::two_rooms(rows, cols),
            drawn::u_trap(rows, cols),
        ]
    }

    /// Free corners and a free cell anywhere, as far as there are some.
    fn goals(occupied: &Grid<bool>, rng: &mut Xoshiro256PlusPlus) -> Vec<Place> {
        let bottom = occupied.rows() - 1;
        let right = occupied.cols() - 1;
        let anywhere = (rng.random_range(0..=bottom), rng.random_range(0..=right));
        let places = [(0, 0), (0, right), (bottom, 0), (bottom, right), anywhere];
        places.into_iter().filter(|&place| !occupied[place]).collect()
    }

    /// A corridor one cell wide that runs to and fro through the whole map.
    fn snake(rows: usize, cols: usize) -> Grid<bool> {
        let mut map = Grid::filled(rows, cols, false);
        for row in (1..rows).step_by(2) {
            map.row_mut(row).fill(true);
            map[(row, if row % 4 == 1 { cols - 1 } else { 0 })] = false;
        }
        map
    }

    fn steps(values: &Grid<u32>) -> impl Iterator<Item = Option<u32>> {
        values.values().iter().map(|&value| value.checked_sub(GOAL))
    }

    /// Holds for fewest steps, and for nothing else.
    fn assert_each_cell_follows_from_its_neighbours(
        occupied: &Grid<bool>,
        goal: Place,
        rule: (Connectivity, CornerCutting),
    ) {
        let values = wavefront(occupied, goal, rule.0, rule.1).unwrap();
        for place in (0..occupied.rows()).flat_map(|row| (0..occupied.cols()).map(move |col| (row, col))) {
            let offsets = TieOrder::WestFirst.steps(rule.0).iter();
            let neighbours = offsets.filter_map(|&offset| place::step(occupied, place, offset, rule.1));
            let lowest = neighbours.map(|to| values[to]).filter(|&value| value != UNREACHED).min();
            let expected = match lowest {
                _ if occupied[place] => OBSTACLE,
                _ if place == goal => GOAL,
                Some(value) => value + 1,
                None => UNREACHED,
            };
            assert_eq!(values[place], expected, "{place:?} with {rule:?}");
        }
    }

    #[test]
    fn each_value_is_one_more_than_the_lowest_of_its_neighbours() {
        let mut rng = stream(1, "wavefront");
        for (rows, cols) in [(1, 1), (1, 40), (40, 1), (15, 50), (16, 16), (17, 31), (48, 33)] {
            for occupied in maps(rows, cols, &mut rng) {
                for goal in goals(&occupied, &mut rng) {
                    for rule in RULES {
                        assert_each_cell_follows_from_its_neighbours(&occupied, goal, rule);
                    }
                }
            }
        }
    }

    #[test]
    fn tiles_and_queue_agree() {
        let mut rng = stream(2, "wavefront");
        for (rows, cols) in [(16, 16), (16, 97), (33, 64), (100, 130)] {
            for occupied in maps(rows, cols, &mut rng) {
                for goal in goals(&occupied, &mut rng) {
                    for (connectivity, corners) in RULES {
                        let mut expected = Grid::filled(rows, cols, UNREACHED);
                        fill_by_queue(&occupied, goal, connectivity, corners, &mut expected);
                        let found = wavefront(&occupied, goal, connectivity, corners).unwrap();
                        assert!(found == expected, "{rows} x {cols}, goal {goal:?}, {connectivity:?}, {corners:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn sixteen_bits_of_steps_are_not_enough_for_a_snake() {
        let occupied = snake(401, 401);
        for (connectivity, corners) in RULES {
            let values = wavefront(&occupied, (0, 0), connectivity, corners).unwrap();
            let mut expected = Grid::filled(401, 401, UNREACHED);
            fill_by_queue(&occupied, (0, 0), connectivity, corners, &mut expected);
            assert!(values == expected, "{connectivity:?}, {corners:?}");
            assert!(values[(400, 400)] > 1 << 16);
        }
    }

    #[test]
    fn values_fall_by_one_along_every_descent() {
        let mut rng = stream(3, "wavefront");
        for occupied in maps(40, 50, &mut rng) {
            for goal in goals(&occupied, &mut rng) {
                for (connectivity, corners) in RULES {
                    let values = wavefront(&occupied, goal, connectivity, corners).unwrap();
                    for start in [(0, 0), (39, 49), (20, 25), (39, 0)] {
                        let order = if rng.random() { TieOrder::CrossFirst } else { TieOrder::WestFirst };
                        let route = descend_wavefront(&values, start, connectivity, corners, order);
                        match (values[start], route) {
                            (OBSTACLE, route) => assert_eq!(route, Route::StartOccupied),
                            (UNREACHED, route) => assert_eq!(route, Route::Unreachable),
                            (_, Route::Found(path)) => {
                                assert_eq!((path[0], path[path.len() - 1]), (start, goal));
                                assert!(path.windows(2).all(|pair| values[pair[1]] + 1 == values[pair[0]]));
                            }
                            (value, route) => panic!("{route:?} from {start:?} with value {value}"),
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn more_moves_never_need_more_steps_and_two_straight_ones_replace_an_open_diagonal() {
        let mut rng = stream(4, "wavefront");
        for occupied in maps(50, 40, &mut rng) {
            for goal in goals(&occupied, &mut rng) {
                let [four, any, open] =
                    RULES.map(|(connectivity, corners)| wavefront(&occupied, goal, connectivity, corners).unwrap());
                for ((four, any), open) in steps(&four).zip(steps(&any)).zip(steps(&open)) {
                    assert_eq!(four.is_some(), open.is_some());
                    if let (Some(four), Some(any), Some(open)) = (four, any, open) {
                        assert!(any <= open && open <= four && four <= 2 * open);
                    }
                }
            }
        }
    }

    #[test]
    fn a_closed_room_is_not_reached() {
        let mut occupied = Grid::filled(40, 40, false);
        for i in 10..=20 {
            for place in [(10, i), (20, i), (i, 10), (i, 20)] {
                occupied[place] = true;
            }
        }
        for (connectivity, corners) in RULES {
            let outside = wavefront(&occupied, (0, 0), connectivity, corners).unwrap();
            let inside = wavefront(&occupied, (15, 15), connectivity, corners).unwrap();
            for (place, in_room) in [((15, 15), true), ((19, 11), true), ((21, 21), false), ((39, 39), false)] {
                assert_eq!(outside[place] == UNREACHED, in_room);
                assert_eq!(inside[place] == UNREACHED, !in_room);
            }
        }
    }

    #[test]
    fn a_kept_grid_gets_the_same_values_as_a_new_one() {
        let mut rng = stream(5, "wavefront");
        let mut kept = Grid::filled(3, 5, 77);
        for (rows, cols) in [(30, 41), (30, 41), (20, 7), (41, 30)] {
            let mut occupied = drawn::random(rows, cols, 0.4, &mut rng);
            occupied[(3, 3)] = false;
            for (connectivity, corners) in RULES {
                wavefront_into(&occupied, (3, 3), connectivity, corners, &mut kept).unwrap();
                assert!(kept == wavefront(&occupied, (3, 3), connectivity, corners).unwrap());
            }
        }
    }

    #[test]
    fn a_goal_in_an_obstacle_or_outside_is_reported() {
        let occupied = drawn::single_obstacle(20, 20);
        let refusal = |goal| wavefront(&occupied, goal, Connectivity::Eight, CornerCutting::Allowed).unwrap_err();
        assert_eq!(refusal((5, 15)), BadPlace::Occupied { place: (5, 15) });
        assert_eq!(refusal((20, 0)), BadPlace::Outside { place: (20, 0), rows: 20, cols: 20 });
    }
}
