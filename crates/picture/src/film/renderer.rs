//! Whole frames.

use crate::Picture;
use crate::canvas::Canvas;
use crate::colours::PAPER;
use crate::film::field::{FieldRenderer, FieldView};
use crate::film::hud::HudRenderer;
use crate::film::{FrameLayout, RunView, RunViewId, ViewOptions};
use wildfire_base::time::SimTime;
use wildfire_timeline::State;

/// One moment of one run, or of two.
#[derive(Clone, Copy)]
pub struct FrameRequest<'a> {
    /// One or two.
    pub runs: &'a [&'a RunView],
    pub time: SimTime,
    pub options: &'a ViewOptions,
}

/// Draws frames of one size, one after the other.
pub struct FrameRenderer {
    layout: FrameLayout,
    sheet: Canvas,
    /// The request that was drawn last.
    shown: Option<DrawnRequest>,
    fields: Vec<FieldRenderer>,
    hud: HudRenderer,
}

impl FrameRenderer {
    /// Makes a renderer of frames of that width and height in pixels, of one run or two.
    pub fn new((width, height): (u32, u32), runs: usize) -> Self {
        Self {
            layout: FrameLayout::new((width, height), runs),
            sheet: Canvas::new(width, height, PAPER),
            shown: None,
            fields: (0..runs).map(|_| FieldRenderer::default()).collect(),
            hud: HudRenderer::default(),
        }
    }

    pub fn layout(&self) -> &FrameLayout {
        &self.layout
    }

    /// Returns whether the frame that was drawn last is this one.
    pub fn shows(&self, request: &FrameRequest) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.matches(request))
    }

    /// Red, green, blue and opacity of every pixel of the frame, row by row. What is shown follows from the request
    /// alone, whatever was drawn before.
    pub fn paint(&mut self, request: &FrameRequest) -> &[u8] {
        if !self.shows(request) {
            self.draw(request);
            self.shown = Some(DrawnRequest::new(request));
        }
        self.sheet.bytes()
    }

    fn draw(&mut self, request: &FrameRequest) {
        let states: Vec<State> = request.runs.iter().map(|run| run.state_at(request.time)).collect();
        for (run_index, &run) in request.runs.iter().enumerate() {
            let pane = self.layout.fields[run_index];
            let rival = (request.runs.len() == 2).then(|| (request.runs[1 - run_index], &states[1 - run_index]));
            let moment = FieldView { run, state: &states[run_index], rival, run_index, options: request.options };
            let painted = self.fields[run_index].paint(&moment, (pane.width, pane.height));
            self.sheet.copy_from(painted, (pane.left, pane.top));
        }
        self.hud.paint(&mut self.sheet, &self.layout, request, &states);
    }
}

/// A request without its runs.
struct DrawnRequest {
    runs: Vec<RunViewId>,
    time: SimTime,
    options: ViewOptions,
}

impl DrawnRequest {
    fn new(request: &FrameRequest) -> Self {
        Self {
            runs: request.runs.iter().map(|run| run.id()).collect(),
            time: request.time,
            options: request.options.clone(),
        }
    }

    fn matches(&self, request: &FrameRequest) -> bool {
        self.time == request.time
            && self.options == *request.options
            && self.runs.iter().copied().eq(request.runs.iter().map(|run| run.id()))
    }
}

/// One frame as a picture.
pub fn still(request: &FrameRequest, size: (u32, u32)) -> Picture {
    let mut renderer = FrameRenderer::new(size, request.runs.len());
    renderer.paint(request);
    renderer.sheet.finish()
}
