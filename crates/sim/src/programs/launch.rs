//! What starts a program or a module, what it may take, and how it fails: the same on every system.

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Duration;

use wildfire_base::untrusted::visible;
use wildfire_module::Module;
use wildfire_planning::PlanFailure;

/// The most lines of stderr that are handed on in a run.
pub const MAX_STDERR_LINES: u64 = 10_000;

/// The most characters of an answer that a message quotes.
const MAX_QUOTED: usize = 200;

/// A program: what starts it, and what it may take.
#[derive(Clone, Debug, PartialEq)]
pub struct Launch {
    /// Stands before its lines on stderr.
    pub name: String,
    /// The executable, absolute or from PATH, and its arguments.
    pub command: Vec<OsString>,
    /// The folder in which it works.
    pub folder: PathBuf,
    /// True if it runs behind walls where the system has them.
    pub is_sandboxed: bool,
    /// Wall time from its start to `ready`, and CPU time if that of queries is limited.
    pub start_limit: Duration,
    /// Wall time of a query.
    pub query_limit: Duration,
    /// CPU time of all its processes in a query.
    pub query_cpu: Option<Duration>,
    /// Failed attempts to start it again after which nobody tries again in a run.
    pub restarts: u32,
    /// Expansions that a query counts for at least.
    pub expansions_per_query: u32,
    /// In place of a command: a module, and the seed of its random bytes.
    pub module: Option<(Module, u64)>,
    /// Instructions of a module from its start to `ready`.
    pub start_instructions: u64,
    /// Instructions of a module in a query, a new start after a failure included.
    pub query_instructions: u64,
    pub limits: ProcessLimits,
}

/// The kinds of failure of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProcessErrorKind {
    TimedOut,
    BudgetSpent,
    Crashed,
    BadAnswer,
}

impl From<ProcessErrorKind> for PlanFailure {
    fn from(kind: ProcessErrorKind) -> Self {
        match kind {
            ProcessErrorKind::TimedOut => Self::TimedOut,
            ProcessErrorKind::BudgetSpent => Self::BudgetSpent,
            ProcessErrorKind::Crashed => Self::Crashed,
            ProcessErrorKind::BadAnswer => Self::BadAnswer,
        }
    }
}

/// A failure of a program, which has been killed since, if it was still there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProcessError {
    pub kind: ProcessErrorKind,
    /// What happened; reads well after the program's name.
    pub message: String,
}

impl ProcessError {
    pub fn crashed(message: impl Into<String>) -> Self {
        Self { kind: ProcessErrorKind::Crashed, message: message.into() }
    }

    /// The program said itself that it cannot play.
    pub fn refused(message: &str) -> Self {
        let quoted: String = message.chars().take(MAX_QUOTED).collect();
        Self { kind: ProcessErrorKind::BadAnswer, message: format!("refuses the field: {}", visible(&quoted)) }
    }

    #[cfg(unix)]
    pub(super) fn timed_out(message: String) -> Self {
        Self { kind: ProcessErrorKind::TimedOut, message }
    }

    /// An answer that is none; quotes its beginning.
    pub fn bad_answer(answer: &[u8], problem: &str) -> Self {
        // A character has four bytes at most.
        let beginning = String::from_utf8_lossy(&answer[..answer.len().min(4 * MAX_QUOTED)]);
        // Escapes count: the problem comes after them and must not be cut off.
        let shown = visible(beginning.trim_end());
        let quoted: String = shown.chars().take(MAX_QUOTED).collect();
        let more = if shown.chars().nth(MAX_QUOTED).is_some() { "…" } else { "" };
        Self { kind: ProcessErrorKind::BadAnswer, message: format!("answered `{quoted}{more}`: {problem}") }
    }
}

/// What a program may take for an answer.
#[derive(Clone, Copy, Debug)]
pub struct QueryLimits<'a> {
    pub wall: Duration,
    pub cpu: Option<CpuLimit>,
    /// Instructions of a module, with those since it was last asked for their number.
    pub instructions: u64,
    /// Names the answer, for messages.
    pub answer: &'a str,
}

/// CPU time that a program may take.
#[derive(Clone, Copy, Debug)]
pub struct CpuLimit {
    pub limit: Duration,
    /// What the program had taken in all when it began to count.
    pub from: Duration,
}

/// The limits that a supervisor watches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProcessLimits {
    /// In megabytes, of all processes together.
    pub memory_mb: u64,
    pub processes: usize,
}

/// Hands on a line of a program's stderr.
pub fn say(name: &str, line: &str) {
    // A line that nobody can read is no reason to stop.
    let _ = writeln!(io::stderr(), "{name}: {}", visible(line));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problem_of_an_answer_stands_after_a_short_quotation_whatever_was_answered() {
        for answer in ["\u{7}".repeat(5000), "ü".repeat(5000), "x".into(), String::new()] {
            let message = ProcessError::bad_answer(answer.as_bytes(), "it is no JSON").message;
            assert!(message.chars().count() < 250 && message.ends_with("`: it is no JSON"), "{message}");
        }
    }
}
