//! In what two plans differ, in words.

use serde_json::Value;

use super::BatchPlan;
use crate::scenario::Scenario;

/// The most differences that are named.
const MOST: usize = 5;

/// In what a plan differs from the one that is asked for; empty if they are the same.
pub fn differences(there: &BatchPlan, asked: &BatchPlan) -> Vec<String> {
    let mut found = Vec::new();
    let mut compare = |what: &str, there: String, asked: String| {
        if there != asked {
            found.push(sentence(what, &there, &asked));
        }
    };
    compare("seeds", there.seeds.to_string(), asked.seeds.to_string());
    compare("record", format!("{:?}", there.record).to_lowercase(), format!("{:?}", asked.record).to_lowercase());
    compare("what is swept", listed(&there.swept_keys), listed(&asked.swept_keys));
    compare("the number of variants", there.variants.len().to_string(), asked.variants.len().to_string());
    for (one, other) in there.variants.iter().zip(&asked.variants) {
        found.extend(differences_of_scenarios(&one.scenario, &other.scenario));
    }
    shortened(found)
}

/// In which values a scenario differs from the one that is asked for.
pub fn differences_of_scenarios(there: &Scenario, asked: &Scenario) -> Vec<String> {
    let json = |scenario| serde_json::to_value(scenario).expect("scenarios hold names, numbers and lists only");
    let mut found = Vec::new();
    collect("", &json(there), &json(asked), &mut found);
    shortened(found)
}

fn collect(path: &str, there: &Value, asked: &Value, found: &mut Vec<String>) {
    let inside = |step: &str| if path.is_empty() { step.to_owned() } else { format!("{path}.{step}") };
    match (there, asked) {
        (Value::Object(there), Value::Object(asked)) => {
            let keys = there.keys().chain(asked.keys().filter(|key| !there.contains_key(*key)));
            for key in keys {
                let value = |table: &serde_json::Map<String, Value>| table.get(key).cloned().unwrap_or_default();
                collect(&inside(key), &value(there), &value(asked), found);
            }
        }
        (Value::Array(there), Value::Array(asked)) if there.len() == asked.len() => {
            for (index, (there, asked)) in there.iter().zip(asked).enumerate() {
                collect(&inside(&index.to_string()), there, asked, found);
            }
        }
        _ if there == asked => {}
        _ => found.push(sentence(path, &cut(&there.to_string()), &cut(&asked.to_string()))),
    }
}

fn sentence(what: &str, there: &str, asked: &str) -> String {
    format!("{what} is {there} there, {asked} is asked for")
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
    if found.len() > MOST {
        let more = found.len() - MOST;
        found.truncate(MOST);
        found.push(format!("and {more} more"));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario;

    fn smoke(changes: &[&str]) -> Scenario {
        let changes: Vec<_> = changes.iter().map(|&change| change.to_owned()).collect();
        scenario::load("smoke", &changes).expect("it is built in")
    }

    #[test]
    fn each_value_that_differs_is_named_with_both_values() {
        let found = differences_of_scenarios(&smoke(&[]), &smoke(&["fire.relight=true", "unimog.0.speed_mps=7"]));
        let expected =
            ["fire.relight is false there, true is asked for", "unimog.0.speed_mps is 8.0 there, 7.0 is asked for"];
        assert_eq!(found, expected);
    }

    #[test]
    fn long_lists_of_differences_are_cut() {
        let found = differences_of_scenarios(&smoke(&[]), &scenario::load("contest", &[]).expect("it is built in"));
        assert_eq!(found.len(), MOST + 1);
        assert!(found[MOST].starts_with("and "), "{found:?}");
    }

    #[test]
    fn same_scenario_has_no_differences() {
        assert!(differences_of_scenarios(&smoke(&[]), &smoke(&[])).is_empty());
    }
}
