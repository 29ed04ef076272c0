//! Planners and policies that are not built in, as scenarios write them: tables `[planner.NAME]` and `[policy.NAME]`.
//!
//! A table with a `command` says how to start a program, one with a `module` which WebAssembly module answers. One with
//! neither says that the planner or policy of this name is registered from Rust or from Python; its `settings` are passed
//! on all the same, and a batch of Python notes the hash of its code. Reading a scenario never starts anything.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

use crate::Scenario;
use crate::faults::check::{Check, TablePath};
use crate::faults::path::PathStep;
use wildfire_base::input_file::{self, list_of_at_most};
use wildfire_base::or_none;
use wildfire_base::ranges;
use wildfire_base::ranges::number_text;
#[cfg(feature = "modules")]
use wildfire_module::Limits;
use wildfire_planning::PlannerName;
use wildfire_planning::registry::Charge;

/// The tables by the names that they give.
pub type Programs = BTreeMap<PlannerName, Program>;

/// The most tables of a scenario.
const MAX_PROGRAMS: usize = 100;

/// Instructions of a module where its table gives none.
const QUERY_INSTRUCTIONS: u64 = 1_000_000_000;
const START_INSTRUCTIONS: u64 = 10_000_000_000;

/// The largest memory of a module.
#[cfg(feature = "modules")]
const MAX_MODULE_MB: u32 = 256;

/// The most bytes of a message to or from a program or module, its line end included.
pub const MAX_MESSAGE_BYTES: usize = 16_000_000;

/// The largest file of a module, bytes.
const MAX_MODULE_BYTES: u64 = 64_000_000;

/// The most words of a command, and files of a table.
const MAX_ITEMS: usize = 1000;

/// A custom planner or policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Program {
    /// The program and its arguments; no shell is run. The program is found by `PATH`, or, if it has a slash, from the
    /// scenario's folder, which is also the program's working folder.
    #[serde(deserialize_with = "list_of_at_most::<MAX_ITEMS, _, _>")]
    pub command: Vec<String>,
    /// File of a WebAssembly module instead of a command, relative to the scenario's folder; runs without trust.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub module: Option<PathBuf>,
    /// Most instructions of a module in a query, a restart included [default: 10^9].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub query_instructions: Option<u64>,
    /// Most instructions of a module from its start until it is ready [default: 10^10].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_instructions: Option<u64>,
    /// Folder of the command and its files instead of the scenario's; relative to the scenario's folder.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub folder: Option<PathBuf>,
    /// Files whose contents belong to a batch's plan; those that `command` names and the module always do.
    #[serde(deserialize_with = "list_of_at_most::<MAX_ITEMS, _, _>")]
    pub files: Vec<PathBuf>,
    /// Passed on unchanged.
    pub settings: Map<String, Value>,
    /// Limit of the seconds from a start until it is ready, including building: wall clock, and also CPU time if
    /// `query_cpu_s` is set.
    pub start_limit_s: f64,
    /// Wall-clock limit of a query.
    pub query_limit_s: f64,
    /// CPU seconds of its whole process group in a query; `"none"`: no limit.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub query_cpu_s: Option<f64>,
    /// Memory limit of its process group; of a module at most 256.
    pub memory_limit_mb: u32,
    /// Simulated planning time for each expansion that an answer reports, or each 10^6 instructions of a module.
    pub seconds_per_expansion: f64,
    /// Least number of expansions charged for each query of a planner, whatever the answer reports.
    pub expansions_per_query: u32,
    /// Failed restarts tolerated in a run; after one more, all later queries fail as crashed. A query that times out,
    /// crashes or has a bad answer costs only that query.
    pub restarts: u32,
    /// One process for all runs of a worker instead of one for each run.
    pub reuse: bool,
    /// Run it without a network and with a view of its folder only, read-only, where bubblewrap is installed.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub sandbox: bool,
    /// Name before its lines on stderr instead of that of the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// The folder in which it works, as loading finds it; empty for the current one.
    #[serde(skip_serializing_if = "is_empty")]
    #[schemars(skip)]
    pub works_in: PathBuf,
    /// The files that belong to it with the SHA-256 of their contents, as loading finds them; of registered code, its
    /// hash or its version.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(skip)]
    pub sha256: BTreeMap<String, String>,
}

fn is_empty(path: &Path) -> bool {
    path.as_os_str().is_empty()
}

impl Default for Program {
    fn default() -> Self {
        Self {
            command: Vec::new(),
            module: None,
            query_instructions: None,
            start_instructions: None,
            folder: None,
            files: Vec::new(),
            settings: Map::new(),
            start_limit_s: 30.0,
            query_limit_s: 10.0,
            query_cpu_s: None,
            memory_limit_mb: 2048,
            seconds_per_expansion: 0.0,
            expansions_per_query: 0,
            restarts: 3,
            reuse: false,
            sandbox: false,
            label: None,
            works_in: PathBuf::new(),
            sha256: BTreeMap::new(),
        }
    }
}

impl Program {
    /// Returns the simulated time that its expansions cost.
    pub fn charge(&self) -> Charge {
        Charge { roadmap_s: self.seconds_per_expansion, local_s: self.seconds_per_expansion }
    }

    /// Whether it answers as a program or a module, rather than being registered in Rust or Python.
    pub fn is_external(&self) -> bool {
        !self.command.is_empty() || self.module.is_some()
    }

    /// Returns its command as a line that a shell would read.
    pub fn command_line(&self) -> String {
        self.command
            .iter()
            .map(|word: &String| {
                let is_whole = !word.is_empty()
                    && word.chars().all(|letter| letter.is_ascii_alphanumeric() || "-_./=:,+@%".contains(letter));
                if is_whole { word.clone() } else { format!("'{}'", word.replace('\'', "'\\''")) }
            })
            .collect::<Vec<_>>()
            .join(" ")
    }

    /// Returns the instructions that a module may run in a query.
    pub fn query_instructions(&self) -> u64 {
        self.query_instructions.unwrap_or(QUERY_INSTRUCTIONS)
    }

    /// Returns the instructions that a module may run from its start until it is ready.
    pub fn start_instructions(&self) -> u64 {
        self.start_instructions.unwrap_or(START_INSTRUCTIONS)
    }

    /// Returns what a module may take.
    #[cfg(feature = "modules")]
    pub fn module_limits(&self) -> Limits {
        Limits { memory: self.memory_limit_mb.min(MAX_MODULE_MB) as usize * 1_000_000, answer: MAX_MESSAGE_BYTES }
    }

    /// Reads the file of a module.
    pub fn read_module(&self, file: &Path) -> io::Result<Vec<u8>> {
        input_file::read(&self.works_in.join(file), MAX_MODULE_BYTES)
    }

    /// Fills in where it works, given the scenario's folder, and the hashes of the files that belong to it.
    ///
    /// # Errors
    /// If one of [`Self::files`] or the module cannot be read, or the module is none.
    pub(crate) fn fill_in(&mut self, folder: &Path) -> Result<(), UnusableFile> {
        self.works_in = self.folder.as_ref().map_or_else(|| folder.to_owned(), |subfolder| folder.join(subfolder));
        self.sha256 = self.hashes()?;
        Ok(())
    }

    /// Computes the hashes of the files that belong to it, as they are now.
    fn hashes(&self) -> Result<BTreeMap<String, String>, UnusableFile> {
        let mut hashes = BTreeMap::new();
        if !self.is_external() {
            return Ok(hashes);
        }
        if let Some(module) = &self.module {
            let unusable = |reason| UnusableFile { place: vec![PathStep::key("module")], file: module.clone(), reason };
            let bytes = self.read_module(module).map_err(|error| unusable(Unusable::Unreadable(error)))?;
            // The check is part of loading: a module that cannot run would otherwise fail in each run of a batch.
            #[cfg(feature = "modules")]
            wildfire_module::check(&bytes, self.module_limits())
                .map_err(|message| unusable(Unusable::Module(message)))?;
            hashes.insert(module.display().to_string(), hexadecimal(&Sha256::digest(&bytes)));
        }
        // Scripts are words of a command too, and a batch must notice when one of them changes.
        for word in &self.command {
            // A program without a slash is found by PATH.
            let is_named = self.command.first() != Some(word) || word.contains('/');
            if let (true, Ok(Some(hash))) = (is_named, hash_of(&self.works_in.join(word))) {
                hashes.insert(word.clone(), hash);
            }
        }
        for (index, file) in self.files.iter().enumerate() {
            // A file that is listed must exist, while a word of a command need not be one.
            let hash = hash_of(&self.works_in.join(file))
                .and_then(|hash| hash.ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "it is not a file")));
            let hash = hash.map_err(|error| UnusableFile {
                place: vec![PathStep::key("files"), PathStep::Index(index)],
                file: file.clone(),
                reason: Unusable::Unreadable(error),
            })?;
            hashes.insert(file.display().to_string(), hash);
        }
        Ok(hashes)
    }

    /// Lists in words the files that are no longer what they were when the scenario was loaded.
    fn changed_files(&self) -> Vec<String> {
        if !self.is_external() {
            return Vec::new();
        }
        let changed = self.sha256.iter().filter_map(|(name, before)| match hash_of(&self.works_in.join(name)) {
            Ok(Some(now)) if now == *before => None,
            Ok(Some(_)) => Some(format!("{name} has changed")),
            Ok(None) => Some(format!("{name} is not a file")),
            Err(error) => Some(format!("{name}: {error}")),
        });
        changed.collect()
    }

    /// Describes it in a sentence; `kind` is planner or policy.
    pub(crate) fn describe(&self, kind: &str, name: &PlannerName) -> String {
        if let Some(module) = &self.module {
            format!(
                "The {kind} `{name}` is the WebAssembly module {}; a query may run {} instructions.",
                module.display(),
                number_text(self.query_instructions() as f64)
            )
        } else if self.command.is_empty() {
            format!("The {kind} `{name}` must be registered when the scenario is run.")
        } else {
            format!("The {kind} `{name}` is a program that runs only if trusted: {}.", self.command_line())
        }
    }
}

/// Returns the SHA-256 of a file's contents in hexadecimal; `None` of what is no file.
fn hash_of(path: &Path) -> io::Result<Option<String>> {
    // To open a pipe would be to wait for whoever writes to it.
    if !fs::metadata(path)?.is_file() {
        return Ok(None);
    }
    let mut file = File::open(path)?;
    let mut hash = Sha256::new();
    let mut bytes = vec![0; 1 << 16];
    loop {
        match file.read(&mut bytes) {
            Ok(0) => break,
            Ok(count) => hash.update(&bytes[..count]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(Some(hexadecimal(&hash.finalize())))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A file of a table that cannot be used.
#[derive(Debug)]
pub(crate) struct UnusableFile {
    /// Where the table names it.
    pub place: Vec<PathStep>,
    pub file: PathBuf,
    pub reason: Unusable,
}

/// Why a file cannot be used.
#[derive(Debug)]
pub(crate) enum Unusable {
    Unreadable(io::Error),
    /// It is no module that could run; reads well after its name.
    #[cfg(feature = "modules")]
    Module(String),
}

/// A program that a scenario starts.
#[derive(Clone, Copy, Debug)]
pub struct UsedProgram<'a> {
    /// `planner` or `policy`.
    pub kind: &'static str,
    pub name: &'a PlannerName,
    pub table: &'a Program,
}

impl Scenario {
    /// Lists the programs that a run of it starts.
    pub fn used_programs(&self) -> Vec<UsedProgram<'_>> {
        let planners = self.planner.iter().filter(|(name, _)| self.unimog.iter().any(|truck| truck.planner == **name));
        let policies = self.policy.iter().filter(|(name, _)| self.has_follower(name));
        let planners = planners.map(|(name, table)| UsedProgram { kind: "planner", name, table });
        let policies = policies.map(|(name, table)| UsedProgram { kind: "policy", name, table });
        planners.chain(policies).filter(|used| used.table.is_external()).collect()
    }

    /// Says whether a run of it starts a program, which must be trusted; modules need no trust.
    pub fn needs_trust(&self) -> bool {
        self.used_programs().iter().any(|used| used.table.module.is_none())
    }

    /// Says whether an agent follows the policy of this name, or crews do.
    pub(crate) fn has_follower(&self, policy: &PlannerName) -> bool {
        let trucks = self.unimog.iter().any(|truck| truck.goal.name() == policy.name());
        let crews = self.custom_line_policy().is_some_and(|custom| custom == policy);
        crews || trucks || self.wumpus.iter().any(|wumpus| wumpus.goal.name() == policy.name())
    }

    /// Takes over the hashes of registered code from another one; no file has them.
    pub fn take_over_code(&mut self, other: &Self) {
        for (ours, others) in [(&mut self.planner, &other.planner), (&mut self.policy, &other.policy)] {
            for (name, table) in ours.iter_mut().filter(|(_, table)| !table.is_external()) {
                table.sha256 = others.get(name).map_or_else(BTreeMap::new, |other| other.sha256.clone());
            }
        }
    }

    /// Lists in words the files of its programs that are no longer what they were when it was loaded.
    pub fn changed_program_files(&self) -> Vec<String> {
        let tables = self.planner.values().chain(self.policy.values());
        tables.flat_map(Program::changed_files).collect()
    }
}

ranges! { Program {
    start_limit_s: 0.01..=3600.0, query_limit_s: 0.01..=3600.0, query_cpu_s: 0.001..=3600.0, memory_limit_mb: 1.0..=1e6,
    query_instructions: 1.0..=1e15, start_instructions: 1.0..=1e15, seconds_per_expansion: 0.0..=1000.0,
    expansions_per_query: 0.0..=1e6, restarts: 0.0..=1000.0,
} }

/// Checks the tables of one kind, `planner` or `policy`, some of whose names are taken.
pub(crate) fn check_programs(kind: &str, programs: &Programs, is_built_in: impl Fn(&PlannerName) -> bool) -> Check {
    let all = TablePath::named(kind);
    TablePath::named("").count(kind, programs.len(), MAX_PROGRAMS)?;
    for (name, program) in programs {
        if is_built_in(name) {
            let expected = format!("another name; this is the name of a built-in {kind}");
            return all.refuse(name.name(), "a table".into(), expected);
        }
        let table = all.inner(name.name());
        if program.command.first().is_some_and(String::is_empty) {
            return table.refuse("command", "a list that begins with an empty text".into(), "a program's name".into());
        }
    }
    Ok(())
}
