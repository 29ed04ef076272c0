//! The compiled half of the Python package `wildfire-contest`: simulation, planning and collision checks. The other half,
//! `wildfire_contest/`, contains the parts that read better in Python.
//!
//! The interpreter's lock is released during simulation, planning by built-in planners, and collision checks of many poses.
//! Nothing here relies on the lock for its own safety.

mod arrays;
mod audit;
mod batch;
mod checker;
mod columns;
mod compare;
mod drive;
mod envs;
mod errors;
mod grid_maps;
mod interruption;
mod literal;
mod observation;
mod path;
mod plan;
mod planner;
mod policy;
mod program;
mod query;
mod run;
mod scenario;
mod tables;

#[pyo3::pymodule(gil_used = false)]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::audit::{Violation, audit};
    #[pymodule_export]
    use crate::batch::{Batch, batch, read_batch, run_shard};
    #[pymodule_export]
    use crate::checker::Checker;
    #[pymodule_export]
    use crate::compare::compare;
    #[pymodule_export]
    use crate::drive::Driver;
    #[pymodule_export]
    use crate::envs::{Contests, SavedContest, named_agents};
    #[pymodule_export]
    use crate::grid_maps::{search_grid, wavefront_map};
    #[pymodule_export]
    use crate::path::{Path, dubins_length, reeds_shepp_length};
    #[pymodule_export]
    use crate::plan::{certify, find_path, judge, plan, plan_together};
    #[pymodule_export]
    use crate::program::command_line;
    #[pymodule_export]
    use crate::query::{Query, Site, Vehicle};
    #[pymodule_export]
    use crate::run::{Run, restored_run, run};
    #[pymodule_export]
    use crate::scenario::{Scenario, restored_scenario, scenario};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", wildfire::batch::plan::PROGRAM_VERSION)
    }
}
