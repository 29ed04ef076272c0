//! Fuzzers of scenarios, and of everything that reads files or words.

mod batches;
#[expect(clippy::print_stdout, reason = "says how much was tried, and which case broke a law")]
#[path = "../../fuzz/mod.rs"]
mod fuzz;
mod grammar;
mod maps;
mod parsers;
#[path = "../../fuzz/phrases.rs"]
mod phrases;
mod recordings;
mod scenarios;
