//! Bushes by state, which is the legend too.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use super::super::words;
use super::{heading, values};
use crate::fire::BushStateKind;
use crate::picture::film::BushCounts;

/// Where a name begins behind its sign, and where a count ends in front of its share.
const NAME: f32 = 2.3;
const COUNT: f32 = 6.0;

pub fn block(moment: &Moment) -> Block {
    let counts = BushStateKind::ALL.map(|kind| {
        let mut marks = vec![Mark::Sign(kind), Mark::Left { from: NAME, text: kind.name().into(), face: Face::PLAIN }];
        match moment.counts.as_slice() {
            [counts] => marks.extend(count_and_share(counts, kind)),
            counts => marks.extend(values(counts.iter().map(|counts| counts.count(kind).to_string()), Face::STRONG)),
        }
        Line::new(marks)
    });
    let names = moment.is_comparison().then(|| heading(moment, Mark::left("bushes", Face::faint())));
    Block::new(1, names.into_iter().chain(counts).collect())
}

fn count_and_share(counts: &BushCounts, kind: BushStateKind) -> [Mark; 2] {
    let (count, share) = (counts.count(kind), words::per_cent(counts.count(kind), counts.bushes()));
    [
        Mark::Right { to: COUNT, text: count.to_string(), face: Face::STRONG },
        Mark::Right { to: 0.0, text: share, face: Face::faint() },
    ]
}
