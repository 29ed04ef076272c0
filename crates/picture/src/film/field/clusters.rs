//! Clusters, where cells are too small to see: agents close together as one mark with their number, fires as one glow.
//!
//! Neighbours share a square of a lattice fixed to the field, so that moving the view does not regroup them.

use std::collections::BTreeMap;

use crate::canvas::{Canvas, Ink, Point};
use crate::colours::{BURNING, PAPER, Rgb, bush_colour};
use crate::film::field::Pane;
use crate::film::lettering::{LetterStyle, Lettering};
use crate::font::Weight;
use crate::text::Align;
use wildfire_base::geometry::DVec2;
use wildfire_fire::BushStateKind;
use wildfire_timeline::Role;

/// All in thin lines. Side of a square of the lattice for agents; half a mark of one agent, what twice as many add to it, its
/// pale edge, and the height of its number.
const AGENT_SQUARE: f32 = 56.0;
const HALF_MARK: f32 = 6.0;
const PER_DOUBLING: f32 = 1.6;
const EDGE: f32 = 1.0;
const TEXT: f32 = 8.0;

/// Of the lattice for fires; radius of the glow of one bush, and what twice as many add to it.
const FIRE_SQUARE: f32 = 12.0;
const GLOW: f32 = 5.0;
const GLOW_PER_DOUBLING: f32 = 1.6;
/// The opacity of a glow, the share of its radius that its core has, and the opacity of that.
const OPACITY: f32 = 0.45;
const CORE: f32 = 0.5;
const CORE_OPACITY: f32 = 0.9;
/// No glow where bushes that fire has changed take more than this share of a square: there they are seen by themselves.
const SEEN: f32 = 0.1;
/// A bush that burns counts as many times in the colour of a glow.
const BURNING_COUNTS: u32 = 4;

/// What lies close together.
#[derive(Debug)]
pub struct Cluster<T> {
    /// The mean of their places in the pane.
    pub at: Point,
    pub members: Vec<T>,
}

/// Returns the squares that have places, in order of rows and columns. The lattice is shifted by a share of a square.
fn clusters<T>(pane: &Pane, (square, shift): (f32, f64), places: impl Iterator<Item = (DVec2, T)>) -> Vec<Cluster<T>> {
    let side = f64::from(square * pane.unit());
    // The lattice is fixed to the field, so that clusters stay together while the view moves.
    let origin = pane.projection.place(DVec2::ZERO);
    let mut squares: BTreeMap<(i32, i32), (DVec2, Vec<T>)> = BTreeMap::new();
    for (point, what) in places {
        let place = pane.projection.place(point);
        let [col, row] = ((place - origin) / side + shift).floor().to_array().map(|at| at as i32);
        let (sum, there) = squares.entry((row, col)).or_default();
        *sum += place;
        there.push(what);
    }
    let clusters = squares.into_values().map(|(sum, members)| {
        let at = (sum / members.len() as f64).as_vec2().into();
        Cluster { at, members }
    });
    clusters.collect()
}

/// Returns the agents of a role that are close together, by their places in the setting.
pub fn agent_clusters(pane: &Pane, role: Role) -> Vec<Cluster<usize>> {
    let agents = pane.setting().agents.iter().zip(&pane.view.state.agents).enumerate();
    let places = agents.filter(|(_, (start, _))| start.id.role == role);
    // Marks of both roles are to hide each other seldom.
    let shift = if role.drives() { 0.0 } else { 0.5 };
    clusters(pane, (AGENT_SQUARE, shift), places.map(|(index, (start, state))| (start.body.centre(state.pose), index)))
}

/// Draws how many agents are about a place: trucks as a square, Wumpuses as a disc.
pub fn draw_cluster(
    canvas: &mut Canvas,
    pane: &Pane,
    lettering: &mut Lettering,
    at: Point,
    count: usize,
    role: Role,
    colour: Rgb,
) {
    let unit = pane.unit();
    let half = (HALF_MARK + PER_DOUBLING * count.max(1).ilog2() as f32) * unit;
    if !pane.is_near(at, half + EDGE * unit) {
        return;
    }
    for (reach, colour) in [(half + EDGE * unit, PAPER), (half, colour)] {
        if role.drives() {
            canvas.fill_rect(at.0 - reach, at.1 - reach, 2.0 * reach, 2.0 * reach, colour);
        } else {
            canvas.fill_disc(at, 1.1 * reach, colour);
        }
    }
    let style = LetterStyle { height: TEXT * unit, weight: Weight::Bold, colour: PAPER };
    lettering.draw(canvas, &count.to_string(), (at.0, at.1 + 0.5 * TEXT * unit), Align::Centre, style);
}

/// Draws a glow about bushes close together that fire has changed, the larger the more they are, whose core has the mean colour
/// of their states.
pub fn draw_glows(canvas: &mut Canvas, pane: &Pane) {
    let bushes = pane.setting().bushes.iter().zip(&pane.view.state.bushes);
    let changed = bushes.map(|(&cell, bush)| (cell, bush.kind())).filter(|(_, kind)| *kind != BushStateKind::Intact);
    let places = changed.map(|(cell, kind)| (pane.frame().centre(cell), kind));
    let side = FIRE_SQUARE * pane.unit() / pane.cell_side();
    let max = SEEN * side * side;
    for Cluster { at, members: kinds } in clusters(pane, (FIRE_SQUARE, 0.0), places) {
        let radius = (GLOW + GLOW_PER_DOUBLING * kinds.len().ilog2() as f32) * pane.unit();
        if (kinds.len() as f32) < max && pane.is_near(at, radius) {
            draw_glow(canvas, at, radius, mean_colour(&kinds));
        }
    }
}

/// Draws a glow with a core of a colour.
pub fn draw_glow(canvas: &mut Canvas, at: Point, radius: f32, core: Rgb) {
    canvas.fill_disc_with(at, radius, Ink { colour: BURNING, opacity: OPACITY });
    canvas.fill_disc_with(at, CORE * radius, Ink { colour: core, opacity: CORE_OPACITY });
}

fn mean_colour(kinds: &[BushStateKind]) -> Rgb {
    let all: u32 = kinds.iter().map(|&kind| weight(kind)).sum();
    let channel = |channel: usize| {
        let sum: u32 = kinds.iter().map(|&kind| weight(kind) * u32::from(bush_colour(kind)[channel])).sum();
        (sum / all) as u8
    };
    std::array::from_fn(channel)
}

fn weight(kind: BushStateKind) -> u32 {
    if kind == BushStateKind::Burning { BURNING_COUNTS } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Picture;
    use crate::colours::{BURNED_OUT, INK, WUMPUS};
    use crate::film::field::tests::setting;
    use crate::film::{FrameRequest, RunView, ViewOptions, still};
    use wildfire_base::geometry::{Cell, Pose};
    use wildfire_base::time::SimTime;
    use wildfire_timeline::{AgentId, AgentStart, Body, Cause, Event, Fact, FireFact, Timeline};

    const SIZE: (u32, u32) = (600, 600);

    /// A field of 1000 by 1000 cells with a bush in its middle that burns for a minute from the start, and twelve Wumpuses in
    /// one place.
    fn picture_at(time_s: f64) -> Picture {
        let mut setting = setting();
        (setting.frame.cols, setting.frame.rows) = (1000, 1000);
        let cell = Cell { col: 500, row: 500 };
        setting.bushes = vec![cell];
        let start = |number| AgentStart {
            id: AgentId::wumpus(number),
            pose: Pose::new(1200.0, 3800.0, 0.0),
            body: Body::Square { size_m: 2.0 },
            limits: None,
        };
        setting.agents = (0..12).map(start).collect();
        let at = |time_s: f64, fact| Event { time: SimTime::from_seconds(time_s), fact: Fact::Fire(fact) };
        let events =
            vec![at(0.0, FireFact::Ignited { cell, cause: Cause::Scheduled }), at(60.0, FireFact::BurnedOut { cell })];
        let run = RunView::new(Timeline { setting, events, ground: Vec::new() }, None);
        let time = SimTime::from_seconds(time_s);
        let options = ViewOptions::default();
        let request = FrameRequest { runs: &[&run], time, options: &options };
        still(&request, SIZE)
    }

    /// The number of pixels of the field's pane that come near to a colour.
    fn count(picture: &Picture, colour: Rgb) -> usize {
        let is_near = |pixel: Rgb| pixel.iter().zip(colour).all(|(&one, other)| one.abs_diff(other) < 24);
        let places = (0..400).flat_map(|y| (0..380).map(move |x| (x, y)));
        places.filter(|&(x, y)| is_near(picture.pixel(x, y))).count()
    }

    #[test]
    fn one_fire_on_a_field_of_a_million_cells_is_seen_while_it_burns_and_afterwards() {
        assert!(count(&picture_at(30.0), BURNING) >= 16, "it burns");
        let later = picture_at(90.0);
        assert!(count(&later, BURNING) == 0 && count(&later, BURNED_OUT) >= 6, "{}", count(&later, BURNED_OUT));
    }

    #[test]
    fn agents_in_one_place_are_one_mark_with_their_number() {
        let picture = picture_at(30.0);
        assert!(count(&picture, WUMPUS) > 150, "{}", count(&picture, WUMPUS));
        // The number is written on it, and no other number about it.
        assert!(count(&picture, PAPER) > 20 && count(&picture, INK) < 60);
    }
}
