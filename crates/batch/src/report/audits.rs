//! Audits of many runs on several threads: recordings, and runs of batches, which are simulated again if they were not
//! recorded.

use std::collections::BTreeSet;
use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rayon::prelude::*;
use serde::{Serialize, Serializer};

use crate::execute::{BatchError, RUNS_FILE, RunResult, RunRow, Status, panics};
use crate::plan::{PROGRAM_VERSION, PlannedRun};
use crate::table::{FinishedBatch, FinishedError, RunRecord};
use wildfire_audit::{Audited, SampleStep, Verdict, Violation, audit_timeline};
use wildfire_base::document::number::{count, rounded};
use wildfire_base::document::{Block, Document};
use wildfire_base::object;
use wildfire_sim::{CustomRegistry, RunCost, RunOptions};
use wildfire_timeline::{Outcome, Timeline, file};

/// Runs between two looks at the results, per worker.
const RUNS_PER_ROUND: usize = 32;

/// The maximum number of violations that are listed in words.
pub const LISTED_VIOLATIONS: usize = 10;

/// A source of runs to audit.
#[derive(Debug)]
pub enum AuditSource {
    Recordings(Vec<PathBuf>),
    Batch(Box<FinishedBatch>),
    /// Runs of a batch by their numbers, which are repeated even if there are recordings.
    Repeated(Box<FinishedBatch>, BTreeSet<u64>),
}

impl AuditSource {
    pub fn count(&self) -> u64 {
        match self {
            Self::Recordings(paths) => paths.len() as u64,
            Self::Batch(batch) => batch.count(),
            Self::Repeated(_, numbers) => numbers.len() as u64,
        }
    }
}

/// The findings of many audits.
#[derive(Clone, Debug, Default)]
pub struct AuditReport {
    /// The number of audited runs by the source of their timelines.
    pub recorded: u64,
    pub simulated: u64,
    /// Runs that could not take place according to their rows.
    pub not_run: u64,
    /// Runs of batches that have no row.
    pub without_row: u64,
    /// Recordings that lack speed limits and the rules of fire.
    pub without_limits: u64,
    pub audited: Audited,
    /// The number of runs with a violation, and the first violations in words.
    pub violations: u64,
    pub listed: Vec<ListedViolation>,
    /// The reason why the first file could not be read, and the number of such files.
    pub first_unreadable: Option<(String, ErrorKind)>,
    pub unreadable: u64,
}

/// A run with a violation, or whose row differs from the run.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedViolation {
    /// The recording, or the run of a batch, by its name.
    pub run: String,
    /// The first violation; `None` if only the row is wrong.
    pub violation: Option<Violation>,
    pub message: String,
}

impl fmt::Display for ListedViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.run, self.message)
    }
}

/// One run to be audited.
enum Subject<'a> {
    Recording(&'a Path),
    Run { batch: &'a FinishedBatch, run: PlannedRun<'a>, row: Option<RunRecord>, recording: Option<PathBuf> },
}

/// The outcome of an audit of one run.
enum Finding {
    Recorded(Verdict, Option<String>),
    Simulated(Verdict, Option<String>),
    NotRun(Option<String>),
    Unreadable(String, ErrorKind),
}

type Subjects<'a> = Box<dyn Iterator<Item = Result<Subject<'a>, FinishedError>> + 'a>;

impl AuditSource {
    /// The runs in their order, each with its row if there is one.
    fn subjects(&self) -> Result<Subjects<'_>, FinishedError> {
        match self {
            Self::Recordings(paths) => Ok(Box::new(paths.iter().map(|path| Ok(Subject::Recording(path))))),
            Self::Batch(batch) => {
                // Rows are read along with the runs and not looked up, as `runs.csv` may be larger than memory.
                let mut rows = batch.rows()?;
                Ok(Box::new(batch.runs().map(move |run| {
                    let row = rows.as_mut().map(|rows| rows.next(&run)).transpose()?;
                    let recording = batch.recording(&run);
                    Ok(Subject::Run { batch, run, row, recording })
                })))
            }
            Self::Repeated(batch, numbers) => {
                let mut rows = batch.rows()?;
                let subjects = batch.runs().map(move |run| {
                    // The rows of runs that are not repeated are passed over too, since rows come in the order of the plan.
                    let row = rows.as_mut().map(|rows| rows.next(&run)).transpose()?;
                    Ok(numbers.contains(&run.number).then_some(Subject::Run { batch, run, row, recording: None }))
                });
                Ok(Box::new(subjects.filter_map(Result::transpose)))
            }
        }
    }
}

/// The options of audits.
#[derive(Clone, Copy, Debug)]
pub struct AuditOptions<'a> {
    /// The number of threads.
    pub jobs: usize,
    pub step: SampleStep,
    /// The planners and policies of runs that are repeated.
    pub registry: &'a CustomRegistry,
    /// The maximum number of listed runs with a violation.
    pub listed: usize,
}

/// Audits all runs of all sources on some threads; the report is in their order, whatever the number of threads.
///
/// `on_run` is called from the workers after each run, in any order.
///
/// # Errors
/// Rows that do not go with their plan, or threads that cannot be started.
pub fn audit_all(
    sources: &[AuditSource],
    options: &AuditOptions<'_>,
    on_run: impl Fn() + Sync,
) -> Result<AuditReport, AuditsError> {
    let &AuditOptions { jobs, .. } = options;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| BatchError::NoWorkers { jobs, reason: error.to_string() })?;
    let mut report = AuditReport::default();
    for source in sources {
        let mut subjects = source.subjects()?;
        loop {
            // Audits go in rounds, so the findings of a batch of a million runs are never all in memory.
            let round = subjects.by_ref().take(RUNS_PER_ROUND * jobs).collect::<Result<Vec<_>, _>>()?;
            if round.is_empty() {
                break;
            }
            let findings: Vec<_> = pool.install(|| {
                // Each run is a job by itself: a recording is read quickly, while a run without one is simulated again.
                round
                    .par_iter()
                    .with_max_len(1)
                    .map(|subject| (subject.name(), subject.look(options)))
                    .inspect(|_| on_run())
                    .collect()
            });
            report.without_row += round.iter().filter(|subject| subject.lacks_its_row()).count() as u64;
            findings.into_iter().for_each(|(name, finding)| report.add(name, finding, options.listed));
        }
    }
    Ok(report)
}

impl Subject<'_> {
    fn name(&self) -> String {
        match self {
            Self::Recording(path) => path.display().to_string(),
            Self::Run { batch, run, .. } => batch.name_of(run),
        }
    }

    fn lacks_its_row(&self) -> bool {
        matches!(self, Self::Run { row: None, .. })
    }

    fn look(&self, options: &AuditOptions<'_>) -> Finding {
        let &AuditOptions { step, registry, .. } = options;
        match self {
            Self::Recording(path) => look_at_file(path, step, |_| None),
            Self::Run { batch, run, row, recording } => match recording {
                Some(path) => look_at_file(path, step, |timeline| {
                    // A recording of another run explains any difference of the row, so it is looked for first.
                    other_run(run, timeline).or_else(|| difference(run, row.as_ref(), timeline, RunCost::default()))
                }),
                None => {
                    let memory = batch.plan().memory;
                    let options = RunOptions { memory, ..registry.clone().into() };
                    look_again(run, &options, row.as_ref(), step)
                }
            },
        }
    }
}

fn look_at_file(path: &Path, step: SampleStep, difference: impl Fn(&Timeline) -> Option<String>) -> Finding {
    match file::read(path) {
        Ok(timeline) => Finding::Recorded(audit_timeline(&timeline, step), difference(&timeline)),
        Err(error) => Finding::Unreadable(format!("{}: {error}", path.display()), error.kind()),
    }
}

/// Makes a run once more, within the memory that it had and with the same planners and policies.
fn look_again(run: &PlannedRun<'_>, options: &RunOptions, row: Option<&RunRecord>, step: SampleStep) -> Finding {
    match panics::catch(|| wildfire_sim::run_with_options(&run.variant.scenario, run.seed, options)) {
        Ok(Ok(again)) => {
            let difference = difference(run, row, &again.timeline, again.cost);
            Finding::Simulated(audit_timeline(&again.timeline, step), difference)
        }
        Ok(Err(error)) => Finding::NotRun(missing_result(run, row, Status::Failed, &error.to_string())),
        Err(panic) => Finding::NotRun(missing_result(run, row, Status::Panicked, &panic)),
    }
}

/// In words, that a recording is not of the run whose name it has.
fn other_run(run: &PlannedRun<'_>, timeline: &Timeline) -> Option<String> {
    let name = &timeline.setting.scenario;
    let seed = timeline.setting.seed;
    let is_other = seed != run.seed || *name != run.variant.scenario.name;
    is_other.then(|| format!("its recording is of {name}, seed {seed}"))
}

/// In words, what a row says else than a run. That it cannot be recorded is no difference.
fn difference(run: &PlannedRun<'_>, row: Option<&RunRecord>, timeline: &Timeline, cost: RunCost) -> Option<String> {
    let row = row.filter(|row| row.is_done() || file::encode(timeline).is_ok())?;
    let result = RunResult::new(Outcome::new(timeline), cost);
    // What planners had to say is in no recording, and is no part of the outcome.
    let message = row.message().to_owned();
    let again = RunRow { message, ..RunRow::done(run.label(), result, Duration::ZERO) };
    row.difference(&RunRecord::from_row(&again))
}

/// In words, that a row has a result which its run does not give.
fn missing_result(run: &PlannedRun<'_>, row: Option<&RunRecord>, status: Status, message: &str) -> Option<String> {
    let row = row.filter(|row| row.is_done())?;
    let again = RunRow::not_done(run.label(), status, message.to_owned(), Duration::ZERO);
    row.difference(&RunRecord::from_row(&again))
}

impl AuditReport {
    /// Returns the number of audited runs.
    pub fn runs(&self) -> u64 {
        self.recorded + self.simulated
    }

    fn add(&mut self, run: String, finding: Finding, max: usize) {
        let (verdict, difference) = match finding {
            Finding::Recorded(verdict, difference) => {
                self.recorded += 1;
                (Some(verdict), difference)
            }
            Finding::Simulated(verdict, difference) => {
                self.simulated += 1;
                (Some(verdict), difference)
            }
            Finding::NotRun(difference) => {
                self.not_run += 1;
                (None, difference)
            }
            Finding::Unreadable(reason, kind) => {
                self.unreadable += 1;
                // Without the file nothing is known of the run, so it counts neither as audited nor as a violation.
                self.first_unreadable.get_or_insert((reason, kind));
                return;
            }
        };
        let violation = verdict.as_ref().and_then(|verdict| verdict.violation);
        if let Some(verdict) = verdict {
            self.audited += verdict.audited;
            self.without_limits += u64::from(!verdict.knows_limits);
        }
        let message = violation.map(|violation| violation.to_string()).or(difference);
        // A run with a broken rule and a different row counts once: the figure is of runs.
        self.violations += u64::from(message.is_some());
        if let Some(message) = message.filter(|_| self.listed.len() < max) {
            self.listed.push(ListedViolation { run, violation, message });
        }
    }
}

impl AuditReport {
    /// Returns a sentence each on what was audited, what could not be, and how many runs violate a rule.
    pub fn sentences(&self) -> Vec<String> {
        let Audited { legs, poses, metres, extinctions } = self.audited;
        let metres = rounded(metres, 0);
        let mut sentences =
            vec![format!("Runs: {} recorded, {} simulated again from their plan.", self.recorded, self.simulated)];
        if self.not_run > 0 {
            sentences.push(format!("{} more could not be run.", self.not_run));
        }
        sentences.push(format!("Checked: {legs} legs, {metres} m, {poses} poses, {extinctions} extinctions."));
        if self.without_row > 0 {
            sentences.push(format!("{} of the runs have no row in {RUNS_FILE} to compare with.", self.without_row));
        }
        if self.without_limits > 0 {
            sentences.push(format!(
                "{} of the recordings are older than format 3 and lack speed limits and rules of fire spread, so these \
                                 were not checked.",
                self.without_limits
            ));
        }
        sentences.push(match self.violations {
            0 if self.runs() == 0 => "No run was checked.".into(),
            0 => "Violations: none.".into(),
            count => format!("Violations: in {count} of {} runs.", self.runs() + self.not_run),
        });
        sentences
    }
}

/// The reason why runs cannot be audited.
#[derive(Debug, thiserror::Error)]
pub enum AuditsError {
    #[error(transparent)]
    Finished(#[from] FinishedError),
    #[error(transparent)]
    Batch(#[from] BatchError),
}

impl Serialize for AuditReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Audited { legs, poses, metres, extinctions } = self.audited;
        let report = object!(Report {
            program_version: PROGRAM_VERSION,
            recorded: self.recorded,
            simulated: self.simulated,
            not_run: self.not_run,
            unreadable: self.unreadable,
            without_row: self.without_row,
            without_limits: self.without_limits,
            legs,
            poses,
            metres,
            extinctions,
            violations: self.violations,
            first_violations: self.listed.iter().map(ToString::to_string).collect::<Vec<_>>(),
        });
        report.serialize(serializer)
    }
}

impl From<&AuditReport> for Document {
    /// Lists the first violations, one for each run, then how much was checked.
    fn from(report: &AuditReport) -> Self {
        let runs = report.runs() + report.not_run;
        let mut document = Self::new(format!("Audit of {}", count(runs as usize, "run")));
        let hidden = report.violations.saturating_sub(LISTED_VIOLATIONS as u64);
        let hidden = (hidden > 0).then(|| format!("... and {hidden} more runs."));
        // One line each, however long it is: such lines are searched and sorted.
        let listed: Vec<_> = report.listed.iter().map(ToString::to_string).chain(hidden).collect();
        document = document.with((!listed.is_empty()).then(|| Block::Verbatim(listed.join("\n"))));
        document.add_list(report.sentences());
        document
    }
}
