//! Frames of runs: a field with its fires and agents at one time, or two of them side by side on one clock, with
//! counts, curves and words about them.
//!
//! Windows, stills and films show the same pixels: a [`Painter`] draws a [`Shot`] on a sheet.

mod books;
mod camera;
mod courses;
mod expenses;
mod fate;
mod field;
mod history;
mod hud;
mod keys;
mod layers;
mod layout;
mod lettering;
mod look;
mod painter;
mod run;
mod vegetation;

pub use books::Doings;
pub use camera::{Camera, Projection};
pub use fate::Fate;
pub use field::pick;
pub use history::Tally;
pub use hud::clock;
pub use keys::{BINDINGS, Binding};
pub use layers::{Layer, Layers};
pub use layout::{Layout, Place, Rectangle};
pub use look::{Look, Selected, Status};
pub use painter::{Painter, Shot, still};
pub use run::{Film, FilmId};
