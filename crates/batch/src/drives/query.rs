//! A query to a planner, or a path that was computed elsewhere, without the path.

use std::fmt;
use std::sync::Arc;

use crate::plan::Value;
use crate::table::{Column, Kind, Unit, about, columns};
use wildfire_planning::PlanFailure;
use wildfire_planning::judge::DriveFigures;

/// A column of a table of drives.
pub type DriveColumn = Column<fn(&DriveQuery) -> Value>;

/// A goal, the planner, and the cost and quality of the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveQuery {
    /// The seed; `None` in a table without seeds.
    pub seed: Option<u64>,
    /// The index of its variant in the table.
    pub variant: usize,
    pub field: Arc<str>,
    /// The index of the goal on its field.
    pub goal: usize,
    pub planner: Arc<str>,
    /// The cost; `None` for a path that was computed elsewhere.
    pub cost: Option<QueryCost>,
    /// The figures of the path, valid or not; `None` without a path.
    pub figures: Option<DriveFigures>,
    pub failure: Option<DriveFailure>,
    /// The first violation that the audit found on the path.
    pub violation: Option<Box<str>>,
    /// The certified lower bound on the length of any path to the goal; `None` if there is none, or it was not asked for.
    pub certified_bound_m: Option<f64>,
    /// The planner's own message about a failure, which is no column.
    pub message: Option<Box<str>>,
}

/// The cost of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueryCost {
    /// CPU time of the clearance field and of the planner's own preparation, equal for all goals of a field.
    pub cpu_build_s: f64,
    pub cpu_query_s: f64,
    pub expansions: u64,
}

/// The reason why a goal was not reached although the path, if there is one, breaks no rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DriveFailure {
    Planner(PlanFailure),
    /// A table of paths has no path to this goal.
    NoPath,
    /// A recorded truck dropped the goal while driving.
    Dropped,
}

impl DriveFailure {
    /// Says whether there was a path, and the planner's gate refused it.
    pub fn is_refusal(self) -> bool {
        self == Self::Planner(PlanFailure::BadAnswer)
    }

    /// Returns the failure with this name.
    pub fn parse(text: &[u8]) -> Option<Self> {
        let planners = PlanFailure::ALL.map(Self::Planner);
        planners.into_iter().chain([Self::NoPath, Self::Dropped]).find(|failure| failure.to_string().as_bytes() == text)
    }
}

impl fmt::Display for DriveFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Planner(failure) => failure.fmt(f),
            Self::NoPath => f.write_str("no path"),
            Self::Dropped => f.write_str("dropped"),
        }
    }
}

impl DriveQuery {
    /// Returns what is wrong with a path that was refused, so that nobody drove or audited it.
    fn refusal(&self) -> Option<&str> {
        self.message.as_deref().filter(|_| self.failure.is_some_and(DriveFailure::is_refusal))
    }

    /// Returns the figures of a path that reaches its goal and that the audit accepts.
    pub fn solved(&self) -> Option<&DriveFigures> {
        self.figures.as_ref().filter(|_| self.failure.is_none() && self.violation.is_none())
    }
}

/// The columns of tables of drives, in their order, after the seed and what is swept.
#[rustfmt::skip]
pub const DRIVE_COLUMNS: &[DriveColumn] = columns! { DriveColumn, query;
    field: Text None "name of the field" = query.field.to_string();
    goal: Count None "number of the goal on its field, from 0" = query.goal as u64;
    planner: Text None "planner that was queried, or that computed the path" = query.planner.to_string();
    success: Flag None "whether a path reaches the goal and passes the audit" = query.solved().is_some();
    reason: optional Text None "why the goal was not reached" = query.failure.map(|failure| failure.to_string());
    cpu_build_s: optional Real CpuSeconds "CPU time: clearance field and the planner's preparation"
        = query.cost.map(|cost| cost.cpu_build_s);
    cpu_query_s: optional Real CpuSeconds "CPU time: the query" = query.cost.map(|cost| cost.cpu_query_s);
    length_m: optional Real Metres "length of the path" = query.figures.map(|path| path.length_m);
    lower_bound_ratio: optional Real None "length over a lower bound on the length of any path"
        = query.figures.and_then(|path| path.printed_ratio());
    min_clearance_m: optional Real Metres "smallest distance to a bush or the border"
        = query.figures.map(|path| path.min_clearance_m);
    cusps: optional Count None "changes between forward and reverse" = query.figures.map(|path| path.cusps);
    drive_s: optional Real Seconds "time of the drive" = query.figures.map(|path| path.drive_s);
    expansions: optional Count None "nodes expanded" = query.cost.map(|cost| cost.expansions);
    violation: optional Text None "first violation found by the audit on the path, or what is wrong with a refused one"
        = query.violation.as_deref().or(query.refusal()).map(str::to_owned);
};

/// The column of tables of drives whose goals have certificates; it is the last.
pub const CERTIFIED_COLUMN: DriveColumn = columns! { DriveColumn, query;
    certified_bound_m: optional Real Metres "lower bound on the length of any path, with a certificate"
        = query.certified_bound_m;
}[0];
