//! Gradient descent from the start to the goal or a local minimum, with the wavefront as an escape from there.

use super::wavefront::{descend_wavefront, wavefront};
use super::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder, place};

/// The end of a descent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Descent {
    /// The cells from the start to the goal, both included.
    Reached(Vec<Place>),
    /// The cells from the start to a local minimum, both included: no neighbour is lower, and it is not the goal.
    Stuck(Vec<Place>),
    StartOccupied,
}

/// Descends to the lowest neighbour, ties by [`TieOrder::WestFirst`], as long as it is strictly lower.
///
/// Occupied cells are not entered, whatever their potential. The descent ends, because the potential falls with every
/// step. A goal outside or in an obstacle is an error, and so is a start outside.
pub fn descend(
    potential: &Grid<f64>,
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
) -> Result<Descent, BadPlace> {
    if !place::check_ends(occupied, start, goal)? {
        return Ok(Descent::StartOccupied);
    }
    let mut path = vec![start];
    let mut here = start;
    while here != goal {
        // Strictly lower: of equals the first in order stays, and a plain is a local minimum.
        let mut lowest = here;
        for &offset in TieOrder::WestFirst.steps(connectivity) {
            if let Some(to) = place::step(occupied, here, offset, corners)
                && potential[to] < potential[lowest]
            {
                lowest = to;
            }
        }
        if lowest == here {
            return Ok(Descent::Stuck(path));
        }
        here = lowest;
        path.push(here);
    }
    Ok(Descent::Reached(path))
}

/// A descent that continues by the wavefront where it is stuck.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Escape {
    /// The descent reached the goal by itself: cells from the start to the goal.
    NotNeeded(Vec<Place>),
    /// The cells from the start to a local minimum, and from there to the goal; both include the minimum.
    HandedOver {
        descent: Vec<Place>,
        wavefront: Vec<Place>,
    },
    /// The cells from the start to a local minimum, from which no steps lead to the goal.
    Unreachable(Vec<Place>),
    StartOccupied,
}

/// Descends, and continues from a local minimum with the fewest steps to the goal, ties by [`TieOrder::CrossFirst`].
///
/// Errors are those of [`descend`].
pub fn descend_or_escape(
    potential: &Grid<f64>,
    occupied: &Grid<bool>,
    start: Place,
    goal: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
) -> Result<Escape, BadPlace> {
    let descent = match descend(potential, occupied, start, goal, connectivity, corners)? {
        Descent::Reached(path) => return Ok(Escape::NotNeeded(path)),
        Descent::StartOccupied => return Ok(Escape::StartOccupied),
        Descent::Stuck(path) => path,
    };
    let minimum = *descent.last().expect("a descent holds its start");
    // Only now, since most descents need no wavefront, which looks at all of the map.
    let values = wavefront(occupied, goal, connectivity, corners)?;
    Ok(match descend_wavefront(&values, minimum, connectivity, corners, TieOrder::CrossFirst) {
        Route::Found(wavefront) => Escape::HandedOver { descent, wavefront },
        Route::StartOccupied | Route::Unreachable => Escape::Unreachable(descent),
    })
}

#[cfg(test)]
mod tests {
    use super::super::potential::{Attraction, attraction};
    use super::*;

    fn map(rows: &[&str]) -> Grid<bool> {
        let occupied = rows.iter().flat_map(|row| row.bytes().map(|byte| byte == b'#')).collect();
        Grid::from_values(rows.len(), rows[0].len(), occupied)
    }

    fn escape(occupied: &Grid<bool>, start: Place, goal: Place) -> Result<Escape, BadPlace> {
        let potential = attraction(occupied.rows(), occupied.cols(), goal, Attraction::Manhattan, None);
        descend_or_escape(&potential, occupied, start, goal, Connectivity::Four, CornerCutting::Allowed)
    }

    #[test]
    fn a_descent_stuck_in_a_trap_is_led_out_of_it() {
        let trap = map(&["......", ".###..", "...#..", ".###.."]);
        let expected = Escape::HandedOver {
            descent: vec![(2, 1), (2, 2)],
            wavefront: vec![
                (2, 2),
                (2, 1),
                (2, 0),
                (1, 0),
                (0, 0),
                (0, 1),
                (0, 2),
                (0, 3),
                (0, 4),
                (1, 4),
                (2, 4),
                (2, 5),
            ],
        };
        assert_eq!(escape(&trap, (2, 1), (2, 5)), Ok(expected));
    }

    #[test]
    fn a_descent_that_arrives_needs_no_escape() {
        assert_eq!(escape(&map(&["..."]), (0, 2), (0, 0)), Ok(Escape::NotNeeded(vec![(0, 2), (0, 1), (0, 0)])));
        assert_eq!(escape(&map(&["..."]), (0, 1), (0, 1)), Ok(Escape::NotNeeded(vec![(0, 1)])));
    }

    #[test]
    fn an_enclosed_goal_and_blocked_ends_are_answers() {
        let wall = map(&[".#."]);
        assert_eq!(escape(&wall, (0, 0), (0, 2)), Ok(Escape::Unreachable(vec![(0, 0)])));
        assert_eq!(escape(&wall, (0, 1), (0, 2)), Ok(Escape::StartOccupied));
        assert_eq!(escape(&wall, (0, 0), (0, 1)), Err(BadPlace::Occupied { place: (0, 1) }));
        assert_eq!(escape(&wall, (0, 0), (1, 0)), Err(BadPlace::Outside { place: (1, 0), rows: 1, cols: 3 }));
    }

    #[test]
    fn ties_go_west_then_north_and_level_ground_is_no_way_down() {
        let open = map(&["...", "...", "..."]);
        let walk = |potential: &Grid<f64>| {
            descend(potential, &open, (1, 1), (2, 2), Connectivity::Eight, CornerCutting::Allowed).unwrap()
        };
        let mut bowl = Grid::filled(3, 3, 1.0);
        assert_eq!(walk(&bowl), Descent::Stuck(vec![(1, 1)]));
        bowl[(0, 1)] = 0.5;
        bowl[(1, 0)] = 0.5;
        assert_eq!(walk(&bowl), Descent::Stuck(vec![(1, 1), (1, 0)]));
    }
}
