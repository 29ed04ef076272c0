//! One row of distances, the steps from row to row, and the integer widths of step counts.

use crate::Connectivity;

/// The number of cells per iteration of a loop: a few vectors, so that the loop's overhead is negligible.
pub const LANES: usize = 32;

/// The distances of a row of cells, with a margin at either end for the longest step.
///
/// The width is rounded up to whole lanes. The cells that are added are as good as free ones: no way between two cells
/// of a rectangle gets shorter by leaving it.
#[derive(Clone)]
pub struct DistanceRow<T> {
    cells: Vec<T>,
    width: usize,
}

impl<T: StepCount> DistanceRow<T> {
    pub fn unknown(cols: usize) -> Self {
        let width = cols.next_multiple_of(LANES);
        Self { cells: vec![T::UNKNOWN; LANES + width + LANES], width }
    }

    pub fn cells(&self) -> &[T] {
        &self.cells[LANES..][..self.width]
    }

    pub fn cells_mut(&mut self) -> &mut [T] {
        &mut self.cells[LANES..][..self.width]
    }

    /// Returns the cells `steps` columns to the west of each cell.
    pub fn west(&self, steps: usize) -> &[T] {
        &self.cells[LANES - steps..][..self.width]
    }

    /// Returns the cells `steps` columns to the east of each cell.
    pub fn east(&self, steps: usize) -> &[T] {
        &self.cells[LANES + steps..][..self.width]
    }

    pub fn forget(&mut self) {
        self.cells_mut().fill(T::UNKNOWN);
    }

    /// Loads what [`store`](Self::store) has stored.
    pub fn load(&mut self, counts: &[u16]) {
        for (cell, &count) in self.cells_mut().iter_mut().zip(counts) {
            *cell = T::from_count(count);
        }
    }

    /// Stores the distances unchanged, including unknown ones.
    pub fn store(&self, counts: &mut [u16]) {
        for (count, cell) in counts.iter_mut().zip(self.cells()) {
            *count = cell.count();
        }
    }

    /// Loads what [`store_values`](Self::store_values) has stored.
    pub fn load_values(&mut self, values: &[u16]) {
        for (cell, value) in self.cells_mut().iter_mut().zip(values) {
            *cell = T::from_count(value - 1);
        }
    }

    /// Stores the values of the brushfire.
    pub fn store_values(&self, values: &mut [u16]) {
        for (value, cell) in values.iter_mut().zip(self.cells()) {
            *value = cell.count() + 1;
        }
    }

    /// Sets distances by a step from the row before, or 0 in occupied cells.
    pub fn step_and_mark(&mut self, before: &Self, connectivity: Connectivity, occupied: &[bool]) {
        self.step(before, connectivity, occupied, |steps, occupied| if occupied { T::ZERO } else { steps });
        // What the row was used for before may have left distances beyond its end.
        self.cells_mut()[occupied.len()..].fill(T::UNKNOWN);
    }

    /// Lowers distances by a step from the row before, where that is less.
    pub fn step_and_join(&mut self, before: &Self, connectivity: Connectivity, current: &Self) {
        self.step(before, connectivity, current.cells(), T::min);
    }

    fn step<U: Copy>(&mut self, before: &Self, connectivity: Connectivity, beside: &[U], join: impl Fn(T, U) -> T) {
        let cells = self.cells_mut().iter_mut().zip(beside).zip(before.cells());
        match connectivity {
            Connectivity::Four => {
                for ((cell, &beside), &before) in cells {
                    *cell = join(before.plus(1), beside);
                }
            }
            Connectivity::Eight => {
                for ((((cell, &beside), &before), &west), &east) in cells.zip(before.west(1)).zip(before.east(1)) {
                    *cell = join(before.min(west).min(east).plus(1), beside);
                }
            }
        }
    }
}

/// A number of steps to an obstacle, or unknown.
pub trait StepCount: Copy + Ord {
    const ZERO: Self;
    /// More than any count.
    const UNKNOWN: Self;

    /// Adds steps; [`UNKNOWN`](Self::UNKNOWN) if that is too many.
    fn plus(self, steps: u8) -> Self;

    fn from_count(count: u16) -> Self;

    fn count(self) -> u16;
}

impl StepCount for u8 {
    const ZERO: Self = 0;
    const UNKNOWN: Self = Self::MAX;

    fn plus(self, steps: u8) -> Self {
        self.saturating_add(steps)
    }

    fn from_count(count: u16) -> Self {
        count.min(Self::MAX.into()) as Self
    }

    fn count(self) -> u16 {
        self.into()
    }
}

/// Counted from the lowest number upwards, since the vectors of every x86-64 know the minimum of signed words only.
impl StepCount for i16 {
    const ZERO: Self = Self::MIN;
    const UNKNOWN: Self = Self::MAX;

    fn plus(self, steps: u8) -> Self {
        self.saturating_add(steps.into())
    }

    fn from_count(count: u16) -> Self {
        count.wrapping_add_signed(Self::MIN) as Self
    }

    fn count(self) -> u16 {
        (self as u16).wrapping_add_signed(Self::MIN)
    }
}
