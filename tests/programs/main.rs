//! Programs as planners and policies: what they may do wrong, what they cost, and that nothing of them is left.
#![cfg(target_os = "linux")]

#[path = "../shared/children.rs"]
#[expect(dead_code, reason = "no program here reads a pipe of the tests")]
mod children;

mod batches;
mod cost;
mod modules;
mod policy;
mod same;
mod shell;
mod stage;
mod table;
mod templates;
mod traces;
mod trust;
