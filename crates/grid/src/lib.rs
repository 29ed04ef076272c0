#![doc = include_str!("../README.md")]
//!
//! Grids of values and the classical algorithms on them.
//!
//! This layer uses only (row, column); the caller determines the edge of row 0 and the size of a cell.

pub mod astar;
pub mod brushfire;
pub mod bucket_queue;
pub mod cost_map;
pub mod descent;
pub mod distance;
#[cfg(any(test, feature = "testing"))]
pub mod drawn;
pub mod layered_queue;
#[cfg(feature = "files")]
pub mod map_files;
pub mod occupancy;
pub mod octile;
pub mod open_list;
pub mod parameter;
pub mod path_search;
pub mod place;
pub mod potential;
pub mod sampling;
pub mod segment;
pub mod voronoi;
pub mod wavefront;

pub use place::{BadPlace, Connectivity, CornerCutting, Place, Route, TieOrder};

use std::ops::{Index, IndexMut};

/// A rectangle of values, stored row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid<T> {
    rows: usize,
    cols: usize,
    values: Vec<T>,
}

impl<T: Clone> Grid<T> {
    pub fn filled(rows: usize, cols: usize, value: T) -> Self {
        Self { rows, cols, values: vec![value; rows * cols] }
    }
}

impl<T> Grid<T> {
    /// Wraps values that are already in row-major order.
    ///
    /// # Panics
    /// If there are not exactly `rows * cols` values.
    pub fn from_values(rows: usize, cols: usize, values: Vec<T>) -> Self {
        assert_eq!(values.len(), rows * cols, "a grid of {rows} x {cols} holds {} values", rows * cols);
        Self { rows, cols, values }
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    pub fn cols(&self) -> usize {
        self.cols
    }

    pub fn values(&self) -> &[T] {
        &self.values
    }

    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    pub fn row(&self, row: usize) -> &[T] {
        &self.values[row * self.cols..(row + 1) * self.cols]
    }

    pub fn row_mut(&mut self, row: usize) -> &mut [T] {
        &mut self.values[row * self.cols..(row + 1) * self.cols]
    }

    pub fn get(&self, row: usize, col: usize) -> Option<&T> {
        (row < self.rows && col < self.cols).then(|| &self.values[row * self.cols + col])
    }
}

impl<T> Index<(usize, usize)> for Grid<T> {
    type Output = T;
    fn index(&self, (row, col): (usize, usize)) -> &T {
        &self.values[row * self.cols + col]
    }
}

impl<T> IndexMut<(usize, usize)> for Grid<T> {
    fn index_mut(&mut self, (row, col): (usize, usize)) -> &mut T {
        &mut self.values[row * self.cols + col]
    }
}
