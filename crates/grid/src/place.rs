//! Cells of a grid, their neighbours, and the order of neighbours.

use std::f64::consts::SQRT_2;

use thiserror::Error;

use crate::Grid;

/// A cell as (row, column), both from 0.
pub type Place = (usize, usize);

/// A step as (rows, columns), each -1, 0 or 1.
pub type Direction = (isize, isize);

/// The reason why a cell cannot be a goal. A start has to be on the map too; a start in an obstacle is valid and has no
/// path.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum BadPlace {
    #[error("row {}, column {} lies outside the map of {rows} rows and {cols} columns", place.0, place.1)]
    Outside { place: Place, rows: usize, cols: usize },
    #[error("row {}, column {} is occupied", place.0, place.1)]
    Occupied { place: Place },
}

/// The result of a search for a path to the goal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Route {
    /// The cells from start to goal, both included.
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
    // The goal comes first: a bad one is an error also where the start is occupied.
    check_free(occupied, goal)?;
    match check_free(occupied, start) {
        Err(BadPlace::Occupied { .. }) => Ok(false),
        checked => checked.map(|()| true),
    }
}

/// Returns the free cell that a step from `from` leads to, if the step is legal.
#[inline]
pub fn step(occupied: &Grid<bool>, from: Place, step: Direction, corners: CornerCutting) -> Option<Place> {
    step_where(occupied, |&is_occupied| !is_occupied, from, step, corners)
}

/// Returns the cell that a step from `from` leads to, if the step is legal on a grid whose values determine which cells
/// are free.
pub fn step_where<T>(
    grid: &Grid<T>,
    is_free: impl Fn(&T) -> bool,
    from: Place,
    step: Direction,
    corners: CornerCutting,
) -> Option<Place> {
    let to = neighbour(grid, from, step)?;
    let is_free = |place: Place| is_free(&grid[place]);
    let keeps_corners = corners == CornerCutting::Allowed || (is_free((from.0, to.1)) && is_free((to.0, from.1)));
    (is_free(to) && keeps_corners).then_some(to)
}

/// Returns the cell that a step from `from` leads to, if it is on the grid.
#[inline]
pub fn neighbour<T>(grid: &Grid<T>, from: Place, step: Direction) -> Option<Place> {
    // A step from row 0 or column 0 wraps around to a number that is outside too.
    let to = (from.0.wrapping_add_signed(step.0), from.1.wrapping_add_signed(step.1));
    (to.0 < grid.rows() && to.1 < grid.cols()).then_some(to)
}

/// Returns the length of a path in cells: 1 for an orthogonal step, the square root of 2 for a diagonal one.
pub fn octile_length(path: &[Place]) -> f64 {
    let diagonal = path.windows(2).filter(|pair| pair[0].0 != pair[1].0 && pair[0].1 != pair[1].1).count();
    let straight = path.len().saturating_sub(1) - diagonal;
    straight as f64 + diagonal as f64 * SQRT_2
}

/// The number of neighbours of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Connectivity {
    /// Cells that share a side.
    Four,
    /// Cells that share a side or a corner.
    Eight,
}

/// The rule for diagonal steps past an occupied cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerCutting {
    /// A diagonal step only requires that its two ends are free.
    Allowed,
    /// A diagonal step also requires that both cells beside it are free.
    Forbidden,
}

/// The order of neighbours that decides ties. Row 0 is the north edge in these names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieOrder {
    /// S N E W SE SW NE NW (Daudt, "Autonomous Robotics Lab 1: Brushfire and Wavefront", appendix B).
    CrossFirst,
    /// W N E S NW NE SE SW (Akram and López Musito, "Autonomous Systems, Lab 2", 2024, section 3.3).
    WestFirst,
}

impl Connectivity {
    /// Returns the number of neighbours of a cell inside the grid.
    pub fn count(self) -> usize {
        match self {
            Self::Four => 4,
            Self::Eight => 8,
        }
    }
}

impl TieOrder {
    /// Returns the steps to the neighbours in this order, orthogonal ones first.
    pub fn steps(self, connectivity: Connectivity) -> &'static [Direction] {
        const CROSS_FIRST: [Direction; 8] = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
        const WEST_FIRST: [Direction; 8] = [(0, -1), (-1, 0), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, 1), (1, -1)];
        let all = match self {
            Self::CrossFirst => &CROSS_FIRST,
            Self::WestFirst => &WEST_FIRST,
        };
        &all[..connectivity.count()]
    }
}
