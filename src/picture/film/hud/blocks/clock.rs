//! The time, and how fast it goes.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use super::super::words;

pub fn block(moment: &Moment) -> Block {
    let time = Line { height: 3.0, marks: vec![Mark::left(words::clock(moment.time), Face::CLOCK)] };
    let mut below = vec![Mark::left(format!("of {}", words::clock(moment.end)), Face::faint())];
    if let Some(status) = &moment.options.status {
        let pace = if status.is_paused { "paused".to_owned() } else { format!("{} x", status.speed) };
        below.push(Mark::right(pace, Face::STRONG));
    }
    let follows = moment.options.follows.map(|agent| Line::pair("follows", agent.to_string()));
    Block::new(0, [time, Line::new(below)].into_iter().chain(follows).collect())
}
