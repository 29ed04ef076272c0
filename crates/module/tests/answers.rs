//! Modules answer as programs do, count alike each time and under each engine, and break nothing whatever they do.

use std::fmt::Debug;

use wildfire_module::{Engine, Failure, FailureKind, Limits, Module, ModuleAnswer, ModuleInstance};

const LIMITS: Limits = Limits { memory: 1 << 20, answer: 1000 };
const PLENTY: u64 = 1_000_000;

/// A command that reads a line into memory at 1024 and then runs `then`, again and again. `$length` is the length of the
/// line; `(call $answer (i32.const FROM) (i32.const LENGTH))` writes bytes of memory to stdout.
fn command(then: &str) -> Vec<u8> {
    command_with("", then)
}

/// The same with more functions.
fn command_with(functions: &str, then: &str) -> Vec<u8> {
    let text = format!(
        r#"(module
            (import "wasi_snapshot_preview1" "fd_read" (func $fd_read (param i32 i32 i32 i32) (result i32)))
            (import "wasi_snapshot_preview1" "fd_write" (func $fd_write (param i32 i32 i32 i32) (result i32)))
            (import "wasi_snapshot_preview1" "random_get" (func $random_get (param i32 i32) (result i32)))
            (import "wasi_snapshot_preview1" "clock_time_get" (func $clock (param i32 i64 i32) (result i32)))
            (import "wasi_snapshot_preview1" "path_open"
                (func $path_open (param i32 i32 i32 i32 i32 i64 i64 i32 i32) (result i32)))
            (import "wasi_snapshot_preview1" "proc_exit" (func $exit (param i32)))
            (memory (export "memory") 2)
            (func $write (param $fd i32) (param $from i32) (param $length i32)
                (i32.store (i32.const 0) (local.get $from))
                (i32.store (i32.const 4) (local.get $length))
                (drop (call $fd_write (local.get $fd) (i32.const 0) (i32.const 1) (i32.const 8))))
            (func $answer (param $from i32) (param $length i32)
                (call $write (i32.const 1) (local.get $from) (local.get $length)))
            (func $deeper (call $deeper))
            {functions}
            (func (export "_start") (local $length i32) (local $n i32) (local $x f64)
                (i32.store (i32.const 512) (i32.const 0x0a6b6f))
                (loop $again
                    (i32.store (i32.const 0) (i32.const 1024))
                    (i32.store (i32.const 4) (i32.const 512))
                    (drop (call $fd_read (i32.const 0) (i32.const 0) (i32.const 1) (i32.const 8)))
                    (local.set $length (i32.load (i32.const 8)))
                    {then}
                    (br $again))))"#
    );
    wat::parse_str(text).expect("the text of a module")
}

const ECHO: &str = "(call $answer (i32.const 1024) (local.get $length))";
const OK: &str = "(call $answer (i32.const 512) (i32.const 3))";

/// What each engine gives, which is the same.
fn alike<T: PartialEq + Debug>(of: impl Fn(Engine) -> T) -> T {
    let first = of(Engine::ALL[0]);
    for &engine in &Engine::ALL[1..] {
        assert_eq!(of(engine), first, "{engine:?}");
    }
    first
}

fn start(engine: Engine, bytes: &[u8], seed: u64) -> ModuleInstance {
    let module = Module::new(engine, "test", bytes, LIMITS).expect("a module");
    ModuleInstance::new(&module, seed).expect("it fits")
}

/// What a module answers to lines, until it fails.
fn answers(bytes: &[u8], seed: u64, lines: &[(&str, u64)]) -> Vec<Result<ModuleAnswer, Failure>> {
    alike(|engine| {
        let mut instance = start(engine, bytes, seed);
        lines.iter().map(|(line, budget)| instance.exchange(line.as_bytes(), *budget, 0)).collect()
    })
}

fn answer_to(bytes: &[u8], seed: u64, budget: u64) -> Result<ModuleAnswer, Failure> {
    answers(bytes, seed, &[("hello\n", budget)]).remove(0)
}

fn answer_of(then: &str) -> Result<ModuleAnswer, Failure> {
    answer_to(&command(then), 1, PLENTY)
}

fn failed(then: &str) -> (FailureKind, String) {
    let failure = answer_of(then).expect_err("it does not answer");
    (failure.kind, failure.message)
}

fn refused(bytes: &[u8]) -> String {
    alike(|engine| Module::new(engine, "test", bytes, LIMITS).expect_err("it is refused"))
}

#[test]
fn lines_are_answered_one_by_one() {
    let lines = ["hello\n", "a longer line\n", "\n"];
    let answers = answers(&command(ECHO), 1, &lines.map(|line| (line, PLENTY)));
    for (answer, line) in answers.into_iter().zip(lines) {
        assert_eq!(answer.expect("an answer").line, line.as_bytes());
    }
}

#[test]
fn the_same_line_counts_the_same_and_each_turn_of_a_loop_counts_its_instructions() {
    // A turn: get, const, sub, tee and br_if; nop and loop count nothing.
    let turns = |n: u32| {
        let then = format!(
            "(local.set $n (i32.const {n}))
             (loop $turn (nop) (br_if $turn (local.tee $n (i32.sub (local.get $n) (i32.const 1))))) {OK}"
        );
        answer_of(&then).expect("an answer").instructions
    };
    assert_eq!(turns(1000), turns(1000));
    assert_eq!(turns(1000) - turns(10), 990 * 5);
    let answers = answers(&command(ECHO), 1, &[("hello\n", PLENTY); 4]);
    let counts: Vec<u64> = answers.into_iter().map(|answer| answer.expect("an answer").instructions).collect();
    // The first also counts the way to the loop.
    assert!(counts[0] > counts[1] && counts[1] == counts[2] && counts[2] == counts[3], "{counts:?}");
}

#[test]
fn budget_is_spent_at_the_same_instruction() {
    let cost = answer_of(OK).expect("an answer").instructions;
    assert!(answer_to(&command(OK), 1, cost).is_ok());
    let failure = answer_to(&command(OK), 1, cost - 1).expect_err("it is one short");
    assert_eq!(failure.kind, FailureKind::BudgetSpent);
    let (kind, message) = failed("(loop $for_ever (br $for_ever))");
    assert_eq!((kind, message.as_str()), (FailureKind::BudgetSpent, "ran more than 1000000 instructions"));
}

#[test]
fn work_on_many_bytes_counts_by_their_number() {
    let fill = |length: u32| {
        let then = format!("(memory.fill (i32.const 1024) (i32.const 7) (i32.const {length})) {OK}");
        answer_of(&then).expect("an answer").instructions
    };
    assert_eq!(fill(8000) - fill(0), 1000);
    let random = |length: u32| {
        let then = format!("(drop (call $random_get (i32.const 1024) (i32.const {length}))) {OK}");
        answer_of(&then).expect("an answer").instructions
    };
    assert_eq!(random(8000) - random(0), 1000);
    let endless = "(loop $again (memory.fill (i32.const 0) (i32.const 0) (i32.const 65536)) (br $again))";
    assert_eq!(failed(endless).0, FailureKind::BudgetSpent);
}

#[test]
fn random_bytes_follow_from_the_seed_and_clocks_stand_still() {
    let random = "(drop (call $random_get (i32.const 1024) (i32.const 16)))
        (i32.store8 (i32.const 1040) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 17))";
    let bytes = |seed| answer_to(&command(random), seed, PLENTY).map(|answer| answer.line);
    assert_eq!(bytes(1), bytes(1));
    assert_ne!(bytes(1), bytes(2));
    let clock = "(drop (call $clock (i32.const 1) (i64.const 0) (i32.const 1024)))
        (i32.store8 (i32.const 1032) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 9))";
    assert_eq!(answer_of(clock).expect("an answer").line, b"\0\0\0\0\0\0\0\0\n");
}

#[test]
fn nans_have_the_same_bits_wherever_they_can_be_seen() {
    const CANONICAL: [u8; 8] = 0x7ff8_0000_0000_0000_u64.to_le_bytes();
    let answer = "(i32.store8 (i32.const 1032) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 9))";
    let line = |then: &str| answer_of(&format!("{then} {answer}")).expect("an answer").line;
    let other = "(f64.neg (f64.reinterpret_i64 (i64.const 0x7ff0000000000123)))";
    assert_eq!(line(&format!("(f64.store (i32.const 1024) {other})"))[..8], CANONICAL);
    assert_eq!(line(&format!("(i64.store (i32.const 1024) (i64.reinterpret_f64 {other}))"))[..8], CANONICAL);
    let sign = format!("(f64.store (i32.const 1024) (f64.copysign (f64.const 2) {other}))");
    assert_eq!(line(&sign)[..8], 2.0_f64.to_le_bytes());
    assert_eq!(line("(f64.store (i32.const 1024) (f64.const -0.1))")[..8], (-0.1_f64).to_le_bytes());
}

#[test]
fn whatever_a_module_does_is_a_sentence() {
    let too_long = "(loop $flood (call $answer (i32.const 1024) (i32.const 512)) (br $flood))";
    assert_eq!(failed(too_long), (FailureKind::BadAnswer, "wrote more than 1000 bytes".to_owned()));
    assert_eq!(failed(""), (FailureKind::BadAnswer, "reads on without having answered".to_owned()));
    assert_eq!(failed("(call $exit (i32.const 3))"), (FailureKind::Crashed, "ended with exit code 3".to_owned()));
    assert_eq!(failed("(return)"), (FailureKind::Crashed, "ended".to_owned()));
    for (does, word) in [
        ("(unreachable)", "unreachable"),
        ("(drop (i32.load (i32.const -1)))", "out of bounds memory access"),
        ("(drop (i32.div_s (i32.const 1) (i32.const 0)))", "integer divide by zero"),
        ("(drop (i32.div_s (i32.const 0x80000000) (i32.const -1)))", "integer overflow"),
        ("(drop (i32.trunc_f64_s (f64.const nan)))", "invalid conversion to integer"),
    ] {
        let (kind, message) = failed(does);
        assert!(kind == FailureKind::Crashed && message.starts_with("trapped: "), "{message}");
        assert!(message.contains(word), "{message}");
    }
    assert_eq!(failed("(call $deeper)"), (FailureKind::Crashed, "nests its calls too deeply".to_owned()));
    let on_stderr = "(call $write (i32.const 2) (i32.const 512) (i32.const 3)) (call $exit (i32.const 1))";
    assert_eq!(failed(on_stderr).1, "ended with exit code 1; its last message: ok");
    // Neither a file nor more memory than it may have is to be got, and it can go on.
    let open = format!(
        "(if (i32.eqz (call $path_open (i32.const 3) (i32.const 0) (i32.const 1024) (i32.const 1) (i32.const 0)
            (i64.const 0) (i64.const 0) (i32.const 0) (i32.const 8))) (then (unreachable))) {OK}"
    );
    assert_eq!(answer_of(&open).expect("an answer").line, b"ok\n");
    let grow = format!("(if (i32.ge_s (memory.grow (i32.const 100)) (i32.const 0)) (then (unreachable))) {OK}");
    assert_eq!(answer_of(&grow).expect("an answer").line, b"ok\n");
}

#[test]
fn a_module_that_failed_is_not_queried_again() {
    let [first, second] = &answers(&command("(unreachable)"), 1, &[("hello\n", PLENTY); 2])[..] else { panic!() };
    assert!(first.is_err());
    assert_eq!(second.as_ref().expect_err("it is over").message, "has failed before");
}

#[test]
fn what_is_no_module_is_refused_with_a_sentence() {
    assert!(refused(b"#!/bin/sh").starts_with("is not a WebAssembly module"));
    assert!(refused(&command(OK)[..100]).starts_with("is not a valid module: "));
    let module = |text: &str| refused(&wat::parse_str(text).expect("the text of a module"));
    let memory = r#"(memory (export "memory") 1)"#;
    let start = r#"(func (export "_start"))"#;
    assert_eq!(
        module(&format!(r#"(module (import "env" "now" (func)) {memory} {start})"#)),
        "imports `env.now`; only functions of `wasi_snapshot_preview1` exist"
    );
    assert!(module(&format!("(module {memory})")).starts_with("has no function `_start`"));
    assert!(module(&format!("(module {start})")).starts_with("does not export its `memory`"));
    let typed = r#"(import "wasi_snapshot_preview1" "fd_read" (func (param i32) (result i32)))"#;
    assert_eq!(
        module(&format!("(module {typed} {memory} {start})")),
        "imports `wasi_snapshot_preview1.fd_read` with another type than it has"
    );
    assert_eq!(
        module(&format!(r#"(module (import "env" "memory" (memory 1)) {start})"#)),
        "imports `env.memory`, which is not a function; only those of `wasi_snapshot_preview1` exist"
    );
    assert_eq!(
        module(&format!(r#"(module (memory (export "memory") 1000) {start})"#)),
        "begins with 65.5 MB of memory; at most 1.048576 MB are allowed"
    );
    let outside = format!(r#"(module {memory} {start} (data (i32.const 70000) "x"))"#);
    assert_eq!(module(&outside), "cannot be started: out of bounds memory access");
    let early = format!("(module {memory} {start} (func $early) (start $early))");
    assert!(module(&early).starts_with("has a start function"));
    let taken = format!(r#"(module {memory} {start} (global (export "wildfire:gas") i32 (i32.const 0)))"#);
    assert_eq!(module(&taken), "exports `wildfire:gas`, a reserved name");
    let vectors = format!("(module {memory} {start} (func (drop (v128.const i64x2 0 0))))");
    assert!(module(&vectors).starts_with("is not a valid module: SIMD"), "{}", module(&vectors));
}

#[test]
fn nested_calls_end_at_the_same_depth() {
    // A function that calls itself as often as the line is told, and one whose frame is larger.
    let down = |locals: &str| {
        format!(
            "(func $down (param $n i32) (local {locals})
                (if (i32.eqz (local.get $n)) (then (return))) (call $down (i32.sub (local.get $n) (i32.const 1))))"
        )
    };
    let goes = |locals: &str, depth: u32| {
        let then = format!("(call $down (i32.const {depth})) {OK}");
        answer_to(&command_with(&down(locals), &then), 1, 100 * PLENTY).map(|answer| answer.instructions)
    };
    let deepest = |locals: &str| {
        let (mut works, mut fails) = (1_u32, 1 << 20);
        while fails - works > 1 {
            let depth = works.midpoint(fails);
            if goes(locals, depth).is_ok() { works = depth } else { fails = depth }
        }
        works
    };
    let (flat, wide) = (deepest(""), deepest(&"f64 ".repeat(989)));
    // A frame has 8 slots, its parameter, its locals and two values on the stack.
    assert_eq!((flat, wide), ((1 << 20) / 11 - 3, (1 << 20) / 1000 - 1));
    let failure = goes("", flat + 1).expect_err("it is too deep");
    assert_eq!((failure.kind, failure.message.as_str()), (FailureKind::Crashed, "nests its calls too deeply"));
}

#[test]
fn functions_give_their_slots_back_whichever_way_they_end() {
    // By `return` from two blocks, by a branch to the end of the function, by its end; with one result, or two.
    let functions = "(func $leaf (result i32) (i32.const 3))
        (func $one (param $n i32) (result i32)
            (block (loop
                (if (i32.eq (local.get $n) (i32.const 0)) (then (return (call $leaf))))
                (br_if 2 (i32.const 4) (i32.eq (local.get $n) (i32.const 1)))
                (drop)))
            (i32.const 5))
        (func $two (param $n i32) (result i32 i32)
            (if (local.get $n) (then (return (i32.const 6) (call $leaf))))
            (i32.const 1) (call $one (i32.const 0)))";
    let then = "(local.set $n (i32.const 300000))
        (loop $turn
            (i32.store8 (i32.const 1024) (i32.add (i32.const 48) (call $one (i32.const 0))))
            (i32.store8 (i32.const 1025) (i32.add (i32.const 48) (call $one (i32.const 1))))
            (i32.store8 (i32.const 1026) (i32.add (i32.const 48) (call $one (i32.const 2))))
            (i32.store8 (i32.const 1027) (i32.add (i32.const 48) (i32.sub (call $two (i32.const 0)))))
            (i32.store8 (i32.const 1028) (i32.add (i32.const 48) (i32.sub (call $two (i32.const 1)))))
            (br_if $turn (local.tee $n (i32.sub (local.get $n) (i32.const 1)))))
        (i32.store8 (i32.const 1029) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 6))";
    let answer = answer_to(&command_with(functions, then), 1, 100 * PLENTY).expect("an answer");
    assert_eq!(String::from_utf8_lossy(&answer.line), "345.3\n");
}

#[test]
fn lists_of_very_many_buffers_are_refused_before_they_are_read() {
    // 28 is INVAL; 1024 buffers of no bytes are written.
    let then = "(i32.store8 (i32.const 1024) (i32.add (i32.const 48)
            (call $fd_write (i32.const 1) (i32.const 4096) (i32.const 1025) (i32.const 8))))
        (i32.store8 (i32.const 1025) (i32.add (i32.const 48)
            (call $fd_write (i32.const 1) (i32.const 4096) (i32.const 1024) (i32.const 8))))
        (i32.store8 (i32.const 1026) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 3))";
    assert_eq!(answer_of(then).expect("an answer").line, [48 + 28, 48, b'\n']);
}

#[test]
fn any_change_of_a_byte_is_a_sentence_or_a_module() {
    let bytes = command(OK);
    let mut refused = 0;
    for at in 0..bytes.len() {
        for change in [1, 0x40, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            let answer = alike(|engine| {
                let module = Module::new(engine, "test", &changed, LIMITS).ok()?;
                Some(ModuleInstance::new(&module, 1).expect("it was tried").exchange(b"hello\n", 10_000, 0))
            });
            refused += usize::from(answer.is_none());
        }
    }
    assert!(refused > bytes.len(), "{refused} of {} changes are refused", 3 * bytes.len());
}
