//! Planners and policies that are programs of their own, in any language.
//!
//! A program reads questions from stdin and writes answers to stdout, JSON objects, one a line: [`protocol`]. A
//! [`supervisor`] holds it, so that nothing of it is left whatever happens; a [`process`] asks it, waits no longer than
//! it may take, and knows what it costs. Elsewhere than on Unix there are only modules.

pub mod protocol;

#[cfg(not(target_family = "wasm"))]
mod backend;
#[cfg(not(target_family = "wasm"))]
mod external_client;
#[cfg(not(target_family = "wasm"))]
pub mod launch;
#[cfg(not(target_family = "wasm"))]
mod planner;
#[cfg(not(target_family = "wasm"))]
mod policy;
#[cfg(not(target_family = "wasm"))]
mod pool;
#[cfg(not(target_family = "wasm"))]
#[cfg_attr(not(unix), path = "no_process.rs")]
pub mod process;
#[cfg(unix)]
mod process_tree;
#[cfg(unix)]
pub mod sandbox;
#[cfg(unix)]
pub mod supervisor;

#[cfg(not(target_family = "wasm"))]
pub use pool::{ProgramPool, Trust};

/// Why a program does not run elsewhere, and what does.
pub const ONLY_ON_UNIX: &str =
    "programs run only on Unix; expected a WebAssembly module, or code that is registered in Python or Rust";
