//! Pictures drawn on the CPU: grid maps, their legends, surfaces; ways of a vehicle, drives on a field;
//! [`charts`]; frames of runs, [`film`], and GIFs of them.
//!
//! The same scene gives the same picture on every machine, byte for byte: drawing uses only arithmetic that is exact to
//! the standard, and trigonometry from [`crate::geometry::ops`].

mod canvas;
pub mod charts;
mod colours;
mod curves;
mod drives;
pub mod film;
mod font;
mod gif_film;
mod legend;
mod map;
mod marks;
mod png;
mod scene;
mod surface;
mod text;
mod thin_line;
mod ticks;
mod values;
mod way_lines;
mod world_sheet;
mod zoom;

pub use colours::{ColourMap, Rgb, bush_colour};
pub use curves::{CurveScene, draw_curves};
pub use drives::{DriveScene, DrivenWays, draw_drives};
pub use font::has_all_of as font_has_all_of;
pub use gif_film::{ColourCounts, GifFilm, Palette};
pub use map::{draw_map, draw_overlay};
pub use png::Picture;
pub use scene::{MapScene, Zones};
pub use surface::draw_surface;
