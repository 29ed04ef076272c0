//! A program that runs: lines to it, lines from it, for no longer than it may take, and what it costs.
//!
//! One thread does all: it writes, waits for an answer, hands on what the program writes to stderr, and looks at clocks,
//! in one loop over what is ready. So a program that does not read, does not answer, answers without end or ends is found
//! in the same place, and what is kept of it has a limit.

use std::io::{self, ErrorKind, PipeReader, PipeWriter, Read, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::process::Child;
use std::thread::available_parallelism;
use std::time::Duration;

use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::signal::{Signal, killpg};
use nix::unistd::Pid;

use super::launch::{CpuLimit, Launch, MAX_STDERR_LINES, ProcessError, QueryLimits, say};
use super::process_tree::GroupClock;
use super::sandbox;
use super::supervisor::{self, Exceeded, ExitCause, GRACE, Report, SupervisorCommand};
use wildfire_base::time::wall::WallStopwatch;
use wildfire_base::untrusted::visible;
use wildfire_scenario::MAX_MESSAGE_BYTES;

/// The time in which a supervisor ends what is left of a program, and itself.
const TIDYING: Duration = Duration::from_secs(3);

/// The time within which the end of a program follows on that of its output.
const LAST_BREATH: Duration = Duration::from_secs(1);

/// The shortest time between two looks at the CPU time of a program that is limited.
const MIN_CPU_LOOK: Duration = Duration::from_millis(5);

/// A program that was started. Dropped, it is killed.
#[derive(Debug)]
pub struct Process {
    name: String,
    supervisor: Child,
    control: UnixStream,
    /// The beginning of a report.
    reports: Vec<u8>,
    /// Closed when nothing more is asked.
    to: Option<PipeWriter>,
    from: PipeReader,
    has_closed_output: bool,
    /// What was received and is no line yet.
    received: Vec<u8>,
    /// The first bytes of it in which there is no line end.
    searched: usize,
    scratch: Box<[u8]>,
    clock: Option<GroupClock>,
    fate: ExitReport,
}

/// What a supervisor reported of a program's end.
#[derive(Debug, Default)]
struct ExitReport {
    pid: Option<i32>,
    not_started: Option<String>,
    exceeded: Option<Exceeded>,
    ending: Option<ExitCause>,
    last_stderr: Option<String>,
    /// It closed its output and did not end.
    has_lived_on: bool,
    /// The supervisor is gone, and with it all that it held.
    is_gone: bool,
}

impl Process {
    /// Starts a program. Whether that succeeds shows when it is asked something.
    pub fn start(program: &Launch) -> Result<Self, ProcessError> {
        let cannot = |error: io::Error| ProcessError::crashed(format!("cannot be started: {error}"));
        let (reader, to) = io::pipe().map_err(cannot)?;
        let (from, writer) = io::pipe().map_err(cannot)?;
        let (control, other_end) = UnixStream::pair().map_err(cannot)?;
        // Neither end may block: a program that reads nothing while it writes would hold both.
        for fd in [to.as_fd(), from.as_fd(), control.as_fd()] {
            fcntl(fd, FcntlArg::F_SETFL(OFlag::O_NONBLOCK)).map_err(|error| cannot(error.into()))?;
        }
        let command_line = match program.is_sandboxed {
            true => sandbox::sandboxed(&program.folder, &program.command),
            false => program.command.clone(),
        };
        let mut command = supervisor::command(program.limits, &program.folder, &command_line).map_err(cannot)?;
        // The supervisor's stderr is its control socket; the program's own goes through it.
        command.stdin(reader).stdout(writer).stderr(OwnedFd::from(other_end));
        let supervisor = command.spawn().map_err(|error| {
            ProcessError::crashed(format!("has no supervisor: {}: {error}", command.get_program().to_string_lossy()))
        })?;
        Ok(Self {
            name: program.name.clone(),
            supervisor,
            control,
            reports: Vec::new(),
            to: Some(to),
            from,
            has_closed_output: false,
            received: Vec::new(),
            searched: 0,
            // As much as a pipe holds on Linux, so that one read empties it.
            scratch: vec![0; 1 << 16].into(),
            clock: None,
            fate: ExitReport::default(),
        })
    }

    /// Reads the CPU time that it and its descendants have taken so far; `None` where the system does not tell.
    pub fn cpu(&mut self) -> Option<Duration> {
        self.take_reports();
        let watch = WallStopwatch::start();
        // It may answer before its supervisor has said which process it is.
        while self.clock.is_none() && !self.fate.is_over() && watch.elapsed() < LAST_BREATH {
            let mut report = [PollFd::new(self.control.as_fd(), PollFlags::POLLIN)];
            let left = LAST_BREATH.saturating_sub(watch.elapsed()).as_millis() + 1;
            let _ = poll(&mut report, PollTimeout::from(u16::try_from(left).unwrap_or(u16::MAX)));
            self.take_reports();
        }
        self.clock.as_mut()?.total()
    }

    /// Counts what it writes to stderr again.
    pub fn begin_run(&mut self) {
        self.order(SupervisorCommand::NextRun);
    }

    /// Sends lines and waits for the next line that comes. Whatever goes wrong, the program is killed.
    pub fn exchange(&mut self, message: &[u8], allowance: QueryLimits<'_>) -> Result<Vec<u8>, ProcessError> {
        let answer = self.try_exchange(message, allowance);
        if answer.is_err() {
            self.kill();
        }
        answer
    }

    fn try_exchange(&mut self, message: &[u8], allowance: QueryLimits<'_>) -> Result<Vec<u8>, ProcessError> {
        let watch = WallStopwatch::start();
        let mut unsent = message;
        let mut output_closed: Option<WallStopwatch> = None;
        let mut is_writable = true;
        loop {
            // Sent piece by piece between reads, as a long message fills the pipe.
            if is_writable && !unsent.is_empty() {
                unsent = self.send(unsent);
            }
            if let Some(line) = self.take_line() {
                return Ok(line);
            }
            // Without a bound a program that writes no newline would fill the memory.
            if self.received.len() >= MAX_MESSAGE_BYTES {
                let problem = format!("it is longer than {MAX_MESSAGE_BYTES} bytes");
                return Err(ProcessError::bad_answer(&self.received, &problem));
            }
            // Only now: a line that is here counts, even at the limit.
            let elapsed = watch.elapsed();
            let mut wait = allowance.wall.saturating_sub(elapsed);
            if wait.is_zero() {
                let answer = allowance.answer;
                let limit = allowance.wall.as_secs_f64();
                return Err(ProcessError::timed_out(format!("gave no {answer} within {limit} s")));
            }
            if self.has_closed_output {
                let since = *output_closed.get_or_insert_with(WallStopwatch::start);
                if self.fate.is_over() || since.elapsed() > LAST_BREATH {
                    self.fate.has_lived_on = !self.fate.is_over();
                    // Its supervisor knows how it ended, and what its last words were.
                    self.kill();
                    return Err(ProcessError::crashed(self.fate.message()));
                }
                wait = wait.min(LAST_BREATH);
            }
            // Looked up before each wait, which ends no later than the limit can be reached.
            if let Some(CpuLimit { limit, from }) = allowance.cpu
                && let Some(now) = self.cpu()
            {
                let left = limit.saturating_sub(now.saturating_sub(from));
                if left.is_zero() {
                    let answer = allowance.answer;
                    let limit = limit.as_secs_f64();
                    return Err(ProcessError::timed_out(format!("gave no {answer} within {limit} s of CPU time")));
                }
                // It cannot take more than all that there is.
                let at_once = available_parallelism().map_or(1, |cores| cores.get() as u32);
                wait = wait.min((left / at_once).max(MIN_CPU_LOOK));
            }
            let ready = self.wait(wait, !unsent.is_empty());
            if ready.report {
                self.take_reports();
            }
            // It may have answered and ended: what it said comes first.
            if ready.output || self.fate.is_over() {
                self.receive();
            }
            is_writable = ready.input;
        }
    }

    /// Waits until something is ready, at most for this time.
    fn wait(&self, time: Duration, has_unsent: bool) -> Ready {
        // Nothing more comes from what is closed, which would be ready forever.
        let output = (!self.has_closed_output).then_some((self.from.as_fd(), PollFlags::POLLIN));
        let report = (!self.fate.is_gone).then_some((self.control.as_fd(), PollFlags::POLLIN));
        let input = self.to.as_ref().filter(|_| has_unsent).map(|to| (to.as_fd(), PollFlags::POLLOUT));
        let parts = [output, report, input];
        let mut fds: Vec<_> = parts.iter().flatten().map(|&(fd, flags)| PollFd::new(fd, flags)).collect();
        // Up to the next millisecond, so that the time has passed then.
        let millis = u16::try_from(time.as_millis() + 1).unwrap_or(u16::MAX);
        let _ = poll(&mut fds, PollTimeout::from(millis));
        let mut found = fds.iter().map(|fd| fd.any().unwrap_or(false));
        let [output, report, input] = parts.map(|part| part.is_some() && found.next().unwrap_or(false));
        Ready { output, report, input }
    }

    /// Sends what can be sent at once; returns the rest. To a program that does not listen any more all is sent: what
    /// follows from that shows at its output.
    fn send<'a>(&mut self, message: &'a [u8]) -> &'a [u8] {
        let mut unsent = message;
        while let (Some(to), false) = (&mut self.to, unsent.is_empty()) {
            match to.write(unsent) {
                Ok(written) => unsent = &unsent[written..],
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return unsent,
                Err(_) => {
                    self.to = None;
                    self.has_closed_output = true;
                }
            }
        }
        &[]
    }

    /// Takes in what was written, up to one line more than is wanted.
    fn receive(&mut self) {
        while self.received.len() < MAX_MESSAGE_BYTES {
            match self.from.read(&mut self.scratch) {
                Ok(0) => {
                    self.has_closed_output = true;
                    return;
                }
                Ok(count) => {
                    self.received.extend_from_slice(&self.scratch[..count]);
                    // The pipe is empty, and another read would only say so.
                    if count < self.scratch.len() {
                        return;
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => {
                    // Once the program has ended, only descendants hold the pipe open, and they answer nothing.
                    self.has_closed_output |= error.kind() != ErrorKind::WouldBlock || self.fate.is_over();
                    return;
                }
            }
        }
    }

    fn take_line(&mut self) -> Option<Vec<u8>> {
        let Some(end) = self.received[self.searched..].iter().position(|&byte| byte == b'\n') else {
            self.searched = self.received.len();
            return None;
        };
        let rest = self.received.split_off(self.searched + end + 1);
        self.searched = 0;
        Some(std::mem::replace(&mut self.received, rest))
    }

    /// Takes in what the supervisor reports, and hands on what the program writes to stderr.
    fn take_reports(&mut self) {
        let mut bytes = [0; 4096];
        while !self.fate.is_gone {
            match self.control.read(&mut bytes) {
                Ok(0) => self.fate.is_gone = true,
                Ok(count) => self.reports.extend_from_slice(&bytes[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => self.fate.is_gone = true,
            }
            // A report that is half received waits for its rest.
            let Some(end) = self.reports.iter().rposition(|&byte| byte == b'\n') else { continue };
            let lines: Vec<u8> = self.reports.drain(..=end).collect();
            let reports = lines.split(|&byte| byte == b'\n').filter_map(|line| serde_json::from_slice(line).ok());
            reports.for_each(|report| self.take_report(report));
        }
    }

    fn take_report(&mut self, report: Report) {
        match report {
            Report::Started { pid } => {
                self.fate.pid = Some(pid);
                self.clock = Some(GroupClock::new(pid));
            }
            Report::NotStarted { reason } => self.fate.not_started = Some(reason),
            Report::Others { pids } => self.clock.iter_mut().for_each(|clock| clock.others.clone_from(&pids)),
            Report::Reaped { cpu_us } => {
                self.clock.iter_mut().for_each(|clock| clock.reaped = Duration::from_micros(cpu_us));
            }
            Report::Stderr { line } => {
                say(&self.name, &line);
                // The last words are part of the error message.
                if !line.trim().is_empty() {
                    self.fate.last_stderr = Some(line);
                }
            }
            Report::StderrCut => {
                say(&self.name, &format!("more than {MAX_STDERR_LINES} lines; the rest of this run is left out"));
            }
            Report::LastStderr { line } => self.fate.last_stderr = Some(line),
            Report::Exceeded { limit } => self.fate.exceeded = Some(limit),
            Report::Ended { how } => self.fate.ending = Some(how),
        }
    }

    fn order(&mut self, order: SupervisorCommand) {
        let mut line = serde_json::to_vec(&order).expect("orders are JSON");
        line.push(b'\n');
        // A supervisor that cannot be told takes the end of its orders for the order to stop.
        if self.control.write_all(&line).is_err() {
            let _ = self.control.shutdown(std::net::Shutdown::Write);
        }
    }

    /// Asks it to end, with a last message, and waits until nothing of it is left.
    pub fn end(mut self, message: &[u8]) {
        self.send(message);
        self.to = None;
        self.order(SupervisorCommand::End);
        self.wait_until_gone(GRACE + TIDYING);
    }

    /// Kills it, and waits until nothing of it is left.
    pub fn kill(&mut self) {
        self.order(SupervisorCommand::Kill);
        self.to = None;
        self.wait_until_gone(TIDYING);
    }

    fn wait_until_gone(&mut self, time: Duration) {
        let watch = WallStopwatch::start();
        self.take_reports();
        while !self.fate.is_gone && watch.elapsed() < time {
            // Nobody reads its output any more, which would be ready all the time.
            self.has_closed_output = true;
            self.wait(time.saturating_sub(watch.elapsed()), false);
            self.take_reports();
        }
    }
}

/// What is ready: its output can be read, its input written, a report of its supervisor read.
struct Ready {
    output: bool,
    report: bool,
    input: bool,
}

impl Drop for Process {
    fn drop(&mut self) {
        if !self.fate.is_gone {
            self.kill();
        }
        // A supervisor that was killed itself could not do what it is there for.
        if let (Some(pid), None) = (self.fate.pid, self.fate.ending) {
            let _ = killpg(Pid::from_raw(pid), Signal::SIGKILL);
        }
        if !self.fate.is_gone {
            let _ = self.supervisor.kill();
        }
        let _ = self.supervisor.wait();
    }
}

impl ExitReport {
    fn is_over(&self) -> bool {
        self.is_gone || self.ending.is_some() || self.not_started.is_some()
    }

    /// Words what happened to the program.
    fn message(&self) -> String {
        let ending = self.ending.filter(|_| !self.has_lived_on);
        let what = match (&self.not_started, self.exceeded, ending) {
            (Some(reason), ..) => return format!("cannot be started: {reason}"),
            (_, Some(Exceeded::MemoryMb(found)), _) => format!("took {found} MB of memory and was killed"),
            (_, Some(Exceeded::Processes(found)), _) => format!("ran {found} processes and was killed"),
            (.., Some(ExitCause::Code(code))) => format!("ended with exit code {code}"),
            (.., Some(ExitCause::Signal(signal))) => match Signal::try_from(signal) {
                Ok(name) => format!("was ended by the signal {name}"),
                Err(_) => format!("was ended by the signal {signal}"),
            },
            (None, None, None) if self.pid.is_none() && !self.has_lived_on => {
                "cannot be started: its supervisor has ended".to_owned()
            }
            (None, None, None) => "closed its output".to_owned(),
        };
        match &self.last_stderr {
            Some(line) => format!("{what}; its last words: {}", visible(line.trim())),
            None => what,
        }
    }
}
