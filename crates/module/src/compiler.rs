//! The engine `wasmtime`: it compiles a module to machine code, and takes the place of the interpreter where it is built in.
//!
//! It cannot resume a call that a function of the host has ended. So a module runs on a stack of its own, as a future that
//! owns its store; a read with no input suspends that once, and the next question polls it again.

use std::fmt;
use std::future::poll_fn;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use wasmtime::{AsContextMut, Config, Engine, Error, Extern, Global, InstancePre, Linker, Memory, Store, StoreLimits};
use wasmtime::{StoreLimitsBuilder, Trap, Val};

use crate::count::{Counted, GAS, MAX_SLOTS, SLOTS};
use crate::host::{Caller, Function, SharedHost, StopCause, WASI, four};
use crate::instance::{Limits, MAX_TABLE_ELEMENTS, Pause, Reason};

/// Bytes of native stack for all slots: a value that is kept over a call takes eight bytes, and where the compiler keeps
/// others too, they are few.
const STACK_BYTES: usize = 8 * size_of::<u64>() * MAX_SLOTS as usize;

/// Bytes of it that are left for functions of the host.
const HOST_STACK_BYTES: usize = 1 << 20;

/// A compiled module with its imports.
pub struct Compiled(InstancePre<StoreData>);

impl fmt::Debug for Compiled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Compiled").finish_non_exhaustive()
    }
}

/// What a store holds.
struct StoreData {
    limits: StoreLimits,
    host: SharedHost,
    /// Set as soon as there is an instance; nothing runs before.
    parts: Option<HostParts>,
    /// What is handed over when a module stops, and when it goes on.
    desk: InstructionCounter,
}

/// Instructions: those that a module may run next, and then those that it has left with its slots.
type InstructionCounter = Arc<Mutex<(i64, i32)>>;

/// What functions of the host need of an instance.
#[derive(Clone, Copy)]
struct HostParts {
    memory: Memory,
    gas: Global,
    slots: Global,
}

impl Compiled {
    pub fn new(counted: &Counted) -> Result<Self, String> {
        let mut config = Config::new();
        // Wasmtime demands that the whole stack be larger than the part for WebAssembly.
        config.async_stack_size(STACK_BYTES + HOST_STACK_BYTES).max_wasm_stack(STACK_BYTES);
        // Messages name the trap alone, so frames would be collected for nothing.
        config.wasm_backtrace_max_frames(None);
        let cannot = |error: Error| format!("cannot be compiled: {error}");
        let engine = Engine::new(&config).map_err(cannot)?;
        let module = wasmtime::Module::new(&engine, &counted.bytes).map_err(cannot)?;
        let mut linker = Linker::new(&engine);
        // Counting keeps the imports and their order, so the two lists match.
        for (import, requested) in counted.imports.iter().zip(module.imports()) {
            let function = Function::of(import)?;
            // Anything else was refused by `Function::of`.
            let of = requested.ty().func().expect("it is a function").clone();
            let added = linker.func_new_async(WASI, &import.name, of, move |mut caller, numbers, results| {
                // No function reads an i64, such as the precision of a clock, so it may become 0.
                let numbers = four(numbers.iter().map(|number| number.i32().unwrap_or_default().cast_unsigned()));
                Box::new(async move {
                    // A read without input suspends here, and is tried again once the module is polled with some.
                    let number = loop {
                        match call(&mut caller, function, numbers) {
                            Err(StopCause::NeedsInput) => wait(&mut caller).await,
                            number => break number?,
                        }
                    };
                    results.iter_mut().for_each(|result| *result = Val::I32(number));
                    Ok(())
                })
            });
            // A name that is defined already is the only reason for the linker to refuse it.
            added.map_err(|_| format!("imports `{}` twice", import.name))?;
        }
        Ok(Self(linker.instantiate_pre(&module).map_err(cannot)?))
    }

    pub fn start(&self, host: SharedHost, limits: Limits) -> Result<Running, String> {
        let limits = StoreLimitsBuilder::new().memory_size(limits.memory).table_elements(MAX_TABLE_ELEMENTS).build();
        let desk = InstructionCounter::default();
        let data = StoreData { limits, host, parts: None, desk: Arc::clone(&desk) };
        let mut store = Store::new(self.0.module().engine(), data);
        store.limiter(|data| &mut data.limits);
        // Modules with a start function are refused, so instantiation runs no code and never waits.
        let mut instantiation = Box::pin(self.0.instantiate_async(&mut store));
        let instance = match poll_once(instantiation.as_mut()) {
            Poll::Ready(instance) => instance.map_err(|error| message_of(&error))?,
            Poll::Pending => unreachable!("nothing waits before `_start`"),
        };
        // It borrows the store.
        drop(instantiation);
        let start = instance.get_typed_func::<(), ()>(&mut store, "_start").map_err(|error| error.to_string())?;
        let mut export = |name| instance.get_export(&mut store, name);
        let (Some(Extern::Memory(memory)), Some(Extern::Global(gas)), Some(Extern::Global(slots))) =
            (export("memory"), export(GAS), export(SLOTS))
        else {
            unreachable!("its exports were looked at");
        };
        store.data_mut().parts = Some(HostParts { memory, gas, slots });
        let call = async move {
            // The first poll comes from `run`, which has put the budget on the desk by then.
            take_budget(&mut store);
            let result = start.call_async(&mut store, ()).await;
            leave_rest(&mut store);
            match result {
                Ok(()) => Reason::End,
                // A stop of the host comes back as the engine's error, like a trap.
                Err(error) => match error.downcast_ref() {
                    Some(&stop) => Reason::Stop(stop),
                    None => Reason::Trap(message_of(&error)),
                },
            }
        };
        Ok(Running { call: Mutex::new(Box::pin(call)), desk })
    }
}

/// An instance of a module.
pub struct Running {
    /// Nobody polls it from two threads; a mutex says so.
    call: Mutex<Pin<Box<dyn Future<Output = Reason> + Send>>>,
    desk: InstructionCounter,
}

impl fmt::Debug for Running {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Running").finish_non_exhaustive()
    }
}

impl Running {
    /// Runs until there is no input left, or until its end, with so many instructions.
    pub fn run(&mut self, budget: i64) -> Pause {
        *lock(&self.desk) = (budget, 0);
        let call = self.call.get_mut().unwrap_or_else(PoisonError::into_inner);
        let reason = match poll_once(call.as_mut()) {
            Poll::Ready(reason) => reason,
            Poll::Pending => Reason::Stop(StopCause::NeedsInput),
        };
        let (left, slots) = *lock(&self.desk);
        Pause { reason, left, slots }
    }
}

fn lock(desk: &InstructionCounter) -> std::sync::MutexGuard<'_, (i64, i32)> {
    desk.lock().unwrap_or_else(PoisonError::into_inner)
}

fn poll_once<T>(future: Pin<&mut (impl Future<Output = T> + ?Sized)>) -> Poll<T> {
    future.poll(&mut Context::from_waker(Waker::noop()))
}

/// Gives an instance the instructions that it may run next.
fn take_budget(mut context: impl AsContextMut<StoreData = StoreData>) {
    let view = context.as_context();
    let parts = view.data().parts;
    let budget = lock(&view.data().desk).0;
    let gas = parts.expect("there is an instance").gas;
    gas.set(&mut context, Val::I64(budget)).expect("it is a mutable i64");
}

/// Notes what an instance has left.
fn leave_rest(mut context: impl AsContextMut<StoreData = StoreData>) {
    let HostParts { gas, slots, .. } = context.as_context().data().parts.expect("there is an instance");
    let rest = (gas.get(&mut context).unwrap_i64(), slots.get(&mut context).unwrap_i32());
    *lock(&context.as_context().data().desk) = rest;
}

/// Suspends a module until it is polled again.
async fn wait(context: &mut impl AsContextMut<StoreData = StoreData>) {
    // The caller reads what is left while the module is suspended.
    leave_rest(&mut *context);
    let mut is_back = false;
    // Pending once, and ready when it is polled again, which happens when there is input.
    poll_fn(|_| if std::mem::replace(&mut is_back, true) { Poll::Ready(()) } else { Poll::Pending }).await;
    take_budget(context);
}

/// Calls a function of the host for a module.
fn call(
    mut context: impl AsContextMut<StoreData = StoreData>,
    function: Function,
    numbers: [u32; 4],
) -> Result<i32, StopCause> {
    let view = context.as_context();
    let host = view.data().host.clone();
    let parts = view.data().parts;
    let HostParts { memory, gas, .. } = parts.expect("there is an instance");
    // The host charges for bytes that it moves, so what is left goes there and back.
    let left = gas.get(&mut context).unwrap_i64();
    let mut caller = Caller { memory: memory.data_mut(&mut context), left, host: &mut host.lock() };
    let number = function.call(&mut caller, numbers);
    let left = caller.left;
    gas.set(context, Val::I64(left)).expect("it is a mutable i64");
    number
}

/// What an error is, in the words of the WebAssembly specification where it is a trap.
fn message_of(error: &Error) -> String {
    match error.downcast_ref::<Trap>() {
        Some(trap) => trap.to_string().trim_start_matches("wasm trap: ").to_owned(),
        None => error.to_string(),
    }
}
