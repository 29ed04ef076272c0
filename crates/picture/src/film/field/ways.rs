//! The paths of agents: those driven recently and those planned.

use crate::canvas::{Canvas, Ink, Pen};
use crate::colours::{PAPER, Rgb, agent_colour};
use crate::film::field::Pane;
use crate::film::field::lines::{Dashes, draw_visible_line};
use crate::thin_line::draw_line;
use wildfire_base::geometry::{Cell, DVec2, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;
use wildfire_base::vehicle::Segment;

/// The time in which what was driven fades away, and the number of steps: fewer of agents that are marks, which are many.
const FADES_IN: SimTime = SimTime::from_nanos(120_000_000_000);
const FADING_STEPS: u64 = 12;
const MARKED_FADING_STEPS: u64 = 4;
const FRESH: f32 = 0.8;
const STALE: f32 = 0.12;

const WIDTH: f32 = 2.0;
/// Dash and gap in pixels, forward and in reverse.
const FORWARD: (f64, f64) = (8.0, 5.0);
const REVERSE: (f64, f64) = (2.0, 3.0);

/// Planned ways of agents that are marks: width, opacity of a truck's and of a Wumpus's, dash and gap, and half the side of a
/// goal's mark. They are many, and lie over fires and each other.
const MARKED_WIDTH: f32 = 1.0;
const MARKED_TRUCK: f32 = 0.9;
const MARKED_WUMPUS: f32 = 0.35;
const MARKED_DASHES: (f64, f64) = (4.0, 3.0);
const MARKED_GOAL: f32 = 3.0;

/// The chord of a drawn arc is nowhere farther from it than this, in pixels.
const TOLERANCE: f64 = 0.1;
/// Pieces of an arc, as far as that bound goes.
const MAX_PIECES: f64 = 2000.0;

/// A part of a way between changes of direction.
struct Stretch {
    is_reverse: bool,
    /// Metres from the beginning of the leg to the first point.
    from_m: f64,
    points: Vec<DVec2>,
}

/// Draws the ways of all agents.
pub fn draw_ways(canvas: &mut Canvas, pane: &Pane) {
    for agent in 0..pane.setting().agents.len() {
        draw_driven(canvas, pane, agent);
        draw_planned(canvas, pane, agent);
    }
}

/// The oldest part first, each step of age more faded.
fn draw_driven(canvas: &mut Canvas, pane: &Pane, agent: usize) {
    let (run, now) = (pane.view.run, pane.view.state.time);
    let width = WIDTH * pane.unit();
    let colour = agent_colour(pane.setting().agents[agent].id);
    let count = if pane.has_marks() { MARKED_FADING_STEPS } else { FADING_STEPS };
    // The oldest comes first, so the freshest part lies on top where paths cross.
    for step in (0..count).rev() {
        let ago = |steps: u64| now.since(SimTime::from_nanos(FADES_IN.as_nanos() / count * steps));
        let (from, to) = (ago(step + 1), ago(step));
        let opacity = FRESH + (STALE - FRESH) * step as f32 / (count - 1) as f32;
        for leg in run.index().legs_between(agent, from, to) {
            let trajectory = leg.trajectory(run.timeline());
            let window = [from.max(leg.from), to.min(leg.until)].map(|time| trajectory.distance_m(time));
            for stretch in stretches(trajectory, window, pane.projection.pixels_per_metre) {
                let dashes = stretch.is_reverse.then_some(REVERSE);
                draw_stretch(canvas, pane, &stretch, Pen { ink: Ink { colour, opacity }, width }, dashes);
            }
        }
    }
}

/// Dashes stay where they are on the ground while the agent comes along.
fn draw_planned(canvas: &mut Canvas, pane: &Pane, agent: usize) {
    let (run, state) = (pane.view.run, pane.view.state);
    let id = pane.setting().agents[agent].id;
    let colour = agent_colour(id);
    let opacity = if id.role.drives() { MARKED_TRUCK } else { MARKED_WUMPUS };
    let marked = pane.has_marks().then(|| Pen { ink: Ink { colour, opacity }, width: MARKED_WIDTH * pane.unit() });
    if let Some(goal) = state.agents[agent].goal {
        match &marked {
            Some(pen) => draw_small_goal(canvas, pane, goal, pen),
            None => draw_goal(canvas, pane, goal, colour),
        }
    }
    if let Some(leg) = run.index().leg_at(agent, state.time) {
        let trajectory = leg.trajectory(run.timeline());
        // Metres along the leg, from where the agent is now to the end.
        let window = [trajectory.distance_m(state.time), trajectory.distance_m(SimTime::MAX)];
        for stretch in stretches(trajectory, window, pane.projection.pixels_per_metre) {
            let dashes = if stretch.is_reverse { REVERSE } else { FORWARD };
            if let Some(pen) = marked {
                draw_stretch(canvas, pane, &stretch, pen, Some(MARKED_DASHES));
                continue;
            }
            // A pale line beneath keeps dashes visible on dark ground.
            let width = WIDTH * pane.unit();
            let halo = Pen { ink: Ink { colour: PAPER, opacity: 0.75 }, width: 2.0 * width };
            draw_stretch(canvas, pane, &stretch, halo, None);
            draw_stretch(canvas, pane, &stretch, Pen::opaque(colour, width), Some(dashes));
        }
    }
}

/// Marks the corners of the cell that an agent goes for.
fn draw_goal(canvas: &mut Canvas, pane: &Pane, goal: Cell, colour: Rgb) {
    let (x, y) = pane.cell_centre(goal);
    let half = (0.62 * pane.cell_side()).max(6.0 * pane.unit());
    let arm = 0.6 * half;
    for (right, down) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let corner = (x + right * half, y + down * half);
        let bracket = [(corner.0 - right * arm, corner.1), corner, (corner.0, corner.1 - down * arm)];
        canvas.trace(&bracket, &Pen::opaque(PAPER, 4.0 * pane.unit()));
        canvas.trace(&bracket, &Pen::opaque(colour, 2.0 * pane.unit()));
    }
}

/// Marks the cell that an agent goes for with a small square.
fn draw_small_goal(canvas: &mut Canvas, pane: &Pane, goal: Cell, pen: &Pen) {
    let (x, y) = pane.cell_centre(goal);
    let half = MARKED_GOAL * pane.unit();
    if pane.is_near((x, y), half) {
        let corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)];
        for (index, &corner) in corners.iter().enumerate() {
            draw_line(canvas, corner, corners[(index + 1) % 4], pen.width, pen.ink);
        }
    }
}

/// Returns the part of a leg between two marks, in metres from its beginning, sampled for that many pixels a metre.
fn stretches(leg: &Trajectory, [from_m, to_m]: [f64; 2], pixels_per_metre: f64) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut begins_m = 0.0;
    for (start, piece) in leg.pieces_with_starts() {
        let Some(segment) = piece.segment() else { continue };
        let length_m = segment.length_m.abs();
        let first = (from_m - begins_m).max(0.0);
        let last = (to_m - begins_m).min(length_m);
        if first < last {
            let is_reverse = segment.is_reverse();
            // A change of direction begins a new stretch, as reverse has dashes of its own.
            if stretches.last().is_none_or(|stretch| stretch.is_reverse != is_reverse) {
                let at = segment.pose_at(start, first.copysign(segment.length_m)).position();
                stretches.push(Stretch { is_reverse, from_m: begins_m + first, points: vec![at] });
            }
            let stretch = stretches.last_mut().expect("there is one by now");
            stretch.points.extend(sample(start, segment, (first, last), pixels_per_metre));
        }
        begins_m += length_m;
    }
    stretches
}

/// Points of a segment after `first` up to `last`, metres from its beginning, near enough for the eye: the middle of a
/// chord lies `r (1 - cos(a / 2))`, about `r a^2 / 8`, from an arc of radius `r` that turns by `a`.
fn sample(
    start: Pose,
    segment: Segment,
    (first, last): (f64, f64),
    pixels_per_metre: f64,
) -> impl Iterator<Item = DVec2> {
    let turn = (segment.curvature * (last - first)).abs();
    let radius = pixels_per_metre / segment.curvature.abs();
    let pieces = if segment.curvature == 0.0 {
        1.0
    } else {
        (turn * (radius / (8.0 * TOLERANCE)).sqrt()).ceil().clamp(1.0, MAX_PIECES)
    };
    (1..=pieces as u32).map(move |piece| {
        let along = first + (last - first) * f64::from(piece) / pieces;
        segment.pose_at(start, along.copysign(segment.length_m)).position()
    })
}

/// Dashes are counted from the beginning of the leg.
fn draw_stretch(canvas: &mut Canvas, pane: &Pane, stretch: &Stretch, pen: Pen, pattern: Option<(f64, f64)>) {
    let projection = &pane.projection;
    let line: Vec<DVec2> = stretch.points.iter().map(|&point| projection.place(point)).collect();
    let offset = stretch.from_m * projection.pixels_per_metre;
    let unit = f64::from(pane.unit());
    let dashes = pattern.map(|(length, gap)| Dashes { length: unit * length, gap: unit * gap, offset });
    draw_visible_line(canvas, pane, &line, pen, dashes);
}
