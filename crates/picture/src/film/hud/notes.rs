//! Words over the panes: names of runs, messages, the line above the chart of a frame without a panel, and all keys.

use crate::canvas::Point;
use crate::colours::{INK, PAPER};
use crate::film::hud::formatting::{format_clock, format_hectares};
use crate::film::hud::pen::{TextFace, TextPen};
use crate::film::hud::{HudView, formatting};
use crate::film::lettering::fitted;
use crate::film::{BINDINGS, FrameLayout, Layer};
use crate::text::{Align, measure_weighted};
use wildfire_fire::BushStateKind;

// In heights of text.
const INSIDE: f32 = 0.7;
const OUTSIDE: f32 = 0.8;
const NOTE_HEIGHT: f32 = 2.2;

/// The run's name in the corner of each pane of a comparison.
pub fn draw_run_names(pen: &mut TextPen, layout: &FrameLayout, view: &HudView) {
    for (run_index, (pane, run)) in layout.fields.iter().zip(view.runs).enumerate() {
        let seed = run.timeline().setting.seed;
        let end = run.end_time();
        let mut name = format!("{}  {}, seed {seed}", formatting::run_name(run_index), run.title());
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
    let left = first.left as f32;
    let right = last.right() as f32;
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
    fitted(text, pen.height(TextFace::STRONG), TextFace::STRONG.weight, width - 2.0 * pen.length(INSIDE + OUTSIDE))
}

/// A line of text in a box.
fn draw_note(pen: &mut TextPen, text: &str, (left, top): Point, face: TextFace) {
    let inside = pen.length(INSIDE);
    let height = pen.length(NOTE_HEIGHT);
    let width = pen.measure(text, face) + 2.0 * inside;
    let ground = if face.colour == PAPER { INK } else { PAPER };
    pen.fill((left, top), (width, height), ground);
    pen.write(text, (left + inside, top + pen.length(0.5 * (NOTE_HEIGHT + face.size))), Align::Left, face);
}

const HEADLINE_CLOCK: TextFace = TextFace { size: 1.3, ..TextFace::TITLE };

/// The clock, and as many of the counts as there is room for, or what ground has burned; of a comparison both runs'.
pub fn draw_headline(pen: &mut TextPen, layout: &FrameLayout, view: &HudView) {
    let base = layout.chart.top as f32 + pen.length(2.1);
    let mut x = pen.length(1.0);
    pen.write(&format_clock(view.time), (x, base), Align::Left, HEADLINE_CLOCK);
    x += pen.measure(&format_clock(view.time), HEADLINE_CLOCK) + pen.length(1.5);
    if view.is_of_ground() {
        let burned = view.runs.iter().filter_map(|run| {
            let counts = run.index().ground()?.counts_at(view.time);
            Some(format_hectares(run.hectares(counts.cells - counts.intact())))
        });
        let burned = format!("{} burned", burned.collect::<Vec<_>>().join(" : "));
        pen.write(&burned, (x, base), Align::Left, TextFace::STRONG);
        return;
    }
    let sign = pen.length(1.5);
    let right = layout.width as f32 - pen.length(1.0);
    // Notes go in the order of what matters during a fire, as the row is cut off where the room ends.
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

// In heights of text.
const HELP_MARGIN: f32 = 2.0;
const HELP_LINE: f32 = 1.8;
const BETWEEN: f32 = 1.2;
/// Before and after the first line.
const HEADING: f32 = 3.2;

/// Keys and what they do, one below the other.
type KeyTable = Vec<(String, String)>;

pub fn draw_help(pen: &mut TextPen, layout: &FrameLayout, has_ground: bool) {
    let tables = [
        BINDINGS.iter().map(|binding| (binding.keys.to_owned(), binding.does.to_owned())).collect::<KeyTable>(),
        Layer::all_of(has_ground).map(|layer| (layer.key().to_string(), layer.name().to_owned())).collect::<KeyTable>(),
    ];
    let widths = tables.each_ref().map(widths);
    let width = widths.iter().map(|(keys, does)| keys + BETWEEN + does).sum::<f32>() + 3.0 * HELP_MARGIN;
    let height = HEADING + HELP_LINE * tables[0].len() as f32 + HELP_MARGIN;
    let sheet_width = layout.width as f32;
    let sheet_height = layout.height as f32;
    // The help shrinks with the frame, since none of its lines may be left out.
    let text = pen.text.min(0.98 * sheet_width / width).min(0.98 * sheet_height / height);
    let mut pen = TextPen { sheet: &mut *pen.sheet, lettering: &mut *pen.lettering, signs: &mut *pen.signs, text };
    let width = pen.length(width);
    let height = pen.length(height);
    let left = (0.5 * (sheet_width - width)).round();
    let top = (0.5 * (sheet_height - height)).round();
    pen.fill((left - 1.0, top - 1.0), (width + 2.0, height + 2.0), INK);
    pen.fill((left, top), (width, height), PAPER);
    let mut x = left + pen.length(HELP_MARGIN);
    for ((table, (keys, does)), heading) in tables.iter().zip(widths).zip(["Keys and mouse", "Layers"]) {
        pen.write(heading, (x, top + pen.length(2.4)), Align::Left, TextFace::TITLE);
        for (row, (key, what)) in table.iter().enumerate() {
            let base = top + pen.length(HEADING + HELP_LINE * (row + 1) as f32 - 0.4);
            pen.write(key, (x, base), Align::Left, TextFace::STRONG);
            pen.write(what, (x + pen.length(keys + BETWEEN), base), Align::Left, TextFace::PLAIN);
        }
        x += pen.length(keys + BETWEEN + does + HELP_MARGIN);
    }
}

/// Returns the widths of the two columns of a table, in heights of text.
fn widths(table: &KeyTable) -> (f32, f32) {
    let keys = &mut table.iter().map(|row| &row.0);
    let does = &mut table.iter().map(|row| &row.1);
    (widest(keys, TextFace::STRONG), widest(does, TextFace::PLAIN))
}

/// Returns the width of the widest of some texts.
fn widest(texts: &mut dyn Iterator<Item = &String>, face: TextFace) -> f32 {
    texts.map(|text| measure_weighted(text, face.size, face.weight)).fold(0.0, f32::max)
}
