//! Water by the heat of fire: the litres that each burning cell takes, from its ignition on.

use std::collections::BTreeMap;

use bevy_ecs::prelude::*;

use super::queue::CellEvent;
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_fire::FireField;
use wildfire_timeline::{SpreadSetting, WaterEnergy, WaterRules};

/// The water that fires take in a run in which their heat matters.
#[derive(Resource, Clone, Debug)]
pub struct WaterNeeds {
    spread: SpreadSetting,
    energy: WaterEnergy,
    /// By burning cell.
    litres: BTreeMap<Cell, f64>,
}

impl WaterNeeds {
    /// Returns the needs before anything burns; `None` where all stops take the same.
    pub fn new(water: Option<&WaterRules>, spread: Option<&SpreadSetting>) -> Option<Self> {
        let energy = water?.energy?;
        let spread = spread?.clone();
        Some(Self { spread, energy, litres: BTreeMap::new() })
    }

    /// Takes in what became of a cell.
    pub fn follow(&mut self, event: CellEvent, now: SimTime, fires: &FireField) {
        match event {
            CellEvent::Ignite { cell, cause } => {
                let front = self.spread.front(cell, now, cause, |near| fires.last_ignited(near));
                let litres = front.map_or(0.0, |front| self.energy.litres(front, fires.frame().cell_m));
                self.litres.insert(cell, litres);
            }
            CellEvent::Extinguish { cell, .. } | CellEvent::BurnOut { cell } => drop(self.litres.remove(&cell)),
            CellEvent::Wet { .. } | CellEvent::Dry { .. } | CellEvent::Clear { .. } => {}
        }
    }

    /// Returns the litres that a burning cell takes; infinite if it is too hot.
    pub fn litres(&self, cell: Cell) -> f64 {
        self.litres.get(&cell).copied().unwrap_or_default()
    }

    /// Returns the portions that it takes by itself.
    pub fn water_units(&self, cell: Cell) -> u32 {
        self.energy.water_units(self.litres(cell))
    }

    /// Chooses the cells that a stop puts out with some portions: its goal, then others in their order as far as the water
    /// lasts.
    pub fn plan_stop(&self, goal: Cell, others: impl IntoIterator<Item = Cell>, left: u32) -> StopPlan {
        let (mut cells, mut litres) = (Vec::new(), 0.0);
        for cell in std::iter::once(goal).chain(others) {
            let with = litres + self.litres(cell);
            // One that takes less may still fit after one that does not.
            if self.energy.water_units(with) <= left {
                litres = with;
                cells.push(cell);
            }
        }
        StopPlan { cells, water_units: self.energy.water_units(litres) }
    }
}

/// The cells that a stop puts out, and the portions that it takes.
#[derive(Debug)]
pub struct StopPlan {
    pub cells: Vec<Cell>,
    pub water_units: u32,
}
