//! Bars in groups, with whiskers.

use super::axes::Scale;
use super::drawing::Drawing;
use super::sheet::{LABEL, Layout, Plot, Swatch, fitted, width_of};
use super::style::{STYLES, Style};
use super::{Estimate, Titles};
use crate::picture::canvas::Point;
use crate::picture::colours::{INK, PAPER, Rgb};
use crate::picture::text::Align;

const HEIGHT: f32 = 260.0;
const LEFT: f32 = 48.0;
/// What of a group's room its bars take.
const BARS: f32 = 0.78;
const WIDEST: f32 = 64.0;

/// A bar of every series in every group; values from zero.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    pub titles: Titles,
    /// Names of the groups, from left to right.
    pub groups: Vec<String>,
    /// At most as many as there are [`STYLES`]; more are left out.
    pub series: Vec<BarSeries>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct BarSeries {
    pub name: String,
    /// One for each group; `None` where there is nothing to show.
    pub bars: Vec<Option<Estimate>>,
}

impl BarChart {
    pub fn draw(&self) -> Drawing {
        let series = || STYLES.into_iter().zip(&self.series);
        let key = series().map(|(style, series)| (style, series.name.as_str())).collect();
        let layout = Layout { titles: &self.titles, swatch: Swatch::Bar, key, left: LEFT, height: HEIGHT };
        let (mut drawing, plot) = layout.draw();
        let bars = series().flat_map(|(_, series)| series.bars.iter().flatten());
        let scale = Scale::around(bars.map(Estimate::range)).with_zero();
        plot.draw_y_axis(&mut drawing, scale);
        let room = (plot.right - plot.left) / self.groups.len().max(1) as f32;
        let count = series().count().max(1) as f32;
        let width = (room * BARS / count).min(WIDEST);
        let numbers = series().flat_map(|(_, series)| series.bars.iter().flatten()).map(|bar| short_number(bar.value));
        let has_numbers = numbers.map(|number| width_of(&number, LABEL)).fold(0.0, f32::max) < width;
        for (group, name) in self.groups.iter().enumerate() {
            let centre = plot.left + (group as f32 + 0.5) * room;
            for (index, (style, series)) in series().enumerate() {
                let left = centre + (index as f32 - count / 2.0) * width;
                if let Some(bar) = series.bars.get(group).copied().flatten() {
                    let top = draw_bar(&mut drawing, &plot, scale, style, bar, (left, left + width));
                    if has_numbers {
                        let at = (left + width / 2.0, top - 5.0);
                        drawing.text(&short_number(bar.value), at, Align::Centre, LABEL, INK);
                    }
                }
            }
            draw_name(&mut drawing, name, (centre, plot.bottom), room - 6.0);
        }
        plot.draw_base(&mut drawing);
        drawing
    }
}

/// Where the bar, or its whisker, ends on the top is returned.
fn draw_bar(
    drawing: &mut Drawing,
    plot: &Plot,
    scale: Scale,
    style: Style,
    bar: Estimate,
    (left, right): (f32, f32),
) -> f32 {
    let gap = 0.06 * (right - left);
    let (left, right) = (left + gap, right - gap);
    style.fill_rect(drawing, (left, plot.y(scale, bar.value)), (right, plot.y(scale, 0.0)));
    let centre = 0.5 * (left + right);
    let mut top = plot.y(scale, bar.value);
    if let Some((low, high)) = bar.interval.filter(|(low, high)| low < high) {
        let ends = [plot.y(scale, low), plot.y(scale, high)];
        draw_whisker(drawing, centre, ends, (0.25 * (right - left)).min(6.0), INK);
        top = top.min(ends[1]);
    }
    top
}

/// A group's name in one line, or in two where it is too long.
fn draw_name(drawing: &mut Drawing, name: &str, (x, y): Point, room: f32) {
    let is_long = width_of(name, LABEL) > room;
    let (first, second) = if is_long { name.split_once(' ').unwrap_or((name, "")) } else { (name, "") };
    for (index, line) in [first, second].into_iter().filter(|line| !line.is_empty()).enumerate() {
        let base = y + 9.0 + LABEL + index as f32 * (LABEL + 5.0);
        drawing.text(&fitted(line, room, LABEL), (x, base), Align::Centre, LABEL, INK);
    }
}

/// A line from end to end with bars of twice `reach` across, on white so that it shows on every ground.
pub fn draw_whisker(drawing: &mut Drawing, x: f32, [low, high]: [f32; 2], reach: f32, ink: Rgb) {
    for (width, colour) in [(3.6, PAPER), (1.4, ink)] {
        drawing.line(vec![(x, low), (x, high)], width, colour);
        for y in [low, high] {
            drawing.line(vec![(x - reach, y), (x + reach, y)], width, colour);
        }
    }
}

/// A number with three digits or its whole part.
fn short_number(value: f64) -> String {
    let decimals = match value.abs() {
        size if size >= 100.0 || size == 0.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 1.0 => 2,
        _ => 3,
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::charts::drawing::Mark;

    #[test]
    fn bars_are_as_high_as_their_values() {
        let bar = |value| Some(Estimate { value, interval: None });
        let chart = BarChart {
            titles: Titles::default(),
            groups: vec!["a".into(), "b".into()],
            series: vec![BarSeries { name: "one".into(), bars: vec![bar(2.0), bar(1.0)] }],
        };
        let drawing = chart.draw();
        let heights: Vec<f32> = drawing
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Area { corners, .. } => Some(corners[2].1 - corners[0].1),
                _ => None,
            })
            .collect();
        assert_eq!(heights.len(), 2);
        assert!((heights[0] - 2.0 * heights[1]).abs() < 0.01, "{heights:?}");
    }
}
