//! `wildfire --help`: the commands that most people need, in groups; and what somebody meant who named a command that there
//! is not.

use std::ffi::OsString;

use clap::Command;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use crate::cli::EXAMPLES;
use crate::cli::error::CliError;
use crate::cli::options;
use wildfire_base::untrusted::visible;

/// Headings and commands of the overview. Those that are left out are printed by `help --all`.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Watch", &["demo", "run", "play", "page"]),
    ("Contest", &["batch", "report", "compare", "rank"]),
    ("Make", &["new", "check", "scenarios", "plan"]),
    ("Maps and fire", &["map", "curve", "fire", "map-of"]),
];

/// The lines of the program's examples that the overview has: the heading and the first four, and two on exit codes.
const FIRST_LINES: usize = 5;
const LAST_LINES: usize = 2;

/// Words for what a command does, as people look for it.
const SYNONYMS: [(&str, &str); 25] = [
    ("animate", "render"),
    ("bench", "batch"),
    ("benchmark", "plan"),
    ("chart", "report"),
    ("create", "new"),
    ("game", "page"),
    ("gif", "render"),
    ("heatmap", "map-of"),
    ("init", "new"),
    ("leaderboard", "rank"),
    ("list", "scenarios"),
    ("movie", "render"),
    ("plot", "report"),
    ("results", "report"),
    ("rnu", "run"),
    ("show", "scenarios"),
    ("sim", "run"),
    ("simulate", "run"),
    ("start", "run"),
    ("stats", "batch"),
    ("test", "check"),
    ("validate", "check"),
    ("verify", "audit"),
    ("video", "render"),
    ("view", "play"),
];

/// Writes the overview of a program's commands.
pub fn overview(program: &Command) -> String {
    let about = program.get_about().map(ToString::to_string).unwrap_or_default();
    let mut text = wrapped("", &about) + "\nUsage: wildfire [OPTIONS] <COMMAND>\n";
    for (heading, names) in GROUPS {
        text += &format!("\n{heading}:\n");
        for name in names {
            let command = program.find_subcommand(name).expect("groups have commands of the program");
            text += &format!("  {name:<11}{}\n", first_clause(command));
        }
    }
    let grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).chain(["help"]).collect();
    let others = program.get_subcommands().filter(|command| !command.is_hide_set()).map(Command::get_name);
    let others: Vec<&str> = others.filter(|name| !grouped.contains(name)).collect();
    text += "\nMore, which `wildfire help --all` explains:\n";
    text += &wrapped("  ", &others.join(", "));
    text += "\nOptions:\n  -q, --quiet    Print only results and errors, no progress or notes\n  -h, --help     Also after a command; \
             -V, --version: print the version\n\n";
    let examples: Vec<&str> = EXAMPLES.lines().collect();
    let (first, last) = (&examples[..FIRST_LINES], &examples[examples.len() - LAST_LINES..]);
    text + &first.join("\n") + "\n\n" + &last.join("\n") + "\n"
}

/// The sentence of a command up to its first colon or semicolon, as far as it fits into a line of 80.
fn first_clause(command: &Command) -> String {
    const ROOM: usize = 66;
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let clause = about.split([':', ';']).next().unwrap_or_default();
    let end = if clause.chars().count() > ROOM { clause.rfind(", ").unwrap_or(clause.len()) } else { clause.len() };
    clause[..end].to_owned()
}

/// Lines of at most 78 letters, each with an indent.
fn wrapped(indent: &str, text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut().filter(|line| line.len() + 1 + word.len() <= 78) {
            Some(line) => *line += &format!(" {word}"),
            None => lines.push(format!("{indent}{word}")),
        }
    }
    lines.join("\n") + "\n"
}

/// Returns what to do instead of a command or an option that there is not; `None` for other mistakes. Of the commands within
/// `map` and others the parser knows the names.
pub fn mistake(args: &[OsString], error: &clap::Error, program: &Command) -> Option<CliError> {
    let mut names = args.iter().skip(1).map(|word| word.to_string_lossy()).filter(|word| !word.starts_with('-'));
    if let Some(ContextValue::String(found)) = error.get(ContextKind::InvalidArg)
        && error.kind() == ErrorKind::UnknownArgument
    {
        let command = names.fold(program, |command, name| command.find_subcommand(&*name).unwrap_or(command));
        if command.get_name() == "scenarios" && !found.starts_with('-') {
            let advice = "`wildfire scenarios --show NAME` prints a scenario";
            return Some(CliError::bad_input(format_args!("`{}` is no option", visible(found)), Some(advice)));
        }
        let advice = options::advice(command, found)?;
        return Some(CliError::bad_input(format_args!("there is no option `{found}` here"), Some(advice)));
    }
    let Some(ContextValue::String(found)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    let first = names.next()?;
    let named = if first == "help" { names.next()? } else { first };
    if named != *found {
        return None;
    }
    let names = program.get_subcommands().filter(|command| !command.is_hide_set()).map(Command::get_name);
    let meant = SYNONYMS.iter().find(|(word, _)| *word == found.to_lowercase()).map(|(_, name)| (*name).to_owned());
    let meant = meant.or_else(|| wildfire_scenario::nearest_name(found, names));
    let tip = meant.map_or_else(String::new, |name| format!("; did you mean `wildfire {name}`?"));
    let sentence = format!("there is no command `{}`{tip}", visible(found));
    Some(CliError::bad_input(sentence, Some("`wildfire --help` shows the commands")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{parse, program};

    #[test]
    fn the_overview_is_short_and_names_every_command() {
        let program = program();
        let text = overview(&program);
        assert!(text.lines().count() < 45 && text.lines().all(|line| line.len() <= 80), "{text}");
        for command in program.get_subcommands() {
            assert!(text.contains(command.get_name()), "{}: {text}", command.get_name());
        }
    }

    #[test]
    fn what_was_meant_by_a_command_is_found() {
        let program = program();
        for (word, name) in
            SYNONYMS.into_iter().chain([("bacth", "batch"), ("lesson", "lessons"), ("scenario", "scenarios")])
        {
            assert!(program.find_subcommand(name).is_some() && program.find_subcommand(word).is_none(), "{word}");
            for line in [vec!["wildfire", word], vec!["wildfire", "help", word]] {
                let args: Vec<OsString> = line.iter().map(OsString::from).collect();
                let error = parse(&args).expect_err(word);
                let message = mistake(&args, &error, &program).map(|error| format!("{error:?}")).unwrap_or_default();
                assert!(message.contains(&format!("did you mean `wildfire {name}`?")), "{line:?}: {message}");
            }
        }
        let args = ["wildfire", "map", "burshfire"].map(OsString::from);
        let error = parse(&args).expect_err("there is no such map");
        assert!(mistake(&args, &error, &program).is_none(), "the parser knows the maps");
    }
}
