//! A real window on the X display, seen and used as a person does.

use std::env;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use wildfire::time::wall::WallStopwatch;

use crate::xwd::Screenshot;

/// No window on a slow machine takes longer for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// There is one pointer and one keyboard.
static HANDS: Mutex<()> = Mutex::new(());

/// The right to use the display; `None`, with a word, where something is missing.
pub fn hands() -> Option<MutexGuard<'static, ()>> {
    let missing = missing();
    if let Some(missing) = &missing {
        assert!(env::var_os("WILDFIRE_WINDOW_TEST").is_none_or(|value| value != "required"), "there is no {missing}");
        say(&format!("skipped: there is no {missing}"));
    }
    missing.is_none().then(|| HANDS.lock().unwrap_or_else(PoisonError::into_inner))
}

#[expect(clippy::print_stderr, reason = "a test that is skipped says so")]
pub fn say(message: &str) {
    eprintln!("{message}");
}

fn missing() -> Option<&'static str> {
    if env::var_os("DISPLAY").is_none_or(|display| display.is_empty()) {
        return Some("display");
    }
    let is_there = |program: &str| {
        let paths = env::var_os("PATH").unwrap_or_default();
        env::split_paths(&paths).any(|folder| folder.join(program).is_file())
    };
    ["xdotool", "xwd"].into_iter().find(|program| !is_there(program))
}

/// Tries until there is an answer.
pub fn wait_for<T>(what: &str, mut answer: impl FnMut() -> Option<T>) -> T {
    let clock = WallStopwatch::start();
    loop {
        if let Some(answer) = answer() {
            return answer;
        }
        assert!(clock.elapsed() < PATIENCE, "waited in vain for {what}");
        pause();
    }
}

#[expect(clippy::disallowed_methods, reason = "another process needs the processor meanwhile")]
fn pause() {
    thread::sleep(Duration::from_millis(20));
}

/// The program, as it is started in a folder.
pub fn program(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wildfire"));
    // Drivers look for Wayland there, and say so if it is not set.
    command.env("XDG_RUNTIME_DIR", folder).env("WGPU_BACKEND", "vulkan");
    command.current_dir(folder).stdin(Stdio::null());
    command
}

/// An open window; it is closed when this goes.
pub struct Window {
    process: Child,
    id: String,
    stderr_path: PathBuf,
}

impl Window {
    /// Opens `wildfire play` in a folder.
    pub fn open<S: AsRef<OsStr>>(folder: &Path, arguments: &[S]) -> Self {
        let stderr_path = folder.join("stderr.txt");
        let start = || {
            let mut command = program(folder);
            command.arg("play").args(arguments).stdout(Stdio::null());
            command.stderr(File::create(&stderr_path).expect("the test's own folder"));
            command.spawn().expect("it starts")
        };
        let mut process = start();
        let id = wait_for("the window", || {
            if process.try_wait().expect("it was started").is_some() {
                let reason = fs::read_to_string(&stderr_path).unwrap_or_default();
                // A virtual display begins again when its last window is closed, and answers nobody meanwhile.
                assert!(reason.contains("does not answer"), "{reason}");
                process = start();
            }
            let pid = process.id().to_string();
            answer("xdotool", &["search", "--onlyvisible", "--pid", &pid])?.lines().next().map(str::to_owned)
        });
        let window = Self { process, id, stderr_path };
        // Without a window manager nobody else gives it the keyboard.
        window.hand(&["windowfocus", "--sync", &window.id]);
        window
    }

    fn hand(&self, arguments: &[&str]) {
        answer("xdotool", arguments).unwrap_or_else(|| panic!("xdotool {arguments:?}"));
    }

    /// Presses keys, named as X names them, one after the other.
    pub fn press(&self, keys: &[&str]) {
        self.hand(&[&["key", "--clearmodifiers", "--delay", "30"], keys].concat());
    }

    pub fn mouse_to(&self, (x, y): (f64, f64)) {
        self.hand(&["mousemove", "--window", &self.id, &(x as i64).to_string(), &(y as i64).to_string()]);
    }

    /// Button 1 is the left one, 4 and 5 are the wheel.
    pub fn click(&self, button: &str) {
        self.hand(&["click", button]);
    }

    pub fn drag(&self, from: (f64, f64), to: (f64, f64)) {
        self.mouse_to(from);
        self.hand(&["mousedown", "1"]);
        self.mouse_to(to);
        self.hand(&["mouseup", "1"]);
    }

    pub fn resize(&self, (width, height): (u32, u32)) {
        self.hand(&["windowsize", &self.id, &width.to_string(), &height.to_string()]);
    }

    /// Takes the window from the program, which is not asked.
    pub fn destroy(&self) {
        self.hand(&["windowclose", &self.id]);
    }

    pub fn title(&self) -> String {
        answer("xdotool", &["getwindowname", &self.id]).unwrap_or_default().trim().to_owned()
    }

    pub fn screenshot(&self) -> Option<Screenshot> {
        let output = Command::new("xwd").args(["-silent", "-id", &self.id]).output().ok()?;
        Screenshot::parse(&output.stdout)
    }

    /// Waits until the title ends so.
    pub fn wait_for_title(&self, end: &str) {
        wait_for(&format!("the title '... {end}'"), || self.title().ends_with(end).then_some(()));
    }

    /// Waits until the program has ended by itself; returns how, and what it said.
    pub fn wait_for_end(mut self) -> (ExitStatus, String) {
        let status = wait_for("the end", || self.process.try_wait().expect("it was started"));
        (status, fs::read_to_string(&self.stderr_path).unwrap_or_default())
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        // Best effort: it may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn answer(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).stderr(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}
