//! The wind at the time: an arrow along which it blows, its speed, and where it comes from.

use crate::canvas::{Canvas, Point};
use crate::colours::{FAINT_INK, INK, PAPER};
use crate::film::field::Pane;
use crate::film::field::scales::draw_plate;
use crate::text::{Align, draw_text, measure_text};
use wildfire_base::geometry::compass;

/// All in thin lines.
const MARGIN: f32 = 10.0;
const PADDING: f32 = 7.0;
const TEXT: f32 = 8.0;
const DIAL: f32 = 17.0;

const POINTS: [&str; 16] =
    ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];

/// Returns the point of the compass that is nearest to an azimuth.
pub fn compass_word(azimuth_deg: f64) -> &'static str {
    POINTS[(azimuth_deg / 22.5).round().rem_euclid(16.0) as usize]
}

/// Draws the wind at the upper right, where the run has weather.
pub fn draw_wind(canvas: &mut Canvas, pane: &Pane) {
    let Some(spread) = &pane.setting().spread else { return };
    let wind = spread.weather().at(pane.view.state.time).wind_mps;
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
