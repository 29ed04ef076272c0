//! A sheet of pixels and the operations that draw on it.
//!
//! Pixel (0, 0) is at the upper left; pixel (x, y) covers x to x + 1 and y to y + 1. All drawing is opaque, except
//! [`Canvas::fill_through`], for what takes an [`Ink`] or a [`Pen`], and for sheets laid over others.

use std::ops::Range;

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform,
};

use super::colours::{PAPER, Rgb};
use super::png::Picture;

/// A point on the sheet, in pixels to the right and down.
pub type Point = (f32, f32);

/// The most points that are stroked at once, which bounds the memory that a long line takes.
const STROKED_AT_ONCE: usize = 4096;

/// A colour with an opacity from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink {
    pub colour: Rgb,
    pub opacity: f32,
}

/// A pen for lines; their ends are cut off straight, so that lines that follow each other do not overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    pub ink: Ink,
    /// In pixels.
    pub width: f32,
}

#[derive(Clone)]
pub struct Canvas {
    pixels: Pixmap,
}

impl Ink {
    pub fn opaque(colour: Rgb) -> Self {
        Self { colour, opacity: 1.0 }
    }

    fn paint(self) -> Paint<'static> {
        let mut paint = paint(self.colour);
        paint.shader.apply_opacity(self.opacity);
        paint
    }
}

impl Pen {
    pub fn opaque(colour: Rgb, width: f32) -> Self {
        Self { ink: Ink::opaque(colour), width }
    }

    fn stroke(&self) -> Stroke {
        Stroke { width: self.width, line_join: LineJoin::Round, ..Stroke::default() }
    }
}

impl Canvas {
    /// # Panics
    /// If a side is 0 or the sheet does not fit into memory.
    pub fn new(width: u32, height: u32, colour: Rgb) -> Self {
        let mut pixels = Pixmap::new(width, height).expect("a sheet has sides and fits into memory");
        pixels.fill(Color::from_rgba8(colour[0], colour[1], colour[2], 255));
        Self { pixels }
    }

    /// Creates a transparent sheet, to lay over another one.
    ///
    /// # Panics
    /// As [`Canvas::new`].
    pub fn transparent(width: u32, height: u32) -> Self {
        Self { pixels: Pixmap::new(width, height).expect("a sheet has sides and fits into memory") }
    }

    pub fn width(&self) -> u32 {
        self.pixels.width()
    }

    pub fn height(&self) -> u32 {
        self.pixels.height()
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

    /// Gives the pixels from (`left`, `top`) to before (`right`, `bottom`) one colour, as far as they are on the sheet.
    pub fn fill_pixels(&mut self, (left, top): (i32, i32), (right, bottom): (i32, i32), [red, green, blue]: Rgb) {
        let width = self.width() as usize;
        let height = self.height() as usize;
        let left = on_sheet(left, width);
        let right = on_sheet(right, width);
        for row in on_sheet(top, height)..on_sheet(bottom, height) {
            if left < right {
                self.row_from(left, row)[..right - left].fill([red, green, blue, 255]);
            }
        }
    }

    /// Lays a colour over the pixels from (`left`, `top`) to before (`right`, `bottom`), as far as they are on the sheet; what is
    /// below shows through. Cheaper than [`Canvas::fill_through`].
    pub fn tint_pixels(&mut self, (left, top): (i32, i32), (right, bottom): (i32, i32), ink: Ink) {
        let width = self.width() as usize;
        let height = self.height() as usize;
        let (left, right) = (on_sheet(left, width), on_sheet(right, width).max(on_sheet(left, width)));
        // Weights are in 256 parts, so a shift takes the place of a division for every channel of every pixel.
        let weight = (256.0 * ink.opacity) as i32;
        for row in on_sheet(top, height)..on_sheet(bottom, height) {
            for pixel in &mut self.row_from(left, row)[..right - left] {
                for (under, &over) in pixel.iter_mut().zip(&ink.colour) {
                    let was = i32::from(*under);
                    *under = (was + (((i32::from(over) - was) * weight) >> 8)) as u8;
                }
            }
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

    pub fn fill_disc_with(&mut self, (x, y): Point, radius: f32, ink: Ink) {
        if let Some(disc) = PathBuilder::from_circle(x, y, radius) {
            self.fill_shape(&disc, Transform::identity(), ink);
        }
    }

    /// Fills a path of any shape, placed on the sheet by `placed`.
    pub fn fill_shape(&mut self, path: &Path, placed: Transform, ink: Ink) {
        self.pixels.fill_path(path, &ink.paint(), FillRule::Winding, placed, None);
    }

    /// Draws along a path, placed on the sheet by `placed`, with a round pen that is placed and scaled with it.
    pub fn stroke_shape(&mut self, path: &Path, placed: Transform, width: f32, ink: Ink) {
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixels.stroke_path(path, &ink.paint(), &stroke, placed, None);
    }

    /// Draws a line of straight pieces.
    pub fn trace(&mut self, points: &[Point], pen: &Pen) {
        self.trace_path(open(points).finish(), pen);
    }

    /// Draws a circle.
    pub fn ring(&mut self, (x, y): Point, radius: f32, pen: &Pen) {
        self.trace_path(PathBuilder::from_circle(x, y, radius), pen);
    }

    fn trace_path(&mut self, path: Option<Path>, pen: &Pen) {
        if let Some(path) = path {
            self.pixels.stroke_path(&path, &pen.ink.paint(), &pen.stroke(), Transform::identity(), None);
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
            // Pieces share a point, where their round ends hide the joint.
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

    /// All pixels row by row, as red, green, blue and opacity.
    pub fn pixels_mut(&mut self) -> &mut [[u8; 4]] {
        self.pixels.data_mut().as_chunks_mut().0
    }

    /// The pixels of a row from `left` on, as red, green, blue and opacity.
    pub fn row_from(&mut self, left: usize, row: usize) -> &mut [[u8; 4]] {
        let width = self.pixels.width() as usize;
        &mut self.pixels_mut()[row * width + left..(row + 1) * width]
    }

    /// Returns the sheet at half the size: the mean of each square of four pixels.
    pub fn halved(self) -> Self {
        // An odd last row or column is dropped, as it has no partner to be averaged with.
        let width = self.pixels.width() / 2;
        let height = self.pixels.height() / 2;
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

    /// Red, green, blue and opacity of every pixel, row by row.
    pub fn bytes(&self) -> &[u8] {
        self.pixels.data()
    }

    /// Copies another sheet to a place of this one, as far as it fits.
    pub fn copy_from(&mut self, other: &Self, (left, top): (u32, u32)) {
        self.copy_columns(other, other.width(), (left, top));
    }

    /// Copies a row of pixels of another sheet of the same size.
    pub fn copy_row(&mut self, other: &Self, row: usize) {
        let length = 4 * self.pixels.width() as usize;
        let bytes = row * length..(row + 1) * length;
        self.pixels.data_mut()[bytes.clone()].copy_from_slice(&other.pixels.data()[bytes]);
    }

    /// Copies the first `columns` pixels of each row of another sheet to a place of this one, as far as they fit.
    pub fn copy_columns(&mut self, other: &Self, columns: u32, (left, top): (u32, u32)) {
        let width = self.pixels.width();
        let height = self.pixels.height();
        let columns = columns.min(other.width()).min(width.saturating_sub(left)) as usize;
        let rows = other.pixels.height().min(height.saturating_sub(top)) as usize;
        let (source, _) = other.pixels.data().as_chunks::<4>();
        let stride = other.pixels.width() as usize;
        for row in 0..rows {
            self.row_from(left as usize, top as usize + row)[..columns]
                .copy_from_slice(&source[row * stride..][..columns]);
        }
    }

    /// Lays another sheet over this one, its upper left corner at a place that may be outside.
    pub fn lay_over(&mut self, other: &Self, (left, top): (i32, i32)) {
        let columns = within(left, other.width(), self.width());
        let rows = within(top, other.height(), self.height());
        if columns.is_empty() {
            return;
        }
        let (source, _) = other.pixels.data().as_chunks::<4>();
        let stride = other.width() as usize;
        for row in rows {
            let column = (columns.start as i64 - i64::from(left)) as usize;
            let from = (row as i64 - i64::from(top)) as usize * stride + column;
            for (under, &over) in self.row_from(columns.start, row).iter_mut().zip(&source[from..][..columns.len()]) {
                *under = laid_over(*under, over);
            }
        }
    }

    pub fn finish(self) -> Picture {
        let width = self.pixels.width();
        let height = self.pixels.height();
        Picture::from_rgba(width, height, self.pixels.take())
    }
}

/// Returns the pixels of a length that lie in a room.
fn within(at: i32, length: u32, room: u32) -> Range<usize> {
    // The sum takes 64 bits, as a corner far outside plus a length may not fit into 32.
    let first = i64::from(at);
    let last = i64::from(at) + i64::from(length);
    first.clamp(0, room.into()) as usize..last.clamp(0, room.into()) as usize
}

/// Returns the nearest place on a sheet with this many rows or columns, or behind its last one.
fn on_sheet(at: i32, max: usize) -> usize {
    (at.max(0) as usize).min(max)
}

/// A pixel over another one, both premultiplied by their opacity.
fn laid_over(under: [u8; 4], over: [u8; 4]) -> [u8; 4] {
    let through = 255 - u16::from(over[3]);
    std::array::from_fn(|channel| {
        let seen = (u16::from(under[channel]) * through + 127) / 255;
        (seen + u16::from(over[channel])).min(255) as u8
    })
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

/// A line of straight pieces.
pub fn open(points: &[Point]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (index, &(x, y)) in points.iter().enumerate() {
        if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path
}

/// A closed line of straight pieces; `None` without corners, or with one that is no place.
pub fn closed(corners: &[Point]) -> Option<Path> {
    let mut path = open(corners);
    path.close();
    path.finish()
}
