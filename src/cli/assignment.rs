//! `wildfire new seeds` and `wildfire new assignment`: what a course needs that ranks planners.

use std::fs;
use std::hash::BuildHasher;
use std::path::Path;

use crate::cli::demo::expect_empty;
use crate::cli::error::CliError;
use crate::cli::terminal;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::plan::shell_word;

/// The number of seeds that are written: as many as the guide's course has.
const SEEDS: u64 = 20;

/// The name of the file of seeds, as the rules give it.
const SEEDS_FILE: &str = "secret.csv";

const FILES: [(&str, &str); 5] = [
    ("rules.toml", include_str!("../../assets/assignment/rules.toml")),
    ("anna.toml", include_str!("../../assets/assignment/anna.toml")),
    ("ben.toml", include_str!("../../assets/assignment/ben.toml")),
    ("cem.toml", include_str!("../../assets/assignment/cem.toml")),
    ("handout.md", include_str!("../../assets/assignment/handout.md")),
];

/// Returns random seeds, one a line. They have 64 bits: the fields of smaller numbers could be tried out one by one.
pub fn random_seeds() -> String {
    #[expect(clippy::disallowed_types, reason = "secret seeds are to come from the machine's entropy")]
    let entropy = std::hash::RandomState::new();
    (0..SEEDS).map(|number| format!("{}\n", entropy.hash_one(number))).collect()
}

/// Writes rules, secret seeds, sample entries and a hand-out into a folder that is new or empty, and prints what to do with
/// them.
pub fn write(folder: &Path) -> Result<(), CliError> {
    // Rules or secret seeds of an earlier course must not be overwritten.
    expect_empty(folder)?;
    fs::create_dir_all(folder).map_err(|error| CliError::unwritable(folder, &error))?;
    let seeds = random_seeds();
    for (name, text) in FILES.into_iter().chain([(SEEDS_FILE, seeds.as_str())]) {
        let path = folder.join(name);
        write_whole(&path, text.as_bytes()).map_err(|error| CliError::unwritable(&path, &error))?;
    }
    let [rules, anna, ben, cem] = ["rules.toml", "anna.toml", "ben.toml", "cem.toml"]
        .map(|name| shell_word(&folder.join(name).display().to_string()));
    terminal::print(&format!(
        "{} holds the rules, {SEEDS} secret seeds ({SEEDS_FILE}), three sample entries and a handout.\n\
         Give rules.toml and handout.md to the students, and keep {SEEDS_FILE}. Then:\n\n  \
         wildfire batch --rules {rules} --agent {anna} {ben} {cem} --out runs/course\n  \
         wildfire rank runs/course --audit 2 --sheets runs/sheets\n",
        folder.display(),
    ))
}
