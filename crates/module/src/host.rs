//! What a module finds around it: WASI preview 1 (`wasi_snapshot_preview1`) with stdin, stdout and stderr, and no world.
//!
//! Each function is written once, for all engines: it gets the memory of the module that calls it, and what that has left.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rand::Rng;
use wasmparser::ValType;
use wildfire_base::rng::Xoshiro256PlusPlus;

use crate::count::{BYTES_PER_INSTRUCTION, Import};

/// The module that WASI's functions are imported from.
pub const WASI: &str = "wasi_snapshot_preview1";

/// Error numbers of WASI.
const SUCCESS: i32 = 0;
const BAD_DESCRIPTOR: i32 = 8;
const FAULT: i32 = 21;
const INVALID: i32 = 28;
const NOT_SUPPORTED: i32 = 58;

/// The most buffers of one call, as many as Linux takes: a list costs time, and only what is moved counts as instructions.
const MAX_BUFFERS: u32 = 1024;

/// The most bytes of stderr that are kept: the beginning of what a module writes between two answers.
const MAX_STDERR_BYTES: usize = 4096;

/// What a module has around it while it runs.
#[derive(Debug)]
pub struct Host {
    /// What it has not read yet.
    pub input: Vec<u8>,
    /// What it has written to stdout and nobody has taken.
    pub output: Vec<u8>,
    /// The most bytes that `output` may hold.
    pub max_output: usize,
    /// What it has written to stderr since the last answer.
    pub stderr: Vec<u8>,
    pub random: Xoshiro256PlusPlus,
    /// Its name, which is its only argument.
    pub name: String,
}

/// A host, shared by a module and its caller.
#[derive(Clone, Debug)]
pub struct SharedHost(Arc<Mutex<Host>>);

impl SharedHost {
    pub fn new(host: Host) -> Self {
        Self(Arc::new(Mutex::new(host)))
    }

    pub fn lock(&self) -> MutexGuard<'_, Host> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Why a module stops before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopCause {
    /// It reads stdin, and there is nothing; the same call works once there is.
    NeedsInput,
    /// It has called `proc_exit`.
    Exit(i32),
    /// It has written more than an answer may be long.
    Flood,
}

impl fmt::Display for StopCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NeedsInput => f.write_str("waits for input"),
            Self::Exit(code) => write!(f, "exits with code {code}"),
            Self::Flood => f.write_str("writes too much"),
        }
    }
}

impl std::error::Error for StopCause {}

/// Why a function does not do what it was called for.
enum HostError {
    /// It returns an error number.
    Number(i32),
    /// It does not return.
    Stop(StopCause),
}

type Access<T> = Result<T, HostError>;

/// An attempt to use memory that a module does not have.
const OUTSIDE: HostError = HostError::Number(FAULT);

/// A module that calls a function.
pub struct Caller<'a> {
    pub memory: &'a mut [u8],
    /// Instructions that it has left.
    pub left: i64,
    pub host: &'a mut Host,
}

impl Caller<'_> {
    fn read(&self, at: u32, length: u32) -> Access<&[u8]> {
        let from = at as usize;
        self.memory.get(from..from + length as usize).ok_or(OUTSIDE)
    }

    fn write(&mut self, at: u32, bytes: &[u8]) -> Access<()> {
        let from = at as usize;
        self.memory.get_mut(from..from + bytes.len()).ok_or(OUTSIDE)?.copy_from_slice(bytes);
        Ok(())
    }

    fn write_word(&mut self, at: u32, word: u32) -> Access<()> {
        self.write(at, &word.to_le_bytes())
    }

    /// The place and the length of each buffer in a list.
    fn buffers(&self, list: u32, count: u32) -> Access<Vec<(u32, u32)>> {
        if count > MAX_BUFFERS {
            return Err(HostError::Number(INVALID));
        }
        let pairs = self.read(list, count.checked_mul(8).ok_or(OUTSIDE)?)?;
        let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().expect("four bytes"));
        Ok(pairs.chunks_exact(8).map(|pair| (word(&pair[..4]), word(&pair[4..]))).collect())
    }

    /// Counts work on so many bytes as the injected code counts it.
    fn charge(&mut self, bytes: usize) {
        self.left = self.left.saturating_sub_unsigned(bytes as u64 / BYTES_PER_INSTRUCTION);
    }
}

/// What a function does with the numbers that it is called with: at most four matter.
type HostFunction = fn(&mut Caller<'_>, [u32; 4]) -> Access<()>;

fn fd_read(caller: &mut Caller<'_>, [fd, list, count, moved_at]: [u32; 4]) -> Access<()> {
    if fd != 0 {
        return Err(HostError::Number(BAD_DESCRIPTOR));
    }
    // Before anything is moved, so that the same call can be made again.
    if caller.host.input.is_empty() {
        return Err(HostError::Stop(StopCause::NeedsInput));
    }
    let mut moved = 0;
    for (at, length) in caller.buffers(list, count)? {
        let take = (length as usize).min(caller.host.input.len());
        // Nothing is taken that has no place to go.
        caller.read(at, take as u32)?;
        let bytes: Vec<u8> = caller.host.input.drain(..take).collect();
        caller.write(at, &bytes)?;
        moved += take;
    }
    caller.charge(moved);
    caller.write_word(moved_at, moved as u32)
}

fn fd_write(caller: &mut Caller<'_>, [fd, list, count, moved_at]: [u32; 4]) -> Access<()> {
    if fd != 1 && fd != 2 {
        return Err(HostError::Number(BAD_DESCRIPTOR));
    }
    let mut all = 0u32;
    for (at, length) in caller.buffers(list, count)? {
        let host = &*caller.host;
        let room = if fd == 1 { host.max_output - host.output.len() } else { MAX_STDERR_BYTES - host.stderr.len() };
        let bytes = caller.read(at, length)?;
        // Only what is kept is copied: a call that fails later is not charged.
        let taken = bytes[..bytes.len().min(room)].to_vec();
        all = all.checked_add(length).ok_or(OUTSIDE)?;
        let host = &mut *caller.host;
        if fd == 1 { &mut host.output } else { &mut host.stderr }.extend(taken);
        if fd == 1 && length as usize > room {
            return Err(HostError::Stop(StopCause::Flood));
        }
    }
    caller.charge(all as usize);
    caller.write_word(moved_at, all)
}

/// What kind of file a descriptor is: a terminal or a pipe, to which everything may be done that is done here.
fn fd_fdstat_get(caller: &mut Caller<'_>, [fd, at, ..]: [u32; 4]) -> Access<()> {
    const CHARACTER_DEVICE: u8 = 2;
    if fd > 2 {
        return Err(HostError::Number(BAD_DESCRIPTOR));
    }
    // WASI's `fdstat`: the type, flags, and from byte 8 on the rights.
    let mut status = [0u8; 24];
    status[0] = CHARACTER_DEVICE;
    status[8..].fill(0xff);
    caller.write(at, &status)
}

fn args_sizes_get(caller: &mut Caller<'_>, [count, size, ..]: [u32; 4]) -> Access<()> {
    let length = caller.host.name.len() as u32 + 1;
    caller.write_word(count, 1)?;
    caller.write_word(size, length)
}

fn args_get(caller: &mut Caller<'_>, [list, text, ..]: [u32; 4]) -> Access<()> {
    let mut name = caller.host.name.clone().into_bytes();
    name.push(0);
    caller.write_word(list, text)?;
    caller.write(text, &name)
}

fn environ_sizes_get(caller: &mut Caller<'_>, [count, size, ..]: [u32; 4]) -> Access<()> {
    caller.write_word(count, 0)?;
    caller.write_word(size, 0)
}

/// Any clock: it stands still.
fn clock_time_get(caller: &mut Caller<'_>, [_clock, _precision, at, _]: [u32; 4]) -> Access<()> {
    caller.write(at, &0u64.to_le_bytes())
}

fn random_get(caller: &mut Caller<'_>, [at, length, ..]: [u32; 4]) -> Access<()> {
    // Before memory is taken for a length that the module made up.
    caller.read(at, length)?;
    let mut bytes = vec![0; length as usize];
    caller.host.random.fill_bytes(&mut bytes);
    caller.charge(bytes.len());
    caller.write(at, &bytes)
}

fn proc_exit(_caller: &mut Caller<'_>, [code, ..]: [u32; 4]) -> Access<()> {
    Err(HostError::Stop(StopCause::Exit(code.cast_signed())))
}

/// Fills a list of numbers up with zeros.
pub fn four(numbers: impl Iterator<Item = u32>) -> [u32; 4] {
    let mut four = [0; 4];
    four.iter_mut().zip(numbers).for_each(|(to, number)| *to = number);
    four
}

/// A function of WASI as a module imports it.
#[derive(Clone, Copy, Debug)]
pub struct Function(HostFunction);

impl Function {
    /// Returns the function that an import asks for. Those that need a world do nothing and return an error number.
    ///
    /// # Errors
    /// A sentence that names an import of another kind; it reads well after the module's name.
    pub fn of(import: &Import) -> Result<Self, String> {
        use ValType::{I32, I64};
        let Import { module, name, of } = import;
        let Some(of) = of else {
            return Err(format!("imports `{module}.{name}`, which is not a function; only those of `{WASI}` exist"));
        };
        if module != WASI {
            return Err(format!("imports `{module}.{name}`; only functions of `{WASI}` exist"));
        }
        let (parameters, act): (&[ValType], HostFunction) = match name.as_str() {
            "fd_read" => (&[I32; 4], fd_read),
            "fd_write" => (&[I32; 4], fd_write),
            "fd_fdstat_get" => (&[I32; 2], fd_fdstat_get),
            "args_sizes_get" => (&[I32; 2], args_sizes_get),
            "args_get" => (&[I32; 2], args_get),
            "environ_sizes_get" => (&[I32; 2], environ_sizes_get),
            // `environ_sizes_get` reports no variable, so there is nothing to write.
            "environ_get" => (&[I32; 2], |_, _| Ok(())),
            "clock_time_get" => (&[I32, I64, I32], clock_time_get),
            "random_get" => (&[I32; 2], random_get),
            "proc_exit" => (&[I32], proc_exit),
            "sched_yield" => (&[], |_, _| Ok(())),
            "fd_close" => (&[I32], |_, _| Ok(())),
            // wasi-libc scans for preopened folders as it starts, up to the first bad descriptor.
            "fd_prestat_get" => (&[I32; 2], |_, _| Err(HostError::Number(BAD_DESCRIPTOR))),
            // Of an unknown function any parameters will do, as it only returns an error number.
            _ => (of.params(), |_, _| Err(HostError::Number(NOT_SUPPORTED))),
        };
        // `proc_exit` does not return, so it has no error number.
        let results: &[ValType] = if name == "proc_exit" { &[] } else { &[I32] };
        if (of.params(), of.results()) != (parameters, results) {
            return Err(format!("imports `{module}.{name}` with another type than it has"));
        }
        Ok(Self(act))
    }

    /// Does what it does with the numbers of a call; returns the error number that the call returns.
    ///
    /// # Errors
    /// If the call does not return.
    pub fn call(self, caller: &mut Caller<'_>, numbers: [u32; 4]) -> Result<i32, StopCause> {
        match (self.0)(caller, numbers) {
            Ok(()) => Ok(SUCCESS),
            Err(HostError::Number(number)) => Ok(number),
            Err(HostError::Stop(stop)) => Err(stop),
        }
    }
}
