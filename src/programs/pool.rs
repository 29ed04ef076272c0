//! The programs of a scenario's tables as planners by name, and those that wait between two runs.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rand::Rng;

use super::planner::ProgramPlanner;
use super::process::Launch;
use super::protocol::{FieldMessage, LimitsMessage, ToProgram, VehicleMessage};
use super::respondent::{Respondent, Session};
use super::supervisor::Limits;
use crate::collision::{ClearanceField, LEAST_CLEARANCE_M};
use crate::planning::{MakeError, NameError, PlannerName, Planners, Site, TruckPlanner};
use crate::scenario::{Program, Scenario};
use crate::trajectory::SpeedLimits;
use crate::vehicle::{Dimensions, ReedsShepp};

/// The most processes of a program at once.
const MOST_PROCESSES: usize = 16;

/// Bits of a seed that a program gets: all whole numbers below 2^53 are f64.
const SEED_BITS: u32 = 53;

/// Programs that play in more than one run and are free at the moment.
#[derive(Debug, Default)]
pub struct Idle(Mutex<Vec<(Arc<Launch>, Session)>>);

impl Idle {
    fn take(&self, launch: &Launch) -> Option<Session> {
        let mut idle = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = idle.iter().position(|(other, _)| **other == *launch)?;
        Some(idle.swap_remove(found).1)
    }

    /// Takes a program back, unless it has failed.
    pub fn give_back(&self, respondent: Respondent) {
        if let Some(free) = respondent.into_session() {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(free);
        }
    }
}

impl Drop for Idle {
    fn drop(&mut self) {
        let idle = std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner));
        idle.into_iter().for_each(|(_, session)| session.end());
    }
}

/// Makes planners of the programs that scenarios name, as often as runs ask for them.
///
/// Whoever makes one trusts the scenarios: their tables are commands.
#[derive(Clone, Debug, Default)]
pub struct ProgramPool {
    idle: Arc<Idle>,
}

/// A run, as programs are told of it.
#[derive(Clone, Copy, Debug)]
pub struct ProgramRun<'a> {
    pub scenario: &'a Scenario,
    pub seed: u64,
    /// The folder of the scenario, in which programs work.
    pub folder: &'a Path,
}

impl ProgramPool {
    /// Adds the planners of a scenario's tables to those that are known otherwise.
    ///
    /// # Errors
    /// If one of them cannot have its name.
    pub fn planners_of(&self, run: ProgramRun<'_>, known: Planners) -> Result<Planners, NameError> {
        let tables = run.scenario.planner.iter().filter(|(_, table)| !table.command.is_empty());
        tables.fold(Ok(known), |planners, (name, table)| {
            let launch = Arc::new(launch(name, table, run.folder));
            let idle = table.reuse.then(|| Arc::clone(&self.idle));
            let run = format!("{}/{}", run.scenario.name, run.seed);
            let stream = name.name().to_owned();
            let make = move |site: &Site<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
                let frame = site.checker.field().frame();
                let message = ToProgram::Field(FieldMessage {
                    run: run.clone(),
                    truck: Some(site.truck),
                    seed: (site.stream)(&stream).next_u64() >> (u64::BITS - SEED_BITS),
                    cols: frame.cols,
                    rows: frame.rows,
                    cell_m: frame.cell_m,
                    cells_cr: &bushes(site.checker.field()),
                    vehicle: Some(vehicle(site.body, site.limits)),
                    limits: Some(limits(site.limits)),
                    least_clearance: LEAST_CLEARANCE_M,
                    settings: site.own,
                    agents: None,
                    plays: None,
                });
                let before = idle.as_ref().and_then(|idle| idle.take(&launch));
                let respondent = Respondent::new(Arc::clone(&launch), &message, before);
                let respondent = respondent.map_err(|trouble| MakeError::new(trouble.words))?;
                let curves = ReedsShepp { radius_m: site.body.turning_radius_m };
                Ok(Box::new(ProgramPlanner { respondent: Some(respondent), idle: idle.clone(), curves }))
            };
            planners?.with(name.name(), make)
        })
    }
}

/// Lists column and row of the bushes of a field.
fn bushes(field: &ClearanceField) -> Vec<[u16; 2]> {
    let cells = field.occupied().values().iter().enumerate().filter(|&(_, &occupied)| occupied);
    cells.map(|(index, _)| <(u16, u16)>::from(field.frame().cell(index)).into()).collect()
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
    }
}

/// Returns what starts the program of a table, and what it may take.
fn launch(name: &PlannerName, table: &Program, folder: &Path) -> Launch {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    Launch {
        name: name.to_string(),
        command: table.command.iter().map(Into::into).collect(),
        folder: folder.to_owned(),
        start_limit: Duration::from_secs_f64(table.start_limit_s),
        query_limit: Duration::from_secs_f64(table.query_limit_s),
        query_cpu: table.query_cpu_s.map(Duration::from_secs_f64),
        restarts: table.restarts,
        limits: Limits { memory_mb: table.memory_limit_mb.into(), processes: MOST_PROCESSES },
    }
}
