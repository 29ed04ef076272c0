//! The second opinion on finished timelines, with shapes and queries of rapier.
//!
//! Planners answer to `collision`; this module answers to nobody. It takes what really was driven, samples it finely,
//! and holds every sample against the rules: the footprint overlaps no bush and stays in the field, the way bends no
//! more than the turning radius allows, nothing slides, jumps or speeds, and fires go out only beside a truck that
//! stands. World frame, metres, seconds. It shares no code with `collision` and `planning`.

mod ground;
mod leg;
mod run;

pub use ground::{Ground, Touch};
pub use leg::{Breach, Offence, Step, audit_leg};
pub use run::{RunOffence, RunRule, audit_timeline};

use std::ops::AddAssign;

/// What an audit looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Audited {
    pub legs: u64,
    pub samples: u64,
    pub metres: f64,
    pub extinctions: u64,
}

impl AddAssign for Audited {
    fn add_assign(&mut self, other: Self) {
        self.legs += other.legs;
        self.samples += other.samples;
        self.metres += other.metres;
        self.extinctions += other.extinctions;
    }
}
