//! The supervisor: this program, started once more to hold a program that plans, and to end it whatever happens to us.
//!
//! It holds one end of a socket whose other end is ours. When that closes, because a run is over or because we were
//! killed, it kills the program and all that the program has started, by their process group and, on Linux, wherever they
//! have moved to. Until then it watches how many processes there are and how much memory they take, and hands on what the
//! program writes to stderr. The program's stdin and stdout are pipes to us, in which it has no part.
//!
//! A process of its own, and not a thread, since no thread outlives a kill, and since limits are inherited.

use std::env;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{ChildStderr, Command, Stdio};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::resource::{Resource, UsageWho, getrusage, setrlimit};
use nix::sys::signal::{Signal, kill, killpg};
use nix::sys::time::TimeValLike;
use nix::sys::wait::{WaitPidFlag, WaitStatus, waitpid};
use nix::unistd::{Pid, dup2_stdin, dup2_stdout};
use serde::{Deserialize, Serialize};
use signal_hook::consts::SIGCHLD;
use signal_hook::low_level::pipe;

use super::launch::{MAX_STDERR_LINES, ProcessLimits};
use super::process_tree::ProcessTree;
use wildfire_base::time::wall::WallStopwatch;

/// The first argument of a supervisor.
const WORD: &str = "supervise-program";

/// Set in the environment of a supervisor, so that a program that does not know the word starts no further ones.
const MARK: &str = "WILDFIRE_SUPERVISOR";

/// The time between two looks at the program's processes.
const TICK: Duration = Duration::from_millis(25);

/// The same while they are being killed.
const SHORT_TICK: Duration = Duration::from_millis(2);

/// The time that a program has to end by itself after the last message.
pub const GRACE: Duration = Duration::from_secs(2);

/// The time after which processes that do not end although they were killed are left to the system.
const GIVE_UP: Duration = Duration::from_secs(10);

/// The most bytes of a line of stderr that are handed on.
const MAX_STDERR_LINE_BYTES: usize = 2000;

/// The most bytes that wait for us to read them.
const MAX_WAITING: usize = 1 << 16;

/// A process may reserve this multiple of what all may use. This ends programs that fill the memory between two looks.
const RESERVED: u64 = 4;

/// An order to a supervisor, one a line. The end of all orders is one to kill.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SupervisorCommand {
    /// Let the program end by itself, and kill it after [`GRACE`].
    End,
    Kill,
    /// Another run begins: lines of stderr are counted again.
    NextRun,
}

/// A report of a supervisor, one a line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Report {
    Started {
        pid: i32,
    },
    NotStarted {
        reason: String,
    },
    /// The processes that are there beside the one that was started.
    Others {
        pids: Vec<i32>,
    },
    /// A line of stderr.
    #[serde(rename = "said")]
    Stderr {
        line: String,
    },
    /// There are more lines than are handed on.
    #[serde(rename = "said-too-much")]
    StderrCut,
    /// The last line of stderr, if it was not handed on.
    #[serde(rename = "said-last")]
    LastStderr {
        line: String,
    },
    /// It is being killed for this.
    Exceeded {
        limit: Exceeded,
    },
    /// Processes have ended; the CPU time of all that have, in microseconds.
    Reaped {
        cpu_us: u64,
    },
    /// The program has ended; [`Self::Reaped`] has been sent.
    Ended {
        how: ExitCause,
    },
}

/// A limit, and what was found instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exceeded {
    MemoryMb(u64),
    Processes(usize),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExitCause {
    Code(i32),
    Signal(i32),
}

/// The command line that starts a supervisor, without what it is to do.
static COMMAND: OnceLock<Vec<OsString>> = OnceLock::new();

/// Says how this program is started again, where it is not the executable of this process: a library inside another
/// program names an executable of `wildfire`. Only the first call has an effect.
pub fn set_command(command: Vec<OsString>) {
    let _ = COMMAND.set(command);
}

/// Returns the command that starts a supervisor of a program, which is to work in this folder, with its arguments.
pub fn command(limits: ProcessLimits, folder: &Path, program: &[OsString]) -> io::Result<Command> {
    if env::var_os(MARK).is_some() {
        let reason =
            "this is a supervisor already; the command that starts supervisors does not know its first argument";
        return Err(io::Error::other(reason));
    }
    let start = match COMMAND.get() {
        Some(command) => command.clone(),
        None => vec![env::current_exe()?.into_os_string()],
    };
    let (executable, arguments) = start.split_first().ok_or_else(|| io::Error::other("its command is empty"))?;
    let mut command = Command::new(executable);
    command.args(arguments).arg(WORD).args([limits.memory_mb.to_string(), limits.processes.to_string()]);
    command.arg(folder).args(program);
    // Its own group, so that Ctrl-C at the terminal ends us first and the program by our end.
    command.env(MARK, "1").process_group(0);
    Ok(command)
}

/// Supervises a program if the arguments of this process, its own name left out, ask for that; returns the exit code.
///
/// Every program that starts supervisors by itself calls this before anything else.
pub fn run_if_requested(arguments: &[OsString]) -> Option<u8> {
    let (word, arguments) = arguments.split_first()?;
    (word == WORD).then(|| match SupervisorTask::from_arguments(arguments).and_then(|task| supervise(&task)) {
        Ok(()) => 0,
        Err(error) => {
            let _ = writeln!(io::stderr(), "{WORD} is for this program's own use: {error}");
            2
        }
    })
}

struct SupervisorTask<'a> {
    limits: ProcessLimits,
    folder: &'a Path,
    program: &'a OsString,
    arguments: &'a [OsString],
}

impl<'a> SupervisorTask<'a> {
    fn from_arguments(arguments: &'a [OsString]) -> io::Result<Self> {
        let [memory_mb, processes, folder, program, arguments @ ..] = arguments else {
            return Err(io::Error::other("expected limits, a folder and a program"));
        };
        let number = |word: &OsString| word.to_str().and_then(|word| word.parse().ok());
        let limits = number(memory_mb).zip(number(processes));
        let (memory_mb, processes) = limits.ok_or_else(|| io::Error::other("expected two numbers"))?;
        let limits = ProcessLimits { memory_mb, processes: processes as usize };
        Ok(Self { limits, folder: Path::new(folder), program, arguments })
    }
}

fn supervise(task: &SupervisorTask<'_>) -> io::Result<()> {
    // Stderr is the socket that `Process::start` has put there.
    let control = UnixStream::from(io::stderr().as_fd().try_clone_to_owned()?);
    // Refuses a stderr that is no socket, as when somebody types the word by hand.
    control.peer_addr()?;
    // One loop waits for orders, ends of children and reports, so none of them may block.
    control.set_nonblocking(true)?;
    let outbox = Arc::new(SendBuffer::new(control.try_clone()?));
    inherit_limits(task.limits.memory_mb);
    // Before the program is there: its end is not to be missed.
    let (child_ended, handler) = UnixStream::pair()?;
    child_ended.set_nonblocking(true)?;
    pipe::register(SIGCHLD, handler)?;

    let mut command = Command::new(task.program);
    // A process group of its own, so that its children end with it; without the mark it may start supervisors itself.
    command.args(task.arguments).current_dir(task.folder).env_remove(MARK).process_group(0);
    // Stdin and stdout are pipes from the process that started this one.
    let spawned = command.stdin(Stdio::inherit()).stdout(Stdio::inherit()).stderr(Stdio::piped()).spawn();
    let mut child = match spawned {
        Ok(child) => child,
        Err(error) => {
            let program = task.program.to_string_lossy();
            let folder = task.folder.display();
            outbox.send(&Report::NotStarted { reason: format!("{program}, in {folder}: {error}") });
            // The report is the answer: an exit code would say that the supervisor itself has failed.
            outbox.empty();
            return Ok(());
        }
    };
    let pid = Pid::from_raw(child.id() as i32);
    outbox.send(&Report::Started { pid: pid.as_raw() });
    // The pipes are the program's alone now: when it closes one, we are to notice.
    let nowhere = File::options().read(true).write(true).open("/dev/null")?;
    dup2_stdin(&nowhere)?;
    dup2_stdout(&nowhere)?;
    let counter = Arc::new(Mutex::new(0));
    // A thread, as a full pipe would stop the program whatever else happens.
    let reader = child.stderr.take().map(|stderr| {
        let outbox = Arc::clone(&outbox);
        let counter = Arc::clone(&counter);
        thread::Builder::new().spawn(move || hand_on(stderr, &outbox, &counter))
    });
    let mut watch = ProcessWatch {
        control: Some(control),
        orders: Vec::new(),
        child_ended,
        outbox: Arc::clone(&outbox),
        stderr_lines: counter,
        limits: task.limits,
        family: ProcessTree::new(pid.as_raw()),
        pid,
        ending: None,
        killing: None,
    };
    watch.until_all_are_gone();
    // Children that live on may hold the pipe open: then its end is not waited for.
    if let Some(Ok(reader)) = reader
        && !watch.has_timed_out()
    {
        let _ = reader.join();
    }
    outbox.empty();
    Ok(())
}

/// Limits that the program has from its first moment on. Where the system refuses one, looking has to do.
fn inherit_limits(memory_mb: u64) {
    let _ = setrlimit(Resource::RLIMIT_CORE, 0, 0);
    let reserved = memory_mb.saturating_mul(1_000_000).saturating_mul(RESERVED);
    let _ = setrlimit(Resource::RLIMIT_DATA, reserved, reserved);
    // Whatever leaves the program's group, or loses its parent, stays a descendant of ours.
    #[cfg(target_os = "linux")]
    let _ = nix::sys::prctl::set_child_subreaper(true);
}

/// Lines on their way to us. Nobody waits for us to read them but who reads stderr.
struct SendBuffer {
    socket: UnixStream,
    waiting: Mutex<Vec<u8>>,
}

impl SendBuffer {
    fn new(socket: UnixStream) -> Self {
        Self { socket, waiting: Mutex::default() }
    }

    /// Adds a report, and sends what can be sent at once. Returns how many bytes wait.
    fn send(&self, report: &Report) -> usize {
        let mut line = serde_json::to_vec(report).expect("reports are JSON");
        line.push(b'\n');
        self.waiting().extend(line);
        self.flush()
    }

    fn flush(&self) -> usize {
        let mut waiting = self.waiting();
        while !waiting.is_empty() {
            match (&self.socket).write(&waiting) {
                Ok(written) => drop(waiting.drain(..written)),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                // Nobody is there who would read them.
                Err(_) => waiting.clear(),
            }
        }
        waiting.len()
    }

    /// Waits until all is sent, for as long as somebody could still want it.
    fn empty(&self) {
        let watch = WallStopwatch::start();
        while self.flush() > 0 && watch.elapsed() < GRACE {
            pause(SHORT_TICK);
        }
    }

    fn waiting(&self) -> std::sync::MutexGuard<'_, Vec<u8>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[expect(clippy::disallowed_methods, reason = "other processes live in real time")]
fn pause(time: Duration) {
    thread::sleep(time);
}

/// Hands on lines of stderr until it is closed. While too much waits for us, the program has to wait.
fn hand_on(stderr: ChildStderr, outbox: &SendBuffer, counter: &Mutex<u64>) {
    let mut stderr = BufReader::new(stderr);
    let mut last = None;
    while let Some(line) = line_of_limited_length(&mut stderr) {
        let count = {
            let mut count = counter.lock().unwrap_or_else(PoisonError::into_inner);
            *count += 1;
            *count
        };
        let report = match count {
            ..=MAX_STDERR_LINES => Report::Stderr { line },
            _ => {
                // Lines beyond the bound are not sent, but the last one often names the error.
                last = Some(line);
                if count > MAX_STDERR_LINES + 1 {
                    continue;
                }
                Report::StderrCut
            }
        };
        let mut waiting = outbox.send(&report);
        // A program that writes faster than its reports are read waits here.
        while waiting > MAX_WAITING {
            pause(TICK);
            waiting = outbox.flush();
        }
    }
    // Only at the end is it clear which line was the last.
    if let Some(line) = last {
        outbox.send(&Report::LastStderr { line });
    }
}

/// Reads a line; of a longer one, its beginning. `None` at the end.
fn line_of_limited_length(reader: &mut impl BufRead) -> Option<String> {
    let mut line = Vec::new();
    let mut has_input = false;
    loop {
        let bytes = match reader.fill_buf() {
            Ok([]) => break,
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(_) => break,
        };
        has_input = true;
        let end = bytes.iter().position(|&byte| byte == b'\n');
        let part = &bytes[..end.unwrap_or(bytes.len())];
        // What is too long is read on and dropped, so that the next line begins where it does.
        line.extend_from_slice(&part[..part.len().min(MAX_STDERR_LINE_BYTES - line.len())]);
        let used = end.map_or(bytes.len(), |end| end + 1);
        reader.consume(used);
        if end.is_some() {
            break;
        }
    }
    has_input.then(|| String::from_utf8_lossy(&line).trim_end_matches('\r').to_owned())
}

/// The program and its descendants, from its start to the end of the last of them.
struct ProcessWatch {
    /// Until we have closed our end.
    control: Option<UnixStream>,
    /// The beginning of an order.
    orders: Vec<u8>,
    /// Readable when a child has ended.
    child_ended: UnixStream,
    outbox: Arc<SendBuffer>,
    /// Lines of stderr in this run.
    stderr_lines: Arc<Mutex<u64>>,
    limits: ProcessLimits,
    family: ProcessTree,
    /// The program, whose number is that of its group too.
    pid: Pid,
    /// Runs since the program was asked to end.
    ending: Option<WallStopwatch>,
    /// Runs since all are being killed.
    killing: Option<WallStopwatch>,
}

impl ProcessWatch {
    fn until_all_are_gone(&mut self) {
        while self.reap() && !self.has_timed_out() {
            self.look();
            if self.ending.is_some_and(|since| since.elapsed() >= GRACE) {
                self.kill_group();
            }
            // What has left the group is killed one by one, and may have started others meanwhile.
            if self.killing.is_some() {
                for pid in self.family.others() {
                    let _ = kill(Pid::from_raw(pid), Signal::SIGKILL);
                }
            }
            self.wait(if self.killing.is_some() { SHORT_TICK } else { TICK });
            self.outbox.flush();
        }
    }

    fn has_timed_out(&self) -> bool {
        self.killing.is_some_and(|since| since.elapsed() > GIVE_UP)
    }

    /// Kills all that is in the program's group, at once: nothing in it can start another process meanwhile.
    fn kill_group(&mut self) {
        if self.killing.is_none() {
            let _ = killpg(self.pid, Signal::SIGKILL);
            self.killing = Some(WallStopwatch::start());
        }
    }

    /// Buries all children that have ended; those of others become ours. Says whether there are any left.
    fn reap(&mut self) -> bool {
        let (mut has_reaped, mut ending) = (false, None);
        let has_more = loop {
            // All that have ended: signals of several may come as one.
            let status = match waitpid(None, Some(WaitPidFlag::WNOHANG)) {
                Ok(WaitStatus::StillAlive) => break true,
                Ok(status) => status,
                Err(Errno::EINTR) => continue,
                // No children are left (`ECHILD`).
                Err(_) => break false,
            };
            has_reaped = true;
            match status {
                WaitStatus::Exited(pid, code) if pid == self.pid => ending = Some(ExitCause::Code(code)),
                WaitStatus::Signaled(pid, signal, _) if pid == self.pid => {
                    ending = Some(ExitCause::Signal(signal as i32));
                }
                _ => {}
            }
        };
        // After they are buried, as the system counts only children that were waited for.
        if has_reaped {
            self.outbox.send(&Report::Reaped { cpu_us: cpu_of_the_ended_us() });
        }
        // After `Reaped`, so that the CPU time is complete when the end is reported.
        if let Some(how) = ending {
            self.outbox.send(&Report::Ended { how });
            // Without the program nobody reads its children's work.
            self.kill_group();
        }
        has_more
    }

    /// Looks who is there, and whether they keep the limits.
    fn look(&mut self) {
        if self.family.look() {
            self.outbox.send(&Report::Others { pids: self.family.others().collect() });
        }
        if self.killing.is_some() {
            return;
        }
        // The program itself is not among the others.
        let processes = 1 + self.family.others().count();
        let exceeded = if processes > self.limits.processes {
            Some(Exceeded::Processes(processes))
        } else {
            let memory_mb = self.family.memory_bytes(self.limits.memory_mb * 1_000_000) / 1_000_000;
            (memory_mb > self.limits.memory_mb).then_some(Exceeded::MemoryMb(memory_mb))
        };
        if let Some(limit) = exceeded {
            self.kill_group();
            self.outbox.send(&Report::Exceeded { limit });
        }
    }

    /// Waits for an order, the end of a child, or the next look.
    fn wait(&mut self, tick: Duration) {
        let fds = [Some(self.child_ended.as_fd()), self.control.as_ref().map(AsFd::as_fd)];
        let mut fds: Vec<_> = fds.into_iter().flatten().map(|fd| PollFd::new(fd, PollFlags::POLLIN)).collect();
        let found = poll(&mut fds, PollTimeout::try_from(tick).unwrap_or(PollTimeout::ZERO));
        if found.is_ok_and(|count| count > 0) {
            let mut bytes = [0; 256];
            while matches!((&self.child_ended).read(&mut bytes), Ok(1..)) {}
            self.take_orders();
        }
    }

    fn take_orders(&mut self) {
        let Some(control) = &self.control else { return };
        let mut bytes = [0; 256];
        let is_closed = loop {
            match (&*control).read(&mut bytes) {
                Ok(0) => break true,
                Ok(count) => self.orders.extend_from_slice(&bytes[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => break error.kind() != ErrorKind::WouldBlock,
            }
        };
        while let Some(end) = self.orders.iter().position(|&byte| byte == b'\n') {
            let line: Vec<u8> = self.orders.drain(..=end).collect();
            // A command that cannot be understood ends the program, which is the safe side.
            match serde_json::from_slice(&line) {
                // `until_all_are_gone` kills the program once `GRACE` has passed since.
                Ok(SupervisorCommand::End) => self.ending = Some(WallStopwatch::start()),
                Ok(SupervisorCommand::NextRun) => *self.stderr_lines.lock().unwrap_or_else(PoisonError::into_inner) = 0,
                Ok(SupervisorCommand::Kill) | Err(_) => self.kill_group(),
            }
        }
        if is_closed {
            // A closed socket is readable all the time, so it must not be polled any more.
            self.control = None;
            // The simulation is gone, perhaps killed: its programs must not live on.
            if self.ending.is_none() {
                self.kill_group();
            }
        }
    }
}

/// CPU time of all descendants that have ended and were waited for, by us or by their parents.
fn cpu_of_the_ended_us() -> u64 {
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN);
    usage.map_or(0, |usage| (usage.user_time() + usage.system_time()).num_microseconds().unsigned_abs())
}
