//! Marks for an entry of a course: its runs are played and audited, tests give points, and a text tells its author why.
//!
//! The text is for the author: it has ordinals in the place of seeds, the names of files in the place of paths, and no other
//! entry than the baselines of the rules.

mod forms;
mod redaction;

use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use crate::arena::{AuditedRun, audited_run};
use crate::comparison::Metric;
use crate::execute::{BatchError, with_threads};
use crate::plan::{
    BatchPlan, Course, CourseError, CourseRefusal, CourseRequest, ENTRY_FILE, EntryFile, GradingRules, Seeds,
    course_fault, planner_of,
};
use crate::report::Failures;
use crate::table::{Better, RunRecord, run_column};
pub use redaction::Redaction;
use wildfire_base::document::number::{count, rounded, short};
use wildfire_sim::RunOptions;

/// The worst runs that the text lists.
const MAX_WORST_RUNS: usize = 3;

/// Columns whose sum is the effort of a run.
const EFFORT: [usize; 3] =
    [run_column("truck_roadmap_expansions"), run_column("truck_local_expansions"), run_column("wumpus_expansions")];

/// Columns of queries that a planner or a policy did not answer as it should.
const CRASHES: [usize; 6] = [
    run_column("truck_failed_timed_out"),
    run_column("truck_failed_crashed"),
    run_column("truck_failed_bad_answer"),
    run_column("policy_failed_timed_out"),
    run_column("policy_failed_crashed"),
    run_column("policy_failed_bad_answer"),
];

/// A reason for which nothing can be graded; what is wrong with an entry is none.
#[derive(Debug, Error)]
pub enum GradeError {
    #[error(transparent)]
    Rules(CourseError),
    #[error(transparent)]
    Refused(CourseRefusal),
    #[error(transparent)]
    Batch(#[from] BatchError),
}

/// The entry that is graded, and the rules by which it is.
#[derive(Clone, Debug)]
pub struct GradeRequest {
    pub rules: PathBuf,
    /// Its file, or a folder with `entry.toml` or one file that ends in `.toml`.
    pub entry: PathBuf,
    /// Seeds in the place of those of the rules.
    pub seeds: Option<Seeds>,
}

/// A test that gives points.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GradedTest {
    pub name: String,
    pub is_passed: bool,
    pub points: f64,
    pub max_points: f64,
    /// A sentence for the author.
    pub output: String,
}

impl GradedTest {
    fn new(name: impl Into<String>, is_passed: bool, max_points: f64, output: String) -> Self {
        let points = if is_passed { max_points } else { 0.0 };
        Self { name: name.into(), is_passed, points, max_points, output }
    }
}

/// The result of grading.
#[derive(Clone, Debug, Serialize)]
pub struct Grade {
    pub entry: String,
    pub points: f64,
    pub max_points: f64,
    pub tests: Vec<GradedTest>,
    pub metric: String,
    pub better: &'static str,
    /// The mean of the metric over all runs; none of an entry that was not played.
    pub score: Option<f64>,
    pub runs: usize,
    pub failed_runs: usize,
    /// More for the author: failed queries by reason, worst runs.
    pub remarks: Vec<String>,
    pub is_refused: bool,
    pub has_violation: bool,
}

/// The runs of an entry and of the baselines, before they are played.
#[derive(Debug)]
pub struct GradePlan {
    rules: GradingRules,
    metric: Metric,
    better: Better,
    redaction: Redaction,
    /// The runs of the entry come first; a plan without runs of it has its faults instead.
    plan: Result<BatchPlan, Vec<CourseError>>,
    entry: String,
}

impl GradePlan {
    /// Reads rules and entry. An entry that the rules refuse has a plan without runs, and a grade.
    ///
    /// # Errors
    /// If something is wrong with the rules, or with a baseline.
    pub fn new(request: &GradeRequest) -> Result<Self, GradeError> {
        let course = Course::read(&request.rules).map_err(GradeError::Rules)?;
        let rules = course.grading.clone().ok_or_else(|| {
            let message = "it has no table [grading]; expected one with `marks` or `points`";
            GradeError::Rules(course_fault(&request.rules, None, message))
        })?;
        let metric = Metric::of_outcomes(&rules.metric).map_err(|error| error.to_string());
        let metric = metric.and_then(|metric| match metric.about.better {
            Some(better) => Ok((metric, better)),
            None => Err(format!("`{}` has no better side; expected a metric that has one", rules.metric)),
        });
        let (metric, better) = metric.map_err(|message| {
            GradeError::Rules(course_fault(&request.rules, None, &format!("[grading]: {message}")))
        })?;
        let seeds = match &request.seeds {
            Some(seeds) => seeds.clone(),
            None => course.seeds().map_err(GradeError::Rules)?,
        };
        // Readers of the grade must not learn the seeds.
        let redaction = Redaction::new(seeds.iter());
        let entry_file = entry_file(&request.entry);
        let folder = request.rules.parent().unwrap_or(Path::new(""));
        let baselines: Vec<PathBuf> = rules
            .baselines
            .iter()
            // Names without the ending are those of built-in planners.
            .map(|name| if name.ends_with(".toml") { folder.join(name) } else { PathBuf::from(name) })
            .collect();
        let plan = entry_file.map_err(|fault| vec![fault]).and_then(|entry| {
            let entries = [entry.clone()].into_iter().chain(baselines).collect();
            let course_request = CourseRequest { entries, seeds: Some(seeds), ..CourseRequest::default() };
            match course_request.resolve_by(&course, &|path| read_entry(path, &rules), true) {
                Ok(found) => Ok(Ok(found.plan)),
                // Only faults of the entry make a grade; one of a baseline is a fault of the course.
                Err(CourseRefusal::Entries(faults)) if faults.iter().all(|fault| fault.path == entry) => Err(faults),
                Err(CourseRefusal::Entries(faults)) => {
                    let of_baseline = faults.into_iter().find(|fault| fault.path != entry);
                    Ok(Err(GradeError::Rules(of_baseline.expect("not all are the entry's"))))
                }
                Err(refusal) => Ok(Err(GradeError::Refused(refusal))),
            }
        });
        // Faults of the course end here, those of the entry become its grade.
        let plan = match plan {
            Ok(plan) => Ok(plan?),
            Err(faults) => Err(faults),
        };
        let entry = match &plan {
            Ok(plan) => plan.variants[0].swept[0].to_string(),
            Err(_) => request.entry.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        };
        Ok(Self { rules, metric, better, redaction, plan, entry })
    }

    /// Returns the runs; `None` of an entry that was refused.
    pub fn plan(&self) -> Option<&BatchPlan> {
        self.plan.as_ref().ok()
    }

    /// Plays and audits all runs on this number of threads, and marks them; `on_run` is called after each, in any order.
    ///
    /// # Errors
    /// If threads cannot be started. A run that fails costs points only.
    pub fn play(&self, options: &RunOptions, jobs: usize, on_run: impl Fn() + Sync) -> Result<Grade, GradeError> {
        let plan = match &self.plan {
            Ok(plan) => plan,
            Err(faults) => return Ok(self.refused(faults)),
        };
        let options = RunOptions { memory: plan.memory, ..options.clone() };
        let played = with_threads(jobs, || {
            // A run is a job by itself, as some take much longer than others.
            let numbers = (1..=plan.count()).collect::<Vec<u64>>().into_par_iter().with_max_len(1);
            let played = numbers.map(|number| {
                let AuditedRun { row, violation, .. } = audited_run(&plan.run(number), &options);
                on_run();
                GradedRun { record: RunRecord::from_row(&row), violation }
            });
            played.collect::<Vec<_>>()
        })?;
        Ok(self.marked(plan, &played))
    }

    /// The grade of an entry that the rules refuse.
    fn refused(&self, faults: &[CourseError]) -> Grade {
        let reasons: Vec<String> = faults.iter().map(|fault| self.redaction.of(&fault.to_string())).collect();
        let mut grade =
            self.grade(vec![GradedTest::new(VALID, false, self.rules.points.valid, reasons.join("; ") + ".")]);
        let points = self.rules.points;
        // Listed although not played, so that the maximum of points is that of every entry.
        let others = [(NO_CRASH, points.no_crash), (NO_VIOLATION, points.no_violation)];
        let baselines = self.rules.baselines.iter().map(|name| (beats(name), self.rules.points_of_baseline(name)));
        let effort = self.rules.max_expansions.map(|_| (EFFORT_WITHIN.to_owned(), points.effort));
        let score = (!self.rules.marks.is_empty()).then(|| (SCORE.to_owned(), self.rules.max_points_of_score()));
        let others = others
            .map(|(name, points)| (name.to_owned(), points))
            .into_iter()
            .chain(baselines)
            .chain(effort)
            .chain(score);
        grade.tests.extend(others.map(|(name, points)| GradedTest::new(name, false, points, NOT_PLAYED.into())));
        grade.is_refused = true;
        grade.with_sums()
    }

    fn grade(&self, tests: Vec<GradedTest>) -> Grade {
        Grade {
            entry: self.entry.clone(),
            points: 0.0,
            max_points: 0.0,
            tests,
            metric: self.metric.name.to_string(),
            better: self.better.name(),
            score: None,
            runs: 0,
            failed_runs: 0,
            remarks: Vec::new(),
            is_refused: false,
            has_violation: false,
        }
    }

    /// Marks the runs of all variants, in the order of the plan.
    fn marked(&self, plan: &BatchPlan, played: &[GradedRun]) -> Grade {
        // Runs come by variant, first the entry's and then each baseline's, equally many of each.
        let groups = 1 + self.rules.baselines.len();
        let ours = &played[..played.len() / groups];
        let values = self.values(played);
        let mut means = values.chunks(ours.len()).map(|values| values.iter().sum::<f64>() / values.len() as f64);
        let score = means.next().expect("the entry's runs come first");
        let points = self.rules.points;
        let runs = ours.len();
        let mut tests = vec![GradedTest::new(VALID, true, points.valid, "The entry follows the rules.".into())];
        tests.push(self.no_crash(ours));
        let first_violation = ours.iter().zip(1..).find_map(|(run, number)| Some((run.violation.as_ref()?, number)));
        let has_violation = first_violation.is_some();
        // An entry that never plays has broken no rule and spent nothing, and earns nothing by that.
        let finished = ours.iter().filter(|run| run.record.is_done()).count();
        let output = match first_violation {
            None => format!("The audit of {} found no violation.", count(finished, "finished run")),
            Some((violation, number)) => {
                format!("Run {number} of {runs} violates a rule: {}.", self.redaction.of(violation))
            }
        };
        tests.push(GradedTest::new(NO_VIOLATION, finished > 0 && !has_violation, points.no_violation, output));
        let metric = &self.rules.metric;
        for (name, theirs) in self.rules.baselines.iter().zip(means) {
            let is_better = self.better.best_first(score, theirs).is_lt();
            let output = format!("Mean {metric}: {}; of the baseline: {}.", rounded(score, 2), rounded(theirs, 2));
            let points = self.rules.points_of_baseline(name);
            tests.push(GradedTest::new(beats(name), is_better && !has_violation, points, output));
        }
        if let Some(max) = self.rules.max_expansions {
            let effort = ours.iter().map(GradedRun::effort).sum::<f64>() / runs as f64;
            let output = format!("{} expansions per run on average, at most {}.", rounded(effort, 0), short(max));
            tests.push(GradedTest::new(EFFORT_WITHIN, finished > 0 && effort <= max, points.effort, output));
        }
        if let Some(points) = self.rules.points_of(score) {
            let max_points = self.rules.max_points_of_score();
            let points = if has_violation { 0.0 } else { (points * 100.0).round() / 100.0 };
            let counted = if has_violation { "; it does not count, because a run violates a rule" } else { "" };
            let output = format!("Mean {metric} over {}: {}{counted}.", count(runs, "run"), rounded(score, 2));
            tests.push(GradedTest { points, ..GradedTest::new(SCORE, points > 0.0, max_points, output) });
        }
        Grade {
            score: Some(score),
            runs,
            failed_runs: runs - finished,
            remarks: self.remarks(plan, ours, &values[..runs]),
            has_violation,
            ..self.grade(tests)
        }
        .with_sums()
    }

    /// Returns the metric of each run. Those without a value get the worst one of all, so that nobody gains by failing.
    fn values(&self, played: &[GradedRun]) -> Vec<f64> {
        let values: Vec<Option<f64>> = played.iter().map(|run| self.metric.value(&run.record)).collect();
        let found = values.iter().flatten().copied();
        let worst = match self.better {
            Better::Higher => found.fold(0.0, f64::min),
            Better::Lower => found.fold(0.0, f64::max),
        };
        values.into_iter().map(|value| value.unwrap_or(worst)).collect()
    }

    fn no_crash(&self, ours: &[GradedRun]) -> GradedTest {
        let failed = ours.iter().filter(|run| !run.record.is_done()).count();
        let crashed: u64 = ours.iter().map(GradedRun::crashed_queries).sum();
        let first = ours.iter().find(|run| run.crashed_queries() > 0 || !run.record.is_done());
        let message = first.map_or(String::new(), |run| self.redaction.of(run.record.message()));
        let runs = count(ours.len(), "run");
        let output = match (failed, crashed) {
            (0, 0) => format!("{runs} finished; no query crashed, timed out or had an invalid answer."),
            (0, _) => format!("{crashed} queries crashed, timed out or had an answer that is not valid: {message}."),
            _ => format!("{failed} of {runs} failed: {message}."),
        };
        GradedTest::new(NO_CRASH, failed == 0 && crashed == 0, self.rules.points.no_crash, output)
    }

    /// Lists what an author may want to look at: failed queries by reason, and the worst runs by their ordinals.
    fn remarks(&self, plan: &BatchPlan, ours: &[GradedRun], values: &[f64]) -> Vec<String> {
        let sum = ours.iter().fold([Failures::default(), Failures::default()], |[mut queries, mut asks], run| {
            queries += Failures::of_queries(&run.record);
            asks += Failures::of_asks(&run.record);
            [queries, asks]
        });
        let [queries, asks] = sum;
        let planner = planner_of(&plan.variants[0].scenario);
        let failures = queries.of_planner(&planner).into_iter().chain(asks.of_policies(None));
        let mut remarks: Vec<String> = failures.map(|sentence| self.redaction.of(&sentence)).collect();
        let mut worst: Vec<usize> = (0..values.len()).collect();
        worst.sort_by(|one, other| self.better.best_first(values[*other], values[*one]));
        // Ordinals, as the numbers of seeds stay hidden.
        let worst =
            worst.into_iter().take(MAX_WORST_RUNS).map(|run| format!("run {} ({})", run + 1, short(values[run])));
        let worst: Vec<String> = worst.collect();
        remarks.push(format!("Worst of {}: {}.", count(values.len(), "run"), worst.join(", ")));
        remarks
    }
}

const VALID: &str = "Valid entry";
const NO_CRASH: &str = "No crash";
const NO_VIOLATION: &str = "No violation";
const EFFORT_WITHIN: &str = "Effort within the budget";
const SCORE: &str = "Score";
const NOT_PLAYED: &str = "Not played, because the entry is not valid.";

fn beats(baseline: &str) -> String {
    format!("Beats the baseline {}", baseline.strip_suffix(".toml").unwrap_or(baseline))
}

impl Grade {
    fn with_sums(mut self) -> Self {
        // Sums of decimal fractions have a tail that no table of marks has.
        self.points = (self.tests.iter().map(|test| test.points).sum::<f64>() * 100.0).round() / 100.0;
        self.max_points = self.tests.iter().map(|test| test.max_points).sum();
        self
    }
}

/// A run, and the first rule that it violates.
struct GradedRun {
    record: RunRecord,
    violation: Option<String>,
}

impl GradedRun {
    fn effort(&self) -> f64 {
        EFFORT.iter().filter_map(|&column| self.record.number(column)).sum()
    }

    fn crashed_queries(&self) -> u64 {
        CRASHES.iter().filter_map(|&column| self.record.number(column)).sum::<f64>() as u64
    }
}

/// Reads the file of an entry; that of a baseline that is a built-in planner need not exist.
fn read_entry(path: &Path, rules: &GradingRules) -> Result<EntryFile, CourseError> {
    let mut built_in = rules.baselines.iter().filter(|name| !name.ends_with(".toml"));
    match built_in.find(|name| path.as_os_str() == name.as_str()) {
        Some(planner) => EntryFile::from_text(path, &format!("unimog.planner = \"{planner}\"")),
        None => EntryFile::read(path),
    }
}

/// Finds the file of an entry that was submitted as a file or a folder.
fn entry_file(path: &Path) -> Result<PathBuf, CourseError> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let usual = path.join(ENTRY_FILE);
    if usual.is_file() {
        return Ok(usual);
    }
    let found = fs::read_dir(path).into_iter().flatten().flatten().map(|file| file.path());
    let mut found = found.filter(|file| file.extension().is_some_and(|ending| ending == "toml"));
    match (found.next(), found.next()) {
        (Some(file), None) => Ok(file),
        _ => Err(course_fault(&usual, None, "the file does not exist; expected it, or one file that ends in .toml")),
    }
}
