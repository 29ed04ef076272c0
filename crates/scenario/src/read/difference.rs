//! The values in which two scenarios differ.

use serde_json::Value;

/// A value in which two resolved scenarios differ.
#[derive(Clone, Debug, PartialEq)]
pub struct ValueDifference {
    /// The key as `--set` takes it, such as `unimog.0.speed_mps`.
    pub key: String,
    /// The values in the one scenario and in the other; `None` where it has no such value.
    pub values: [Option<Value>; 2],
}

/// Returns all values in which two resolved scenarios differ. Lists of agents and the like are gone through one by one.
pub fn value_differences(one: &Value, other: &Value) -> Vec<ValueDifference> {
    let mut found = Vec::new();
    collect("", [Some(one), Some(other)], &mut found);
    found
}

fn collect(path: &str, values: [Option<&Value>; 2], found: &mut Vec<ValueDifference>) {
    let inside = |step: &str| if path.is_empty() { step.to_owned() } else { format!("{path}.{step}") };
    match values {
        [Some(Value::Object(one)), Some(Value::Object(other))] => {
            // Keys that only the other one has come last; a missing key differs from any value.
            for key in one.keys().chain(other.keys().filter(|key| !one.contains_key(*key))) {
                collect(&inside(key), [one.get(key), other.get(key)], found);
            }
        }
        // In lists of different lengths entries have no partners, and all behind an inserted one would differ.
        [Some(Value::Array(one)), Some(Value::Array(other))] if one.len() == other.len() || are_tables(one, other) => {
            for index in 0..one.len().max(other.len()) {
                collect(&inside(&index.to_string()), [one.get(index), other.get(index)], found);
            }
        }
        [one, other] if one == other => {}
        _ => found.push(ValueDifference { key: path.to_owned(), values: values.map(Option::<&Value>::cloned) }),
    }
}

fn are_tables(one: &[Value], other: &[Value]) -> bool {
    one.iter().chain(other).all(Value::is_object)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agents_that_only_one_scenario_has_are_separate_differences() {
        let json = |trucks: &[f64]| {
            let trucks: Vec<_> = trucks.iter().map(|speed| serde_json::json!({ "speed_mps": speed })).collect();
            serde_json::json!({ "unimog": trucks, "start": [1, 2, 3] })
        };
        let found = value_differences(&json(&[8.0]), &json(&[7.0, 9.0]));
        let keys: Vec<_> = found.iter().map(|it| it.key.as_str()).collect();
        assert_eq!(keys, ["unimog.0.speed_mps", "unimog.1"]);
        assert_eq!(found[0].values, [Some(8.0.into()), Some(7.0.into())]);
        assert_eq!(found[1].values, [None, Some(serde_json::json!({ "speed_mps": 9.0 }))]);
        let shorter = serde_json::json!({ "unimog": [{ "speed_mps": 8.0 }], "start": [1, 2] });
        let found = value_differences(&json(&[8.0]), &shorter);
        assert_eq!(found.len(), 1, "a list of numbers is one value: {found:?}");
    }
}
