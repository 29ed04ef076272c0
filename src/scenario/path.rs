//! Paths into a scenario, such as `unimog.0.prm.samples`, and the places in its text that they lead to.

use std::fmt;
use std::ops::Range;

use serde_path_to_error::Segment;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A step into a table or a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    Key(String),
    Index(usize),
}

impl Step {
    pub fn key(name: &str) -> Self {
        Self::Key(name.to_owned())
    }
}

/// Steps from the top of a scenario to a value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FieldPath(pub Vec<Step>);

/// What a path leads to in a text: all of it was found, or only the way to the last table that exists.
pub enum Found {
    Whole { key: Range<usize>, value: Range<usize> },
    Part(Range<usize>),
}

impl FieldPath {
    /// A path in dots, numbers being places in lists.
    pub fn parse(dotted: &str) -> Self {
        let step = |part: &str| part.parse().map_or_else(|_| Step::Key(part.to_owned()), Step::Index);
        Self(dotted.split('.').filter(|part| !part.is_empty()).map(step).collect())
    }

    pub fn of_serde(path: &serde_path_to_error::Path) -> Self {
        let step = |segment: &Segment| match segment {
            Segment::Seq { index } => Some(Step::Index(*index)),
            Segment::Map { key } | Segment::Enum { variant: key } => Some(Step::Key(key.clone())),
            Segment::Unknown => None,
        };
        Self(path.iter().filter_map(step).collect())
    }

    /// This path and one step more.
    pub fn join(&self, step: Step) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }

    pub fn starts_with(&self, other: &Self) -> bool {
        self.0.starts_with(&other.0)
    }

    pub fn leads_to(&self, table: &toml::Table) -> bool {
        let Some((Step::Key(first), rest)) = self.0.split_first() else { return true };
        let walk = |value: &'_ toml::Value| {
            let mut value = value;
            rest.iter().all(|step| match step {
                Step::Key(key) => value.get(key).map(|inner| value = inner).is_some(),
                Step::Index(index) => value.get(index).map(|inner| value = inner).is_some(),
            })
        };
        table.get(first).is_some_and(walk)
    }

    /// The bytes of a TOML text that this path leads to.
    pub fn locate(&self, text: &str) -> Found {
        let Ok(root) = DeTable::parse(text) else { return Found::Part(0..0) };
        let mut table = Some(root.get_ref());
        let mut value: Option<&Spanned<DeValue>> = None;
        let mut key = 0..0;
        for step in &self.0 {
            let next = match step {
                Step::Key(name) => table.and_then(|table| table.get_key_value(name.as_str())).map(|(name, inner)| {
                    key = name.span();
                    inner
                }),
                Step::Index(index) => value.and_then(|value| value.get_ref().get(*index)).inspect(|inner| {
                    key = inner.span();
                }),
            };
            let Some(next) = next else { return Found::Part(value.map_or(0..0, Spanned::span)) };
            table = next.get_ref().as_table();
            value = Some(next);
        }
        value.map_or(Found::Part(0..0), |value| Found::Whole { key, value: value.span() })
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, step) in self.0.iter().enumerate() {
            if number > 0 {
                f.write_str(".")?;
            }
            match step {
                Step::Key(key) => f.write_str(key)?,
                Step::Index(index) => write!(f, "{index}")?,
            }
        }
        Ok(())
    }
}
