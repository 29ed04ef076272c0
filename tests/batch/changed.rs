//! Journals and folders that others change while a batch is at work on them.

use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::thread;

use wildfire::batch::{Batch, BatchError, JournalError, OutputFolder, Record};

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
    for (change, words) in changes {
        let (over, said) = ended_by(change);
        assert_eq!(over, 5, "{said}");
        assert!(said.contains(words), "{said}");
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
