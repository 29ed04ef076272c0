//! The panel: blocks of lines, one below the other in one column or more.

use crate::Rgb;
use crate::colours::{FAINT_INK, PAPER};
use crate::film::hud::legend::LegendSign;
use crate::film::hud::pen::{TextFace, TextPen};
use crate::film::layout::{PixelRect, edges};
use crate::film::lettering::fitted;
use crate::text::Align;
use wildfire_fire::BushStateKind;

// In heights of text.
const MIN_COLUMN: f32 = 26.0;
const MARGIN: f32 = 1.6;
/// Between two blocks, and from the line between them to the lower one.
const GAP: f32 = 1.6;
const BELOW_LINE: f32 = 0.35;

/// Draws as many of the blocks as there is room for, in their order.
pub fn draw_panel(pen: &mut TextPen, panel: PixelRect, blocks: Vec<PanelBlock>) {
    let [left, top, right, bottom] = edges(panel);
    pen.fill((left, top), (right - left, bottom - top), PAPER);
    pen.fill((left, top), if top > 0.0 { (right - left, 1.0) } else { (1.0, bottom - top) }, FAINT_INK);
    let columns = ((right - left) / pen.length(MIN_COLUMN)).floor().max(1.0);
    let width = (right - left) / columns;
    let room = (bottom - top) / pen.text - 2.0 * MARGIN;
    let (blocks, places) = fit(blocks, columns as usize, room);
    for (block, (column, above)) in blocks.iter().zip(places) {
        let column_left = left + width * column as f32;
        let edges = (column_left + pen.length(MARGIN), column_left + width - pen.length(MARGIN));
        let block_top = top + pen.length(MARGIN + above);
        if above > 0.0 {
            pen.fill((edges.0, block_top - pen.length(BELOW_LINE)), (edges.1 - edges.0, 1.0), FAINT_INK);
        }
        block.draw(pen, edges, block_top);
    }
}

/// Blocks that fit, and of each its column and what is above it there, in heights of text. Lines that a block can spare give way
/// before any block does.
fn fit(mut blocks: Vec<PanelBlock>, columns: usize, room: f32) -> (Vec<PanelBlock>, Vec<(usize, f32)>) {
    loop {
        if let Some(places) = places(&blocks, columns, room) {
            return (blocks, places);
        }
        // The last one of the highest rank: `max_by_key` takes the last of equals.
        let can_spare = |index: &usize| blocks[*index].lines.len() > blocks[*index].min;
        if let Some(longest) = (0..blocks.len()).filter(can_spare).max_by_key(|&index| blocks[index].rank) {
            blocks[longest].lines.pop();
            continue;
        }
        let dropped = (0..blocks.len()).max_by_key(|&index| blocks[index].rank).expect("no blocks always fit");
        blocks.remove(dropped);
    }
}

/// Column by column; `None` if they do not fit.
fn places(blocks: &[PanelBlock], columns: usize, room: f32) -> Option<Vec<(usize, f32)>> {
    let (mut column, mut used) = (0, 0.0);
    let mut places = Vec::new();
    for block in blocks {
        if used > 0.0 && used + block.height() > room {
            (column, used) = (column + 1, 0.0);
        }
        if column == columns || used + block.height() > room {
            return None;
        }
        places.push((column, used));
        used += block.height() + GAP;
    }
    Some(places)
}

/// Lines that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelBlock {
    /// The block's rank: where there is too little room, the highest are left out first.
    pub rank: u8,
    pub lines: Vec<PanelLine>,
    /// The lines that it keeps as long as it is there; those after them are left out before any block is.
    pub min: usize,
}

/// A line of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelLine {
    /// From the line above to this one, in heights of text.
    pub height: f32,
    pub marks: Vec<LineMark>,
}

/// The parts of a line; distances from the column's edges in heights of text.
#[derive(Clone, Debug, PartialEq)]
pub enum LineMark {
    /// Cut short where the next text begins.
    Left {
        from: f32,
        text: String,
        face: TextFace,
    },
    /// Ends there.
    Right {
        to: f32,
        text: String,
        face: TextFace,
    },
    /// At the left edge.
    Sign(BushStateKind),
    Legend {
        from: f32,
        sign: LegendSign,
    },
    /// Over the whole width, by shares that add up to 1.
    Bar(Vec<(f64, Rgb)>),
}

/// Between two texts of a line, in heights of text.
const APART: f32 = 0.6;
/// Side of a sign, in heights of text.
const SIGN: f32 = 1.5;

impl LineMark {
    pub fn left(text: impl Into<String>, face: TextFace) -> Self {
        Self::Left { from: 0.0, text: text.into(), face }
    }

    pub fn right(text: impl Into<String>, face: TextFace) -> Self {
        Self::Right { to: 0.0, text: text.into(), face }
    }
}

impl PanelLine {
    pub const HEIGHT: f32 = 1.75;

    pub fn new(marks: Vec<LineMark>) -> Self {
        Self { height: Self::HEIGHT, marks }
    }

    /// Makes a line of a name and its value.
    pub fn pair(name: &str, value: impl Into<String>) -> Self {
        Self::new(vec![LineMark::left(name, TextFace::faint()), LineMark::right(value, TextFace::PLAIN)])
    }

    /// Draws it on a base line between the edges of its column.
    fn draw(&self, pen: &mut TextPen, (left, right): (f32, f32), base: f32) {
        for mark in &self.marks {
            match mark {
                LineMark::Left { from, text, face } => {
                    let x = left + pen.length(*from);
                    let room = self.next_text(pen, (left, right), x) - x;
                    pen.write(&fitted(text, pen.height(*face), face.weight, room), (x, base), Align::Left, *face);
                }
                LineMark::Right { to, text, face } => {
                    pen.write(text, (right - pen.length(*to), base), Align::Right, *face);
                }
                LineMark::Sign(kind) => {
                    let side = pen.length(SIGN);
                    pen.sign(*kind, (left + 0.5 * side, base - pen.length(0.5)), side);
                }
                LineMark::Legend { from, sign } => sign.draw(pen, left + pen.length(*from), base),
                LineMark::Bar(shares) => draw_bar(pen, shares, (left, right), base),
            }
        }
    }

    /// Returns where text that begins at `x` must have ended.
    fn next_text(&self, pen: &TextPen, (left, right): (f32, f32), x: f32) -> f32 {
        let starts = self.marks.iter().filter_map(|mark| match mark {
            LineMark::Left { from, .. } => Some(left + pen.length(*from)),
            LineMark::Right { to, text, face } => Some(right - pen.length(*to) - pen.measure(text, *face)),
            LineMark::Sign(_) | LineMark::Legend { .. } | LineMark::Bar(_) => None,
        });
        starts.filter(|&start| start > x).map(|start| start - pen.length(APART)).fold(right, f32::min)
    }
}

fn draw_bar(pen: &mut TextPen, shares: &[(f64, Rgb)], (left, right): (f32, f32), base: f32) {
    let height = pen.length(0.5);
    let mut from = left;
    for &(share, colour) in shares {
        let to = (from + (right - left) * share as f32).min(right);
        pen.fill((from, base - height), (to.round() - from.round(), height), colour);
        from = to;
    }
}

impl PanelBlock {
    pub fn new(rank: u8, lines: Vec<PanelLine>) -> Self {
        Self { rank, min: lines.len(), lines }
    }

    pub fn with_min(self, min: usize) -> Self {
        Self { min, ..self }
    }

    /// In heights of text.
    pub fn height(&self) -> f32 {
        self.lines.iter().map(|line| line.height).sum()
    }

    /// Draws it between the edges of its column, from `top` down.
    pub fn draw(&self, pen: &mut TextPen, edges: (f32, f32), top: f32) {
        let mut base = top;
        for line in &self.lines {
            base += pen.text * line.height;
            line.draw(pen, edges, base.round());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(rank: u8, lines: usize) -> PanelBlock {
        PanelBlock::new(rank, vec![PanelLine::new(Vec::new()); lines])
    }

    #[test]
    fn blocks_of_high_rank_give_way() {
        let blocks = vec![block(0, 2), block(3, 4), block(1, 2), block(3, 4)];
        let ranks = |columns, room| fit(blocks.clone(), columns, room).0.iter().map(|b| b.rank).collect::<Vec<_>>();
        assert_eq!(ranks(1, 100.0), [0, 3, 1, 3]);
        assert_eq!(ranks(1, 20.0), [0, 3, 1]);
        assert_eq!(ranks(1, 10.0), [0, 1]);
        assert_eq!(ranks(1, 4.0), [0]);
        assert!(ranks(1, 1.0).is_empty());
        assert_eq!(ranks(2, 12.5), [0, 3, 1, 3]);
    }

    #[test]
    fn lines_that_can_be_spared_give_way_before_blocks() {
        let blocks = vec![block(0, 4).with_min(2), block(1, 2), block(9, 6).with_min(3)];
        let lines = |room| fit(blocks.clone(), 1, room).0.iter().map(|block| block.lines.len()).collect::<Vec<_>>();
        assert_eq!(lines(100.0), [4, 2, 6]);
        assert_eq!(lines(21.0), [4, 2, 4]);
        assert_eq!(lines(16.0), [2, 2, 3]);
        assert_eq!(lines(14.0), [2, 2]);
    }

    #[test]
    fn blocks_stay_within_their_columns() {
        for (columns, room) in [(1, 30.0), (2, 12.0), (3, 8.0), (1, 3.0)] {
            let (blocks, places) =
                fit((0..9).map(|rank| block(rank, 1 + usize::from(rank) % 3)).collect(), columns, room);
            for pair in places.windows(2).zip(&blocks) {
                let ([(column, above), (next_column, next_above)], block) = (pair.0, pair.1) else { unreachable!() };
                assert!(column != next_column || above + block.height() < *next_above);
            }
            for ((column, above), block) in places.iter().zip(&blocks) {
                assert!(*column < columns && above + block.height() <= room);
            }
        }
    }
}
