//! The arguments of `wildfire curve`, as clap reads them.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{ArgGroup, Args};

use crate::cli::curve::limits::{self, NUMBERS, RADII_M};
use crate::cli::numbers;
use crate::geometry::Pose;
use crate::vehicle::CurvePrice;

#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("what").args(["from", "pairs"]).required(true),
    after_help = "\
Poses are those of the middle of the rear axle: metres east and north, and the
heading in degrees counter-clockwise from east. Each of these numbers is at most
1e6, the turning radius from 0.001 to 1e6 m.

Examples:
  wildfire curve --from 0,0,0 --to 20,15,180
  wildfire curve --from 0,0,0 --to 20,15,180 --radius 8 --png curve.png
  wildfire curve --from 0,0,0 --to 20,15,180 --cusp-m 30 --json
  wildfire curve --pairs pairs.csv --csv lengths.csv"
)]
pub struct CurveArguments {
    /// The pose to start from.
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true, value_parser = pose, requires = "to")]
    pub from: Option<End>,
    /// The pose to arrive at.
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true, value_parser = pose, requires = "from")]
    pub to: Option<End>,
    /// The smallest turning radius of the middle of the rear axle.
    #[arg(long, value_name = "METRES", default_value = "13", allow_hyphen_values = true, value_parser = radius)]
    pub radius: f64,
    /// The price of a metre in reverse, in metres driven forward; adds the cheapest Reeds-Shepp curve [default: 1].
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = price, conflicts_with = "pairs")]
    pub reverse_factor: Option<f64>,
    /// The price of a cusp, in metres driven forward; adds the cheapest Reeds-Shepp curve [default: 0].
    #[arg(long, value_name = "METRES", allow_hyphen_values = true, value_parser = price, conflicts_with = "pairs")]
    pub cusp_m: Option<f64>,
    /// Lengths and words of many pairs of poses, for --csv: a CSV file with the columns x0,y0,th0,x1,y1,th1 in any
    /// order, angles in radians.
    #[arg(long, value_name = "FILE.csv", requires = "csv")]
    pub pairs: Option<PathBuf>,
    /// Write poses along the curves: curve,s_m,x_m,y_m,heading_rad,direction. With --pairs, write its columns and
    /// reeds_shepp_m,reeds_shepp_word,dubins_m,dubins_word.
    #[arg(help_heading = "Output", long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// The longest way between two poses in the CSV file; all joints are in it.
    #[arg(
        help_heading = "Output",
        long,
        value_name = "METRES",
        default_value = "0.05",
        allow_hyphen_values = true,
        value_parser = step,
        requires = "csv",
        conflicts_with = "pairs"
    )]
    pub step: f64,
    /// Draw the curves.
    #[arg(help_heading = "Output", long, value_name = "FILE.png", conflicts_with = "pairs")]
    pub png: Option<PathBuf>,
    /// Print the report as one JSON object.
    #[arg(help_heading = "Output", long, conflicts_with = "pairs")]
    pub json: bool,
}

/// A pose as it was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    pub x: f64,
    pub y: f64,
    pub heading_deg: f64,
}

impl CurveArguments {
    /// The prices, if any was given.
    pub fn price(&self) -> Option<CurvePrice> {
        let CurvePrice { reverse_factor, cusp_m } = CurvePrice::LENGTH;
        (self.reverse_factor.is_some() || self.cusp_m.is_some()).then(|| CurvePrice {
            reverse_factor: self.reverse_factor.unwrap_or(reverse_factor),
            cusp_m: self.cusp_m.unwrap_or(cusp_m),
        })
    }
}

impl End {
    /// Full turns are taken off before the degrees become radians, so that they change nothing.
    pub fn pose(self) -> Pose {
        Pose::new(self.x, self.y, (self.heading_deg % 360.0).to_radians())
    }
}

fn pose(text: &str) -> Result<End, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| within(number, &NUMBERS)).collect();
    match numbers.as_deref() {
        Some(&[x, y, heading_deg]) => Ok(End { x, y, heading_deg }),
        _ => Err(format!(
            "expected X,Y,DEG, metres east and north and degrees from east, such as 20,15.5,-90, each {}",
            limits::shown(&NUMBERS)
        )),
    }
}

fn radius(text: &str) -> Result<f64, String> {
    within(text, &RADII_M).ok_or_else(|| format!("expected metres {}", limits::shown(&RADII_M)))
}

fn price(text: &str) -> Result<f64, String> {
    let range = 0.0..=*NUMBERS.end();
    within(text, &range).ok_or_else(|| format!("expected a number {}", limits::shown(&range)))
}

fn step(text: &str) -> Result<f64, String> {
    let range = 1e-6..=*NUMBERS.end();
    within(text, &range).ok_or_else(|| format!("expected metres {}", limits::shown(&range)))
}

fn within(text: &str, range: &RangeInclusive<f64>) -> Option<f64> {
    numbers::parse(text.trim()).filter(|number| range.contains(number))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn poses_are_three_numbers_and_full_turns_change_nothing() {
        let given = pose("1.5, -2,810").expect("three numbers");
        assert_eq!(given, End { x: 1.5, y: -2.0, heading_deg: 810.0 });
        assert_eq!(given.pose(), Pose { x: 1.5, y: -2.0, heading: FRAC_PI_2 });
        for wrong in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,nan", "inf,0,0", "0,-1e7,0", "1;2;3"] {
            assert!(pose(wrong).is_err_and(|expected| expected.contains("from -1000000 to 1000000")), "{wrong}");
        }
    }
}
