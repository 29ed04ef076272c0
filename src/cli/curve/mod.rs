//! `wildfire curve`: the shortest curves of a turning radius between two poses, or between many pairs.

pub mod report;
mod tables;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{ArgGroup, Args};

pub use tables::{PathSample, poses_along};

use report::{CurveReport, End};
use tables::COORDINATES;

use crate::cli::error::CliError;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::report::FormArguments;
use crate::cli::{numbers, terminal};
use wildfire_base::input_file::is_standard_stream;
use wildfire_base::vehicle::CurvePrice;

/// The range of turning radii in metres.
const RADII_M: RangeInclusive<f64> = 1e-3..=1e6;

#[derive(Debug, Args)]
#[command(
    group = ArgGroup::new("what").args(["from", "pairs"]).required(true),
    after_help = "\
A pose is that of the middle of the rear axle: metres east and north, and a heading in
degrees counter-clockwise from east. Each of these numbers is at most 1e6; the turning
radius is from 0.001 to 1e6 m.

Examples:
  wildfire curve --from 0,0,0 --to 20,15,180
  wildfire curve --from 0,0,0 --to 20,15,180 --turning-radius 8 --png curve.png
  wildfire curve --from 0,0,0 --to 20,15,180 --cusp-m 30 --format json
  wildfire curve --pairs pairs.csv --csv lengths.csv"
)]
pub struct CurveArguments {
    /// Start pose.
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true, value_parser = pose, requires = "to")]
    pub from: Option<End>,
    /// Goal pose.
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true, value_parser = pose, requires = "from")]
    pub to: Option<End>,
    /// Smallest turning radius of the middle of the rear axle.
    #[arg(long = "turning-radius", alias = "radius", value_name = "METRES", default_value = "13", allow_hyphen_values = true, value_parser = radius)]
    pub radius: f64,
    /// Cost of a metre in reverse, in metres driven forward; adds the cheapest Reeds-Shepp curve [default: 1].
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = price, conflicts_with = "pairs")]
    pub reverse_factor: Option<f64>,
    /// Cost of a cusp, in metres driven forward; adds the cheapest Reeds-Shepp curve [default: 0].
    #[arg(long, value_name = "METRES", allow_hyphen_values = true, value_parser = price, conflicts_with = "pairs")]
    pub cusp_m: Option<f64>,
    /// CSV file of pose pairs, for --csv: the columns x0,y0,th0,x1,y1,th1 in any order, angles in radians.
    #[arg(long, value_name = "FILE.csv", requires = "csv", conflicts_with = "report_form")]
    pub pairs: Option<PathBuf>,
    /// Write poses along the curves: curve,s_m,x_m,y_m,heading_rad,direction. With --pairs, write its columns and
    /// reeds_shepp_m,reeds_shepp_word,dubins_m,dubins_word.
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
    /// Largest distance between poses in the CSV file, in metres; all joints are included.
    #[arg(
        long = "step-m",
        alias = "step",
        value_name = "METRES",
        default_value = "0.05",
        allow_hyphen_values = true,
        value_parser = step,
        requires = "csv",
        conflicts_with = "pairs"
    )]
    pub step: f64,
    /// Draw the curves.
    #[arg(long, value_name = "FILE.png", conflicts_with = "pairs")]
    pub png: Option<PathBuf>,
    #[command(flatten)]
    pub form: FormArguments,
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

fn pose(text: &str) -> Result<End, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| numbers::within(number, &COORDINATES)).collect();
    match numbers.as_deref() {
        Some(&[x, y, heading_deg]) => Ok(End { x, y, heading_deg }),
        _ => Err(format!(
            "expected X,Y,DEG, metres east and north and degrees from east, such as 20,15.5,-90, each {}",
            numbers::range_text(&COORDINATES)
        )),
    }
}

fn radius(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &RADII_M, "metres")
}

fn price(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(0.0..=*COORDINATES.end()), "a number")
}

fn step(text: &str) -> Result<f64, String> {
    numbers::parse_within(text, &(1e-6..=*COORDINATES.end()), "metres")
}

pub fn run(arguments: &CurveArguments, quiet: bool) -> Result<ExitCode, CliError> {
    match (&arguments.pairs, &arguments.csv, arguments.from, arguments.to) {
        (Some(pairs), Some(csv), ..) => write_lengths(pairs, csv, arguments.radius, quiet)?,
        (_, _, Some(from), Some(to)) => report_curves(from, to, arguments, quiet)?,
        _ => unreachable!("the arguments require --pairs with --csv, or --from with --to"),
    }
    Ok(ExitCode::SUCCESS)
}

fn write_lengths(pairs: &Path, csv: &Path, radius_m: f64, quiet: bool) -> Result<(), CliError> {
    Files { inputs: vec![pairs], outputs: vec![(Format::Csv, csv)], ..Files::default() }.check()?;
    let rows = tables::write_lengths(pairs, csv, radius_m)?;
    if !quiet && !is_standard_stream(csv) {
        terminal::note(&format!("wrote {}: {rows} pairs, turning radius {radius_m} m", csv.display()));
    }
    Ok(())
}

fn report_curves(from: End, to: End, arguments: &CurveArguments, quiet: bool) -> Result<(), CliError> {
    let files = Files { form: arguments.form, ..Files::default() };
    let stream = files.writing([(Format::Csv, &arguments.csv), (Format::Png, &arguments.png)]).check()?;
    let report = CurveReport::new(from, to, arguments.radius, arguments.price());
    // The step is checked before anything is printed, so one that is too fine leaves no half of an answer.
    if arguments.csv.is_some() {
        tables::check_samples(&report.curves, arguments.step)?;
    }
    let printed = stream.print(&arguments.form.render(&report));
    // Whatever cannot be written, all else is kept.
    let written = output_files::write_all(
        &[
            (arguments.csv.as_deref(), &|path| tables::write_samples(path, &report.curves, arguments.step)),
            (arguments.png.as_deref(), &|path| report.draw().write_png(path)),
        ],
        quiet,
    );
    printed.and(written)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;
    use std::fs;

    use super::*;
    use crate::cli::Command;
    use crate::cli::command_lines::{check_message, parsed};
    use crate::cli::fuzz::text::{NUMBERS, mutated};
    use crate::cli::fuzz::{Case, Fuzzer, Law, below, one_of};
    use wildfire_base::geometry::Pose;

    #[test]
    fn curves_and_pairs_take_anything() {
        let law = |case: &mut Case<'_>| if case.chance(40) { table_of_pairs(case) } else { two_poses(case) };
        Fuzzer { name: "curves_and_pairs", target: "--lib", law }.run(3000);
    }

    /// Checks that two poses have curves that lead from one to the other, whatever the numbers are.
    fn two_poses(case: &mut Case<'_>) -> Law {
        let number = |case: &mut Case<'_>| match below(&mut case.dice, 4) {
            0 => (*one_of(&mut case.dice, NUMBERS)).to_owned(),
            1 => (below(&mut case.dice, 2_000_001) as f64 - 1e6).to_string(),
            _ => (0.25 * below(&mut case.dice, 400) as f64 - 50.0).to_string(),
        };
        let pose = |case: &mut Case<'_>| [(); 3].map(|()| number(case)).join(",");
        let mut args = ["--from", &pose(case), "--to", &pose(case)].map(str::to_owned).to_vec();
        for option in ["--turning-radius", "--reverse-factor", "--cusp-m"] {
            if case.chance(40) {
                args.extend([option.to_owned(), number(case)]);
            }
        }
        if case.chance(50) {
            args.push("--format=json".into());
        }
        let Some(Command::Curve(arguments)) = parsed(case, "curve", args)? else { return Ok(()) };
        let (Some(from), Some(to)) = (arguments.from, arguments.to) else { return Err("a pose is missing".into()) };
        case.count("poses accepted");
        let report = CurveReport::new(from, to, arguments.radius, arguments.price());
        for curve in &report.curves {
            let (end, goal) = (curve.path.end(), to.pose());
            let missed_m = end.position().distance(goal.position());
            if missed_m.is_nan() || missed_m > 1e-8 + 1e-11 * arguments.radius {
                return Err(format!("the {} curve ends {missed_m} m from its goal", curve.name));
            }
        }
        if tables::check_samples(&report.curves, 0.05).is_ok() && case.chance(5) {
            let count = report.curves.iter().map(|curve| poses_along(&curve.path, 0.05).count()).sum::<usize>();
            report.draw();
            if count == 0 { Err("a curve without a pose".into()) } else { Ok(()) }
        } else {
            let rendered = arguments.form.render(&report);
            if arguments.form.is_json() && serde_json::from_str::<serde_json::Value>(&rendered).is_err() {
                return Err(format!("this is no JSON: {rendered}"));
            }
            check_message(&rendered)
        }
    }

    /// Checks that a table of pairs is read or refused, and that its own columns stay as they are.
    fn table_of_pairs(case: &mut Case<'_>) -> Law {
        case.kind = "pairs";
        const TABLES: &[&str] = &[
            "x0,y0,th0,x1,y1,th1\n0,0,0,20,15,3.14\n1,2,3,4,5,6\n",
            "name,th1,x1,y1,\"x0\",y0,th0\n\"a,b\",0,1,2,3,4,5\n\n",
        ];
        case.input = mutated(&mut case.dice, TABLES, &["x0", "th1,", "\"", "reeds_shepp_m", "1e6", "\u{FEFF}"]);
        let pairs = case.write("pairs.csv", &case.input);
        let lengths = case.folder.join("lengths.csv");
        match tables::write_lengths(&pairs, &lengths, 13.0) {
            Ok(rows) => {
                case.count("tables of pairs accepted");
                let written = fs::read(&lengths).map_err(|error| error.to_string())?;
                let lines = written.iter().filter(|&&byte| byte == b'\n').count() as u64;
                if lines < rows + 1 { Err(format!("{lines} lines were written of {rows} pairs")) } else { Ok(()) }
            }
            Err(refusal) => check_message(&refusal.sentence()),
        }
    }

    #[test]
    fn poses_are_three_numbers_and_full_turns_change_nothing() {
        let found = pose("1.5, -2,810").expect("three numbers");
        assert_eq!(found, End { x: 1.5, y: -2.0, heading_deg: 810.0 });
        assert_eq!(found.pose(), Pose { x: 1.5, y: -2.0, heading: FRAC_PI_2 });
        for wrong in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,nan", "inf,0,0", "0,-1e7,0", "1;2;3"] {
            assert!(pose(wrong).is_err_and(|expected| expected.contains("from -1000000 to 1000000")), "{wrong}");
        }
    }
}
