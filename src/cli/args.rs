//! Arguments that several commands share.

use std::num::NonZeroUsize;
use std::{env, thread};

use clap::Args;

use crate::cli::error::CliError;
use crate::cli::numbers;
use wildfire_batch::report::PaperCharts;
use wildfire_picture::charts::PaperSize;
use wildfire_planning::{NameError, PlannerName};
use wildfire_scenario::MemoryLimit;

/// A scenario and changes to it.
#[derive(Debug, Args)]
pub struct ScenarioArguments {
    /// A scenario file, or the name of a built-in scenario.
    #[arg(value_name = "SCENARIO", default_value = "contest")]
    pub source: String,
    /// Change a value of the scenario, such as `fire.burn_out_s=30`, `unimog.prm_rs.samples=1000` (all trucks) or
    /// `unimog.0.speed_mps=6` (the first); may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    #[command(flatten)]
    pub programs: ProgramArguments,
}

/// The runs of a scenario or a batch, and the seed of one of them.
#[derive(Debug, Args)]
pub struct SeededArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    /// The seed of everything random in the run [default: 1].
    #[arg(short, long, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: Option<u64>,
}

/// Programs that plan.
#[derive(Clone, Debug, Default, Args)]
pub struct ProgramArguments {
    /// Register a program as planner and policy NAME, such as `rrt='python3 rrt.py'`; the command is split as a shell
    /// would, but no shell runs. May be repeated.
    #[arg(long = "command", value_name = "NAME=COMMAND", value_parser = parse_command)]
    pub commands: Vec<NamedCommand>,
    /// Register a WebAssembly module as planner and policy NAME, such as `rrt=rrt.wasm`; runs without `--trust`. May be
    /// repeated.
    #[arg(long = "module", value_name = "NAME=FILE.wasm", value_parser = parse_module)]
    pub modules: Vec<NamedModule>,
    /// Allow programs named in scenario files to run.
    #[arg(long)]
    pub trust: bool,
}

/// A planner that is a module: its name, and its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedModule {
    pub name: PlannerName,
    pub file: String,
}

fn parse_module(text: &str) -> Result<NamedModule, String> {
    let (name, file) = text.split_once('=').ok_or("expected NAME=FILE.wasm, such as rrt=rrt.wasm")?;
    Ok(NamedModule { name: parse_custom_name(name)?, file: file.to_owned() })
}

/// Reads a name that no built-in planner has.
fn parse_custom_name(name: &str) -> Result<PlannerName, String> {
    let name = PlannerName::new(name).map_err(|error| format!("`{name}`: {error}"))?;
    match name.built_in() {
        Some(kind) => Err(NameError::BuiltIn(kind).to_string()),
        None => Ok(name),
    }
}

/// A planner that is a program: its name, and the words of its command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedCommand {
    pub name: PlannerName,
    pub args: Vec<String>,
}

fn parse_command(text: &str) -> Result<NamedCommand, String> {
    let (name, command) = text.split_once('=').ok_or("expected NAME=COMMAND, such as rrt='python3 rrt.py'")?;
    let name = parse_custom_name(name)?;
    let args = shell_args(command)?;
    if args.first().is_none_or(String::is_empty) {
        return Err("expected a program after NAME=".to_owned());
    }
    Ok(NamedCommand { name, args })
}

/// Splits a command into words as a POSIX shell does: at blanks, but not within quotes or after a backslash. Nothing else
/// has a meaning.
fn shell_args(command: &str) -> Result<Vec<String>, String> {
    let mut args = Vec::new();
    let mut word = None::<String>;
    let mut quote = None;
    let mut letters = command.chars();
    while let Some(letter) = letters.next() {
        match (quote, letter) {
            (None, ' ' | '\t' | '\n') => args.extend(word.take()),
            (Some(open), _) if letter == open => quote = None,
            (None, '\'' | '"') => {
                // Quotes around nothing are a word too, as in `--name ""`.
                quote = Some(letter);
                word.get_or_insert_default();
            }
            (None | Some('"'), '\\') => {
                let next = letters.next().ok_or("a backslash ends the command; expected a letter after it")?;
                let word = word.get_or_insert_default();
                // Within double quotes it only has a meaning before these.
                if quote.is_some() && !matches!(next, '"' | '\\' | '$' | '`') {
                    word.push(letter);
                }
                word.push(next);
            }
            _ => word.get_or_insert_default().push(letter),
        }
    }
    args.extend(word);
    match quote {
        Some(open) => Err(format!("a {open} is not closed")),
        None => Ok(args),
    }
}

/// Arguments of every command that simulates.
#[derive(Debug, Args)]
pub struct MemoryArguments {
    /// Memory limit of a run, such as `4GB`, `512MiB` or `4G` (4 GB); a run that would exceed it is refused [default:
    /// 2GB, or the limit in the batch's plan].
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<MemoryLimit>,
}

impl MemoryArguments {
    pub fn limit(&self) -> MemoryLimit {
        self.memory.unwrap_or_default()
    }
}

/// Charts for papers.
#[derive(Clone, Copy, Debug, Args)]
pub struct PaperArguments {
    /// Also write the charts as PDF, with text as outlines.
    #[arg(long)]
    pub pdf: bool,
    /// Also write the charts as PGF, for `\input` in LaTeX, in the paper's font.
    #[arg(long)]
    pub pgf: bool,
    /// Width of the charts on paper: about 88 mm for a column, 180 mm for a page.
    #[arg(long, value_name = "MM", default_value = "88", value_parser = width_mm)]
    pub width_mm: f32,
    /// Font size of the charts in points.
    #[arg(long, value_name = "PT", default_value = "8", value_parser = font_pt)]
    pub font_pt: f32,
}

/// None, and the sizes of a column.
impl Default for PaperArguments {
    fn default() -> Self {
        Self { pdf: false, pgf: false, width_mm: 88.0, font_pt: 8.0 }
    }
}

impl PaperArguments {
    /// # Errors
    /// If letters of this size have no room on this width.
    pub fn charts(&self) -> Result<PaperCharts, CliError> {
        let Self { pdf, pgf, width_mm, font_pt } = *self;
        let min = PaperSize::min_width_mm(font_pt).ceil();
        if (pdf || pgf) && width_mm < min {
            let sentence =
                format!("--width-mm {width_mm} is too narrow for a font of {font_pt} pt; expected at least {min}");
            return Err(CliError::bad_input(sentence, Some("reduce the font size with --font-pt")));
        }
        Ok(PaperCharts { size: PaperSize { width_mm, font_pt }, pdf, pgf })
    }

    /// Names the forms in which charts are written.
    pub fn forms(&self) -> &'static str {
        match (self.pdf, self.pgf) {
            (false, false) => "SVG and PNG",
            (true, false) => "SVG, PNG and PDF",
            (false, true) => "SVG, PNG and PGF",
            (true, true) => "SVG, PNG, PDF and PGF",
        }
    }
}

fn width_mm(text: &str) -> Result<f32, String> {
    numbers::parse_within(text, &(40.0..=1000.0), "a width in millimetres")
}

fn font_pt(text: &str) -> Result<f32, String> {
    numbers::parse_within(text, &(4.0..=40.0), "a size in points")
}

/// The most threads that a batch starts.
const MAX_JOBS: usize = 1024;

pub fn parse_jobs(text: &str) -> Result<NonZeroUsize, String> {
    let jobs = numbers::parse_within(text, &(1..=MAX_JOBS), "a whole number")?;
    Ok(NonZeroUsize::new(jobs).expect("the range begins at 1"))
}

/// Returns the threads that are asked for, or those that this process is given: by Slurm, where it says so, as a task
/// that is not bound to its processors sees all of its machine; else by the machine.
pub fn jobs_or_usual(requested: Option<NonZeroUsize>) -> usize {
    jobs_or_all(requested.or_else(|| parse_jobs(&env::var("SLURM_CPUS_PER_TASK").ok()?).ok()))
}

/// Returns the threads that are asked for, or as many as the machine runs at once.
pub fn jobs_or_all(requested: Option<NonZeroUsize>) -> usize {
    requested.or_else(|| thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get)
}

pub fn parse_seed(text: &str) -> Result<u64, String> {
    let seed = numbers::parse_within(text, &(0..=u64::MAX), "a whole number");
    seed.map_err(|expected| match text.contains(['.', ',']) {
        true => "expected one seed; `wildfire batch --seeds 1..5` runs several".to_owned(),
        false => expected,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_split_as_a_shell_does() {
        for (command, args) in [
            ("python3 rrt.py  --range 12", &["python3", "rrt.py", "--range", "12"][..]),
            (r#"a 'b c' "d \"e\" \x" f\ g ''"#, &["a", "b c", r#"d "e" \x"#, "f g", ""]),
            ("a|b ; $c 'it'\\''s'", &["a|b", ";", "$c", "it's"]),
        ] {
            assert_eq!(
                shell_args(command).as_deref(),
                Ok(&args.iter().map(ToString::to_string).collect::<Vec<_>>()[..])
            );
        }
        for wrong in ["'a", "a \"b", "a\\"] {
            assert!(shell_args(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn command_has_a_name_of_its_own_and_a_program() {
        let named = parse_command("rrt=./a=b c").expect("it is one");
        assert_eq!((named.name.name(), named.args), ("rrt", vec!["./a=b".to_owned(), "c".to_owned()]));
        for (wrong, fragment) in [
            ("rrt", "expected NAME=COMMAND"),
            ("rrt=", "expected a program"),
            ("rrt=''", "expected a program"),
            ("RRT=a", "a letter first"),
            ("prm-rs=a", "built-in"),
        ] {
            let message = parse_command(wrong).expect_err("it is wrong");
            assert!(message.contains(fragment), "{wrong}: {message}");
        }
    }
}
