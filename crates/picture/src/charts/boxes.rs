//! Box plots, one below the other.
//!
//! A box reaches from the lower to the upper quartile, with a white stroke at the median. Lines go on to the farthest
//! values within one and a half times the box's length of it; values beyond are points (Tukey, "Exploratory Data
//! Analysis", 1977, section 2D).

use std::f64::consts::LN_10;

use crate::charts::drawing::Drawing;
use crate::charts::sheet::{
    AxisScale, DrawnSheet, LABEL, LINE, PanelGrid, Plot, SheetLayout, Swatch, draw_panel_name, fitted, numbered,
    sheets, width_of,
};
use crate::charts::style::Style;
use crate::charts::{ChartRow, Titles};
use crate::colours::{INK, PAPER};
use crate::text::Align;
use wildfire_base::geometry::ops;

/// Heights in units: of a row, and of the box in it.
const ROW: f32 = 30.0;
const BOX: f32 = 15.0;
const WIDEST_NAME: f32 = 210.0;
/// The height that a panel keeps free below, for numbers.
const BELOW: f32 = 34.0;
/// The most boxes on a sheet of several panels.
const ROWS: usize = 24;
/// The reach of the lines, in lengths of the box.
const FENCE: f64 = 1.5;
/// Points nearer to each other than this are one.
const POINT: f32 = 0.5;

/// Boxes over one axis, which is the same in all panels.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxChart {
    pub titles: Titles,
    /// Shows powers of ten equally far apart. Numbers that are not above zero have no place there, and are shown at that of
    /// the smallest that is.
    pub is_logarithmic: bool,
    pub panels: Vec<BoxPanel>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct BoxPanel {
    /// The panel's name; empty for a panel that fills a sheet of its own.
    pub name: String,
    pub boxes: Vec<BoxSeries>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct BoxSeries {
    pub name: String,
    pub style: Style,
    /// Ascending.
    pub values: Vec<f64>,
    /// Lower quartile, median and upper quartile; `None` without values.
    pub quartiles: Option<[f64; 3]>,
}

impl BoxChart {
    /// Lists what it shows, the values of each box in ascending order.
    pub fn rows(&self) -> impl Iterator<Item = ChartRow<'_>> {
        let boxes = self.panels.iter().flat_map(|panel| panel.boxes.iter().map(|series| (panel.name.as_str(), series)));
        boxes.flat_map(|(panel, series)| {
            series.values.iter().map(move |&value| ChartRow {
                panel,
                series: &series.name,
                x: String::new(),
                value,
                interval: None,
            })
        })
    }

    /// Draws the panels on as many sheets of this width, in units, as they take.
    pub fn draw(&self, width: f32) -> Vec<Drawing> {
        let boxes = || self.panels.iter().flat_map(|panel| &panel.boxes);
        let widest = boxes().map(|series| width_of(&series.name, LABEL)).fold(0.0, f32::max);
        let left = widest.min(WIDEST_NAME) + 12.0;
        let places = self.places();
        // The values are sorted, so the first and the last are the ends.
        let ends = boxes().flat_map(|series| series.values.first().into_iter().chain(series.values.last()));
        let scale = AxisScale::around(ends.map(|&end| (places.of(end), places.of(end))));
        let max_rows = self.panels.iter().map(|panel| panel.boxes.len()).max().unwrap_or(0).max(1);
        // A panel is never divided over two sheets, so its boxes stay comparable.
        let sheets = sheets(&self.panels, |panel| &panel.name, (ROWS / max_rows).max(1));
        let sheet = |(index, panels): (usize, &&[BoxPanel])| {
            let titles = numbered(&self.titles, index, sheets.len());
            let grid = PanelGrid { columns: 1, left, below: BELOW, above: LINE };
            let grid = grid.with_names(width, panels.iter().map(|panel| panel.name.as_str()));
            let heights: Vec<f32> = panels.iter().map(|panel| ROW * panel.boxes.len().max(1) as f32).collect();
            let is_alone = panels[0].name.is_empty();
            let height = if is_alone { heights[0] } else { grid.height(&heights) };
            let key = Vec::new();
            let layout = SheetLayout { titles: &titles, swatch: Swatch::Bar, key, width, left, right: 0.0, height };
            let DrawnSheet { mut drawing, plot } = layout.draw();
            let parts = if is_alone { vec![plot] } else { grid.parts(&plot, &heights) };
            for (panel, part) in panels.iter().zip(&parts) {
                draw_panel_name(&mut drawing, part, left, &panel.name);
                draw_panel(&mut drawing, &Axis { plot: *part, scale, places }, panel);
            }
            drawing
        };
        sheets.iter().enumerate().map(sheet).collect()
    }

    fn places(&self) -> ScalePlaces {
        let values = self.panels.iter().flat_map(|panel| &panel.boxes).flat_map(|series| &series.values);
        let min = values.copied().filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min);
        if self.is_logarithmic { ScalePlaces::Logarithmic { min: min.min(f64::MAX) } } else { ScalePlaces::Linear }
    }
}

/// Where values are on a scale.
#[derive(Clone, Copy, Debug)]
enum ScalePlaces {
    Linear,
    /// By decimal logarithms; those of smaller values are that of the least.
    Logarithmic {
        min: f64,
    },
}

impl ScalePlaces {
    fn of(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic { min } => ops::ln(value.max(min)) / LN_10,
        }
    }
}

/// The axis of a panel.
struct Axis {
    plot: Plot,
    scale: AxisScale,
    places: ScalePlaces,
}

impl Axis {
    fn x(&self, value: f64) -> f32 {
        self.plot.x(self.scale, self.places.of(value))
    }
}

fn draw_panel(drawing: &mut Drawing, axis: &Axis, panel: &BoxPanel) {
    let plot = &axis.plot;
    match axis.places {
        ScalePlaces::Linear => plot.draw_x_axis(drawing, axis.scale),
        ScalePlaces::Logarithmic { .. } => plot.draw_log_x_axis(drawing, axis.scale),
    }
    for (index, series) in panel.boxes.iter().enumerate() {
        let middle = plot.top + (index as f32 + 0.5) * ROW;
        let name_at = (plot.left - 10.0, middle + 0.5 * LABEL);
        drawing.text(&fitted(&series.name, WIDEST_NAME, LABEL), name_at, Align::Right, LABEL, INK);
        match series.quartiles {
            Some(quartiles) => draw_box(drawing, axis, middle, series, quartiles),
            None => drawing.text("no drive", (plot.left + 8.0, name_at.1), Align::Left, LABEL, INK),
        }
    }
    plot.draw_base(drawing);
}

fn draw_box(drawing: &mut Drawing, axis: &Axis, middle: f32, series: &BoxSeries, [lower, median, upper]: [f64; 3]) {
    let (low, high) = whiskers(&series.values, lower, upper);
    let half = 0.5 * BOX;
    for (from, to) in [(low, lower), (upper, high)] {
        drawing.line(vec![(axis.x(from), middle), (axis.x(to), middle)], 1.4, INK);
    }
    for end in [low, high] {
        drawing.line(vec![(axis.x(end), middle - 4.0), (axis.x(end), middle + 4.0)], 1.4, INK);
    }
    // A box of no width can still be seen.
    let left = axis.x(lower);
    let right = axis.x(upper).max(axis.x(lower) + 2.0);
    series.style.fill_rect(drawing, (left, middle - half), (right, middle + half));
    let at = axis.x(median);
    // White beneath the line, which a dark box would hide.
    for (width, colour) in [(4.0, PAPER), (1.8, INK)] {
        drawing.line(vec![(at, middle - half - 2.0), (at, middle + half + 2.0)], width, colour);
    }
    // Thousands of outliers at one place would be as many marks in the file, and look like one.
    let mut last = f32::NEG_INFINITY;
    for &value in series.values.iter().filter(|value| **value < low || **value > high) {
        let at = axis.x(value);
        if at - last >= POINT {
            series.style.mark(drawing, (at, middle), 1.8);
            last = at;
        }
    }
}

/// Returns the farthest of ascending values that lie within the fences of a box; its own ends if none does.
fn whiskers(values: &[f64], lower: f64, upper: f64) -> (f64, f64) {
    let reach = FENCE * (upper - lower);
    let low = values.iter().copied().find(|value| *value >= lower - reach).unwrap_or(lower);
    let high = values.iter().rev().copied().find(|value| *value <= upper + reach).unwrap_or(upper);
    (low.min(lower), high.max(upper))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::drawing::DrawingMark;
    use crate::charts::{SCREEN_WIDTH, STYLES};

    #[test]
    fn lines_end_at_the_farthest_values_within_the_fences() {
        let values = [-10.0, 0.0, 1.0, 2.0, 3.0, 4.0, 6.9, 7.1, 30.0];
        assert_eq!(whiskers(&values, 1.0, 3.4), (0.0, 6.9));
        assert_eq!(whiskers(&[5.0], 5.0, 5.0), (5.0, 5.0));
        assert_eq!(whiskers(&[0.0, 1.0, 1.0, 1.0, 9.0], 1.0, 1.0), (1.0, 1.0));
    }

    fn chart(is_logarithmic: bool) -> BoxChart {
        let values: Vec<f64> = (1..=1000).map(|index| 1e-3 * f64::from(index * index)).collect();
        let series = |name: &str, values: Vec<f64>| {
            let quartiles = values.get(values.len() / 2).map(|median| [0.5 * median, *median, 1.5 * median]);
            BoxSeries { name: name.into(), style: STYLES[0], values, quartiles }
        };
        let boxes = vec![series("one", values), series("none", Vec::new()), series("two", vec![2.0, 2.0])];
        let panels = ["a", "b"].map(|name| BoxPanel { name: name.into(), boxes: boxes.clone() }).to_vec();
        BoxChart { titles: Titles::default(), is_logarithmic, panels }
    }

    #[test]
    fn everything_lies_on_the_sheet_on_either_scale() {
        for is_logarithmic in [false, true] {
            let chart = chart(is_logarithmic);
            let sheets = chart.draw(SCREEN_WIDTH);
            assert_eq!(sheets.len(), 1);
            for mark in &sheets[0].marks {
                let points = match mark {
                    DrawingMark::Area { corners, .. } => corners.clone(),
                    DrawingMark::Line { points, .. } => points.clone(),
                    DrawingMark::Text { at, .. } => vec![*at],
                };
                assert!(points.iter().all(|(x, y)| x.is_finite() && (0.0..=SCREEN_WIDTH).contains(x) && *y >= 0.0));
            }
            assert_eq!(sheets[0].texts().filter(|text| *text == "no drive").count(), 2);
            assert_eq!(chart.rows().count(), 2 * 1002);
        }
    }

    #[test]
    fn powers_of_ten_are_equally_far_apart() {
        let sheet = &chart(true).draw(SCREEN_WIDTH)[0];
        let at = |label: &str| {
            let marks = sheet.marks.iter().filter_map(|mark| match mark {
                DrawingMark::Text { text, at, .. } if text == label => Some(at.0),
                _ => None,
            });
            marks.into_iter().next().expect("it is labelled")
        };
        let steps = [at("0.1") - at("0.01"), at("10") - at("1")];
        assert!(steps[0] > 20.0 && (steps[0] - steps[1]).abs() < 0.1, "{steps:?}");
    }
}
