//! The path from start to goal, whichever algorithm searched for it.

use serde::Serialize;

use crate::grid::descent::{Descent, Escape};
use crate::grid::place::octile_length;
use crate::grid::{Place, Route};

/// The answer to the question for a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WalkResult {
    Reached,
    Unreachable,
    Stuck,
    StartOccupied,
}

/// A way and its ends.
#[derive(Debug)]
pub struct Walk {
    pub start: Place,
    pub goal: Place,
    pub way: Way,
}

/// The path as far as it leads.
#[derive(Debug)]
pub struct Way {
    pub answer: WalkResult,
    /// Cells from the start on; empty if the way does not begin.
    pub cells: Vec<Place>,
    /// The local minimum in which a descent ended.
    pub minimum: Option<Place>,
}

impl From<Route> for Way {
    fn from(route: Route) -> Self {
        let (answer, cells) = match route {
            Route::Found(cells) => (WalkResult::Reached, cells),
            Route::Unreachable => (WalkResult::Unreachable, Vec::new()),
            Route::StartOccupied => (WalkResult::StartOccupied, Vec::new()),
        };
        Self { answer, cells, minimum: None }
    }
}

impl From<Descent> for Way {
    fn from(descent: Descent) -> Self {
        match descent {
            Descent::Reached(cells) => Self { answer: WalkResult::Reached, cells, minimum: None },
            Descent::Stuck(cells) => Self { answer: WalkResult::Stuck, minimum: cells.last().copied(), cells },
            Descent::StartOccupied => Route::StartOccupied.into(),
        }
    }
}

impl From<Escape> for Way {
    fn from(escape: Escape) -> Self {
        match escape {
            Escape::NotNeeded(cells) => Descent::Reached(cells).into(),
            Escape::HandedOver { descent: mut cells, wavefront } => {
                let minimum = cells.last().copied();
                cells.extend(wavefront.into_iter().skip(1));
                Self { answer: WalkResult::Reached, cells, minimum }
            }
            Escape::Unreachable(cells) => Self { answer: WalkResult::Unreachable, ..Descent::Stuck(cells).into() },
            Escape::StartOccupied => Route::StartOccupied.into(),
        }
    }
}

impl Walk {
    pub fn sentence(&self) -> String {
        let at = |(row, col): Place| format!("row {row}, column {col}");
        let (start, goal) = (at(self.start), at(self.goal));
        let minimum = self.way.minimum.map(|place| format!("Stuck in a local minimum at {}", at(place)));
        let measures = self.way.measures();
        match (self.way.answer, minimum) {
            (WalkResult::Reached, None) => format!("Reached the goal: {measures}."),
            (WalkResult::Reached, Some(stuck)) => {
                format!("{stuck}; reached the goal from there by the wavefront: {measures} in all.")
            }
            (WalkResult::Unreachable, None) => {
                format!("Unreachable: no way leads from the start, {start}, to the goal, {goal}.")
            }
            (WalkResult::Unreachable, Some(stuck)) => {
                format!("{stuck}. Unreachable: no way leads from there to the goal, {goal}.")
            }
            (WalkResult::Stuck, stuck) => format!("{}: {measures}.", stuck.unwrap_or_default()),
            (WalkResult::StartOccupied, _) => format!("No path: the start, {start}, lies in an obstacle."),
        }
    }
}

impl Way {
    fn measures(&self) -> String {
        let steps = self.cells.len().saturating_sub(1);
        let noun = if steps == 1 { "step" } else { "steps" };
        format!("{steps} {noun}, length {:.3}", octile_length(&self.cells))
    }
}
