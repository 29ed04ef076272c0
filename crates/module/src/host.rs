//! What a module finds around it: WASI preview 1 (`wasi_snapshot_preview1`) with stdin, stdout and stderr, and no world.

use std::fmt;

use rand::Rng;
use wasmi::{AsContextMut, Caller, Extern, ExternType, Global, Linker, Memory, Store, StoreLimits, Val};
use wildfire_base::rng::Xoshiro256PlusPlus;

use crate::count::{BYTES_PER_INSTRUCTION, GAS};

/// The module that WASI's functions are imported from.
const WASI: &str = "wasi_snapshot_preview1";

/// Error numbers of WASI.
const SUCCESS: i32 = 0;
const BAD_DESCRIPTOR: i32 = 8;
const FAULT: i32 = 21;
const NOT_SUPPORTED: i32 = 58;

/// The most bytes of stderr that are kept: the beginning of what a module writes between two answers.
const MOST_SAID: usize = 4096;

/// What a module has around it while it runs.
pub struct Host {
    pub limits: StoreLimits,
    /// What it has not read yet.
    pub input: Vec<u8>,
    /// What it has written to stdout and nobody has taken.
    pub output: Vec<u8>,
    /// The most bytes that `output` may hold.
    pub most_output: usize,
    /// What it has written to stderr since the last answer.
    pub said: Vec<u8>,
    pub random: Xoshiro256PlusPlus,
    /// A read that waits for input.
    pub waiting: Option<Read>,
    /// Its name, which is its only argument.
    pub name: String,
}

/// A read of stdin: where the list of its buffers is, how many there are, and where the number of bytes goes.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    buffers: u32,
    count: u32,
    moved: u32,
}

/// Why a module stops before its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stop {
    /// It reads stdin, and there is nothing.
    NeedsInput,
    /// It has called `proc_exit`.
    Exit(i32),
    /// It has written more than an answer may be long.
    Flood,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NeedsInput => f.write_str("waits for input"),
            Self::Exit(code) => write!(f, "exits with code {code}"),
            Self::Flood => f.write_str("writes too much"),
        }
    }
}

impl wasmi::errors::HostError for Stop {}

/// An attempt to use memory that a module does not have.
struct Fault;

type Access<T> = Result<T, Fault>;

/// A module's memory and what it has left, seen by the functions that it calls.
struct View<C> {
    context: C,
    memory: Memory,
    gas: Global,
}

impl<'a, 'b> View<&'a mut Caller<'b, Host>> {
    fn of(context: &'a mut Caller<'b, Host>) -> Access<Self> {
        let memory = context.get_export("memory").and_then(Extern::into_memory).ok_or(Fault)?;
        let gas = context.get_export(GAS).and_then(Extern::into_global).ok_or(Fault)?;
        Ok(Self { context, memory, gas })
    }
}

impl<C: AsContextMut<Data = Host>> View<C> {
    fn host<T>(&mut self, act: impl FnOnce(&mut Host) -> T) -> T {
        act(self.context.as_context_mut().data_mut())
    }

    fn read(&self, at: u32, length: u32) -> Access<&[u8]> {
        let from = at as usize;
        self.memory.data(&self.context).get(from..from + length as usize).ok_or(Fault)
    }

    fn write(&mut self, at: u32, bytes: &[u8]) -> Access<()> {
        self.memory.write(&mut self.context, at as usize, bytes).map_err(|_| Fault)
    }

    fn write_word(&mut self, at: u32, word: u32) -> Access<()> {
        self.write(at, &word.to_le_bytes())
    }

    /// The place and the length of each buffer in a list.
    fn buffers(&self, list: u32, count: u32) -> Access<Vec<(u32, u32)>> {
        let pairs = self.read(list, count.checked_mul(8).ok_or(Fault)?)?;
        let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
        Ok(pairs.chunks_exact(8).map(|pair| (word(&pair[..4]), word(&pair[4..]))).collect())
    }

    /// Counts work on so many bytes as the injected code counts it.
    fn charge(&mut self, bytes: usize) {
        if let Val::I64(left) = self.gas.get(&self.context) {
            let rest = left.saturating_sub_unsigned(bytes as u64 / BYTES_PER_INSTRUCTION);
            self.gas.set(&mut self.context, Val::I64(rest)).expect("it is a mutable i64");
        }
    }

    /// Moves input into the buffers of a read.
    fn fill(&mut self, read: Read) -> Access<()> {
        let mut moved = 0;
        for (at, length) in self.buffers(read.buffers, read.count)? {
            let bytes: Vec<u8> = self.host(|host| {
                let take = (length as usize).min(host.input.len());
                host.input.drain(..take).collect()
            });
            self.write(at, &bytes)?;
            moved += bytes.len();
        }
        self.charge(moved);
        self.write_word(read.moved, moved as u32)
    }
}

/// Lets a read that waited go on with the input that has come since; returns what its call returns.
pub fn finish_read(store: &mut Store<Host>, memory: Memory, gas: Global) -> i32 {
    match store.data_mut().waiting.take() {
        Some(read) => errno(View { context: store, memory, gas }.fill(read)),
        None => FAULT,
    }
}

fn errno(access: Access<()>) -> i32 {
    access.map_or(FAULT, |()| SUCCESS)
}

/// Runs what a call does with a module's memory; returns what the call returns.
fn with(mut caller: Caller<'_, Host>, act: impl FnOnce(&mut View<&mut Caller<'_, Host>>) -> Access<()>) -> i32 {
    errno(View::of(&mut caller).and_then(|mut view| act(&mut view)))
}

fn fd_read(mut caller: Caller<'_, Host>, fd: i32, buffers: u32, count: u32, moved: u32) -> Result<i32, wasmi::Error> {
    if fd != 0 {
        return Ok(BAD_DESCRIPTOR);
    }
    let read = Read { buffers, count, moved };
    if caller.data().input.is_empty() {
        caller.data_mut().waiting = Some(read);
        return Err(wasmi::Error::host(Stop::NeedsInput));
    }
    Ok(with(caller, |view| view.fill(read)))
}

fn fd_write(mut caller: Caller<'_, Host>, fd: i32, buffers: u32, count: u32, moved: u32) -> Result<i32, wasmi::Error> {
    if fd != 1 && fd != 2 {
        return Ok(BAD_DESCRIPTOR);
    }
    let written = View::of(&mut caller).and_then(|mut view| {
        let mut all = 0u32;
        for (at, length) in view.buffers(buffers, count)? {
            let bytes = view.read(at, length)?.to_vec();
            all = all.checked_add(length).ok_or(Fault)?;
            let fits = view.host(|host| {
                let (to, most) =
                    if fd == 1 { (&mut host.output, host.most_output) } else { (&mut host.said, MOST_SAID) };
                let room = most - to.len();
                to.extend(bytes.iter().take(room));
                bytes.len() <= room
            });
            if fd == 1 && !fits {
                return Ok(None);
            }
        }
        view.charge(all as usize);
        view.write_word(moved, all)?;
        Ok(Some(()))
    });
    match written {
        Ok(Some(())) => Ok(SUCCESS),
        Ok(None) => Err(wasmi::Error::host(Stop::Flood)),
        Err(Fault) => Ok(FAULT),
    }
}

/// What kind of file a descriptor is: a terminal or a pipe, to which everything may be done that is done here.
fn fd_fdstat_get(caller: Caller<'_, Host>, fd: i32, at: u32) -> i32 {
    const CHARACTER_DEVICE: u8 = 2;
    if !(0..=2).contains(&fd) {
        return BAD_DESCRIPTOR;
    }
    with(caller, |view| {
        let mut status = [0u8; 24];
        status[0] = CHARACTER_DEVICE;
        status[8..].fill(0xff);
        view.write(at, &status)
    })
}

fn args_sizes_get(caller: Caller<'_, Host>, count: u32, size: u32) -> i32 {
    with(caller, |view| {
        let length = view.host(|host| host.name.len()) as u32 + 1;
        view.write_word(count, 1)?;
        view.write_word(size, length)
    })
}

fn args_get(caller: Caller<'_, Host>, list: u32, text: u32) -> i32 {
    with(caller, |view| {
        let mut name = view.host(|host| host.name.clone().into_bytes());
        name.push(0);
        view.write_word(list, text)?;
        view.write(text, &name)
    })
}

fn environ_sizes_get(caller: Caller<'_, Host>, count: u32, size: u32) -> i32 {
    with(caller, |view| {
        view.write_word(count, 0)?;
        view.write_word(size, 0)
    })
}

/// Any clock: it stands still.
fn clock_time_get(caller: Caller<'_, Host>, _clock: i32, _precision: i64, at: u32) -> i32 {
    with(caller, |view| view.write(at, &0u64.to_le_bytes()))
}

fn random_get(caller: Caller<'_, Host>, at: u32, length: u32) -> i32 {
    with(caller, |view| {
        view.read(at, length)?;
        let mut bytes = vec![0; length as usize];
        view.host(|host| host.random.fill_bytes(&mut bytes));
        view.charge(bytes.len());
        view.write(at, &bytes)
    })
}

fn proc_exit(_caller: Caller<'_, Host>, code: i32) -> Result<(), wasmi::Error> {
    Err(wasmi::Error::host(Stop::Exit(code)))
}

/// Gives a module the functions of WASI that it imports. Those that need a world do nothing and return an error number.
///
/// # Errors
/// A sentence that names an import of another kind; it reads well after the module's name.
pub fn link(linker: &mut Linker<Host>, module: &wasmi::Module) -> Result<(), String> {
    for import in module.imports() {
        let (from, name) = (import.module(), import.name());
        let ExternType::Func(of) = import.ty() else {
            return Err(format!("imports `{from}.{name}`, which is no function; only those of `{WASI}` are there"));
        };
        if from != WASI {
            return Err(format!("imports `{from}.{name}`; only functions of `{WASI}` are there"));
        }
        match name {
            "fd_read" => linker.func_wrap(WASI, name, fd_read),
            "fd_write" => linker.func_wrap(WASI, name, fd_write),
            "fd_fdstat_get" => linker.func_wrap(WASI, name, fd_fdstat_get),
            "args_sizes_get" => linker.func_wrap(WASI, name, args_sizes_get),
            "args_get" => linker.func_wrap(WASI, name, args_get),
            "environ_sizes_get" => linker.func_wrap(WASI, name, environ_sizes_get),
            "environ_get" => linker.func_wrap(WASI, name, |_: i32, _: i32| SUCCESS),
            "clock_time_get" => linker.func_wrap(WASI, name, clock_time_get),
            "random_get" => linker.func_wrap(WASI, name, random_get),
            "proc_exit" => linker.func_wrap(WASI, name, proc_exit),
            "sched_yield" => linker.func_wrap(WASI, name, || SUCCESS),
            "fd_close" => linker.func_wrap(WASI, name, |_: i32| SUCCESS),
            "fd_prestat_get" => linker.func_wrap(WASI, name, |_: i32, _: i32| BAD_DESCRIPTOR),
            _ => linker.func_new(WASI, name, of.clone(), |_, _, results| {
                results.iter_mut().for_each(|result| *result = Val::I32(NOT_SUPPORTED));
                Ok(())
            }),
        }
        .map_err(|error| format!("imports `{from}.{name}` twice: {error}"))?;
    }
    Ok(())
}
