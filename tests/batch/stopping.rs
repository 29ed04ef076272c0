//! Batches that a rule stops when enough is known.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use wildfire::batch::comparison::{ComparisonError, Questions, Selection, Verdict, compare};
use wildfire::batch::execute::{Batch, BatchError, OutputFolder, RunScenario};
use wildfire::batch::plan::{BatchPlan, Record, Slice, StoppingGoal, StoppingRule, Variant};
use wildfire::batch::stopping::{Look, PlayedBatch};
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
    let until = StoppingRule { metric: "saved".into(), goal, max_seeds: one.seeds.clone() };
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
