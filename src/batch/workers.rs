//! Threads that run what a journal does not hold yet.
//!
//! The thread that calls writes the journal and watches for a stop; the others take one run after the other. They hold
//! all that they need themselves, so that a run that lasts long need not be waited for when the batch is stopped.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use crate::batch::journal::{OpenJournal, encode_row};
use crate::batch::{
    BatchError, BatchPlan, OutputFolder, PlannedRun, Record, RunDetail, RunResult, RunRow, Status, panics,
};
use crate::scenario::Scenario;
use crate::sim::{Run, RunError};
use crate::time::wall::WallStopwatch;
use crate::timeline::file::{self, FileError};
use crate::timeline::{Outcome, Timeline};

/// How often the journal and the stop are looked after while no run ends.
const POLL: Duration = Duration::from_millis(100);

/// How long runs that are under way are waited for when the batch is stopped.
const GRACE: Duration = Duration::from_millis(1500);

/// Rows of each worker that may wait for the journal, so that slow disks do not fill the memory.
const WAITING_ROWS: usize = 4;

/// A way to run a scenario with a seed.
pub type RunScenario = dyn Fn(&Scenario, u64) -> Result<Run, RunError> + Send + Sync;

/// What all workers share.
pub struct Work {
    pub plan: Arc<BatchPlan>,
    pub folder: OutputFolder,
    pub run: Box<RunScenario>,
    /// Set from outside to begin no more runs.
    pub stop: Arc<AtomicBool>,
    pub runs: Mutex<Box<dyn Iterator<Item = u64> + Send>>,
}

/// A run that is over, with its line for the journal.
struct Finished {
    run: u64,
    status: Status,
    line: Vec<u8>,
}

type Message = Result<Finished, BatchError>;

/// Runs until the work is done or stopped, and leaves the journal on the disk.
pub fn work_off(
    work: Work,
    jobs: usize,
    journal: &mut OpenJournal,
    mut on_run: impl FnMut(Status),
) -> Result<(), BatchError> {
    let work = Arc::new(work);
    let finished = start_workers(&work, jobs)?;
    let mut stopped: Option<WallStopwatch> = None;
    loop {
        match finished.recv_timeout(POLL) {
            Ok(message) => {
                let Finished { run, status, line } = message?;
                journal.add(run, status, &line)?;
                on_run(status);
            }
            Err(RecvTimeoutError::Timeout) => journal.sync_if_due()?,
            Err(RecvTimeoutError::Disconnected) => break,
        }
        if work.stop.load(Ordering::Relaxed) && stopped.get_or_insert_with(WallStopwatch::start).elapsed() > GRACE {
            break;
        }
    }
    journal.sync()
}

/// The workers end when there is no more work, or nobody who takes its results.
fn start_workers(work: &Arc<Work>, jobs: usize) -> Result<Receiver<Message>, BatchError> {
    let (sender, receiver) = sync_channel(jobs * WAITING_ROWS);
    for _ in 0..jobs {
        let (work, sender) = (Arc::clone(work), sender.clone());
        let started = thread::Builder::new().spawn(move || work.work_off(&sender));
        started.map_err(|error| BatchError::NoWorkers { jobs, reason: error.to_string() })?;
    }
    Ok(receiver)
}

impl Work {
    fn work_off(&self, sender: &SyncSender<Message>) {
        while let Some(number) = self.next_run() {
            let run = self.plan.run(number);
            let row = self.run_one(&run);
            let message = row.map(|row| Finished { run: number, status: row.status, line: encode_row(&row) });
            let is_last = message.is_err();
            if sender.send(message).is_err() || is_last {
                break;
            }
        }
    }

    fn next_run(&self) -> Option<u64> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        self.runs.lock().unwrap_or_else(PoisonError::into_inner).next()
    }

    fn run_one(&self, run: &PlannedRun<'_>) -> Result<RunRow, BatchError> {
        let stopwatch = WallStopwatch::start();
        let scenario = &run.variant.scenario;
        let caught = panics::catch(|| (self.run)(scenario, run.seed).map(|run| (Outcome::of(&run.timeline), run)));
        let wall = stopwatch.elapsed();
        let not_done = |status, message| RunRow::not_done(run.label(), status, message, wall);
        Ok(match caught {
            Ok(Ok((outcome, done))) => match self.record(run, &outcome, &done.timeline)? {
                None => {
                    let row = RunRow::done(run.label(), RunResult::new(outcome, done.cost), wall);
                    RunRow { detail: RunDetail::of(&done.timeline), ..row }
                }
                Some(reason) => not_done(Status::Failed, format!("cannot be recorded: {reason}")),
            },
            Ok(Err(error)) => not_done(Status::Failed, error.to_string()),
            Err(panic) => {
                let message = format!("panicked: {panic}; see it again: {}", run.repeating_command());
                not_done(Status::Panicked, message)
            }
        })
    }

    /// Writes the recording of a run if the plan asks for it, or says what about the run cannot be recorded. An error
    /// is one of the disk.
    fn record(
        &self,
        run: &PlannedRun<'_>,
        outcome: &Outcome,
        timeline: &Timeline,
    ) -> Result<Option<FileError>, BatchError> {
        if !is_recorded(self.plan.record, outcome) {
            return Ok(None);
        }
        let path = self.folder.recording(&self.plan.recording_name(run));
        match file::write(timeline, &path) {
            Ok(()) => Ok(None),
            Err(FileError::Io(source)) => Err(BatchError::Unrecordable { path, source }),
            Err(refusal) => Ok(Some(refusal)),
        }
    }
}

fn is_recorded(record: Record, outcome: &Outcome) -> bool {
    match record {
        Record::All => true,
        Record::Failed => outcome.truck_stuck_s > 0.0 || outcome.wumpus_stuck_s > 0.0,
        Record::None => false,
    }
}
