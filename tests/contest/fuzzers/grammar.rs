//! Scenarios by the grammar of the program's own JSON Schema, so that a new key is drawn without a change here.
//!
//! Ranges of numbers are not part of the schema. They are taken from the refusal of a number that is in no range.

use std::collections::BTreeMap;

use annotate_snippets::{Level, Renderer};
use arbitrary::Unstructured;
use serde_json::Value as Json;
use toml::{Table, Value};
use wildfire::scenario::{self, Fault, ScenarioError, SourceLocation};
use wildfire::untrusted::visible_lines;

use super::fuzz::{Law, below, chance, one_of};

/// Keys of a scenario and what they take.
pub struct Grammar {
    schema: Json,
    keys: Vec<Key>,
    /// The keys that take words or yes and no: they decide what the others are good for.
    choices: Vec<usize>,
    /// Ranges by path without places in lists: `unimog.prm.samples`.
    ranges: BTreeMap<String, [f64; 2]>,
}

/// A key that takes a value, or a list of plain ones.
struct Key {
    /// Names of tables and lists of tables, and the key's own.
    path: Vec<String>,
    schema: Json,
}

/// A scenario and the files beside it.
pub struct Written {
    pub scenario: Table,
    /// The map that `field.map` names.
    pub map: Option<String>,
}

/// The name of the map that a drawn scenario may name.
pub const MAP: &str = "map.txt";

/// The name of the weather stream that a drawn scenario may name, and what it says.
pub const WEATHER: &str = "weather.csv";
pub const WEATHER_TEXT: &str = "time,temperature_c,humidity_pct,speed_mps,from_deg,rain_mm,solar_w_m2\n\
                                2026-07-14 12:00,29,24,5,270,0,850\n2026-07-14 13:00,20,90,9,180,4,100\n";

impl Grammar {
    pub fn new() -> Self {
        let schema = serde_json::to_value(scenario::schema()).expect("a schema is JSON");
        let mut grammar = Self { schema, keys: Vec::new(), choices: Vec::new(), ranges: BTreeMap::new() };
        let mut keys = Vec::new();
        grammar.keys_of(&grammar.schema, &[], &mut keys);
        grammar.choices = (0..keys.len()).filter(|&key| grammar.is_choice(&keys[key].schema)).collect();
        for key in &keys {
            let path = key.path.join(".");
            if let Some(range) = range_of(&path) {
                grammar.ranges.insert(path, range);
            }
        }
        Self { keys, ..grammar }
    }

    /// Numbers by their path without places in lists, with the least and the most that each may be.
    pub fn ranges(&self) -> &BTreeMap<String, [f64; 2]> {
        &self.ranges
    }

    /// Draws a scenario of a small field and a short time, with some other keys; most are accepted.
    pub fn draw(&self, dice: &mut Unstructured<'_>) -> Written {
        let cell_m = if chance(dice, 80) { 5.0 } else { *one_of(dice, &[2.5, 20.0, 3.3, 1.0, 0.5, 7.0]) };
        let side = 8 + below(dice, if cell_m > 5.0 { 3 } else { 13 });
        let size_m = side as f64 * cell_m;
        let mut scenario = Table::new();
        scenario.insert("name".into(), Value::String("fuzz".into()));
        scenario.insert("duration_s".into(), Value::Float(1.0 + below(dice, 240) as f64));
        let map = chance(dice, 20).then(|| drawn_map(dice, side));
        let mut field = Table::from_iter([("cell_m".into(), Value::Float(cell_m))]);
        if map.is_some() {
            field.insert("map".into(), Value::String(MAP.into()));
            if chance(dice, 20) {
                field.insert("map_invert".into(), Value::Boolean(chance(dice, 50)));
            }
        } else {
            field.insert("size_m".into(), Value::Float(size_m));
            field.insert(
                "coverage".into(),
                Value::Float(*one_of(dice, &[0.1, 0.05, 0.02, 0.08, 0.12, 0.1, 0.2, 0.1, 0.05, 0.4])),
            );
            field.insert("start_clearance_m".into(), Value::Float(*one_of(dice, &[5.0, 0.0, 10.0]) * cell_m / 5.0));
        }
        scenario.insert("field".into(), Value::Table(field));
        for kind in ["wumpus", "unimog"] {
            let count = *one_of(dice, &[1, 1, 1, 2, 1, 1, 0, 1, 3, 1]);
            let agent = |dice: &mut Unstructured<'_>| {
                let mut agent = placed(dice, kind, size_m);
                if chance(dice, 60) {
                    let planners = &self.properties(&self.properties(&self.schema)[kind]["items"])["planner"];
                    let planner = self.value(dice, planners, "planner").expect("planners have names");
                    agent.insert("planner".into(), planner);
                }
                Value::Table(agent)
            };
            let agents = (0..count).map(|_| agent(dice)).collect();
            scenario.insert(kind.into(), Value::Array(agents));
        }
        if chance(dice, 40) {
            let count = 1 + below(dice, 3);
            let items = &self.properties(&self.schema)["ignition"]["items"];
            let ignition = |dice: &mut Unstructured<'_>| self.ignition(dice, items, side);
            let ignitions = (0..count).map(|_| ignition(dice)).collect();
            scenario.insert("ignition".into(), Value::Array(ignitions));
        }
        if chance(dice, 10) {
            let moisture = *one_of(dice, &["fixed", "tables", "nelson"]);
            let stream = [("file", WEATHER), ("dead_moisture", moisture)];
            let stream = stream.map(|(key, word)| (key.to_owned(), Value::String(word.to_owned())));
            scenario.insert("weather".into(), Value::Table(stream.into_iter().collect()));
        }
        for _ in 0..below(dice, 10) {
            self.change(dice, &mut scenario);
        }
        Written { scenario, map }
    }

    /// Sets one key; one of agents, in any of them.
    fn change(&self, dice: &mut Unstructured<'_>, scenario: &mut Table) {
        let key = if chance(dice, 40) { *one_of(dice, &self.choices) } else { below(dice, self.keys.len()) };
        let Key { path, schema } = &self.keys[key];
        let dotted = path.join(".");
        // Keys that decide whether anything can be run are drawn by other means, and only now and then by these.
        if (FRAME.contains(&dotted.as_str()) || WHOLE.contains(&path[0].as_str())) && !chance(dice, 5) {
            return;
        }
        let (Some(value), Some((name, tables))) = (self.value(dice, schema, &dotted), path.split_last()) else {
            return;
        };
        let mut table = scenario;
        for name in tables {
            let inner = table.entry(name.clone()).or_insert_with(|| Value::Table(Table::new()));
            let inner = match inner {
                Value::Table(inner) => inner,
                Value::Array(entries) if !entries.is_empty() => {
                    let entry = below(dice, entries.len());
                    let Value::Table(inner) = &mut entries[entry] else { return };
                    inner
                }
                _ => return,
            };
            table = inner;
        }
        table.insert(name.clone(), value);
    }

    fn ignition(&self, dice: &mut Unstructured<'_>, schema: &Json, side: usize) -> Value {
        let schema = self.resolved(schema);
        let mut entry = Table::new();
        let at_s = self.value(dice, &self.properties(schema)["at_s"], "ignition.at_s");
        entry.insert("at_s".into(), at_s.unwrap_or(Value::Float(0.0)));
        if chance(dice, 60) {
            entry.insert("random".into(), Value::Integer(1 + below(dice, 9) as i64));
        } else {
            let mut at = || Value::Integer(below(dice, side) as i64);
            let cells = (0..3).map(|_| Value::Array(vec![at(), at()])).collect();
            entry.insert("cells".into(), Value::Array(cells));
        }
        Value::Table(entry)
    }

    /// Draws a value of this schema; `None` for null, which TOML does not have.
    fn value(&self, dice: &mut Unstructured<'_>, schema: &Json, path: &str) -> Option<Value> {
        let default = &schema["default"];
        let schema = self.resolved(schema);
        if let Some(choices) = ["anyOf", "oneOf"].iter().find_map(|of| schema[*of].as_array()) {
            // Names of one's own are seldom known.
            let is_named = choices[0]["oneOf"].is_array() && chance(dice, 95);
            let choice = if is_named { &choices[0] } else { one_of(dice, choices) };
            return self.value(dice, choice, path);
        }
        if let Some(word) = schema["const"].as_str() {
            return Some(Value::String(word.to_owned()));
        }
        if let Some(values) = schema["enum"].as_array() {
            return one_of(dice, values).as_str().map(|word| Value::String(word.to_owned()));
        }
        let kinds = match &schema["type"] {
            Json::Array(kinds) => kinds.iter().filter_map(Json::as_str).collect(),
            kind => Vec::from_iter(kind.as_str()),
        };
        Some(match *kinds.first()? {
            "boolean" => Value::Boolean(chance(dice, 50)),
            "integer" => self.whole_number(dice, schema, default, path),
            "number" => Value::Float(self.number(dice, default.as_f64().unwrap_or(1.0), path)),
            "string" => Value::String((*one_of(dice, &["x", "", MAP, "nowhere.txt", "é\u{202E}\n"])).to_owned()),
            "array" => {
                let min = schema["minItems"].as_u64().unwrap_or(0) as usize;
                let max = schema["maxItems"].as_u64().map_or(min + 3, |max| max as usize);
                let count = min + below(dice, max - min + 1);
                let item = |index: usize| match &schema["prefixItems"] {
                    Json::Array(items) if index < items.len() => items[index].clone(),
                    _ => schema["items"].clone(),
                };
                Value::Array((0..count).filter_map(|index| self.value(dice, &item(index), path)).collect())
            }
            // A value of an unknown kind stays as it is by default.
            _ => return None,
        })
    }

    /// Draws a number, mostly near the default, else anywhere in the range, at its ends, or beyond.
    fn number(&self, dice: &mut Unstructured<'_>, default: f64, path: &str) -> f64 {
        let [min, max] = self.ranges.get(path).copied().unwrap_or([0.0, 1e6]);
        let factor = *one_of(dice, &[1.0, 0.5, 2.0, 0.25, 4.0, 1.5, 0.1, 10.0, 0.999_999, 3.7]);
        match below(dice, 100) {
            0..65 if default == 0.0 => *one_of(dice, &[0.0, 0.01, 0.1, 1.0]),
            0..65 => (default * factor).clamp(min, max),
            65..85 => {
                // As likely in every power of ten.
                let powers = std::iter::successors(Some(1e-3), |power| Some(10.0 * power));
                let powers: Vec<f64> = powers.take_while(|power| *power <= max.max(1e-3)).collect();
                (factor * one_of(dice, &powers)).clamp(min, max)
            }
            85..89 => min,
            89..93 => max,
            93 => min.next_down(),
            94 => max.next_up(),
            95 => min.next_up().min(max),
            96 => max.next_down().max(min),
            97 => -0.0,
            98 => min + 0.5 * (max - min),
            _ => *one_of(dice, &[f64::NAN, f64::INFINITY, f64::MAX, 5e-324, -1.0, -1e308, 1e-300, 1e15]),
        }
    }

    fn whole_number(&self, dice: &mut Unstructured<'_>, schema: &Json, default: &Json, path: &str) -> Value {
        let number = self.number(dice, default.as_f64().unwrap_or(10.0), path);
        let max = schema["maximum"].as_f64().unwrap_or(i64::MAX as f64);
        match below(dice, 64) {
            63 => Value::Float(number),
            62 => Value::Integer(i64::MIN),
            _ => Value::Integer(number.round().clamp(0.0, max) as i64),
        }
    }

    fn resolved<'a>(&'a self, schema: &'a Json) -> &'a Json {
        match schema["$ref"].as_str().and_then(|path| path.strip_prefix("#/$defs/")) {
            Some(name) => &self.schema["$defs"][name],
            None => schema,
        }
    }

    fn properties<'a>(&'a self, schema: &'a Json) -> &'a serde_json::Map<String, Json> {
        self.resolved(schema)["properties"].as_object().expect("tables have their keys in the schema")
    }

    /// All keys below a path.
    fn keys_of(&self, schema: &Json, path: &[String], found: &mut Vec<Key>) {
        for (name, inner) in self.properties(schema) {
            let path = [path, std::slice::from_ref(name)].concat();
            let resolved = self.resolved(inner);
            let items = self.resolved(&resolved["items"]);
            match (resolved["type"].as_str(), items["type"].as_str()) {
                // Tables whose keys are names: one of them.
                (Some("object"), _) if resolved["additionalProperties"]["type"] == "number" => {
                    let path = [path.as_slice(), &["other".to_owned()]].concat();
                    found.push(Key { path, schema: resolved["additionalProperties"].clone() });
                }
                (Some("object"), _) if resolved["additionalProperties"].is_object() => {
                    let entry = [path.as_slice(), &["rrt".to_owned()]].concat();
                    self.keys_of(&resolved["additionalProperties"], &entry, found);
                }
                // Settings that are handed on as they are.
                (Some("object"), _) if !resolved["properties"].is_object() => {}
                (Some("object"), _) => self.keys_of(resolved, &path, found),
                (Some("array"), Some("object")) => self.keys_of(items, &path, found),
                _ => found.push(Key { path, schema: inner.clone() }),
            }
        }
    }

    /// Says whether a value of this schema is one of a few.
    fn is_choice(&self, schema: &Json) -> bool {
        let resolved = self.resolved(schema);
        resolved["type"] == "boolean" || resolved["enum"].is_array() || resolved["oneOf"].is_array()
    }
}

/// Keys that say where a scenario takes place and for how long, and those that need a file beside it.
const FRAME: [&str; 24] = [
    "duration_s",
    "field.size_m",
    "field.cell_m",
    "field.map",
    "field.map_invert",
    "field.pieces",
    "unimog.start.x_m",
    "unimog.start.y_m",
    "wumpus.start_m",
    "planner.rrt.module",
    "policy.rrt.module",
    "weather.file",
    "weather.dead_moisture",
    "weather.start_h",
    "weather.latitude_deg",
    "weather.utc_offset_h",
    "fuel_file",
    "barrier.file",
    "wind.east",
    "wind.from",
    "wind.north",
    "wind.speed",
    "wind.toward",
    "wind.units",
];

/// Tables whose keys are right together only.
const WHOLE: [&str; 2] = ["barrier", "fuel"];

/// Reads a number's range from the refusal of one that is too large.
fn range_of(path: &str) -> Option<[f64; 2]> {
    let ask = |number: &str| {
        let changes = ["ignition=[{ at_s = 0, random = 1 }]".to_owned(), format!("{path}={number}")];
        match scenario::load("smoke", &changes).err()?.fault {
            Fault::Value { expected, .. } => Some(expected),
            _ => None,
        }
    };
    // A whole number must fit its type before its range is looked at.
    ["1e300", "4294967295", "65535"].into_iter().find_map(|number| {
        let expected = ask(number)?;
        let (min, max) = expected.strip_prefix("a number from ")?.split_once(" to ")?;
        Some([min.parse().ok()?, max.parse().ok()?])
    })
}

/// Checks that a refusal says where to look, and that its message can be shown.
pub fn refusal_names_its_place(refusal: &ScenarioError) -> Law {
    match (&refusal.location, &refusal.fault) {
        (Some(_), _) => {}
        // These are about a whole file, which they name.
        (None, Fault::NotFound { .. } | Fault::Unreadable { .. }) => {}
        (None, fault) => return Err(format!("a refusal without a place: {fault}")),
    }
    let snippet = refusal.location.as_ref().map(SourceLocation::snippet);
    let shown = Renderer::plain().render(&[Level::ERROR.primary_title(refusal.to_string()).elements(snippet)]);
    match visible_lines(&shown) {
        visible if visible != shown => Err(format!("what is shown acts on a terminal: {shown:?}")),
        _ if refusal.location.is_some() && !shown.contains('^') => Err(format!("no place is shown: {shown}")),
        _ => Ok(()),
    }
}

/// Draws an agent with its start in the field, as far from the border as a truck is long where the field has room.
fn placed(dice: &mut Unstructured<'_>, kind: &str, size_m: f64) -> Table {
    let mut at = || Value::Float(size_m * (0.2 + 0.05 * below(dice, 13) as f64));
    match kind {
        "wumpus" => Table::from_iter([("start_m".into(), Value::Array(vec![at(), at()]))]),
        _ => {
            let start = Table::from_iter([("x_m".into(), at()), ("y_m".into(), at())]);
            Table::from_iter([("start".into(), Value::Table(start))])
        }
    }
}

/// Draws a map as text, or as JSON.
fn drawn_map(dice: &mut Unstructured<'_>, side: usize) -> String {
    let percent = *one_of(dice, &[10, 5, 20, 40, 0, 60]);
    if chance(dice, 30) {
        let count = side * side * usize::from(percent) / 100;
        let cells: Vec<_> = (0..count).map(|_| [below(dice, side), below(dice, side)]).collect();
        return serde_json::json!({ "n": side, "cell_m": 5.0, "cells_cr": cells }).to_string();
    }
    let rows = if chance(dice, 30) { 1 + below(dice, 2 * side) } else { side };
    let row = |dice: &mut Unstructured<'_>| (0..side).map(|_| if chance(dice, percent) { '#' } else { '.' }).collect();
    let drawn: Vec<String> = (0..rows).map(|_| row(dice)).collect();
    drawn.join("\n")
}
