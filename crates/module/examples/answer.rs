//! Times a module: how long each engine takes to answer the lines of a file, and for how many instructions.
//!
//!     cargo run --release -p wildfire-module --features wasmtime --example answer -- mine.wasm lines.txt
//!
//! A planner that is started by `sh -c 'tee lines.txt | ./planner'` leaves such a file.

use std::{env, fs};

use cpu_time::ThreadTime;
use wildfire_module::{Engine, Limits, Module, ModuleInstance};

#[expect(clippy::print_stdout, reason = "it is what the example is for")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [file, lines] = &env::args().skip(1).collect::<Vec<_>>()[..] else {
        return Err("expected a module and lines".into());
    };
    let bytes = fs::read(file)?;
    let lines = fs::read_to_string(lines)?;
    for &engine in Engine::ALL {
        let start = ThreadTime::now();
        let module = Module::new(engine, file, &bytes, Limits { memory: 256_000_000, answer: 16_000_000 })?;
        let compiled = start.elapsed();
        let mut instance = None;
        let mut instructions = 0;
        for line in lines.lines().filter(|line| !line.contains("\"type\":\"end\"")) {
            // Each hello is that of a new run.
            if line.contains("\"type\":\"hello\"") {
                instance = None;
            }
            let instance = match &mut instance {
                Some(instance) => instance,
                none => none.insert(ModuleInstance::new(&module, 1)?),
            };
            let answer = instance.exchange(format!("{line}\n").as_bytes(), u64::MAX, 0);
            instructions += answer.map_err(|failure| failure.message)?.instructions;
        }
        let [compiled, all] = [compiled, start.elapsed()].map(|time| time.as_secs_f64());
        println!(
            "{engine:?}: {compiled:.3} s to compile, {:.3} s to answer, {instructions} instructions",
            all - compiled
        );
    }
    Ok(())
}
