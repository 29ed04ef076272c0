//! Requests of drives: as a whole for Python, and step by step for the commands.

use super::attempts::{Attempt, AttemptSettings, attempts};
use super::error::DriveError;
use super::problems::DriveProblems;
use super::table::DriveTable;
use wildfire_planning::{PlannerName, TruckPlannerKind};
use wildfire_scenario::{LoadedScenario, MemoryLimit, Problem, Scenario};
use wildfire_sim::CustomRegistry;
use wildfire_sim::programs::{ProgramPool, Trust};

/// Drives on the fields of one scenario, with one seed.
#[derive(Clone, Debug)]
pub struct DriveRequest {
    /// The scenario whose first truck drives: a file, or a built-in name.
    pub scenario: String,
    /// Changes of the scenario's values, `key=value`.
    pub changes: Vec<String>,
    pub problems: DriveProblems,
    /// The names of planners, `all` for every known one; without any, the first truck's planner.
    pub planners: Vec<PlannerName>,
    /// The seed of all random numbers.
    pub seed: u64,
    pub memory: MemoryLimit,
}

impl DriveRequest {
    /// Asks every planner for every goal, including those of `registry`; programs that files name are not started.
    ///
    /// # Errors
    /// If the scenario, a field or a planner is refused.
    pub fn plan(&self, registry: &CustomRegistry) -> Result<DriveTable, DriveError> {
        let changes = custom_names(registry).chain(self.changes.iter().cloned()).collect::<Vec<_>>();
        let LoadedScenario { scenario, .. } = LoadedScenario::open(&self.scenario, &changes)?;
        let problems = self.problems.load(&scenario, self.seed)?;
        let planners = requested_planners(&self.planners, &scenario);
        expect_planners_exist(registry, &scenario, &planners)?;
        let makers =
            ProgramPool::new(Trust::Only(Default::default())).planners_of(&scenario, registry.planners.clone())?;
        let programs = &scenario.planner;
        let question =
            AttemptSettings { planners: &planners, makers: &makers, programs, seed: self.seed, limit: self.memory };
        let attempts = ask_all(&problems, &question)?;
        Ok(DriveTable::of_one_variant(attempts.iter().map(|attempt| attempt.query(None, 0)).collect()))
    }
}

/// Asks all planners for all goals of all problems, problem by problem.
///
/// # Errors
/// If one of the planners cannot be built, or they would take more memory than the limit.
pub fn ask_all<'a>(problems: &'a [Problem], question: &AttemptSettings<'_>) -> Result<Vec<Attempt<'a>>, DriveError> {
    let drives = problems.iter().map(|problem| {
        attempts(problem, question).map_err(|source| DriveError::Failed { field: problem.name.clone(), source })
    });
    Ok(drives.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// Returns changes of a scenario that declare the registered planners and policies.
pub fn custom_names(registry: &CustomRegistry) -> impl Iterator<Item = String> {
    let CustomRegistry { planners, policies, .. } = registry;
    let planners = planners.custom_names().map(|name| format!("planner.\"{name}\".command=[]"));
    planners.chain(policies.custom_names().map(|name| format!("policy.\"{name}\".command=[]")))
}

/// The name that is every known planner's.
const ALL_PLANNERS: &str = "all";

/// Returns the planners of these names without duplicates, or the first truck's planner.
pub fn requested_planners(names: &[PlannerName], scenario: &Scenario) -> Vec<PlannerName> {
    let default_planner = scenario.unimog.iter().take(1).map(|truck| truck.planner.clone());
    let named = names.iter().flat_map(|name| match name.name() {
        ALL_PLANNERS => {
            TruckPlannerKind::ALL.map(PlannerName::from).into_iter().chain(scenario.planner.keys().cloned()).collect()
        }
        _ => vec![name.clone()],
    });
    let mut planners = Vec::new();
    for planner in named.chain(default_planner.filter(|_| names.is_empty())) {
        // A planner that is named twice, or by name and by `all`, would have two rows for each goal.
        if !planners.contains(&planner) {
            planners.push(planner);
        }
    }
    planners
}

/// Refuses unknown planners: names that are neither built in nor registered, and have no table in the scenario.
pub fn expect_planners_exist(
    registry: &CustomRegistry,
    scenario: &Scenario,
    planners: &[PlannerName],
) -> Result<(), DriveError> {
    let mut unregistered = planners.iter().filter(|name| !registry.planners.knows(name));
    let Some(unknown) = unregistered.find(|name| !scenario.planner.contains_key(*name)) else { return Ok(()) };
    let tables = scenario.planner.keys().map(PlannerName::name);
    let valid = TruckPlannerKind::ALL.map(TruckPlannerKind::name).into_iter().chain(tables).map(str::to_owned);
    Err(DriveError::UnknownPlanner { name: unknown.clone(), valid: valid.collect() })
}
