//! Long lines in pixels: the part of them that is in the pane, and dashes along them.

use crate::canvas::{Canvas, Pen, Point};
use crate::film::field::Pane;
use crate::thin_line::draw_line;
use wildfire_base::geometry::DVec2;

/// Lines are drawn this far beyond the pane, in pixels, so that their ends are not seen.
const BEYOND: f64 = 16.0;

/// Dashes along a line, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dashes {
    pub length: f64,
    pub gap: f64,
    /// The place in the pattern where the line begins.
    pub offset: f64,
}

/// Draws a line through places in the pane, as far as it can be seen there.
pub fn draw_visible_line(canvas: &mut Canvas, pane: &Pane, line: &[DVec2], pen: Pen, dashes: Option<Dashes>) {
    let mut passed = 0.0;
    for pair in line.windows(2) {
        let step = pair[1] - pair[0];
        let length = step.length();
        if let Some((first, last)) = clip(pair[0], pair[1], pane.size) {
            let mut draw = |from: f64, to: f64| {
                let at = |share: f64| -> Point { (pair[0] + step * share).as_vec2().into() };
                draw_line(canvas, at(from), at(to), pen.width, pen.ink);
            };
            match dashes {
                None => draw(first, last),
                Some(dashes) => {
                    // Dashes count from the beginning of the line and not of what is seen, or they would crawl as the view moves.
                    let from = dashes.offset + passed;
                    for (begins, ends) in dashes.between(from + first * length, from + last * length) {
                        draw((begins - from) / length, (ends - from) / length);
                    }
                }
            }
        }
        passed += length;
    }
}

impl Dashes {
    /// Returns where dashes begin and end between two places of the pattern.
    fn between(self, first: f64, last: f64) -> impl Iterator<Item = (f64, f64)> {
        let period = self.length + self.gap;
        let numbers = std::iter::successors(Some((first / period).floor()), move |number| Some(number + 1.0));
        let numbers = numbers.take(((last - first) / period) as usize + 2);
        numbers.filter_map(move |number| {
            let begins = number * period;
            let (begins, ends) = (begins.max(first), (begins + self.length).min(last));
            (begins < ends).then_some((begins, ends))
        })
    }
}

/// Returns where a piece enters a pane and leaves it, as shares of its length (Liang and Barsky, "A New Concept and
/// Method for Line Clipping", ACM Transactions on Graphics 3(1), 1984).
fn clip(from: DVec2, to: DVec2, (width, height): (u32, u32)) -> Option<(f64, f64)> {
    let max = DVec2::new(f64::from(width), f64::from(height)) + BEYOND;
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (at, step, max) in [(from.x, to.x - from.x, max.x), (from.y, to.y - from.y, max.y)] {
        if step == 0.0 {
            // A piece along an edge never crosses it, so it is inside or outside as a whole.
            if !(-BEYOND..=max).contains(&at) {
                return None;
            }
        } else {
            let a = (-BEYOND - at) / step;
            let b = (max - at) / step;
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
    }
    (first < last).then_some((first, last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_seen_where_they_are_in_the_pane() {
        let seen = |from: (f64, f64), to: (f64, f64)| clip(DVec2::from(from), DVec2::from(to), (100, 50));
        assert_eq!(seen((10.0, 10.0), (90.0, 40.0)), Some((0.0, 1.0)));
        assert_eq!(seen((50.0, 25.0), (50.0, 125.0)), Some((0.0, 0.41)));
        assert_eq!(seen((-32.0, 7.0), (0.0, 7.0)), Some((0.5, 1.0)));
        assert_eq!(seen((-50.0, 0.0), (-20.0, 50.0)), None);
        assert_eq!(seen((10.0, 70.0), (90.0, 70.0)), None);
        assert_eq!(seen((110.0, -40.0), (140.0, 20.0)), None, "it passes a corner");
    }

    #[test]
    fn dashes_repeat_and_are_cut_at_the_ends() {
        let dashes = Dashes { length: 3.0, gap: 2.0, offset: 0.0 };
        assert_eq!(dashes.between(1.0, 12.0).collect::<Vec<_>>(), [(1.0, 3.0), (5.0, 8.0), (10.0, 12.0)]);
        assert_eq!(dashes.between(3.5, 4.5).count(), 0);
        assert_eq!(dashes.between(-1.0, 1.0).collect::<Vec<_>>(), [(0.0, 1.0)]);
        assert_eq!(dashes.between(f64::NAN, f64::NAN).count(), 0);
    }
}
