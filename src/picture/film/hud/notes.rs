//! Words on the panes: names of the runs of a comparison, and what the player has to say.

use super::super::lettering::fitted;
use super::moment::Moment;
use super::pen::{Face, Pen};
use super::words;
use crate::picture::canvas::Point;
use crate::picture::colours::{INK, PAPER};
use crate::picture::film::Layout;
use crate::picture::text::Align;

// In heights of text.
const INSIDE: f32 = 0.7;
const OUTSIDE: f32 = 0.8;
const HEIGHT: f32 = 2.2;

/// The run's name in the corner of each pane of a comparison.
pub fn name_runs(pen: &mut Pen, layout: &Layout, moment: &Moment) {
    for (run_index, (pane, run)) in layout.fields.iter().zip(moment.runs).enumerate() {
        let (seed, end) = (run.timeline().setting.seed, run.end_time());
        let mut name = format!("{}  {}, seed {seed}", words::run_name(run_index), run.title());
        if moment.time >= end {
            name.push_str(&format!(", ended at {}", words::clock(end)));
        }
        let outside = pen.length(OUTSIDE);
        let name = shortened(pen, &name, pane.width as f32);
        note(pen, &name, (pane.left as f32 + outside, pane.top as f32 + outside), Face::STRONG);
    }
}

/// In the middle of the lower part of the panes, above what measures them.
pub fn tell_message(pen: &mut Pen, layout: &Layout, message: &str) {
    let (Some(first), Some(last)) = (layout.fields.first(), layout.fields.last()) else { return };
    let (left, right) = (first.left as f32, last.right() as f32);
    let message = shortened(pen, message, right - left);
    let width = pen.measure(&message, Face::STRONG) + 2.0 * pen.length(INSIDE);
    let top = first.bottom() as f32 - pen.length(2.0 * (OUTSIDE + HEIGHT));
    note(pen, &message, ((0.5 * (left + right - width)).round(), top), Face { colour: PAPER, ..Face::STRONG });
}

fn shortened(pen: &Pen, text: &str, width: f32) -> String {
    fitted(text, pen.height(Face::STRONG), width - 2.0 * pen.length(INSIDE + OUTSIDE))
}

/// A line of text in a box.
fn note(pen: &mut Pen, text: &str, (left, top): Point, face: Face) {
    let (inside, height) = (pen.length(INSIDE), pen.length(HEIGHT));
    let width = pen.measure(text, face) + 2.0 * inside;
    let ground = if face.colour == PAPER { INK } else { PAPER };
    pen.fill((left, top), (width, height), ground);
    pen.write(text, (left + inside, top + pen.length(0.5 * (HEIGHT + face.size))), Align::Left, face);
}
