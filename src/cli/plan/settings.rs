//! The settings that planners had.

use crate::planning::TruckPlannerKind;
use crate::scenario::LoadedScenario;

/// The values of a planner's settings of the first truck, by names such as `hybrid.shortcuts`.
pub fn planner_settings(planner: TruckPlannerKind, loaded: &LoadedScenario) -> Vec<(String, String)> {
    let own = |name: String| {
        let name = name.strip_prefix("unimog.0.")?;
        let table = name.split_once('.')?.0;
        planner.maker().tables().contains(&table).then(|| name.to_owned())
    };
    loaded.values().into_iter().filter_map(|(name, value)| Some((own(name)?, value))).collect()
}

/// Settings that bound a planner's effort: expansions, samples, tries.
const BUDGETS: [&str; 3] = ["max_expansions", "samples", "shortcuts"];

/// The settings that bound a planner's effort, as text.
pub fn budget(planner: TruckPlannerKind, loaded: &LoadedScenario) -> String {
    let is_budget = |name: &str| BUDGETS.iter().any(|budget| name.rsplit('.').next() == Some(budget));
    let budgets = planner_settings(planner, loaded).into_iter().filter(|(name, _)| is_budget(name));
    let budgets: Vec<_> = budgets.map(|(name, value)| format!("{name}={value}")).collect();
    if budgets.is_empty() { "none".into() } else { budgets.join(", ") }
}
