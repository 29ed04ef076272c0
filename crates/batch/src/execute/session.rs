//! A session on a batch or a slice of one, from its start, or from where it was stopped, to its end.

use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use rayon::prelude::*;
use sha2::{Digest, Sha256};

use crate::execute::entries::JOURNAL;
use crate::execute::journal::{
    JournalError, LockedJournal, OpenJournal, RowReader, plan_of_journal, seeds_of_journal, written_journal,
};
use crate::execute::machines::note_machine;
use crate::execute::workers::{RunEnd, Task, Work, run_all};
use crate::execute::{BatchError, Disk, JournalIndex, OutputFolder, RUNS_FILE, RealDisk, RunScenario, write_whole};
use crate::plan::{BatchPlan, ENTRY_COLUMN, PLAN_FILE, PlanError, Record, Slice};
use wildfire_base::whole_file::sync_folder_of;
use wildfire_sim::{CustomRegistry, RunOptions};
use wildfire_timeline::file::{self, FileError};

/// A slice of a batch that only this process works on.
pub struct Batch {
    plan: Arc<BatchPlan>,
    folder: OutputFolder,
    journal: OpenJournal,
    disk: Box<dyn Disk>,
    found: Found,
    /// The SHA-256 of the plan's file as this process found or left them.
    written_plan: Option<[u8; 32]>,
}

/// Irregularities that an earlier process left in the folder.
#[derive(Debug)]
pub struct Found {
    /// True if a line of the journal was torn, which was dropped.
    pub has_torn_line: bool,
    /// Incomplete files, which were removed.
    pub leftovers: Vec<PathBuf>,
    /// Repeated lines of the journal, equal in everything that is not measured; two processes made them.
    pub repeated: u64,
    /// Recordings of runs in the journal that are missing or damaged; their runs are repeated.
    pub lost_recordings: Vec<LostRecording>,
}

/// A recording that is no longer readable.
#[derive(Debug)]
pub struct LostRecording {
    pub run: u64,
    pub path: PathBuf,
    /// The reason, in words that read well after the path.
    pub reason: String,
}

impl Batch {
    /// Begins a batch in a folder that holds no results, or whose results may be overwritten.
    ///
    /// # Errors
    /// If another process is at work there, or the disk cannot be written: found before the first run.
    pub fn begin(plan: BatchPlan, folder: OutputFolder) -> Result<Self, BatchError> {
        Self::begin_on(plan, folder, Box::new(RealDisk))
    }

    /// Does the same on a given disk.
    pub fn begin_on(plan: BatchPlan, folder: OutputFolder, disk: Box<dyn Disk>) -> Result<Self, BatchError> {
        let journal = LockedJournal::take(&folder, Slice::WHOLE)?;
        folder.remove_earlier_results()?;
        journal.clear()?;
        write_plan(&plan, &folder, PLAN_FILE, disk.as_ref())?;
        Self::open(plan, folder, Slice::WHOLE, journal, disk)
    }

    /// Begins or continues a slice of a batch, in a folder that slices of the same plan share.
    ///
    /// # Errors
    /// If the folder holds another plan, or slices of another size.
    pub fn join(plan: BatchPlan, folder: OutputFolder, slice: Slice) -> Result<Self, BatchError> {
        let disk = Box::new(RealDisk);
        refuse_other_slices(&folder, slice)?;
        match BatchPlan::read(folder.path()) {
            Err(PlanError::Missing { .. }) => write_plan_once(&plan, &folder, slice, disk.as_ref())?,
            found => found?.expect_same(&plan, folder.path())?,
        }
        let journal = LockedJournal::take(&folder, slice)?;
        Self::open(plan, folder, slice, journal, disk)
    }

    /// Continues a slice of the batch in this folder.
    ///
    /// # Errors
    /// If there is no plan, or another version's, if a scenario of it has changed, or the journal is damaged.
    pub fn resume(folder: OutputFolder, slice: Slice) -> Result<Self, BatchError> {
        Self::resume_on(folder, slice, Box::new(RealDisk))
    }

    /// Does the same on a given disk.
    pub fn resume_on(folder: OutputFolder, slice: Slice, disk: Box<dyn Disk>) -> Result<Self, BatchError> {
        let plan = BatchPlan::read(folder.path()).map_err(|error| plan_error(error, &folder))?;
        let plan = shortened_as_journal(plan, &folder, disk.as_ref())?;
        plan.expect_unchanged_sources()?;
        refuse_other_slices(&folder, slice)?;
        let is_finished = folder.path().join(RUNS_FILE).exists();
        if is_finished && !folder.path().join(JOURNAL.name(slice)).exists() {
            return Err(BatchError::NoJournal { path: folder.path().to_owned() });
        }
        let journal = LockedJournal::take(&folder, slice)?;
        Self::open(plan, folder, slice, journal, disk)
    }

    fn open(
        plan: BatchPlan,
        folder: OutputFolder,
        slice: Slice,
        journal: LockedJournal,
        disk: Box<dyn Disk>,
    ) -> Result<Self, BatchError> {
        // Other slices may be at work: what they left is removed when they are merged.
        let leftovers = if slice.is_whole() { folder.remove_leftovers()? } else { Vec::new() };
        // Before the first run, so that a folder that cannot be written to is found at once.
        if plan.record != Record::None {
            folder.prepare_recordings()?;
        }
        let journal = journal.open(&plan, slice, disk.as_ref())?;
        let has_torn_line = journal.index().is_torn();
        // Recordings may have been removed since: their runs are done, so they are only recorded again.
        let lost_recordings = lost_recordings(&plan, &folder, journal.index())?;
        let repeated = journal.index().repeated();
        let found = Found { has_torn_line, leftovers, repeated, lost_recordings };
        // The digest decides, as the file may be replaced by an equal one while the batch runs.
        let written_plan = fs::read(folder.path().join(PLAN_FILE)).ok().map(|bytes| Sha256::digest(bytes).into());
        Ok(Self { plan: Arc::new(plan), folder, journal, disk, found, written_plan })
    }

    pub fn plan(&self) -> &BatchPlan {
        &self.plan
    }

    pub fn folder(&self) -> &OutputFolder {
        &self.folder
    }

    /// Returns the irregularities found when the batch was begun or resumed.
    pub fn found(&self) -> &Found {
        &self.found
    }

    /// Returns the progress according to the journal.
    pub fn progress(&self) -> &JournalIndex {
        self.journal.index()
    }

    /// Executes the runs missing from the journal on `jobs` threads; runs that lost their recordings are repeated
    /// first.
    ///
    /// `on_run` is called after each run, in any order. Runs that fail, or that cannot be recorded though they should
    /// be, are rows like the others.
    ///
    /// # Errors
    /// [`BatchError::Stopped`] if `stop` was set before the last run; all other errors are those of the disk, or of
    /// starting the threads, and [`BatchError::OtherOutcome`] if a run that is made again ends differently. After any
    /// of them the batch can be resumed.
    pub fn run(
        &mut self,
        registry: &CustomRegistry,
        jobs: usize,
        stop: &Arc<AtomicBool>,
        on_run: impl FnMut(RunEnd),
    ) -> Result<(), BatchError> {
        self.run_with(self.simulation(registry), jobs, stop, on_run)
    }

    /// Returns the function that simulates a run of this batch.
    pub fn simulation(&self, registry: &CustomRegistry) -> Box<RunScenario> {
        let options = RunOptions { memory: self.plan.memory, ..registry.clone().into() };
        Box::new(move |scenario, seed| wildfire_sim::run_with_options(scenario, seed, &options))
    }

    /// Does the same with another function that runs a scenario with a seed.
    pub fn run_with(
        &mut self,
        run: Box<RunScenario>,
        jobs: usize,
        stop: &Arc<AtomicBool>,
        on_run: impl FnMut(RunEnd),
    ) -> Result<(), BatchError> {
        self.run_some(|_| true, &Arc::from(run), jobs, stop, on_run)?;
        // The tables of a whole batch are written next, row by row; a slice is merged by a process that knows no digests.
        if !self.journal.index().slice().is_whole() {
            self.journal.rows()?.expect_unchanged_lines()?;
        }
        Ok(())
    }

    /// Executes those of the missing runs that are wanted now, by their numbers, as [`Self::run`] does.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub(crate) fn run_some(
        &mut self,
        is_wanted: impl Fn(u64) -> bool + Clone + Send + 'static,
        run: &Arc<RunScenario>,
        jobs: usize,
        stop: &Arc<AtomicBool>,
        on_run: impl FnMut(RunEnd),
    ) -> Result<(), BatchError> {
        // Their runs are in the journal already, so they must not become rows a second time.
        let lost: Vec<u64> = self.found.lost_recordings.iter().map(|lost| lost.run).collect();
        // A process with nothing to do is no machine that took part.
        if !lost.is_empty() || self.journal.index().missing(is_wanted.clone()).next().is_some() {
            match note_machine(&self.folder, self.journal.index().slice(), jobs, self.disk.as_ref()) {
                // Of a folder that is gone, the journal says it better.
                Err(BatchError::Unwritable { source, .. }) if source.kind() == ErrorKind::NotFound => {}
                noted => noted?,
            }
        }
        // Entries of a course take turns, so that all of them meet the machine equally busy.
        let in_turn = in_turn(&self.plan, self.journal.index().missing(is_wanted.clone()));
        let work = Work {
            plan: Arc::clone(&self.plan),
            folder: self.folder.clone(),
            run: Arc::clone(run),
            stop: Arc::clone(stop),
            tasks: Mutex::new(Box::new(lost.into_iter().map(Task::RecordAgain).chain(in_turn.map(Task::Run)))),
            under_way: Mutex::default(),
        };
        // A class goes on whatever the program of one entry does to these files.
        if self.plan.variants.iter().any(|variant| self.plan.entry(variant).is_some() && variant.scenario.needs_trust())
        {
            self.journal.guard(self.folder.path().join(PLAN_FILE))?;
        }
        let worked_off = run_all(work, jobs, &mut self.journal, on_run);
        // Whatever ended the work, the runs that are over are to be kept.
        let brought = self.journal.bring_home();
        // The first fault is reported: a copy that cannot be brought home may follow from it.
        let recorded_again = worked_off?;
        brought?;
        self.journal.restore_lines()?;
        self.expect_unchanged_plan()?;
        let is_over = self.journal.index().missing(is_wanted).next().is_none()
            && recorded_again == self.found.lost_recordings.len();
        if !is_over {
            return Err(BatchError::Stopped);
        }
        self.found.lost_recordings.clear();
        Ok(())
    }

    /// Ends a whole batch after the given number of seeds of each variant, all of whose runs are in the journal: plan, journal and
    /// recordings become those of a batch of these runs. What a crash leaves of it, resuming completes.
    pub(crate) fn shorten(self, played: &[u64]) -> Result<Self, BatchError> {
        let plan = self.plan.shortened(played);
        let rows = &mut self.rows()?;
        // Rows are renumbered: the number of a run follows from the plan, and the shorter plan has others.
        let renumbered = plan.runs().map(|run| {
            let mut row = rows.row(self.plan.number(plan.place(run.number)))?;
            row.label.run = run.number;
            Ok(row)
        });
        let path = self.folder.journal(Slice::WHOLE);
        let shorter = written_journal(&path, &plan, self.disk(), renumbered)?;
        let Self { plan: longer, folder, journal, disk, .. } = self;
        // Windows does not replace a file that is open.
        drop(journal);
        // The journal is replaced before the plan: `shortened_as_journal` finishes what a crash between both leaves.
        shorter.finish().map_err(|source| BatchError::unwritable(&path, source))?;
        write_plan(&plan, &folder, PLAN_FILE, &*disk)?;
        // From the first on, so that no name is taken that a later one still has.
        for run in plan.runs().filter(|_| plan.record != Record::None) {
            let before = longer.run(longer.number(plan.place(run.number)));
            let [from, to] =
                [longer.recording_name(&before), plan.recording_name(&run)].map(|it| folder.recording(&it));
            // A crash may come between two recordings; those that were renamed before are then left alone.
            if from != to && from.exists() {
                fs::rename(&from, &to).map_err(|source| BatchError::unwritable(&to, source))?;
            }
        }
        Self::resume_on(folder, Slice::WHOLE, disk)
    }

    /// Refuses a plan that a program has rewritten meanwhile: its rows would be read by other rules than they were made by.
    fn expect_unchanged_plan(&self) -> Result<(), JournalError> {
        let path = self.folder.path().join(PLAN_FILE);
        if fs::read(&path).ok().map(|bytes| Sha256::digest(bytes).into()) == self.written_plan {
            return Ok(());
        }
        Err(JournalError::Changed { path, change: "it is not the plan that has run".into() })
    }

    /// Returns the disk to which this batch writes.
    pub(crate) fn disk(&self) -> &dyn Disk {
        self.disk.as_ref()
    }

    /// Reads the rows of the runs that are in the journal.
    pub(crate) fn rows(&self) -> Result<RowReader<'_>, JournalError> {
        self.journal.rows()
    }
}

/// Puts runs into the order in which they are begun: that of the plan, but entries of a course take turns, seed by seed,
/// so that all of them meet the machine as busy as the others do.
fn in_turn(
    plan: &BatchPlan,
    missing: impl Iterator<Item = u64> + Send + 'static,
) -> Box<dyn Iterator<Item = u64> + Send> {
    if !plan.swept_keys.iter().any(|key| key == ENTRY_COLUMN) {
        return Box::new(missing);
    }
    let mut runs: Vec<u64> = missing.collect();
    runs.sort_by_key(|run| (plan.place(*run).seed, *run));
    Box::new(runs.into_iter())
}

/// Says of a folder without a plan whether a batch was about to begin there.
fn plan_error(error: PlanError, folder: &OutputFolder) -> BatchError {
    let leftover = folder.leftovers().into_iter().find_map(|path| {
        let name = path.file_name()?.to_string_lossy();
        name.starts_with(PLAN_FILE).then(|| name.into_owned())
    });
    match (error, leftover) {
        (PlanError::Missing { folder: path }, Some(leftover)) => BatchError::NotStarted { path, leftover },
        (error, _) => error.into(),
    }
}

/// Finds the recordings of runs in the journal that are missing or damaged.
fn lost_recordings(
    plan: &BatchPlan,
    folder: &OutputFolder,
    journal: &JournalIndex,
) -> Result<Vec<LostRecording>, BatchError> {
    // Recordings are verified in parallel, as this reads and decompresses all of them.
    let lost = journal.recorded().par_iter().filter_map(|&run| {
        // Verified and not only found: a process may have been killed while it wrote one.
        let path = folder.recording(&plan.recording_name(&plan.run(run)));
        match file::verify(&path) {
            Ok(()) => None,
            // A disk that cannot be read is no reason to make recordings again.
            Err(FileError::Io(source)) if source.kind() != ErrorKind::NotFound => {
                Some(Err(BatchError::Unreadable { path, source }))
            }
            Err(FileError::Io(_)) => Some(Ok(LostRecording { run, path, reason: "missing".into() })),
            Err(error) => Some(Ok(LostRecording { run, path, reason: error.to_string() })),
        }
    });
    lost.collect()
}

/// Returns the plan, or that of the first seeds if the journal is already theirs: the process was stopped after it had
/// written the journal and before it wrote the plan, which is made up for.
fn shortened_as_journal(plan: BatchPlan, folder: &OutputFolder, disk: &dyn Disk) -> Result<BatchPlan, BatchError> {
    let path = folder.journal(Slice::WHOLE);
    let Some(found) = plan.until.as_ref().and_then(|_| plan_of_journal(&path)) else { return Ok(plan) };
    if found == plan.content_sha256() {
        return Ok(plan);
    }
    // A finished journal has the runs in the order of its plan, so that each variant begins with the first seed.
    let mut played: Vec<u64> = Vec::new();
    for seed in seeds_of_journal(&path) {
        if seed == plan.seeds.nth(0) {
            played.push(0);
        }
        played.last_mut().into_iter().for_each(|seeds| *seeds += 1);
    }
    // Each variant must have a count, or the journal is of another plan with seeds that only look alike.
    let shorter = Some(plan.shortened(&played)).filter(|_| played.len() == plan.variants.len());
    // The digest decides: the counts were guessed from seeds.
    match shorter.filter(|shorter| shorter.has_seeds_of_rule() && shorter.content_sha256() == found) {
        Some(shorter) => {
            write_plan(&shorter, folder, PLAN_FILE, disk)?;
            Ok(shorter)
        }
        None => Ok(plan),
    }
}

fn write_plan(plan: &BatchPlan, folder: &OutputFolder, name: &str, disk: &dyn Disk) -> Result<(), BatchError> {
    write_whole(disk, &folder.path().join(name), plan.to_json().as_bytes())
}

/// Writes the plan unless another slice has written one meanwhile, which then must be the same.
fn write_plan_once(plan: &BatchPlan, folder: &OutputFolder, slice: Slice, disk: &dyn Disk) -> Result<(), BatchError> {
    // Slices may begin at the same time, so each writes a part of its own.
    let part_name = format!("{PLAN_FILE}.{}", JOURNAL.name(slice));
    write_plan(plan, folder, &part_name, disk)?;
    let part = folder.path().join(part_name);
    let path = folder.path().join(PLAN_FILE);
    // A second name for a file is refused where the name is taken, which renaming is not.
    let linked = fs::hard_link(&part, &path);
    let removed = fs::remove_file(&part);
    match linked {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            Ok(BatchPlan::read(folder.path())?.expect_same(plan, folder.path())?)
        }
        // Where files have one name only, slices that begin at the same instant differ by their journals.
        Err(_) => write_plan(plan, folder, PLAN_FILE, disk),
        Ok(()) => removed.and_then(|()| sync_folder_of(&path)).map_err(|source| BatchError::unwritable(&path, source)),
    }
}

/// Slices of a plan are of one size.
fn refuse_other_slices(folder: &OutputFolder, slice: Slice) -> Result<(), BatchError> {
    let found = folder.journals()?;
    match found.into_iter().find(|other| other.of() != slice.of()) {
        Some(other) => Err(BatchError::OtherSlices { path: folder.path().to_owned(), found: other, requested: slice }),
        None => Ok(()),
    }
}
