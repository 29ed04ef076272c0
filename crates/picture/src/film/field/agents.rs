//! Agents to scale, with heading and steered wheels.

use crate::canvas::{Canvas, Pen, Point};
use crate::colours::{PAPER, UNIMOG, WUMPUS, agent_colour};
use crate::film::field::Pane;
use crate::film::field::clusters::{Cluster, agent_clusters, draw_cluster};
use crate::film::field::sprite::{Placement, UNIMOG_SPRITE, WHEEL_SPRITE, WUMPUS_SPRITE};
use crate::film::lettering::Lettering;
use crate::marks::to_f32;
use crate::text::{Align, draw_text, measure_text};
use wildfire_base::geometry::{DVec2, Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{Piece, Trajectory};
use wildfire_base::vehicle::Dimensions;
use wildfire_timeline::{Activity, AgentId, Body, Role};

/// Bodies shorter than this, in thin lines, are drawn this long, and a ring says so.
const MIN_WUMPUS: f32 = 13.0;
const MIN_UNIMOG: f32 = 18.0;

/// Marks of agents that are too many to be drawn as bodies, in thin lines: the length of a truck's, which points where it is
/// headed, the radius of a Wumpus's, and the width of the pale edge of both.
const MARK_LENGTH: f32 = 11.0;
const MARK_RADIUS: f32 = 3.4;
const MARK_EDGE: f32 = 1.0;

/// The size of the truck that the sprites are drawn for, in metres.
const DRAWN_LENGTH_M: f64 = 4.9;
const DRAWN_WIDTH_M: f64 = 2.2;
/// The distance of a wheel's middle from the middle of its axle, as a share of the body's half width.
const WHEEL_AT: f64 = 0.78;

/// Draws all agents, trucks over Wumpuses; of those that are marks, several close together as one.
pub fn draw_agents(canvas: &mut Canvas, pane: &Pane, lettering: &mut Lettering) {
    if !pane.has_marks() {
        (0..pane.setting().agents.len()).for_each(|index| draw_agent(canvas, pane, index));
        return;
    }
    for (role, colour) in [(Role::Wumpus, WUMPUS), (Role::Unimog, UNIMOG)] {
        for Cluster { at, members } in agent_clusters(pane, role) {
            match members.as_slice() {
                [alone] => draw_mark(canvas, pane, *alone),
                many => draw_cluster(canvas, pane, lettering, at, many.len(), role, colour),
            }
        }
    }
}

/// Draws an agent as a mark, which is hollow while it does nothing.
fn draw_mark(canvas: &mut Canvas, pane: &Pane, index: usize) {
    let start = &pane.setting().agents[index];
    let state = &pane.view.state.agents[index];
    let at = pane.at(start.body.centre(state.pose));
    let unit = pane.unit();
    if !pane.is_near(at, MARK_LENGTH * unit) {
        return;
    }
    let colour = agent_colour(start.id);
    let edge = MARK_EDGE * unit;
    let is_idle = state.activity == Activity::Standing;
    if let Body::Square { .. } = start.body {
        let radius = MARK_RADIUS * unit;
        canvas.fill_disc(at, radius + edge, PAPER);
        canvas.fill_disc(at, radius, colour);
        if is_idle {
            canvas.fill_disc(at, 0.55 * radius, PAPER);
        }
        return;
    }
    let (sin, cos) = ops::sin_cos(state.pose.heading);
    let (sin, cos) = (to_f32(sin), to_f32(cos));
    let arrow = |length: f32| {
        [(0.58, 0.0), (-0.42, 0.36), (-0.24, 0.0), (-0.42, -0.36)].map(|(along, across): (f32, f32)| {
            let along = along * length;
            let across = across * length;
            // Pixels count downwards, so north has a minus.
            (at.0 + along * cos - across * sin, at.1 - along * sin - across * cos)
        })
    };
    let length = MARK_LENGTH * unit;
    // A pale edge beneath, or marks of one colour that overlap would merge.
    canvas.fill(&arrow(length + 4.0 * edge), PAPER);
    canvas.fill(&arrow(length), colour);
    if is_idle {
        canvas.fill(&arrow(0.5 * length), PAPER);
    }
}

fn draw_agent(canvas: &mut Canvas, pane: &Pane, index: usize) {
    let start = &pane.setting().agents[index];
    let state = &pane.view.state.agents[index];
    let at = pane.at(start.body.centre(state.pose));
    let unit = pane.unit();
    let length = drawn_length(pane, &start.body);
    if !pane.is_near(at, length) {
        return;
    }
    // The ring tells that the body is drawn larger than it is.
    if length > true_length(pane, &start.body) {
        let radius = ring_radius(length, unit);
        canvas.ring(at, radius, &Pen::opaque(PAPER, 4.0 * unit));
        canvas.ring(at, radius, &Pen::opaque(agent_colour(start.id), 2.0 * unit));
    }
    match start.body {
        Body::Square { .. } => {
            WUMPUS_SPRITE.draw(canvas, Placement::turned(at, state.pose.heading, (length, length)));
        }
        Body::Truck(body) => {
            // The steered wheels follow the curvature of the leg, as a state has none.
            let scale = f64::from(length) / body.length_m;
            let leg = pane.view.run.index().leg_at(index, pane.view.state.time);
            let leg = leg.map(|leg| leg.trajectory(pane.view.run.timeline()));
            let curvature = leg.map_or(0.0, |leg| curvature_at(leg, pane.view.state.time));
            draw_truck(canvas, at, state.pose, &body, scale, curvature);
        }
    }
    // In crowded runs `draw_labels` writes the numbers, where it finds room.
    if !pane.view.run.is_crowded() && is_one_of_many(pane, start.id) {
        draw_number(canvas, at, (length, unit), start.id);
    }
}

/// The radius of the ring about a body that is drawn larger than it is.
fn ring_radius(length: f32, unit: f32) -> f32 {
    0.62 * length + 2.0 * unit
}

/// Returns how far an agent reaches from its middle as it is drawn, its ring included, in pixels.
pub fn drawn_reach(pane: &Pane, body: &Body) -> f32 {
    let length = drawn_length(pane, body);
    let unit = pane.unit();
    if pane.has_marks() || length <= true_length(pane, body) {
        0.5 * length + unit
    } else {
        ring_radius(length, unit) + 2.0 * unit
    }
}

/// Pixels from end to end of a body, or its mark, as it is drawn.
pub fn drawn_length(pane: &Pane, body: &Body) -> f32 {
    if pane.has_marks() {
        return pane.unit() * if let Body::Square { .. } = body { 2.0 * MARK_RADIUS } else { MARK_LENGTH };
    }
    let min = match body {
        Body::Square { .. } => MIN_WUMPUS,
        Body::Truck(_) => MIN_UNIMOG,
    };
    true_length(pane, body).max(min * pane.unit())
}

fn true_length(pane: &Pane, body: &Body) -> f32 {
    pane.projection.length(match body {
        Body::Square { size_m } => *size_m,
        Body::Truck(body) => body.length_m,
    })
}

/// `scale` in pixels a metre, `curvature` of the way of the rear axle.
fn draw_truck(canvas: &mut Canvas, (x, y): Point, pose: Pose, body: &Dimensions, scale: f64, curvature: f64) {
    let stretch = DVec2::new(body.length_m / DRAWN_LENGTH_M, body.width_m / DRAWN_WIDTH_M) * scale;
    let drawn = (to_f32(stretch.x), to_f32(stretch.y));
    let rear_axle = -body.centre_offset_m();
    // By the single-track model, as wheelbase times curvature is the tangent of the steering angle.
    let steering = ops::atan(body.wheelbase_m * curvature);
    for (along_m, angle) in [(rear_axle, 0.0), (rear_axle + body.wheelbase_m, steering)] {
        for side in [-0.5, 0.5] {
            let hub = DVec2::new(along_m, side * WHEEL_AT * body.width_m) * scale;
            let turned = Pose { x: 0.0, y: 0.0, ..pose }.transform(hub);
            let at = (x + to_f32(turned.x), y - to_f32(turned.y));
            WHEEL_SPRITE.draw(canvas, Placement::turned(at, pose.heading + angle, drawn));
        }
    }
    UNIMOG_SPRITE.draw(canvas, Placement::turned((x, y), pose.heading, drawn));
}

/// Curvature of the stretch that is driven; of the first one before it sets out, of the last one when it has arrived.
pub fn curvature_at(leg: &Trajectory, time: SimTime) -> f64 {
    let curvature = |piece: &Piece| piece.segment().map(|segment| segment.curvature);
    if time < leg.sets_out_at() {
        leg.pieces().iter().find_map(curvature).unwrap_or(0.0)
    } else if time >= leg.end_time() {
        leg.pieces().iter().rev().find_map(curvature).unwrap_or(0.0)
    } else {
        leg.pace_at(time).curvature
    }
}

fn is_one_of_many(pane: &Pane, id: AgentId) -> bool {
    pane.setting().agents.iter().filter(|agent| agent.id.role == id.role).count() > 1
}

fn draw_number(canvas: &mut Canvas, (x, y): Point, (length, unit): (f32, f32), id: AgentId) {
    let at = (x + 0.45 * length + 4.0 * unit, y - 0.45 * length);
    let label = id.number.to_string();
    let width = measure_text(&label, 8.0 * unit);
    canvas.fill_rect(at.0 - 2.0 * unit, at.1 - 10.0 * unit, width + 4.0 * unit, 12.0 * unit, agent_colour(id));
    draw_text(canvas, &label, at, Align::Left, 8.0 * unit, PAPER);
}
