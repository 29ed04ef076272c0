//! The window: runs played, paused, scrubbed and compared.
//!
//! It shows finished timelines and knows no simulation: the command line hands it sources of films. Nothing in it can
//! change an outcome.
//!
//! What a film shows is painted by [`crate::picture::film`] on the processor, one sheet of pixels a frame, as it is for
//! stills and films; the window hands the sheet to the graphics adapter as one texture. So [`PlayerPlugin`] holds all
//! that the window does with time, keys, mouse and further runs, and needs neither display nor adapter;
//! [`ScreenPlugin`] adds those. A frame first lets the time pass, then does what was asked, then paints.

mod command;
mod desk;
mod failure;
mod frame;
mod input;
mod mouse;
mod player;
mod reels;
mod saved;
mod screen;
mod sheet;
mod title;
mod viewer;
mod window;

pub use command::Command;
pub use failure::ViewError;
pub use frame::{PlayerPlugin, ViewSystems};
pub use player::Player;
pub use reels::{FilmSource, Reels};
pub use screen::ScreenPlugin;
pub use sheet::Sheet;
pub use viewer::Viewer;
pub use window::{play, seat, window};

use crate::picture::film::{Film, Look};
use crate::time::SimTime;

/// What a window shows first, and where it gets the rest from.
pub struct Programme {
    /// One run or two, each with its source; a recording has none.
    pub films: Vec<(Film, Option<Box<dyn FilmSource>>)>,
    pub look: Look,
    /// Simulated seconds for a second, from [`Player::SLOWEST`] to [`Player::FASTEST`].
    pub speed: f64,
    /// Where the clock stands first; beyond the end of all runs it stands there.
    pub start: SimTime,
    pub is_paused: bool,
    /// Width and height in pixels.
    pub size: (u32, u32),
}
