use glam::DVec2;

use crate::collision::CollisionChecker;
use crate::geometry::FieldFrame;
use crate::grid::octile::{cost_to_go, legal_moves};
use crate::grid::{Connectivity, CornerCutting, Grid};
use crate::planning::Goal;

/// The part of a walk over cells that no truck drives less than, however it cuts the corners of the grid.
const SHARE: f64 = 0.94;

/// For every diagonal move the orthogonal ones beside it: nothing passes between two bushes that touch at a corner.
const BESIDE_DIAGONAL: [(u8, u8); 4] = [(4, 0b0011), (5, 0b0110), (6, 0b1100), (7, 0b1001)];

/// Walks over the cells of one field that are free of bushes.
#[derive(Debug)]
pub struct Cells {
    frame: FieldFrame,
    moves: Grid<u8>,
    occupied: Grid<bool>,
}

/// How far it is from every cell to a goal for somebody who walks from cell to cell.
#[derive(Debug)]
pub struct Wave<'a> {
    cells: &'a Cells,
    metres: Grid<f64>,
}

impl Cells {
    pub fn new(checker: &CollisionChecker) -> Self {
        let field = checker.field();
        let mut moves = legal_moves(field.occupied(), Connectivity::Eight, CornerCutting::Allowed);
        for mask in moves.values_mut() {
            for (k, beside) in BESIDE_DIAGONAL {
                *mask &= if *mask & beside == 0 { !(1 << k) } else { u8::MAX };
            }
        }
        Self { frame: *field.frame(), moves, occupied: field.occupied().clone() }
    }

    pub fn wave_to(&self, goal: Goal) -> Wave<'_> {
        let (centre, radius_m) = match goal {
            Goal::Pose(pose) => (pose.position(), 0.0),
            Goal::Disc(disc) => (disc.centre, disc.radius_m),
        };
        let cell_m = self.frame.cell_m;
        let half = DVec2::splat(0.5 * cell_m);
        let is_in_disc = |index: &usize| {
            let offset = (self.frame.centre(self.frame.cell(*index)) - centre).abs();
            !self.occupied.values()[*index] && (offset - half).max(DVec2::ZERO).length() <= radius_m
        };
        let goals = (0..self.frame.cell_count()).filter(is_in_disc);
        let steps = (cell_m, cell_m * std::f64::consts::SQRT_2);
        Wave { cells: self, metres: cost_to_go(&self.moves, goals, steps) }
    }
}

impl Wave<'_> {
    /// Metres that are still to drive at least from a place in the field, nearly; infinite where no way leads.
    pub fn least_m(&self, place: DVec2) -> f64 {
        let cell = self.cells.frame.cell_at(place);
        let walked = cell.map_or(f64::INFINITY, |cell| self.metres.values()[self.cells.frame.index(cell)]);
        (SHARE * walked - self.cells.frame.cell_m).max(0.0)
    }
}
