//! Scales: a bar in metres, and the bar of the displayed values.

use crate::canvas::{Canvas, Point};
use crate::colours::{INK, PAPER, Rgb};
use crate::field_map::MapScale;
use crate::film::field::Pane;
use crate::film::field::value_map::ValueMap;
use crate::marks::to_f32;
use crate::text::{Align, draw_text, measure_text};

/// All in thin lines.
const MARGIN: f32 = 10.0;
const TEXT: f32 = 8.0;
const PADDING: f32 = 6.0;
const LONGEST: f64 = 140.0;
const BAR_WIDTH: f32 = 12.0;
const BAR_HEIGHT: f32 = 110.0;
const TICK: f32 = 4.0;

/// The most that the plate of the length bar takes of a pane, its margin included: pixels from the left edge and from the lower.
pub fn length_bar_room(pane: &Pane) -> (f32, f32) {
    let unit = pane.unit();
    let longest = to_f32(LONGEST) * unit;
    (longest + (MARGIN + 2.0 * PADDING) * unit, (MARGIN + TEXT + 3.0 * PADDING) * unit)
}

/// A bar of a round length in metres, at the lower left.
pub fn draw_length_bar(canvas: &mut Canvas, pane: &Pane) {
    let unit = pane.unit();
    let [margin, text, padding] = [MARGIN, TEXT, PADDING].map(|length| length * unit);
    let longest = (LONGEST * f64::from(unit)).min(0.3 * f64::from(pane.size.0));
    let metres = round_length(longest / pane.projection.pixels_per_metre);
    let length = pane.projection.length(metres);
    let label = if metres < 1000.0 { format!("{metres} m") } else { format!("{} km", metres / 1000.0) };
    let width = length.max(measure_text(&label, text));
    let bottom = pane.size.1 as f32 - margin;
    let height = text + 3.0 * padding;
    draw_plate(canvas, (margin, bottom - height), (width + 2.0 * padding, height));
    let left = margin + padding;
    let line = bottom - padding;
    draw_text(canvas, &label, (left, line - padding - unit), Align::Left, text, INK);
    canvas.fill_rect(left, line - 2.0 * unit, length, 2.0 * unit, INK);
    for end in [left, left + length - 2.0 * unit] {
        canvas.fill_rect(end, line - 5.0 * unit, 2.0 * unit, 5.0 * unit, INK);
    }
}

/// The longest of 1, 2 or 5 times a power of ten that is not longer than `max`, if that lies between a tenth of a
/// millimetre and a million kilometres.
fn round_length(max: f64) -> f64 {
    let mut length = 1e-4;
    for factor in [2.0, 2.5, 2.0].into_iter().cycle().take(39) {
        if length * factor > max {
            break;
        }
        length *= factor;
    }
    // Products of such factors are rounded; the digits say what is meant.
    format!("{length:.0e}").parse().unwrap_or(length)
}

/// What a bar of colours shows.
pub struct ValueBar<'a> {
    name: &'a str,
    /// Labels, and where they are, as shares of the bar from below.
    labels: Vec<(f64, String)>,
    /// The colour at a share of the bar.
    shade: Box<dyn Fn(f64) -> Rgb + 'a>,
}

impl<'a> ValueBar<'a> {
    pub fn from_values(map: &'a ValueMap) -> Self {
        let scale = &map.scale;
        let labels = scale.ticks(5).into_iter().map(|tick| (scale.fraction(tick.value), tick.label));
        let shade = |share: f64| scale.colour(scale.low * (1.0 - share) + scale.high * share);
        Self { name: map.quantity.name(), labels: labels.collect(), shade: Box::new(shade) }
    }

    pub fn from_scale(scale: &'a MapScale) -> Self {
        let labels = scale.ticks.iter().map(|tick| (scale.fraction(tick.value), tick.label.clone()));
        Self { name: &scale.name, labels: labels.collect(), shade: Box::new(|share| scale.shade(share)) }
    }
}

/// A bar of colours with round values, at the lower right.
pub fn draw_value_bar(canvas: &mut Canvas, pane: &Pane, bar: &ValueBar) {
    let unit = pane.unit();
    let [margin, text, padding] = [MARGIN, TEXT, PADDING].map(|length| length * unit);
    let [bar_width, bar_height, mark] = [BAR_WIDTH, BAR_HEIGHT, TICK].map(|length| (length * unit).round());
    let name = bar.name;
    let labels = bar.labels.iter().map(|(_, label)| measure_text(label, text)).fold(0.0, f32::max);
    let width = measure_text(name, text).max(bar_width + 2.0 * mark + labels) + 2.0 * padding;
    let height = bar_height + 2.0 * text + 4.0 * padding;
    let right = pane.size.0 as f32 - margin;
    let bottom = pane.size.1 as f32 - margin;
    draw_plate(canvas, (right - width, bottom - height), (width, height));
    let left = (right - width + padding).round();
    let top = (bottom - padding - 0.5 * text - bar_height).round();
    draw_text(canvas, name, (left, bottom - height + padding + text), Align::Left, text, INK);
    draw_shades(canvas, bar, (left, top), (bar_width, bar_height));
    for (share, label) in &bar.labels {
        let y = top + bar_height * (1.0 - to_f32(*share));
        canvas.fill_rect(left + bar_width, y - 0.5 * unit, mark, unit, INK);
        let at = (left + bar_width + 2.0 * mark, y + 0.5 * text);
        draw_text(canvas, label, at, Align::Left, text, INK);
    }
}

fn draw_shades(canvas: &mut Canvas, bar: &ValueBar, (left, top): Point, (width, height): (f32, f32)) {
    let rows = height as i32;
    for row in 0..rows {
        let share = 1.0 - (f64::from(row) + 0.5) / f64::from(rows);
        let (x, y) = (left as i32, top as i32 + row);
        canvas.fill_pixels((x, y), (x + width as i32, y + 1), (bar.shade)(share));
    }
}

pub fn draw_plate(canvas: &mut Canvas, (left, top): Point, (width, height): (f32, f32)) {
    let (right, bottom) = (left + width, top + height);
    canvas.fill_through(&[(left, top), (right, top), (right, bottom), (left, bottom)], PAPER, 0.85);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_as_long_as_may_be() {
        for (max, expected) in [(49.9, 20.0), (50.0, 50.0), (0.3, 0.2), (7300.0, 5000.0), (1.0, 1.0), (0.01, 0.01)] {
            assert_eq!(round_length(max), expected, "of {max}");
        }
    }

    #[test]
    fn any_length_has_an_answer() {
        for max in [0.0, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
            assert!(round_length(max).is_finite());
        }
    }
}
