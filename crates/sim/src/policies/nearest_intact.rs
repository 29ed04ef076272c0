//! The arsonist's policy of distance: the nearest bush that it can approach and light, in a straight line from the middle
//! of its body to the cell's centre, ties by cell index.
//!
//! The options of a Wumpus are most of a field at first, so they are not listed: square rings of cells about it are looked
//! at, from the inside to the outside, until no cell farther out can be nearer than the best so far.

use glam::DVec2;

use super::{Action, Observation, Policy, first_goes};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_timeline::AgentId;

/// What can be off by rounding where a place is compared with the edges of cells, in cells.
const ROUNDING_CELLS: f64 = 1e-6;

/// The nearest of a Wumpus's options.
#[derive(Clone, Copy, Debug)]
pub struct NearestIntact;

impl Policy for NearestIntact {
    fn choose(&mut self, seen: &Observation<'_>, queried: &[AgentId]) -> Vec<(AgentId, Action)> {
        first_goes(seen, queried, |agent| {
            nearest_cell(seen.fires.frame(), agent.place, |cell| seen.is_option(agent.id, cell))
        })
    }

    fn fork(&self) -> Option<Box<dyn Policy>> {
        Some(Box::new(*self))
    }
}

/// Returns the cell whose centre is nearest to a place of the field, of those that are wanted; ties by cell index.
fn nearest_cell(frame: &FieldFrame, place: DVec2, is_wanted: impl Fn(Cell) -> bool) -> Option<Cell> {
    let cols = i32::from(frame.cols);
    let rows = i32::from(frame.rows);
    let middle =
        (place / frame.cell_m).floor().clamp(DVec2::ZERO, DVec2::new(f64::from(cols - 1), f64::from(rows - 1)));
    let (col, row) = (middle.x as i32, middle.y as i32);
    let mut best: Option<(f64, Cell)> = None;
    for ring in 0..cols.max(rows) {
        // The place is in the middle cell, so at least half a cell less than the ring from every centre on it.
        let min_m = (f64::from(ring) - 0.5 - ROUNDING_CELLS).max(0.0) * frame.cell_m;
        if best.is_some_and(|(squared, _)| squared < min_m * min_m) {
            break;
        }
        for cell in ring_around(frame, (col, row), ring) {
            let squared = (frame.centre(cell) - place).length_squared();
            let is_nearer = best.is_none_or(|(min, nearest)| {
                squared < min || (squared == min && frame.index(cell) < frame.index(nearest))
            });
            if is_nearer && is_wanted(cell) {
                best = Some((squared, cell));
            }
        }
    }
    best.map(|(_, cell)| cell)
}

/// Iterates by index over the cells of the field on the square ring of a radius, in cells, about a column and row.
pub fn ring_around(frame: &FieldFrame, (col, row): (i32, i32), ring: i32) -> impl Iterator<Item = Cell> + use<> {
    let cols = i32::from(frame.cols);
    let rows = i32::from(frame.rows);
    let ring_rows = (row - ring).max(0)..=(row + ring).min(rows - 1);
    ring_rows.flat_map(move |r| {
        // A row between the northern and the southern edge has only its ends on the ring.
        let stride = if (r - row).abs() == ring { 1 } else { 2 * ring };
        let ring_cols = (col - ring..=col + ring).step_by(stride.max(1) as usize);
        ring_cols.filter(move |c| (0..cols).contains(c)).map(move |c| Cell { col: c as u16, row: r as u16 })
    })
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    #[test]
    fn the_nearest_cell_is_the_first_of_the_nearest_of_all() {
        let mut rng = rng::stream(1, "nearest-intact");
        let mut ties = 0;
        for round in 0..2000 {
            let frame = FieldFrame { cols: rng.random_range(1..30), rows: rng.random_range(1..30), cell_m: 5.0 };
            let share = [0.0, 0.003, 0.05, 0.5][round % 4];
            let wanted: Vec<bool> = (0..frame.cell_count()).map(|_| rng.random_bool(share)).collect();
            // On centres and corners of cells, where ties are, and anywhere.
            let steps = |rng: &mut rng::Xoshiro256PlusPlus, cells: u16| match round % 3 {
                0 => f64::from(rng.random_range(0..=2 * cells)) * 2.5,
                _ => rng.random_range(0.0..f64::from(cells) * 5.0),
            };
            let place = DVec2::new(steps(&mut rng, frame.cols), steps(&mut rng, frame.rows));
            let squared = |cell: Cell| (frame.centre(cell) - place).length_squared();
            let all = (0..frame.cell_count()).filter(|&index| wanted[index]).map(|index| frame.cell(index));
            let expected = all.clone().min_by(|&a, &b| squared(a).total_cmp(&squared(b)));
            let found = nearest_cell(&frame, place, |cell| wanted[frame.index(cell)]);
            assert_eq!(found, expected, "round {round}: from {place}");
            ties += usize::from(all.filter(|&cell| Some(squared(cell)) == expected.map(squared)).count() > 1);
        }
        assert!(ties > 50, "{ties} ties");
    }
}
