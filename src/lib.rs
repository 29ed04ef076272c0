//! A contest between motion planners on a burning field: an arsonist on a grid, the Wumpus, sets bushes on fire; a fire
//! truck with Ackermann steering, the Unimog, puts them out.
//!
//! The same scenario and seed give the same run on every machine, bit for bit. Lengths are metres, times seconds, angles
//! radians counter-clockwise; x points east, y north, from the field's south-west corner.
//!
//! ```
//! // A built-in scenario or a file, with any value changed.
//! let scenario = wildfire::load("contest", &["fire.burn_out_s=45".to_owned()])?;
//! let run = wildfire::run(&scenario, 7)?;
//! let outcome = wildfire::Outcome::new(&run.timeline);
//! println!("{} of {} bushes burned", outcome.burned(), outcome.obstacles);
//! assert_eq!(outcome.obstacles, outcome.intact + outcome.burned() + outcome.extinguished);
//! // The audit shares no code with the planners.
//! let verdict = wildfire::audit_timeline(&run.timeline, Default::default());
//! assert!(verdict.violation.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A custom planner
//!
//! A type that implements [`TruckPlanner`] enters the contest under a name that scenarios give to their trucks. Its
//! paths are checked before they are driven, and its CPU time is measured. [`own_planner`] has what that takes.
//!
//! ```
//! use wildfire::own_planner::{MakeError, Planners, ReedsShepp, PlannerContext, run_with};
//! use wildfire::{CollisionChecker, Goal, Plan, PlanFailure, Pose, TruckPlanner};
//!
//! /// Drives the shortest curve to the fire, if that is free.
//! struct Bold(CollisionChecker);
//!
//! impl TruckPlanner for Bold {
//!     fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
//!         let Goal::Disc(disc) = goal else { return Plan::from(Err(PlanFailure::GoalBlocked)) };
//!         let ahead = (disc.centre - start.position()).normalize_or_zero() * (disc.radius_m - 3.0);
//!         let end = Pose::new(disc.centre.x - ahead.x, disc.centre.y - ahead.y, start.heading);
//!         let curves = ReedsShepp { radius_m: self.0.body().turning_radius_m };
//!         let path = curves.shortest(start, end).path(start);
//!         let is_free = path.legs().all(|(pose, segment)| self.0.motion_is_free(pose, segment, 0.1));
//!         Plan::from(if is_free { Ok(path) } else { Err(PlanFailure::Disconnected) })
//!     }
//! }
//!
//! let make = |context: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> { Ok(Box::new(Bold(context.checker.clone()))) };
//! let planners = Planners::default().with("bold", make)?;
//! let changes = ["planner.bold.command=[]", "unimog.planner=bold"].map(str::to_owned);
//! let run = run_with(&wildfire::load("contest", &changes)?, 7, &planners)?;
//! assert!(wildfire::Outcome::new(&run.timeline).extinguished > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The whole program with one planner more is [`own_planner::main_with`], in a `main.rs` of five lines.
//!
//! # What is for users, and what is not
//!
//! The names on this page and in [`own_planner`] are. They are documented in full, and a change of them is an entry in the
//! changelog. What else can be reached from here is open because the tests, benchmarks and examples of this package use it,
//! and may change with every version. The parts that are of use by themselves are crates with front pages of their own:
//! `wildfire-base`, `wildfire-grid`, `wildfire-fire`, `wildfire-planning`, `wildfire-timeline`, `wildfire-audit`,
//! `wildfire-picture`, `wildfire-scenario`, `wildfire-sim`, `wildfire-batch`, each of which may use those before it.

#![warn(missing_docs, reason = "every name of the front page is explained; tests/front_page.rs looks inside its types")]

// What fuzzers share is also part of the tests in `tests/`, where this crate has its name.
#[cfg(test)]
extern crate self as wildfire;

#[doc(hidden)]
pub mod cli;

pub use wildfire_audit::{Verdict, audit_timeline};
pub use wildfire_base::geometry::Pose;
pub use wildfire_base::query::{Goal, PlanFailure};
pub use wildfire_base::time::SimTime;
pub use wildfire_base::vehicle::{Dimensions, Path};
pub use wildfire_planning::collision::{ClearanceField, CollisionChecker};
pub use wildfire_planning::{Plan, TruckPlanner};
pub use wildfire_scenario::{Scenario, load};
pub use wildfire_sim::{Run, run};
pub use wildfire_timeline::file::read as read_recording;
pub use wildfire_timeline::{Fact, Outcome, Timeline};

#[doc(hidden)]
pub use wildfire_base::{
    document, event_queue, geometry, input_file, npy, or_none, query, ranges, rng, time, trajectory, untrusted,
    vehicle, whole_file,
};
#[doc(hidden)]
pub use wildfire_batch::{self as batch, stats};
#[doc(hidden)]
pub use wildfire_grid::{self as grid, map_files};
#[doc(hidden)]
pub use wildfire_planning::{self as planning, collision};
#[doc(hidden)]
pub use wildfire_scenario as scenario;
#[doc(hidden)]
pub use wildfire_sim::{self as sim, programs};
#[cfg(feature = "view")]
#[doc(hidden)]
pub use wildfire_view as view;
#[doc(hidden)]
pub use {wildfire_audit as audit, wildfire_fire as fire, wildfire_picture as picture, wildfire_timeline as timeline};

/// What it takes to enter the contest with a custom planner.
///
/// A planner implements [`TruckPlanner`]. [`Planners`](own_planner::Planners) knows it by its name, together with the
/// built-in ones, and makes one for every truck of every run that asks for it. The scenario has a table `[planner.NAME]`,
/// which may be empty, and gives the name to its trucks as `unimog.planner`. Runs, batches and the whole command line take
/// planners: [`run_with`](own_planner::run_with), [`main_with`](own_planner::main_with). The [`Judge`](own_planner::Judge)
/// tells in advance whether a path would be driven.
pub mod own_planner {
    pub use crate::cli::main_with;
    pub use wildfire_base::vehicle::{ReedsShepp, Segment};
    pub use wildfire_planning::judge::{BadPath, Judge};
    pub use wildfire_planning::{MakeError, NameError, PlannerContext, PlannerFactory, PlannerName, Planners};
    pub use wildfire_sim::run_with;
}
