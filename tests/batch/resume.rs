//! Batches that are stopped, torn or damaged, and gone on with.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use wildfire::batch::execute::{Batch, BatchError, JournalError, OutputFolder};
use wildfire::batch::plan::{PlanError, Record, Slice};

use crate::made_up::{made_up_run, made_up_runs_until, outcomes, plan, run};

const SEEDS: &str = "1..60";

fn folder(path: &Path) -> OutputFolder {
    OutputFolder::shared(path).expect("a scratch folder")
}

/// Runs until so many runs have begun, and these to their end.
fn begin_and_stop(path: &Path, after: u64) {
    let stop = Arc::new(AtomicBool::new(false));
    let mut batch = Batch::begin(plan(SEEDS, Record::None), folder(path)).expect("the disk is fine");
    let stopped = batch.run_with(made_up_runs_until(after, &stop), 2, &stop, |_| {});
    assert!(matches!(stopped, Err(BatchError::Stopped)), "{stopped:?}");
}

fn resume(path: &Path) -> Result<(), BatchError> {
    let stop = Arc::default();
    let mut batch = Batch::resume(folder(path), Slice::WHOLE)?;
    batch.run_with(Box::new(made_up_run), 2, &stop, |_| {})?;
    batch.finish(&stop).map(drop)
}

fn assert_like_the_uninterrupted(path: &Path, uninterrupted: &Path) {
    for file in ["runs.csv", "agents.csv"] {
        assert_eq!(outcomes(&path.join(file)), outcomes(&uninterrupted.join(file)), "{file}");
    }
}

#[test]
fn stopped_batch_goes_on_where_it_was() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (stopped, whole) = (scratch.path().join("stopped"), scratch.path().join("whole"));
    run(&whole, SEEDS, 1);
    begin_and_stop(&stopped, 20);
    assert!(!stopped.join("runs.csv").exists(), "there are no tables of half a batch");
    let batch = Batch::resume(folder(&stopped), Slice::WHOLE).expect("it can be resumed");
    let stored = batch.progress().stored();
    assert!((20..60).contains(&stored), "{stored} runs were over");
    drop(batch);
    resume(&stopped).expect("it can be resumed");
    assert_like_the_uninterrupted(&stopped, &whole);
    resume(&stopped).expect("a batch that is complete may be resumed too");
    assert_like_the_uninterrupted(&stopped, &whole);
}

#[test]
fn journal_torn_anywhere_loses_no_more_than_what_was_torn() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (torn, whole) = (scratch.path().join("torn"), scratch.path().join("whole"));
    run(&whole, SEEDS, 1);
    run(&torn, SEEDS, 1);
    let journal = fs::read(torn.join("runs.journal")).expect("it is there");
    // Cuts in the first line, about the ends of all, and enough between them to make a thousand.
    let ends = journal.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at);
    let near_ends = ends.flat_map(|end| end.saturating_sub(1)..=end + 1);
    let spread = (0..1000).map(|index| index * journal.len() / 1000);
    let mut cuts: Vec<usize> = (0..200).step_by(10).chain(near_ends).chain(spread).collect();
    cuts.sort_unstable();
    cuts.dedup();
    assert!(cuts.len() >= 1000);
    for (index, &cut) in cuts.iter().enumerate() {
        fs::write(torn.join("runs.journal"), &journal[..cut.min(journal.len())]).expect("writable");
        let lines = journal[..cut.min(journal.len())].iter().filter(|&&byte| byte == b'\n').count() as u64;
        let batch = Batch::resume(folder(&torn), Slice::WHOLE).expect("it is torn, not damaged");
        assert_eq!(batch.progress().stored(), lines.saturating_sub(1), "cut at {cut}");
        drop(batch);
        // Going on is the slow part, and the same whatever is missing.
        if index % 100 == 0 {
            fs::remove_file(torn.join("runs.csv")).expect("it is there");
            resume(&torn).expect("it is torn, not damaged");
            assert_like_the_uninterrupted(&torn, &whole);
        }
    }
}

#[test]
fn damage_before_the_end_is_named_with_its_line() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run(scratch.path(), "1..5", 1);
    let path = scratch.path().join("runs.journal");
    let journal = fs::read_to_string(&path).expect("it is there");
    let lines: Vec<&str> = journal.lines().collect();
    let refusal = |lines: &[&str]| {
        fs::write(&path, lines.join("\n") + "\n").expect("writable");
        match Batch::resume(folder(scratch.path()), Slice::WHOLE) {
            Err(BatchError::Journal(JournalError::Damaged { line, reason, .. })) => (line, reason),
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("{lines:?} is not damaged"),
        }
    };
    let changed = lines[3].replacen("\"seed\":", "\"seed\":1", 1);
    assert_eq!(refusal(&[lines[0], lines[1], lines[2], &changed]), (4, "its checksum is wrong".into()));
    assert_eq!(refusal(&[lines[0], lines[1], "", lines[3]]), (3, "it does not begin with a checksum".into()));
    assert_eq!(refusal(&[lines[0], lines[1], &lines[2][..50], lines[3]]).0, 3);
    let forged = lines[2][9..].replacen("\"intact\":", "\"intact\":1", 1);
    let forged = format!("{:08x} {forged}", crc32fast::hash(forged.as_bytes()));
    let (line, reason) = refusal(&[lines[0], lines[2], &forged]);
    assert!(line == 3 && reason.starts_with("run 2 appears twice with different results: its row has "), "{reason}");
    assert_eq!(refusal(&[lines[1], lines[2]]).0, 1);
    assert_eq!(refusal(&[lines[0], lines[0]]).0, 2);
}

#[test]
fn second_process_on_a_batch_is_refused() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let first = Batch::begin(plan(SEEDS, Record::None), folder(scratch.path())).expect("the disk is fine");
    let is_locked = |second: Result<Batch, BatchError>| {
        matches!(second.map(drop), Err(BatchError::Journal(JournalError::Locked { .. })))
    };
    assert!(is_locked(Batch::resume(folder(scratch.path()), Slice::WHOLE)));
    assert!(is_locked(Batch::begin(plan(SEEDS, Record::None), folder(scratch.path()))));
    assert!(scratch.path().join("plan.json").exists(), "the first one's plan is still there");
    drop(first);
    resume(scratch.path()).expect("nobody works on it now");
}

#[test]
fn changed_scenario_is_refused_with_the_difference() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let source = scratch.path().join("mine.toml");
    let smoke = wildfire::scenario::BUILT_IN.iter().find(|(name, _)| *name == "smoke").expect("it is built in").1;
    fs::write(&source, smoke).expect("writable");
    let request = wildfire::batch::plan::BatchRequest {
        scenarios: vec![source.display().to_string()],
        ..wildfire::batch::plan::BatchRequest::default()
    };
    let plan = request.resolve(false).expect("a small batch");
    drop(Batch::begin(plan, folder(&scratch.path().join("out"))).expect("the disk is fine"));
    let out = || folder(&scratch.path().join("out"));
    assert!(Batch::resume(out(), Slice::WHOLE).is_ok(), "nothing has changed");
    fs::write(&source, smoke.replace("burn_out_s = 60.0", "burn_out_s = 30.0")).expect("writable");
    match Batch::resume(out(), Slice::WHOLE).map(drop) {
        Err(BatchError::Plan(PlanError::SourceChanged { differences, .. })) => {
            assert_eq!(differences, ["fire.burn_out_s is 60.0 there, but 30.0 was requested"]);
        }
        other => panic!("{other:?}"),
    }
    fs::remove_file(&source).expect("it is there");
    assert!(Batch::resume(out(), Slice::WHOLE).is_ok(), "the plan has all that is needed");
}

#[test]
fn folder_without_a_batch_is_named() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let refusal = Batch::resume(folder(scratch.path()), Slice::WHOLE).map(drop).expect_err("it is empty");
    assert!(matches!(refusal, BatchError::Plan(PlanError::Missing { .. })), "{refusal}");
    run(scratch.path(), "1..5", 1);
    fs::remove_file(scratch.path().join("runs.journal")).expect("it is there");
    let refusal = Batch::resume(folder(scratch.path()), Slice::WHOLE).map(drop).expect_err("its journal is gone");
    assert!(matches!(refusal, BatchError::NoJournal { .. }), "{refusal}");
}

#[test]
fn what_a_killed_process_left_aside_is_removed_and_named() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    begin_and_stop(scratch.path(), 20);
    let left = ["plan.json.123.part", "runs.csv.7.part"].map(|name| scratch.path().join(name));
    let mine = scratch.path().join("mine.csv.7.part");
    for path in left.iter().chain([&mine]) {
        fs::write(path, "half").expect("writable");
    }
    let batch = Batch::resume(folder(scratch.path()), Slice::WHOLE).expect("it can be resumed");
    assert_eq!(batch.found().leftovers, left);
    assert!(left.iter().all(|path| !path.exists()) && mine.exists());
}

#[test]
fn batch_that_was_killed_before_its_plan_appeared_is_begun_again_without_force() {
    for has_journal in [false, true] {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let left = scratch.path().join("plan.json.123.part");
        fs::write(&left, "{").expect("writable");
        if has_journal {
            fs::write(scratch.path().join("runs.journal"), "").expect("writable");
        }
        match Batch::resume(folder(scratch.path()), Slice::WHOLE).map(drop) {
            Err(BatchError::NotStarted { leftover, .. }) => assert_eq!(leftover, "plan.json.123.part"),
            other => panic!("{other:?}"),
        }
        let empty = OutputFolder::named(scratch.path(), false).expect("nothing of worth is there");
        let batch = Batch::begin(plan(SEEDS, Record::None), empty).expect("the disk is fine");
        assert_eq!(batch.found().leftovers, std::slice::from_ref(&left));
        assert!(!left.exists());
    }
}
