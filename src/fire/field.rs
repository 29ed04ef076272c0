//! The bushes of a field and what has become of them.

use serde::Serialize;

use super::FireChange;
use crate::geometry::{Cell, FieldFrame};
use crate::time::SimTime;

/// The state of a bush.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum BushState {
    Intact,
    Burning { since: SimTime },
    BurnedOut,
    Extinguished,
}

impl BushState {
    pub fn burns(self) -> bool {
        matches!(self, Self::Burning { .. })
    }

    /// Returns true if it can catch fire, where the rules let extinguished bushes burn again or not.
    pub fn can_be_lit(self, relight: bool) -> bool {
        self == Self::Intact || (relight && self == Self::Extinguished)
    }

    pub fn kind(self) -> BushStateKind {
        match self {
            Self::Intact => BushStateKind::Intact,
            Self::Burning { .. } => BushStateKind::Burning,
            Self::BurnedOut => BushStateKind::BurnedOut,
            Self::Extinguished => BushStateKind::Extinguished,
        }
    }
}

/// The state of a bush without its time, as it is counted, coloured and named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BushStateKind {
    Intact,
    Burning,
    BurnedOut,
    Extinguished,
}

impl BushStateKind {
    pub const ALL: [Self; 4] = [Self::Intact, Self::Burning, Self::BurnedOut, Self::Extinguished];

    pub fn name(self) -> &'static str {
        match self {
            Self::Intact => "intact",
            Self::Burning => "burning",
            Self::BurnedOut => "burned out",
            Self::Extinguished => "extinguished",
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Bush {
    /// `None` where no bush grows.
    state: Option<BushState>,
    /// How often it has caught fire.
    episode: u32,
    /// Position in the list of what can burn.
    slot: u32,
}

/// The bushes of a field.
#[derive(Clone, Debug)]
pub struct FireField {
    frame: FieldFrame,
    /// Whether extinguished bushes can burn again.
    relight: bool,
    /// By cell index.
    bushes: Vec<Bush>,
    /// Cell indices of what can burn, in no order.
    flammable: Vec<u32>,
    /// Cell indices of what burns, ascending.
    burning: Vec<u32>,
}

impl FireField {
    /// Creates a field on which all `bushes` are intact.
    pub fn new(frame: FieldFrame, bushes: &[Cell], relight: bool) -> Self {
        let bare = Bush { state: None, episode: 0, slot: 0 };
        let mut cells = vec![bare; frame.cell_count()];
        let mut flammable = Vec::with_capacity(bushes.len());
        for &cell in bushes {
            let index = frame.index(cell);
            cells[index] = Bush { state: Some(BushState::Intact), slot: flammable.len() as u32, ..bare };
            flammable.push(index as u32);
        }
        Self { frame, relight, bushes: cells, flammable, burning: Vec::new() }
    }

    /// Returns the most bytes that it takes with this number of bushes.
    pub fn most_bytes(frame: &FieldFrame, bushes: u64) -> u64 {
        // Both lists of bushes may have doubled just before their end.
        frame.cell_count() as u64 * size_of::<Bush>() as u64 + bushes * 4 * size_of::<u32>() as u64
    }

    pub fn frame(&self) -> &FieldFrame {
        &self.frame
    }

    /// Returns what has become of the bush in a cell; `None` if no bush grows there.
    pub fn state(&self, cell: Cell) -> Option<BushState> {
        self.bushes[self.frame.index(cell)].state
    }

    pub fn can_burn(&self, cell: Cell) -> bool {
        self.state(cell).is_some_and(|state| state.can_be_lit(self.relight))
    }

    pub fn is_burning(&self, cell: Cell) -> bool {
        self.state(cell).is_some_and(BushState::burns)
    }

    /// Returns the number that tells a cell's last burning from its earlier ones.
    pub fn episode(&self, cell: Cell) -> u32 {
        self.bushes[self.frame.index(cell)].episode
    }

    /// Returns true if that very burning still goes on.
    pub fn goes_on(&self, cell: Cell, episode: u32) -> bool {
        self.is_burning(cell) && self.episode(cell) == episode
    }

    /// Iterates over burning cells by cell index.
    pub fn burning(&self) -> impl ExactSizeIterator<Item = Cell> + '_ {
        self.burning.iter().map(|&index| self.frame.cell(index as usize))
    }

    /// Iterates over the cells that can burn, in no order.
    pub fn flammable(&self) -> impl ExactSizeIterator<Item = Cell> + '_ {
        self.flammable.iter().map(|&index| self.frame.cell(index as usize))
    }

    /// Sets a cell on fire; `lit` by somebody, or caught from another cell. Returns `None` if it cannot burn.
    pub fn ignite(&mut self, cell: Cell, now: SimTime, lit: bool) -> Option<FireChange> {
        if !self.can_burn(cell) {
            return None;
        }
        let index = self.frame.index(cell);
        self.remove_flammable(index);
        let position = self.burning.partition_point(|&other| other < index as u32);
        self.burning.insert(position, index as u32);
        let bush = &mut self.bushes[index];
        bush.state = Some(BushState::Burning { since: now });
        bush.episode += 1;
        Some(FireChange::Ignited { cell, lit })
    }

    /// Ends a fire by suppression.
    pub fn extinguish(&mut self, cell: Cell) -> FireChange {
        self.end_burning(cell, BushState::Extinguished);
        if self.relight {
            let index = self.frame.index(cell);
            self.bushes[index].slot = self.flammable.len() as u32;
            self.flammable.push(index as u32);
        }
        FireChange::Extinguished { cell }
    }

    /// Ends a fire because nothing is left to burn.
    pub fn burn_out(&mut self, cell: Cell) -> FireChange {
        self.end_burning(cell, BushState::BurnedOut);
        FireChange::BurnedOut { cell }
    }

    fn end_burning(&mut self, cell: Cell, state: BushState) {
        let index = self.frame.index(cell);
        let position = self.burning.binary_search(&(index as u32)).expect("only a burning cell stops burning");
        self.burning.remove(position);
        self.bushes[index].state = Some(state);
    }

    fn remove_flammable(&mut self, index: usize) {
        let slot = self.bushes[index].slot as usize;
        self.flammable.swap_remove(slot);
        if let Some(&moved) = self.flammable.get(slot) {
            self.bushes[moved as usize].slot = slot as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_burns_once_unless_extinguished_ones_can_burn_again() {
        let frame = FieldFrame { cols: 3, rows: 3, cell_m: 5.0 };
        let cell = Cell { col: 1, row: 1 };
        for relight in [false, true] {
            let mut fires = FireField::new(frame, &[cell], relight);
            assert_eq!(fires.ignite(cell, SimTime::ZERO, true), Some(FireChange::Ignited { cell, lit: true }));
            let first = fires.episode(cell);
            assert_eq!(fires.ignite(cell, SimTime::ZERO, true), None, "it burns already");
            fires.extinguish(cell);
            assert!(!fires.goes_on(cell, first));
            let again = fires.ignite(cell, SimTime::from_seconds(1.0), true);
            assert_eq!(again.is_some(), relight);
            assert!(!fires.goes_on(cell, first), "another burning is not the first");
            if relight {
                fires.burn_out(cell);
                assert_eq!(fires.ignite(cell, SimTime::from_seconds(2.0), true), None);
            }
        }
    }

    #[test]
    fn nothing_burns_where_no_bush_grows() {
        let frame = FieldFrame { cols: 3, rows: 3, cell_m: 5.0 };
        let mut fires = FireField::new(frame, &[Cell { col: 1, row: 1 }], false);
        assert_eq!(fires.ignite(Cell { col: 0, row: 0 }, SimTime::ZERO, true), None);
        assert_eq!(fires.state(Cell { col: 0, row: 0 }), None);
    }
}
