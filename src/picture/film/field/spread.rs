//! Rings about cells that spread their fire, at the moment of spreading, and lines to what catches fire from them.

use super::Pane;
use crate::picture::canvas::{Canvas, Ink, Pen};
use crate::picture::colours::{BURNING, Rgb};
use crate::picture::film::courses::Spread;
use crate::picture::thin_line::draw_line;
use crate::time::SimTime;

/// How long a ring grows and fades: a few frames of a run that is played 50 times as fast.
const LASTS: SimTime = SimTime::from_nanos(5_000_000_000);
const WIDTH: f32 = 3.0;
const LINE: Rgb = [158, 50, 0];

/// Draws what spread lately.
pub fn draw(canvas: &mut Canvas, pane: &Pane) {
    let now = pane.moment.state.time;
    for spread in pane.moment.run.courses().spreads_between(now.since(LASTS), now) {
        let share = (now.since(spread.time).as_seconds() / LASTS.as_seconds()) as f32;
        draw_spread(canvas, pane, spread, share);
    }
}

/// `share` of its time is over: rings slow down as they grow.
fn draw_spread(canvas: &mut Canvas, pane: &Pane, spread: &Spread, share: f32) {
    let centre = pane.cell_centre(spread.from);
    let left = 1.0 - share;
    let radius = pane.projection.length(radius_m(pane, spread));
    let unit = pane.unit();
    let ink = |colour: Rgb, opacity: f32| Ink { colour, opacity };
    for (behind, width) in [(0.85, 0.5 * WIDTH * unit), (1.0, WIDTH * unit)] {
        let radius = behind * radius * (1.0 - left * left);
        canvas.ring(centre, radius, &Pen { ink: ink(BURNING, left), width });
    }
    for &cell in &spread.caught {
        draw_line(canvas, centre, pane.cell_centre(cell), 1.6 * unit, ink(LINE, 0.8 * left));
    }
}

/// As the rules have it, or else as far as the farthest cell that caught fire.
fn radius_m(pane: &Pane, spread: &Spread) -> f64 {
    let setting = pane.setting();
    let distance_m = |cell| (setting.frame.centre(cell) - setting.frame.centre(spread.from)).length();
    let farthest_m = || spread.caught.iter().map(|&cell| distance_m(cell)).fold(0.0, f64::max);
    setting.rules.fire.map_or_else(farthest_m, |fire| fire.spread_radius_m)
}
