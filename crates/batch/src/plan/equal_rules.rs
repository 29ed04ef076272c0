//! The rules that entries of a ranking must share: a scenario without what is an entry's own. A course asks before its
//! first run, and a ranking before it counts.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value as Json;

use super::{ENTRY_COLUMN, FreeKeys};

/// Keys in which entries may differ unless more are freed: who plans, who chooses, and how they are set.
pub const USUALLY_FREE: [&str; 10] = [
    "planner.*",
    "policy.*",
    "unimog.planner",
    "unimog.goal",
    "unimog.prm",
    "unimog.primitives",
    "unimog.prm_rs",
    "unimog.hybrid",
    "unimog.lattice",
    "unimog.safety",
];

/// The members of a scenario that hold the tables of programs, whose names and contents are an entry's own, and those of
/// a table that limit what a program may take.
pub const TABLES_OF_PROGRAMS: [&str; 2] = ["planner", "policy"];
const LIMITS: [&str; 9] = [
    "start_limit_s",
    "query_limit_s",
    "query_cpu_s",
    "memory_limit_mb",
    "seconds_per_expansion",
    "expansions_per_query",
    "query_instructions",
    "start_instructions",
    "restarts",
];

/// The columns that name an entry whatever was swept.
pub const COLUMNS_OF_ENTRIES: [&str; 3] = [ENTRY_COLUMN, "planner", "policy"];

impl FreeKeys {
    /// Returns whether the values of a column are an entry's own, where these keys are free.
    pub fn belongs_to_entry(&self, column: &str) -> bool {
        COLUMNS_OF_ENTRIES.contains(&column)
            || self.has_key(column)
            || column.split('.').next().is_some_and(|first| TABLES_OF_PROGRAMS.contains(&first))
    }
}

/// The keys in which entries may differ.
#[derive(Clone, Debug)]
pub struct FreeParameters {
    /// Keys of scenarios.
    pub keys: FreeKeys,
    /// Limits of programs, by their keys.
    pub limits: FreeKeys,
}

impl FreeParameters {
    /// The usual keys and these, which free limits of programs too.
    ///
    /// # Errors
    /// If one of them is no key.
    pub fn parse(more: &[&str]) -> Result<Self, super::FreeKeysError> {
        let all: Vec<&str> = USUALLY_FREE.into_iter().chain(more.iter().copied()).collect();
        Ok(Self { keys: FreeKeys::parse(&all)?, limits: FreeKeys::parse(more)? })
    }
}

/// Returns a scenario without what is an entry's own.
pub fn rules_of(mut scenario: Json, free: &FreeKeys) -> Json {
    resolve_rescue(&mut scenario);
    if let Json::Object(table) = &mut scenario {
        TABLES_OF_PROGRAMS.iter().for_each(|name| drop(table.remove(*name)));
        table.remove("name");
    }
    free.remove_from(&mut scenario);
    scenario
}

/// By key, all values that it has in the tables of some programs, as JSON: a second program may have no other than the first.
pub type LimitsOfPrograms = BTreeMap<String, BTreeSet<String>>;

/// Returns the limits of the programs that play in a scenario, except those that are free.
pub fn limits_of_programs(scenario: &Json, free: &FreeKeys) -> LimitsOfPrograms {
    let mut limits = LimitsOfPrograms::new();
    for (list, name, table) in programs_of(scenario) {
        for key in LIMITS.into_iter().filter(|key| !free.has(&[list, name, key])) {
            limits.entry(format!("{list}.*.{key}")).or_default().insert(table[key].to_string());
        }
    }
    limits
}

/// Returns the table of a program that is kept from run to run, if one plays, such as `planner.mine`.
pub fn kept_program(scenario: &Json) -> Option<String> {
    let mut kept = programs_of(scenario).filter(|(_, _, table)| table["reuse"].as_bool() == Some(true));
    kept.next().map(|(list, name, _)| format!("{list}.{name}"))
}

/// Lists the tables of the programs that play in a scenario, each with the list that it is in and its name.
fn programs_of(scenario: &Json) -> impl Iterator<Item = (&'static str, &str, &Json)> {
    let agents = ["unimog", "wumpus"].into_iter().flat_map(|kind| scenario[kind].as_array().into_iter().flatten());
    let of_agents = agents.flat_map(|agent| [&agent["planner"], &agent["goal"]]);
    let has_crews = scenario["crew"].as_array().is_some_and(|crews| !crews.is_empty());
    let of_crews = has_crews.then(|| &scenario["line"]["policy"]);
    let names: BTreeSet<&str> = of_agents.chain(of_crews).filter_map(Json::as_str).collect();
    TABLES_OF_PROGRAMS.into_iter().flat_map(move |list| {
        let tables = scenario[list].as_object().into_iter().flatten();
        let plays = names.clone();
        tables
            .filter(move |(name, _)| plays.contains(name.as_str()))
            .map(move |(name, table)| (list, name.as_str(), table))
    })
}

/// Replaces the choice that depends on who plans, so that it is compared as what it comes to.
fn resolve_rescue(scenario: &mut Json) {
    let built_in = wildfire_planning::TruckPlannerKind::ALL.map(|kind| kind.to_string());
    for truck in scenario["unimog"].as_array_mut().into_iter().flatten() {
        if truck["rescue"].as_str() == Some("auto") {
            let is_built_in =
                truck["planner"].as_str().is_some_and(|name| built_in.iter().any(|planner| planner == name));
            truck["rescue"] = is_built_in.into();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_second_program_hides_no_limit_and_crews_have_programs_too() {
        let scenario = json!({
            "unimog": [{ "planner": "mine", "goal": "nearest" }, { "planner": "other", "goal": "nearest" }],
            "crew": [{}],
            "line": { "policy": "crews" },
            "planner": { "mine": { "query_cpu_s": 1.0 }, "other": { "query_cpu_s": 50.0 }, "idle": { "query_cpu_s": 7.0 } },
            "policy": { "crews": { "query_cpu_s": 3.0, "reuse": true } },
        });
        let limits = limits_of_programs(&scenario, &FreeKeys::default());
        assert_eq!(limits["planner.*.query_cpu_s"], BTreeSet::from(["1.0".to_owned(), "50.0".to_owned()]));
        assert_eq!(limits["policy.*.query_cpu_s"], BTreeSet::from(["3.0".to_owned()]));
        assert_eq!(kept_program(&scenario).as_deref(), Some("policy.crews"));
        let mut without_crews = scenario;
        without_crews["crew"] = json!([]);
        assert_eq!(kept_program(&without_crews), None);
    }
}
