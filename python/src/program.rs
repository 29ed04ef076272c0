//! The command line started from Python, and planners that are separate programs.

use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::Arc;

use pyo3::prelude::*;
use wildfire::cli;
#[cfg(unix)]
use wildfire::programs::supervisor;
use wildfire::programs::{ProgramPool, Trust};
use wildfire::sim::{CustomRegistry, StartPrograms};

/// Returns the starter of the programs that scenarios name, if they are trusted.
pub fn programs(py: Python<'_>, trust: bool) -> Option<Arc<dyn StartPrograms>> {
    trust.then(|| {
        set_supervisor(py);
        Arc::new(ProgramPool::new(Trust::All)) as Arc<dyn StartPrograms>
    })
}

/// Sets the supervisor of planner programs, where there are any: the program runs itself again, which here is Python.
fn set_supervisor(py: Python<'_>) {
    #[cfg(not(unix))]
    let _ = py;
    #[cfg(unix)]
    if let Ok(python) = py.import("sys").and_then(|sys| sys.getattr("executable")?.extract::<OsString>()) {
        supervisor::set_command(vec![python, "-m".into(), "wildfire_contest".into()]);
    }
}

/// Runs the program with these arguments, the first of which is its name, and returns its exit code. Invalid arguments end
/// the process, and from then on signals end it too.
#[pyfunction]
pub fn command_line(py: Python<'_>, words: Vec<OsString>) -> u8 {
    set_supervisor(py);
    let exit = py.detach(|| cli::main_from(words, CustomRegistry::default()));
    // An exit code can be compared, but not read.
    (0..=u8::MAX).find(|&code| ExitCode::from(code) == exit).unwrap_or(u8::MAX)
}
