//! What burns: the vegetation's states and the rules of spread, burn-out and suppression.
//!
//! A cell that catches fire burns until it burns out or is extinguished. Once, a set time after it caught fire and if
//! it burns still, it sets on fire what can burn within a radius. Nothing here knows the order of time: callers
//! schedule what [`Vegetation::ignite`] says is to come and ask again when it is due.

use serde::{Deserialize, Serialize};

use crate::geometry::{Cell, FieldFrame};
use crate::time::SimTime;

/// Distances between cell centres are exact multiples of the cell size; this absorbs the rounding of their product.
const RADIUS_TOLERANCE: f64 = 1e-9;

/// What a cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellState {
    /// No bush grows here.
    Bare,
    Intact,
    Burning,
    BurnedOut,
    Extinguished,
}

/// How fire behaves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FireRules {
    /// From ignition to spreading.
    pub spread_delay: SimTime,
    /// In metres between cell centres, inclusive.
    pub spread_radius_m: f64,
    /// Whether cells that were lit spread, and whether cells that caught fire from others do.
    pub lit_spreads: bool,
    pub caught_spreads: bool,
    /// From ignition to burned out; `None` burns for ever.
    pub burn_out: Option<SimTime>,
    /// Whether extinguished cells can burn again.
    pub relight: bool,
}

/// One burning of one cell, and what is due if it goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Burn {
    pub cell: Cell,
    /// Tells this burning from earlier and later ones of the same cell.
    pub episode: u32,
    pub spreads_at: Option<SimTime>,
    pub burns_out_at: Option<SimTime>,
}

#[derive(Clone, Copy, Debug)]
struct Bush {
    state: CellState,
    episode: u32,
    ignited_at: SimTime,
    /// Position in the list of what can burn.
    slot: u32,
}

/// The vegetation of a field.
#[derive(Clone, Debug)]
pub struct Vegetation {
    frame: FieldFrame,
    rules: FireRules,
    /// By cell index.
    bushes: Vec<Bush>,
    /// Cell indices of what can burn, in no order.
    flammable: Vec<u32>,
    /// Cell indices of what burns, ascending.
    burning: Vec<u32>,
    /// Column and row offsets within the spread radius, itself excluded.
    stencil: Vec<(i32, i32)>,
}

impl Vegetation {
    /// All `bushes` intact.
    pub fn new(frame: FieldFrame, bushes: &[Cell], rules: FireRules) -> Self {
        let bare = Bush { state: CellState::Bare, episode: 0, ignited_at: SimTime::ZERO, slot: 0 };
        let mut cells = vec![bare; frame.cell_count()];
        let mut flammable = Vec::with_capacity(bushes.len());
        for &cell in bushes {
            let index = frame.index(cell);
            cells[index] = Bush { state: CellState::Intact, slot: flammable.len() as u32, ..bare };
            flammable.push(index as u32);
        }
        let stencil = stencil(&frame, rules.spread_radius_m);
        Self { frame, rules, bushes: cells, flammable, burning: Vec::new(), stencil }
    }

    /// The most bytes that it takes on a field with this number of bushes.
    pub fn most_bytes(frame: &FieldFrame, bushes: u64, spread_radius_m: f64) -> u64 {
        let reach = (spread_radius_m / frame.cell_m).min(f64::from(frame.cols.max(frame.rows)));
        let across = 2 * reach as u64 + 3;
        let cells = frame.cell_count() as u64;
        // Both lists of bushes, and the stencil, in lists that double; what one fire spreads to.
        let neighbours = (across * across).min(4 * cells);
        cells * size_of::<Bush>() as u64
            + bushes * 4 * size_of::<u32>() as u64
            + 3 * neighbours * size_of::<(i32, i32)>() as u64
    }

    pub fn state(&self, cell: Cell) -> CellState {
        self.bushes[self.frame.index(cell)].state
    }

    pub fn can_burn(&self, cell: Cell) -> bool {
        self.is_flammable(self.frame.index(cell))
    }

    pub fn is_burning(&self, cell: Cell) -> bool {
        self.state(cell) == CellState::Burning
    }

    /// Whether that very burning still goes on.
    pub fn goes_on(&self, cell: Cell, episode: u32) -> bool {
        self.is_burning(cell) && self.bushes[self.frame.index(cell)].episode == episode
    }

    /// When a burning cell caught fire.
    pub fn ignited_at(&self, cell: Cell) -> SimTime {
        self.bushes[self.frame.index(cell)].ignited_at
    }

    /// Burning cells by cell index.
    pub fn burning(&self) -> impl ExactSizeIterator<Item = Cell> + '_ {
        self.burning.iter().map(|&index| self.frame.cell(index as usize))
    }

    /// How many cells can still burn.
    pub fn flammable_count(&self) -> usize {
        self.flammable.len()
    }

    /// Sets a cell on fire; `lit` by somebody, or caught from another cell. `None` if it cannot burn.
    pub fn ignite(&mut self, cell: Cell, now: SimTime, lit: bool) -> Option<Burn> {
        let index = self.frame.index(cell);
        if !self.is_flammable(index) {
            return None;
        }
        self.remove_flammable(index);
        let position = self.burning.partition_point(|&other| other < index as u32);
        self.burning.insert(position, index as u32);
        let bush = &mut self.bushes[index];
        bush.state = CellState::Burning;
        bush.episode += 1;
        bush.ignited_at = now;
        let spreads = if lit { self.rules.lit_spreads } else { self.rules.caught_spreads };
        Some(Burn {
            cell,
            episode: bush.episode,
            spreads_at: spreads.then_some(now + self.rules.spread_delay),
            burns_out_at: self.rules.burn_out.map(|span| now + span),
        })
    }

    /// What a burning cell would set on fire now, by cell index.
    pub fn within_spread(&self, from: Cell) -> Vec<Cell> {
        // Late in a run few cells can still burn, and a wide radius reaches the whole field: take the shorter list.
        if self.flammable.len() < self.stencil.len() {
            let limit = squared_radius_in_cells(&self.frame, self.rules.spread_radius_m);
            let mut caught: Vec<u32> =
                self.flammable.iter().copied().filter(|&i| self.squared_offset(from, i) <= limit).collect();
            caught.sort_unstable();
            return caught.into_iter().map(|index| self.frame.cell(index as usize)).collect();
        }
        let neighbours = self.stencil.iter().filter_map(|&(cols, rows)| self.frame.offset(from, cols, rows));
        neighbours.filter(|&cell| self.can_burn(cell)).collect()
    }

    /// Ends a fire by suppression.
    pub fn extinguish(&mut self, cell: Cell) {
        self.end_burning(cell, CellState::Extinguished);
        if self.rules.relight {
            let index = self.frame.index(cell);
            self.bushes[index].slot = self.flammable.len() as u32;
            self.flammable.push(index as u32);
        }
    }

    /// Ends a fire because nothing is left to burn.
    pub fn burn_out(&mut self, cell: Cell) {
        self.end_burning(cell, CellState::BurnedOut);
    }

    fn end_burning(&mut self, cell: Cell, state: CellState) {
        let index = self.frame.index(cell);
        let position = self.burning.binary_search(&(index as u32)).expect("only a burning cell stops burning");
        self.burning.remove(position);
        self.bushes[index].state = state;
    }

    fn is_flammable(&self, index: usize) -> bool {
        match self.bushes[index].state {
            CellState::Intact => true,
            CellState::Extinguished => self.rules.relight,
            CellState::Bare | CellState::Burning | CellState::BurnedOut => false,
        }
    }

    fn remove_flammable(&mut self, index: usize) {
        let slot = self.bushes[index].slot as usize;
        self.flammable.swap_remove(slot);
        if let Some(&moved) = self.flammable.get(slot) {
            self.bushes[moved as usize].slot = slot as u32;
        }
    }

    fn squared_offset(&self, from: Cell, index: u32) -> f64 {
        let to = self.frame.cell(index as usize);
        let (cols, rows) = (f64::from(to.col) - f64::from(from.col), f64::from(to.row) - f64::from(from.row));
        cols * cols + rows * rows
    }
}

fn squared_radius_in_cells(frame: &FieldFrame, radius_m: f64) -> f64 {
    let cells = radius_m / frame.cell_m;
    cells * cells * (1.0 + RADIUS_TOLERANCE)
}

/// Offsets within the radius in the order of cell index, no farther than the field is wide.
fn stencil(frame: &FieldFrame, radius_m: f64) -> Vec<(i32, i32)> {
    let limit = squared_radius_in_cells(frame, radius_m);
    let reach = limit.sqrt().floor();
    let cols = reach.min(f64::from(frame.cols) - 1.0) as i32;
    let rows = reach.min(f64::from(frame.rows) - 1.0) as i32;
    let offsets = (-rows..=rows).flat_map(|row| (-cols..=cols).map(move |col| (col, row)));
    offsets.filter(|&(col, row)| (col, row) != (0, 0) && f64::from(col * col + row * row) <= limit).collect()
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    const FRAME: FieldFrame = FieldFrame { cols: 30, rows: 20, cell_m: 5.0 };

    fn rules() -> FireRules {
        FireRules {
            spread_delay: SimTime::from_seconds(10.0),
            spread_radius_m: 30.0,
            lit_spreads: true,
            caught_spreads: false,
            burn_out: Some(SimTime::from_seconds(60.0)),
            relight: false,
        }
    }

    fn random_bushes(seed: u64) -> Vec<Cell> {
        let mut rng = crate::rng::stream(seed, "fire test");
        (0..FRAME.cell_count()).filter(|_| rng.random_bool(0.2)).map(|index| FRAME.cell(index)).collect()
    }

    #[test]
    fn what_catches_fire_is_what_lies_within_the_radius() {
        for (seed, radius_m) in [(1, 5.0), (2, 12.3), (3, 30.0), (4, 1e9)] {
            let bushes = random_bushes(seed);
            let mut plants = Vegetation::new(FRAME, &bushes, FireRules { spread_radius_m: radius_m, ..rules() });
            let from = bushes[bushes.len() / 2];
            plants.ignite(from, SimTime::ZERO, true).expect("it is intact");
            let near = |cell: &Cell| (FRAME.centre(*cell) - FRAME.centre(from)).length() <= radius_m;
            let expected: Vec<Cell> = bushes.iter().copied().filter(|cell| *cell != from && near(cell)).collect();
            assert_eq!(plants.within_spread(from), expected, "radius {radius_m}");
        }
    }

    #[test]
    fn the_short_list_and_the_stencil_agree_as_bushes_burn() {
        let bushes = random_bushes(9);
        let mut plants = Vegetation::new(FRAME, &bushes, rules());
        for (count, &cell) in bushes.iter().rev().enumerate() {
            let near = |other: &Cell| (FRAME.centre(*other) - FRAME.centre(cell)).length() <= 30.0;
            plants.ignite(cell, SimTime::ZERO, true);
            let left = &bushes[..bushes.len() - count - 1];
            let expected: Vec<Cell> = left.iter().copied().filter(near).collect();
            assert_eq!(plants.within_spread(cell), expected);
        }
        assert_eq!(plants.flammable_count(), 0);
        assert_eq!(plants.burning().collect::<Vec<_>>(), bushes);
    }

    #[test]
    fn the_radius_is_inclusive() {
        let bushes = [Cell { col: 2, row: 3 }, Cell { col: 8, row: 3 }, Cell { col: 8, row: 4 }];
        let mut plants = Vegetation::new(FRAME, &bushes, rules());
        plants.ignite(bushes[0], SimTime::ZERO, true);
        assert_eq!(plants.within_spread(bushes[0]), [bushes[1]]);
    }

    #[test]
    fn a_cell_burns_once_unless_extinguished_ones_can_burn_again() {
        let cell = Cell { col: 1, row: 1 };
        for relight in [false, true] {
            let mut plants = Vegetation::new(FRAME, &[cell], FireRules { relight, ..rules() });
            let first = plants.ignite(cell, SimTime::ZERO, true).expect("it is intact");
            assert_eq!(plants.ignite(cell, SimTime::ZERO, true), None, "it burns already");
            plants.extinguish(cell);
            assert!(!plants.goes_on(cell, first.episode));
            let again = plants.ignite(cell, SimTime::from_seconds(1.0), true);
            assert_eq!(again.is_some(), relight);
            assert!(!plants.goes_on(cell, first.episode), "another burning is not the first");
            if relight {
                plants.burn_out(cell);
                assert_eq!(plants.ignite(cell, SimTime::from_seconds(2.0), true), None);
            }
        }
    }

    #[test]
    fn only_what_was_lit_spreads_under_the_rules_of_the_report() {
        let bushes = [Cell { col: 0, row: 0 }, Cell { col: 1, row: 0 }];
        let mut plants = Vegetation::new(FRAME, &bushes, rules());
        let now = SimTime::from_seconds(100.0);
        let lit = plants.ignite(bushes[0], now, true).expect("intact");
        let caught = plants.ignite(bushes[1], now, false).expect("intact");
        assert_eq!(lit.spreads_at, Some(SimTime::from_seconds(110.0)));
        assert_eq!(caught.spreads_at, None);
        assert_eq!(caught.burns_out_at, Some(SimTime::from_seconds(160.0)));
    }
}
