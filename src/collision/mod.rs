//! Free or not: the one place that planners ask.
//!
//! World frame, metres. An answer "free" is a proof; an answer "not free" may be cautious by a few centimetres.
//! A [`ClearanceField`] answers for points and discs, a [`CollisionChecker`] for the body of a truck: a few look-ups in
//! the field settle most questions, the exact distance between rectangle and cells the rest.
//! [`first_meeting`] answers for two bodies that move.

#[cfg(test)]
mod brute_force;
mod checker;
mod field;
mod meeting;
mod rectangle;
mod sweep;

pub use checker::{CollisionChecker, LEAST_CLEARANCE_M, MOTION_TOLERANCE_M};
pub use field::ClearanceField;
pub use meeting::{MEETING_TOLERANCE_M, Moving, first_meeting, gap_between};
