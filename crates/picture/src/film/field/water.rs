//! The places where trucks refill their tanks.

use crate::canvas::{Canvas, Ink, Pen};
use crate::colours::{PAPER, WATER};
use crate::film::field::Pane;

/// Half the width of the drop in thin lines, and of one that has to leave marks of agents to be seen.
const DROP: f32 = 6.0;
const SMALL_DROP: f32 = 2.5;
/// How far its tip is above the middle of its round part, in half widths.
const TIP: f32 = 2.2;

/// Draws each place as a drop, with the circle in which the middle of a truck has to be.
pub fn draw_water(canvas: &mut Canvas, pane: &Pane) {
    let Some(water) = &pane.setting().water else { return };
    let unit = pane.unit();
    let reach = pane.projection.length(water.reach_m);
    let half = if pane.has_marks() { SMALL_DROP } else { DROP } * unit;
    for &place in &water.places {
        let at = pane.at(place);
        if !pane.is_near(at, reach.max(TIP * half)) {
            continue;
        }
        // A circle that the drop would cover says nothing.
        if reach > half {
            canvas.fill_disc_with(at, reach, Ink { colour: WATER, opacity: 0.1 });
            canvas.ring(at, reach, &Pen { ink: Ink { colour: WATER, opacity: 0.6 }, width: unit });
        }
        for (half, colour) in [(half + 1.5 * unit, PAPER), (half, WATER)] {
            let (x, y) = at;
            // Straight sides from the tip touch the circle where its radius is at a right angle to them.
            let up = half / TIP;
            let across = half * (1.0 - 1.0 / (TIP * TIP)).sqrt();
            canvas.fill(&[(x, y - TIP * half), (x + across, y - up), (x - across, y - up)], colour);
            canvas.fill_disc(at, half, colour);
        }
    }
}
