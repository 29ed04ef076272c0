//! Keys of a scenario that may be changed, or may differ: patterns such as `unimog.planner` and `planner.*`.

use serde_json::Value as Json;
use thiserror::Error;

use super::MAX_FREE_KEYS;

/// The most steps of a pattern, and the most patterns.
const MAX_STEPS: usize = 8;
const MAX_PATTERNS: usize = 2 * MAX_FREE_KEYS;

/// Keys of prices: what planning costs in simulated time, in whichever table they are.
const PRICES: [&str; 3] = ["seconds_per_expansion", "seconds_per_evaluation", "expansions_per_query"];

/// Says whether a key is that of a price.
pub fn is_price(steps: &[&str]) -> bool {
    steps.last().is_some_and(|last| PRICES.contains(last))
}

/// Patterns of keys. A key matches if it begins with the steps of a pattern; `*` is any one step. Numbers of agents may
/// be left out, so that `unimog.planner` is the planner of every truck. A price only matches a pattern that ends with its
/// own key: `unimog.hybrid` does not free `unimog.hybrid.seconds_per_expansion`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FreeKeys {
    patterns: Vec<Vec<String>>,
}

/// A reason for which a pattern of keys is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FreeKeysError {
    #[error("`{pattern}` is not a key: expected steps separated by dots, such as `unimog.planner` or `planner.*`")]
    NoKey { pattern: String },
    #[error("`{pattern}` would free everything; expected it to begin with the name of a table or value")]
    Everything { pattern: String },
    #[error("{count} keys are too many; expected at most {MAX_PATTERNS}")]
    TooMany { count: usize },
}

impl FreeKeys {
    pub fn parse<S: AsRef<str>>(patterns: &[S]) -> Result<Self, FreeKeysError> {
        if patterns.len() > MAX_PATTERNS {
            return Err(FreeKeysError::TooMany { count: patterns.len() });
        }
        let patterns = patterns.iter().map(|pattern| steps_of_pattern(pattern.as_ref())).collect::<Result<_, _>>()?;
        Ok(Self { patterns })
    }

    /// Says whether the value at these steps matches; numbers of agents are steps too.
    pub fn has(&self, steps: &[&str]) -> bool {
        let names_it =
            |pattern: &Vec<String>| !is_price(steps) || pattern.last().map(String::as_str) == steps.last().copied();
        self.patterns.iter().any(|pattern| names_it(pattern) && begins_with(steps, pattern))
    }

    /// Says the same of a key as `--set` takes it.
    pub fn has_key(&self, key: &str) -> bool {
        self.has(&key.split('.').collect::<Vec<_>>())
    }

    /// Removes from a scenario every value that matches.
    pub fn remove_from(&self, scenario: &mut Json) {
        self.remove_below(scenario, &mut Vec::new());
    }

    fn remove_below(&self, value: &mut Json, steps: &mut Vec<String>) {
        let mut goes = |step: String, inner: &mut Json| {
            steps.push(step);
            self.remove_below(inner, steps);
            let path: Vec<&str> = steps.iter().map(String::as_str).collect();
            let is_empty = inner.as_object().is_some_and(serde_json::Map::is_empty);
            // Tables stay unless all in them was removed: a value that is not free must still be compared.
            let goes = self.has(&path) && (is_empty || !inner.is_object());
            steps.pop();
            goes
        };
        match value {
            Json::Object(table) => {
                // The keys are copied, as a table cannot be changed while it is gone through.
                let keys: Vec<String> = table.keys().cloned().collect();
                for key in keys {
                    let inner = table.get_mut(&key).expect("the key is one of the table's");
                    if goes(key.clone(), inner) {
                        table.remove(&key);
                    }
                }
            }
            Json::Array(list) => {
                for (index, inner) in list.iter_mut().enumerate() {
                    // Items of a list stay: without one, all later items would have other numbers.
                    goes(index.to_string(), inner);
                }
            }
            _ => {}
        }
    }
}

fn steps_of_pattern(pattern: &str) -> Result<Vec<String>, FreeKeysError> {
    let steps: Vec<String> = pattern.split('.').map(|step| step.trim().to_owned()).collect();
    if !steps.iter().all(|step| !step.is_empty() && !step.contains(|letter: char| letter.is_whitespace()))
        || steps.len() > MAX_STEPS
    {
        return Err(FreeKeysError::NoKey { pattern: pattern.to_owned() });
    }
    if steps[0] == "*" {
        return Err(FreeKeysError::Everything { pattern: pattern.to_owned() });
    }
    Ok(steps)
}

fn begins_with(steps: &[&str], pattern: &[String]) -> bool {
    let Some((wanted, pattern_rest)) = pattern.split_first() else { return true };
    let Some((step, rest)) = steps.split_first() else { return false };
    let is_number = step.bytes().all(|byte| byte.is_ascii_digit());
    let is_it = wanted == step || wanted == "*" && !is_number;
    is_it && begins_with(rest, pattern_rest) || is_number && begins_with(rest, pattern)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn free(patterns: &[&str]) -> FreeKeys {
        FreeKeys::parse(patterns).expect("patterns")
    }

    #[test]
    fn pattern_frees_what_is_at_it_and_below_it_of_every_agent() {
        let free = free(&["unimog.planner", "planner.*", "unimog.1.goal"]);
        for key in
            ["unimog.planner", "unimog.3.planner", "planner.rrt", "planner.rrt.settings.range_m", "unimog.1.goal"]
        {
            assert!(free.has_key(key), "{key}");
        }
        for key in ["unimog", "unimog.goal", "unimog.0.goal", "planner", "unimog.planners", "fire.planner", ""] {
            assert!(!free.has_key(key), "{key}");
        }
    }

    #[test]
    fn prices_are_free_only_where_a_key_names_them() {
        let mut scenario = json!({
            "duration_s": 60.0,
            "planner": { "rrt": { "command": ["a"] } },
            "unimog": [{ "planner": "rrt", "prm": { "samples": 3, "seconds_per_expansion": 0.1 }, "start": [1] }],
        });
        free(&["unimog.planner", "unimog.prm", "planner"]).remove_from(&mut scenario);
        let left = json!({ "duration_s": 60.0, "unimog": [{ "prm": { "seconds_per_expansion": 0.1 }, "start": [1] }] });
        assert_eq!(scenario, left);
        let price = "unimog.0.prm.seconds_per_expansion";
        assert!(!free(&["unimog", "unimog.prm"]).has_key(price));
        assert!(free(&["unimog.prm.seconds_per_expansion"]).has_key(price));
        assert!(free(&["planner.*.expansions_per_query"]).has_key("planner.rrt.expansions_per_query"));
        assert!(!free(&["planner.*.expansions_per_query"]).has_key("planner.rrt.seconds_per_expansion"));
    }

    #[test]
    fn what_is_no_key_is_refused() {
        for pattern in ["", ".", "a..b", "a.", "a b", "a.b.c.d.e.f.g.h.i"] {
            assert!(matches!(FreeKeys::parse(&[pattern]), Err(FreeKeysError::NoKey { .. })), "{pattern}");
        }
        assert!(matches!(FreeKeys::parse(&["*"]), Err(FreeKeysError::Everything { .. })));
        assert!(matches!(FreeKeys::parse(&vec!["a"; 201]), Err(FreeKeysError::TooMany { count: 201 })));
    }
}
