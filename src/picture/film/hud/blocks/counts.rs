//! Bushes by fate, which is the legend too.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use super::super::words;
use super::{heading, values};
use crate::picture::film::{Fate, Tally};

/// Where a name begins behind its sign, and where a count ends in front of its share.
const NAME: f32 = 2.3;
const COUNT: f32 = 6.0;

pub fn block(moment: &Moment) -> Block {
    let counts = Fate::ALL.map(|fate| {
        let mut marks = vec![Mark::Sign(fate), Mark::Left { from: NAME, text: fate.name().into(), face: Face::PLAIN }];
        match moment.tallies.as_slice() {
            [tally] => marks.extend(count_and_share(tally, fate)),
            tallies => marks.extend(values(tallies.iter().map(|tally| tally.count(fate).to_string()), Face::STRONG)),
        }
        Line::of(marks)
    });
    let names = moment.is_comparison().then(|| heading(moment, Mark::left("bushes", Face::faint())));
    Block::new(1, names.into_iter().chain(counts).collect())
}

fn count_and_share(tally: &Tally, fate: Fate) -> [Mark; 2] {
    let (count, share) = (tally.count(fate), words::per_cent(tally.count(fate), tally.bushes()));
    [
        Mark::Right { to: COUNT, text: count.to_string(), face: Face::STRONG },
        Mark::Right { to: 0.0, text: share, face: Face::faint() },
    ]
}
