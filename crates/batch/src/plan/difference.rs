//! In what two plans differ, in words.

use serde_json::Value;

use super::BatchPlan;
use wildfire_scenario::{Scenario, value_differences};

/// The most differences that are named.
const MAX: usize = 5;

/// In what a plan differs from the one that is asked for; empty if they are the same.
pub fn differences(there: &BatchPlan, requested: &BatchPlan) -> Vec<String> {
    let mut found = Vec::new();
    let mut compare = |what: &str, there: String, requested: String| {
        if there != requested {
            found.push(sentence(what, &there, &requested));
        }
    };
    // Seeds come first, as another list of seeds is the likeliest difference.
    compare("seeds", there.seeds.to_string(), requested.seeds.to_string());
    compare("record", format!("{:?}", there.record).to_lowercase(), format!("{:?}", requested.record).to_lowercase());
    compare("the stopping rule", there.rule_text(), requested.rule_text());
    compare("memory", there.memory.to_string(), requested.memory.to_string());
    compare("the list of swept keys", listed(&there.swept_keys), listed(&requested.swept_keys));
    compare("the number of variants", there.variants.len().to_string(), requested.variants.len().to_string());
    // With another number of variants the pairs are not comparable, which the line above has said.
    for (one, other) in there.variants.iter().zip(&requested.variants) {
        found.extend(differences_of_scenarios(&one.scenario, &other.scenario));
    }
    shortened(found)
}

/// In which values a scenario differs from the one that is asked for.
pub fn differences_of_scenarios(there: &Scenario, requested: &Scenario) -> Vec<String> {
    let json = |scenario| serde_json::to_value(scenario).expect("scenarios hold names, numbers and lists only");
    let text = |value: Option<Value>| value.map_or("nothing".into(), |value| cut(&value.to_string()));
    let found = value_differences(&json(there), &json(requested)).into_iter();
    shortened(found.map(|it| sentence(&it.key, &text(it.values[0].clone()), &text(it.values[1].clone()))).collect())
}

fn sentence(what: &str, there: &str, requested: &str) -> String {
    format!("{what} is {there} there, but {requested} was requested")
}

fn listed(keys: &[String]) -> String {
    if keys.is_empty() { "nothing".into() } else { keys.join(", ") }
}

fn cut(text: &str) -> String {
    const WIDTH: usize = 60;
    if text.chars().count() <= WIDTH { text.into() } else { text.chars().take(WIDTH).chain("...".chars()).collect() }
}

fn shortened(mut found: Vec<String>) -> Vec<String> {
    // Variants that differ in one way all say the same.
    found.dedup();
    if found.len() > MAX {
        let more = found.len() - MAX;
        found.truncate(MAX);
        found.push(format!("and {more} more"));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_scenario as scenario;

    fn smoke(changes: &[&str]) -> Scenario {
        let changes: Vec<_> = changes.iter().map(|&change| change.to_owned()).collect();
        scenario::load("smoke", &changes).expect("it is built in")
    }

    #[test]
    fn each_value_that_differs_is_named_with_both_values() {
        let found = differences_of_scenarios(&smoke(&[]), &smoke(&["fire.relight=true", "unimog.0.speed_mps=7"]));
        let expected = [
            "fire.relight is false there, but true was requested",
            "unimog.0.speed_mps is 8.0 there, but 7.0 was \
            requested",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn long_lists_of_differences_are_cut() {
        let found = differences_of_scenarios(&smoke(&[]), &scenario::load("contest", &[]).expect("it is built in"));
        assert_eq!(found.len(), MAX + 1);
        assert!(found[MAX].starts_with("and "), "{found:?}");
    }

    #[test]
    fn same_scenario_has_no_differences() {
        assert!(differences_of_scenarios(&smoke(&[]), &smoke(&[])).is_empty());
    }
}
