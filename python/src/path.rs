//! Paths and shortest curves between poses.

use numpy::{AllowTypeChange, PyArrayLike2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;
use wildfire::geometry::Pose;
use wildfire::vehicle::{self, Dubins, ReedsShepp, Segment};

use crate::arrays::{LARGEST, Poses, described, is_sane, is_sane_pose, rows};

/// The largest number of poses of a path, the same as in a file.
const MAX_SAMPLES: f64 = 1e7;

/// A path of the rear axle: a pose, and segments of constant curvature from there on.
///
/// Parameters
/// ----------
/// start : array of shape (3,)
/// segments : array of shape (n, 2)
///     Curvature (1/m, positive to the left) and length (m, negative in reverse).
#[pyclass(frozen, module = "wildfire_contest", name = "Path")]
pub struct Path(pub vehicle::Path);

#[pymethods]
impl Path {
    #[new]
    fn new(start: Poses, segments: &Bound<'_, PyAny>) -> PyResult<Self> {
        let start = one_pose(start, "start")?;
        // An empty list has no columns.
        if segments.len().is_ok_and(|length| length == 0) {
            return Ok(Self(vehicle::Path::standing(start)));
        }
        let rows = segments.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>().ok();
        let Some(rows) = rows.filter(|rows| rows.as_array().ncols() == 2) else {
            let sentence = format!("expected segments of shape (n, 2), found {}", described(segments));
            return Err(PyValueError::new_err(sentence));
        };
        let rows = rows.as_array();
        let segments: Vec<_> =
            rows.rows().into_iter().map(|row| Segment { curvature: row[0], length_m: row[1] }).collect();
        match segments.iter().position(|segment| !is_sane(segment.curvature) || !is_sane(segment.length_m)) {
            Some(index) => {
                Err(PyValueError::new_err(format!("segment {index} has numbers that are not finite or too large")))
            }
            None => Ok(Self(vehicle::Path { start, segments })),
        }
    }

    /// Joins poses by the shortest curves for a turning radius: of Reeds and Shepp, or of Dubins.
    ///
    /// Parameters
    /// ----------
    /// start : array of shape (3,)
    /// poses : array of shape (3,) or (n, 3)
    ///     In their order, without the start.
    /// radius : float
    ///     Metres.
    /// forward_only : bool
    ///     True: Dubins curves, which have no reverse.
    #[staticmethod]
    #[pyo3(signature = (start, poses, radius, forward_only = false))]
    fn through(start: Poses, poses: Poses, radius: f64, forward_only: bool) -> PyResult<Self> {
        let start = one_pose(start, "start")?;
        let radius_m = checked_radius(radius)?;
        let (poses, _) = poses.listed(None);
        match poses.iter().position(|pose| !is_sane_pose(pose)) {
            Some(index) => {
                Err(PyValueError::new_err(format!("pose {index} has numbers that are not finite or too large")))
            }
            None if forward_only => {
                let curves = Dubins { radius_m };
                Ok(Self(joined(start, &poses, |from, to| curves.shortest(from, to).path(from))))
            }
            None => Ok(Self(through(start, &poses, radius_m))),
        }
    }

    /// Returns the start pose.
    #[getter]
    fn start(&self) -> (f64, f64, f64) {
        triple(self.0.start)
    }

    /// Returns the end pose.
    #[getter]
    fn end(&self) -> (f64, f64, f64) {
        triple(self.0.end())
    }

    /// Returns the curvature and signed length of each segment: shape (n, 2), 1/m and metres.
    #[getter]
    fn segments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let segments: Vec<_> = self.0.segments.iter().map(|segment| [segment.curvature, segment.length_m]).collect();
        rows(py, &segments)
    }

    /// Returns the driven distance in metres, forward and reverse alike.
    #[getter]
    fn length(&self) -> f64 {
        self.0.length_m()
    }

    /// Returns the number of changes between forward and reverse.
    #[getter]
    fn cusps(&self) -> u32 {
        self.0.cusps()
    }

    /// Returns poses along the path.
    ///
    /// Parameters
    /// ----------
    /// step : float
    ///     The largest distance between two of them in metres. Start, end and all joints are included.
    ///
    /// Returns
    /// -------
    /// array of shape (n, 4), float64
    ///     x, y, heading, and the direction in which the truck arrives: 1 forward, -1 in reverse.
    #[pyo3(signature = (step = 0.5))]
    fn poses<'py>(&self, py: Python<'py>, step: f64) -> PyResult<Bound<'py, PyAny>> {
        if !(step > 0.0 && self.0.length_m() / step <= MAX_SAMPLES) {
            let sentence = format!("step is {step}; expected metres above 0, and at most {MAX_SAMPLES:e} poses");
            return Err(PyValueError::new_err(sentence));
        }
        let first = self.0.segments.first().is_some_and(Segment::is_reverse);
        let mut samples = vec![sample(self.0.start, first)];
        for (start, segment) in self.0.legs() {
            let of_segment = vehicle::Path { start, segments: vec![segment] };
            samples.extend(of_segment.samples(step).skip(1).map(|(_, pose)| sample(pose, segment.is_reverse())));
        }
        rows(py, &samples)
    }

    fn __len__(&self) -> usize {
        self.0.segments.len()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, (Triple, Segments)) {
        let path = &slf.get().0;
        let segments = path.segments.iter().map(|segment| (segment.curvature, segment.length_m)).collect();
        (slf.get_type(), (triple(path.start), segments))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.0 == other.get().0)
    }

    fn __repr__(&self) -> String {
        let segments = self.0.segments.len();
        let metres = self.0.length_m();
        let cusps = self.0.cusps();
        format!("<Path: {segments} segments, {metres:.2} m, {cusps} cusps>")
    }
}

fn sample(pose: Pose, is_reverse: bool) -> [f64; 4] {
    [pose.x, pose.y, pose.heading, if is_reverse { -1.0 } else { 1.0 }]
}

type Triple = (f64, f64, f64);

/// Curvatures and lengths, as the constructor takes them.
type Segments = Vec<(f64, f64)>;

pub fn triple(pose: Pose) -> Triple {
    (pose.x, pose.y, pose.heading)
}

pub fn one_pose(poses: Poses, name: &str) -> PyResult<Pose> {
    match poses {
        Poses::One(pose) if is_sane_pose(&pose) => Ok(pose),
        Poses::One(_) => Err(PyValueError::new_err(format!("{name} has numbers that are not finite or too large"))),
        Poses::Many(_) => Err(PyValueError::new_err(format!("{name} has many poses; expected one"))),
    }
}

fn checked_radius(radius: f64) -> PyResult<f64> {
    if radius > 0.0 && radius <= LARGEST {
        return Ok(radius);
    }
    Err(PyValueError::new_err(format!("radius is {radius}; expected metres above 0, and at most {LARGEST:e}")))
}

/// Joins poses by the shortest Reeds-Shepp curves, from the start on.
pub fn through(start: Pose, poses: &[Pose], radius_m: f64) -> vehicle::Path {
    let curves = ReedsShepp { radius_m };
    joined(start, poses, |from, to| curves.shortest(from, to).path(from))
}

fn joined(start: Pose, poses: &[Pose], curve: impl Fn(Pose, Pose) -> vehicle::Path) -> vehicle::Path {
    let mut path = vehicle::Path::standing(start);
    let mut from = start;
    for &to in poses {
        path.segments.extend(curve(from, to).segments);
        from = to;
    }
    path
}

/// Returns the length of the shortest curve for a vehicle that drives forward and in reverse.
///
/// Parameters
/// ----------
/// a, b : array of shape (3,) or (n, 3)
///     A single pose is paired with all of the others.
/// radius : float
///     The turning radius in metres.
///
/// Returns
/// -------
/// float or array of shape (n,), float64
///     Metres; nan for an invalid pose.
#[pyfunction]
#[pyo3(signature = (a, b, radius))]
pub fn reeds_shepp_length<'py>(py: Python<'py>, a: Poses, b: Poses, radius: f64) -> PyResult<Bound<'py, PyAny>> {
    let curves = ReedsShepp { radius_m: checked_radius(radius)? };
    a.answer_pairs(b, py, |from, to| length(from, to, |from, to| curves.length_m(from, to)))
}

/// Returns the length of the shortest curve for a vehicle that drives forward only; see `reeds_shepp_length`.
#[pyfunction]
#[pyo3(signature = (a, b, radius))]
pub fn dubins_length<'py>(py: Python<'py>, a: Poses, b: Poses, radius: f64) -> PyResult<Bound<'py, PyAny>> {
    let curves = Dubins { radius_m: checked_radius(radius)? };
    a.answer_pairs(b, py, |from, to| length(from, to, |from, to| curves.length_m(from, to)))
}

/// Returns nan for an invalid pose, which no curve can reach.
fn length(from: Pose, to: Pose, length_m: impl Fn(Pose, Pose) -> f64) -> f64 {
    if is_sane_pose(&from) && is_sane_pose(&to) { length_m(from, to) } else { f64::NAN }
}
