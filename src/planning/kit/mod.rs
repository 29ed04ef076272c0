//! What several planners use: searches over poses, the clearance that they keep, heuristics, and the ends of drives.
//!
//! Planners import this and never each other.

pub mod best_first;
pub mod clearance_profile;
pub mod closed_set;
pub mod ends;
pub mod halton;
pub mod heuristic;
pub mod holonomic;
pub mod local_search;
pub mod motion_price;
pub mod safety;
pub mod shortcuts;
pub mod shorten;
pub mod turn_straight;
