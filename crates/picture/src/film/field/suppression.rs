//! Suppressing trucks: their reach, the jet of water, and the elapsed share of the stop.

use std::f64::consts::TAU;

use crate::canvas::{Canvas, Ink, Pen, Point};
use crate::colours::{EXTINGUISHED, INK, PAPER, WATER};
use crate::film::field::Pane;
use crate::film::field::lines::{Dashes, draw_visible_line};
use crate::marks::to_f32;
use wildfire_base::geometry::{Cell, DVec2, ops};
use wildfire_timeline::{Activity, Body, SuppressionSpan};

/// Drops of the jet, in pixels, and how fast they fly: pixels in a simulated second.
const DROP: f64 = 7.0;
const DROPS_PER_SECOND: f64 = 60.0;
const MIN_JET: f32 = 2.0;
/// Width of a full jet in metres.
const JET_M: f64 = 0.4;
/// Chords of a full ring.
const CHORDS: f64 = 60.0;

/// Draws reach, jet and progress of every truck that suppresses.
pub fn draw_suppressions(canvas: &mut Canvas, pane: &Pane) {
    let (run, state) = (pane.view.run, pane.view.state);
    for (index, agent) in state.agents.iter().enumerate() {
        let stop = run.index().stop_at(index, state.time).filter(|_| agent.activity == Activity::Suppressing);
        let (Some(SuppressionSpan { since, cell, lasts }), Body::Truck(body)) =
            (stop, pane.setting().agents[index].body)
        else {
            continue;
        };
        let centre = body.body_centre(agent.pose);
        draw_reach(canvas, pane, centre);
        draw_jet(canvas, pane, centre, cell);
        let share = state.time.since(since).as_seconds() / lasts.as_seconds();
        draw_progress(canvas, pane, cell, share.clamp(0.0, 1.0));
    }
}

fn draw_reach(canvas: &mut Canvas, pane: &Pane, centre: DVec2) {
    if let Some(reach_m) = pane.setting().rules.suppression_reach_m {
        let at = pane.at(centre);
        let radius = pane.projection.length(reach_m);
        canvas.fill_disc_with(at, radius, Ink { colour: WATER, opacity: 0.1 });
        canvas.ring(at, radius, &Pen { ink: Ink { colour: WATER, opacity: 0.8 }, width: 1.5 * pane.unit() });
    }
}

fn draw_jet(canvas: &mut Canvas, pane: &Pane, from: DVec2, cell: Cell) {
    // It ends where the flames begin, which stay to be seen.
    let to = pane.frame().centre(cell);
    let short = 0.4 * pane.frame().cell_m / (to - from).length();
    let line = [from, to - (to - from) * short.min(1.0)].map(|point| pane.projection.place(point));
    let width = pane.projection.length(JET_M).max(MIN_JET * pane.unit());
    let flown = pane.view.state.time.as_seconds() * DROPS_PER_SECOND % (2.0 * DROP);
    let drops = Dashes { length: DROP, gap: DROP, offset: 2.0 * DROP - flown };
    draw_visible_line(canvas, pane, &line, Pen::opaque(WATER, width + 2.0), None);
    draw_visible_line(canvas, pane, &line, Pen::opaque(EXTINGUISHED, width), None);
    draw_visible_line(canvas, pane, &line, Pen::opaque(PAPER, width), Some(drops));
}

/// A ring that fills clockwise from the top.
fn draw_progress(canvas: &mut Canvas, pane: &Pane, cell: Cell, share: f64) {
    let at = pane.cell_centre(cell);
    let radius = (0.8 * pane.cell_side()).clamp(9.0 * pane.unit(), 60.0 * pane.unit());
    let width = (0.2 * radius).max(3.5);
    canvas.ring(at, radius, &Pen::opaque(INK, width + 2.0));
    canvas.ring(at, radius, &Pen::opaque(PAPER, width));
    canvas.trace(&arc(at, radius, share), &Pen::opaque(WATER, width));
}

fn arc((x, y): Point, radius: f32, share: f64) -> Vec<Point> {
    let chords = (CHORDS * share).ceil().max(1.0);
    (0..=chords as u32)
        .map(|chord: u32| {
            let (sin, cos) = ops::sin_cos(TAU * share * f64::from(chord) / chords);
            (x + radius * to_f32(sin), y - radius * to_f32(cos))
        })
        .collect()
}
