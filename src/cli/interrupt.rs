//! Ctrl-C: the first lets the program tidy up, the second ends it at once.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::cli::failure::Failure;
use crate::cli::{exit, terminal};

/// A flag that the first Ctrl-C, or request of the system to end, sets. To be called once.
pub fn watch() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&stop);
    let watched = ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::Relaxed) {
            process::exit(exit::INTERRUPTED.into());
        }
        terminal::note("stopping; Ctrl-C once more to stop at once");
    });
    watched.map_err(|error| Failure::environment(format_args!("cannot watch for Ctrl-C: {error}")))?;
    Ok(stop)
}
