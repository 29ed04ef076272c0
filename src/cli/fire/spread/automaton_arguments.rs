//! Arguments of `wildfire fire spread --model alexandridis` alone.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use crate::cli::args::{parse_jobs, parse_seed};
use crate::cli::fire::options::{MAX_SECONDS, SlopeArguments, azimuth, choice};
use crate::cli::numbers;
use wildfire_base::geometry::ops;
use wildfire_base::time::SimTime;
use wildfire_fire::models::{AlexandridisRules, Density, Vegetation};

const HEADING: &str = "Automaton (--model alexandridis)";

/// Settings of the automaton alone; the field, the wind and the cells that are lit are those of every lone fire.
#[derive(Debug, Args)]
pub struct AutomatonArguments {
    /// Probability that a burning cell ignites a neighbour, without wind and slope.
    #[arg(help_heading = HEADING, long, value_name = "SHARE", default_value = "0.58", value_parser = share)]
    pub p0: f64,
    /// Coefficient c1 of the wind factor exp(V (c1 + c2 (cos t - 1))), for a wind V at an angle t.
    #[arg(help_heading = HEADING, long, value_name = "C1", default_value = "0.045", value_parser = coefficient)]
    pub wind_c1: f64,
    /// Coefficient c2 of the wind factor.
    #[arg(help_heading = HEADING, long, value_name = "C2", default_value = "0.131", value_parser = coefficient)]
    pub wind_c2: f64,
    /// Coefficient a of the slope factor exp(a s), for a slope s in degrees.
    #[arg(help_heading = HEADING, long, value_name = "A", default_value = "0.078", value_parser = coefficient)]
    pub slope_a: f64,
    /// Kind of vegetation; changes the probability of spread by -30 %, 0 % or +40 %.
    #[arg(help_heading = HEADING, long, value_name = "NAME", default_value = "thickets", value_parser = choice::<Vegetation>(&["agricultural", "thickets", "pine"]))]
    pub vegetation: Vegetation,
    /// Density of the vegetation; changes the probability of spread by -40 %, 0 % or +30 %.
    #[arg(help_heading = HEADING, long, value_name = "NAME", default_value = "normal", value_parser = choice::<Density>(&["sparse", "normal", "dense"]))]
    pub density: Density,
    /// Slope of the whole field in degrees, instead of --slope.
    #[arg(help_heading = HEADING, long, hide = true, value_name = "DEGREES", conflicts_with = "slope", value_parser = slope_deg)]
    slope_deg: Option<f64>,
    /// Uphill azimuth, instead of --aspect.
    #[arg(help_heading = HEADING, long, hide = true, value_name = "AZIMUTH", conflicts_with = "aspect", allow_hyphen_values = true, value_parser = azimuth)]
    uphill_deg: Option<f64>,
    /// Largest number of steps of a fire [default: until it goes out].
    #[arg(help_heading = HEADING, long, value_name = "N", value_parser = steps)]
    pub steps: Option<u32>,
    /// Length of a step in seconds; matters only if the wind changes.
    #[arg(help_heading = HEADING, long, value_name = "SECONDS", default_value = "10", value_parser = seconds)]
    pub step_s: f64,
    /// Number of fires, with consecutive seeds.
    #[arg(help_heading = HEADING, long, value_name = "N", default_value = "1", value_parser = runs)]
    pub runs: u32,
    /// Seed of the first fire.
    #[arg(help_heading = HEADING, short, long, value_name = "N", default_value = "1", value_parser = parse_seed)]
    pub seed: u64,
    /// Number of threads; results do not depend on it [default: the number of processors].
    #[arg(help_heading = HEADING, short, long, env = "WILDFIRE_JOBS", value_name = "N", value_parser = parse_jobs)]
    pub jobs: Option<NonZeroUsize>,
    /// Write each fire's burned cells and the last step with an ignition: run,area,last_step.
    #[arg(help_heading = HEADING, long = "csv", alias = "areas", value_name = "FILE.csv")]
    pub areas: Option<PathBuf>,
}

fn share(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(0.0..=1.0), "a probability")
}

fn coefficient(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(0.0..=1.0), "a number")
}

fn slope_deg(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(0.0..=60.0), "degrees")
}

fn steps(text: &str) -> Result<u32, String> {
    numbers::parse_within(text, &(0..=1_000_000), "a whole number")
}

fn runs(text: &str) -> Result<u32, String> {
    numbers::parse_within(text, &(1..=1_000_000), "a whole number")
}

fn seconds(text: &str) -> Result<f64, String> {
    numbers::parse_time_within(text, &(0.001..=MAX_SECONDS))
}

impl AutomatonArguments {
    /// Returns how steep the field is and the azimuth of the way up, both in degrees.
    pub fn slope_and_uphill_deg(&self, slope: &SlopeArguments) -> [f64; 2] {
        let uphill = (slope.aspect + 180.0).rem_euclid(360.0);
        [self.slope_deg.unwrap_or_else(|| ops::atan(slope.slope).to_degrees()), self.uphill_deg.unwrap_or(uphill)]
    }

    pub fn rules(&self) -> AlexandridisRules {
        AlexandridisRules {
            p0: self.p0,
            wind_c1: self.wind_c1,
            wind_c2: self.wind_c2,
            slope_a: self.slope_a,
            vegetation: self.vegetation,
            density: self.density,
            step: SimTime::from_seconds(self.step_s),
        }
    }
}
