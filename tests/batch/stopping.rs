//! Batches that a rule stops when enough is known.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use wildfire::batch::comparison::{ComparisonError, Questions, RankingRequest, Selection, Verdict, compare, rank};
use wildfire::batch::execute::{Batch, BatchError, OutputFolder, RunScenario};
use wildfire::batch::plan::{BatchPlan, Record, Slice, StoppingGoal, StoppingRule, Value, Variant};
use wildfire::batch::stopping::{Look, PlayedBatch, StopError, StopRequest, Until};
use wildfire::batch::table::FinishedBatch;
use wildfire::scenario::Scenario;

use crate::made_up::{made_up_run, outcomes, plan};

const DECIDED: StoppingGoal = StoppingGoal::Decided { margin: 0.0 };

/// Two variants, the second of which saves all bushes where it is the better one.
fn two_variants(seeds: &str, goal: StoppingGoal, record: Record) -> BatchPlan {
    let one = plan(seeds, record);
    let other = Variant {
        scenario: Scenario { name: "better".into(), ..one.variants[0].scenario.clone() },
        ..one.variants[0].clone()
    };
    let until = StoppingRule { metric: "saved".into(), goal, max_seeds: one.seeds.clone(), played: Vec::new() };
    BatchPlan { variants: vec![one.variants[0].clone(), other], until: Some(until), ..one }
}

/// Seeds that fail or panic do so in both variants.
fn simulation(is_better: bool) -> Box<RunScenario> {
    Box::new(move |scenario: &Scenario, seed| {
        let run = made_up_run(scenario, seed)?;
        if is_better && scenario.name == "better" { made_up_run(scenario, 7 * 10 * seed) } else { Ok(run) }
    })
}

fn folder(path: &Path) -> OutputFolder {
    OutputFolder::shared(path).expect("a scratch folder")
}

fn finish(batch: Batch, is_better: bool, jobs: usize) -> Look {
    let stop = Arc::default();
    let PlayedBatch { batch, look } =
        batch.run_until(simulation(is_better), jobs, &stop, |_| {}, |_| {}).expect("the disk is fine");
    batch.finish(&stop).expect("the disk is fine");
    look.expect("there is a rule")
}

fn assert_same_rows(one: &Path, other: &Path) {
    for file in ["runs.csv", "agents.csv"] {
        assert_eq!(outcomes(&one.join(file)), outcomes(&other.join(file)), "{file}");
    }
}

#[test]
fn rows_are_those_of_a_batch_of_these_seeds_for_all_workers_and_interruptions() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = |name: &str| scratch.path().join(name);
    let stopping = || two_variants("1..200", DECIDED, Record::None);
    for jobs in [1, 3] {
        let batch = Batch::begin(stopping(), folder(&path(&jobs.to_string()))).expect("the disk is fine");
        let look = finish(batch, true, jobs);
        // Of the first 20 seeds three fail, so that there are 20 pairs after 30.
        assert_eq!((look.seeds, look.is_over(), look.estimates.len()), (30, true, 1));
    }
    let fixed = BatchPlan { until: None, ..two_variants("1..30", DECIDED, Record::None) };
    let batch = Batch::begin(fixed, folder(&path("fixed"))).expect("the disk is fine");
    let PlayedBatch { batch, look } =
        batch.run_until(simulation(true), 1, &Arc::default(), |_| {}, |_| {}).expect("the disk is fine");
    assert_eq!(look, None);
    batch.finish(&AtomicBool::new(false)).expect("the disk is fine");
    for runs in [1, 25, 45, 59] {
        let (stop, started) = (Arc::new(AtomicBool::new(false)), AtomicU64::new(0));
        let (flag, run) = (Arc::clone(&stop), simulation(true));
        let stopped: Box<RunScenario> = Box::new(move |scenario, seed| {
            if started.fetch_add(1, Ordering::Relaxed) + 1 >= runs {
                flag.store(true, Ordering::Relaxed);
            }
            run(scenario, seed)
        });
        let batch = Batch::begin(stopping(), folder(&path(&format!("at-{runs}")))).expect("the disk is fine");
        let result = batch.run_until(stopped, 2, &stop, |_| {}, |_| {}).map(drop);
        assert!(matches!(result, Err(BatchError::Stopped)), "after {runs} runs");
        let batch = Batch::resume(folder(&path(&format!("at-{runs}"))), Slice::WHOLE).expect("it can be resumed");
        assert_eq!(finish(batch, true, 2).seeds, 30);
        assert_same_rows(&path(&format!("at-{runs}")), &path("fixed"));
    }
    assert_same_rows(&path("1"), &path("fixed"));
    assert_same_rows(&path("3"), &path("fixed"));
    let finished = FinishedBatch::open(&path("1")).expect("it is finished");
    assert_eq!(finished.plan().seeds.to_string(), "1..30");
    assert_eq!(finished.plan().stop_text().as_deref(), Some("saved decided, after 30 of at most 200 seeds"));
}

#[test]
fn crash_between_journal_and_plan_is_made_up_for() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = scratch.path();
    let batch = Batch::begin(two_variants("1..200", DECIDED, Record::All), folder(path)).expect("the disk is fine");
    let before = fs::read(path.join("plan.json")).expect("it was written");
    finish(batch, true, 2);
    let rows = outcomes(&path.join("runs.csv"));
    fs::write(path.join("plan.json"), before).expect("writable");
    fs::remove_file(path.join("runs.csv")).expect("it was written");
    let batch = Batch::resume(folder(path), Slice::WHOLE).expect("it can be resumed");
    assert_eq!(batch.plan().seeds.to_string(), "1..30");
    finish(batch, true, 2);
    assert_eq!(outcomes(&path.join("runs.csv")), rows);
    let finished = FinishedBatch::open(path).expect("it is finished");
    let recorded = finished.runs().filter(|run| finished.recording(run).is_some()).count();
    assert_eq!(recorded, 2 * (30 - 3 - 1), "all but those that fail or panic");
}

#[test]
fn what_does_not_differ_plays_all_seeds() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    for (goal, seeds, is_over) in [
        (DECIDED, 75, false),
        // All differences are zero, which shows nothing of others.
        (StoppingGoal::Decided { margin: 0.5 }, 75, false),
        (StoppingGoal::Within { half_width: 0.5 }, 75, false),
    ] {
        let path = scratch.path().join(format!("{goal:?}"));
        let batch = Batch::begin(two_variants("1..75", goal, Record::None), folder(&path)).expect("the disk is fine");
        let look = finish(batch, false, 2);
        assert_eq!((look.seeds, look.is_over()), (seeds, is_over), "{goal:?}");
    }
}

#[test]
fn mean_of_an_only_variant_is_settled_to_what_was_asked() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let mut before = 0;
    for half_width in [1.0, 0.5, 0.3] {
        let path = scratch.path().join(half_width.to_string());
        let two = two_variants("1..1000", StoppingGoal::Within { half_width }, Record::None);
        let one = BatchPlan { variants: two.variants[..1].to_vec(), ..two };
        let look = finish(Batch::begin(one, folder(&path)).expect("the disk is fine"), false, 2);
        let interval = look.estimates[0].interval.expect("the values differ");
        assert!(look.is_over() && interval.high - interval.low <= 2.0 * half_width, "{look:?}");
        assert!(look.seeds > before, "narrower intervals need more seeds: {look:?}");
        before = look.seeds;
    }
}

#[test]
fn comparison_has_the_interval_by_which_the_batch_stopped() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let batch =
        Batch::begin(two_variants("1..200", DECIDED, Record::None), folder(scratch.path())).expect("the disk is fine");
    let look = finish(batch, true, 2);
    let selection = Selection { by: Some(("scenario".into(), Vec::new())), ..Selection::default() };
    let paths = [scratch.path().to_owned()];
    let comparison = compare(&paths, &selection, &["saved".to_owned()]).expect("it is finished");
    let judged = &comparison.against_a[0].judged[0];
    assert_eq!((judged.verdict, judged.contrast.p_value), (Verdict::Difference, None));
    let [found, expected] = [judged.contrast.interval, look.estimates[0].interval].map(|it| it.expect("they differ"));
    assert!((found.low - expected.low).abs() < 1e-9 && (found.high - expected.high).abs() < 1e-9);
    let questions = Questions { power: Some("1".parse().expect("an amount")), ..Questions::default() };
    assert!(matches!(comparison.asking(questions), Err(ComparisonError::StoppedByRule { .. })));
}

/// Bushes on fire with an entry, which differ by chance from seed to seed: two entries are equally good.
fn ignited(entry: &str, seed: u64) -> u64 {
    match entry {
        "best" => seed % 3,
        "twin" => (seed + 1) % 3,
        "middle" => (5 * seed + 1) % 5,
        _ => 6 - seed % 2,
    }
}

const ENTRIES: [&str; 4] = ["middle", "best", "worst", "twin"];

fn entries_simulation() -> Box<RunScenario> {
    Box::new(|scenario, seed| made_up_run(scenario, 700 * seed + ignited(&scenario.name, seed)))
}

/// Four entries of a class, of which a rule finds the best.
fn class(seeds: &str, goal: StoppingGoal, record: Record) -> BatchPlan {
    let one = plan(seeds, record);
    let variants = ENTRIES.map(|name| Variant {
        scenario: Scenario { name: name.into(), ..one.variants[0].scenario.clone() },
        swept: vec![Value::Text(name.into())],
        ..one.variants[0].clone()
    });
    let until = StoppingRule { metric: "saved".into(), goal, max_seeds: one.seeds.clone(), played: Vec::new() };
    BatchPlan { variants: variants.to_vec(), swept_keys: vec!["entry".into()], until: Some(until), ..one }
}

fn play(batch: Batch, jobs: usize) -> PlayedBatch {
    let stop = Arc::default();
    let played = batch.run_until(entries_simulation(), jobs, &stop, |_| {}, |_| {}).expect("the disk is fine");
    played.batch.finish(&stop).expect("the disk is fine");
    played
}

const GROUPS: StoppingGoal = StoppingGoal::Groups { margin: 0.0 };

#[test]
fn entries_that_are_worse_are_dropped_and_the_first_group_is_that_of_all_runs() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = |name: &str| scratch.path().join(name);
    for jobs in [1, 3] {
        let name = jobs.to_string();
        let PlayedBatch { batch, look } = play(
            Batch::begin(class("1..120", GROUPS, Record::None), folder(&path(&name))).expect("the disk is fine"),
            jobs,
        );
        let played = batch.plan().played();
        assert!(played[0] < 120 && played[2] == 20 && [played[1], played[3]] == [120, 120], "{played:?}");
        let sentences = look.expect("there is a rule").sentences(batch.plan());
        assert!(sentences[0].contains("best, entry best; twin, entry twin."), "{sentences:?}");
    }
    assert_same_rows(&path("1"), &path("3"));
    let all = BatchPlan { until: None, ..class("1..120", GROUPS, Record::None) };
    play(Batch::begin(all, folder(&path("all"))).expect("the disk is fine"), 2);
    let first_group = |name: &str| {
        let ranking = rank(&[path(name)], &RankingRequest::default()).expect("it is finished");
        let first = ranking.entries.iter().filter(|entry| entry.ranks[0] == 1);
        let mut names: Vec<String> = first.map(|entry| entry.name.clone()).collect();
        names.sort();
        (names, ranking)
    };
    let (names, ranking) = first_group("1");
    assert_eq!(names, ["best", "twin"]);
    assert_eq!(names, first_group("all").0);
    assert_eq!(ranking.stop.as_deref(), Some("the best by saved, after 20 to 120 of at most 120 seeds"));
    let runs: Vec<usize> = ranking.entries.iter().map(|entry| entry.runs).collect();
    assert!(runs[..2] == [120, 120] && runs[3] == 20, "{runs:?}");
    assert!(ranking.pairs.iter().all(|pair| pair.p_adjusted.is_none()), "p-values are for a fixed number of runs");
}

#[test]
fn entries_that_stop_apart_can_be_interrupted_and_lose_nothing_in_a_crash() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = |name: &str| scratch.path().join(name);
    let begin =
        |name: &str| Batch::begin(class("1..60", GROUPS, Record::All), folder(&path(name))).expect("the disk is fine");
    let before = begin("whole");
    let plan_json = fs::read(path("whole").join("plan.json")).expect("it was written");
    let whole = play(before, 2).batch;
    let plan = whole.plan();
    for number in 1..=plan.count() {
        let place = plan.place(number);
        assert_eq!(plan.number(place), number);
        assert_eq!(plan.run(number).seed, plan.seeds.nth(place.seed));
    }
    for runs in [30, 90, 150] {
        let (stop, started, run) = (Arc::new(AtomicBool::new(false)), AtomicU64::new(0), entries_simulation());
        let flag = Arc::clone(&stop);
        let stopped: Box<RunScenario> = Box::new(move |scenario, seed| {
            if started.fetch_add(1, Ordering::Relaxed) + 1 >= runs {
                flag.store(true, Ordering::Relaxed);
            }
            run(scenario, seed)
        });
        let name = format!("at-{runs}");
        let result = begin(&name).run_until(stopped, 2, &stop, |_| {}, |_| {}).map(drop);
        assert!(matches!(result, Err(BatchError::Stopped)), "after {runs} runs");
        play(Batch::resume(folder(&path(&name)), Slice::WHOLE).expect("it can be resumed"), 2);
        assert_same_rows(&path(&name), &path("whole"));
    }
    // As after a crash between journal and plan.
    fs::write(path("at-30").join("plan.json"), plan_json).expect("writable");
    fs::remove_file(path("at-30").join("runs.csv")).expect("it was written");
    let resumed = Batch::resume(folder(&path("at-30")), Slice::WHOLE).expect("it can be resumed");
    assert_eq!(resumed.plan().played(), plan.played());
    play(resumed, 2);
    assert_same_rows(&path("at-30"), &path("whole"));
    let finished = FinishedBatch::open(&path("at-30")).expect("it is finished");
    assert!(finished.runs().all(|run| finished.recording(&run).is_some()));
}

/// The batch of a plan that has stopped is played again with the same runs.
#[test]
fn plan_of_a_batch_that_stopped_gives_the_same_rows() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = |name: &str| scratch.path().join(name);
    let begin = |plan: BatchPlan, name: &str| Batch::begin(plan, folder(&path(name))).expect("the disk is fine");
    play(begin(class("1..60", GROUPS, Record::None), "once"), 2);
    let again = BatchPlan::read(&path("once")).expect("it was written");
    play(begin(again, "again"), 2);
    assert_same_rows(&path("once"), &path("again"));
}

/// A plan can be written by anybody, and then its metric need not have a better side.
#[test]
fn groups_of_a_metric_without_a_better_side_are_those_of_the_most() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let of_class = class("1..30", GROUPS, Record::None);
    let until = of_class.until.clone().map(|rule| StoppingRule { metric: "wumpus_distance_m".into(), ..rule });
    let plan = BatchPlan { until, ..of_class };
    let PlayedBatch { batch, .. } = play(Batch::begin(plan, folder(scratch.path())).expect("the disk is fine"), 2);
    assert_eq!(batch.plan().played(), [30; 4], "no Wumpus walks, so that all are equal");
}

#[test]
fn groups_of_one_entry_are_refused() {
    let of_class = class("1..30", GROUPS, Record::None);
    let request = StopRequest { until: Until::Groups, metric: None, equivalent: None };
    assert!(request.rule(&of_class).is_ok());
    // Without a column of entries, the scenarios are what one entry is averaged over.
    let variants = of_class.variants.iter().map(|variant| Variant { swept: Vec::new(), ..variant.clone() }).collect();
    let plan = BatchPlan { swept_keys: Vec::new(), variants, ..of_class };
    assert!(matches!(request.rule(&plan), Err(StopError::OneEntry)));
}

#[test]
fn pairs_of_a_sweep_stop_by_themselves() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let of_class = class("1..100", DECIDED, Record::None);
    // Two coverages of two planners: at one of them the planners are equal.
    let swept = ["0.1", "0.2", "0.1", "0.2"].map(|value| vec![Value::Text(value.into())]);
    let named = ["best", "best", "worst", "twin"];
    let variants = of_class.variants.iter().zip(swept).zip(named).map(|((variant, swept), name)| Variant {
        scenario: Scenario { name: name.into(), ..variant.scenario.clone() },
        swept,
        ..variant.clone()
    });
    let plan = BatchPlan { variants: variants.collect(), ..of_class };
    let PlayedBatch { batch, .. } = play(Batch::begin(plan, folder(scratch.path())).expect("the disk is fine"), 2);
    assert_eq!(batch.plan().played(), [20, 100, 20, 100]);
    let stop = batch.plan().stop_text();
    assert_eq!(stop.as_deref(), Some("saved decided, after 20 to 100 of at most 100 seeds"));
}
