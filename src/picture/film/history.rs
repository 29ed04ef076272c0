//! Counts and scores of a run over time, and what happened to each bush.

use crate::fire::BushStateKind;
use crate::time::SimTime;
use crate::timeline::{Rules, Timeline};

/// Bushes by state, and how often each change happened so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BushCounts {
    /// In the order of [`BushStateKind::ALL`].
    bushes: [u32; 4],
    /// How often a bush came to each state, in the same order.
    changes: [u32; 4],
}

impl BushCounts {
    pub fn count(&self, kind: BushStateKind) -> u32 {
        self.bushes[kind as usize]
    }

    pub fn bushes(&self) -> u32 {
        self.bushes.iter().sum()
    }

    /// Burning or burned out.
    pub fn burned(&self) -> u32 {
        self.count(BushStateKind::Burning) + self.count(BushStateKind::BurnedOut)
    }

    /// As [`crate::timeline::Outcome::wumpus_score`] counts.
    pub fn wumpus_score(&self, rules: &Rules) -> f64 {
        rules.score_wumpus_ignited * self.changes_to(BushStateKind::Burning)
            + rules.score_wumpus_burned_out * self.changes_to(BushStateKind::BurnedOut)
    }

    /// As [`crate::timeline::Outcome::truck_score`] counts.
    pub fn truck_score(&self, rules: &Rules) -> f64 {
        rules.score_truck_extinguished * self.changes_to(BushStateKind::Extinguished)
    }

    fn changes_to(&self, kind: BushStateKind) -> f64 {
        f64::from(self.changes[kind as usize])
    }
}

/// Counts over time, as steps, and the facts of each bush.
#[derive(Debug)]
pub struct CountHistory {
    /// Ascending in time, the first at zero; each holds from its time on, after all facts of that time.
    steps: Vec<(SimTime, BushCounts)>,
    /// Bush, by its place in the setting, and index of the fact that changed it; ascending.
    changes: Vec<(usize, usize)>,
}

impl CountHistory {
    pub fn new(timeline: &Timeline) -> Self {
        let end = timeline.end_time();
        let mut kinds = vec![BushStateKind::Intact; timeline.setting.bushes.len()];
        let mut counts = BushCounts::default();
        counts.bushes[BushStateKind::Intact as usize] = kinds.len() as u32;
        let mut history = Self { steps: vec![(SimTime::ZERO, counts)], changes: Vec::new() };
        for (index, event) in timeline.events.iter().enumerate().take_while(|(_, event)| event.time <= end) {
            let Some((cell, to)) = event.bush_change() else { continue };
            let kind = to.kind();
            counts.changes[kind as usize] += 1;
            if let Some(bush) = timeline.setting.bush_index(cell) {
                let was = std::mem::replace(&mut kinds[bush], kind);
                counts.bushes[was as usize] -= 1;
                counts.bushes[kind as usize] += 1;
                history.changes.push((bush, index));
            }
            history.step(event.time, counts);
        }
        history.changes.sort_unstable();
        history
    }

    fn step(&mut self, time: SimTime, counts: BushCounts) {
        match self.steps.last_mut() {
            Some(last) if last.0 == time => last.1 = counts,
            _ => self.steps.push((time, counts)),
        }
    }

    /// After all facts at `time`.
    pub fn counts_at(&self, time: SimTime) -> BushCounts {
        self.steps[self.steps.partition_point(|step| step.0 <= time) - 1].1
    }

    /// The indices of the facts that changed a bush, by its place in the setting, in order of time.
    pub fn changes_of(&self, bush: usize) -> impl Iterator<Item = usize> {
        let from = self.changes.partition_point(|change| change.0 < bush);
        self.changes[from..].iter().take_while(move |change| change.0 == bush).map(|change| change.1)
    }
}
