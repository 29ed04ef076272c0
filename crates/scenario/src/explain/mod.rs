//! Explains a scenario by its values and its schema, for `wildfire check`.

pub mod ground_report;
pub mod warnings;

use serde_json::Value as Json;

use crate::faults::path::{FieldPath, PathStep};
use crate::keys::agents::{AgentList, SHOWN_SEED};
use crate::keys::field::percent;
use crate::keys::rules::describe_ignitions;
use crate::read::load::LoadedScenario;
use crate::site::landscape::is_bare;
use crate::{
    FireModelName, MemoryEstimate, MemoryLimit, MemoryPart, Scenario, Terrain, bytes_text, schema, weather_on,
};
use ground_report::{describe_fires, describe_ground, describe_weather};
use warnings::warnings;
use wildfire_base::document::{Block, Document, WIDTH};
use wildfire_base::geometry::Cell;

/// Explains a scenario: its values and what the chosen words mean, the field of seed 1 with a map, the memory that a run
/// takes beside its limit, and warnings. No line is wider than a terminal.
pub fn explain(loaded: &LoadedScenario, limit: MemoryLimit) -> Document {
    let scenario = &loaded.scenario;
    let values = ScenarioValues::new(loaded);
    let title = format!("{}: {} s of simulated time at most.", scenario.name, scenario.duration_s);
    let mut document = Document::new(title);
    let mut add = |title: &str, lines: Vec<String>| {
        if !lines.is_empty() {
            document = std::mem::take(&mut document).with(section(title, lines));
        }
    };
    add("Field", [vec![scenario.field.describe()], values.of("field", &[])].concat());
    add("Fire", values.of("fire", scenario.fire.unused()));
    for (title, table) in [("Suppression", "suppression"), ("Score", "score"), ("Landscape", "landscape")] {
        add(title, values.of(table, &[]));
    }
    // Under the model `radius` fire knows no weather.
    if scenario.fire.model != FireModelName::Radius {
        add("Weather", describe_weather(scenario));
    }
    for agents in scenario.kinds() {
        add(agents.title(), describe_agents(agents, loaded, &values));
    }
    for (title, table) in
        [("Dispatch", "dispatch"), ("Sight", "sight"), ("Traffic", "traffic"), ("Crews", "crew"), ("Line", "line")]
    {
        add(title, values.of(table, &[]));
    }
    if let Some(water) = &scenario.water {
        add("Water", [values.of("water", &[]), vec![water.describe()]].concat());
    }
    if !scenario.ignition.is_empty() {
        add("Ignitions", vec![describe_ignitions(&scenario.ignition)]);
    }
    add("Programs", [describe_programs(scenario), values.of("planner", &[]), values.of("policy", &[])].concat());
    let left = values.all.iter().filter(|value| value.is_default).count();
    let set = values.all.len() - left;
    let counts = match left {
        0 => format!("All {set} values are set."),
        _ => format!("{set} values are set, {left} have their defaults, marked by {DEFAULT}."),
    };
    add("Values", vec![counts]);
    let terrain = Terrain::from_scenario(scenario, SHOWN_SEED);
    // A field that cannot be generated is explained nevertheless, with the reason in the place of its map.
    let field = match &terrain {
        Ok(terrain) => describe_terrain(scenario, terrain),
        Err(error) => vec![Block::Text(format!("There is none: {error}."))],
    };
    document = document.with([Block::Heading(format!("Field of seed {SHOWN_SEED}"))]).with(field);
    if let Ok(terrain) = &terrain
        && let Some(landscape) = &terrain.landscape
    {
        document = document.with(section("Ground", describe_ground(scenario, terrain)));
        // Uncertain weather is that of seed 1 too, so that the fires fit the field that is shown.
        let fires = describe_fires(scenario, terrain, &weather_on(scenario, SHOWN_SEED, landscape));
        if !fires.is_empty() {
            document = document.with(section("Fire on level ground in the first weather", fires));
        }
    }
    document = document.with([Block::Heading("Maximum memory of a run".into())]).with(list_memory(scenario, limit));
    let warnings = warnings(scenario, terrain.as_ref().ok());
    if !warnings.is_empty() {
        document = document.with(section("Warnings", warnings));
    }
    document
}

/// Keys that matter most to what happens in a run.
const MAIN_KEYS: &str = "duration_s field.size_m field.cell_m field.coverage field.map fire.model fire.spread_delay_s \
    fire.spread_radius_m fire.burn_out_s suppression.reach_m suppression.dwell_s score.truck_extinguished \
    wumpus.goal wumpus.planner wumpus.speed_mps unimog.goal unimog.planner unimog.speed_mps \
    unimog.vehicle.turning_radius_m dispatch.policy";

/// The most values of an outline: they fit on a screen.
const MAX_OUTLINE: usize = 24;

/// Lists the main values of a scenario, of its first truck and Wumpus, and then those that it sets otherwise than the
/// contest, what the contest has not first; each as a change of it is written: `key=value`.
pub fn outline(loaded: &LoadedScenario) -> Vec<String> {
    let contest = LoadedScenario::open("contest", &[]).expect("it is built in").values();
    let mut ranked = Vec::new();
    for (path, value) in loaded.values().into_iter().filter(|(path, value)| value != "[]" && path != "name") {
        let key = path.replacen("unimog.0.", "unimog.", 1).replacen("wumpus.0.", "wumpus.", 1);
        let (table, rest) = key.split_once('.').unwrap_or_default();
        // There may be hundreds of further agents.
        let is_further_agent = ["unimog", "wumpus"].contains(&table) && rest.starts_with(|c: char| c.is_ascii_digit());
        let rank = if MAIN_KEYS.split(' ').any(|main| main == key) {
            0
        } else if is_further_agent || !loaded.is_set(&path) || contest.contains(&(path, value.clone())) {
            continue;
        } else if contest.iter().any(|(other, _)| other.split('.').next() == Some(table) && other != table) {
            2
        } else {
            1
        };
        ranked.push((rank, format!("{key}={value}")));
    }
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.into_iter().take(MAX_OUTLINE).map(|(_, line)| line).collect()
}

fn section(title: &str, lines: Vec<String>) -> [Block; 2] {
    [Block::Heading(title.into()), Block::List(lines)]
}

/// Marks a value that is left to its default.
const DEFAULT: char = '*';

/// A value of a scenario.
struct ListedValue {
    path: String,
    value: String,
    is_default: bool,
}

/// All values of a scenario, and the schema that says what they mean.
struct ScenarioValues {
    all: Vec<ListedValue>,
    schema: Json,
}

impl ScenarioValues {
    fn new(loaded: &LoadedScenario) -> Self {
        let values = loaded.values().into_iter().filter(|(_, value)| value != "[]");
        Self {
            all: values.map(|(path, value)| ListedValue { is_default: !loaded.is_set(&path), path, value }).collect(),
            schema: schema().to_value(),
        }
    }

    /// Lists the values of a table but those that are not used, and then what the words among them mean.
    fn of(&self, table: &str, unused: &[&str]) -> Vec<String> {
        let [values, mut meanings] = self.listed(table, unused);
        meanings.splice(..0, (!values.is_empty()).then(|| values.join(", ")));
        meanings
    }

    /// Lists the values of a table and the meanings of words, each as it is printed.
    fn listed(&self, table: &str, unused: &[&str]) -> [Vec<String>; 2] {
        let is_used = |key: &str| !unused.iter().any(|name| key.split('.').next() == Some(name));
        let of_table = self.all.iter().filter_map(|value| {
            let key = value.path.strip_prefix(table)?.strip_prefix('.')?;
            is_used(key).then_some((key, value))
        });
        let mut listed = [Vec::new(), Vec::new()];
        for (key, ListedValue { path, value, is_default }) in of_table {
            listed[0].push(format!("{key}={value}{}", if *is_default { DEFAULT.to_string() } else { String::new() }));
            let meaning = self.meaning(&FieldPath::parse(path), value.trim_matches('"'));
            listed[1].extend(meaning.map(|meaning| format!("{key}={value}: {}", meaning.replace('\n', " "))));
        }
        listed
    }

    /// Returns what the schema says of a word that is chosen from several, if it does.
    fn meaning(&self, path: &FieldPath, word: &str) -> Option<&str> {
        let setting = path.0.iter().try_fold(&self.schema, |table, step| {
            let table = self.resolved(table);
            match step {
                PathStep::Key(key) => table["properties"].get(key).or_else(|| table.get("additionalProperties")),
                PathStep::Index(_) => table.get("items"),
            }
        });
        self.meaning_within(setting?, word)
    }

    fn meaning_within<'a>(&'a self, setting: &'a Json, word: &str) -> Option<&'a str> {
        let setting = self.resolved(setting);
        let choices = ["oneOf", "anyOf"].iter().filter_map(|key| setting[key].as_array()).flatten();
        choices.into_iter().find_map(|choice| {
            if choice["const"] == word { choice["description"].as_str() } else { self.meaning_within(choice, word) }
        })
    }

    /// Returns the definition that a part of the schema refers to, in a table that may be left out too.
    fn resolved<'a>(&'a self, part: &'a Json) -> &'a Json {
        let part = if part["anyOf"][1]["type"] == "null" { &part["anyOf"][0] } else { part };
        let definition = part["$ref"].as_str().and_then(|path| self.schema.pointer(path.trim_start_matches('#')));
        definition.unwrap_or(part)
    }
}

/// Lists the values of the agents of a kind, those that all have once, and what follows from them.
fn describe_agents(agents: &dyn AgentList, loaded: &LoadedScenario, values: &ScenarioValues) -> Vec<String> {
    if agents.len() == 0 {
        return vec!["None.".to_owned()];
    }
    let (kind, copies) = (agents.key(), &loaded.copies);
    let numbers: Vec<usize> = (0..agents.len()).filter(|&number| !copies.is_copy(kind, number)).collect();
    let each: Vec<[Vec<String>; 2]> = numbers
        .iter()
        .map(|&number| {
            let unused = agents.unused(&loaded.scenario, number);
            let [values, meanings] = values.listed(&format!("{kind}.{number}"), &unused);
            [values, [agents.facts(number), meanings].concat()]
        })
        .collect();
    // A fleet of twenty would repeat each line twenty times; with one agent there is nothing to share.
    let is_shared = |part: usize, line: &String| each.len() > 1 && each.iter().all(|agent| agent[part].contains(line));
    let mut lines = Vec::new();
    let mut add = |who: &str, [values, sentences]: [Vec<&String>; 2]| {
        let values = values.into_iter().map(String::as_str).collect::<Vec<_>>().join(", ");
        lines.extend((!values.is_empty()).then(|| format!("{who}: {values}")));
        lines.extend(sentences.into_iter().map(|sentence| format!("{who}: {sentence}")));
    };
    add("all", [0, 1].map(|part| each[0][part].iter().filter(|line| is_shared(part, line)).collect()));
    for (&number, agent) in numbers.iter().zip(&each) {
        add(&number.to_string(), [0, 1].map(|part| agent[part].iter().filter(|line| !is_shared(part, line)).collect()));
        let last = (number + 1..agents.len()).take_while(|&other| copies.is_copy(kind, other)).last();
        // Copies follow their entry, so a range names them.
        if let (Some(last), Some(entry)) = (last, copies.entry(kind, number)) {
            let numbers = if last == number + 1 { last.to_string() } else { format!("{} to {last}", number + 1) };
            let places = if last == number + 1 { "a random place" } else { "random places" };
            let stream = format!("from the stream `starts/{kind}/{entry}`.");
            add(&numbers, [Vec::new(), vec![&format!("like {number}, at {places} {stream}")]]);
        }
    }
    lines
}

/// Names the planners and policies that are not built in and that agents use.
fn describe_programs(scenario: &Scenario) -> Vec<String> {
    let planners = scenario.planner.iter().filter(|(name, _)| scenario.unimog.iter().any(|it| it.planner == **name));
    let policies = scenario.policy.iter().filter(|(name, _)| scenario.has_follower(name));
    let planners = planners.map(|(name, program)| program.describe("planner", name));
    planners.chain(policies.map(|(name, program)| program.describe("policy", name))).collect()
}

fn describe_terrain(scenario: &Scenario, terrain: &Terrain) -> Vec<Block> {
    let bushes = terrain.bushes.len();
    let share = percent(bushes as f64 / terrain.frame.cell_count() as f64);
    let pieces = match &scenario.field.imported {
        Some(_) => String::new(),
        None => format!("{} pieces, ", scenario.field.wanted_pieces()),
    };
    let sentence = format!("{pieces}{bushes} bushes, {share} % of the cells.");
    vec![Block::Text(sentence), Block::Verbatim(draw_sketch(terrain, scenario))]
}

/// Lists the memory that a run needs, part by part, what can be added as it goes on, and whether the limit allows it.
fn list_memory(scenario: &Scenario, limit: MemoryLimit) -> Vec<Block> {
    let estimate = MemoryEstimate::new(scenario);
    let needed = MemoryPart { name: format!("in total; the limit of a run is {limit}"), bytes: estimate.needed() };
    // A part that is tiny beside the others is not worth a line.
    let parts = estimate.parts.iter().filter(|part| part.bytes >= estimate.needed() / 100);
    let terms = Block::Terms(
        parts.chain([&needed]).map(|part| (format!("{:>8}", bytes_text(part.bytes)), part.name.clone())).collect(),
    );
    let sentence = if estimate.meter(limit).is_err() {
        "No run can start: that is more than the limit; --memory sets another."
    } else if estimate.has_trucks {
        "Searches, floods, curves and the timeline need more; they are counted as they grow, and a run that reaches \
         the limit fails."
    } else {
        "The timeline needs more; it is counted as it grows, and a run that reaches the limit fails."
    };
    vec![terms, Block::Text(sentence.to_owned())]
}

/// The indent of the map of a field.
const INDENT: &str = "  ";

/// Draws a map of a field, north above: `.` free, `~` water and what else nobody can cross, `=` ground that does not burn
/// and carries trucks, `#` a bush, `W` and `U` where a Wumpus and a truck start.
///
/// On fields that are too wide a character is a square of cells, and is `#` if any of them is a bush.
fn draw_sketch(terrain: &Terrain, scenario: &Scenario) -> String {
    // A character stands for whole cells, so the map is no wider than a terminal and not distorted.
    let cells_a_character = usize::from(terrain.frame.cols).div_ceil(WIDTH - INDENT.len());
    let side = |cells: u16| usize::from(cells).div_ceil(cells_a_character);
    let mut rows = vec![vec!['.'; side(terrain.frame.cols)]; side(terrain.frame.rows)];
    let mut mark = |cell: Cell, character| {
        rows[usize::from(cell.row) / cells_a_character][usize::from(cell.col) / cells_a_character] = character;
    };
    for &cell in &terrain.blocked {
        mark(cell, '~');
    }
    // Roads on top of water, so that bridges are seen where a character stands for several cells.
    let fuels = terrain.landscape.iter().flat_map(|landscape| landscape.fuel.iter().enumerate());
    for (index, _) in fuels.filter(|(_, fuel)| is_bare(**fuel)) {
        let cell = terrain.frame.cell(index);
        if !terrain.occupied[(cell.row.into(), cell.col.into())] {
            mark(cell, '=');
        }
    }
    for &bush in &terrain.bushes {
        mark(bush, '#');
    }
    // Agents of the first kind are drawn last, on top.
    for start in scenario.kinds().iter().rev().flat_map(|agents| agents.starts()) {
        if let Some(cell) = terrain.frame.cell_at(start.place) {
            mark(cell, start.letter);
        }
    }
    let lines = rows.iter().rev().map(|row| format!("{INDENT}{}\n", row.iter().collect::<String>()));
    let scale = match cells_a_character {
        1 => String::new(),
        n => format!("{INDENT}Each character is {n} x {n} cells.\n"),
    };
    lines.collect::<String>() + &scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BUILT_IN, Field, ImportedField, load};

    fn explained(source: &str, changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        let loaded = LoadedScenario::open(source, &changes).expect("this scenario is right");
        explain(&loaded, MemoryLimit::default()).to_text()
    }

    fn in_one_line(text: &str) -> String {
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn no_line_is_wider_than_eighty_characters() {
        assert_narrow(|name| name != "county");
    }

    #[test]
    #[ignore = "tier 2: what the explanation of county measures takes long"]
    fn no_line_of_county_is_wider_than_eighty_characters() {
        assert_narrow(|name| name == "county");
    }

    fn assert_narrow(is_selected: fn(&str) -> bool) {
        for (name, _) in BUILT_IN.iter().filter(|(name, _)| is_selected(name)) {
            // The places of some lie all over their kilometres.
            let sizes = match *name {
                "landscape" | "brigade" | "initial-attack" => &["2000"][..],
                "county" => &["10000"],
                "duel" => &["1000", "2000"],
                _ => &["250", "1000", "2000"],
            };
            for size in sizes {
                let text = explained(name, &[format!("field.size_m={size}").as_str()]);
                let widest = text.lines().map(|line| line.chars().count()).max();
                assert!(widest <= Some(WIDTH), "{name}: {widest:?}\n{text}");
            }
        }
    }

    fn assert_explained(source: &str, changes: &[&str], expected: &[&str], absent: &[&str]) {
        let text = in_one_line(&explained(source, changes));
        for phrase in expected {
            assert!(text.contains(phrase), "`{phrase}` is not in {text}");
        }
        for phrase in absent {
            assert!(!text.contains(phrase), "`{phrase}` is in {text}");
        }
    }

    #[test]
    fn values_are_listed_with_their_meanings_and_defaults_are_marked() {
        let rules = ["spread_delay_s=9.0,", "spread_from=\"lit\": Only cells lit by a Wumpus", "62 tetrominoes."];
        assert_explained("original-2024", &[], &rules, &[]);
        assert_explained("contest", &[], &["All 121 values are set. Field of seed"], &["*,"]);
        let left = ["dwell_s=5.0*", "prm_rs.max_edge_m=40.0*", "prm_rs.neighbours=7,"];
        assert_explained("smoke", &["unimog.prm_rs.neighbours=7"], &left, &["prm_rs.neighbours=7*"]);
    }

    #[test]
    fn settings_of_other_planners_are_left_out() {
        let walks = ["wumpus.planner=potential", "wumpus.potential.escape=none"];
        let expected = ["potential.escape=\"none\": It gives up the goal.", "prm.samples=500"];
        assert_explained("report-2024", &walks, &expected, &["heuristic=", "prm_rs"]);
        let unused = ["potential", "prm.samples", "lattice.", "safety"];
        assert_explained("contest", &[], &["prm_rs.samples=200", "heuristic=\"octile\": Length of"], &unused);
        let dispatched = ["policy=\"hungarian\": The assignment of free trucks"];
        assert_explained("contest", &["dispatch.policy=hungarian"], &dispatched, &["goal=\"nearest"]);
    }

    #[test]
    fn streams_of_weather_are_described_as_they_are_read() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("station.wxs");
        std::fs::write(&path, "RAWS: 2\n2026 7 14 1200 86 25 0 10 270 0\n2026 7 14 1300 86 25 0 11 271 0\n").unwrap();
        let file = format!("weather.file={}", path.display());
        let wind = "From 0 s: 5.655 m/s at 10 m toward 359 deg";
        let notes = ["It has no RAWS_UNITS; English units are taken", "Its last row, of hour 1, holds to the end"];
        // The run begins half an hour after the last row.
        let changes = ["fire.model=rothermel", file.as_str(), "weather.start_h=1.5", "duration_s=7200"];
        assert_explained("contest", &changes, &[wind, notes[0], notes[1]], &["more changes"]);
    }

    #[test]
    fn what_agents_have_in_common_is_listed_once() {
        let text = in_one_line(&explained("fleet", &["unimog.1.goal=oldest"]));
        assert_eq!((text.matches("speed_mps=8.0").count(), text.matches("goal=\"oldest\"").count()), (1, 2), "{text}");
        assert!(text.contains(" 1: goal=\"oldest\", ") && text.contains("all: cost=\"time\""), "{text}");
    }

    #[test]
    fn speeds_in_turns_are_explained() {
        let fact = "On its circle of 13 m, 10 m/s is 7.7 m/s2 to the side.";
        assert_explained("contest", &["unimog.speed_mps=10"], &[fact], &[]);
        let limited = ["7.7 m/s2 to the side; 3 m/s2 allows 6.2 m/s there.", "turn to 13.0 degrees, in 0.6 s."];
        let changes = ["unimog.speed_mps=10", "unimog.limits.lateral_mps2=3", "unimog.vehicle.steering_rate_deg_s=20"];
        assert_explained("contest", &changes, &limited, &[]);
    }

    #[test]
    fn a_field_that_cannot_be_is_explained_too() {
        let text = explained("smoke", &["field.start_clearance_m=200"]);
        assert!(text.contains("There is none: no placement left for piece 1 of 10"), "{text}");
    }

    fn drawn(map: &str) -> String {
        let wumpus_alone = load("wumpus-alone", &["wumpus.start_m=[2.5, 2.5]".into()]).expect("this scenario is right");
        let imported = ImportedField::parse(map, 5.0).expect("this map is right");
        let scenario = Scenario { field: Field { imported: Some(imported), ..Field::default() }, ..wumpus_alone };
        draw_sketch(&Terrain::from_scenario(&scenario, 1).expect("a given field needs no drawing"), &scenario)
    }

    #[test]
    fn a_map_is_drawn_as_it_was_imported() {
        assert_eq!(drawn("#..\n.##\n..."), "  #..\n  .##\n  W..\n");
    }

    #[test]
    fn a_wide_field_is_drawn_smaller_and_keeps_its_bushes() {
        let wide = format!("{}#\n{}\n", ".".repeat(99), ".".repeat(100));
        let text = drawn(&wide);
        assert_eq!(text.lines().next(), Some(format!("  W{}#", ".".repeat(48)).as_str()));
        assert!(text.contains("2 x 2 cells"));
    }
}
