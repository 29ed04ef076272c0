//! Paths of a vehicle as lines of points, and their symbols: lines in both directions, cusps, arrows at poses.

use crate::canvas::{Canvas, Point};
use crate::colours::{GOAL, INK, PAPER, Rgb};
use crate::marks::to_f32;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::{Path, Segment};

/// Arcs are drawn with a point for each turn by this much, in radians: 0.05 pixels off at a radius of 300 pixels.
const TURN_RAD: f64 = 0.035;

/// A stretch of a path between cusps.
pub struct WayRun {
    pub is_reverse: bool,
    /// Metres east and north, from the start of the stretch to its end; at least two.
    pub places: Vec<(f64, f64)>,
}

/// The stretches of a path, none if it has no length.
pub fn way_runs(path: &Path) -> Vec<WayRun> {
    let mut runs: Vec<WayRun> = Vec::new();
    for (start, segment) in path.legs() {
        if runs.last().is_none_or(|run| run.is_reverse != segment.is_reverse()) {
            runs.push(WayRun { is_reverse: segment.is_reverse(), places: vec![(start.x, start.y)] });
        }
        let run = runs.last_mut().expect("there is one by now");
        run.places.extend(places(start, segment));
    }
    runs
}

/// Places on a segment, without its start.
fn places(start: Pose, segment: Segment) -> impl Iterator<Item = (f64, f64)> {
    let turn = (segment.curvature * segment.length_m).abs();
    let steps = (turn / TURN_RAD).ceil().max(1.0);
    let shares = std::iter::successors(Some(1.0), |step| Some(step + 1.0)).map(move |step: f64| step / steps);
    shares.take_while(|&share| share <= 1.0).map(move |share| {
        let pose = segment.pose_at(start, share * segment.length_m);
        (pose.x, pose.y)
    })
}

/// A pose that is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseMark {
    Start,
    Goal,
}

wildfire_base::names! { PoseMark { Start: "start", Goal: "goal" } }

impl PoseMark {
    /// Draws an arrow about a place, its heading in radians counter-clockwise from the right.
    pub fn draw(self, canvas: &mut Canvas, at: Point, heading: f64, radius: f32) {
        let inside = match self {
            Self::Start => PAPER,
            Self::Goal => GOAL,
        };
        for (share, colour) in [(1.5, PAPER), (1.25, INK), (0.8, inside)] {
            canvas.fill(&arrow(at, heading, share * radius), colour);
        }
    }
}

/// A line of a way: whole forward, dashed in reverse.
pub fn draw_run(canvas: &mut Canvas, points: &[Point], width: f32, colour: Rgb, is_reverse: bool) {
    if is_reverse { canvas.dashed(points, width, colour) } else { canvas.polyline(points, width, colour) }
}

pub fn draw_cusp(canvas: &mut Canvas, at: Point) {
    canvas.fill_disc(at, 5.0, INK);
    canvas.fill_disc(at, 3.0, PAPER);
}

/// A tip, two tails and the notch between them.
fn arrow((x, y): Point, heading: f64, radius: f32) -> [Point; 4] {
    let (sin, cos) = ops::sin_cos(heading);
    let sin = to_f32(sin) * radius;
    let cos = to_f32(cos) * radius;
    let corner = |ahead: f32, left: f32| (x + ahead * cos - left * sin, y - ahead * sin - left * cos);
    [corner(1.0, 0.0), corner(-0.8, 0.75), corner(-0.4, 0.0), corner(-0.8, -0.75)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn runs_change_at_cusps_and_follow_the_path() {
        let segment = |curvature, length_m| Segment { curvature, length_m };
        let segments = vec![segment(0.1, 9.0), segment(0.0, 4.0), segment(-0.1, -6.0)];
        let path = Path { start: Pose::new(3.0, 5.0, 1.0), segments };
        let runs = way_runs(&path);
        assert_eq!(runs.iter().map(|run| run.is_reverse).collect::<Vec<_>>(), [false, true]);
        assert_eq!(runs[0].places[0], (3.0, 5.0));
        assert_eq!(runs[0].places.last(), runs[1].places.first());
        let end = path.end();
        assert_eq!(*runs[1].places.last().expect("places"), (end.x, end.y));
        let drawn_m = |run: &WayRun| {
            let steps = run.places.windows(2).map(|pair| {
                let x = pair[1].0 - pair[0].0;
                let y = pair[1].1 - pair[0].1;
                (x * x + y * y).sqrt()
            });
            steps.sum::<f64>()
        };
        assert!((drawn_m(&runs[0]) - 13.0).abs() < 1e-2 && (drawn_m(&runs[1]) - 6.0).abs() < 1e-2);
    }

    #[test]
    fn standing_is_no_line() {
        assert!(way_runs(&Path::standing(Pose::default())).is_empty());
    }

    #[test]
    fn arrows_point_along_the_heading() {
        let tip = |heading| arrow((50.0, 50.0), heading, 10.0)[0];
        let near = |(x, y): Point, expected: Point| (x - expected.0).abs() + (y - expected.1).abs() < 1e-3;
        assert!(near(tip(0.0), (60.0, 50.0)), "east is right");
        assert!(near(tip(FRAC_PI_2), (50.0, 40.0)), "north is up");
    }
}
