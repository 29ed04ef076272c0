//! Paths into a scenario, such as `unimog.0.prm.samples`, and the spans of its text that they lead to.

use std::fmt;
use std::ops::Range;

use serde_path_to_error::Segment;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Value};

/// A step into a table or a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathStep {
    Key(String),
    Index(usize),
}

impl PathStep {
    pub fn key(name: &str) -> Self {
        Self::Key(name.to_owned())
    }
}

/// The steps from the top of a scenario to a value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FieldPath(pub Vec<PathStep>);

/// The span of a text that a path leads to: of its last step, or of the last table on the way that exists.
pub enum FoundSpan {
    Whole { key: Range<usize>, value: Range<usize> },
    Part(Range<usize>),
}

impl FieldPath {
    /// Parses a path whose steps are separated by dots; a number is an index into a list, and a step in double quotes is a
    /// key whatever it holds.
    pub fn parse(dotted: &str) -> Self {
        let (mut steps, mut rest) = (Vec::new(), dotted);
        while !rest.is_empty() {
            // Only quotes keep a dot or a number within a key, as in `policy."v1.2"`.
            if let Some((key, after)) = rest.strip_prefix('"').and_then(|quoted| quoted.split_once('"')) {
                steps.push(PathStep::key(key));
                rest = after.strip_prefix('.').unwrap_or(after);
                continue;
            }
            let (part, after) = rest.split_once('.').unwrap_or((rest, ""));
            if !part.is_empty() {
                steps.push(part.parse().map_or_else(|_| PathStep::key(part), PathStep::Index));
            }
            rest = after;
        }
        Self(steps)
    }

    pub fn from_serde(path: &serde_path_to_error::Path) -> Self {
        Self(path.iter().filter_map(step_of).collect())
    }

    /// Returns this path with one more step.
    pub fn join(&self, step: PathStep) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }

    pub fn starts_with(&self, other: &Self) -> bool {
        self.0.starts_with(&other.0)
    }

    pub fn leads_to(&self, root: &Value) -> bool {
        self.get(root).is_some()
    }

    fn get<'v>(&self, root: &'v Value) -> Option<&'v Value> {
        self.0.iter().try_fold(root, |value, step| match step {
            PathStep::Key(key) => value.get(key),
            PathStep::Index(index) => value.get(index),
        })
    }

    /// Removes what it leads to from its table.
    pub fn remove_from(&self, root: &mut Value) {
        let Some((PathStep::Key(last), table)) = self.0.split_last() else { return };
        let table = table.iter().try_fold(root, |value, step| match step {
            PathStep::Key(key) => value.get_mut(key),
            PathStep::Index(index) => value.get_mut(index),
        });
        table.and_then(Value::as_table_mut).and_then(|table| table.remove(last));
    }

    /// Lists the paths of this form that lead to something; a step `*` stands for each entry of a list or a table.
    pub fn all_in(&self, root: &Value) -> Vec<Self> {
        let Some(at) = self.0.iter().position(|step| *step == PathStep::key("*")) else {
            return self.leads_to(root).then(|| self.clone()).into_iter().collect();
        };
        let steps: Vec<PathStep> = match Self(self.0[..at].to_vec()).get(root) {
            Some(Value::Array(list)) => (0..list.len()).map(PathStep::Index).collect(),
            Some(Value::Table(table)) => table.keys().cloned().map(PathStep::Key).collect(),
            _ => Vec::new(),
        };
        let with = |step| Self([&self.0[..at], &[step], &self.0[at + 1..]].concat());
        steps.into_iter().flat_map(|step| with(step).all_in(root)).collect()
    }

    /// Returns the path of this form beside another one: both have the same steps where this one has `*`.
    pub fn beside(&self, other: &Self) -> Self {
        let step =
            |(this, others): (&PathStep, &PathStep)| if *this == PathStep::key("*") { others } else { this }.clone();
        Self(self.0.iter().zip(other.0.iter().chain(&self.0)).map(step).collect())
    }

    /// Returns the line of a TOML text, from 1, in which the key that this path leads to is; or the last table on the way.
    pub fn line_in(&self, text: &str) -> usize {
        let span = match self.locate(text) {
            FoundSpan::Whole { key, .. } => key,
            FoundSpan::Part(span) => span,
        };
        1 + text.bytes().take(span.start).filter(|&byte| byte == b'\n').count()
    }

    /// Finds the bytes of a TOML text that this path leads to.
    pub fn locate(&self, text: &str) -> FoundSpan {
        let Ok(root) = DeTable::parse(text) else { return FoundSpan::Part(0..0) };
        let mut table = Some(root.get_ref());
        let mut value: Option<&Spanned<DeValue>> = None;
        let mut key = 0..0;
        for step in &self.0 {
            let next = match step {
                PathStep::Key(name) => {
                    table.and_then(|table| table.get_key_value(name.as_str())).map(|(name, inner)| {
                        key = name.span();
                        inner
                    })
                }
                PathStep::Index(index) => value.and_then(|value| value.get_ref().get(*index)).inspect(|inner| {
                    key = inner.span();
                }),
            };
            // The innermost part that exists is marked, since an omitted value has no place of its own.
            let Some(next) = next else { return FoundSpan::Part(value.map_or(0..0, Spanned::span)) };
            table = next.get_ref().as_table();
            value = Some(next);
        }
        value.map_or(FoundSpan::Part(0..0), |value| FoundSpan::Whole { key, value: value.span() })
    }
}

fn step_of(segment: &Segment) -> Option<PathStep> {
    match segment {
        Segment::Seq { index } => Some(PathStep::Index(*index)),
        Segment::Map { key } | Segment::Enum { variant: key } => Some(PathStep::Key(key.clone())),
        Segment::Unknown => None,
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, step) in self.0.iter().enumerate() {
            if number > 0 {
                f.write_str(".")?;
            }
            match step {
                PathStep::Key(key) if key.contains('.') => write!(f, "\"{key}\"")?,
                PathStep::Key(key) => f.write_str(key)?,
                PathStep::Index(index) => write!(f, "{index}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_divided_by_dots_outside_of_quotes() {
        let key = PathStep::key;
        for (dotted, steps, written) in [
            ("unimog.0.prm", vec![key("unimog"), PathStep::Index(0), key("prm")], "unimog.0.prm"),
            (
                "planner.\"rrt-2.1\".command",
                vec![key("planner"), key("rrt-2.1"), key("command")],
                "planner.\"rrt-2.1\".command",
            ),
            ("planner.\"rrt\"", vec![key("planner"), key("rrt")], "planner.rrt"),
            ("a..b.", vec![key("a"), key("b")], "a.b"),
            ("\"a", vec![key("\"a")], "\"a"),
            ("", vec![], ""),
        ] {
            let path = FieldPath::parse(dotted);
            assert_eq!(path.0, steps, "{dotted}");
            assert_eq!(path.to_string(), written);
        }
    }
}
