//! What touches what, as the planner asks it: standing obstacles and the map's border, and the other vehicles' routes.

use glam::DVec2;

use super::judge::TOLERANCE_M;
use super::{BACK_M, BODY, FRONT_M, Instance, Mode, OBSTACLE_M, Route, STEP_M, Vehicle, WIDTH_M};
use crate::collision::Rectangle;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::Segment;

/// The distance that exact planning keeps, metres, which leaves room for the rounding of written numbers.
const MARGIN_M: f64 = 0.004;
/// The share of the margin that may be lost between the instants that are looked at.
const SLACK: f64 = 0.75;
/// What may be lost at least: it bounds the instants that are looked at where bodies touch. An end may overlap by as much,
/// so that both together are what the judge takes for rounding.
const MIN_SLACK_M: f64 = 0.5 * TOLERANCE_M;
/// Rear points stay this far inside the border in exact planning: an arc leaves the chord between instants an eighth of a
/// step apart by less.
const BORDER_M: f64 = 0.004;
/// The instants in a step at which rear points are compared with the border, and those for an end that is nearer to it: an
/// arc leaves the chord by 0.8 mm then, which the judge takes for rounding.
const BORDER_LOOKS: [u32; 2] = [8, 16];

/// Least distance of two rear axles at whole steps in [`Mode::Benchmark`], with a margin for rounding.
const CIRCLES_M: f64 = 4.472_135_954_999_58 + 1e-4;
/// Farther apart than this in the middle of a step, the centres of two bodies cannot have met in it: two circumscribed
/// circles of 1.803 m and what both drive in half a step, 1.059 m of the rear axle, on an arc 1.074 m of the centre.
const REACH_M: f64 = 2.0 * (1.803 + 1.075) + MARGIN_M;

/// A step of a vehicle: the pose at its beginning and the segment.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    pub from: Pose,
    pub step: Segment,
}

impl Motion {
    pub fn standing(pose: Pose) -> Self {
        Self { from: pose, step: Segment { curvature: 0.0, length_m: 0.0 } }
    }

    fn body_at(&self, share: f64) -> Rectangle {
        BODY.footprint(self.step.pose_at(self.from, share * self.step.length_m)).into()
    }

    /// Returns the most metres that a point of the body moves.
    fn reach_m(&self) -> f64 {
        self.step.length_m.abs() * BODY.farthest_point_rate(self.step.curvature)
    }

    /// Returns where the traffic looks at it: the rear axle at its end, or the body's centre in its middle.
    fn place(&self, mode: Mode) -> DVec2 {
        match mode {
            Mode::Benchmark => self.step.end(self.from).position(),
            Mode::Exact => BODY.body_centre(self.step.pose_at(self.from, 0.5 * self.step.length_m)),
        }
    }
}

/// The map as a vehicle alone meets it.
#[derive(Clone, Copy, Debug)]
pub struct StaticMap<'a> {
    instance: &'a Instance,
    mode: Mode,
    /// The distance from obstacles in [`Mode::Exact`].
    margin_m: f64,
    /// The distance of rear points from the border in [`Mode::Exact`].
    border_m: f64,
}

impl<'a> StaticMap<'a> {
    /// Prepares the map for one vehicle, unless it may not stand at its start or at its goal; then says whether that is
    /// the goal.
    pub fn new(instance: &'a Instance, mode: Mode, vehicle: &Vehicle) -> Result<Self, bool> {
        let mut ground = Self { instance, mode, margin_m: MARGIN_M, border_m: BORDER_M };
        for (pose, is_goal) in [(vehicle.start, false), (vehicle.goal, true)] {
            if mode == Mode::Exact {
                let body = Motion::standing(pose).body_at(0.0);
                let gaps = instance.obstacles.iter().map(|&centre| disc_gap(&body, centre));
                ground.margin_m = gaps.map(margin_at).fold(ground.margin_m, f64::min);
                let DVec2 { x, y } = (instance.size_m - pose.position()).min(pose.position());
                // An end that is nearer to the border would be refused, and the vehicle could not leave it.
                ground.border_m = ground.border_m.min(x.min(y));
            }
            let is_tested = is_goal || mode == Mode::Exact;
            if is_tested && (ground.margin_m < -MIN_SLACK_M || !ground.allows(&Motion::standing(pose))) {
                return Err(is_goal);
            }
        }
        Ok(ground)
    }

    /// Says whether a step keeps clear of obstacles and on the map.
    pub fn allows(&self, motion: &Motion) -> bool {
        match self.mode {
            Mode::Benchmark => {
                // The benchmark looks at poses at whole steps only.
                let end = motion.step.end(motion.from);
                let (sin, cos) = ops::sin_cos(end.heading);
                self.is_on_map(end, 0.0)
                    && !self.instance.obstacles.iter().any(|&centre| {
                        // In the vehicle's frame the benchmark grows the body by the radius, with square corners.
                        let (dx, dy) = (centre.x - end.x, centre.y - end.y);
                        let along = cos * dx + sin * dy;
                        let across = cos * dy - sin * dx;
                        along > -BACK_M - OBSTACLE_M - 1e-6
                            && along < FRONT_M + OBSTACLE_M + 1e-6
                            && across.abs() < 0.5 * WIDTH_M + OBSTACLE_M + 1e-6
                    })
            }
            Mode::Exact => {
                let [far, near] = BORDER_LOOKS;
                let on_arc = if self.border_m < BORDER_M { near } else { far };
                // A straight whose ends are on the map is on it all along, as the map is convex.
                let looks = if motion.step.curvature == 0.0 { 1 } else { on_arc };
                let is_inside = (1..=looks).all(|look| {
                    let share = f64::from(look) / f64::from(looks);
                    self.is_on_map(motion.step.pose_at(motion.from, share * motion.step.length_m), self.border_m)
                });
                let place = motion.place(Mode::Exact);
                // Half of what two bodies need, as an obstacle stands still.
                let reach_m = 0.5 * REACH_M + OBSTACLE_M;
                is_inside
                    && !self.instance.obstacles.iter().any(|&centre| {
                        // Most obstacles are too far from the middle for the search along the whole motion.
                        centre.distance_squared(place) < reach_m * reach_m
                            && comes_near(motion.reach_m(), self.margin_m, |share| {
                                disc_gap(&motion.body_at(share), centre)
                            })
                    })
            }
        }
    }

    fn is_on_map(&self, pose: Pose, inside_m: f64) -> bool {
        let DVec2 { x, y } = self.instance.size_m;
        (inside_m..=x - inside_m).contains(&pose.x) && (inside_m..=y - inside_m).contains(&pose.y)
    }
}

/// Returns the distance from a body to a disc; no less than the disc's negative radius.
fn disc_gap(body: &Rectangle, centre: DVec2) -> f64 {
    let offset = centre - body.centre;
    let seen = DVec2::new(offset.dot(body.axis), body.axis.perp_dot(offset)).abs();
    (seen - DVec2::new(body.half_length, body.half_width)).max(DVec2::ZERO).length() - OBSTACLE_M
}

/// Returns the margin that an end leaves: one that is tighter than [`MARGIN_M`] lowers it.
fn margin_at(gap_m: f64) -> f64 {
    MARGIN_M.min(if gap_m > 0.0 { 0.5 * gap_m } else { gap_m })
}

/// Says whether a gap becomes less than a margin within a step, in which it changes by no more than `change_m`: by
/// conservative advancement, as in [`crate::collision::first_conflict`].
///
/// It looks at no more than `change_m / MIN_SLACK_M` instants, and a gap that it lets pass never falls below the margin
/// by more than [`SLACK`] of it or [`MIN_SLACK_M`].
fn comes_near(change_m: f64, margin_m: f64, gap_at: impl Fn(f64) -> f64) -> bool {
    let slack_m = (SLACK * margin_m).max(MIN_SLACK_M);
    let mut share = 0.0;
    while share < 1.0 {
        let room_m = gap_at(share) - margin_m;
        if room_m < 0.0 {
            return true;
        }
        // Without any change the share becomes infinite.
        share += (room_m + slack_m) / change_m;
    }
    gap_at(1.0) < margin_m
}

/// The routes of the vehicles that have one, by steps.
#[derive(Clone, Debug)]
pub struct Traffic {
    mode: Mode,
    vehicles: usize,
    /// The distance of bodies in [`Mode::Exact`].
    margin_m: f64,
    /// For each step a place of every vehicle, see [`Motion::place`]; far away for those without a route. The last row
    /// holds forever.
    places: Vec<DVec2>,
    motions: Vec<Vec<Motion>>,
}

/// The place of what is not there.
const ABSENT: DVec2 = DVec2::INFINITY;

impl Traffic {
    pub fn new(mode: Mode, vehicles: usize) -> Self {
        let places = vec![ABSENT; vehicles];
        let motions = vec![Vec::new(); vehicles];
        Self { mode, vehicles, margin_m: MARGIN_M, places, motions }
    }

    /// Lowers the margin to what vehicles leave that stand at these poses together, if they do not overlap.
    pub fn make_room_for(&mut self, poses: &[Pose]) {
        let bodies: Vec<Rectangle> = poses.iter().map(|&pose| Motion::standing(pose).body_at(0.0)).collect();
        let gaps = bodies.iter().enumerate().flat_map(|(at, one)| bodies[..at].iter().map(|other| one.gap_to(other)));
        let margins = gaps.map(margin_at).filter(|&margin_m| margin_m >= -MIN_SLACK_M);
        self.margin_m = margins.fold(self.margin_m, f64::min);
    }

    /// Says whether two vehicles touch within a step.
    fn touch(&self, one: &Motion, other: &Motion) -> bool {
        let change_m = one.reach_m() + other.reach_m();
        comes_near(change_m, self.margin_m, |share| one.body_at(share).gap_to(&other.body_at(share)))
    }

    /// Returns the number of steps until all stand.
    pub fn horizon(&self) -> usize {
        self.places.len() / self.vehicles - 1
    }

    pub fn remove(&mut self, vehicle: usize) {
        self.motions[vehicle].clear();
        for row in self.places.chunks_exact_mut(self.vehicles) {
            row[vehicle] = ABSENT;
        }
    }

    pub fn insert(&mut self, vehicle: usize, route: &Route) {
        while self.horizon() < route.steps.len() {
            // All vehicles stand after their last step, so the last row holds for the new steps too.
            self.places.extend_from_within(self.places.len() - self.vehicles..);
        }
        let motions = &mut self.motions[vehicle];
        motions.clear();
        motions.extend(route.poses().zip(&route.steps).map(|(from, &step)| Motion { from, step }));
        let end = route.poses().last().unwrap_or(route.start);
        motions.push(Motion::standing(end));
        for (at, row) in self.places.chunks_exact_mut(self.vehicles).enumerate() {
            row[vehicle] = motions[at.min(motions.len() - 1)].place(self.mode);
        }
    }

    /// Calls `meet` with every vehicle that a step from time `at` on conflicts with.
    #[inline]
    pub fn for_each_conflict(&self, at: usize, motion: &Motion, mut meet: impl FnMut(usize)) {
        let row = self.vehicles * at.min(self.horizon());
        let place = motion.place(self.mode);
        let reach_m = if self.mode == Mode::Benchmark { CIRCLES_M } else { REACH_M };
        for (vehicle, other) in self.places[row..row + self.vehicles].iter().enumerate() {
            if other.distance_squared(place) < reach_m * reach_m {
                let motions = &self.motions[vehicle];
                if self.mode == Mode::Benchmark || self.touch(motion, &motions[at.min(motions.len() - 1)]) {
                    meet(vehicle);
                }
            }
        }
    }

    pub fn conflicts(&self, at: usize, motion: &Motion) -> u32 {
        let mut count = 0;
        self.for_each_conflict(at, motion, |_| count += 1);
        count
    }

    /// Calls `meet` with every vehicle that a whole route conflicts with, once for each step.
    pub fn for_each_conflict_of(&self, route: &Route, mut meet: impl FnMut(usize)) {
        let mut end = route.start;
        for (at, (from, &step)) in route.poses().zip(&route.steps).enumerate() {
            self.for_each_conflict(at, &Motion { from, step }, &mut meet);
            end = step.end(from);
        }
        // After its last step it stands there and blocks, for as long as any other drives.
        for at in route.steps.len()..=self.horizon() {
            self.for_each_conflict(at, &Motion::standing(end), &mut meet);
        }
    }

    /// Returns, by time, the number of conflicts of a vehicle that stands at a pose from then on; the last holds
    /// forever.
    pub fn conflicts_of_standing(&self, pose: Pose) -> Vec<u32> {
        let motion = Motion::standing(pose);
        let mut counts: Vec<u32> = (0..=self.horizon()).map(|at| self.conflicts(at, &motion)).collect();
        for at in (0..self.horizon()).rev() {
            counts[at] += counts[at + 1];
        }
        counts
    }
}

/// Splits a drive into steps of at most [`STEP_M`]: full ones, and a shorter last one of each segment.
pub fn steps_of(segments: impl Iterator<Item = Segment>) -> impl Iterator<Item = Segment> {
    segments.filter(|segment| segment.length_m.abs() > 1e-6).flat_map(|segment| {
        let length_m = segment.length_m.abs();
        // Rounding must not add a step of no length to a whole number of steps.
        let full = (length_m / STEP_M - 1e-9).floor() as usize;
        let rest = segment.with_length(length_m - full as f64 * STEP_M);
        std::iter::repeat_n(segment.with_length(STEP_M), full).chain((rest.length_m.abs() > 1e-9).then_some(rest))
    })
}
