//! Water that puts out a fire front: what its flame and its hot fuel give off as heat, water takes up as it boils.
//!
//! Van Wagner, C.E. and Taylor, S.W. 2022. Theoretical amounts of water to put out forest fires. Natural Resources Canada,
//! Canadian Forest Service, Information Report BC-X-458: equations 1, 2, 7b and 10b, in kilocalories there. The least
//! amounts in theory; what is applied by hand takes two to four times as much (their table 4).

use wildfire_base::geometry::ops;

/// Heat of a kilogram of fuel, of all models: 8,000 Btu/lb.
const FUEL_KJ_KG: f64 = 18_608.0;

/// Kilojoules of a kilocalorie.
pub const KJ_PER_KCAL: f64 = 4.184;

/// Temperatures of the air and of the steam that water becomes, degrees Celsius.
const AIR_C: f64 = 20.0;
const STEAM_C: f64 = 100.0;

/// Returns the heat that a kilogram of water takes up, kJ, from the temperature of the air to that of its steam, 100 degrees
/// Celsius or more (equation 1).
pub fn heat_kj_kg(air_c: f64, steam_c: f64) -> f64 {
    (100.0 - air_c + 540.0 + 0.46 * (steam_c - 100.0)) * KJ_PER_KCAL
}

/// Returns the intensity of the hottest front that a pump puts out, whose jet covers some metres of it at once.
pub fn max_kw_m(pump_lps: f64, jet_m: f64) -> f64 {
    pump_lps * heat_kj_kg(AIR_C, STEAM_C) / jet_m
}

/// Returns how deep the flame of a front is, metres: half the flame's length by Thomas (1963) (equation 2).
pub fn flame_depth_m(intensity_kw_m: f64) -> f64 {
    0.5 * 0.0792 * two_thirds(intensity_kw_m)
}

/// Returns the water that quenches the flame, mm on the depth of the flame (equation 7b).
pub fn quenching_mm(intensity_kw_m: f64) -> f64 {
    3.84e-4 * two_thirds(intensity_kw_m)
}

/// Returns the water that cools the hot fuel in it, mm, by its dry weight (equation 10b).
pub fn cooling_mm(fuel_kg_m2: f64) -> f64 {
    0.226 * fuel_kg_m2
}

/// Returns the litres that put out a metre of front: flame and fuel, on the depth of the flame.
pub fn litres_per_m(intensity_kw_m: f64, fuel_kg_m2: f64) -> f64 {
    flame_depth_m(intensity_kw_m) * (quenching_mm(intensity_kw_m) + cooling_mm(fuel_kg_m2))
}

/// Returns the fuel that gives off some heat as it flames, both by the square metre.
pub fn fuel_kg_m2(heat_kj_m2: f64) -> f64 {
    heat_kj_m2 / FUEL_KJ_KG
}

fn two_thirds(intensity_kw_m: f64) -> f64 {
    ops::pow(intensity_kw_m.max(0.0) / KJ_PER_KCAL, 2.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance * expected.abs(), "{found}, expected {expected}");
    }

    #[test]
    fn flames_and_water_are_those_that_were_published() {
        // Tables 2 and 3: kcal/(s m), flame depth in m (half of a printed length) and water in mm, as printed.
        for (kcal, depth_m, water_mm) in [(100.0, 0.855, 0.008), (1000.0, 3.96, 0.038), (10_000.0, 18.4, 0.18)] {
            assert_near(flame_depth_m(kcal * KJ_PER_KCAL), depth_m, 2.5e-3);
            assert_near(quenching_mm(kcal * KJ_PER_KCAL), water_mm, 0.04);
        }
        for (fuel_kg_m2, water_mm) in [(1.25, 0.28), (2.5, 0.56), (5.0, 1.13)] {
            assert_near(cooling_mm(fuel_kg_m2), water_mm, 1e-2);
        }
        assert_near(heat_kj_kg(20.0, 100.0), 620.0 * KJ_PER_KCAL, 1e-12);
        assert_near(heat_kj_kg(20.0, 200.0), 666.0 * KJ_PER_KCAL, 1e-12);
    }

    #[test]
    fn formulas_hold_to_nine_digits() {
        // Cubes have exact powers of two thirds.
        for root in [1.0, 5.0, 10.0, 20.0] {
            let intensity = root * root * root * KJ_PER_KCAL;
            assert_near(flame_depth_m(intensity), 0.0396 * root * root, 1e-12);
            let water_mm = 3.84e-4 * root * root + 0.226 * 2.5;
            assert_near(litres_per_m(intensity, 2.5), 0.0396 * root * root * water_mm, 1e-12);
        }
        assert_eq!(litres_per_m(0.0, 2.5), 0.0);
    }
}
