//! CPU cost of planning, from the thread's own CPU clock.
//!
//! What is measured here is reported and never decides anything, so that outcomes stay equal bit for bit.

use std::time::Duration;

#[cfg(not(target_family = "wasm"))]
use cpu_time::ThreadTime;

/// Where threads have no clocks, nothing takes time.
#[cfg(target_family = "wasm")]
#[derive(Clone, Copy, Debug)]
struct ThreadTime;

#[cfg(target_family = "wasm")]
impl ThreadTime {
    fn now() -> Self {
        Self
    }

    fn duration_since(self, _: Self) -> Duration {
        Duration::ZERO
    }
}

/// Measures the CPU time that this thread spends from its creation on.
///
/// The clock counts nanoseconds of this thread only; other threads and waiting do not show.
#[derive(Clone, Copy, Debug)]
pub struct CpuStopwatch(ThreadTime);

impl CpuStopwatch {
    pub fn start() -> Self {
        Self(ThreadTime::now())
    }

    /// CPU time since the start, or since the last lap.
    pub fn elapsed_since_last(&mut self) -> Duration {
        let now = ThreadTime::now();
        let span = now.duration_since(self.0);
        self.0 = now;
        span
    }
}
