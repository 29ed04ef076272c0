//! Relaxation schedules: the clearances that are tried in turn if the wanted one leads nowhere.

use crate::collision::MIN_CLEARANCE_M;

/// A stage of a schedule: an attempt to find a path that keeps a share of the wanted clearance.
#[derive(Clone, Copy, Debug)]
pub struct Stage<E> {
    /// Share of the wanted clearance.
    pub share: f64,
    /// The effort of the attempt, in the caller's terms.
    pub effort: E,
}

impl<E> Stage<E> {
    /// Returns the clearance to keep, in metres: a share of the wanted one, at most `max_m`, and at least what every
    /// body keeps.
    pub fn min_clearance_m(&self, wanted_m: f64, max_m: f64) -> f64 {
        (self.share * wanted_m).min(max_m).max(MIN_CLEARANCE_M)
    }

    /// Returns whether less than the wanted clearance is kept.
    pub fn is_relaxed(&self) -> bool {
        self.share < 1.0
    }
}
