//! A planner whose paths are smoothed for wheels that turn at a limited rate.
//!
//! Planners join arcs and straights as if wheels turned at once. Where they do not, a truck can drive such a path only if it
//! stands at every corner of curvature until its wheels have turned, and does so ([`SpeedLimits`]). This planner takes
//! the path of another and puts clothoids in place of corners where they fit, so that the truck need not stop there: see
//! [`SteeringLimits`] for the curves and their source.
//!
//! A clothoid that is centred on its corner turns the truck by as much as the corner did, and leads a few centimetres aside.
//! The lengths of the path's own segments take that up, all together and by as little as possible (Gauss-Newton steps of
//! least norm), until the path ends where it did: in the same pose, or for a disc with the body's centre at the same
//! place. What touches something, or takes longer than the stop, is not done: it is tried again at half the speed, on a
//! shorter clothoid, and so on; after four times the stop stays.
//!
//! A smooth path lies centimetres beside the one that was planned. It keeps [`MIN_CLEARANCE_M`], and the clearance that the
//! planner was asked for up to that.

use glam::{DMat3, DVec2, DVec3};

use super::observer::PlanningObserver;
use super::{BuildReport, Goal, GoalDisc, NearestPlan, NullObserver, Plan, TruckPlanner};
use crate::collision::{CollisionChecker, MIN_CLEARANCE_M};
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::{Path, Segment, SteeringLimits};

/// The shares of the speed that a corner allows at which clothoids are tried.
const SPEED_SHARES: [f64; 5] = [1.0, 0.5, 0.25, 0.125, 0.0625];
/// A clothoid must save at least this.
const WORTH_S: f64 = 1e-6;
/// A radian at the end counts as much as these metres.
const LEVER_M: f64 = 10.0;
/// The end of a smooth path is off by less than this, in metres, and radians over [`LEVER_M`].
const END_M: f64 = 1e-9;
/// Steps in which lengths are adjusted.
const MAX_STEPS: u32 = 20;
/// Keeps steps finite where lengths cannot move the end every way.
const DAMPING: f64 = 1e-9;

/// A planner and the smoother of its paths.
pub struct SmoothSteering {
    planner: Box<dyn TruckPlanner>,
    smoother: CurvatureSmoother,
}

impl SmoothSteering {
    pub fn new(planner: Box<dyn TruckPlanner>, smoother: CurvatureSmoother) -> Self {
        Self { planner, smoother }
    }

    fn smoothed(&self, plan: Plan, ends_in_pose: bool) -> Plan {
        Plan { path: plan.path.map(|path| self.smoother.smooth(&path, ends_in_pose)), ..plan }
    }
}

impl TruckPlanner for SmoothSteering {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        let plan = self.planner.plan_observed(start, goal, observer);
        self.smoothed(plan, matches!(goal, Goal::Pose(_)))
    }

    fn plan_to_nearest(
        &mut self,
        start: Pose,
        discs: &[GoalDisc],
        observer: &mut dyn PlanningObserver,
    ) -> Option<NearestPlan> {
        let NearestPlan { index, plan } = self.planner.plan_to_nearest(start, discs, observer)?;
        Some(NearestPlan { index, plan: self.smoothed(plan, false) })
    }

    fn build_report(&self) -> BuildReport {
        self.planner.build_report()
    }

    fn show_roadmap(&mut self, observer: &mut dyn PlanningObserver) {
        self.planner.show_roadmap(observer);
    }
}

/// Replaces jumps of curvature by clothoids, for one body on one field.
#[derive(Clone, Debug)]
pub struct CurvatureSmoother {
    checker: CollisionChecker,
    limits: SpeedLimits,
    steering: SteeringLimits,
}

impl CurvatureSmoother {
    /// `None` if the truck steers at once.
    pub fn new(checker: &CollisionChecker, limits: &SpeedLimits) -> Option<Self> {
        limits.steering.map(|steering| Self { checker: checker.clone(), limits: *limits, steering })
    }

    /// Returns a path that takes no longer, from the same pose to the same pose or, if that fails, to the same position
    /// of the body's centre.
    pub fn smooth(&self, path: &Path, ends_in_pose: bool) -> Path {
        // Two arcs of one curvature have no corner between them, so they must be one segment first.
        let path = path.clone().joined();
        let mut corners = SmoothedPath {
            steering: self.steering,
            centre_offset_m: self.checker.body().centre_offset_m(),
            start: path.start,
            segments: &path.segments,
            speeds_mps: vec![None; path.segments.len()],
        };
        let wanted = corners.end_of(path.end());
        let mut best_s = self.limits.drive_s(&path.segments);
        let mut best = path.clone();
        // Each corner is tried with the clothoids that earlier ones have got.
        for (corner, pair) in path.segments.windows(2).enumerate() {
            let [before, behind] = [pair[0], pair[1]];
            // At a cusp the truck stands anyway, and its wheels turn meanwhile.
            if before.is_reverse() != behind.is_reverse() || self.steering.is_step(before.curvature, behind.curvature) {
                continue;
            }
            let speed_mps = self.limits.speed_on(&before).min(self.limits.speed_on(&behind));
            let smooth = SPEED_SHARES.into_iter().find_map(|share| {
                corners.speeds_mps[corner] = Some(share * speed_mps);
                let smooth = corners.fit(wanted, ends_in_pose)?;
                let drive_s = self.limits.drive_s(&smooth.segments);
                // Time before the sweep, which takes far longer than a sum.
                (drive_s < best_s - WORTH_S && self.is_free(&smooth)).then_some((smooth, drive_s))
            });
            match smooth {
                Some(smooth) => (best, best_s) = smooth,
                // Nothing fits here, so the truck stops as it does on the path without clothoids.
                None => corners.speeds_mps[corner] = None,
            }
        }
        best
    }

    fn is_free(&self, path: &Path) -> bool {
        path.legs().all(|(start, segment)| self.checker.motion_is_free(start, segment, MIN_CLEARANCE_M))
    }
}

/// The end of a path: where the body's centre is, and which way it points.
#[derive(Clone, Copy)]
struct PathEnd {
    centre: DVec2,
    heading: f64,
}

/// A path, and the speeds at which clothoids replace the corner behind each of its segments.
struct SmoothedPath<'a> {
    steering: SteeringLimits,
    centre_offset_m: f64,
    start: Pose,
    segments: &'a [Segment],
    speeds_mps: Vec<Option<f64>>,
}

impl SmoothedPath<'_> {
    /// Returns the path with its clothoids, which ends as wanted; `None` if its segments are too short for that.
    fn fit(&self, wanted: PathEnd, ends_in_pose: bool) -> Option<Path> {
        let lever_m = if ends_in_pose { LEVER_M } else { 0.0 };
        // Where the heading does not count, its row is zero, and needs no more than to be solvable.
        let damping = DVec3::new(DAMPING, DAMPING, if ends_in_pose { DAMPING } else { 1.0 });
        let mut lengths_m = self.lengths_between();
        for _ in 0..MAX_STEPS {
            // A segment that has no length left, or one the other way, has taken up all that it can.
            if lengths_m
                .iter()
                .zip(self.segments)
                .any(|(length_m, segment)| length_m * segment.length_m.signum() <= 0.0)
            {
                return None;
            }
            let path = self.path(&lengths_m);
            let end = self.end_of(path.end());
            let gap = wanted.centre - end.centre;
            let turn = ops::wrap_angle(wanted.heading - end.heading);
            let miss = DVec3::new(gap.x, gap.y, lever_m * turn);
            if miss.length() < END_M {
                return Some(path);
            }
            let moves = self.moves(&lengths_m, end.centre, lever_m);
            let normal = moves.iter().fold(DMat3::from_diagonal(damping), |sum, &column| {
                sum + DMat3::from_cols(column * column.x, column * column.y, column * column.z)
            });
            // The minimum-norm step that moves the end by `miss`: lengths change by the columns times these shares.
            let shares = normal.inverse() * miss;
            for (length_m, column) in lengths_m.iter_mut().zip(moves) {
                *length_m += column.dot(shares);
            }
        }
        None
    }

    fn end_of(&self, pose: Pose) -> PathEnd {
        PathEnd { centre: pose.position() + pose.direction() * self.centre_offset_m, heading: pose.heading }
    }

    /// Returns the arcs in place of the corner behind a segment, none where there is no clothoid.
    fn clothoid(&self, corner: usize) -> impl Iterator<Item = Segment> + use<> {
        let arcs = self.speeds_mps[corner].map(|speed_mps| {
            let [before, behind] = [self.segments[corner], self.segments[corner + 1]];
            let sense = before.length_m.signum();
            self.steering.clothoid(before.curvature, behind.curvature, sense, speed_mps)
        });
        arcs.into_iter().flatten()
    }

    /// Returns the lengths of the segments, less the halves of the clothoids at their ends.
    fn lengths_between(&self) -> Vec<f64> {
        let mut lengths_m: Vec<f64> = self.segments.iter().map(|segment| segment.length_m).collect();
        for corner in 0..self.segments.len() - 1 {
            let half_m = 0.5 * self.clothoid(corner).map(|arc| arc.length_m).sum::<f64>();
            lengths_m[corner] -= half_m;
            lengths_m[corner + 1] -= half_m;
        }
        lengths_m
    }

    /// Returns the path whose own segments have these lengths.
    fn path(&self, lengths_m: &[f64]) -> Path {
        let arcs = self.segments.iter().zip(lengths_m).enumerate();
        let segments = arcs.flat_map(|(index, (segment, &length_m))| {
            std::iter::once(Segment { length_m, ..*segment }).chain(self.clothoid(index))
        });
        Path { start: self.start, segments: segments.collect() }
    }

    /// Returns by how much the end moves with the length of each segment of its own: what follows is shifted along, and
    /// turned about the segment's end.
    fn moves(&self, lengths_m: &[f64], centre: DVec2, lever_m: f64) -> Vec<DVec3> {
        let mut pose = self.start;
        let arcs = self.segments.iter().zip(lengths_m).enumerate();
        let columns = arcs.map(|(index, (segment, &length_m))| {
            pose = Segment { length_m, ..*segment }.end(pose);
            let by = pose.direction() + (centre - pose.position()).perp() * segment.curvature;
            pose = self.clothoid(index).fold(pose, |pose, arc| arc.end(pose));
            DVec3::new(by.x, by.y, lever_m * segment.curvature)
        });
        columns.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_fields::{TestField, least_clearance};
    use super::*;
    use crate::planners;
    use crate::registry::OwnedSettings;
    use wildfire_base::time::SimTime;
    use wildfire_base::trajectory::{Piece, Trajectory};
    use wildfire_base::vehicle::STEERING_STEP_S;

    /// A truck that turns its wheels by 20 degrees a second.
    const LIMITS: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 4.0,
        acceleration_mps2: Some(2.0),
        braking_mps2: Some(4.0),
        lateral_mps2: Some(3.0),
        steering: Some(STEERING),
    };
    const STEERING: SteeringLimits = SteeringLimits { rate_rad_s: 0.349, wheelbase_m: 3.0 };

    fn corners(path: &Path) -> usize {
        let is_corner = |pair: &[Segment]| {
            pair[0].is_reverse() == pair[1].is_reverse() && !STEERING.is_step(pair[0].curvature, pair[1].curvature)
        };
        path.segments.windows(2).filter(|pair| is_corner(pair)).count()
    }

    #[test]
    fn smooth_drives_end_where_they_did_touch_nothing_and_take_no_longer() {
        let mut sharp = 0;
        let mut left = 0;
        let mut before_s = 0.0;
        let mut after_s = 0.0;
        for seed in 0..10 {
            let mut field = TestField::random(seed, 40);
            let mut planner = field.make(&OwnedSettings::default(), seed, planners::hybrid_astar::HybridAstar::build);
            let smoother = CurvatureSmoother::new(&field.checker, &LIMITS).expect("its wheels take their time");
            let body = *field.checker.body();
            for turn in 0..10 {
                let disc = field.random_goal();
                let to_disc = planner.plan(field.start, disc.into()).path;
                let Ok(path) = to_disc else { continue };
                let as_pose = turn % 2 == 0;
                let smooth = smoother.smooth(&path, as_pose);
                assert_eq!(smooth.start, path.start);
                assert!(body.body_centre(smooth.end()).distance(body.body_centre(path.end())) < 1e-8);
                if as_pose {
                    assert!(ops::wrap_angle(smooth.end().heading - path.end().heading).abs() < 1e-9);
                }
                assert!(smooth.segments.iter().all(|segment| segment.curvature.abs() <= body.max_curvature()));
                assert_eq!(smooth.cusps(), path.cusps());
                assert!(least_clearance(&field.checker, &smooth) > 0.0);
                let [of_path, of_smooth] = [&path, &smooth].map(|path| LIMITS.drive_s(&path.segments));
                assert!(of_smooth <= of_path + 1e-9, "{of_smooth} s, {of_path} s before");
                (before_s, after_s) = (before_s + of_path, after_s + of_smooth);
                (sharp, left) = (sharp + corners(&path), left + corners(&smooth));
            }
        }
        assert!(left * 4 < sharp && sharp > 100, "{left} of {sharp} corners are left");
        assert!(after_s < 0.85 * before_s, "{after_s} s, {before_s} s before");
    }

    #[test]
    fn the_steering_of_a_smooth_drive_never_jumps_farther_than_its_wheels_turn() {
        let mut field = TestField::random(3, 40);
        let mut planner = field.make(&OwnedSettings::default(), 3, planners::hybrid_astar::HybridAstar::build);
        let smoother = CurvatureSmoother::new(&field.checker, &LIMITS).expect("its wheels take their time");
        for _ in 0..10 {
            let goal = field.random_goal();
            let Ok(path) = planner.plan(field.start, goal.into()).path else { continue };
            let drive = Trajectory::from_path(&smoother.smooth(&path, false), SimTime::ZERO, LIMITS);
            let (mut wheels, mut stood_s) = (0.0, 0.0);
            for piece in drive.pieces() {
                match *piece {
                    Piece::Wait { seconds } => stood_s += seconds,
                    Piece::Drive { segment, .. } => {
                        let turning_s = STEERING.turning_s(wheels, segment.curvature);
                        assert!(turning_s <= f64::max(stood_s, STEERING_STEP_S) + 1e-9, "{turning_s} s in {stood_s} s");
                        (wheels, stood_s) = (segment.curvature, 0.0);
                    }
                    Piece::Turn { .. } => unreachable!("trucks do not turn on the spot"),
                }
            }
        }
    }

    /// Makes the clothoids that are tried first for two corners, and looks at the solver alone.
    #[test]
    fn lengths_take_up_what_clothoids_lead_aside() {
        let k = 1.0 / 13.0;
        let segment = |curvature, length_m| Segment { curvature, length_m };
        let segments = [segment(k, 20.0), segment(0.0, 30.0), segment(-k, 15.0), segment(0.0, -20.0)];
        let start = Pose::new(40.0, 60.0, 0.3);
        let path = Path { start, segments: segments.to_vec() };
        let speeds_mps = vec![Some(6.0), Some(6.0), None, None];
        let corners = SmoothedPath { steering: STEERING, centre_offset_m: 1.5, start, segments: &segments, speeds_mps };
        let wanted = corners.end_of(path.end());
        let smooth = corners.fit(wanted, true).expect("its segments are long enough");
        assert!(smooth.end().position().distance(path.end().position()) < 1e-8);
        assert!(ops::wrap_angle(smooth.end().heading - path.end().heading).abs() < 1e-9);
        assert!(smooth.segments.len() > path.segments.len() + 8);
        let aside_m = smooth.samples(0.5).map(|(metres, pose)| {
            let share = metres / smooth.length_m() * path.length_m();
            pose.position().distance(path.pose_at(share).position())
        });
        assert!(aside_m.fold(0.0, f64::max) < 1.0);
        let short = [segment(k, 1.0), segment(0.0, 1.0), segment(-k, 1.0), segment(0.0, -20.0)];
        assert!(SmoothedPath { segments: &short, ..corners }.fit(wanted, true).is_none());
    }

    #[test]
    fn only_trucks_whose_wheels_take_their_time_have_their_paths_smoothed() {
        let field = TestField::random(1, 25);
        let at_once = SpeedLimits { steering: None, ..LIMITS };
        assert!(CurvatureSmoother::new(&field.checker, &at_once).is_none());
    }
}
