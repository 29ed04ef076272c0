use crate::geometry::Pose;
use crate::vehicle::{Path, Segment};

/// Shorter pieces are rounding, and left out.
const SHORTEST_M: f64 = 1e-9;

/// A path that is being changed, with the places of its joints.
#[derive(Clone, Debug)]
pub struct Way {
    segments: Vec<Segment>,
    /// Pose and metres driven at the start of every segment, and at the end.
    joints: Vec<(Pose, f64)>,
}

impl Way {
    /// Segments of no length are left out, and those that continue one another become one.
    pub fn new(start: Pose, way: impl IntoIterator<Item = Segment>) -> Self {
        let mut segments = Vec::new();
        append(&mut segments, way);
        let mut joints = vec![(start, 0.0)];
        for segment in &segments {
            let (pose, driven_m) = joints[joints.len() - 1];
            joints.push((segment.end(pose), driven_m + segment.length_m.abs()));
        }
        Self { segments, joints }
    }

    pub fn start(&self) -> Pose {
        self.joints[0].0
    }

    pub fn into_path(self) -> Path {
        Path { start: self.start(), segments: self.segments }
    }

    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    pub fn length_m(&self) -> f64 {
        self.joints[self.joints.len() - 1].1
    }

    /// Metres driven at the start of every segment, and at the end.
    pub fn joints_m(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.joints.iter().map(|&(_, driven_m)| driven_m)
    }

    /// Pose after so many metres, from 0 to the length.
    pub fn pose_at(&self, driven_m: f64) -> Pose {
        let Some(index) = self.segment_at(driven_m) else { return self.start() };
        let (pose, before_m) = self.joints[index];
        let segment = self.segments[index];
        segment.pose_at(pose, (driven_m - before_m).copysign(segment.length_m))
    }

    /// Replaces what `way` holds by the segments of this way with those `between` two places of it exchanged.
    pub fn splice(&self, (from_m, to_m): (f64, f64), between: impl Iterator<Item = Segment>, way: &mut Vec<Segment>) {
        way.clear();
        append(way, self.part(0.0, from_m));
        append(way, between);
        append(way, self.part(to_m, self.length_m()));
    }

    /// The segments between two places.
    pub fn part(&self, from_m: f64, to_m: f64) -> impl Iterator<Item = Segment> + '_ {
        self.segments.iter().zip(self.joints.windows(2)).filter_map(move |(segment, joints)| {
            let length_m = to_m.min(joints[1].1) - from_m.max(joints[0].1);
            (length_m > 0.0).then(|| segment.with_length(length_m))
        })
    }

    fn segment_at(&self, driven_m: f64) -> Option<usize> {
        let last = self.segments.len().checked_sub(1)?;
        Some(self.joints.partition_point(|&(_, before_m)| before_m <= driven_m).saturating_sub(1).min(last))
    }
}

/// Metres, and `cusp_m` for every change of direction.
pub fn cost(segments: &[Segment], cusp_m: f64) -> f64 {
    let metres: f64 = segments.iter().map(|segment| segment.length_m.abs()).sum();
    let cusps = segments.windows(2).filter(|pair| pair[0].is_reverse() != pair[1].is_reverse()).count();
    metres + cusp_m * cusps as f64
}

fn append(segments: &mut Vec<Segment>, way: impl IntoIterator<Item = Segment>) {
    for segment in way.into_iter().filter(|segment| segment.length_m.abs() > SHORTEST_M) {
        match segments.last_mut() {
            Some(last) if last.curvature == segment.curvature && last.is_reverse() == segment.is_reverse() => {
                last.length_m += segment.length_m;
            }
            _ => segments.push(segment),
        }
    }
}
