//! Ground on which bodies are slower than elsewhere.

use std::sync::Arc;

use glam::DVec2;

use super::profile::{Paced, fastest_pieces};
use super::{SpeedLimits, Trajectory};
use crate::geometry::FieldFrame;
use crate::time::SimTime;
use crate::vehicle::{Path, Segment};

/// Paths are cut into pieces no longer than this share of a cell's side, each of which is on one kind of ground.
const PIECE: f64 = 0.5;

/// The share of its speed that a body keeps, by kind of ground. The cell under the middle of its rear axle counts.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundSpeed {
    frame: FieldFrame,
    /// The kind of ground by cell index.
    kinds: Arc<[u8]>,
    shares: [f64; 256],
}

impl GroundSpeed {
    /// `kinds` has a number for each cell of the frame, `shares` are more than 0 and at most 1.
    pub fn new(frame: FieldFrame, kinds: Arc<[u8]>, shares: [f64; 256]) -> Self {
        Self { frame, kinds, shares }
    }

    /// Returns the share at a place; 1 outside of the field.
    pub fn share_at(&self, place: DVec2) -> f64 {
        self.frame.cell_at(place).map_or(1.0, |cell| self.share(self.frame.index(cell)))
    }

    /// Returns the share in a cell.
    pub fn share(&self, cell: usize) -> f64 {
        self.shares[usize::from(self.kinds[cell])]
    }

    /// Cuts a path where the ground changes.
    fn cut(&self, path: &Path) -> Vec<Paced> {
        let mut segments = Vec::new();
        for (start, segment) in path.legs() {
            let pieces = (segment.length_m.abs() / (PIECE * self.frame.cell_m)).ceil().max(1.0) as u32;
            let along = |piece: f64| piece / f64::from(pieces);
            let shares = (0..pieces).map(|piece| {
                let middle = segment.pose_at(start, along(f64::from(piece) + 0.5) * segment.length_m);
                self.share_at(middle.position())
            });
            let shares: Vec<f64> = shares.collect();
            // Joined again where the ground stays the same, so that only its changes cut the path.
            for same in shares.chunk_by(f64::eq) {
                let length_m = segment.length_m * along(same.len() as f64);
                segments.push(Paced { segment: Segment { length_m, ..segment }, share: same[0] });
            }
        }
        segments
    }
}

impl Trajectory {
    /// Drives a path as [`Trajectory::from_path`] does, at the share of the greatest speed that the ground allows.
    pub fn over_ground(path: &Path, start_time: SimTime, limits: SpeedLimits, ground: &GroundSpeed) -> Self {
        Self::new(start_time, path.start, fastest_pieces(ground.cut(path).into_iter(), &limits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::rng;
    use crate::trajectory::profile::tests::{random_limits, random_path};

    const FRAME: FieldFrame = FieldFrame { cols: 40, rows: 40, cell_m: 5.0 };

    /// Roads are of the kind 1; elsewhere a quarter of the speed is kept.
    fn ground(is_road: impl Fn(u16) -> bool) -> GroundSpeed {
        let mut shares = [0.25; 256];
        shares[1] = 1.0;
        let kinds = (0..FRAME.cell_count()).map(|index| u8::from(is_road(FRAME.cell(index).col))).collect();
        GroundSpeed::new(FRAME, kinds, shares)
    }

    #[test]
    fn a_straight_drive_takes_longer_off_the_road() {
        // Columns 10 to 19 are roads: from 50 to 100 m.
        let ground = ground(|col| (10..20).contains(&col));
        let path =
            Path { start: Pose::new(30.0, 12.0, 0.0), segments: vec![Segment { curvature: 0.0, length_m: 100.0 }] };
        let drive = Trajectory::over_ground(&path, SimTime::ZERO, SpeedLimits::new(10.0, 10.0), &ground);
        assert!((drive.duration_s() - (50.0 / 10.0 + 50.0 / 2.5)).abs() < 1e-9, "{} s", drive.duration_s());
        assert!((drive.end().x - 130.0).abs() < 1e-9);
        // Where a road begins it speeds up, and before it ends it brakes.
        let limits =
            SpeedLimits { acceleration_mps2: Some(2.0), braking_mps2: Some(3.0), ..SpeedLimits::new(10.0, 10.0) };
        let slower = Trajectory::over_ground(&path, SimTime::ZERO, limits, &ground);
        assert!(slower.duration_s() > drive.duration_s() + 1.0);
        let speed_at = |x: f64| {
            let arrives = |after: f64| slower.pose_at(SimTime::from_seconds(after)).x >= x;
            let after = (0..).map(|step| 0.01 * f64::from(step)).find(|&after| arrives(after)).expect("it gets there");
            slower.state_at(SimTime::from_seconds(after)).speed_mps
        };
        assert!(speed_at(49.0) <= 2.5 && speed_at(101.0) <= 2.51 && speed_at(75.0) > 8.0);
    }

    #[test]
    fn where_all_is_road_a_drive_is_as_fast_as_without_ground_and_nowhere_faster() {
        let mut rng = rng::stream(5, "ground");
        let roads = ground(|_| true);
        let none = ground(|_| false);
        for _ in 0..50 {
            let path = random_path(&mut rng);
            let limits = random_limits(&mut rng);
            let plain = Trajectory::from_path(&path, SimTime::ZERO, limits);
            assert_eq!(Trajectory::over_ground(&path, SimTime::ZERO, limits, &roads), plain);
            let slow = Trajectory::over_ground(&path, SimTime::ZERO, limits, &none);
            assert!(slow.duration_s() >= plain.duration_s() - 1e-9);
            assert!((slow.end().x - plain.end().x).abs() < 1e-6);
        }
    }
}
