//! What a batch is asked to do, and the file that freezes it.

use std::fmt::Write;
use std::str::FromStr;

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::batch::Seeds;
use crate::scenario::Scenario;

/// Version of the format of `plan.json`.
const PLAN_FORMAT: u32 = 1;

/// The version of this program, as it stands in every file that it writes.
pub const PROGRAM_VERSION: &str = env!("CARGO_PKG_VERSION");

/// What `plan.json` names as its program.
pub(super) const PROGRAM: &str = "wildfire";

/// Which runs leave a recording of their timeline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Record {
    All,
    /// Those in which some agent was stuck. (A run that could not take place has no timeline.)
    Failed,
    #[default]
    None,
}

/// A scenario and the seeds to run it with.
#[derive(Clone, Debug)]
pub struct BatchPlan {
    /// The scenario as it was named on the command line.
    pub source: String,
    /// Its `--set` options.
    pub overrides: Vec<String>,
    pub scenario: Scenario,
    pub seeds: Seeds,
    pub record: Record,
}

/// Contents of `plan.json`.
#[derive(Serialize)]
struct Frozen<'a> {
    format: u32,
    program: &'static str,
    program_version: &'static str,
    source: &'a str,
    overrides: &'a [String],
    seeds: String,
    runs: u64,
    record: Record,
    content_sha256: String,
    scenario: &'a Scenario,
}

/// What the outcome columns of a batch depend on.
#[derive(Serialize)]
struct Content<'a> {
    program_version: &'static str,
    seeds: String,
    scenario: &'a Scenario,
}

impl BatchPlan {
    /// The plan as JSON, the scenario with all its defaults filled in.
    pub fn to_json(&self) -> String {
        let frozen = Frozen {
            format: PLAN_FORMAT,
            program: PROGRAM,
            program_version: PROGRAM_VERSION,
            source: &self.source,
            overrides: &self.overrides,
            seeds: self.seeds.to_string(),
            runs: self.seeds.count(),
            record: self.record,
            content_sha256: self.content_sha256(),
            scenario: &self.scenario,
        };
        let mut json = serde_json::to_string_pretty(&frozen).expect("plans hold names, numbers and lists only");
        json.push('\n');
        json
    }

    /// SHA-256, in hexadecimal, of the compact JSON of program version, seeds and resolved scenario: two batches with
    /// the same hash have the same outcome columns.
    pub fn content_sha256(&self) -> String {
        let content =
            Content { program_version: PROGRAM_VERSION, seeds: self.seeds.to_string(), scenario: &self.scenario };
        let json = serde_json::to_vec(&content).expect("scenarios hold names, numbers and lists only");
        Sha256::digest(json).iter().fold(String::new(), |mut hex, byte| {
            write!(hex, "{byte:02x}").expect("a string takes any text");
            hex
        })
    }

    /// The command that runs one of the plan's seeds again.
    pub fn repeating_command(&self, seed: u64) -> String {
        let mut command = format!("wildfire run {} --seed {seed}", shell_word(&self.source));
        for option in &self.overrides {
            write!(command, " --set {}", shell_word(option)).expect("a string takes any text");
        }
        command
    }
}

impl FromStr for Record {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "all" => Ok(Self::All),
            "failed" => Ok(Self::Failed),
            "none" => Ok(Self::None),
            _ => Err("expected `all`, `failed` or `none`".into()),
        }
    }
}

/// The word as a shell takes it for one word.
fn shell_word(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./=:,+@%".contains(letter);
    if !word.is_empty() && word.chars().all(plain) { word.into() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_the_shell() {
        assert_eq!(shell_word("scenarios/a.toml"), "scenarios/a.toml");
        assert_eq!(shell_word("unimog.prm.samples=1000"), "unimog.prm.samples=1000");
        assert_eq!(shell_word("my file.toml"), "'my file.toml'");
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word(""), "''");
    }
}
