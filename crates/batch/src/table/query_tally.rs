//! How the trucks' queries of some runs went, as far as it tells whether a planner's figures are its own: drives to which
//! the reachability flood led after the planner had failed, and queries that a clock ended.

use std::ops::AddAssign;

use serde::Serialize;

use crate::table::columns::RUN_COLUMNS;
use wildfire_base::document::number::{count, rounded};

/// Words in messages of programs that reached another limit than that of a query; `crates/sim/src/programs/process.rs` writes them.
const OTHER_LIMITS: [&str; 3] = [" of memory and was killed", "gave no `hello` within ", "gave no `ready` within "];

/// Counts of drives and queries of trucks over some runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct QueryTally {
    /// Plans that trucks got, from any source.
    pub drives: u64,
    /// Queries that failed without a rescue.
    pub failed: u64,
    /// Drives from the reachability flood after the planner had failed.
    pub rescued: u64,
    /// Queries that ended because a planner exceeded its time limit.
    pub timed_out: u64,
    /// Runs with a message about another limit: of memory, or of the time to start.
    pub limited_runs: u64,
    /// Questions to custom policies.
    pub asks: u64,
    /// Questions without an answer, or with one that nobody could carry out.
    pub failed_asks: u64,
    /// Questions that ended because a policy exceeded its time limit.
    pub timed_out_asks: u64,
}

impl QueryTally {
    /// Creates counts from the numbers in columns of `runs.csv`, 0 where there is none, and from the run's message.
    pub fn of_run(number: impl Fn(&str) -> u64, message: &str) -> Self {
        // Columns are found by prefix, so a new reason of failure is counted without a change here.
        let sum = |prefix: &str| {
            let names = RUN_COLUMNS.iter().map(|column| column.name).filter(|name| name.starts_with(prefix));
            // The numbers come from a file that anybody may write, and must not overflow.
            names.map(&number).fold(0, u64::saturating_add)
        };
        let failed = sum("truck_failed_");
        Self {
            drives: number("truck_plans").saturating_sub(failed),
            failed,
            rescued: number("truck_lattice_plans"),
            timed_out: number("truck_failed_timed_out"),
            limited_runs: OTHER_LIMITS.iter().any(|phrase| message.contains(phrase)).into(),
            asks: number("policy_asked"),
            failed_asks: sum("policy_failed_").saturating_add(number("policy_illegal")),
            timed_out_asks: number("policy_failed_timed_out"),
        }
    }

    /// Returns what a reader must know about these figures: nothing if nobody was rescued and no clock decided.
    pub fn sentences(&self, planner: &str) -> Vec<String> {
        let rescued = (self.rescued > 0).then(|| {
            let share = 100.0 * self.rescued as f64 / self.drives.max(1) as f64;
            let share = if share < 0.05 { "under 0.1".to_owned() } else { rounded(share, 1) };
            format!("Rescued: {share} % of the drives by {planner}.")
        });
        rescued.into_iter().chain(self.machine_sentence(planner)).collect()
    }

    /// Returns whether a limit of time or memory changed an outcome, so that another machine may give another one.
    pub fn depends_on_machine(&self) -> bool {
        self.timed_out > 0 || self.timed_out_asks > 0 || self.limited_runs > 0
    }

    /// Returns a sentence about that, if a limit changed an outcome.
    pub fn machine_sentence(&self, planner: &str) -> Option<String> {
        let timed_out = (self.timed_out > 0).then(|| {
            let queries =
                if self.timed_out == 1 { "1 query".to_owned() } else { format!("{} queries", self.timed_out) };
            format!("{queries} of {planner} timed out")
        });
        let limited = (self.limited_runs > 0).then(|| match self.limited_runs {
            1 => format!("{planner} reached a limit of memory or start time in 1 run"),
            runs => format!("{planner} reached a limit of memory or start time in {runs} runs"),
        });
        let asks = (self.timed_out_asks > 0)
            .then(|| format!("{} of a policy timed out", count(self.timed_out_asks as usize, "ask")));
        let reasons: Vec<String> = timed_out.into_iter().chain(asks).chain(limited).collect();
        self.depends_on_machine().then(|| format!("Outcomes depend on this machine: {}.", reasons.join("; ")))
    }
}

impl AddAssign for QueryTally {
    fn add_assign(&mut self, other: Self) {
        self.drives = self.drives.saturating_add(other.drives);
        self.failed = self.failed.saturating_add(other.failed);
        self.rescued = self.rescued.saturating_add(other.rescued);
        self.timed_out = self.timed_out.saturating_add(other.timed_out);
        self.limited_runs = self.limited_runs.saturating_add(other.limited_runs);
        self.asks = self.asks.saturating_add(other.asks);
        self.failed_asks = self.failed_asks.saturating_add(other.failed_asks);
        self.timed_out_asks = self.timed_out_asks.saturating_add(other.timed_out_asks);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_was_rescued_and_whom_a_clock_stopped_is_said() {
        let number = |column: &str| match column {
            "truck_plans" => 120,
            "truck_failed_disconnected" | "truck_failed_timed_out" => 10,
            "truck_lattice_plans" => 12,
            _ => 0,
        };
        let mut tally = QueryTally::of_run(number, "");
        assert_eq!(tally, QueryTally { drives: 100, failed: 20, rescued: 12, timed_out: 10, ..QueryTally::default() });
        tally += QueryTally { drives: 100, ..QueryTally::default() };
        assert_eq!(
            tally.sentences("rrt"),
            ["Rescued: 6.0 % of the drives by rrt.", "Outcomes depend on this machine: 10 queries of rrt timed out."]
        );
        let limited = QueryTally::of_run(|_| 0, "planner `rrt` took 70 MB of memory and was killed");
        assert_eq!(
            limited.sentences("rrt"),
            ["Outcomes depend on this machine: rrt reached a limit of memory or start time in 1 run."]
        );
        let asks = QueryTally::of_run(|column| if column.starts_with("policy_") { 3 } else { 0 }, "");
        assert_eq!((asks.asks, asks.failed_asks), (3, 12));
        assert_eq!(asks.sentences("rrt"), ["Outcomes depend on this machine: 3 asks of a policy timed out."]);
        assert!(QueryTally { drives: 9, ..QueryTally::default() }.sentences("rrt").is_empty());
    }
}
