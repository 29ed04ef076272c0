//! A path as lines of points.

use crate::geometry::Pose;
use crate::vehicle::{Path, Segment};

/// Arcs are drawn with a point for each turn by this much, in radians: 0.05 pixels off at a radius of 300 pixels.
const TURN_RAD: f64 = 0.035;

/// A stretch of a path between cusps.
pub struct Run {
    pub is_reverse: bool,
    /// Metres east and north, from the start of the stretch to its end; at least two.
    pub places: Vec<(f64, f64)>,
}

/// The stretches of a path, none if it has no length.
pub fn runs(path: &Path) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (start, segment) in path.legs() {
        if runs.last().is_none_or(|run| run.is_reverse != segment.is_reverse()) {
            runs.push(Run { is_reverse: segment.is_reverse(), places: vec![(start.x, start.y)] });
        }
        let run = runs.last_mut().expect("there is one by now");
        run.places.extend(places(start, segment));
    }
    runs
}

/// Places on a segment, without its start.
fn places(start: Pose, segment: Segment) -> impl Iterator<Item = (f64, f64)> {
    let turn = (segment.curvature * segment.length_m).abs();
    let steps = (turn / TURN_RAD).ceil().max(1.0);
    let shares = std::iter::successors(Some(1.0), |step| Some(step + 1.0)).map(move |step: f64| step / steps);
    shares.take_while(|&share| share <= 1.0).map(move |share| {
        let pose = segment.pose_at(start, share * segment.length_m);
        (pose.x, pose.y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_change_at_cusps_and_follow_the_path() {
        let segment = |curvature, length_m| Segment { curvature, length_m };
        let segments = vec![segment(0.1, 9.0), segment(0.0, 4.0), segment(-0.1, -6.0)];
        let path = Path { start: Pose::new(3.0, 5.0, 1.0), segments };
        let runs = runs(&path);
        assert_eq!(runs.iter().map(|run| run.is_reverse).collect::<Vec<_>>(), [false, true]);
        assert_eq!(runs[0].places[0], (3.0, 5.0));
        assert_eq!(runs[0].places.last(), runs[1].places.first());
        let end = path.end();
        assert_eq!(*runs[1].places.last().expect("places"), (end.x, end.y));
        let drawn_m = |run: &Run| {
            let steps = run.places.windows(2).map(|pair| {
                let (x, y) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
                (x * x + y * y).sqrt()
            });
            steps.sum::<f64>()
        };
        assert!((drawn_m(&runs[0]) - 13.0).abs() < 1e-2 && (drawn_m(&runs[1]) - 6.0).abs() < 1e-2);
    }

    #[test]
    fn standing_is_no_line() {
        assert!(runs(&Path::standing(Pose::default())).is_empty());
    }
}
