//! Runs of a track, made in memory, several at once.

use std::time::Duration;

use rayon::prelude::*;

use super::row::{hash_of_query, hash_of_run};
use super::{ArenaError, ArenaRow, Track, TrackKind};
use crate::drives::{AttemptError, AttemptSettings, DriveProblems, attempts};
use crate::execute::{BatchError, RunResult, RunRow, Status, panics};
use crate::plan::{BatchPlan, PlannedRun};
use crate::report::Failures;
use crate::table::{RunRecord, run_column};
use wildfire_audit::{SampleStep, audit_timeline};
use wildfire_planning::Planners;
use wildfire_scenario::Scenario;
use wildfire_sim::{CustomRegistry, RunError, RunOptions};
use wildfire_timeline::Outcome;

/// Who plays, and on how many threads.
#[derive(Clone, Copy)]
pub struct Players<'a> {
    pub registry: &'a CustomRegistry,
    /// The planners that a scenario names, programs and modules among them, or why there are none.
    pub planners_of: &'a (dyn Fn(&Scenario) -> Result<Planners, String> + Sync),
    pub jobs: usize,
}

/// A run that was made.
#[derive(Clone, Debug)]
pub struct Played {
    pub row: ArenaRow,
    /// The first rule that the independent audit found broken.
    pub violation: Option<String>,
    /// Why it failed, or what planners and policies said about failed queries.
    pub message: String,
    /// Failed queries of the trucks' planners.
    pub failed_queries: Failures,
    /// Failed queries of policies.
    pub failed_policy_queries: Failures,
    /// True if a planner or policy could not be started or built.
    pub is_not_started: bool,
}

/// Makes the runs with these numbers, counted from 1; `on_run` is called after each, in any order.
///
/// # Errors
/// If threads cannot be started, or a track's field has no goal. A run that fails is a row without a score.
pub fn play(
    track: &Track,
    plan: &BatchPlan,
    numbers: &[u64],
    players: &Players<'_>,
    on_run: impl Fn() + Sync,
) -> Result<Vec<Played>, ArenaError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(players.jobs).build();
    let pool = pool.map_err(|error| BatchError::NoWorkers { jobs: players.jobs, reason: error.to_string() })?;
    let options = RunOptions { memory: plan.memory, ..players.registry.clone().into() };
    pool.install(|| {
        // Each run is a job by itself: in chunks, a thread that is done would wait for the last chunk of another.
        let played = numbers.par_iter().with_max_len(1).map(|&number| {
            let run = plan.run(number);
            let played = match track.kind {
                TrackKind::Run => Ok(simulated(track, &run, &options)),
                TrackKind::Drive => driven(&run, plan, players),
            };
            on_run();
            played
        });
        played.collect()
    })
}

fn row_of(run: &PlannedRun<'_>, score: Option<f64>, effort: u64, hash: String) -> ArenaRow {
    let [entry, condition] =
        [0, 1].map(|place| run.variant.swept.get(place).map_or(String::new(), ToString::to_string));
    ArenaRow { entry, condition, seed: run.seed, score, effort, hash }
}

/// A run that was made and audited.
pub(crate) struct AuditedRun {
    pub row: RunRow,
    /// The first rule that the independent audit found broken.
    pub violation: Option<String>,
    /// True if a planner or policy could not be started or built.
    pub is_not_started: bool,
}

/// Makes a run and audits it; whatever goes wrong, it is a row.
pub(crate) fn audited_run(run: &PlannedRun<'_>, options: &RunOptions) -> AuditedRun {
    let made = panics::catch(|| wildfire_sim::run_with_options(&run.variant.scenario, run.seed, options));
    let is_not_started =
        matches!(&made, Ok(Err(RunError::NoPolicy { .. } | RunError::NoPrograms { .. } | RunError::NoPlanner { .. })));
    // No times are measured: rows must be the same on every machine.
    let not_done = |status, message| (RunRow::not_done(run.label(), status, message, Duration::ZERO), None);
    let (row, violation) = match made {
        Ok(Ok(done)) => {
            let violation =
                audit_timeline(&done.timeline, SampleStep::default()).violation.map(|found| found.to_string());
            let result = RunResult { asks: done.asks, ..RunResult::new(Outcome::new(&done.timeline), done.cost) };
            let message = done.messages.to_string();
            (RunRow { message, ..RunRow::done(run.label(), result, Duration::ZERO) }, violation)
        }
        Ok(Err(error)) => not_done(Status::Failed, error.to_string()),
        Err(panic) => not_done(Status::Panicked, panic),
    };
    AuditedRun { row, violation, is_not_started }
}

fn simulated(track: &Track, run: &PlannedRun<'_>, options: &RunOptions) -> Played {
    let AuditedRun { row, violation, is_not_started } = audited_run(run, options);
    let record = RunRecord::from_row(&row);
    // Effort is counted in expansions and not in seconds, as it must be equal when another machine plays the run again.
    let effort = track.effort.iter().map(|column| record.number(run_column(column)).unwrap_or(0.0) as u64).sum();
    let row = ArenaRow { ..row_of(run, track.metric().number(&record), effort, hash_of_run(&record)) };
    Played {
        row,
        violation,
        message: record.message().to_owned(),
        failed_queries: Failures::of_queries(&record),
        failed_policy_queries: Failures::of_asks(&record),
        is_not_started,
    }
}

/// A query's score is the share of its path that is needed, 0 if there is none: the lower bound of the length over the length.
/// So the mean over queries is success weighted by path length (Anderson et al., "On evaluation of embodied navigation
/// agents", 2018), with a bound in the place of the shortest length, which nobody knows.
fn driven(run: &PlannedRun<'_>, plan: &BatchPlan, players: &Players<'_>) -> Result<Played, ArenaError> {
    let scenario = &run.variant.scenario;
    // Each seed has one goal: a row of a board is one query, and its seeds are the independent sample.
    let problems = DriveProblems { goals: Some(1), ..DriveProblems::default() }.load(scenario, run.seed)?;
    let problem = &problems[0];
    // A query is of one vehicle, so only the first truck's planner enters.
    let planners: Vec<_> = scenario.unimog.iter().take(1).map(|truck| truck.planner.clone()).collect();
    // A custom planner may panic; its entry then has a failed run.
    let result = panics::catch(|| {
        let makers = (players.planners_of)(scenario).map_err(|message| (message, true))?;
        let question = AttemptSettings {
            planners: &planners,
            makers: &makers,
            programs: &scenario.planner,
            seed: run.seed,
            limit: plan.memory,
        };
        let answers = attempts(problem, &question);
        answers.map(|answers| answers[0].query(None, 0)).map_err(|error| {
            let is_not_started = matches!(error, AttemptError::NoPlanner { .. });
            (error.to_string(), is_not_started)
        })
    });
    let result = result.map_err(|panic| (panic, false)).flatten();
    Ok(match result {
        Ok(query) => {
            // A query without an answer scores 0; only a query that could not be posed has no score.
            // A path may be as long as the bound, and rounding may make it shorter.
            let solved =
                query.solved().map(|figures| figures.lower_bound_ratio.map_or(1.0, |ratio| 1.0 / ratio.max(1.0)));
            let effort = query.cost.map_or(0, |cost| cost.expansions);
            let row = row_of(run, Some(solved.unwrap_or(0.0)), effort, hash_of_query(&query));
            let reason = query.failure.map(|failure| failure.to_string());
            let failed_queries = Failures::of_query(reason, query.message.as_deref());
            let message = query.message.map_or(String::new(), String::from);
            let violation = query.violation.map(String::from);
            let failed_policy_queries = Failures::default();
            Played { row, violation, message, failed_queries, failed_policy_queries, is_not_started: false }
        }
        Err((message, is_not_started)) => {
            let row = row_of(run, None, 0, super::row::shown_hash("failed\n"));
            let failed_queries = Failures::default();
            let failed_policy_queries = Failures::default();
            Played { row, violation: None, message, failed_queries, failed_policy_queries, is_not_started }
        }
    })
}
