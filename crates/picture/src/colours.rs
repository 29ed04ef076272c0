//! Colours of values, of zones, and of everything without a value.

use colorous::VIRIDIS;

use wildfire_fire::BushStateKind;
use wildfire_timeline::{AgentId, Role};

/// Red, green and blue, 0 to 255.
pub type Rgb = [u8; 3];

/// A map from values to colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// Perceptually uniform, readable in grey and by the colour-blind (van der Walt and Smith, matplotlib, 2015).
    Viridis,
    /// The rainbow of older MATLAB, as the reports used it.
    Jet,
    /// From blue over teal and green to yellow, evenly lighter: much like newer MATLAB's parula, whose numbers are not free.
    BlueYellow,
}

pub const PAPER: Rgb = [255, 255, 255];
pub const INK: Rgb = [32, 32, 36];
pub const FAINT_INK: Rgb = [196, 196, 200];
/// The ink of words that are not to be read first.
pub const NOTE_INK: Rgb = [92, 92, 98];
// Neutral, so that neither colour map holds them.
pub const OBSTACLE: Rgb = [56, 56, 60];
pub const WITHOUT_VALUE: Rgb = [226, 226, 228];
/// The colour of cells that a search jumped through.
pub const SWEPT: Rgb = [190, 214, 240];
/// Of edges of trees and roadmaps, of which thousands may cross.
pub const EDGE: Rgb = [146, 146, 152];
pub const PATH: Rgb = [214, 0, 110];
pub const GOAL: Rgb = [255, 214, 10];
/// Colours of zones in order, from the set of eight that Okabe and Ito ("Color Universal Design", 2008) chose for the
/// colour-blind: vermilion, yellow, bluish green, sky blue.
pub const ZONES: [Rgb; 4] = [[213, 94, 0], [240, 228, 66], [0, 158, 115], [86, 180, 233]];

/// Colours of paths in order: the usual path colour, then blue, bluish green and orange of the same set of eight.
pub const WAYS: [Rgb; 4] = [PATH, [0, 114, 178], [0, 158, 115], [230, 159, 0]];

// States of bushes, from the set of Okabe and Ito where it has them; they differ by shape too.
pub const INTACT: Rgb = [0, 158, 115];
pub const BURNING: Rgb = [213, 94, 0];
pub const BURNED_OUT: Rgb = [64, 60, 58];
pub const EXTINGUISHED: Rgb = [86, 180, 233];

/// The colour of a bush in a state.
pub fn bush_colour(state: BushStateKind) -> Rgb {
    match state {
        BushStateKind::Intact => INTACT,
        BushStateKind::Burning => BURNING,
        BushStateKind::BurnedOut => BURNED_OUT,
        BushStateKind::Extinguished => EXTINGUISHED,
    }
}

/// Water: jets, how far they reach, and where tanks are filled; darker than bushes that were put out, so that it shows on the
/// ground.
pub const WATER: Rgb = [0, 114, 178];
/// Of a field where nothing grows, of its border, and around it.
pub const FIELD: Rgb = [240, 234, 216];
pub const BORDER: Rgb = [104, 98, 86];
pub const OUTSIDE: Rgb = [214, 212, 206];
/// Colours of agents, their paths and their goals.
pub const WUMPUS: Rgb = [126, 64, 152];
pub const UNIMOG: Rgb = [176, 20, 48];

/// The colour of an agent.
pub fn agent_colour(agent: AgentId) -> Rgb {
    match agent.role {
        Role::Wumpus => WUMPUS,
        Role::Unimog => UNIMOG,
    }
}

impl ColourMap {
    /// The colour at a fraction of the range, 0 to 1.
    pub fn colour(self, fraction: f64) -> Rgb {
        match self {
            Self::Viridis => VIRIDIS.eval_continuous(fraction).into_array(),
            Self::Jet => jet(fraction),
            Self::BlueYellow => between(&BLUE_YELLOW, fraction),
        }
    }
}

/// MATLAB's `jet`: each channel is a trapezium 1 high, a quarter wide at the top and three quarters at the foot; blue,
/// green and red follow a quarter apart ("colormap", MATLAB Reference).
fn jet(fraction: f64) -> Rgb {
    [3.0, 2.0, 1.0].map(|centre: f64| channel(255.0 * (1.5 - (4.0 * fraction - centre).abs()).clamp(0.0, 1.0)))
}

/// Colours of evenly rising lightness, 0.38 to 0.95 in Oklab (B. Ottosson, "A perceptual color space for image processing",
/// 2020), while the hue goes from 272 to 104 degrees, as strong as screens show them.
const BLUE_YELLOW: [Rgb; 9] = [
    [39, 42, 165],
    [7, 72, 194],
    [0, 109, 184],
    [0, 139, 177],
    [39, 167, 168],
    [70, 195, 154],
    [137, 215, 120],
    [212, 227, 84],
    [255, 243, 116],
];

/// The colour at a fraction of the way along some colours, each as far from the next.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it lies within the list")]
fn between(colours: &[Rgb], fraction: f64) -> Rgb {
    let place = fraction.clamp(0.0, 1.0) * (colours.len() - 1) as f64;
    let first = (place as usize).min(colours.len() - 2);
    blend(colours[first], colours[first + 1], place - first as f64)
}

/// Returns the lightness of a colour as eyes weigh its channels, 0 to 255 (ITU-R BT.601).
pub fn lightness([red, green, blue]: Rgb) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

/// `over` at an opacity of `share`, 0 to 1, on `under`.
pub fn blend(under: Rgb, over: Rgb, share: f64) -> Rgb {
    std::array::from_fn(|index| {
        let under = f64::from(under[index]);
        let over = f64::from(over[index]);
        channel(under + (over - under) * share)
    })
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a channel lies within 0 to 255")]
fn channel(value: f64) -> u8 {
    value.round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jet_runs_from_dark_blue_over_green_to_dark_red() {
        assert_eq!(jet(0.0), [0, 0, 128]);
        assert_eq!(jet(0.125), [0, 0, 255]);
        assert_eq!(jet(0.5), [128, 255, 128]);
        assert_eq!(jet(0.875), [255, 0, 0]);
        assert_eq!(jet(1.0), [128, 0, 0]);
    }

    #[test]
    fn no_value_has_the_colour_of_what_has_none() {
        for map in [ColourMap::Viridis, ColourMap::Jet, ColourMap::BlueYellow] {
            for step in 0..=1000 {
                let [red, green, blue] = map.colour(f64::from(step) / 1000.0);
                let min = red.min(green).min(blue);
                let max = red.max(green).max(blue);
                assert!(max - min > 30, "{map:?} is grey at {step}: {red}, {green}, {blue}");
            }
        }
    }

    #[test]
    fn what_is_higher_is_lighter_from_blue_to_yellow() {
        let colours = (0..=1000).map(|step| ColourMap::BlueYellow.colour(f64::from(step) / 1000.0));
        let lightness: Vec<f64> = colours.map(lightness).collect();
        assert!(lightness.windows(2).all(|pair| pair[0] <= pair[1] + 1.0), "by rounding at most");
        assert!(lightness[0] < 70.0 && lightness[1000] > 220.0);
    }

    #[test]
    fn blending_keeps_the_ends() {
        assert_eq!(blend(PAPER, INK, 0.0), PAPER);
        assert_eq!(blend(PAPER, INK, 1.0), INK);
        assert_eq!(blend([0, 100, 200], [100, 0, 0], 0.5), [50, 50, 100]);
    }
}
