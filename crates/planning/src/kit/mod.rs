//! Components that several planners share. Planners import these and never each other.
//!
//! - [`best_first`] is the search over poses; [`local_search`] follows waypoints with it, [`relaxed_search`] goes for a
//!   goal from both ends, [`floods`] look at every bin of a lattice once.
//! - [`heuristic`], [`holonomic`] and [`turn_straight`] say what is still to drive, [`motion_price`] and [`safety`] what
//!   motions cost.
//! - [`clearance_profile`] says what room a drive keeps, [`relaxation`] what is asked for in turn, [`ends`] whether there
//!   is room at all, [`target`] where a drive may end.
//! - [`halton`], [`sample_density`], [`milestone_tiles`] and [`roadmap_graph`] are for roadmaps; [`path_improvement`] makes
//!   paths shorter; [`vehicle_units`] scales fields for vehicles of another size.

pub mod best_first;
pub mod clearance_profile;
pub mod closed_set;
pub mod drive_cost;
pub mod ends;
pub mod floods;
pub mod halton;
pub mod heuristic;
pub mod holonomic;
pub mod lattice;
pub mod local_search;
pub mod milestone_tiles;
pub mod motion_price;
pub mod path_improvement;
pub mod relaxation;
pub mod relaxed_search;
pub mod roadmap_graph;
pub mod safety;
pub mod sample_density;
pub mod target;
pub mod turn_straight;
pub mod vehicle_units;
