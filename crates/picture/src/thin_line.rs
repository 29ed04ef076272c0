//! Straight lines a few pixels wide, drawn without general paths, since frames have thousands of them.

use super::canvas::{Canvas, Ink, Point};

/// Draws a line on an opaque sheet, smoothed by how much of each pixel it covers; its ends are cut along the pixels.
/// Lines that begin where others end leave no gap. What is no number is not drawn.
pub fn draw_line(canvas: &mut Canvas, from: Point, to: Point, width: f32, ink: Ink) {
    let (right, down) = (to.0 - from.0, to.1 - from.1);
    if !(right.is_finite() && down.is_finite()) || (right == 0.0 && down == 0.0) {
        return;
    }
    let columns = canvas.width() as usize;
    let rows = canvas.height() as usize;
    let pixels = canvas.pixels_mut();
    // Along the longer side, so that each step is a whole pixel and no gap is left.
    if right.abs() >= down.abs() {
        let mut put = |x: usize, y: usize, share: f32| blend(&mut pixels[y * columns + x], ink, share);
        sweep(from, to, width, (columns, rows), &mut put);
    } else {
        let mut put = |y: usize, x: usize, share: f32| blend(&mut pixels[y * columns + x], ink, share);
        sweep((from.1, from.0), (to.1, to.0), width, (rows, columns), &mut put);
    }
}

/// Calls `put` with place and covered share of the pixels of a line that is no steeper than its first coordinate is
/// long; `room` pixels there are along each coordinate.
fn sweep(from: Point, to: Point, width: f32, room: (usize, usize), put: &mut impl FnMut(usize, usize, f32)) {
    let (from, to) = if from.0 <= to.0 { (from, to) } else { (to, from) };
    let slope = (to.1 - from.1) / (to.0 - from.0);
    let half = 0.5 * width * (1.0 + slope * slope).sqrt();
    // A column of pixels at a time: a line that is not steep covers few pixels of each.
    let first = from.0.max(0.0);
    let last = to.0.min(room.0 as f32);
    for along in first as usize..last.ceil().max(0.0) as usize {
        let begins = first.max(along as f32);
        let ends = last.min(along as f32 + 1.0);
        let middle = from.1 + slope * (0.5 * (begins + ends) - from.0);
        // The line counts as level within a column, at its height in the middle.
        let (low, high) = (middle - half, middle + half);
        for across in low.max(0.0) as usize..(high.ceil().max(0.0) as usize).min(room.1) {
            let covered = high.min(across as f32 + 1.0) - low.max(across as f32);
            put(along, across, covered * (ends - begins));
        }
    }
}

fn blend(pixel: &mut [u8; 4], ink: Ink, share: f32) {
    let weight = (256.0 * ink.opacity * share) as i32;
    for (under, &over) in pixel.iter_mut().zip(&ink.colour) {
        let under_then = i32::from(*under);
        *under = (under_then + (((i32::from(over) - under_then) * weight + 128) >> 8)) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::{INK, PAPER};

    /// Returns how much ink a line leaves on paper, in whole pixels of it.
    fn area(lines: &[[Point; 2]], width: f32) -> f64 {
        let mut canvas = Canvas::new(60, 50, PAPER);
        for &[from, to] in lines {
            draw_line(&mut canvas, from, to, width, Ink::opaque(INK));
        }
        let picture = canvas.finish();
        let darkness = |index: u32| f64::from(255 - picture.pixel(index % 60, index / 60)[0]);
        (0..3000).map(darkness).sum::<f64>() / f64::from(255 - INK[0])
    }

    #[test]
    fn lines_cover_their_length_times_their_width() {
        for (to, width) in [((50.0, 10.0), 1.0), ((50.0, 37.5), 2.0), ((10.0, 40.0), 1.5), ((30.0, 45.0), 3.0)] {
            let from = (10.0, 10.0);
            let length = f64::from((to.0 - from.0) * (to.0 - from.0) + (to.1 - from.1) * (to.1 - from.1)).sqrt();
            for line in [[from, to], [to, from]] {
                let expected = length * f64::from(width);
                assert!((area(&[line], width) - expected).abs() < 0.03 * expected, "{line:?}");
            }
        }
    }

    #[test]
    fn a_line_in_two_parts_is_the_line() {
        let a = (3.2, 40.1);
        let b = (20.7, 30.2);
        let c = (38.2, 20.3);
        let whole = area(&[[a, c]], 2.0);
        let parts = area(&[[a, b], [b, c]], 2.0);
        assert!((whole - parts).abs() < 1.0, "{whole} and {parts}");
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let inside = area(&[[(0.0, 20.0), (60.0, 20.0)]], 2.0);
        assert_eq!(area(&[[(-1e7, 20.0), (1e7, 20.0)]], 2.0), inside);
        for line in [[(-9.0, -9.0), (-1.0, 60.0)], [(f32::NAN, 1.0), (5.0, 5.0)], [(70.0, 0.0), (90.0, 50.0)]] {
            assert_eq!(area(&[line], 2.0), 0.0, "{line:?}");
        }
    }
}
