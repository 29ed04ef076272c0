//! Nothing that a scenario may choose leads to a violation: scenarios are drawn over everything that can be chosen,
//! run, and audited.
//!
//! The choices are read from the JSON Schema of scenarios, so that a new setting, or a new value of an old one, is
//! drawn from the day it is there. `WILDFIRE_SETTINGS_CASES=1..3000` draws these cases (both ends) instead of a few.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::panic;

use rand::RngExt;
use rand::seq::IndexedRandom;
use serde_json::{Value, json};
use wildfire::audit::{Audited, SampleStep, audit_timeline};
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::scenario::{self, Scenario};
use wildfire::sim;

/// A scenario with two agents of each kind in a small field, where much burns and all are in each other's way.
const BASE: &str = r##"{
    "name": "settings",
    "duration_s": 90.0,
    "field": { "size_m": 75.0, "coverage": 0.15 },
    "wumpus": [{ "start_m": [62.5, 62.5] }, { "start_m": [12.5, 62.5] }],
    "unimog": [
        { "start": { "x_m": 15.0, "y_m": 15.0 } },
        { "start": { "x_m": 60.0, "y_m": 15.0, "heading_deg": 90.0 } }
    ],
    "ignition": [{ "at_s": 1.0, "random": 3 }]
}"##;

/// The share of cases in which a setting has another value than the base scenario, if its values are listed or if it is
/// a number.
const CHOICE_SHARE: f64 = 0.75;
const NUMBER_SHARE: f64 = 0.04;

/// The values that a setting may have.
#[derive(Clone, Debug)]
enum Values {
    /// One of these.
    Listed(Vec<Value>),
    /// One or several of these.
    SomeOf(Vec<Value>),
    Number,
    WholeNumber,
    NumberOrNone,
    /// It is not drawn.
    Fixed,
}

/// Lists every setting of a scenario, as a JSON pointer into it, with the values that it may have.
fn settings(base: &Value) -> Vec<(String, Values)> {
    let schema = serde_json::to_value(scenario::schema()).expect("a schema is JSON");
    let mut found = Vec::new();
    collect(&schema, &schema, base, "", &mut found);
    found
}

/// Goes through a schema and a value that it describes.
fn collect(root: &Value, schema: &Value, value: &Value, pointer: &str, found: &mut Vec<(String, Values)>) {
    if let Some(reference) = schema["$ref"].as_str() {
        let target =
            reference.strip_prefix('#').and_then(|place| root.pointer(place)).expect("references lead somewhere");
        return collect(root, target, value, pointer, found);
    }
    // Planners and policies that nobody registered.
    if schema["additionalProperties"].is_object() {
        return;
    }
    if let Some(properties) = schema["properties"].as_object() {
        // A complete scenario leaves out tables that it does not choose, and the `count` of agents, which loading carries out.
        for (name, inner) in properties.iter().filter(|(name, _)| value.get(name).is_some()) {
            collect(root, inner, &value[name], &format!("{pointer}/{name}"), found);
        }
        return;
    }
    if let (Some(entries), Some("object")) = (value.as_array(), resolved(root, &schema["items"])["type"].as_str()) {
        for (index, entry) in entries.iter().enumerate() {
            collect(root, &schema["items"], entry, &format!("{pointer}/{index}"), found);
        }
        return;
    }
    let values = values(root, schema).unwrap_or_else(|| panic!("{pointer}: what may it be by {schema}?"));
    found.push((pointer.to_owned(), values));
}

fn resolved<'a>(root: &'a Value, schema: &'a Value) -> &'a Value {
    let target = schema["$ref"].as_str().and_then(|reference| root.pointer(reference.strip_prefix('#')?));
    target.unwrap_or(schema)
}

/// Returns the values of a setting of this schema; `None` if the schema is not understood.
fn values(root: &Value, schema: &Value) -> Option<Values> {
    if let Some(enum_values) = enum_values(schema) {
        return Some(Values::Listed(enum_values));
    }
    if schema["anyOf"] == json!([{ "const": "auto" }, { "type": "boolean" }]) {
        return Some(Values::Listed(vec![json!("auto"), json!(true), json!(false)]));
    }
    if schema["anyOf"] == json!([{ "type": "number" }, { "const": "none" }]) {
        return Some(Values::NumberOrNone);
    }
    match schema["type"].as_str() {
        Some("boolean") => Some(Values::Listed(vec![json!(true), json!(false)])),
        Some("number") => Some(Values::Number),
        Some("integer") => Some(Values::WholeNumber),
        // Names and paths.
        Some("string") => Some(Values::Fixed),
        Some("array") => match enum_values(resolved(root, &schema["items"])) {
            Some(enum_values) => Some(Values::SomeOf(enum_values)),
            // Places, and lists of tables that the scenario leaves empty.
            None => {
                let items = resolved(root, &schema["items"]);
                (items["type"] == "number" || items["type"] == "object").then_some(Values::Fixed)
            }
        },
        // Tables that may be left out: models that the scenario does not choose.
        None if is_optional_table(root, schema) => Some(Values::Fixed),
        // Settings that may be left out: a map, a count instead of a share.
        None if schema["type"].as_array()?.contains(&json!("null")) => Some(Values::Fixed),
        _ => None,
    }
}

/// Says whether a schema is that of a table, or of nothing.
fn is_optional_table(root: &Value, schema: &Value) -> bool {
    let choices = schema["anyOf"].as_array().map_or(&[][..], Vec::as_slice);
    choices.iter().any(|choice| choice["type"] == "null")
        && choices.iter().any(|choice| resolved(root, choice)["type"] == "object")
}

/// The words of an enumeration.
fn enum_values(schema: &Value) -> Option<Vec<Value>> {
    if let Some(listed) = schema["enum"].as_array() {
        return Some(listed.clone());
    }
    if let Some(choices) = schema["anyOf"].as_array() {
        return choices.iter().find_map(enum_values);
    }
    let variants = schema["oneOf"].as_array()?;
    let of_variant =
        |variant: &Value| variant.get("const").map(|word| vec![word.clone()]).or_else(|| enum_values(variant));
    variants.iter().map(of_variant).collect::<Option<Vec<_>>>().map(|enum_values| enum_values.concat())
}

/// Draws another value for a setting.
fn draw(values: &Values, base: &Value, rng: &mut Xoshiro256PlusPlus) -> Value {
    let factor = *[0.25, 0.5, 2.0, 4.0].choose(rng).expect("there are some");
    let scaled = |number: f64| if number == 0.0 { 0.1 * factor } else { number * factor };
    match values {
        Values::Listed(listed) => listed.choose(rng).expect("an enumeration has values").clone(),
        Values::SomeOf(listed) => {
            let first = rng.random_range(0..listed.len());
            listed[first..=rng.random_range(first..listed.len())].iter().cloned().collect()
        }
        Values::Number => json!(scaled(base.as_f64().expect("the base scenario is complete"))),
        Values::WholeNumber => json!(scaled(base.as_f64().expect("the base scenario is complete")).ceil() as u64),
        Values::NumberOrNone if rng.random_bool(0.5) => json!("none"),
        Values::NumberOrNone => json!(scaled(base.as_f64().unwrap_or(2.0))),
        Values::Fixed => base.clone(),
    }
}

/// The changes that a case makes to the base scenario.
type Changes = BTreeMap<String, Value>;

fn draw_changes(settings: &[(String, Values)], base: &Value, rng: &mut Xoshiro256PlusPlus) -> Changes {
    let mut changes = Changes::new();
    for (pointer, values) in settings {
        let share = match values {
            Values::Number | Values::WholeNumber => NUMBER_SHARE,
            Values::Listed(_) | Values::SomeOf(_) | Values::NumberOrNone => CHOICE_SHARE,
            Values::Fixed => 0.0,
        };
        if rng.random_bool(share) {
            changes.insert(pointer.clone(), draw(values, base.pointer(pointer).expect("it was found there"), rng));
        }
    }
    changes
}

/// Draws changes until the check accepts the base scenario with them; returns both.
fn draw_scenario(settings: &[(String, Values)], base: &Value, rng: &mut Xoshiro256PlusPlus) -> (Changes, Scenario) {
    loop {
        let changes = draw_changes(settings, base, rng);
        if let Some(scenario) = changed(base, &changes) {
            return (changes, scenario);
        }
    }
}

/// The base scenario with changes, if it is allowed.
fn changed(base: &Value, changes: &Changes) -> Option<Scenario> {
    let mut value = base.clone();
    for (pointer, new) in changes {
        *value.pointer_mut(pointer).expect("it was found there") = new.clone();
    }
    let scenario: Scenario = serde_json::from_value(value).expect("values are drawn from the schema");
    scenario.check().is_ok().then_some(scenario)
}

/// The base scenario with all its defaults.
fn base() -> Value {
    let scenario: Scenario = serde_json::from_str(BASE).expect("the base scenario is right");
    serde_json::to_value(scenario).expect("scenarios can be written")
}

/// These cases, or those that the environment asks for.
fn cases(usual: RangeInclusive<u64>) -> RangeInclusive<u64> {
    let Ok(text) = std::env::var("WILDFIRE_SETTINGS_CASES") else { return usual };
    let (first, last) = text.split_once("..").expect("cases are FIRST..LAST");
    let number = |text: &str| text.parse().expect("cases are whole numbers");
    number(first)..=number(last)
}

/// Draws a case, runs it, and says what is wrong with it; `None` if the field has no room for its bushes or agents.
fn try_case(case: u64, settings: &[(String, Values)], base: &Value) -> Option<(Changes, Result<Audited, String>)> {
    let (changes, scenario) = draw_scenario(settings, base, &mut rng::stream(case, "settings"));
    let audited = panic::catch_unwind(|| {
        let run = sim::run(&scenario, case).ok()?;
        let verdict = audit_timeline(&run.timeline, SampleStep::default());
        Some(verdict.violation.map_or(Ok(verdict.audited), |violation| Err(violation.to_string())))
    });
    audited.unwrap_or_else(|_| Some(Err("it panicked".into()))).map(|result| (changes, result))
}

#[test]
fn no_setting_leads_to_a_violation() {
    audit_settings(cases(1..=50));
}

#[test]
#[ignore = "tier 2: enough cases that every value of every setting is drawn"]
fn no_setting_of_many_leads_to_a_violation() {
    audit_settings(cases(1..=200));
}

#[expect(clippy::print_stdout, reason = "the test prints what it counted")]
fn audit_settings(cases: RangeInclusive<u64>) {
    let base = base();
    let settings = settings(&base);
    let mut unseen: BTreeMap<&str, Vec<Value>> = settings
        .iter()
        .filter_map(|(pointer, values)| match values {
            Values::Listed(listed) | Values::SomeOf(listed) => Some((pointer.as_str(), listed.clone())),
            _ => None,
        })
        .collect();
    let (mut audited, mut ran, mut wrong) = (Audited::default(), 0, Vec::new());
    let tried = cases.clone().count();
    for case in cases {
        let Some((changes, result)) = try_case(case, &settings, &base) else { continue };
        ran += 1;
        match result {
            Ok(more) => audited += more,
            Err(fault) => wrong.push(format!("case {case}: {fault}\n{}", json!(changes))),
        }
        for (pointer, left) in &mut unseen {
            let value = changes.get(*pointer).unwrap_or_else(|| base.pointer(pointer).expect("it was found there"));
            left.retain(|word| word != value && !value.as_array().is_some_and(|several| several.contains(word)));
        }
    }
    println!("{ran} of {tried} cases ran: {audited:?}");
    assert!(wrong.is_empty(), "{} cases are wrong:\n{}", wrong.len(), wrong.join("\n"));
    unseen.retain(|_, left| !left.is_empty());
    assert!(unseen.is_empty() || tried < 100, "never drawn: {unseen:?}");
    assert!(4 * ran > 3 * tried, "only {ran} cases could be run");
    assert!(audited.legs > 10 * ran as u64 && audited.extinctions > 2 * ran as u64, "{ran} cases: {audited:?}");
}
