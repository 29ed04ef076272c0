//! Curves over a number, with bands or whiskers.

use crate::canvas::Point;
use crate::charts::bars::draw_whisker;
use crate::charts::drawing::Drawing;
use crate::charts::sheet::{
    AxisScale, DrawnSheet, LINE, LOWEST, PanelGrid, Plot, SheetLayout, Swatch, distinct, draw_panel_name, numbered,
    sheets,
};
use crate::charts::style::Style;
use crate::charts::{ChartRow, Estimate, Titles};
use crate::colours::INK;
use crate::ticks::{Tick, tick_at};

const HEIGHT: f32 = 280.0;
const LEFT: f32 = 48.0;
/// The height of each of several panels, two of which are side by side.
const PANEL_HEIGHT: f32 = 150.0;
const GRID: PanelGrid = PanelGrid { columns: 2, left: LEFT, below: 30.0, above: LINE };
/// The most panels on a sheet.
const PANELS: usize = 8;
const BAND: f32 = 0.2;
/// The distance between marks of curves at one place, and the share of the room between two places that they may take.
const APART: f32 = 9.0;
const MAX_OF_ROOM: f32 = 0.7;
/// The reach of marks and whiskers to either side.
const MARK: f32 = 5.0;
/// The most places of marks that are the ticks of their axis; among more, round values are.
const MAX_MARK_TICKS: usize = 12;

/// Curves in pairs of axes, which are the same in all panels.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveChart {
    pub titles: Titles,
    pub spread: Spread,
    pub panels: Vec<CurvePanel>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CurvePanel {
    /// The panel's name; empty for a panel that fills a sheet of its own.
    pub name: String,
    pub curves: Vec<Curve>,
}

/// The ways to show intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// A band, for many points.
    Bands,
    /// Whiskers on marked points, for few of them.
    Whiskers,
    /// The same of differences, with a line at zero.
    Differences,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    pub name: String,
    pub style: Style,
    /// Ascending along the x axis.
    pub points: Vec<(f64, Estimate)>,
}

impl CurveChart {
    /// Lists what it shows.
    pub fn rows(&self) -> impl Iterator<Item = ChartRow<'_>> {
        let curves = self.panels.iter().flat_map(|panel| panel.curves.iter().map(|curve| (panel.name.as_str(), curve)));
        curves.flat_map(|(panel, curve)| {
            curve.points.iter().map(move |&(x, Estimate { value, interval })| ChartRow {
                panel,
                series: &curve.name,
                x: x.to_string(),
                value,
                interval,
            })
        })
    }

    /// Draws the panels on as many sheets of this width, in units, as they take.
    pub fn draw(&self, width: f32) -> Vec<Drawing> {
        let swatch = if self.spread == Spread::Bands { Swatch::Line } else { Swatch::MarkedLine };
        let points = || self.panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points);
        // All panels share one scale, so that their curves can be compared.
        let y = AxisScale::around(points().map(|(_, estimate)| estimate.range()));
        // Differences have no meaning without the line at zero; other quantities have it if that costs little room.
        let y = if self.spread == Spread::Differences { y.with_zero() } else { y.with_near_zero() };
        let x = AxisScale::around(points().map(|&(x, _)| (x, x)));
        let x = if self.spread == Spread::Bands { exact(x, points()) } else { x };
        let sheets = sheets(&self.panels, |panel| &panel.name, PANELS);
        let sheet = |(index, panels): (usize, &&[CurvePanel])| {
            let curves = panels.iter().flat_map(|panel| &panel.curves);
            let key = distinct(curves.map(|curve| (curve.style, curve.name.as_str())));
            let titles = numbered(&self.titles, index, sheets.len());
            let grid = GRID.with_names(width, panels.iter().map(|panel| panel.name.as_str()));
            let heights = vec![grid.panel_height(width, PANEL_HEIGHT); panels.len()];
            let is_alone = panels[0].name.is_empty();
            let height = if is_alone { HEIGHT } else { grid.height(&heights) };
            let layout = SheetLayout { titles: &titles, swatch, key, width, left: LEFT, right: 0.0, height };
            let layout = if is_alone { layout.with_one_panel(LOWEST) } else { layout };
            let DrawnSheet { mut drawing, plot } = layout.draw();
            let parts = if is_alone { vec![plot] } else { grid.parts(&plot, &heights) };
            for (panel, plot) in panels.iter().zip(parts) {
                // Marks and whiskers reach beyond their places, and must not be cut off at the ends of the axis.
                let x = if self.spread == Spread::Bands { x } else { self.roomy(x, &plot) };
                self.draw_panel(&mut drawing, &Axes { plot, x, y }, panel);
            }
            drawing
        };
        sheets.iter().enumerate().map(sheet).collect()
    }

    /// The scale with room at both ends for the marks of all curves, which are side by side.
    fn roomy(&self, x: AxisScale, plot: &Plot) -> AxisScale {
        let max = self.panels.iter().map(|panel| panel.curves.len()).max().unwrap_or(0);
        let aside = f64::from(0.5 * APART * max as f32 + MARK);
        let places =
            self.panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points).map(|(x, _)| *x);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let width = f64::from(plot.right - plot.left);
        // The room is itself part of the scale, so it is a share of the width that is left.
        let room = (high - low) * aside / (width - 2.0 * aside);
        if room.is_finite() && room > 0.0 {
            AxisScale { low: x.low.min(low - room), high: x.high.max(high + room) }
        } else {
            x
        }
    }

    /// Ticks where the marks of all panels are; `None` if these are too many, or there are none.
    fn mark_ticks(&self) -> Option<Vec<Tick>> {
        let points = self.panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| &curve.points);
        let mut places: Vec<f64> = points.map(|&(x, _)| x).filter(|x| x.is_finite()).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let are_few = self.spread != Spread::Bands && (1..=MAX_MARK_TICKS).contains(&places.len());
        are_few.then(|| places.into_iter().map(tick_at).collect())
    }

    fn draw_panel(&self, drawing: &mut Drawing, axes: &Axes, panel: &CurvePanel) {
        draw_panel_name(drawing, &axes.plot, LEFT, &panel.name);
        axes.plot.draw_y_axis(drawing, axes.y);
        match self.mark_ticks() {
            Some(ticks) => axes.plot.draw_x_ticks(drawing, axes.x, &ticks),
            None => axes.plot.draw_x_axis(drawing, axes.x),
        }
        axes.plot.draw_base(drawing);
        match self.spread {
            Spread::Bands => axes.draw_bands(drawing, &panel.curves),
            Spread::Whiskers => axes.draw_marked(drawing, &panel.curves),
            Spread::Differences => {
                let Axes { plot, y, .. } = axes;
                let zero = plot.y(*y, 0.0);
                drawing.line(vec![(plot.left, zero), (plot.right, zero)], 1.6, INK);
                axes.draw_marked(drawing, &panel.curves);
            }
        }
    }
}

/// The scale without room at its ends.
fn exact<'a>(scale: AxisScale, points: impl Iterator<Item = &'a (f64, Estimate)>) -> AxisScale {
    let ends = points.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &(x, _)| (low.min(x), high.max(x)));
    if ends.0 < ends.1 { AxisScale { low: ends.0, high: ends.1 } } else { scale }
}

struct Axes {
    plot: Plot,
    x: AxisScale,
    y: AxisScale,
}

impl Axes {
    fn line<'a>(
        &'a self,
        curve: &'a Curve,
        value: fn(&Estimate) -> f64,
    ) -> impl DoubleEndedIterator<Item = Point> + 'a {
        curve.points.iter().map(move |(x, estimate)| (self.plot.x(self.x, *x), self.plot.y(self.y, value(estimate))))
    }

    fn draw_bands(&self, drawing: &mut Drawing, curves: &[Curve]) {
        curves.iter().for_each(|curve| self.draw_band(drawing, curve));
        for curve in curves {
            curve.style.line(drawing, self.line(curve, |estimate| estimate.value).collect());
        }
    }

    /// Lines through their values, so that they cross only where means do. Marks and whiskers at one place are a little
    /// beside each other, so that all are seen.
    fn draw_marked(&self, drawing: &mut Drawing, curves: &[Curve]) {
        // All lines come first, so none lies over another curve's mark.
        for curve in curves {
            curve.style.line(drawing, self.line(curve, |estimate| estimate.value).collect());
        }
        let apart = APART.min(MAX_OF_ROOM * self.min_room(curves) / curves.len().max(1) as f32);
        for (index, curve) in curves.iter().enumerate() {
            let aside = apart * (index as f32 - 0.5 * (curves.len() - 1) as f32);
            for ((_, estimate), (x, y)) in curve.points.iter().zip(self.line(curve, |estimate| estimate.value)) {
                let x = x + aside;
                if let Some((low, high)) = estimate.interval {
                    let ends = [self.plot.y(self.y, low), self.plot.y(self.y, high)];
                    draw_whisker(drawing, x, ends, 4.0, curve.style.colour);
                }
                curve.style.mark(drawing, (x, y), 4.0);
            }
        }
    }

    /// Units between the two places that are nearest to each other.
    fn min_room(&self, curves: &[Curve]) -> f32 {
        let mut places: Vec<f32> =
            curves.iter().flat_map(|curve| self.line(curve, |estimate| estimate.value).map(|(x, _)| x)).collect();
        places.sort_by(f32::total_cmp);
        places.dedup();
        places.windows(2).map(|pair| pair[1] - pair[0]).fold(f32::INFINITY, f32::min)
    }

    fn draw_band(&self, drawing: &mut Drawing, curve: &Curve) {
        let low = self.line(curve, |estimate| estimate.interval.map_or(estimate.value, |(low, _)| low));
        let high = self.line(curve, |estimate| estimate.interval.map_or(estimate.value, |(_, high)| high));
        let outline: Vec<Point> = low.chain(high.rev()).collect();
        drawing.area(outline, curve.style.colour, BAND);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::drawing::DrawingMark;
    use crate::charts::{SCREEN_WIDTH, STYLES};

    #[test]
    fn curve_lies_in_its_band() {
        let point = |index: u32| {
            let value = f64::from(index * index);
            (f64::from(index), Estimate { value, interval: Some((value - 1.0, value + 2.0)) })
        };
        let curve = Curve { name: "one".into(), style: STYLES[0], points: (0..10).map(point).collect() };
        let panels = vec![CurvePanel { name: String::new(), curves: vec![curve] }];
        let chart = CurveChart { titles: Titles::default(), spread: Spread::Bands, panels };
        let drawing = &chart.draw(SCREEN_WIDTH)[0];
        let band = drawing.marks.iter().find_map(|mark| match mark {
            DrawingMark::Area { corners, .. } => Some(corners.clone()),
            _ => None,
        });
        let line = drawing.marks.iter().rev().find_map(|mark| match mark {
            DrawingMark::Line { points, .. } => Some(points.clone()),
            _ => None,
        });
        let band = band.expect("a band");
        let line = line.expect("a line");
        for (index, (x, y)) in line.iter().enumerate() {
            let low = band[index];
            let high = band[band.len() - 1 - index];
            assert!(low.0 == *x && high.0 == *x && low.1 >= *y && *y >= high.1, "{index}");
        }
    }

    #[test]
    fn lines_go_through_the_true_places_and_only_marks_and_whiskers_are_moved() {
        // Seven planners that fall steeply, the first above all others everywhere.
        let curve = |index: usize| {
            let point = |x: f64| {
                let value = 100.0 - 400.0 * x - 0.5 * index as f64;
                (x, Estimate { value, interval: Some((value - 1.0, value + 1.0)) })
            };
            Curve { name: format!("{index}"), style: STYLES[index], points: [0.05, 0.1, 0.2].map(point).to_vec() }
        };
        let panels = vec![CurvePanel { name: String::new(), curves: (0..STYLES.len()).map(curve).collect() }];
        let chart = CurveChart { titles: Titles::default(), spread: Spread::Whiskers, panels };
        // 85 mm at 8 points.
        let drawing = &chart.draw(355.0)[0];
        let lines = |holds: fn(&[Point], f32) -> bool| {
            let lines = drawing.marks.iter().filter_map(move |mark| match mark {
                DrawingMark::Line { points, width, .. } if holds(points, *width) => Some(points.clone()),
                _ => None,
            });
            lines.collect::<Vec<_>>()
        };
        let curves = lines(|points, _| points.len() == 3);
        assert_eq!(curves.len(), STYLES.len());
        for (upper, lower) in curves.iter().zip(&curves[1..]) {
            assert!(upper.iter().zip(lower).all(|(upper, lower)| upper.0 == lower.0 && upper.1 < lower.1));
        }
        let whiskers = lines(|points, width| width == 1.4 && points[0].0 == points[1].0);
        let mut places: Vec<f32> = whiskers.iter().map(|points| points[0].0).collect();
        places.sort_by(f32::total_cmp);
        assert!(places.len() == 21 && places.windows(2).all(|pair| pair[1] - pair[0] > 1.0), "{places:?}");
    }

    #[test]
    fn axis_has_the_values_at_which_marks_are_if_these_are_few() {
        let estimate = Estimate { value: 1.0, interval: None };
        let drawing = |count: u32| {
            let points = (1..=count).map(|index| (f64::from(index * index) / 8.0, estimate)).collect();
            let curves = vec![Curve { name: "one".into(), style: STYLES[0], points }];
            let panels = vec![CurvePanel { name: String::new(), curves }];
            CurveChart { titles: Titles::default(), spread: Spread::Whiskers, panels }.draw(SCREEN_WIDTH).remove(0)
        };
        for label in ["0.125", "0.5", "1.125", "2", "3.125"] {
            assert!(drawing(5).texts().any(|text| text == label), "{label}");
        }
        assert!(!drawing(13).texts().any(|text| text == "0.125"));
    }

    #[test]
    fn marks_of_many_curves_stay_in_their_panel() {
        let estimate = Estimate { value: 1.0, interval: Some((0.5, 1.5)) };
        let curve = |index: usize| Curve {
            name: format!("curve {index}"),
            style: STYLES[index],
            points: vec![(6.0, estimate), (12.0, estimate)],
        };
        let panel = |name: &str| CurvePanel { name: name.into(), curves: (0..STYLES.len()).map(curve).collect() };
        let panels = vec![panel("one"), panel("two")];
        let drawing = &CurveChart { titles: Titles::default(), spread: Spread::Whiskers, panels }.draw(SCREEN_WIDTH)[0];
        let bases = drawing.marks.iter().filter_map(|mark| match mark {
            DrawingMark::Line { points, width, .. } if *width == 1.2 => Some((points[0].0, points[1].0)),
            _ => None,
        });
        let bases: Vec<(f32, f32)> = bases.collect();
        assert_eq!(bases.len(), 2, "a base line for each panel");
        let mut marks = 0;
        for corners in drawing.marks.iter().filter_map(|mark| match mark {
            // Below the key.
            DrawingMark::Area { corners, .. } if corners[0].1 > 100.0 => Some(corners),
            _ => None,
        }) {
            let is_inside =
                |&(left, right): &(f32, f32)| corners.iter().all(|&(x, _)| x >= left - 2.0 && x <= right + 2.0);
            assert!(bases.iter().any(is_inside), "{corners:?} {bases:?}");
            marks += 1;
        }
        assert!(marks >= 2 * 7 * 2, "{marks} marks");
    }

    #[test]
    fn charts_for_a_column_are_low_and_cut_no_name() {
        let estimate = Estimate { value: 1.0, interval: Some((0.5, 1.5)) };
        let curves: Vec<Curve> = ["prm-rs", "hybrid-astar", "lattice"]
            .into_iter()
            .zip(STYLES)
            .map(|(name, style)| Curve { name: name.into(), style, points: vec![(0.05, estimate), (0.2, estimate)] })
            .collect();
        let chart = |names: &[&str]| {
            let titles = Titles {
                title: "Extinguished at the end of a run, by field.coverage".into(),
                note: "Marks are means, whiskers their 95 % intervals.".into(),
                x: "field.coverage".into(),
                y: "share of obstacles".into(),
            };
            let panel = |name: &&str| CurvePanel { name: (*name).to_owned(), curves: curves.clone() };
            CurveChart { titles, spread: Spread::Whiskers, panels: names.iter().map(panel).collect() }
        };
        let names = ["prm-rs, field.coverage 0.05", "hybrid-astar, field.coverage 0.05", "none; least-slack, 0.1"];
        // 85 and 88 mm with letters of 8 pt.
        for width in [355.6, 368.2] {
            let alone = &chart(&[""]).draw(width)[0];
            assert!(alone.height <= 0.7 * width + 0.01, "{} of {width}", alone.height);
            let several = &chart(&names).draw(width)[0];
            assert!(several.height <= 2.0 * 0.7 * width, "two rows of panels: {} of {width}", several.height);
            let texts: Vec<&str> = several.texts().chain(alone.texts()).collect();
            assert!(!texts.iter().any(|text| text.contains("...")), "{texts:?}");
            assert!(texts.contains(&"hybrid-astar,") && texts.contains(&"field.coverage 0.05"), "{texts:?}");
        }
        assert_eq!(chart(&[""]).draw(SCREEN_WIDTH)[0].height, 18.0 + 12.0 + 4.0 * 19.0 + 280.0 + 25.0 + 19.0 + 18.0);
    }
}
