//! Arguments that several commands share.

use std::num::NonZeroUsize;

use clap::Args;

use crate::cli::numbers;
use crate::scenario::MemoryLimit;

/// A scenario and changes to it.
#[derive(Debug, Args)]
pub struct ScenarioArguments {
    /// A scenario file, or the name of a built-in scenario.
    #[arg(value_name = "SCENARIO", default_value = "contest")]
    pub source: String,
    /// Change a value of the scenario, such as `fire.burn_out_s=30`, `unimog.prm_rs.samples=1000` (all trucks) or
    /// `unimog.0.speed_mps=6` (the first); may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
}

/// Arguments of every command that simulates.
#[derive(Debug, Args)]
pub struct MemoryArguments {
    /// The memory that a run may take, such as `4GB`, `512MiB` or `4G`, which is 4 GB: one that would take more is not
    /// run [default: 2GB, or what the plan of a batch says].
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<MemoryLimit>,
}

impl MemoryArguments {
    pub fn limit(&self) -> MemoryLimit {
        self.memory.unwrap_or_default()
    }
}

/// The most threads that a batch starts.
const MAX_JOBS: usize = 1024;

pub fn parse_jobs(text: &str) -> Result<NonZeroUsize, String> {
    let jobs = numbers::parse_within(text, &(1..=MAX_JOBS), "a whole number")?;
    Ok(NonZeroUsize::new(jobs).expect("the range begins at 1"))
}

pub fn parse_seed(text: &str) -> Result<u64, String> {
    numbers::parse_within(text, &(0..=u64::MAX), "a whole number")
}
