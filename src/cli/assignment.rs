//! `wildfire new seeds` and `wildfire new assignment`: what a course needs that ranks planners.

use std::fs;
use std::hash::BuildHasher;
use std::path::Path;

use crate::cli::demo::expect_empty;
use crate::cli::error::CliError;
use crate::cli::grade::Platform;
use crate::cli::terminal;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::plan::{rules_schema, shell_word};

/// The number of seeds that are written: as many as the guide's course has.
const SEEDS: u64 = 20;

/// The name of the file of seeds, as the rules give it.
const SEEDS_FILE: &str = "secret.csv";

/// The name of the file of seeds that students may see.
const PUBLIC_SEEDS_FILE: &str = "public.csv";

/// The name of the program in the folder of a platform that runs it elsewhere.
const PROGRAM_FILE: &str = "wildfire";

const FILES: [(&str, &str); 5] = [
    ("rules.toml", include_str!("../../assets/assignment/rules.toml")),
    ("anna.toml", include_str!("../../assets/assignment/anna.toml")),
    ("ben.toml", include_str!("../../assets/assignment/ben.toml")),
    ("cem.toml", include_str!("../../assets/assignment/cem.toml")),
    ("handout.md", include_str!("../../assets/assignment/handout.md")),
];

/// The instructor's page, with places for what differs between platforms.
const INSTRUCTOR: &str = include_str!("../../assets/assignment/instructor.md");
const PLACES: [&str; 3] = ["{files}", "{collect}", "{grade}"];

/// What a platform adds: its parts of the instructor's page, and its files.
struct PlatformFiles {
    parts: &'static str,
    files: &'static [(&'static str, &'static str)],
}

const GRADESCOPE: PlatformFiles = PlatformFiles {
    parts: include_str!("../../assets/assignment/gradescope/instructor.md"),
    files: &[
        ("setup.sh", include_str!("../../assets/assignment/gradescope/setup.sh")),
        ("run_autograder", include_str!("../../assets/assignment/gradescope/run_autograder")),
    ],
};
const CLASSROOM50: PlatformFiles = PlatformFiles {
    parts: include_str!("../../assets/assignment/classroom50/instructor.md"),
    files: &[("autograder.py", include_str!("../../assets/assignment/classroom50/autograder.py"))],
};
const PLAIN: PlatformFiles = PlatformFiles {
    parts: include_str!("../../assets/assignment/plain/instructor.md"),
    files: &[("Makefile", include_str!("../../assets/assignment/plain/Makefile"))],
};

/// Returns random seeds, one a line. They have 64 bits: the fields of smaller numbers could be tried out one by one.
pub fn random_seeds() -> String {
    #[expect(clippy::disallowed_types, reason = "secret seeds are to come from the machine's entropy")]
    let entropy = std::hash::RandomState::new();
    (0..SEEDS).map(|number| format!("{}\n", entropy.hash_one(number))).collect()
}

/// Writes rules, secret seeds, sample entries, a hand-out, the instructor's page and the files of a platform into a folder
/// that is new or empty, and prints what to do with them.
pub fn write(folder: &Path, platform: Platform) -> Result<(), CliError> {
    expect_empty(folder)?;
    fs::create_dir_all(folder).map_err(|error| CliError::unwritable(folder, &error))?;
    let added = match platform {
        Platform::Gradescope => GRADESCOPE,
        Platform::Classroom50 => CLASSROOM50,
        Platform::Plain => PLAIN,
    };
    let parts = PLACES.into_iter().zip(added.parts.split("---\n"));
    let readme = parts.fold(INSTRUCTOR.to_owned(), |page, (place, part)| page.replace(place, part.trim_start()));
    let schema = serde_json::to_string_pretty(&rules_schema()).expect("a schema is JSON") + "\n";
    let seeds = random_seeds();
    let public_seeds = random_seeds();
    let mut files: Vec<(&str, &str)> = FILES.into_iter().chain(added.files.iter().copied()).collect();
    files.extend([(SEEDS_FILE, &seeds[..]), ("README.md", &readme), ("rules.schema.json", &schema)]);
    files.extend((platform == Platform::Classroom50).then_some((PUBLIC_SEEDS_FILE, &public_seeds[..])));
    for (name, text) in files {
        let path = folder.join(name);
        write_whole(&path, text.as_bytes()).map_err(|error| CliError::unwritable(&path, &error))?;
    }
    if platform != Platform::Plain {
        copy_program(&folder.join(PROGRAM_FILE))?;
    }
    let [rules, anna, ben, cem] = ["rules.toml", "anna.toml", "ben.toml", "cem.toml"]
        .map(|name| shell_word(&folder.join(name).display().to_string()));
    terminal::print(&format!(
        "{} holds the rules, {SEEDS} secret seeds ({SEEDS_FILE}), three sample entries and a handout; README.md is for you.\n\
         Give rules.toml and handout.md to the students, and keep {SEEDS_FILE}. Then:\n\n  \
         wildfire batch --rules {rules} --entry {anna} {ben} {cem} --out runs/course\n  \
         wildfire rank runs/course --audit 2 --sheets runs/sheets\n",
        folder.display(),
    ))
}

/// Copies this program, which is for the platform if both are Linux on one kind of processor.
fn copy_program(to: &Path) -> Result<(), CliError> {
    if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        let program = std::env::current_exe();
        let copied = program.and_then(|program| fs::copy(program, to));
        copied.map_err(|error| CliError::unwritable(to, &error))?;
    } else {
        terminal::note(&format!("put the program for Linux on x86-64 from the release there: {}", to.display()));
    }
    Ok(())
}
