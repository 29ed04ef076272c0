//! What answers the lines of the protocol: a process of its own, or a module inside of this one.

use std::time::Duration;

use wildfire_module::{Failure, FailureKind, ModuleInstance};

use super::launch::{Launch, MAX_STDERR_LINES, ProcessError, ProcessErrorKind, QueryLimits, say};
use super::process::Process;
use super::protocol::ToProgram;

/// Something that answers a line with a line.
#[derive(Debug)]
pub enum Backend {
    Process(Box<Process>),
    Module(Box<WasmInstance>),
}

/// A module that was started.
#[derive(Debug)]
pub struct WasmInstance {
    name: String,
    instance: ModuleInstance,
    /// Instructions that nobody has counted yet.
    instructions: u64,
    /// Lines of stderr that were passed on.
    stderr_lines: u64,
}

impl Backend {
    /// Starts a program or a module. Whether that succeeds shows when it is asked something.
    pub fn start(program: &Launch) -> Result<Self, ProcessError> {
        match &program.module {
            None => Ok(Self::Process(Box::new(Process::start(program)?))),
            Some((module, seed)) => {
                let instance = ModuleInstance::new(module, *seed).map_err(ProcessError::crashed)?;
                Ok(Self::Module(Box::new(WasmInstance {
                    name: program.name.clone(),
                    instance,
                    instructions: 0,
                    stderr_lines: 0,
                })))
            }
        }
    }

    /// Sends a line and waits for the next line that comes. Whatever goes wrong, it answers no more.
    pub fn exchange(&mut self, message: &[u8], allowance: QueryLimits<'_>) -> Result<Vec<u8>, ProcessError> {
        match self {
            Self::Process(process) => process.exchange(message, allowance),
            Self::Module(guest) => guest.exchange(message, allowance.instructions),
        }
    }

    /// Reads the CPU time that a process and its descendants have taken so far; `None` of a module, whose time is that of
    /// the thread that asks, and where the system does not tell.
    pub fn cpu(&mut self) -> Option<Duration> {
        match self {
            Self::Process(process) => process.cpu(),
            Self::Module(_) => None,
        }
    }

    /// Returns the instructions of a module since the last call; `None` of a process, whose nobody counts.
    pub fn take_instructions(&mut self) -> Option<u64> {
        match self {
            Self::Process(_) => None,
            Self::Module(guest) => Some(std::mem::take(&mut guest.instructions)),
        }
    }

    /// Prepares it to play in another run.
    pub fn begin_run(&mut self) {
        match self {
            Self::Process(process) => process.begin_run(),
            Self::Module(guest) => guest.stderr_lines = 0,
        }
    }

    /// Says goodbye, and waits until nothing of it is left.
    pub fn end(self) {
        if let Self::Process(process) = self {
            process.end(&ToProgram::End.line());
        }
    }

    /// Kills it, and waits until nothing of it is left.
    pub fn kill(&mut self) {
        if let Self::Process(process) = self {
            process.kill();
        }
    }
}

impl WasmInstance {
    fn exchange(&mut self, message: &[u8], budget: u64) -> Result<Vec<u8>, ProcessError> {
        let answer = self.instance.exchange(message, budget, self.instructions);
        // Shown even if the query failed: it often says why.
        for line in String::from_utf8_lossy(&self.instance.stderr()).lines() {
            if self.stderr_lines < MAX_STDERR_LINES {
                say(&self.name, line);
            }
            self.stderr_lines += 1;
        }
        let (instructions, answer) = match answer {
            Ok(answer) => (answer.instructions, Ok(answer.line)),
            Err(Failure { kind, message, instructions }) => {
                let kind = match kind {
                    FailureKind::BudgetSpent => ProcessErrorKind::BudgetSpent,
                    FailureKind::Crashed => ProcessErrorKind::Crashed,
                    FailureKind::BadAnswer => ProcessErrorKind::BadAnswer,
                };
                (instructions, Err(ProcessError { kind, message }))
            }
        };
        // Failed queries count too, so that failing is not cheap.
        self.instructions = self.instructions.saturating_add(instructions);
        answer
    }
}
