//! Points, poses, rectangles and the field's cells.
//!
//! World frame: metres, x east, y north, origin at the field's south-west corner.
//! Angles: radians, counter-clockwise, in (-pi, pi]. All arithmetic is `f64`.

mod cell;
pub mod compass;
pub mod ops;
mod pose;

pub use cell::{Cell, FieldFrame};
pub use glam::{DVec2, DVec3};
pub use pose::{OrientedRect, Pose};
