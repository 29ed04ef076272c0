//! Styles of series: colour, hatching, dashes, mark.

use super::drawing::Drawing;
use crate::canvas::Point;
use crate::colours::{INK, PAPER, Rgb};
use crate::marks::to_f32;
use wildfire_base::geometry::ops;

/// The style of a series; no two differ in colour alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    pub colour: Rgb,
    hatch: Hatch,
    dashes: &'static [f32],
    corners: u8,
}

/// Lines across an area.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Hatch {
    None,
    Rising,
    Falling,
    Crossed,
    Level,
}

/// Looks of series in their order; the colours are seven of Okabe and Ito's eight, whose yellow is too faint for a
/// line.
pub const STYLES: [Style; 7] = [
    Style { colour: [0, 114, 178], hatch: Hatch::None, dashes: &[], corners: 0 },
    Style { colour: [213, 94, 0], hatch: Hatch::Rising, dashes: &[8.0, 4.0], corners: 4 },
    Style { colour: [0, 158, 115], hatch: Hatch::Falling, dashes: &[2.0, 3.0], corners: 3 },
    Style { colour: [204, 121, 167], hatch: Hatch::Crossed, dashes: &[8.0, 3.0, 2.0, 3.0], corners: 0 },
    Style { colour: [230, 159, 0], hatch: Hatch::Level, dashes: &[14.0, 4.0], corners: 4 },
    Style { colour: [86, 180, 233], hatch: Hatch::Rising, dashes: &[4.0, 4.0], corners: 3 },
    Style { colour: INK, hatch: Hatch::None, dashes: &[14.0, 3.0, 2.0, 3.0, 2.0, 3.0], corners: 5 },
];

const HATCH_STEP: f32 = 7.0;
const LINE: f32 = 2.0;

impl Style {
    pub fn fill_rect(&self, drawing: &mut Drawing, from: Point, to: Point) {
        drawing.rect(from, to, self.colour);
        let mut lines = |is_rising| {
            for line in hatching(from, to, is_rising) {
                drawing.line(line.to_vec(), 1.4, PAPER);
            }
        };
        match self.hatch {
            Hatch::None => {}
            Hatch::Rising => lines(true),
            Hatch::Falling => lines(false),
            Hatch::Crossed => [true, false].into_iter().for_each(lines),
            Hatch::Level => {
                // Strokes lie at multiples of the step over the whole sheet, so neighbouring bars have one pattern.
                let mut y = (from.1 / HATCH_STEP).ceil() * HATCH_STEP;
                while y < to.1 {
                    drawing.line(vec![(from.0, y), (to.0, y)], 1.4, PAPER);
                    y += HATCH_STEP;
                }
            }
        }
    }

    pub fn line(&self, drawing: &mut Drawing, points: Vec<Point>) {
        drawing.dashed(points, LINE, self.colour, self.dashes);
    }

    /// A disc, or a shape with corners.
    pub fn mark(&self, drawing: &mut Drawing, (x, y): Point, radius: f32) {
        let (corners, radius) = if self.corners == 0 { (24, radius) } else { (self.corners, 1.25 * radius) };
        let corner = |index: u8, radius: f32| {
            let (sin, cos) = ops::sin_cos(f64::from(index) * std::f64::consts::TAU / f64::from(corners));
            (x + radius * to_f32(sin), y - radius * to_f32(cos))
        };
        drawing.area((0..corners).map(|index| corner(index, radius + 1.0)).collect(), PAPER, 1.0);
        drawing.area((0..corners).map(|index| corner(index, radius)).collect(), self.colour, 1.0);
    }
}

/// The pieces of slanting lines that lie in a rectangle; their places do not depend on it.
fn hatching((left, top): Point, (right, bottom): Point, is_rising: bool) -> impl Iterator<Item = [Point; 2]> {
    // On a rising line x + y is the same everywhere, on a falling one x - y.
    let (first, last) = if is_rising { (left + top, right + bottom) } else { (left - bottom, right - top) };
    let start = (first / HATCH_STEP).ceil() * HATCH_STEP;
    let sums = std::iter::successors(Some(start), |sum| Some(sum + HATCH_STEP)).take_while(move |&sum| sum < last);
    sums.map(move |sum| {
        let (low, high) = if is_rising { (sum - bottom, sum - top) } else { (sum + top, sum + bottom) };
        let at = |x: f32| (x, if is_rising { sum - x } else { x - sum });
        [at(low.max(left)), at(high.min(right))]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn styles_differ_without_their_colours() {
        for (index, style) in STYLES.iter().enumerate() {
            for other in &STYLES[..index] {
                assert_ne!(style.colour, other.colour);
                assert_ne!(style.dashes, other.dashes);
            }
        }
    }

    #[test]
    fn hatching_stays_inside() {
        for is_rising in [true, false] {
            let lines: Vec<_> = hatching((3.0, 5.0), (40.0, 21.0), is_rising).collect();
            assert!(lines.len() > 4);
            for (x, y) in lines.into_iter().flatten() {
                assert!((2.99..=40.01).contains(&x) && (4.99..=21.01).contains(&y), "{x}, {y}");
            }
        }
    }
}
