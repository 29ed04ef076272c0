//! Words on the panes, and the line above the chart of a frame without a panel.

use crate::fire::BushStateKind;
use crate::picture::canvas::Point;
use crate::picture::colours::{INK, PAPER};
use crate::picture::film::FrameLayout;
use crate::picture::film::hud::pen::{TextFace, TextPen};
use crate::picture::film::hud::words::format_clock;
use crate::picture::film::hud::{HudView, words};
use crate::picture::film::lettering::fitted;
use crate::picture::text::Align;

// In heights of text.
const INSIDE: f32 = 0.7;
const OUTSIDE: f32 = 0.8;
const NOTE_HEIGHT: f32 = 2.2;

/// The run's name in the corner of each pane of a comparison.
pub fn draw_run_names(pen: &mut TextPen, layout: &FrameLayout, view: &HudView) {
    for (run_index, (pane, run)) in layout.fields.iter().zip(view.runs).enumerate() {
        let (seed, end) = (run.timeline().setting.seed, run.end_time());
        let mut name = format!("{}  {}, seed {seed}", words::run_name(run_index), run.title());
        if view.time >= end {
            name.push_str(&format!(", ended at {}", format_clock(end)));
        }
        let outside = pen.length(OUTSIDE);
        let name = shortened(pen, &name, pane.width as f32);
        draw_note(pen, &name, (pane.left as f32 + outside, pane.top as f32 + outside), TextFace::STRONG);
    }
}

/// Draws a message in the middle of the lower part of the panes, above the length bar.
pub fn draw_message(pen: &mut TextPen, layout: &FrameLayout, message: &str) {
    let (Some(first), Some(last)) = (layout.fields.first(), layout.fields.last()) else { return };
    let (left, right) = (first.left as f32, last.right() as f32);
    let message = shortened(pen, message, right - left);
    let width = pen.measure(&message, TextFace::STRONG) + 2.0 * pen.length(INSIDE);
    let top = first.bottom() as f32 - pen.length(2.0 * (OUTSIDE + NOTE_HEIGHT));
    draw_note(
        pen,
        &message,
        ((0.5 * (left + right - width)).round(), top),
        TextFace { colour: PAPER, ..TextFace::STRONG },
    );
}

fn shortened(pen: &TextPen, text: &str, width: f32) -> String {
    fitted(text, pen.height(TextFace::STRONG), width - 2.0 * pen.length(INSIDE + OUTSIDE))
}

/// A line of text in a box.
fn draw_note(pen: &mut TextPen, text: &str, (left, top): Point, face: TextFace) {
    let (inside, height) = (pen.length(INSIDE), pen.length(NOTE_HEIGHT));
    let width = pen.measure(text, face) + 2.0 * inside;
    let ground = if face.colour == PAPER { INK } else { PAPER };
    pen.fill((left, top), (width, height), ground);
    pen.write(text, (left + inside, top + pen.length(0.5 * (NOTE_HEIGHT + face.size))), Align::Left, face);
}

const HEADLINE_CLOCK: TextFace = TextFace { size: 1.3, ..TextFace::TITLE };

/// The clock, and as many of the counts as there is room for; of a comparison both runs'.
pub fn draw_headline(pen: &mut TextPen, layout: &FrameLayout, view: &HudView) {
    let base = layout.chart.top as f32 + pen.length(2.1);
    let mut x = pen.length(1.0);
    pen.write(&format_clock(view.time), (x, base), Align::Left, HEADLINE_CLOCK);
    x += pen.measure(&format_clock(view.time), HEADLINE_CLOCK) + pen.length(1.5);
    let (sign, right) = (pen.length(1.5), layout.width as f32 - pen.length(1.0));
    for kind in [BushStateKind::Burning, BushStateKind::BurnedOut, BushStateKind::Extinguished, BushStateKind::Intact] {
        let counts: Vec<String> = view.counts.iter().map(|counts| counts.count(kind).to_string()).collect();
        let counts = counts.join(" : ");
        let width = sign + pen.length(0.5) + pen.measure(&counts, TextFace::STRONG);
        if x + width > right {
            break;
        }
        pen.sign(kind, (x + 0.5 * sign, base - pen.length(0.5)), sign);
        pen.write(&counts, (x + sign + pen.length(0.5), base), Align::Left, TextFace::STRONG);
        x += width + pen.length(1.2);
    }
}
