//! Moisture of dead sticks hour by hour, from heat and water diffusing in a cylinder (Nelson's model).
//!
//! Nelson, R.M. 2000. Prediction of diurnal change in 10-h fuel stick moisture content. Canadian Journal of Forest Research
//! 30: 1071-1087; sizes and rates as in Carlson, J.D. et al. 2007. Application of the Nelson model to four timelag fuel
//! classes. International Journal of Wildland Fire 16: 204-216. Lengths in cm, times in hours, heat in calories,
//! temperatures in degrees Celsius, moisture as a fraction of the dry weight.
//!
//! The surface exchanges heat with air and sky and water with the air; within the stick, water moves by diffusion of vapour
//! and of bound water. NFDRS4 computes the same temperatures of the surface. Its humidity at the surface is not published:
//! here the sorption takes place at the mean of the temperatures of air and surface, which is nearest to its answers
//! (`docs/fire-spread.md` says how near). Capillary flow of free water and the water of
//! dew are left out; rain and the hour after it follow NFDRS4's answers.

use std::f64::consts::PI;

use wildfire_base::geometry::ops;

/// Nodes along the radius, the first at the surface, the last in the middle.
const NODES: usize = 11;

/// The most that wood holds at any place.
const MAX_MOISTURE: f64 = 0.35;

/// Density of dry wood with its cavities, g/cm3.
const DENSITY: f64 = 0.4;

/// Pressure of the air, cal/cm3.
const AIR_PRESSURE: f64 = 0.0218;

/// The psychrometric constant, for pressures as shares of that of the air, per degree.
const PSYCHROMETRIC: f64 = 0.000_772;

const KELVIN: f64 = 273.2;

/// Gas constant, cal/(mol K).
const GAS: f64 = 1.987;

/// The share of the rain's water that a stick takes up while the air becomes drier, as at the end of a storm.
const END_OF_STORM: f64 = 0.15;

/// A class of dead fuel: a stick, and the steps that its water and its diffusivities need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickSize {
    pub radius_cm: f64,
    /// Conductance of the surface for water where the stick takes it up; where it dries: 0.06 cm/h.
    pub adsorption_cm_h: f64,
    /// The most moisture that rain adds to the surface, per hour.
    pub rain_uptake: f64,
    pub steps: u32,
    /// Times an hour that the diffusivities are computed.
    pub updates: u32,
}

/// Sticks of the 1-, 10-, 100- and 1000-hour classes, as NFDRS4 sets them up.
pub const SIZES: [StickSize; 4] = [
    StickSize { radius_cm: 0.2, adsorption_cm_h: 0.462_252_733, rain_uptake: 3.670_706_306, steps: 265, updates: 25 },
    StickSize { radius_cm: 0.64, adsorption_cm_h: 0.079_548_303, rain_uptake: 0.310_102_409_7, steps: 60, updates: 9 },
    StickSize { radius_cm: 2.0, adsorption_cm_h: 0.06, rain_uptake: 0.051_202_534_87, steps: 20, updates: 5 },
    StickSize { radius_cm: 3.81, adsorption_cm_h: 0.06, rain_uptake: 0.033_787_099_35, steps: 13, updates: 5 },
];

/// The air at the end of an hour, and the rain of the hour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    pub temperature_c: f64,
    /// Relative humidity as a fraction, above zero.
    pub humidity: f64,
    pub solar_w_m2: f64,
    pub rain_cm: f64,
}

/// A stick in the weather.
#[derive(Clone, Debug, PartialEq)]
pub struct Stick {
    size: StickSize,
    /// Transfer of heat to the air, cal/(cm2 h K).
    to_air: f64,
    air: Air,
    moisture: [f64; NODES],
    temperature_c: [f64; NODES],
    diffusivity: [f64; NODES],
}

impl Stick {
    /// Creates a stick of 20 degrees and 17.5 % moisture in still, dry, dark air of the same temperature.
    pub fn new(size: StickSize) -> Self {
        let r = size.radius_cm;
        Self {
            size,
            to_air: 0.2195 + 0.0526 / (r * r * r.sqrt()),
            air: Air { temperature_c: 20.0, humidity: 0.2, solar_w_m2: 0.0, rain_cm: 0.0 },
            moisture: [0.175; NODES],
            temperature_c: [20.0; NODES],
            diffusivity: [diffusivity(20.0, 0.175); NODES],
        }
    }

    /// Lets an hour pass in which the air changes steadily to that at its end.
    pub fn advance_hour(&mut self, to: &Air) {
        let StickSize { steps, updates, .. } = self.size;
        let from = self.air;
        let share = if to.humidity < from.humidity { END_OF_STORM } else { 1.0 };
        let uptake = share * self.size.rain_uptake * (1.0 - ops::exp(-100.0 * to.rain_cm / PI));
        let step_h = 1.0 / f64::from(steps);
        let mut updated = 1;
        // Both ends of the hour have a step, as in NFDRS4.
        for step in 0..=steps {
            let share = f64::from(step) / f64::from(steps);
            let between = |from: f64, to: f64| from + (to - from) * share;
            let air = Air {
                temperature_c: between(from.temperature_c, to.temperature_c),
                humidity: between(from.humidity, to.humidity),
                solar_w_m2: between(from.solar_w_m2, to.solar_w_m2),
                // Rain is the sum of an hour and not a value at its end, so it is not interpolated.
                rain_cm: to.rain_cm,
            };
            self.exchange(&air, uptake * step_h, from.rain_cm > 0.0);
            self.diffuse(step_h);
            // Diffusivities vary slowly and take exponentials, so they are renewed a few times an hour, evenly spread.
            if f64::from(updated) / f64::from(updates) - share < 0.5 * step_h {
                for (node, value) in self.diffusivity.iter_mut().enumerate() {
                    *value = diffusivity(self.temperature_c[node], self.moisture[node]);
                }
                updated += 1;
            }
        }
        self.air = *to;
    }

    /// Returns the median of the nodes, which NFDRS4 takes for the moisture of the class.
    pub fn median_moisture(&self) -> f64 {
        let mut sorted = self.moisture;
        sorted.sort_by(f64::total_cmp);
        sorted[NODES / 2]
    }

    pub fn surface_moisture(&self) -> f64 {
        self.moisture[0]
    }

    pub fn surface_temperature_c(&self) -> f64 {
        self.temperature_c[0]
    }

    /// Sets temperature and moisture of the surface. Where dew falls in the hour after rain, its moisture stays.
    fn exchange(&mut self, air: &Air, rain_uptake: f64, is_after_rain: bool) {
        let surface_c = self.balanced_temperature_c(air);
        self.temperature_c[0] = surface_c;
        let [surface, inner] = [self.moisture[0], self.moisture[1]];
        self.moisture[0] = if air.rain_cm > 0.0 {
            surface + rain_uptake
        } else if is_after_rain && air.humidity * saturation(air.temperature_c) > saturation(surface_c) {
            surface
        } else {
            let vapour = air.humidity * saturation(air.temperature_c)
                + PSYCHROMETRIC * AIR_PRESSURE * (air.temperature_c - surface_c);
            // At a humidity of 1 the logarithm below has no value.
            let humidity = (vapour / saturation(surface_c)).clamp(0.001, 0.99);
            let (scale, exponent) = sorption(0.5 * (air.temperature_c + surface_c));
            let equilibrium = scale * ops::pow(-ops::ln(1.0 - humidity), exponent);
            let conductance = if equilibrium > surface { self.size.adsorption_cm_h } else { 0.06 };
            let biot = conductance * self.spacing_cm() / self.diffusivity[0];
            (inner + biot * equilibrium) / (1.0 + biot)
        }
        .clamp(0.0, MAX_MOISTURE);
    }

    /// Returns the temperature at which the surface gains as much heat as it loses: to the air, to the sky (3 degrees warm by
    /// night, 6 by day) and, where no rain falls, by water that condenses or evaporates.
    fn balanced_temperature_c(&self, air: &Air) -> f64 {
        let is_day = air.solar_w_m2 > 0.0;
        // 4 emissivity x Stefan and Boltzmann's constant x T^3 / pi, at the temperature of the sky.
        let (to_sky, sky_c) = if is_day { (0.116_171, 6.0) } else { (0.112_467, 3.0) };
        // A pyranometer has a millivolt for each 94.743 W/m2.
        let gain = air.solar_w_m2 / 94.743 - to_sky * (air.temperature_c - sky_c);
        let dry_c = air.temperature_c + gain / (to_sky + self.to_air);
        if air.rain_cm > 0.0 {
            return dry_c;
        }
        // Chilton and Colburn's analogy; Prandtl's number of air 0.7, Schmidt's of vapour in it 0.58.
        let vapour_transfer = 0.622 * self.to_air * ops::pow(0.7 / 0.58, 0.667);
        let by_vapour = PSYCHROMETRIC * vapour_transfer / 0.24 * latent_heat(dry_c + KELVIN) / 18.0;
        air.temperature_c + gain / (to_sky + self.to_air + by_vapour)
    }

    /// Moves heat and water between the nodes. Each node weighs its own value of before against those of its neighbours
    /// (Patankar 1980, section 3.4, with old neighbours), which is stable for steps of any length.
    fn diffuse(&mut self, step_h: f64) {
        // In cm2/h; unlike that of water it does not depend on the moisture.
        const HEAT_DIFFUSIVITY: f64 = 8.0;
        let spacing = self.spacing_cm();
        let radius = |node: usize| spacing * (NODES - 1 - node) as f64;
        let moisture = self.moisture;
        let temperature_c = self.temperature_c;
        for node in 1..NODES - 1 {
            let (outside, inside) = (node - 1, node + 1);
            let storage = radius(node) * spacing / step_h;
            let mixed = |old: &[f64; NODES], out: f64, within: f64| {
                let [out, within] = [out * radius(outside) / spacing, within * radius(inside) / spacing];
                (out * old[outside] + within * old[inside] + storage * old[node]) / (out + within + storage)
            };
            self.moisture[node] =
                mixed(&moisture, self.diffusivity[outside], self.diffusivity[inside]).min(MAX_MOISTURE);
            self.temperature_c[node] = mixed(&temperature_c, HEAT_DIFFUSIVITY, HEAT_DIFFUSIVITY);
        }
        // No flow crosses the axis, by symmetry.
        self.moisture[NODES - 1] = self.moisture[NODES - 2];
        self.temperature_c[NODES - 1] = self.temperature_c[NODES - 2];
    }

    fn spacing_cm(&self) -> f64 {
        self.size.radius_cm / (NODES - 1) as f64
    }
}

/// Pressure of saturated vapour, cal/cm3.
fn saturation(temperature_c: f64) -> f64 {
    2.39e-5 * ops::exp(20.58 - 5205.0 / (temperature_c + KELVIN))
}

/// Heat that a mole of water takes up as it evaporates, cal.
fn latent_heat(kelvin: f64) -> f64 {
    13_550.0 - 10.22 * kelvin
}

/// Returns a and b of the equilibrium moisture a (-ln(1 - humidity))^b.
fn sorption(temperature_c: f64) -> (f64, f64) {
    (0.1617 - 0.001_419 * temperature_c, 0.4657 + 0.003_578 * temperature_c)
}

/// Returns how fast water diffuses in wood, as vapour in its cavities and bound to their walls, cm2/h.
fn diffusivity(temperature_c: f64, moisture: f64) -> f64 {
    let kelvin = temperature_c + KELVIN;
    let (scale, exponent) = sorption(temperature_c);
    let saturated = scale * ops::pow(-ops::ln(0.01), exponent);
    // Water beyond the saturation of the walls is not bound.
    let bound = moisture.min(saturated).max(1e-6);
    // The slope of the humidity in equilibrium over the moisture.
    let slope = if moisture < saturated {
        let dryness = ops::pow(bound / scale, 1.0 / exponent);
        dryness / (bound * exponent) * ops::exp(-dryness)
    } else {
        0.0
    };
    let water = bound / (1.3 - 0.64 * bound);
    let wall = (0.685 + water) / (1.0 / DENSITY + water);
    let in_air = 0.22 * 3600.0 * (0.0242 / AIR_PRESSURE) * ops::pow(kelvin / KELVIN, 1.75);
    let vapour = 18.0 * 0.016 * (1.0 - wall) * in_air * saturation(temperature_c) * slope / (DENSITY * GAS * kelvin);
    let of_vapour = (7.22 + 0.002_374 * kelvin + 2.67e-7 * kelvin * kelvin) * kelvin;
    let sorption_heat = 5040.0 * ops::exp(-14.0 * bound);
    let activation = (latent_heat(kelvin) + sorption_heat - of_vapour) / 1.2;
    let tortuosity = (2.0 - water / (0.685 + water)) * (1.0 - (1.0 - wall).sqrt()) * wall;
    vapour + 3600.0 * 0.0985 / tortuosity * ops::exp(-activation / (GAS * kelvin))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DAY: Air = Air { temperature_c: 28.0, humidity: 0.25, solar_w_m2: 800.0, rain_cm: 0.0 };
    const NIGHT: Air = Air { temperature_c: 12.0, humidity: 0.8, solar_w_m2: 0.0, rain_cm: 0.0 };

    #[test]
    fn thick_sticks_dry_later_and_all_stay_within_bounds() {
        let mut sticks = SIZES.map(Stick::new);
        let mut swings = [[f64::INFINITY, 0.0]; 4];
        for hour in 0..96 {
            let rain_cm = if hour == 40 { 0.5 } else { 0.0 };
            let air = if hour / 12 % 2 == 0 { Air { rain_cm, ..DAY } } else { Air { rain_cm, ..NIGHT } };
            for (stick, [min, max]) in sticks.iter_mut().zip(&mut swings) {
                stick.advance_hour(&air);
                let moisture = stick.median_moisture();
                (*min, *max) = (min.min(moisture), max.max(moisture));
                let nodes = stick.moisture.iter().all(|moisture| (0.0..=MAX_MOISTURE).contains(moisture));
                assert!(nodes, "hour {hour}: {:?}", stick.moisture);
            }
        }
        let swings = swings.map(|[min, max]| max - min);
        assert!(swings.is_sorted_by(|thin, thick| thin > thick), "{swings:?}");
    }

    #[test]
    fn a_thin_stick_comes_into_balance_with_still_air() {
        let mut stick = Stick::new(SIZES[0]);
        // Dark and dry, at the temperature of the sky: the surface is as warm as the air.
        let air = Air { temperature_c: 3.0, humidity: 0.4, solar_w_m2: 0.0, rain_cm: 0.0 };
        (0..100).for_each(|_| stick.advance_hour(&air));
        let (scale, exponent) = sorption(3.0);
        let balance = scale * ops::pow(-ops::ln(0.6), exponent);
        assert!((stick.surface_temperature_c() - 3.0).abs() < 1e-12);
        assert!((stick.median_moisture() - balance).abs() < 1e-6, "{} and {balance}", stick.median_moisture());
    }
}
