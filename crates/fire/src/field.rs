//! All that can burn on a field, and what has become of it.

use std::collections::BTreeMap;
use std::ops::{Index, IndexMut, RangeInclusive};

use serde::Serialize;

use super::FireChange;
use super::cell_set::CellSet;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;

/// The state of a bush, or of a cell of ground that burns.
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
    pub fn can_ignite(self, reignition: bool) -> bool {
        self == Self::Intact || (reignition && self == Self::Extinguished)
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

wildfire_base::names! { BushStateKind {
    Intact: "intact", Burning: "burning", BurnedOut: "burned out", Extinguished: "extinguished",
} }

/// A cell that can burn or could once, and what has become of it.
#[derive(Clone, Copy, Debug)]
struct FieldCell {
    /// When it last caught fire.
    ignited: SimTime,
    /// How often it has caught fire.
    episode: u32,
    /// `None` where nothing grows that burns.
    kind: Option<BushStateKind>,
    is_bush: bool,
    /// True if somebody lit it when it last caught fire.
    is_source: bool,
}

/// The cells on which something grows, found by their index in the field. A large field is mostly bare.
#[derive(Clone, Debug)]
struct FuelCells {
    /// For every 64 cells of the field: which of them have fuel, and how many with fuel come before.
    places: Vec<(u64, u32)>,
    cells: Vec<FieldCell>,
    bare: FieldCell,
}

impl FuelCells {
    fn bare(bare: FieldCell) -> Self {
        Self { places: Vec::new(), cells: Vec::new(), bare }
    }

    /// Makes room for all that has fuel; what had room keeps its state.
    fn make_room(&mut self, fuel: &CellSet, cell_count: usize) {
        let mut grown = Self::bare(self.bare);
        grown.places = vec![(0, 0); cell_count.div_ceil(64)];
        grown.cells = Vec::with_capacity(fuel.iter().len());
        for index in fuel.iter() {
            grown.places[index / 64].0 |= 1 << (index % 64);
            grown.cells.push(self[index]);
        }
        // A rank index, so that `place` counts the bits of one word only.
        let mut before = 0;
        for (bits, first) in &mut grown.places {
            *first = before;
            before += bits.count_ones();
        }
        *self = grown;
    }

    fn place(&self, index: usize) -> Option<usize> {
        let &(bits, first) = self.places.get(index / 64)?;
        let bit = 1 << (index % 64);
        (bits & bit != 0).then(|| first as usize + (bits & (bit - 1)).count_ones() as usize)
    }
}

impl Index<usize> for FuelCells {
    type Output = FieldCell;

    fn index(&self, index: usize) -> &FieldCell {
        self.place(index).map_or(&self.bare, |place| &self.cells[place])
    }
}

impl IndexMut<usize> for FuelCells {
    fn index_mut(&mut self, index: usize) -> &mut FieldCell {
        let place = self.place(index).expect("only what can burn changes");
        &mut self.cells[place]
    }
}

/// All that can burn on a field: bushes, and where there is a landscape, the ground between them.
#[derive(Clone, Debug)]
pub struct FireField {
    frame: FieldFrame,
    /// Whether what was extinguished can burn again.
    reignition: bool,
    /// By cell index; where nothing grows that burns it is nothing's.
    cells: FuelCells,
    /// All that can burn or could once.
    fuel: CellSet,
    /// Intact, or extinguished where that can burn again; wet or not.
    flammable: CellSet,
    burning: CellSet,
    /// Cell indices of what is wet, and until when. Trucks wet a few cells at a time.
    wet: BTreeMap<u32, SimTime>,
}

impl FireField {
    /// Creates a field on which all `bushes` are intact, and nothing else burns.
    pub fn new(frame: FieldFrame, bushes: &[Cell], reignition: bool) -> Self {
        let bare = FieldCell { ignited: SimTime::ZERO, episode: 0, kind: None, is_bush: false, is_source: false };
        let count = frame.cell_count();
        let mut field = Self {
            frame,
            reignition,
            cells: FuelCells::bare(bare),
            fuel: CellSet::new(count),
            flammable: CellSet::new(count),
            burning: CellSet::new(count),
            wet: BTreeMap::new(),
        };
        field.add(bushes.iter().copied(), true);
        field
    }

    /// Adds ground that burns, in cells without a bush; cells with one stay bushes.
    #[must_use]
    pub fn with_ground(mut self, ground: impl IntoIterator<Item = Cell>) -> Self {
        self.add(ground, false);
        self
    }

    /// Adds cells on which something grows, all intact; those that have something already stay as they are.
    fn add(&mut self, cells: impl IntoIterator<Item = Cell>, are_bushes: bool) {
        let mut added = Vec::new();
        for cell in cells {
            let index = self.frame.index(cell);
            if !self.fuel.contains(index) {
                self.fuel.insert(index);
                self.flammable.insert(index);
                added.push(index);
            }
        }
        if added.is_empty() {
            return;
        }
        // Once for all, as it copies every cell that is there.
        self.cells.make_room(&self.fuel, self.frame.cell_count());
        for index in added {
            self.cells[index].kind = Some(BushStateKind::Intact);
            self.cells[index].is_bush = are_bushes;
        }
    }

    pub fn frame(&self) -> &FieldFrame {
        &self.frame
    }

    /// Returns what has become of a cell; `None` if nothing grows there that burns.
    pub fn state(&self, cell: Cell) -> Option<BushState> {
        let FieldCell { kind, ignited, .. } = self.cells[self.frame.index(cell)];
        Some(match kind? {
            BushStateKind::Intact => BushState::Intact,
            BushStateKind::Burning => BushState::Burning { since: ignited },
            BushStateKind::BurnedOut => BushState::BurnedOut,
            BushStateKind::Extinguished => BushState::Extinguished,
        })
    }

    /// Returns what has become of a cell, without its time.
    pub fn kind(&self, cell: Cell) -> Option<BushStateKind> {
        self.cells[self.frame.index(cell)].kind
    }

    /// Returns true if a bush grows in the cell, false on ground, burning or bare.
    pub fn is_bush(&self, cell: Cell) -> bool {
        self.cells[self.frame.index(cell)].is_bush
    }

    /// Returns when a cell that burns or has burned out caught fire.
    pub fn ignited_at(&self, cell: Cell) -> Option<SimTime> {
        let FieldCell { kind, ignited, .. } = self.cells[self.frame.index(cell)];
        matches!(kind, Some(BushStateKind::Burning | BushStateKind::BurnedOut)).then_some(ignited)
    }

    /// Returns when a cell last caught fire, whatever became of it.
    pub fn last_ignited(&self, cell: Cell) -> Option<SimTime> {
        let FieldCell { episode, ignited, .. } = self.cells[self.frame.index(cell)];
        (episode > 0).then_some(ignited)
    }

    pub fn can_burn(&self, cell: Cell) -> bool {
        let can_ignite = match self.kind(cell) {
            Some(BushStateKind::Intact) => true,
            Some(BushStateKind::Extinguished) => self.reignition,
            _ => false,
        };
        can_ignite && !self.is_wet(cell)
    }

    pub fn is_burning(&self, cell: Cell) -> bool {
        self.kind(cell) == Some(BushStateKind::Burning)
    }

    pub fn is_wet(&self, cell: Cell) -> bool {
        !self.wet.is_empty() && self.wet.contains_key(&(self.frame.index(cell) as u32))
    }

    /// Returns until when a cell is wet, if it is.
    pub fn wet_until(&self, cell: Cell) -> Option<SimTime> {
        self.wet.get(&(self.frame.index(cell) as u32)).copied()
    }

    /// Returns true if what was extinguished can burn again.
    pub fn allows_reignition(&self) -> bool {
        self.reignition
    }

    /// Returns true if somebody lit the cell when it last caught fire, and it did not catch fire from another one.
    pub fn is_source(&self, cell: Cell) -> bool {
        self.cells[self.frame.index(cell)].is_source
    }

    /// Returns the number that tells a cell's last burning from its earlier ones.
    pub fn episode(&self, cell: Cell) -> u32 {
        self.cells[self.frame.index(cell)].episode
    }

    /// Returns true if that very burning still goes on.
    pub fn goes_on(&self, cell: Cell, episode: u32) -> bool {
        self.is_burning(cell) && self.episode(cell) == episode
    }

    /// Iterates by cell index over all that can burn or could once: bushes, and ground with fuel.
    pub fn with_fuel(&self) -> impl ExactSizeIterator<Item = Cell> + '_ {
        self.fuel.iter().map(|index| self.frame.cell(index))
    }

    /// Iterates over burning cells by cell index.
    pub fn burning(&self) -> impl ExactSizeIterator<Item = Cell> + '_ {
        self.burning.iter().map(|index| self.frame.cell(index))
    }

    /// Iterates by cell index over what is left to burn, wet or dry.
    pub fn flammable(&self) -> impl ExactSizeIterator<Item = Cell> + '_ {
        self.flammable.iter().map(|index| self.frame.cell(index))
    }

    /// Iterates by cell index over what is left to burn, wet or dry, of a piece of a row of cells.
    pub fn flammable_in_row(&self, row: u16, cols: RangeInclusive<u16>) -> impl Iterator<Item = Cell> + '_ {
        let first = self.frame.index(Cell { col: *cols.start(), row });
        let end = self.frame.index(Cell { col: *cols.end(), row }) + 1;
        self.flammable.within(first, end).map(|index| self.frame.cell(index))
    }

    /// Sets a cell on fire; `is_source` if somebody lit it, not another cell. Returns `None` if it cannot burn.
    pub fn ignite(&mut self, cell: Cell, now: SimTime, is_source: bool) -> Option<FireChange> {
        if !self.can_burn(cell) {
            return None;
        }
        let index = self.frame.index(cell);
        self.flammable.remove(index);
        self.burning.insert(index);
        let burning = &mut self.cells[index];
        burning.kind = Some(BushStateKind::Burning);
        burning.ignited = now;
        burning.is_source = is_source;
        burning.episode += 1;
        Some(FireChange::Ignited { cell, is_source })
    }

    /// Ends a fire by suppression.
    pub fn extinguish(&mut self, cell: Cell) -> FireChange {
        self.end_burning(cell, BushStateKind::Extinguished);
        if self.reignition {
            self.flammable.insert(self.frame.index(cell));
        }
        FireChange::Extinguished { cell }
    }

    /// Ends a fire because nothing is left to burn.
    pub fn burn_out(&mut self, cell: Cell) -> FireChange {
        self.end_burning(cell, BushStateKind::BurnedOut);
        FireChange::BurnedOut { cell }
    }

    /// Wets a cell that is left to burn. Returns `None` for others, and where that would end no later than before.
    pub fn wet(&mut self, cell: Cell, until: SimTime) -> Option<FireChange> {
        let is_left = match self.kind(cell) {
            Some(BushStateKind::Intact) => true,
            Some(BushStateKind::Extinguished) => self.reignition,
            _ => false,
        };
        if !is_left || self.wet_until(cell).is_some_and(|so_far| so_far >= until) {
            return None;
        }
        self.wet.insert(self.frame.index(cell) as u32, until);
        Some(FireChange::Wetted { cell, until })
    }

    /// Dries a cell at the time at which its wetness ends. Returns `None` if it was wetted again meanwhile.
    pub fn dry(&mut self, cell: Cell, now: SimTime) -> Option<FireChange> {
        let index = self.frame.index(cell) as u32;
        (self.wet.get(&index) == Some(&now)).then(|| {
            self.wet.remove(&index);
            FireChange::Dried { cell }
        })
    }

    /// Clears a cell that is left to burn: it is wet for good. Returns `None` for others.
    pub fn clear(&mut self, cell: Cell) -> Option<FireChange> {
        self.wet(cell, SimTime::MAX)
    }

    fn end_burning(&mut self, cell: Cell, kind: BushStateKind) {
        let index = self.frame.index(cell);
        assert!(self.is_burning(cell), "only a burning cell stops burning");
        self.burning.remove(index);
        self.cells[index].kind = Some(kind);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_burns_once_unless_extinguished_ones_can_burn_again() {
        let frame = FieldFrame { cols: 3, rows: 3, cell_m: 5.0 };
        let cell = Cell { col: 1, row: 1 };
        for reignition in [false, true] {
            let mut fires = FireField::new(frame, &[cell], reignition);
            assert_eq!(fires.ignite(cell, SimTime::ZERO, true), Some(FireChange::Ignited { cell, is_source: true }));
            let first = fires.episode(cell);
            assert_eq!(fires.ignite(cell, SimTime::ZERO, true), None, "it burns already");
            fires.extinguish(cell);
            assert!(!fires.goes_on(cell, first));
            let again = fires.ignite(cell, SimTime::from_seconds(1.0), true);
            assert_eq!(again.is_some(), reignition);
            assert!(!fires.goes_on(cell, first), "another burning is not the first");
            if reignition {
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

    #[test]
    fn a_wet_cell_cannot_burn_until_it_is_dry() {
        let frame = FieldFrame { cols: 3, rows: 1, cell_m: 5.0 };
        let bush = Cell { col: 0, row: 0 };
        let ground = Cell { col: 1, row: 0 };
        let bare = Cell { col: 2, row: 0 };
        let mut fires = FireField::new(frame, &[bush], false).with_ground([ground]);
        assert!(fires.is_bush(bush) && !fires.is_bush(ground));
        let soon = SimTime::from_seconds(10.0);
        let later = SimTime::from_seconds(20.0);
        assert_eq!(fires.wet(bare, soon), None);
        assert_eq!(fires.wet(ground, soon), Some(FireChange::Wetted { cell: ground, until: soon }));
        assert_eq!(fires.wet(ground, soon), None, "it is wet for as long already");
        assert!(fires.wet(ground, later).is_some());
        assert_eq!(fires.ignite(ground, SimTime::ZERO, false), None);
        assert_eq!(fires.dry(ground, soon), None, "it was wetted again");
        assert_eq!(fires.dry(ground, later), Some(FireChange::Dried { cell: ground }));
        assert!(fires.ignite(ground, later, false).is_some());
        assert_eq!(fires.wet(ground, SimTime::from_seconds(30.0)), None, "water on a fire is a matter of dwelling");
    }
}
