//! The panel: blocks one below the other in one column or more.

use super::super::layout::{Rectangle, edges};
use super::block::Block;
use super::pen::Pen;
use crate::picture::colours::{FAINT_INK, PAPER};

// In heights of text.
const LEAST_COLUMN: f32 = 26.0;
const MARGIN: f32 = 1.6;
/// Between two blocks, and from the line between them to the lower one.
const GAP: f32 = 1.6;
const BELOW_LINE: f32 = 0.35;

/// Draws as many of the blocks as there is room for, in their order.
pub fn draw(pen: &mut Pen, panel: Rectangle, blocks: Vec<Block>) {
    let [left, top, right, bottom] = edges(panel);
    pen.fill((left, top), (right - left, bottom - top), PAPER);
    pen.fill((left, top), if top > 0.0 { (right - left, 1.0) } else { (1.0, bottom - top) }, FAINT_INK);
    let columns = ((right - left) / pen.length(LEAST_COLUMN)).floor().max(1.0);
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

/// Blocks that fit, and of each its column and what is above it there, in heights of text.
fn fit(mut blocks: Vec<Block>, columns: usize, room: f32) -> (Vec<Block>, Vec<(usize, f32)>) {
    loop {
        if let Some(places) = places(&blocks, columns, room) {
            return (blocks, places);
        }
        // The last one of the highest rank.
        let dropped = (0..blocks.len()).max_by_key(|&index| blocks[index].rank).expect("no blocks always fit");
        blocks.remove(dropped);
    }
}

/// Column by column; `None` if they do not fit.
fn places(blocks: &[Block], columns: usize, room: f32) -> Option<Vec<(usize, f32)>> {
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

#[cfg(test)]
mod tests {
    use super::super::block::Line;
    use super::*;

    fn block(rank: u8, lines: usize) -> Block {
        Block::new(rank, vec![Line::new(Vec::new()); lines])
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
