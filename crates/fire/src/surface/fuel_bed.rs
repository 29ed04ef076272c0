//! A fuel model with moistures: all that does not depend on wind and slope.

use super::{BTU_J, Curing, FOOT_M, FOOT_PER_MINUTE, FuelMoisture};
use crate::fuel::FuelModel;
use wildfire_base::geometry::ops;

/// Density of dry wood, in lb/ft3, the same in all models.
const PARTICLE_DENSITY: f64 = 32.0;
/// Mineral content of fuel, and the part of it that is no silica.
const MINERALS: f64 = 0.0555;
const EFFECTIVE_MINERALS: f64 = 0.010;

/// Lower ends of the size classes in which net loads are summed (Albini, 1976), by surface-area-to-volume ratio.
const SIZE_BINS: [f64; 5] = [1200.0, 192.0, 96.0, 48.0, 16.0];

/// The mean moisture of the dead or the live fuel, and the moisture from which on it does not burn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelState {
    pub moisture: f64,
    pub extinction: f64,
}

/// A fuel bed without wind and slope, and what these will multiply it by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelBed {
    /// Rate without wind and slope, ft/min; zero where nothing burns.
    pub(super) r0: f64,
    /// Btu/ft2/min.
    pub(super) reaction_intensity: f64,
    /// Minutes.
    pub(super) residence: f64,
    /// The factor of wind is `wind_scale` times the wind in ft/min to the power of `wind_exponent` (47).
    pub(super) wind_scale: f64,
    pub(super) wind_exponent: f64,
    /// The factor of slope is this times the square of rise over run (51).
    pub(super) slope_scale: f64,
    /// Of the dead fuel, `None` where there is none.
    pub dead: Option<FuelState>,
    /// Of the live fuel, `None` where there is none.
    pub live: Option<FuelState>,
}

/// Fuel of one size, dead or live.
#[derive(Clone, Copy)]
struct SizeClass {
    load: f64,
    sav: f64,
    moisture: f64,
}

impl SizeClass {
    /// Surface per area of ground (53).
    fn area(self) -> f64 {
        self.sav * self.load / PARTICLE_DENSITY
    }
}

/// Sums over classes; those without load add nothing.
fn sum(classes: &[SizeClass], value: impl Fn(SizeClass) -> f64) -> f64 {
    classes.iter().filter(|class| class.load > 0.0).map(|&class| value(class)).sum()
}

/// Means over classes by their surface (56); zero without any.
fn mean(classes: &[SizeClass], value: impl Fn(SizeClass) -> f64) -> f64 {
    let area = sum(classes, SizeClass::area);
    if area > 0.0 { sum(classes, |class| class.area() / area * value(class)) } else { 0.0 }
}

fn size_bin(sav: f64) -> usize {
    SIZE_BINS.iter().take_while(|&&lower| sav < lower).count()
}

/// Weighs each load by the surface of its size class, without minerals (Albini, 1976, in place of 24 and 59).
fn net_load(classes: &[SizeClass]) -> f64 {
    let area = sum(classes, SizeClass::area);
    sum(classes, |class| {
        sum(classes, |other| if size_bin(other.sav) == size_bin(class.sav) { other.area() / area } else { 0.0 })
            * class.load
            * (1.0 - MINERALS)
    })
}

/// The part of the reaction that moisture leaves (29); nothing from the extinction moisture on.
fn moisture_damping(state: FuelState) -> f64 {
    let ratio = state.moisture / state.extinction;
    // The polynomial does not quite vanish at 1, and means of equal moistures may be a rounding away from them.
    if ratio >= 1.0 - 1e-12 { 0.0 } else { 1.0 - ratio * (2.59 - ratio * (5.11 - ratio * 3.52)) }
}

/// Returns the moisture from which on live fuel does not burn: the more dry dead fuel, the higher (Albini, 1976, for 88).
fn live_extinction(dead: &[SizeClass], live: &[SizeClass], dead_extinction: f64) -> f64 {
    let fine_dead = sum(dead, |class| class.load * ops::exp(-138.0 / class.sav));
    let fine_live = sum(live, |class| class.load * ops::exp(-500.0 / class.sav));
    if fine_dead == 0.0 || fine_live == 0.0 {
        return dead_extinction;
    }
    let moisture = sum(dead, |class| class.moisture * class.load * ops::exp(-138.0 / class.sav)) / fine_dead;
    (2.9 * (fine_dead / fine_live) * (1.0 - moisture / dead_extinction) - 0.226).max(dead_extinction)
}

impl FuelBed {
    /// Computes the bed of a fuel model with these moistures.
    pub fn new(model: &FuelModel, moisture: &FuelMoisture, curing: Curing) -> Self {
        let FuelMoisture { d1, d10, d100, herb, woody } = *moisture;
        let cured = match curing {
            _ if !model.is_dynamic() => 0.0,
            // (1.2 - herb) / 0.9, with factors by which 0.3 gives 1.
            Curing::Exact => ((12.0 - 10.0 * herb) / 9.0).clamp(0.0, 1.0),
            Curing::Behave => (1.333 - 1.11 * herb).clamp(0.0, 1.0),
        };
        let class = |size: usize, share: f64, moisture| SizeClass {
            load: share * model.loads[size],
            sav: model.savs[size],
            moisture,
        };
        // Cured grass is as fine as it was alive and as dry as what is dead.
        let dead = [class(0, 1.0, d1), class(1, 1.0, d10), class(2, 1.0, d100), class(3, cured, d1)];
        let live = [class(3, 1.0 - cured, herb), class(4, 1.0, woody)];
        let areas = [sum(&dead, SizeClass::area), sum(&live, SizeClass::area)];
        let area = areas[0] + areas[1];
        if area == 0.0 {
            return Self::without_fuel();
        }
        // The mean over both categories (56, 57).
        let overall = |value: &dyn Fn(SizeClass) -> f64| {
            areas[0] / area * mean(&dead, value) + areas[1] / area * mean(&live, value)
        };

        let sav = overall(&|class| class.sav);
        // Bulk density (40), packing ratio (31), and that over its optimum (37).
        let bulk_density = model.loads.iter().sum::<f64>() / model.depth_ft;
        let packing = bulk_density / PARTICLE_DENSITY;
        let relative_packing = packing / (3.348 * ops::pow(sav, -0.8189));

        let dead_state = fuel_state(&dead, model.dead_extinction);
        let live_state = fuel_state(&live, live_extinction(&dead, &live, model.dead_extinction));
        let mineral_damping = (0.174 * ops::pow(EFFECTIVE_MINERALS, -0.19)).min(1.0);
        let burning_dead = net_load(&dead) * moisture_damping(dead_state);
        let burning_live = net_load(&live) * moisture_damping(live_state);
        // The greatest reaction velocity (36), and Albini's (1976) exponent in place of (39).
        let coarse = sav * sav.sqrt();
        let fastest = coarse / (495.0 + 0.0594 * coarse);
        let exponent = 133.0 * ops::pow(sav, -0.7913);
        let reaction_velocity =
            fastest * ops::pow(relative_packing, exponent) * ops::exp(exponent * (1.0 - relative_packing));
        let heat = model.heat_btu_lb;
        // Most models have one heat content, and runs depend on the order of these factors.
        let burning_heat = if heat == model.live_heat_btu_lb {
            reaction_velocity * (burning_dead + burning_live) * heat
        } else {
            reaction_velocity * (burning_dead * heat + burning_live * model.live_heat_btu_lb)
        };
        let reaction_intensity = burning_heat * mineral_damping;

        // The ratio of the propagating flux (42), and the heat that ignites the bed (12, 14).
        let flux = ops::exp((0.792 + 0.681 * sav.sqrt()) * (packing + 0.1)) / (192.0 + 0.2595 * sav);
        let heat_sink =
            bulk_density * overall(&|class| ops::exp(-138.0 / class.sav) * (250.0 + 1116.0 * class.moisture));
        // Wind coefficients (48 to 50).
        let wind_power = 0.715 * ops::exp(-3.59e-4 * sav);
        Self {
            r0: reaction_intensity * flux / heat_sink,
            reaction_intensity,
            residence: 384.0 / sav,
            wind_scale: 7.47 * ops::exp(-0.133 * ops::pow(sav, 0.55)) * ops::pow(relative_packing, -wind_power),
            wind_exponent: 0.02526 * ops::pow(sav, 0.54),
            slope_scale: 5.275 * ops::pow(packing, -0.3),
            dead: (areas[0] > 0.0).then_some(dead_state),
            live: (areas[1] > 0.0).then_some(live_state),
        }
    }

    fn without_fuel() -> Self {
        Self {
            r0: 0.0,
            reaction_intensity: 0.0,
            residence: 0.0,
            wind_scale: 1.0,
            wind_exponent: 1.0,
            slope_scale: 0.0,
            dead: None,
            live: None,
        }
    }

    /// Says whether a fire spreads in it: there is fuel, and it is dry enough.
    pub fn burns(&self) -> bool {
        self.r0 > 0.0
    }

    /// Returns the rate without wind and slope.
    pub fn r0_mps(&self) -> f64 {
        self.r0 * FOOT_PER_MINUTE
    }

    /// Returns how long a point flames (Anderson, 1969).
    pub fn residence_s(&self) -> f64 {
        self.residence * 60.0
    }

    /// Returns the heat that a burning square metre gives off.
    pub fn reaction_intensity_kw_m2(&self) -> f64 {
        self.reaction_intensity * BTU_J / (FOOT_M * FOOT_M) / 60.0 / 1000.0
    }
}

fn fuel_state(classes: &[SizeClass], extinction: f64) -> FuelState {
    FuelState { moisture: mean(classes, |class| class.moisture), extinction }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuel::FUEL_MODELS;

    fn bed(name: &str, moisture: FuelMoisture) -> FuelBed {
        FuelBed::new(FuelModel::by_name(name).expect("it is one"), &moisture, Curing::Exact)
    }

    fn with_dead(moisture: f64) -> FuelMoisture {
        FuelMoisture { d1: moisture, d10: moisture, d100: moisture, ..FuelMoisture::default() }
    }

    /// Fuel of one size, for which the sums over classes vanish: reckoned by a separate program.
    #[test]
    fn beds_of_one_class_burn_as_reckoned_by_hand() {
        for (name, moisture, r0_m_min, heat_kw_m2, residence_s) in [
            ("R01", 0.06, 1.403_696_779_688_525_4, 156.366_626_353_924_46, 6.582_857_142_857_143),
            ("R03", 0.10, 1.180_692_026_207_335, 489.317_095_556_483_7, 15.36),
        ] {
            let bed = bed(name, with_dead(moisture));
            for (found, expected) in [
                (bed.r0_mps() * 60.0, r0_m_min),
                (bed.reaction_intensity_kw_m2(), heat_kw_m2),
                (bed.residence_s(), residence_s),
            ] {
                assert!((found / expected - 1.0).abs() < 1e-12, "{name}: {found}, expected {expected}");
            }
        }
    }

    #[test]
    fn fire_goes_out_at_the_extinction_moisture_and_is_slower_the_nearer_to_it() {
        for model in FUEL_MODELS.iter().filter(|model| model.burns()) {
            let live = model.dead_extinction.max(3.0);
            let rate = |share: f64| {
                let moisture = with_dead(share * model.dead_extinction);
                let moisture = FuelMoisture { herb: live, woody: live, ..moisture };
                FuelBed::new(model, &moisture, Curing::Exact).r0_mps()
            };
            let rates: Vec<f64> = (0..10).map(|tenths| rate(f64::from(tenths) / 10.0)).collect();
            assert!(rates.is_sorted_by(|drier, wetter| drier > wetter) && rates[9] > 0.0, "{}: {rates:?}", model.code);
            assert_eq!([rate(1.0), rate(1.01), rate(3.0)], [0.0; 3], "{}", model.code);
        }
    }

    #[test]
    fn what_has_no_fuel_never_burns() {
        for model in FUEL_MODELS.iter().filter(|model| !model.burns()) {
            let bed = FuelBed::new(model, &FuelMoisture::default(), Curing::Exact);
            assert_eq!((bed.burns(), bed.r0_mps(), bed.residence_s()), (false, 0.0, 0.0));
            assert_eq!((bed.dead, bed.live), (None, None));
        }
    }

    #[test]
    fn grass_is_dead_at_30_percent_and_alive_at_120() {
        let states = |herb: f64| {
            let bed = bed("GR1", FuelMoisture { herb, ..FuelMoisture::default() });
            (bed.dead.is_some(), bed.live.is_some())
        };
        assert_eq!([states(0.2), states(0.3), states(0.31)], [(true, false), (true, false), (true, true)]);
        // The 1-h load is dead in any case.
        assert_eq!([states(1.19), states(1.2), states(3.0)], [(true, true); 3]);
        let rate = |curing, herb| {
            let model = FuelModel::by_name("GR1").expect("it is one");
            FuelBed::new(model, &FuelMoisture { herb, ..FuelMoisture::default() }, curing).r0_mps()
        };
        assert_eq!(rate(Curing::Exact, 0.3), rate(Curing::Exact, 0.1), "all is dead");
        assert!(rate(Curing::Exact, 0.5) > rate(Curing::Exact, 0.6));
        let rounded = rate(Curing::Behave, 0.6) / rate(Curing::Exact, 0.6);
        assert!(rounded != 1.0 && (rounded - 1.0).abs() < 0.02, "{rounded}");
        // Anderson's grass is never cured, and his shrubs take the moisture of woody fuel.
        for (name, herb, woody) in [("R02", 0.9, 0.5), ("R04", 0.5, 0.9)] {
            let live = bed(name, FuelMoisture { herb, woody, ..FuelMoisture::default() }).live.expect("there is some");
            assert!((live.moisture - 0.9).abs() < 1e-12, "{name}");
        }
    }
}
