#![doc = include_str!("../README.md")]
//!
//! The state of every cell that can burn, and models of the spread of fire between them.
//!
//! A [`FireField`] holds the states of bushes and ground. A [`FireModel`] predicts their changes: after each change of a cell
//! it forecasts arrivals of the fire and burn-outs, and when an arrival is due it determines which cells catch fire. Neither
//! keeps the time. The caller applies changes one by one, notifies the model of each, and returns each forecast when it is
//! due; an outdated forecast is recognised by its episode or revision and has no effect.

mod cell_set;
pub mod chance;
pub mod contain;
pub mod embers;
mod field;
pub mod fine_moisture;
pub mod fuel;
mod landscape;
pub mod line;
pub mod lone;
pub mod models;
pub mod nelson;
pub mod spotting;
pub mod surface;
pub mod water;
mod weather;

use std::fmt;

use dyn_clone::DynClone;
use serde::{Deserialize, Serialize};

pub use field::{BushState, BushStateKind, FireField};
pub use landscape::{CanopyLayers, Landscape, RATE_FACTORS, RATE_PARTS, Relief};
pub use weather::{MoistureZones, Weather, WeatherInterval, WeatherTableError, WindField};

use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;

/// How fire behaves under the rule of the radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FireRules {
    /// From ignition to spreading.
    pub spread_delay: SimTime,
    /// In metres between cell centres, inclusive.
    pub spread_radius_m: f64,
    /// Whether cells that were lit spread, and whether cells that caught fire from others do.
    #[serde(rename = "lit_spreads")]
    pub sources_spread: bool,
    pub caught_spreads: bool,
    /// From ignition to burned out; `None` burns forever.
    pub burn_out: Option<SimTime>,
    /// Whether extinguished cells can burn again.
    #[serde(rename = "relight")]
    pub reignition: bool,
}

/// A change of one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FireChange {
    /// It caught fire; `is_source` if somebody lit it, not another cell.
    Ignited {
        cell: Cell,
        is_source: bool,
    },
    Extinguished {
        cell: Cell,
    },
    BurnedOut {
        cell: Cell,
    },
    /// A truck wets it, so that it cannot burn until then.
    Wetted {
        cell: Cell,
        until: SimTime,
    },
    /// It is wet no longer.
    Dried {
        cell: Cell,
    },
}

impl FireChange {
    pub fn cell(self) -> Cell {
        match self {
            Self::Ignited { cell, .. }
            | Self::Extinguished { cell }
            | Self::BurnedOut { cell }
            | Self::Wetted { cell, .. }
            | Self::Dried { cell } => cell,
        }
    }
}

/// The fire gets somewhere, if nothing has changed by then.
///
/// Both fields are the model's own: one that spreads all around at once may name the burning cell and its episode, one
/// that follows a front the cell that the front reaches and the revision of its plan for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    pub cell: Cell,
    pub revision: u32,
}

/// Something that a model expects of the fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FireEvent {
    /// The model is to be asked what catches fire.
    Arrival(Arrival),
    /// The cell is burned out if that burning still goes on, see [`FireField::goes_on`].
    BurnOut { cell: Cell, episode: u32 },
    /// The cell is dry if it has not been wetted again, see [`FireField::dry`].
    Dry { cell: Cell },
}

/// The way by which fire gets from one cell to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpreadBy {
    /// The front of the fire.
    Front,
    /// An ember that the wind has carried.
    Ember,
}

/// A cell that catches fire from another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spread {
    pub cell: Cell,
    pub from: Cell,
    pub by: SpreadBy,
}

/// Events that are expected, with their times.
pub type FireEvents = Vec<(SimTime, FireEvent)>;

/// A rule of how fire goes from cell to cell.
///
/// A model draws chance, if it does, from the run's seed, the cell and its episode, so that the order of events at one
/// instant cannot matter.
pub trait FireModel: fmt::Debug + DynClone + Send + Sync {
    /// Takes in a change that `fires` has just been through, and adds to `expected` what follows from it and when. To
    /// void an arrival the model forgets its revision.
    fn follow(&mut self, fires: &FireField, now: SimTime, change: FireChange, expected: &mut FireEvents);

    /// Returns what a due arrival sets on fire, in this order; nothing if it is void. Cells that cannot burn by the time
    /// their turn comes are passed over.
    fn arrive(&mut self, fires: &FireField, now: SimTime, arrival: Arrival, expected: &mut FireEvents) -> Vec<Spread>;

    /// Returns true if fire may still get somewhere though nothing burns: a front between the cells that it has left and
    /// those that it has not reached.
    fn is_under_way(&self) -> bool {
        false
    }

    /// Draws what chance decides from now on by another seed.
    fn reseed(&mut self, _seed: u64) {}
}

dyn_clone::clone_trait_object!(FireModel);

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::event_queue::EventQueue;
    use wildfire_base::geometry::FieldFrame;

    const FRAME: FieldFrame = FieldFrame { cols: 9, rows: 1, cell_m: 5.0 };

    fn cell(col: u16) -> Cell {
        Cell { col, row: 0 }
    }

    /// Fire on a row of bushes, driven by a wind from the west: a front needs 10 s to the next cell in the east and
    /// 30 s to the one in the west. Every cell has at most one arrival that counts.
    #[derive(Clone, Debug, Default)]
    struct Front {
        /// By column: the revision that counts, and the plan that it stands for.
        plans: [(u32, Option<(SimTime, Cell)>); 9],
    }

    impl Front {
        /// Plans the earliest arrival at a cell over what burns beside it.
        fn plan(&mut self, fires: &FireField, now: SimTime, to: Cell, expected: &mut FireEvents) {
            let ways = [(to.col.checked_sub(1), 10.0), (Some(to.col + 1).filter(|&col| col < FRAME.cols), 30.0)];
            let arrivals = ways.into_iter().filter_map(|(col, seconds)| {
                let Some(BushState::Burning { since }) = fires.state(cell(col?)) else { return None };
                Some(((since + SimTime::from_seconds(seconds)).max(now), cell(col?)))
            });
            let best = arrivals.min_by_key(|&(time, _)| time);
            let (revision, plan) = &mut self.plans[usize::from(to.col)];
            if *plan != best {
                *revision += 1;
                *plan = best;
                let arrival = FireEvent::Arrival(Arrival { cell: to, revision: *revision });
                expected.extend(best.map(|(time, _)| (time, arrival)));
            }
        }
    }

    impl FireModel for Front {
        fn follow(&mut self, fires: &FireField, now: SimTime, change: FireChange, expected: &mut FireEvents) {
            let col = change.cell().col;
            for near in [col.checked_sub(1), Some(col + 1).filter(|&col| col < FRAME.cols)].into_iter().flatten() {
                if fires.can_burn(cell(near)) {
                    self.plan(fires, now, cell(near), expected);
                }
            }
        }

        fn arrive(&mut self, _: &FireField, _: SimTime, arrival: Arrival, _: &mut FireEvents) -> Vec<Spread> {
            let (revision, plan) = self.plans[usize::from(arrival.cell.col)];
            let (_, from) = plan.filter(|_| revision == arrival.revision).unzip();
            from.map(|from| Spread { cell: arrival.cell, from, by: SpreadBy::Front }).into_iter().collect()
        }
    }

    enum Act {
        Light(Cell),
        Extinguish(Cell),
        Forecast(FireEvent),
    }

    /// Lights and extinguishes at these seconds and returns the second at which each column caught fire.
    fn burn(acts: Vec<(f64, Act)>) -> [Option<f64>; 9] {
        let bushes: Vec<Cell> = (0..FRAME.cols).map(cell).collect();
        let mut fires = FireField::new(FRAME, &bushes, false);
        let mut model = Front::default();
        let mut queue = EventQueue::default();
        for (seconds, act) in acts {
            queue.push(SimTime::from_seconds(seconds), 0, act);
        }
        let mut caught = [None; 9];
        while let Some((now, _)) = queue.peek() {
            let mut expected = Vec::new();
            let changes: Vec<FireChange> = match queue.pop_due(now, 0).expect("it was just seen") {
                Act::Light(cell) => fires.ignite(cell, now, true).into_iter().collect(),
                Act::Extinguish(cell) => vec![fires.extinguish(cell)],
                Act::Forecast(FireEvent::Arrival(arrival)) => {
                    let spread = model.arrive(&fires, now, arrival, &mut expected);
                    spread.into_iter().filter_map(|spread| fires.ignite(spread.cell, now, false)).collect()
                }
                Act::Forecast(FireEvent::BurnOut { .. } | FireEvent::Dry { .. }) => {
                    unreachable!("these fires burn forever, and nobody wets them")
                }
            };
            for change in changes {
                if let FireChange::Ignited { cell, .. } = change {
                    caught[usize::from(cell.col)] = Some(now.as_seconds());
                }
                model.follow(&fires, now, change, &mut expected);
            }
            for (time, event) in expected {
                queue.push(time, 0, Act::Forecast(event));
            }
        }
        caught
    }

    #[test]
    fn a_front_reaches_every_cell_by_its_fastest_way() {
        let west = burn(vec![(0.0, Act::Light(cell(0)))]);
        assert_eq!(west, [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0].map(Some));
        // From the east it takes longer, and the fire in the west gets there first.
        let both = burn(vec![(0.0, Act::Light(cell(0))), (5.0, Act::Light(cell(8)))]);
        assert_eq!(both, [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 35.0, 5.0].map(Some));
    }

    #[test]
    fn arrivals_from_what_is_extinguished_are_void_and_planned_again_from_what_still_burns() {
        // The front stands in column 3 at 30 s and would reach column 4 at 40 s.
        let alone = burn(vec![(0.0, Act::Light(cell(0))), (35.0, Act::Extinguish(cell(3)))]);
        assert_eq!(alone, [Some(0.0), Some(10.0), Some(20.0), Some(30.0), None, None, None, None, None]);
        // Column 5 burns since 32 s, so that column 4 now catches fire from there, 30 s later.
        let between = vec![(0.0, Act::Light(cell(0))), (32.0, Act::Light(cell(5))), (35.0, Act::Extinguish(cell(3)))];
        assert_eq!(burn(between)[3..6], [Some(30.0), Some(62.0), Some(32.0)]);
    }
}
