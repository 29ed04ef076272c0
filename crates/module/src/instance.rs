//! A module that runs: it is asked a line, runs until it waits for the next one, and what it wrote is the answer.

use std::fmt;
use std::sync::Arc;

use wasmi::{Config, Engine, Extern, Func, Global, Linker, Memory, ResumableCall, ResumableCallHostTrap};
use wasmi::{Store, StoreLimitsBuilder, TrapCode, Val};
use wildfire_base::rng;

use crate::count::{GAS, counted};
use crate::host::{self, Host, Stop};

/// The most calls of functions inside of each other.
const DEEPEST: usize = 10_000;

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
    engine: Engine,
    module: Arc<wasmi::Module>,
    name: String,
    limits: Limits,
}

impl Module {
    /// Reads a module from the bytes of its file.
    ///
    /// # Errors
    /// A sentence that says what is wrong with it; it reads well after the module's name.
    pub fn new(name: &str, bytes: &[u8], limits: Limits) -> Result<Self, String> {
        let counted = counted(bytes)?;
        let mut config = Config::default();
        config.set_max_recursion_depth(DEEPEST);
        let engine = Engine::new(&config);
        let module = wasmi::Module::new(&engine, &counted).map_err(|error| format!("cannot be compiled: {error}"))?;
        let module = Self { engine, module: Arc::new(module), name: name.to_owned(), limits };
        let exports = |name, is_it: fn(&wasmi::ExternType) -> bool| {
            module.module.get_export(name).is_some_and(|export| is_it(&export))
        };
        if !exports("_start", |export| export.func().is_some()) {
            return Err("has no function `_start`; build it as a command, not as a library".to_owned());
        }
        if !exports("memory", |export| export.memory().is_some()) {
            return Err("does not export its `memory`".to_owned());
        }
        // What is wrong with its imports and its memory shows when it is put together.
        Instance::new(&module, 0)?;
        Ok(module)
    }
}

impl PartialEq for Module {
    /// Whether it is the same compiled module.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.module, &other.module)
    }
}

/// An answer, and what it cost.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
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

/// A module that was started.
pub struct Instance {
    store: Store<Host>,
    memory: Memory,
    gas: Global,
    state: State,
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Instance").field("name", &self.store.data().name).finish_non_exhaustive()
    }
}

/// Where an instance is between two answers.
enum State {
    /// It has not run yet.
    New(Func),
    /// It waits for input.
    Waiting(ResumableCallHostTrap),
    /// It has failed.
    Over,
}

impl Instance {
    /// Prepares a module to run; all its random bytes follow from the seed.
    ///
    /// # Errors
    /// If its memory is larger than it may be, or its data do not fit into it.
    pub fn new(module: &Module, seed: u64) -> Result<Self, String> {
        let limits = StoreLimitsBuilder::new().memory_size(module.limits.memory).table_elements(1 << 20).build();
        let host = Host {
            limits,
            input: Vec::new(),
            output: Vec::new(),
            most_output: module.limits.answer,
            said: Vec::new(),
            random: rng::stream(seed, "module"),
            waiting: None,
            name: module.name.clone(),
        };
        let mut store = Store::new(&module.engine, host);
        store.limiter(|host| &mut host.limits);
        let mut linker = Linker::new(&module.engine);
        host::link(&mut linker, &module.module)?;
        let cannot = |error: wasmi::Error| format!("cannot be started: {error}");
        let instance = linker.instantiate_and_start(&mut store, &module.module).map_err(cannot)?;
        let export = |name| instance.get_export(&store, name);
        let (Some(Extern::Func(start)), Some(Extern::Memory(memory)), Some(Extern::Global(gas))) =
            (export("_start"), export("memory"), export(GAS))
        else {
            unreachable!("`Module::new` has looked");
        };
        Ok(Self { store, memory, gas, state: State::New(start) })
    }

    /// Gives a module a line and lets it run until it reads the next one; returns the line that it wrote.
    ///
    /// # Errors
    /// If it runs out of instructions, traps, ends, writes more than it may, or waits without having answered.
    pub fn exchange(&mut self, line: &[u8], budget: u64) -> Result<Answer, Failure> {
        let budget = i64::try_from(budget).unwrap_or(i64::MAX);
        self.gas.set(&mut self.store, Val::I64(budget)).expect("it is a mutable i64");
        self.store.data_mut().input.extend_from_slice(line);
        self.store.data_mut().said.clear();
        let run = match std::mem::replace(&mut self.state, State::Over) {
            State::New(start) => start.call_resumable(&mut self.store, &[], &mut []),
            State::Waiting(call) => {
                let result = host::finish_read(&mut self.store, self.memory, self.gas);
                call.resume(&mut self.store, &[Val::I32(result)], &mut [])
            }
            State::Over => return Err(self.failure(FailureKind::Crashed, "has failed before".to_owned(), 0)),
        };
        let left = match self.gas.get(&self.store) {
            Val::I64(left) => left,
            _ => unreachable!("it is an i64"),
        };
        let instructions = budget.saturating_sub(left).unsigned_abs();
        if left < 0 {
            let message = format!("ran more than {budget} instructions");
            return Err(self.failure(FailureKind::BudgetSpent, message, instructions));
        }
        let (kind, message) = match run {
            Ok(ResumableCall::HostTrap(call)) => match call.host_error().downcast_ref::<Stop>() {
                Some(Stop::NeedsInput) => {
                    let output = &mut self.store.data_mut().output;
                    match output.iter().position(|&byte| byte == b'\n') {
                        Some(end) => {
                            let rest = output.split_off(end + 1);
                            let line = std::mem::replace(output, rest);
                            self.state = State::Waiting(call);
                            return Ok(Answer { line, instructions });
                        }
                        None => (FailureKind::BadAnswer, "reads on without having answered".to_owned()),
                    }
                }
                Some(Stop::Exit(code)) => (FailureKind::Crashed, format!("ended with exit code {code}")),
                Some(Stop::Flood) | None => {
                    (FailureKind::BadAnswer, format!("wrote more than {} bytes", self.store.data().most_output))
                }
            },
            Ok(_) => (FailureKind::Crashed, "ended".to_owned()),
            Err(error) => match error.as_trap_code() {
                Some(TrapCode::StackOverflow) => (FailureKind::Crashed, "nests its calls too deeply".to_owned()),
                Some(code) => (FailureKind::Crashed, format!("trapped: {code}")),
                None => (FailureKind::Crashed, format!("trapped: {error}")),
            },
        };
        Err(self.failure(kind, message, instructions))
    }

    /// What it has written to stderr since it was last given a line: the beginning, if that is long.
    pub fn said(&self) -> &[u8] {
        &self.store.data().said
    }

    /// Adds the last line that a module wrote to stderr to what happened to it.
    fn failure(&self, kind: FailureKind, message: String, instructions: u64) -> Failure {
        let said = String::from_utf8_lossy(&self.store.data().said);
        let message = match said.lines().rev().find(|line| !line.trim().is_empty()) {
            Some(line) => format!("{message}; its last message: {}", wildfire_base::untrusted::visible(line.trim())),
            None => message,
        };
        Failure { kind, message, instructions }
    }
}
