//! Flames on burning cells, their burning times, and rings around cells that spread fire.

use crate::canvas::{Canvas, Ink, Pen, Point};
use crate::colours::{BURNING, INK, PAPER, Rgb};
use crate::film::field::bushes::{BUSH_STAMPS, MIN_SPRITE, Stamps, scatter};
use crate::film::field::sprite::{FLAME_SPRITE, Placement};
use crate::film::field::{Layer, Pane};
use crate::text::{Align, draw_text, measure_text};
use crate::thin_line::draw_line;
use wildfire_base::time::SimTime;
use wildfire_timeline::{BushState, SpreadMoment};

/// Pictures of a flickering fire, shown in turn.
const FRAMES: usize = 8;
const FRAMES_PER_SECOND: f64 = 8.0;

/// The number of sizes in which a young fire grows, and the seconds that it takes.
const SIZES: usize = 6;
const GROWS_FOR_S: f64 = 4.0;
const SMALLEST: f32 = 0.45;

/// Cells with shorter sides than this, in pixels, have no room for a number.
const MIN_AGE: f32 = 22.0;

/// Tongues of a fire, the ones behind first: place of the foot in the cell, from its centre, and height; in cells.
const TONGUES: [(Point, f32); 4] =
    [((0.02, 0.02), 0.78), ((-0.27, -0.2), 0.66), ((0.27, -0.24), 0.6), ((0.02, -0.4), 0.74)];

/// The part by which a tongue is longer than at rest, and its lean to the right, in each picture.
const STRETCH: [f32; FRAMES] = [0.0, 0.10, 0.16, 0.06, -0.06, -0.12, -0.04, 0.08];
const LEAN: [f32; FRAMES] = [0.0, 0.08, 0.14, 0.16, 0.06, -0.06, -0.14, -0.08];

/// Draws the flames of all that burns, from north to south, and the seconds since ignition on them.
pub fn draw_flames(canvas: &mut Canvas, pane: &Pane, stamps: &mut Stamps) {
    let side = pane.cell_side();
    if side < MIN_SPRITE {
        return;
    }
    let state = pane.view.state;
    let mut ages = Vec::new();
    let shows_ages = pane.shows(Layer::Ages) && side >= MIN_AGE;
    // Flames go from north to south: one in front hides what is behind it.
    for (&cell, bush) in pane.setting().bushes.iter().zip(&state.bushes).rev() {
        let BushState::Burning { since } = *bush else { continue };
        let at = pane.cell_centre(cell);
        if !pane.is_near(at, side) {
            continue;
        }
        let age_s = state.time.since(since).as_seconds();
        // Neighbours flicker out of step, and half of them are mirrored.
        // The cell decides and not chance, so a picture of one moment is always the same.
        let offset = scatter(cell) as usize;
        let frame = ((state.time.as_seconds() * FRAMES_PER_SECOND) as usize).wrapping_add(offset) % FRAMES;
        let is_mirrored = (offset / FRAMES).is_multiple_of(2);
        // There are a few sizes only, so that each flame is drawn once and stamped from then on.
        let size = ((age_s / GROWS_FOR_S * (SIZES - 1) as f64) as usize).min(SIZES - 1);
        let grown = SMALLEST + (1.0 - SMALLEST) * size as f32 / (SIZES - 1) as f32;
        let number = BUSH_STAMPS + (frame * SIZES + size) * 2 + usize::from(is_mirrored);
        stamps.lay(canvas, at, number, |canvas, at, side| {
            let side_of_tongues = if is_mirrored { -side } else { side };
            draw_tongues(canvas, at, (grown * side_of_tongues, grown * side), frame);
        });
        ages.extend(shows_ages.then_some((at, age_s)));
    }
    // Over all flames, since those of the cell in front would hide them.
    ages.into_iter().for_each(|(at, age_s)| draw_age(canvas, at, side, age_s));
}

/// Draws the tongues of a fire about a place, scaled across and up, in one of its pictures.
pub fn draw_tongues(canvas: &mut Canvas, (x, y): Point, (across, up): (f32, f32), frame: usize) {
    for (index, &((right, above), height)) in TONGUES.iter().enumerate() {
        let stretch = STRETCH[(frame + 3 * index) % FRAMES];
        let lean = LEAN[(frame + 5 * index) % FRAMES];
        let foot = (x + right * across, y - above * up);
        let scale = (0.95 * height * across, height * (1.0 + stretch) * up);
        FLAME_SPRITE.draw(canvas, Placement::leaning(foot, scale, lean));
    }
}

fn draw_age(canvas: &mut Canvas, (x, y): Point, side: f32, age_s: f64) {
    let height = (0.24 * side).clamp(7.0, 18.0);
    let label = format!("{}", age_s as u64);
    let base = y + 0.46 * side;
    let half = 0.5 * measure_text(&label, height) + 0.35 * height;
    let top = base - 1.35 * height;
    let bottom = base + 0.35 * height;
    let plate = [(x - half, top), (x + half, top), (x + half, bottom), (x - half, bottom)];
    canvas.fill_through(&plate, INK, 0.72);
    draw_text(canvas, &label, (x, base), Align::Centre, height, PAPER);
}

/// The time in which a ring grows and fades: a few frames of a run that is played 50 times as fast.
const RING_LASTS: SimTime = SimTime::from_nanos(5_000_000_000);
const RING_WIDTH: f32 = 3.0;
const SPREAD_LINE: Rgb = [158, 50, 0];

/// Draws what spread lately.
pub fn draw_spreads(canvas: &mut Canvas, pane: &Pane) {
    let now = pane.view.state.time;
    for spread in pane.view.run.index().spreads_between(now.since(RING_LASTS), now) {
        let share = (now.since(spread.time).as_seconds() / RING_LASTS.as_seconds()) as f32;
        draw_spread(canvas, pane, spread, share);
    }
}

/// `share` of its time is over: rings slow down as they grow.
fn draw_spread(canvas: &mut Canvas, pane: &Pane, spread: &SpreadMoment, share: f32) {
    let centre = pane.cell_centre(spread.from);
    let left = 1.0 - share;
    let radius = pane.projection.length(radius_m(pane, spread));
    let unit = pane.unit();
    for (behind, width) in [(0.85, 0.5 * RING_WIDTH * unit), (1.0, RING_WIDTH * unit)] {
        let radius = behind * radius * (1.0 - left * left);
        canvas.ring(centre, radius, &Pen { ink: Ink { colour: BURNING, opacity: left }, width });
    }
    for &cell in &spread.caught {
        let ink = Ink { colour: SPREAD_LINE, opacity: 0.8 * left };
        draw_line(canvas, centre, pane.cell_centre(cell), 1.6 * unit, ink);
    }
}

/// Returns the radius of the rules, or where these are unknown the distance of the farthest cell that caught fire.
fn radius_m(pane: &Pane, spread: &SpreadMoment) -> f64 {
    let setting = pane.setting();
    if let Some(fire) = setting.rules.fire {
        return fire.spread_radius_m;
    }
    let from = setting.frame.centre(spread.from);
    spread.caught.iter().map(|&cell| (setting.frame.centre(cell) - from).length()).fold(0.0, f64::max)
}
