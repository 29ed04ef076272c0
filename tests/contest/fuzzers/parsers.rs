//! Fuzzers of everything that reads what people or other programs wrote, with input that nobody would write.
//!
//! Nothing panics, no case runs without end, memory stays bounded. Every refusal has words, and a place if the input is
//! a text. Whatever is accepted is the same when it is written and read again. Checksums and hashes are right, so that
//! what they cover is reached.
//!
//! Arguments of the command line and the tables that its commands read have a fuzzer in `src/cli/command_lines.rs`.
//! `tests/fuzz/mod.rs` says which variables of the environment ask for more cases, or for one.

use std::panic;
use std::process::Command;
use std::str::FromStr;
use std::sync::LazyLock;
use std::{env, fs};

use wildfire::batch::plan::{MAX_RUNS, Record, Seeds, Slice};
use wildfire::scenario::{BUILT_IN, LoadedScenario, MemoryLimit, TruckPlannerKind, explain};
use wildfire::untrusted::{spreadsheet_cell, text_of_cell, visible};

use super::fuzz::text::mutated;
use super::fuzz::{Case, Fuzzer, Law, below, one_of};
use super::grammar::{Grammar, MAP, refusal_names_its_place};
use super::maps::check_message;
use super::{batches, maps, phrases, recordings};

/// The number of cases that are run where nobody asks for more.
const CASES: u64 = 10_000;

/// The name of the test, by which it starts itself.
const TEST: &str = "fuzzers::parsers::parsers_take_anything";

/// The most memory that the fuzzer may have taken, in kilobytes: reading a recording may take most of it.
const MAX_MEMORY_KB: u64 = 1 << 20;

/// Feeds a case to a parser, and looks whether a law is broken.
type Feed = fn(&mut Case<'_>) -> Law;

/// The parsers with their weights: how often each is drawn among the sum of all.
const PARSERS: &[(usize, &str, Feed)] = &[
    (250, "words of the command line", command_text),
    (150, "recordings", recordings::recording),
    (150, "map files", maps::map_file),
    (100, "rasters", maps::raster_file),
    (40, "files of landscapes and weather", maps::landscape_files),
    (100, "given fields", maps::imported_field),
    (100, "problem files", maps::problem_file),
    (80, "journals", batches::journal),
    (50, "options of batches", batches::batch_options),
    (40, "scenario files", scenario_file),
    (40, "changes", change),
    (30, "plan files", batches::plan_file),
    (20, "plans of batches", batches::frozen_plan),
    (20, "tables compared", batches::compared_tables),
    (20, "finished batches", batches::finished_rows),
    (20, "NumPy arrays", maps::numpy_array),
    (1, "reports", batches::report),
];

static GRAMMAR: LazyLock<Grammar> = LazyLock::new(Grammar::new);

#[test]
fn parsers_take_anything() {
    // Its memory is counted, and tests beside it take some too: where it was not asked for, it has a process of its own.
    if !env::args().skip(1).any(|filter| TEST.contains(&filter)) {
        let tests = env::current_exe().expect("this program has a path");
        let output = Command::new(tests).args([TEST, "--nocapture"]).output().expect("it can be started");
        println!("{}", String::from_utf8_lossy(&output.stdout));
        return assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let tally = Fuzzer { name: "parsers", target: "--test contest", law: parser_takes_it }.run(CASES);
    let cases: u64 = PARSERS.iter().filter_map(|(_, name, _)| tally.get(*name)).sum();
    for (_, name, _) in PARSERS {
        assert!(cases < CASES || tally.contains_key(*name), "no case was about {name}");
    }
    if let Some(memory_kb) = max_memory_kb() {
        println!("at most {memory_kb} KB of memory");
        assert!(memory_kb < MAX_MEMORY_KB, "{memory_kb} KB of memory were taken");
    }
}

/// A fuzzer that can fail: it reports the fault of the smallest case, with the command that repeats it.
#[test]
fn broken_law_is_told_of_a_small_case() {
    let law = |case: &mut Case<'_>| {
        let draws: Vec<usize> = (0..64).map(|_| below(&mut case.dice, 256)).collect();
        case.input = draws.iter().map(|draw| format!("{draw};")).collect::<String>().into_bytes();
        assert!(draws.iter().all(|&draw| draw < 200), "a number is large");
        Ok(())
    };
    let payload = panic::catch_unwind(|| Fuzzer { name: "broken_law", target: "--test contest", law }.run(1));
    let payload = payload.expect_err("the law is broken");
    let report = payload.downcast_ref::<String>().expect("a report");
    assert!(report.contains("it panics: a number is large (tests/contest/fuzzers/parsers.rs:"), "{report}");
    assert!(report.contains("again: WILDFIRE_FUZZ_CASE="), "{report}");
    let small = report.lines().skip_while(|line| !line.starts_with("made smaller")).nth(1).expect("an input");
    let numbers: Vec<&str> = small.split(';').filter(|number| !matches!(*number, "0" | "")).collect();
    assert!(numbers.len() <= 4, "{report}");
}

/// Reads the peak of memory as the system counts it, where it does.
fn max_memory_kb() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

fn parser_takes_it(case: &mut Case<'_>) -> Law {
    let all: usize = PARSERS.iter().map(|(share, _, _)| share).sum();
    let mut draw = below(&mut case.dice, all);
    for (share, name, law) in PARSERS {
        if draw < *share {
            case.kind = name;
            case.count(*name);
            return law(case);
        }
        draw -= share;
    }
    unreachable!("the shares make up all of it")
}

fn scenario_file(case: &mut Case<'_>) -> Law {
    case.input = if case.chance(30) {
        let drawn = GRAMMAR.draw(&mut case.dice);
        case.write(MAP, drawn.map.as_deref().unwrap_or("..\n.#\n").as_bytes());
        let text = toml::to_string(&drawn.scenario).expect("what was drawn can be written");
        mutated(&mut case.dice, &[text], &[])
    } else {
        let samples: Vec<&str> = BUILT_IN.iter().map(|(_, text)| *text).collect();
        mutated(&mut case.dice, &samples, &["[field]\n", "[[wumpus]]\n", "unimog = []\n", "field.map = 'map.txt'\n"])
    };
    let path = case.write("scenario.toml", &case.input);
    read_scenario(case, path.to_str().expect("scratch folders have plain names"), &[])
}

/// Checks a change to a built-in scenario.
fn change(case: &mut Case<'_>) -> Law {
    let keys: Vec<&String> = GRAMMAR.ranges().keys().collect();
    let key =
        if case.chance(80) { (*one_of(&mut case.dice, &keys)).clone() } else { phrases::phrase(&mut case.dice, KEYS) };
    let value = phrases::phrase(&mut case.dice, VALUES);
    let mut change = format!("{key}={value}");
    if case.chance(20) {
        change = String::from_utf8_lossy(&mutated(&mut case.dice, &[change], &[])).into_owned();
    }
    case.input = change.clone().into_bytes();
    read_scenario(case, "smoke", &[change])
}

const KEYS: &[&str] =
    &["unimog", "wumpus", ".", "0", "field", "given", "map", "prm", "start_m", "fire", "=", "name", "shapes"];
const VALUES: &[&str] =
    &["[", "]", "{", "}", "x_m = 1", "true", "\"", "prm-rs", "none", "potential", ", ", "1..2", "lattice"];

fn read_scenario(case: &mut Case<'_>, source: &str, changes: &[String]) -> Law {
    match LoadedScenario::open(source, changes) {
        Ok(loaded) => {
            case.count("scenarios accepted");
            // It looks what roadmaps the trucks would have, which takes a hundred times as long as reading.
            if case.chance(5) {
                explain(&loaded, MemoryLimit::default()).to_text();
            }
            for (path, _) in loaded.values() {
                loaded.is_set(&path);
            }
            Ok(())
        }
        Err(refusal) => refusal_names_its_place(&refusal),
    }
}

/// Checks seeds, slices and names.
fn command_text(case: &mut Case<'_>) -> Law {
    const TOKENS: &[&str] =
        &["..", ",", "/", "1", "5", "1..5", "2/5", "7", "all", "none", "prm-rs", "prm+primitives", "lattice"];
    let text = phrases::phrase(&mut case.dice, TOKENS);
    case.input = text.clone().into_bytes();
    if let Ok(seeds) = comes_back::<Seeds>(&text)? {
        case.count("words accepted");
        if !(1..=MAX_RUNS).contains(&seeds.count()) {
            return Err(format!("{} seeds", seeds.count()));
        }
        let last = seeds.nth(seeds.count() - 1);
        if seeds.count() < 1000 && seeds.iter().last() != Some(last) {
            return Err(format!("its last seed is not {last}"));
        }
    }
    if let Ok(slice) = comes_back::<Slice>(&text)? {
        case.count("words accepted");
        if (1..=20).any(|run| slice.place_of(run).is_some_and(|place| slice.run_at(place) != run)) {
            return Err("a run of the slice is at another place".into());
        }
    }
    if text_of_cell(&spreadsheet_cell(&text)) != text {
        return Err("a cell of a table holds another text".into());
    }
    let shown = visible(&text);
    if shown.chars().any(char::is_control) || visible(&shown) != shown {
        return Err(format!("shown as {shown:?} it acts on a terminal"));
    }
    if let Err(refusal) = text.parse::<Record>() {
        check_message(&refusal)?;
    }
    if let Ok(planner) = text.parse::<TruckPlannerKind>()
        && planner.name() != text
    {
        return Err(format!("it is taken for {}", planner.name()));
    }
    Ok(())
}

/// Reads a text, and checks that the value is the same when it is written and read again.
fn comes_back<T: FromStr<Err: ToString> + ToString + PartialEq>(text: &str) -> Result<Result<T, T::Err>, String> {
    let read = text.parse::<T>();
    match &read {
        Ok(value) if value.to_string().parse::<T>().ok().as_ref() != Some(value) => {
            Err(format!("{} comes back as something else", value.to_string()))
        }
        Err(refusal) => check_message(&refusal.to_string()).map(|()| read),
        Ok(_) => Ok(read),
    }
}
