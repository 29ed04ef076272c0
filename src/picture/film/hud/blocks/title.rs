//! Title and seed; what was changed in the scenario has a line of its own.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use super::super::words;

pub fn block(moment: &Moment) -> Block {
    let lines = moment.runs.iter().enumerate().flat_map(|(run_index, run)| {
        let (name, changes) = run.title().split_once(", ").unwrap_or((run.title(), ""));
        let (name, face) = if moment.is_comparison() {
            (format!("{}  {name}", words::run_name(run_index)), Face::STRONG)
        } else {
            (name.to_owned(), Face::TITLE)
        };
        let seed = format!("seed {}", run.timeline().setting.seed);
        let title = Line::new(vec![Mark::left(name, face), Mark::right(seed, Face::PLAIN)]);
        let changes = (!changes.is_empty()).then(|| Line::new(vec![Mark::left(changes, Face::faint())]));
        [title].into_iter().chain(changes)
    });
    Block::new(3, lines.collect())
}
