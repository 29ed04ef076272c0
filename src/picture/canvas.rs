//! A sheet of pixels and the few ways to draw on it.
//!
//! Pixel (0, 0) is at the upper left; pixel (x, y) covers x to x + 1 and y to y + 1. All drawing is opaque, but for
//! [`Canvas::fill_through`].

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform,
};

use super::colours::{PAPER, Rgb};
use super::png::Picture;

/// A place on the sheet, in pixels to the right and down.
pub type Point = (f32, f32);

/// The most points that are stroked at once, which bounds the memory that a long line takes.
const STROKED_AT_ONCE: usize = 4096;

pub struct Canvas {
    pixels: Pixmap,
}

impl Canvas {
    /// # Panics
    /// If a side is 0 or the sheet does not fit into memory.
    pub fn new(width: u32, height: u32, colour: Rgb) -> Self {
        let mut pixels = Pixmap::new(width, height).expect("a sheet has sides and fits into memory");
        pixels.fill(Color::from_rgba8(colour[0], colour[1], colour[2], 255));
        Self { pixels }
    }

    /// A sheet of at least that width and height in pixels.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sheet has some thousand pixels")]
    pub fn sized(width: f32, height: f32, colour: Rgb) -> Self {
        Self::new(width.ceil() as u32, height.ceil() as u32, colour)
    }

    /// Gives every pixel of a rectangle one colour; what lies outside the sheet is left out.
    pub fn fill_rect(&mut self, left: f32, top: f32, width: f32, height: f32, colour: Rgb) {
        if let Some(rect) = Rect::from_xywh(left.round(), top.round(), width.round(), height.round()) {
            self.pixels.fill_rect(rect, &paint(colour), Transform::identity(), None);
        }
    }

    /// Fills the area inside a closed line.
    pub fn fill(&mut self, corners: &[Point], colour: Rgb) {
        if let Some(area) = closed(corners) {
            self.fill_path(&area, colour);
        }
    }

    /// Fills the area inside a closed line with an opacity from 0 to 1.
    pub fn fill_through(&mut self, corners: &[Point], colour: Rgb, opacity: f32) {
        if let Some(area) = closed(corners) {
            let mut paint = paint(colour);
            paint.shader.apply_opacity(opacity);
            self.pixels.fill_path(&area, &paint, FillRule::Winding, Transform::identity(), None);
        }
    }

    /// Fills the area inside a closed line with pixels that it covers by their centre, so that areas side by side show
    /// no seam.
    pub fn fill_hard(&mut self, corners: &[Point], colour: Rgb) {
        if let Some(area) = closed(corners) {
            let paint = Paint { anti_alias: false, ..paint(colour) };
            self.pixels.fill_path(&area, &paint, FillRule::EvenOdd, Transform::identity(), None);
        }
    }

    pub fn fill_disc(&mut self, (x, y): Point, radius: f32, colour: Rgb) {
        if let Some(disc) = PathBuilder::from_circle(x, y, radius) {
            self.fill_path(&disc, colour);
        }
    }

    fn fill_path(&mut self, path: &Path, colour: Rgb) {
        self.pixels.fill_path(path, &paint(colour), FillRule::Winding, Transform::identity(), None);
    }

    /// Draws a line of straight pieces with round ends.
    pub fn polyline(&mut self, points: &[Point], width: f32, colour: Rgb) {
        let mut from = 0;
        while from + 1 < points.len() {
            let to = (from + STROKED_AT_ONCE).min(points.len() - 1);
            self.stroke(open(&points[from..=to]), width, colour);
            from = to;
        }
    }

    /// Draws a line of straight pieces in dashes that are as long as the gaps between them, three widths.
    pub fn dashed(&mut self, points: &[Point], width: f32, colour: Rgb) {
        self.dashed_by(points, width, colour, vec![3.0 * width; 2]);
    }

    /// Draws a line of straight pieces in dashes; lengths of dashes and gaps in pixels, an even number of them.
    pub fn dashed_by(&mut self, points: &[Point], width: f32, colour: Rgb, lengths: Vec<f32>) {
        let dash = StrokeDash::new(lengths, 0.0);
        let stroke = Stroke { width, dash, line_join: LineJoin::Round, ..Stroke::default() };
        self.stroke_with(open(points), &stroke, colour);
    }

    /// Draws along a path with a round pen.
    pub fn stroke(&mut self, path: PathBuilder, width: f32, colour: Rgb) {
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.stroke_with(path, &stroke, colour);
    }

    fn stroke_with(&mut self, path: PathBuilder, stroke: &Stroke, colour: Rgb) {
        if let Some(path) = path.finish() {
            self.pixels.stroke_path(&path, &paint(colour), stroke, Transform::identity(), None);
        }
    }

    /// Draws along a closed line with pixels that it covers by their centre: few colours, which pack small.
    pub fn outline_hard(&mut self, corners: &[Point], width: f32, colour: Rgb) {
        if let Some(line) = closed(corners) {
            let paint = Paint { anti_alias: false, ..paint(colour) };
            let stroke = Stroke { width, ..Stroke::default() };
            self.pixels.stroke_path(&line, &paint, &stroke, Transform::identity(), None);
        }
    }

    /// The pixels of a row from `left` on, as red, green, blue and opacity.
    pub fn row_from(&mut self, left: usize, row: usize) -> &mut [[u8; 4]] {
        let width = self.pixels.width() as usize;
        let (pixels, _) = self.pixels.data_mut().as_chunks_mut();
        &mut pixels[row * width + left..(row + 1) * width]
    }

    /// The same sheet at half the size: the mean of each square of four pixels.
    pub fn halved(self) -> Self {
        let (width, height) = (self.pixels.width() / 2, self.pixels.height() / 2);
        let mut half = Self::new(width, height, PAPER);
        let (finer, _) = self.pixels.data().as_chunks::<4>();
        let stride = self.pixels.width() as usize;
        for row in 0..height as usize {
            let above = &finer[2 * row * stride..];
            let below = &finer[(2 * row + 1) * stride..];
            for (col, pixel) in half.row_from(0, row).iter_mut().enumerate() {
                let square = [above[2 * col], above[2 * col + 1], below[2 * col], below[2 * col + 1]];
                *pixel = mean(square);
            }
        }
        half
    }

    pub fn finish(self) -> Picture {
        let (width, height) = (self.pixels.width(), self.pixels.height());
        Picture::from_rgba(width, height, self.pixels.take())
    }
}

fn mean(pixels: [[u8; 4]; 4]) -> [u8; 4] {
    std::array::from_fn(|channel| {
        let sum: u16 = pixels.iter().map(|pixel| u16::from(pixel[channel])).sum();
        u8::try_from((sum + 2) / 4).expect("a mean of bytes is a byte")
    })
}

fn paint(colour: Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(colour[0], colour[1], colour[2], 255);
    paint
}

fn open(points: &[Point]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (index, &(x, y)) in points.iter().enumerate() {
        if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path
}

fn closed(corners: &[Point]) -> Option<Path> {
    let mut path = open(corners);
    path.close();
    path.finish()
}
