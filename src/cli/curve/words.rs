//! Segments in words and degrees, and numbers as people read them.

use crate::vehicle::Segment;

/// Names the direction of the steering wheel.
pub fn steering(segment: &Segment) -> &'static str {
    match segment.curvature {
        0.0 => "straight",
        left if left > 0.0 => "left",
        _ => "right",
    }
}

pub fn direction(segment: &Segment) -> &'static str {
    if segment.is_reverse() { "reverse" } else { "forward" }
}

/// Returns how far the heading turns, counter-clockwise.
pub fn turn_deg(segment: &Segment) -> f64 {
    (segment.curvature * segment.length_m).to_degrees()
}

/// A number with at most six digits after the point.
pub fn short(number: f64) -> String {
    // The sum makes -0 to 0.
    ((number * 1e6).round() / 1e6 + 0.0).to_string()
}
