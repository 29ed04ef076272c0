//! Sprites of cells drawn once and laid down often.

use crate::picture::canvas::{Canvas, Point};

/// Cells with longer sides than this, in pixels, are few: their sprites are drawn where they are.
const MOST_SIDE: f32 = 96.0;

/// A stamp is so many sides of a cell wide, so that what sticks out of its cell is on it.
const WIDTH: f32 = 1.8;

/// Drawings on small sheets, all for cells of one size.
#[derive(Default)]
pub struct Stamps {
    side: f32,
    drawn: Vec<Option<Canvas>>,
}

impl Stamps {
    /// Forgets what was drawn for cells of another size.
    pub fn begin(&mut self, side: f32) {
        if self.side != side {
            *self = Self { side, drawn: Vec::new() };
        }
    }

    /// Lays down what `draw` draws about a place, for cells of the present side; `number` tells one drawing from others.
    pub fn lay(&mut self, canvas: &mut Canvas, (x, y): Point, number: usize, draw: impl Fn(&mut Canvas, Point, f32)) {
        if self.side > MOST_SIDE {
            return draw(canvas, (x, y), self.side);
        }
        let half = (0.5 * WIDTH * self.side).ceil() as u32 + 1;
        if self.drawn.len() <= number {
            self.drawn.resize_with(number + 1, || None);
        }
        let stamp = self.drawn[number].get_or_insert_with(|| {
            let mut stamp = Canvas::transparent(2 * half, 2 * half);
            draw(&mut stamp, (half as f32, half as f32), self.side);
            stamp
        });
        canvas.lay_over(stamp, (x.round() as i32 - half as i32, y.round() as i32 - half as i32));
    }
}
