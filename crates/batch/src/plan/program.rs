//! What made a file: the program, and what it was built from, as its build script found it.

use serde::Deserialize;

/// The version of this program, as every file that it writes names it.
pub const PROGRAM_VERSION: &str = env!("CARGO_PKG_VERSION");

/// The program that `plan.json` names.
pub const PROGRAM: &str = "wildfire";

/// The commit that it was built from, with `-dirty` behind it where sources were changed; none of a development build, and
/// of one without a repository.
pub const COMMIT: Option<&str> = if env!("WILDFIRE_COMMIT").is_empty() { None } else { Some(env!("WILDFIRE_COMMIT")) };

/// The compiler that built it.
pub const COMPILER: &str = env!("WILDFIRE_COMPILER");

/// All that it says of itself: the version, and a line each for commit, compiler and target.
pub const LONG_VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    "\ncommit:   ",
    env!("WILDFIRE_COMMIT_WORDS"),
    "\ncompiler: ",
    env!("WILDFIRE_COMPILER"),
    "\ntarget:   ",
    env!("WILDFIRE_TARGET"),
);

/// The program that wrote the plan of a batch. Neither commit nor compiler decides an outcome, so no hash holds them and no
/// comparison of plans asks for them; plans that older programs wrote do not have them.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct PlanWriter {
    pub program_version: String,
    #[serde(default)]
    pub commit: Option<String>,
    #[serde(default)]
    pub compiler: Option<String>,
}

impl PlanWriter {
    /// Says which program it was, as far as it is known: `wildfire 0.1.0, commit ..., rustc ...`.
    pub fn description(&self) -> String {
        let commit = self.commit.as_ref().map(|commit| format!("commit {commit}"));
        let parts = [Some(format!("{PROGRAM} {}", self.program_version)), commit, self.compiler.clone()];
        parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writer_is_named_as_far_as_it_is_known() {
        let old: PlanWriter = serde_json::from_str(r#"{"program_version": "0.0.9"}"#).expect("it is an older plan's");
        assert_eq!(old.description(), "wildfire 0.0.9");
        let new = r#"{"program_version": "0.1.0", "commit": "ab-dirty", "compiler": "rustc 1.95.0"}"#;
        let new: PlanWriter = serde_json::from_str(new).expect("it is a newer one's");
        assert_eq!(new.description(), "wildfire 0.1.0, commit ab-dirty, rustc 1.95.0");
    }

    #[test]
    fn long_version_says_what_it_was_built_from() {
        assert!(LONG_VERSION.starts_with(&format!("{PROGRAM_VERSION}\ncommit:   ")), "{LONG_VERSION}");
        assert!(LONG_VERSION.contains(COMPILER) && COMPILER.starts_with("rustc "), "{LONG_VERSION}");
        assert_eq!(COMMIT.is_none(), LONG_VERSION.contains("commit:   unknown"), "{LONG_VERSION}");
    }
}
