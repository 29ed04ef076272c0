//! The truck's planners, one folder each: what is its own, and its settings. None imports another.

pub mod hybrid_astar;
pub mod lattice;
pub mod prm_primitives;
pub mod prm_rs;
