//! Conversion of poses: one as three numbers, or many as an array with three columns.
//!
//! A pose is `(x, y, heading)` of the middle of the rear axle: metres east and north from the field's south-west corner,
//! radians counter-clockwise from east.

use numpy::{AllowTypeChange, Element, IntoPyArray, PyArray1, PyArrayLike1, PyArrayLike2};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wildfire::geometry::Pose;

/// The largest accepted coordinates, lengths and angles: beyond them, squares lose the millimetres.
pub const LARGEST: f64 = 1e6;

/// One pose or many; the answer has the same form.
pub enum Poses {
    One(Pose),
    Many(Vec<Pose>),
}

impl<'py> FromPyObject<'_, 'py> for Poses {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        // Three numbers need no conversion by numpy.
        if let Ok((x, y, heading)) = object.extract::<(f64, f64, f64)>() {
            return Ok(Self::One(pose(x, y, heading)));
        }
        // An empty array can be read with any dimension.
        let one =
            object.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>().ok().filter(|one| !one.as_array().is_empty());
        if let Some(one) = one {
            let [x, y, heading] = one.as_array().to_vec()[..] else { return Err(wrong_shape(&object)) };
            return Ok(Self::One(pose(x, y, heading)));
        }
        let many = object.extract::<PyArrayLike2<'_, f64, AllowTypeChange>>().map_err(|_| wrong_shape(&object))?;
        let many = many.as_array();
        if many.ncols() != 3 {
            return Err(wrong_shape(&object));
        }
        Ok(Self::Many(many.rows().into_iter().map(|row| pose(row[0], row[1], row[2])).collect()))
    }
}

fn wrong_shape(object: &Bound<'_, PyAny>) -> PyErr {
    PyValueError::new_err(format!("expected poses of shape (3,) or (n, 3), found {}", described(object)))
}

/// Describes an argument that is not the expected array by its shape or its type.
pub fn described(object: &Bound<'_, PyAny>) -> String {
    let numpy = object.py().import("numpy").and_then(|numpy| numpy.call_method1("shape", (object,)));
    match numpy {
        Ok(shape) if shape.len().is_ok_and(|dimensions| dimensions > 0) => format!("shape {shape}"),
        _ => object.get_type().name().map_or_else(|_| "something else".to_owned(), |name| format!("a {name}")),
    }
}

/// Leaves numbers that are not finite unchanged: wrapping such a heading would never end.
pub fn pose(x: f64, y: f64, heading: f64) -> Pose {
    if is_sane(heading) { Pose::new(x, y, heading) } else { Pose { x, y, heading } }
}

/// Returns whether a number is finite and small enough to compute with.
pub fn is_sane(number: f64) -> bool {
    number.abs() <= LARGEST
}

/// Returns whether all numbers of a pose are finite and small enough to compute with.
pub fn is_sane_pose(pose: &Pose) -> bool {
    is_sane(pose.x) && is_sane(pose.y) && is_sane(pose.heading)
}

impl Poses {
    fn len(&self) -> Option<usize> {
        match self {
            Self::One(_) => None,
            Self::Many(poses) => Some(poses.len()),
        }
    }

    fn get(&self, index: usize) -> Pose {
        match self {
            Self::One(pose) => *pose,
            Self::Many(poses) => poses[index],
        }
    }

    /// Evaluates a function for each pose, without the interpreter's lock if there are many.
    pub fn answer<'py, T>(self, py: Python<'py>, ask: impl Fn(Pose) -> T + Send + Sync) -> PyResult<Bound<'py, PyAny>>
    where
        T: Element + Send + IntoPyObject<'py>,
    {
        match self {
            Self::One(pose) => ask(pose).into_bound_py_any(py),
            Self::Many(poses) => {
                let answers: Vec<T> = py.detach(|| poses.into_iter().map(ask).collect());
                Ok(answers.into_pyarray(py).into_any())
            }
        }
    }

    /// Evaluates a function for each pair of poses; a single pose is paired with all of the others.
    pub fn answer_pairs<'py, T>(
        self,
        other: Self,
        py: Python<'py>,
        ask: impl Fn(Pose, Pose) -> T + Send + Sync,
    ) -> PyResult<Bound<'py, PyAny>>
    where
        T: Element + Send + IntoPyObject<'py>,
    {
        let count = match (self.len(), other.len()) {
            (None, None) => return ask(self.get(0), other.get(0)).into_bound_py_any(py),
            (Some(one), Some(two)) if one != two => {
                let sentence = format!("found {one} poses and {two} poses; expected as many, or one");
                return Err(PyValueError::new_err(sentence));
            }
            (one, two) => one.or(two).unwrap_or_default(),
        };
        let answers: Vec<T> = py.detach(|| (0..count).map(|index| ask(self.get(index), other.get(index))).collect());
        Ok(answers.into_pyarray(py).into_any())
    }
}

/// One number for all poses, or one for each.
pub enum Numbers {
    One(f64),
    Many(Vec<f64>),
}

impl<'py> FromPyObject<'_, 'py> for Numbers {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(number) = object.extract::<f64>() {
            return Ok(Self::One(number));
        }
        let many = object.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>().map_err(|_| {
            PyValueError::new_err(format!("expected a number, or numbers of shape (n,), found {}", described(&object)))
        })?;
        Ok(Self::Many(many.as_array().to_vec()))
    }
}

impl Numbers {
    /// Requires as many numbers as poses.
    pub fn expect(&self, count: usize, name: &str) -> PyResult<()> {
        match self {
            Self::Many(numbers) if numbers.len() != count => {
                let found = numbers.len();
                Err(PyValueError::new_err(format!(
                    "{name} has {found} numbers for {count} poses; expected as many, or one"
                )))
            }
            _ => Ok(()),
        }
    }

    pub fn len(&self) -> Option<usize> {
        match self {
            Self::One(_) => None,
            Self::Many(numbers) => Some(numbers.len()),
        }
    }

    pub fn get(&self, index: usize) -> f64 {
        match self {
            Self::One(number) => *number,
            Self::Many(numbers) => numbers[index],
        }
    }
}

impl Poses {
    /// Lists the poses, repeating a single one to match the number of numbers paired with it.
    pub fn listed(self, wanted: Option<usize>) -> (Vec<Pose>, bool) {
        match (self, wanted) {
            (Self::One(pose), None) => (vec![pose], true),
            (Self::One(pose), Some(count)) => (vec![pose; count], false),
            (Self::Many(poses), _) => (poses, false),
        }
    }
}

/// Makes a two-dimensional array.
pub fn rows<'py, T: Element + Clone, const N: usize>(py: Python<'py>, rows: &[[T; N]]) -> PyResult<Bound<'py, PyAny>> {
    let flat: Bound<'py, PyArray1<T>> = rows.as_flattened().to_vec().into_pyarray(py);
    flat.call_method1("reshape", ((rows.len(), N),))
}
