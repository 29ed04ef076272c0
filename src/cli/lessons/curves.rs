//! Data of the lesson on curves: the shortest ones of a car, with reverse and without, to many poses.

use serde_json::{Value, json};

use super::short;
use crate::cli::curve::report::{dubins_word, reeds_shepp_word};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Dubins, ReedsShepp, Segment};

/// That of the truck, in metres.
const RADIUS_M: f64 = 13.0;
/// Where the car is to arrive, in metres ahead and to the left.
const GOALS: [(&str, f64, f64); 5] = [
    ("beside, 8 m to the left", 0.0, 8.0),
    ("straight ahead, 30 m", 30.0, 0.0),
    ("ahead and to the left", 18.0, 14.0),
    ("behind, 20 m", -20.0, 0.0),
    ("the same place", 0.0, 0.0),
];
const DEGREES: usize = 15;

pub fn curves() -> Value {
    let from = Pose::new(0.0, 0.0, 0.0);
    let goals = GOALS.map(|(name, x, y)| {
        let turns: Vec<Value> = (0..360)
            .step_by(DEGREES)
            .map(|degrees| {
                let to = Pose::new(x, y, (degrees as f64).to_radians());
                let reverse = ReedsShepp { radius_m: RADIUS_M }.shortest(from, to);
                let forward = Dubins { radius_m: RADIUS_M }.shortest(from, to);
                json!({
                    "reeds_shepp": curve(&reeds_shepp_word(&reverse), reverse.length_m, reverse.segments()),
                    "dubins": curve(&dubins_word(&forward), forward.length_m, forward.segments()),
                })
            })
            .collect();
        json!({"name": name, "x": x, "y": y, "turns": turns})
    });
    json!({"radius": RADIUS_M, "degrees": DEGREES, "goals": goals})
}

/// A curve; its segments are curvatures in 1/m and lengths in metres, negative in reverse.
fn curve(word: &str, length_m: f64, segments: impl Iterator<Item = Segment>) -> Value {
    let segments: Vec<_> = segments.map(|part| [short(part.curvature, 6), short(part.length_m, 3)]).collect();
    json!({"word": word, "length": short(length_m, 2), "segments": segments})
}
