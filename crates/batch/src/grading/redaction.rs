//! Messages without what their reader must not see: seeds, and the paths of the one who grades.

use std::collections::BTreeSet;

/// The most characters of a message that are shown.
const LONGEST: usize = 400;

/// Numbers with fewer digits stay: they are counts and coordinates far more often than seeds.
const MIN_SEED_DIGITS: usize = 5;

/// The seeds of a course.
#[derive(Debug)]
pub struct Redaction {
    seeds: BTreeSet<String>,
}

impl Redaction {
    pub fn new(seeds: impl Iterator<Item = u64>) -> Self {
        Self { seeds: seeds.map(|seed| seed.to_string()).filter(|seed| seed.len() >= MIN_SEED_DIGITS).collect() }
    }

    /// Returns a message in which seeds are dashes, and paths the names of their files.
    pub fn of(&self, message: &str) -> String {
        let mut shown = String::new();
        let mut rest = message;
        while !rest.is_empty() {
            // A word that may be part of a path; other letters stand between two of them.
            let end = rest.find(|letter: char| !is_of_path(letter)).unwrap_or(rest.len());
            let word = &rest[..end];
            let name = word.trim_end_matches('/').rsplit('/').next().unwrap_or_default();
            shown += &self.without_seeds(if word.contains('/') && is_path(word) { name } else { word });
            let next = rest[end..].find(is_of_path).map_or(rest.len(), |at| end + at);
            shown += &rest[end..next];
            rest = &rest[next..];
        }
        match shown.char_indices().nth(LONGEST) {
            Some((end, _)) => format!("{}…", &shown[..end]),
            None => shown,
        }
    }

    fn without_seeds(&self, word: &str) -> String {
        let parts = word.split_inclusive(|letter: char| !letter.is_ascii_digit());
        let parts = parts.map(|part| {
            let digits = part.trim_end_matches(|letter: char| !letter.is_ascii_digit());
            if self.seeds.contains(digits) { part.replace(digits, "-") } else { part.to_owned() }
        });
        parts.collect()
    }
}

fn is_of_path(letter: char) -> bool {
    letter.is_alphanumeric() || "/_-.+~@".contains(letter)
}

/// Names of agents such as `unimog/0` are no paths, and neither are units.
fn is_path(word: &str) -> bool {
    word.starts_with(['/', '.', '~'])
        || word.matches('/').count() > 1
        || word.rsplit('/').next().is_some_and(|name| name.contains('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_and_paths_are_left_out_and_all_else_stays() {
        let redaction = Redaction::new([7, 18_446_744_073_709_551_557, 90_210].into_iter());
        for (message, shown) in [
            ("unimog/0 at 7.0 s: crashed: exit code 7", "unimog/0 at 7.0 s: crashed: exit code 7"),
            ("seed 18446744073709551557, twice", "seed -, twice"),
            ("x=90210y 902100 90210", "x=-y 902100 -"),
            ("File \"/autograder/submission/mine.py\", line 3", "File \"mine.py\", line 3"),
            ("/autograder/source/rules.toml:3: fixed by ../course/rules.toml", "rules.toml:3: fixed by rules.toml"),
            ("in /srv/class/course/: No such file", "in course: No such file"),
            ("12 km/h (see seeds/90210.csv)", "12 km/h (see -.csv)"),
            ("", ""),
        ] {
            assert_eq!(redaction.of(message), shown);
        }
        assert_eq!(redaction.of(&"ü".repeat(5000)).chars().count(), LONGEST + 1);
    }
}
