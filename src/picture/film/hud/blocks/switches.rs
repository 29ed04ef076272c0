//! The layers with their keys, for who can press them.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use crate::picture::film::{Layer, ViewOptions};

/// Where the second layer of a line begins, and a name behind its key.
const SECOND: f32 = 11.8;
const NAME: f32 = 1.9;

pub fn block(moment: &Moment) -> Option<Block> {
    moment.options.status.as_ref()?;
    let (first, second) = Layer::ALL.split_at(Layer::ALL.len().div_ceil(2));
    let lines = (0..first.len()).map(|row| {
        let mut marks = switch(moment.options, first[row], 0.0).to_vec();
        marks.extend(second.get(row).into_iter().flat_map(|&layer| switch(moment.options, layer, SECOND)));
        Line::new(marks)
    });
    let note = lacks_searches(moment).then(|| Line::new(vec![Mark::left("no searches in the recording", Face::PLAIN)]));
    let help = Line::new(vec![Mark::left("?  all keys", Face::PLAIN)]);
    Some(Block::new(13, lines.chain(note).chain([help]).collect()))
}

/// Whether something shall be shown that no run has.
fn lacks_searches(moment: &Moment) -> bool {
    let shown = Layer::ALL.into_iter().filter(|&layer| moment.options.layers.contains(layer));
    shown.into_iter().any(Layer::needs_searches) && !moment.runs.iter().any(|run| run.has_searches())
}

fn switch(options: &ViewOptions, layer: Layer, from: f32) -> [Mark; 2] {
    let is_on = options.layers.contains(layer);
    let (key, name) = if is_on { (Face::STRONG, Face::STRONG) } else { (Face::PLAIN, Face::faint()) };
    [
        Mark::Left { from, text: layer.key().to_string(), face: key },
        Mark::Left { from: from + NAME, text: layer.name().into(), face: name },
    ]
}
