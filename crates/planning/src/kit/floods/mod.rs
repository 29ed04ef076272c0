//! Floods over lattices of (x, y, heading): slow, and complete at their resolution.
//!
//! A flood spreads from a root pose in arcs and straights, forward and reverse. Every motion can be driven back, so one
//! flood answers for every pose that the truck drives to from the root. A yes is proven by a path. A no means: not at the
//! resolution of the finest of the [`LATTICES`], or not through any passage as wide as the body, or not within the finest
//! lattice's limit of [`MAX_POSES`] poses.

mod flood;
mod passages;
mod search;

use flood::MAX_BINS;
pub use flood::MAX_POSES;
pub use search::{FloodQuery, FloodSearch, Floods};

use super::lattice::Lattice;
use wildfire_base::geometry::FieldFrame;

/// Lattices of the floods, coarsest first. The short motions of the last can turn the truck about in tight pockets.
pub const LATTICES: [Lattice; 3] = [
    Lattice { bin_m: 10.0, headings: 24, step_m: 14.0 },
    Lattice { bin_m: 5.0, headings: 24, step_m: 7.0 },
    Lattice { bin_m: 1.25, headings: 72, step_m: 1.5 },
];

/// Bytes of a pose, what waits among them included, and of a bin, in lists that double.
const POSE_BYTES: u64 = 28;
const BIN_BYTES: u64 = 5;

/// Returns an upper bound of the bytes of floods over all lattices of a field, each of which spreads from up to this
/// number of poses.
pub fn flood_bytes(frame: &FieldFrame, max_spread: u32) -> u64 {
    LATTICES
        .into_iter()
        .map(|lattice: Lattice| {
            let Lattice { bin_m, headings, .. } = lattice;
            let bins = (frame.width_m() / bin_m * (frame.height_m() / bin_m) * f64::from(headings)) as u64;
            let poses = bins.min(MAX_POSES as u64).min(6 * u64::from(max_spread) + 1);
            POSE_BYTES * poses + BIN_BYTES * bins.min(MAX_BINS as u64)
        })
        .sum()
}

/// The clearance that the body keeps from bushes and border.
pub const CLEARANCE_M: f64 = 0.03;
