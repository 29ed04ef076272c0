//! Differences, one below the other: each with its interval, beside a line at zero.

use crate::charts::drawing::Drawing;
use crate::charts::sheet::{AxisScale, DrawnSheet, LABEL, Plot, SheetLayout, Swatch, fitted, lines, rule, width_of};
use crate::charts::style::STYLES;
use crate::charts::{ChartRow, Estimate, Titles};
use crate::colours::{INK, PAPER};
use crate::text::Align;

const ROW: f32 = 30.0;
/// The most room for names, and for names and words together, in shares of the width of the sheet.
const WIDEST_NAME: f32 = 0.32;
const WIDEST_TEXT: f32 = 0.63;
/// From one line of a text in two lines to the other.
const LINE: f32 = 12.0;
/// The room between the plot and the words at its sides.
const GAP: f32 = 12.0;
/// Half of the side of a mark, and the reach of the ends of an interval.
const MARK: f32 = 4.5;

/// Differences over one axis, after the forest plots of meta-analyses (Lewis, Clarke, "Forest plots: trying to see the wood
/// and the trees", BMJ 322, 2001).
#[derive(Clone, Debug, PartialEq)]
pub struct ForestChart {
    pub titles: Titles,
    pub rows: Vec<ForestRow>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ForestRow {
    pub name: String,
    /// The difference and its interval; `None` where it cannot be given in the unit of the axis.
    pub difference: Option<Estimate>,
    /// Words to the right of it, such as the same in its own unit.
    pub text: String,
    /// True if there is evidence of a difference: the mark is filled.
    pub is_significant: bool,
}

impl ForestChart {
    /// Lists what it shows.
    pub fn rows(&self) -> impl Iterator<Item = ChartRow<'_>> {
        self.rows.iter().filter_map(|ForestRow { name, difference, .. }| {
            let Estimate { value, interval } = (*difference)?;
            Some(ChartRow { panel: "", series: name, x: String::new(), value, interval })
        })
    }

    pub fn draw(&self, width: f32) -> Drawing {
        let widest = |text: fn(&ForestRow) -> &str, max: f32| {
            self.rows.iter().map(|row| width_of(text(row), LABEL)).fold(0.0, f32::max).min(max)
        };
        // Names give way to the numbers, which are what the chart is read for.
        let of_names = widest(|row| &row.name, WIDEST_NAME * width);
        let of_texts = widest(|row| &row.text, WIDEST_TEXT * width - of_names);
        let (left, right) = (of_names + GAP, of_texts + GAP);
        let height = ROW * self.rows.len().max(1) as f32;
        let layout =
            SheetLayout { titles: &self.titles, swatch: Swatch::Bar, key: Vec::new(), width, left, right, height };
        let DrawnSheet { mut drawing, plot } = layout.draw();
        let differences = self.rows.iter().filter_map(|row| row.difference);
        // Zero is on the scale in any case: a difference is judged by its distance from it.
        let scale = AxisScale::around(differences.map(|difference| difference.range()).chain([(0.0, 0.0)]));
        plot.draw_x_axis(&mut drawing, scale);
        let zero = plot.x(scale, 0.0);
        drawing.line(vec![(zero, plot.top), (zero, plot.bottom)], 1.6, INK);
        for (index, row) in self.rows.iter().enumerate() {
            let middle = plot.top + (index as f32 + 0.5) * ROW;
            if index > 0 {
                rule(&mut drawing, &plot, middle - 0.5 * ROW);
            }
            draw_text(&mut drawing, &row.name, of_names, (plot.left - GAP, middle), Align::Right);
            draw_text(&mut drawing, &row.text, of_texts, (plot.right + GAP, middle), Align::Left);
            draw_difference(&mut drawing, &plot, scale, middle, row);
        }
        plot.draw_base(&mut drawing);
        drawing
    }
}

/// Draws a text about a height, in two lines where one is too short; what two lines do not hold is cut.
fn draw_text(drawing: &mut Drawing, text: &str, room: f32, (x, middle): (f32, f32), align: Align) {
    let first = lines(text, room, LABEL).swap_remove(0);
    let rest = text.strip_prefix(first.as_str()).unwrap_or_default().trim_start();
    let from_middle = if rest.is_empty() { 0.0 } else { 0.5 * LINE };
    let base = middle + 0.5 * LABEL;
    drawing.text(&first, (x, base - from_middle), align, LABEL, INK);
    if !rest.is_empty() {
        drawing.text(&fitted(rest, room, LABEL), (x, base + from_middle), align, LABEL, INK);
    }
}

/// Draws the difference of a row about a height, with its interval.
fn draw_difference(drawing: &mut Drawing, plot: &Plot, scale: AxisScale, middle: f32, row: &ForestRow) {
    let Some(Estimate { value, interval }) = row.difference else { return };
    let colour = STYLES[0].colour;
    if let Some((low, high)) = interval {
        let ends = [plot.x(scale, low), plot.x(scale, high)];
        drawing.line(vec![(ends[0], middle), (ends[1], middle)], 1.8, colour);
        for x in ends {
            drawing.line(vec![(x, middle - MARK), (x, middle + MARK)], 1.8, colour);
        }
    }
    let x = plot.x(scale, value);
    let mut square =
        |reach: f32, colour| drawing.rect((x - reach, middle - reach), (x + reach, middle + reach), colour);
    square(MARK, colour);
    // A hollow mark is seen in print and by the colour-blind too.
    if !row.is_significant {
        square(MARK - 1.6, PAPER);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::SCREEN_WIDTH;
    use crate::charts::drawing::DrawingMark;

    #[test]
    fn differences_are_on_their_side_of_zero_within_their_intervals() {
        let row = |value: f64, is_significant| ForestRow {
            name: "a metric with a long name".into(),
            difference: Some(Estimate { value, interval: Some((value - 2.0, value + 3.0)) }),
            text: "5 (3 to 8)".into(),
            is_significant,
        };
        let without = ForestRow { difference: None, ..row(0.0, false) };
        let rows = vec![row(5.0, true), row(-1.0, false), without];
        let drawing = ForestChart { titles: Titles::default(), rows }.draw(SCREEN_WIDTH);
        let lines = |width: f32| {
            let lines = drawing.marks.iter().filter_map(move |mark| match mark {
                DrawingMark::Line { points, width: stroke, .. } if *stroke == width => Some(points.clone()),
                _ => None,
            });
            lines.collect::<Vec<_>>()
        };
        let zero = lines(1.6)[0][0].0;
        let intervals = lines(1.8);
        assert_eq!(intervals.len(), 2 * 3, "an interval and its two ends for each row that has one");
        let squares = drawing.marks.iter().filter_map(|mark| match mark {
            DrawingMark::Area { corners, colour, .. } => Some((0.5 * (corners[0].0 + corners[1].0), *colour)),
            _ => None,
        });
        let squares: Vec<_> = squares.collect();
        assert_eq!(
            squares.iter().filter(|(_, colour)| *colour == PAPER).count(),
            1,
            "one that is not significantly different"
        );
        assert!(squares[0].0 > zero && squares[1].0 < zero && intervals[0][0].0 > zero && intervals[3][1].0 > zero);
        for (interval, square) in [(&intervals[0], squares[0].0), (&intervals[3], squares[1].0)] {
            assert!(interval[0].0 < square && square < interval[1].0);
        }
        assert!(drawing.marks.iter().all(|mark| match mark {
            DrawingMark::Line { points, .. } => points.iter().all(|&(x, _)| (0.0..=SCREEN_WIDTH).contains(&x)),
            _ => true,
        }));
    }

    #[test]
    fn texts_are_whole_on_narrow_sheets() {
        for name in ["prm-rs", "a planner with a long name"] {
            let row = ForestRow {
                name: name.into(),
                difference: Some(Estimate { value: -0.68, interval: Some((-1.46, 0.11)) }),
                text: "-0.68 (-1.46 to 0.11)".into(),
                is_significant: false,
            };
            let drawing = ForestChart { titles: Titles::default(), rows: vec![row] }.draw(340.0);
            let texts = drawing.texts().collect::<Vec<_>>().join(" ");
            assert!(texts.contains(name) && texts.contains("-0.68 (-1.46 to 0.11)"), "{texts}");
        }
    }
}
