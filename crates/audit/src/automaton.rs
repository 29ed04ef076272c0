//! Fire by the automaton of Alexandridis: every try of a cell is drawn again.
//!
//! A cell tries each of its eight neighbours once, a step after it caught fire, if it still burns. Its chance is a hash of
//! the run's seed, the cell, how often it has caught fire, and the direction, so that each try can be repeated by itself:
//! what succeeds must have set its neighbour on fire, if that could burn, and nothing else may have. The directions, the
//! slope between two cells and which try counts are found here; the factors and the draw are those of `fire`.

use super::cell_log::{CellLog, Change, ChangeKind};
use super::violation::first_violation;
use super::{Violation, ViolationKind};
use wildfire_base::geometry::{Cell, DVec2};
use wildfire_base::time::SimTime;
use wildfire_fire::chance::Chance;
use wildfire_fire::models::AlexandridisRules;
use wildfire_fire::{Landscape, Relief, Weather};
use wildfire_timeline::{Cause, Setting};

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
    landscape: &Landscape,
    weather: &Weather,
    rules: AlexandridisRules,
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
        for (change, episode, later) in ignitions(changes) {
            if let ChangeKind::Ignited(Cause::Spread(from)) = change.what
                && !self.spreads(from, change)
            {
                let kind = ViolationKind::NoSource { cell: change.cell, from };
                return Err(change.violation(self.setting, kind));
            }
            let due = change.time + self.rules.step;
            // What is put out at the very instant may have been so before its tries.
            if due >= end || is_put_out(later, |time| time <= due) {
                continue;
            }
            let neighbours = self.neighbours(change.cell);
            // The draws are repeated from seed, cell and direction, which need no order.
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
        ignitions(self.log.of_cell(from)).any(|(ignition, episode, later)| {
            ignition.time + self.rules.step == caught.time
                && !is_put_out(later, |time| time < caught.time)
                && self.succeeds(from, episode, direction, to, caught.time)
        })
    }

    fn succeeds(&self, from: Cell, episode: u32, direction: u32, to: Cell, time: SimTime) -> bool {
        let way = self.setting.frame.centre(to) - self.setting.frame.centre(from);
        let metres = (way.x * way.x + way.y * way.y).sqrt();
        let wind =
            self.rules.wind_factor(self.weather.at_cell(time, self.landscape.frame.index(from)).wind_mps, way / metres);
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

/// Iterates over the times that a cell caught fire, each with its number from 1 and the changes of the cell after it.
fn ignitions(changes: &[Change]) -> impl Iterator<Item = (&Change, u32, &[Change])> {
    let with_later = changes.iter().enumerate().map(|(index, change)| (change, &changes[index + 1..]));
    let ignitions = with_later.filter(|(change, _)| matches!(change.what, ChangeKind::Ignited(_)));
    ignitions.zip(1..).map(|((change, later), episode)| (change, episode, later))
}

/// Says whether a fire ends by water at a time that counts. It is of the changes after its beginning: at one instant a cell
/// may be put out and catch fire again.
fn is_put_out(later: &[Change], counts: impl Fn(SimTime) -> bool) -> bool {
    later.iter().any(|change| matches!(change.what, ChangeKind::Extinguished { .. }) && counts(change.time))
}
