//! Ground in classes with distinguishable colours, and shading of slopes.

use crate::colours::{FIELD, Rgb, blend};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_fire::Landscape;

/// A class of ground, by what grows or lies there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GroundCover {
    /// Nothing is known of it, and nothing burns there.
    Nothing,
    Grass,
    Shrub,
    Timber,
    Slash,
    Bare,
    Water,
    Road,
}

impl GroundCover {
    /// Returns the class of a fuel model: the four groups of Anderson 1982, to which those of Scott and Burgan 2005 are
    /// joined (grass with shrub among shrub, timber with understory or litter among timber), and what does not burn.
    pub fn from_fuel(number: u8) -> Self {
        match number {
            1..=3 | 101..=109 => Self::Grass,
            4..=7 | 121..=149 => Self::Shrub,
            8..=10 | 161..=189 => Self::Timber,
            11..=13 | 201..=204 => Self::Slash,
            91 => Self::Road,
            92 | 93 | 99 => Self::Bare,
            98 => Self::Water,
            // Custom models, of which the number says nothing.
            14..=89 | 205.. => Self::Shrub,
            _ => Self::Nothing,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing to burn",
            Self::Grass => "grass",
            Self::Shrub => "shrub",
            Self::Timber => "timber",
            Self::Slash => "slash",
            Self::Bare => "bare, roads",
            Self::Water => "water",
            Self::Road => "road",
        }
    }

    /// A quiet colour, so that fire and agents stand out; bushes of the film are darker and greener than all of them.
    pub fn colour(self) -> Rgb {
        match self {
            Self::Nothing => FIELD,
            Self::Grass => [231, 229, 184],
            Self::Shrub => [206, 213, 166],
            Self::Timber => [180, 199, 158],
            Self::Slash => [214, 199, 164],
            Self::Bare => [209, 198, 183],
            Self::Water => [154, 194, 220],
            Self::Road => [112, 108, 104],
        }
    }

    pub fn burns(self) -> bool {
        matches!(self, Self::Grass | Self::Shrub | Self::Timber | Self::Slash)
    }
}

/// Returns the class of every cell of a landscape, by cell index.
pub fn ground_covers(landscape: &Landscape) -> Vec<GroundCover> {
    landscape.fuel.iter().map(|&number| GroundCover::from_fuel(number)).collect()
}

/// Returns the class of every cell of a field that only bushes grow on, by cell index.
pub fn bush_covers(frame: &FieldFrame, bushes: &[Cell]) -> Vec<GroundCover> {
    let mut covers = vec![GroundCover::Nothing; frame.cell_count()];
    bushes.iter().for_each(|&bush| covers[frame.index(bush)] = GroundCover::Shrub);
    covers
}

/// The sun as mapmakers have it, in the north-west: the unit vector towards it, half of whose length is up.
const SUN: [f64; 3] = [-0.612_372_435_695_794_5, 0.612_372_435_695_794_5, 0.5];
/// Relief stays quiet: at most this much darker or lighter than flat ground.
const DARKEST: f64 = 0.30;
const LIGHTEST: f64 = 0.22;

/// Lights a colour as ground with a gradient has it under the sun: by the cosine of the angle between the ground's normal and
/// the sun (Horn, "Hill shading and the reflectance map", Proceedings of the IEEE 69(1), 1981), compared with flat ground.
pub fn hillshade(colour: Rgb, gradient: DVec2) -> Rgb {
    if gradient == DVec2::ZERO {
        return colour;
    }
    let normal = (1.0 + gradient.x * gradient.x + gradient.y * gradient.y).sqrt();
    let cosine = ((SUN[2] - SUN[0] * gradient.x - SUN[1] * gradient.y) / normal).max(0.0);
    let lighter = 0.75 * (cosine - SUN[2]);
    if lighter < 0.0 {
        blend(colour, [0, 0, 0], (-lighter).min(DARKEST))
    } else {
        blend(colour, [255; 3], lighter.min(LIGHTEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_fire::fuel::FuelModel;

    #[test]
    fn every_fuel_model_has_a_class_that_burns_if_it_does() {
        for number in 0..=255 {
            let cover = GroundCover::from_fuel(number);
            match FuelModel::by_number(number) {
                Some(model) => assert_eq!(cover.burns(), model.burns(), "{}: {cover:?}", model.code),
                None => assert!(number == 0 || cover == GroundCover::Nothing || cover.burns(), "{number}: {cover:?}"),
            }
        }
    }

    #[test]
    fn slopes_towards_the_sun_are_light() {
        let colour = GroundCover::Grass.colour();
        assert_eq!(hillshade(colour, DVec2::ZERO), colour);
        // Falling to the north-west, and rising to it.
        assert!(hillshade(colour, DVec2::new(0.3, -0.3))[0] > colour[0]);
        assert!(hillshade(colour, DVec2::new(-0.3, 0.3))[0] < colour[0]);
        assert!(hillshade(colour, DVec2::new(-1e6, 1e6))[0] > 100);
    }
}
