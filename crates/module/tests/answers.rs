//! Modules answer as programs do, count alike each time, and break nothing whatever they do.

use wildfire_module::{Answer, Failure, FailureKind, Instance, Limits, Module, counted};

const LIMITS: Limits = Limits { memory: 1 << 20, answer: 1000 };
const PLENTY: u64 = 1_000_000;

/// A command that reads a line into memory at 1024 and then runs `then`, again and again. `$length` is the length of the
/// line; `(call $answer (i32.const FROM) (i32.const LENGTH))` writes bytes of memory to stdout.
fn command(then: &str) -> Vec<u8> {
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

fn started(then: &str, seed: u64) -> Instance {
    let module = Module::new("test", &command(then), LIMITS).expect("a module");
    Instance::new(&module, seed).expect("it fits")
}

fn refused(bytes: &[u8]) -> String {
    Module::new("test", bytes, LIMITS).expect_err("it is refused")
}

fn asked(then: &str) -> Result<Answer, Failure> {
    started(then, 1).exchange(b"hello\n", PLENTY)
}

fn failed(then: &str) -> (FailureKind, String) {
    let failure = asked(then).expect_err("it does not answer");
    (failure.kind, failure.message)
}

#[test]
fn lines_are_answered_one_by_one() {
    let mut instance = started(ECHO, 1);
    for line in ["hello\n", "a longer line\n", "\n"] {
        assert_eq!(instance.exchange(line.as_bytes(), PLENTY).expect("an answer").line, line.as_bytes());
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
        asked(&then).expect("an answer").instructions
    };
    assert_eq!(turns(1000), turns(1000));
    assert_eq!(turns(1000) - turns(10), 990 * 5);
    let mut instance = started(ECHO, 1);
    let first = instance.exchange(b"hello\n", PLENTY).expect("an answer").instructions;
    let counts = [0; 3].map(|_| instance.exchange(b"hello\n", PLENTY).expect("an answer").instructions);
    // The first also counts the way to the loop.
    assert!(first > counts[0] && counts[0] == counts[1] && counts[1] == counts[2], "{first}, {counts:?}");
}

#[test]
fn budget_is_spent_at_the_same_instruction() {
    let cost = asked(OK).expect("an answer").instructions;
    assert!(started(OK, 1).exchange(b"hello\n", cost).is_ok());
    let failure = started(OK, 1).exchange(b"hello\n", cost - 1).expect_err("it is one short");
    assert_eq!(failure.kind, FailureKind::BudgetSpent);
    let (kind, message) = failed("(loop $for_ever (br $for_ever))");
    assert_eq!((kind, message.as_str()), (FailureKind::BudgetSpent, "ran more than 1000000 instructions"));
}

#[test]
fn work_on_many_bytes_counts_by_their_number() {
    let fill = |length: u32| {
        let then = format!("(memory.fill (i32.const 1024) (i32.const 7) (i32.const {length})) {OK}");
        asked(&then).expect("an answer").instructions
    };
    assert_eq!(fill(8000) - fill(0), 1000);
    let random = |length: u32| {
        let then = format!("(drop (call $random_get (i32.const 1024) (i32.const {length}))) {OK}");
        asked(&then).expect("an answer").instructions
    };
    assert_eq!(random(8000) - random(0), 1000);
    let for_ever = "(loop $again (memory.fill (i32.const 0) (i32.const 0) (i32.const 65536)) (br $again))";
    assert_eq!(failed(for_ever).0, FailureKind::BudgetSpent);
}

#[test]
fn random_bytes_follow_from_the_seed_and_clocks_stand_still() {
    let random = "(drop (call $random_get (i32.const 1024) (i32.const 16)))
        (i32.store8 (i32.const 1040) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 17))";
    let bytes = |seed| started(random, seed).exchange(b"hello\n", PLENTY).map(|answer| answer.line);
    assert_eq!(bytes(1), bytes(1));
    assert_ne!(bytes(1), bytes(2));
    let clock = "(drop (call $clock (i32.const 1) (i64.const 0) (i32.const 1024)))
        (i32.store8 (i32.const 1032) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 9))";
    assert_eq!(asked(clock).expect("an answer").line, b"\0\0\0\0\0\0\0\0\n");
}

#[test]
fn nans_have_the_same_bits_wherever_they_can_be_seen() {
    const CANONICAL: [u8; 8] = 0x7ff8_0000_0000_0000_u64.to_le_bytes();
    let answer = "(i32.store8 (i32.const 1032) (i32.const 10)) (call $answer (i32.const 1024) (i32.const 9))";
    let line = |then: &str| asked(&format!("{then} {answer}")).expect("an answer").line;
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
    let (kind, message) = failed("(unreachable)");
    assert!(kind == FailureKind::Crashed && message.starts_with("trapped: "), "{message}");
    assert_eq!(failed("(call $deeper)"), (FailureKind::Crashed, "nests its calls too deeply".to_owned()));
    let told = "(call $write (i32.const 2) (i32.const 512) (i32.const 3)) (call $exit (i32.const 1))";
    assert_eq!(failed(told).1, "ended with exit code 1; its last message: ok");
    // Neither a file nor more memory than it may have is to be got, and it can go on.
    let open = format!(
        "(if (i32.eqz (call $path_open (i32.const 3) (i32.const 0) (i32.const 1024) (i32.const 1) (i32.const 0)
            (i64.const 0) (i64.const 0) (i32.const 0) (i32.const 8))) (then (unreachable))) {OK}"
    );
    assert_eq!(asked(&open).expect("an answer").line, b"ok\n");
    let grow = format!("(if (i32.ge_s (memory.grow (i32.const 100)) (i32.const 0)) (then (unreachable))) {OK}");
    assert_eq!(asked(&grow).expect("an answer").line, b"ok\n");
}

#[test]
fn a_module_that_failed_is_not_asked_again() {
    let mut instance = started("(unreachable)", 1);
    assert!(instance.exchange(b"hello\n", PLENTY).is_err());
    assert_eq!(instance.exchange(b"hello\n", PLENTY).expect_err("it is over").message, "has failed before");
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
        "imports `env.now`; only functions of `wasi_snapshot_preview1` are there"
    );
    assert!(module(&format!("(module {memory})")).starts_with("has no function `_start`"));
    assert!(module(&format!("(module {start})")).starts_with("does not export its `memory`"));
    assert!(module(&format!(r#"(module (memory (export "memory") 1000) {start})"#)).starts_with("cannot be started: "));
    let early = format!("(module {memory} {start} (func $early) (start $early))");
    assert!(module(&early).starts_with("has a start function"));
    let taken = format!(r#"(module {memory} {start} (global (export "wildfire:gas") i32 (i32.const 0)))"#);
    assert_eq!(module(&taken), "exports `wildfire:gas`, a name that is taken");
    let vectors = format!("(module {memory} {start} (func (drop (v128.const i64x2 0 0))))");
    assert!(module(&vectors).starts_with("is not a valid module: SIMD"), "{}", module(&vectors));
}

#[test]
fn any_change_of_a_byte_is_a_sentence_or_a_module() {
    let bytes = command(OK);
    let mut refused = 0;
    for at in 0..bytes.len() {
        for change in [1, 0x40, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            match Module::new("test", &changed, LIMITS) {
                Ok(module) => {
                    if let Ok(mut instance) = Instance::new(&module, 1) {
                        let _ = instance.exchange(b"hello\n", 10_000);
                    }
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > bytes.len(), "{refused} of {} changes are refused", 3 * bytes.len());
}

#[test]
fn counting_twice_is_refused_and_counting_is_repeatable() {
    let once = counted(&command(OK)).expect("a module");
    assert_eq!(once, counted(&command(OK)).expect("a module"));
    assert!(counted(&once).is_err());
}
