//! Disks that are full.

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use wildfire::batch::execute::{Append, Batch, BatchError, Disk, OutputFolder, RealDisk, Whole};
use wildfire::batch::plan::{Record, Slice};

use crate::made_up::{made_up_run, outcomes, plan, run};

const SEEDS: &str = "1..12";

/// A disk on which only so many operations succeed; the first that does not writes half of what it should.
struct FillingDisk {
    left: Arc<AtomicU64>,
}

struct FillingFile<F> {
    left: Arc<AtomicU64>,
    file: F,
}

impl FillingDisk {
    fn of(operations: u64) -> Self {
        Self { left: Arc::new(AtomicU64::new(operations)) }
    }

    fn file<F>(&self, file: F) -> Box<FillingFile<F>> {
        Box::new(FillingFile { left: Arc::clone(&self.left), file })
    }
}

fn take_one(left: &AtomicU64) -> io::Result<()> {
    let taken = left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
    taken.map(drop).map_err(|_| ErrorKind::StorageFull.into())
}

impl Disk for FillingDisk {
    fn whole_file(&self, path: &Path) -> io::Result<Box<dyn Whole>> {
        take_one(&self.left)?;
        Ok(self.file(RealDisk.whole_file(path)?))
    }

    fn journal(&self, file: File) -> Box<dyn Append> {
        self.file(file)
    }
}

impl Write for FillingFile<Box<dyn Whole>> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        take_one(&self.left)?;
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Whole for FillingFile<Box<dyn Whole>> {
    fn finish(self: Box<Self>) -> io::Result<()> {
        take_one(&self.left)?;
        self.file.finish()
    }
}

impl Append for FillingFile<File> {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Err(error) = take_one(&self.left) {
            self.file.write_all(&bytes[..bytes.len() / 2])?;
            return Err(error);
        }
        self.file.append(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        take_one(&self.left)?;
        self.file.sync()
    }
}

fn folder(path: &Path) -> OutputFolder {
    OutputFolder::shared(path).expect("a scratch folder")
}

fn to_the_end(batch: Result<Batch, BatchError>) -> Result<(), BatchError> {
    let mut batch = batch?;
    let stop = Arc::default();
    batch.run_with(Box::new(made_up_run), 2, &stop, |_| {})?;
    batch.finish(&stop).map(drop)
}

#[test]
fn disk_that_is_full_at_any_write_ends_the_batch_and_it_can_be_resumed() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let whole = scratch.path().join("whole");
    run(&whole, SEEDS, 1);
    let mut refused = 0;
    for operations in 0.. {
        let path = scratch.path().join(operations.to_string());
        let disk = Box::new(FillingDisk::of(operations));
        let ended = to_the_end(Batch::begin_on(plan(SEEDS, Record::None), folder(&path), disk));
        if ended.is_ok() {
            break;
        }
        refused += 1;
        assert!(matches!(ended, Err(BatchError::Unwritable { .. })), "{ended:?}");
        if path.join("plan.json").exists() {
            to_the_end(Batch::resume(folder(&path), Slice::WHOLE)).expect("there is room now");
        } else {
            to_the_end(Batch::begin(plan(SEEDS, Record::None), folder(&path))).expect("there is room now");
        }
        for file in ["runs.csv", "agents.csv"] {
            assert_eq!(outcomes(&path.join(file)), outcomes(&whole.join(file)), "{file} after {operations} operations");
        }
    }
    assert!(refused > 20, "a plan, a line a run and three tables are more than {refused} writes");
}

#[test]
fn disk_that_stays_full_while_it_is_resumed_loses_nothing() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let (whole, path) = (scratch.path().join("whole"), scratch.path().join("full"));
    run(&whole, SEEDS, 1);
    drop(Batch::begin(plan(SEEDS, Record::None), folder(&path)).expect("the disk is fine"));
    let resumed = |operations| {
        to_the_end(Batch::resume_on(folder(&path), Slice::WHOLE, Box::new(FillingDisk::of(operations)))).is_ok()
    };
    // A run more each time, until only the tables are left, which need some writes in one go.
    let attempts = (0..80).take_while(|attempt| !resumed(1 + attempt * attempt / 20)).count();
    assert!(attempts > 10, "it was done after {attempts} attempts");
    assert_eq!(outcomes(&path.join("runs.csv")), outcomes(&whole.join("runs.csv")));
}
