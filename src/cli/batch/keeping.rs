//! How journals are kept, as the command line says it.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use crate::cli::{interrupt, numbers};
use wildfire_batch::execute::{JournalKeeping, Lock};
use wildfire_batch::plan::shell_word;

/// How journals are locked.
#[derive(Clone, Debug, Args)]
pub struct LockArguments {
    /// Lock that keeps two processes off one slice: `flock` (the system's), or `none` if the file system refuses it and
    /// the scheduler separates them.
    #[arg(help_heading = "Shared file systems", long, value_name = "HOW", default_value_t)]
    lock: Lock,
}

/// How journals are locked and written.
#[derive(Debug, Args)]
pub struct KeepingArguments {
    #[command(flatten)]
    pub lock: LockArguments,
    /// Longest delay until a finished run is on disk: seconds, or `h:mm:ss` [default: 1].
    #[arg(help_heading = "Shared file systems", long, value_name = "TIME", allow_hyphen_values = true, value_parser = parse_seconds)]
    sync_every: Option<f64>,
    /// Write the journal to this folder on a local disk and move it into place when the process ends or is stopped. If
    /// the machine fails first, its runs are lost and run again.
    #[arg(help_heading = "Shared file systems", long, value_name = "DIR")]
    pub journal_dir: Option<PathBuf>,
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    numbers::parse_time_within(text, &(0.0..=3600.0))
}

impl LockArguments {
    pub fn keeping(&self) -> JournalKeeping {
        JournalKeeping { lock: self.lock, ..JournalKeeping::default() }
    }

    /// Writes the option for another command, with a blank before it; nothing if it is the usual one.
    pub fn args(&self) -> String {
        if self.lock == Lock::default() { String::new() } else { format!(" --lock {}", self.lock) }
    }
}

impl KeepingArguments {
    pub fn keeping(&self) -> JournalKeeping {
        let usual = JournalKeeping::default();
        JournalKeeping {
            lock: self.lock.lock,
            sync_every: self.sync_every.map_or(usual.sync_every, Duration::from_secs_f64),
            local_folder: self.journal_dir.clone(),
        }
    }

    /// Writes the options for another command, each with a blank before it.
    pub fn args(&self) -> String {
        let sync_every = self.sync_every.map(|seconds| format!(" --sync-every {seconds}"));
        let journal_dir =
            self.journal_dir.as_ref().map(|path| format!(" --journal-dir {}", shell_word(&path.display().to_string())));
        [Some(self.lock.args()), sync_every, journal_dir].into_iter().flatten().collect()
    }

    /// Returns the time that a batch may take to end after a signal: a journal may have to be brought to its place first.
    pub fn longest_tidying(&self) -> Duration {
        if self.journal_dir.is_some() { Duration::from_secs(60) } else { interrupt::USUAL_TIDYING }
    }
}
