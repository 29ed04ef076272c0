//! The columns of `runs.csv` and `agents.csv`, and the same names and values for other forms of output.
//!
//! Outcome columns come first. They are equal bit for bit whenever a seed is run again; every column that may differ
//! begins with `cpu_` or `wall_`, and stands after them. A number is written with the fewest digits that read back as
//! the same f64; a value that does not exist is an empty field.

use crate::batch::execute::{CpuSplit, RunRow};
use crate::batch::plan::{RunLabel, Value};
use crate::sim::AgentCost;
use crate::timeline::{AgentOutcome, Outcome, Winner};

/// A name and how to get its value.
#[derive(Clone, Copy, Debug)]
pub struct Column<F> {
    pub name: &'static str,
    pub value: F,
}

/// A column of `runs.csv`.
pub type RunColumn = Column<fn(&RunRow) -> Value>;

/// A column of `agents.csv`.
pub type AgentColumn = Column<fn(&AgentRow<'_>) -> Value>;

/// One agent of a run that is done.
#[derive(Clone, Copy, Debug)]
pub struct AgentRow<'a> {
    pub label: &'a RunLabel,
    pub outcome: &'a AgentOutcome,
    pub cost: Option<&'a AgentCost>,
}

impl<'a> AgentRow<'a> {
    /// The agents of a run, in the order of its timeline; none of a run that is not done.
    pub fn all_of(row: &'a RunRow) -> impl Iterator<Item = Self> {
        row.result.iter().flat_map(move |result| {
            result.outcome.agents.iter().map(move |outcome| Self {
                label: &row.label,
                outcome,
                cost: result.cost.agents.iter().find(|cost| cost.agent == outcome.agent),
            })
        })
    }
}

/// Whether values of this column may differ between two runs of one seed.
pub fn is_measured(name: &str) -> bool {
    name.starts_with("cpu_") || name.starts_with("wall_")
}

/// Without trucks there is no planner, and a run that is done has no message.
fn unless_empty(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

fn outcome<T: Into<Value>>(row: &RunRow, value: impl Fn(&Outcome) -> T) -> Value {
    row.result.as_ref().map(|result| value(&result.outcome)).into()
}

fn trucks(row: &RunRow, value: impl Fn(&AgentOutcome) -> f64) -> Value {
    row.result.as_ref().map(|result| result.trucks().map(value).sum::<f64>()).into()
}

fn trucks_count(row: &RunRow, value: impl Fn(&AgentOutcome) -> u64) -> Value {
    row.result.as_ref().map(|result| result.trucks().map(value).sum::<u64>()).into()
}

fn trucks_longest(row: &RunRow, value: impl Fn(&AgentOutcome) -> f64) -> Value {
    row.result.as_ref().map(|result| result.trucks().map(value).fold(0.0, f64::max)).into()
}

fn wumpuses(row: &RunRow, value: impl Fn(&AgentOutcome) -> f64) -> Value {
    row.result.as_ref().map(|result| result.wumpuses().map(value).sum::<f64>()).into()
}

fn wumpuses_count(row: &RunRow, value: impl Fn(&AgentOutcome) -> u64) -> Value {
    row.result.as_ref().map(|result| result.wumpuses().map(value).sum::<u64>()).into()
}

fn wumpuses_longest(row: &RunRow, value: impl Fn(&AgentOutcome) -> f64) -> Value {
    row.result.as_ref().map(|result| result.wumpuses().map(value).fold(0.0, f64::max)).into()
}

fn cpu(row: &RunRow, value: impl Fn(&CpuSplit) -> f64) -> Value {
    row.result.as_ref().map(|result| value(&result.cpu)).into()
}

fn winner(outcome: &Outcome) -> String {
    match outcome.winner() {
        Winner::Wumpus => "wumpus",
        Winner::Unimog => "unimog",
        Winner::Tie => "tie",
    }
    .into()
}

macro_rules! columns {
    ($row:ident; $($name:ident = $value:expr),+ $(,)?) => {
        &[$(Column { name: stringify!($name), value: |$row| $value.into() }),+]
    };
}

/// How many columns of [`RUN_COLUMNS`] stand before those of what a batch sweeps.
pub const COLUMNS_BEFORE_SWEPT: usize = 4;

/// The columns of `runs.csv`, in their order, but for those of what a batch sweeps.
pub const RUN_COLUMNS: &[RunColumn] = columns! { row;
    scenario = row.label.scenario.clone(),
    seed = row.label.seed,
    run = row.label.run,
    planner = unless_empty(&row.label.planner),
    status = row.status.to_string(),
    message = unless_empty(&row.message),
    obstacles = outcome(row, |o| o.obstacles),
    intact = outcome(row, |o| o.intact),
    burning = outcome(row, |o| o.burning),
    burned_out = outcome(row, |o| o.burned_out),
    extinguished = outcome(row, |o| o.extinguished),
    intact_ratio = outcome(row, Outcome::intact_ratio),
    burned_ratio = outcome(row, Outcome::burned_ratio),
    extinguished_ratio = outcome(row, Outcome::extinguished_ratio),
    lit_by_wumpus = outcome(row, |o| o.lit_by_wumpus),
    caught_by_spread = outcome(row, |o| o.caught_by_spread),
    truck_stuck_s = outcome(row, |o| o.truck_stuck_s),
    wumpus_stuck_s = outcome(row, |o| o.wumpus_stuck_s),
    lit_by_schedule = outcome(row, |o| o.lit_by_schedule),
    ended_s = outcome(row, |o| o.ended_s),
    burning_cell_s = outcome(row, |o| o.burning_cell_s),
    peak_burning = outcome(row, |o| o.peak_burning),
    mean_response_s = outcome(row, |o| o.mean_response_s),
    first_fire_s = outcome(row, |o| o.first_fire_s),
    all_out_s = outcome(row, |o| o.all_out_s),
    wumpus_score = outcome(row, |o| o.wumpus_score),
    truck_score = outcome(row, |o| o.truck_score),
    winner = outcome(row, winner),
    truck_plans = trucks_count(row, |a| a.plans.into()),
    truck_failed_start_blocked = trucks_count(row, |a| a.failures[0].into()),
    truck_failed_goal_blocked = trucks_count(row, |a| a.failures[1].into()),
    truck_failed_disconnected = trucks_count(row, |a| a.failures[2].into()),
    truck_failed_budget_spent = trucks_count(row, |a| a.failures[3].into()),
    truck_lattice_plans = trucks_count(row, |a| a.lattice_plans.into()),
    truck_roadmap_samples = trucks_count(row, |a| a.roadmap_samples.into()),
    truck_roadmap_edges = trucks_count(row, |a| a.roadmap_edges.into()),
    truck_roadmap_components = trucks_count(row, |a| a.roadmap_components.into()),
    truck_roadmap_expansions = trucks_count(row, |a| a.roadmap_expansions),
    truck_local_expansions = trucks_count(row, |a| a.local_expansions),
    truck_distance_m = trucks(row, |a| a.distance_m),
    truck_driving_s = trucks(row, |a| a.driving_s),
    truck_planning_s = trucks(row, |a| a.planning_s),
    truck_suppressing_s = trucks(row, |a| a.suppressing_s),
    truck_standing_s = trucks(row, |a| a.standing_s),
    truck_longest_idle_s = trucks_longest(row, |a| a.longest_idle_s),
    truck_cusps = trucks_count(row, |a| a.cusps.into()),
    truck_wasted_drives = trucks_count(row, |a| a.wasted_drives.into()),
    truck_waiting_s = trucks(row, |a| a.waiting_s),
    truck_deadlocks = trucks_count(row, |a| a.deadlocks.into()),
    wumpus_plans = wumpuses_count(row, |a| a.plans.into()),
    wumpus_failed_plans = wumpuses_count(row, |a| a.failures.iter().copied().map(u64::from).sum()),
    wumpus_local_minima = wumpuses_count(row, |a| a.local_minima.into()),
    wumpus_expansions = wumpuses_count(row, |a| a.roadmap_expansions + a.local_expansions),
    wumpus_distance_m = wumpuses(row, |a| a.distance_m),
    wumpus_walking_s = wumpuses(row, |a| a.driving_s),
    wumpus_planning_s = wumpuses(row, |a| a.planning_s),
    wumpus_standing_s = wumpuses(row, |a| a.standing_s),
    wumpus_longest_idle_s = wumpuses_longest(row, |a| a.longest_idle_s),
    cpu_sampling_s = cpu(row, |c| c.sampling_s),
    cpu_map_generation_s = cpu(row, |c| c.map_generation_s),
    cpu_roadmap_search_s = cpu(row, |c| c.roadmap_search_s),
    cpu_local_search_s = cpu(row, |c| c.local_search_s),
    cpu_prm_total_s = cpu(row, CpuSplit::prm_total_s),
    cpu_unimog_total_s = cpu(row, CpuSplit::unimog_total_s),
    cpu_wumpus_s = cpu(row, |c| c.wumpus_s),
    cpu_clearance_field_s = cpu(row, |c| c.clearance_field_s),
    cpu_reachability_s = cpu(row, |c| c.reachability_s),
    cpu_terrain_s = cpu(row, |c| c.terrain_s),
    cpu_run_s = cpu(row, |c| c.run_s),
    wall_run_s = row.wall.as_secs_f64(),
};

/// The columns of `agents.csv`, in their order.
pub const AGENT_COLUMNS: &[AgentColumn] = columns! { row;
    scenario = row.label.scenario.clone(),
    seed = row.label.seed,
    run = row.label.run,
    agent = row.outcome.agent.to_string(),
    cells = row.outcome.cells,
    plans = row.outcome.plans,
    failed_start_blocked = row.outcome.failures[0],
    failed_goal_blocked = row.outcome.failures[1],
    failed_disconnected = row.outcome.failures[2],
    failed_budget_spent = row.outcome.failures[3],
    failed_local_minimum = row.outcome.failures[4],
    lattice_plans = row.outcome.lattice_plans,
    local_minima = row.outcome.local_minima,
    roadmap_samples = row.outcome.roadmap_samples,
    roadmap_edges = row.outcome.roadmap_edges,
    roadmap_components = row.outcome.roadmap_components,
    roadmap_expansions = row.outcome.roadmap_expansions,
    local_expansions = row.outcome.local_expansions,
    distance_m = row.outcome.distance_m,
    driving_s = row.outcome.driving_s,
    planning_s = row.outcome.planning_s,
    suppressing_s = row.outcome.suppressing_s,
    standing_s = row.outcome.standing_s,
    stuck_s = row.outcome.stuck_s,
    longest_idle_s = row.outcome.longest_idle_s,
    cusps = row.outcome.cusps,
    wasted_drives = row.outcome.wasted_drives,
    waiting_s = row.outcome.waiting_s,
    deadlocks = row.outcome.deadlocks,
    cpu_sampling_s = row.cost.map(|cost| cost.sampling.as_secs_f64()),
    cpu_map_generation_s = row.cost.map(|cost| cost.connecting.as_secs_f64()),
    cpu_roadmap_search_s = row.cost.map(|cost| cost.roadmap_search.as_secs_f64()),
    cpu_local_search_s = row.cost.map(|cost| cost.local_search.as_secs_f64()),
    cpu_reachability_s = row.cost.map(|cost| cost.reachability.as_secs_f64()),
};
