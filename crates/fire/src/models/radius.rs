//! The contest's rule: a set time after it caught fire, and if it still burns, a cell sets on fire at once whatever can
//! burn within a radius of its centre.

use crate::{Arrival, FireChange, FireEvent, FireEvents, FireField, FireModel, FireRules, Spread, SpreadBy};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::time::SimTime;

/// Distances between cell centres are exact multiples of the cell size; this absorbs the rounding of their product.
const RADIUS_TOLERANCE: f64 = 1e-9;

/// The rule of the radius on one field.
#[derive(Clone, Debug)]
pub struct Radius {
    rules: FireRules,
    /// For every row from the southernmost on, how many columns to either side lie within the radius.
    half_widths: Vec<u16>,
}

impl Radius {
    pub fn new(frame: &FieldFrame, rules: FireRules) -> Self {
        let limit = squared_radius_in_cells(frame, rules.spread_radius_m);
        // No farther than the field is wide.
        let reach = limit.sqrt().floor();
        let rows = reach.min(f64::from(frame.rows) - 1.0) as i32;
        let half_width = |row: i32| {
            let left = limit - f64::from(row * row);
            let about = left.sqrt().min(f64::from(frame.cols) - 1.0) as i32;
            // The root may be off by rounding, the squares of whole numbers are not.
            (about - 1..=about + 1).rev().find(|cols| f64::from(cols * cols + row * row) <= limit).unwrap_or(0) as u16
        };
        Self { rules, half_widths: (-rows..=rows).map(half_width).collect() }
    }

    /// Returns what a burning cell would set on fire now, by cell index.
    ///
    /// Looks at 64 cells at once where none of them can burn, since a wide radius covers much of a field.
    fn within_reach(&self, fires: &FireField, from: Cell) -> Vec<Cell> {
        let frame = fires.frame();
        let reach = (self.half_widths.len() / 2) as i32;
        let mut found = Vec::new();
        for (row, &half_width) in (i32::from(from.row) - reach..).zip(&self.half_widths) {
            let Some(row) = u16::try_from(row).ok().filter(|&row| row < frame.rows) else { continue };
            let cols = from.col.saturating_sub(half_width)..=from.col.saturating_add(half_width).min(frame.cols - 1);
            // What is wet is left to burn, but not now.
            found.extend(fires.flammable_in_row(row, cols).filter(|&cell| fires.can_burn(cell)));
        }
        found
    }
}

fn squared_radius_in_cells(frame: &FieldFrame, radius_m: f64) -> f64 {
    let cells = radius_m / frame.cell_m;
    cells * cells * (1.0 + RADIUS_TOLERANCE)
}

impl FireModel for Radius {
    /// An arrival names the cell that spreads and its episode: what it reaches is decided when it is due.
    fn follow(&mut self, fires: &FireField, now: SimTime, change: FireChange, expected: &mut FireEvents) {
        let FireChange::Ignited { cell, is_source } = change else { return };
        let episode = fires.episode(cell);
        if if is_source { self.rules.sources_spread } else { self.rules.caught_spreads } {
            let arrival = FireEvent::Arrival(Arrival { cell, revision: episode });
            expected.push((now + self.rules.spread_delay, arrival));
        }
        if let Some(span) = self.rules.burn_out {
            expected.push((now + span, FireEvent::BurnOut { cell, episode }));
        }
    }

    fn arrive(
        &mut self,
        fires: &FireField,
        _now: SimTime,
        arrival: Arrival,
        _expected: &mut FireEvents,
    ) -> Vec<Spread> {
        let Arrival { cell: from, revision: episode } = arrival;
        if !fires.goes_on(from, episode) {
            return Vec::new();
        }
        self.within_reach(fires, from).into_iter().map(|cell| Spread { cell, from, by: SpreadBy::Front }).collect()
    }
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
            sources_spread: true,
            caught_spreads: false,
            burn_out: Some(SimTime::from_seconds(60.0)),
            reignition: false,
        }
    }

    fn random_bushes(seed: u64) -> Vec<Cell> {
        let mut rng = wildfire_base::rng::stream(seed, "fire test");
        (0..FRAME.cell_count()).filter(|_| rng.random_bool(0.2)).map(|index| FRAME.cell(index)).collect()
    }

    #[test]
    fn what_catches_fire_is_what_lies_within_the_radius() {
        for (seed, radius_m) in [(1, 5.0), (2, 12.3), (3, 30.0), (4, 1e9)] {
            let bushes = random_bushes(seed);
            let model = Radius::new(&FRAME, FireRules { spread_radius_m: radius_m, ..rules() });
            let mut fires = FireField::new(FRAME, &bushes, false);
            let from = bushes[bushes.len() / 2];
            fires.ignite(from, SimTime::ZERO, true).expect("it is intact");
            let near = |cell: &Cell| (FRAME.centre(*cell) - FRAME.centre(from)).length() <= radius_m;
            let expected: Vec<Cell> = bushes.iter().copied().filter(|cell| *cell != from && near(cell)).collect();
            assert_eq!(model.within_reach(&fires, from), expected, "radius {radius_m}");
        }
    }

    #[test]
    fn the_short_list_and_the_stencil_agree_as_bushes_burn() {
        let bushes = random_bushes(9);
        let model = Radius::new(&FRAME, rules());
        let mut fires = FireField::new(FRAME, &bushes, false);
        for (count, &cell) in bushes.iter().rev().enumerate() {
            let near = |other: &Cell| (FRAME.centre(*other) - FRAME.centre(cell)).length() <= 30.0;
            fires.ignite(cell, SimTime::ZERO, true);
            let left = &bushes[..bushes.len() - count - 1];
            let expected: Vec<Cell> = left.iter().copied().filter(near).collect();
            assert_eq!(model.within_reach(&fires, cell), expected);
        }
        assert_eq!(fires.flammable().len(), 0);
        assert_eq!(fires.burning().collect::<Vec<_>>(), bushes);
    }

    #[test]
    fn the_radius_is_inclusive() {
        let bushes = [Cell { col: 2, row: 3 }, Cell { col: 8, row: 3 }, Cell { col: 8, row: 4 }];
        let model = Radius::new(&FRAME, rules());
        let mut fires = FireField::new(FRAME, &bushes, false);
        fires.ignite(bushes[0], SimTime::ZERO, true);
        assert_eq!(model.within_reach(&fires, bushes[0]), [bushes[1]]);
    }

    #[test]
    fn only_sources_spread_under_the_rules_of_the_report() {
        let source = Cell { col: 0, row: 0 };
        let caught = Cell { col: 1, row: 0 };
        let mut model = Radius::new(&FRAME, rules());
        let mut fires = FireField::new(FRAME, &[source, caught], false);
        let now = SimTime::from_seconds(100.0);
        let mut expected = Vec::new();
        for (cell, is_source) in [(source, true), (caught, false)] {
            let change = fires.ignite(cell, now, is_source).expect("it is intact");
            model.follow(&fires, now, change, &mut expected);
        }
        let spreads = Arrival { cell: source, revision: 1 };
        let burn_out = SimTime::from_seconds(160.0);
        let wanted = [
            (SimTime::from_seconds(110.0), FireEvent::Arrival(spreads)),
            (burn_out, FireEvent::BurnOut { cell: source, episode: 1 }),
            (burn_out, FireEvent::BurnOut { cell: caught, episode: 1 }),
        ];
        assert_eq!(expected, wanted);
        fires.extinguish(source);
        assert_eq!(model.arrive(&fires, SimTime::from_seconds(110.0), spreads, &mut expected), [], "it burns no more");
    }
}
