//! WebAssembly modules that answer lines with lines, as programs do: the same answers and the same count of instructions
//! on every machine, and nothing that a module does can harm the program that asks it.
//!
//! A module is an ordinary command for `wasm32-wasip1` that reads stdin and writes stdout. It has arguments (its name), an
//! empty environment, clocks that stand still, random bytes that follow from a seed, and no files.
//!
//! Two engines run modules: `wasmi` interprets them; `wasmtime`, behind the feature of this name, compiles them.

#[cfg(feature = "wasmtime")]
mod compiler;
mod count;
mod host;
mod instance;
mod interpreter;

pub use instance::{Engine, Failure, FailureKind, Limits, Module, ModuleAnswer, ModuleInstance, check};
