//! A fire by itself, without agents: which cell it reaches when, and from where.

use std::sync::Arc;

use super::models::{Rothermel, RothermelRules};
use super::surface::crown::FireType;
use super::{FireField, Landscape, Spread, Weather};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;

/// A fire on a landscape that nobody fights.
#[derive(Clone, Debug)]
pub struct LoneFire {
    fires: FireField,
    model: Rothermel,
    /// What is to be lit, the last first.
    ignitions: Vec<(SimTime, Cell)>,
    /// By cell index: the cell that the fire came from; the cell itself where it was lit.
    parents: Vec<u32>,
    /// What catches fire at one instant.
    spreads: Vec<Spread>,
}

impl LoneFire {
    /// The most bytes that a fire takes with its landscape, by cell: 41 were measured where every cell has a slope of its
    /// own, 31 on a plane.
    const BYTES_A_CELL: u64 = 48;

    /// Bounds the memory of a fire on a field and of its landscape.
    pub fn max_bytes(frame: &FieldFrame) -> u64 {
        Self::BYTES_A_CELL * frame.cell_count() as u64
    }

    /// Creates a fire that begins in cells at times. Cells that cannot burn then are passed over.
    pub fn new(
        landscape: Arc<Landscape>,
        weather: Arc<Weather>,
        rules: RothermelRules,
        ignitions: &[(SimTime, Cell)],
    ) -> Self {
        let frame = landscape.frame;
        let burns = landscape.burning_numbers();
        let fuels = landscape.fuel.iter().enumerate().filter(|&(_, &fuel)| burns[usize::from(fuel)]);
        let fires = FireField::new(frame, &[], false).with_ground(fuels.map(|(index, _)| frame.cell(index)));
        let mut ignitions = ignitions.to_vec();
        ignitions.sort_unstable_by_key(|&(time, cell)| std::cmp::Reverse((time, frame.index(cell))));
        let parents = vec![u32::MAX; frame.cell_count()];
        Self { fires, model: Rothermel::new(landscape, weather, rules), ignitions, parents, spreads: Vec::new() }
    }

    /// Lets the fire burn until a time, that instant included. Times between do not matter: an hour in pieces is the same
    /// hour.
    pub fn burn_until(&mut self, until: SimTime) {
        loop {
            let ignition = self.ignitions.last().map(|&(time, _)| time);
            let arrival = self.model.next_arrival();
            let Some(now) = ignition.into_iter().chain(arrival).min().filter(|&now| now <= until) else { return };
            while let Some((_, cell)) = self.ignitions.pop_if(|&mut (time, _)| time == now) {
                self.ignite(now, cell, cell);
            }
            // Taken out, as `ignite` borrows all of `self`, and put back for its memory.
            let mut spreads = std::mem::take(&mut self.spreads);
            self.model.take_due(now, &mut spreads);
            for Spread { cell, from, .. } in spreads.drain(..) {
                self.ignite(now, cell, from);
            }
            self.spreads = spreads;
        }
    }

    fn ignite(&mut self, now: SimTime, cell: Cell, from: Cell) {
        if let Some(change) = self.fires.ignite(cell, now, cell == from) {
            let frame = *self.fires.frame();
            self.parents[frame.index(cell)] = frame.index(from) as u32;
            self.model.apply(&self.fires, now, change);
        }
    }

    /// Clears a cell that has not caught fire at a time up to which the fire has burned.
    pub fn clear(&mut self, now: SimTime, cell: Cell) {
        if let Some(change) = self.fires.clear(cell) {
            self.model.apply(&self.fires, now, change);
        }
    }

    /// Returns when a cell caught fire.
    pub fn arrival(&self, cell: Cell) -> Option<SimTime> {
        self.fires.ignited_at(cell)
    }

    /// Returns the kind of fire that came to a cell with trees; without trees it is a surface fire, and `None` where nothing
    /// burned.
    pub fn fire_type(&mut self, cell: Cell) -> Option<FireType> {
        let time = self.arrival(cell)?;
        Some(self.model.fire_type(cell, time).unwrap_or(FireType::Surface))
    }

    /// Returns the cell from which the fire came to one, the cell itself if it was lit; `None` where nothing burned.
    pub fn parent(&self, cell: Cell) -> Option<Cell> {
        let frame = self.fires.frame();
        let parent = self.parents[frame.index(cell)];
        (parent != u32::MAX).then(|| frame.cell(parent as usize))
    }

    /// Returns all that can burn and what has become of it.
    pub fn fires(&self) -> &FireField {
        &self.fires
    }

    /// Returns when fire reached a cell, or is going to if nothing changes; `None` where it will not, or is still too far
    /// away to say.
    pub fn expected_arrival(&self, cell: Cell) -> Option<SimTime> {
        self.arrival(cell).or_else(|| self.model.planned_arrival(cell))
    }

    /// Returns the time of the next arrival, if any is to come.
    pub fn next_arrival(&mut self) -> Option<SimTime> {
        self.model.next_arrival()
    }
}
