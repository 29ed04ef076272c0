//! WebAssembly modules that answer lines with lines, as programs do: the same answers and the same count of instructions
//! on every machine, and nothing that a module does can harm the program that asks it.
//!
//! A module is an ordinary command for `wasm32-wasip1` that reads stdin and writes stdout. It has arguments (its name), an
//! empty environment, clocks that stand still, random bytes that follow from a seed, and no files.

mod count;
mod host;
mod instance;

pub use count::{BYTES_PER_INSTRUCTION, GAS, counted};
pub use instance::{Answer, Failure, FailureKind, Instance, Limits, Module};
