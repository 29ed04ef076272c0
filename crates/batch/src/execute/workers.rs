//! Worker threads that execute the runs missing from a journal.
//!
//! The thread that calls writes the journal and watches for a stop; the others take one run after the other. They hold
//! all that they need themselves, so that a run that lasts long need not be waited for when the batch is stopped.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use crate::execute::journal::{OpenJournal, encode_row};
use crate::execute::{BatchError, OutputFolder, RunDetail, RunResult, RunRow, Status, panics};
use crate::plan::{BatchPlan, PlannedRun};
use wildfire_base::time::wall::WallStopwatch;
use wildfire_scenario::Scenario;
use wildfire_sim::{Run, RunError};
use wildfire_timeline::file::{self, FileError};
use wildfire_timeline::{RunIndex, Timeline};

/// The time between two checks of the journal and of the stop while no run ends.
const POLL: Duration = Duration::from_millis(100);

/// The time for which a batch that is stopped waits for the runs that are under way.
const GRACE: Duration = Duration::from_millis(1500);

/// Rows of each worker that may wait for the journal, so that slow disks do not fill the memory.
const WAITING_ROWS: usize = 4;

/// A function that runs a scenario with a seed.
pub type RunScenario = dyn Fn(&Scenario, u64) -> Result<Run, RunError> + Send + Sync;

/// Limits the threads of parallel work to this number. Only the first call has an effect, and none after such work has
/// begun.
pub fn limit_threads(jobs: usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs);
    // The threads that are there already will do.
    let _ = pool.build_global();
}

/// Executes parallel work on this number of threads of its own. None of them is left afterwards, so that a process
/// forked later does not wait for threads that it does not have.
///
/// # Errors
/// If the threads cannot be started.
pub fn with_threads<T: Send>(jobs: usize, work: impl FnOnce() -> T + Send) -> Result<T, BatchError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| BatchError::NoWorkers { jobs, reason: error.to_string() })?;
    Ok(pool.install(work))
}

/// The work of a batch, shared by all workers.
pub struct Work {
    pub plan: Arc<BatchPlan>,
    pub folder: OutputFolder,
    pub run: Arc<RunScenario>,
    /// A flag, set from outside, that stops new runs.
    pub stop: Arc<AtomicBool>,
    pub tasks: Mutex<Box<dyn Iterator<Item = Task> + Send>>,
    /// Runs of programs that have begun and are not in the journal yet.
    pub under_way: Mutex<BTreeSet<u64>>,
}

/// A run to execute.
#[derive(Clone, Copy, Debug)]
pub enum Task {
    /// A run that is executed for the first time.
    Run(u64),
    /// A run in the journal, repeated for its recording.
    RecordAgain(u64),
}

/// The end of a run, for observers of a batch.
#[derive(Clone, Copy, Debug)]
pub struct RunEnd {
    /// The number of the run in the plan.
    pub run: u64,
    pub status: Status,
    /// The real time of the run.
    pub wall: Duration,
}

/// A run that is over.
enum Finished {
    /// A new run, with its line for the journal.
    Run { end: RunEnd, line: Vec<u8> },
    /// A repeated run that is not recorded yet: it must equal the run in the journal.
    Again { run: u64, made: Box<(RunRow, Option<Timeline>)> },
}

type WorkerMessage = Result<Finished, BatchError>;

/// Executes runs until the work is done or stopped, and syncs the journal. Returns how many runs were recorded again.
pub fn run_all(
    work: Work,
    jobs: usize,
    journal: &mut OpenJournal,
    mut on_run: impl FnMut(RunEnd),
) -> Result<usize, BatchError> {
    let work = Arc::new(work);
    let finished = start_workers(&work, jobs)?;
    let mut recorded_again = 0;
    let mut stopped: Option<WallStopwatch> = None;
    let mut suspects = BTreeSet::new();
    let mut suspected = Vec::new();
    loop {
        // A timeout, so that the journal is synced and a stop is seen while long runs go on.
        let message = finished.recv_timeout(POLL);
        if journal.restore()?.is_some() {
            // Any of the programs that are at work, or were, may have done it.
            suspects.extend(work.under_way());
        }
        match message {
            Ok(message) => match message? {
                Finished::Run { end, .. } if suspects.remove(&end.run) => {
                    work.end(end.run);
                    suspected.push(end.run);
                }
                Finished::Run { end, line } => {
                    work.end(end.run);
                    // Written before it is shown, so that what was reported is kept.
                    // A line is whole in the file before the next one, as only this thread writes.
                    journal.add(end.run, end.status, &line)?;
                    on_run(end);
                }
                Finished::Again { run, made } => {
                    let (row, timeline) = *made;
                    // The row in the journal is compared first: a recording of another run must not stand beside that row.
                    work.record_again(&journal.row(run)?, &row, timeline.as_ref())?;
                    recorded_again += 1;
                    on_run(RunEnd { run, status: row.status, wall: row.wall });
                }
            },
            Err(RecvTimeoutError::Timeout) => journal.sync_if_due()?,
            Err(RecvTimeoutError::Disconnected) => break,
        }
        // Workers end their runs by themselves; after a while those that do not are left behind.
        if work.stop.load(Ordering::Relaxed) && stopped.get_or_insert_with(WallStopwatch::start).elapsed() > GRACE {
            break;
        }
    }
    suspected.iter().try_for_each(|&run| repeat_alone(&work, run, journal, &mut on_run))?;
    // After a stop too: the runs in it are over.
    journal.sync()?;
    Ok(recorded_again)
}

/// Repeats a run while no other program is at work. If the files of the batch change again, it was this one's, and the run
/// fails; else its row is as good as any.
fn repeat_alone(
    work: &Work,
    number: u64,
    journal: &mut OpenJournal,
    on_run: &mut impl FnMut(RunEnd),
) -> Result<(), BatchError> {
    let message = if work.stop.load(Ordering::Relaxed) { None } else { work.perform(Task::Run(number)) };
    // Before the run counts as over, as what changed now was changed by its program.
    let change = journal.restore()?;
    work.end(number);
    let Some(Finished::Run { mut end, mut line }) = message.transpose()? else { return Ok(()) };
    if let Some(change) = change {
        let message = format!("its program changed files of the batch, which were restored: {change}");
        let row = RunRow::not_done(work.plan.run(number).label(), Status::Failed, message, end.wall);
        end.status = row.status;
        line = encode_row(&row);
    }
    journal.add(end.run, end.status, &line)?;
    on_run(end);
    Ok(())
}

/// The workers end when there is no more work, or nobody who takes its results.
fn start_workers(work: &Arc<Work>, jobs: usize) -> Result<Receiver<WorkerMessage>, BatchError> {
    let (sender, receiver) = sync_channel(jobs * WAITING_ROWS);
    for _ in 0..jobs {
        let work = Arc::clone(work);
        let sender = sender.clone();
        let started = thread::Builder::new().spawn(move || work.run_all(&sender));
        started.map_err(|error| BatchError::NoWorkers { jobs, reason: error.to_string() })?;
    }
    Ok(receiver)
}

impl Work {
    fn run_all(&self, sender: &SyncSender<WorkerMessage>) {
        while let Some(task) = self.next_task() {
            let Some(message) = self.perform(task) else { break };
            let is_last = message.is_err();
            if sender.send(message).is_err() || is_last {
                break;
            }
        }
    }

    /// Returns the runs of programs that have begun and are not in the journal yet.
    fn under_way(&self) -> BTreeSet<u64> {
        self.under_way.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Notes that what became of a run is known.
    fn end(&self, run: u64) {
        self.under_way.lock().unwrap_or_else(PoisonError::into_inner).remove(&run);
    }

    fn next_task(&self) -> Option<Task> {
        if self.stop.load(Ordering::Relaxed) {
            return None;
        }
        self.tasks.lock().unwrap_or_else(PoisonError::into_inner).next()
    }

    /// Returns nothing of a run that was stopped before its end.
    fn perform(&self, task: Task) -> Option<WorkerMessage> {
        match task {
            Task::Run(number) => {
                let run = self.plan.run(number);
                if run.variant.scenario.needs_trust() {
                    self.under_way.lock().unwrap_or_else(PoisonError::into_inner).insert(number);
                }
                let row = match self.run_one(&run)? {
                    (row, Some(timeline)) => self.recorded(&run, row, &timeline),
                    (row, None) => Ok(row),
                };
                Some(row.map(|row| {
                    let end = RunEnd { run: number, status: row.status, wall: row.wall };
                    // The worker's thread encodes, so the one thread that writes does not become the bottleneck.
                    Finished::Run { end, line: encode_row(&row) }
                }))
            }
            Task::RecordAgain(number) => {
                let made = Box::new(self.run_one(&self.plan.run(number))?);
                Some(Ok(Finished::Again { run: number, made }))
            }
        }
    }

    /// Makes a run; returns its row, and its timeline if it is done. Returns nothing of one that was stopped.
    fn run_one(&self, run: &PlannedRun<'_>) -> Option<(RunRow, Option<Timeline>)> {
        let stopwatch = WallStopwatch::start();
        let scenario = &run.variant.scenario;
        // A panic is a row like a failure, so that one bad seed does not end a batch.
        let caught = panics::catch(|| {
            (self.run)(scenario, run.seed).map(|done| {
                // Inside, as deriving the outcome may panic too.
                let index = RunIndex::new(&done.timeline);
                let detail = RunDetail::new(&index, &done.answer_cpu);
                (index.into_outcome(), detail, done)
            })
        });
        // After deriving the outcome, which takes part of a worker's time.
        let wall = stopwatch.elapsed();
        let not_done = |status, message| (RunRow::not_done(run.label(), status, message, wall), None);
        Some(match caught {
            Ok(Ok((outcome, detail, done))) => {
                let result = RunResult { asks: done.asks, ..RunResult::new(outcome, done.cost) };
                let row = RunRow::done(run.label(), result, wall);
                (RunRow { detail, message: done.messages.to_string(), ..row }, Some(done.timeline))
            }
            // A run that was stopped is not over: it is missing and will be run again.
            Ok(Err(RunError::Stopped)) => return None,
            Ok(Err(error)) => not_done(Status::Failed, error.to_string()),
            // The command runs the seed again by itself, without the other runs of the batch.
            Err(panic) => {
                let message = format!("panicked: {panic}; see it again: {}", run.repeating_command());
                not_done(Status::Panicked, message)
            }
        })
    }

    /// Writes the recording of a run if the plan asks for it; the row says so if the run cannot be recorded. An error
    /// is one of the disk.
    fn recorded(&self, run: &PlannedRun<'_>, row: RunRow, timeline: &Timeline) -> Result<RunRow, BatchError> {
        let outcome = row.result.as_ref().map(|result| &result.outcome);
        let keeps = outcome.is_some_and(|it| self.plan.record.keeps(it.truck_stuck_s, it.wumpus_stuck_s));
        Ok(match if keeps { self.record(run, timeline)? } else { None } {
            None => row,
            Some(reason) => {
                let message = format!("cannot be recorded: {reason}");
                RunRow::not_done(row.label, Status::Failed, message, row.wall)
            }
        })
    }

    /// Writes a recording, or says what about the run cannot be recorded.
    fn record(&self, run: &PlannedRun<'_>, timeline: &Timeline) -> Result<Option<FileError>, BatchError> {
        let path = self.recording(run);
        match file::write(timeline, &path) {
            Ok(()) => Ok(None),
            Err(FileError::Io(source)) => Err(BatchError::Unrecordable { path, source }),
            Err(refusal) => Ok(Some(refusal)),
        }
    }

    /// Writes the recording of a run that was made again.
    ///
    /// # Errors
    /// If it is another run than the journal says, or one of the disk.
    fn record_again(&self, stored: &RunRow, again: &RunRow, timeline: Option<&Timeline>) -> Result<(), BatchError> {
        let run = self.plan.run(stored.label.run);
        let other = |difference| BatchError::OtherOutcome { path: self.recording(&run), difference };
        match (stored.difference(again), timeline) {
            (None, Some(timeline)) => match self.record(&run, timeline)? {
                None => Ok(()),
                Some(refusal) => Err(other(refusal.to_string())),
            },
            (difference, _) => Err(other(difference.unwrap_or_else(|| "its run has no end".into()))),
        }
    }

    fn recording(&self, run: &PlannedRun<'_>) -> PathBuf {
        self.folder.recording(&self.plan.recording_name(run))
    }
}
