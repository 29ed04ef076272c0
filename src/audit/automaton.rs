//! Fire by the automaton of Alexandridis: every try of a cell is drawn again.
//!
//! A cell tries each of its eight neighbours once, a step after it caught fire, if it still burns. Its chance is a hash of
//! the run's seed, the cell, how often it has caught fire, and the direction, so that each try can be repeated by itself:
//! what succeeds must have set its neighbour on fire, if that could burn, and nothing else may have. The directions, the
//! slope between two cells and which try counts are found here; the factors and the draw are those of `fire`.

use super::cell_log::{CellLog, Change, What};
use super::violation::first_violation;
use super::{Violation, ViolationKind};
use crate::fire::chance::Chance;
use crate::fire::models::AlexandridisRules;
use crate::fire::{Landscape, Relief, Weather};
use crate::geometry::{Cell, DVec2};
use crate::time::SimTime;
use crate::timeline::{Cause, Setting};

/// The rules and the chance of one run.
struct Automaton<'a> {
    setting: &'a Setting,
    landscape: &'a Landscape,
    weather: &'a Weather,
    rules: AlexandridisRules,
    chance: Chance,
    log: &'a CellLog<'a>,
}

/// Holds all that spread, and all that should have, against the draws; returns the first violation that is found.
pub fn audit_automaton(
    setting: &Setting,
    (landscape, weather, rules): (&Landscape, &Weather, AlexandridisRules),
    log: &CellLog<'_>,
    end: SimTime,
) -> Result<(), Violation> {
    let chance = Chance::new(setting.seed, "spread");
    let automaton = Automaton { setting, landscape, weather, rules, chance, log };
    first_violation(log.cells().map(|of_cell| automaton.check_cell(of_cell, end)))
}

impl Automaton<'_> {
    /// Checks how a cell caught fire, each time, and what it set on fire.
    fn check_cell(&self, changes: &[Change], end: SimTime) -> Result<(), Violation> {
        let ignitions = changes.iter().filter(|change| matches!(change.what, What::Ignited(_)));
        for (change, episode) in ignitions.zip(1..) {
            if let What::Ignited(Cause::Spread(from)) = change.what
                && !self.spreads(from, change)
            {
                let kind = ViolationKind::NoSource { cell: change.cell, from };
                return Err(change.violation(self.setting, kind));
            }
            let due = change.time + self.rules.step;
            let is_put_out = changes.iter().any(|later| {
                matches!(later.what, What::Extinguished { .. }) && (change.time..=due).contains(&later.time)
            });
            if due >= end || is_put_out {
                continue;
            }
            let neighbours = self.neighbours(change.cell);
            let mut spared = neighbours.filter(|&(direction, to)| {
                self.succeeds(change.cell, episode, direction, to, due) && self.log.is_spared(to, due)
            });
            if let Some((_, cell)) = spared.next() {
                let kind = ViolationKind::SparedBySpread { cell, from: change.cell };
                return Err(Violation { time: due, agent: None, place: self.setting.frame.centre(cell), kind });
            }
        }
        Ok(())
    }

    /// The neighbours in the order of cell index, with their numbers, which are those of their directions.
    fn neighbours(&self, cell: Cell) -> impl Iterator<Item = (u32, Cell)> + '_ {
        let offsets = (-1..=1).flat_map(|rows| (-1..=1).map(move |cols| (cols, rows)));
        let around = offsets.filter(|&offset| offset != (0, 0)).zip(0_u32..);
        around.filter_map(move |((cols, rows), number)| Some((number, self.setting.frame.offset(cell, cols, rows)?)))
    }

    /// Says whether a cell burned for a step by then, and its try succeeds.
    fn spreads(&self, from: Cell, caught: &Change) -> bool {
        let Some((direction, to)) = self.neighbours(from).find(|&(_, to)| to == caught.cell) else { return false };
        let changes = self.log.of_cell(from);
        let ignitions = changes.iter().filter(|change| matches!(change.what, What::Ignited(_))).zip(1..);
        let mut begun = ignitions.filter(|(change, _)| change.time + self.rules.step == caught.time);
        let Some((begun, episode)) = begun.next() else { return false };
        let is_put_out = changes.iter().any(|change| {
            let is_between = begun.time <= change.time && change.time < caught.time;
            matches!(change.what, What::Extinguished { .. }) && is_between
        });
        !is_put_out && self.succeeds(from, episode, direction, to, caught.time)
    }

    fn succeeds(&self, from: Cell, episode: u32, direction: u32, to: Cell, time: SimTime) -> bool {
        let way = self.setting.frame.centre(to) - self.setting.frame.centre(from);
        let metres = (way.x * way.x + way.y * way.y).sqrt();
        let wind = self.rules.wind_factor(self.weather.at(time).wind_mps, way / metres);
        let slope = self.rules.slope_factor(self.rise_m(from, to, way), metres);
        self.chance.uniform(from, episode, direction) < self.rules.probability(wind, slope)
    }

    fn rise_m(&self, from: Cell, to: Cell, way: DVec2) -> f64 {
        let frame = self.setting.frame;
        if let Relief::Elevation(heights) = &self.landscape.relief {
            return f64::from(heights[frame.index(to)]) - f64::from(heights[frame.index(from)]);
        }
        let gradient = (self.landscape.gradient(from) + self.landscape.gradient(to)) / 2.0;
        gradient.x * way.x + gradient.y * way.y
    }
}
