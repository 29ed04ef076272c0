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
//! // A second opinion, which shares no code with the planners.
//! let verdict = wildfire::audit_timeline(&run.timeline, Default::default());
//! assert!(verdict.violation.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A planner of one's own
//!
//! Whoever implements [`TruckPlanner`] enters the contest with it, under a name that scenarios give to their trucks. Its
//! paths are checked before they are driven, and its CPU time is measured. [`own_planner`] has what that takes.
//!
//! ```
//! use wildfire::own_planner::{MakeError, Planners, ReedsShepp, Site, run_with};
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
//! let make = |site: &Site<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> { Ok(Box::new(Bold(site.checker.clone()))) };
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
//! The names on this page and in [`own_planner`] are. They are documented in full, and a change of them is an entry in the changelog. The
//! modules behind them are open because the tests, benchmarks and examples of this package use them; they may change
//! with every version and are left out of this documentation. `RUSTDOCFLAGS='--cfg internals' cargo doc` includes them.
//!
//! # Layers
//!
//! Imports point downwards only. Each layer may use those above it in this list:
//! `time`, `geometry`, `rng`, `event_queue`, `input_file`, `or_none`, `ranges`, `untrusted`, `whole_file`; `document`;
//! `grid`; `map_files`; `vehicle`; `trajectory`; `collision`; `planning`; `fire`; `scenario`; `timeline`; `picture`; `audit`;
//! `sim`; `programs`; `stats`; `batch`; `view`; `cli`.

// What fuzzers share is also part of the tests in `tests/`, where this crate has its name.
#[cfg(test)]
extern crate self as wildfire;

#[cfg_attr(not(internals), doc(hidden))]
pub mod audit;
#[cfg_attr(not(internals), doc(hidden))]
pub mod batch;
#[cfg_attr(not(internals), doc(hidden))]
pub mod cli;
#[cfg_attr(not(internals), doc(hidden))]
pub mod collision;
#[cfg_attr(not(internals), doc(hidden))]
pub mod document;
#[cfg_attr(not(internals), doc(hidden))]
pub mod event_queue;
#[cfg_attr(not(internals), doc(hidden))]
pub mod fire;
#[cfg_attr(not(internals), doc(hidden))]
pub mod geometry;
#[cfg_attr(not(internals), doc(hidden))]
pub mod grid;
#[cfg_attr(not(internals), doc(hidden))]
pub mod input_file;
#[cfg_attr(not(internals), doc(hidden))]
pub mod map_files;
#[cfg_attr(not(internals), doc(hidden))]
pub mod npy;
#[cfg_attr(not(internals), doc(hidden))]
pub mod or_none;
#[cfg_attr(not(internals), doc(hidden))]
pub mod picture;
#[cfg_attr(not(internals), doc(hidden))]
pub mod planning;
#[cfg_attr(not(internals), doc(hidden))]
pub mod programs;
#[cfg_attr(not(internals), doc(hidden))]
pub mod query;
#[cfg_attr(not(internals), doc(hidden))]
pub mod ranges;
#[cfg_attr(not(internals), doc(hidden))]
pub mod rng;
#[cfg_attr(not(internals), doc(hidden))]
pub mod scenario;
#[cfg_attr(not(internals), doc(hidden))]
pub mod sim;
#[cfg_attr(not(internals), doc(hidden))]
pub mod stats;
#[cfg_attr(not(internals), doc(hidden))]
pub mod time;
#[cfg_attr(not(internals), doc(hidden))]
pub mod timeline;
#[cfg_attr(not(internals), doc(hidden))]
pub mod trajectory;
#[cfg_attr(not(internals), doc(hidden))]
pub mod untrusted;
#[cfg_attr(not(internals), doc(hidden))]
pub mod vehicle;
#[cfg(feature = "view")]
#[cfg_attr(not(internals), doc(hidden))]
pub mod view;
#[cfg_attr(not(internals), doc(hidden))]
pub mod whole_file;

pub use audit::{Verdict, audit_timeline};
pub use collision::{ClearanceField, CollisionChecker};
pub use geometry::Pose;
pub use planning::{Goal, Plan, PlanFailure, TruckPlanner};
pub use scenario::{Scenario, load};
pub use sim::{Run, run};
pub use time::SimTime;
pub use timeline::file::read as read_recording;
pub use timeline::{Fact, Outcome, Timeline};
pub use vehicle::{Dimensions, Path};

/// What it takes to enter the contest with a planner of one's own.
///
/// A planner implements [`TruckPlanner`]. [`Planners`](own_planner::Planners) knows it by its name, together with the
/// built-in ones, and makes one for every truck of every run that asks for it. The scenario has a table `[planner.NAME]`,
/// which may be empty, and gives the name to its trucks as `unimog.planner`. Runs, batches and the whole command line take
/// planners: [`run_with`](own_planner::run_with), [`main_with`](own_planner::main_with). The [`Judge`](own_planner::Judge)
/// tells beforehand whether a path would be driven.
pub mod own_planner {
    pub use crate::cli::main_with;
    pub use crate::planning::judge::{BadPath, Judge};
    pub use crate::planning::{MakeError, MakePlanner, NameError, PlannerName, Planners, Site};
    pub use crate::sim::run_with;
    pub use crate::vehicle::{ReedsShepp, Segment};
}
