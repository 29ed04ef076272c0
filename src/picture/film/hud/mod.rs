//! What stands around the fields: clock, counts, scores, legend, stories; the curves over time, which are the timeline.

mod block;
mod blocks;
mod chart;
mod headline;
mod help;
mod moment;
mod notes;
mod panel;
mod pen;
mod signs;
mod words;

pub use words::clock;

use chart::ChartRenderer;
use moment::Moment;
use pen::Pen;
use signs::Signs;

use super::lettering::Lettering;
use super::{FrameRequest, Layout};
use crate::picture::canvas::Canvas;
use crate::timeline::State;

/// Draws panel and chart; keeps what seldom changes from frame to frame.
#[derive(Default)]
pub struct HudRenderer {
    lettering: Lettering,
    chart: ChartRenderer,
    signs: Signs,
}

impl HudRenderer {
    /// `states` are those of the runs at the request's time.
    pub fn paint(&mut self, sheet: &mut Canvas, layout: &Layout, request: &FrameRequest, states: &[State]) {
        self.chart.paint(sheet, &mut self.lettering, layout, request);
        let moment = Moment::new(request, states);
        let mut pen = Pen { sheet, lettering: &mut self.lettering, signs: &mut self.signs, text: layout.text as f32 };
        match layout.panel {
            Some(panel) => panel::draw(&mut pen, panel, blocks::blocks(&moment)),
            None => headline::draw(&mut pen, layout, &moment),
        }
        if moment.is_comparison() {
            notes::name_runs(&mut pen, layout, &moment);
        }
        if let Some(message) = request.options.status.as_ref().and_then(|status| status.message.as_ref()) {
            notes::tell_message(&mut pen, layout, message);
        }
        if request.options.shows_help {
            help::draw(&mut pen, layout);
        }
    }
}
