//! Journals and folders that others change while a batch is at work on them.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::thread;

use wildfire::batch::execute::{Batch, BatchError, JournalError, OutputFolder};
use wildfire::batch::plan::{Record, Slice};

use crate::made_up::{made_up_run, plan};

/// Runs a batch whose folder is changed after its fifth run; returns how many runs were over at its end, and its error
/// in words.
fn ended_by(change: fn(&Path)) -> (u64, String) {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = scratch.path().join("out");
    let folder = OutputFolder::named(&path, false).expect("a scratch folder");
    let mut batch = Batch::begin(plan("1..1000", Record::None), folder).expect("the disk is fine");
    let mut over = 0;
    let ended = batch.run_with(Box::new(made_up_run), 1, &Arc::default(), |_| {
        over += 1;
        if over == 5 {
            change(&path);
        }
    });
    match ended {
        Err(BatchError::Journal(JournalError::Changed { path: named, change })) => {
            assert_eq!(named, path.join("runs.journal"));
            (over, change)
        }
        other => panic!("{other:?}"),
    }
}

/// Changes the folder of a batch.
type Change = fn(&Path);

#[test]
fn journal_that_is_changed_under_a_batch_ends_it_before_the_next_line() {
    let changes: [(Change, &str); 6] = [
        (|folder| fs::remove_dir_all(folder).expect("it is there"), "was removed"),
        (|folder| fs::rename(folder, folder.with_file_name("elsewhere")).expect("it is there"), "or renamed"),
        (|folder| fs::remove_file(folder.join("runs.journal")).expect("it is there"), "was removed"),
        (
            |folder| {
                let path = folder.join("runs.journal");
                let copy = fs::read(&path).expect("it is there");
                fs::remove_file(&path).expect("it is there");
                fs::write(&path, copy).expect("writable");
            },
            "another file has its name",
        ),
        (
            |folder| {
                let file = OpenOptions::new().write(true).open(folder.join("runs.journal")).expect("it is there");
                file.set_len(10).expect("writable");
            },
            "it has 10 bytes, expected the",
        ),
        (
            |folder| {
                let file = OpenOptions::new().append(true).open(folder.join("runs.journal"));
                file.expect("it is there").write_all(b"x").expect("writable");
            },
            "that were written",
        ),
    ];
    for (change, fragment) in changes {
        let (over, message) = ended_by(change);
        assert_eq!(over, 5, "{message}");
        assert!(message.contains(fragment), "{message}");
    }
}

#[test]
fn folder_that_is_removed_while_no_run_ends_stops_the_batch() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = scratch.path().join("out");
    let folder = OutputFolder::named(&path, false).expect("a scratch folder");
    let mut batch = Batch::begin(plan("1..1000", Record::None), folder).expect("the disk is fine");
    let endless = Box::new(move |_: &_, _| {
        let _ = fs::remove_dir_all(&path);
        loop {
            thread::park();
        }
    });
    let ended = batch.run_with(endless, 1, &Arc::default(), |_| {});
    assert!(matches!(ended, Err(BatchError::Journal(JournalError::Changed { .. }))), "{ended:?}");
}

/// Changes a digit of a column in every line of a journal, and the checksums with it, as a program that plays could.
fn rewrite_rows(path: &Path) {
    let text = fs::read_to_string(path).expect("it is there");
    let lines = text.lines().enumerate().map(|(number, line)| {
        let json = line[9..].replace("\"extinguished\":0", "\"extinguished\":9");
        if number == 0 { format!("{line}\n") } else { format!("{:08x} {json}\n", crc32fast::hash(json.as_bytes())) }
    });
    let rewritten: String = lines.collect();
    assert!(rewritten.len() == text.len() && rewritten != text, "it is another journal of the same length");
    // As through an open file, so that it stays the same one.
    OpenOptions::new().write(true).open(path).expect("it is there").write_all(rewritten.as_bytes()).expect("writable");
}

#[test]
fn rows_that_a_program_rewrites_with_their_checksums_never_come_into_tables() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = scratch.path().join("out");
    let folder = OutputFolder::named(&path, false).expect("a scratch folder");
    let mut batch = Batch::begin(plan("1..20", Record::None), folder).expect("the disk is fine");
    let (mut over, journal) = (0, path.join("runs.journal"));
    let ended = batch.run_with(Box::new(made_up_run), 1, &Arc::default(), |_| {
        over += 1;
        if over == 15 {
            rewrite_rows(&journal);
        }
    });
    ended.expect("the length is that of what was written");
    match batch.finish(&Arc::default()) {
        Err(BatchError::Journal(JournalError::Rewritten { path: named, run })) => {
            assert_eq!((&named, run), (&journal, 1));
        }
        other => panic!("{:?}", other.map(drop)),
    }
    assert!(!path.join("runs.csv").exists());
    drop(batch);
    // Resuming believes none of the rows.
    let resumed = Batch::resume(OutputFolder::shared(&path).expect("it is there"), Slice::WHOLE);
    let resumed = resumed.expect("there is a plan");
    assert_eq!((resumed.progress().stored(), resumed.progress().not_done()), (0, 0));
}

#[test]
fn slice_whose_rows_a_program_rewrites_ends_before_it_can_be_merged() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = scratch.path().join("out");
    let folder = OutputFolder::shared(&path).expect("a scratch folder");
    let slice = Slice::new(1, 2).expect("a slice");
    let mut batch = Batch::join(plan("1..20", Record::None), folder, slice).expect("the disk is fine");
    let (mut over, journal) = (0, path.join("runs-1-of-2.journal"));
    let ended = batch.run_with(Box::new(made_up_run), 1, &Arc::default(), |_| {
        over += 1;
        if over == 5 {
            rewrite_rows(&journal);
        }
    });
    assert!(matches!(ended, Err(BatchError::Journal(JournalError::Rewritten { run: 1, .. }))), "{ended:?}");
}

#[test]
fn plan_that_a_program_rewrites_ends_the_batch() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let path = scratch.path().join("out");
    let folder = OutputFolder::named(&path, false).expect("a scratch folder");
    let mut batch = Batch::begin(plan("1..5", Record::None), folder).expect("the disk is fine");
    let plan_file = path.join("plan.json");
    let ended = batch.run_with(Box::new(made_up_run), 1, &Arc::default(), |_| {
        let text = fs::read_to_string(&plan_file).expect("it is there").replace("my file", "My file");
        fs::write(&plan_file, text).expect("writable");
    });
    match ended {
        Err(BatchError::Journal(JournalError::Changed { path, change })) => {
            assert_eq!((path, change.as_str()), (plan_file, "it is not the plan that has run"));
        }
        other => panic!("{other:?}"),
    }
}
