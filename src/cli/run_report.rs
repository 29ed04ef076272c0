//! The report of `wildfire run`: the outcome, the winner, the agents, the CPU time.

use std::fmt::Write;

use crate::batch::{RunResult, RunRow, TextTable, notes};
use crate::cli::scenario_commands::{WIDTH, wrapped};
use crate::timeline::{AgentOutcome, Outcome, Winner};

/// The report of a run that is done, at most 80 columns wide.
pub fn to_text(row: &RunRow, result: &RunResult) -> String {
    let outcome = &result.outcome;
    let mut text = format!("{}, seed {}: ended after {:.1} s\n\n", row.label.scenario, row.label.seed, outcome.ended_s);
    text.push_str(&states(outcome).to_text());
    text.push('\n');
    text.push_str(&fires(outcome));
    text.push_str(&verdict(result));
    for note in notes(result) {
        for line in wrapped(&format!("Note: {note}"), WIDTH) {
            push(&mut text, format_args!("{line}\n"));
        }
    }
    text.push('\n');
    text.push_str(&agents(outcome).to_text());
    text.push('\n');
    text.push_str(&cpu_times(result).to_text());
    text.push_str(&cpu_per_plan(result));
    text
}

fn table(headings: &[&str], rows: Vec<Vec<String>>) -> TextTable {
    let headings = headings.iter().map(|heading| heading.split(' ').map(str::to_owned).collect()).collect();
    TextTable { headings, rows, rules_before: Vec::new() }
}

fn states(outcome: &Outcome) -> TextTable {
    let row = |state: &str, count: u32, ratio: f64| vec![state.to_owned(), count.to_string(), format!("{ratio:.3}")];
    let mut rows = vec![
        row("intact", outcome.intact, outcome.intact_ratio()),
        row("burned", outcome.burned(), outcome.burned_ratio()),
        row("extinguished", outcome.extinguished, outcome.extinguished_ratio()),
    ];
    rows.push(vec!["all".into(), outcome.obstacles.to_string(), String::new()]);
    TextTable { rules_before: vec![rows.len() - 1], ..table(&["Obstacles", "total", "ratio"], rows) }
}

fn fires(outcome: &Outcome) -> String {
    let (lit, spread, schedule) = (outcome.lit_by_wumpus, outcome.caught_by_spread, outcome.lit_by_schedule);
    let mut text = format!("Fires: {lit} lit by the Wumpus, {spread} caught by spread");
    if schedule > 0 {
        push(&mut text, format_args!(", {schedule} by schedule"));
    }
    push(&mut text, format_args!(";\n       at most {} at once", outcome.peak_burning));
    if let Some(first) = outcome.first_fire_s {
        push(&mut text, format_args!(", the first at {first:.1} s"));
    }
    if let Some(response) = outcome.mean_response_s {
        push(&mut text, format_args!(";\n       put out after {response:.1} s on average"));
    }
    text.push_str(".\n");
    text
}

fn verdict(result: &RunResult) -> String {
    let outcome = &result.outcome;
    let (wumpus, truck) = (outcome.wumpus_score, outcome.truck_score);
    if result.trucks().next().is_none() || result.wumpuses().next().is_none() {
        return format!("No contest: one side has no agents. Points: Wumpus {wumpus}, Unimog {truck}.\n");
    }
    match outcome.winner() {
        Winner::Wumpus => format!("The Wumpus wins, {wumpus} points to {truck}.\n"),
        Winner::Unimog => format!("The Unimog wins, {truck} points to {wumpus}.\n"),
        Winner::Tie => format!("A tie, {truck} points each.\n"),
    }
}

fn agents(outcome: &Outcome) -> TextTable {
    let seconds = |seconds: f64| format!("{seconds:.1}");
    let row = |agent: &AgentOutcome| {
        let failed: u32 = agent.failures.iter().sum();
        vec![
            agent.agent.to_string(),
            agent.cells.to_string(),
            agent.plans.to_string(),
            failed.to_string(),
            seconds(agent.distance_m),
            seconds(agent.driving_s),
            seconds(agent.planning_s),
            seconds(agent.suppressing_s),
            seconds(agent.standing_s),
            seconds(agent.stuck_s),
        ]
    };
    let headings = [
        "Agent",
        "cells",
        "plans",
        "failed",
        "distance m",
        "moving s",
        "planning s",
        "suppress. s",
        "standing s",
        "stuck s",
    ];
    table(&headings, outcome.agents.iter().map(row).collect())
}

fn cpu_times(result: &RunResult) -> TextTable {
    let cpu = &result.cpu;
    let parts = [
        ("terrain", cpu.terrain_s),
        ("clearance field", cpu.clearance_field_s),
        ("PRM sampling", cpu.sampling_s),
        ("PRM map generation", cpu.map_generation_s),
        ("roadmap search", cpu.roadmap_search_s),
        ("local search", cpu.local_search_s),
        ("reachability", cpu.reachability_s),
        ("Wumpus search", cpu.wumpus_s),
        ("everything else", cpu.rest_s()),
        ("whole run", cpu.run_s),
    ];
    let share = |seconds: f64| if cpu.run_s > 0.0 { format!("{:.1}", 100.0 * seconds / cpu.run_s) } else { "-".into() };
    let row = |(phase, seconds): (&str, f64)| vec![phase.to_owned(), format!("{:.3}", seconds * 1e3), share(seconds)];
    let rows: Vec<_> = parts.into_iter().map(row).collect();
    TextTable { rules_before: vec![rows.len() - 1], ..table(&["Phase", "CPU ms", "%"], rows) }
}

fn cpu_per_plan(result: &RunResult) -> String {
    let per_plan = |cpu_s: f64, agents: u32| format!("{:.1}", 1e6 * cpu_s / f64::from(agents.max(1)));
    let truck_plans = result.trucks().map(|agent| agent.plans).sum();
    let wumpus_plans = result.wumpuses().map(|agent| agent.plans).sum();
    let queries_s = result.cpu.roadmap_search_s + result.cpu.local_search_s;
    let (truck, wumpus) = (per_plan(queries_s, truck_plans), per_plan(result.cpu.wumpus_s, wumpus_plans));
    format!("CPU a plan: truck {truck} us ({truck_plans} plans), Wumpus {wumpus} us ({wumpus_plans} plans).\n")
}

fn push(text: &mut String, more: std::fmt::Arguments<'_>) {
    text.write_fmt(more).expect("a string takes any text");
}
