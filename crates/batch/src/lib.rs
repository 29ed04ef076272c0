#![doc = include_str!("../README.md")]
//!
//! Many runs: the plan, workers, a journal that loses nothing, tables in the order of the plan.
//!
//! A [`BatchPlan`](plan::BatchPlan) lists the runs. A [`Batch`](execute::Batch) executes them on several threads and keeps a
//! journal with a line for each finished one; the tables are written from the journal when all have finished. So a batch can be
//! stopped at any moment and resumed, and each run adds only a few bytes of memory. Apart from its `cpu_` and `wall_` columns,
//! a row never depends on the number of workers, on slices or on interruptions. A run that fails or panics is a row like the
//! others, with the reason.
//!
//! Four modules, each of which imports only those before it, and eight more beside the last:
//! - `plan`: the runs, frozen in `plan.json`;
//! - `execute`: workers, the journal and its folder; each run yields a [`RunRow`](execute::RunRow);
//! - `table`: the columns, the files written from them, and the reader of these files;
//! - `report`: reports on one batch, from its summary to its page of charts, and its audit;
//! - `maps`: results of a batch for every cell of the field;
//! - `decisions`: what the decisions of a run were worth;
//! - `drives`: queries to planners outside of runs, their table and their summary;
//! - `together`: vehicles that plan at once, their solutions and the check of these;
//! - [`comparison`]: comparisons of batches, including those of other versions of the program;
//! - [`stopping`]: batches that stop when enough is known;
//! - [`arena`]: frozen tracks, and boards of entries on them;
//! - [`grading`]: marks for an entry of a course.

pub mod arena;
pub mod comparison;
pub mod decisions;
pub mod drives;
pub mod execute;
pub mod grading;
pub mod maps;
pub mod plan;
pub mod report;
pub mod stats;
pub mod stopping;
pub mod table;
pub mod together;
