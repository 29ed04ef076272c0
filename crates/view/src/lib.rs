#![doc = include_str!("../README.md")]
//!
//! The window: runs played, paused, scrubbed and compared.
//!
//! It shows finished timelines and knows no simulation: the command line hands it loaders of runs. Nothing in it can
//! change an outcome.
//!
//! What a window shows is drawn by [`wildfire_picture::film`] on the processor, one buffer of pixels a frame, as it is
//! for stills and films; the window hands the buffer to the graphics adapter as one texture. So [`PlayerPlugin`] holds
//! all that the window does with time, keys, mouse and further runs, and needs neither display nor adapter;
//! [`ScreenPlugin`] adds those. A frame first lets the time pass, then does what was asked, then draws.

mod controls;
mod failure;
mod frame;
mod frame_buffer;
mod input;
mod mouse;
mod player;
mod run_set;
mod screen;
mod window;

pub use failure::ViewError;
pub use frame::{PlayerPlugin, ViewSystems, Viewer};
pub use frame_buffer::FrameBuffer;
pub use input::Command;
pub use player::Player;
pub use run_set::{RunLoader, RunSet};
pub use screen::ScreenPlugin;
pub use window::{insert_resources, play, window};

use wildfire_base::time::SimTime;
use wildfire_picture::film::{RunView, ViewOptions};

/// The configuration of a window: what it shows first, and where it gets further runs from.
pub struct ViewerConfig {
    /// One run or two, each with its loader; a recording has none.
    pub runs: Vec<(RunView, Option<Box<dyn RunLoader>>)>,
    pub options: ViewOptions,
    /// Simulated seconds for a second, from [`Player::SLOWEST`] to [`Player::FASTEST`].
    pub speed: f64,
    /// The first time shown; one beyond the end of all runs becomes that end.
    pub start: SimTime,
    pub is_paused: bool,
    /// Width and height in pixels.
    pub size: (u32, u32),
}
