//! Numbers of agents that are many: each at the upper right of its agent where nothing else is, or nowhere, so that none jumps
//! from side to side in a film.
//!
//! Places are given out in turn: first to whom the viewer asked about, then to trucks that do something, to other trucks, and to
//! Wumpuses, each by number. So numbers cover neither each other nor agents nor fires, and which are written follows from the
//! frame alone. Of agents that are marks only those have one that the viewer asked about: the others have marks for several.

use crate::picture::canvas::{Canvas, Ink, Point};
use crate::picture::colours::{PAPER, agent_colour};
use crate::picture::film::field::Pane;
use crate::picture::film::field::agents::drawn_reach;
use crate::picture::film::field::highlights::{is_selected, selected_reach};
use crate::picture::film::field::scales::length_bar_room;
use crate::picture::film::lettering::{LetterStyle, Lettering};
use crate::picture::font::Weight;
use crate::picture::text::{Align, measure_weighted};
use crate::timeline::{Activity, AgentId};

/// All in thin lines: height of digits, what is around them on their plate, and between a plate and its agent.
const TEXT: f32 = 8.0;
const PADDING: f32 = 2.0;
const GAP: f32 = 1.0;
/// How much a plate hides.
const PLATE: f32 = 0.8;

/// A rectangle in a pane, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelBox {
    pub left: f32,
    pub top: f32,
    pub width: f32,
    pub height: f32,
}

impl LabelBox {
    fn about((x, y): Point, half: f32) -> Self {
        Self { left: x - half, top: y - half, width: 2.0 * half, height: 2.0 * half }
    }

    fn right(&self) -> f32 {
        self.left + self.width
    }

    fn bottom(&self) -> f32 {
        self.top + self.height
    }
}

/// What is taken of a pane, by squares of a few pixels.
pub struct FreeRoom {
    side: f32,
    columns: usize,
    taken: Vec<bool>,
    size: (f32, f32),
}

impl FreeRoom {
    /// A pane of that width and height where nothing is taken, in squares of that side; all in pixels.
    pub fn new((width, height): (f32, f32), side: f32) -> Self {
        let count = |length: f32| (length / side).ceil() as usize;
        Self { side, columns: count(width), taken: vec![false; count(width) * count(height)], size: (width, height) }
    }

    /// Takes a rectangle, as far as it is in the pane.
    pub fn take(&mut self, label: &LabelBox) {
        for square in self.squares(label) {
            self.taken[square] = true;
        }
    }

    /// Returns whether a rectangle is in the pane and nothing of it is taken.
    pub fn is_free(&self, label: &LabelBox) -> bool {
        let is_inside =
            label.left >= 0.0 && label.top >= 0.0 && label.right() <= self.size.0 && label.bottom() <= self.size.1;
        is_inside && self.squares(label).all(|square| !self.taken[square])
    }

    /// The squares that a rectangle touches.
    fn squares(&self, label: &LabelBox) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.taken.len() / self.columns.max(1));
        let range = |from: f32, to: f32, most: usize| {
            ((from / self.side).floor().max(0.0) as usize).min(most)
                ..((to / self.side).ceil().max(0.0) as usize).min(most)
        };
        let across = range(label.left, label.right(), columns);
        range(label.top, label.bottom(), rows)
            .flat_map(move |row| across.clone().map(move |column| row * columns + column))
    }
}

/// Returns where labels of those sizes come to lie beside their middles; each keeps free of what is taken and of those before it.
/// One for which there is no room has no place.
pub fn place_labels(room: &mut FreeRoom, wanted: &[(Point, f32, (f32, f32))]) -> Vec<Option<LabelBox>> {
    let place = |&((x, y), reach, (width, height)): &(Point, f32, (f32, f32))| {
        // The corner of a label comes as near as the middles of its sides would: the agent is round.
        let label = LabelBox { left: x + 0.75 * reach, top: y - 0.75 * reach - height, width, height };
        room.is_free(&label).then(|| room.take(&label)).map(|()| label)
    };
    wanted.iter().map(place).collect()
}

/// Writes the numbers of agents where there is room for them; none is to lie over those fires.
pub fn draw_labels(canvas: &mut Canvas, pane: &Pane, lettering: &mut Lettering, fires: &[Point]) {
    let unit = pane.unit();
    let mut room = FreeRoom::new((pane.size.0 as f32, pane.size.1 as f32), 2.0 * unit);
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
    for &(_, at, reach, _) in &shown {
        // The square in a disc of that radius: what is missing at its corners are edges.
        room.take(&LabelBox::about(at, 0.75 * reach));
    }
    let (width, height) = length_bar_room(pane);
    room.take(&LabelBox { left: 0.0, top: pane.size.1 as f32 - height, width, height });
    let fire = (0.5 * pane.cell_side()).max(2.0 * unit);
    fires.iter().for_each(|&at| room.take(&LabelBox::about(at, fire)));
    shown.sort_by_key(|&(id, _, _, activity)| (turn(pane, id, activity), id));
    let size = |id: AgentId| {
        let width = measure_weighted(&id.number.to_string(), TEXT * unit, Weight::Bold) + 2.0 * PADDING * unit;
        (width, (TEXT + 2.0 * PADDING) * unit)
    };
    let wanted: Vec<(Point, f32, (f32, f32))> =
        shown.iter().map(|&(id, at, reach, _)| (at, reach + GAP * unit, size(id))).collect();
    for (label, &(id, ..)) in place_labels(&mut room, &wanted).into_iter().zip(&shown) {
        if let Some(label) = label {
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
    let whole = |at: f32| at.round() as i32;
    let (from, to) = ((whole(label.left), whole(label.top)), (whole(label.right()), whole(label.bottom())));
    canvas.tint_pixels(from, to, Ink { colour: PAPER, opacity: PLATE });
    let style = LetterStyle { height: TEXT * unit, weight: Weight::Bold, colour: agent_colour(id) };
    let at = (label.left + PADDING * unit, label.bottom() - PADDING * unit);
    lettering.draw(canvas, &id.number.to_string(), at, Align::Left, style);
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::rng;

    fn overlap(one: &LabelBox, other: &LabelBox) -> bool {
        one.left < other.right() && other.left < one.right() && one.top < other.bottom() && other.top < one.bottom()
    }

    #[test]
    fn labels_overlap_neither_each_other_nor_what_is_taken() {
        let mut rng = rng::stream(1, "picture/labels");
        for count in [1, 20, 200, 1000] {
            let mut room = FreeRoom::new((640.0, 480.0), 2.0);
            let mut point = || (rng.random_range(-20.0_f32..660.0), rng.random_range(-20.0_f32..500.0));
            let taken: Vec<LabelBox> = (0..count).map(|_| LabelBox::about(point(), 5.0)).collect();
            taken.iter().for_each(|taken| room.take(taken));
            let wanted: Vec<(Point, f32, (f32, f32))> =
                taken.iter().map(|taken| ((taken.left + 5.0, taken.top + 5.0), 8.0, (16.0, 12.0))).collect();
            let placed = place_labels(&mut room, &wanted);
            let labels: Vec<LabelBox> = placed.iter().flatten().copied().collect();
            for (index, label) in labels.iter().enumerate() {
                assert!(label.left >= 0.0 && label.top >= 0.0 && label.right() <= 640.0 && label.bottom() <= 480.0);
                assert!(taken.iter().all(|taken| !overlap(label, taken)), "{label:?}");
                assert!(labels[..index].iter().all(|other| !overlap(label, other)), "{label:?}");
            }
            assert!(labels.len() * 6 >= count.min(200), "{} of {count}", labels.len());
        }
    }

    #[test]
    fn a_label_is_left_out_only_where_its_place_is_not_free() {
        let mut rng = rng::stream(2, "picture/labels");
        let wanted: Vec<(Point, f32, (f32, f32))> = (0..300)
            .map(|_| ((rng.random_range(0.0..300.0), rng.random_range(0.0..300.0)), 6.0, (14.0, 12.0)))
            .collect();
        let mut room = FreeRoom::new((300.0, 300.0), 2.0);
        let placed = place_labels(&mut room, &wanted);
        assert!(placed[0].is_some() && placed.iter().any(Option::is_none));
        for (label, wanted) in placed.iter().zip(&wanted) {
            // In the room that all have left.
            let again = place_labels(&mut FreeRoom { taken: room.taken.clone(), ..room }, &[*wanted]);
            assert!(label.is_some() || again[0].is_none(), "{wanted:?}");
        }
    }

    #[test]
    fn who_is_alone_has_its_label_at_the_upper_right() {
        let mut room = FreeRoom::new((200.0, 200.0), 2.0);
        let placed = place_labels(&mut room, &[((100.0, 100.0), 8.0, (16.0, 12.0))]);
        let label = placed[0].expect("there is room");
        assert!(label.left > 100.0 && label.bottom() < 100.0, "{label:?}");
    }
}
