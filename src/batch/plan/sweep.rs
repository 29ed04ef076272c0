//! Keys of a scenario that take one value after another: `field.coverage=0.05,0.10,0.20`.
//!
//! A sweep has one key, or several that take their values together, the first value of each, then the second. Sweeps
//! of a plan are multiplied: every combination of their values is run.

use thiserror::Error;

use super::Value;
use crate::scenario::toml_value;

/// Keys that take their values together.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    keys: Vec<String>,
    /// In each entry a setting for each key.
    steps: Vec<Vec<Setting>>,
}

/// A value that a key takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// As it is written in a change.
    pub written: String,
    /// The value as a column has it.
    pub value: Value,
}

/// A reason for which something cannot be swept.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SweepError {
    #[error("the values of `{key}` end with nothing, or have nothing between two commas; expected a value there")]
    EmptyValue { key: String },
    #[error("`{key}` has no values to take")]
    NoValues { key: String },
    #[error("`{key}` takes the value {value} twice")]
    Twice { key: String, value: String },
    #[error(
        "`{one}` and `{other}` take their values together, but one has {one_count} of them and the other {other_count}"
    )]
    Unequal { one: String, one_count: usize, other: String, other_count: usize },
    #[error("`{one}` and `{other}` contradict each other: both say what the same value is")]
    Contradiction { one: String, other: String },
}

impl Setting {
    /// A value as TOML spells it, else a text.
    pub fn parse(written: &str) -> Self {
        let written = written.trim();
        let value = toml_value(written).map_or_else(|| Value::Text(written.to_owned()), value_of);
        Self { written: written.to_owned(), value }
    }

    pub fn from_toml(value: toml::Value) -> Self {
        Self { written: value.to_string(), value: value_of(value) }
    }
}

fn value_of(value: toml::Value) -> Value {
    match value {
        toml::Value::Integer(number) => u64::try_from(number).map_or(Value::Real(number as f64), Value::Count),
        // Zero has no sign in a scenario.
        toml::Value::Float(number) => Value::Real(number + 0.0),
        toml::Value::String(text) => Value::Text(text),
        other => Value::Text(other.to_string()),
    }
}

impl Sweep {
    /// One key and its values with commas between them.
    pub fn parse(key: &str, values: &str) -> Result<Self, SweepError> {
        let settings = split_at_commas(values).into_iter().map(Setting::parse).collect();
        Self::together(vec![(key.trim().to_owned(), settings)])
    }

    /// Keys that take their values together; at least one, each with at least one value.
    pub fn together(columns: Vec<(String, Vec<Setting>)>) -> Result<Self, SweepError> {
        for (key, settings) in &columns {
            check_values(key, settings)?;
        }
        let (first, count) = (&columns[0].0, columns[0].1.len());
        if let Some((other, settings)) = columns.iter().find(|(_, settings)| settings.len() != count) {
            let (one, other, other_count) = (first.clone(), other.clone(), settings.len());
            return Err(SweepError::Unequal { one, one_count: count, other, other_count });
        }
        let step = |index: usize| columns.iter().map(|(_, settings)| settings[index].clone()).collect();
        let steps: Vec<Vec<Setting>> = (0..count).map(step).collect();
        let keys: Vec<String> = columns.into_iter().map(|(key, _)| key).collect();
        Ok(Self { keys, steps })
    }

    pub fn keys(&self) -> &[String] {
        &self.keys
    }

    pub fn steps(&self) -> &[Vec<Setting>] {
        &self.steps
    }
}

/// A key that takes its values alone takes no value twice; one of several may, where the others differ.
fn check_values(key: &str, settings: &[Setting]) -> Result<(), SweepError> {
    let key = || key.to_owned();
    if settings.is_empty() {
        return Err(SweepError::NoValues { key: key() });
    }
    if settings.iter().any(|setting| setting.written.is_empty()) {
        return Err(SweepError::EmptyValue { key: key() });
    }
    Ok(())
}

/// Refuses two sweeps, or a sweep and a change, of the same value, and values that come twice.
pub fn check_sweeps(sweeps: &[Sweep], changed_keys: &[&str]) -> Result<(), SweepError> {
    let contradiction = |one: &str, other: &str| SweepError::Contradiction { one: one.into(), other: other.into() };
    let mut seen: Vec<&str> = changed_keys.to_vec();
    for sweep in sweeps {
        for key in &sweep.keys {
            if let Some(other) = seen.iter().find(|other| overlap(key, other)) {
                return Err(contradiction(other, key));
            }
            seen.push(key);
        }
        for (index, step) in sweep.steps.iter().enumerate() {
            if sweep.steps[..index].contains(step) {
                return Err(SweepError::Twice { key: sweep.keys[0].clone(), value: step[0].written.clone() });
            }
        }
    }
    Ok(())
}

/// Says whether two keys can name the same value: `unimog.planner` means all trucks, so `unimog.0.planner` among them.
fn overlap(one: &str, other: &str) -> bool {
    let is_index = |step: Option<&&str>| step.is_some_and(|step| step.chars().all(|letter| letter.is_ascii_digit()));
    let (mut one, mut other) = (one.split('.').peekable(), other.split('.').peekable());
    loop {
        match (is_index(one.peek()), is_index(other.peek())) {
            (true, false) => drop(one.next()),
            (false, true) => drop(other.next()),
            _ => match (one.next(), other.next()) {
                (Some(left), Some(right)) if left != right => return false,
                (Some(_), Some(_)) => {}
                _ => return true,
            },
        }
    }
}

/// Splits a text at the commas that are outside of quotes and brackets.
pub fn split_at_commas(text: &str) -> Vec<&str> {
    let (mut parts, mut start, mut depth, mut quote) = (Vec::new(), 0, 0_u32, None);
    for (at, letter) in text.char_indices() {
        match (quote, letter) {
            (Some(open), _) if open == letter => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(letter),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth = depth.saturating_sub(1),
            (None, ',') if depth == 0 => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_in_quotes_and_brackets_part_nothing() {
        assert_eq!(split_at_commas("1,2"), ["1", "2"]);
        assert_eq!(split_at_commas(r#"["a", "b"],["c"]"#), [r#"["a", "b"]"#, r#"["c"]"#]);
        assert_eq!(split_at_commas(r#""a,b",'c,"d'"#), [r#""a,b""#, r#"'c,"d'"#]);
        assert_eq!(split_at_commas("{ x_m = 1, y_m = 2 }"), ["{ x_m = 1, y_m = 2 }"]);
        assert_eq!(split_at_commas("]],1"), ["]]", "1"]);
    }

    #[test]
    fn values_are_numbers_where_they_can_be() {
        let values = |text: &str| {
            let sweep = Sweep::parse("a", text).expect("values");
            sweep.steps.into_iter().map(|step| step[0].value.clone()).collect::<Vec<_>>()
        };
        assert_eq!(values("1,0.10,-3"), [Value::Count(1), Value::Real(0.1), Value::Real(-3.0)]);
        let texts = ["prm-rs", "two words", "true"].map(|text| Value::Text(text.into()));
        assert_eq!(values("prm-rs,\"two words\",true"), texts);
    }

    #[test]
    fn nothing_is_no_value() {
        for text in ["", "1,", ",1", "1,,2"] {
            let refusal = Sweep::parse("a", text).expect_err("a value is missing");
            assert!(matches!(refusal, SweepError::EmptyValue { .. }), "{text}: {refusal}");
        }
    }

    #[test]
    fn keys_that_go_together_have_as_many_values() {
        let settings = |text: &str| split_at_commas(text).into_iter().map(Setting::parse).collect::<Vec<_>>();
        let sweep = Sweep::together(vec![("a".into(), settings("1,2")), ("b".into(), settings("3,3"))]);
        assert_eq!(sweep.expect("pairs").steps.len(), 2);
        let refusal = Sweep::together(vec![("a".into(), settings("1,2")), ("b".into(), settings("3"))]);
        assert!(matches!(refusal, Err(SweepError::Unequal { one_count: 2, other_count: 1, .. })));
    }

    #[test]
    fn contradictions_are_found_and_neighbours_are_not() {
        for (one, other) in [
            ("a", "a"),
            ("unimog.planner", "unimog.0.planner"),
            ("unimog.0", "unimog.0.planner"),
            ("unimog", "unimog.0.planner"),
            ("field", "field.coverage"),
        ] {
            assert!(overlap(one, other) && overlap(other, one), "{one} {other}");
        }
        for (one, other) in [
            ("unimog.0.planner", "unimog.1.planner"),
            ("unimog.planner", "unimog.prm"),
            ("unimog.planner", "wumpus.planner"),
        ] {
            assert!(!overlap(one, other) && !overlap(other, one), "{one} {other}");
        }
    }

    #[test]
    fn value_that_comes_twice_is_named() {
        let refused = |text: &str| check_sweeps(&[Sweep::parse("a", text).expect("values")], &[]);
        assert_eq!(refused("1,2,1"), Err(SweepError::Twice { key: "a".into(), value: "1".into() }));
        assert_eq!(refused("1,2"), Ok(()));
        let swept = [Sweep::parse("fire.relight", "true,false").expect("values")];
        let refusal = check_sweeps(&swept, &["fire.relight"]).expect_err("it is changed and swept");
        assert!(matches!(refusal, SweepError::Contradiction { .. }));
    }
}
