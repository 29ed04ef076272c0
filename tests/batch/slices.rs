//! Batches that are run slice by slice.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use wildfire::batch::execute::{Batch, BatchError, OutputFolder, RealDisk};
use wildfire::batch::plan::{PlanError, Record, Slice};
use wildfire::batch::report::{BatchReport, merge};

use crate::made_up::{made_up_run, outcomes, plan, run};

const SEEDS: &str = "1..23,100..111";

fn join(path: &Path, seeds: &str, number: u64, of: u64) -> Result<Batch, BatchError> {
    let folder = OutputFolder::shared(path).expect("a scratch folder");
    Batch::join(plan(seeds, Record::None), folder, Slice::new(number, of).expect("a slice"))
}

fn run_slice(path: &Path, number: u64, of: u64, jobs: usize) {
    let mut batch = join(path, SEEDS, number, of).expect("the disk is fine");
    batch.run_with(Box::new(made_up_run), jobs, &Arc::default(), |_| {}).expect("the disk is fine");
}

fn merged(path: &Path) -> Result<BatchReport, BatchError> {
    let folder = OutputFolder::existing(path).expect("it is there");
    merge(&folder, &RealDisk, &AtomicBool::new(false)).map(|merged| merged.report)
}

#[test]
fn any_number_of_slices_and_workers_gives_the_same_rows() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let whole = scratch.path().join("whole");
    run(&whole, SEEDS, 1);
    for of in 1..=5 {
        for jobs in 1..=2 {
            let path = scratch.path().join(format!("{of}-{jobs}"));
            for number in (1..=of).rev() {
                run_slice(&path, number, of, jobs);
            }
            merged(&path).expect("all slices are there");
            for file in ["runs.csv", "agents.csv"] {
                assert_eq!(outcomes(&path.join(file)), outcomes(&whole.join(file)), "{of} slices, {jobs} jobs");
            }
        }
    }
}

#[test]
fn slices_that_are_missing_or_incomplete_are_not_merged() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_slice(scratch.path(), 1, 3, 1);
    run_slice(scratch.path(), 3, 3, 1);
    let refusal = merged(scratch.path()).expect_err("slice 2 is missing");
    assert!(matches!(refusal, BatchError::SliceNotStarted { slice, .. } if slice.to_string() == "2/3"), "{refusal}");
    drop(join(scratch.path(), SEEDS, 2, 3).expect("the disk is fine"));
    let refusal = merged(scratch.path()).expect_err("slice 2 has no runs");
    assert!(matches!(refusal, BatchError::Incomplete { missing: 12, of: 12, .. }), "{refusal}");
    assert!(!scratch.path().join("runs.csv").exists());
    run_slice(scratch.path(), 2, 3, 1);
    merged(scratch.path()).expect("all slices are there");
}

#[test]
fn slice_at_which_somebody_works_is_not_merged_and_not_run_twice() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_slice(scratch.path(), 1, 2, 1);
    let other = join(scratch.path(), SEEDS, 2, 2).expect("the disk is fine");
    assert!(
        join(scratch.path(), SEEDS, 2, 2).map(drop).expect_err("it is locked").to_string().contains("another process")
    );
    assert!(merged(scratch.path()).expect_err("it is locked").to_string().contains("another process"));
    assert!(join(scratch.path(), SEEDS, 1, 2).is_ok(), "the first slice is nobody's");
    drop(other);
}

#[test]
fn slice_of_another_plan_is_refused_with_the_difference() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    run_slice(scratch.path(), 1, 2, 1);
    let refusal = join(scratch.path(), "1..5", 2, 2).map(drop).expect_err("the seeds differ");
    assert!(matches!(refusal, BatchError::Plan(PlanError::Differs { .. })), "{refusal}");
    assert!(refusal.to_string().contains("seeds is 1..23,100..111 there, but 1..5 was requested"), "{refusal}");
    let refusal = join(scratch.path(), SEEDS, 1, 3).map(drop).expect_err("the slices are of another size");
    assert!(matches!(refusal, BatchError::OtherSlices { .. }), "{refusal}");
}

#[test]
fn journal_of_another_plan_is_not_merged() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (one, other) = (scratch.path().join("one"), scratch.path().join("other"));
    run_slice(&one, 1, 2, 1);
    drop(join(&other, "1..5", 2, 2).expect("the disk is fine"));
    std::fs::copy(other.join("runs-2-of-2.journal"), one.join("runs-2-of-2.journal")).expect("writable");
    let refusal = merged(&one).expect_err("the second journal is another plan's");
    assert!(refusal.to_string().contains("belongs to another plan"), "{refusal}");
}
