//! From the wind of weather stations to the wind that a flame feels (Albini and Baughman, INT-221, 1979).

use wildfire_base::geometry::ops;

/// The least part of the ground, covered by crowns and filled by them to a third, that shelters it; and their least height.
const SHELTERING_SHARE: f64 = 0.05;
const SHELTERING_HEIGHT_FT: f64 = 6.0;

/// A part by which rounding may make either smaller than it is: layers of trees are in whole percent and tenths of metres, so
/// that much land lies at the limit to the digit.
const ROUNDING: f64 = 1e-9;

/// Returns the wind 20 ft above the vegetation for one at 10 m.
pub fn twenty_foot_wind(at_10_m: f64) -> f64 {
    at_10_m / 1.15
}

/// Returns the wind at the middle of the flames as a part of the one 20 ft above fuel of this depth that nothing
/// shelters; zero for fuel without depth.
pub fn unsheltered_adjustment(depth_ft: f64) -> f64 {
    if depth_ft > 0.0 { 1.83 / ops::ln((20.0 + 0.36 * depth_ft) / (0.13 * depth_ft)) } else { 0.0 }
}

/// Returns the same below trees that cover a part of the ground; `None` if they are too few or too low to shelter it.
pub fn sheltered_adjustment(canopy_height_ft: f64, canopy_cover: f64) -> Option<f64> {
    let filled = canopy_cover / 3.0;
    let is_below = |value: f64, limit: f64| value < limit * (1.0 - ROUNDING);
    if is_below(filled, SHELTERING_SHARE) || is_below(canopy_height_ft, SHELTERING_HEIGHT_FT) {
        return None;
    }
    let profile = ops::ln((20.0 + 0.36 * canopy_height_ft) / (0.13 * canopy_height_ft));
    Some(0.555 / ((filled * canopy_height_ft).sqrt() * profile))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deeper_fuel_reaches_into_more_wind_and_trees_take_it() {
        let depths = [0.2, 0.4, 1.0, 2.5, 6.0].map(unsheltered_adjustment);
        assert!(depths.is_sorted() && depths[0] > 0.2 && depths[4] < 0.6, "{depths:?}");
        assert_eq!(unsheltered_adjustment(0.0), 0.0);
        for height_ft in [6.0, 20.0, 60.0, 120.0] {
            for cover in [0.2, 0.4, 1.0] {
                let sheltered = sheltered_adjustment(height_ft, cover).expect("there are trees");
                assert!((0.0..0.4).contains(&sheltered), "{height_ft} {cover}: {sheltered}");
            }
        }
        assert_eq!((sheltered_adjustment(5.9, 1.0), sheltered_adjustment(60.0, 0.14)), (None, None));
    }
}
