//! A wildfire contest between planners: an arsonist on a grid sets bushes on fire, a truck with Ackermann steering
//! puts them out.
//!
//! The layers, lowest first; each may use those above it in this list:
//! [`time`], [`geometry`], [`rng`], [`event_queue`], [`input_file`], [`ranges`], [`untrusted`], [`whole_file`];
//! [`document`]; [`grid`];
//! [`map_files`]; [`vehicle`]; [`trajectory`]; [`collision`]; [`planning`]; [`fire`]; [`scenario`]; [`timeline`];
//! [`picture`]; [`audit`]; [`sim`]; [`stats`]; [`batch`]; `view`; [`cli`].

// What fuzzers share is also part of the tests in `tests/`, where this crate has its name.
#[cfg(test)]
extern crate self as wildfire;

pub mod audit;
pub mod batch;
pub mod cli;
pub mod collision;
pub mod document;
pub mod event_queue;
pub mod fire;
pub mod geometry;
pub mod grid;
pub mod input_file;
pub mod map_files;
pub mod picture;
pub mod planning;
pub mod ranges;
pub mod rng;
pub mod scenario;
pub mod sim;
pub mod stats;
pub mod time;
pub mod timeline;
pub mod trajectory;
pub mod untrusted;
pub mod vehicle;
#[cfg(feature = "view")]
pub mod view;
pub mod whole_file;
