//! Highlights: bushes that differ from the other run, and what the viewer selected with the mouse.

use crate::canvas::{Canvas, Ink, Pen};
use crate::colours::{INK, PAPER, Rgb};
use crate::film::camera::Projection;
use crate::film::field::agents::drawn_length;
use crate::film::field::{FieldView, Pane};
use crate::film::{RunView, Selected, ViewOptions};
use crate::thin_line::draw_line;
use wildfire_base::geometry::Cell;
use wildfire_timeline::{AgentId, AgentStart, Body, State};

/// Far from all colours of fire, bushes and agents.
const DIFFERENT: Rgb = [255, 0, 220];

/// Width of an outline in sides of a cell, and in pixels at least; it lies outside of what it is about.
const LINE: f32 = 0.1;
const MIN_LINE: f32 = 1.5;
/// Dark edges on both sides of an outline, in its widths, and in pixels at least.
const CASING: f32 = 0.3;
const MIN_CASING: f32 = 0.75;

/// Outlines areas of bushes whose state differs from that in the other run; on fields with other bushes none.
pub fn draw_differences(canvas: &mut Canvas, pane: &Pane) {
    let differing = differing(pane);
    if differing.is_empty() {
        return;
    }
    let frame = pane.frame();
    let mut differs = vec![false; frame.cell_count()];
    differing.iter().for_each(|&cell| differs[frame.index(cell)] = true);
    // A side between two differing bushes is inside of an area and stays free.
    let is_outside = |cell: Cell, (cols, rows): (i32, i32)| {
        !frame.offset(cell, cols, rows).is_some_and(|other| differs[frame.index(other)])
    };
    let width = (LINE * pane.cell_side()).max(MIN_LINE * pane.unit());
    let casing = (CASING * width).max(MIN_CASING * pane.unit());
    // The dark casing of all sides comes first, or that of one side would cut into the colour of the next.
    for (from, to, colour) in [(-casing, width + casing, INK), (0.0, width, DIFFERENT)] {
        for &cell in &differing {
            for side in [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().filter(|&side| is_outside(cell, side)) {
                draw_side(canvas, pane, (cell, side), (from, to), colour);
            }
        }
    }
}

fn differing(pane: &Pane) -> Vec<Cell> {
    let view = pane.view;
    let Some((rival, rival_state)) = view.rival else { return Vec::new() };
    let setting = pane.setting();
    let other = &rival.timeline().setting;
    if (setting.frame, &setting.bushes) != (other.frame, &other.bushes) {
        return Vec::new();
    }
    let kinds = view.state.bushes.iter().zip(&rival_state.bushes);
    let cells = setting.bushes.iter().zip(kinds);
    cells.filter(|(_, (here, there))| here.kind() != there.kind()).map(|(&cell, _)| cell).collect()
}

/// Draws a side of a cell, by the direction to the neighbour there, as a band between two distances outside the cell.
fn draw_side(canvas: &mut Canvas, pane: &Pane, (cell, side): (Cell, (i32, i32)), (from, to): (f32, f32), colour: Rgb) {
    let ((left, top), (right, bottom)) = pane.projection.cell(pane.frame(), cell);
    let [left, top, right, bottom] = [left, top, right, bottom].map(|at| at as f32);
    let outside = 0.5 * (from + to);
    let ends = match side {
        (1, _) => [(right + outside, top - to), (right + outside, bottom + to)],
        (-1, _) => [(left - outside, top - to), (left - outside, bottom + to)],
        (_, 1) => [(left - to, top - outside), (right + to, top - outside)],
        _ => [(left - to, bottom + outside), (right + to, bottom + outside)],
    };
    draw_line(canvas, ends[0], ends[1], to - from, Ink::opaque(colour));
}

/// Draws a frame about the bush, or a ring about the agent, that the viewer asked about.
pub fn draw_selected(canvas: &mut Canvas, pane: &Pane) {
    let selected = pane.view.options.selected.filter(|(run_index, _)| *run_index == pane.view.run_index);
    let halo = Pen::opaque(PAPER, 6.0 * pane.unit());
    let outline = Pen::opaque(INK, 3.0 * pane.unit());
    match selected {
        Some((_, Selected::Bush(cell))) => {
            let half = 0.5 * pane.cell_side() + 4.0 * pane.unit();
            let (x, y) = pane.cell_centre(cell);
            let corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)];
            // Once around and along the first side again, so that the first corner is joined too.
            let line = [corners[0], corners[1], corners[2], corners[3], corners[0], corners[1]];
            canvas.trace(&line, &halo);
            canvas.trace(&line, &outline);
        }
        Some((_, Selected::Agent(agent))) => {
            if let Some(index) = pane.setting().agent_index(agent) {
                let start = &pane.setting().agents[index];
                let state = &pane.view.state.agents[index];
                let at = pane.at(start.body.centre(state.pose));
                let radius = ring_radius(pane, &start.body);
                canvas.ring(at, radius, &halo);
                canvas.ring(at, radius, &outline);
            }
        }
        None => {}
    }
}

/// The radius of the ring about a selected agent.
fn ring_radius(pane: &Pane, body: &Body) -> f32 {
    0.6 * drawn_length(pane, body) + 7.0 * pane.unit()
}

/// Returns whether the viewer asked about an agent of this run.
pub fn is_selected(pane: &Pane, agent: AgentId) -> bool {
    pane.view.options.selected == Some((pane.view.run_index, Selected::Agent(agent)))
}

/// Returns how far the ring about an agent reaches from its middle, in pixels, if the viewer asked about it.
pub fn selected_reach(pane: &Pane, start: &AgentStart) -> Option<f32> {
    is_selected(pane, start.id).then(|| ring_radius(pane, &start.body) + 3.0 * pane.unit())
}

/// The number of pixels beyond an agent's body from which it is hit.
const GENEROUS: f32 = 6.0;

/// Returns what is drawn at a place of a run's pane, `size` in pixels: the nearest agent, if its body is no more than a
/// few pixels away, or else a bush.
pub fn pick(run: &RunView, state: &State, options: &ViewOptions, size: (u32, u32), at: (f64, f64)) -> Option<Selected> {
    let view = FieldView { run, state, rival: None, run_index: 0, options };
    let pane = Pane { view: &view, projection: Projection::from_options(run, state, options, size), size };
    agent_at(&pane, at).or_else(|| {
        let cell = pane.frame().cell_at(pane.projection.world(at))?;
        pane.setting().bush_index(cell).map(|_| Selected::Bush(cell))
    })
}

fn agent_at(pane: &Pane, (x, y): (f64, f64)) -> Option<Selected> {
    let agents = pane.setting().agents.iter().zip(&pane.view.state.agents);
    let hit = agents.filter_map(|(start, state)| {
        let (agent_x, agent_y) = pane.at(start.body.centre(state.pose));
        let right = x - f64::from(agent_x);
        let down = y - f64::from(agent_y);
        let distance = (right * right + down * down).sqrt();
        let reach = f64::from(0.5 * drawn_length(pane, &start.body) + GENEROUS);
        (distance <= reach).then_some((distance, start.id))
    });
    hit.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id)| Selected::Agent(id))
}
