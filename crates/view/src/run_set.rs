//! The displayed runs, and their replacement by others.

use std::sync::Arc;
use std::thread::{self, JoinHandle};

use bevy::prelude::Resource;

use wildfire_base::time::SimTime;
use wildfire_picture::film::RunView;

/// A source of further runs for a window.
pub trait RunLoader: Send + Sync {
    /// Simulates or reads the run of a seed, which may take long.
    ///
    /// # Errors
    /// A message for the viewer.
    fn load(&self, seed: u64) -> Result<RunView, String>;

    /// The seeds to step through; `None` if any seed is allowed.
    fn seeds(&self) -> Option<&[u64]>;
}

/// The runs to request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeedStep {
    Next,
    Previous,
    /// The next, to be played from the beginning.
    Rerun,
}

/// The displayed runs, and the requested ones.
#[derive(Resource)]
pub struct RunSet {
    runs: Vec<LoadedRun>,
    pending: Option<(SeedStep, JoinHandle<LoadResult>)>,
}

/// The result of a thread: a run in place of each that has a loader.
type LoadResult = Result<Vec<Option<RunView>>, String>;

struct LoadedRun {
    view: RunView,
    loader: Option<Arc<dyn RunLoader>>,
}

impl RunSet {
    pub fn new(runs: Vec<(RunView, Option<Box<dyn RunLoader>>)>) -> Self {
        let runs = runs.into_iter().map(|(run, loader)| LoadedRun { view: run, loader: loader.map(Arc::from) });
        Self { runs: runs.collect(), pending: None }
    }

    /// One run or two.
    pub fn runs(&self) -> Vec<&RunView> {
        self.runs.iter().map(|run| &run.view).collect()
    }

    /// Returns when the longest run ends.
    pub fn end(&self) -> SimTime {
        RunView::last_end(&self.runs())
    }

    /// The next time after `time` at which something happens in any run.
    pub fn next_event(&self, time: SimTime) -> Option<SimTime> {
        self.runs.iter().filter_map(|run| run.view.index().next_event(time)).min()
    }

    /// The last time before `time` at which something happened in any run.
    pub fn previous_event(&self, time: SimTime) -> Option<SimTime> {
        self.runs.iter().filter_map(|run| run.view.index().previous_event(time)).max()
    }

    /// Returns whether other runs are on their way.
    pub fn is_waiting(&self) -> bool {
        self.pending.is_some()
    }

    /// Requests the next run of every loader on a thread and returns a sentence about it; the present runs stay until
    /// those are there.
    ///
    /// # Errors
    /// A sentence that says why there are no other runs.
    pub fn request(&mut self, step: SeedStep) -> Result<String, String> {
        // A second request would take the place of the first, whose runs nobody would then receive.
        if self.is_waiting() {
            return Err("the run requested before is not ready yet".into());
        }
        let requests = self.runs.iter().map(|run| run.next_request(step)).collect::<Result<Vec<_>, _>>()?;
        let seeds: Vec<u64> = requests.iter().flatten().map(|(_, seed)| *seed).collect();
        let message = match seeds[..] {
            [] => return Err("a recording has no other seeds".into()),
            [seed] => format!("simulating seed {seed} ..."),
            [first, second, ..] if first == second => format!("simulating seed {first} twice ..."),
            [first, second, ..] => format!("simulating seeds {first} and {second} ..."),
        };
        let thread = thread::spawn(move || requests.into_iter().map(fetch).collect());
        self.pending = Some((step, thread));
        Ok(message)
    }

    /// Takes in the runs that were requested; `None` while they are on their way or none were requested.
    ///
    /// # Errors
    /// A sentence that says why they do not come; the present runs stay.
    pub fn receive(&mut self) -> Option<Result<SeedStep, String>> {
        // Joining a thread that still works would freeze the window.
        let (step, thread) = self.pending.take_if(|(_, thread)| thread.is_finished())?;
        let runs = thread.join().unwrap_or_else(|_| Err("the simulation crashed, which is a bug".into()));
        Some(runs.map(|runs| {
            self.replace(runs);
            step
        }))
    }

    fn replace(&mut self, runs: Vec<Option<RunView>>) {
        for (loaded, run) in self.runs.iter_mut().zip(runs) {
            if let Some(run) = run {
                loaded.view = run;
            }
        }
    }
}

type LoadRequest = (Arc<dyn RunLoader>, u64);

fn fetch(request: Option<LoadRequest>) -> Result<Option<RunView>, String> {
    request.map(|(loader, seed)| loader.load(seed)).transpose()
}

impl LoadedRun {
    /// Returns the next run to request; nothing for a recording.
    fn next_request(&self, step: SeedStep) -> Result<Option<LoadRequest>, String> {
        let Some(loader) = &self.loader else { return Ok(None) };
        let seed = neighbour(self.view.timeline().setting.seed, loader.seeds(), step)?;
        Ok(Some((Arc::clone(loader), seed)))
    }
}

/// The seed beside `seed`.
fn neighbour(seed: u64, seeds: Option<&[u64]>, step: SeedStep) -> Result<u64, String> {
    let beside = match (seeds, step) {
        (None, SeedStep::Next | SeedStep::Rerun) => seed.checked_add(1),
        (None, SeedStep::Previous) => seed.checked_sub(1),
        (Some(seeds), _) => {
            let at = seeds.iter().position(|&listed| listed == seed);
            let beside = match step {
                // A seed that is not in the list is followed by the first one.
                SeedStep::Next | SeedStep::Rerun => at.map_or(Some(0), |at| at.checked_add(1)),
                SeedStep::Previous => at.and_then(|at| at.checked_sub(1)),
            };
            beside.and_then(|beside| seeds.get(beside).copied())
        }
    };
    beside.ok_or_else(|| match step {
        SeedStep::Next | SeedStep::Rerun => format!("seed {seed} is the last"),
        SeedStep::Previous => format!("seed {seed} is the first"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_of_a_batch_are_walked_in_its_order_and_end() {
        let seeds = Some([4, 9, 2].as_slice());
        assert_eq!(neighbour(4, seeds, SeedStep::Next), Ok(9));
        assert_eq!(neighbour(9, seeds, SeedStep::Next), Ok(2));
        assert_eq!(neighbour(2, seeds, SeedStep::Previous), Ok(9));
        assert!(neighbour(2, seeds, SeedStep::Next).is_err());
        assert!(neighbour(4, seeds, SeedStep::Previous).is_err());
    }

    #[test]
    fn seeds_of_a_scenario_follow_one_another() {
        assert_eq!(neighbour(7, None, SeedStep::Next), Ok(8));
        assert_eq!(neighbour(7, None, SeedStep::Previous), Ok(6));
        assert!(neighbour(0, None, SeedStep::Previous).is_err());
        assert!(neighbour(u64::MAX, None, SeedStep::Next).is_err());
    }
}
