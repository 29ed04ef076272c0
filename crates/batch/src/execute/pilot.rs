//! A pilot: some runs of a plan, executed to estimate the duration of all.

use std::time::Duration;

use crate::execute::panics;
use crate::plan::BatchPlan;
use wildfire_base::time::wall::WallStopwatch;
use wildfire_sim::{CustomRegistry, RunOptions};

/// The most runs of a pilot.
const MAX_RUNS: u64 = 20;

/// The time after which no further run is begun.
const LONGEST: Duration = Duration::from_secs(60);

/// The result of a pilot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pilot {
    pub runs: u64,
    /// The real time of all pilot runs, one after the other.
    pub total: Duration,
    /// The real time of the longest one.
    pub longest: Duration,
}

impl Pilot {
    /// Executes runs that are spread evenly over the plan, so that every variant has its share if there are enough, on
    /// this thread; at least one, and no more after a minute. Failed runs count with the time they took.
    pub fn run(plan: &BatchPlan, registry: &CustomRegistry) -> Self {
        let options = RunOptions { memory: plan.memory, ..registry.clone().into() };
        let runs = plan.count().min(MAX_RUNS);
        let mut pilot = Self { runs: 0, total: Duration::ZERO, longest: Duration::ZERO };
        for index in 0..runs {
            // The first runs of a plan are all of its first variant, and would say nothing of the others.
            // The middle of each of as many parts; a plan has fewer than 2^53 runs, so this does not overflow.
            let run = plan.run(1 + (2 * index + 1) * plan.count() / (2 * runs));
            let stopwatch = WallStopwatch::start();
            // A run that panics does so in the batch as well, and is a row of it.
            let _ = panics::catch(|| wildfire_sim::run_with_options(&run.variant.scenario, run.seed, &options));
            let time = stopwatch.elapsed();
            pilot.runs += 1;
            pilot.total += time;
            pilot.longest = pilot.longest.max(time);
            // The estimate may be coarse, but it must not take long itself.
            if pilot.total > LONGEST {
                break;
            }
        }
        pilot
    }

    /// Returns the mean duration of a run in seconds.
    pub fn mean_s(&self) -> f64 {
        self.total.as_secs_f64() / self.runs as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::BatchRequest;

    #[test]
    fn pilot_makes_some_runs_of_a_plan_and_all_of_a_small_one() {
        for (seeds, expected) in [("1..3", 3), ("1..1000", MAX_RUNS)] {
            let request =
                BatchRequest { scenarios: vec!["smoke".into()], seeds: seeds.parse().ok(), ..BatchRequest::default() };
            let plan = request.resolve(false).expect("a small batch");
            let pilot = Pilot::run(&plan, &CustomRegistry::default());
            assert_eq!(pilot.runs, expected);
            assert!(pilot.longest <= pilot.total && pilot.mean_s() > 0.0, "{pilot:?}");
        }
    }
}
