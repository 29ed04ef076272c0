//! What happened to cells, bushes and ground alike, in order of time and cell by cell.

use super::{Violation, ViolationKind};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_timeline::{AgentId, Cause, Event, Fact, FireFact, GroundEvent, GroundFact, Setting, Timeline};

/// A change of a bush or of ground, whichever list of the timeline it is from.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    pub time: SimTime,
    pub cell: Cell,
    pub what: ChangeKind,
}

/// A change of a cell.
#[derive(Clone, Copy, Debug)]
pub enum ChangeKind {
    Ignited(Cause),
    BurnedOut,
    Extinguished { by: AgentId },
    Wetted { until: SimTime, by: AgentId },
    Cleared { holds: bool },
}

impl Change {
    fn from_fact(event: &Event) -> Option<Self> {
        let Fact::Fire(fact) = event.fact else { return None };
        let what = match fact {
            FireFact::Ignited { cause, .. } => ChangeKind::Ignited(cause),
            FireFact::BurnedOut { .. } => ChangeKind::BurnedOut,
            FireFact::Extinguished { by, .. } => ChangeKind::Extinguished { by },
        };
        Some(Self { time: event.time, cell: fact.cell(), what })
    }

    fn from_ground(event: &GroundEvent) -> Self {
        let what = match event.fact {
            GroundFact::Ignited(cause) => ChangeKind::Ignited(cause),
            GroundFact::Extinguished { by } => ChangeKind::Extinguished { by },
            GroundFact::Wetted { until, by } => ChangeKind::Wetted { until, by },
            GroundFact::Cleared { holds, .. } => ChangeKind::Cleared { holds },
        };
        Self { time: event.time, cell: event.cell, what }
    }

    fn agent(&self) -> Option<AgentId> {
        match self.what {
            ChangeKind::Ignited(Cause::Agent(by)) | ChangeKind::Extinguished { by } | ChangeKind::Wetted { by, .. } => {
                Some(by)
            }
            ChangeKind::Ignited(_) | ChangeKind::BurnedOut | ChangeKind::Cleared { .. } => None,
        }
    }

    pub fn violation(&self, setting: &Setting, kind: ViolationKind) -> Violation {
        Violation { time: self.time, agent: self.agent(), place: setting.frame.centre(self.cell), kind }
    }
}

/// Merges what happened to bushes and to ground in order of time.
pub fn changes_in_order(timeline: &Timeline) -> Vec<Change> {
    let mut changes: Vec<Change> = timeline.ground.iter().map(Change::from_ground).collect();
    changes.extend(timeline.events.iter().filter_map(Change::from_fact));
    // Both are in order of time, and the sort is stable.
    changes.sort_by_key(|change| change.time);
    changes
}

/// The changes of a run by the cells that they are of.
#[derive(Debug)]
pub struct CellLog<'a> {
    setting: &'a Setting,
    /// By cell index, then in their order.
    changes: Vec<Change>,
}

impl<'a> CellLog<'a> {
    pub fn new(setting: &'a Setting, changes: &[Change]) -> Self {
        let mut changes = changes.to_vec();
        // A stable sort, so that the changes of a cell keep their order.
        changes.sort_by_key(|change| setting.frame.index(change.cell));
        Self { setting, changes }
    }

    /// Iterates over the changes of each cell that has any.
    pub fn cells(&self) -> impl Iterator<Item = &[Change]> {
        self.changes.chunk_by(|one, other| one.cell == other.cell)
    }

    pub fn of_cell(&self, cell: Cell) -> &[Change] {
        let frame = self.setting.frame;
        let index = frame.index(cell);
        let from = self.changes.partition_point(|change| frame.index(change.cell) < index);
        let count = self.changes[from..].partition_point(|change| change.cell == cell);
        &self.changes[from..from + count]
    }

    /// Says whether a cell could burn at a time, for certain, and did not catch fire by then.
    pub fn is_spared(&self, cell: Cell, time: SimTime) -> bool {
        if !self.setting.is_ground(cell) && self.setting.bush_index(cell).is_none() {
            return false;
        }
        let mut is_left = true;
        for change in self.of_cell(cell).iter().take_while(|change| change.time <= time) {
            match change.what {
                ChangeKind::Ignited(_) => is_left = false,
                // Put out at that very instant, it may not have been able to burn when the fire came.
                ChangeKind::Extinguished { .. } => is_left = self.setting.rules.reignition && change.time < time,
                ChangeKind::Wetted { until, .. } if until >= time => return false,
                ChangeKind::Cleared { holds: true } => return false,
                ChangeKind::Wetted { .. } | ChangeKind::Cleared { .. } | ChangeKind::BurnedOut => {}
            }
        }
        is_left
    }
}
