//! The command line of the program, as Python starts it, and planners that are programs of their own.

use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::Arc;

use pyo3::prelude::*;
use wildfire::cli;
#[cfg(unix)]
use wildfire::programs::{ProgramPool, Trust, supervisor};
use wildfire::sim::{Entrants, StartPrograms};

/// Returns who starts the programs that scenarios name, if these are trusted.
pub fn programs(py: Python<'_>, trust: bool) -> Option<Arc<dyn StartPrograms>> {
    #[cfg(unix)]
    if trust {
        set_supervisor(py);
        return Some(Arc::new(ProgramPool::new(Trust::All)));
    }
    None
}

/// Programs that plan are held by this program started again, which is Python's here.
#[cfg(unix)]
fn set_supervisor(py: Python<'_>) {
    if let Ok(python) = py.import("sys").and_then(|sys| sys.getattr("executable")?.extract::<OsString>()) {
        supervisor::set_command(vec![python, "-m".into(), "wildfire_contest".into()]);
    }
}

/// Does what the program does with these words, the first of which is its name, and returns its exit code. Wrong words
/// end the process. From then on signals end it too, as they end the program.
#[pyfunction]
pub fn command_line(py: Python<'_>, words: Vec<OsString>) -> u8 {
    #[cfg(unix)]
    set_supervisor(py);
    let exit = py.detach(|| cli::main_from(words, Entrants::default()));
    // What a code is cannot be asked, only what it equals.
    (0..=u8::MAX).find(|&code| ExitCode::from(code) == exit).unwrap_or(u8::MAX)
}
