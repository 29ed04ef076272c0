//! The layout of a frame.

use crate::marks::to_f32;

/// A part of the sheet, in pixels to the right and down from its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    pub left: u32,
    pub top: u32,
    pub width: u32,
    pub height: u32,
}

impl PixelRect {
    pub fn right(&self) -> u32 {
        self.left + self.width
    }

    pub fn bottom(&self) -> u32 {
        self.top + self.height
    }

    pub fn contains(&self, (x, y): (f64, f64)) -> bool {
        let columns = f64::from(self.left)..f64::from(self.left + self.width);
        let rows = f64::from(self.top)..f64::from(self.top + self.height);
        columns.contains(&x) && rows.contains(&y)
    }
}

/// The places of a frame's parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameLayout {
    pub width: u32,
    pub height: u32,
    /// The height of capitals of ordinary text; all else grows with it.
    pub text: u32,
    /// The panes of the fields, one a run.
    pub fields: Vec<PixelRect>,
    /// Counts, scores, legend and stories; a sheet that is too small for them has none.
    pub panel: Option<PixelRect>,
    /// Counts over time, and the differences below them.
    pub chart: PixelRect,
    /// The part of the chart between the start and the end of time, which is the timeline to scrub.
    pub timeline: PixelRect,
}

/// The part of a frame at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FramePart {
    /// In the pane of a run's field, pixels from the pane's upper left corner.
    Field {
        run_index: usize,
        at: (f64, f64),
    },
    /// On the timeline, as a share of the run's duration, 0 to 1.
    Timeline {
        share: f64,
    },
    Elsewhere,
}

// Lengths in heights of text.
const COLUMN: u32 = 26;
const PANEL_BELOW: u32 = 24;
const CHART_OF_ONE: u32 = 17;
const CHART_OF_TWO: u32 = 27;
const MIN_PANE: u32 = 20;
const LEFT_OF_TIMELINE: u32 = 10;
const RIGHT_OF_TIMELINE: u32 = 3;

impl FrameLayout {
    pub const MIN_WIDTH: u32 = 320;
    pub const MIN_HEIGHT: u32 = 240;
    pub const MAX_SIDE: u32 = 8192;

    /// Lays out a frame of one run or two; the panel goes where it leaves the larger panes.
    ///
    /// # Panics
    /// If a side is not within the limits, or there are no runs.
    pub fn new(size: (u32, u32), runs: usize) -> Self {
        assert!(size.0 >= Self::MIN_WIDTH && size.1 >= Self::MIN_HEIGHT && runs > 0, "a frame has room and a run");
        let text = 5 + size.0.min(size.1) / 200;
        let beside = Self::with_panel(size, runs, text, (COLUMN * text, 0));
        let below = Self::with_panel(size, runs, text, (0, PANEL_BELOW * text));
        let best = if below.min_side() > beside.min_side() { below } else { beside };
        if best.min_side() < MIN_PANE * text { Self::with_panel(size, runs, text, (0, 0)) } else { best }
    }

    /// Lays out a frame with a panel as wide as `beside` right of the panes, or as high as `below` under them.
    fn with_panel((width, height): (u32, u32), runs: usize, text: u32, (beside, below): (u32, u32)) -> Self {
        let chart_text = if runs == 1 { CHART_OF_ONE } else { CHART_OF_TWO };
        // Text sets the height, and a share of the frame bounds it: a low frame must keep room for its fields.
        let chart_height = (chart_text * text).min(height * if runs == 1 { 33 } else { 40 } / 100);
        let chart = PixelRect { left: 0, top: height - chart_height, width, height: chart_height };
        let room = width.saturating_sub(beside);
        let pane_height = chart.top.saturating_sub(below);
        // The product comes before the division, so that panes meet without a gap of a pixel.
        let edge = |run_index: u32| room * run_index / runs as u32;
        let fields = (0..runs as u32).map(|run_index| PixelRect {
            left: edge(run_index),
            top: 0,
            width: edge(run_index + 1) - edge(run_index),
            height: pane_height,
        });
        let panel = if beside > 0 {
            Some(PixelRect { left: room, top: 0, width: beside, height: chart.top })
        } else {
            (below > 0).then_some(PixelRect { left: 0, top: pane_height, width, height: below })
        };
        let before = LEFT_OF_TIMELINE * text;
        let after = RIGHT_OF_TIMELINE * text;
        let timeline = PixelRect { left: before, width: width - before - after, ..chart };
        Self { width, height, text, fields: fields.collect(), panel, chart, timeline }
    }

    fn min_side(&self) -> u32 {
        self.fields.iter().map(|pane| pane.width.min(pane.height)).min().unwrap_or(0)
    }

    pub fn place_at(&self, at: (f64, f64)) -> FramePart {
        if let Some(run_index) = self.fields.iter().position(|pane| pane.contains(at)) {
            let pane = self.fields[run_index];
            return FramePart::Field { run_index, at: (at.0 - f64::from(pane.left), at.1 - f64::from(pane.top)) };
        }
        if self.chart.contains(at) {
            let share = (at.0 - f64::from(self.timeline.left)) / f64::from(self.timeline.width);
            return FramePart::Timeline { share: share.clamp(0.0, 1.0) };
        }
        FramePart::Elsewhere
    }

    /// Returns how far to the right a share of the run's duration, 0 to 1, lies on the timeline, in pixels.
    pub fn timeline_x(&self, share: f64) -> f64 {
        f64::from(self.timeline.left) + share * f64::from(self.timeline.width)
    }

    /// A length given in heights of text, in pixels.
    pub(super) fn length(&self, texts: f32) -> f32 {
        (texts * self.text as f32).round()
    }
}

/// The edges of a part of the sheet: left, top, right, bottom.
pub(super) fn edges(part: PixelRect) -> [f32; 4] {
    [part.left, part.top, part.right(), part.bottom()].map(|edge| to_f32(f64::from(edge)))
}
