//! Observers of planners: the kind of work in progress, and the places that searches examine.
//!
//! Planners keep no clock and no record. The caller passes an observer, which changes no answer.

use std::time::Duration;

use glam::DVec2;

use wildfire_base::query::SearchPhase;
use wildfire_base::time::cpu::CpuStopwatch;

use super::search_recorder::{SearchRecorder, Searched};

/// The kinds of work whose CPU time is measured separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanningWork {
    /// Queries of a roadmap.
    Roadmap,
    /// Searches over motions, and path improvement.
    Local,
}

/// Watches a planner while it answers a query.
pub trait PlanningObserver {
    /// A kind of work begins, which ends what was done before; `None`: the rest is not counted.
    fn begins(&mut self, work: Option<PlanningWork>);

    /// A search of this phase looked at straight lines, in this order, in metres; where it began there is a line of length
    /// zero. Lines that are not asked for are not worked out.
    fn on_edges_examined(&mut self, phase: SearchPhase, lines: &mut dyn Iterator<Item = [DVec2; 2]>);
}

/// Observes nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NullObserver;

impl PlanningObserver for NullObserver {
    fn begins(&mut self, _work: Option<PlanningWork>) {}

    fn on_edges_examined(&mut self, _phase: SearchPhase, _lines: &mut dyn Iterator<Item = [DVec2; 2]>) {}
}

/// CPU time of one query, by kind of work.
#[derive(Clone, Copy, Debug, Default)]
pub struct QueryTime {
    pub roadmap: Duration,
    pub local: Duration,
}

/// What a monitor has seen of a query.
#[derive(Debug)]
pub struct QueryRecord {
    pub time: QueryTime,
    /// The recorded searches, each phase at most once.
    pub searches: Vec<Searched>,
}

/// Measures the CPU time of a query by kind of work, and records the places it examines if requested.
#[derive(Debug)]
pub struct QueryMonitor {
    /// What is being done, and since when. Reading a thread's clock takes longer than many a query, so it is read only
    /// where work begins or ends.
    work: Option<(PlanningWork, CpuStopwatch)>,
    time: QueryTime,
    recorder: SearchRecorder,
}

impl QueryMonitor {
    pub fn new(records_searches: bool) -> Self {
        let recorder = SearchRecorder::new(records_searches);
        Self { work: None, time: QueryTime::default(), recorder }
    }

    /// Ends the query.
    pub fn finish(mut self) -> QueryRecord {
        self.begins(None);
        QueryRecord { time: self.time, searches: self.recorder.finish() }
    }
}

impl PlanningObserver for QueryMonitor {
    fn begins(&mut self, work: Option<PlanningWork>) {
        let ended = self.work.take().map(|(ended, mut watch)| {
            let spent = watch.elapsed_since_last();
            match ended {
                PlanningWork::Roadmap => self.time.roadmap += spent,
                PlanningWork::Local => self.time.local += spent,
            }
            watch
        });
        // The same watch goes on, so that no time is lost between two kinds of work.
        self.work = work.map(|work| (work, ended.unwrap_or_else(CpuStopwatch::start)));
    }

    fn on_edges_examined(&mut self, phase: SearchPhase, lines: &mut dyn Iterator<Item = [DVec2; 2]>) {
        self.recorder.add(phase, lines);
    }
}
