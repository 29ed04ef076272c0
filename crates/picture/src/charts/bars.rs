//! Bars in groups, with whiskers.

use crate::canvas::Point;
use crate::charts::drawing::Drawing;
use crate::charts::sheet::{
    AxisScale, DrawnSheet, LABEL, LINE, LOWEST, PanelGrid, Plot, SheetLayout, Swatch, distinct, draw_panel_name, lines,
    numbered, sheets, width_of,
};
use crate::charts::style::Style;
use crate::charts::{ChartRow, Estimate, Titles};
use crate::colours::{INK, PAPER, Rgb};
use crate::text::Align;

const HEIGHT: f32 = 260.0;
const LEFT: f32 = 48.0;
/// The height of each of several panels, one below the other, with the names of the groups under each.
const PANEL_HEIGHT: f32 = 120.0;
const GRID: PanelGrid = PanelGrid { columns: 1, left: LEFT, below: 44.0, above: LINE };
/// The most panels on a sheet.
const PANELS: usize = 4;
/// The share of a group's room that its bars take.
const BARS: f32 = 0.78;
const WIDEST: f32 = 64.0;

/// A bar of every series in every group; values from zero. All panels have one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    pub titles: Titles,
    /// Names of the groups, from left to right.
    pub groups: Vec<String>,
    pub panels: Vec<BarPanel>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct BarPanel {
    /// The panel's name; empty for a panel that fills a sheet of its own.
    pub name: String,
    pub series: Vec<BarSeries>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct BarSeries {
    pub name: String,
    pub style: Style,
    /// One for each group; `None` where there is nothing to show.
    pub bars: Vec<Option<Estimate>>,
}

impl BarChart {
    /// Lists what it shows.
    pub fn rows(&self) -> impl Iterator<Item = ChartRow<'_>> {
        let series =
            self.panels.iter().flat_map(|panel| panel.series.iter().map(|series| (panel.name.as_str(), series)));
        series.flat_map(|(panel, series)| {
            let bars = self.groups.iter().zip(&series.bars).filter_map(|(group, bar)| Some((group, (*bar)?)));
            bars.map(move |(group, Estimate { value, interval })| ChartRow {
                panel,
                series: &series.name,
                x: group.clone(),
                value,
                interval,
            })
        })
    }

    /// Draws the panels on as many sheets of this width, in units, as they take.
    pub fn draw(&self, width: f32) -> Vec<Drawing> {
        let bars = self.panels.iter().flat_map(|panel| &panel.series).flat_map(|series| series.bars.iter().flatten());
        // All panels and sheets share one scale, so that heights can be compared; it begins at zero, as a bar shows a length.
        let scale = AxisScale::around(bars.map(Estimate::range)).with_zero();
        let sheets = sheets(&self.panels, |panel| &panel.name, PANELS);
        let names = self.names(self.room(width - SheetLayout::margins(width) - LEFT) - NAME_GAP);
        let sheet = |(index, panels): (usize, &&[BarPanel])| {
            let series = panels.iter().flat_map(|panel| &panel.series);
            let key = distinct(series.map(|series| (series.style, series.name.as_str())));
            let titles = numbered(&self.titles, index, sheets.len());
            let titles = Titles { x: names.key.clone().unwrap_or_else(|| titles.x.clone()), ..titles };
            let grid = GRID.with_names(width, panels.iter().map(|panel| panel.name.as_str()));
            let heights = vec![grid.panel_height(width, PANEL_HEIGHT); panels.len()];
            // A panel without a name is the only one, and takes the whole plot.
            let is_alone = panels[0].name.is_empty();
            let height = if is_alone { HEIGHT } else { grid.height(&heights) };
            let layout =
                SheetLayout { titles: &titles, swatch: Swatch::Bar, key, width, left: LEFT, right: 0.0, height };
            let layout = if is_alone { layout.with_one_panel(LOWEST) } else { layout };
            let DrawnSheet { mut drawing, plot } = layout.draw();
            let parts = if is_alone { vec![plot] } else { grid.parts(&plot, &heights) };
            for (panel, part) in panels.iter().zip(&parts) {
                self.draw_panel(&mut drawing, part, scale, (panel, &names));
            }
            drawing
        };
        sheets.iter().enumerate().map(sheet).collect()
    }

    /// The room of a group on a plot of this width.
    fn room(&self, width: f32) -> f32 {
        width / self.groups.len().max(1) as f32
    }

    /// Names the groups in lines of this width: in words if these fit, else by letters with a key.
    fn names(&self, room: f32) -> GroupNames {
        let lines: Vec<Vec<String>> = self.groups.iter().map(|name| lines(name, room, LABEL)).collect();
        if self.groups.iter().zip(&lines).all(|(name, lines)| lines.len() <= NAME_LINES && lines.join(" ") == *name) {
            return GroupNames { lines, key: None };
        }
        let letters = || (b'A'..=b'Z').cycle().map(|letter| char::from(letter).to_string());
        let key = self.groups.iter().zip(letters()).map(|(name, letter)| format!("{letter}: {name}"));
        let key = key.collect::<Vec<_>>().join(", ");
        GroupNames { lines: letters().take(self.groups.len()).map(|letter| vec![letter]).collect(), key: Some(key) }
    }

    fn draw_panel(
        &self,
        drawing: &mut Drawing,
        plot: &Plot,
        scale: AxisScale,
        (panel, names): (&BarPanel, &GroupNames),
    ) {
        draw_panel_name(drawing, plot, LEFT, &panel.name);
        plot.draw_y_axis(drawing, scale);
        let room = self.room(plot.right - plot.left);
        // Never 0, as a panel may have axes but no series.
        let count = panel.series.len().max(1) as f32;
        let width = (room * BARS / count).min(WIDEST);
        let bars = panel.series.iter().flat_map(|series| series.bars.iter().flatten());
        let numbers = bars.map(|bar| short_number(bar.value));
        // Numbers on some bars only would look like a choice of the author.
        let has_numbers = numbers.map(|number| width_of(&number, LABEL)).fold(0.0, f32::max) < width;
        for (group, name) in names.lines.iter().enumerate() {
            let centre = plot.left + (group as f32 + 0.5) * room;
            for (index, series) in panel.series.iter().enumerate() {
                let left = centre + (index as f32 - count / 2.0) * width;
                if let Some(bar) = series.bars.get(group).copied().flatten() {
                    let top = draw_bar(drawing, plot, scale, series.style, bar, (left, left + width));
                    if has_numbers {
                        let at = (left + width / 2.0, top - 5.0);
                        drawing.text(&short_number(bar.value), at, Align::Centre, LABEL, INK);
                    }
                }
            }
            draw_name(drawing, name, (centre, plot.bottom));
        }
        plot.draw_base(drawing);
    }
}

/// Draws a bar and returns the height at which it, or its whisker, ends.
fn draw_bar(
    drawing: &mut Drawing,
    plot: &Plot,
    scale: AxisScale,
    style: Style,
    bar: Estimate,
    (left, right): (f32, f32),
) -> f32 {
    let gap = 0.06 * (right - left);
    let (left, right) = (left + gap, right - gap);
    style.fill_rect(drawing, (left, plot.y(scale, bar.value)), (right, plot.y(scale, 0.0)));
    let centre = 0.5 * (left + right);
    let mut top = plot.y(scale, bar.value);
    // An interval without width would be a stroke that looks like an edge of the bar.
    if let Some((low, high)) = bar.interval.filter(|(low, high)| low < high) {
        let ends = [plot.y(scale, low), plot.y(scale, high)];
        draw_whisker(drawing, centre, ends, (0.25 * (right - left)).min(6.0), INK);
        // The number above stands clear of the whisker.
        top = top.min(ends[1]);
    }
    top
}

/// What stands below the groups.
struct GroupNames {
    lines: Vec<Vec<String>>,
    /// What letters stand for, where there is no room for the names.
    key: Option<String>,
}

/// The most lines of a group's name, and units between two names.
const NAME_LINES: usize = 2;
const NAME_GAP: f32 = 6.0;

fn draw_name(drawing: &mut Drawing, lines: &[String], (x, y): Point) {
    for (index, line) in lines.iter().enumerate() {
        let base = y + 9.0 + LABEL + index as f32 * (LABEL + 5.0);
        drawing.text(line, (x, base), Align::Centre, LABEL, INK);
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
    use crate::charts::drawing::DrawingMark;
    use crate::charts::{SCREEN_WIDTH, STYLES};

    #[test]
    fn bars_are_as_high_as_their_values() {
        let bar = |value| Some(Estimate { value, interval: None });
        let chart = BarChart {
            titles: Titles::default(),
            groups: vec!["a".into(), "b".into()],
            panels: vec![BarPanel {
                name: String::new(),
                series: vec![BarSeries { name: "one".into(), style: STYLES[0], bars: vec![bar(2.0), bar(1.0)] }],
            }],
        };
        let heights: Vec<f32> = chart.draw(SCREEN_WIDTH)[0]
            .marks
            .iter()
            .filter_map(|mark| match mark {
                DrawingMark::Area { corners, .. } => Some(corners[2].1 - corners[0].1),
                _ => None,
            })
            .collect();
        assert_eq!(heights.len(), 2);
        assert!((heights[0] - 2.0 * heights[1]).abs() < 0.01, "{heights:?}");
    }

    #[test]
    fn names_that_have_no_room_are_letters_with_a_key() {
        let groups = ["Clearance field", "Sampling", "Connecting", "Roadmap search", "Local search", "Reachability"];
        let series = vec![BarSeries { name: "one".into(), style: STYLES[0], bars: vec![None; groups.len()] }];
        let chart = BarChart {
            titles: Titles {
                title: "CPU time of a run by part, in words that take several lines".into(),
                ..Titles::default()
            },
            groups: groups.map(str::to_owned).to_vec(),
            panels: vec![BarPanel { name: String::new(), series }],
        };
        let texts = |width| chart.draw(width)[0].texts().map(str::to_owned).collect::<Vec<_>>();
        assert!(texts(SCREEN_WIDTH).contains(&"Sampling".to_owned()));
        let narrow = texts(300.0);
        assert!(narrow.contains(&"F".to_owned()) && narrow.join(" ").contains("F: Reachability"), "{narrow:?}");
        assert!(narrow.iter().all(|text| !text.contains("...")), "{narrow:?}");
    }

    #[test]
    fn panels_have_one_scale_whatever_sheet_they_are_on() {
        let panel = |value: f64| {
            let bars = vec![Some(Estimate { value, interval: None })];
            let series = vec![BarSeries { name: "one".into(), style: STYLES[0], bars }];
            BarPanel { name: format!("panel {value}"), series }
        };
        let panels: Vec<BarPanel> = (1..=10).map(|value| panel(f64::from(value))).collect();
        let drawings = BarChart { titles: Titles::default(), groups: vec!["a".into()], panels }.draw(SCREEN_WIDTH);
        assert_eq!(drawings.len(), 3);
        let heights = drawings.iter().flat_map(|drawing| &drawing.marks).filter_map(|mark| match mark {
            DrawingMark::Area { corners, .. } => Some(corners[2].1 - corners[0].1),
            _ => None,
        });
        let heights: Vec<f32> = heights.collect();
        assert_eq!(heights.len(), 10, "a bar for each");
        assert!(heights.iter().zip(1..).all(|(height, value)| (height / heights[0] - value as f32).abs() < 0.01));
        let names = drawings.iter().flat_map(|drawing| &drawing.marks);
        let names = names.filter(|mark| matches!(mark, DrawingMark::Text { text, .. } if text.starts_with("panel ")));
        assert_eq!(names.count(), 10, "each with its name");
    }
}
