//! Data of the lessons on intervals and on dispatch: runs of the contest, computed when the pages are written.

use std::num::NonZero;
use std::thread;

use serde_json::{Value, json};

use super::short;
use crate::cli::error::CliError;
use wildfire_base::rng;
use wildfire_base::time::SimTime;
use wildfire_batch::stats::{Interval, estimate_mean, t_reach};
use wildfire_scenario::{Scenario, load};
use wildfire_sim::run;
use wildfire_timeline::{AgentId, ChangedBush, Outcome, Role, RunIndex, Timeline};

/// Seeds of the pairs, and the planners that are compared on them.
const PAIR_SEEDS: u64 = 100;
const PLANNERS: [&str; 2] = ["hybrid-astar", "prm-rs"];

/// Policies of dispatch; the first is what the others are compared with.
const POLICIES: [&str; 4] = ["nearest", "nearest-by-drive", "hungarian", "auction"];
/// Seeds of their table, and those that are shown.
const DISPATCH_SEEDS: u64 = 10;
const SHOWN_SEEDS: u64 = 2;
/// Simulated seconds between two positions.
const STEP_S: u32 = 2;
const DISPATCH_S: u32 = 600;

/// Runs all seeds from 1 to `last` of a scenario, on all processors; what becomes of each run is in the order of seeds.
fn run_seeds<T: Send>(
    scenario: &Scenario,
    last: u64,
    use_run: impl Fn(u64, &Timeline) -> T + Sync,
) -> Result<Vec<T>, CliError> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get) as u64;
    let use_run = &use_run;
    let part = move |first| {
        let seeds = (first..=last).step_by(threads as usize);
        seeds.map(|seed| Ok((seed, use_run(seed, &run(scenario, seed)?.timeline)))).collect::<Result<Vec<_>, _>>()
    };
    let parts = thread::scope(|scope| {
        let parts: Vec<_> = (1..=threads).map(|first| scope.spawn(move || part(first))).collect();
        parts.into_iter().map(|part| part.join().expect("a run does not panic")).collect::<Result<Vec<_>, _>>()
    });
    let parts = parts.map_err(|error: wildfire_sim::RunError| CliError::run_failed(error.to_string()))?;
    let mut all: Vec<_> = parts.into_iter().flatten().collect();
    all.sort_by_key(|&(seed, _)| seed);
    Ok(all.into_iter().map(|(_, kept)| kept).collect())
}

/// Differences between two planners on the same seeds, and Student's quantiles for their intervals.
pub fn pairs() -> Result<Value, CliError> {
    let [a, b] = [outcomes_of_planner(PLANNERS[0])?, outcomes_of_planner(PLANNERS[1])?];
    let metrics = [("bushes saved", "bushes", "saved", 2), ("distance driven", "m", "truck_distance_m", 0)];
    let metrics = [0, 1].map(|column| {
        let (name, unit, metric, decimals) = metrics[column];
        let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| short(b[column] - a[column], 1)).collect();
        json!({"name": name, "unit": unit, "differences": differences, "all": mean(&differences, metric, decimals)})
    });
    // By sample size; there is no interval of fewer than two.
    let reach: Vec<f64> = (2..=PAIR_SEEDS).map(|size| short(t_reach((size - 1) as f64), 4)).collect();
    Ok(json!({"planners": PLANNERS, "seeds": PAIR_SEEDS, "metrics": metrics, "reach": reach}))
}

fn outcomes_of_planner(planner: &str) -> Result<Vec<[f64; 2]>, CliError> {
    let scenario = load("contest", &[format!("unimog.planner={planner}")])?;
    run_seeds(&scenario, PAIR_SEEDS, |_, timeline| {
        let outcome = Outcome::new(timeline);
        let driven: f64 =
            outcome.agents.iter().filter(|agent| is_truck(agent.agent)).map(|agent| agent.distance_m).sum();
        [f64::from(outcome.intact + outcome.extinguished), driven]
    })
}

/// A mean with its 95 % interval, as `wildfire compare` estimates and prints it.
fn mean(values: &[f64], metric: &str, decimals: usize) -> Value {
    let estimate =
        estimate_mean(values, &mut rng::stream(1, &format!("bootstrap/B/{metric}"))).expect("there are values");
    let [low, high] = Interval::ends(estimate.interval);
    let [mean, low, high] = [Some(estimate.mean), low, high].map(|number| mean_text(number, decimals));
    json!({"mean": mean, "low": low, "high": high})
}

fn mean_text(number: Option<f64>, decimals: usize) -> Option<String> {
    number.map(|number| format!("{number:.decimals$}").replace('-', "−"))
}

/// Runs of a fleet under several policies, and what each policy saves.
pub fn dispatch() -> Result<Value, CliError> {
    let mut policies = Vec::new();
    let mut saved_by_nearest = Vec::new();
    for policy in POLICIES {
        let changes = [format!("dispatch.policy={policy}"), format!("duration_s={DISPATCH_S}")];
        let scenario = load("fleet", &changes)?;
        let runs = run_seeds(&scenario, DISPATCH_SEEDS, |seed, timeline| {
            let outcome = Outcome::new(timeline);
            let film = (seed <= SHOWN_SEEDS).then(|| film(timeline));
            (f64::from(outcome.intact + outcome.extinguished), film)
        })?;
        let saved: Vec<f64> = runs.iter().map(|run| run.0).collect();
        // The first policy is compared with itself, so that its difference is 0 in the table.
        if saved_by_nearest.is_empty() {
            saved_by_nearest.clone_from(&saved);
        }
        let differences: Vec<f64> = saved.iter().zip(&saved_by_nearest).map(|(saved, other)| saved - other).collect();
        let films: Vec<Value> = runs.into_iter().filter_map(|run| run.1).collect();
        policies.push(
            json!({"name": policy, "saved": saved, "difference": mean(&differences, "saved", 1), "films": films}),
        );
    }
    Ok(json!({"step": STEP_S, "duration": DISPATCH_S, "seeds": DISPATCH_SEEDS, "policies": policies}))
}

fn is_truck(agent: AgentId) -> bool {
    agent.role == Role::Unimog
}

/// A run to be drawn: bushes, when they change, and where agents are at equal steps, in metres and degrees.
fn film(timeline: &Timeline) -> Value {
    let frame = timeline.setting.frame;
    let bushes: Vec<[u16; 2]> = timeline.setting.bushes.iter().map(|bush| [bush.col, bush.row]).collect();
    let changes: Vec<Value> = timeline
        .events
        .iter()
        .filter_map(|event| {
            let ChangedBush { cell, state } = event.bush_change()?;
            let state = state.kind() as usize;
            // Not rounded down, so that nothing has changed at a step that is before the event.
            let seconds = (event.time.as_seconds() * 10.0).ceil() / 10.0;
            Some(json!([seconds, timeline.setting.bush_index(cell)?, state]))
        })
        .collect();
    let index = RunIndex::new(timeline);
    let agents = timeline.setting.agents.iter().enumerate().map(|(agent, start)| {
        let seconds = (0..=DISPATCH_S).step_by(STEP_S as usize);
        let states = seconds.map(|second| {
            let state = index.agent_at(agent, SimTime::from_seconds(f64::from(second)));
            let goal = state.goal.map_or(-1, |goal| i64::from(goal.row) * i64::from(frame.cols) + i64::from(goal.col));
            let degrees = state.pose.heading.to_degrees().round();
            json!([short(state.pose.x, 1), short(state.pose.y, 1), degrees, goal])
        });
        json!({"truck": is_truck(start.id), "states": states.collect::<Vec<_>>()})
    });
    json!({
        "cols": frame.cols,
        "rows": frame.rows,
        "cell": frame.cell_m,
        "bushes": bushes,
        "changes": changes,
        "agents": agents.collect::<Vec<_>>(),
    })
}
