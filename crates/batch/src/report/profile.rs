//! Where the CPU time of runs went, by part.

use crate::execute::RunRow;
use wildfire_base::document::number::{percent, rounded};
use wildfire_base::document::{Block, Table};

/// Sums over the runs that are done.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    runs: u64,
    facts: u64,
    /// Seconds by part, in the order of [`PARTS`], and in all.
    parts_s: [f64; PARTS.len()],
    total_s: f64,
}

/// The parts that only some runs have: with a dispatched team, with planners or policies that are not built in.
const OPTIONAL: [&str; 4] = ["Custom planner: start", "Custom planner: queries", "Dispatch", "Custom policies"];

const PARTS: [&str; 13] = [
    "Drawing the field",
    "Clearance field",
    "Roadmap sampling",
    "Roadmap connecting",
    "Roadmap search",
    "Local search",
    "Reachability",
    OPTIONAL[0],
    OPTIONAL[1],
    OPTIONAL[2],
    "Wumpus",
    OPTIONAL[3],
    "Events, fire, rest",
];

impl Profile {
    pub fn add(&mut self, row: &RunRow) {
        let Some(result) = &row.result else { return };
        let cpu = &result.cpu;
        let parts = [
            cpu.terrain_s,
            cpu.clearance_field_s,
            cpu.sampling_s,
            cpu.map_generation_s,
            cpu.roadmap_search_s,
            cpu.local_search_s,
            cpu.reachability_s,
            cpu.custom_start_s,
            cpu.custom_queries_s,
            cpu.dispatch_s,
            cpu.wumpus_s,
            cpu.policy_s,
            cpu.rest_s(),
        ];
        self.parts_s.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        self.total_s += cpu.run_s;
        self.runs += 1;
        self.facts += row.detail.facts;
    }

    /// Returns a table, and how many facts a second of CPU time makes.
    pub fn blocks(&self, title: &str) -> Vec<Block> {
        if self.runs == 0 {
            return vec![Block::Text(format!("No run of {title} is done, so there is no CPU time to divide."))];
        }
        let row = |(name, seconds): (&str, f64)| {
            let (share, per_run_ms) = (seconds / self.total_s, 1e3 * seconds / self.runs as f64);
            vec![name.to_owned(), rounded(seconds, 3), percent(share), rounded(per_run_ms, 3)]
        };
        let is_shown = |&(name, seconds): &(&str, f64)| !OPTIONAL.contains(&name) || seconds > 0.0;
        let parts = PARTS.into_iter().zip(self.parts_s).filter(is_shown);
        let rows: Vec<_> = parts.chain([("Run", self.total_s)]).map(row).collect();
        let rule = rows.len() - 1;
        let table = Table::new(&["Part", "CPU s", "Share\n%", "ms per\nrun"], rows);
        let table = Table { rules_before: vec![rule], ..table }.with_caption(&format!("CPU time of {title}"));
        let (facts, per_second) = (self.facts, rounded(self.facts as f64 / self.total_s, 0));
        let facts = format!("{facts} events in {} runs, {per_second} per second of CPU time.", self.runs);
        vec![Block::Table(table), Block::Text(facts)]
    }
}
