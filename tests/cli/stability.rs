//! Names that were published are still there, as `docs/command-line.md` promises: `tests/data/names.txt` lists them. A name may
//! be added and is then promised too, from the release whose list has it.
//! `WILDFIRE_REWRITE_DATA=1 cargo test --test cli stability` adds the names of today.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value as Json;
use wildfire::batch::drives::DRIVE_COLUMNS;
use wildfire::batch::table::{AGENT_COLUMNS, is_measured};
use wildfire::cli;

use crate::children::{output_of, program};

/// The names of a JSON Schema: members with the way to them, and words that a text is one of.
struct Names<'a> {
    schema: &'a Json,
    found: &'a mut BTreeSet<String>,
    /// Definitions that the walk is in, as some contain themselves.
    inside: Vec<&'a str>,
}

impl<'a> Names<'a> {
    fn add(&mut self, part: &'a Json, path: &str) {
        if let Some(reference) = part["$ref"].as_str().filter(|reference| !self.inside.contains(reference)) {
            self.inside.push(reference);
            let schema = self.schema;
            self.add(schema.pointer(&reference[1..]).expect("a schema has its definitions"), path);
            self.inside.pop();
        }
        for (name, member) in part["properties"].as_object().into_iter().flatten() {
            if !is_measured(name) {
                let path = format!("{path}.{name}");
                self.add(member, &path);
                self.found.insert(path);
            }
        }
        let any = ["anyOf", "oneOf", "allOf", "prefixItems"].iter().filter_map(|key| part[key].as_array()).flatten();
        any.chain(part.get("items")).for_each(|part| self.add(part, path));
        // The keys of such a table are the user's.
        part.get("additionalProperties").into_iter().for_each(|value| self.add(value, &format!("{path}.*")));
        let values = part["enum"].as_array().into_iter().flatten().chain([&part["const"]]);
        self.found.extend(values.filter_map(Json::as_str).map(|word| format!("{path} = {word}")));
    }
}

fn schema(of: &str) -> Json {
    serde_json::from_slice(&output_of(program().args(["schema", of])).stdout).expect("a schema is JSON")
}

fn add_options(command: &clap::Command, path: &str, found: &mut BTreeSet<String>) {
    found.insert(path.to_owned());
    for option in command.get_arguments() {
        // Hidden ones are earlier names, which are still taken.
        let long = option.get_long().into_iter().chain(option.get_all_aliases().into_iter().flatten());
        let names: Vec<String> = long.map(|name| format!("{path} --{name}")).collect();
        found.extend(option.get_short().map(|letter| format!("{path} -{letter}")));
        let names_or_place = if names.is_empty() { &[path.to_owned()] } else { &names[..] };
        let words = option.get_possible_values();
        found.extend(
            names_or_place
                .iter()
                .flat_map(|name| words.iter().map(move |word| format!("{name} = {}", word.get_name()))),
        );
        found.extend(names);
    }
    for part in command.get_subcommands() {
        add_options(part, &format!("{path} {}", part.get_name()), found);
    }
}

fn names_of_today() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut command = cli::program();
    command.build();
    add_options(&command, "wildfire", &mut found);
    let schemas = command.find_subcommand("schema").and_then(|schema| schema.get_positionals().next());
    for of in schemas.expect("it prints one of several").get_possible_values() {
        let schema = schema(of.get_name());
        Names { schema: &schema, found: &mut found, inside: Vec::new() }.add(&schema, of.get_name());
    }
    let agents = AGENT_COLUMNS.iter().map(|column| ("agents", column.name));
    let columns = agents.chain(DRIVE_COLUMNS.iter().map(|column| ("drives", column.name)));
    found.extend(columns.filter(|(_, name)| !is_measured(name)).map(|(table, name)| format!("{table}.{name}")));
    found
}

#[test]
fn no_published_name_is_gone() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/names.txt");
    let text = fs::read_to_string(&path).expect("it is kept with the tests");
    let (published, today) = (text.lines().map(str::to_owned).collect::<BTreeSet<_>>(), names_of_today());
    let gone: Vec<_> = published.difference(&today).collect();
    assert!(gone.is_empty(), "published names that are gone: {gone:#?}");
    if std::env::var_os("WILDFIRE_REWRITE_DATA").is_some_and(|value| value == "1") {
        fs::write(path, today.iter().map(|name| format!("{name}\n")).collect::<String>()).expect("writable");
    } else {
        assert!(published.len() > 1000, "{} names are published", published.len());
    }
}
