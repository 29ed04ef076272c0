//! The columns of all tables of a batch. A line here is all that a column needs: its name, `optional` if a row may have
//! no value, its kind and unit, what it means, and how it is found. Columns of numbers of `runs.csv` have a `title` in
//! charts; some say which side is `better`, how a difference is put in a `phrase`, and what the best in them did, which is
//! the `aim` of a report. CSV and Parquet files, the data dictionary, the metrics of comparisons and the charts of reports
//! have all this from here.
//!
//! Outcome columns come first. They are equal bit for bit whenever a seed is run again; every column that may differ
//! begins with `cpu_` or `wall_`, and is after them. A number is written with the fewest digits that read back as the
//! same f64; a value that does not exist is an empty field.

use crate::execute::{CpuSplit, PlannerCall, RunResult, RunRow, StateCount};
use crate::plan::{RunLabel, Value};
use crate::table::column::Better::{Higher, Lower};
use crate::table::column::{Column, Kind, Unit};
use wildfire_base::query::PlanFailure;
use wildfire_sim::{AgentCost, PolicyTally, RunCost};
use wildfire_timeline::{AgentOutcome, GroundOutcome, Outcome, Winner};

/// A column of `runs.csv`.
pub type RunColumn = Column<fn(&RunRow) -> Value>;

/// A column of `agents.csv`.
pub type AgentColumn = Column<fn(&AgentRow<'_>) -> Value>;

/// A column of `planner_calls.parquet`, after those of the run.
pub type CallColumn = Column<fn(&PlannerCall) -> Value>;

/// A column of `states.parquet`, after those of the run.
pub type StateColumn = Column<fn(&StateCount) -> Value>;

/// An agent of a finished run.
#[derive(Clone, Copy, Debug)]
pub struct AgentRow<'a> {
    pub label: &'a RunLabel,
    pub outcome: &'a AgentOutcome,
    pub cost: Option<&'a AgentCost>,
}

impl<'a> AgentRow<'a> {
    fn policy(&self) -> Option<&'a str> {
        let policy = self.label.policies.iter().find(|(agent, _)| *agent == self.outcome.agent);
        policy.map(|(_, name)| name.as_str())
    }

    /// Returns the agents of a run, in the order of its timeline; none for a run that is not done.
    pub fn from_run(row: &'a RunRow) -> impl Iterator<Item = Self> {
        row.result.iter().flat_map(move |result| {
            result.outcome.agents.iter().map(move |outcome| Self {
                label: &row.label,
                outcome,
                cost: result.cost.agents.iter().find(|cost| cost.agent == outcome.agent),
            })
        })
    }
}

/// Returns whether values of this column may differ between two runs of one seed.
pub fn is_measured(name: &str) -> bool {
    name.starts_with("cpu_") || name.starts_with("wall_")
}

/// Without trucks there is no planner, and most runs that are done have no message.
fn unless_empty(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

fn outcome<T: Into<Value>>(row: &RunRow, value: impl Fn(&Outcome) -> T) -> Value {
    row.result.as_ref().map(|result| value(&result.outcome)).into()
}

/// A value of the ground; none of a run in which only bushes burn.
fn ground<T: Into<Value>>(row: &RunRow, value: impl Fn(&GroundOutcome) -> T) -> Value {
    row.result.as_ref().and_then(|result| result.outcome.ground.as_ref()).map(value).into()
}

fn trucks(row: &RunRow, value: impl Fn(&AgentOutcome) -> f64) -> Value {
    row.result.as_ref().map(|result| result.trucks().map(value).sum::<f64>()).into()
}

fn trucks_count(row: &RunRow, value: impl Fn(&AgentOutcome) -> u64) -> Value {
    row.result.as_ref().map(|result| result.trucks().map(value).sum::<u64>()).into()
}

fn failed(row: &RunRow, reason: PlanFailure) -> Value {
    trucks_count(row, |truck| truck.failures[reason].into())
}

fn trucks_longest(row: &RunRow, value: impl Fn(&AgentOutcome) -> f64) -> Value {
    row.result.as_ref().map(|result| result.trucks().map(value).fold(0.0, f64::max)).into()
}

fn flock_ratio(result: &RunResult) -> Option<f64> {
    let (flocked, goals) =
        result.trucks().fold((0, 0), |(flocked, goals), truck| (flocked + truck.flocked_goals, goals + truck.goals));
    (goals > 0).then(|| f64::from(flocked) / f64::from(goals))
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

/// A count of the asks of policies that are not built in; none where all are built in.
fn asks(row: &RunRow, value: impl Fn(&PolicyTally) -> u64) -> Value {
    row.result.as_ref().and_then(|result| result.asks.as_ref()).map(value).into()
}

fn cpu_source(cost: &RunCost) -> Option<String> {
    let min_trusted = cost.agents.iter().filter_map(|agent| agent.source).max();
    min_trusted.map(|source| source.name().to_owned())
}

fn winner(outcome: &Outcome) -> String {
    match outcome.winner() {
        Winner::Wumpus => "wumpus",
        Winner::Unimog => "unimog",
        Winner::Tie => "tie",
    }
    .into()
}

/// Reads lines `name: [optional] Kind Unit "description" = value, what else there is to say of it;`.
macro_rules! columns {
    ($Column:ty, $row:ident;
     $($name:ident: $($about:ident)+ $description:literal = $value:expr $(, $extra:ident($($argument:expr),*))*;)+) => {
        &[$({
            let (is_required, kind, unit) = about!($($about)+);
            let name = stringify!($name);
            let column: $Column = Column {
                name, description: $description, unit, kind, is_required, title: "", better: None, phrase: None, aim: None,
                value: |$row| $value.into(),
            };
            column$(.$extra($($argument),*))*
        }),+]
    };
}

macro_rules! about {
    (optional $kind:ident $unit:ident) => {
        (false, Kind::$kind, Unit::$unit)
    };
    ($kind:ident $unit:ident) => {
        (true, Kind::$kind, Unit::$unit)
    };
}

pub(crate) use {about, columns};

/// The number of columns of [`RUN_COLUMNS`] that precede those of swept keys.
pub const COLUMNS_BEFORE_SWEPT: usize = 5;

/// The columns of `runs.csv` in order, without those of swept keys.
#[rustfmt::skip]
pub const RUN_COLUMNS: &[RunColumn] = columns! { RunColumn, row;
    scenario: Text None "name of the scenario" = row.label.scenario.clone();
    seed: Count None "seed of all randomness in the run" = row.label.seed;
    run: Count None "number of the run in the plan, from 1" = row.label.run;
    planner: optional Text None "planner of the trucks, separated by `;` if trucks differ"
        = unless_empty(&row.label.planner);
    policy: optional Text None "policy that chooses where the trucks go, separated by `;` if trucks differ"
        = unless_empty(&row.label.policy());
    status: Text None "done, failed or panicked" = row.status.to_string();
    message: optional Text None "why a run is not done, or its planners' and policies' messages about failures"
        = unless_empty(&row.message);
    obstacles: optional Count Cells "bush cells of the field" = outcome(row, |o| o.obstacles), title("Bush cells");
    intact: optional Count Cells "bush cells that never burned" = outcome(row, |o| o.intact),
        title("Intact"), better(Higher);
    burning: optional Count Cells "bush cells still burning at the end" = outcome(row, |o| o.burning), title("Burning"),
        better(Lower);
    burned_out: optional Count Cells "bush cells that burned out" = outcome(row, |o| o.burned_out), title("Burned out"),
        better(Lower);
    extinguished: optional Count Cells "bush cells extinguished by trucks" = outcome(row, |o| o.extinguished),
        title("Extinguished"), better(Higher),
        phrase("$ extinguishes", "more bushes per run", "fewer bushes per run");
    intact_ratio: optional Real Share "share of all bush cells" = outcome(row, Outcome::intact_ratio),
        title("Share intact"), better(Higher);
    burned_ratio: optional Real Share "share of all bush cells that burn or have burned out"
        = outcome(row, Outcome::burned_ratio), title("Share burned"), better(Lower);
    extinguished_ratio: optional Real Share "share of all bush cells" = outcome(row, Outcome::extinguished_ratio),
        title("Share extinguished"), better(Higher);
    lit_by_wumpus: optional Count Cells "ignitions of bushes by Wumpuses; a bush lit again counts again"
        = outcome(row, |o| o.lit_by_wumpus), title("Lit by Wumpuses");
    caught_by_spread: optional Count Cells "ignitions of bushes by spread" = outcome(row, |o| o.caught_by_spread),
        title("Caught by spread"), better(Lower);
    truck_stuck_s: optional Real Seconds
        "time in which trucks did nothing although they could reach a fire"
        = outcome(row, |o| o.truck_stuck_s), title("Truck stuck time"), better(Lower);
    wumpus_stuck_s: optional Real Seconds
        "time in which Wumpuses did nothing although they could light something"
        = outcome(row, |o| o.wumpus_stuck_s), title("Wumpus stuck time");
    lit_by_schedule: optional Count Cells "ignitions of bushes by the scenario" = outcome(row, |o| o.lit_by_schedule),
        title("Lit by the scenario");
    ended_s: optional Real Seconds "simulated time at the end" = outcome(row, |o| o.ended_s), title("End of the run"),
        phrase("with $ runs end", "s later", "s sooner");
    burning_cell_s: optional Real CellSeconds "number of burning bush cells integrated over time"
        = outcome(row, |o| o.burning_cell_s), title("Burning cells over time"), better(Lower),
        phrase("$ has", "more cell-seconds of fire per run", "fewer cell-seconds of fire per run");
    peak_burning: optional Count Cells "largest number of bush cells burning at once"
        = outcome(row, |o| o.peak_burning), title("Most bushes burning at once"), better(Lower),
        phrase("with $", "more bushes burn at the peak", "fewer bushes burn at the peak");
    mean_response_s: optional Real Seconds "mean time from ignition to extinction, over extinguished bushes"
        = outcome(row, |o| o.mean_response_s), title("Time from ignition to extinction"), better(Lower),
        phrase("$ puts a fire out", "s later", "s sooner"),
        aim("put fires out fastest", ["put fires out after", ""], "s sooner");
    first_fire_s: optional Real Seconds "time of the first ignition of a bush" = outcome(row, |o| o.first_fire_s),
        title("First fire");
    all_out_s: optional Real Seconds "end of the last bush fire, if no bush burned at the end"
        = outcome(row, |o| o.all_out_s), title("End of the last fire");
    wumpus_score: optional Real Points "score of the Wumpuses by the scenario's rules"
        = outcome(row, |o| o.wumpus_score), title("Points of the Wumpuses"), better(Lower);
    truck_score: optional Real Points "score of the trucks by the scenario's rules" = outcome(row, |o| o.truck_score),
        title("Points of the trucks"), better(Higher);
    winner: optional Text None "wumpus, unimog or tie" = outcome(row, winner);
    least_burned: optional Count Cells "lower bound on the bush cells that burn whatever the trucks do"
        = outcome(row, |o| o.least_burned), title("Lower bound on burned bushes");
    truck_plans: optional Count None "planner queries of trucks, including failed queries"
        = trucks_count(row, |a| a.plans.into()), title("Truck queries");
    truck_failed_start_blocked: optional Count None "failed queries: the truck's own pose is not free"
        = failed(row, PlanFailure::StartBlocked), title("Failed queries: start blocked"), better(Lower);
    truck_failed_goal_blocked: optional Count None "failed queries: no free place within reach of the goal"
        = failed(row, PlanFailure::GoalBlocked), title("Failed queries: goal blocked"), better(Lower);
    truck_failed_disconnected: optional Count None "failed queries: start and goal are not connected"
        = failed(row, PlanFailure::Disconnected), title("Failed queries: not connected"), better(Lower);
    truck_failed_budget_spent: optional Count None "failed queries: the budget of expansions ran out"
        = failed(row, PlanFailure::BudgetSpent), title("Failed queries: budget spent"), better(Lower);
    truck_failed_timed_out: optional Count None "failed queries: a custom planner did not answer in time"
        = failed(row, PlanFailure::TimedOut), title("Failed queries: timed out"), better(Lower);
    truck_failed_crashed: optional Count None "failed queries: a custom planner ended or failed"
        = failed(row, PlanFailure::Crashed), title("Failed queries: crashed"), better(Lower);
    truck_failed_bad_answer: optional Count None "failed queries: an answer that is not a valid path"
        = failed(row, PlanFailure::BadAnswer), title("Failed queries: bad answer"), better(Lower);
    truck_lattice_plans: optional Count None "plans found by the reachability flood after the planner had failed"
        = trucks_count(row, |a| a.lattice_plans.into()), title("Plans found by the flood"), better(Lower);
    truck_roadmap_samples: optional Count None "milestones of the roadmaps"
        = trucks_count(row, |a| a.roadmap_samples.into()), title("Milestones of the roadmaps");
    truck_roadmap_edges: optional Count None "edges of the roadmaps" = trucks_count(row, |a| a.roadmap_edges.into()),
        title("Edges of the roadmaps");
    truck_roadmap_components: optional Count None
        "connected components of the roadmaps; 0 if not counted, as with planners that join them on demand"
        = trucks_count(row, |a| a.roadmap_components.into()), title("Components of the roadmaps");
    truck_roadmap_expansions: optional Count None "nodes expanded in the roadmaps"
        = trucks_count(row, |a| a.roadmap_expansions), title("Nodes expanded in roadmaps"), better(Lower);
    truck_local_expansions: optional Count None "nodes expanded in local searches"
        = trucks_count(row, |a| a.local_expansions), title("Nodes expanded in local searches"), better(Lower);
    truck_distance_m: optional Real Metres "distance driven" = trucks(row, |a| a.distance_m),
        title("Distance driven by trucks"), better(Lower), phrase("with $ trucks drive", "m more", "m less");
    truck_driving_s: optional Real Seconds "time spent driving" = trucks(row, |a| a.driving_s),
        title("Truck driving time"), phrase("with $ trucks drive", "s longer", "s less");
    truck_planning_s: optional Real Seconds "simulated planning time charged by the scenario"
        = trucks(row, |a| a.planning_s), title("Truck planning time"), better(Lower);
    truck_suppressing_s: optional Real Seconds "time spent extinguishing fires" = trucks(row, |a| a.suppressing_s),
        title("Truck extinguishing time");
    truck_standing_s: optional Real Seconds "time spent neither driving, planning nor extinguishing"
        = trucks(row, |a| a.standing_s), title("Truck standing time"), better(Lower);
    truck_longest_idle_s: optional Real Seconds "longest time that a truck stood while something burned"
        = trucks_longest(row, |a| a.longest_idle_s), title("Longest truck standstill"), better(Lower);
    truck_cusps: optional Count None "changes between forward and reverse" = trucks_count(row, |a| a.cusps.into()),
        title("Changes of driving direction"), better(Lower), phrase("with $ trucks reverse", "times more", "times less");
    truck_wasted_drives: optional Count None "drives that ended without an extinction"
        = trucks_count(row, |a| a.wasted_drives.into()), title("Wasted drives"), better(Lower);
    truck_waiting_s: optional Real Seconds "time spent waiting for other trucks" = trucks(row, |a| a.waiting_s),
        title("Truck waiting time"), better(Lower), phrase("with $ trucks wait", "s longer", "s less");
    truck_deadlocks: optional Count None "deadlocks of trucks that were resolved"
        = trucks_count(row, |a| a.deadlocks.into()), title("Truck deadlocks"), better(Lower);
    wumpus_plans: optional Count None "planner queries of Wumpuses, including failed queries"
        = wumpuses_count(row, |a| a.plans.into()), title("Wumpus queries");
    wumpus_failed_plans: optional Count None "failed queries of Wumpuses"
        = wumpuses_count(row, |a| a.failures.sum().into()), title("Failed Wumpus queries");
    wumpus_local_minima: optional Count None "local minima met by descents on a potential field"
        = wumpuses_count(row, |a| a.local_minima.into()), title("Wumpus local minima");
    wumpus_expansions: optional Count None "nodes expanded by Wumpuses"
        = wumpuses_count(row, |a| a.roadmap_expansions + a.local_expansions), title("Nodes expanded by Wumpuses");
    wumpus_distance_m: optional Real Metres "distance walked" = wumpuses(row, |a| a.distance_m),
        title("Distance walked by Wumpuses");
    wumpus_walking_s: optional Real Seconds "time spent walking" = wumpuses(row, |a| a.driving_s),
        title("Wumpus walking time");
    wumpus_planning_s: optional Real Seconds "simulated planning time charged by the scenario"
        = wumpuses(row, |a| a.planning_s), title("Wumpus planning time");
    wumpus_standing_s: optional Real Seconds "time spent standing" = wumpuses(row, |a| a.standing_s),
        title("Wumpus standing time");
    wumpus_longest_idle_s: optional Real Seconds "longest time that a Wumpus stood while it could light something"
        = wumpuses_longest(row, |a| a.longest_idle_s), title("Longest Wumpus standstill");
    ground_cells: optional Count Cells "cells of ground that can burn; this and the next columns only if ground burns"
        = ground(row, |g| g.cells), title("Ground cells");
    ground_burned: optional Count Cells "cells of ground that caught fire" = ground(row, |g| g.burned),
        title("Ground burned");
    ground_extinguished: optional Count Cells "cells of ground extinguished by trucks"
        = ground(row, |g| g.extinguished), title("Ground extinguished");
    ground_peak_burning: optional Count Cells "largest number of ground cells burning at once"
        = ground(row, |g| g.peak_burning), title("Most ground burning at once");
    spotted: optional Count Cells "ignitions by embers, of bushes and of ground" = ground(row, |g| g.spotted),
        title("Ignitions by embers");
    burned_ha: optional Real Hectares "area of all bushes and ground that caught fire" = ground(row, |g| g.burned_ha),
        title("Burned area"), phrase("$ loses", "more hectares per run", "fewer hectares per run"),
        aim("lost the least area", ["lost", " of area"], "ha less");
    reached_edge_s: optional Real Seconds "time at which a border cell, bush or ground, first caught fire, if any"
        = ground(row, |g| g.reached_edge_s), title("Time fire reached the border");
    contained_at_s: optional Real Seconds
        "time of the last ignition, if all fire was out before the end and none reached the border; only without Wumpuses"
        = ground(row, |g| g.contained_at_s), title("Time of containment"), better(Lower),
        phrase("$ contains the fire", "s later", "s sooner");
    contained_ha: optional Real Hectares "burned area of a contained fire"
        = ground(row, |g| g.contained_at_s.map(|_| g.burned_ha)), title("Area of contained fires"), better(Lower);
    escaped: optional Count None "1 if fire was not contained, otherwise 0; only without Wumpuses"
        = ground(row, |g| g.escaped.map(u64::from)), title("Escaped fires"), better(Lower),
        phrase("with $", "more fires escape per run", "fewer fires escape per run");
    line_built_m: optional Real Metres "line that crews built, if there are any"
        = ground(row, |g| g.line.map(|line| line.built_m)), title("Line built");
    line_lost_m: optional Real Metres "the part of it that does not hold"
        = ground(row, |g| g.line.map(|line| line.lost_m)), title("Line lost");
    truck_idle_s: optional Real Seconds
        "time in which trucks had no goal, or their policy made them wait or relocate"
        = trucks(row, |a| a.idle_s), title("Truck idle time");
    truck_relocations: optional Count None "drives of trucks to waiting places or to water"
        = trucks_count(row, |a| a.relocations.into()), title("Truck relocations");
    truck_refills: optional Count None "number of tank refills" = trucks_count(row, |a| a.refills.into()),
        title("Tank refills");
    truck_refilling_s: optional Real Seconds "time spent refilling" = trucks(row, |a| a.refilling_s),
        title("Tank refill time");
    truck_hopeless_drives: optional Count None
        "wasted drives to a fire that would burn out before the truck could extinguish it"
        = trucks_count(row, |a| a.hopeless_drives.into()), title("Hopeless drives");
    truck_goals: optional Count None "plans of trucks to a fire" = trucks_count(row, |a| a.goals.into()),
        title("Truck goals");
    truck_flock_ratio: optional Real Share
        "share of truck goals within 60 m of another truck's goal; none without goals"
        = row.result.as_ref().and_then(flock_ratio), title("Flock ratio");
    policy_asked: optional Count None
        "queries to custom policies; this and the next columns only if there are any"
        = asks(row, |a| a.asked), title("Policy queries");
    policy_failed_timed_out: optional Count None "failed policy queries: no answer in time"
        = asks(row, |a| a.timed_out), title("Failed policy queries: timed out");
    policy_failed_crashed: optional Count None "failed policy queries: the policy ended or failed"
        = asks(row, |a| a.crashed), title("Failed policy queries: crashed");
    policy_failed_bad_answer: optional Count None "failed policy queries: an answer in an unknown format"
        = asks(row, |a| a.bad_answer), title("Failed policy queries: bad answer");
    policy_illegal: optional Count None "policy queries answered with a choice that was not an option; the agent waited"
        = asks(row, |a| a.illegal), title("Policy queries with an illegal answer");
    cpu_sampling_s: optional Real CpuSeconds "CPU time: sampling the roadmaps" = cpu(row, |c| c.sampling_s),
        title("Sampling"), better(Lower);
    cpu_map_generation_s: optional Real CpuSeconds "CPU time: connecting the samples"
        = cpu(row, |c| c.map_generation_s), title("Connecting"), better(Lower);
    cpu_roadmap_search_s: optional Real CpuSeconds "CPU time: queries to the roadmaps"
        = cpu(row, |c| c.roadmap_search_s), title("Roadmap search"), better(Lower);
    cpu_local_search_s: optional Real CpuSeconds "CPU time: local searches of trucks" = cpu(row, |c| c.local_search_s),
        title("Local search"), better(Lower);
    cpu_prm_total_s: optional Real CpuSeconds "CPU time: clearance field, sampling, map generation and roadmap search"
        = cpu(row, CpuSplit::prm_total_s), title("CPU time of the roadmap planner"), better(Lower);
    cpu_unimog_total_s: optional Real CpuSeconds "CPU time: all planning of the trucks"
        = cpu(row, CpuSplit::unimog_total_s), title("CPU time of the trucks' planning"), better(Lower),
        phrase("with $ the planners use", "ms more CPU per run", "ms less CPU per run"), scaled_by(1e3),
        aim("needed the least CPU time for planning", ["planned in", " of CPU time"], "ms less");
    cpu_wumpus_s: optional Real CpuSeconds "CPU time: all planning of the Wumpuses" = cpu(row, |c| c.wumpus_s),
        title("Wumpus"), better(Lower);
    cpu_clearance_field_s: optional Real CpuSeconds "CPU time: distance field for collision checks"
        = cpu(row, |c| c.clearance_field_s), title("Clearance field"), better(Lower);
    cpu_reachability_s: optional Real CpuSeconds "CPU time: reachability floods and the searches in them"
        = cpu(row, |c| c.reachability_s), title("Reachability"), better(Lower);
    cpu_dispatch_s: optional Real CpuSeconds "CPU time: decisions of the policy that dispatches the trucks"
        = cpu(row, |c| c.dispatch_s), title("Dispatch"), better(Lower);
    cpu_custom_start_s: optional Real CpuSeconds
        "CPU time: building the trucks' custom planners, including all starts of their programs"
        = cpu(row, |c| c.custom_start_s), title("Custom planner: start"), better(Lower);
    cpu_custom_queries_s: optional Real CpuSeconds "CPU time: queries to the trucks' custom planners"
        = cpu(row, |c| c.custom_queries_s), title("Custom planner: queries"), better(Lower);
    cpu_policy_s: optional Real CpuSeconds
        "CPU time: custom policies, including all starts of their programs" = cpu(row, |c| c.policy_s),
        title("Custom policies"), better(Lower);
    cpu_terrain_s: optional Real CpuSeconds "CPU time: generating the field" = cpu(row, |c| c.terrain_s),
        title("Field generation"), better(Lower);
    cpu_run_s: optional Real CpuSeconds "CPU time: the whole run" = cpu(row, |c| c.run_s), title("CPU time of the run"),
        better(Lower);
    cpu_source: optional Text None
        "source of CPU times of custom planners: thread, process or reported; the least trusted if several"
        = row.result.as_ref().and_then(|result| cpu_source(&result.cost));
    wall_run_s: Real WallSeconds "real time: the whole run" = row.wall.as_secs_f64(), title("Real time of the run"),
        better(Lower);
};

/// The columns of `agents.csv` in order.
#[rustfmt::skip]
pub const AGENT_COLUMNS: &[AgentColumn] = columns! { AgentColumn, row;
    scenario: Text None "name of the scenario" = row.label.scenario.clone();
    seed: Count None "seed of all randomness in the run" = row.label.seed;
    run: Count None "number of the run in the plan, from 1" = row.label.run;
    agent: Text None "unimog/0, wumpus/0 ..." = row.outcome.agent.to_string();
    policy: optional Text None "policy that chooses the agent's goals" = row.policy().map(str::to_owned);
    cells: Count Cells "bush cells lit by the Wumpus or extinguished by the truck" = row.outcome.cells;
    plans: Count None "planner queries, including failed queries" = row.outcome.plans;
    failed_start_blocked: Count None "failed queries: the agent's own pose is not free" = row.outcome.failures[PlanFailure::StartBlocked];
    failed_goal_blocked: Count None "failed queries: no free place within reach of the goal"
        = row.outcome.failures[PlanFailure::GoalBlocked];
    failed_disconnected: Count None "failed queries: start and goal are not connected" = row.outcome.failures[PlanFailure::Disconnected];
    failed_budget_spent: Count None "failed queries: the budget of expansions ran out" = row.outcome.failures[PlanFailure::BudgetSpent];
    failed_local_minimum: Count None "failed queries: a descent ended in a local minimum" = row.outcome.failures[PlanFailure::LocalMinimum];
    failed_timed_out: Count None "failed queries: a custom planner did not answer in time"
        = row.outcome.failures[PlanFailure::TimedOut];
    failed_crashed: Count None "failed queries: a custom planner ended or failed"
        = row.outcome.failures[PlanFailure::Crashed];
    failed_bad_answer: Count None "failed queries: an answer that is not a valid path"
        = row.outcome.failures[PlanFailure::BadAnswer];
    lattice_plans: Count None "plans found by the reachability flood after the planner had failed"
        = row.outcome.lattice_plans;
    local_minima: Count None "local minima met by descents on a potential field" = row.outcome.local_minima;
    roadmap_samples: Count None "milestones of the roadmap" = row.outcome.roadmap_samples;
    roadmap_edges: Count None "edges of the roadmap" = row.outcome.roadmap_edges;
    roadmap_components: Count None "connected components of the roadmap; 0 if they were not counted"
        = row.outcome.roadmap_components;
    roadmap_expansions: Count None "nodes expanded in the roadmap" = row.outcome.roadmap_expansions;
    local_expansions: Count None "nodes expanded in local searches" = row.outcome.local_expansions;
    distance_m: Real Metres "distance driven or walked" = row.outcome.distance_m;
    driving_s: Real Seconds "time spent driving or walking" = row.outcome.driving_s;
    planning_s: Real Seconds "simulated planning time charged by the scenario" = row.outcome.planning_s;
    suppressing_s: Real Seconds "time spent extinguishing fires" = row.outcome.suppressing_s;
    standing_s: Real Seconds "time spent neither driving, planning nor extinguishing" = row.outcome.standing_s;
    stuck_s: Real Seconds "time in which the agent did nothing although it could reach a target"
        = row.outcome.stuck_s;
    longest_idle_s: Real Seconds "longest time that the agent stood while there was something to do"
        = row.outcome.longest_idle_s;
    cusps: Count None "changes between forward and reverse" = row.outcome.cusps;
    wasted_drives: Count None "drives that ended without an extinction" = row.outcome.wasted_drives;
    waiting_s: Real Seconds "time spent waiting for other trucks" = row.outcome.waiting_s;
    deadlocks: Count None "deadlocks that this agent resolved" = row.outcome.deadlocks;
    idle_s: Real Seconds "time in which a truck had no goal, or its policy made it wait or relocate"
        = row.outcome.idle_s;
    relocations: Count None "drives of a truck to waiting places or to water" = row.outcome.relocations;
    refills: Count None "number of tank refills" = row.outcome.refills;
    refilling_s: Real Seconds "time spent refilling" = row.outcome.refilling_s;
    hopeless_drives: Count None "wasted drives to a fire that would burn out before the truck could extinguish it"
        = row.outcome.hopeless_drives;
    goals: Count None "plans of a truck to a fire" = row.outcome.goals;
    flocked_goals: Count None "goals within 60 m of another truck's goal" = row.outcome.flocked_goals;
    cpu_sampling_s: optional Real CpuSeconds "CPU time: sampling the roadmap"
        = row.cost.map(|cost| cost.sampling.as_secs_f64());
    cpu_map_generation_s: optional Real CpuSeconds "CPU time: connecting the samples"
        = row.cost.map(|cost| cost.connecting.as_secs_f64());
    cpu_roadmap_search_s: optional Real CpuSeconds "CPU time: queries to the roadmap"
        = row.cost.map(|cost| cost.roadmap_search.as_secs_f64());
    cpu_local_search_s: optional Real CpuSeconds "CPU time: local searches"
        = row.cost.map(|cost| cost.local_search.as_secs_f64());
    cpu_reachability_s: optional Real CpuSeconds "CPU time: reachability floods and the searches in them"
        = row.cost.map(|cost| cost.reachability.as_secs_f64());
    cpu_custom_start_s: optional Real CpuSeconds
        "CPU time: building a custom planner, including all starts of its program"
        = row.cost.map(|cost| cost.starting.as_secs_f64());
    cpu_custom_queries_s: optional Real CpuSeconds "CPU time: queries to a custom planner"
        = row.cost.map(|cost| cost.queries.as_secs_f64());
    cpu_source: optional Text None
        "source of CPU times of a custom planner: thread, process or reported; the least trusted if several"
        = row.cost.and_then(|cost| cost.source).map(|source| source.name().to_owned());
};

/// The columns of `planner_calls.parquet` in order, after those of the run.
#[rustfmt::skip]
pub const CALL_COLUMNS: &[CallColumn] = columns! { CallColumn, call;
    agent: Text None "agent that plans: unimog/0, wumpus/0 ..." = call.agent.to_string();
    t_s: Real Seconds "simulated time of the query" = call.time.as_seconds();
    goal_col: Count None "column of the cell that the agent goes for, from the west" = u64::from(call.goal.0);
    goal_row: Count None "row of the cell that the agent goes for, from the south" = u64::from(call.goal.1);
    solved: Flag None "whether a plan was found" = call.answer.is_ok();
    status: Text None "solved, or the reason for the failure"
        = call.answer.err().map_or("solved".to_owned(), |failure| failure.to_string());
    solution_length_m: optional Real Metres "length of the path" = call.answer.ok().map(|plan| plan.length_m);
    solution_segments: optional Count None "number of straight lines and arcs of the path"
        = call.answer.ok().map(|plan| plan.segments);
    cusps: optional Count None "changes between forward and reverse" = call.answer.ok().map(|plan| plan.cusps);
    drive_s: optional Real Seconds "simulated duration of the path, including waits"
        = call.answer.ok().map(|plan| plan.duration_s);
    roadmap_expansions: Count None "nodes expanded in the roadmap" = call.effort.roadmap_expansions;
    local_expansions: Count None "nodes expanded in the local search" = call.effort.local_expansions;
    by_lattice: optional Flag None "whether the reachability flood found the plan after the planner had failed"
        = call.answer.ok().map(|plan| plan.by_lattice());
    found_by: optional Text None
        "what found the plan of a truck: straight, roadmap, search, relaxed, lattice, reachability, backing-out or way-home"
        = call.answer.ok().and_then(|plan| plan.found_by).map(|found_by| found_by.to_string());
    cpu_query_s: optional Real CpuSeconds "CPU time of the query: the agent's planning since its previous query"
        = call.cpu.map(|cpu| cpu.as_secs_f64());
};

/// The columns of `states.parquet` in order, after those of the run.
#[rustfmt::skip]
pub const STATE_COLUMNS: &[StateColumn] = columns! { StateColumn, state;
    t_s: Real Seconds "simulated time, in steps of a sixtieth of the scenario's duration" = state.time.as_seconds();
    intact: Count Cells "cells that never burned" = state.intact;
    burning: Count Cells "cells that are burning" = state.burning;
    burned_out: Count Cells "cells that have burned out" = state.burned_out;
    extinguished: Count Cells "cells that were extinguished and are not burning" = state.extinguished;
};

/// Returns the index of a column of [`RUN_COLUMNS`]; an unknown name is a compile-time error.
pub const fn run_column(name: &str) -> usize {
    let mut index = 0;
    while index < RUN_COLUMNS.len() {
        if is_same(RUN_COLUMNS[index].name.as_bytes(), name.as_bytes()) {
            return index;
        }
        index += 1;
    }
    panic!("there is no such column")
}

const fn is_same(one: &[u8], other: &[u8]) -> bool {
    let mut index = 0;
    while index < one.len() && index < other.len() && one[index] == other[index] {
        index += 1;
    }
    index == one.len() && index == other.len()
}
