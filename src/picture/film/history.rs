//! Counts and scores of a run over time, and what happened to each bush.

use super::Fate;
use crate::time::SimTime;
use crate::timeline::{Rules, Timeline};

/// Bushes by fate, and how often each change happened so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// In the order of [`Fate::ALL`].
    bushes: [u32; 4],
    /// How often a bush came to each fate, in the same order.
    changes: [u32; 4],
}

impl Tally {
    pub fn count(&self, fate: Fate) -> u32 {
        self.bushes[fate as usize]
    }

    pub fn bushes(&self) -> u32 {
        self.bushes.iter().sum()
    }

    /// Burning or burned out.
    pub fn burned(&self) -> u32 {
        self.count(Fate::Burning) + self.count(Fate::BurnedOut)
    }

    /// As [`crate::timeline::Outcome::wumpus_score`] counts.
    pub fn wumpus_score(&self, rules: &Rules) -> f64 {
        rules.score_wumpus_ignited * self.changes_to(Fate::Burning)
            + rules.score_wumpus_burned_out * self.changes_to(Fate::BurnedOut)
    }

    /// As [`crate::timeline::Outcome::truck_score`] counts.
    pub fn truck_score(&self, rules: &Rules) -> f64 {
        rules.score_truck_extinguished * self.changes_to(Fate::Extinguished)
    }

    fn changes_to(&self, fate: Fate) -> f64 {
        f64::from(self.changes[fate as usize])
    }
}

/// Counts over time, as steps, and the facts of each bush.
#[derive(Debug)]
pub struct History {
    /// Ascending in time, the first at zero; each holds from its time on, after all facts of that time.
    steps: Vec<(SimTime, Tally)>,
    /// Bush, by its place in the setting, and index of the fact that changed it; ascending.
    changes: Vec<(usize, usize)>,
}

impl History {
    pub fn of(timeline: &Timeline) -> Self {
        let end = timeline.end_time();
        let mut fates = vec![Fate::Intact; timeline.setting.bushes.len()];
        let mut tally = Tally::default();
        tally.bushes[Fate::Intact as usize] = fates.len() as u32;
        let mut history = Self { steps: vec![(SimTime::ZERO, tally)], changes: Vec::new() };
        for (index, event) in timeline.events.iter().enumerate().take_while(|(_, event)| event.time <= end) {
            let Some((cell, to)) = event.bush_change() else { continue };
            let fate = Fate::of(to);
            tally.changes[fate as usize] += 1;
            if let Some(bush) = timeline.setting.bush_index(cell) {
                let was = std::mem::replace(&mut fates[bush], fate);
                tally.bushes[was as usize] -= 1;
                tally.bushes[fate as usize] += 1;
                history.changes.push((bush, index));
            }
            history.step(event.time, tally);
        }
        history.changes.sort_unstable();
        history
    }

    fn step(&mut self, time: SimTime, tally: Tally) {
        match self.steps.last_mut() {
            Some(last) if last.0 == time => last.1 = tally,
            _ => self.steps.push((time, tally)),
        }
    }

    /// After all facts at `time`.
    pub fn tally_at(&self, time: SimTime) -> Tally {
        self.steps[self.steps.partition_point(|step| step.0 <= time) - 1].1
    }

    /// The indices of the facts that changed a bush, by its place in the setting, in order of time.
    pub fn changes_of(&self, bush: usize) -> impl Iterator<Item = usize> {
        let from = self.changes.partition_point(|change| change.0 < bush);
        self.changes[from..].iter().take_while(move |change| change.0 == bush).map(|change| change.1)
    }
}
