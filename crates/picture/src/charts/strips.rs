//! Distributions, one below the other: a histogram, and quantiles under it.

use crate::charts::drawing::Drawing;
use crate::charts::sheet::{
    AxisScale, DrawnSheet, LABEL, LINE, PanelGrid, Plot, SheetLayout, Swatch, draw_panel_name, fitted, numbered, rule,
    sheets, width_of,
};
use crate::charts::style::Style;
use crate::charts::{ChartRow, Titles};
use crate::colours::{INK, PAPER};
use crate::text::Align;

/// Heights in units: of a histogram with its quantiles, of its highest column.
const ROW: f32 = 74.0;
const ONE_ROW: f32 = 150.0;
/// The least height of a row, in a column of a paper.
const MIN_ROW: f32 = 44.0;
const QUANTILES: f32 = 16.0;
/// The room above the columns of a row, for a number.
const ABOVE: f32 = 16.0;
/// The most of a row that each of these two takes.
const MAX_OF_ROW: f32 = 0.27;
const MAX_COLUMNS: usize = 48;
const WIDEST_NAME: f32 = 210.0;
/// The height that a panel keeps free below, for numbers.
const BELOW: f32 = 34.0;
/// The most distributions on a sheet of several panels.
const ROWS: usize = 8;

/// Distributions over one axis, which is the same in all panels.
#[derive(Clone, Debug, PartialEq)]
pub struct StripChart {
    pub titles: Titles,
    pub panels: Vec<StripPanel>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct StripPanel {
    /// The panel's name; empty for a panel that fills a sheet of its own.
    pub name: String,
    pub strips: Vec<Strip>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    pub name: String,
    pub style: Style,
    /// Ascending.
    pub values: Vec<f64>,
    /// The quantiles at 5, 25, 50, 75 and 95 %; `None` without values.
    pub quantiles: Option<[f64; 5]>,
}

impl StripChart {
    /// Lists what it shows, the values of each distribution in ascending order.
    pub fn rows(&self) -> impl Iterator<Item = ChartRow<'_>> {
        let strips = self.panels.iter().flat_map(|panel| panel.strips.iter().map(|strip| (panel.name.as_str(), strip)));
        strips.flat_map(|(panel, strip)| {
            strip.values.iter().map(move |&value| ChartRow {
                panel,
                series: &strip.name,
                x: String::new(),
                value,
                interval: None,
            })
        })
    }

    /// Draws the panels on as many sheets of this width, in units, as they take.
    pub fn draw(&self, width: f32) -> Vec<Drawing> {
        let strips = || self.panels.iter().flat_map(|panel| &panel.strips);
        let has_names = strips().count() > 1;
        let widest = strips().map(|strip| width_of(&strip.name, LABEL)).fold(0.0, f32::max);
        // A single strip needs no name, as there is no other.
        let left = if has_names { widest.min(WIDEST_NAME) + 12.0 } else { 0.0 };
        let row = if has_names { ROW } else { ONE_ROW };
        let scale =
            AxisScale::around(strips().filter_map(|strip| Some((*strip.values.first()?, *strip.values.last()?))));
        // All have as many columns, so that heights mean the same in every panel.
        let columns = columns(
            self.panels
                .iter()
                .map(|panel| panel.strips.iter().map(|strip| strip.values.len()).sum())
                .max()
                .unwrap_or(0),
        );
        let max_rows = self.panels.iter().map(|panel| panel.strips.len()).max().unwrap_or(0).max(1);
        let sheets = sheets(&self.panels, |panel| &panel.name, (ROWS / max_rows).max(1));
        let sheet = |(index, panels): (usize, &&[StripPanel])| {
            let titles = numbered(&self.titles, index, sheets.len());
            let grid = PanelGrid { columns: 1, left, below: BELOW, above: LINE };
            let grid = grid.with_names(width, panels.iter().map(|panel| panel.name.as_str()));
            let rows = max_rows as f32;
            // Rows shrink down to a limit, below which a histogram has no shape any more.
            let row = row.min((grid.panel_height(width, row * rows) / rows).max(MIN_ROW));
            let heights: Vec<f32> = panels.iter().map(|panel| row * panel.strips.len() as f32).collect();
            let is_alone = panels[0].name.is_empty();
            let height = if is_alone { heights[0] } else { grid.height(&heights) };
            let layout =
                SheetLayout { titles: &titles, swatch: Swatch::Bar, key: Vec::new(), width, left, right: 0.0, height };
            let layout = if is_alone { layout.with_one_panel(MIN_ROW * rows) } else { layout };
            let DrawnSheet { mut drawing, plot } = layout.draw();
            let parts = if is_alone { vec![plot] } else { grid.parts(&plot, &heights) };
            for (panel, part) in panels.iter().zip(&parts) {
                draw_panel_name(&mut drawing, part, left, &panel.name);
                draw_panel(&mut drawing, part, (scale, columns), panel, has_names);
            }
            drawing
        };
        sheets.iter().enumerate().map(sheet).collect()
    }
}

fn draw_panel(
    drawing: &mut Drawing,
    plot: &Plot,
    (scale, columns): (AxisScale, usize),
    panel: &StripPanel,
    has_names: bool,
) {
    plot.draw_x_axis(drawing, scale);
    let row = (plot.bottom - plot.top) / panel.strips.len().max(1) as f32;
    for (index, strip) in panel.strips.iter().enumerate() {
        let top = plot.top + index as f32 * row;
        let part = Plot { top, bottom: top + row, ..*plot };
        if has_names {
            let name_at = (part.left - 10.0, part.bottom - QUANTILES.min(MAX_OF_ROW * row) - 6.0);
            drawing.text(&fitted(&strip.name, WIDEST_NAME, LABEL), name_at, Align::Right, LABEL, INK);
            rule(drawing, &part, part.bottom);
        }
        draw_strip(drawing, &part, scale, columns, strip);
    }
    plot.draw_base(drawing);
}

fn draw_strip(drawing: &mut Drawing, part: &Plot, scale: AxisScale, columns: usize, strip: &Strip) {
    let counts = counts(scale, columns, &strip.values);
    let highest_count = counts.iter().copied().max().unwrap_or(0).max(1);
    let max = MAX_OF_ROW * (part.bottom - part.top);
    let quantiles_height = QUANTILES.min(max);
    let above = ABOVE.min(max);
    let base = part.bottom - quantiles_height;
    let width = (part.right - part.left) / columns as f32;
    let height = base - part.top - above;
    for (index, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let left = part.left + index as f32 * width;
        // A single run among many is a line that can still be seen.
        let top = base - (count as f32 / highest_count as f32 * height).max(1.5);
        // Half a unit is left free at both sides: columns that touch would look like one area.
        drawing.rect((left + 0.5, top), (left + width - 0.5, base), strip.style.colour);
    }
    if let Some(highest) = counts.iter().position(|&count| count == highest_count) {
        let x = part.left + (highest as f32 + 0.5) * width;
        drawing.text(&highest_count.to_string(), (x, part.top + above - 0.25 * above), Align::Centre, LABEL, INK);
    }
    match strip.quantiles {
        Some(quantiles) => {
            draw_quantiles(drawing, base + quantiles_height / 2.0, quantiles.map(|value| part.x(scale, value)));
        }
        None => drawing.text("no values", (part.left + 8.0, base - 6.0), Align::Left, LABEL, INK),
    }
}

/// A line from 5 to 95 %, thick from 25 to 75 %, with a white stroke in a black frame at the median.
fn draw_quantiles(drawing: &mut Drawing, y: f32, [p5, p25, p50, p75, p95]: [f32; 5]) {
    drawing.line(vec![(p5, y), (p95, y)], 1.6, INK);
    drawing.rect((p25, y - 3.0), (p75, y + 3.0), INK);
    drawing.rect((p50 - 3.0, y - 5.5), (p50 + 3.0, y + 5.5), INK);
    drawing.rect((p50 - 1.5, y - 4.0), (p50 + 1.5, y + 4.0), PAPER);
}

/// Returns the number of columns: about twice the square root of the number of values.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
fn columns(values: usize) -> usize {
    ((2.0 * (values as f64).sqrt()) as usize).clamp(8, MAX_COLUMNS)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "columns are counted from 0 to 48")]
fn counts(scale: AxisScale, columns: usize, values: &[f64]) -> Vec<u64> {
    let mut counts = vec![0; columns];
    for value in values {
        let share = (value - scale.low) / (scale.high - scale.low);
        counts[((share * columns as f64) as usize).min(columns - 1)] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_counted_once() {
        let values: Vec<f64> = (0..1000).map(|index| f64::from(index * index)).collect();
        let scale = AxisScale { low: 0.0, high: 999.0 * 999.0 };
        let counts = counts(scale, 12, &values);
        assert_eq!(counts.iter().sum::<u64>(), 1000);
        assert!(counts[0] > counts[11], "{counts:?}");
        assert!(counts[11] > 0);
    }

    #[test]
    fn distributions_for_a_column_are_lower_than_on_a_screen() {
        let strip = |name: &str| Strip {
            name: name.into(),
            style: super::super::STYLES[0],
            values: vec![0.1, 0.2, 0.4],
            quantiles: Some([0.1, 0.1, 0.2, 0.4, 0.4]),
        };
        let strips = ["prm-rs", "hybrid-astar", "lattice"].map(strip).to_vec();
        let panels = vec![StripPanel { name: String::new(), strips }];
        let titles = Titles { title: "Extinguished at the end of a run".into(), ..Titles::default() };
        let chart = StripChart { titles, panels };
        assert!(chart.draw(355.6)[0].height <= 0.7 * 355.6);
        assert!(chart.draw(720.0)[0].height > 3.0 * ROW);
    }
}
