//! Searches of planners: roadmaps, and the last search of each agent, if they were recorded.

use crate::canvas::{Canvas, Ink, Point};
use crate::colours::{Rgb, blend};
use crate::film::field::{Layer, Pane};
use crate::thin_line::draw_line;
use wildfire_base::query::{SearchGraph, SearchPhase};
use wildfire_timeline::FoundSearch;

/// The style in which a layer shows searches of one phase.
pub struct SearchStyle {
    pub layer: Layer,
    pub phase: SearchPhase,
    /// The colours of the first line and of the last one.
    pub colours: [Rgb; 2],
    /// In pixels.
    pub width: f32,
    pub opacity: f32,
    /// Radius of a disc at every place, in sides of a cell.
    pub disc: f32,
}

// Roadmaps have lines all over the field, one over the other: each is faint. Places of a Wumpus are cells.
pub const STYLES: [SearchStyle; 4] = [
    SearchStyle {
        layer: Layer::Roadmap,
        phase: SearchPhase::Roadmap,
        colours: [[52, 64, 92], [52, 64, 92]],
        width: 1.0,
        opacity: 0.2,
        disc: 0.0,
    },
    SearchStyle {
        layer: Layer::Query,
        phase: SearchPhase::Query,
        colours: [[0, 44, 84], [40, 140, 220]],
        width: 1.25,
        opacity: 0.8,
        disc: 0.0,
    },
    SearchStyle {
        layer: Layer::LocalSearch,
        phase: SearchPhase::Local,
        colours: [[74, 4, 20], [240, 118, 134]],
        width: 1.0,
        opacity: 0.7,
        disc: 0.0,
    },
    SearchStyle {
        layer: Layer::WumpusSearch,
        phase: SearchPhase::Walk,
        colours: [[46, 14, 70], [176, 112, 220]],
        width: 1.25,
        opacity: 0.8,
        disc: 0.16,
    },
];

/// A search that is shown.
pub struct ShownSearch<'a> {
    /// Its place among the facts.
    pub fact: usize,
    style: &'static SearchStyle,
    graph: &'a SearchGraph,
}

/// The searches that the layers ask for, all agents'.
pub(super) fn shown_searches<'a>(pane: &Pane<'a>) -> Vec<ShownSearch<'a>> {
    let run = pane.view.run;
    let time = pane.view.state.time;
    let styles = STYLES.iter().filter(|style| pane.shows(style.layer));
    let searches = styles.flat_map(|style| {
        (0..pane.setting().agents.len()).filter_map(move |agent| {
            let FoundSearch { fact, graph } = run.index().search_at(agent, style.phase, time)?;
            Some(ShownSearch { fact, style, graph })
        })
    });
    searches.collect()
}

/// Draws searches in the order in which places were looked at, from dark to light.
pub(super) fn draw_searches(canvas: &mut Canvas, pane: &Pane, searches: &[ShownSearch]) {
    for ShownSearch { graph, style, .. } in searches {
        let width = style.width * pane.unit();
        let radius = style.disc * pane.cell_side();
        // Never 0, as shares are made by dividing by it.
        let max = graph.edges.len().saturating_sub(1).max(1) as f64;
        for (index, ends) in graph.lines().enumerate() {
            let ends = ends.map(|end| pane.at(end));
            if may_be_seen(pane, &ends) {
                let colour = blend(style.colours[0], style.colours[1], index as f64 / max);
                draw_line(canvas, ends[0], ends[1], width, Ink { colour, opacity: style.opacity });
                if radius > 0.0 {
                    canvas.fill_disc_with(ends[1], radius, Ink { colour, opacity: style.opacity });
                }
            }
        }
    }
}

/// Returns whether the two ends do not lie beyond the same side of the pane.
fn may_be_seen(pane: &Pane, [a, b]: &[Point; 2]) -> bool {
    let width = pane.size.0 as f32;
    let height = pane.size.1 as f32;
    overlaps(a.0, b.0, width) && overlaps(a.1, b.1, height)
}

/// Says whether a stretch between two places lies partly between 0 and a greatest one.
fn overlaps(a: f32, b: f32, max: f32) -> bool {
    a.max(b) >= 0.0 && a.min(b) <= max
}
