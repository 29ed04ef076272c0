//! Where the CPU time of runs went, by part.

use crate::batch::execute::RunRow;
use crate::batch::text_table::TextTable;

/// Sums over the runs that are done.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    runs: u64,
    facts: u64,
    /// Seconds by part, in the order of [`PARTS`], and in all.
    parts_s: [f64; PARTS.len()],
    total_s: f64,
}

const PARTS: [&str; 9] = [
    "Drawing the field",
    "Clearance field",
    "Roadmap sampling",
    "Roadmap connecting",
    "Roadmap search",
    "Local search",
    "Reachability",
    "Wumpus",
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
            cpu.wumpus_s,
            cpu.rest_s(),
        ];
        self.parts_s.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        self.total_s += cpu.run_s;
        self.runs += 1;
        self.facts += row.detail.facts;
    }

    /// A table, and how many facts a second of CPU time makes.
    pub fn to_text(&self) -> String {
        let headings = [&["Part"][..], &["CPU s"], &["Share", "%"], &["ms a", "run"]];
        let headings = headings.map(|lines| lines.iter().map(|&line| line.to_owned()).collect());
        let row = |(name, seconds): (&str, f64)| {
            let share = 100.0 * seconds / self.total_s;
            let per_run_ms = 1e3 * seconds / self.runs as f64;
            vec![name.to_owned(), format!("{seconds:.3}"), format!("{share:.1}"), format!("{per_run_ms:.3}")]
        };
        if self.runs == 0 {
            return "No run is done, so there is no CPU time to part.\n".into();
        }
        let parts = PARTS.into_iter().zip(self.parts_s).chain([("Run", self.total_s)]);
        let table =
            TextTable { headings: headings.to_vec(), rows: parts.map(row).collect(), rules_before: vec![PARTS.len()] };
        let per_second = self.facts as f64 / self.total_s;
        let facts = self.facts;
        format!("{}\n{facts} events in {} runs, {per_second:.0} a second of CPU time.\n", table.to_text(), self.runs)
    }
}
