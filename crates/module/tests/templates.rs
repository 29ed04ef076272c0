//! The planners that `wildfire new planner` writes, compiled as modules: each engine gives the same answers for the same
//! numbers of instructions.
#![expect(clippy::print_stdout, reason = "the test's output says what was left out")]

use std::fs;
use std::path::Path;
use std::process::Command;

use wildfire_module::{Engine, Failure, Limits, Module, ModuleAnswer, ModuleInstance};

const HELLO: &str = "{\"type\":\"hello\",\"protocol\":1,\"program\":\"test\"}\n";

/// The messages of a field with scattered bushes, and of drives on it.
fn lines() -> Vec<String> {
    let bushes: Vec<String> = (0..60).map(|n| format!("[{},{}]", n * 17 % 40, n * 29 % 40)).collect();
    let field = format!(
        "{{\"type\":\"field\",\"run\":\"test\",\"truck\":0,\"seed\":7,\"cols\":40,\"rows\":40,\"cell_m\":5,\"cells_cr\":[{}],\
         \"vehicle\":{{\"length\":4.9,\"width\":2.2,\"wheelbase\":3,\"rear_overhang\":0.95,\"min_turn_radius\":13,\
         \"v_max\":8,\"v_max_reverse\":8}},\"limits\":{{}},\"least_clearance\":0.01,\"settings\":{{\"curves\":60}}}}\n",
        bushes.join(",")
    );
    let drives = (1..=12).map(|id| {
        let [x, y, to_x, to_y] = [37, 61, 83, 97].map(|step| 10.0 + f64::from(id * step % 180) + 0.25);
        format!("{{\"type\":\"plan\",\"id\":{id},\"start\":[{x},{y},0.5],\"goal\":{{\"disc\":[{to_x},{to_y},10]}}}}\n")
    });
    [HELLO.to_owned(), field].into_iter().chain(drives).collect()
}

fn answers(engine: Engine, bytes: &[u8]) -> Vec<Result<ModuleAnswer, Failure>> {
    let limits = Limits { memory: 64_000_000, answer: 1_000_000 };
    let module = Module::new(engine, "planner.wasm", bytes, limits).expect("a module");
    let mut instance = ModuleInstance::new(&module, 1).expect("it fits");
    lines().iter().map(|line| instance.exchange(line.as_bytes(), 10_000_000_000, 0)).collect()
}

/// Compiles a template, or says that it is left out.
fn expect_alike(file: &str, compiler: &str, arguments: &[&str]) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let template = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/planners").join(file);
    let module = folder.join(format!("{file}.wasm"));
    let built = Command::new(compiler).args(arguments).arg(template).arg("-o").arg(&module).output();
    if !built.is_ok_and(|built| built.status.success()) {
        println!("left out: {compiler} {} does not compile here", arguments.join(" "));
        return;
    }
    let bytes = fs::read(module).expect("it was written");
    let first = answers(Engine::Interpreter, &bytes);
    for answer in &first {
        let answer = answer.as_ref().expect("an answer");
        println!("{} {}", answer.instructions, String::from_utf8_lossy(&answer.line).trim_end());
    }
    let found = first.iter().flatten().filter(|answer| String::from_utf8_lossy(&answer.line).contains("segments"));
    assert!(found.count() > 6, "it finds most paths");
    for &engine in Engine::ALL {
        assert_eq!(answers(engine, &bytes), first, "{engine:?}");
    }
}

#[test]
fn template_in_rust_answers_alike() {
    expect_alike("planner.rs", "rustc", &["--edition", "2024", "-O", "--target", "wasm32-wasip1"]);
}

#[test]
fn template_in_c_answers_alike() {
    expect_alike("planner.c", "python3", &["-m", "ziglang", "cc", "--target=wasm32-wasi", "-O2"]);
}
