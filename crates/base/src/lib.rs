#![doc = include_str!("../README.md")]

pub mod document;
pub mod event_queue;
pub mod geometry;
pub mod input_file;
pub mod names;
pub mod npy;
pub mod object;
pub mod or_none;
pub mod query;
pub mod ranges;
pub mod rng;
pub mod time;
pub mod trajectory;
pub mod untrusted;
pub mod vehicle;
pub mod whole_file;
