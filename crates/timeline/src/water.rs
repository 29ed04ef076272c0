//! Water: the content of a truck's tank, and the places to fill it.

use wildfire_base::geometry::DVec2;
use wildfire_base::time::SimTime;

/// The rules of water, equal for all trucks.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterRules {
    /// The number of stops at fires that a full tank lasts for, at least one. A stop takes its water when it begins.
    pub full_tank: u32,
    /// The time to refill the water of one stop.
    pub fill_per_stop: SimTime,
    /// The greatest distance from the centre of a truck to a place with water where it can refill, in metres.
    pub reach_m: f64,
    /// The places with water, in metres in the frame of the field; at least one.
    pub places: Vec<DVec2>,
}

impl WaterRules {
    /// Returns the time to fill a tank that lasts for some stops.
    pub fn fill_time(&self, stops_left: u32) -> SimTime {
        let missing = u64::from(self.full_tank.saturating_sub(stops_left));
        SimTime::from_nanos(self.fill_per_stop.as_nanos().saturating_mul(missing))
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
        WaterRules { full_tank: 4, fill_per_stop: SimTime::from_seconds(15.0), reach_m: 10.0, places }
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
