//! The bushes in the course of a run: counts as steps, every change, and the moments of spread.

use std::collections::BTreeMap;

use crate::replay::BushChange;
use crate::{BushState, Cause, Fact, FireFact, Outcome, Rules, Setting, Timeline};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::BushStateKind;

const NANOS_PER_SECOND: f64 = 1e9;

/// Between two kept states there are at least this many changes, and as many as there are bushes, so that all of them
/// together are not larger than the changes.
const MIN_STRIDE: usize = 256;

/// The bushes by state, and the number of changes of each kind so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BushCounts {
    /// In the order of [`BushStateKind::ALL`].
    bushes: [u32; 4],
    /// Times that a bush came to each state, in the same order.
    changes: [u32; 4],
}

impl BushCounts {
    pub fn count(&self, kind: BushStateKind) -> u32 {
        self.bushes[kind as usize]
    }

    pub fn bushes(&self) -> u32 {
        self.bushes.iter().sum()
    }

    pub fn burning(&self) -> u32 {
        self.count(BushStateKind::Burning)
    }

    /// Returns the number of bushes that burn or have burned out.
    pub fn burned(&self) -> u32 {
        self.burning() + self.count(BushStateKind::BurnedOut)
    }

    /// Returns the number of bushes that can catch fire, depending on whether extinguished ones burn again.
    pub fn lightable(&self, reignition: bool) -> u32 {
        let extinguished = if reignition { self.count(BushStateKind::Extinguished) } else { 0 };
        self.count(BushStateKind::Intact) + extinguished
    }

    /// Returns the points for ignitions, including spread and schedule, and for burn-outs.
    pub fn wumpus_score(&self, rules: &Rules) -> f64 {
        rules.score_wumpus_ignited * self.changes_to(BushStateKind::Burning)
            + rules.score_wumpus_burned_out * self.changes_to(BushStateKind::BurnedOut)
    }

    /// Returns the points for extinctions.
    pub fn truck_score(&self, rules: &Rules) -> f64 {
        rules.score_truck_extinguished * self.changes_to(BushStateKind::Extinguished)
    }

    fn changes_to(&self, kind: BushStateKind) -> f64 {
        f64::from(self.changes[kind as usize])
    }
}

/// A change of a bush, by its place in the setting, with the place of the fact.
#[derive(Clone, Copy, Debug)]
struct BushTransition {
    time: SimTime,
    bush: usize,
    to: BushState,
    fact: usize,
}

/// All changes of bushes, counts after each of them, and whole states every so often.
#[derive(Debug)]
pub(super) struct BushHistory {
    /// In order of time.
    changes: Vec<BushTransition>,
    /// Bush, and the place of the fact that changed it; ascending.
    by_bush: Vec<(usize, usize)>,
    /// In order of time, the first at zero; each holds from its time on, after all facts of that time.
    counts: Vec<(SimTime, BushCounts)>,
    stride: usize,
    /// Before the changes 0, `stride`, 2 `stride` and so on.
    kept: Vec<Vec<BushState>>,
}

impl BushHistory {
    fn new(bushes: usize) -> Self {
        let mut counts = BushCounts::default();
        counts.bushes[BushStateKind::Intact as usize] = bushes as u32;
        Self {
            changes: Vec::new(),
            by_bush: Vec::new(),
            counts: vec![(SimTime::ZERO, counts)],
            stride: bushes.max(MIN_STRIDE),
            kept: vec![vec![BushState::Intact; bushes]],
        }
    }

    /// Returns the counts after all facts at `time`.
    pub fn counts_at(&self, time: SimTime) -> BushCounts {
        self.counts[self.counts.partition_point(|step| step.0 <= time) - 1].1
    }

    /// Returns the states in the order of [`Setting::bushes`], after all facts at `time`.
    pub fn states_at(&self, time: SimTime) -> Vec<BushState> {
        let until = self.changes.partition_point(|change| change.time <= time);
        let before = until / self.stride;
        let mut bushes = self.kept[before].clone();
        for change in &self.changes[before * self.stride..until] {
            bushes[change.bush] = change.to;
        }
        bushes
    }

    /// Iterates over the places of the facts that changed a bush, in order of time.
    pub fn changes_of(&self, bush: usize) -> impl Iterator<Item = usize> {
        let from = self.by_bush.partition_point(|change| change.0 < bush);
        self.by_bush[from..].iter().take_while(move |change| change.0 == bush).map(|change| change.1)
    }

    fn last_counts(&self) -> &BushCounts {
        &self.counts[self.counts.len() - 1].1
    }

    fn push(&mut self, change: BushTransition, from: BushState, bushes: &[BushState]) {
        let mut counts = *self.last_counts();
        let from = from.kind() as usize;
        let to = change.to.kind() as usize;
        counts.bushes[from] -= 1;
        counts.bushes[to] += 1;
        counts.changes[to] += 1;
        // Of the counts at one instant, a look-up may only find the last.
        match self.counts.last_mut() {
            Some(last) if last.0 == change.time => last.1 = counts,
            _ => self.counts.push((change.time, counts)),
        }
        self.changes.push(change);
        if self.changes.len().is_multiple_of(self.stride) {
            self.kept.push(bushes.to_vec());
        }
    }
}

/// Follows the bushes through a run.
#[derive(Debug)]
pub(super) struct BushReader {
    history: BushHistory,
    outcome: Outcome,
    // 16 million cells that burn for an hour are more nanoseconds than 64 bits hold.
    burning_cell_ns: u128,
    response_ns: u128,
    responses: u32,
    first_fire: Option<SimTime>,
    last_end_of_fire: Option<SimTime>,
}

impl BushReader {
    pub fn new(setting: &Setting) -> Self {
        Self {
            history: BushHistory::new(setting.bushes.len()),
            outcome: Outcome::default(),
            burning_cell_ns: 0,
            response_ns: 0,
            responses: 0,
            first_fire: None,
            last_end_of_fire: None,
        }
    }

    pub fn counts(&self) -> &BushCounts {
        self.history.last_counts()
    }

    pub fn record_fact(&mut self, fact: &Fact) {
        match fact {
            Fact::Fire(FireFact::Ignited { cause: Cause::Agent(_), .. }) => self.outcome.lit_by_wumpus += 1,
            Fact::Fire(FireFact::Ignited { cause: Cause::Spread(_) | Cause::Spotted(_), .. }) => {
                self.outcome.caught_by_spread += 1;
            }
            Fact::Fire(FireFact::Ignited { cause: Cause::Scheduled, .. }) => self.outcome.lit_by_schedule += 1,
            _ => {}
        }
    }

    /// Records the effect of the fact at that place; `bushes` are as they are after it.
    pub fn record_change(&mut self, change: BushChange, now: SimTime, fact: usize, bushes: &[BushState]) {
        let BushChange { bush, from, to } = change;
        self.history.push(BushTransition { time: now, bush, to, fact }, from, bushes);
        if to.burns() {
            self.first_fire = self.first_fire.or(Some(now));
        } else {
            self.last_end_of_fire = Some(now);
        }
        if let (BushState::Burning { since }, BushState::Extinguished) = (from, to) {
            self.response_ns += u128::from((now - since).as_nanos());
            self.responses += 1;
        }
    }

    /// Records what burns after all facts of an instant.
    pub fn end_instant(&mut self) {
        self.outcome.peak_burning = self.outcome.peak_burning.max(self.counts().burning());
    }

    /// Records a period of time.
    pub fn account(&mut self, span: SimTime) {
        self.burning_cell_ns += u128::from(self.counts().burning()) * u128::from(span.as_nanos());
    }

    /// Returns the history, and an outcome with its numbers about bushes.
    pub fn finish(mut self, rules: &Rules) -> (BushHistory, Outcome) {
        let counts = *self.counts();
        // NaN without a response, and then left out below.
        let mean_response_s = self.response_ns as f64 / NANOS_PER_SECOND / f64::from(self.responses);
        let outcome = Outcome {
            obstacles: counts.bushes(),
            intact: counts.count(BushStateKind::Intact),
            burning: counts.burning(),
            burned_out: counts.count(BushStateKind::BurnedOut),
            extinguished: counts.count(BushStateKind::Extinguished),
            burning_cell_s: self.burning_cell_ns as f64 / NANOS_PER_SECOND,
            mean_response_s: (self.responses > 0).then_some(mean_response_s),
            first_fire_s: self.first_fire.map(SimTime::as_seconds),
            all_out_s: self.last_end_of_fire.filter(|_| counts.burning() == 0).map(SimTime::as_seconds),
            wumpus_score: counts.wumpus_score(rules),
            truck_score: counts.truck_score(rules),
            ..self.outcome
        };
        self.history.by_bush = self.history.changes.iter().map(|change| (change.bush, change.fact)).collect();
        self.history.by_bush.sort_unstable();
        (self.history, outcome)
    }
}

/// A moment of spread: a burning cell ignites its neighbourhood, if anything can burn there.
#[derive(Debug, PartialEq)]
pub struct SpreadMoment {
    pub time: SimTime,
    pub from: Cell,
    /// The ignited cells, in order.
    pub caught: Vec<Cell>,
}

/// When the rules let which burning cells spread, and what caught fire from them; where the rules are not known, only
/// what did light something.
pub(super) fn spread_moments(timeline: &Timeline) -> Vec<SpreadMoment> {
    let mut caught: BTreeMap<(SimTime, u16, u16), Vec<Cell>> = BTreeMap::new();
    // Moments at which fire may spread count even where nothing caught fire.
    for (time, from) in due_spreads(timeline) {
        caught.insert((time, from.row, from.col), Vec::new());
    }
    for event in &timeline.events {
        if let Fact::Fire(FireFact::Ignited { cell, cause: Cause::Spread(from) }) = event.fact {
            caught.entry((event.time, from.row, from.col)).or_default().push(cell);
        }
    }
    caught
        .into_iter()
        .map(|((time, row, col), caught)| SpreadMoment { time, from: Cell { col, row }, caught })
        .collect()
}

/// Cells that burn still when their delay is over. At one instant fires end before they spread.
fn due_spreads(timeline: &Timeline) -> Vec<(SimTime, Cell)> {
    let Setting { bushes, rules, .. } = &timeline.setting;
    let Some(fire) = rules.fire else { return Vec::new() };
    let mut due: Vec<Option<SimTime>> = vec![None; bushes.len()];
    let mut spreads = Vec::new();
    for event in &timeline.events {
        let Fact::Fire(fact) = &event.fact else { continue };
        let Some(bush) = timeline.setting.bush_index(fact.cell()) else { continue };
        match fact {
            FireFact::Ignited { cause, .. } => {
                // What an agent or the schedule lit is a source.
                let may = if matches!(cause, Cause::Spread(_)) { fire.caught_spreads } else { fire.sources_spread };
                due[bush] = may.then_some(event.time + fire.spread_delay);
            }
            FireFact::BurnedOut { .. } | FireFact::Extinguished { .. } => {
                spreads.extend(due[bush].take().filter(|&due| due < event.time).map(|due| (due, bushes[bush])));
            }
        }
    }
    let end = timeline.end_time();
    let lasting = due.iter().zip(bushes).filter_map(|(due, &bush)| Some((due.filter(|&due| due <= end)?, bush)));
    spreads.extend(lasting);
    spreads
}
