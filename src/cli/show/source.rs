//! Sources of the runs that are shown.

use std::iter;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};

use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::terminal;
use wildfire_base::input_file;
use wildfire_base::time::SimTime;
use wildfire_batch::plan::{PlannedRun, Record};
use wildfire_batch::table::FinishedBatch;
use wildfire_picture::film::{RunView, Verdict};
use wildfire_scenario::{BUILT_IN, LoadedScenario, MemoryLimit, Scenario, ScenarioText};
use wildfire_sim::RunOptions;
use wildfire_timeline::file::{self, FileError};
use wildfire_timeline::{CpuSample, Timeline};
#[cfg(feature = "view")]
use wildfire_view::RunLoader;

/// The seed of a scenario's first run.
const FIRST_SEED: u64 = 1;

/// Says whether a simulated run records its searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Searches {
    Recorded,
    LeftOut,
}

/// A run that is to be shown.
pub struct ShownRun {
    pub title: String,
    pub timeline: Timeline,
    /// `None` of a recording: what was measured is no part of it.
    pub cpu_samples: Option<Vec<CpuSample>>,
    /// Verdicts on decisions, by time.
    pub verdicts: Vec<(SimTime, Verdict)>,
}

impl ShownRun {
    pub fn into_view(self) -> RunView {
        RunView::new(self.timeline, self.cpu_samples).with_title(self.title).with_verdicts(self.verdicts)
    }
}

/// The thing that a name leads to; an input that can be read only once has been read.
pub enum Named {
    Scenario(ScenarioText),
    Recording {
        path: PathBuf,
        bytes: Vec<u8>,
    },
    /// The folder of a batch.
    Batch(PathBuf),
}

impl Named {
    /// Finds a built-in scenario, a batch's folder, a recording, or a scenario's file. A recording is known by its name
    /// or its first bytes.
    ///
    /// # Errors
    /// If nothing has this name, or it cannot be read, or it is too large for a recording or a scenario.
    pub fn open(name: &str) -> Result<Self, CliError> {
        // A built-in name comes before a file of the same name, as in all other commands.
        if BUILT_IN.iter().any(|(existing, _)| *existing == name) {
            return Ok(Self::Scenario(ScenarioText::open(name)?));
        }
        let path = Path::new(name);
        if path.is_dir() {
            return Ok(Self::Batch(path.to_owned()));
        }
        // The file is read whole and once: a pipe cannot be opened again to look at its first bytes.
        let bytes = input_file::read(path, file::MAX_BYTES);
        let has_its_name = path.extension().is_some_and(|extension| extension == "wildfire");
        match bytes {
            Ok(bytes) if has_its_name || bytes.starts_with(file::MAGIC) => {
                Ok(Self::Recording { path: path.to_owned(), bytes })
            }
            Err(error) if has_its_name => Err(CliError::unreadable(path, &error)),
            bytes => Ok(Self::Scenario(ScenarioText::from_bytes(name, bytes)?)),
        }
    }

    fn path(&self) -> &Path {
        match self {
            Self::Scenario(text) => Path::new(&text.source),
            Self::Recording { path, .. } | Self::Batch(path) => path,
        }
    }
}

/// A source of runs.
pub enum Source {
    /// One run, and the bytes of its file: a pipe gives them once.
    Recording { path: PathBuf, bytes: Vec<u8> },
    /// The runs of a batch's first variant, as they were recorded; what was not is simulated.
    Batch { batch: Box<FinishedBatch>, seeds: Vec<u64>, title: String, options: RunOptions },
    /// Any seed is simulated; the title names what was changed.
    Scenario { scenario: Box<Scenario>, title: String, options: RunOptions },
}

impl Source {
    /// Opens the thing that a name leads to, with changes to its values if it is a scenario. Runs that are simulated
    /// may take `memory`, or what their batch allows them.
    pub fn new(
        named: &Named,
        overrides: &[String],
        memory: Option<MemoryLimit>,
        context: &CommandContext,
    ) -> Result<Self, CliError> {
        let source = match named {
            Named::Scenario(text) => {
                let scenario =
                    Box::new(LoadedScenario::from_text(text, &context.with_custom_names(overrides))?.scenario);
                context.expect_trusted(&scenario)?;
                let title = iter::once(&scenario.name).chain(overrides).map(String::as_str).collect::<Vec<_>>();
                return Ok(Self::Scenario {
                    title: title.join(", "),
                    scenario,
                    options: context.run_options(false, memory.unwrap_or_default()),
                });
            }
            Named::Batch(folder) => Self::from_batch(folder, memory, context)?,
            Named::Recording { path, bytes } => Self::Recording { path: path.clone(), bytes: bytes.clone() },
        };
        // A finished run has its values; only a scenario can still be changed.
        if overrides.is_empty() {
            return Ok(source);
        }
        let name = named.path().display();
        let sentence = format!("{name} is a finished run; expected a scenario if values are changed");
        Err(CliError::bad_input(sentence, None))
    }

    fn from_batch(folder: &Path, memory: Option<MemoryLimit>, context: &CommandContext) -> Result<Self, CliError> {
        if !FinishedBatch::is_there(folder) {
            let sentence = format!("{} holds no batch plan", folder.display());
            return Err(CliError::bad_input(sentence, Some("name one of the recordings in it, if there are any")));
        }
        let batch = Box::new(FinishedBatch::open(folder)?);
        let seeds = batch.plan().seeds.iter().collect();
        let title = batch.plan().title(&batch.plan().variants[0]);
        if batch.plan().record != Record::All {
            context.expect_trusted_plan(batch.plan())?;
        }
        let options = context.run_options(false, memory.unwrap_or(batch.plan().memory));
        Ok(Self::Batch { batch, seeds, title, options })
    }

    /// Gives the runs that are still to come another title; a recording has none of these.
    pub fn rename(&mut self, name: &str) {
        match self {
            Self::Recording { .. } => {}
            Self::Batch { title, .. } | Self::Scenario { title, .. } => name.clone_into(title),
        }
    }

    /// Returns the scenario of the runs; `None` of a recording, which does not hold it.
    pub fn scenario(&self) -> Option<&Scenario> {
        match self {
            Self::Recording { .. } => None,
            Self::Batch { batch, .. } => Some(&batch.plan().variants[0].scenario),
            Self::Scenario { scenario, .. } => Some(scenario),
        }
    }

    /// Returns the scenario of the runs, and notes what is left out of a batch.
    ///
    /// # Errors
    /// If the source is a recording.
    pub fn expect_scenario(&self, name: &str, context: &CommandContext) -> Result<&Scenario, CliError> {
        if let Some(note) = self.note().filter(|_| !context.quiet) {
            terminal::note(&note);
        }
        self.scenario().ok_or_else(|| {
            let sentence = format!("{name} is a recording, which does not hold its scenario");
            CliError::bad_input(sentence, Some("name its scenario or its batch, and its --seed"))
        })
    }

    pub fn has_one_run(&self) -> bool {
        matches!(self, Self::Recording { .. })
    }

    /// Names what is left out of a batch with more than one variant.
    pub fn note(&self) -> Option<String> {
        let Self::Batch { batch, title, .. } = self else { return None };
        let folder = batch.folder().display();
        let variants = batch.plan().variants.len();
        (variants > 1).then(|| format!("{folder} has {variants} variants; using the first, {title}"))
    }

    /// The run of a seed, or the first one.
    ///
    /// # Errors
    /// If the source has no run of this seed, or it cannot be read, or it could not take place.
    pub fn run(&self, seed: Option<u64>, searches: Searches) -> Result<ShownRun, CliError> {
        match (self, seed) {
            (Self::Recording { path, bytes }, None) => recorded(path, file::decode(bytes)),
            (Self::Recording { path, .. }, Some(_)) => {
                let sentence = format!("{} is a single run with its own seed; expected no seed", path.display());
                Err(CliError::bad_input(sentence, None))
            }
            (Self::Batch { batch, seeds, title, options }, seed) => {
                let run = run_of_batch(batch, &planned_run(batch, seeds, seed)?, searches, options)?;
                Ok(ShownRun { title: title.clone(), ..run })
            }
            (Self::Scenario { scenario, title, options }, seed) => {
                let run = simulated(scenario, seed.unwrap_or(FIRST_SEED), searches, options)?;
                Ok(ShownRun { title: title.clone(), ..run })
            }
        }
    }
}

/// A run of a batch as it was recorded, or else simulated again.
pub fn run_of_batch(
    batch: &FinishedBatch,
    run: &PlannedRun<'_>,
    searches: Searches,
    options: &RunOptions,
) -> Result<ShownRun, CliError> {
    let simulated = || simulated(&run.variant.scenario, run.seed, searches, options);
    let shown = batch.recording(run).map_or_else(simulated, |path| recorded(&path, file::read(&path)))?;
    Ok(ShownRun { title: batch.plan().title(run.variant), ..shown })
}

/// The first run, or that of a seed.
fn planned_run<'a>(batch: &'a FinishedBatch, seeds: &[u64], seed: Option<u64>) -> Result<PlannedRun<'a>, CliError> {
    let found = seed.map_or(Some(0), |seed| seeds.iter().position(|&other| other == seed));
    let index = found.ok_or_else(|| {
        let folder = batch.folder().display();
        let all = &batch.plan().seeds;
        let sentence = format!("{folder} has no seed {}; its seeds are {all}", seed.unwrap_or_default());
        CliError::bad_input(sentence, None)
    })?;
    Ok(batch.plan().run(index as u64 + 1))
}

fn recorded(path: &Path, timeline: Result<Timeline, FileError>) -> Result<ShownRun, CliError> {
    let unreadable =
        |error: FileError| CliError::from_input_error(format_args!("{}: {error}", path.display()), error.kind());
    let timeline = timeline.map_err(unreadable)?;
    Ok(ShownRun { title: timeline.setting.scenario.clone(), timeline, cpu_samples: None, verdicts: Vec::new() })
}

fn simulated(scenario: &Scenario, seed: u64, searches: Searches, options: &RunOptions) -> Result<ShownRun, CliError> {
    let options = RunOptions { records_searches: searches == Searches::Recorded, ..options.clone() };
    // The panic has been printed by then, with a backtrace if one was asked for.
    let caught = panic::catch_unwind(AssertUnwindSafe(|| wildfire_sim::run_with_options(scenario, seed, &options)));
    let run = caught.map_err(|_| CliError::run_failed("the run panicked: this is a bug in wildfire"))?;
    let run = run.map_err(CliError::run_failed)?;
    let cpu_samples = Some(run.cpu_samples);
    Ok(ShownRun { title: scenario.name.clone(), timeline: run.timeline, cpu_samples, verdicts: Vec::new() })
}

#[cfg(feature = "view")]
impl RunLoader for Source {
    fn load(&self, seed: u64) -> Result<RunView, String> {
        let run = self.run(Some(seed), Searches::Recorded);
        run.map(ShownRun::into_view).map_err(|failure| failure.sentence())
    }

    fn seeds(&self) -> Option<&[u64]> {
        match self {
            Self::Batch { seeds, .. } => Some(seeds),
            Self::Recording { .. } | Self::Scenario { .. } => None,
        }
    }
}
