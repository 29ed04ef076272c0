//! What the moves of a lattice cost.

use super::astar::is_diagonal;

/// The cost of every move of a lattice; never negative.
pub trait StepCosts {
    /// Of move `k` of [`MOVES`](super::astar::MOVES), which leads between these points.
    fn of(&self, k: usize, from: usize, to: usize) -> f64;
}

/// One cost for all orthogonal moves, one for all diagonal ones.
impl StepCosts for (f64, f64) {
    fn of(&self, k: usize, _: usize, _: usize) -> f64 {
        if is_diagonal(k) { self.1 } else { self.0 }
    }
}
