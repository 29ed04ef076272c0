//! Embers beside the front: what they are about to set on fire.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::embers::{EmberSource, Embers};
use crate::surface::{SurfaceOptions, surface_fire};
use crate::{Landscape, Spread, SpreadBy, Weather};
use wildfire_base::geometry::{Cell, DVec2};
use wildfire_base::time::SimTime;

/// The embers of one run that have not gone out.
#[derive(Clone, Debug)]
pub struct Sparks {
    embers: Embers,
    landscape: Arc<Landscape>,
    weather: Arc<Weather>,
    options: SurfaceOptions,
    /// When which cell (by index) catches fire, and the cell that the ember comes from.
    glowing: BTreeSet<(SimTime, u32, u32)>,
}

impl Sparks {
    pub fn new(embers: Embers, landscape: &Arc<Landscape>, weather: &Arc<Weather>, options: SurfaceOptions) -> Self {
        let landscape = Arc::clone(landscape);
        let weather = Arc::clone(weather);
        Self { embers, landscape, weather, options, glowing: BTreeSet::new() }
    }

    /// Draws embers that fly from now on by another seed.
    pub fn reseed(&mut self, seed: u64) {
        self.embers.seed = seed;
    }

    /// Lets the embers fly of a cell that catches fire from a front that came along a way, or that was lit: then its front
    /// is that of the head.
    pub fn fly_from(&mut self, cell: Cell, way: Option<DVec2>, episode: u32, time: SimTime) {
        let Some(fire) = surface_fire(&self.landscape, &self.weather, &self.options, cell, time) else { return };
        let rate_mps = way.map_or(fire.rate_mps, |way| fire.front_normal_rate_mps(way));
        let intensity_kw_m = fire.intensity_kw_m(rate_mps);
        let heat_kj_m2 = fire.heat_kj_m2();
        let source = EmberSource { cell, episode, time, intensity_kw_m, heat_kj_m2 };
        let frame = &self.landscape.frame;
        for landing in self.embers.landings(&source, &self.landscape, &self.weather) {
            let place = (frame.index(landing.cell) as u32, frame.index(cell) as u32);
            self.glowing.extend(landing.ignites.map(|ignites| (ignites, place.0, place.1)));
        }
    }

    /// Returns when and where the next ember sets something on fire, if that can burn then.
    pub fn next(&self) -> Option<(SimTime, Cell)> {
        self.glowing.first().map(|&(time, cell, _)| (time, self.landscape.frame.cell(cell as usize)))
    }

    /// Adds what embers set on fire by a time, by (time, cell index).
    pub fn take_due(&mut self, now: SimTime, spreads: &mut Vec<Spread>) {
        let frame = &self.landscape.frame;
        while let Some((_, cell, from)) = self.glowing.first().copied().filter(|&(time, ..)| time <= now) {
            self.glowing.pop_first();
            let [cell, from] = [cell, from].map(|index| frame.cell(index as usize));
            spreads.push(Spread { cell, from, by: SpreadBy::Ember });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embers::EmberSettings;
    use crate::lone::LoneFire;
    use crate::models::RothermelRules;
    use crate::surface::FuelMoisture;
    use wildfire_base::geometry::FieldFrame;

    const FRAME: FieldFrame = FieldFrame { cols: 80, rows: 60, cell_m: 5.0 };
    const RIVER: std::ops::Range<u16> = 38..42;
    const START: (SimTime, Cell) = (SimTime::ZERO, Cell { col: 10, row: 30 });

    /// Grass with a river from south to north, and a strong wind over it.
    fn fire(embers: Option<EmberSettings>, seed: u64) -> LoneFire {
        let mut landscape = Landscape::uniform(FRAME, 102);
        for index in 0..FRAME.cell_count() {
            if RIVER.contains(&FRAME.cell(index).col) {
                landscape.fuel[index] = 98;
            }
        }
        let weather = Weather::constant(DVec2::X * 12.0, FuelMoisture::default());
        let embers = embers.map(|settings| Embers { settings, seed });
        let rules = RothermelRules { embers, ..RothermelRules::default() };
        LoneFire::new(Arc::new(landscape), Arc::new(weather), rules, &[START])
    }

    fn arrivals(fire: &LoneFire) -> Vec<Option<SimTime>> {
        (0..FRAME.cell_count()).map(|index| fire.arrival(FRAME.cell(index))).collect()
    }

    fn is_beyond(index: usize) -> bool {
        FRAME.cell(index).col >= RIVER.end
    }

    const MANY: EmberSettings = EmberSettings {
        per_mj: 0.005,
        i_min_kw_m: 100.0,
        d0: 1.0,
        a: 0.3,
        b: 0.55,
        k: 5.0,
        cross_sd_m: 5.0,
        p_ign: 0.5,
        delay_s: 30.0,
    };

    #[test]
    fn embers_cross_a_river_that_stops_the_front() {
        let hour = SimTime::from_seconds(3600.0);
        let burned_beyond = |mut fire: LoneFire| {
            fire.burn_until(hour);
            let arrivals = arrivals(&fire);
            let crossed = (0..arrivals.len()).filter(|&index| is_beyond(index) && arrivals[index].is_some());
            crossed.map(|index| fire.parent(FRAME.cell(index)).expect("it burned")).collect::<Vec<_>>()
        };
        assert_eq!(burned_beyond(fire(None, 1)), []);
        assert_eq!(burned_beyond(fire(Some(EmberSettings { per_mj: 0.0, ..MANY }), 1)), []);
        let parents = burned_beyond(fire(Some(MANY), 1));
        let from_before = parents.iter().filter(|parent| parent.col < RIVER.start).count();
        assert!(from_before > 0 && parents.len() > 10 * from_before, "{from_before} of {}", parents.len());
    }

    #[test]
    fn embers_only_hasten_a_fire_and_no_slices_of_time_change_it() {
        let hour = SimTime::from_seconds(1800.0);
        let mut with = fire(Some(MANY), 3);
        let mut without = fire(None, 3);
        with.burn_until(hour);
        without.burn_until(hour);
        let hastened = arrivals(&with);
        let front = arrivals(&without);
        let microsecond = SimTime::from_nanos(1000);
        for (index, (with, without)) in hastened.iter().zip(&front).enumerate() {
            if let Some(without) = without {
                let with = with.expect("the front comes all the same");
                assert!(with <= *without + microsecond, "{}: {with} after {without}", FRAME.cell(index));
            }
        }
        assert_ne!(hastened, front);
        let mut sliced = fire(Some(MANY), 3);
        for slice in 1..=180 {
            sliced.burn_until(SimTime::from_seconds(10.0 * f64::from(slice)));
        }
        assert_eq!(arrivals(&sliced), hastened);
        let mut other = fire(Some(MANY), 4);
        other.burn_until(hour);
        assert_ne!(arrivals(&other), hastened, "another seed has other embers");
    }
}
