//! The curves between two poses as one JSON object.

use serde::Serialize;

use crate::batch::PROGRAM_VERSION;
use crate::cli::curve::args::End;
use crate::cli::curve::report::{CurveReport, FoundCurve};
use crate::cli::curve::words::{direction, steering, turn_deg};
use crate::vehicle;

/// The members in their order.
#[derive(Serialize)]
struct Object<'a> {
    program_version: &'static str,
    from: Pose,
    to: Pose,
    radius_m: f64,
    curves: Vec<Curve<'a>>,
}

#[derive(Serialize)]
struct Pose {
    x_m: f64,
    y_m: f64,
    heading_deg: f64,
}

/// What does not apply is null.
#[derive(Serialize)]
struct Curve<'a> {
    curve: &'static str,
    length_m: f64,
    word: &'a str,
    family: Option<&'a str>,
    cusps: u32,
    price: Option<Price>,
    segments: Vec<Segment>,
}

#[derive(Serialize)]
struct Price {
    reverse_factor: f64,
    cusp_m: f64,
    price_m: f64,
}

#[derive(Serialize)]
struct Segment {
    steering: &'static str,
    direction: &'static str,
    length_m: f64,
    turn_deg: f64,
}

/// Writes the report as one line.
pub fn to_json(report: &CurveReport) -> String {
    let object = Object {
        program_version: PROGRAM_VERSION,
        from: pose(report.from),
        to: pose(report.to),
        radius_m: report.radius_m,
        curves: report.curves.iter().map(curve).collect(),
    };
    serde_json::to_string(&object).expect("names, numbers and words are JSON") + "\n"
}

fn pose(End { x, y, heading_deg }: End) -> Pose {
    Pose { x_m: x, y_m: y, heading_deg }
}

fn curve(found: &FoundCurve) -> Curve<'_> {
    let price = found.price.map(|(price, price_m)| Price {
        reverse_factor: price.reverse_factor,
        cusp_m: price.cusp_m,
        price_m,
    });
    Curve {
        curve: found.kind,
        length_m: found.length_m,
        word: &found.word,
        family: found.family.as_deref(),
        cusps: found.path.cusps(),
        price,
        segments: found.path.segments.iter().map(segment).collect(),
    }
}

fn segment(segment: &vehicle::Segment) -> Segment {
    Segment {
        steering: steering(segment),
        direction: direction(segment),
        length_m: segment.length_m.abs(),
        turn_deg: turn_deg(segment),
    }
}
