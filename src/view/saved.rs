//! Stills of what the window shows, in the current folder.

use std::path::{Path, PathBuf};

use crate::picture::film::{FrameRequest, RunView, still};
use crate::time::SimTime;

/// Writes a still and says where it is, or why it is not.
pub fn save_still(request: &FrameRequest, size: (u32, u32)) -> String {
    let path = free_name(&base_name(request.runs, request.time));
    match still(request, size).write_png(&path) {
        Ok(()) => format!("saved {}", path.display()),
        Err(error) => format!("cannot write {}: {error}", path.display()),
    }
}

/// The first name that no file has yet.
fn free_name(base: &str) -> PathBuf {
    let names = std::iter::once(format!("{base}.png")).chain((2..).map(|number| format!("{base}-{number}.png")));
    let free = names.map(PathBuf::from).find(|name| !is_taken(name));
    free.expect("numbers do not end")
}

/// A link that leads nowhere has a name, too.
fn is_taken(name: &Path) -> bool {
    name.symlink_metadata().is_ok()
}

fn base_name(runs: &[&RunView], time: SimTime) -> String {
    let runs: Vec<String> = runs.iter().map(|run| run_name(run)).collect();
    format!("{}-{:.1}s", runs.join("-and-"), time.as_seconds())
}

fn run_name(run: &RunView) -> String {
    let setting = &run.timeline().setting;
    let is_plain = |letter: char| letter.is_alphanumeric() || matches!(letter, '-' | '_');
    let scenario = setting.scenario.chars().map(|letter| if is_plain(letter) { letter } else { '_' });
    // Long names are cut, so that the whole fits a file name.
    format!("{}-seed-{}", scenario.take(40).collect::<String>(), setting.seed)
}
