//! Points of both sides, and what planning cost.

use super::super::block::{Block, Line, Mark};
use super::super::moment::Moment;
use super::super::pen::Face;
use super::super::words;
use super::{heading, values};
use crate::picture::Rgb;
use crate::picture::colours::{FAINT_INK, UNIMOG, WUMPUS};

pub fn block(moment: &Moment) -> Block {
    let scores: Vec<[f64; 2]> = moment
        .runs
        .iter()
        .zip(&moment.counts)
        .map(|(run, counts)| {
            let rules = &run.timeline().setting.rules;
            [counts.wumpus_score(rules), counts.truck_score(rules)]
        })
        .collect();
    let side = |side: usize, name: &str, colour: Rgb| {
        let mut marks = vec![Mark::left(name, Face { colour, ..Face::STRONG })];
        marks.extend(values(scores.iter().map(|score| points(score[side])), Face::STRONG));
        Line::new(marks)
    };
    let mut lines = vec![side(0, "Wumpus", WUMPUS), side(1, "Unimog", UNIMOG)];
    if let &[score] = scores.as_slice() {
        lines.push(Line { height: 1.2, marks: vec![Mark::Bar(shares(score))] });
        lines.push(Line::new(vec![Mark::left(lead(score), Face::PLAIN)]));
    } else {
        lines.insert(0, heading(moment, Mark::left("points", Face::faint())));
        let mut marks = vec![Mark::left("leads", Face::faint())];
        marks.extend(values(scores.iter().map(|&score| leader(score).unwrap_or("-").to_owned()), Face::PLAIN));
        lines.push(Line::new(marks));
    }
    lines.extend(cpu(moment));
    Block::new(2, lines)
}

/// CPU time of all decisions so far, where it is known of a run.
fn cpu(moment: &Moment) -> Option<Line> {
    let known: Vec<_> = moment.runs.iter().map(|run| run.cpu_until(moment.time)).collect();
    known.iter().any(Option::is_some).then(|| {
        let mut marks = vec![Mark::left("CPU for plans", Face::faint())];
        marks.extend(values(known.iter().map(|cpu| cpu.map_or("-".to_owned(), words::cpu)), Face::PLAIN));
        Line::new(marks)
    })
}

/// Who has more points.
fn leader([wumpus, unimog]: [f64; 2]) -> Option<&'static str> {
    if wumpus > unimog { Some("Wumpus") } else { (unimog > wumpus).then_some("Unimog") }
}

fn lead(score: [f64; 2]) -> String {
    leader(score)
        .map_or("nobody leads".to_owned(), |name| format!("{name} leads by {}", points((score[0] - score[1]).abs())))
}

/// Points are whole numbers with ordinary rules.
fn points(score: f64) -> String {
    if score.fract() == 0.0 { format!("{score:.0}") } else { format!("{score:.1}") }
}

/// The part of each side in all points.
fn shares([wumpus, unimog]: [f64; 2]) -> Vec<(f64, Rgb)> {
    let (wumpus, unimog) = (wumpus.max(0.0), unimog.max(0.0));
    let all = wumpus + unimog;
    if all > 0.0 { vec![(wumpus / all, WUMPUS), (unimog / all, UNIMOG)] } else { vec![(1.0, FAINT_INK)] }
}
