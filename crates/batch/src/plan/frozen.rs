//! `plan.json`: the plan as it was when the batch began.

use std::fmt::{self, Write};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use serde::de::{DeserializeOwned, Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use sha2::{Digest, Sha256};
use thiserror::Error;

use super::difference::{differences, differences_of_scenarios};
use super::request::{MAX_PLAN_BYTES, MAX_VARIANTS};
use super::{BatchPlan, COMMIT, COMPILER, MAX_FREE_KEYS, MAX_SWEPT_KEYS, PROGRAM, PROGRAM_VERSION, PlanWriter, Record};
use super::{Seeds, SeedsError, StoppingRule, Value, Variant};
use wildfire_base::input_file::{self, InputFile, list_of_at_most};
use wildfire_base::object;
use wildfire_planning::PlannerName;
use wildfire_scenario::{self as scenario, Fault, MemoryLimit, Program, Programs, TruckGoal, WumpusGoal};
use wildfire_sim::CustomRegistry;

pub const PLAN_FILE: &str = "plan.json";

/// Version of the format of `plan.json`.
pub(super) const PLAN_FORMAT: u32 = 2;

/// The longest file of a plan: besides seeds and variants it holds some names and numbers.
const MAX_FILE_BYTES: u64 = MAX_PLAN_BYTES + 1_000_000;

/// A reason for which the plan of a folder cannot be used.
#[derive(Debug, Error)]
pub enum PlanError {
    #[error("{} has no {PLAN_FILE}; expected the folder of a batch", folder.display())]
    Missing { folder: PathBuf },
    #[error(
        "{} has the {kind} `{name}`, which was registered in Rust or Python: resume and audit the batch from there, \
         with the same names",
        path.display()
    )]
    NotRegistered { path: PathBuf, kind: &'static str, name: PlannerName },
    #[error("cannot read {}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("{} is not a batch plan: {reason}", path.display())]
    NotAPlan { path: PathBuf, reason: String },
    #[error(
        "{} was written by wildfire {found}; this is {PROGRAM_VERSION}, whose runs may differ",
        path.display()
    )]
    OtherVersion { path: PathBuf, found: String },
    #[error("{} was changed after it was written: its contents have the hash {found}, expected {expected}",
path.display())]
    Tampered { path: PathBuf, found: String, expected: String },
    #[error("{} contains an invalid scenario: {fault}", path.display())]
    Refused { path: PathBuf, fault: Box<Fault> },
    #[error("{} differs from the requested plan: {}", path.display(), list(.differences))]
    Differs { path: PathBuf, differences: Vec<String> },
    #[error(
        "`{scenario}` has changed since the batch began: {}; the remaining runs would not match the finished runs",
        list(.differences)
    )]
    SourceChanged { scenario: String, differences: Vec<String> },
}

fn list(differences: &[String]) -> String {
    differences.join("; ")
}

/// The part that plans of all formats have.
#[derive(Deserialize)]
pub(super) struct PlanHead {
    program: String,
    pub program_version: String,
    pub format: u32,
}

#[derive(Deserialize)]
struct PlanBody {
    content_sha256: String,
    seeds: String,
    record: Record,
    /// Plans that were written before runs had a limit do not say it.
    #[serde(default)]
    memory_bytes: MemoryLimit,
    #[serde(default, deserialize_with = "list_of_at_most::<MAX_FREE_KEYS, _, _>")]
    free: Vec<String>,
    until: Option<StoppingRule>,
    #[serde(deserialize_with = "list_of_at_most::<MAX_SWEPT_KEYS, _, _>")]
    swept_keys: Vec<String>,
    #[serde(deserialize_with = "variants_within_limit")]
    variants: Vec<Variant>,
}

impl Variant {
    /// Bounds from above the bytes that it takes, in the file of a plan and in memory.
    pub(super) fn bytes(&self) -> u64 {
        /// Spaces before a line of a variant, which is in a list in an object.
        const INDENTATION: usize = 4;
        let json = serde_json::to_vec_pretty(self).expect("variants hold names, numbers and lists only");
        let lines = json.iter().filter(|&&byte| byte == b'\n').count() + 1;
        // A short text takes more in memory than its letters.
        let texts = (self.changes.len() + self.swept.len()) * size_of::<Value>();
        (json.len() + INDENTATION * lines + texts) as u64
    }
}

/// Reads variants that are no more than a batch can have. What they take in memory is held against the limit one by
/// one, as some bytes of text may become a truck with all its settings.
fn variants_within_limit<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Variant>, D::Error> {
    struct Variants;

    impl<'de> Visitor<'de> for Variants {
        type Value = Vec<Variant>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a list of variants")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<Variant>, A::Error> {
            let mut variants: Vec<Variant> = Vec::new();
            let mut bytes = 0;
            // Variants are read one by one, so a file that claims a million of them is refused before they are in memory.
            while let Some(variant) = seq.next_element::<Variant>()? {
                bytes += variant.bytes();
                if bytes > MAX_PLAN_BYTES || variants.len() as u64 == MAX_VARIANTS {
                    return Err(A::Error::custom("it has more or larger variants than a batch takes"));
                }
                variants.push(variant);
            }
            Ok(variants)
        }
    }
    deserializer.deserialize_seq(Variants)
}

impl BatchPlan {
    /// The plan as JSON, the scenarios with all their defaults filled in.
    pub fn to_json(&self) -> String {
        let free = (!self.free.is_empty()).then_some(&self.free);
        let frozen = object!(Plan {
            format: PLAN_FORMAT,
            program: PROGRAM,
            program_version: PROGRAM_VERSION,
            commit: COMMIT,
            compiler: COMPILER,
            content_sha256: self.content_sha256(),
            seeds: self.seeds.to_string(),
            runs: self.count(),
            record: self.record,
            memory_bytes: self.memory,
            // Without free keys there is no member.
            #[serde(flatten)]
            free: free.map(|free| object!(Free { free })),
            #[serde(flatten)]
            until: self.until.as_ref().map(|until| object!(Until { until })),
            swept_keys: &self.swept_keys,
            variants: &self.variants,
        });
        let mut json = serde_json::to_string_pretty(&frozen).expect("plans hold names, numbers and lists only");
        json.push('\n');
        json
    }

    /// SHA-256, in hexadecimal, of the compact JSON of program version, seeds, limit of memory if it is not the usual
    /// one, stopping rule if there is one, swept keys and resolved scenarios: two batches with the same hash have the same outcome columns.
    pub fn content_sha256(&self) -> String {
        // The limit decides which runs fail.
        let memory_bytes = (self.memory != MemoryLimit::default()).then_some(self.memory);
        let content = object!(Content {
            program_version: PROGRAM_VERSION,
            seeds: self.seeds.to_string(),
            #[serde(flatten)]
            memory: memory_bytes.map(|memory_bytes| object!(Memory { memory_bytes })),
            #[serde(flatten)]
            until: self.until.as_ref().map(|until| object!(Until { until })),
            swept_keys: &self.swept_keys,
            // Resolved scenarios are hashed and not their sources, as a file may change while its name stays.
            scenarios: self.variants.iter().map(|variant| &variant.scenario).collect::<Vec<_>>(),
        });
        let json = serde_json::to_vec(&content).expect("scenarios hold names, numbers and lists only");
        Sha256::digest(json).iter().fold(String::new(), |mut hex, byte| {
            write!(hex, "{byte:02x}").expect("a string takes any text");
            hex
        })
    }

    /// Reads the plan of a batch's folder.
    ///
    /// # Errors
    /// If there is none, if it cannot be read, if another version of the program wrote it, or if it was changed.
    pub fn read(folder: &Path) -> Result<Self, PlanError> {
        Self::read_file(folder.join(PLAN_FILE))
    }

    /// Reads the plan of a batch from a copy of its file, wherever that is.
    ///
    /// # Errors
    /// Fails as [`Self::read`] does.
    pub fn read_file(path: PathBuf) -> Result<Self, PlanError> {
        let file = open(path.parent().unwrap_or(&path), &path)?;
        // The head is read first: the body of another version may have a form that this one cannot read.
        let head = read_head(&path, &file)?;
        if head.format != PLAN_FORMAT || head.program_version != PROGRAM_VERSION {
            return Err(PlanError::OtherVersion { path, found: head.program_version });
        }
        let body: PlanBody = read_json(&path, &file)?;
        let expected = body.content_sha256.clone();
        let plan =
            body.into_plan().map_err(|error| PlanError::NotAPlan { path: path.clone(), reason: error.to_string() })?;
        let found = plan.content_sha256();
        // A plan that was edited by hand would claim runs that the journal does not have.
        if found != expected {
            return Err(PlanError::Tampered { path, found, expected });
        }
        plan.check_variants(&path)?;
        Ok(plan)
    }

    /// Reads which program wrote the plan of a batch's folder, and what that was built from.
    ///
    /// # Errors
    /// If there is no plan, or it cannot be read.
    pub fn read_writer(folder: &Path) -> Result<PlanWriter, PlanError> {
        let path = folder.join(PLAN_FILE);
        let file = open(folder, &path)?;
        read_head(&path, &file)?;
        read_json(&path, &file)
    }

    /// Reads the text of the plan of a batch's folder as it was written; none if it is longer than `max` bytes.
    ///
    /// # Errors
    /// If there is no plan, or it cannot be read.
    pub fn read_text(folder: &Path, max: u64) -> Result<Option<String>, PlanError> {
        let path = folder.join(PLAN_FILE);
        let file = open(folder, &path)?;
        let unreadable = |source| PlanError::Unreadable { path: path.clone(), source };
        let mut bytes = Vec::new();
        file.take(max + 1).read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > max {
            return Ok(None);
        }
        input_file::text(bytes).map(Some).map_err(unreadable)
    }

    /// A hash can be computed by anybody, so the contents under a right one are checked like any scenario.
    fn check_variants(&self, path: &Path) -> Result<(), PlanError> {
        let not_a_plan = |reason: &str| PlanError::NotAPlan { path: path.to_owned(), reason: reason.to_owned() };
        if self.variants.is_empty() {
            return Err(not_a_plan("it has no variants"));
        }
        // A rule takes seeds in order; any other list would be a choice.
        if !self.until.as_ref().is_none_or(|rule| rule.goal.is_valid()) || !self.has_seeds_of_rule() {
            return Err(not_a_plan("its seeds are not the first of those that its stopping rule allows"));
        }
        for variant in &self.variants {
            if variant.swept.len() != self.swept_keys.len() {
                return Err(not_a_plan("a variant does not have a value for each swept key"));
            }
            variant
                .scenario
                .check()
                .map_err(|fault| PlanError::Refused { path: path.to_owned(), fault: Box::new(fault) })?;
        }
        Ok(())
    }

    /// Refuses another plan than this one, which is that of a folder.
    pub fn expect_same(&self, requested: &Self, folder: &Path) -> Result<(), PlanError> {
        let differences = differences(self, requested);
        if differences.is_empty() {
            return Ok(());
        }
        Err(PlanError::Differs { path: folder.join(PLAN_FILE), differences })
    }

    /// Refuses a batch whose runs cannot be made here: a planner or a policy of them was registered, and none of
    /// that name is registered here.
    pub fn expect_registry(&self, registry: &CustomRegistry, folder: &Path) -> Result<(), PlanError> {
        for Variant { scenario, .. } in &self.variants {
            let planners = scenario.unimog.iter().map(|truck| ("planner", &truck.planner));
            let trucks = scenario.unimog.iter().filter_map(|truck| match &truck.goal {
                TruckGoal::Policy(name) => Some(("policy", name)),
                _ => None,
            });
            let wumpuses = scenario.wumpus.iter().filter_map(|wumpus| match &wumpus.goal {
                WumpusGoal::Policy(name) => Some(("policy", name)),
                _ => None,
            });
            let crews = scenario.custom_line_policy().map(|name| ("policy", name));
            // Programs are part of the scenario, and need no registry.
            let missing = planners.chain(trucks).chain(wumpuses).chain(crews).find(|&(kind, name)| match kind {
                "planner" => !registry.planners.knows(name) && !is_external(&scenario.planner, name),
                _ => {
                    !registry.policies.custom_names().any(|custom| custom == name)
                        && !is_external(&scenario.policy, name)
                }
            });
            if let Some((kind, name)) = missing {
                return Err(PlanError::NotRegistered { path: folder.to_owned(), kind, name: name.clone() });
            }
        }
        Ok(())
    }

    /// Refuses to go on with scenarios that are no longer what they were when the plan was made. A scenario whose
    /// file is not there, or was a pipe, or is not a scenario now, is taken as the plan has it.
    pub fn expect_unchanged_sources(&self) -> Result<(), PlanError> {
        for variant in &self.variants {
            let differences = variant.scenario.changed_program_files();
            if !differences.is_empty() {
                return Err(PlanError::SourceChanged { scenario: variant.source.clone(), differences });
            }
            if !scenario::can_be_read_again(&variant.source) {
                // A scenario from a pipe can be read once only, and the plan has it whole.
                continue;
            }
            let Ok(mut now) = scenario::load(&variant.source, &variant.changes) else { continue };
            // Registered code has its digest from the running process and from no file.
            now.take_over_code(&variant.scenario);
            let differences = differences_of_scenarios(&variant.scenario, &now);
            if !differences.is_empty() {
                return Err(PlanError::SourceChanged { scenario: variant.source.clone(), differences });
            }
        }
        Ok(())
    }
}

fn is_external(table: &Programs, name: &PlannerName) -> bool {
    table.get(name).is_some_and(Program::is_external)
}

impl PlanBody {
    fn into_plan(self) -> Result<BatchPlan, SeedsError> {
        let Self { seeds, record, memory_bytes: memory, free, until, swept_keys, variants, .. } = self;
        let seeds: Seeds = seeds.parse()?;
        Ok(BatchPlan { variants, swept_keys, seeds, record, memory, free, until })
    }
}

/// Reads which program wrote the plan, and in which format.
pub(super) fn read_head(path: &Path, file: &File) -> Result<PlanHead, PlanError> {
    let head: PlanHead = read_json(path, file)?;
    if head.program == PROGRAM {
        return Ok(head);
    }
    let reason = format!("its program is `{}`, expected `{PROGRAM}`", head.program);
    Err(PlanError::NotAPlan { path: path.to_owned(), reason })
}

/// Opens the file of a plan, which has at most [`MAX_FILE_BYTES`].
pub(super) fn open(folder: &Path, path: &Path) -> Result<File, PlanError> {
    let not_a_plan = |reason: String| PlanError::NotAPlan { path: path.to_owned(), reason };
    match input_file::open(path) {
        Ok(InputFile::Regular(_, bytes)) if bytes > MAX_FILE_BYTES => {
            Err(not_a_plan(format!("it is longer than {} MB", MAX_FILE_BYTES / 1_000_000)))
        }
        Ok(InputFile::Regular(file, _)) => Ok(file),
        Ok(_) => Err(not_a_plan("it is a device or a pipe".into())),
        Err(source) if source.kind() == io::ErrorKind::NotFound => {
            Err(PlanError::Missing { folder: folder.to_owned() })
        }
        Err(source) => Err(PlanError::Unreadable { path: path.to_owned(), source }),
    }
}

/// Reads the file from its beginning; the text, which may be long, is not kept.
pub(super) fn read_json<T: DeserializeOwned>(path: &Path, mut file: &File) -> Result<T, PlanError> {
    let unreadable = |source| PlanError::Unreadable { path: path.to_owned(), source };
    file.rewind().map_err(unreadable)?;
    // It may have grown since it was opened.
    serde_json::from_reader(BufReader::new(file.take(MAX_FILE_BYTES))).map_err(|error| match error.is_io() {
        true => unreadable(error.into()),
        false => PlanError::NotAPlan { path: path.to_owned(), reason: error.to_string() },
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::plan::BatchRequest;
    use wildfire_scenario::BUILT_IN;

    fn plan(scenario: &str, options: &[&str]) -> BatchPlan {
        let mut request = BatchRequest { scenarios: vec![scenario.into()], ..BatchRequest::default() };
        for option in options {
            request.add_option(option).expect("an option");
        }
        request.resolve(false).expect("a small batch")
    }

    fn read_back(json: &str) -> Result<BatchPlan, PlanError> {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        fs::write(scratch.path().join(PLAN_FILE), json).expect("writable");
        BatchPlan::read(scratch.path())
    }

    #[test]
    fn plan_of_every_scenario_survives_being_frozen() {
        for (name, _) in BUILT_IN {
            let plan = plan(name, &["fire.burn_out_s=30,40.5", "field.cell_m=2.5,5"]);
            assert_eq!(read_back(&plan.to_json()).expect("it was just written"), plan, "{name}");
        }
    }

    #[test]
    fn hash_covers_what_decides_and_nothing_else() {
        let hash = |options: &[&str]| plan("smoke", options).content_sha256();
        assert_eq!(hash(&[]).len(), 64);
        assert_eq!(hash(&[]), BatchPlan { record: Record::All, ..plan("smoke", &[]) }.content_sha256());
        assert_ne!(hash(&[]), hash(&["fire.relight=true"]));
        assert_ne!(hash(&["fire.burn_out_s=30,40"]), hash(&["fire.burn_out_s=40,30"]));
    }

    #[test]
    fn commit_and_compiler_are_named_and_decide_nothing() {
        let plan = plan("smoke", &[]);
        let json = plan.to_json();
        let compiler = format!("  \"compiler\": \"{COMPILER}\",\n");
        let commit =
            json.lines().find(|line| line.starts_with("  \"commit\": ")).expect("it is a member").to_owned() + "\n";
        assert!(json.contains(&compiler), "{json}");
        let of_others = json.replacen(&compiler, "  \"compiler\": \"rustc 9\",\n", 1);
        let of_others = of_others.replacen(&commit, "  \"commit\": \"ab\",\n", 1);
        let of_old_ones = json.replacen(&compiler, "", 1).replacen(&commit, "", 1);
        for other in [&of_others, &of_old_ones] {
            let read = read_back(other).expect("it has the same hash");
            assert_eq!(read.content_sha256(), plan.content_sha256());
            plan.expect_same(&read, Path::new("out")).expect("it is the same plan");
        }
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let writer = |json: &str| {
            fs::write(scratch.path().join(PLAN_FILE), json).expect("writable");
            BatchPlan::read_writer(scratch.path()).expect("it names its program")
        };
        assert_eq!(writer(&of_others).description(), format!("wildfire {PROGRAM_VERSION}, commit ab, rustc 9"));
        assert_eq!(writer(&of_old_ones).description(), format!("wildfire {PROGRAM_VERSION}"));
        assert_eq!(writer(&json).compiler.as_deref(), Some(COMPILER));
    }

    #[test]
    fn plans_from_before_the_limit_of_memory_are_read_with_the_usual_one() {
        let usual = plan("smoke", &[]);
        let json = usual.to_json();
        let line = "  \"memory_bytes\": 2000000000,\n";
        assert!(json.contains(line), "{json}");
        assert_eq!(read_back(&json.replacen(line, "", 1)).expect("it has the hash that it had"), usual);
        let tight = BatchPlan { memory: MemoryLimit { bytes: 1_000_000 }, ..usual.clone() };
        assert_ne!(tight.content_sha256(), usual.content_sha256());
        assert_eq!(read_back(&tight.to_json()).expect("it was just written"), tight);
        let changed = tight.to_json().replacen("\"memory_bytes\": 1000000", "\"memory_bytes\": 2000000", 1);
        assert!(matches!(read_back(&changed), Err(PlanError::Tampered { .. })));
        let refusal = usual.expect_same(&tight, Path::new("out")).expect_err("they differ").to_string();
        assert!(refusal.contains("memory is 2 GB there, but 1 MB was requested"), "{refusal}");
    }

    #[test]
    fn plan_that_was_changed_or_is_another_versions_is_refused() {
        let json = plan("smoke", &[]).to_json();
        let refusal = |from: &str, to: &str| {
            assert!(json.contains(from), "{json}");
            read_back(&json.replacen(from, to, 1)).expect_err("it was changed")
        };
        let version = format!("\"program_version\": \"{PROGRAM_VERSION}\"");
        assert!(matches!(refusal(&version, "\"program_version\": \"0.0.1\""), PlanError::OtherVersion { .. }));
        assert!(matches!(refusal("\"duration_s\": 300.0", "\"duration_s\": 301.0"), PlanError::Tampered { .. }));
        assert!(matches!(refusal("\"seeds\": \"1..5\"", "\"seeds\": \"1..6\""), PlanError::Tampered { .. }));
        assert!(matches!(refusal("\"seeds\": \"1..5\"", "\"seeds\": \"x\""), PlanError::NotAPlan { .. }));
        assert!(matches!(refusal("\"program\": \"wildfire\"", "\"program\": \"other\""), PlanError::NotAPlan { .. }));
        assert!(matches!(refusal("{", "["), PlanError::NotAPlan { .. }));
    }

    #[test]
    fn impossible_scenario_under_a_right_hash_is_refused() {
        let mut forged = plan("smoke", &[]);
        forged.variants[0].scenario.field.size_m = 1e9;
        let refusal = read_back(&forged.to_json()).expect_err("the field has 4e16 cells");
        assert!(matches!(refusal, PlanError::Refused { .. }), "{refusal}");
        forged.variants.clear();
        assert!(matches!(read_back(&forged.to_json()), Err(PlanError::NotAPlan { .. })));
    }

    #[test]
    fn another_plan_is_refused_with_the_difference() {
        let one = plan("smoke", &[]);
        let other = plan("smoke", &["fire.burn_out_s=30"]);
        assert!(one.expect_same(&one, Path::new("out")).is_ok());
        let refusal = one.expect_same(&other, Path::new("out")).expect_err("they differ").to_string();
        assert!(refusal.contains("fire.burn_out_s is 60.0 there, but 30.0 was requested"), "{refusal}");
    }
}
