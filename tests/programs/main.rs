//! Programs as planners: what they may do wrong, what they cost, and that nothing of them is left.
#![cfg(target_os = "linux")]

mod cost;
mod stage;
mod table;
mod traces;
