//! The values of a map, in the type that their algorithm gives.

use std::io;
use std::path::Path;

use serde::Serialize;

use crate::grid::{Grid, Place};
use crate::map_files::{MapValue, write_csv, write_npy};

/// A map of values.
#[derive(Debug)]
pub enum Values {
    Flags(Grid<bool>),
    Distances(Grid<u16>),
    Steps(Grid<u32>),
    Reals(Grid<f64>),
}

/// One value of a map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    Whole(u32),
    Real(f64),
}

impl Values {
    pub fn write_csv(&self, path: &Path) -> io::Result<()> {
        match self {
            Self::Flags(map) => write_csv(path, map),
            Self::Distances(map) => write_csv(path, map),
            Self::Steps(map) => write_csv(path, map),
            Self::Reals(map) => write_csv(path, map),
        }
    }

    pub fn write_npy(&self, path: &Path) -> io::Result<()> {
        match self {
            Self::Flags(map) => write_npy(path, map),
            Self::Distances(map) => write_npy(path, map),
            Self::Steps(map) => write_npy(path, map),
            Self::Reals(map) => write_npy(path, map),
        }
    }

    pub fn at(&self, place: Place) -> Value {
        match self {
            Self::Flags(map) => Value::Whole(map[place].into()),
            Self::Distances(map) => Value::Whole(map[place].into()),
            Self::Steps(map) => Value::Whole(map[place]),
            Self::Reals(map) => Value::Real(map[place]),
        }
    }

    /// The largest value that is finite; `None` if there is none.
    pub fn max(&self) -> Option<Value> {
        match self {
            Self::Flags(map) => map.values().iter().max().map(|&value| Value::Whole(value.into())),
            Self::Distances(map) => map.values().iter().max().map(|&value| Value::Whole(value.into())),
            Self::Steps(map) => map.values().iter().max().map(|&value| Value::Whole(value)),
            Self::Reals(map) => {
                map.values().iter().copied().filter(|value| value.is_finite()).reduce(f64::max).map(Value::Real)
            }
        }
    }
}

impl Value {
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Whole(value) => value.into(),
            Self::Real(value) => value,
        }
    }

    /// The value as the CSV file has it.
    pub fn to_text(self) -> String {
        let mut text = Vec::new();
        match self {
            Self::Whole(value) => value.append_text(&mut text),
            Self::Real(value) => value.append_text(&mut text),
        }
        String::from_utf8(text).expect("numbers are ASCII")
    }

    /// The value with two digits after the point where it is no integer by type.
    pub fn to_short_text(self) -> String {
        match self {
            Self::Whole(value) => value.to_string(),
            Self::Real(value) => format!("{value:.2}"),
        }
    }
}
