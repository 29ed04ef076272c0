//! Steps within a row, to the west and the east, as far as they lower distances.
//!
//! A cell is joined with the cells 1 column beside it, then 2, 4 and so on; it has then the least over all cells nearer
//! than twice the last stride. What comes from farther is carried along the row, from one group of lanes to the next.
//! Parts of the row that hold small distances only are left out as soon as no farther cell can lower them.

use std::mem;
use std::ops::Range;

use crate::brushfire::row::StepCount;
use crate::brushfire::row::{DistanceRow, LANES};

/// Cells that are left out together: fewer would be bookkeeping, more would keep near cells waiting for far ones.
const SEGMENT: usize = 16 * LANES;

/// The working memory of steps within a row.
pub struct Sideways<T> {
    /// For each segment the greatest distance in it; zero for one that is finished and in both rows.
    farthest: Vec<T>,
    /// The row after the next stride.
    next: DistanceRow<T>,
}

impl<T: StepCount> Sideways<T> {
    pub fn new(cols: usize) -> Self {
        Self { farthest: vec![T::UNKNOWN; cols.div_ceil(SEGMENT)], next: DistanceRow::unknown(cols) }
    }

    /// Lowers each distance to the least over all cells of the row plus the steps between them. Returns whether all are
    /// known afterwards.
    pub fn spread(&mut self, row: &mut DistanceRow<T>) -> bool {
        self.farthest.fill(T::UNKNOWN);
        let mut stride = 1;
        while usize::from(stride) < LANES && self.has_farther_than(stride) {
            self.join(row, stride);
            stride *= 2;
        }
        if self.has_farther_than(stride) {
            self.carry(row);
        }
        !self.farthest.contains(&T::UNKNOWN)
    }

    /// Returns whether a cell can be lowered by one at least `steps` columns away.
    fn has_farther_than(&self, steps: u8) -> bool {
        self.farthest.iter().any(|&far| far > T::ZERO.plus(steps))
    }

    fn join(&mut self, row: &mut DistanceRow<T>, stride: u8) {
        for (index, farthest) in self.farthest.iter_mut().enumerate() {
            let segment = segment(index, row);
            let to = &mut self.next.cells_mut()[segment.clone()];
            let from = &row.cells()[segment.clone()];
            if *farthest > T::ZERO.plus(stride) {
                let west = row.west(stride.into());
                let east = row.east(stride.into());
                *farthest = join(to, from, &west[segment.clone()], &east[segment], stride);
            } else if *farthest > T::ZERO {
                to.copy_from_slice(from);
                *farthest = T::ZERO;
            }
        }
        mem::swap(row, &mut self.next);
    }

    /// Ends what strides have begun, once each cell has the least over all cells that are nearer than `LANES`.
    fn carry(&mut self, row: &mut DistanceRow<T>) {
        let limit = T::ZERO.plus(LANES as u8);
        let is_open = |farthest: T| farthest > limit;
        let mut edge = T::UNKNOWN;
        for (cells, &mut farthest) in row.cells_mut().chunks_mut(SEGMENT).zip(&mut self.farthest) {
            if is_open(farthest) {
                carry_east(cells, edge);
            }
            edge = cells[cells.len() - 1];
        }
        edge = T::UNKNOWN;
        for (cells, farthest) in row.cells_mut().chunks_mut(SEGMENT).zip(&mut self.farthest).rev() {
            if is_open(*farthest) {
                *farthest = carry_west(cells, edge);
            }
            edge = cells[0];
        }
    }
}

fn segment<T: StepCount>(index: usize, row: &DistanceRow<T>) -> Range<usize> {
    index * SEGMENT..row.cells().len().min((index + 1) * SEGMENT)
}

/// Joins cells with those a stride away on both sides; returns the greatest distance then.
// Inlined, the compiler would no longer know that the rows do not overlap, and test for it on every segment.
#[inline(never)]
fn join<T: StepCount>(to: &mut [T], from: &[T], west: &[T], east: &[T], stride: u8) -> T {
    let mut farthest = [T::ZERO; LANES];
    let beside = lanes(west).iter().zip(lanes(east));
    for ((to, from), (west, east)) in lanes_mut(to).iter_mut().zip(lanes(from)).zip(beside) {
        for lane in 0..LANES {
            to[lane] = from[lane].min(west[lane].min(east[lane]).plus(stride));
            farthest[lane] = farthest[lane].max(to[lane]);
        }
    }
    greatest(farthest)
}

/// Lowers cells to what comes from the west, where the cell before them is `edge`.
fn carry_east<T: StepCount>(cells: &mut [T], mut edge: T) {
    for lanes in lanes_mut(cells) {
        let next_edge = lanes[LANES - 1].min(edge.plus(LANES as u8));
        for (lane, cell) in lanes.iter_mut().enumerate() {
            *cell = (*cell).min(edge.plus(lane as u8 + 1));
        }
        edge = next_edge;
    }
}

/// Lowers cells to what comes from the east, where the cell after them is `edge`; returns the greatest distance then.
fn carry_west<T: StepCount>(cells: &mut [T], mut edge: T) -> T {
    let mut farthest = [T::ZERO; LANES];
    for lanes in lanes_mut(cells).iter_mut().rev() {
        let next_edge = lanes[0].min(edge.plus(LANES as u8));
        for lane in 0..LANES {
            lanes[lane] = lanes[lane].min(edge.plus((LANES - lane) as u8));
            farthest[lane] = farthest[lane].max(lanes[lane]);
        }
        edge = next_edge;
    }
    greatest(farthest)
}

fn greatest<T: StepCount>(lanes: [T; LANES]) -> T {
    lanes.into_iter().fold(T::ZERO, T::max)
}

fn lanes<T>(cells: &[T]) -> &[[T; LANES]] {
    cells.as_chunks().0
}

fn lanes_mut<T>(cells: &mut [T]) -> &mut [[T; LANES]] {
    cells.as_chunks_mut().0
}
