//! Keys of a scenario that take one value after another: `field.coverage=0.05,0.10,0.20`.
//!
//! A sweep has one key, or several that take their values together, the first value of each, then the second. Sweeps
//! of a plan are multiplied: every combination of their values is run.
//!
//! Values in equal steps may be written as a range, `0.05..0.20:0.05`. They are counted in decimal digits, so that the third
//! is 0.15 and not the float beside it.

use std::collections::BTreeSet;

use thiserror::Error;

use super::Value;
use wildfire_scenario::toml_value;

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
    #[error("the values of `{key}` have an empty place at the end or between two commas; expected a value there")]
    EmptyValue { key: String },
    #[error("`{key}` has no values")]
    NoValues { key: String },
    #[error("`{key}` has the value {value} twice")]
    Twice { key: String, value: String },
    #[error("`{one}` and `{other}` are swept together, but one has {one_count} values and the other {other_count}")]
    Unequal { one: String, one_count: usize, other: String, other_count: usize },
    #[error("the range {range} of `{key}` {problem}")]
    Range { key: String, range: String, problem: String },
    #[error("`{one}` and `{other}` contradict each other: both set the same value")]
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

/// Says whether two texts are one value, as `0.10` and `0.1` are.
pub fn is_same_value(one: &str, other: &str) -> bool {
    one == other || number(one).is_some_and(|number_of_one| number(other) == Some(number_of_one))
}

fn number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok()
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
    /// One key and its values with commas between them, some of which may be ranges.
    pub fn parse(key: &str, values: &str) -> Result<Self, SweepError> {
        let key = key.trim().to_owned();
        let mut settings = Vec::new();
        for part in split_at_commas(values) {
            match Range::parse(part) {
                Some(range) => settings.extend(range.values(&key)?.iter().map(|value| Setting::parse(value))),
                None => settings.push(Setting::parse(part)),
            }
        }
        Self::together(vec![(key, settings)])
    }

    /// Keys that take their values together; at least one, each with at least one value.
    pub fn together(columns: Vec<(String, Vec<Setting>)>) -> Result<Self, SweepError> {
        for (key, settings) in &columns {
            check_values(key, settings)?;
        }
        let first = &columns[0].0;
        let count = columns[0].1.len();
        // Values are taken row by row, so a shorter list would leave combinations without one.
        if let Some((other, settings)) = columns.iter().find(|(_, settings)| settings.len() != count) {
            let one = first.clone();
            let other = other.clone();
            let other_count = settings.len();
            return Err(SweepError::Unequal { one, one_count: count, other, other_count });
        }
        let steps: Vec<Vec<Setting>> =
            (0..count).map(|index| columns.iter().map(|(_, settings)| settings[index].clone()).collect()).collect();
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

/// Says whether a text is several values: they have commas between them, or are a range.
pub fn is_several(text: &str) -> bool {
    split_at_commas(text).len() > 1 || Range::parse(text).is_some()
}

/// The most values of a range.
const MAX_VALUES: i64 = 10_000;

/// The most digits of a number in a range, which 64 bits hold.
const MAX_DIGITS: usize = 15;

/// Numbers in equal steps, both ends included where the steps lead to the last.
struct Range<'a> {
    written: &'a str,
    /// First, last and step, in units of the last digit.
    numbers: [i64; 3],
    digits_after_point: usize,
}

impl<'a> Range<'a> {
    /// Reads `FIRST..LAST:STEP`, three decimal numbers; all else is no range.
    fn parse(text: &'a str) -> Option<Self> {
        let written = text.trim();
        let (first, rest) = written.split_once("..")?;
        let (last, step) = rest.split_once(':')?;
        let parts = [first, last, step].map(Decimal::parse);
        let digits_after_point = parts.iter().flatten().map(|part| part.fraction.len()).max()?;
        let [first, last, step] = parts.map(|part| part.and_then(|part| part.in_units(digits_after_point)));
        Some(Self { written, numbers: [first?, last?, step?], digits_after_point })
    }

    fn values(&self, key: &str) -> Result<Vec<String>, SweepError> {
        let refuse =
            |problem: String| SweepError::Range { key: key.to_owned(), range: self.written.to_owned(), problem };
        let [first, last, step] = self.numbers;
        if step <= 0 || last < first {
            return Err(refuse(
                "is invalid; expected FIRST..LAST:STEP with a step above 0 and LAST not below FIRST".into(),
            ));
        }
        // Nothing overflows, as no number has more than 15 digits.
        let count = (last - first) / step + 1;
        if count > MAX_VALUES {
            return Err(refuse(format!("has {count} values; expected at most {MAX_VALUES}")));
        }
        Ok((0..count).map(|index| self.text(first + index * step)).collect())
    }

    /// Writes a number of the range with as many digits as its ends have.
    fn text(&self, number: i64) -> String {
        let unit = 10_i64.pow(self.digits_after_point as u32);
        let sign = if number < 0 { "-" } else { "" };
        let whole = number.abs() / unit;
        let rest = number.abs() % unit;
        match self.digits_after_point {
            0 => format!("{sign}{whole}"),
            digits => format!("{sign}{whole}.{rest:0digits$}"),
        }
    }
}

/// A number as its digits.
struct Decimal<'a> {
    is_negative: bool,
    whole: &'a str,
    fraction: &'a str,
}

impl<'a> Decimal<'a> {
    fn parse(text: &'a str) -> Option<Self> {
        let digits = text.strip_prefix('-').unwrap_or(text);
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        // `1` and `1.0` are numbers, `1.` and `.5` are not.
        let is_number = !whole.is_empty() && (whole.len() == digits.len() || !fraction.is_empty());
        let are_digits = [whole, fraction].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit()));
        (is_number && are_digits).then_some(Self { is_negative: digits.len() < text.len(), whole, fraction })
    }

    /// Counts it in units of the digit at this place after the point.
    fn in_units(&self, digits_after_point: usize) -> Option<i64> {
        // Zeros at the end bring all three numbers to the same unit.
        let digits = format!("{}{:0<digits_after_point$}", self.whole, self.fraction);
        let number: i64 = (digits.len() <= MAX_DIGITS).then(|| digits.parse().ok()).flatten()?;
        Some(if self.is_negative { -number } else { number })
    }
}

/// A key that takes its values alone takes no value twice; one of several may, where the others differ.
fn check_values(key: &str, settings: &[Setting]) -> Result<(), SweepError> {
    if settings.is_empty() {
        return Err(SweepError::NoValues { key: key.to_owned() });
    }
    if settings.iter().any(|setting| setting.written.is_empty()) {
        return Err(SweepError::EmptyValue { key: key.to_owned() });
    }
    Ok(())
}

/// Refuses two sweeps, or a sweep and a change, of the same value, and values that come twice.
pub fn check_sweeps(sweeps: &[Sweep], changed_keys: &[&str]) -> Result<(), SweepError> {
    let mut seen: Vec<&str> = changed_keys.to_vec();
    for sweep in sweeps {
        for key in &sweep.keys {
            // A key and a table that holds it overlap too: the later change would replace the earlier one without a word.
            if let Some(other) = seen.iter().find(|other| overlap(key, other)) {
                return Err(SweepError::Contradiction { one: (*other).into(), other: key.clone() });
            }
            seen.push(key);
        }
        let mut steps = BTreeSet::new();
        for step in &sweep.steps {
            let written: Vec<&str> = step.iter().map(|setting| &setting.written[..]).collect();
            let value = written.join(", ");
            // A value that comes twice would be two variants with equal runs, which tests would count as independent.
            if !steps.insert(written) {
                return Err(SweepError::Twice { key: sweep.keys.join("`, `"), value });
            }
        }
    }
    Ok(())
}

/// Says whether two keys can name the same value: `unimog.planner` means all trucks, so `unimog.0.planner` among them.
fn overlap(one: &str, other: &str) -> bool {
    let mut one = one.split('.').peekable();
    let mut other = other.split('.').peekable();
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

fn is_index(step: Option<&&str>) -> bool {
    step.is_some_and(|step| step.chars().all(|letter| letter.is_ascii_digit()))
}

/// Splits a text at the commas that are outside of quotes and brackets.
fn split_at_commas(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut start = 0;
    let mut depth = 0_u32;
    let mut quote = None;
    for (at, letter) in text.char_indices() {
        match (quote, letter) {
            (Some(open), _) if open == letter => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(letter),
            (None, '[' | '{') => depth += 1,
            // Unmatched brackets are left to the TOML parser, whose error shows the place.
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
    fn ranges_are_counted_in_decimal_digits() {
        let written = |text: &str| {
            let sweep = Sweep::parse("a", text).expect("values");
            sweep.steps.into_iter().map(|step| step[0].written.clone()).collect::<Vec<_>>()
        };
        assert_eq!(written("0.05..0.2:0.05"), ["0.05", "0.10", "0.15", "0.20"]);
        assert_eq!(written("1..10:4, 20"), ["1", "5", "9", "20"]);
        assert_eq!(written("-1..1:0.5"), ["-1.0", "-0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(written("3..3:1"), ["3"]);
        for text in ["..", "1..2", "a..b:c", "1..2:", "../maps:1", "1e3..2e3:1e2", "1...2:1", ".5..1:.1"] {
            assert!(!is_several(text), "{text}");
        }
        assert!(is_several("1..2:1"));
        for (text, part) in [("2..1:1", "step above 0"), ("1..2:0", "step above 0"), ("0..1:0.00001", "100001 values")]
        {
            let refusal = Sweep::parse("a", text).expect_err("no values").to_string();
            assert!(refusal.contains(part), "{refusal}");
        }
    }

    #[test]
    fn numbers_are_the_same_however_they_are_written() {
        assert!(is_same_value("0.10", "0.1") && is_same_value("1e3", "1000") && is_same_value("prm-rs", "prm-rs"));
        assert!(!is_same_value("0.1", "0.11") && !is_same_value("1", "one") && !is_same_value("", "0"));
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
