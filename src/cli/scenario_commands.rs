//! `wildfire check`, `wildfire scenarios`, and loading a scenario for the other commands.

use std::process::ExitCode;

use crate::cli::args::{CheckArguments, ScenariosArguments};
use crate::cli::error::CliError;
use crate::cli::terminal;
use crate::scenario::{self, LoadedScenario, Scenario};

/// Loads a scenario from a file or by its built-in name.
pub fn load(source: &str, overrides: &[String]) -> Result<Scenario, CliError> {
    Ok(scenario::load(source, overrides)?)
}

pub fn check(arguments: &CheckArguments) -> Result<ExitCode, CliError> {
    let loaded = LoadedScenario::open(&arguments.scenario.source, &arguments.scenario.overrides)?;
    terminal::print(&scenario::explain(&loaded, arguments.memory))?;
    Ok(ExitCode::SUCCESS)
}

pub fn list_or_show(arguments: &ScenariosArguments) -> Result<ExitCode, CliError> {
    let text = match &arguments.show {
        Some(name) => shown(name)?.to_owned(),
        None => list(),
    };
    terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn shown(name: &str) -> Result<&'static str, CliError> {
    let found = scenario::BUILT_IN.iter().find(|(known, _)| *known == name);
    found.map(|(_, text)| *text).ok_or_else(|| {
        let names: Vec<_> = scenario::BUILT_IN.iter().map(|(known, _)| *known).collect();
        let known = format!("the built-in scenarios are {}", names.join(", "));
        CliError::bad_input(format_args!("there is no built-in scenario `{name}`"), Some(&known))
    })
}

/// The width of a terminal's line.
pub const WIDTH: usize = 80;

/// Names, and the first sentence of the comment that opens each file.
fn list() -> String {
    let width = scenario::BUILT_IN.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let entry = |&(name, text): &(&str, &str)| {
        let lines = wrapped(&first_sentence(text), WIDTH - width - 2);
        let labels = std::iter::once(name).chain(std::iter::repeat(""));
        labels.zip(lines).map(|(label, line)| format!("{label:width$}  {line}\n")).collect::<String>()
    };
    scenario::BUILT_IN.iter().map(entry).collect()
}

fn first_sentence(text: &str) -> String {
    let comment = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    let paragraph = comment.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    match paragraph.find(". ") {
        Some(end) => paragraph[..=end].to_owned(),
        None => paragraph,
    }
}

/// Lines of whole words, at most `width` characters each unless a word is longer; at least one line.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("there is one always");
        if line.is_empty() {
            line.push_str(word);
        } else if line.chars().count() + 1 + word.chars().count() <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn purpose_is_the_first_sentence_of_the_first_paragraph() {
        assert_eq!(first_sentence("# One two\n# three. Four.\n\nname = 1\n"), "One two three.");
        assert_eq!(first_sentence("# One\n#\n# two\n"), "One");
        assert_eq!(first_sentence("name = 1\n"), "");
    }

    #[test]
    fn wrapping_keeps_words_and_width() {
        assert_eq!(wrapped("a bb ccc dddd", 4), ["a bb", "ccc", "dddd"]);
        assert_eq!(wrapped("", 4), [""]);
        assert_eq!(wrapped("unbreakable x", 4), ["unbreakable", "x"]);
    }
}
