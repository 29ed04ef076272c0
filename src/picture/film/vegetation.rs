//! The bushes of a run at any time, without going through all that happened before.

use crate::time::SimTime;
use crate::timeline::{BushState, Event, Setting, Timeline};

/// Between two kept states there are at least this many changes, and as many as there are bushes, so that all of them
/// together are not larger than the changes.
const LEAST_STRIDE: usize = 256;

/// What became of which bush, by its place in the setting.
#[derive(Clone, Copy, Debug)]
struct Turn {
    time: SimTime,
    bush: usize,
    to: BushState,
}

/// All changes of bushes, and their states every so many changes.
#[derive(Debug)]
pub struct BushStateHistory {
    /// In order of time.
    turns: Vec<Turn>,
    stride: usize,
    /// Before the turns 0, `stride`, 2 `stride` and so on.
    kept: Vec<Vec<BushState>>,
}

impl BushStateHistory {
    pub fn new(timeline: &Timeline) -> Self {
        let setting = &timeline.setting;
        let turns = turns(timeline, setting);
        let stride = setting.bushes.len().max(LEAST_STRIDE);
        let mut bushes = vec![BushState::Intact; setting.bushes.len()];
        let mut kept = vec![bushes.clone()];
        for turns in turns.chunks_exact(stride) {
            apply(turns, &mut bushes);
            kept.push(bushes.clone());
        }
        Self { turns, stride, kept }
    }

    /// In the order of [`Setting::bushes`], after all facts at `time`.
    pub fn at(&self, time: SimTime) -> Vec<BushState> {
        let until = self.turns.partition_point(|turn| turn.time <= time);
        let before = until / self.stride;
        let mut bushes = self.kept[before].clone();
        apply(&self.turns[before * self.stride..until], &mut bushes);
        bushes
    }
}

fn turns(timeline: &Timeline, setting: &Setting) -> Vec<Turn> {
    let end = timeline.end_time();
    let events = timeline.events.iter().take_while(|event| event.time <= end);
    let turn = |event: &Event| {
        let (cell, to) = event.bush_change()?;
        Some(Turn { time: event.time, bush: setting.bush_index(cell)?, to })
    };
    events.filter_map(turn).collect()
}

fn apply(turns: &[Turn], bushes: &mut [BushState]) {
    for turn in turns {
        bushes[turn.bush] = turn.to;
    }
}
