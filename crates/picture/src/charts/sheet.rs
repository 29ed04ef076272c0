//! The sheet of a chart: title, note, key, and the plot with its axes in the remaining space.

use crate::charts::Titles;
use crate::charts::drawing::Drawing;
use crate::charts::style::Style;
use crate::colours::{FAINT_INK, INK, NOTE_INK};
use crate::marks::to_f32;
use crate::text::{Align, measure_text};
use crate::ticks::{Tick, log_ticks, ticks};

/// Height of capitals in numbers and names, notes, titles.
pub const LABEL: f32 = 8.5;

/// The width of a sheet on a screen.
pub const SCREEN_WIDTH: f32 = 720.0;
/// The height of a line on a screen, and so that of a panel's name.
pub const LINE: f32 = 19.0;
/// The widest sheet for a column of a paper, with narrow margins and lines.
const COLUMN: f32 = 500.0;
/// The most height of such a sheet with one panel, and of one of several panels, as a share of its width; panels are no
/// lower than the least.
const HIGHEST: f32 = 0.7;
pub const LOWEST: f32 = 80.0;
const SWATCH: f32 = 26.0;
/// The width of common fonts, in which SVG is shown, divided by that of the project's own.
const FONTS: f32 = 1.12;

/// The lengths in which sheets on screens and for columns differ, in units.
#[derive(Clone, Copy, Debug)]
struct Measures {
    margin: f32,
    /// The height of a line of text, and of one of the title.
    line: f32,
    title_line: f32,
    /// Height of capitals in titles.
    title: f32,
}

impl Measures {
    fn of_width(width: f32) -> Self {
        if is_column(width) {
            Self { margin: 8.0, line: 15.0, title_line: 16.0, title: 10.0 }
        } else {
            Self { margin: 18.0, line: LINE, title_line: LINE, title: 12.0 }
        }
    }
}

/// Says whether a sheet of this width is for a column of a paper.
fn is_column(width: f32) -> bool {
    width <= COLUMN
}

/// The area in which values are drawn, in units from the upper left corner of the sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plot {
    pub left: f32,
    pub top: f32,
    pub right: f32,
    pub bottom: f32,
}

/// A sheet with everything around its plot.
pub struct DrawnSheet {
    pub drawing: Drawing,
    pub plot: Plot,
}

/// Panels of one sheet, row by row, as small multiples: each with its name above and its axis below.
#[derive(Clone, Copy, Debug)]
pub struct PanelGrid {
    pub columns: usize,
    /// Units to the left of every panel, as of the whole plot, and below every panel.
    pub left: f32,
    pub below: f32,
    /// Units above every panel, for its name.
    pub above: f32,
}

/// Units between the names of a panel and its neighbour to the left.
const GAP: f32 = 16.0;
/// Units between the left end of a panel's room and a name that begins there.
const NAME_INSET: f32 = 8.0;

impl PanelGrid {
    /// The same with room for these names of panels on a sheet of this width.
    pub fn with_names<'a>(self, width: f32, names: impl Iterator<Item = &'a str>) -> Self {
        let part = self.panel_width(width);
        let max = names.map(|name| name_lines(name, part, self.left).1.len()).max().unwrap_or(1);
        Self { above: LINE + (max - 1) as f32 * Measures::of_width(width).line, ..self }
    }

    /// The height of a panel on a sheet of this width: the usual one, or less in a column.
    pub fn panel_height(&self, width: f32, usual: f32) -> f32 {
        if is_column(width) { usual.min((HIGHEST * self.panel_width(width)).max(LOWEST)) } else { usual }
    }

    fn panel_width(&self, width: f32) -> f32 {
        let gaps = (self.columns - 1) as f32 * (GAP + self.left);
        (width - SheetLayout::margins(width) - self.left - gaps) / self.columns as f32
    }

    /// The height that panels of these heights take together; those in one row are as high as the highest of them.
    pub fn height(&self, heights: &[f32]) -> f32 {
        let rows = self.row_heights(heights);
        rows.iter().map(|height| self.above + height).sum::<f32>() + self.below * rows.len().saturating_sub(1) as f32
    }

    /// Returns the parts of the plot that the panels take.
    pub fn parts(&self, plot: &Plot, heights: &[f32]) -> Vec<Plot> {
        let gap = GAP + self.left;
        let width = (plot.right - plot.left - (self.columns - 1) as f32 * gap) / self.columns as f32;
        let mut top = plot.top;
        let mut parts = Vec::new();
        for (row, height) in heights.chunks(self.columns).zip(self.row_heights(heights)) {
            top += self.above;
            for column in 0..row.len() {
                let left = plot.left + column as f32 * (width + gap);
                parts.push(Plot { left, top, right: left + width, bottom: top + height });
            }
            top += height + self.below;
        }
        parts
    }

    fn row_heights(&self, heights: &[f32]) -> Vec<f32> {
        heights.chunks(self.columns).map(|row| row.iter().copied().fold(0.0, f32::max)).collect()
    }
}

/// Divides panels among sheets, `max` on each; a panel without a name has a sheet of its own.
pub fn sheets<'a, T>(panels: &'a [T], name: impl Fn(&T) -> &str + 'a, max: usize) -> Vec<&'a [T]> {
    let with_names = panels.chunk_by(move |one, next| !name(one).is_empty() && !name(next).is_empty());
    with_names.flat_map(|together| together.chunks(max)).collect()
}

/// The entries of a key for series of several panels, each once.
pub fn distinct<T: PartialEq>(series: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for entry in series {
        if !found.contains(&entry) {
            found.push(entry);
        }
    }
    found
}

/// The titles of one of several sheets.
pub fn numbered(titles: &Titles, index: usize, sheets: usize) -> Titles {
    let title = match sheets {
        0 | 1 => titles.title.clone(),
        _ => format!("{} ({} of {sheets})", titles.title, index + 1),
    };
    Titles { title, ..titles.clone() }
}

/// Draws the name of a panel above it, if it has one; `left` is the room to the left of the panel.
pub fn draw_panel_name(drawing: &mut Drawing, part: &Plot, left: f32, name: &str) {
    if name.is_empty() {
        return;
    }
    let (outside, lines) = name_lines(name, part.right - part.left, left);
    let line_height = Measures::of_width(drawing.width).line;
    for (above, line) in lines.iter().rev().enumerate() {
        let at = (part.left - outside, part.top - 6.0 - above as f32 * line_height);
        drawing.text(line, at, Align::Left, LABEL, INK);
    }
}

/// Breaks the name of a panel of this width: one line where it fits, else up to two that begin in the room to the left of
/// the panel. Returns how far outside of the panel they begin.
fn name_lines(name: &str, width: f32, left: f32) -> (f32, Vec<String>) {
    if width_of(name, LABEL) <= width {
        return (0.0, vec![name.to_owned()]);
    }
    let outside = (left - NAME_INSET).max(0.0);
    let mut found = lines(name, width + outside, LABEL);
    if found.len() > 2 {
        let rest = found.split_off(1).join(" ");
        found.push(fitted(&rest, width + outside, LABEL));
    }
    (outside, found)
}

/// The sign of a series in the key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swatch {
    Bar,
    Line,
    MarkedLine,
}

/// The parts of a sheet besides its plot.
pub struct SheetLayout<'a> {
    pub titles: &'a Titles,
    pub swatch: Swatch,
    pub key: Vec<(Style, &'a str)>,
    /// The width of the sheet in units.
    pub width: f32,
    /// Units to the left and to the right of the plot, and its height.
    pub left: f32,
    pub right: f32,
    pub height: f32,
}

impl SheetLayout<'_> {
    /// Units to the left and to the right of every plot on a sheet of this width.
    pub fn margins(width: f32) -> f32 {
        2.0 * Measures::of_width(width).margin
    }

    /// The same with a plot that is low enough for a column, if the sheet is for one: a single panel, no lower than `min`.
    #[must_use]
    pub fn with_one_panel(self, min: f32) -> Self {
        if !is_column(self.width) {
            return self;
        }
        // How much room the texts take is only known once they are broken into lines.
        let besides = self.draw().drawing.height - self.height;
        let height = self.height.min((HIGHEST * self.width - besides).max(min.min(self.height)));
        Self { height, ..self }
    }

    /// Draws everything around the plot.
    pub fn draw(&self) -> DrawnSheet {
        let rows = self.key_rows();
        let Measures { margin, line: line_height, title_line, title: title_size } = Measures::of_width(self.width);
        // Texts are broken first, as everything below moves down with their number of lines.
        let room = self.width - 2.0 * margin;
        let title = lines(&self.titles.title, room, title_size);
        let note = lines(&self.titles.note, room, LABEL);
        let x = lines(&self.titles.x, room, LABEL);
        let note_top = margin + title_size + title.len() as f32 * title_line;
        let key_top = note_top + note.len() as f32 * line_height;
        let top = key_top + rows.len() as f32 * line_height + if self.titles.y.is_empty() { 0.0 } else { line_height };
        let plot =
            Plot { left: margin + self.left, top, right: self.width - margin - self.right, bottom: top + self.height };
        let below = LINE + 6.0 + if self.titles.x.is_empty() { 0.0 } else { x.len() as f32 * line_height };
        let mut drawing = Drawing::new(self.width, plot.bottom + below + margin, &self.titles.title);
        let is_text = |(_, line): &(usize, &String)| !line.is_empty();
        for (index, line) in title.iter().enumerate().filter(is_text) {
            let base = margin + title_size + index as f32 * title_line;
            drawing.text(line, (margin, base), Align::Left, title_size, INK);
        }
        for (index, line) in note.iter().enumerate().filter(is_text) {
            drawing.text(line, (margin, note_top + index as f32 * line_height), Align::Left, LABEL, NOTE_INK);
        }
        for (index, row) in rows.iter().enumerate() {
            self.draw_key_row(&mut drawing, row, key_top + index as f32 * line_height);
        }
        drawing.text(&self.titles.y, (margin, top - 10.0), Align::Left, LABEL, INK);
        // One line is in the middle of the axis; more are a text, which takes the whole sheet.
        let (left, align) = match x.len() {
            1 => (0.5 * (plot.left + plot.right), Align::Centre),
            _ => (margin, Align::Left),
        };
        for (index, line) in x.iter().enumerate().filter(is_text) {
            let base = plot.bottom + LINE + 8.0 + LABEL + index as f32 * line_height;
            drawing.text(line, (left, base), align, LABEL, INK);
        }
        DrawnSheet { drawing, plot }
    }

    /// Entries of the key, as many in a row as it holds; none where there is a single series.
    fn key_rows(&self) -> Vec<Vec<&(Style, &str)>> {
        let mut rows: Vec<Vec<&(Style, &str)>> = Vec::new();
        // It is infinite, so the first entry begins a row.
        let mut used = f32::INFINITY;
        for entry in self.key.iter().filter(|_| self.key.len() > 1) {
            let width = self.entry_width(entry.1);
            if used + width > self.width - Self::margins(self.width) {
                rows.push(Vec::new());
                used = 0.0;
            }
            used += width;
            rows.last_mut().expect("there is a row by now").push(entry);
        }
        rows
    }

    fn draw_key_row(&self, drawing: &mut Drawing, row: &[&(Style, &str)], base: f32) {
        let mut x = 0.5 * Self::margins(self.width);
        for (style, name) in row {
            let middle = base - LABEL / 2.0;
            match self.swatch {
                Swatch::Bar => style.fill_rect(drawing, (x, middle - 6.0), (x + SWATCH - 6.0, middle + 6.0)),
                Swatch::Line | Swatch::MarkedLine => style.line(drawing, vec![(x, middle), (x + SWATCH, middle)]),
            }
            if self.swatch == Swatch::MarkedLine {
                style.mark(drawing, (x + SWATCH / 2.0, middle), 4.0);
            }
            drawing.text(&self.key_name(name), (x + SWATCH + 6.0, base), Align::Left, LABEL, INK);
            x += self.entry_width(name);
        }
    }

    fn key_name(&self, name: &str) -> String {
        fitted(name, self.width - Self::margins(self.width) - SWATCH - 6.0, LABEL)
    }

    fn entry_width(&self, name: &str) -> f32 {
        SWATCH + 6.0 + width_of(&self.key_name(name), LABEL) + 16.0
    }
}

/// Returns the greatest width of a text, whatever the font.
pub fn width_of(text: &str, height: f32) -> f32 {
    FONTS * measure_text(text, height)
}

/// The text in lines that are no wider than `width`, one at least; words that are wider are cut.
pub fn lines(text: &str, width: f32, height: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if width_of(&format!("{line} {word}"), height) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| fitted(line, width, height)).collect()
}

/// The text, cut where it is wider than `width`.
pub fn fitted(text: &str, width: f32, height: f32) -> String {
    if width_of(text, height) <= width {
        return text.to_owned();
    }
    let mut short = String::new();
    for letter in text.chars() {
        short.push(letter);
        if width_of(&format!("{short}..."), height) > width {
            short.pop();
            break;
        }
    }
    format!("{}...", short.trim_end())
}

/// A line across the plot that separates.
pub fn rule(drawing: &mut Drawing, plot: &Plot, y: f32) {
    drawing.line(vec![(plot.left, y), (plot.right, y)], 1.0, FAINT_INK);
}

/// The room that a tick keeps for itself along x and y, in units.
const TICK_ROOM: [f32; 2] = [64.0, 40.0];

/// The least distance between two numbers of an axis, in units.
const TICK_GAP: f32 = 6.0;

/// Values along a side of a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisScale {
    pub low: f64,
    pub high: f64,
}

impl AxisScale {
    /// All of the values with a little room; those of values that cannot be negative begin at zero.
    pub fn around(ranges: impl Iterator<Item = (f64, f64)>) -> Self {
        let finite = ranges.filter(|(low, high)| low.is_finite() && high.is_finite());
        let (low, high) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), (low, high)| (min.min(low), max.max(high)));
        // Nothing is finite, but an axis is drawn all the same.
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let room = 0.04 * (high - low);
        match () {
            () if low == high && low == 0.0 => Self { low: 0.0, high: 1.0 },
            () if low == high => Self { low: low - 0.1 * low.abs(), high: high + 0.1 * high.abs() },
            () if low >= 0.0 && low - room < 0.0 => Self { low: 0.0, high: high + room },
            () => Self { low: low - room, high: high + room },
        }
    }

    /// The same with zero, where that leaves the values half of the room.
    pub fn with_near_zero(self) -> Self {
        if self.low > 0.5 * self.high { self } else { self.with_zero() }
    }

    /// The same with zero, for what is shown as a length.
    pub fn with_zero(self) -> Self {
        Self { low: self.low.min(0.0), high: self.high.max(0.0) }
    }

    fn share(self, value: f64) -> f32 {
        to_f32(((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0))
    }
}

impl Plot {
    pub fn x(&self, scale: AxisScale, value: f64) -> f32 {
        self.left + scale.share(value) * (self.right - self.left)
    }

    pub fn y(&self, scale: AxisScale, value: f64) -> f32 {
        self.bottom - scale.share(value) * (self.bottom - self.top)
    }

    /// Numbers to the left, and a line across at each.
    pub fn draw_y_axis(&self, drawing: &mut Drawing, scale: AxisScale) {
        for tick in ticks(scale.low, scale.high, max_ticks(self.bottom - self.top, TICK_ROOM[1]), 0.0) {
            let y = self.y(scale, tick.value);
            drawing.line(vec![(self.left, y), (self.right, y)], 1.0, FAINT_INK);
            drawing.text(&tick.label, (self.left - 7.0, y + LABEL / 2.0), Align::Right, LABEL, INK);
        }
    }

    /// Numbers below, and a line upwards at each.
    pub fn draw_x_axis(&self, drawing: &mut Drawing, scale: AxisScale) {
        for tick in ticks(scale.low, scale.high, max_ticks(self.right - self.left, TICK_ROOM[0]), 0.0) {
            self.draw_x_tick(drawing, scale, &tick);
        }
    }

    /// Lines upwards at given ticks, in ascending order, and their numbers below, those of the ends first: a number that
    /// would touch another is left out.
    pub fn draw_x_ticks(&self, drawing: &mut Drawing, scale: AxisScale, ticks: &[Tick]) {
        let mut taken: Vec<(f32, f32)> = Vec::new();
        let last = ticks.len().saturating_sub(1);
        let between = 1..last.max(1);
        for index in [0, last].into_iter().take(ticks.len()).chain(between) {
            let Tick { value, label } = &ticks[index];
            let x = self.x(scale, *value);
            let reach = 0.5 * (width_of(label, LABEL) + TICK_GAP);
            let is_free = taken.iter().all(|&(left, right)| x + reach <= left || right <= x - reach);
            let label = if is_free { label.clone() } else { String::new() };
            self.draw_x_tick(drawing, scale, &Tick { value: *value, label });
            taken.extend(is_free.then_some((x - reach, x + reach)));
        }
    }

    fn draw_x_tick(&self, drawing: &mut Drawing, scale: AxisScale, tick: &Tick) {
        let x = self.x(scale, tick.value);
        drawing.line(vec![(x, self.top), (x, self.bottom)], 1.0, FAINT_INK);
        if !tick.label.is_empty() {
            drawing.text(&tick.label, (x, self.bottom + 9.0 + LABEL), Align::Centre, LABEL, INK);
        }
    }

    /// The same where the scale is of decimal logarithms.
    pub fn draw_log_x_axis(&self, drawing: &mut Drawing, scale: AxisScale) {
        for tick in log_ticks(scale.low, scale.high, max_ticks(self.right - self.left, TICK_ROOM[0])) {
            let x = self.x(scale, tick.value);
            drawing.line(vec![(x, self.top), (x, self.bottom)], 1.0, FAINT_INK);
            drawing.text(&tick.label, (x, self.bottom + 9.0 + LABEL), Align::Centre, LABEL, INK);
        }
    }

    pub fn draw_base(&self, drawing: &mut Drawing) {
        drawing.line(vec![(self.left, self.bottom), (self.right, self.bottom)], 1.2, INK);
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sheet has room for some dozen ticks")]
fn max_ticks(length: f32, each: f32) -> usize {
    (length / each).max(2.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_of_a_sheet_do_not_overlap_and_stay_in_the_plot() {
        let grid = PanelGrid { columns: 2, left: 48.0, below: 26.0, above: LINE };
        let heights = [100.0, 60.0, 80.0, 90.0, 100.0];
        let plot = Plot { left: 66.0, top: 50.0, right: 702.0, bottom: 50.0 + grid.height(&heights) };
        let parts = grid.parts(&plot, &heights);
        assert_eq!(parts.len(), heights.len());
        for (index, part) in parts.iter().enumerate() {
            assert!(part.left >= plot.left && part.right <= plot.right + 0.01 && part.bottom <= plot.bottom + 0.01);
            assert!(part.bottom - part.top >= heights[index] && part.top >= plot.top + LINE);
            for other in &parts[..index] {
                let is_beside = part.left >= other.right + grid.left || other.left >= part.right + grid.left;
                assert!(is_beside || part.top >= other.bottom + grid.below, "{part:?} {other:?}");
            }
        }
    }

    #[test]
    fn every_panel_is_on_one_sheet() {
        let panels = ["a", "b", "c", "", "", "d"];
        let sheets = sheets(&panels, |name| name, 2);
        assert_eq!(sheets, [&["a", "b"][..], &["c"], &[""], &[""], &["d"]]);
        let titles = Titles { title: "T".into(), ..Titles::default() };
        assert_eq!([numbered(&titles, 0, 1).title, numbered(&titles, 1, 3).title], ["T", "T (2 of 3)"]);
    }

    #[test]
    fn numbers_of_custom_ticks_do_not_touch_and_those_of_the_ends_are_there() {
        let plot = Plot { left: 0.0, top: 0.0, right: 100.0, bottom: 50.0 };
        let values: [f64; 6] = [1.0, 2.0, 3.0, 50.0, 99.0, 100.0];
        let ticks = values.map(|value| Tick { value, label: value.to_string() });
        let scale = AxisScale { low: 0.0, high: 100.0 };
        for (ticks, expected) in [(&ticks[..], vec!["1", "100", "50"]), (&ticks[..1], vec!["1"]), (&[], vec![])] {
            let mut drawing = Drawing::new(100.0, 80.0, "");
            plot.draw_x_ticks(&mut drawing, scale, ticks);
            assert_eq!(drawing.texts().collect::<Vec<_>>(), expected);
            assert_eq!(drawing.marks.len(), ticks.len() + expected.len(), "a line for each");
        }
    }

    #[test]
    fn long_names_are_cut_to_their_room() {
        assert_eq!(lines("one two", 200.0, LABEL), ["one two"]);
        assert_eq!(lines("", 200.0, LABEL), [""]);
        let several = lines(&"some words ".repeat(20), 200.0, LABEL);
        assert!(several.len() > 3 && several.iter().all(|line| width_of(line, LABEL) <= 200.0), "{several:?}");
        assert_eq!(several.join(" ").trim_end(), "some words ".repeat(20).trim_end());
        assert_eq!(fitted("short", 200.0, LABEL), "short");
        let cut = fitted(&"long ".repeat(100), 200.0, LABEL);
        assert!(cut.ends_with("...") && width_of(&cut, LABEL) <= 200.0, "{cut}");
    }

    #[test]
    fn scale_holds_its_values_and_starts_at_zero_where_they_are_near() {
        assert_eq!(AxisScale::around([(0.0, 10.0), (2.0, 5.0)].into_iter()), AxisScale { low: 0.0, high: 10.4 });
        assert_eq!(AxisScale::around([(-10.0, 10.0)].into_iter()), AxisScale { low: -10.8, high: 10.8 });
        assert_eq!(AxisScale::around([(f64::NAN, 1.0)].into_iter()), AxisScale { low: 0.0, high: 1.0 });
        let one = AxisScale::around([(3.0, 3.0)].into_iter());
        assert!(one.low < 3.0 && one.high > 3.0);
    }
}
