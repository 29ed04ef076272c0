//! Changes of cells, bushes and ground, in one list.

use crate::{ChangedBush, RunIndex};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::BushStateKind;

/// A cell that changes its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExportedChange {
    pub time: SimTime,
    pub cell: Cell,
    pub state: BushStateKind,
}

/// Lists all changes until the end of a run in order of time; of one instant bushes first, in the order of their facts, then
/// ground by cell index.
///
/// Cells that are not in it stay intact. When ground burns out is in it, though recordings leave it to the reader.
pub fn cell_changes(index: &RunIndex<'_>) -> Vec<ExportedChange> {
    let timeline = index.timeline();
    let end = index.end_time();
    let events = timeline.events.iter().take_while(|event| event.time <= end);
    let bushes = events.filter_map(|event| {
        let ChangedBush { cell, state } = event.bush_change()?;
        Some(ExportedChange { time: event.time, cell, state: state.kind() })
    });
    let mut changes: Vec<ExportedChange> = bushes.collect();
    let Some(ground) = index.ground() else { return changes };
    let frame = timeline.setting.frame;
    for cell in (0..frame.cell_count()).map(|index| frame.cell(index)) {
        for burning in ground.burnings_of(cell) {
            let ended = if burning.is_extinguished { BushStateKind::Extinguished } else { BushStateKind::BurnedOut };
            let states = [(burning.ignited, BushStateKind::Burning), (burning.ends, ended)];
            let states = states.into_iter().filter(|(time, _)| *time <= end);
            changes.extend(states.map(|(time, state)| ExportedChange { time, cell, state }));
        }
    }
    // The sort is stable.
    changes.sort_by_key(|change| change.time);
    changes
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::sample;

    #[test]
    fn changes_lead_to_the_states_of_the_run_at_any_time() {
        for timeline in [sample::by_hand(), sample::random(5, SimTime::from_seconds(300.0)), sample::on_ground()] {
            let index = RunIndex::new(&timeline);
            let changes = cell_changes(&index);
            assert!(changes.is_sorted_by_key(|change| change.time));
            for share in [0.2, 0.5, 0.9, 1.0] {
                let time = SimTime::from_seconds(share * index.end_time().as_seconds()).min(index.end_time());
                let so_far = changes.iter().take_while(|change| change.time <= time);
                let states: BTreeMap<_, _> =
                    so_far.map(|change| ((change.cell.row, change.cell.col), change.state)).collect();
                let found = |cell: Cell| states.get(&(cell.row, cell.col)).copied().unwrap_or(BushStateKind::Intact);
                let state = index.state_at(time);
                for (&bush, expected) in timeline.setting.bushes.iter().zip(&state.bushes) {
                    assert_eq!(found(bush), expected.kind(), "{bush} at {time}");
                }
                let frame = timeline.setting.frame;
                for cell in (0..frame.cell_count()).map(|index| frame.cell(index)) {
                    if let Some(expected) = index.ground().and_then(|ground| ground.state_at(cell, time)) {
                        assert_eq!(found(cell), expected.kind(), "ground {cell} at {time}");
                    }
                }
            }
        }
    }
}
