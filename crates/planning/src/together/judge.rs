//! An independent check of schedules, the program's own and foreign ones.
//!
//! It shares nothing with the planner but the constants: poses within a step are turned about the centre of turning, bodies
//! are polygons of four corners, and what happens between whole steps is decided by halving a step until the bodies are
//! proven free, or touch: they cannot come nearer than their fastest points allow.

use std::f64::consts::PI;
use std::fmt;

use glam::DVec2;

use super::{BACK_M, FRONT_M, Instance, Mode, OBSTACLE_M, RADIUS_M, Route, STEP_M, WIDTH_M};
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::Segment;

/// Overlaps up to this are taken for rounding, those of more than twice as much are always found, metres.
pub const TOLERANCE_M: f64 = 0.001;
/// Distance at which a step may miss the pose that its arc leads to, for schedules that were rounded; and a schedule its
/// start and its goal.
pub const ROUNDING_M: f64 = 0.01;
/// The same for headings, radians.
pub const ROUNDING_RAD: f64 = 0.005;
/// A share by which an arc may be tighter than the turning radius, through rounding.
const TIGHTER: f64 = 0.01;

/// The poses of one vehicle at whole steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    pub name: String,
    /// The first is that of step 0; after the last the vehicle stands.
    pub poses: Vec<Pose>,
}

/// A broken rule.
#[derive(Clone, Debug, PartialEq)]
pub enum RuleBreach {
    /// A vehicle of the instance has no schedule, or one of none.
    Missing(String),
    /// A schedule does not begin at the start, or end at the goal.
    WrongEnd { vehicle: String, is_goal: bool, off_m: f64, off_rad: f64 },
    /// No arc or line that the vehicle can drive in a step leads from one pose to the next.
    Undrivable { vehicle: String, step: usize },
    /// The rear axle leaves the map.
    OffMap { vehicle: String, time: f64 },
    /// A body touches an obstacle.
    Obstacle { vehicle: String, obstacle: usize, time: f64, depth_m: f64 },
    /// Two vehicles touch, or their circles in [`Mode::Benchmark`].
    Vehicles { names: [String; 2], time: f64, depth_m: f64 },
}

impl fmt::Display for RuleBreach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing(vehicle) => write!(f, "{vehicle} has no schedule"),
            Self::WrongEnd { vehicle, is_goal, off_m, off_rad } => {
                let end =
                    if *is_goal { "ends at a distance from its goal" } else { "begins at a distance from its start" };
                write!(f, "{vehicle} {end}: {off_m:.3} m and {off_rad:.3} rad")
            }
            Self::Undrivable { vehicle, step } => {
                write!(f, "{vehicle} cannot drive from its pose at step {step} to the next within a step")
            }
            Self::OffMap { vehicle, time } => write!(f, "{vehicle} leaves the map at step {time:.2}"),
            Self::Obstacle { vehicle, obstacle, time, depth_m } => {
                write!(f, "{vehicle} overlaps obstacle {obstacle} by {depth_m:.3} m at step {time:.2}")
            }
            Self::Vehicles { names: [one, other], time, depth_m } => {
                write!(f, "{one} and {other} overlap by {depth_m:.3} m at step {time:.2}")
            }
        }
    }
}

/// The result of the check of a solution.
#[derive(Debug)]
pub struct ScheduleCheck {
    /// The first fault of every vehicle, of every vehicle with an obstacle, and of every pair.
    pub faults: Vec<RuleBreach>,
    /// The routes, in the order of the instance, if all steps can be driven.
    pub routes: Option<Vec<Route>>,
}

/// Checks a schedule for every vehicle of an instance.
pub fn check(instance: &Instance, mode: Mode, schedules: &[Schedule]) -> ScheduleCheck {
    let mut faults = Vec::new();
    let mut tracks = Vec::new();
    let mut routes = Vec::new();
    for vehicle in &instance.vehicles {
        let schedule = schedules.iter().find(|schedule| schedule.name == vehicle.name);
        // A single pose is both the first and the last.
        let Some((schedule, [first, .., last] | [first @ last])) =
            schedule.map(|schedule| (schedule, schedule.poses.as_slice()))
        else {
            faults.push(RuleBreach::Missing(vehicle.name.clone()));
            continue;
        };
        for (is_goal, found, requested) in [(false, first, vehicle.start), (true, last, vehicle.goal)] {
            let off_m = (found.position() - requested.position()).length();
            let off_rad = ops::wrap_angle(found.heading - requested.heading).abs();
            // Written so that what is not a number is a fault.
            if !(off_m <= ROUNDING_M && off_rad <= ROUNDING_RAD) {
                faults.push(RuleBreach::WrongEnd { vehicle: vehicle.name.clone(), is_goal, off_m, off_rad });
            }
        }
        let steps: Vec<Option<JudgedStep>> =
            schedule.poses.windows(2).map(|pair| JudgedStep::between(pair[0], pair[1])).collect();
        match steps.iter().position(Option::is_none) {
            // Without steps the vehicle has no track: it cannot be tested against others.
            Some(step) => faults.push(RuleBreach::Undrivable { vehicle: vehicle.name.clone(), step }),
            None => {
                let mut steps: Vec<JudgedStep> = steps.into_iter().flatten().collect();
                let segments = steps.iter().map(|step| step.segment).collect();
                routes.push(Route { start: *first, steps: segments });
                // Forever, as others may still drive when it has arrived.
                steps.push(JudgedStep::standing(*last));
                tracks.push(VehicleTrack { name: &vehicle.name, steps });
            }
        }
    }
    // Whatever other vehicles did wrong, so that one check reports all that it can.
    for track in &tracks {
        faults.extend(off_map(instance, mode, track));
        let touched = instance.obstacles.iter().enumerate().filter_map(|(index, &centre)| {
            let (time, depth_m) = touches_obstacle(mode, track, centre)?;
            Some(RuleBreach::Obstacle { vehicle: track.name.to_owned(), obstacle: index, time, depth_m })
        });
        faults.extend(touched);
    }
    for (index, one) in tracks.iter().enumerate() {
        // Each pair once.
        for other in &tracks[..index] {
            if let Some((time, depth_m)) = vehicles_touch(mode, other, one) {
                let names = [other.name.to_owned(), one.name.to_owned()];
                faults.push(RuleBreach::Vehicles { names, time, depth_m });
            }
        }
    }
    // A missing route leaves nothing to price.
    ScheduleCheck { faults, routes: (routes.len() == instance.vehicles.len()).then_some(routes) }
}

/// A vehicle's steps; the last, which stands, is forever.
struct VehicleTrack<'a> {
    name: &'a str,
    steps: Vec<JudgedStep>,
}

impl VehicleTrack<'_> {
    fn step(&self, at: usize) -> &JudgedStep {
        &self.steps[at.min(self.steps.len() - 1)]
    }
}

/// A drive within a step: the body's corners at its beginning, and how they move.
struct JudgedStep {
    rear: DVec2,
    /// The radius of a circle about the rear axle at the beginning that holds the whole motion.
    reach_m: f64,
    corners: [DVec2; 4],
    motion: JudgedMotion,
    /// The most metres that a corner covers.
    corner_m: f64,
    segment: Segment,
}

enum JudgedMotion {
    Line(DVec2),
    Turn { centre: DVec2, angle: f64 },
}

impl JudgedStep {
    fn standing(pose: Pose) -> Self {
        Self::new(pose, JudgedMotion::Line(DVec2::ZERO), Segment { curvature: 0.0, length_m: 0.0 })
    }

    fn new(from: Pose, motion: JudgedMotion, segment: Segment) -> Self {
        let rear = from.position();
        let (sin, cos) = ops::sin_cos(from.heading);
        let along = DVec2::new(cos, sin);
        let left = DVec2::new(-sin, cos);
        let half = 0.5 * WIDTH_M;
        let corners = [(FRONT_M, half), (-BACK_M, half), (-BACK_M, -half), (FRONT_M, -half)]
            .map(|(ahead, aside)| rear + along * ahead + left * aside);
        // No corner moves farther than this, which bounds how fast gaps close in `first_touch`.
        let corner_m = match &motion {
            JudgedMotion::Line(shift) => shift.length(),
            JudgedMotion::Turn { centre, angle } => {
                corners.iter().map(|corner| (*corner - *centre).length() * angle.abs()).fold(0.0, f64::max)
            }
        };
        let reach_m = corners.iter().map(|corner| (*corner - rear).length()).fold(0.0, f64::max) + corner_m;
        Self { rear, reach_m, corners, motion, corner_m, segment }
    }

    /// Finds the line or the arc from one pose to another, if the vehicle can drive it in a step.
    fn between(from: Pose, to: Pose) -> Option<Self> {
        let numbers = [from.x, from.y, from.heading, to.x, to.y, to.heading];
        // Comparisons below are false for what is not a number, and would let it pass.
        if !numbers.iter().all(|number| number.is_finite()) {
            return None;
        }
        let chord = to.position() - from.position();
        let turn = ops::wrap_angle(to.heading - from.heading);
        let (sin, cos) = ops::sin_cos(from.heading + 0.5 * turn);
        let along_m = chord.dot(DVec2::new(cos, sin));
        let aside_m = chord.dot(DVec2::new(-sin, cos));
        // The chord of an arc lies along its mean heading.
        if aside_m.abs() > ROUNDING_M {
            return None;
        }
        if chord.length() < 1e-9 && turn.abs() < 1e-9 {
            return Some(Self::standing(from));
        }
        let is_straight =
            // Rounded poses of a straight turn by a little.
            turn.abs() < 1e-6 || (turn.abs() < ROUNDING_RAD && chord.length() > RADIUS_M * 2.0 * turn.abs());
        let length_m = if is_straight { along_m } else { along_m * 0.5 * turn / ops::sin(0.5 * turn) };
        // No vehicle turns by more than a quarter within a step.
        if length_m.abs() > STEP_M + ROUNDING_M || turn.abs() > 0.5 * PI {
            return None;
        }
        if is_straight {
            return Some(Self::new(from, JudgedMotion::Line(chord), Segment { curvature: 0.0, length_m }));
        }
        let curvature = turn / length_m;
        // Rounded poses of a short arc say little about its radius.
        let min_m = RADIUS_M * turn.abs() * (1.0 - TIGHTER) - ROUNDING_M;
        if length_m.abs() < min_m || length_m == 0.0 {
            return None;
        }
        // From the middle of the chord at a right angle, so that the turn ends exactly at the next pose.
        let centre =
            0.5 * (from.position() + to.position()) + DVec2::new(-chord.y, chord.x) * (0.5 / ops::tan(0.5 * turn));
        Some(Self::new(from, JudgedMotion::Turn { centre, angle: turn }, Segment { curvature, length_m }))
    }

    fn moved(&self, point: DVec2, share: f64) -> DVec2 {
        match self.motion {
            JudgedMotion::Line(shift) => point + shift * share,
            JudgedMotion::Turn { centre, angle } => {
                let (sin, cos) = ops::sin_cos(angle * share);
                let arm = point - centre;
                centre + DVec2::new(cos * arm.x - sin * arm.y, sin * arm.x + cos * arm.y)
            }
        }
    }

    fn corners_at(&self, share: f64) -> [DVec2; 4] {
        self.corners.map(|corner| self.moved(corner, share))
    }

    fn rear_at(&self, share: f64) -> DVec2 {
        self.moved(self.rear, share)
    }
}

/// Finds an instant of a step at which a gap is below zero by more than the tolerance, given that it changes by no more
/// than `change_m` in the whole step.
fn first_touch(change_m: f64, gap_at: &dyn Fn(f64) -> f64) -> Option<(f64, f64)> {
    let mut parts = vec![(0.0, 1.0)];
    while let Some((from, to)) = parts.pop() {
        let middle: f64 = 0.5 * (from + to);
        let gap_m = gap_at(middle);
        if gap_m < -TOLERANCE_M {
            return Some((middle, -gap_m));
        }
        if gap_m - 0.5 * (to - from) * change_m <= -2.0 * TOLERANCE_M {
            // The earlier half comes first.
            parts.extend([(middle, to), (from, middle)]);
        }
    }
    None
}

fn off_map(instance: &Instance, mode: Mode, track: &VehicleTrack) -> Option<RuleBreach> {
    let DVec2 { x, y } = instance.size_m;
    let inside = |point: DVec2| point.x.min(point.y).min(x - point.x).min(y - point.y);
    track.steps.iter().enumerate().find_map(|(at, step)| {
        let share = match mode {
            Mode::Benchmark => (inside(step.rear) < -TOLERANCE_M).then_some(0.0),
            Mode::Exact => first_touch(step.corner_m, &|share| inside(step.rear_at(share))).map(|(share, _)| share),
        }?;
        Some(RuleBreach::OffMap { vehicle: track.name.to_owned(), time: at as f64 + share })
    })
}

fn touches_obstacle(mode: Mode, track: &VehicleTrack, centre: DVec2) -> Option<(f64, f64)> {
    // The benchmark does not compare starts with obstacles.
    let skipped = usize::from(mode == Mode::Benchmark);
    track.steps.iter().enumerate().skip(skipped).find_map(|(at, step)| {
        // Twice the radius also covers the benchmark's square corners, which are 1.42 radii away.
        if (step.rear - centre).length() > step.reach_m + 2.0 * OBSTACLE_M {
            return None;
        }
        let (share, depth_m) = match mode {
            Mode::Benchmark => {
                let gap_m = signed_sides(&step.corners, centre).fold(f64::NEG_INFINITY, f64::max) - OBSTACLE_M;
                (gap_m < -TOLERANCE_M).then_some((0.0, -gap_m))?
            }
            Mode::Exact => {
                first_touch(step.corner_m, &|share| distance_to(&step.corners_at(share), centre) - OBSTACLE_M)?
            }
        };
        Some((at as f64 + share, depth_m))
    })
}

fn vehicles_touch(mode: Mode, one: &VehicleTrack, other: &VehicleTrack) -> Option<(f64, f64)> {
    let circles_m = ops::hypot(2.0 * FRONT_M, WIDTH_M);
    // The vehicle that arrives first stands at its goal until the other has arrived.
    (0..one.steps.len().max(other.steps.len())).find_map(|at| {
        let (a, b) = (one.step(at), other.step(at));
        let apart_m = (a.rear - b.rear).length();
        let (share, depth_m) = match mode {
            Mode::Benchmark => (apart_m < circles_m - TOLERANCE_M).then_some((0.0, circles_m - apart_m))?,
            Mode::Exact if apart_m > a.reach_m + b.reach_m => return None,
            Mode::Exact => first_touch(a.corner_m + b.corner_m, &|share| {
                let a = a.corners_at(share);
                let b = b.corners_at(share);
                widest_gap(&a, &b).max(widest_gap(&b, &a))
            })?,
        };
        Some((at as f64 + share, depth_m))
    })
}

/// The distances of a point to the lines through the sides of a polygon, positive outside; corners counter-clockwise.
fn signed_sides(corners: &[DVec2; 4], point: DVec2) -> impl Iterator<Item = f64> + '_ {
    (0..4).map(move |side| {
        let from = corners[side];
        let to = corners[(side + 1) % 4];
        (to - from).normalize().perp_dot(from - point)
    })
}

/// The widest gap that a side of the first polygon leaves to the second; negative if there is none.
fn widest_gap(first: &[DVec2; 4], second: &[DVec2; 4]) -> f64 {
    (0..4)
        .map(|side| {
            let (from, to) = (first[side], first[(side + 1) % 4]);
            let along = (to - from).normalize();
            second.iter().map(|&corner| along.perp_dot(from - corner)).fold(f64::INFINITY, f64::min)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// The distance of a point to a polygon, 0 inside.
fn distance_to(corners: &[DVec2; 4], point: DVec2) -> f64 {
    if signed_sides(corners, point).all(|gap_m| gap_m <= 0.0) {
        return 0.0;
    }
    (0..4)
        .map(|side: usize| {
            let from = corners[side];
            let to = corners[(side + 1) % 4];
            let share = ((point - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
            (from + (to - from) * share - point).length()
        })
        .fold(f64::INFINITY, f64::min)
}
