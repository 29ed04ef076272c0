//! The inputs of a planner: the truck, its vehicle, its settings, and each query.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use wildfire::geometry::{DVec2, Pose};
use wildfire::planning::{self, Goal, GoalDisc};
use wildfire::trajectory::SpeedLimits;
use wildfire::vehicle::Dimensions;

use crate::arrays::{Poses, is_sane, is_sane_pose, pose};
use crate::checker::Checker;

/// The body of a truck with Ackermann steering, in metres. The default is the contest's Unimog.
#[pyclass(frozen, from_py_object, get_all, module = "wildfire_contest")]
#[derive(Clone)]
pub struct Vehicle {
    /// Overall length, bumper to bumper.
    length: f64,
    /// Overall width.
    width: f64,
    /// Distance between the axles.
    wheelbase: f64,
    /// Distance from the rear axle to the rear bumper.
    rear_overhang: f64,
    /// Smallest turning radius of the middle of the rear axle.
    min_turn_radius: f64,
}

impl Vehicle {
    pub fn from_body(body: &Dimensions) -> Self {
        Self {
            length: body.length_m,
            width: body.width_m,
            wheelbase: body.wheelbase_m,
            rear_overhang: body.rear_overhang_m,
            min_turn_radius: body.turning_radius_m,
        }
    }

    /// Returns the dimensions if they are possible.
    pub fn checked_body(&self) -> PyResult<Dimensions> {
        let sides = [self.length, self.width, self.min_turn_radius];
        let is_possible = sides.iter().all(|&side| side > 0.0 && is_sane(side))
            && self.wheelbase > 0.0
            && self.wheelbase <= self.length
            && (0.0..=self.length).contains(&self.rear_overhang);
        if !is_possible {
            return Err(PyValueError::new_err(format!("{} is no vehicle", self.__repr__())));
        }
        Ok(Dimensions {
            length_m: self.length,
            width_m: self.width,
            wheelbase_m: self.wheelbase,
            rear_overhang_m: self.rear_overhang,
            turning_radius_m: self.min_turn_radius,
            ..Dimensions::default()
        })
    }
}

#[pymethods]
impl Vehicle {
    #[new]
    #[pyo3(signature = (length = 4.9, width = 2.2, wheelbase = 3.0, rear_overhang = 0.95, min_turn_radius = 13.0))]
    fn new(length: f64, width: f64, wheelbase: f64, rear_overhang: f64, min_turn_radius: f64) -> Self {
        Self { length, width, wheelbase, rear_overhang, min_turn_radius }
    }

    fn __repr__(&self) -> String {
        let Self { length, width, wheelbase, rear_overhang, min_turn_radius } = self;
        format!(
            "Vehicle(length={length}, width={width}, wheelbase={wheelbase}, rear_overhang={rear_overhang}, \
             min_turn_radius={min_turn_radius})"
        )
    }
}

/// One truck on one field, for which a factory creates a planner.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Site {
    truck: u16,
    seed: u64,
    settings: Py<PyAny>,
    vehicle: Vehicle,
    speeds: SpeedLimits,
    checker: Py<Checker>,
}

impl Site {
    pub fn new(site: &planning::PlannerContext<'_>, seed: u64, settings: Py<PyAny>, checker: Py<Checker>) -> Self {
        let vehicle = Vehicle::from_body(site.body);
        Self { truck: site.truck, seed, settings, vehicle, speeds: *site.limits, checker }
    }
}

#[pymethods]
impl Site {
    /// Returns the number of the truck, from 0.
    #[getter]
    fn truck(&self) -> u16 {
        self.truck
    }

    /// Returns a seed for the planner's random numbers, below 2**53: a different one for each run, truck and name.
    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the ``settings`` of the scenario's table ``[planner.NAME]``.
    #[getter]
    fn settings(&self, py: Python<'_>) -> Py<PyAny> {
        self.settings.clone_ref(py)
    }

    /// Returns the vehicle.
    #[getter]
    fn vehicle(&self) -> Vehicle {
        self.vehicle.clone()
    }

    /// Returns the top speeds forward and in reverse, in metres per second.
    #[getter]
    fn speeds(&self) -> (f64, f64) {
        (self.speeds.forward_mps, self.speeds.reverse_mps)
    }

    /// Returns the collision checker of the truck's body on the field.
    #[getter]
    fn checker(&self, py: Python<'_>) -> Py<Checker> {
        self.checker.clone_ref(py)
    }

    fn __repr__(&self) -> String {
        format!("<Site of truck {}, seed {}>", self.truck, self.seed)
    }
}

/// A goal from Python: a `Disc`, or a pose as three numbers.
pub struct GoalLike(pub Goal);

impl<'py> FromPyObject<'_, 'py> for GoalLike {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let (x, y, last) = object
            .extract::<(f64, f64, f64)>()
            .map_err(|_| PyTypeError::new_err("expected a goal: a Disc, a Pose, or a pose as (x, y, heading)"))?;
        let is_disc = object.is_instance(goal_class(object.py(), "Disc")?)?;
        let goal = if is_disc {
            Goal::Disc(GoalDisc { centre: DVec2::new(x, y), radius_m: last })
        } else {
            Goal::Pose(pose(x, y, last))
        };
        let is_possible = [x, y, last].into_iter().all(is_sane) && !(is_disc && last < 0.0);
        if is_possible { Ok(Self(goal)) } else { Err(PyValueError::new_err("the goal has numbers that are invalid")) }
    }
}

/// Returns one of the two named tuples.
fn goal_class<'py>(py: Python<'py>, name: &'static str) -> PyResult<&'py Bound<'py, PyAny>> {
    static DISC: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    static POSE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let class = if name == "Disc" { &DISC } else { &POSE };
    let found =
        class.get_or_try_init(py, || PyResult::Ok(py.import("wildfire_contest.planners")?.getattr(name)?.unbind()))?;
    Ok(found.bind(py))
}

pub fn goal_object(py: Python<'_>, goal: Goal) -> PyResult<Bound<'_, PyAny>> {
    match goal {
        Goal::Disc(GoalDisc { centre, radius_m }) => goal_class(py, "Disc")?.call1((centre.x, centre.y, radius_m)),
        Goal::Pose(Pose { x, y, heading }) => goal_class(py, "Pose")?.call1((x, y, heading)),
    }
}

/// A query to a planner: start, goal and obstacles.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Query {
    pub start: Pose,
    pub goal: Goal,
    pub checker: Py<Checker>,
}

#[pymethods]
impl Query {
    #[new]
    fn new(start: (f64, f64, f64), goal: GoalLike, checker: Py<Checker>) -> Self {
        Self { start: pose(start.0, start.1, start.2), goal: goal.0, checker }
    }

    /// Returns the start pose.
    #[getter]
    fn start(&self) -> (f64, f64, f64) {
        (self.start.x, self.start.y, self.start.heading)
    }

    /// Returns the goal: a `Disc` for the centre of the body, or a `Pose`.
    #[getter]
    fn goal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        goal_object(py, self.goal)
    }

    /// Returns the collision checker of the truck's body on the field.
    #[getter]
    fn checker(&self, py: Python<'_>) -> Py<Checker> {
        self.checker.clone_ref(py)
    }

    /// Returns whether a drive that ends in these poses reaches the goal.
    ///
    /// It does if the centre of the body is in the disc, or the pose is within 1 mm and 0.001 rad.
    ///
    /// Parameters
    /// ----------
    /// poses : array of shape (3,) or (n, 3)
    ///
    /// Returns
    /// -------
    /// bool or array of shape (n,), bool
    fn meets<'py>(&self, py: Python<'py>, poses: Poses) -> PyResult<Bound<'py, PyAny>> {
        let checker = self.checker.get();
        let body = checker.0.body();
        poses.answer(py, |pose| is_sane_pose(&pose) && self.goal.is_met(pose, body))
    }

    fn __repr__(&self) -> String {
        let Pose { x, y, heading } = self.start;
        format!("<Query from ({x}, {y}, {heading}) to {:?}>", self.goal)
    }
}
