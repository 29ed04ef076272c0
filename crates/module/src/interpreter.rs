//! The engine `wasmi`: an interpreter, small, and at work at once.

use wasmi::{AsContextMut, Config, Error, Extern, ExternType, Func, Global, Linker, Memory, ResumableCall};
use wasmi::{ResumableCallHostTrap, Store, StoreLimits, StoreLimitsBuilder, TrapCode, Val};

use crate::count::{Counted, FRAME_SLOTS, GAS, MAX_SLOTS, SLOTS};
use crate::host::{Caller, Function, SharedHost, StopCause, WASI, four};
use crate::instance::{Limits, MAX_TABLE_ELEMENTS, Pause, Reason};

impl wasmi::errors::HostError for StopCause {}

/// A compiled module with its imports.
#[derive(Debug)]
pub struct Compiled {
    module: wasmi::Module,
    linker: Linker<Data>,
}

/// What a store holds.
#[derive(Debug)]
struct Data {
    limits: StoreLimits,
    host: SharedHost,
    /// Set as soon as there is an instance; nothing runs before.
    parts: Option<Parts>,
    /// A call that waits for input.
    waiting: Option<(Function, [u32; 4])>,
}

/// What functions of the host need of an instance.
#[derive(Clone, Copy, Debug)]
struct Parts {
    memory: Memory,
    gas: Global,
    slots: Global,
}

impl Compiled {
    pub fn new(counted: &Counted) -> Result<Self, String> {
        let mut config = Config::default();
        // Slots are counted, so neither is ever reached.
        config.set_max_recursion_depth(MAX_SLOTS as usize / FRAME_SLOTS as usize + 2);
        config.set_max_stack_height(2 * size_of::<u64>() * MAX_SLOTS as usize);
        let engine = wasmi::Engine::new(&config);
        let module =
            wasmi::Module::new(&engine, &counted.bytes).map_err(|error| format!("cannot be compiled: {error}"))?;
        let mut linker = Linker::new(&engine);
        // Counting keeps the imports and their order, so the two lists match.
        for (import, requested) in counted.imports.iter().zip(module.imports()) {
            let function = Function::of(import)?;
            let ExternType::Func(of) = requested.ty() else { unreachable!("it is a function") };
            let act = move |mut caller: wasmi::Caller<'_, Data>, numbers: &[Val], results: &mut [Val]| {
                // No function reads an i64, such as the precision of a clock, so it may become 0.
                let numbers = four(numbers.iter().map(|number| number.i32().unwrap_or_default().cast_unsigned()));
                let number = call(&mut caller, function, numbers).map_err(|stop| {
                    // The call is made again with the same numbers once there is input.
                    caller.data_mut().waiting = Some((function, numbers));
                    Error::host(stop)
                })?;
                results.iter_mut().for_each(|result| *result = Val::I32(number));
                Ok(())
            };
            linker
                .func_new(WASI, &import.name, of.clone(), act)
                .map_err(|_| format!("imports `{}` twice", import.name))?;
        }
        Ok(Self { module, linker })
    }

    pub fn start(&self, host: SharedHost, limits: Limits) -> Result<Running, String> {
        let limits = StoreLimitsBuilder::new().memory_size(limits.memory).table_elements(MAX_TABLE_ELEMENTS).build();
        let mut store = Store::new(self.linker.engine(), Data { limits, host, parts: None, waiting: None });
        store.limiter(|data| &mut data.limits);
        let instance =
            self.linker.instantiate_and_start(&mut store, &self.module).map_err(|error| message_of(&error))?;
        let export = |name| instance.get_export(&store, name);
        let (
            Some(Extern::Func(start)),
            Some(Extern::Memory(memory)),
            Some(Extern::Global(gas)),
            Some(Extern::Global(slots)),
        ) = (export("_start"), export("memory"), export(GAS), export(SLOTS))
        else {
            unreachable!("its exports were looked at");
        };
        let parts = Parts { memory, gas, slots };
        // Functions of the host find memory and globals through it.
        store.data_mut().parts = Some(parts);
        Ok(Running { store, parts, state: InterpreterState::New(start) })
    }
}

/// An instance of a module.
#[derive(Debug)]
pub struct Running {
    store: Store<Data>,
    parts: Parts,
    state: InterpreterState,
}

/// Where an instance is between two answers.
#[derive(Debug)]
enum InterpreterState {
    /// It has not run yet.
    New(Func),
    /// It waits for input.
    Waiting(ResumableCallHostTrap),
    Over,
}

impl Running {
    /// Runs until there is no input left, or until its end, with so many instructions.
    pub fn run(&mut self, budget: i64) -> Pause {
        self.parts.gas.set(&mut self.store, Val::I64(budget)).expect("it is a mutable i64");
        // Over unless it turns out to wait: a trap leaves nothing to go on with.
        let ended = match std::mem::replace(&mut self.state, InterpreterState::Over) {
            InterpreterState::New(start) => start.call_resumable(&mut self.store, &[], &mut []),
            InterpreterState::Waiting(waiting) => {
                let (function, numbers) = self.store.data_mut().waiting.take().expect("a call that waits");
                // The module resumes with the result of the very call that had no input.
                let number = call(&mut self.store, function, numbers).expect("there is input");
                waiting.resume(&mut self.store, &[Val::I32(number)], &mut [])
            }
            InterpreterState::Over => unreachable!("nobody runs what is over"),
        };
        let reason = match ended {
            Ok(ResumableCall::HostTrap(trap)) => match trap.host_error().downcast_ref() {
                Some(&stop) => {
                    // After an exit or a flood too: `ModuleInstance` runs no module again that has failed.
                    self.state = InterpreterState::Waiting(trap);
                    Reason::Stop(stop)
                }
                None => Reason::Trap("an error of the host".to_owned()),
            },
            Ok(_) => Reason::End,
            Err(error) => Reason::Trap(message_of(&error)),
        };
        let number = |global: Global| global.get(&self.store);
        let (Val::I64(left), Val::I32(slots)) = (number(self.parts.gas), number(self.parts.slots)) else {
            unreachable!("an i64 and an i32");
        };
        Pause { reason, left, slots }
    }
}

/// Calls a function of the host for a module.
fn call(mut context: impl AsContextMut<Data = Data>, function: Function, numbers: [u32; 4]) -> Result<i32, StopCause> {
    let view = context.as_context();
    let host = view.data().host.clone();
    let parts = view.data().parts;
    let Parts { memory, gas, .. } = parts.expect("there is an instance");
    let Val::I64(left) = gas.get(&context) else { unreachable!("it is an i64") };
    let mut caller = Caller { memory: memory.data_mut(&mut context), left, host: &mut host.lock() };
    let number = function.call(&mut caller, numbers);
    let left = caller.left;
    gas.set(context, Val::I64(left)).expect("it is a mutable i64");
    number
}

/// What an error is, in the words of the WebAssembly specification where it is a trap.
fn message_of(error: &Error) -> String {
    match error.as_trap_code() {
        Some(TrapCode::IndirectCallToNull) => "uninitialized element".to_owned(),
        Some(code) => code.trap_message().to_owned(),
        None => error.to_string(),
    }
}
