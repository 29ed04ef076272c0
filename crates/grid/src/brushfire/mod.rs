//! Brushfire: the distance from every cell to the nearest obstacle.
//!
//! The distances are separable: a nearest obstacle can be reached by vertical steps (with eight neighbours, diagonal
//! ones too) and then horizontal ones. A sweep from the first row to the last finds how far the nearest obstacle above
//! is; a sweep back joins what lies below and finishes each row by horizontal steps. (Rosenfeld and Pfaltz,
//! "Sequential operations in digital picture processing", Journal of the ACM 13, 1966.)
//!
//! The sweep back needs what the first one found, in the opposite order. To keep all of it would cost as much memory as
//! the map; so the first sweep leaves one row of each band in the map of results, where it will be overwritten in time,
//! and the sweep back begins each band with going through it once more.
//!
//! Every step is taken for many columns at once, in bytes as long as these can hold the distances. The first row with
//! farther cells, and all that are left then, are done in words.

mod row;
mod sideways;

use std::mem;
use std::ops::Range;

use row::{DistanceRow, StepCount};
use sideways::Sideways;

use crate::{Connectivity, Grid};

/// The longest side of a map: city-block distances within it fit 16 bits.
pub const MAX_SIDE: usize = 32_767;

/// Rows in a band.
const BAND: usize = 32;

/// Computes the distance to the nearest occupied cell plus one, so that obstacles hold 1: the city-block distance with
/// four neighbours, the chessboard distance with eight. `None` if nothing is occupied.
///
/// # Panics
/// If a side is longer than [`MAX_SIDE`].
pub fn brushfire(occupied: &Grid<bool>, connectivity: Connectivity) -> Option<Grid<u16>> {
    let mut values = Grid::filled(0, 0, 0);
    brushfire_into(occupied, connectivity, &mut values).then_some(values)
}

/// Computes [`brushfire`] into a map that is reused; `false`, and all values 0, if nothing is occupied.
///
/// Memory that the system has yet to give takes longer to get than to fill, so it pays to keep the map. It takes the
/// size of `occupied` if it has another.
///
/// # Panics
/// If a side is longer than [`MAX_SIDE`].
pub fn brushfire_into(occupied: &Grid<bool>, connectivity: Connectivity, values: &mut Grid<u16>) -> bool {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    assert!(rows.max(cols) <= MAX_SIDE, "a map of {rows} x {cols} cells is too large");
    if (values.rows(), values.cols()) != (rows, cols) {
        *values = Grid::filled(rows, cols, 0);
    }
    if occupied.values().is_empty() {
        return false;
    }
    let far_rows = BandSweep::<u8>::new(occupied, connectivity).run(rows, values);
    let is_complete = far_rows == 0 || BandSweep::<i16>::new(occupied, connectivity).run(far_rows, values) == 0;
    // Every distance fits into a word, so rows are left only where nothing is occupied.
    if !is_complete {
        values.values_mut().fill(0);
    }
    is_complete
}

/// The working memory of the two sweeps over a map.
struct BandSweep<'a, T> {
    occupied: &'a Grid<bool>,
    connectivity: Connectivity,
    /// Distances in the row before the band and the rows of the band, first to obstacles above or beside, then to all.
    band: Vec<DistanceRow<T>>,
    /// Distances to all obstacles in the row after the band.
    below: DistanceRow<T>,
    here: DistanceRow<T>,
    sideways: Sideways<T>,
}

impl<'a, T: StepCount> BandSweep<'a, T> {
    fn new(occupied: &'a Grid<bool>, connectivity: Connectivity) -> Self {
        let row = DistanceRow::unknown(occupied.cols());
        let sideways = Sideways::new(occupied.cols());
        Self { occupied, connectivity, band: vec![row.clone(); BAND + 1], below: row.clone(), here: row, sideways }
    }

    /// Finishes the first `rows` rows of `values`, those after them being finished, from the last to the first. Returns
    /// how many are left when a distance does not fit.
    fn run(&mut self, rows: usize, values: &mut Grid<u16>) -> usize {
        let bands = (0..rows).step_by(BAND).map(|start| start..rows.min(start + BAND));
        // This pass leaves the last row of each band in `values`, from which the next one can begin the following band.
        for band in bands.clone() {
            self.descend(band.clone(), values);
            self.band[band.len()].store(values.row_mut(band.end - 1));
        }
        if rows < values.rows() {
            self.below.load_values(values.row(rows));
        }
        // Upwards, as a row is finished only when all below it are.
        for band in bands.rev() {
            self.descend(band.clone(), values);
            let left = self.finish(band.clone(), values);
            if left > 0 {
                return band.start + left;
            }
        }
        0
    }

    /// Goes through a band downwards, from the row that `values` keeps of the band before.
    fn descend(&mut self, band: Range<usize>, values: &Grid<u16>) {
        match band.start.checked_sub(1) {
            Some(before) => self.band[0].load(values.row(before)),
            None => self.band[0].forget(),
        }
        for (row, at) in band.zip(1..) {
            let (above, here) = self.band.split_at_mut(at);
            here[0].step_and_mark(&above[at - 1], self.connectivity, self.occupied.row(row));
        }
    }

    /// Finishes a band upwards, from the row below it. Returns how many of its rows are left when a distance does not
    /// fit.
    fn finish(&mut self, band: Range<usize>, values: &mut Grid<u16>) -> usize {
        let mut left = band.len();
        while left > 0 {
            let below = if left < band.len() { &self.band[left + 1] } else { &self.below };
            self.here.step_and_join(below, self.connectivity, &self.band[left]);
            if !self.sideways.spread(&mut self.here) {
                break;
            }
            mem::swap(&mut self.here, &mut self.band[left]);
            left -= 1;
        }
        // Only now, since memory that is written from its low end to its high one is written three times as fast.
        for (row, at) in band.zip(1..).skip(left) {
            self.band[at].store_values(values.row_mut(row));
        }
        // The first row of this band lies below the next one, which is above it.
        mem::swap(&mut self.below, &mut self.band[1]);
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;

    use rand::{Rng, RngExt};

    use crate::{CornerCutting, TieOrder, drawn, place};
    use wildfire_base::rng;

    const BOTH: [Connectivity; 2] = [Connectivity::Four, Connectivity::Eight];

    /// Breadth-first search from all obstacles at once.
    fn plain_brushfire(occupied: &Grid<bool>, connectivity: Connectivity) -> Option<Grid<u16>> {
        let mut values = Grid::filled(occupied.rows(), occupied.cols(), 0);
        let cells = (0..occupied.rows()).flat_map(|row| (0..occupied.cols()).map(move |col| (row, col)));
        let mut front: VecDeque<_> = cells.filter(|&cell| occupied[cell]).collect();
        front.iter().for_each(|&cell| values[cell] = 1);
        while let Some(from) = front.pop_front() {
            for &step in TieOrder::CrossFirst.steps(connectivity) {
                if let Some(to) =
                    place::step(occupied, from, step, CornerCutting::Allowed).filter(|&to| values[to] == 0)
                {
                    values[to] = values[from] + 1;
                    front.push_back(to);
                }
            }
        }
        occupied.values().contains(&true).then_some(values)
    }

    /// The least distance over all obstacles.
    fn brute_force(occupied: &Grid<bool>, connectivity: Connectivity) -> Option<Grid<u16>> {
        let cells = || (0..occupied.rows()).flat_map(|row| (0..occupied.cols()).map(move |col| (row, col)));
        let distance = |(row, col): (usize, usize), (r, c): (usize, usize)| match connectivity {
            Connectivity::Four => row.abs_diff(r) + col.abs_diff(c),
            Connectivity::Eight => row.abs_diff(r).max(col.abs_diff(c)),
        };
        let obstacles: Vec<_> = cells().filter(|&cell| occupied[cell]).collect();
        let nearest = |cell| obstacles.iter().map(|&obstacle| distance(cell, obstacle) as u16 + 1).min();
        let values: Option<Vec<_>> = cells().map(nearest).collect();
        values.map(|values| Grid::from_values(occupied.rows(), occupied.cols(), values))
    }

    fn drawn_map(rows: usize, cols: usize, rng: &mut impl Rng) -> Grid<bool> {
        match rng.random_range(0..6) {
            0 => drawn::random(rows, cols, 0.001, rng),
            1 => drawn::random(rows, cols, 0.05, rng),
            2 => drawn::random(rows, cols, 0.5, rng),
            3 => drawn::blobs(rows, cols, 3, 0..=9, rng),
            4 => drawn::maze(rows, cols, 3, rng),
            _ => drawn::single_obstacle(rows, cols),
        }
    }

    fn assert_equal(map: &Grid<bool>, connectivity: Connectivity, expected: Option<&Grid<u16>>) {
        let found = brushfire(map, connectivity);
        // Not `assert_eq!`, which would print both maps.
        assert!(found.as_ref() == expected, "{} x {}, {connectivity:?}", map.rows(), map.cols());
    }

    #[test]
    fn brushfire_equals_brute_force() {
        let mut rng = rng::stream(1, "grid/brushfire");
        for _ in 0..300 {
            let rows = rng.random_range(1..20);
            let cols = rng.random_range(1..50);
            let map = drawn_map(rows, cols, &mut rng);
            for connectivity in BOTH {
                assert_equal(&map, connectivity, brute_force(&map, connectivity).as_ref());
            }
        }
    }

    #[test]
    fn brushfire_equals_breadth_first_search() {
        let mut rng = rng::stream(2, "grid/brushfire");
        for _ in 0..60 {
            let rows = rng.random_range(1..150);
            let cols = rng.random_range(1..700);
            let map = drawn_map(rows, cols, &mut rng);
            for connectivity in BOTH {
                assert_equal(&map, connectivity, plain_brushfire(&map, connectivity).as_ref());
            }
        }
    }

    #[test]
    fn distances_beyond_a_byte_are_exact_from_whatever_row_on() {
        for (rows, cols, obstacle) in
            [(600, 40, (599, 39)), (600, 40, (300, 3)), (600, 40, (0, 0)), (90, 700, (60, 650))]
        {
            let mut map = Grid::filled(rows, cols, false);
            map[obstacle] = true;
            for connectivity in BOTH {
                assert_equal(&map, connectivity, plain_brushfire(&map, connectivity).as_ref());
            }
        }
    }

    #[test]
    fn the_longest_rows_and_columns_do_not_overflow() {
        for (rows, cols) in [(4, MAX_SIDE), (MAX_SIDE, 4)] {
            let mut map = Grid::filled(rows, cols, false);
            map[(0, 0)] = true;
            let far = |connectivity| brushfire(&map, connectivity).map(|values| values[(rows - 1, cols - 1)]);
            assert_eq!(far(Connectivity::Four), Some(32_770));
            assert_eq!(far(Connectivity::Eight), Some(32_767));
        }
    }

    #[test]
    fn a_map_without_obstacles_has_no_brushfire() {
        for (rows, cols) in [(0, 0), (0, 5), (5, 0), (1, 1), (40, 300)] {
            let map = Grid::filled(rows, cols, false);
            for connectivity in BOTH {
                let mut values = Grid::filled(rows, cols, 7);
                assert!(!brushfire_into(&map, connectivity, &mut values));
                assert!(values.values().iter().all(|&value| value == 0));
            }
        }
    }

    #[test]
    fn what_a_kept_map_contained_does_not_matter() {
        let mut rng = rng::stream(3, "grid/brushfire");
        let mut kept = Grid::filled(1, 1, 9);
        for rows in [70, 70, 70, 69, 40, 40, 40, 1] {
            let map = drawn_map(rows, 300, &mut rng);
            for connectivity in BOTH {
                let is_some = brushfire_into(&map, connectivity, &mut kept);
                assert!(is_some.then_some(&kept) == brushfire(&map, connectivity).as_ref());
            }
        }
    }

    #[test]
    #[should_panic(expected = "too large")]
    fn a_side_that_is_too_long_is_refused() {
        brushfire(&Grid::filled(1, MAX_SIDE + 1, false), Connectivity::Four);
    }
}
