//! What the panel tells, block by block.

mod agents;
mod clock;
mod counts;
mod scores;
mod story;
mod switches;
mod title;

use super::block::{Block, Line, Mark};
use super::moment::Moment;
use super::pen::Face;
use super::words;

/// All blocks in the order in which they are shown.
pub fn blocks(moment: &Moment) -> Vec<Block> {
    let mut blocks = vec![title::block(moment), clock::block(moment), counts::block(moment), scores::block(moment)];
    blocks.extend(story::block(moment));
    blocks.extend(agents::blocks(moment));
    blocks.extend(switches::block(moment));
    blocks
}

/// Where the first of two values ends in front of the second, in heights of text.
const FIRST_VALUE: f32 = 7.6;

/// Values at the right of a line: one a run.
fn values(texts: impl IntoIterator<Item = String>, face: Face) -> Vec<Mark> {
    let texts: Vec<String> = texts.into_iter().collect();
    let count = texts.len();
    let mark = |(index, text)| Mark::Right { to: FIRST_VALUE * (count - 1 - index) as f32, text, face };
    texts.into_iter().enumerate().map(mark).collect()
}

/// Above the values of the runs of a comparison: what they are of, and the names of the runs.
fn heading(moment: &Moment, name: Mark) -> Line {
    let names = values((0..moment.runs.len()).map(|run_index| words::run_name(run_index).to_owned()), Face::STRONG);
    Line::new([name].into_iter().chain(names).collect())
}
