//! Pictures and films: what is shown is what the timeline says, and what is read of damaged recordings.

mod crowds;
mod damaged;
mod field;
mod frames;
mod moments;
mod pictures;
