//! Sources of scenarios: files and the built-in ones.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use toml_parser::Source;
use toml_parser::lexer::TokenKind;

use super::built_in::BUILT_IN;
use crate::faults::error::{Fault, ScenarioError, nearest_name};
use wildfire_base::input_file;

/// The longest scenario or plan file that is read, and the most brackets and braces that open in it. Reading TOML was
/// measured to take up to 80 bytes for a byte of text, and 2.4 KB for a table: together about 64 MiB.
pub const MAX_SCENARIO_BYTES: u64 = 350_000;
const MAX_BRACKETS: usize = 24_000;

/// The most brackets and braces of a TOML text that may be open at once: the parser's own limit.
///
/// The parser counts a closing bracket that closes nothing as one level less, so that texts which are wrong in this way
/// nest as deep as they are long and overflow the stack. [`first_too_deep`] is not misled.
const MAX_NESTING: usize = 80;

/// The longest map that is read.
pub const MAX_MAP_BYTES: u64 = 32_000_000;

/// The text of a scenario and what to call it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenarioText {
    /// The source as it was asked for: a built-in name, or a path.
    pub source: String,
    /// The name that messages use: the path, or the file's name in the program's `scenarios` folder.
    pub(crate) name: String,
    /// The scenario's name, unless its text gives one.
    pub(crate) stem: String,
    pub text: String,
    /// The folder from which relative paths in the text start.
    pub folder: PathBuf,
}

impl ScenarioText {
    /// Reads a built-in scenario by its exact name, or else the input at this path.
    ///
    /// # Errors
    /// Fails if there is none, or it cannot be read, or it is not text, or it has more than [`MAX_SCENARIO_BYTES`].
    pub fn open(source: &str) -> Result<Self, Box<ScenarioError>> {
        if BUILT_IN.iter().any(|(name, _)| *name == source) {
            return Self::built_in(source);
        }
        Self::from_bytes(source, input_file::read(Path::new(source), MAX_SCENARIO_BYTES))
    }

    /// Takes a built-in scenario by its exact name.
    ///
    /// # Errors
    /// Fails if there is none.
    pub fn built_in(source: &str) -> Result<Self, Box<ScenarioError>> {
        let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == source) else {
            return Err(not_found(source));
        };
        let (name, stem) = (format!("scenarios/{name}.toml"), (*name).to_owned());
        Ok(Self { source: source.to_owned(), name, stem, text: (*text).to_owned(), folder: PathBuf::new() })
    }

    /// Takes the bytes that were read at this path.
    ///
    /// # Errors
    /// Fails if it could not be read or is not text.
    pub fn from_bytes(source: &str, bytes: io::Result<Vec<u8>>) -> Result<Self, Box<ScenarioError>> {
        let path = Path::new(source);
        let text = bytes.and_then(within_limits).and_then(input_file::text).map_err(|error| match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => not_found(source),
            _ => unreadable(path, &error).nowhere(),
        })?;
        let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { source: source.to_owned(), name: source.to_owned(), stem, text, folder })
    }
}

fn not_found(source: &str) -> Box<ScenarioError> {
    let nearest = nearest_name(source, BUILT_IN.iter().map(|(name, _)| *name));
    Fault::NotFound { name: source.to_owned(), nearest }.nowhere()
}

/// Refuses what would take too much memory to be parsed.
fn within_limits(bytes: Vec<u8>) -> io::Result<Vec<u8>> {
    if bytes.len() as u64 > MAX_SCENARIO_BYTES {
        return Err(input_file::too_large(MAX_SCENARIO_BYTES));
    }
    let brackets = bytes.iter().filter(|&&byte| byte == b'[' || byte == b'{').count();
    if brackets > MAX_BRACKETS {
        let reason = format!("it has {brackets} opening brackets and braces; expected at most {MAX_BRACKETS}");
        return Err(io::Error::new(ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

/// Finds the first bracket or brace that would be open together with more than [`MAX_NESTING`] others.
///
/// Returns its place in bytes. A text for which there is one must not be parsed as TOML.
pub fn first_too_deep(text: &str) -> Option<usize> {
    let mut open = Vec::new();
    for token in Source::new(text).lex() {
        let opened_by = match token.kind() {
            kind @ (TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket) => {
                if open.len() == MAX_NESTING {
                    return Some(token.span().start());
                }
                open.push(kind);
                continue;
            }
            TokenKind::RightSquareBracket => TokenKind::LeftSquareBracket,
            TokenKind::RightCurlyBracket => TokenKind::LeftCurlyBracket,
            _ => continue,
        };
        // As in the parser, whose levels end with a bracket of their own kind and with no other.
        open.pop_if(|last| *last == opened_by);
    }
    None
}

/// Reads a value as TOML spells it; `None` if this is not TOML.
pub fn toml_value(written: &str) -> Option<toml::Value> {
    if first_too_deep(written).is_some() { None } else { written.parse().ok() }
}

/// Words the refusal of a text that [`first_too_deep`] refuses.
pub(crate) fn too_deep_message() -> String {
    format!("more than {MAX_NESTING} brackets and braces are open at once")
}

/// Says whether the scenario of this name can be read once more: a built-in one, or a file, but not a pipe.
pub fn can_be_read_again(source: &str) -> bool {
    BUILT_IN.iter().any(|(name, _)| *name == source) || fs::metadata(source).is_ok_and(|found| found.is_file())
}

/// Reads the text of a file; a file of more bytes than `max` is refused.
pub(crate) fn read_text(path: &Path, max: u64) -> Result<String, Fault> {
    input_file::read_text(path, max).map_err(|error| unreadable(path, &error))
}

/// Words why something at a path cannot be read.
pub(crate) fn unreadable(path: &Path, error: &io::Error) -> Fault {
    Fault::Unreadable { path: path.display().to_string(), kind: error.kind(), reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LoadedScenario;

    #[test]
    fn brackets_in_texts_and_comments_do_not_nest() {
        let open = "[".repeat(MAX_NESTING + 1);
        assert_eq!(first_too_deep(&format!("# {open}\nx = \"{open}\"\ny = '{open}'\n")), None);
        assert_eq!(first_too_deep(&format!("x = {open}")), Some(4 + MAX_NESTING));
        assert_eq!(first_too_deep(&"[a]\nx = [[1], [2]]\n".repeat(MAX_NESTING)), None);
    }

    /// Wrong closing brackets make the parser believe that it is higher up than it is.
    #[test]
    fn deeply_nested_tables_are_refused_and_do_not_overflow_the_stack() {
        let deep = [
            format!("x = {}", "{a=".repeat(20_000)),
            format!("x = {}", "[".repeat(20_000)),
            format!("x = {}", "[}".repeat(20_000)),
            format!("x = {}", "{a=[}".repeat(10_000)),
            format!("{}\nx = {}", "}".repeat(20_000), "{a=".repeat(20_000)),
            format!("x = {}", "{ a ".repeat(20_000)),
        ];
        let small_stack = std::thread::Builder::new().stack_size(512 * 1024);
        let all_refused = move || {
            for text in deep {
                let source =
                    ScenarioText::from_bytes("deep.toml", Ok(text.clone().into_bytes())).expect("within limits");
                let refusal = LoadedScenario::from_text(&source, &[]).expect_err("nobody nests so deep").to_string();
                assert!(refusal.contains("brackets"), "{refusal}");
                assert_eq!(toml_value(&text[text.find("= ").map_or(0, |at| at + 2)..]), None);
            }
        };
        small_stack.spawn(all_refused).expect("a thread starts").join().expect("no thread dies");
    }
}
