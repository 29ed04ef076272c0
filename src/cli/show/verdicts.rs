//! Verdicts on the decisions of a run, as `wildfire why --format json` prints them.

use std::path::Path;

use serde::Deserialize;

use crate::cli::error::CliError;
use wildfire_base::input_file;
use wildfire_base::time::SimTime;
use wildfire_picture::film::Verdict;
use wildfire_timeline::Timeline;

/// The largest file that is read: some thousand decisions with all gains.
const MAX_BYTES: u64 = 256 << 20;

#[derive(Deserialize)]
struct Why {
    scenario: String,
    seed: u64,
    decisions: Vec<JudgedDecision>,
}

#[derive(Deserialize)]
struct JudgedDecision {
    t_s: f64,
    is_mistake: bool,
    is_good: bool,
}

/// Reads the verdicts on a run.
///
/// # Errors
/// If the file is not the output of `wildfire why --format json`, or that of another run.
pub fn read(path: &Path, timeline: &Timeline) -> Result<Vec<(SimTime, Verdict)>, CliError> {
    let text = input_file::read_text(path, MAX_BYTES).map_err(|error| CliError::unreadable(path, &error))?;
    let why: Why = serde_json::from_str(&text).map_err(|error| {
        let sentence = format!("{}: {error}; expected the output of `wildfire why --format json`", path.display());
        CliError::bad_input(sentence, None)
    })?;
    let setting = &timeline.setting;
    // Verdicts on another run would mark decisions that this one does not have.
    if (&why.scenario, why.seed) != (&setting.scenario, setting.seed) {
        let sentence = format!(
            "{} is about seed {} of {}; expected seed {} of {}",
            path.display(),
            why.seed,
            why.scenario,
            setting.seed,
            setting.scenario
        );
        return Err(CliError::bad_input(sentence, None));
    }
    let mut verdicts: Vec<(SimTime, Verdict)> = Vec::new();
    for JudgedDecision { t_s, is_mistake, is_good } in why.decisions {
        // Anybody may have written the file, and a time beyond all runs does not fit into nanoseconds.
        if !(0.0..=1e9).contains(&t_s) {
            let sentence = format!("{}: a decision at {t_s} s; expected times of the run", path.display());
            return Err(CliError::bad_input(sentence, None));
        }
        let verdict = match (is_mistake, is_good) {
            (true, _) => Verdict::Mistake,
            (false, true) => Verdict::Good,
            (false, false) => Verdict::Neutral,
        };
        verdicts.push((SimTime::from_seconds(t_s), verdict));
    }
    verdicts.sort_by_key(|(time, _)| *time);
    Ok(verdicts)
}
