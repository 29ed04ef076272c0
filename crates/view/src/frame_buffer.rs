//! The pixels that the window shows.

use bevy::prelude::Resource;

use wildfire_picture::film::{FrameLayout, FrameRenderer, FrameRequest};

/// The pixels that the window shows, as large as the window in pixels of the display.
#[derive(Resource)]
pub struct FrameBuffer {
    renderer: FrameRenderer,
    size: (u32, u32),
    runs: usize,
    /// Pixels of the frame for one of the window's own.
    scale: f64,
    /// True if nothing was painted on it since it got its size.
    is_blank: bool,
    painted: Option<Vec<u8>>,
}

impl FrameBuffer {
    /// Makes a buffer of a width and height in pixels, within the limits of frames, for one run or two.
    pub fn new(size: (u32, u32), runs: usize) -> Self {
        let size = within_limits(size);
        Self { renderer: FrameRenderer::new(size, runs), size, runs, scale: 1.0, is_blank: true, painted: None }
    }

    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    pub fn layout(&self) -> &FrameLayout {
        self.renderer.layout()
    }

    /// Fits it to a window of that size in pixels of the display, `scale` of which are one of the window's own.
    pub fn fit(&mut self, size: (u32, u32), scale: f64) {
        let size = within_limits(size);
        if size != self.size {
            *self = Self::new(size, self.runs);
        }
        self.scale = scale;
    }

    pub fn is_blank(&self) -> bool {
        self.is_blank
    }

    /// The place on the frame of a place in the window.
    pub fn place(&self, (x, y): (f32, f32)) -> (f64, f64) {
        (f64::from(x) * self.scale, f64::from(y) * self.scale)
    }

    pub fn paint(&mut self, request: &FrameRequest) {
        self.is_blank = false;
        self.painted = Some(self.renderer.paint(request).to_vec());
    }

    /// Takes the frame if it was drawn since the last call: red, green, blue and opacity of every pixel, row by row.
    pub fn take_painted(&mut self) -> Option<Vec<u8>> {
        self.painted.take()
    }
}

fn within_limits((width, height): (u32, u32)) -> (u32, u32) {
    (
        width.clamp(FrameLayout::MIN_WIDTH, FrameLayout::MAX_SIDE),
        height.clamp(FrameLayout::MIN_HEIGHT, FrameLayout::MAX_SIDE),
    )
}
