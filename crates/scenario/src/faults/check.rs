//! The tools of checks: paths of tables, and values that are refused with their path.

use std::ops::RangeInclusive;

use super::error::{Fault, nearest_name};
use super::path::{FieldPath, PathStep};
use super::wording::shortened;
use wildfire_base::geometry::{DVec2, FieldFrame};
use wildfire_base::ranges::{OutOfRange, SettingsTable, check_range, number_text};

/// The most characters of a scenario's name, which goes into tables and file names.
const MAX_NAME: usize = 100;

/// The most changes of wind or moisture.
pub const MAX_CHANGES: usize = 10_000;

/// The distance by which a body may stick out of the field through rounding, metres.
pub const ROUNDING_M: f64 = 1e-9;

/// Checks a name that goes into tables and file names.
pub fn check_name(field: &str, name: &str) -> Check {
    let fits = (1..=MAX_NAME).contains(&name.chars().count()) && !name.chars().any(char::is_control);
    if fits {
        return Ok(());
    }
    let expected = format!("a line of 1 to {MAX_NAME} characters");
    TablePath::named("").refuse(field, shortened(&format!("{name:?}")), expected)
}

/// A value that is refused.
pub struct ValidationError {
    pub path: FieldPath,
    found: String,
    expected: Expected,
}

/// What should be there instead.
enum Expected {
    Text(String),
    /// One of the names that are known of a kind: planner, policy.
    Name {
        kind: &'static str,
        valid_names: Vec<String>,
    },
}

impl ValidationError {
    pub fn fault(&self) -> Fault {
        let field = self.path.to_string();
        let found = self.found.clone();
        match &self.expected {
            Expected::Text(expected) => Fault::Value { field, found, expected: expected.clone() },
            Expected::Name { kind, valid_names } => {
                let nearest = nearest_name(&found, valid_names.iter().map(String::as_str));
                Fault::UnknownName { kind, field, found: shortened(&found), valid_names: valid_names.clone(), nearest }
            }
        }
    }
}

/// The result of a check: nothing, or the first value that is refused.
pub type Check = Result<(), Box<ValidationError>>;

/// Checks the number that a path leads to.
pub fn check_number(path: FieldPath, number: f64, range: RangeInclusive<f64>) -> Check {
    check_range("", number, range).map_err(|OutOfRange { found, expected, .. }| {
        Box::new(ValidationError { path, found, expected: Expected::Text(expected) })
    })
}

/// The path of a table of the scenario, to name values in faults.
pub struct TablePath(FieldPath);

impl TablePath {
    pub fn named(dotted: &str) -> Self {
        Self(FieldPath::parse(dotted))
    }

    pub fn entry(list: &str, number: usize) -> Self {
        Self(FieldPath(vec![PathStep::key(list), PathStep::Index(number)]))
    }

    pub fn inner(&self, name: &str) -> Self {
        Self(self.0.join(PathStep::key(name)))
    }

    /// Returns the path of a value of the table.
    pub fn key(&self, name: &str) -> FieldPath {
        self.0.join(PathStep::key(name))
    }

    /// The entry of a list whose path this is.
    pub fn item(&self, number: usize) -> Self {
        Self(self.0.join(PathStep::Index(number)))
    }

    pub fn number(&self, name: &str, value: f64, range: RangeInclusive<f64>) -> Check {
        check_number(self.0.join(PathStep::key(name)), value, range)
    }

    pub fn settings(&self, settings: &dyn SettingsTable, frame: &FieldFrame) -> Check {
        settings.check(frame).map_err(|OutOfRange { name, found, expected }| {
            let path = FieldPath([self.0.0.clone(), FieldPath::parse(&name).0].concat());
            Box::new(ValidationError { path, found, expected: Expected::Text(expected) })
        })
    }

    /// Checks that the times of a list of changes ascend.
    pub fn ascending(&self, name: &str, times_s: impl ExactSizeIterator<Item = f64>) -> Check {
        self.count(name, times_s.len(), MAX_CHANGES)?;
        let mut before_s = f64::NEG_INFINITY;
        for (number, at_s) in times_s.enumerate() {
            if at_s <= before_s {
                let expected = format!("a time after {} s, the time of the previous entry", number_text(before_s));
                return self.inner(name).item(number).refuse("at_s", number_text(at_s), expected);
            }
            before_s = at_s;
        }
        Ok(())
    }

    pub fn count(&self, name: &str, count: usize, max: usize) -> Check {
        if count <= max { Ok(()) } else { self.refuse(name, count.to_string(), format!("at most {max}")) }
    }

    pub fn inside(&self, name: &str, corners: &[DVec2], frame: &FieldFrame) -> Check {
        if corners.iter().all(|&corner| frame.border_distance(corner) >= -ROUNDING_M) {
            return Ok(());
        }
        let expected =
            format!("a place with the whole body inside the field of {} x {} m", frame.width_m(), frame.height_m());
        self.refuse(name, "partly or wholly outside".into(), expected)
    }

    pub fn refuse(&self, name: &str, found: String, expected: String) -> Check {
        self.refuse_step(PathStep::key(name), found, expected)
    }

    pub fn refuse_step(&self, step: PathStep, found: String, expected: String) -> Check {
        Err(Box::new(ValidationError { path: self.0.join(step), found, expected: Expected::Text(expected) }))
    }

    /// Refuses a name that nobody of this kind, planner or policy, has.
    pub fn refuse_name(&self, key: &str, kind: &'static str, found: &str, valid_names: Vec<String>) -> Check {
        let path = self.0.join(PathStep::key(key));
        Err(Box::new(ValidationError { path, found: found.to_owned(), expected: Expected::Name { kind, valid_names } }))
    }
}
