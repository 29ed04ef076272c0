//! The tracks of a truck: its path from the start to where it stands.
//!
//! Where nothing else leads on, a truck drives back the way it came. What it has driven back is no longer part of its
//! tracks, so that the way back does not grow however often that happens.

use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Path, Segment};

/// Legs from the start to the present pose, each beginning where the one before ended.
#[derive(Clone, Debug, Default)]
pub struct Tracks {
    legs: Vec<Path>,
    /// Metres of the present leg that lead back over the last ones.
    leading_back_m: f64,
}

/// A path that begins by leading back over tracks.
#[derive(Debug)]
pub struct RetracedPath {
    pub path: Path,
    /// The metres of it that lead back.
    pub back_m: f64,
}

impl Tracks {
    pub fn legs(&self) -> usize {
        self.legs.len()
    }

    /// Returns where the last `legs` began; there must be at least one leg, and that many.
    pub fn start_of_last(&self, legs: usize) -> Pose {
        self.legs[self.legs.len() - legs].start
    }

    /// Returns a path from the present `pose` back over the last `legs` and then along `then`.
    pub fn retrace(&self, pose: Pose, legs: usize, then: Path) -> RetracedPath {
        let back: Vec<Segment> = self.legs.iter().rev().take(legs).flat_map(|leg| leg.reversed().segments).collect();
        let back_m = back.iter().map(|segment| segment.length_m.abs()).sum();
        let path = Path { start: pose, segments: back.into_iter().chain(then.segments).collect() };
        RetracedPath { path, back_m }
    }

    /// Notes that the truck sets out on a leg whose first metres lead back.
    pub fn set_out(&mut self, back_m: f64) {
        self.leading_back_m = back_m;
    }

    /// Adds the leg as it was driven; `None` if the truck never moved.
    pub fn record(&mut self, driven: Option<Path>) {
        let leading_back_m = std::mem::take(&mut self.leading_back_m);
        let Some(driven) = driven else { return };
        // It may have been cut short before it was back.
        let back_m = leading_back_m.min(driven.length_m());
        self.remove_last(back_m);
        let [_, onward] = driven.split_at(back_m);
        if !onward.segments.is_empty() {
            self.legs.push(onward);
        }
    }

    fn remove_last(&mut self, mut metres: f64) {
        while metres > 0.0
            && let Some(leg) = self.legs.pop()
        {
            let length_m = leg.length_m();
            if metres < length_m {
                let [kept, _] = leg.split_at(length_m - metres);
                self.legs.push(kept);
            }
            metres -= length_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leg(start: Pose, lengths_m: &[f64]) -> Path {
        let segment = |(k, &length_m)| Segment { curvature: [0.0, 0.05, -0.07][k % 3], length_m };
        Path { start, segments: lengths_m.iter().enumerate().map(segment).collect() }
    }

    fn driven() -> (Tracks, Pose) {
        let mut tracks = Tracks::default();
        let mut pose = Pose::new(50.0, 50.0, 0.4);
        for lengths_m in [&[10.0, 4.0, -3.0][..], &[8.0], &[-5.0, 6.0]] {
            let leg = leg(pose, lengths_m);
            pose = leg.end();
            tracks.record(Some(leg));
        }
        (tracks, pose)
    }

    fn set_out_back(tracks: &mut Tracks, pose: Pose, legs: usize, then: Path) -> Path {
        let RetracedPath { path, back_m } = tracks.retrace(pose, legs, then);
        tracks.set_out(back_m);
        path
    }

    fn assert_leads_home(tracks: Tracks, pose: Pose) {
        let legs = tracks.legs();
        let home = tracks.retrace(pose, legs, Path::standing(pose)).path.end();
        assert!((home.position() - Pose::new(50.0, 50.0, 0.4).position()).length() < 1e-9, "{home:?}");
        assert!((home.heading - 0.4).abs() < 1e-9);
    }

    #[test]
    fn tracks_lead_back_to_the_start() {
        let (tracks, pose) = driven();
        assert_leads_home(tracks, pose);
    }

    #[test]
    fn what_was_driven_back_is_no_longer_part_of_the_way() {
        let (mut tracks, pose) = driven();
        let turning = tracks.start_of_last(2);
        let path = set_out_back(&mut tracks, pose, 2, leg(turning, &[2.0, 3.0]));
        let end = path.end();
        tracks.record(Some(path));
        assert_eq!(tracks.legs(), 2);
        assert!((tracks.legs.iter().map(Path::length_m).sum::<f64>() - (17.0 + 5.0)).abs() < 1e-9);
        assert_leads_home(tracks, end);
    }

    #[test]
    fn a_way_back_that_was_never_started_takes_nothing_off() {
        let (mut tracks, pose) = driven();
        set_out_back(&mut tracks, pose, 3, Path::standing(pose));
        tracks.record(None);
        let leg = leg(pose, &[2.0]);
        let end = leg.end();
        tracks.record(Some(leg));
        assert_eq!(tracks.legs(), 4);
        assert_leads_home(tracks, end);
    }

    #[test]
    fn breaking_off_again_and_again_on_the_way_back_adds_nothing() {
        let (mut tracks, mut pose) = driven();
        let mut length_m: f64 = tracks.legs.iter().map(Path::length_m).sum();
        for cut_m in [1.0, 4.5, 0.25, 9.0, 6.0] {
            let legs = tracks.legs();
            let path = set_out_back(&mut tracks, pose, legs, Path::standing(pose));
            let [cut, _] = path.split_at(cut_m);
            pose = cut.end();
            tracks.record(Some(cut));
            length_m -= cut_m;
            assert!((tracks.legs.iter().map(Path::length_m).sum::<f64>() - length_m).abs() < 1e-9);
        }
        assert_leads_home(tracks, pose);
    }
}
