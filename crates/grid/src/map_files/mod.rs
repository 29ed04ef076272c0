//! Reading and writing maps: images, text, CSV, NumPy arrays, Moving AI maps, ROS maps.
//!
//! The first line of a file is row 0, its first cell column 0; errors count as everything here does, from 0.

mod bmp;
pub mod carried;
mod colours;
mod decimal;
mod decoded;
mod error;
mod map;
mod moving_ai;
mod npy;
mod otsu;
mod pictures;
mod pixel;
mod png;
mod pnm;
pub mod raster;
mod read;
mod ros;
mod rows;
mod text;
mod tiff_image;
mod write;

pub use colours::read_colours;
pub use error::{Fault, MapError};
pub use map::{MapFile, NEAR_TOLERANCE, Reading, Tolerance};
pub use read::{is_plain_text, read, read_bytes};
pub use ros::MapPlace;
pub use write::{MapValue, write_csv, write_npy, write_path, write_png, write_text};

/// The maximum number of rows and of columns of a map.
pub use crate::brushfire::MAX_SIDE;

/// The maximum number of cells of a map: step counts within it fit 32 bits, and the derived maps fit the memory of a
/// laptop.
pub const MAX_CELLS: usize = 1 << 28;
/// The maximum size of a map file in bytes: 16 for every cell of the largest map.
pub const MAX_BYTES: u64 = 1 << 32;
