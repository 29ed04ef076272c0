//! Paths of the rear axle: segments of constant curvature in a row.

use serde::{Deserialize, Serialize};

use crate::geometry::{Pose, ops};

/// A stretch of constant curvature of the rear axle's path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// 1/m, positive where the steering wheel points left, whichever way the truck drives; 0 is straight.
    pub curvature: f64,
    /// Metres, negative in reverse.
    pub length_m: f64,
}

impl Segment {
    /// Pose after `travelled_m` of this segment (signed like `length_m`), integrated in closed form.
    #[inline]
    pub fn pose_at(&self, start: Pose, travelled_m: f64) -> Pose {
        let half_turn = 0.5 * self.curvature * travelled_m;
        // The chord of the arc, along the mean heading: exact however small the curvature is.
        let chord =
            if half_turn == 0.0 { travelled_m } else { 2.0 * ops::recurring_sin_cos(half_turn).0 / self.curvature };
        let (sin, cos) = ops::recurring_sin_cos(start.heading + half_turn);
        Pose::new(start.x + cos * chord, start.y + sin * chord, start.heading + self.curvature * travelled_m)
    }

    /// Returns the pose at its end.
    #[inline]
    pub fn end(&self, start: Pose) -> Pose {
        self.pose_at(start, self.length_m)
    }

    /// Says whether it is driven backwards.
    pub fn is_reverse(&self) -> bool {
        self.length_m < 0.0
    }

    /// The same curvature and direction for `metres` (not negative).
    pub fn with_length(&self, metres: f64) -> Self {
        Self { curvature: self.curvature, length_m: metres.copysign(self.length_m) }
    }
}

/// A drivable path: a start pose of the rear axle and the segments from there on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Of the rear axle.
    pub start: Pose,
    /// Each begins where the one before ended.
    pub segments: Vec<Segment>,
}

impl Path {
    /// The path of a truck that stays where it is.
    pub fn standing(start: Pose) -> Self {
        Self { start, segments: Vec::new() }
    }

    /// Returns the pose in which it ends.
    pub fn end(&self) -> Pose {
        self.segments.iter().fold(self.start, |pose, segment| segment.end(pose))
    }

    /// Driven distance in metres, forward and reverse alike.
    pub fn length_m(&self) -> f64 {
        self.segments.iter().map(|segment| segment.length_m.abs()).sum()
    }

    /// Number of changes between forward and reverse.
    pub fn cusps(&self) -> u32 {
        self.segments.windows(2).filter(|pair| pair[0].is_reverse() != pair[1].is_reverse()).count() as u32
    }

    /// Joins segments that continue one another.
    #[must_use]
    pub fn joined(self) -> Self {
        let mut segments: Vec<Segment> = Vec::with_capacity(self.segments.len());
        for segment in self.segments {
            match segments.last_mut() {
                Some(last) if last.curvature == segment.curvature && last.is_reverse() == segment.is_reverse() => {
                    last.length_m += segment.length_m;
                }
                _ => segments.push(segment),
            }
        }
        Self { start: self.start, segments }
    }

    /// The same way driven back: from the end to the start.
    pub fn reversed(&self) -> Self {
        let segments = self.segments.iter().rev();
        Self {
            start: self.end(),
            segments: segments.map(|s| Segment { curvature: s.curvature, length_m: -s.length_m }).collect(),
        }
    }

    /// The first `metres` of the driven way, and the rest, which begins where the first part ends.
    pub fn split_at(&self, metres: f64) -> [Self; 2] {
        let mut first = Self::standing(self.start);
        let mut others = Vec::new();
        let mut left = metres;
        for &segment in &self.segments {
            let length_m = segment.length_m.abs();
            // With equality the split is at a joint, and makes no segment of length 0.
            if left >= length_m {
                first.segments.push(segment);
            } else if left > 0.0 {
                first.segments.push(segment.with_length(left));
                others.push(segment.with_length(length_m - left));
            } else {
                others.push(segment);
            }
            left -= length_m;
        }
        let rest = Self { start: first.end(), segments: others };
        [first, rest]
    }

    /// Pose after `travelled_m` of the driven way, in closed form; before the start and beyond the end, these.
    pub fn pose_at(&self, travelled_m: f64) -> Pose {
        let mut left = travelled_m.max(0.0);
        for (start, segment) in self.legs() {
            if left <= segment.length_m.abs() {
                return segment.pose_at(start, left.copysign(segment.length_m));
            }
            left -= segment.length_m.abs();
        }
        self.end()
    }

    /// Poses along the way with the metres driven so far: the start, every joint, the end, and equal steps of at most
    /// `spacing_m` (positive) between them.
    pub fn samples(&self, spacing_m: f64) -> impl Iterator<Item = (f64, Pose)> + '_ {
        let mut driven_m = 0.0;
        let legs = self.legs().flat_map(move |(start, segment)| {
            let before_m = driven_m;
            let length_m = segment.length_m.abs();
            driven_m += length_m;
            let steps = (length_m / spacing_m).ceil().max(1.0) as u32;
            (1..=steps).map(move |step| {
                let share = f64::from(step) / f64::from(steps);
                (before_m + share * length_m, segment.pose_at(start, share * segment.length_m))
            })
        });
        std::iter::once((0.0, self.start)).chain(legs)
    }

    /// Each segment with the pose at which it begins.
    pub fn legs(&self) -> impl Iterator<Item = (Pose, Segment)> + '_ {
        let mut pose = self.start;
        self.segments.iter().map(move |&segment| {
            let start = pose;
            pose = segment.end(start);
            (start, segment)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wiggle() -> Path {
        let segment = |curvature, length_m| Segment { curvature, length_m };
        Path {
            start: Pose::new(10.0, 20.0, 0.7),
            segments: vec![
                segment(1.0 / 13.0, 9.0),
                segment(0.0, 4.0),
                segment(-1.0 / 13.0, -6.0),
                segment(1.0 / 13.0, -3.0),
                segment(0.0, 2.0),
            ],
        }
    }

    #[test]
    fn a_path_driven_back_ends_at_its_start() {
        let path = wiggle();
        let back = path.reversed();
        let end = back.end();
        assert!((end.position() - path.start.position()).length() < 1e-12);
        assert!((end.heading - path.start.heading).abs() < 1e-12);
        assert_eq!(back.length_m(), path.length_m());
        assert_eq!(back.cusps(), path.cusps());
    }

    #[test]
    fn parts_of_a_path_make_up_the_whole() {
        let path = wiggle();
        for metres in [0.0, 3.0, 9.0, 15.5, 19.0, 24.0, 30.0] {
            let [first, rest] = path.split_at(metres);
            assert!((first.length_m() - metres.min(24.0)).abs() < 1e-12);
            assert!((rest.length_m() - (24.0 - metres).max(0.0)).abs() < 1e-12);
            assert_eq!((first.start, rest.start), (path.start, first.end()));
            assert!((rest.end().position() - path.end().position()).length() < 1e-12);
        }
    }

    #[test]
    fn the_pose_at_a_distance_is_where_the_first_part_ends() {
        let path = wiggle();
        for metres in [-1.0, 0.0, 3.0, 9.0, 15.5, 19.0, 23.9, 24.0, 30.0] {
            let [first, _] = path.split_at(metres);
            assert!((path.pose_at(metres).position() - first.end().position()).length() < 1e-12);
            assert!((path.pose_at(metres).heading - first.end().heading).abs() < 1e-12);
        }
    }

    #[test]
    fn samples_meet_every_joint_and_keep_the_spacing() {
        let path = wiggle();
        let samples: Vec<(f64, Pose)> = path.samples(0.7).collect();
        assert_eq!(samples[0], (0.0, path.start));
        assert_eq!(*samples.last().expect("the end"), (24.0, path.end()));
        for joint_m in [9.0, 13.0, 19.0, 22.0] {
            assert!(samples.iter().any(|&(driven_m, _)| driven_m == joint_m), "no sample at {joint_m} m");
        }
        for pair in samples.windows(2) {
            assert!(pair[0].0 < pair[1].0 && pair[1].0 - pair[0].0 <= 0.7 + 1e-12);
        }
        for (driven_m, pose) in samples {
            assert!((path.pose_at(driven_m).position() - pose.position()).length() < 1e-12);
        }
        assert_eq!(Path::standing(path.start).samples(0.7).count(), 1);
    }

    #[test]
    fn cusps_are_changes_of_direction() {
        assert_eq!(wiggle().cusps(), 2);
        assert_eq!(wiggle().length_m(), 24.0);
    }

    #[test]
    fn closed_form_agrees_with_small_steps() {
        let segment = Segment { curvature: -1.0 / 13.0, length_m: -7.0 };
        let start = Pose::new(3.0, -2.0, 2.9);
        let mut x = start.x;
        let mut y = start.y;
        let mut heading = start.heading;
        let steps = 200_000;
        let step = segment.length_m / f64::from(steps);
        for _ in 0..steps {
            let middle = heading + 0.5 * step * segment.curvature;
            x += step * ops::cos(middle);
            y += step * ops::sin(middle);
            heading += step * segment.curvature;
        }
        let end = segment.end(start);
        assert!((end.x - x).abs() < 1e-8 && (end.y - y).abs() < 1e-8);
        assert!((end.heading - ops::wrap_angle(heading)).abs() < 1e-9);
    }
}
