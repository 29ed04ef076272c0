//! Paths, and the shortest curves between poses.

use numpy::{AllowTypeChange, PyArrayLike2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wildfire::geometry::Pose;
use wildfire::vehicle::{self, Dubins, ReedsShepp, Segment};

use crate::arrays::{LARGEST, Poses, is_sane, is_sane_pose, rows};

/// The most poses of a path, of which there can be no more in a file either.
const MAX_SAMPLES: f64 = 1e7;

/// A path of the rear axle.
#[pyclass(frozen, module = "wildfire_contest", name = "Path")]
pub struct Path(pub vehicle::Path);

#[pymethods]
impl Path {
    #[new]
    fn new(start: Poses, segments: PyArrayLike2<'_, f64, AllowTypeChange>) -> PyResult<Self> {
        let start = one(start, "start")?;
        let segments = segments.as_array();
        if segments.nrows() > 0 && segments.ncols() != 2 {
            let shape = segments.shape();
            return Err(PyValueError::new_err(format!("segments have the shape {shape:?}; expected (n, 2)")));
        }
        let rows = segments.rows().into_iter().filter(|row| row.len() == 2);
        let segments: Vec<_> = rows.map(|row| Segment { curvature: row[0], length_m: row[1] }).collect();
        match segments.iter().position(|segment| !is_sane(segment.curvature) || !is_sane(segment.length_m)) {
            Some(index) => Err(PyValueError::new_err(format!("segment {index} is not made of finite, sane numbers"))),
            None => Ok(Self(vehicle::Path { start, segments })),
        }
    }

    #[staticmethod]
    fn through(start: Poses, poses: Poses, radius: f64) -> PyResult<Self> {
        let start = one(start, "start")?;
        let radius_m = checked_radius(radius)?;
        let (poses, _) = poses.listed(None);
        match poses.iter().position(|pose| !is_sane_pose(pose)) {
            Some(index) => Err(PyValueError::new_err(format!("pose {index} is not made of finite, sane numbers"))),
            None => Ok(Self(through(start, &poses, radius_m))),
        }
    }

    #[getter]
    fn start(&self) -> (f64, f64, f64) {
        triple(self.0.start)
    }

    #[getter]
    fn end(&self) -> (f64, f64, f64) {
        triple(self.0.end())
    }

    #[getter]
    fn segments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let segments: Vec<_> = self.0.segments.iter().map(|segment| [segment.curvature, segment.length_m]).collect();
        rows(py, &segments)
    }

    #[getter]
    fn length(&self) -> f64 {
        self.0.length_m()
    }

    #[getter]
    fn cusps(&self) -> u32 {
        self.0.cusps()
    }

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

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.0 == other.get().0)
    }

    fn __repr__(&self) -> String {
        let (segments, metres, cusps) = (self.0.segments.len(), self.0.length_m(), self.0.cusps());
        format!("<Path: {segments} segments, {metres:.2} m, {cusps} cusps>")
    }
}

fn sample(pose: Pose, is_reverse: bool) -> [f64; 4] {
    [pose.x, pose.y, pose.heading, if is_reverse { -1.0 } else { 1.0 }]
}

pub fn triple(pose: Pose) -> (f64, f64, f64) {
    (pose.x, pose.y, pose.heading)
}

fn one(poses: Poses, name: &str) -> PyResult<Pose> {
    match poses {
        Poses::One(pose) if is_sane_pose(&pose) => Ok(pose),
        Poses::One(_) => Err(PyValueError::new_err(format!("{name} is not made of finite, sane numbers"))),
        Poses::Many(_) => Err(PyValueError::new_err(format!("{name} is many poses; expected one"))),
    }
}

fn checked_radius(radius: f64) -> PyResult<f64> {
    if radius > 0.0 && radius <= LARGEST {
        return Ok(radius);
    }
    Err(PyValueError::new_err(format!("radius is {radius}; expected metres above 0")))
}

/// Joins poses by the shortest Reeds-Shepp curves, from the start on.
pub fn through(start: Pose, poses: &[Pose], radius_m: f64) -> vehicle::Path {
    let curves = ReedsShepp { radius_m };
    let mut path = vehicle::Path::standing(start);
    let mut from = start;
    for &to in poses {
        path.segments.extend(curves.shortest(from, to).segments());
        from = to;
    }
    path
}

#[pyfunction]
#[pyo3(signature = (a, b, radius))]
pub fn reeds_shepp_length<'py>(py: Python<'py>, a: Poses, b: Poses, radius: f64) -> PyResult<Bound<'py, PyAny>> {
    let curves = ReedsShepp { radius_m: checked_radius(radius)? };
    a.answer_pairs(b, py, |from, to| length(from, to, |from, to| curves.length_m(from, to)))
}

#[pyfunction]
#[pyo3(signature = (a, b, radius))]
pub fn dubins_length<'py>(py: Python<'py>, a: Poses, b: Poses, radius: f64) -> PyResult<Bound<'py, PyAny>> {
    let curves = Dubins { radius_m: checked_radius(radius)? };
    a.answer_pairs(b, py, |from, to| length(from, to, |from, to| curves.length_m(from, to)))
}

/// There is no curve between what is no pose.
fn length(from: Pose, to: Pose, length_m: impl Fn(Pose, Pose) -> f64) -> f64 {
    if is_sane_pose(&from) && is_sane_pose(&to) { length_m(from, to) } else { f64::NAN }
}
