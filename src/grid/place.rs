//! Places on a grid, and answers to the question for a way between two of them.

use std::f64::consts::SQRT_2;

use thiserror::Error;

use super::{CornerCutting, Grid};

/// (row, column), both from 0.
pub type Place = (usize, usize);

/// Why a place cannot be a goal; a start has to be on the map too, and one in an obstacle is an answer.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BadPlace {
    #[error("row {}, column {} lies outside the map of {rows} rows and {cols} columns", place.0, place.1)]
    Outside { place: Place, rows: usize, cols: usize },
    #[error("row {}, column {} is occupied", place.0, place.1)]
    Occupied { place: Place },
}

/// What came of looking for a way to the goal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Route {
    /// Cells from start to goal, both included.
    Found(Vec<Place>),
    StartOccupied,
    /// No sequence of legal steps leads from the start to the goal.
    Unreachable,
}

/// Accepts a place on a free cell.
pub fn check_free(occupied: &Grid<bool>, place: Place) -> Result<(), BadPlace> {
    match occupied.get(place.0, place.1) {
        None => Err(BadPlace::Outside { place, rows: occupied.rows(), cols: occupied.cols() }),
        Some(true) => Err(BadPlace::Occupied { place }),
        Some(false) => Ok(()),
    }
}

/// Accepts a goal on a free cell and a start on the map; returns whether the start is free too.
pub fn check_ends(occupied: &Grid<bool>, start: Place, goal: Place) -> Result<bool, BadPlace> {
    check_free(occupied, goal)?;
    match check_free(occupied, start) {
        Err(BadPlace::Occupied { .. }) => Ok(false),
        checked => checked.map(|()| true),
    }
}

/// The free cell that a step from `from` leads to, if the step is legal.
#[inline]
pub fn step(occupied: &Grid<bool>, from: Place, step: (isize, isize), corners: CornerCutting) -> Option<Place> {
    step_where(occupied, |&is_occupied| !is_occupied, from, step, corners)
}

/// The cell that a step from `from` leads to, if the step is legal on a grid whose values tell which cells are free.
pub fn step_where<T>(
    grid: &Grid<T>,
    is_free: impl Fn(&T) -> bool,
    from: Place,
    step: (isize, isize),
    corners: CornerCutting,
) -> Option<Place> {
    let to = neighbour(grid, from, step)?;
    let is_free = |place: Place| is_free(&grid[place]);
    let keeps_corners = corners == CornerCutting::Allowed || (is_free((from.0, to.1)) && is_free((to.0, from.1)));
    (is_free(to) && keeps_corners).then_some(to)
}

/// The cell that a step from `from` leads to, if it is on the grid.
#[inline]
pub fn neighbour<T>(grid: &Grid<T>, from: Place, step: (isize, isize)) -> Option<Place> {
    // A step from row 0 or column 0 wraps around to a number that is outside too.
    let to = (from.0.wrapping_add_signed(step.0), from.1.wrapping_add_signed(step.1));
    (to.0 < grid.rows() && to.1 < grid.cols()).then_some(to)
}

/// Length of a path in cells: 1 for an orthogonal step, the square root of 2 for a diagonal one.
pub fn octile_length(path: &[Place]) -> f64 {
    let is_diagonal = |pair: &&[Place]| pair[0].0 != pair[1].0 && pair[0].1 != pair[1].1;
    let diagonal = path.windows(2).filter(is_diagonal).count();
    let straight = path.len().saturating_sub(1) - diagonal;
    straight as f64 + diagonal as f64 * SQRT_2
}
