//! Numbers of agents that are many: each at the upper right of its agent where nothing else is, or nowhere, so that none jumps
//! from side to side in a film.
//!
//! Places are given out in turn: first to whom the viewer asked about, then to trucks that do something, to other trucks, and to
//! Wumpuses, each by number. So numbers cover neither each other nor agents nor fires, and which are written follows from the
//! frame alone. Of agents that are marks only those have one that the viewer asked about: the others have marks for several.

use crate::canvas::{Canvas, Ink, Point};
use crate::colours::{PAPER, agent_colour};
use crate::film::field::Pane;
use crate::film::field::agents::drawn_reach;
use crate::film::field::highlights::{is_selected, selected_reach};
use crate::film::field::scales::length_bar_room;
use crate::film::lettering::{LetterStyle, Lettering};
use crate::font::Weight;
use crate::text::{Align, measure_weighted};
use wildfire_timeline::{Activity, AgentId};

/// All in thin lines: height of digits, what is around them on their plate, and between a plate and its agent.
const TEXT: f32 = 8.0;
const PADDING: f32 = 2.0;
const GAP: f32 = 1.0;
/// How much a plate hides.
const PLATE: f32 = 0.8;

/// A rectangle in a pane, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LabelBox {
    left: f32,
    top: f32,
    right: f32,
    bottom: f32,
}

impl LabelBox {
    fn about((x, y): Point, half: f32) -> Self {
        Self { left: x - half, top: y - half, right: x + half, bottom: y + half }
    }

    /// Beside a place, that far from it. The corner of a label comes as near as the middles of its sides would: agents are round.
    fn beside((x, y): Point, reach: f32, (width, height): (f32, f32)) -> Self {
        let left = x + 0.75 * reach;
        let bottom = y - 0.75 * reach;
        Self { left, top: bottom - height, right: left + width, bottom }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }
}

/// Returns which labels are written in a pane of that size: each keeps free of what is taken and of those before it.
fn written(size: (f32, f32), taken: &[LabelBox], wanted: &[LabelBox]) -> Vec<bool> {
    let mut placed: Vec<LabelBox> = Vec::new();
    wanted
        .iter()
        .map(|label: &LabelBox| {
            let is_inside = label.left >= 0.0 && label.top >= 0.0 && label.right <= size.0 && label.bottom <= size.1;
            let is_free = is_inside && !taken.iter().chain(&placed).any(|other| label.overlaps(other));
            placed.extend(is_free.then_some(*label));
            is_free
        })
        .collect()
}

/// Writes the numbers of agents where there is room for them; none is to lie over those fires.
pub fn draw_labels(canvas: &mut Canvas, pane: &Pane, lettering: &mut Lettering, fires: &[Point]) {
    let unit = pane.unit();
    let width = pane.size.0 as f32;
    let height = pane.size.1 as f32;
    let agents = pane.setting().agents.iter().zip(&pane.view.state.agents);
    let mut shown: Vec<(AgentId, Point, f32, Activity)> = agents
        .map(|(start, state)| {
            let selected = selected_reach(pane, start).unwrap_or(0.0);
            let reach = drawn_reach(pane, &start.body).max(selected);
            (start.id, pane.at(start.body.centre(state.pose)), reach, state.activity)
        })
        .filter(|&(id, at, reach, activity)| {
            pane.is_near(at, reach) && (!pane.has_marks() || turn(pane, id, activity) == 0)
        })
        .collect();
    // The square in a disc of that radius: what is missing at its corners are edges.
    let bodies = shown.iter().map(|&(_, at, reach, _)| LabelBox::about(at, 0.75 * reach));
    let (bar_width, bar_height) = length_bar_room(pane);
    let bar = LabelBox { left: 0.0, top: height - bar_height, right: bar_width, bottom: height };
    let fire = (0.5 * pane.cell_side()).max(2.0 * unit);
    let taken = bodies.chain([bar]).chain(fires.iter().map(|&at| LabelBox::about(at, fire))).collect::<Vec<_>>();
    shown.sort_by_key(|&(id, _, _, activity)| (turn(pane, id, activity), id));
    let size = |id: AgentId| {
        let width = measure_weighted(&id.number.to_string(), TEXT * unit, Weight::Bold) + 2.0 * PADDING * unit;
        (width, (TEXT + 2.0 * PADDING) * unit)
    };
    let wanted = shown.iter().map(|&(id, at, reach, _)| LabelBox::beside(at, reach + GAP * unit, size(id)));
    let wanted: Vec<LabelBox> = wanted.collect();
    for ((is_written, &label), &(id, ..)) in written((width, height), &taken, &wanted).iter().zip(&wanted).zip(&shown) {
        if *is_written {
            draw_label(canvas, lettering, (id, label), unit);
        }
    }
}

/// The turn in which an agent gets a place for its number, the least first.
fn turn(pane: &Pane, id: AgentId, activity: Activity) -> u8 {
    match activity {
        _ if is_selected(pane, id) || pane.view.options.followed_agent() == Some(id) => 0,
        Activity::Standing if id.role.suppresses() => 2,
        _ if id.role.suppresses() => 1,
        _ => 3,
    }
}

fn draw_label(canvas: &mut Canvas, lettering: &mut Lettering, (id, label): (AgentId, LabelBox), unit: f32) {
    let [left, top, right, bottom] = [label.left, label.top, label.right, label.bottom].map(|at| at.round() as i32);
    canvas.tint_pixels((left, top), (right, bottom), Ink { colour: PAPER, opacity: PLATE });
    let style = LetterStyle { height: TEXT * unit, weight: Weight::Bold, colour: agent_colour(id) };
    let at = (label.left + PADDING * unit, label.bottom - PADDING * unit);
    lettering.draw(canvas, &id.number.to_string(), at, Align::Left, style);
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    #[test]
    fn labels_are_left_out_only_where_something_lies_or_the_pane_ends() {
        let mut rng = rng::stream(1, "picture/labels");
        for count in [1, 20, 200, 1000] {
            let mut point = || (rng.random_range(-20.0_f32..660.0), rng.random_range(-20.0_f32..500.0));
            let places: Vec<Point> = (0..count).map(|_| point()).collect();
            let taken: Vec<LabelBox> = places.iter().map(|&at| LabelBox::about(at, 5.0)).collect();
            let wanted: Vec<LabelBox> = places.iter().map(|&at| LabelBox::beside(at, 8.0, (16.0, 12.0))).collect();
            let is_written = written((640.0, 480.0), &taken, &wanted);
            for (index, label) in wanted.iter().enumerate() {
                let before = wanted[..index].iter().zip(&is_written).filter(|(_, is_written)| **is_written);
                let is_free = !taken.iter().chain(before.map(|(other, _)| other)).any(|other| label.overlaps(other));
                let is_inside = label.left >= 0.0 && label.top >= 0.0 && label.right <= 640.0 && label.bottom <= 480.0;
                assert_eq!(is_written[index], is_free && is_inside, "{label:?}");
            }
        }
    }

    #[test]
    fn a_label_lies_at_the_upper_right_of_its_agent() {
        let label = LabelBox::beside((100.0, 100.0), 8.0, (16.0, 12.0));
        assert!(label.left > 100.0 && label.bottom < 100.0, "{label:?}");
    }
}
