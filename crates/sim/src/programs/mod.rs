//! Planners and policies that are programs of their own, in any language.
//!
//! A program reads questions from stdin and writes answers to stdout, JSON objects, one a line: [`protocol`]. A
//! [`supervisor`] holds it, so that nothing of it is left whatever happens; a [`process`] asks it, waits no longer than
//! it may take, and knows what it costs.

pub mod protocol;

#[cfg(unix)]
mod backend;
#[cfg(unix)]
mod external_client;
#[cfg(unix)]
mod planner;
#[cfg(unix)]
mod policy;
#[cfg(unix)]
mod pool;
#[cfg(unix)]
pub mod process;
#[cfg(unix)]
mod process_tree;
#[cfg(unix)]
pub mod supervisor;

#[cfg(unix)]
pub use pool::{ProgramPool, Trust};
