//! What is wrong with a scenario, where, and in which words; the tools of checks.

pub mod check;
pub mod error;
pub mod json_location;
pub mod path;
pub mod wording;
