//! Messages of the TOML reader in the words of a scenario's author.

use super::error::{Fault, nearest_name};
use super::path::{FieldPath, PathStep};

/// Values that only loading fills in: no file may have them.
pub const LOADED: [&str; 16] = [
    "fire.rothermel.given_moisture",
    "fire.rothermel.given_factors",
    "barrier.*.given",
    "ignition.*.inside",
    "given_fuel",
    "wind.*.given",
    "field.given",
    "field.raster_frame",
    "landscape.given",
    "landscape.given_roads",
    "weather.rows",
    "ignition.*.weights",
    "planner.*.sha256",
    "planner.*.works_in",
    "policy.*.sha256",
    "policy.*.works_in",
];

/// The most characters of a text that a message quotes.
const LONGEST_QUOTE: usize = 60;

/// The part of `key = value` that is at fault.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum KeyOrValue {
    Key,
    Value,
}

/// A fault, the path that it concerns, and which side of `key = value` is wrong.
pub struct FaultOfField {
    pub fault: Fault,
    pub path: FieldPath,
    pub side: KeyOrValue,
}

/// Turns a message of serde into a fault.
pub fn fault_from_message(message: &str, path: FieldPath) -> FaultOfField {
    // Serde puts every name in backticks and nothing else, so its messages can be taken apart.
    let mut quoted = message.split('`').skip(1).step_by(2);
    let name = quoted.next().unwrap_or_default();
    let is_loaded = |name: &str| LOADED.iter().any(|path| path.rsplit('.').next() == Some(name));
    // Values that only loading fills in must not be offered as names to write.
    let valid_names: Vec<String> = quoted.filter(|name| !is_loaded(name)).map(str::to_owned).collect();
    let (fault, path, side) = if message.starts_with("unknown field") {
        let table = table_of(&path, name);
        (unknown_field(name, &table, valid_names), table.join(PathStep::key(name)), KeyOrValue::Key)
    } else if message.starts_with("missing field") {
        (Fault::MissingField { name: name.to_owned(), table: path.to_string() }, path, KeyOrValue::Value)
    } else if message.starts_with("unknown variant") {
        let nearest = nearest_name(name, valid_names.iter().map(String::as_str));
        let fault = Fault::UnknownWord { field: path.to_string(), found: shortened(name), valid_names, nearest };
        (fault, path, KeyOrValue::Value)
    } else {
        (value_fault(message, &path), path, KeyOrValue::Value)
    };
    FaultOfField { fault, path, side }
}

/// Describes an unknown field, with the most similar known name.
pub fn unknown_field(name: &str, table: &FieldPath, valid_names: Vec<String>) -> Fault {
    let nearest = nearest_name(name, valid_names.iter().map(String::as_str));
    Fault::UnknownField { name: shortened(name), table: table.to_string(), valid_names, nearest }
}

/// Returns the table that holds an unknown field, whether or not the reported path includes the field itself.
fn table_of(path: &FieldPath, name: &str) -> FieldPath {
    match path.0.split_last() {
        Some((PathStep::Key(last), table)) if last == name => FieldPath(table.to_vec()),
        _ => path.clone(),
    }
}

fn value_fault(message: &str, path: &FieldPath) -> Fault {
    let field = path.to_string();
    let Some((found, expected)) = message.strip_prefix("invalid ").and_then(|rest| rest.split_once(", expected "))
    else {
        return Fault::Rule { message: format!("`{field}`: {message}") };
    };
    let found = found.split_once(": ").map_or(found, |(_, value)| value);
    if found == "map" && expected == "a sequence" {
        let message = format!("`{field}` is a list: each entry begins with [[{field}]]");
        return Fault::Rule { message };
    }
    Fault::Value { field, found: found_text(found), expected: expected_text(expected) }
}

fn found_text(found: &str) -> String {
    let plain = ["integer ", "floating point ", "boolean "].iter().find_map(|kind| found.strip_prefix(kind));
    match found {
        "map" => "a table".into(),
        "sequence" => "a list".into(),
        // The TOML reader says this of a number where it expects a word.
        "unit variant" => "no text".into(),
        _ => match found.split_once(' ') {
            Some(("string", text)) => format!("the text {}", shortened(text)),
            Some(("length", count)) => format!("a list of {count}"),
            _ => plain.unwrap_or(found).trim_matches('`').to_owned(),
        },
    }
}

/// Returns the text, or its beginning if it is too long to quote.
pub fn shortened(text: &str) -> String {
    if text.chars().count() <= LONGEST_QUOTE {
        return text.to_owned();
    }
    text.chars().take(LONGEST_QUOTE).chain("...".chars()).collect()
}

fn expected_text(expected: &str) -> String {
    match expected {
        "f64" => "a number".into(),
        "u16" => format!("a whole number from 0 to {}", u16::MAX),
        "u32" => format!("a whole number from 0 to {}", u32::MAX),
        "a sequence" => "a list".into(),
        "a string" | "path string" | "string only" => "a string in quotes".into(),
        "a boolean" => "true or false".into(),
        "an array of length 2" | "fewer elements in array" => "a list of two numbers".into(),
        "a tuple of size 2" | "fewer elements in sequence" => "a pair [column, row]".into(),
        _ if expected.starts_with("struct ") => "a table".into(),
        _ => expected.into(),
    }
}
