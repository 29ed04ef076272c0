//! The programs of a scenario's tables as planners by name, and those that wait between two runs.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rand::Rng;
use serde_json::Value;

use super::external_client::{ExternalClient, Idle};
use super::launch::{Launch, ProcessLimits};
use super::planner::ProgramPlanner;
use super::policy::ProgramPolicy;
use super::protocol::{FieldMessage, LimitsMessage, ToProgram, VehicleMessage};
use crate::StartPrograms;
use crate::policies::{Policies, Policy, PolicyContext, PolicyNameError};
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_base::trajectory::SpeedLimits;
use wildfire_base::vehicle::{Dimensions, ReedsShepp};
use wildfire_module::{Engine, Module};
use wildfire_planning::collision::{ClearanceField, MIN_CLEARANCE_M};
use wildfire_planning::{MakeError, NameError, PlannerContext, PlannerName, Planners, TruckPlanner};
use wildfire_scenario::{Program, Programs, Scenario, UsedProgram};

/// The most processes of a program at once.
const MAX_PROCESSES: usize = 16;

/// Bits of a seed that a program gets: all whole numbers below 2^53 are f64.
const SEED_BITS: u32 = 53;

/// The programs that may be started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trust {
    /// Those of every table, whoever wrote it.
    All,
    /// Those with these kinds (`planner`, `policy`) and names, which the user gave himself.
    Only(BTreeSet<(&'static str, PlannerName)>),
}

impl Trust {
    /// Returns whether a program may be started. A module can do nothing but answer, so it always may.
    pub fn includes(&self, kind: &'static str, name: &PlannerName, table: &Program) -> bool {
        match self {
            Self::All => true,
            Self::Only(_) if table.module.is_some() => true,
            Self::Only(named) => named.contains(&(kind, name.clone())),
        }
    }
}

/// Makes planners and policies of the programs that scenarios name, as often as runs ask for them.
#[derive(Clone, Debug)]
pub struct ProgramPool {
    trust: Trust,
    idle: Arc<Idle>,
    /// Compiled modules by their file and the bytes of their memory.
    modules: Arc<Mutex<BTreeMap<(PathBuf, usize), Module>>>,
}

impl ProgramPool {
    /// Creates a pool in which no program has been started.
    pub fn new(trust: Trust) -> Self {
        Self { trust, idle: Arc::default(), modules: Arc::default() }
    }

    /// Adds the planners of a scenario's tables, as far as they are trusted, to those that are known otherwise.
    ///
    /// # Errors
    /// If one of them cannot have its name.
    pub fn planners_of(&self, scenario: &Scenario, registry: Planners) -> Result<Planners, NameError> {
        self.trusted("planner", &scenario.planner).try_fold(registry, |planners, (name, table)| {
            let launch = self.launch(name, table);
            let run = scenario.name.clone();
            let stream = name.name().to_owned();
            planners.with(name.name(), move |site: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
                let (launch, idle) = launch.clone().map_err(MakeError::new)?;
                let seed = (site.stream)(&stream).next_u64() >> (u64::BITS - SEED_BITS);
                let cells = bushes(site.checker.field());
                let message = ToProgram::Field(FieldMessage {
                    truck: Some(site.truck),
                    vehicle: Some(vehicle(site.body, site.limits)),
                    limits: Some(limits(site.limits)),
                    ..FieldMessage::new(&run, seed, site.checker.field().frame(), &cells, site.custom_settings)
                });
                let respondent = start(launch, idle.as_ref(), seed, &message)?;
                let curves = ReedsShepp { radius_m: site.body.turning_radius_m };
                Ok(Box::new(ProgramPlanner { respondent: Some(respondent), idle, curves }))
            })
        })
    }

    /// Adds the policies of a scenario's tables, as far as they are trusted, to those that are known otherwise.
    ///
    /// # Errors
    /// If one of them cannot have its name.
    pub fn policies_of(&self, scenario: &Scenario, registry: Policies) -> Result<Policies, PolicyNameError> {
        let bodies: Arc<[_]> = scenario.unimog.iter().map(|truck| (truck.vehicle, truck.speed_limits())).collect();
        self.trusted("policy", &scenario.policy).try_fold(registry, |policies, (name, table)| {
            let launch = self.launch(name, table);
            let run = scenario.name.clone();
            let stream = name.name().to_owned();
            let bodies = Arc::clone(&bodies);
            let make = move |site: &PolicyContext<'_>| -> Result<Box<dyn Policy>, MakeError> {
                // A module that cannot be read is an error only of runs that need it.
                let (launch, idle) = launch.clone().map_err(MakeError::new)?;
                // Cut to what numbers of JSON hold exactly.
                let seed = (site.stream)(&stream).next_u64() >> (u64::BITS - SEED_BITS);
                // A policy gets one body: that of its first truck.
                let first = site.plays.iter().find(|agent| agent.role.drives());
                let body = first.and_then(|agent| bodies.get(usize::from(agent.number)));
                let cells: Vec<[u16; 2]> = site.bushes.iter().copied().map(column_and_row).collect();
                let message = ToProgram::Field(FieldMessage {
                    vehicle: body.map(|(body, speeds)| vehicle(body, speeds)),
                    limits: body.map(|(_, speeds)| limits(speeds)),
                    agents: Some(site.agents.iter().map(ToString::to_string).collect()),
                    plays: Some(site.plays.iter().map(ToString::to_string).collect()),
                    ..FieldMessage::new(&run, seed, &site.frame, &cells, site.custom_settings)
                });
                let respondent = start(launch, idle.as_ref(), seed, &message)?;
                Ok(Box::new(ProgramPolicy::new(respondent, idle)))
            };
            policies.with(name.name(), make)
        })
    }

    fn trusted<'a>(
        &'a self,
        kind: &'static str,
        tables: &'a Programs,
    ) -> impl Iterator<Item = (&'a PlannerName, &'a Program)> {
        tables.iter().filter(move |(name, table)| table.is_external() && self.trust.includes(kind, name, table))
    }

    /// Returns what starts the program of a table, and where it waits between runs if it may. A module is always fresh.
    fn launch(&self, name: &PlannerName, table: &Program) -> Result<(Launch, Option<Arc<Idle>>), String> {
        let mut launch = launch(name, table);
        let Some(file) = &table.module else {
            return Ok((launch, table.reuse.then(|| Arc::clone(&self.idle))));
        };
        // Each run sets its own seed when it starts the module.
        launch.module = Some((self.module(file, table)?, 0));
        Ok((launch, None))
    }

    /// Reads and compiles a module, once for all runs.
    fn module(&self, file: &Path, table: &Program) -> Result<Module, String> {
        let path = table.works_in.join(file);
        let limits = table.module_limits();
        let key = (path, limits.memory);
        // Held while compiling: another thread that needs the same module waits instead of compiling it as well.
        let mut modules = self.modules.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(module) = modules.get(&key) {
            return Ok(module.clone());
        }
        let bytes = table.read_module(file).map_err(|error| format!("{}: {error}", key.0.display()))?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let module = Module::new(Engine::default(), &name, &bytes, limits)
            .map_err(|message| format!("{} {message}", key.0.display()))?;
        modules.insert(key, module.clone());
        Ok(module)
    }
}

impl StartPrograms for ProgramPool {
    fn add(
        &self,
        scenario: &Scenario,
        planners: Planners,
        policies: Policies,
    ) -> Result<(Planners, Policies), MakeError> {
        let mut used = scenario.used_programs().into_iter();
        if let Some(UsedProgram { name, table, .. }) =
            used.find(|used| !self.trust.includes(used.kind, used.name, used.table))
        {
            return Err(MakeError::new(format!("`{name}` is not trusted: {}", table.command_line())));
        }
        let planners = self.planners_of(scenario, planners).map_err(|error| MakeError::new(error.to_string()))?;
        let policies = self.policies_of(scenario, policies).map_err(|error| MakeError::new(error.to_string()))?;
        Ok((planners, policies))
    }
}

fn start(
    mut launch: Launch,
    idle: Option<&Arc<Idle>>,
    seed: u64,
    field: &ToProgram<'_>,
) -> Result<ExternalClient, MakeError> {
    let before = idle.and_then(|idle| idle.take(&launch));
    launch.module.iter_mut().for_each(|(_, of_run)| *of_run = seed);
    ExternalClient::new(Arc::new(launch), field, before).map_err(|error| MakeError::new(error.message))
}

impl<'a> FieldMessage<'a> {
    /// Creates the message of a field on which nobody is yet.
    fn new(run: &str, seed: u64, frame: &FieldFrame, cells_cr: &'a [[u16; 2]], settings: &'a Value) -> Self {
        Self {
            run: run.to_owned(),
            truck: None,
            seed,
            cols: frame.cols,
            rows: frame.rows,
            cell_m: frame.cell_m,
            cells_cr,
            vehicle: None,
            limits: None,
            least_clearance: MIN_CLEARANCE_M,
            settings,
            agents: None,
            plays: None,
        }
    }
}

fn column_and_row(cell: Cell) -> [u16; 2] {
    [cell.col, cell.row]
}

/// Lists column and row of the bushes of a field.
fn bushes(field: &ClearanceField) -> Vec<[u16; 2]> {
    let cells = field.occupied().values().iter().enumerate().filter(|&(_, &occupied)| occupied);
    cells.map(|(index, _)| column_and_row(field.frame().cell(index))).collect()
}

fn vehicle(body: &Dimensions, limits: &SpeedLimits) -> VehicleMessage {
    VehicleMessage {
        length: body.length_m,
        width: body.width_m,
        wheelbase: body.wheelbase_m,
        rear_overhang: body.rear_overhang_m,
        min_turn_radius: body.turning_radius_m,
        v_max: limits.forward_mps,
        v_max_reverse: limits.reverse_mps,
    }
}

fn limits(limits: &SpeedLimits) -> LimitsMessage {
    LimitsMessage {
        acceleration: limits.acceleration_mps2,
        braking: limits.braking_mps2,
        lateral: limits.lateral_mps2,
        steering: limits.steering.map(|steering| steering.rate_rad_s),
    }
}

/// Returns what starts the program of a table, and what it may take.
fn launch(name: &PlannerName, table: &Program) -> Launch {
    // A process cannot be started in a folder of an empty name.
    let folder = if table.works_in.as_os_str().is_empty() { Path::new(".") } else { &table.works_in };
    Launch {
        name: table.label.clone().unwrap_or_else(|| name.to_string()),
        command: table.command.iter().map(Into::into).collect(),
        folder: folder.to_owned(),
        is_sandboxed: table.sandbox,
        start_limit: Duration::from_secs_f64(table.start_limit_s),
        query_limit: Duration::from_secs_f64(table.query_limit_s),
        query_cpu: table.query_cpu_s.map(Duration::from_secs_f64),
        restarts: table.restarts,
        expansions_per_query: table.expansions_per_query,
        module: None,
        start_instructions: table.start_instructions(),
        query_instructions: table.query_instructions(),
        limits: ProcessLimits { memory_mb: table.memory_limit_mb.into(), processes: MAX_PROCESSES },
    }
}
