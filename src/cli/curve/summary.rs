//! The curves between two poses as text for people.

use crate::cli::curve::args::End;
use crate::cli::curve::report::{CurveReport, FoundCurve};
use crate::cli::curve::words::{direction, short, steering, turn_deg};
use crate::vehicle::Segment;

/// A paragraph for each curve: its length and word, then its segments.
pub fn to_text(report: &CurveReport) -> String {
    let question = format!(
        "From {}\nto   {}\nwith a turning radius of {} m.\n",
        pose(report.from),
        pose(report.to),
        report.radius_m
    );
    question + &report.curves.iter().map(curve).collect::<String>()
}

fn pose(End { x, y, heading_deg }: End) -> String {
    format!("x {} m, y {} m, heading {} degrees", short(x), short(y), short(heading_deg))
}

fn curve(found: &FoundCurve) -> String {
    let cusps = match found.path.cusps() {
        0 => "no cusp".to_owned(),
        1 => "1 cusp".to_owned(),
        cusps => format!("{cusps} cusps"),
    };
    let head = format!("\n{}: {:.6} m, {}, {cusps}\n", found.name, found.length_m, word(found));
    let price = found.price.map(|(price, paid)| {
        let (factor, cusp_m) = (short(price.reverse_factor), short(price.cusp_m));
        format!("Costs {paid:.6} m; a metre in reverse counts {factor}, a cusp {cusp_m} m.\n")
    });
    head + &price.unwrap_or_default() + &found.path.segments.iter().map(segment).collect::<String>()
}

/// The word and its family, or how many of its letters have no length.
fn word(found: &FoundCurve) -> String {
    let word = &found.word;
    match (found.letters - found.path.segments.len(), &found.family) {
        (0, Some(family)) => format!("{word}, family {family}"),
        (0, None) => word.clone(),
        (1, _) => format!("{word} with 1 letter of no length"),
        (letters, _) => format!("{word} with {letters} letters of no length"),
    }
}

/// Steering, gear, metres driven, and degrees that the heading changes by.
fn segment(segment: &Segment) -> String {
    let metres = segment.length_m.abs();
    let line = format!("  {:<9} {} {metres:>16.6} m", steering(segment), direction(segment));
    match turn_deg(segment) {
        0.0 => line + "\n",
        degrees => format!("{line} {degrees:>+12.6} degrees\n"),
    }
}
