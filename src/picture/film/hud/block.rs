//! Blocks of lines, which the panel is made of.

use super::super::lettering::fitted;
use super::pen::{Face, Pen};
use crate::fire::BushStateKind;
use crate::picture::Rgb;
use crate::picture::text::Align;

/// Lines that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Where there is too little room, blocks of the highest rank are left out first.
    pub rank: u8,
    pub lines: Vec<Line>,
}

/// A line of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// From the line above to this one, in heights of text.
    pub height: f32,
    pub marks: Vec<Mark>,
}

/// What stands in a line; distances from the column's edges in heights of text.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Cut short where the next text begins.
    Left { from: f32, text: String, face: Face },
    /// Ends there.
    Right { to: f32, text: String, face: Face },
    /// At the left edge.
    Sign(BushStateKind),
    /// Over the whole width, by shares that add up to 1.
    Bar(Vec<(f64, Rgb)>),
}

/// Between two texts of a line, in heights of text.
const APART: f32 = 0.6;
/// Side of a sign, in heights of text.
const SIGN: f32 = 1.5;

impl Mark {
    pub fn left(text: impl Into<String>, face: Face) -> Self {
        Self::Left { from: 0.0, text: text.into(), face }
    }

    pub fn right(text: impl Into<String>, face: Face) -> Self {
        Self::Right { to: 0.0, text: text.into(), face }
    }
}

impl Line {
    pub const HEIGHT: f32 = 1.75;

    pub fn new(marks: Vec<Mark>) -> Self {
        Self { height: Self::HEIGHT, marks }
    }

    /// What is told, and its value.
    pub fn pair(name: &str, value: impl Into<String>) -> Self {
        Self::new(vec![Mark::left(name, Face::faint()), Mark::right(value, Face::PLAIN)])
    }

    /// Draws it on a base line between the edges of its column.
    fn draw(&self, pen: &mut Pen, (left, right): (f32, f32), base: f32) {
        for mark in &self.marks {
            match mark {
                Mark::Left { from, text, face } => {
                    let x = left + pen.length(*from);
                    let room = self.next_text(pen, (left, right), x) - x;
                    pen.write(&fitted(text, pen.height(*face), room), (x, base), Align::Left, *face);
                }
                Mark::Right { to, text, face } => pen.write(text, (right - pen.length(*to), base), Align::Right, *face),
                Mark::Sign(kind) => {
                    let side = pen.length(SIGN);
                    pen.sign(*kind, (left + 0.5 * side, base - pen.length(0.5)), side);
                }
                Mark::Bar(shares) => draw_bar(pen, shares, (left, right), base),
            }
        }
    }

    /// Where text that begins at `x` must have ended.
    fn next_text(&self, pen: &Pen, (left, right): (f32, f32), x: f32) -> f32 {
        let starts = self.marks.iter().filter_map(|mark| match mark {
            Mark::Left { from, .. } => Some(left + pen.length(*from)),
            Mark::Right { to, text, face } => Some(right - pen.length(*to) - pen.measure(text, *face)),
            Mark::Sign(_) | Mark::Bar(_) => None,
        });
        starts.filter(|&start| start > x).map(|start| start - pen.length(APART)).fold(right, f32::min)
    }
}

fn draw_bar(pen: &mut Pen, shares: &[(f64, Rgb)], (left, right): (f32, f32), base: f32) {
    let height = pen.length(0.5);
    let mut from = left;
    for &(share, colour) in shares {
        let to = (from + (right - left) * share as f32).min(right);
        pen.fill((from, base - height), (to.round() - from.round(), height), colour);
        from = to;
    }
}

impl Block {
    pub fn new(rank: u8, lines: Vec<Line>) -> Self {
        Self { rank, lines }
    }

    /// In heights of text.
    pub fn height(&self) -> f32 {
        self.lines.iter().map(|line| line.height).sum()
    }

    /// Draws it between the edges of its column, from `top` down.
    pub fn draw(&self, pen: &mut Pen, edges: (f32, f32), top: f32) {
        let mut base = top;
        for line in &self.lines {
            base += pen.text * line.height;
            line.draw(pen, edges, base.round());
        }
    }
}
