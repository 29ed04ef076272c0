//! `wildfire new`: templates with comments, to begin with.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

use crate::batch::PLAN_TEMPLATE;
use crate::cli::args::{NewArguments, NewFile};
use crate::cli::error::CliError;
use crate::cli::output_files::{Files, Format};
use crate::cli::terminal;
use crate::input_file::is_standard_stream;
use crate::scenario;

const SCENARIO_HEAD: &str = "\
# A scenario of your own. Every value is spelled out, as the built-in scenario `contest` has it; what is left out has
# that value too. `wildfire check FILE` says what it means, scenarios/README.md what each choice does.
";

pub fn run(arguments: &NewArguments) -> Result<ExitCode, CliError> {
    let text = match arguments.what {
        NewFile::Scenario => scenario_template(),
        NewFile::Plan => PLAN_TEMPLATE.to_owned(),
    };
    match &arguments.file {
        Some(path) if !is_standard_stream(path) => write_new(path, &text)?,
        _ => terminal::print(&text)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The contest under another name and with another opening comment.
fn scenario_template() -> String {
    let built_in = scenario::BUILT_IN.iter().find(|(name, _)| *name == "contest");
    let (_, contest) = built_in.expect("it is the default");
    let body: String = contest.split_inclusive('\n').skip_while(|line| line.starts_with('#')).collect();
    format!("{SCENARIO_HEAD}{}", body.replacen("name = \"contest\"", "name = \"mine\"", 1))
}

/// Writes a file that is not there yet.
fn write_new(path: &Path, text: &str) -> Result<(), CliError> {
    Files { outputs: vec![(Format::Toml, path)], ..Files::default() }.check()?;
    let written = File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            let sentence = format!("{} is there already; expected a name that is free", path.display());
            CliError::bad_input(sentence, None)
        }
        _ => CliError::unwritable(path, &error),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenario_template_is_the_contest_under_another_name() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("mine.toml");
        write_new(&path, &scenario_template()).expect("writable");
        let mine = scenario::load(&path.display().to_string(), &[]).expect("it is a scenario");
        let contest = scenario::load("contest", &[]).expect("it is built in");
        assert_eq!(mine, scenario::Scenario { name: "mine".into(), ..contest });
    }
}
