//! Programs that tests start: they begin alike whoever calls the tests, and every wait for them has an end.

use std::ffi::OsStr;
#[cfg(unix)]
use std::fs::File;
use std::io::{Error, ErrorKind};
#[cfg(unix)]
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

/// Longer than anything that tests wait for takes on a machine that is busy elsewhere: only a hang lasts so long.
const PATIENCE: Duration = Duration::from_mins(10);

/// Lets programs start with the default action of signals that the caller of the tests ignores, as `nohup` does.
#[cfg(target_os = "linux")]
pub fn restore_signals() {
    use std::sync::{Arc, Once};

    use signal_hook::consts::{SIGCHLD, SIGHUP, SIGINT, SIGQUIT, SIGTERM};

    static RESTORED: Once = Once::new();
    RESTORED.call_once(|| {
        let status = std::fs::read_to_string("/proc/self/status").expect("this is Linux");
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).expect("it lists ignored signals");
        let mask = u64::from_str_radix(mask.trim(), 16).expect("it is a mask");
        for signal in [SIGCHLD, SIGHUP, SIGINT, SIGQUIT, SIGTERM] {
            if mask >> (signal - 1) & 1 == 1 {
                // The tests still ignore the signal, but a handler does not outlive the start of a program.
                signal_hook::flag::register(signal, Arc::default()).expect("it may be caught");
            }
        }
    });
}

#[cfg(not(target_os = "linux"))]
pub fn restore_signals() {}

/// Variables of the caller that change what the program does or prints; its settings, and those of a scheduler's task.
const CALLERS: [&str; 11] = [
    "CLICOLOR",
    "CLICOLOR_FORCE",
    "COLUMNS",
    "NO_COLOR",
    "RUST_BACKTRACE",
    "RUST_LIB_BACKTRACE",
    "SLURM_ARRAY_TASK_ID",
    "SLURM_CPUS_PER_TASK",
    "SOURCE_DATE_EPOCH",
    "WILDFIRE_JOBS",
    "WILDFIRE_QUIET",
];

/// A program without input, not run yet, that the caller of the tests does not change.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    restore_signals();
    let mut command = Command::new(program);
    CALLERS.iter().for_each(|variable| _ = command.env_remove(variable));
    command.stdin(Stdio::null());
    command
}

/// `wildfire`, as [`command`] makes it.
pub fn program() -> Command {
    command(env!("CARGO_BIN_EXE_wildfire"))
}

/// Waits until something is so, which must come.
#[expect(clippy::disallowed_methods, reason = "other processes live in real time")]
#[track_caller]
pub fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < PATIENCE, "waited in vain until {what}");
        thread::sleep(Duration::from_micros(200));
    }
}

/// Waits for the end of a program, and returns what it wrote to its pipes.
#[track_caller]
pub fn end_of(child: Child) -> Output {
    let id = child.id().to_string();
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || sender.send(child.wait_with_output()));
    let Ok(ended) = receiver.recv_timeout(PATIENCE) else {
        let _ = Command::new("kill").args(["-KILL", &id]).status();
        panic!("a program had not ended after {PATIENCE:?}");
    };
    ended.expect("it can be waited for")
}

/// Runs a program to its end, and returns what it writes.
#[track_caller]
pub fn output_of(command: &mut Command) -> Output {
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut started = command.spawn();
    // While a test starts a program, what another test just wrote may still be open for writing there.
    let is_busy = |error: &Error| error.kind() == ErrorKind::ExecutableFileBusy;
    wait_until("the program may be executed", || {
        let was_busy = started.as_ref().is_err_and(is_busy);
        if was_busy {
            started = command.spawn();
        }
        !was_busy
    });
    end_of(started.unwrap_or_else(|error| panic!("{command:?}: {error}")))
}

/// Opens a named pipe for writing once a program has opened it for reading.
#[cfg(unix)]
#[track_caller]
pub fn writer_once_read(pipe: &Path, reader: &mut Child) -> File {
    use std::os::unix::fs::OpenOptionsExt;

    let mut options = File::options();
    options.write(true).custom_flags(nix::fcntl::OFlag::O_NONBLOCK.bits());
    let mut writer = options.open(pipe);
    wait_until("the pipe is read", || {
        assert!(reader.try_wait().expect("it can be asked").is_none(), "the program does not wait for the pipe");
        writer = options.open(pipe);
        writer.is_ok()
    });
    writer.expect("it was opened")
}

/// Sends a signal by its name.
#[cfg(unix)]
#[track_caller]
pub fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status();
    assert!(sent.expect("there is a kill").success());
}
