//! The head-up display around the fields: clock, counts, scores, legend, stories, and the curves over time, which are
//! the timeline.

mod blocks;
pub(super) mod chart;
mod fleet;
pub(super) mod formatting;
pub(super) mod legend;
mod notes;
mod panel;
mod pen;
pub(super) mod stories;

pub use formatting::format_clock;

use blocks::panel_blocks;
use chart::ChartRenderer;
use notes::{draw_headline, draw_help, draw_message, draw_run_names};
use panel::draw_panel;
use pen::{Signs, TextPen};

use crate::canvas::Canvas;
use crate::film::lettering::Lettering;
use crate::film::{FrameLayout, FrameRequest, RunView, ViewOptions};
use wildfire_base::time::SimTime;
use wildfire_timeline::{BushCounts, State};

/// Draws panel and chart; keeps what seldom changes from frame to frame.
#[derive(Default)]
pub struct HudRenderer {
    lettering: Lettering,
    chart: ChartRenderer,
    signs: Signs,
}

impl HudRenderer {
    /// `states` are those of the runs at the request's time.
    pub fn paint(&mut self, sheet: &mut Canvas, layout: &FrameLayout, request: &FrameRequest, states: &[State]) {
        self.chart.paint(sheet, &mut self.lettering, layout, request);
        let pane_side = layout.fields.iter().map(|pane| pane.width.min(pane.height)).min().map_or(0.0, f64::from);
        let view = HudView { pane_side, ..HudView::new(request, states) };
        let mut pen =
            TextPen { sheet, lettering: &mut self.lettering, signs: &mut self.signs, text: layout.text as f32 };
        match layout.panel {
            Some(panel) => draw_panel(&mut pen, panel, panel_blocks(&view)),
            None => draw_headline(&mut pen, layout, &view),
        }
        if view.is_comparison() {
            draw_run_names(&mut pen, layout, &view);
        }
        if let Some(message) = request.options.status.as_ref().and_then(|status| status.message.as_ref()) {
            draw_message(&mut pen, layout, message);
        }
        if request.options.shows_help {
            draw_help(&mut pen, layout, view.has_ground());
        }
    }
}

/// The runs of a request at its time.
pub struct HudView<'a> {
    pub runs: &'a [&'a RunView],
    pub options: &'a ViewOptions,
    pub time: SimTime,
    /// When the last run ends.
    pub end: SimTime,
    pub states: &'a [State],
    pub counts: Vec<BushCounts>,
    /// The shorter side of the fields' panes in pixels.
    pub pane_side: f64,
}

impl<'a> HudView<'a> {
    pub fn new(request: &FrameRequest<'a>, states: &'a [State]) -> Self {
        let end = RunView::last_end(request.runs);
        let time = request.time.min(end);
        let counts = request.runs.iter().map(|run| run.counts_at(time)).collect();
        Self { runs: request.runs, options: request.options, time, end, states, counts, pane_side: 0.0 }
    }

    /// Says whether ground burns in one of the runs.
    pub fn has_ground(&self) -> bool {
        self.runs.iter().any(|run| run.index().ground().is_some())
    }

    /// Says whether all of the runs are told in hectares.
    pub fn is_of_ground(&self) -> bool {
        self.runs.iter().all(|run| run.is_of_ground())
    }

    pub fn is_comparison(&self) -> bool {
        self.runs.len() > 1
    }
}
