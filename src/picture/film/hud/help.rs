//! All keys, over everything else.

use crate::picture::colours::{INK, PAPER};
use crate::picture::film::hud::pen::{TextFace, TextPen};
use crate::picture::film::{BINDINGS, FrameLayout, Layer};
use crate::picture::text::{Align, measure_text};

// In heights of text.
const MARGIN: f32 = 2.0;
const LINE: f32 = 1.8;
const BETWEEN: f32 = 1.2;
/// Before and after the first line.
const HEADING: f32 = 3.2;

/// Keys and what they do, one below the other.
type KeyTable = Vec<(String, String)>;

pub fn draw_help(pen: &mut TextPen, layout: &FrameLayout) {
    let tables = [
        BINDINGS.iter().map(|binding| (binding.keys.to_owned(), binding.does.to_owned())).collect::<KeyTable>(),
        Layer::ALL.iter().map(|layer| (layer.key().to_string(), layer.name().to_owned())).collect::<KeyTable>(),
    ];
    let widths = tables.each_ref().map(widths);
    let width = widths.iter().map(|(keys, does)| keys + BETWEEN + does).sum::<f32>() + 3.0 * MARGIN;
    let height = HEADING + LINE * tables[0].len() as f32 + MARGIN;
    let (sheet_width, sheet_height) = (layout.width as f32, layout.height as f32);
    let text = pen.text.min(0.98 * sheet_width / width).min(0.98 * sheet_height / height);
    let mut pen = TextPen { sheet: &mut *pen.sheet, lettering: &mut *pen.lettering, signs: &mut *pen.signs, text };
    let (width, height) = (pen.length(width), pen.length(height));
    let (left, top) = ((0.5 * (sheet_width - width)).round(), (0.5 * (sheet_height - height)).round());
    pen.fill((left - 1.0, top - 1.0), (width + 2.0, height + 2.0), INK);
    pen.fill((left, top), (width, height), PAPER);
    let mut x = left + pen.length(MARGIN);
    for ((table, (keys, does)), heading) in tables.iter().zip(widths).zip(["Keys and mouse", "Layers"]) {
        pen.write(heading, (x, top + pen.length(2.4)), Align::Left, TextFace::TITLE);
        for (row, (key, what)) in table.iter().enumerate() {
            let base = top + pen.length(HEADING + LINE * (row + 1) as f32 - 0.4);
            pen.write(key, (x, base), Align::Left, TextFace::STRONG);
            pen.write(what, (x + pen.length(keys + BETWEEN), base), Align::Left, TextFace::PLAIN);
        }
        x += pen.length(keys + BETWEEN + does + MARGIN);
    }
}

/// Returns the widths of the two columns of a table, in heights of text.
fn widths(table: &KeyTable) -> (f32, f32) {
    let widest = |texts: &mut dyn Iterator<Item = &String>| {
        texts.map(|text| measure_text(text, TextFace::PLAIN.size)).fold(0.0, f32::max)
    };
    (widest(&mut table.iter().map(|row| &row.0)), widest(&mut table.iter().map(|row| &row.1)))
}
