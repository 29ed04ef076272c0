//! Scenarios that nobody thought of, run and checked against the rules.
//!
//! Scenarios are drawn by the grammar of the JSON Schema, or are built-in ones with changes to their text. Every
//! refusal has a place. A scenario that is accepted is explained, comes back from TOML and JSON as it was, and is run,
//! with less time and smaller searches where the whole would take too long: nothing panics, the audit finds no violation,
//! the recording comes back bit for bit, there is an outcome, and time that is cut into slices changes nothing.
//!
//! `tests/fuzz/mod.rs` says which variables of the environment ask for more cases, or for one.

use std::sync::LazyLock;

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::scenario::{BUILT_IN, LoadedScenario, MemoryLimit, Scenario, explain};
use wildfire::sim::{self, Run, RunError, Simulation};
use wildfire::time::SimTime;
use wildfire::timeline::{Outcome, Timeline, file};

use super::fuzz::{Case, Fuzzer, Law, below, one_of, text};
use super::grammar::{Grammar, MAP, WEATHER, WEATHER_TEXT, refusal_names_its_place};

/// The number of cases that are run where nobody asks for more.
const CASES: u64 = 100;

/// The most that a run may cost: simulated seconds, trucks, Wumpuses.
const MAX_SECONDS: f64 = 200.0;
const MAX_TRUCKS: usize = 3;
const MAX_WUMPUSES: usize = 6;
/// The most of searches: samples, tries, expansions, bins, points.
const MAX_SAMPLES: u32 = 300;
const MAX_NEIGHBOURS: u32 = 20;
const MAX_SHORTCUTS: u32 = 100;
const MAX_EXPANSIONS: u32 = 3000;
const MAX_BINS: f64 = 1e6;
const MAX_POINTS: f64 = 1e4;
/// Square metres of a field with trucks, which the flood of poses may have to fill.
const MAX_FIELD_M2: f64 = 260.0 * 260.0;

/// The longest ways that are audited in the finest steps.
const MAX_FINELY_AUDITED_M: f64 = 500.0;

static GRAMMAR: LazyLock<Grammar> = LazyLock::new(Grammar::new);

#[test]
fn scenarios_by_grammar_and_mutation_keep_the_rules() {
    let fuzzer = Fuzzer { name: "scenarios", target: "--test contest", law: scenario_keeps_the_rules };
    let tally = fuzzer.run(CASES);
    let count = |sort: &str| tally.get(sort).copied().unwrap_or_default();
    let all: u64 = ["refused", "ran", "did not begin", "too large to be run"].into_iter().map(count).sum();
    // A fuzzer whose scenarios are all refused would find nothing.
    assert!(all < 100 || 2 * count("ran") >= all, "{} of {all} ran", count("ran"));
}

#[test]
fn grammar_knows_the_ranges_of_numbers() {
    let ranges = GRAMMAR.ranges();
    assert!(ranges.len() > 80, "{} ranges were read from refusals", ranges.len());
    assert_eq!(ranges["unimog.prm.samples"], [0.0, 100_000.0]);
}

fn scenario_keeps_the_rules(case: &mut Case<'_>) -> Law {
    let (source, changes) = write_scenario(case);
    let loaded = match LoadedScenario::open(&source, &changes) {
        Ok(loaded) => loaded,
        Err(refusal) => {
            case.count("refused");
            return refusal_names_its_place(&refusal);
        }
    };
    explain(&loaded, MemoryLimit::default()).to_text();
    loaded.values();
    scenario_comes_back(&loaded.scenario)?;
    let Some(scenario) = affordable(&loaded.scenario) else {
        case.count("too large to be run");
        return Ok(());
    };
    scenario.check().map_err(|fault| format!("less of an accepted scenario is refused: {fault}"))?;
    if scenario != loaded.scenario {
        case.count("of these with less time or smaller searches");
    }
    let seed = below(&mut case.dice, 1000) as u64;
    match sim::run(&scenario, seed) {
        Ok(run) => {
            case.count("ran");
            run_keeps_the_rules(case, &scenario, seed, &run)
        }
        Err(
            RunError::Terrain(_)
            | RunError::NoFreeStart { .. }
            | RunError::NoPlanner { .. }
            | RunError::NoPrograms { .. }
            | RunError::NoPolicy { .. },
        ) => {
            case.count("did not begin");
            Ok(())
        }
        Err(RunError::Memory(_)) => {
            case.count("would take more memory than it may");
            Ok(())
        }
        Err(error @ (RunError::Stopped | RunError::NotForked(_) | RunError::FixedInRun { .. })) => {
            Err(format!("nobody asked for this: {error}"))
        }
    }
}

/// Writes a scenario, and returns its path and changes to it.
fn write_scenario(case: &mut Case<'_>) -> (String, Vec<String>) {
    let written = if case.chance(85) {
        case.count("by grammar");
        let written = GRAMMAR.draw(&mut case.dice);
        if let Some(map) = &written.map {
            case.write(MAP, map.as_bytes());
        }
        case.write(WEATHER, WEATHER_TEXT.as_bytes());
        let text = toml::to_string(&written.scenario).expect("what was drawn can be written");
        let text = text.into_bytes();
        // Most of what is changed in the text is refused.
        if case.chance(10) { text::mutated(&mut case.dice, &[text], &[]) } else { text }
    } else {
        case.count("by mutation");
        let samples: Vec<&str> = BUILT_IN.iter().map(|(_, text)| *text).collect();
        text::mutated(&mut case.dice, &samples, &[])
    };
    case.input = written;
    let path = case.write("scenario.toml", &case.input);
    let mut changes = Vec::new();
    if case.chance(10) {
        changes.push((*one_of(&mut case.dice, CHANGES)).to_owned());
        case.input.extend(format!("\n# --set {}\n", changes[0]).bytes());
    }
    (path.to_str().expect("scratch folders have plain names").to_owned(), changes)
}

/// Changes that reach settings that are seldom drawn.
const CHANGES: &[&str] = &[
    "unimog.planner=prm+primitives",
    "unimog.planner=hybrid-astar",
    "unimog.planner=lattice",
    "unimog.retarget=on-event",
    "unimog.limits={ acceleration_mps2 = 1.0, braking_mps2 = 2.0, lateral_mps2 = 3.0 }",
    "suppression.extinguishes=all-in-reach",
    "suppression.reach_m=none",
    "fire.relight=true",
    "wumpus.planner=potential",
    "field.overlaps=dropped",
];

/// Checks that a scenario that is accepted is the same when it is written and read.
fn scenario_comes_back(scenario: &Scenario) -> Law {
    let text = toml::to_string(scenario).map_err(|error| format!("it cannot be written as TOML: {error}"))?;
    let back: Scenario = toml::from_str(&text).map_err(|error| format!("it does not come back from TOML: {error}"))?;
    if back != *scenario {
        return Err("another scenario comes back from TOML".into());
    }
    let json = serde_json::to_string(scenario).map_err(|error| format!("it cannot be written as JSON: {error}"))?;
    let back: Scenario = serde_json::from_str(&json).map_err(|error| format!("no JSON that comes back: {error}"))?;
    if back != *scenario {
        return Err("another scenario comes back from JSON".into());
    }
    back.check().map_err(|fault| format!("it is refused once it was written: {fault}"))
}

/// Returns the scenario with no more of anything than a test can afford; `None` if its field is too large.
fn affordable(scenario: &Scenario) -> Option<Scenario> {
    let mut less = scenario.clone();
    less.duration_s = less.duration_s.min(MAX_SECONDS);
    less.unimog.truncate(MAX_TRUCKS);
    less.wumpus.truncate(MAX_WUMPUSES);
    let frame = less.field.frame();
    let area_m2 = frame.width_m() * frame.height_m();
    if !less.unimog.is_empty() && area_m2 > MAX_FIELD_M2 || frame.cell_count() > 10_000 {
        return None;
    }
    for truck in &mut less.unimog {
        let few = |number: &mut u32, max| *number = (*number).min(max);
        few(&mut truck.prm.samples, MAX_SAMPLES);
        few(&mut truck.prm.neighbours, MAX_NEIGHBOURS);
        few(&mut truck.prm_rs.samples, MAX_SAMPLES);
        few(&mut truck.prm_rs.neighbours, MAX_NEIGHBOURS);
        few(&mut truck.prm_rs.shortcuts, MAX_SHORTCUTS);
        few(&mut truck.hybrid.shortcuts, MAX_SHORTCUTS);
        few(&mut truck.hybrid.max_expansions, MAX_EXPANSIONS);
        few(&mut truck.primitives.max_expansions, MAX_EXPANSIONS);
        few(&mut truck.lattice.max_expansions, 100 * MAX_EXPANSIONS);
        for density in [&mut truck.prm.samples_per_hectare, &mut truck.prm_rs.samples_per_hectare] {
            *density = density.map(|density| density.min(f64::from(MAX_SAMPLES) * 10_000.0 / area_m2));
        }
        for (bin_m, headings) in
            [(&mut truck.hybrid.bin_m, truck.hybrid.headings), (&mut truck.primitives.bin_m, truck.primitives.headings)]
        {
            *bin_m = bin_m.max((area_m2 * f64::from(headings) / MAX_BINS).sqrt());
        }
    }
    for wumpus in &mut less.wumpus {
        wumpus.lattice_m = wumpus.lattice_m.filter(|lattice_m| area_m2 / (lattice_m * lattice_m) <= MAX_POINTS);
    }
    Some(less)
}

fn run_keeps_the_rules(case: &mut Case<'_>, scenario: &Scenario, seed: u64, run: &Run) -> Law {
    let timeline = &run.timeline;
    let outcome = Outcome::new(timeline);
    if outcome.agents.len() != scenario.wumpus.len() + scenario.unimog.len() {
        return Err(format!("an outcome of {} agents", outcome.agents.len()));
    }
    let bytes = file::encode(timeline).map_err(|error| format!("it cannot be recorded: {error}"))?;
    let back = file::decode(&bytes).map_err(|error| format!("its recording cannot be read: {error}"))?;
    if back != *timeline {
        return Err("its recording is another run".into());
    }
    let verdict = audit_timeline(&back, step_of(&outcome));
    if let Some(violation) = verdict.violation {
        return Err(format!("seed {seed}: {violation}"));
    }
    if !verdict.knows_limits {
        return Err("the audit does not know its limits".into());
    }
    if case.chance(10) { slices_change_nothing(case, scenario, seed, timeline) } else { Ok(()) }
}

/// Chooses the step of the audit: the default one where that takes few looks, a coarser one on long ways.
fn step_of(outcome: &Outcome) -> SampleStep {
    let metres: f64 = outcome.agents.iter().map(|agent| agent.distance_m).sum();
    let coarser = (metres / MAX_FINELY_AUDITED_M).max(1.0);
    let SampleStep { metres, degrees } = SampleStep::default();
    SampleStep { metres: metres * coarser, degrees: degrees * coarser }
}

fn slices_change_nothing(case: &mut Case<'_>, scenario: &Scenario, seed: u64, whole: &Timeline) -> Law {
    case.count("of these again, in slices");
    let mut sliced = Simulation::new(scenario, seed).map_err(|error| format!("it ran once, and now {error}"))?;
    let mut until = SimTime::ZERO;
    for _ in 0..16 {
        sliced.advance_to(until);
        let longest = *one_of(&mut case.dice, &[1, 1_000, 3_000_000_000, 90_000_000_000]);
        until += SimTime::from_nanos(below(&mut case.dice, longest) as u64);
    }
    sliced.advance_to(SimTime::MAX);
    if sliced.finish().timeline == *whole { Ok(()) } else { Err("run again, in slices, it is another run".into()) }
}
