#![doc = include_str!("../README.md")]
//!
//! The independent audit of finished timelines, with shapes and queries of rapier.
//!
//! Planners rely on `collision`; this module does not. It checks the actual drives against the rules, each in a separate
//! file:
//!
//! - every leg, in small steps: the footprint overlaps no bush and stays in the field, no turn is tighter than the
//!   turning radius, and the states of the timeline are those to which the pieces of the leg lead;
//! - speeds, and how they change, keep the limits that the timeline holds; at cusps a truck stands;
//! - legs join, and interrupted legs were driven as planned up to the interruption;
//! - no two trucks overlap at any time;
//! - a fire goes out only if a truck stands within reach for the whole dwell, and Wumpuses light only where they arrived;
//! - only cells that can burn catch fire, only burning cells go out, and fire obeys its times and distances;
//! - fire over ground reaches each cell exactly when it is due from the neighbouring cells.
//!
//! World frame, metres, seconds. It shares no code with `collision` and `planning`. Wumpuses walk axis-parallel squares
//! and block nobody.

mod arrival;
mod automaton;
mod cell_log;
mod characteristic;
mod crown;
mod driven;
mod ember;
mod field;
mod fires;
mod ground;
mod leg;
mod line;
mod meeting;
mod pace;
mod run;
mod spread;
mod suppression;
mod tolerance;
mod violation;
mod water;

pub use field::{AuditField, Contact, Outline, UnitPose};
pub use leg::{MotionLimits, SampleStep, audit_leg};
pub use run::{Verdict, audit_timeline};
pub use violation::{Violation, ViolationKind};

use std::ops::AddAssign;

/// The amount that an audit looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Audited {
    /// Legs of trucks and Wumpuses.
    pub legs: u64,
    pub poses: u64,
    pub metres: f64,
    pub extinctions: u64,
}

impl AddAssign for Audited {
    fn add_assign(&mut self, other: Self) {
        self.legs += other.legs;
        self.poses += other.poses;
        self.metres += other.metres;
        self.extinctions += other.extinctions;
    }
}
