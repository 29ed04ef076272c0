//! The command line of the program, as Python starts it.

use std::ffi::OsString;
use std::process::ExitCode;

use pyo3::prelude::*;
use wildfire::cli;
#[cfg(unix)]
use wildfire::programs::supervisor;
use wildfire::sim::Entrants;

/// Does what the program does with these words, the first of which is its name, and returns its exit code. Wrong words
/// end the process. From then on signals end it too, as they end the program.
#[pyfunction]
pub fn command_line(py: Python<'_>, words: Vec<OsString>) -> u8 {
    // Programs that plan are held by this program started again, which is Python's here.
    #[cfg(unix)]
    if let Ok(python) = py.import("sys").and_then(|sys| sys.getattr("executable")?.extract::<OsString>()) {
        supervisor::set_command(vec![python, "-m".into(), "wildfire_contest".into()]);
    }
    let exit = py.detach(|| cli::main_from(words, Entrants::default()));
    // What a code is cannot be asked, only what it equals.
    (0..=u8::MAX).find(|&code| ExitCode::from(code) == exit).unwrap_or(u8::MAX)
}
