//! Recordings that are lost, and made again when their batch is resumed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use wildfire::batch::execute::{Batch, BatchError, OutputFolder, RunScenario};
use wildfire::batch::plan::{Record, Slice};
use wildfire::scenario::Scenario;
use wildfire::sim::{Run, RunError};

use crate::made_up::{made_up_run, plan, run_plan};

/// Seeds of which runs 8 and 18 fail, and run 13 panics.
const SEEDS: &str = "1..20";

fn recording(folder: &Path, seed: u64) -> PathBuf {
    folder.join(format!("recordings/seed-{seed}.wildfire"))
}

fn record_all(folder: &Path) {
    run_plan(folder, plan(SEEDS, Record::All), 2, Box::new(made_up_run)).expect("the disk is fine");
}

fn resumed(folder: &Path, slice: Slice) -> Batch {
    Batch::resume(OutputFolder::existing(folder).expect("it is there"), slice).expect("it can be resumed")
}

fn lost(batch: &Batch) -> Vec<(u64, &str)> {
    batch.found().lost_recordings.iter().map(|lost| (lost.run, lost.reason.as_str())).collect()
}

fn go_on(batch: &mut Batch, run: Box<RunScenario>, stop: bool) -> Result<(), BatchError> {
    let stop = Arc::new(AtomicBool::new(stop));
    batch.run_with(run, 2, &stop, |_| {})?;
    batch.finish(&stop).map(drop)
}

/// Reads every file of a folder, except for the tables in which something is measured.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let recordings = (1..=20).map(|seed| recording(folder, seed)).filter(|path| path.exists());
    let paths = recordings.chain([folder.join("runs.journal"), folder.join("runs.csv")]);
    paths.map(|path| (path.clone(), fs::read(path).expect("it is there"))).collect()
}

#[test]
fn lost_recordings_of_a_finished_batch_are_made_again_and_nothing_else_changes() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = scratch.path();
    record_all(folder);
    let before = contents(folder);
    assert_eq!(before.len(), 17 + 2);
    assert_eq!(lost(&resumed(folder, Slice::WHOLE)), [], "failed runs have no recording that could be lost");

    fs::remove_file(recording(folder, 1)).expect("it is there");
    fs::write(recording(folder, 2), "").expect("writable");
    let whole = fs::read(recording(folder, 3)).expect("it is there");
    fs::write(recording(folder, 3), &whole[..whole.len() - 1]).expect("writable");
    let mut changed = fs::read(recording(folder, 4)).expect("it is there");
    *changed.last_mut().expect("it has bytes") ^= 1;
    fs::write(recording(folder, 4), changed).expect("writable");

    let mut batch = resumed(folder, Slice::WHOLE);
    let found = lost(&batch);
    assert_eq!(found.iter().map(|(run, _)| *run).collect::<Vec<_>>(), [1, 2, 3, 4]);
    for ((_, reason), fragment) in found.iter().zip(["missing", "truncated", "truncated", "checksum"]) {
        assert!(reason.contains(fragment), "{reason}");
    }
    go_on(&mut batch, Box::new(made_up_run), false).expect("the disk is fine");
    drop(batch);
    assert!(contents(folder) == before, "another recording, row or journal");
    assert_eq!(lost(&resumed(folder, Slice::WHOLE)), []);
}

#[test]
fn lost_recordings_of_half_a_batch_are_made_again_before_it_goes_on() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = scratch.path();
    record_all(folder);
    // Six lines are a head and five runs, in whatever order two workers ended them.
    let journal = fs::read_to_string(folder.join("runs.journal")).expect("it is there");
    let kept: String = journal.split_inclusive('\n').take(6).collect();
    fs::write(folder.join("runs.journal"), kept).expect("writable");
    fs::remove_dir_all(folder.join("recordings")).expect("it is there");
    let mut batch = resumed(folder, Slice::WHOLE);
    assert_eq!(batch.progress().stored(), 5);
    assert!((3..=5).contains(&lost(&batch).len()), "{:?}", lost(&batch));
    go_on(&mut batch, Box::new(made_up_run), false).expect("the disk is fine");
    assert_eq!(contents(folder).len(), 17 + 2);
}

#[test]
fn slice_mends_its_own_recordings_only() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let folder = || OutputFolder::shared(scratch.path()).expect("a scratch folder");
    let slices = [1, 2].map(|number| Slice::new(number, 2).expect("a slice"));
    for slice in slices {
        let mut batch = Batch::join(plan(SEEDS, Record::All), folder(), slice).expect("the disk is fine");
        batch.run_with(Box::new(made_up_run), 2, &Arc::default(), |_| {}).expect("the disk is fine");
    }
    fs::remove_dir_all(scratch.path().join("recordings")).expect("it is there");
    let mut batch = resumed(scratch.path(), slices[0]);
    let runs: Vec<u64> = lost(&batch).into_iter().map(|(run, _)| run).collect();
    assert_eq!(runs.len(), 9, "all of its ten but run 13");
    assert!(runs.iter().all(|run| run % 2 == 1), "{runs:?}");
    batch.run_with(Box::new(made_up_run), 2, &Arc::default(), |_| {}).expect("the disk is fine");
    assert!(recording(scratch.path(), 1).exists() && !recording(scratch.path(), 2).exists());
}

#[test]
fn batch_that_is_stopped_before_its_recordings_are_back_is_not_over() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    record_all(scratch.path());
    fs::remove_file(recording(scratch.path(), 1)).expect("it is there");
    let mut batch = resumed(scratch.path(), Slice::WHOLE);
    let stopped = go_on(&mut batch, Box::new(made_up_run), true);
    assert!(matches!(stopped, Err(BatchError::Stopped)), "{stopped:?}");
    go_on(&mut batch, Box::new(made_up_run), false).expect("the disk is fine");
    assert!(recording(scratch.path(), 1).exists());
}

/// Computes a run as another machine might.
fn other_run(scenario: &Scenario, seed: u64) -> Result<Run, RunError> {
    made_up_run(scenario, seed + 1)
}

#[test]
fn run_that_is_another_than_its_row_says_is_not_recorded() {
    for seed in [1, 7] {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        record_all(scratch.path());
        fs::remove_file(recording(scratch.path(), seed)).expect("it is there");
        let mut batch = resumed(scratch.path(), Slice::WHOLE);
        match go_on(&mut batch, Box::new(other_run), false) {
            Err(BatchError::OtherOutcome { path, .. }) => assert_eq!(path, recording(scratch.path(), seed)),
            other => panic!("{other:?}"),
        }
        assert!(!recording(scratch.path(), seed).exists());
    }
}

#[test]
fn batch_that_records_failures_misses_the_recordings_of_these() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    // The made-up agents do nothing, so that all of them are stuck.
    run_plan(scratch.path(), plan(SEEDS, Record::Failed), 1, Box::new(made_up_run)).expect("the disk is fine");
    let recorded: Vec<u64> = (1..=20).filter(|&seed| recording(scratch.path(), seed).exists()).collect();
    assert_eq!(recorded.len(), 17);
    assert_eq!(lost(&resumed(scratch.path(), Slice::WHOLE)), []);
    fs::remove_dir_all(scratch.path().join("recordings")).expect("it is there");
    let batch = resumed(scratch.path(), Slice::WHOLE);
    assert_eq!(lost(&batch).into_iter().map(|(run, _)| run).collect::<Vec<_>>(), recorded);
}
