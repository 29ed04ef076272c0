//! Queries as a benchmark log of OMPL, the Open Motion Planning Library, which its statistics script puts into a database
//! for Planner Arena (M. Moll, I. A. Șucan, L. E. Kavraki, "Benchmarking Motion Planning Algorithms", IEEE Robotics &
//! Automation Magazine 22(3), 2015).
//!
//! A log is a head of lines in a fixed order, then for each planner its settings, the names and types of what is known of
//! a run, a line of values for each run, and a full stop. Planners of one name with other settings are others.

use std::io::{self, Write};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};
use std::{env, fs};

use chrono::DateTime;

use crate::cli::error::CliError;
use wildfire_base::whole_file::WholeFile;
use wildfire_batch::drives::{DriveFailure, DriveQuery};
use wildfire_batch::execute::Machine;
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_planning::judge::DriveFigures;
use wildfire_planning::{PlanFailure, PlannerName};
use wildfire_scenario::{MemoryLimit, Programs};

/// OMPL's own words for the ends of a run, by their numbers there.
const STATUSES: [&str; 10] = [
    "Unknown status",
    "Invalid start",
    "Invalid goal",
    "Unrecognized goal type",
    "Timeout",
    "Approximate solution",
    "Exact solution",
    "Crash",
    "Abort",
    "Infeasible",
];

/// All that a log holds.
pub struct OmplLog<'a> {
    /// The name of the experiment.
    pub scenario: &'a str,
    /// The first, if there are several.
    pub seed: u64,
    /// `None` where nobody knows, which is the day on which 1970 began.
    pub started: Option<Started>,
    pub memory: MemoryLimit,
    /// The longest time that a query of a program may take, seconds; 0 without programs.
    pub program_limit_s: f64,
    /// A line for each problem.
    pub problems: Vec<String>,
    pub planners: Vec<OmplPlanner<'a>>,
}

/// A planner with settings.
pub struct OmplPlanner<'a> {
    pub name: &'a str,
    pub settings: Vec<(String, String)>,
    pub runs: Vec<OmplRun<'a>>,
}

/// A query, and which of the problems it is of.
pub struct OmplRun<'a> {
    pub problem: usize,
    pub seed: u64,
    pub query: &'a DriveQuery,
}

/// A property of a run: its name and type, and its value, `None` where there is none.
type Property = (&'static str, fn(&OmplRun) -> Option<String>);

const PROPERTIES: [Property; 14] = [
    ("approximate solution BOOLEAN", |_| boolean(false)),
    ("build time REAL", |run| run.query.cost.map(|cost| cost.cpu_build_s.to_string())),
    ("correct solution BOOLEAN", |run| boolean(run.query.solved().is_some())),
    ("cusps INTEGER", |run| figure(run, |drive| Some(drive.cusps.into()))),
    ("drive time REAL", |run| figure(run, |drive| Some(drive.drive_s))),
    ("expansions INTEGER", |run| run.query.cost.map(|cost| cost.expansions.to_string())),
    ("goal INTEGER", |run| Some(run.query.goal.to_string())),
    ("lower bound ratio REAL", |run| figure(run, |drive| drive.printed_ratio())),
    ("problem INTEGER", |run| Some(run.problem.to_string())),
    ("seed INTEGER", |run| Some(run.seed.to_string())),
    ("solution clearance REAL", |run| figure(run, |drive| Some(drive.min_clearance_m))),
    ("solution length REAL", |run| figure(run, |drive| Some(drive.length_m))),
    ("solved BOOLEAN", |run| boolean(run.query.figures.is_some())),
    ("time REAL", |run| run.query.cost.map(|cost| cost.cpu_query_s.to_string())),
];

/// When queries began, in seconds since 1970 began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Started(i64);

/// The variable that says which day it is, for whoever wants the same log again
/// (<https://reproducible-builds.org/specs/source-date-epoch/>).
const SOURCE_DATE_EPOCH: &str = "SOURCE_DATE_EPOCH";

impl Started {
    /// Returns now, or what the environment says that it is.
    ///
    /// # Errors
    /// If that is no time.
    pub fn now() -> Result<Self, CliError> {
        let Some(epoch) = env::var_os(SOURCE_DATE_EPOCH) else {
            #[expect(clippy::disallowed_methods, reason = "the log says the day of the benchmark")]
            let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
            return Ok(Self(i64::try_from(now.as_secs()).unwrap_or(0)));
        };
        let epoch = epoch.to_string_lossy();
        let seconds = epoch.parse().ok().filter(|seconds| (0..=LAST_SECOND).contains(seconds));
        seconds.map(Self).ok_or_else(|| {
            let sentence = format!("{SOURCE_DATE_EPOCH} is `{epoch}`; expected whole seconds since 1970");
            CliError::bad_input(sentence, None)
        })
    }

    /// Writes it as OMPL does: in the extended form of ISO 8601, here in UTC.
    fn iso(self) -> String {
        let date = DateTime::from_timestamp(self.0, 0).unwrap_or_default();
        date.format("%Y-%m-%dT%H:%M:%S").to_string()
    }
}

/// The last second of the year 9999.
const LAST_SECOND: i64 = 253_402_300_799;

/// Returns the longest time that a query of these planners may take if they are programs; 0 without programs.
pub fn program_limit_s(planners: &[PlannerName], programs: &Programs) -> f64 {
    let limits = planners.iter().filter_map(|name| programs.get(name)).map(|program| program.query_limit_s);
    limits.fold(0.0, f64::max)
}

impl OmplLog<'_> {
    /// Writes the log.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut log = WholeFile::create(path)?;
        self.write_head(&mut log)?;
        for planner in &self.planners {
            writeln!(log, "{}", planner.name)?;
            writeln!(log, "{} common properties", planner.settings.len())?;
            planner.settings.iter().try_for_each(|(name, value)| writeln!(log, "{name} = {}", one_line(value)))?;
            // There is one more than the list has, for the status, which is an enumeration and comes last.
            writeln!(log, "{} properties for each run", PROPERTIES.len() + 1)?;
            PROPERTIES.iter().try_for_each(|(name, _)| writeln!(log, "{name}"))?;
            writeln!(log, "status ENUM")?;
            writeln!(log, "{} runs", planner.runs.len())?;
            planner.runs.iter().try_for_each(|run| write_run(&mut log, run))?;
            writeln!(log, ".")?;
        }
        log.finish()
    }

    fn write_head(&self, log: &mut impl Write) -> io::Result<()> {
        writeln!(log, "wildfire version {PROGRAM_VERSION}")?;
        // The script of OMPL splits the line at blanks.
        writeln!(log, "Experiment {}", self.scenario.replace(char::is_whitespace, "_"))?;
        writeln!(log, "0 experiment properties")?;
        writeln!(log, "Running on {}", host())?;
        writeln!(log, "Starting at {}", self.started.unwrap_or_default().iso())?;
        writeln!(log, "<<<|")?;
        for (number, problem) in self.problems.iter().enumerate() {
            writeln!(log, "problem {number}: {}", one_line(problem))?;
        }
        writeln!(log, "|>>>")?;
        writeln!(log, "<<<|")?;
        let machine = Machine::here(1);
        writeln!(log, "Architecture: {}", machine.architecture)?;
        writeln!(log, "CPU(s): {}", machine.processors)?;
        machine.cpu.iter().try_for_each(|model| writeln!(log, "Model name: {model}"))?;
        writeln!(log, "|>>>")?;
        // OMPL has one number for all planners, while a benchmark may ask some of them more often.
        let runs = self.planners.iter().map(|planner| planner.runs.len()).max().unwrap_or(0);
        writeln!(log, "{} is the random seed", self.seed)?;
        writeln!(log, "{} seconds per run", self.seconds_per_run())?;
        writeln!(log, "{} MB per run", self.memory.bytes as f64 / 1e6)?;
        writeln!(log, "{runs} runs per planner")?;
        writeln!(log, "{} seconds spent to collect the data", self.times().sum::<f64>())?;
        writeln!(log, "1 enum type")?;
        writeln!(log, "status|{}", STATUSES.join("|"))?;
        writeln!(log, "{} planners", self.planners.len())
    }

    fn times(&self) -> impl Iterator<Item = f64> {
        self.planners
            .iter()
            .flat_map(|planner| &planner.runs)
            .filter_map(|run| run.query.cost)
            .map(|cost| cost.cpu_query_s)
    }

    /// The limit of time, which a log must have: that of programs. The planners that are built in end by their effort, for
    /// them it is the least number of whole seconds that no query exceeded.
    fn seconds_per_run(&self) -> f64 {
        self.times().fold(self.program_limit_s.max(1.0), f64::max).ceil()
    }
}

/// Returns the machine's name, one word; `UNKNOWN`, as OMPL has it, where there is none.
fn host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let name = name.split_whitespace().next().unwrap_or("UNKNOWN");
    name.chars().filter(|letter| !letter.is_control()).collect()
}

/// The text without line ends, so that it stays one line.
fn one_line(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

fn write_run(log: &mut impl Write, run: &OmplRun) -> io::Result<()> {
    for (_, value) in &PROPERTIES {
        write!(log, "{}; ", value(run).unwrap_or_default())?;
    }
    writeln!(log, "{}; ", status(run))
}

/// The number of the word in [`STATUSES`].
fn status(run: &OmplRun) -> usize {
    let word = match run.query.failure {
        None => "Exact solution",
        Some(DriveFailure::Planner(failure)) => match failure {
            PlanFailure::StartBlocked => "Invalid start",
            PlanFailure::GoalBlocked => "Invalid goal",
            PlanFailure::BudgetSpent | PlanFailure::TimedOut => "Timeout",
            PlanFailure::Disconnected => "Infeasible",
            PlanFailure::Crashed => "Crash",
            PlanFailure::LocalMinimum | PlanFailure::BadAnswer => "Unknown status",
        },
        Some(DriveFailure::NoPath | DriveFailure::Dropped) => "Unknown status",
    };
    STATUSES.iter().position(|status| *status == word).expect("every word is one of them")
}

fn figure(run: &OmplRun, figure: fn(DriveFigures) -> Option<f64>) -> Option<String> {
    run.query.figures.and_then(figure).map(|figure| figure.to_string())
}

#[expect(clippy::unnecessary_wraps, reason = "properties may have no value")]
fn boolean(value: bool) -> Option<String> {
    Some(u8::from(value).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_written_as_ompl_writes_them() {
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00"),
            (951_782_400, "2000-02-29T00:00:00"),
            (1_795_451_696, "2026-11-23T16:34:56"),
            (LAST_SECOND, "9999-12-31T23:59:59"),
        ] {
            assert_eq!(Started(seconds).iso(), expected);
        }
    }
}
