//! Batches on file systems that several machines share: locks, two writers, journals that are written elsewhere, and
//! journals in any order.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use rand::seq::SliceRandom;
use wildfire::batch::execute::{
    Batch, BatchError, JournalError, JournalKeeping, JournalScan, Lock, OutputFolder, RealDisk, batch_status,
};
use wildfire::batch::plan::{BatchPlan, Record, Slice};
use wildfire::batch::report::{Merged, merge, read_rows};

use crate::made_up::{made_up_run, made_up_runs_until, outcomes, plan, run};

const SEEDS: &str = "1..23,100..111";

fn keeping(lock: Lock) -> JournalKeeping {
    JournalKeeping { lock, ..JournalKeeping::default() }
}

fn join(path: &Path, number: u64, of: u64, keeping: JournalKeeping) -> Result<Batch, BatchError> {
    let folder = OutputFolder::shared(path).expect("a scratch folder").with_keeping(keeping);
    Batch::join(plan(SEEDS, Record::None), folder, Slice::new(number, of).expect("a slice"))
}

fn work_off(batch: &mut Batch) -> Result<(), BatchError> {
    batch.run_with(Box::new(made_up_run), 2, &Arc::default(), |_| {})
}

fn run_slices(path: &Path, of: u64) {
    for number in 1..=of {
        work_off(&mut join(path, number, of, JournalKeeping::default()).expect("it is free"))
            .expect("the disk is fine");
    }
}

fn existing(path: &Path) -> OutputFolder {
    OutputFolder::existing(path).expect("it is there")
}

fn merged(path: &Path) -> Result<Merged, BatchError> {
    merge(&existing(path), &RealDisk, &AtomicBool::new(false))
}

fn assert_like_the_whole(path: &Path) {
    let whole = tempfile::tempdir().expect("a scratch folder");
    run(whole.path(), SEEDS, 1);
    for file in ["runs.csv", "agents.csv"] {
        assert_eq!(outcomes(&path.join(file)), outcomes(&whole.path().join(file)), "{file}");
    }
}

fn lines(journal: &Path) -> Vec<String> {
    fs::read_to_string(journal).expect("it is there").lines().map(str::to_owned).collect()
}

fn write_lines(journal: &Path, lines: &[String]) {
    fs::write(journal, lines.join("\n") + "\n").expect("writable");
}

#[test]
fn rows_that_two_processes_made_are_taken_once() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (one, other) = (scratch.path().join("one"), scratch.path().join("other"));
    run_slices(&one, 2);
    run_slices(&other, 2);
    // What is measured differs: the lines are not the same, and what they say of the runs is.
    let journal = one.join("runs-1-of-2.journal");
    let twice = [lines(&journal), lines(&other.join("runs-1-of-2.journal")).split_off(1)].concat();
    write_lines(&journal, &twice);
    let batch = join(&one, 1, 2, JournalKeeping::default()).expect("it is no damage");
    assert_eq!((batch.found().repeated, batch.progress().is_complete()), (18, true));
    drop(batch);
    let status = batch_status(&existing(&one)).expect("it is readable");
    assert_eq!((status.slices[0].1.stored, status.slices[0].1.repeated, status.slices[1].1.repeated), (18, 18, 0));
    assert_eq!(merged(&one).expect("all runs are there").repeated, 18);
    assert_like_the_whole(&one);
}

#[test]
fn rows_of_one_run_that_differ_are_damage() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_slices(scratch.path(), 2);
    let journal = scratch.path().join("runs-1-of-2.journal");
    let mut all = lines(&journal);
    // The first run that is done, whichever of two workers was faster.
    let done = all.iter().find(|line| line.contains("\"intact\":")).expect("some run is done");
    let forged = done[9..].replacen("\"intact\":", "\"intact\":1", 1);
    all.push(format!("{:08x} {forged}", crc32fast::hash(forged.as_bytes())));
    write_lines(&journal, &all);
    let refusals = [
        join(scratch.path(), 1, 2, JournalKeeping::default()).map(drop).expect_err("it is damaged"),
        merged(scratch.path()).expect_err("it is damaged"),
        batch_status(&existing(scratch.path())).map(drop).expect_err("it is damaged"),
    ];
    for refusal in refusals {
        let message = refusal.to_string();
        assert!(message.contains("damaged in line 20: run "), "{message}");
        assert!(message.contains(" appears twice with different results: its row has intact "), "{message}");
    }
}

#[test]
fn second_writer_without_a_lock_is_found_and_nothing_is_lost() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let mut one = join(scratch.path(), 1, 2, keeping(Lock::None)).expect("there is no lock");
    let mut other = join(scratch.path(), 1, 2, keeping(Lock::None)).expect("there is no lock");
    work_off(&mut one).expect("the disk is fine");
    match work_off(&mut other) {
        Err(BatchError::Journal(JournalError::Changed { change, .. })) => {
            assert!(change.contains("that were written"), "{change}");
        }
        ended => panic!("{ended:?}"),
    }
    drop((one, other));
    work_off(&mut join(scratch.path(), 2, 2, JournalKeeping::default()).expect("it is free"))
        .expect("the disk is fine");
    merged(scratch.path()).expect("all runs are there");
    assert_like_the_whole(scratch.path());
}

/// Journals of slices in a folder of their own on a local disk.
fn local(path: &Path) -> JournalKeeping {
    JournalKeeping { local_folder: Some(path.to_owned()), sync_every: Duration::ZERO, ..JournalKeeping::default() }
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("it is there");
    entries.map(|entry| entry.expect("readable").path()).collect()
}

#[test]
fn journal_on_a_local_disk_is_brought_to_its_place_when_the_process_ends_or_is_stopped() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (out, disk) = (scratch.path().join("out"), scratch.path().join("disk"));
    let stop = Arc::new(AtomicBool::new(false));
    let home = out.join("runs-1-of-2.journal");
    let mut batch = join(&out, 1, 2, local(&disk)).expect("it is free");
    let ended = batch.run_with(made_up_runs_until(5, &stop), 1, &stop, |_| {
        assert_eq!(fs::metadata(&home).expect("it is there").len(), 0, "lines are written elsewhere");
    });
    assert!(matches!(ended, Err(BatchError::Stopped)), "{ended:?}");
    drop(batch);
    let stored = lines(&home).len() as u64 - 1;
    assert!(stored == 5 && files_in(&disk).is_empty(), "{stored} rows are in their place");
    let mut batch = join(&out, 1, 2, local(&disk)).expect("it is free");
    assert_eq!(batch.progress().stored(), stored);
    work_off(&mut batch).expect("the disk is fine");
    drop(batch);
    work_off(&mut join(&out, 2, 2, local(&disk)).expect("it is free")).expect("the disk is fine");
    assert!(files_in(&disk).is_empty());
    merged(&out).expect("all runs are there");
    assert_like_the_whole(&out);
}

#[test]
fn local_journal_of_a_process_that_was_killed_is_gone_on_with() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (out, disk) = (scratch.path().join("out"), scratch.path().join("disk"));
    // Opened and not run: the local file has its first line, and the place none.
    drop(join(&out, 1, 2, local(&disk)).expect("it is free"));
    let [left] = &files_in(&disk)[..] else { panic!("one journal is expected") };
    let elsewhere = scratch.path().join("elsewhere");
    run_slices(&elsewhere, 2);
    let mut all = lines(&elsewhere.join("runs-1-of-2.journal"));
    all.truncate(8);
    write_lines(left, &all);
    // A second file of that name that has nothing to do with what is in its place is replaced.
    let mut batch = join(&out, 1, 2, local(&disk)).expect("it is free");
    assert_eq!(batch.progress().stored(), 7);
    work_off(&mut batch).expect("the disk is fine");
    drop(batch);
    assert_eq!(lines(&out.join("runs-1-of-2.journal")).len(), 19);
    fs::write(left, "something else").expect("writable");
    let batch = join(&out, 1, 2, local(&disk)).expect("it is replaced");
    assert!(batch.progress().is_complete());
}

#[test]
fn lines_in_any_order_are_merged_into_the_order_of_the_plan() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_slices(scratch.path(), 3);
    let mut rng = wildfire::rng::stream(1, "order");
    for number in 1..=3 {
        let journal = scratch.path().join(format!("runs-{number}-of-3.journal"));
        let mut all = lines(&journal);
        all[1..].shuffle(&mut rng);
        write_lines(&journal, &all);
    }
    merged(scratch.path()).expect("all runs are there");
    assert_like_the_whole(scratch.path());
    let (mut runs, plan) = (Vec::new(), BatchPlan::read(scratch.path()).expect("it is there"));
    read_rows(&plan, &existing(scratch.path()), |row| runs.push(row.label.run)).expect("all runs are there");
    assert_eq!(runs, (1..=35).collect::<Vec<_>>());
}

#[test]
fn more_slices_than_runs_are_merged() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_slices(scratch.path(), 40);
    merged(scratch.path()).expect("all runs are there");
    assert_like_the_whole(scratch.path());
}

#[test]
fn damage_behind_the_last_run_is_found() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_slices(scratch.path(), 2);
    let journal = scratch.path().join("runs-2-of-2.journal");
    let mut all = lines(&journal);
    all.push("00000000 {}".into());
    write_lines(&journal, &all);
    let message = merged(scratch.path()).expect_err("it is damaged").to_string();
    assert!(message.contains("runs-2-of-2.journal is damaged in line 19: its checksum is wrong"), "{message}");
    assert!(!scratch.path().join("runs.csv").exists());
}

#[test]
fn survey_says_what_is_missing_and_what_is_new() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = scratch.path();
    drop(join(path, 1, 3, JournalKeeping::default()).expect("it is free"));
    let plan = BatchPlan::read(path).expect("it was just written");
    let mut survey = JournalScan::new(&existing(path), &plan).expect("a slice has begun");
    let missing = |survey: &JournalScan| -> Vec<(u64, u64, u64)> {
        survey.missing().iter().map(|slice| (slice.slice.number(), slice.missing, slice.of)).collect()
    };
    assert_eq!(survey.update().expect("readable"), 1);
    assert_eq!(missing(&survey), [(1, 12, 12), (2, 12, 12), (3, 11, 11)]);
    let mut second = join(path, 2, 3, JournalKeeping::default()).expect("it is free");
    work_off(&mut second).expect("the disk is fine");
    assert_eq!(survey.update().expect("readable"), 13);
    assert_eq!(missing(&survey), [(1, 12, 12), (3, 11, 11)]);
    let journal = path.join("runs-1-of-3.journal");
    let torn = [fs::read(&journal).expect("it is there"), b"half a line".to_vec()].concat();
    fs::write(&journal, torn).expect("writable");
    assert_eq!(survey.update().expect("readable"), 0, "half a line is none");
}
