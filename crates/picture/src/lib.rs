#![doc = include_str!("../README.md")]
//!
//! Pictures drawn on the CPU: grid maps with legends, and as surfaces; maps of values over a field, with contour lines; paths
//! of a vehicle and drives on a field; [`charts`]; frames of runs ([`film`]) and GIFs of them; scenes for robotics log
//! viewers ([`write_mcap`]).
//!
//! The same scene gives the same picture on every machine, byte for byte: drawing uses only arithmetic that the standard
//! defines exactly, and trigonometry from [`wildfire_base::geometry::ops`].

mod canvas;
pub mod charts;
mod colours;
mod contours;
mod curves;
mod drives;
mod field_map;
pub mod film;
mod font;
mod gif_film;
mod ground;
mod legend;
mod map;
mod map_film;
mod map_sheet;
mod marks;
mod mcap;
mod png;
mod scene;
mod surface;
mod text;
mod thin_line;
mod ticks;
mod values;
mod vehicle_sketch;
mod way_lines;
mod world_sheet;
mod zoom;

pub use colours::{ColourMap, Rgb, bush_colour};
pub use contours::{ContourLine, contour_lines};
pub use curves::{CurveScene, draw_curves};
pub use drives::{DriveScene, DrivenWays, draw_drives};
pub use field_map::{FieldMap, MapQuantity, MapScale, draw_field_maps};
pub use font::unknown_letters;
pub use gif_film::{ColourCounts, GifFilm, Palette};
pub use ground::{GroundCover, bush_covers, ground_covers};
pub use map::{draw_map, draw_overlay, draw_small_map};
pub use map_film::{GrownPath, MapGrowth, write_map_film};
pub use map_sheet::{MapSheet, SheetPanel, draw_map_sheet};
pub use mcap::{MAX_CELLS_OF_MCAP, write_mcap};
pub use png::Picture;
pub use scene::{MapScene, Spot, Zones};
pub use surface::draw_surface;
pub use vehicle_sketch::draw_vehicle;
