//! What lies under the mouse.

use super::agents::drawn_length;
use super::{Moment, Pane};
use crate::picture::film::camera::Projection;
use crate::picture::film::{RunView, Selected, ViewOptions};
use crate::timeline::State;

/// Agents are hit from so many pixels beyond their bodies.
const GENEROUS: f32 = 6.0;

/// What is drawn at a place of a run's pane, `size` in pixels: the nearest agent, if its body is no more than a few
/// pixels away, or else a bush.
pub fn pick(run: &RunView, state: &State, options: &ViewOptions, size: (u32, u32), at: (f64, f64)) -> Option<Selected> {
    let moment = Moment { run, state, rival: None, run_index: 0, options };
    let pane = Pane { moment: &moment, projection: Projection::from_options(run, state, options, size), size };
    agent_at(&pane, at).or_else(|| {
        let cell = pane.frame().cell_at(pane.projection.world(at))?;
        pane.setting().bush_index(cell).map(|_| Selected::Bush(cell))
    })
}

fn agent_at(pane: &Pane, (x, y): (f64, f64)) -> Option<Selected> {
    let agents = pane.setting().agents.iter().zip(&pane.moment.state.agents);
    let hit = agents.filter_map(|(start, state)| {
        let (agent_x, agent_y) = pane.at(start.body.centre(state.pose));
        let (right, down) = (x - f64::from(agent_x), y - f64::from(agent_y));
        let distance = (right * right + down * down).sqrt();
        let reach = f64::from(0.5 * drawn_length(pane, &start.body) + GENEROUS);
        (distance <= reach).then_some((distance, start.id))
    });
    hit.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id)| Selected::Agent(id))
}
