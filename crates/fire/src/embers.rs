//! Embers: fire that the wind carries over what does not burn.
//!
//! A cell that catches fire with a front of at least some power gives off embers, a Poisson number with a mean in
//! proportion to the heat of the whole cell. Each flies with the wind, a lognormal distance with a mean `m = d0 I^a U^b`
//! (I in kW/m, U in m/s at 10 m) and a variance `k m`, and a normal one across it. It lands after the distance over the
//! wind's speed, and sets fire to what it finds there with a probability that falls to nothing at the extinction moisture,
//! some time later, if that can burn then. The form is that of Himoto and Tanaka, "Transport of disk-shaped firebrands in
//! a turbulent boundary layer", 2005, with the exponents of Sardoy and others, 2008, as pyretechnics and ELMFIRE have it.
//!
//! All of it is drawn by a hash of the cell that burns, its episode and the ember's number, see [`Chance`].

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::chance::{Chance, normal, poisson};
use super::{Landscape, Weather};
use wildfire_base::geometry::{Cell, DVec2, ops};
use wildfire_base::ranges;
use wildfire_base::time::SimTime;

/// How many embers fly, how far, and what they set on fire. The defaults are chosen for fields of some hundred metres: a few
/// spot fires in a thousand cells of burning grass, some ten metres ahead. They are no measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct EmberSettings {
    /// Embers for each megajoule of heat; of one cell at most 500 on average.
    pub per_mj: f64,
    /// The least power of a front that emits embers.
    pub i_min_kw_m: f64,
    /// The mean distance in metres is `d0` times the power in kW/m to the power of `a`, times the wind in m/s to the power
    /// of `b`.
    pub d0: f64,
    pub a: f64,
    pub b: f64,
    /// The ratio of the distance's variance to its mean.
    pub k: f64,
    /// The standard deviation across the wind.
    pub cross_sd_m: f64,
    /// The probability that an ember ignites dry fuel.
    pub p_ign: f64,
    /// From landing to ignition.
    pub delay_s: f64,
}

impl Default for EmberSettings {
    fn default() -> Self {
        Self {
            per_mj: 3e-4,
            i_min_kw_m: 500.0,
            d0: 1.0,
            a: 0.3,
            b: 0.55,
            k: 5.0,
            cross_sd_m: 5.0,
            p_ign: 0.5,
            delay_s: 30.0,
        }
    }
}

ranges! { EmberSettings {
    per_mj: 0.0..=1000.0, i_min_kw_m: 0.0..=1e6, d0: 0.0..=1000.0, a: 0.0..=2.0, b: 0.0..=2.0, k: 0.0..=1e6,
    cross_sd_m: 0.0..=1e5, p_ign: 0.0..=1.0, delay_s: 0.0..=1e6,
} }

/// The embers of one run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Embers {
    pub settings: EmberSettings,
    pub seed: u64,
}

/// A cell that has caught fire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmberSource {
    pub cell: Cell,
    pub episode: u32,
    pub time: SimTime,
    /// The power of the front that came to it.
    pub intensity_kw_m: f64,
    /// The heat of a square metre of it.
    pub heat_kj_m2: f64,
}

/// An ember that has come down on the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Landing {
    pub cell: Cell,
    pub time: SimTime,
    /// When the cell catches fire from it, if it can burn then; `None` if the ember goes out.
    pub ignites: Option<SimTime>,
}

/// What an ember draws.
const DISTANCE: u32 = 0;
const ACROSS: u32 = 1;
const IGNITION: u32 = 2;
const DRAWS: u32 = 4;

/// The longest flight that is followed; no run is as long.
const MAX_SECONDS: f64 = 1e7;

impl Embers {
    /// Lists the embers of a cell that come down on the field, in the order of their numbers. Those that leave it are left
    /// out, and without wind none fly.
    pub fn landings(&self, source: &EmberSource, landscape: &Landscape, weather: &Weather) -> Vec<Landing> {
        let EmberSettings { per_mj, i_min_kw_m, d0, a, b, k, cross_sd_m, delay_s, .. } = self.settings;
        let EmberSource { cell, episode, time, intensity_kw_m, heat_kj_m2 } = *source;
        let frame = &landscape.frame;
        // An ember flies in the wind of its source at its start, whatever blows farther on.
        let wind = weather.at_cell(time, frame.index(cell)).wind_mps;
        let speed = ops::hypot(wind.x, wind.y);
        if speed == 0.0 || intensity_kw_m < i_min_kw_m {
            return Vec::new();
        }
        let mean_m = d0 * ops::pow(intensity_kw_m, a) * ops::pow(speed, b);
        // Settings may make it 0 or infinite, neither of which has a logarithm to go on with.
        if !(mean_m > 0.0 && mean_m.is_finite()) {
            return Vec::new();
        }
        // Moments of the logarithm with which the distance has the mean `mean_m` and `k` times that as variance.
        let spread = ops::ln(1.0 + k / mean_m);
        let typical = ops::ln(mean_m) - spread / 2.0;
        let mean_count = per_mj * heat_kj_m2 / 1000.0 * (frame.cell_m * frame.cell_m);
        let count = poisson(mean_count, Chance::new(self.seed, "ember count").uniform(cell, episode, 0));
        // A stream of its own, as the number 0 has been drawn for the count.
        let chance = Chance::new(self.seed, "embers");
        // Calm has returned above, so there is a direction.
        let along = wind / speed;
        let across = DVec2::new(-along.y, along.x);
        (0..count)
            .filter_map(|ember: u32| {
                // Draws are by number, so an ember that leaves the field shifts none of the others.
                let draw = |what: u32| chance.uniform(cell, episode, DRAWS * ember + what);
                let distance_m = ops::exp(typical + spread.sqrt() * normal(draw(DISTANCE)));
                let aside_m = cross_sd_m * normal(draw(ACROSS));
                let lands_on = frame.cell_at(frame.centre(cell) + along * distance_m + across * aside_m)?;
                let seconds = distance_m / speed;
                if seconds > MAX_SECONDS {
                    return None;
                }
                let lands = time + SimTime::from_seconds(seconds);
                let ignites = draw(IGNITION) < self.ignition_probability(lands_on, lands, landscape, weather);
                let ignites = ignites.then(|| lands + SimTime::from_seconds(delay_s));
                Some(Landing { cell: lands_on, time: lands, ignites })
            })
            .collect()
    }

    fn ignition_probability(&self, cell: Cell, time: SimTime, landscape: &Landscape, weather: &Weather) -> f64 {
        let model = landscape.burning_model(cell);
        let moisture = weather.at_cell(time, landscape.frame.index(cell)).moisture.d1;
        model.map_or(0.0, |model| self.settings.p_ign * (1.0 - moisture / model.dead_extinction).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FuelMoisture;
    use wildfire_base::geometry::{FieldFrame, compass};
    use wildfire_base::ranges::SettingsTable;

    const FRAME: FieldFrame = FieldFrame { cols: 401, rows: 401, cell_m: 5.0 };

    fn weather(wind_mps: DVec2, d1: f64) -> Weather {
        Weather::constant(wind_mps, FuelMoisture { d1, ..FuelMoisture::default() })
    }

    fn source(col: u16, episode: u32) -> EmberSource {
        let cell = Cell { col, row: 200 };
        let time = SimTime::from_seconds(100.0);
        EmberSource { cell, episode, time, intensity_kw_m: 2000.0, heat_kj_m2: 4000.0 }
    }

    fn embers(settings: EmberSettings) -> Embers {
        Embers { settings, seed: 9 }
    }

    /// Flights of 2000 cells that burn.
    fn flights(settings: EmberSettings, wind: DVec2) -> Vec<(DVec2, Landing)> {
        let landscape = Landscape::uniform(FRAME, 102);
        let weather = weather(wind, 0.06);
        let sources = (0..2000).map(|number| source(100 + number % 200, u32::from(number)));
        let landings = |source: EmberSource| {
            let from = FRAME.centre(source.cell);
            let landings = embers(settings).landings(&source, &landscape, &weather).into_iter();
            landings.map(move |landing| (FRAME.centre(landing.cell) - from, landing))
        };
        sources.flat_map(landings).collect()
    }

    #[test]
    fn flights_have_the_number_the_distance_and_the_spread_of_the_settings() {
        let settings = EmberSettings { per_mj: 0.02, cross_sd_m: 20.0, ..EmberSettings::default() };
        let toward = compass::unit_toward(60.0);
        let flights = flights(settings, toward * 8.0);
        let count = flights.len() as f64;
        // 0.02 for each MJ, 4 MJ/m2, 25 m2: 2 a cell.
        assert!((count - 4000.0).abs() < 4.0 * 4000.0_f64.sqrt(), "{count}");
        let mean = |value: &dyn Fn(&DVec2) -> f64| flights.iter().map(|(flight, _)| value(flight)).sum::<f64>() / count;
        let along = |flight: &DVec2| flight.dot(toward);
        let aside = |flight: &DVec2| flight.perp_dot(toward);
        let expected_m = ops::pow(2000.0, 0.3) * ops::pow(8.0, 0.55);
        let found_m = mean(&along);
        assert!((found_m - expected_m).abs() < 1.0, "{found_m}, expected {expected_m}");
        let variance = mean(&|flight| (along(flight) - found_m) * (along(flight) - found_m));
        // Positions are centres of cells of 5 m, which adds 25 / 12.
        let expected = 5.0 * expected_m + 25.0 / 12.0;
        assert!((variance / expected - 1.0).abs() < 0.15, "{variance}, expected {expected}");
        assert!(mean(&aside).abs() < 1.5);
        let variance = mean(&|flight| aside(flight) * aside(flight));
        assert!((variance / (400.0 + 25.0 / 12.0) - 1.0).abs() < 0.1, "{variance}");
        // They fly with the wind, and dry grass catches fire from them as often as the settings say.
        for (flight, landing) in &flights {
            let seconds = (landing.time - SimTime::from_seconds(100.0)).as_seconds();
            assert!((seconds * 8.0 - along(flight)).abs() < 5.0, "{seconds}");
            assert!(landing.ignites.is_none_or(|ignites| ignites == landing.time + SimTime::from_seconds(30.0)));
        }
        let caught = flights.iter().filter(|(_, landing)| landing.ignites.is_some()).count() as f64 / count;
        let expected = 0.5 * (1.0 - 0.06 / 0.15);
        assert!((caught - expected).abs() < 4.0 * (expected / count).sqrt(), "{caught}");
    }

    #[test]
    fn weak_fires_calm_air_and_no_embers_make_none() {
        let strong = EmberSettings { per_mj: 1.0, ..EmberSettings::default() };
        let windy = DVec2::X * 5.0;
        let landscape = Landscape::uniform(FRAME, 102);
        let count = |settings, wind, intensity_kw_m| {
            let source = EmberSource { intensity_kw_m, ..source(200, 1) };
            embers(settings).landings(&source, &landscape, &weather(wind, 0.06)).len()
        };
        assert!(count(strong, windy, 500.0) > 50);
        assert_eq!(count(strong, windy, 499.9), 0);
        assert_eq!(count(strong, DVec2::ZERO, 2000.0), 0);
        assert_eq!(count(EmberSettings { per_mj: 0.0, ..strong }, windy, 2000.0), 0);
        assert_eq!(count(EmberSettings { d0: 0.0, ..strong }, windy, 2000.0), 0);
        assert!(
            count(EmberSettings { per_mj: 1000.0, d0: 0.01, ..strong }, windy, 2000.0) < 800,
            "the mean is bounded"
        );
    }

    #[test]
    fn embers_go_out_on_what_is_wet_or_no_fuel() {
        let settings = EmberSettings { per_mj: 1.0, p_ign: 1.0, ..EmberSettings::default() };
        for (fuel, d1, ignites) in [(102, 0.0, true), (102, 0.15, false), (102, 0.3, false), (98, 0.0, false)] {
            let weather = weather(DVec2::X * 5.0, d1);
            let landings = embers(settings).landings(&source(200, 1), &Landscape::uniform(FRAME, fuel), &weather);
            assert!(landings.len() > 50);
            assert!(landings.iter().all(|landing| landing.ignites.is_some() == ignites), "fuel {fuel}, moisture {d1}");
        }
    }

    #[test]
    fn any_settings_in_range_are_borne() {
        for extreme in [0.0, 1.0] {
            let max = |largest: f64| extreme * largest;
            let settings = EmberSettings {
                per_mj: 10.0,
                i_min_kw_m: 0.0,
                d0: 1000.0,
                a: max(2.0),
                b: max(2.0),
                k: max(1e6),
                cross_sd_m: max(1e5),
                p_ign: 1.0,
                delay_s: max(1e6),
            };
            settings.check(&FRAME).expect("these are in range");
            for wind in [1e-12, 5.0, 100.0] {
                let source = EmberSource { intensity_kw_m: 1e5, ..source(200, 1) };
                let landscape = Landscape::uniform(FRAME, 102);
                for landing in embers(settings).landings(&source, &landscape, &weather(DVec2::X * wind, 0.06)) {
                    assert!(landing.cell.col < FRAME.cols && landing.time >= source.time);
                }
            }
        }
        let wrong = EmberSettings { p_ign: 1.5, ..EmberSettings::default() };
        assert_eq!(wrong.check(&FRAME).expect_err("it is no probability").name, "p_ign");
        assert!(EmberSettings { k: f64::NAN, ..EmberSettings::default() }.check(&FRAME).is_err());
    }
}
