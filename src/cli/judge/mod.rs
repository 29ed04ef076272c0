//! `wildfire judge`: paths that were computed anywhere, judged like those of the program's own planners.

mod joined;
mod path_table;
mod recorded;
mod report;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use joined::{PathJudge, PathVerdict};
use path_table::{PathTable, PathTableError, TablePath};
use report::JudgeReport;

use crate::cli::args::{MemoryArguments, ProgramArguments, parse_seed};
use crate::cli::context::CommandContext;
use crate::cli::error::{CliError, exit};
use crate::cli::output_files::{self, Files, Format};
use crate::cli::plan::goal_count;
use crate::cli::report::FormArguments;
use crate::cli::together::{self, mode_parser};
use wildfire_base::document::number::count;
use wildfire_base::input_file;
use wildfire_batch::drives::{
    Attempt, AttemptSettings, CertificateFile, CertificateReport, DriveError, DriveFailure, DriveProblems, DriveQuery,
    MAX_CERTIFICATE_BYTES, attempts, shortened_field,
};
use wildfire_planning::together::Mode;
use wildfire_planning::{PlannerName, Planners};
use wildfire_scenario::{LoadedScenario, Problem};
use wildfire_timeline::file::{self, FileError};

#[derive(Debug, Args)]
#[command(after_help = "\
PATHS.csv has a row for each pose of the rear axle, in the order in which they are
driven: field,goal,planner,x_m,y_m,heading_rad,direction, as `wildfire plan --paths`
writes them. Poses in a row are at most 0.5 m apart and are joined by arcs.

The exit code is 4 if a path is invalid.

Examples:
  wildfire judge field.json paths.csv
  wildfire judge field_*.json paths.csv --against prm-rs,hybrid-astar
  wildfire judge paths.csv --scenario dense --seed 7 --cells 50
  wildfire judge --recording run.wildfire --csv drives.csv
  wildfire judge field_*.json --certificate bounds.json
  wildfire judge --together instance.yaml solution.yaml")]
pub struct JudgeArguments {
    /// Field files, then the table of paths; without field files, the paths are on the scenario's field for the seed.
    #[arg(value_name = "FIELD.json|PATHS.csv", required_unless_present_any = ["recording", "together", "certificate"])]
    pub files: Vec<PathBuf>,
    /// Judge the drives of a recorded run, each as a path towards its goal.
    #[arg(long, value_name = "RUN", conflicts_with_all = ["files", "goals", "cells"])]
    pub recording: Option<PathBuf>,
    /// Check lower bounds on the lengths of paths that `wildfire plan --certify` wrote; all files are field files then.
    #[arg(
        long, value_name = "FILE.json",
        conflicts_with_all = ["recording", "against", "cells", "commands", "modules", "trust", "csv"]
    )]
    pub certificate: Option<PathBuf>,
    /// Judge a solution of many vehicles that `wildfire plan --together` or a program of the CL-MAPF benchmark wrote.
    #[arg(
        help_heading = "Many vehicles", long, num_args = 2, value_names = ["INSTANCE.yaml", "SOLUTION.yaml"],
        conflicts_with_all = [
            "files", "recording", "certificate", "against", "seed", "goals", "cells", "scenario", "overrides", "commands", "modules",
            "trust", "memory", "csv",
        ]
    )]
    pub together: Vec<PathBuf>,
    /// Rules of what touches what [default: exact].
    #[arg(help_heading = "Many vehicles", long, requires = "together", value_parser = mode_parser())]
    pub mode: Option<Mode>,
    /// Planner to compare with, given the same goals; several names with commas or repeated.
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub against: Vec<PlannerName>,
    /// The seed of everything random.
    #[arg(short, long, default_value_t = 1, allow_hyphen_values = true, value_parser = parse_seed)]
    pub seed: u64,
    /// Number of random free goal poses on the scenario's field, as in `wildfire plan` [default: 50].
    #[arg(help_heading = "Goals", long, value_name = "N", value_parser = goal_count)]
    pub goals: Option<usize>,
    /// Number of random goal bushes on each field instead, as in `wildfire plan`.
    #[arg(help_heading = "Goals", long, value_name = "N", conflicts_with = "goals", value_parser = goal_count)]
    pub cells: Option<usize>,
    /// The scenario whose first truck drives, with its planners' settings: a file, or a built-in name.
    #[arg(long, value_name = "SCENARIO", default_value = "drives")]
    pub scenario: String,
    /// Change a value of the scenario, such as `unimog.vehicle.turning_radius_m=8`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub overrides: Vec<String>,
    #[command(flatten)]
    pub programs: ProgramArguments,
    #[command(flatten)]
    pub memory: MemoryArguments,
    #[command(flatten)]
    pub form: FormArguments,
    /// Write a row for each goal and planner.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
}

impl JudgeArguments {
    fn problems(&self, fields: &[PathBuf], loaded: &LoadedScenario) -> Result<Vec<Problem>, CliError> {
        let &Self { seed, goals, cells, .. } = self;
        if goals.is_some() && !fields.is_empty() {
            let sentence = "--goals samples goals on the scenario's field; expected no field files with it";
            return Err(CliError::bad_input(sentence, Some("field files contain their goals")));
        }
        Ok(DriveProblems { fields: fields.to_vec(), goals, cells }.load(&loaded.scenario, seed)?)
    }
}

/// Checks a file of certificates on the fields of these problems.
fn judge_certificates(path: &Path, problems: &[Problem], arguments: &JudgeArguments) -> Result<ExitCode, CliError> {
    let inputs = arguments.files.iter().map(PathBuf::as_path).chain([path]).collect();
    let stream = Files { inputs, form: arguments.form, ..Files::default() }.check()?;
    let text =
        input_file::read_text(path, MAX_CERTIFICATE_BYTES).map_err(|error| CliError::unreadable(path, &error))?;
    let at_path = |fault: String| format!("{}: {fault}", path.display());
    let read = CertificateFile::from_text(&text).map_err(|fault| {
        CliError::bad_input(at_path(fault), Some("expected a file that `wildfire plan --certify` wrote"))
    })?;
    let report = CertificateReport::new(read, problems)
        .map_err(|fault| CliError::bad_input(at_path(fault), Some("name the field files that were planned on")))?;
    stream.print(&arguments.form.render(&report))?;
    Ok(if report.is_clean() { ExitCode::SUCCESS } else { ExitCode::from(exit::VIOLATION) })
}

pub fn run(arguments: &JudgeArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    if !arguments.together.is_empty() {
        return together::judge(&arguments.together, arguments.mode.unwrap_or(Mode::Exact), arguments.form);
    }
    if let Some(certificate) = &arguments.certificate {
        let loaded = LoadedScenario::open(&arguments.scenario, &context.with_custom_names(&arguments.overrides))?;
        let problems = arguments.problems(&arguments.files, &loaded)?;
        return judge_certificates(certificate, &problems, arguments);
    }
    // This lists every file that is read, so an output cannot overwrite an input.
    let mut inputs: Vec<&Path> = arguments.files.iter().chain(&arguments.recording).map(PathBuf::as_path).collect();
    inputs.push(Path::new(&arguments.scenario));
    let files = Files { inputs, form: arguments.form, ..Files::default() };
    let stream = files.writing([(Format::Csv, &arguments.csv)]).check()?;
    let loaded = LoadedScenario::open(&arguments.scenario, &context.with_custom_names(&arguments.overrides))?;
    // Planners are made before the table is read: a name that is wrong must not cost the reading of a large table.
    context.expect_trusted_planners(&loaded.scenario, &arguments.against)?;
    let makers = context.planners_of(&loaded.scenario)?;
    let against = AgainstPlanners::new(arguments, &loaded, &makers)?;
    let conclude = |report: &JudgeReport| {
        let printed = stream.print(&arguments.form.render(report));
        // Whatever cannot be written, all else is kept.
        let csv = arguments.csv.as_deref();
        let written = output_files::write_all(&[(csv, &|path| report.drives.write(path))], context.quiet);
        printed.and(written)?;
        Ok(if report.has_violations() { ExitCode::from(exit::VIOLATION) } else { ExitCode::SUCCESS })
    };
    match (&arguments.recording, arguments.files.split_last()) {
        (Some(recording), _) => judge_recording(recording, &against, conclude),
        (None, Some((paths, fields))) => judge_table(fields, paths, &against, conclude),
        (None, None) => unreachable!("the arguments require files or --recording"),
    }
}

/// The planners that the paths are set beside, and what they are asked with.
struct AgainstPlanners<'a> {
    arguments: &'a JudgeArguments,
    loaded: &'a LoadedScenario,
    planners: Vec<PlannerName>,
    makers: &'a Planners,
}

impl<'a> AgainstPlanners<'a> {
    fn new(arguments: &'a JudgeArguments, loaded: &'a LoadedScenario, makers: &'a Planners) -> Result<Self, CliError> {
        let mut planners: Vec<PlannerName> = Vec::new();
        for name in &arguments.against {
            if !makers.knows(name) {
                let help = format!("expected one of {makers:?}");
                return Err(CliError::bad_input(format_args!("there is no planner `{name}`"), Some(&help)));
            }
            if !planners.contains(name) {
                planners.push(name.clone());
            }
        }
        Ok(Self { arguments, loaded, planners, makers })
    }

    /// Returns the names that they have in the report: those that have computed paths too say that they were asked.
    fn names(&self, judged: &[String]) -> Vec<String> {
        self.planners
            .iter()
            .map(|planner| {
                let mut name = planner.to_string();
                while judged.contains(&name) {
                    name += " (asked)";
                }
                name
            })
            .collect()
    }

    /// Asks all of them for all goals of a problem.
    fn attempts<'p>(&self, problem: &'p Problem) -> Result<Vec<Attempt<'p>>, CliError> {
        if self.planners.is_empty() {
            return Ok(Vec::new());
        }
        let question = AttemptSettings {
            planners: &self.planners,
            makers: self.makers,
            programs: &self.loaded.scenario.planner,
            seed: self.arguments.seed,
            limit: self.arguments.memory.limit(),
        };
        attempts(problem, &question).map_err(|error| {
            CliError::run_failed(format_args!("planning on the field {}: {error}", shortened_field(&problem.name)))
        })
    }
}

/// Returns the row of an attempt, under the planner's name in the report.
fn row_of_attempt(attempt: &Attempt, goal: usize, name: &str) -> DriveQuery {
    DriveQuery { goal, planner: name.into(), ..attempt.query(None, 0) }
}

/// Returns the row of a path that was computed elsewhere.
fn row_of_path((field, goal, planner): (&str, usize, &str), verdict: Option<PathVerdict>) -> DriveQuery {
    let figures = verdict.as_ref().map(|verdict| verdict.figures);
    DriveQuery {
        seed: None,
        variant: 0,
        field: field.into(),
        goal,
        planner: planner.into(),
        cost: None,
        figures,
        // A missing path counts as a failure, so that leaving out hard goals improves nothing.
        failure: figures.is_none().then_some(DriveFailure::NoPath),
        violation: verdict.and_then(|verdict| verdict.violation).map(Into::into),
        certified_bound_m: None,
        message: None,
    }
}

fn judge_table(
    fields: &[PathBuf],
    paths: &Path,
    against: &AgainstPlanners,
    conclude: impl Fn(&JudgeReport) -> Result<ExitCode, CliError>,
) -> Result<ExitCode, CliError> {
    if paths.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
        let sentence = format!("{} has the ending of a field file; expected the table of paths last", paths.display());
        return Err(CliError::bad_input(sentence, Some("wildfire judge FIELD.json PATHS.csv")));
    }
    let problems = against.arguments.problems(fields, against.loaded)?;
    let (judged, mut verdicts) = judge_paths(paths, &problems)?;
    let names = against.names(&judged);
    let mut rows = Vec::new();
    for (index, problem) in problems.iter().enumerate() {
        let attempts = against.attempts(problem)?;
        // As many to each goal as planners were asked, in their order.
        let mut answers = attempts.chunks(names.len().max(1));
        let field = problem.name.as_str();
        for goal in 0..problem.goals.len() {
            for (planner, name) in judged.iter().enumerate() {
                rows.push(row_of_path((field, goal, name), verdicts.remove(&(planner, index, goal))));
            }
            let answers = answers.next().unwrap_or_default().iter().zip(&names);
            rows.extend(answers.map(|(attempt, name)| row_of_attempt(attempt, goal, name)));
        }
    }
    let title = match &problems[..] {
        [only] => format!("Field `{}`", shortened_field(&only.name)),
        several => format!("{} fields", several.len()),
    };
    let goals = count(problems.iter().map(|problem| problem.goals.len()).sum(), "goal");
    let title = format!("{title}, {goals}: paths of {}", count(judged.len(), "planner"));
    conclude(&JudgeReport::new(title, &judged, &names, rows))
}

/// Verdicts by planner, field and goal.
type Verdicts = BTreeMap<(usize, usize, usize), PathVerdict>;

/// Judges all paths of a table, one after the other; returns who computed them too.
fn judge_paths(paths: &Path, problems: &[Problem]) -> Result<(Vec<String>, Verdicts), CliError> {
    let bad =
        |fault: PathTableError| CliError::from_input_error(format_args!("{}: {fault}", paths.display()), fault.kind());
    let mut table = PathTable::open(paths, problems).map_err(bad)?;
    let mut verdicts = Verdicts::new();
    let mut judge: Option<(usize, PathJudge)> = None;
    while let Some(TablePath { planner, problem, goal, poses }) = table.next().map_err(bad)? {
        // Tables go through fields one by one, so one of them is enough to be kept.
        let path_judge = judge.take_if(|(index, _)| *index == problem).map(|(_, judge)| judge);
        let path_judge = path_judge.unwrap_or_else(|| PathJudge::new(&problems[problem]));
        verdicts.insert((planner, problem, goal), path_judge.judge(problems[problem].goals[goal], &poses));
        judge = Some((problem, path_judge));
    }
    Ok((table.into_planners(), verdicts))
}

fn judge_recording(
    recording: &Path,
    against: &AgainstPlanners,
    conclude: impl Fn(&JudgeReport) -> Result<ExitCode, CliError>,
) -> Result<ExitCode, CliError> {
    let unreadable =
        |error: FileError| CliError::from_input_error(format_args!("{}: {error}", recording.display()), error.kind());
    let timeline = file::read(recording).map_err(unreadable)?;
    let drives = recorded::recorded_drives(&timeline);
    let setting = &timeline.setting;
    if drives.is_empty() {
        let sentence = format!("{}: no truck drives in this run", recording.display());
        return Err(CliError::bad_input(sentence, None));
    }
    let mut judged: Vec<String> = drives.iter().map(|drive| drive.truck.to_string()).collect();
    judged.dedup();
    let names = against.names(&judged);
    let field = setting.scenario.as_str();
    let mut rows = Vec::new();
    for (number, drive) in drives.iter().enumerate() {
        let truck = judged.iter().find(|name| **name == drive.truck.to_string()).expect("it is in the list");
        let verdict = PathVerdict { figures: drive.figures, violation: drive.violation.clone() };
        let row = row_of_path((field, number, truck), Some(verdict));
        rows.push(DriveQuery { failure: drive.is_dropped.then_some(DriveFailure::Dropped), ..row });
        if !against.planners.is_empty() {
            let scenario = &against.loaded.scenario;
            let truck =
                scenario.unimog.first().ok_or_else(|| DriveError::NoTruck { scenario: scenario.name.clone() })?;
            let problem = recorded::problem(setting, drive, truck);
            let attempts = against.attempts(&problem)?;
            rows.extend(attempts.iter().zip(&names).map(|(attempt, name)| row_of_attempt(attempt, number, name)));
        }
    }
    let title = format!("Run of `{}`, seed {}: {}", shortened_field(field), setting.seed, count(drives.len(), "drive"));
    conclude(&JudgeReport::new(title, &judged, &names, rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::command_lines::check_message;
    use crate::cli::fuzz::text::mutated;
    use crate::cli::fuzz::{Case, Fuzzer, Law};
    use wildfire_scenario::Unimog;

    #[test]
    fn tables_of_paths_take_anything() {
        Fuzzer { name: "tables_of_paths", target: "--lib", law: table_of_paths }.run(2000);
    }

    /// Checks that a table of paths is judged, with a verdict on each path, or refused in words.
    fn table_of_paths(case: &mut Case<'_>) -> Law {
        const FIELD: &str = "{\"field\": \"mine\", \"n\": 20, \"cell_m\": 5, \"cells_cr\": [[10, 4]],\n\
                             \"start\": [20, 22.5, 0], \"goals\": [{\"pose\": [21, 22.5, 0]}, {\"disc\": [52.5, 22.5, 10]}]}";
        const TABLES: &[&str] = &[
            "field,goal,planner,x_m,y_m,heading_rad,direction\nmine,0,one,20,22.5,0,forward\n\
             mine,0,one,20.5,22.5,0,forward\nmine,0,one,21,22.5,0,forward\nmine,1,two,20,22.5,0,reverse\n\
             mine,1,two,19.6,22.49,0.02,reverse\nmine,1,two,19.9,22.5,0.01,forward\n",
            "goal,direction,x_m,y_m,heading_rad\n0,forward,20,22.5,0\n0,forward,20,22.5,0\n\"1\",forward,20,22.5,-0\n",
        ];
        let tokens =
            ["mine", "forward", "reverse", ",", "\"", "20.0000001", "3.1415926535897931", "1e6", "5e-324", "\u{FEFF}"];
        case.input = mutated(&mut case.dice, TABLES, &tokens);
        let paths = case.write("paths.csv", &case.input);
        let field = case.write("mine.json", FIELD.as_bytes());
        let problems = [Problem::open(&field, &Unimog::default()).map_err(|error| error.to_string())?];
        match judge_paths(&paths, &problems) {
            Ok((planners, verdicts)) => {
                case.count("tables of paths accepted");
                let is_sane = |it: &PathVerdict| it.figures.length_m >= 0.0 && it.figures.drive_s.is_finite();
                if planners.is_empty() || verdicts.is_empty() || !verdicts.values().all(is_sane) {
                    return Err(format!("{planners:?} have {verdicts:?}"));
                }
                Ok(())
            }
            Err(refusal) => check_message(&refusal.sentence()),
        }
    }
}
