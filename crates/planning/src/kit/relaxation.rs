//! Relaxation schedules: what is asked for in turn, where the wanted clearance leads nowhere.

use crate::collision::LEAST_CLEARANCE_M;

/// A stage of a schedule: an attempt to find a path that keeps a share of the wanted clearance.
#[derive(Clone, Copy, Debug)]
pub struct Stage<E> {
    /// Share of the wanted clearance.
    pub share: f64,
    /// The means of the attempt, in the terms of whoever makes it.
    pub effort: E,
}

impl<E> Stage<E> {
    /// Returns the clearance that is kept, in metres: a share of the wanted one, no more than `most_m`, and never less
    /// than what every body keeps.
    pub fn min_clearance_m(&self, wanted_m: f64, most_m: f64) -> f64 {
        (self.share * wanted_m).min(most_m).max(LEAST_CLEARANCE_M)
    }

    /// Says whether less than the wanted clearance is kept.
    pub fn is_relaxed(&self) -> bool {
        self.share < 1.0
    }
}
