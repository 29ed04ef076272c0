//! A module that runs: it is asked a line, runs until it waits for the next one, and what it wrote is the answer.

use std::sync::Arc;

use wildfire_base::rng;

#[cfg(feature = "wasmtime")]
use crate::compiler;
use crate::count::{Counted, counted};
use crate::host::{Function, Host, SharedHost, StopCause};
use crate::interpreter;

/// The most elements of a module's tables.
pub const MAX_TABLE_ELEMENTS: usize = 1 << 20;

/// What runs modules. All engines give the same answers and the same counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// The interpreter `wasmi`.
    Interpreter,
    /// The compiler `wasmtime`.
    #[cfg(feature = "wasmtime")]
    Compiler,
}

impl Engine {
    /// The engines that are built in.
    pub const ALL: &[Self] = &[
        Self::Interpreter,
        #[cfg(feature = "wasmtime")]
        Self::Compiler,
    ];
}

impl Default for Engine {
    /// The fastest that is built in.
    fn default() -> Self {
        Self::ALL[Self::ALL.len() - 1]
    }
}

/// What a module may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of its memory.
    pub memory: usize,
    /// Bytes of an answer, its line end included.
    pub answer: usize,
}

/// A module, counted and compiled: made once, started as often as there are runs.
#[derive(Clone, Debug)]
pub struct Module {
    compiled: Arc<Compiled>,
    name: String,
    limits: Limits,
}

#[derive(Debug)]
enum Compiled {
    Interpreter(interpreter::Compiled),
    #[cfg(feature = "wasmtime")]
    Compiler(compiler::Compiled),
}

#[derive(Debug)]
enum Running {
    Interpreter(interpreter::Running),
    #[cfg(feature = "wasmtime")]
    Compiler(compiler::Running),
}

/// Checks the bytes of a module's file without compiling it.
///
/// # Errors
/// A sentence that says what is wrong with it; it reads well after the module's name.
pub fn check(bytes: &[u8], limits: Limits) -> Result<(), String> {
    checked(bytes, limits).map(drop)
}

fn checked(bytes: &[u8], limits: Limits) -> Result<Counted, String> {
    let counted = counted(bytes)?;
    counted.imports.iter().try_for_each(|import| Function::of(import).map(drop))?;
    if !counted.has_start {
        return Err("has no function `_start` without parameters and results; build it as a command".to_owned());
    }
    let Some(memory) = counted.memory else { return Err("does not export its `memory`".to_owned()) };
    if memory > limits.memory as u64 {
        let initial_mb = memory as f64 / 1e6;
        let max = limits.memory as f64 / 1e6;
        return Err(format!("begins with {initial_mb:.1} MB of memory; at most {max} MB are allowed"));
    }
    Ok(counted)
}

impl Module {
    /// Reads a module from the bytes of its file. Its name is the first argument that it sees.
    ///
    /// # Errors
    /// Those of [`check`], and if its data do not fit into its memory.
    pub fn new(engine: Engine, name: &str, bytes: &[u8], limits: Limits) -> Result<Self, String> {
        let counted = checked(bytes, limits)?;
        let compiled = match engine {
            Engine::Interpreter => Compiled::Interpreter(interpreter::Compiled::new(&counted)?),
            #[cfg(feature = "wasmtime")]
            Engine::Compiler => Compiled::Compiler(compiler::Compiled::new(&counted)?),
        };
        let module = Self { compiled: Arc::new(compiled), name: name.to_owned(), limits };
        // Whether its data fit into its memory shows when it is put together.
        ModuleInstance::new(&module, 0)?;
        Ok(module)
    }
}

impl PartialEq for Module {
    /// Whether it is the same compiled module.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.compiled, &other.compiled)
    }
}

/// An answer, and what it cost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleAnswer {
    /// The line, with its end.
    pub line: Vec<u8>,
    /// Instructions since the answer before.
    pub instructions: u64,
}

/// The kinds of failure of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailureKind {
    /// It ran more instructions than it may.
    BudgetSpent,
    /// It trapped, or ended.
    Crashed,
    /// It wrote too much, or nothing.
    BadAnswer,
}

/// A module that gave no answer. It cannot be asked again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    pub kind: FailureKind,
    /// What happened; reads well after the module's name.
    pub message: String,
    /// Instructions since the answer before.
    pub instructions: u64,
}

/// Why a module runs no longer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reason {
    Stop(StopCause),
    /// `_start` has returned.
    End,
    /// It has trapped; in the words of the WebAssembly specification.
    Trap(String),
}

/// A module that has stopped running, for good unless it needs input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pause {
    pub reason: Reason,
    /// Instructions that it has left; negative if they were spent.
    pub left: i64,
    /// Slots for nested calls that it has left; negative if they were spent.
    pub slots: i32,
}

/// A module that was started.
#[derive(Debug)]
pub struct ModuleInstance {
    host: SharedHost,
    running: Running,
    has_failed: bool,
    max_output: usize,
}

impl ModuleInstance {
    /// Prepares a module to run; all its random bytes follow from the seed.
    ///
    /// # Errors
    /// If its tables are too large, or its data do not fit into its memory.
    pub fn new(module: &Module, seed: u64) -> Result<Self, String> {
        let host = SharedHost::new(Host {
            input: Vec::new(),
            output: Vec::new(),
            max_output: module.limits.answer,
            stderr: Vec::new(),
            random: rng::stream(seed, "module"),
            name: module.name.clone(),
        });
        let running = match &*module.compiled {
            Compiled::Interpreter(compiled) => compiled.start(host.clone(), module.limits).map(Running::Interpreter),
            #[cfg(feature = "wasmtime")]
            Compiled::Compiler(compiled) => compiled.start(host.clone(), module.limits).map(Running::Compiler),
        };
        let running = running.map_err(|message| format!("cannot be started: {message}"))?;
        Ok(Self { host, running, has_failed: false, max_output: module.limits.answer })
    }

    /// Gives a module a line and lets it run until it reads the next one; returns the line that it wrote. It may run
    /// `budget` instructions, of which `spent` are gone already.
    ///
    /// # Errors
    /// If it runs out of instructions, traps, ends, writes more than it may, or waits without having answered.
    pub fn exchange(&mut self, line: &[u8], budget: u64, spent: u64) -> Result<ModuleAnswer, Failure> {
        if self.has_failed {
            return Err(self.failure(FailureKind::Crashed, "has failed before".to_owned(), 0));
        }
        // Unlocked before the module runs, as functions of the host lock it too.
        {
            let mut host = self.host.lock();
            host.input.extend_from_slice(line);
            host.stderr.clear();
        }
        let may = i64::try_from(budget.saturating_sub(spent)).unwrap_or(i64::MAX);
        let Pause { reason, left, slots } = match &mut self.running {
            Running::Interpreter(running) => running.run(may),
            #[cfg(feature = "wasmtime")]
            Running::Compiler(running) => running.run(may),
        };
        // The sequence that would have taken more than there was did not run.
        let instructions = may.saturating_sub(left.max(0)).unsigned_abs();
        let (kind, message) = match reason {
            // A trap of the injected counter looks like any other, so what is left is asked first.
            _ if left < 0 => (FailureKind::BudgetSpent, format!("ran more than {budget} instructions")),
            _ if slots < 0 => (FailureKind::Crashed, "nests its calls too deeply".to_owned()),
            Reason::Stop(StopCause::NeedsInput) => {
                // A module may write its answer in parts: it is complete only when the next line is read.
                let output = &mut self.host.lock().output;
                if let Some(end) = output.iter().position(|&byte| byte == b'\n') {
                    // What follows its line is the beginning of the next answer.
                    let rest = output.split_off(end + 1);
                    return Ok(ModuleAnswer { line: std::mem::replace(output, rest), instructions });
                }
                (FailureKind::BadAnswer, "reads on without having answered".to_owned())
            }
            Reason::Stop(StopCause::Exit(code)) => (FailureKind::Crashed, format!("ended with exit code {code}")),
            Reason::Stop(StopCause::Flood) => {
                (FailureKind::BadAnswer, format!("wrote more than {} bytes", self.max_output))
            }
            Reason::End => (FailureKind::Crashed, "ended".to_owned()),
            Reason::Trap(message) => (FailureKind::Crashed, format!("trapped: {message}")),
        };
        Err(self.failure(kind, message, instructions))
    }

    /// Returns what it has written to stderr since it was last given a line: the beginning, if that is long.
    pub fn stderr(&self) -> Vec<u8> {
        self.host.lock().stderr.clone()
    }

    /// Adds the last line that a module wrote to stderr to what happened to it, and ends it.
    fn failure(&mut self, kind: FailureKind, message: String, instructions: u64) -> Failure {
        self.has_failed = true;
        let host = self.host.lock();
        let stderr = String::from_utf8_lossy(&host.stderr);
        let message = match stderr.lines().rev().find(|line| !line.trim().is_empty()) {
            Some(line) => format!("{message}; its last message: {}", wildfire_base::untrusted::visible(line.trim())),
            None => message,
        };
        Failure { kind, message, instructions }
    }
}
