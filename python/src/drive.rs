//! Steering the truck from outside: a sequence of drives to a fire, each on a field of its own.

use std::sync::Arc;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use rand::RngExt;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, Pose};
use wildfire::planning::{Goal, GoalDisc};
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::scenario::{Scenario, Terrain};
use wildfire::trajectory::SpeedLimits;
use wildfire::vehicle::Segment;

use crate::errors::error;
use crate::scenario::ScenarioLike;

/// Simulated seconds of a step.
const STEP_S: f64 = 0.5;

/// Points along each side of the clearance map around the truck, and metres between them.
const SIDE: usize = 64;
const SPACING_M: f64 = 0.5;

/// Clearances are in tens of metres.
const CLEARANCE_UNIT_M: f64 = 10.0;

/// The least distance of a goal, in metres.
const NEAREST_GOAL_M: f64 = 30.0;

/// Attempts to sample a start and a goal.
const DRAWS: usize = 10_000;

/// A drive under way.
struct DriveUnderWay {
    checker: CollisionChecker,
    limits: SpeedLimits,
    pose: Pose,
    goal: GoalDisc,
}

/// A truck steered from outside.
#[pyclass(module = "wildfire_contest")]
pub struct Driver {
    scenario: Scenario,
    truck: usize,
    drive: Option<DriveUnderWay>,
}

#[pymethods]
impl Driver {
    #[new]
    #[pyo3(signature = (scenario, truck))]
    fn new(py: Python<'_>, scenario: ScenarioLike<'_>, truck: usize) -> PyResult<Self> {
        let scenario = scenario.load(py, Vec::new())?;
        let scenario = scenario.get().library().clone();
        if truck >= scenario.unimog.len() {
            let count = scenario.unimog.len();
            return Err(PyValueError::new_err(format!("truck is {truck}, but the scenario has {count} trucks")));
        }
        Ok(Self { scenario, truck, drive: None })
    }

    /// Starts a drive on the field of a seed.
    fn reset(&mut self, py: Python<'_>, seed: u64) -> PyResult<()> {
        let drive = py.detach(|| begin(&self.scenario, self.truck, seed)).map_err(error)?;
        self.drive = Some(drive);
        Ok(())
    }

    /// Drives for half a second: `steering` is a fraction of the sharpest curvature, positive to the left, and `speed` a
    /// fraction of the top speed, negative in reverse. Returns the progress towards the goal in metres, whether the goal was
    /// reached, and whether the truck touched anything.
    fn step(&mut self, steering: f64, speed: f64) -> PyResult<(f64, bool, bool)> {
        let drive = self.drive.as_mut().ok_or_else(not_started)?;
        // Put this way round, the condition refuses nan too.
        if !(steering.abs() <= 1.0 && speed.abs() <= 1.0) {
            let sentence = format!("the action ({steering}, {speed}) is invalid; expected two numbers from -1 to 1");
            return Err(PyValueError::new_err(sentence));
        }
        let max_mps = if speed < 0.0 { drive.limits.reverse_mps } else { drive.limits.forward_mps };
        let curvature = steering * drive.checker.body().max_curvature();
        let segment = Segment { curvature, length_m: speed * max_mps * STEP_S };
        let before_m = drive.to_goal().length();
        if !drive.checker.motion_is_free(drive.pose, segment, 0.0) {
            return Ok((0.0, false, true));
        }
        drive.pose = segment.end(drive.pose);
        let is_there = Goal::Disc(drive.goal).is_met(drive.pose, drive.checker.body());
        Ok((before_m - drive.to_goal().length(), is_there, false))
    }

    /// Returns the clearances around the truck, rows from right to left and columns from back to front, and the goal: its
    /// offset ahead and to the left, and its radius.
    fn seen<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyArray1<f32>>)> {
        let drive = self.drive.as_ref().ok_or_else(not_started)?;
        let clearances = PyArray1::from_vec(py, drive.clearances()).reshape([SIDE, SIDE])?;
        let goal = drive.to_goal();
        let numbers = [goal.x, goal.y, drive.goal.radius_m].map(|metres| metres as f32);
        Ok((clearances.into_any(), PyArray1::from_slice(py, &numbers)))
    }

    /// Returns the pose of the rear axle: x, y, heading.
    #[getter]
    fn pose(&self) -> PyResult<(f64, f64, f64)> {
        let pose = self.drive.as_ref().ok_or_else(not_started)?.pose;
        Ok((pose.x, pose.y, pose.heading))
    }
}

fn not_started() -> PyErr {
    PyIndexError::new_err("no drive has started: call reset first")
}

impl DriveUnderWay {
    /// Returns the goal's offset from the centre of the body, ahead and to the left, in metres.
    fn to_goal(&self) -> DVec2 {
        let away = self.goal.centre - self.checker.body().body_centre(self.pose);
        let ahead = self.pose.direction();
        DVec2::new(away.dot(ahead), ahead.perp_dot(away))
    }

    fn clearances(&self) -> Vec<f32> {
        let ahead = self.pose.direction();
        let centre = self.checker.body().body_centre(self.pose);
        let left = ahead.perp();
        let offset = |index: usize| (index as f64 - 0.5 * (SIDE - 1) as f64) * SPACING_M;
        let points = (0..SIDE).flat_map(|row| (0..SIDE).map(move |col| (offset(row), offset(col))));
        points
            .map(|(side, front)| {
                let metres = self.checker.field().distance(centre + side * left + front * ahead);
                (metres / CLEARANCE_UNIT_M).clamp(-1.0, 10.0) as f32
            })
            .collect()
    }
}

fn begin(scenario: &Scenario, truck: usize, seed: u64) -> Result<DriveUnderWay, String> {
    let terrain = Terrain::from_scenario(scenario, seed).map_err(|refusal| refusal.to_string())?;
    let settings = &scenario.unimog[truck];
    let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    let checker = CollisionChecker::new(field, settings.vehicle);
    // This is a stream of its own, which leaves the draws of the field as they are; each truck of a seed gets another.
    let mut dice = rng::stream(seed, &format!("drive/{truck}"));
    let draw = |dice: &mut Xoshiro256PlusPlus| {
        let width_m = terrain.frame.width_m();
        let height_m = terrain.frame.height_m();
        let x = dice.random::<f64>() * width_m;
        let y = dice.random::<f64>() * height_m;
        Pose::new(x, y, dice.random::<f64>() * std::f64::consts::TAU)
    };
    let is_free = |pose: &Pose| checker.pose_is_free(*pose, 0.5);
    let start = Some(settings.start.pose()).filter(is_free);
    let start = start.or_else(|| (0..DRAWS).map(|_| draw(&mut dice)).find(is_free));
    let start = start.ok_or("found no free place for the truck on this field")?;
    // The goal contains a free pose, but not always a path to it.
    let radius_m = scenario.suppression.reach_m.unwrap_or(10.0).max(1.0);
    let far = |pose: &Pose| (checker.body().body_centre(*pose) - checker.body().body_centre(start)).length();
    // The distance counts from the rim: a large disc might hold the start, and the first step would end the drive.
    let end = (0..DRAWS).map(|_| draw(&mut dice)).find(|pose| is_free(pose) && far(pose) >= NEAREST_GOAL_M + radius_m);
    let end = end.ok_or("found no place to drive to on this field")?;
    let goal = GoalDisc { centre: checker.body().body_centre(end), radius_m };
    Ok(DriveUnderWay { checker, limits: settings.speed_limits(), pose: start, goal })
}
