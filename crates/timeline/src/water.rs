//! Water: the content of a truck's tank, and the places to fill it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use wildfire_base::geometry::DVec2;
use wildfire_base::time::SimTime;
use wildfire_fire::water::{fuel_kg_m2, litres_per_m, max_kw_m};

use super::burn_map::Front;

/// The rules of water, equal for all trucks.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterRules {
    /// The number of stops at fires, or of portions, that a full tank lasts for, at least one. A stop takes its water when it begins.
    pub full_tank: u32,
    /// The time to refill one of them.
    pub fill_per_stop: SimTime,
    /// The greatest distance from the centre of a truck to a place with water where it can refill, in metres.
    pub reach_m: f64,
    /// The places with water, in metres in the frame of the field; at least one.
    pub places: Vec<DVec2>,
    /// `None` if every stop takes the same water; otherwise tanks are counted in portions, and the fire says how many a stop
    /// takes.
    pub energy: Option<WaterEnergy>,
}

/// Water by the heat of the fire.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WaterEnergy {
    /// Litres of a portion.
    pub portion_l: f64,
    /// Litres per second of the pump.
    pub pump_lps: f64,
    /// Metres of front that its jet covers at once.
    pub jet_m: f64,
    /// Water applied, as a multiple of the least that suffices in theory.
    pub applied: f64,
}

impl WaterEnergy {
    /// Returns the litres that put out a front on the width of a cell; infinite if it gives off more heat below the jet than
    /// the pump's water takes up (Van Wagner and Taylor, 2022; see [`wildfire_fire::water`]).
    pub fn litres(&self, front: Front, cell_m: f64) -> f64 {
        let Front { intensity_kw_m, heat_kj_m2 } = front;
        if intensity_kw_m > self.max_kw_m() {
            return f64::INFINITY;
        }
        self.applied * cell_m * litres_per_m(intensity_kw_m, fuel_kg_m2(heat_kj_m2))
    }

    /// Returns the intensity of the hottest front that the pump puts out.
    pub fn max_kw_m(&self) -> f64 {
        max_kw_m(self.pump_lps, self.jet_m)
    }

    /// Returns the portions that some litres are, at least one.
    pub fn water_units(&self, litres: f64) -> u32 {
        // Litres without end become more portions than any tank holds.
        (litres / self.portion_l).ceil().max(1.0) as u32
    }

    /// Returns how long the pump takes for some portions.
    pub fn spraying(&self, water_units: u32) -> SimTime {
        SimTime::from_seconds(f64::from(water_units) * self.portion_l / self.pump_lps)
    }
}

impl WaterRules {
    /// Returns the time to fill a tank that lasts for some stops.
    pub fn fill_time(&self, stops_left: u32) -> SimTime {
        let missing = u64::from(self.full_tank.saturating_sub(stops_left));
        SimTime::from_nanos(self.fill_per_stop.as_nanos().saturating_mul(missing))
    }

    /// Returns how long a stop takes longer than its dwell.
    pub fn spraying(&self, water_units: u32) -> SimTime {
        self.energy.map_or(SimTime::ZERO, |energy| energy.spraying(water_units))
    }

    /// Lists the places, nearest first.
    pub fn places_from(&self, from: DVec2) -> Vec<DVec2> {
        let mut places = self.places.clone();
        places.sort_by(|a, b| (*a - from).length_squared().total_cmp(&(*b - from).length_squared()));
        places
    }

    /// Returns the nearest place.
    pub fn nearest(&self, from: DVec2) -> DVec2 {
        let distance = |place: &DVec2| (*place - from).length_squared();
        let nearest = self.places.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        *nearest.expect("there is a place with water")
    }

    /// Returns whether a truck with its body's centre here can fill its tank.
    pub fn is_at_water(&self, centre: DVec2) -> bool {
        self.places.iter().any(|place| (*place - centre).length() <= self.reach_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules() -> WaterRules {
        let places = vec![DVec2::new(0.0, 0.0), DVec2::new(100.0, 0.0)];
        WaterRules { full_tank: 4, fill_per_stop: SimTime::from_seconds(15.0), reach_m: 10.0, places, energy: None }
    }

    #[test]
    fn water_follows_the_heat_up_to_what_the_pump_gives() {
        let energy = WaterEnergy { portion_l: 10.0, pump_lps: 5.0, jet_m: 5.0, applied: 2.0 };
        let litres = |intensity_kw_m: f64| energy.litres(Front { intensity_kw_m, heat_kj_m2: 18_608.0 }, 10.0);
        // 125 kcal/(s m): a flame 0.99 m deep, 0.0096 mm for it and 0.226 mm for a kilogram of fuel.
        assert!((litres(523.0) - 2.0 * 10.0 * 0.99 * 0.2356).abs() < 1e-9);
        let max_kw_m = 620.0 * 4.184;
        assert!(litres(max_kw_m - 0.01).is_finite() && litres(max_kw_m + 0.01) == f64::INFINITY);
        assert_eq!([0.0, 10.0, 10.5, f64::INFINITY].map(|litres| energy.water_units(litres)), [1, 1, 2, u32::MAX]);
        assert_eq!(energy.spraying(3), SimTime::from_seconds(6.0));
    }

    #[test]
    fn filling_takes_as_long_as_is_missing() {
        let times = [0, 1, 4, 9].map(|left| rules().fill_time(left).as_seconds());
        assert_eq!(times, [60.0, 45.0, 0.0, 0.0]);
    }

    #[test]
    fn the_nearest_place_comes_first() {
        let rules = rules();
        assert_eq!(rules.nearest(DVec2::new(60.0, 5.0)), rules.places[1]);
        assert_eq!(rules.places_from(DVec2::new(60.0, 5.0)), [rules.places[1], rules.places[0]]);
        assert!(rules.is_at_water(DVec2::new(92.0, 6.0)));
        assert!(!rules.is_at_water(DVec2::new(92.0, 6.1)));
    }
}
