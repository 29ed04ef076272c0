//! Changes from the command line, `path=value`, made to a scenario's table before it is read.

use toml::{Table, Value};

use super::source::toml_value;
use crate::faults::error::{Fault, ScenarioError, SourceLocation};
use crate::faults::path::{FieldPath, PathStep};
use crate::faults::wording::KeyOrValue;

/// The most steps of a path; no value of a scenario lies as deep.
const MAX_STEPS: usize = 8;

/// Changes that were made, in their order.
pub(crate) struct SettingChanges(Vec<SettingChange>);

impl SettingChanges {
    /// Makes changes, `path=value`, to what a file says.
    pub fn make(options: &[String], root: &mut Value) -> Result<Self, Box<ScenarioError>> {
        options.iter().map(|option| SettingChange::make(option, root)).collect::<Result<_, _>>().map(Self)
    }

    fn paths(&self) -> impl Iterator<Item = &FieldPath> {
        self.0.iter().flat_map(|change| &change.set)
    }

    /// Says whether a value is one of a change: it or what it is part of was set.
    pub fn set(&self, path: &FieldPath) -> bool {
        self.paths().any(|set| path.starts_with(set))
    }

    /// Says whether a value, a part of it or what it is part of was set.
    pub fn touch(&self, path: &FieldPath) -> bool {
        self.paths().any(|set| path.starts_with(set) || set.starts_with(path))
    }

    /// Returns the location of a value in the last change that touches it.
    pub fn location(&self, path: &FieldPath, side: KeyOrValue) -> Option<SourceLocation> {
        let touch = |change: &'_ SettingChange| {
            change.set.iter().find(|set| path.starts_with(set) || set.starts_with(path)).map(|set| set.0.len())
        };
        let (change, depth) = self.0.iter().rev().find_map(|change| Some((change, touch(change)?)))?;
        // A fault in a key, or in what the change only adds to, is a fault of its path.
        let in_value = side == KeyOrValue::Value && path.0.len() >= depth || path.0.len() > depth;
        Some(if in_value { change.value_location() } else { change.path_location() })
    }
}

/// A change as it was asked for, and the paths of the values that it set.
struct SettingChange {
    option: String,
    /// Offset of the value within the option, in bytes.
    value_at: usize,
    /// Every value that was set: one, or one of every agent.
    set: Vec<FieldPath>,
}

impl SettingChange {
    /// Makes a change.
    ///
    /// The value is read as TOML where it is valid TOML, and as a text where it is not. A path that names a list without
    /// a number (`unimog.prm.samples`) changes all its entries; tables that are missing are made.
    fn make(option: &str, root: &mut Value) -> Result<Self, Box<ScenarioError>> {
        let whole = || SourceLocation::new("--set", option, 0..option.len());
        let (dotted, written) = option.split_once('=').ok_or_else(|| Fault::NoChange.at(whole()))?;
        let path = FieldPath::parse(dotted.trim());
        let Some((PathStep::Key(_), _)) = path.0.split_first() else { return Err(Fault::NoChange.at(whole())) };
        // Each step is a call of `set_at`, so their number bounds the stack.
        if path.0.len() > MAX_STEPS {
            let message = format!("`{path}` has {} steps; expected at most {MAX_STEPS}", path.0.len());
            return Err(Fault::CannotChange { message }.at(whole()));
        }
        let value = value_of(written.trim());
        let mut change = Self { option: option.to_owned(), value_at: dotted.len() + 1, set: Vec::new() };
        change.set_at(root, &mut FieldPath::default(), &path.0, &value).map_err(|message| {
            Fault::CannotChange { message }.at(SourceLocation::new("--set", option, 0..dotted.len()))
        })?;
        Ok(change)
    }

    fn set_at(&mut self, at: &mut Value, here: &mut FieldPath, rest: &[PathStep], new: &Value) -> Result<(), String> {
        let Some((step, rest)) = rest.split_first() else {
            *at = new.clone();
            // The place where the value begins is kept, so that an error can mark it there.
            self.set.push(here.clone());
            return Ok(());
        };
        match (at, step) {
            (Value::Table(table), PathStep::Key(key)) => {
                here.0.push(step.clone());
                let inner = table.entry(key.clone()).or_insert_with(|| Value::Table(Table::new()));
                self.set_at(inner, here, rest, new)?;
            }
            (Value::Array(list), PathStep::Index(index)) => {
                let length = list.len();
                let inner = list.get_mut(*index);
                let inner =
                    inner.ok_or_else(|| format!("`{here}` has no entry {index}: it has {length}, counted from 0"))?;
                here.0.push(step.clone());
                self.set_at(inner, here, rest, new)?;
            }
            (Value::Array(list), PathStep::Key(_)) => {
                if list.is_empty() {
                    return Err(format!("`{here}` is an empty list; there is nothing to change"));
                }
                // The key itself is kept for each entry, since only the entries' number is missing in the path.
                let all = [std::slice::from_ref(step), rest].concat();
                for (index, inner) in list.iter_mut().enumerate() {
                    here.0.push(PathStep::Index(index));
                    self.set_at(inner, here, &all, new)?;
                    here.0.pop();
                }
                return Ok(());
            }
            (Value::Table(_), PathStep::Index(_)) => {
                return Err(format!("`{here}` is a table; it has no numbered entries"));
            }
            (_, _) => return Err(format!("`{here}` is a plain value; it has no fields")),
        }
        here.0.pop();
        Ok(())
    }

    /// Returns the part of the option that holds its path.
    fn path_location(&self) -> SourceLocation {
        SourceLocation::new("--set", &self.option, 0..self.value_at - 1)
    }

    /// Returns the part of the option that holds its value.
    fn value_location(&self) -> SourceLocation {
        SourceLocation::new("--set", &self.option, self.value_at..self.option.len())
    }
}

/// Reads a value as TOML, else as a text. A number too large for a TOML integer is still a number.
fn value_of(written: &str) -> Value {
    let huge = || {
        let digits = written.trim_start_matches(['+', '-']).starts_with(|first: char| first.is_ascii_digit());
        written.parse().ok().filter(|number: &f64| digits && number.abs() >= i64::MAX as f64)
    };
    toml_value(written).or_else(|| huge().map(Value::Float)).unwrap_or_else(|| Value::String(written.to_owned()))
}
