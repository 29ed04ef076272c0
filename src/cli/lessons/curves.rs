//! Data of the lesson on curves: the shortest ones of a car, with reverse and without, to many poses.

use serde_json::{Value, json};

use super::short;
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
                let with_reverse = ReedsShepp { radius_m: RADIUS_M }.shortest(from, to);
                let forward = Dubins { radius_m: RADIUS_M }.shortest(from, to);
                json!({
                    "reeds_shepp": curve(&with_reverse.word.to_string(), with_reverse.length_m, with_reverse.segments()),
                    "dubins": curve(&forward.word.to_string(), forward.length_m, forward.segments()),
                })
            })
            .collect();
        json!({"name": name, "x": x, "y": y, "turns": turns})
    });
    let [beside, ..] = &goals;
    let [reeds_shepp, dubins] = ["reeds_shepp", "dubins"]
        .map(|name| format!("{:.1}", beside["turns"][0][name]["length"].as_f64().unwrap_or(0.0)));
    let beside = json!({"reeds_shepp": reeds_shepp, "dubins": dubins});
    json!({"radius": RADIUS_M, "degrees": DEGREES, "goals": goals, "beside": beside})
}

/// A curve; its segments are curvatures in 1/m and lengths in metres, negative in reverse.
fn curve(word: &str, length_m: f64, segments: impl Iterator<Item = Segment>) -> Value {
    let segments: Vec<_> = segments.map(|part| [short(part.curvature, 6), short(part.length_m, 3)]).collect();
    json!({"word": word, "length": short(length_m, 2), "segments": segments})
}
