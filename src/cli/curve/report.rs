//! The curves between two poses: an object, a document and a picture of them.

use serde::{Serialize, Serializer};

use wildfire_base::document::number::{count, rounded, short};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::geometry::Pose;
use wildfire_base::object;
use wildfire_base::vehicle::{CurvePrice, Dimensions, Dubins, Path, ReedsShepp, Segment, dubins, reeds_shepp};
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_picture::{CurveScene, Picture, draw_curves};

/// A pose as it was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    pub x: f64,
    pub y: f64,
    pub heading_deg: f64,
}

impl End {
    /// Full turns are taken off before the degrees become radians, so that they change nothing.
    pub fn pose(self) -> Pose {
        Pose::new(self.x, self.y, (self.heading_deg % 360.0).to_radians())
    }
}

/// The least extent of the picture, in turning radii.
const MIN_RADII: f64 = 1e-3;

/// The curves between one pair of poses.
pub struct CurveReport {
    pub from: End,
    pub to: End,
    pub radius_m: f64,
    /// The shortest Reeds-Shepp curve, the shortest Dubins curve, and, if prices were given, the cheapest Reeds-Shepp
    /// curve.
    pub curves: Vec<FoundCurve>,
}

/// A curve of some kind, laid out from the start.
pub struct FoundCurve {
    /// As programs read it.
    pub kind: &'static str,
    /// As people read it.
    pub name: &'static str,
    /// Without letters of no length.
    pub word: String,
    /// The paper's family, of Reeds-Shepp curves.
    pub family: Option<String>,
    pub length_m: f64,
    /// The prices that were to be minimal, and the sum; `None` if the length was.
    pub price: Option<(CurvePrice, f64)>,
    pub path: Path,
}

impl CurveReport {
    /// Computes the curves between two poses.
    pub fn new(from: End, to: End, radius_m: f64, price: Option<CurvePrice>) -> Self {
        let (start, goal) = (from.pose(), to.pose());
        let reeds_shepp = ReedsShepp { radius_m };
        let mut curves = vec![
            reeds_shepp_curve("reeds_shepp", "Reeds-Shepp", &reeds_shepp.shortest(start, goal), start),
            dubins_curve(&Dubins { radius_m }, start, goal),
        ];
        if let Some(price) = price {
            let cheapest = reeds_shepp.cheapest(start, goal, &price);
            let curve = reeds_shepp_curve("cheapest_reeds_shepp", "Cheapest Reeds-Shepp", &cheapest.curve, start);
            curves.push(FoundCurve { price: Some((price, cheapest.price)), ..curve });
        }
        Self { from, to, radius_m, curves }
    }
}

fn reeds_shepp_curve(kind: &'static str, name: &'static str, curve: &reeds_shepp::Curve, start: Pose) -> FoundCurve {
    FoundCurve {
        kind,
        name,
        word: reeds_shepp_word(curve),
        family: Some(curve.word.family().to_string()),
        length_m: curve.length_m,
        price: None,
        path: curve.path(start),
    }
}

/// The word without letters of no length.
pub fn reeds_shepp_word(curve: &reeds_shepp::Curve) -> String {
    curve.driven_letters().map(|letter| letter.to_string()).collect()
}

/// The steering alone, since all letters are forward.
pub fn dubins_word(curve: &dubins::Curve) -> String {
    curve.driven_letters().map(|letter| letter.steering.to_string()).collect()
}

fn dubins_curve(dubins: &Dubins, start: Pose, goal: Pose) -> FoundCurve {
    let curve = dubins.shortest(start, goal);
    FoundCurve {
        kind: "dubins",
        name: "Dubins",
        word: dubins_word(&curve),
        family: None,
        length_m: curve.length_m,
        price: None,
        path: curve.path(start),
    }
}

impl From<&CurveReport> for Document {
    fn from(report: &CurveReport) -> Self {
        let ends = vec![format!("From {}", pose_text(report.from)), format!("to {}", pose_text(report.to))];
        Self::new(format!("Shortest curves with a turning radius of {} m", report.radius_m))
            .with([Block::List(ends)])
            .with(report.curves.iter().flat_map(curve_blocks))
    }
}

fn pose_text(End { x, y, heading_deg }: End) -> String {
    format!("x {} m, y {} m, heading {} degrees", short(x), short(y), short(heading_deg))
}

/// The length and word of a curve, then its segments: steering, gear, metres, and degrees that the heading changes by.
fn curve_blocks(found: &FoundCurve) -> Vec<Block> {
    let cusps = match found.path.cusps() {
        0 => "no cusp".to_owned(),
        cusps => count(cusps as usize, "cusp"),
    };
    let mut lines = vec![format!("{}: {} m, {}, {cusps}", found.name, rounded(found.length_m, 6), word(found))];
    lines.extend(found.price.map(|(price, paid)| {
        let factor = short(price.reverse_factor);
        let cusp_m = short(price.cusp_m);
        format!("Costs {} m; a metre in reverse counts {factor}, a cusp {cusp_m} m.", rounded(paid, 6))
    }));
    let segments: Vec<_> = found
        .path
        .segments
        .iter()
        .map(|segment| {
            let turn = turn_deg(segment);
            let turn = if turn == 0.0 { String::new() } else { format!("{turn:+.6}") };
            vec![steering(segment).into(), direction(segment).into(), rounded(segment.length_m.abs(), 6), turn]
        })
        .collect();
    let table = Table { text_columns: 2, ..Table::new(&["Steering", "Gear", "Length m", "Turn degrees"], segments) };
    let has_segments = !table.rows.is_empty();
    [Block::List(lines)].into_iter().chain(has_segments.then_some(Block::Table(table))).collect()
}

/// The word and, of Reeds-Shepp curves, its family; `no segment` between equal poses.
fn word(found: &FoundCurve) -> String {
    match &found.family {
        _ if found.word.is_empty() => "no segment".into(),
        Some(family) => format!("{}, family {family}", found.word),
        None => found.word.clone(),
    }
}

/// Names the direction of the steering wheel.
fn steering(segment: &Segment) -> &'static str {
    match segment.curvature {
        0.0 => "straight",
        left if left > 0.0 => "left",
        _ => "right",
    }
}

pub fn direction(segment: &Segment) -> &'static str {
    if segment.is_reverse() { "reverse" } else { "forward" }
}

/// Returns how far the heading turns, counter-clockwise.
fn turn_deg(segment: &Segment) -> f64 {
    (segment.curvature * segment.length_m).to_degrees()
}

impl Serialize for CurveReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [from, to] =
            [self.from, self.to].map(|End { x, y, heading_deg }| object!(Pose { x_m: x, y_m: y, heading_deg }));
        let report = object!(Report {
            program_version: PROGRAM_VERSION,
            from,
            to,
            radius_m: self.radius_m,
            curves: self.curves.iter().map(curve).collect::<Vec<_>>(),
        });
        report.serialize(serializer)
    }
}

/// A curve as an object; members that do not apply are null.
fn curve(found: &FoundCurve) -> impl Serialize {
    let price =
        |(CurvePrice { reverse_factor, cusp_m, .. }, price_m)| object!(Price { reverse_factor, cusp_m, price_m });
    let segments = found.path.segments.iter().map(|segment| {
        object!(Segment {
            steering: steering(segment),
            direction: direction(segment),
            length_m: segment.length_m.abs(),
            turn_deg: turn_deg(segment),
        })
    });
    object!(Curve {
        curve: found.kind,
        length_m: found.length_m,
        word: &found.word,
        family: &found.family,
        cusps: found.path.cusps(),
        price: found.price.map(price),
        segments: segments.collect::<Vec<_>>(),
    })
}

impl CurveReport {
    /// Draws the curves, and the contest's truck unless the radius is shorter than its wheelbase, which no truck drives.
    pub fn draw(&self) -> Picture {
        let truck = Dimensions::default();
        let names = self.curves.iter().map(|curve| format!("{}, {} m", curve.name, rounded(curve.length_m, 3)));
        let names: Vec<String> = names.collect();
        let ways: Vec<_> = names.iter().zip(&self.curves).map(|(name, curve)| (name.as_str(), &curve.path)).collect();
        let from = end_text(self.from);
        let to = end_text(self.to);
        let radius_m = self.radius_m;
        draw_curves(&CurveScene {
            title: &format!("Shortest curves from {from} to {to}, turning radius {radius_m} m"),
            start: self.from.pose(),
            goal: self.to.pose(),
            ways: &ways,
            // A truck that turns on a circle within its wheelbase would be drawn where it cannot be.
            body: (radius_m >= truck.wheelbase_m).then_some(&truck),
            min_m: MIN_RADII * radius_m,
        })
    }
}

fn end_text(End { x, y, heading_deg }: End) -> String {
    format!("({}, {}, {} deg)", short(x), short(y), short(heading_deg))
}
