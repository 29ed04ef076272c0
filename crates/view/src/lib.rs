#![doc = include_str!("../README.md")]
//!
//! The window, in which runs are played, paused, scrubbed and compared.
//!
//! It shows finished timelines and does not depend on the simulation: the command line passes it loaders of runs. Nothing in
//! it can change an outcome.
//!
//! [`wildfire_picture::film`] draws each frame on the CPU into one buffer of pixels, as for stills and films; the window
//! passes the buffer to the graphics adapter as one texture. [`PlayerPlugin`] handles time, keys, mouse and further runs and
//! needs neither display nor adapter; [`ScreenPlugin`] adds those. A frame first advances the time, then executes commands,
//! then draws.

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
pub use input::KeyCommand;
pub use player::Player;
pub use run_set::{RunLoader, RunSet};
pub use screen::ScreenPlugin;
pub use window::{insert_resources, play, window};

use wildfire_base::time::SimTime;
use wildfire_picture::film::{RunView, ViewOptions};

/// The configuration of a window: its initial view, and the source of further runs.
pub struct ViewerConfig {
    /// One or two runs, each with its loader; a recording has none.
    pub runs: Vec<(RunView, Option<Box<dyn RunLoader>>)>,
    pub options: ViewOptions,
    /// Simulated seconds per second, from [`Player::SLOWEST`] to [`Player::FASTEST`].
    pub speed: f64,
    /// The first time shown; limited to the end of the longest run.
    pub start: SimTime,
    pub is_paused: bool,
    /// Width and height in pixels.
    pub size: (u32, u32),
}
