//! Collision tests: the only ones that planners use.
//!
//! World frame, metres. An answer "free" is a proof; an answer "not free" may be cautious by a few centimetres.
//! A [`ClearanceField`] answers for points and discs, a [`CollisionChecker`] for the body of a truck: a few look-ups in
//! the field settle most questions, the exact distance between rectangle and cells the rest.
//! [`first_conflict`] answers for two bodies that move.

#[cfg(test)]
mod brute_force;
mod checker;
mod conflict;
mod field;
mod rectangle;
mod sweep;

pub use checker::{CollisionChecker, MIN_CLEARANCE_M, MOTION_TOLERANCE_M, NearestObstacle, Obstacle};
pub use conflict::{CONFLICT_TOLERANCE_M, MovingBody, first_conflict, gap_between};
pub use field::ClearanceField;
pub(crate) use rectangle::Rectangle;
