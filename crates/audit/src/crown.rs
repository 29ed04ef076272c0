//! The ellipse of a fire below trees, found without the code that the fire model has for crowns.
//!
//! Rates of fuel beds are those of [`wildfire_fire::surface`]. Van Wagner's criteria, the shelter of trees, and how much of
//! the crowns burns are computed here from the papers; the wind of active crown fires is found by halving.

use wildfire_base::geometry::{DVec2, DVec3, ops};
use wildfire_fire::surface::crown::{Canopy, CrownMethod, CrownRules};
use wildfire_fire::surface::{Ellipse, FuelBed, SurfaceOptions, WindLimit, unsheltered_adjustment};

// Written out again, as the model's code for crowns is not used here.
const FOOT_M: f64 = 0.3048;

/// More than any wind that is looked for, m/s.
const MAX_MPS: f64 = 1e6;

/// Fuel below trees in one weather.
pub struct UnderCanopy<'a> {
    pub ground: &'a FuelBed,
    pub depth_ft: f64,
    /// Fuel model 10 with the same moistures.
    pub model_10: &'a FuelBed,
    pub wind_10m_mps: DVec2,
    pub gradient: DVec2,
    /// On the rate of what spreads.
    pub rate_factor: f64,
}

/// The part of the wind above trees that is felt at the flames below them (Albini and Baughman, 1979). Trees that fill just
/// five hundredths shelter, however their numbers are rounded.
fn shelter(canopy: &Canopy, depth_ft: f64) -> f64 {
    let feet = canopy.height_m / FOOT_M;
    let filled = canopy.cover * (1.0 - canopy.base_m / canopy.height_m).max(0.0) / 3.0;
    if filled < 0.05 - 1e-11 || feet < 6.0 - 1e-8 {
        return unsheltered_adjustment(depth_ft);
    }
    0.555 / ((filled * feet).sqrt() * ops::ln((20.0 + 0.36 * feet) / (0.13 * feet)))
}

/// Returns the ellipse of a fire below these trees.
pub fn ellipse(canopy: &Canopy, below: &UnderCanopy, options: &SurfaceOptions, rules: CrownRules) -> Ellipse {
    // Crown models are for the wind at 20 ft, which is weaker than at 10 m.
    let speed = below.wind_10m_mps.length() / 1.15;
    let toward = below.wind_10m_mps.normalize_or_zero();
    let factor = shelter(canopy, below.depth_ft);
    let unlimited = SurfaceOptions { wind_limit: WindLimit::None, ..*options };
    let crown_at =
        // Rothermel 1991: the rate of crowns is that of fuel model 10 in 0.4 of the wind, whatever the ground has.
        |wind: f64| 3.34 * below.model_10.behavior(DVec2::X * (0.4 * wind), DVec2::ZERO, &unlimited).rate_mps;
    // kg/m2/min of crowns that burn at some rate in m/s.
    let flow = |rate: f64| rate * 60.0 * canopy.bulk_density_kg_m3;

    let surface = below.ground.behavior(toward * speed * factor, below.gradient, options);
    let heat = surface.reaction_intensity_kw_m2 * surface.residence_s;
    // Heat of ignition in kJ/kg, by the moisture in percent (Van Wagner, 1977).
    let kilojoules = 460.0 + 25.9 * (100.0 * rules.foliar_moisture).max(30.0);
    let critical = ops::pow(0.010 * canopy.base_m.max(0.1) * kilojoules, 1.5);
    // Below Van Wagner's critical intensity the crowns do not catch fire.
    if surface.rate_mps * heat < critical {
        return Ellipse::new(
            surface.rate_mps * below.rate_factor,
            surface.eccentricity,
            surface.heading,
            below.gradient,
        );
    }
    let crown = crown_at(speed);
    // From 3 kg of crowns per square metre and minute a fire runs through them by itself.
    if flow(crown) >= 3.0 {
        // Rothermel (1991): an eighth for each mile per hour.
        let ratio = 1.0 + 0.125 * speed / 0.44704;
        let heading = match toward {
            DVec2::ZERO => surface.heading,
            toward => DVec3::new(toward.x, toward.y, toward.dot(below.gradient)).normalize(),
        };
        // Without wind only the slope stretches it, as it does the fire on the ground.
        let ratio = if toward == DVec2::ZERO { surface.length_to_width } else { ratio };
        return Ellipse::new(crown * below.rate_factor, (1.0 - 1.0 / (ratio * ratio)).sqrt(), heading, below.gradient);
    }
    let rate = match rules.method {
        CrownMethod::Rothermel => surface.rate_mps,
        // Crowns that are too thin for any wind have no crowning wind to be found.
        CrownMethod::ScottReinhardt if flow(crown_at(MAX_MPS)) < 3.0 => surface.rate_mps,
        CrownMethod::ScottReinhardt => {
            let (mut calm, mut windy) = (0.0, MAX_MPS);
            loop {
                // Halved until no number lies between, so that the tolerance is that of the number itself.
                let middle = f64::midpoint(calm, windy);
                if middle <= calm || middle >= windy {
                    break;
                }
                if flow(crown_at(middle)) < 3.0 { calm = middle } else { windy = middle }
            }
            let first = critical / heat;
            let last = below.ground.behavior(toward * windy * factor, below.gradient, options).rate_mps;
            let burned = if last > first { ((surface.rate_mps - first) / (last - first)).clamp(0.0, 1.0) } else { 0.0 };
            surface.rate_mps * (1.0 - burned) + crown * burned
        }
    };
    Ellipse::new(rate * below.rate_factor, surface.eccentricity, surface.heading, below.gradient)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_find_the_same_trees_to_shelter() {
        let mut at_limit = 0;
        for height in (10_u32..400).step_by(5) {
            for base in (0..height).step_by(5) {
                for percent in 1..=100 {
                    let canopy = Canopy {
                        height_m: f64::from(height) / 10.0,
                        base_m: f64::from(base) / 10.0,
                        bulk_density_kg_m3: 0.1,
                        cover: f64::from(percent) / 100.0,
                    };
                    let [one, other] = [shelter(&canopy, 1.0), canopy.wind_adjustment(1.0)];
                    assert!((one - other).abs() < 1e-12 * one, "{canopy:?}: {one} {other}");
                    // By whole numbers: the part of the space that crowns fill, against 5 % of it, three times.
                    let is_sheltered = percent * (height - base) >= 15 * height && height > 18;
                    assert_eq!(one != unsheltered_adjustment(1.0), is_sheltered, "{canopy:?}");
                    at_limit += usize::from(percent * (height - base) == 15 * height);
                }
            }
        }
        assert!(at_limit > 400, "{at_limit}");
    }
}
