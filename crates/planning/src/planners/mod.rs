//! The truck's planners with their settings, one folder each. None imports another.

pub mod hybrid_astar;
pub mod lattice;
pub mod prm_primitives;
pub mod prm_rs;
