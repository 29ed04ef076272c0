//! Files that people write, and what may stand in them: `wildfire scenarios`, `check`, `new` and `schema`.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::batch::{PLAN_TEMPLATE, TableOfRows, plan_schema, row_schema, rules_schema};
use crate::cli::args::ScenarioArguments;
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::output_files::{Files, Format};
use crate::cli::terminal;
use crate::document::{Block, Document};
use crate::input_file::is_standard_stream;
use crate::programs::protocol;
use crate::scenario::{self, BUILT_IN, LoadedScenario, MemoryLimit};
use crate::timeline::export;

const SCENARIO_HEAD: &str = "\
# A scenario of your own. Every value is spelled out, as the built-in scenario `contest` has it; what is left out has
# that value too. `wildfire check FILE` says what it means, scenarios/README.md what each choice does.
";

/// Planners to begin with, by the ending of their file.
const PLANNER_TEMPLATES: [(&str, &str); 3] = [
    ("py", include_str!("../../assets/planners/planner.py")),
    ("cpp", include_str!("../../assets/planners/planner.cpp")),
    ("rs", include_str!("../../assets/planners/planner.rs")),
];

#[derive(Debug, Args)]
pub struct NewArguments {
    /// The kind of file.
    pub what: NewFile,
    /// The file to write, which must not be there yet [default: print it]. A planner is one in Python, C++ or Rust, as the
    /// file's ending says: `.py`, `.cpp` or `.rs`.
    pub file: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum NewFile {
    Scenario,
    Plan,
    Planner,
}

#[derive(Debug, Args)]
pub struct SchemaArguments {
    /// Files, or tables that a batch writes.
    pub of: SchemaOf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum SchemaOf {
    Scenario,
    Plan,
    Rules,
    Runs,
    PlannerCalls,
    States,
    PlannerProtocol,
    /// The object that `wildfire export` writes as JSON.
    Export,
}

#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    /// The memory limit that the estimate is compared with [default: 2GB].
    #[arg(long, value_name = "SIZE", default_value_t, hide_default_value = true)]
    pub memory: MemoryLimit,
}

#[derive(Debug, Args)]
pub struct ScenariosArguments {
    /// Print the file of this built-in scenario.
    #[arg(long, value_name = "NAME")]
    pub show: Option<String>,
}

/// Explains a scenario.
pub fn check(arguments: &CheckArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let loaded =
        LoadedScenario::open(&arguments.scenario.source, &context.with_own_names(&arguments.scenario.overrides))?;
    terminal::print(&scenario::explain(&loaded, arguments.memory).to_text())?;
    Ok(ExitCode::SUCCESS)
}

/// Lists the built-in scenarios, or prints the file of one.
pub fn list_or_show(arguments: &ScenariosArguments) -> Result<ExitCode, CliError> {
    match &arguments.show {
        Some(name) => terminal::print(built_in(name)?)?,
        None => {
            // A list without a title needs no page.
            let term = |(name, text): &(&str, &str)| ((*name).to_owned(), first_sentence(text));
            let terms = Block::Terms(BUILT_IN.iter().map(term).collect());
            terminal::print(&Document::default().with([terms]).to_text())?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn built_in(name: &str) -> Result<&'static str, CliError> {
    let found = BUILT_IN.iter().find(|(known, _)| *known == name);
    found.map(|(_, text)| *text).ok_or_else(|| {
        let names: Vec<_> = BUILT_IN.iter().map(|(known, _)| *known).collect();
        let known = format!("the built-in scenarios are {}", names.join(", "));
        CliError::bad_input(format_args!("there is no built-in scenario `{name}`"), Some(&known))
    })
}

/// Returns the purpose of a scenario: the first sentence of the comment that opens its file.
fn first_sentence(text: &str) -> String {
    let comment = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    let paragraph = comment.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    match paragraph.find(". ") {
        Some(end) => paragraph[..=end].to_owned(),
        None => paragraph,
    }
}

/// Writes a template with comments, to begin with.
pub fn new(arguments: &NewArguments) -> Result<ExitCode, CliError> {
    let file = arguments.file.as_deref().filter(|path| !is_standard_stream(path));
    let (format, text) = match arguments.what {
        NewFile::Scenario => (Format::Toml, scenario_template()),
        NewFile::Plan => (Format::Toml, PLAN_TEMPLATE.to_owned()),
        NewFile::Planner => (Format::Source, planner_template(file)?),
    };
    match file {
        Some(path) => write_new(path, format, &text)?,
        None => terminal::print(&text)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The planner in the language of the file's ending, with the file's name in its opening comment.
fn planner_template(file: Option<&Path>) -> Result<String, CliError> {
    let file = file.unwrap_or(Path::new("planner.py"));
    let ending = file.extension().unwrap_or_default();
    let Some((_, text)) = PLANNER_TEMPLATES.iter().find(|(known, _)| ending == *known) else {
        let sentence = format!("{}: expected a name that ends in .py, .cpp or .rs", file.display());
        return Err(CliError::bad_input(sentence, Some("the ending says in which language the planner begins")));
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    Ok(text.replace("FILE", &name))
}

/// The contest under another name and with another opening comment.
fn scenario_template() -> String {
    let contest = built_in("contest").expect("it is the default");
    let body: String = contest.split_inclusive('\n').skip_while(|line| line.starts_with('#')).collect();
    format!("{SCENARIO_HEAD}{}", body.replacen("name = \"contest\"", "name = \"mine\"", 1))
}

/// Writes a file that is not there yet.
fn write_new(path: &Path, format: Format, text: &str) -> Result<(), CliError> {
    Files { outputs: vec![(format, path)], ..Files::default() }.check()?;
    let written = File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            let sentence = format!("{} is there already; expected a name that is free", path.display());
            CliError::bad_input(sentence, None)
        }
        _ => CliError::unwritable(path, &error),
    })
}

/// Prints what a file may say, or what columns mean, as JSON Schema.
pub fn schema(arguments: &SchemaArguments) -> Result<ExitCode, CliError> {
    let of_file = |schema| serde_json::to_string_pretty(&schema).expect("a schema is JSON");
    let schema = match arguments.of {
        SchemaOf::Scenario => of_file(scenario::schema()),
        SchemaOf::Plan => of_file(plan_schema()),
        SchemaOf::Rules => of_file(rules_schema()),
        SchemaOf::Runs => row_schema(TableOfRows::Runs),
        SchemaOf::PlannerCalls => row_schema(TableOfRows::PlannerCalls),
        SchemaOf::States => row_schema(TableOfRows::States),
        SchemaOf::PlannerProtocol => of_file(protocol::schema()),
        SchemaOf::Export => of_file(export::schema()),
    };
    terminal::print(&format!("{schema}\n"))?;
    Ok(ExitCode::SUCCESS)
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
    fn scenario_template_is_the_contest_under_another_name() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("mine.toml");
        write_new(&path, Format::Toml, &scenario_template()).expect("writable");
        let mine = scenario::load(&path.display().to_string(), &[]).expect("it is a scenario");
        let contest = scenario::load("contest", &[]).expect("it is built in");
        assert_eq!(mine, scenario::Scenario { name: "mine".into(), ..contest });
    }
}
