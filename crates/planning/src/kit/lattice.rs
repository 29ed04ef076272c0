//! Lattices of poses, and the motions that connect them.

use wildfire_base::vehicle::{Dimensions, Segment};

/// A lattice of poses: one pose per bin, connected by motions of one length.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    pub bin_m: f64,
    /// The number of headings per full turn.
    pub headings: u32,
    pub step_m: f64,
}

/// Returns the six motions of `step_m` metres that may follow any pose: straight, left and right at the minimum turning
/// radius, forward first, then in reverse.
pub fn motions(body: &Dimensions, step_m: f64) -> [Segment; 6] {
    let motion = |side: f64, sense: f64| Segment { curvature: side * body.max_curvature(), length_m: sense * step_m };
    [motion(0.0, 1.0), motion(1.0, 1.0), motion(-1.0, 1.0), motion(0.0, -1.0), motion(1.0, -1.0), motion(-1.0, -1.0)]
}
