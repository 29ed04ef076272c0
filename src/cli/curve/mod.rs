//! `wildfire curve`: the shortest curves of a turning radius between two poses, or between many pairs.

mod args;
mod json;
mod limits;
mod pair_table;
mod pairs;
mod report;
pub mod samples;
mod scene;
mod summary;
mod words;

use std::path::Path;
use std::process::ExitCode;

pub use args::CurveArguments;

use args::End;
use report::CurveReport;

use crate::cli::error::CliError;
use crate::cli::output_files::{self, Files, Format};
use crate::cli::terminal;
use crate::input_file::is_standard_stream;

pub fn run(arguments: &CurveArguments, quiet: bool) -> Result<ExitCode, CliError> {
    match (&arguments.pairs, &arguments.csv, arguments.from, arguments.to) {
        (Some(pairs), Some(csv), ..) => write_lengths(pairs, csv, arguments.radius, quiet)?,
        (_, _, Some(from), Some(to)) => report_curves(from, to, arguments, quiet)?,
        _ => unreachable!("the arguments require --pairs with --csv, or --from with --to"),
    }
    Ok(ExitCode::SUCCESS)
}

fn write_lengths(pairs: &Path, csv: &Path, radius_m: f64, quiet: bool) -> Result<(), CliError> {
    Files { inputs: vec![pairs], outputs: vec![(Format::Csv, csv)], json: false }.check()?;
    let rows = pairs::write_lengths(pairs, csv, radius_m)?;
    if !quiet && !is_standard_stream(csv) {
        terminal::note(&format!("wrote {}: {rows} pairs, turning radius {radius_m} m", csv.display()));
    }
    Ok(())
}

fn report_curves(from: End, to: End, arguments: &CurveArguments, quiet: bool) -> Result<(), CliError> {
    let files = Files { json: arguments.json, ..Files::default() };
    let words = files.writing([(Format::Csv, &arguments.csv), (Format::Png, &arguments.png)]).check()?;
    let report = CurveReport::new(from, to, arguments);
    if arguments.csv.is_some() {
        samples::check(&report.curves, arguments.step)?;
    }
    let printed = words.print(&rendered(&report, arguments));
    // Whatever cannot be written, all else is kept.
    let written = output_files::write_all(
        &[
            (arguments.csv.as_deref(), &|path| samples::write(path, &report.curves, arguments.step)),
            (arguments.png.as_deref(), &|path| scene::draw(&report).write_png(path)),
        ],
        quiet,
    );
    printed.and(written)
}

fn rendered(report: &CurveReport, arguments: &CurveArguments) -> String {
    if arguments.json { json::to_json(report) } else { summary::to_text(report) }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::cli::args::Command;
    use crate::cli::command_lines::{parsed, said};
    use crate::cli::fuzz::text::{NUMBERS, mutated};
    use crate::cli::fuzz::{Case, Fuzzer, Law, below, one_of};

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
        let mut words = ["--from", &pose(case), "--to", &pose(case)].map(str::to_owned).to_vec();
        for option in ["--radius", "--reverse-factor", "--cusp-m"] {
            if case.chance(40) {
                words.extend([option.to_owned(), number(case)]);
            }
        }
        if case.chance(50) {
            words.push("--json".into());
        }
        let Some(Command::Curve(arguments)) = parsed(case, "curve", words)? else { return Ok(()) };
        let (Some(from), Some(to)) = (arguments.from, arguments.to) else { return Err("a pose is missing".into()) };
        case.count("poses accepted");
        let report = CurveReport::new(from, to, &arguments);
        for curve in &report.curves {
            let (end, goal) = (curve.path.end(), to.pose());
            let missed_m = end.position().distance(goal.position());
            if missed_m.is_nan() || missed_m > 1e-8 + 1e-11 * arguments.radius {
                return Err(format!("the {} curve ends {missed_m} m from its goal", curve.name));
            }
        }
        if samples::check(&report.curves, 0.05).is_ok() && case.chance(5) {
            let count = report.curves.iter().map(|curve| samples::along(&curve.path, 0.05).count()).sum::<usize>();
            scene::draw(&report);
            if count == 0 { Err("a curve without a pose".into()) } else { Ok(()) }
        } else {
            let rendered = rendered(&report, &arguments);
            if arguments.json && serde_json::from_str::<serde_json::Value>(&rendered).is_err() {
                return Err(format!("this is no JSON: {rendered}"));
            }
            said(&rendered)
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
        match pairs::write_lengths(&pairs, &lengths, 13.0) {
            Ok(rows) => {
                case.count("tables of pairs accepted");
                let written = fs::read(&lengths).map_err(|error| error.to_string())?;
                let lines = written.iter().filter(|&&byte| byte == b'\n').count() as u64;
                if lines < rows + 1 { Err(format!("{lines} lines were written of {rows} pairs")) } else { Ok(()) }
            }
            Err(refusal) => said(&refusal.sentence()),
        }
    }
}
