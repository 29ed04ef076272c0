//! Frames of runs: a field with its fires and agents at one time, or two of them side by side on one clock, with
//! counts, curves and text.
//!
//! Windows, stills and films show the same pixels: a [`FrameRenderer`] draws a [`FrameRequest`] on a sheet.

mod camera;
mod field;
mod fleet_view;
mod hud;
mod keys;
mod layout;
mod lettering;
mod options;
mod page;
mod renderer;
mod run;
mod tour;

pub use camera::{Camera, Projection};
pub use field::pick;
pub use hud::format_clock;
pub use keys::{BINDINGS, Binding};
pub use layout::{FrameLayout, FramePart, PixelRect};
pub use options::{CameraTarget, Layer, Layers, Selected, Status, ViewOptions};
pub use page::{MAX_GROUND_CELLS, PackedModule, page, page_data, play_page};
pub use renderer::{FrameRenderer, FrameRequest, still};
pub use run::{RunView, RunViewId, Verdict};
pub use tour::{TourStop, tour};
