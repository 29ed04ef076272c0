//! What the words about a request are taken from.

use super::super::{BushCounts, FrameRequest, RunView, ViewOptions};
use crate::time::SimTime;
use crate::timeline::State;

/// The runs of a request at its time.
pub struct Moment<'a> {
    pub runs: &'a [&'a RunView],
    pub options: &'a ViewOptions,
    pub time: SimTime,
    /// When the last run ends.
    pub end: SimTime,
    pub states: &'a [State],
    pub counts: Vec<BushCounts>,
}

impl<'a> Moment<'a> {
    pub fn new(request: &FrameRequest<'a>, states: &'a [State]) -> Self {
        let end = RunView::last_end(request.runs);
        let time = request.time.min(end);
        let counts = request.runs.iter().map(|run| run.counts_at(time)).collect();
        Self { runs: request.runs, options: request.options, time, end, states, counts }
    }

    pub fn is_comparison(&self) -> bool {
        self.runs.len() > 1
    }
}
