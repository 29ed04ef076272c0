//! How long the entries of a course will take, from the first run of each.

use std::time::Duration;

use wildfire_batch::execute::RunEnd;
use wildfire_batch::plan::BatchPlan;

/// Nothing is said of entries that take less.
const MIN: Duration = Duration::from_secs(60);

/// The entries of which no run is over yet.
pub struct Estimates {
    /// A title for each variant; none of batches that are not those of a course.
    titles: Vec<Option<String>>,
    seeds: u64,
    jobs: usize,
}

impl Estimates {
    pub fn new(plan: &BatchPlan, jobs: usize) -> Self {
        // Only a course has keys that its rules free.
        let entries = if plan.free.is_empty() { &[] } else { &plan.variants[..] };
        let titles = entries.iter().map(|variant| Some(plan.title(variant))).collect();
        Self { titles, seeds: plan.seeds.count(), jobs }
    }

    /// Estimates, after the first run of an entry, the time that all of its runs take, if that is a while.
    pub fn sentence(&mut self, end: RunEnd) -> Option<String> {
        let variant = usize::try_from((end.run - 1) / self.seeds).ok()?;
        let title = self.titles.get_mut(variant)?.take()?;
        let all = end.wall.mul_f64(self.seeds as f64 / self.jobs as f64);
        let minutes = all.as_secs_f64() / 60.0;
        let time = if minutes < 120.0 { format!("{minutes:.0} min") } else { format!("{:.0} h", minutes / 60.0) };
        (all >= MIN).then(|| format!("{title}: about {time} for this entry, {} runs", self.seeds))
    }
}
