//! What ways of a vehicle are drawn with: lines in both directions, cusps, and arrows at the poses where they begin and end.

use crate::geometry::ops;

use super::canvas::{Canvas, Point};
use super::colours::{GOAL, INK, PAPER, Rgb};
use super::marks::to_f32;

/// A pose that is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseMark {
    Start,
    Goal,
}

impl PoseMark {
    pub fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Goal => "goal",
        }
    }

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
    let (sin, cos) = (to_f32(sin) * radius, to_f32(cos) * radius);
    let corner = |ahead: f32, left: f32| (x + ahead * cos - left * sin, y - ahead * sin - left * cos);
    [corner(1.0, 0.0), corner(-0.8, 0.75), corner(-0.4, 0.0), corner(-0.8, -0.75)]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn arrows_point_along_the_heading() {
        let tip = |heading| arrow((50.0, 50.0), heading, 10.0)[0];
        let near = |(x, y): Point, expected: Point| (x - expected.0).abs() + (y - expected.1).abs() < 1e-3;
        assert!(near(tip(0.0), (60.0, 50.0)), "east is right");
        assert!(near(tip(FRAC_PI_2), (50.0, 40.0)), "north is up");
    }
}
