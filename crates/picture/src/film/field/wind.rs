//! The wind at the time: an arrow along which it blows, its speed, and where it comes from.

use crate::canvas::{Canvas, Point};
use crate::colours::{FAINT_INK, INK, PAPER};
use crate::film::field::Pane;
use crate::film::field::scales::draw_plate;
use crate::text::{Align, draw_text, measure_text};
use wildfire_base::geometry::{Cell, compass};
use wildfire_fire::WindField;

/// All in thin lines.
const MARGIN: f32 = 10.0;
const PADDING: f32 = 7.0;
const TEXT: f32 = 8.0;
const DIAL: f32 = 17.0;

/// Metres between arrows of wind by place, the least distance of two in thin lines, and half the length of the longest.
const ARROWS_APART_M: f64 = 100.0;
const MIN_ARROWS_APART: f32 = 24.0;
const MAX_ARROW: f32 = 14.0;

const POINTS: [&str; 16] =
    ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];

/// Returns the point of the compass that is nearest to an azimuth.
pub fn compass_word(azimuth_deg: f64) -> &'static str {
    POINTS[(azimuth_deg / 22.5).round().rem_euclid(16.0) as usize]
}

/// Draws the wind at the upper right, where the run has weather, and over the field where it differs from place to place.
pub fn draw_wind(canvas: &mut Canvas, pane: &Pane) {
    let Some(spread) = &pane.setting().spread else { return };
    let interval = spread.weather().interval_at(pane.view.state.time);
    if let Some(field) = spread.weather().wind_field(interval) {
        draw_wind_field(canvas, pane, field);
    }
    let wind = spread.weather().intervals()[interval].wind_mps;
    let speed = (wind.x * wind.x + wind.y * wind.y).sqrt();
    let unit = pane.unit();
    let [margin, padding, text, dial] = [MARGIN, PADDING, TEXT, DIAL].map(|length| length * unit);
    // Below this the speed would be printed as 0.0, with a direction that means nothing.
    let is_calm = speed < 0.05;
    let lines = if is_calm {
        ["calm".to_owned(), String::new()]
    } else {
        [format!("{speed:.1} m/s"), format!("from {}", compass_word(compass::azimuth_deg(-wind)))]
    };
    // As wide for every wind, so that it stays where it is when the wind turns.
    let width = 2.0 * padding + (2.0 * dial).max(measure_text("from WNW", text)).max(measure_text("88.8 m/s", text));
    let height = 2.0 * dial + 3.0 * padding + 2.7 * text;
    let left = pane.size.0 as f32 - margin - width;
    let top = margin;
    draw_plate(canvas, (left, top), (width, height));
    let centre = (left + 0.5 * width, top + padding + dial);
    canvas.fill_disc(centre, dial, FAINT_INK);
    canvas.fill_disc(centre, dial - unit, PAPER);
    // The notch marks north, which is up on the field.
    canvas.fill_rect(centre.0 - 0.75 * unit, centre.1 - dial, 1.5 * unit, 4.0 * unit, INK);
    if !is_calm {
        let right = (wind.x / speed) as f32;
        let up = (wind.y / speed) as f32;
        draw_arrow(canvas, centre, (right, up), 0.78 * dial);
    }
    for (line, content) in lines.iter().enumerate() {
        let base = top + 2.0 * (padding + dial) + text * (0.9 + 1.5 * line as f32);
        draw_text(canvas, content, (centre.0, base), Align::Centre, text, INK);
    }
}

/// Draws an arrow every hundred metres, or every few hundred where these would touch; the longest is of the fastest wind.
fn draw_wind_field(canvas: &mut Canvas, pane: &Pane, field: &WindField) {
    let frame = pane.frame();
    let unit = pane.unit();
    let mut apart_m = ARROWS_APART_M;
    while pane.cell_side() / frame.cell_m as f32 * apart_m as f32 <= MIN_ARROWS_APART * unit {
        apart_m += ARROWS_APART_M;
    }
    let step = ((apart_m / frame.cell_m).round() as usize).max(1);
    // Never 0, by which lengths would be divided in a calm.
    let fastest = field.speeds()[1].max(0.05);
    let half = 0.4 * pane.cell_side() * step as f32;
    for row in (step / 2..frame.rows.into()).step_by(step) {
        for col in (step / 2..frame.cols.into()).step_by(step) {
            let cell = Cell { col: col as u16, row: row as u16 };
            let wind = field.at(frame.index(cell));
            let speed = (wind.x * wind.x + wind.y * wind.y).sqrt();
            if speed < 0.05 {
                continue;
            }
            let toward = ((wind.x / speed) as f32, (wind.y / speed) as f32);
            let length = half * (0.3 + 0.7 * (speed / fastest) as f32);
            draw_arrow(canvas, pane.cell_centre(cell), toward, length.min(MAX_ARROW * unit));
        }
    }
}

/// An arrow about a place along a unit vector, to the right and up; `half` its length.
fn draw_arrow(canvas: &mut Canvas, (x, y): Point, (right, up): (f32, f32), half: f32) {
    let at =
        |along: f32, across: f32| (x + half * (along * right + across * up), y - half * (along * up - across * right));
    let corners = [(-1.0, -0.13), (0.15, -0.13), (0.15, -0.5), (1.0, 0.0), (0.15, 0.5), (0.15, 0.13), (-1.0, 0.13)];
    canvas.fill(&corners.map(|(along, across)| at(along, across)), INK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_have_compass_points() {
        let names = [0.0, 11.0, 12.0, 90.0, 225.0, 270.0, 348.0, 349.0, 360.0].map(compass_word);
        assert_eq!(names, ["N", "N", "NNE", "E", "SW", "W", "NNW", "N", "N"]);
    }
}
