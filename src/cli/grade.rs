//! `wildfire grade`: marks for an entry of a course.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use crate::cli::arena::ArenaPlayArguments;
use crate::cli::args::{ProgramArguments, jobs_or_all};
use crate::cli::batch::{SeedsArgument, parse_seeds};
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::output_files::{Files, Format, write_all};
use crate::cli::report::FormArguments;
use crate::cli::terminal::Progress;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::grading::{Grade, GradeError, GradePlan, GradeRequest};
use wildfire_batch::plan::{BatchPlan, CourseRefusal};

#[derive(Debug, Args)]
#[command(after_help = "\
The rules need a table [grading]: points of the tests, baselines to beat, and a
table of marks. An entry that is not valid gets a grade, too; the exit code is
then 2.

Examples:
  wildfire grade mine --rules course/rules.toml --trust
  wildfire grade mine --rules rules.toml --seeds 1..5
  wildfire grade submission --rules rules.toml --for gradescope --out results.json")]
pub struct GradeArguments {
    /// The entry: its file, or a folder with entry.toml.
    #[arg(value_name = "ENTRY")]
    pub entry: PathBuf,
    /// Rules of the course, with a table [grading].
    #[arg(long, value_name = "FILE.toml")]
    pub rules: PathBuf,
    /// Seeds instead of those of the rules: ranges and lists, or `@FILE`.
    #[arg(short, long, allow_hyphen_values = true, value_parser = parse_seeds)]
    pub seeds: Option<SeedsArgument>,
    #[command(flatten)]
    pub play: ArenaPlayArguments,
    /// Form of the file of --out.
    #[arg(long = "for", value_name = "PLATFORM", default_value = "plain")]
    pub platform: Platform,
    /// Write the grade to this file: results.json of Gradescope, result.json of Classroom 50, or all numbers.
    #[arg(short = 'o', long = "out", alias = "json-out", value_name = "FILE.json")]
    pub json_out: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
}

/// Where a course hands out and collects work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Platform {
    Gradescope,
    Classroom50,
    /// A folder with a Makefile.
    Plain,
}

pub fn run(arguments: &GradeArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let files = Files { form: arguments.form, ..Files::default() }.writing([(Format::Json, &arguments.json_out)]);
    let stream = files.check()?;
    let programs = ProgramArguments { trust: arguments.play.trust, ..ProgramArguments::default() };
    let context = context.with_programs(&programs);
    let plan = GradePlan::new(&GradeRequest {
        rules: arguments.rules.clone(),
        entry: arguments.entry.clone(),
        seeds: arguments.seeds.as_ref().map(SeedsArgument::seeds).transpose()?,
    })?;
    plan.plan().map_or(Ok(()), |plan| context.expect_trusted_plan(plan))?;
    let runs = plan.plan().map_or(0, BatchPlan::count);
    let progress = Progress::new(runs, "runs", context.quiet);
    let options = context.registry.clone().into();
    let grade = plan.play(&options, jobs_or_all(arguments.play.jobs), || progress.advance())?;
    progress.end();
    let text = form(&grade, arguments.platform);
    write_all(&[(arguments.json_out.as_deref(), &|path| write_whole(path, text.as_bytes()))], context.quiet)?;
    stream.print(&arguments.form.render(&grade))?;
    Ok(match () {
        () if grade.is_refused => ExitCode::from(exit::BAD_INPUT),
        () if grade.has_violation => ExitCode::from(exit::VIOLATION),
        () if grade.failed_runs > 0 => ExitCode::from(exit::RUN_FAILED),
        () => ExitCode::SUCCESS,
    })
}

fn form(grade: &Grade, platform: Platform) -> String {
    let value = match platform {
        Platform::Gradescope => grade.gradescope(),
        Platform::Classroom50 => grade.classroom50(),
        Platform::Plain => serde_json::to_value(grade).expect("a grade is JSON"),
    };
    format!("{value:#}\n")
}

impl From<GradeError> for CliError {
    fn from(error: GradeError) -> Self {
        match error {
            GradeError::Rules(fault) => match fault.unreadable {
                Some(kind) => Self::from_input_error(fault, kind),
                None => Self::bad_input(fault, None),
            },
            GradeError::Refused(CourseRefusal::Request(refusal)) => refusal.into(),
            GradeError::Refused(refusal) => Self::bad_input(refusal, None),
            GradeError::Batch(error) => error.into(),
        }
    }
}
