//! The collision checker, for one pose or many.

use std::f64::consts::TAU;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{DVec2, FieldFrame, Pose, ops};
use wildfire::planning::kit::halton::radical_inverse;
use wildfire::planning::{Goal, GoalDisc};
use wildfire::scenario::MAX_CELLS_A_SIDE;
use wildfire::vehicle::{Dimensions, ReedsShepp, Segment};

use crate::arrays::{Numbers, Poses, is_sane, is_sane_pose, rows};
use crate::grid_maps::Occupied;
use crate::query::{GoalLike, Vehicle};

/// The largest number of goal poses per call.
const MAX_GOAL_POSES: usize = 100_000;

/// The collision checker of one body on one field.
///
/// A pose is ``(x, y, heading)`` of the middle of the rear axle: metres east and north from the field's south-west corner,
/// radians counter-clockwise from east. One pose has shape (3,) and gives a scalar, many have shape (n, 3) and give an
/// array of shape (n,). A pose with numbers that are not finite is never free.
///
/// Parameters
/// ----------
/// occupied : array of shape (rows, cols), bool
///     True for cells with a bush; row 0 is the southernmost.
/// cell_m : float
///     Side of a cell.
/// vehicle : Vehicle
///     Default: the contest's Unimog.
#[pyclass(frozen, module = "wildfire_contest")]
pub struct Checker(pub Arc<CollisionChecker>);

impl Checker {
    pub fn new(checker: CollisionChecker) -> Self {
        Self(Arc::new(checker))
    }
}

#[pymethods]
impl Checker {
    #[new]
    #[pyo3(signature = (occupied, cell_m = 5.0, vehicle = None))]
    fn from_occupied(occupied: Occupied, cell_m: f64, vehicle: Option<Vehicle>) -> PyResult<Self> {
        let Occupied(cells) = occupied;
        let side = |cells: usize| u16::try_from(cells).ok().filter(|side| (1..=MAX_CELLS_A_SIDE).contains(side));
        let (Some(rows), Some(cols)) = (side(cells.rows()), side(cells.cols())) else {
            let shape = (cells.rows(), cells.cols());
            let sentence = format!("occupied has shape {shape:?}; expected 1 to {MAX_CELLS_A_SIDE} cells per side");
            return Err(PyValueError::new_err(sentence));
        };
        if !(0.01..=1000.0).contains(&cell_m) {
            return Err(PyValueError::new_err(format!("cell_m is {cell_m}; expected 0.01 to 1000 metres")));
        }
        let frame = FieldFrame { cols, rows, cell_m };
        let body = vehicle.map_or_else(|| Ok(Dimensions::default()), |vehicle| vehicle.checked_body())?;
        Ok(Self::new(CollisionChecker::new(Arc::new(ClearanceField::new(frame, &cells)), body)))
    }

    /// Returns the width and height of the field in metres.
    #[getter]
    fn size_m(&self) -> (f64, f64) {
        let frame = self.0.field().frame();
        (frame.width_m(), frame.height_m())
    }

    /// Returns the side of a cell, in metres.
    #[getter]
    fn cell_m(&self) -> f64 {
        self.0.field().frame().cell_m
    }

    /// Returns the vehicle.
    #[getter]
    fn vehicle(&self) -> Vehicle {
        Vehicle::from_body(self.0.body())
    }

    /// Returns which cells hold a bush: shape (rows, cols), bool; row 0 is the southernmost.
    #[getter]
    fn occupied<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let occupied = self.0.field().occupied();
        let flat: Bound<'py, PyArray1<bool>> = occupied.values().to_vec().into_pyarray(py);
        flat.call_method1("reshape", ((occupied.rows(), occupied.cols()),))
    }

    /// Returns whether the body keeps `clearance` metres from bushes and border, and at least 1 cm in any case.
    ///
    /// Parameters
    /// ----------
    /// poses : array of shape (3,) or (n, 3)
    /// clearance : float
    ///     Metres.
    ///
    /// Returns
    /// -------
    /// bool or array of shape (n,), bool
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     `poses` has another shape.
    #[pyo3(signature = (poses, clearance = 0.0))]
    fn pose_is_free<'py>(&self, py: Python<'py>, poses: Poses, clearance: f64) -> PyResult<Bound<'py, PyAny>> {
        let clearance = checked_clearance(clearance)?;
        poses.answer(py, |pose| is_sane_pose(&pose) && self.0.pose_is_free(pose, clearance))
    }

    /// Returns the distance in metres from the body to the nearest bush or border.
    ///
    /// Exact below one metre, a lower bound above; not positive on contact, nan for an invalid pose.
    ///
    /// Parameters
    /// ----------
    /// poses : array of shape (3,) or (n, 3)
    ///
    /// Returns
    /// -------
    /// float or array of shape (n,), float64
    fn clearance<'py>(&self, py: Python<'py>, poses: Poses) -> PyResult<Bound<'py, PyAny>> {
        poses.answer(py, |pose| if is_sane_pose(&pose) { self.0.clearance(pose) } else { f64::NAN })
    }

    /// Returns whether the body keeps `clearance` metres, and at least 1 cm, all along a motion of constant curvature.
    ///
    /// Every motion that keeps the clearance is accepted; every accepted motion keeps it to within 3 cm and touches nothing.
    ///
    /// Parameters
    /// ----------
    /// poses : array of shape (3,) or (n, 3)
    ///     The start poses of the motions.
    /// curvature : float or array of shape (n,)
    ///     1/m, positive to the left.
    /// length : float or array of shape (n,)
    ///     Metres, negative in reverse.
    ///
    /// Returns
    /// -------
    /// bool or array of shape (n,), bool
    #[pyo3(signature = (poses, curvature, length, clearance = 0.0))]
    fn motion_is_free<'py>(
        &self,
        py: Python<'py>,
        poses: Poses,
        curvature: Numbers,
        length: Numbers,
        clearance: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let clearance = checked_clearance(clearance)?;
        let (poses, is_one) = poses.listed(curvature.len().or(length.len()));
        curvature.expect(poses.len(), "curvature")?;
        length.expect(poses.len(), "length")?;
        let ask = |(index, &pose): (usize, &Pose)| {
            let curvature = curvature.get(index);
            let length_m = length.get(index);
            let is_sane = is_sane_pose(&pose) && is_sane(curvature) && is_sane(length_m);
            is_sane && self.0.motion_is_free(pose, Segment { curvature, length_m }, clearance)
        };
        let answers: Vec<bool> = py.detach(|| poses.iter().enumerate().map(ask).collect());
        if is_one { answers[0].into_bound_py_any(py) } else { Ok(answers.into_pyarray(py).into_any()) }
    }

    /// Returns whether the shortest Reeds-Shepp curve from `a` to `b`, at the vehicle's turning radius, is free.
    ///
    /// Parameters
    /// ----------
    /// a, b : array of shape (3,) or (n, 3)
    ///     A single pose is paired with all of the others.
    ///
    /// Returns
    /// -------
    /// bool or array of shape (n,), bool
    #[pyo3(signature = (a, b, clearance = 0.0))]
    fn curve_is_free<'py>(&self, py: Python<'py>, a: Poses, b: Poses, clearance: f64) -> PyResult<Bound<'py, PyAny>> {
        let clearance = checked_clearance(clearance)?;
        let curves = ReedsShepp { radius_m: self.0.body().turning_radius_m };
        a.answer_pairs(b, py, |from, to| {
            let is_sane = is_sane_pose(&from) && is_sane_pose(&to);
            let is_free = |from: Pose| {
                let path = curves.shortest(from, to).path(from);
                // A path without segments has no motion to check, yet the body stands somewhere.
                path.segments.is_empty() && self.0.pose_is_free(from, clearance)
                    || !path.segments.is_empty()
                        && path.legs().all(|(pose, segment)| self.0.motion_is_free(pose, segment, clearance))
            };
            is_sane && is_free(from)
        })
    }

    /// Returns up to `n` free poses in a goal.
    ///
    /// In a disc they are spread evenly over positions and headings, the same every time. For a pose it is the pose itself.
    ///
    /// Returns
    /// -------
    /// array of shape (m, 3), float64
    ///     m is at most n, and 0 if the body does not fit.
    #[pyo3(signature = (goal, n = 24, clearance = 0.1))]
    fn goal_poses<'py>(
        &self,
        py: Python<'py>,
        goal: GoalLike,
        n: usize,
        clearance: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let clearance = checked_clearance(clearance)?;
        if n > MAX_GOAL_POSES {
            return Err(PyValueError::new_err(format!("n is {n}; expected at most {MAX_GOAL_POSES}")));
        }
        let found = py.detach(|| goal_poses(&self.0, goal.0, n, clearance));
        let found: Vec<_> = found.into_iter().map(|pose| [pose.x, pose.y, pose.heading]).collect();
        rows(py, &found)
    }

    fn __repr__(&self) -> String {
        let frame = self.0.field().frame();
        format!("<Checker of {} x {} m>", frame.width_m(), frame.height_m())
    }
}

fn checked_clearance(clearance: f64) -> PyResult<f64> {
    if is_sane(clearance) {
        return Ok(clearance);
    }
    Err(PyValueError::new_err(format!("clearance is {clearance}; expected metres")))
}

/// Poses tried for each requested one before the goal counts as full.
const TRIES: usize = 64;

/// The share of a disc's radius within which poses are sampled, so that rounding puts none outside.
const WITHIN: f64 = 0.98;

/// Finds up to `count` free poses in a goal, spread evenly over the disc and over all headings by Halton's sequence.
/// No random numbers are used, so that the same goal has the same poses.
fn goal_poses(checker: &CollisionChecker, goal: Goal, count: usize, clearance_m: f64) -> Vec<Pose> {
    let is_free = |pose: &Pose| is_sane_pose(pose) && checker.pose_is_free(*pose, clearance_m);
    let GoalDisc { centre, radius_m } = match goal {
        Goal::Pose(pose) => return Some(pose).filter(|_| count > 0).filter(is_free).into_iter().collect(),
        Goal::Disc(disc) => disc,
    };
    let pose = |index: u32| {
        // The bases share no factor: with a common one, headings would go with positions instead of being spread over each.
        let [out, turn, heading] = [2, 3, 5].map(|base| radical_inverse(base, index));
        // The square root makes positions as dense at the rim as at the centre.
        let out_m = WITHIN * radius_m * out.sqrt();
        let (sin, cos) = ops::sin_cos(TAU * turn);
        let heading = ops::wrap_angle(TAU * heading);
        // The disc is for the middle of the body, whereas a pose is of the rear axle.
        let from_axle = checker.body().body_centre(Pose { x: 0.0, y: 0.0, heading });
        let axle = centre + DVec2::new(cos, sin) * out_m - from_axle;
        Pose::new(axle.x, axle.y, heading)
    };
    // Where the body fits nowhere in the disc, the search would never end.
    let max = u32::try_from(TRIES * count).unwrap_or(u32::MAX);
    (1..=max).map(pose).filter(is_free).take(count).collect()
}
