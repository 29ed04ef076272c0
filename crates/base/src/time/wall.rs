//! Elapsed real time, for progress and for the `wall_` columns of a batch.
//!
//! What is measured here is reported and never decides anything.

use std::time::{Duration, Instant};

/// Measures real time from its creation on.
#[derive(Clone, Copy, Debug)]
pub struct WallStopwatch(Instant);

impl WallStopwatch {
    #[expect(clippy::disallowed_methods, reason = "the one home of real time, which is reported and decides nothing")]
    pub fn start() -> Self {
        Self(Instant::now())
    }

    pub fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }
}
