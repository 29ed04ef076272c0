//! The CPU time of runs by part.

use crate::execute::{CpuSplit, RunRow};
use wildfire_base::document::number::{percent, rounded};
use wildfire_base::document::{Block, Table};

/// Sums over the finished runs.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    runs: u64,
    facts: u64,
    /// Seconds by part, in the order of [`PARTS`], and in all.
    parts_s: [f64; PARTS.len()],
    total_s: f64,
}

/// A part of the CPU time: its name, whether only some runs have it, such as those with a dispatched team, and its
/// seconds.
type ProfilePart = (&'static str, bool, fn(&CpuSplit) -> f64);

const PARTS: [ProfilePart; 13] = [
    ("Field generation", false, |cpu| cpu.terrain_s),
    ("Clearance field", false, |cpu| cpu.clearance_field_s),
    ("Roadmap sampling", false, |cpu| cpu.sampling_s),
    ("Roadmap connecting", false, |cpu| cpu.map_generation_s),
    ("Roadmap search", false, |cpu| cpu.roadmap_search_s),
    ("Local search", false, |cpu| cpu.local_search_s),
    ("Reachability", false, |cpu| cpu.reachability_s),
    ("Custom planner: start", true, |cpu| cpu.custom_start_s),
    ("Custom planner: queries", true, |cpu| cpu.custom_queries_s),
    ("Dispatch", true, |cpu| cpu.dispatch_s),
    ("Wumpus", false, |cpu| cpu.wumpus_s),
    ("Custom policies", true, |cpu| cpu.policy_s),
    ("Events, fire, rest", false, CpuSplit::rest_s),
];

impl Profile {
    pub fn add(&mut self, row: &RunRow) {
        let Some(result) = &row.result else { return };
        self.parts_s.iter_mut().zip(&PARTS).for_each(|(sum, (.., seconds))| *sum += seconds(&result.cpu));
        self.total_s += result.cpu.run_s;
        self.runs += 1;
        self.facts += row.detail.facts;
    }

    /// Returns a table, and the number of facts per second of CPU time.
    pub fn blocks(&self, title: &str) -> Vec<Block> {
        if self.runs == 0 {
            return vec![Block::Text(format!("No run of {title} has finished, so there is no CPU time to show."))];
        }
        // Parts of planners that few scenarios have would be rows of zeros.
        let parts = PARTS.iter().zip(self.parts_s).filter(|((_, is_rare, _), seconds)| !is_rare || *seconds > 0.0);
        let parts = parts.map(|((name, ..), seconds)| (*name, seconds));
        let rows: Vec<_> = parts
            .chain([("Run", self.total_s)])
            .map(|(name, seconds)| {
                let share = seconds / self.total_s;
                let per_run_ms = 1e3 * seconds / self.runs as f64;
                vec![name.to_owned(), rounded(seconds, 3), percent(share), rounded(per_run_ms, 3)]
            })
            .collect();
        let rule = rows.len() - 1;
        let table = Table::new(&["Part", "CPU s", "Share\n%", "ms per\nrun"], rows);
        let table = Table { rules_before: vec![rule], ..table }.with_caption(&format!("CPU time of {title}"));
        let facts = self.facts;
        let per_second = rounded(self.facts as f64 / self.total_s, 0);
        let facts = format!("{facts} events in {} runs, {per_second} per second of CPU time.", self.runs);
        vec![Block::Table(table), Block::Text(facts)]
    }
}
