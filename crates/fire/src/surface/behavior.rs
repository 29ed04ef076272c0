//! A fuel bed under a wind and on a slope: the head of the fire, its shape, its heat.

use glam::{DVec2, DVec3};

use super::{BTU_J, Combine, Ellipse, FOOT_M, FOOT_PER_MINUTE, FuelBed, LengthToWidth, SurfaceOptions, WindLimit};
use wildfire_base::geometry::ops;

/// Feet per minute in a mile per hour.
pub(super) const MILE_PER_HOUR: f64 = 88.0;

/// The longest ellipse of Anderson's formula.
const MAX_LENGTH_TO_WIDTH: f64 = 8.0;

/// A fire on the ground; rates are along the slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceFire {
    /// The rate without wind and slope; zero where nothing burns.
    pub r0_mps: f64,
    /// The rate of the head.
    pub rate_mps: f64,
    /// Unit vector in the plane of the slope, x east, y north, z up; without wind and slope, where all directions are
    /// equal, north.
    pub heading: DVec3,
    /// Of the ellipse, in [0, 1).
    pub eccentricity: f64,
    /// At least 1.
    pub length_to_width: f64,
    /// Wind at midflame height that would do alone, on level ground, as much as wind and slope do together.
    pub effective_wind_mps: f64,
    /// Whether the wind limit took from that.
    pub wind_is_limited: bool,
    pub reaction_intensity_kw_m2: f64,
    pub residence_s: f64,
    /// Of the elevation: the slope that the rates are along.
    pub gradient: DVec2,
}

impl FuelBed {
    /// Computes the fire under a wind at midflame height that blows along `midflame_mps`, on ground whose elevation has
    /// this gradient.
    pub fn behavior(&self, midflame_mps: DVec2, gradient: DVec2, options: &SurfaceOptions) -> SurfaceFire {
        let steepness = length(gradient.extend(0.0));
        // Wind and slope are added in the plane of the slope, or on the map and tilted afterwards.
        let (wind, uphill) = match options.combine {
            Combine::Plane => (lift(midflame_mps, gradient), gradient.extend(steepness * steepness)),
            Combine::Flat => (midflame_mps.extend(0.0), gradient.extend(0.0)),
        };
        let wind_factor = self.wind_factor(length(wind) / FOOT_PER_MINUTE);
        let slope_factor = self.slope_scale * (steepness * steepness);
        let together = unit(wind) * wind_factor + unit(uphill) * slope_factor;
        let mut factor = length(together);
        let mut effective = self.wind_of(factor);
        // In ft/min, like the effective wind.
        let max = match options.wind_limit {
            WindLimit::None => f64::INFINITY,
            WindLimit::Rothermel1972 => 0.9 * self.reaction_intensity,
            WindLimit::Andrews2013 => 96.8 * ops::pow(self.reaction_intensity, 1.0 / 3.0),
        };
        let wind_is_limited = effective > max;
        if wind_is_limited {
            effective = max;
            // The rate must fit the limited wind, from which the shape below follows too.
            factor = self.wind_factor(max);
        }
        let along = match options.combine {
            Combine::Plane => together,
            Combine::Flat => lift(together.truncate(), gradient),
        };
        let length_to_width = length_to_width(effective / MILE_PER_HOUR, options.length_to_width);
        SurfaceFire {
            r0_mps: self.r0_mps(),
            rate_mps: self.r0 * (1.0 + factor) * FOOT_PER_MINUTE,
            heading: unit(if along == DVec3::ZERO { lift(DVec2::Y, gradient) } else { along }),
            eccentricity: (length_to_width * length_to_width - 1.0).sqrt() / length_to_width,
            length_to_width,
            effective_wind_mps: effective * FOOT_PER_MINUTE,
            wind_is_limited,
            reaction_intensity_kw_m2: self.reaction_intensity_kw_m2(),
            residence_s: self.residence_s(),
            gradient,
        }
    }

    /// Returns the factor of a wind in ft/min (47).
    fn wind_factor(&self, wind: f64) -> f64 {
        self.wind_scale * ops::pow(wind, self.wind_exponent)
    }

    /// Returns the wind in ft/min of a factor.
    fn wind_of(&self, factor: f64) -> f64 {
        ops::pow(factor / self.wind_scale, 1.0 / self.wind_exponent)
    }

    /// Returns the wind at midflame height that has this factor.
    pub(super) fn wind_of_factor(&self, factor: f64) -> f64 {
        self.wind_of(factor) * FOOT_PER_MINUTE
    }
}

/// Lifts a horizontal vector onto a slope: what is above it there.
pub(super) fn lift(v: DVec2, gradient: DVec2) -> DVec3 {
    v.extend(v.x * gradient.x + v.y * gradient.y)
}

fn length(v: DVec3) -> f64 {
    (v.x * v.x + v.y * v.y + v.z * v.z).sqrt()
}

/// The vector of length 1 in the same direction; of zero, zero.
pub(super) fn unit(v: DVec3) -> DVec3 {
    let length = length(v);
    if length > 0.0 { v / length } else { DVec3::ZERO }
}

/// Computes how many times a fire is as long as wide, from a wind at mid-flame height.
pub(crate) fn length_to_width(effective_mph: f64, rule: LengthToWidth) -> f64 {
    let ratio = match rule {
        LengthToWidth::Anderson1983 => {
            let ratio = 0.936 * ops::exp(0.1147 * effective_mph) + 0.461 * ops::exp(-0.0692 * effective_mph) - 0.397;
            ratio.min(MAX_LENGTH_TO_WIDTH)
        }
        LengthToWidth::Linear => 1.0 + 0.25 * effective_mph,
    };
    ratio.max(1.0)
}

impl SurfaceFire {
    /// Returns the rate along a ray from the point of ignition, over a horizontal direction of any length: what travel
    /// times follow from. Zero where nothing burns.
    pub fn ray_rate_mps(&self, direction: DVec2) -> f64 {
        let e = self.eccentricity;
        self.rate_mps * (1.0 - e) / (1.0 - e * self.cosine(direction))
    }

    /// Returns the rate of a piece of the front that faces a direction (Catchpole and others, 1982): what its heat
    /// follows from. On the flanks of an ellipse it differs from the rate along the ray that leads there.
    pub fn front_normal_rate_mps(&self, direction: DVec2) -> f64 {
        let e = self.eccentricity;
        let along = self.eccentricity * self.cosine(direction);
        self.rate_mps / (1.0 + e) * (along + (1.0 - e * e + along * along).sqrt())
    }

    /// The cosine of the angle, in the plane of the slope, between the heading and what is above a direction.
    fn cosine(&self, direction: DVec2) -> f64 {
        let along = unit(lift(direction, self.gradient));
        along.x * self.heading.x + along.y * self.heading.y + along.z * self.heading.z
    }

    /// Returns the rate of the back (Alexander, 1985).
    pub fn back_rate_mps(&self) -> f64 {
        self.rate_mps * (1.0 - self.eccentricity) / (1.0 + self.eccentricity)
    }

    /// Returns the travel times of its spread from a point.
    pub fn ellipse(&self) -> Ellipse {
        Ellipse::new(self.rate_mps, self.eccentricity, self.heading, self.gradient)
    }

    /// Returns the heat that a square metre gives off while it flames.
    pub fn heat_kj_m2(&self) -> f64 {
        self.reaction_intensity_kw_m2 * self.residence_s
    }

    /// Returns the power of a metre of front that advances at this rate (Byram, 1959).
    pub fn intensity_kw_m(&self, rate_mps: f64) -> f64 {
        self.heat_kj_m2() * rate_mps
    }
}

/// Returns the length of flames of a front of this power (Byram, 1959).
pub fn flame_length_m(intensity_kw_m: f64) -> f64 {
    let btu_per_foot = intensity_kw_m * 1000.0 * FOOT_M / BTU_J;
    0.45 * FOOT_M * ops::pow(btu_per_foot, 0.46)
}

#[cfg(test)]
mod tests {
    use std::array;

    use super::*;
    use crate::fuel::{FUEL_MODELS, FuelModel};
    use crate::surface::{Curing, FuelMoisture};
    use wildfire_base::geometry::compass;

    fn beds() -> impl Iterator<Item = (&'static str, FuelBed)> {
        let models = FUEL_MODELS.iter().filter(|model| model.burns());
        models.map(|model| (&*model.code, FuelBed::new(model, &FuelMoisture::default(), Curing::Exact)))
    }

    const UNLIMITED: SurfaceOptions = SurfaceOptions {
        curing: Curing::Exact,
        combine: Combine::Plane,
        wind_limit: WindLimit::None,
        length_to_width: LengthToWidth::Anderson1983,
    };

    /// Winds and gradients of all kinds: none, along each other, against each other, across.
    fn conditions() -> impl Iterator<Item = (DVec2, DVec2)> {
        let vector = |azimuth: u32, length: f64| compass::unit_toward(f64::from(azimuth)) * length;
        let winds = [(0, 0.0), (90, 2.0), (247, 6.0), (13, 15.0)].map(|(azimuth, speed)| vector(azimuth, speed));
        let slopes = [(0, 0.0), (0, 0.2), (67, 0.5), (200, 1.0)].map(|(azimuth, rise)| vector(azimuth, rise));
        winds.into_iter().flat_map(move |wind| slopes.map(|slope| (wind, slope)))
    }

    fn is_near(found: f64, expected: f64, tolerance: f64) -> bool {
        (found - expected).abs() <= tolerance * expected.abs()
    }

    /// Reckoned by a separate program for fuel of one size.
    #[test]
    fn wind_and_slope_speed_a_fire_up_as_reckoned_by_hand() {
        for (name, dead, wind, slope, level_m_min, uphill_m_min) in [
            ("R01", 0.06, 2.0, 0.3, 25.293_289_202_124_83, 30.491_328_941_178_203),
            ("R03", 0.10, 3.0, 0.2, 44.827_047_082_561_1, 46.507_329_781_617_32),
        ] {
            let model = FuelModel::by_name(name).expect("it is one");
            let bed = FuelBed::new(model, &FuelMoisture { d1: dead, ..FuelMoisture::default() }, Curing::Exact);
            let flat = SurfaceOptions { combine: Combine::Flat, ..UNLIMITED };
            let rate = |slope| bed.behavior(DVec2::X * wind, DVec2::X * slope, &flat).rate_mps * 60.0;
            assert!(is_near(rate(0.0), level_m_min, 1e-12), "{name}: {}", rate(0.0));
            assert!(is_near(rate(slope), uphill_m_min, 1e-12), "{name}: {}", rate(slope));
        }
    }

    #[test]
    fn both_rates_agree_at_head_and_back_and_nowhere_else() {
        for (code, bed) in beds() {
            for (wind, slope) in conditions() {
                let fire = bed.behavior(wind, slope, &UNLIMITED);
                let head = fire.heading.truncate();
                for (direction, rate) in [(head, fire.rate_mps), (-head, fire.back_rate_mps())] {
                    assert!(is_near(fire.ray_rate_mps(direction), rate, 1e-9), "{code}");
                    assert!(is_near(fire.front_normal_rate_mps(direction), rate, 1e-9), "{code}");
                }
                // The front runs ahead of the ray that leads to it, where the ellipse is not a circle.
                let flank = DVec2::new(-head.y, head.x);
                if fire.length_to_width > 1.01 {
                    assert!(fire.front_normal_rate_mps(flank) > fire.ray_rate_mps(flank), "{code}");
                }
            }
        }
    }

    #[test]
    fn travel_times_are_those_of_rays() {
        for (code, bed) in beds() {
            for (wind, slope) in conditions() {
                let fire = bed.behavior(wind, slope, &UNLIMITED);
                let ellipse = fire.ellipse();
                for degrees in (0..360).step_by(30) {
                    let v = compass::unit_toward(f64::from(degrees)) * 7.0;
                    let expected = length(lift(v, slope)) / fire.ray_rate_mps(v);
                    assert!(is_near(ellipse.travel_s(v), expected, 1e-9), "{code} to {degrees}");
                }
            }
        }
    }

    #[test]
    fn shape_and_heading_are_those_of_an_ellipse() {
        for (code, bed) in beds() {
            for options in [UNLIMITED, SurfaceOptions::default()] {
                for (wind, slope) in conditions() {
                    let fire = bed.behavior(wind, slope, &options);
                    assert!((1.0..=8.0).contains(&fire.length_to_width), "{code}");
                    assert!((0.0..1.0).contains(&fire.eccentricity), "{code}");
                    assert!((length(fire.heading) - 1.0).abs() < 1e-12, "{code}");
                    let above = lift(fire.heading.truncate(), slope);
                    assert!((above.z - fire.heading.z).abs() < 1e-12, "{code}: the heading is in the slope");
                }
            }
        }
    }

    #[test]
    fn calm_level_ground_burns_in_circles() {
        for (code, bed) in beds() {
            let fire = bed.behavior(DVec2::ZERO, DVec2::ZERO, &SurfaceOptions::default());
            assert_eq!((fire.rate_mps, fire.eccentricity, fire.length_to_width), (fire.r0_mps, 0.0, 1.0), "{code}");
            assert_eq!(fire.heading, DVec3::Y, "{code}");
        }
    }

    #[test]
    fn more_wind_makes_a_faster_and_longer_fire_up_to_the_limit() {
        for (code, bed) in beds() {
            for limit in [WindLimit::None, WindLimit::Rothermel1972, WindLimit::Andrews2013] {
                let options = SurfaceOptions { wind_limit: limit, ..UNLIMITED };
                let fires: [_; 40] =
                    array::from_fn(|halves| bed.behavior(DVec2::X * (0.5 * halves as f64), DVec2::ZERO, &options));
                assert!(fires.is_sorted_by(|a, b| a.rate_mps <= b.rate_mps), "{code}");
                assert!(fires.is_sorted_by(|a, b| a.length_to_width <= b.length_to_width), "{code}");
                for pair in fires.windows(2) {
                    let is_faster = pair[1].rate_mps > pair[0].rate_mps;
                    assert!(is_faster || pair[1].wind_is_limited, "{code}");
                }
                assert!(limit != WindLimit::None || !fires[39].wind_is_limited, "{code}");
            }
        }
    }

    #[test]
    fn effective_wind_alone_does_as_much() {
        for (code, bed) in beds() {
            for options in [UNLIMITED, SurfaceOptions::default()] {
                for (wind, slope) in conditions() {
                    let fire = bed.behavior(wind, slope, &options);
                    let alone = bed.behavior(DVec2::Y * fire.effective_wind_mps, DVec2::ZERO, &UNLIMITED);
                    assert!(is_near(alone.rate_mps, fire.rate_mps, 1e-9), "{code}");
                    assert!(is_near(alone.length_to_width, fire.length_to_width, 1e-9), "{code}");
                }
            }
        }
    }

    #[test]
    fn conventions_agree_on_level_ground_and_differ_on_slopes() {
        for (code, bed) in beds() {
            let flat = SurfaceOptions { combine: Combine::Flat, ..UNLIMITED };
            for (wind, slope) in conditions() {
                let [plane, flat] = [UNLIMITED, flat].map(|options| bed.behavior(wind, slope, &options));
                if slope == DVec2::ZERO {
                    assert_eq!(plane, flat, "{code}");
                } else if wind.dot(slope) != 0.0 {
                    assert_ne!(plane.rate_mps, flat.rate_mps, "{code}");
                } else {
                    // A wind across the slope is lifted nowhere.
                    assert!(is_near(plane.rate_mps, flat.rate_mps, 1e-12), "{code}");
                }
            }
        }
    }

    #[test]
    fn mirrored_conditions_give_a_mirrored_fire() {
        let mirror = |v: DVec2| DVec2::new(-v.x, v.y);
        for (code, bed) in beds() {
            for (wind, slope) in conditions() {
                let fire = bed.behavior(wind, slope, &UNLIMITED);
                let mirrored = bed.behavior(mirror(wind), mirror(slope), &UNLIMITED);
                assert_eq!(fire.rate_mps, mirrored.rate_mps, "{code}");
                assert_eq!(mirror(fire.heading.truncate()), mirrored.heading.truncate(), "{code}");
            }
        }
    }

    #[test]
    fn intensity_and_flames_are_byrams() {
        let (_, bed) = beds().find(|(code, _)| *code == "GR2").expect("it burns");
        let fire = bed.behavior(DVec2::X * 3.0, DVec2::ZERO, &UNLIMITED);
        assert!(is_near(fire.intensity_kw_m(2.0), 2.0 * fire.reaction_intensity_kw_m2 * fire.residence_s, 1e-15));
        // The formula in metres is the one in feet with its constant rounded.
        for intensity in [10.0, 500.0, 1e4] {
            assert!(is_near(flame_length_m(intensity), 0.0775 * ops::pow(intensity, 0.46), 1e-3));
        }
        assert_eq!(flame_length_m(0.0), 0.0);
    }
}
