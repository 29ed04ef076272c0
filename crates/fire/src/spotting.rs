//! The greatest distance at which a firebrand lights a spot fire, by Albini's models.
//!
//! Albini, F.A. 1979. Spot fire distance from burning trees. General Technical Report INT-56. Albini, F.A. 1981. Spot fire
//! distance from isolated sources. Research Note INT-309. Albini, F.A. 1983. Potential spotting distance from wind-driven
//! surface fires. Research Paper INT-309. Mountains: Chase, C.H. 1984. Spotting distance from wind-driven surface fires.
//! Research Note INT-346. All of the USDA Forest Service; units are theirs.

use std::f64::consts::PI;

use wildfire_base::geometry::ops;

/// A tree species by its name: coefficient and exponent of the steady flame's height in ft, and of its duration (a number
/// without unit), over the diameter at breast height in inches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Species(pub &'static str, [f64; 2], [f64; 2]);

pub const SPECIES: [Species; 14] = [
    Species("Engelmann spruce", [15.7, 0.451], [12.6, -0.256]),
    Species("Douglas-fir", [15.7, 0.451], [10.7, -0.278]),
    Species("subalpine fir", [15.7, 0.451], [10.7, -0.278]),
    Species("western hemlock", [15.7, 0.451], [6.3, -0.249]),
    Species("ponderosa pine", [12.9, 0.453], [12.6, -0.256]),
    Species("lodgepole pine", [12.9, 0.453], [12.6, -0.256]),
    Species("western white pine", [12.9, 0.453], [10.7, -0.278]),
    Species("grand fir", [16.5, 0.515], [10.7, -0.278]),
    Species("balsam fir", [16.5, 0.515], [10.7, -0.278]),
    Species("slash pine", [2.71, 1.0], [11.9, -0.389]),
    Species("longleaf pine", [2.71, 1.0], [11.9, -0.389]),
    Species("pond pine", [2.71, 1.0], [7.91, -0.344]),
    Species("shortleaf pine", [2.71, 1.0], [7.91, -0.344]),
    Species("loblolly pine", [2.71, 1.0], [13.5, -0.544]),
];

/// The fire that lifts the firebrands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    /// Trees that burn together.
    TorchingTrees { trees: f64, species: &'static Species, dbh_in: f64, height_ft: f64 },
    /// A pile with a steady flame of this height.
    BurningPile { flame_ft: f64 },
    /// A surface fire with flames of this length, driven by the wind.
    SurfaceFire { flame_ft: f64 },
}

/// Where on a slope the source is; the downwind side of the ridge is the lee.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    MidslopeWindward,
    ValleyBottom,
    MidslopeLeeward,
    RidgeTop,
}

/// Where firebrands come from and where they go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spotting {
    pub source: Source,
    pub location: Location,
    /// The horizontal distance in miles and the difference in elevation in ft.
    pub ridge_to_valley: [f64; 2],
    /// The mean height of what is downwind; half of it counts where it is `open`.
    pub cover_ft: f64,
    pub open: bool,
    pub wind_20ft_mph: f64,
}

/// The spotting distance and its intermediate results; all are zero without wind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpotDistance {
    /// The flame height of torching trees; zero for other sources.
    pub flame_ft: f64,
    pub flame_duration: f64,
    pub firebrand_ft: f64,
    /// The height of the cover that counts: at least what Albini's wind profile needs.
    pub cover_ft: f64,
    /// Of a surface fire's firebrands while the plume lifts them; zero for other sources.
    pub drift_mi: f64,
    pub flat_mi: f64,
    pub mountain_mi: f64,
}

impl Spotting {
    pub fn distance(&self) -> SpotDistance {
        let wind = self.wind_20ft_mph;
        if wind <= 0.0 {
            return SpotDistance::default();
        }
        let mut spot = self.lift();
        let height = spot.firebrand_ft;
        let cover = if self.open { 0.5 * self.cover_ft } else { self.cover_ft };
        spot.cover_ft = cover.max(2.2 * ops::pow(height, 0.337) - 4.0).max(0.0);
        spot.flat_mi = spot.drift_mi;
        // Where nothing is lifted, only the drift is left: the logarithm of 0 has no value.
        if spot.cover_ft > 0.0 && height > 0.0 {
            let ratio = height / spot.cover_ft;
            let fall = 0.362 + 0.5 * ratio.sqrt() * ops::ln(ratio);
            spot.flat_mi += 0.000718 * wind * spot.cover_ft.sqrt() * fall;
        }
        spot.mountain_mi = self.over_mountains(spot.flat_mi);
        spot
    }

    /// Computes how high firebrands get, and what belongs to the source.
    fn lift(&self) -> SpotDistance {
        let default = SpotDistance::default();
        match self.source {
            Source::TorchingTrees { trees, species, dbh_in, height_ft } => {
                let of_diameter = |[factor, exponent]: [f64; 2]| factor * ops::pow(dbh_in, exponent);
                let flame_ft = of_diameter(species.1) * ops::pow(trees, 0.4);
                let flame_duration = of_diameter(species.2) * ops::pow(trees, -0.2);
                // The four fits of Albini (1979): by tree over flame height and, for low trees, by duration.
                let (factor, exponent) = match height_ft / flame_ft {
                    ratio if ratio >= 1.0 => (4.24, 0.332),
                    ratio if ratio >= 0.5 => (3.64, 0.391),
                    _ if flame_duration < 3.5 => (2.78, 0.418),
                    _ => (4.70, 0.0),
                };
                // Firebrands rise from half of the height of the tree.
                let firebrand_ft = factor * ops::pow(flame_duration, exponent) * flame_ft + 0.5 * height_ft;
                SpotDistance { flame_ft, flame_duration, firebrand_ft, ..default }
            }
            Source::BurningPile { flame_ft } => SpotDistance { firebrand_ft: 12.2 * flame_ft, ..default },
            Source::SurfaceFire { flame_ft } => {
                // Byram's intensity in Btu/ft/s, and the share of it that goes into gusts of the plume.
                let intensity = ops::pow(flame_ft / 0.45, 1.0 / 0.46);
                let gusts = 322.0 * ops::pow(0.474 * self.wind_20ft_mph, -1.01);
                let firebrand_ft = 1.055 * (gusts * intensity).sqrt();
                let drift_mi = 0.000278 * self.wind_20ft_mph * ops::pow(firebrand_ft, 0.643);
                SpotDistance { firebrand_ft, drift_mi, ..default }
            }
        }
    }

    /// Turns a distance over level ground into one over a ridge and a valley that follow each other like a cosine. Six steps
    /// of a fixed-point iteration, as BEHAVE takes.
    fn over_mountains(&self, flat_mi: f64) -> f64 {
        let [length, rise_ft] = self.ridge_to_valley;
        if length <= 0.0 || rise_ft <= 0.0 {
            return flat_mi;
        }
        let phase = PI / 2.0 * f64::from(self.location as u8);
        let flat = flat_mi / length;
        let amplitude = rise_ft / (10_000.0 * PI);
        (0..6).fold(flat, |at, _| flat - amplitude * (ops::cos(PI * at - phase) - ops::cos(phase))) * length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PILE: Spotting = Spotting {
        source: Source::BurningPile { flame_ft: 5.0 },
        location: Location::RidgeTop,
        ridge_to_valley: [1.0, 2000.0],
        cover_ft: 30.0,
        open: false,
        wind_20ft_mph: 5.0,
    };

    fn is_near(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-6 * expected
    }

    #[test]
    fn firebrands_fly_as_far_as_by_hand() {
        // 12.2 x 5 = 61 ft; over 30 ft of cover the ratio is 2.0333, its root 1.42595, its logarithm 0.709677.
        let spot = PILE.distance();
        let flat = 0.000718 * 5.0 * 5.477_225_575 * (0.362 + 0.5 * 1.425_949_975 * 0.709_676_595);
        assert!(is_near(spot.flat_mi, flat) && is_near(spot.firebrand_ft, 61.0), "{spot:?}");
        assert_eq!(Spotting { ridge_to_valley: [1.0, 0.0], ..PILE }.distance().mountain_mi, spot.flat_mi);
        assert_eq!(Spotting { wind_20ft_mph: 0.0, ..PILE }.distance(), SpotDistance::default());
        // 15.7 x 20^0.451 x 15^0.4 and 12.6 x 20^-0.256 x 15^-0.2; the trees are lower than half of the flame.
        let source = Source::TorchingTrees { trees: 15.0, species: &SPECIES[0], dbh_in: 20.0, height_ft: 30.0 };
        let trees = Spotting { source, ..PILE }.distance();
        assert!((trees.flame_ft - 179.1).abs() < 0.1 && (trees.flame_duration - 3.405).abs() < 1e-3, "{trees:?}");
        let unlit = Spotting { source: Source::BurningPile { flame_ft: 0.0 }, ..PILE }.distance();
        assert_eq!((unlit.flat_mi, unlit.mountain_mi), (0.0, 0.0));
        let source = Source::SurfaceFire { flame_ft: 10.0 };
        let surface = Spotting { source, ..PILE }.distance();
        let source = Source::BurningPile { flame_ft: surface.firebrand_ft / 12.2 };
        assert!(is_near(surface.flat_mi, Spotting { source, ..PILE }.distance().flat_mi + surface.drift_mi));
    }
}
