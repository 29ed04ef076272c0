//! Programs where the system is not Unix: none is ever started. Modules are, see [`super::backend`].

use std::time::Duration;

use super::ONLY_ON_UNIX;
use super::launch::{Launch, ProcessError, QueryLimits};

/// A program that was started, which no program is.
#[derive(Debug)]
pub enum NoProcess {}

pub use self::NoProcess as Process;

impl NoProcess {
    pub fn start(_: &Launch) -> Result<Self, ProcessError> {
        Err(ProcessError::crashed(format!("is a program, and {ONLY_ON_UNIX}")))
    }

    pub fn exchange(&mut self, _: &[u8], _: QueryLimits<'_>) -> Result<Vec<u8>, ProcessError> {
        match *self {}
    }

    pub fn cpu(&mut self) -> Option<Duration> {
        match *self {}
    }

    pub fn begin_run(&mut self) {
        match *self {}
    }

    pub fn end(self, _: &[u8]) {
        match self {}
    }

    pub fn kill(&mut self) {
        match *self {}
    }
}
