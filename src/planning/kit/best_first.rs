//! What the truck's lattice searches have in common: the motions of the lattice, and what waits to be judged.

use crate::grid::open_list::Ranked;
use crate::vehicle::{Dimensions, Segment};

/// The six motions of `step_m` metres that may follow any pose: straight, left and right at the smallest turning
/// radius, forward first, then in reverse.
pub fn motions(body: &Dimensions, step_m: f64) -> [Segment; 6] {
    let motion = |side: f64, sense: f64| Segment { curvature: side * body.max_curvature(), length_m: sense * step_m };
    [motion(0.0, 1.0), motion(1.0, 1.0), motion(-1.0, 1.0), motion(0.0, -1.0), motion(1.0, -1.0), motion(-1.0, -1.0)]
}

/// A step `S` from a node, in the open list until its turn comes.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<S> {
    pub key: f64,
    pub cost: f64,
    /// Order of insertion.
    pub sequence: u32,
    pub node: u32,
    pub step: S,
}

impl<S> Ranked for Candidate<S> {
    type Tie = u32;

    fn priority(&self) -> f64 {
        self.key
    }

    fn cost(&self) -> f64 {
        self.cost
    }

    fn tie(&self) -> u32 {
        self.sequence
    }
}
