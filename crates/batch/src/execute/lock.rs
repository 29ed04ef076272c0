//! The lock that keeps two processes from working on one slice of a batch.
//!
//! `flock` is the system's lock on an open file: it ends with its process, however that ends. Lustre without the mount
//! option `flock`, NFS without a lock daemon and some others refuse it; there the scheduler keeps processes apart, and a
//! journal that a second process wrote to is found all the same.

use std::fmt;
use std::str::FromStr;

/// The kind of lock that keeps two processes from working on one slice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lock {
    /// The lock of the operating system.
    #[default]
    Flock,
    /// No lock: the caller makes sure that no other process works on the slice.
    None,
}

impl FromStr for Lock {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "flock" => Ok(Self::Flock),
            "none" => Ok(Self::None),
            _ => Err("expected `flock` or `none`".into()),
        }
    }
}

impl fmt::Display for Lock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Flock => "flock",
            Self::None => "none",
        })
    }
}
