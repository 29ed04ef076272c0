//! Floods over lattices of (x, y, heading): slow, and complete at their resolution.
//!
//! A flood spreads from a root pose in arcs and straights, forward and reverse. Every motion can be driven back, so one
//! flood answers for every pose that the truck drives to from the root. A yes is proven by a path. A no means: not at the
//! resolution of the finest of the [`LATTICES`], or not through any passage as wide as the body, or not within the finest
//! lattice's limit of [`MAX_POSES`] poses.

mod flood;
mod passages;
mod search;

pub use flood::MAX_POSES;
pub use search::{FloodQuery, FloodSearch, Floods};

use super::lattice::Lattice;

/// Lattices of the floods, coarsest first. The short motions of the last can turn the truck about in tight pockets.
pub const LATTICES: [Lattice; 3] = [
    Lattice { bin_m: 10.0, headings: 24, step_m: 14.0 },
    Lattice { bin_m: 5.0, headings: 24, step_m: 7.0 },
    Lattice { bin_m: 1.25, headings: 72, step_m: 1.5 },
];

/// The clearance that the body keeps from bushes and border.
pub const CLEARANCE_M: f64 = 0.03;
