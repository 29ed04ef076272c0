//! Explains a scenario in plain sentences, for `wildfire check`.

use super::agents::{AgentList, SHOWN_SEED};
use super::dispatch::describe_team;
use super::field::percent;
use super::ground_report::{describe_fires, describe_ground, describe_weather};
use super::landscape::is_bare;
use super::load::LoadedScenario;
use super::rules::describe_ignitions;
use super::warnings::warnings;
use super::{FireModelName, MemoryEstimate, MemoryLimit, MemoryPart, Scenario, Terrain, bytes_text, weather};
use wildfire_base::document::{Block, Document, WIDTH};
use wildfire_base::geometry::Cell;

/// Explains a scenario: its rules and agents in sentences with units, the values left to defaults, the field of seed 1
/// with a map, the memory that a run takes beside its limit, and warnings. No line is wider than a terminal.
pub fn explain(loaded: &LoadedScenario, limit: MemoryLimit) -> Document {
    let scenario = &loaded.scenario;
    let section = |title: &str, lines: Vec<String>| [Block::Heading(title.into()), Block::List(lines)];
    let title = format!("{}: {} s of simulated time at most.", scenario.name, scenario.duration_s);
    let mut document = Document::new(title)
        .with(section("Field", vec![scenario.field.describe()]))
        .with(section("Fire", vec![scenario.fire.describe()]))
        .with(section("Suppression", vec![scenario.suppression.describe()]))
        .with(section("Score", vec![scenario.score.describe()]));
    if scenario.fire.model != FireModelName::Radius {
        document = document.with(section("Weather", describe_weather(scenario)));
    }
    for agents in scenario.kinds() {
        document = document.with(section(agents.title(), describe_agents(agents, loaded)));
    }
    let team = describe_team(scenario);
    if !team.is_empty() {
        document = document.with(section("Dispatch", team));
    }
    if !scenario.ignition.is_empty() {
        document = document.with(section("Ignitions", vec![describe_ignitions(&scenario.ignition)]));
    }
    document = document.with(section("Values", vec![list_defaults(loaded)]));
    let terrain = Terrain::from_scenario(scenario, SHOWN_SEED);
    let field = match &terrain {
        Ok(terrain) => describe_terrain(scenario, terrain),
        Err(error) => vec![Block::Text(format!("There is none: {error}."))],
    };
    document = document.with([Block::Heading(format!("Field of seed {SHOWN_SEED}"))]).with(field);
    if let Ok(terrain) = &terrain
        && terrain.landscape.is_some()
    {
        document = document.with(section("Ground", describe_ground(scenario, terrain)));
        let fires = describe_fires(scenario, terrain, &weather(scenario, SHOWN_SEED));
        if !fires.is_empty() {
            document = document.with(section("Fire on level ground in the first weather", fires));
        }
    }
    document = document.with([Block::Heading("Memory of a run, at most".into())]).with(list_memory(scenario, limit));
    let warnings = warnings(scenario, terrain.as_ref().ok());
    if !warnings.is_empty() {
        document = document.with(section("Warnings", warnings));
    }
    document
}

/// Describes the agents of a kind, those of one entry once.
fn describe_agents(agents: &dyn AgentList, loaded: &LoadedScenario) -> Vec<String> {
    if agents.len() == 0 {
        return vec!["None.".to_owned()];
    }
    let (kind, copies) = (agents.key(), &loaded.copies);
    let mut lines = Vec::new();
    for (number, words) in agents.describe(&loaded.scenario).into_iter().enumerate() {
        if copies.is_copy(kind, number) {
            continue;
        }
        lines.push(format!("{number}: {words}"));
        let last = (number + 1..agents.len()).take_while(|&other| copies.is_copy(kind, other)).last();
        if let (Some(last), Some(entry)) = (last, copies.entry(kind, number)) {
            let numbers = if last == number + 1 { last.to_string() } else { format!("{} to {last}", number + 1) };
            let places = if last == number + 1 { "a place" } else { "places" };
            lines.push(format!("{numbers}: like {number}, at {places} drawn from the stream `starts/{kind}/{entry}`."));
        }
    }
    lines
}

fn list_defaults(loaded: &LoadedScenario) -> String {
    let values = loaded.values().into_iter().filter(|(_, value)| value != "[]");
    let (given, left): (Vec<_>, Vec<_>) = values.partition(|(path, _)| loaded.is_given(path));
    if left.is_empty() {
        return format!("All {} values are given.", given.len());
    }
    let mut listed = Vec::new();
    for (path, value) in &left {
        let is_left = |other: &str| left.iter().any(|(path, _)| path == other);
        let shown = path_of_all_agents(path, &loaded.scenario, is_left).unwrap_or_else(|| path.clone());
        let entry = format!("{shown}={value}");
        if !listed.contains(&entry) {
            listed.push(entry);
        }
    }
    format!("{} values are given, {} left to their defaults: {}.", given.len(), left.len(), listed.join(", "))
}

/// Returns the path without the agent's number, if the same value of every agent of the kind is left to its default.
fn path_of_all_agents(path: &str, scenario: &Scenario, is_left: impl Fn(&str) -> bool) -> Option<String> {
    let (list, rest) = path.split_once('.')?;
    let agents = scenario.kinds().into_iter().find(|agents| agents.key() == list)?.len();
    let (_, field) = rest.split_once('.')?;
    (0..agents).all(|number| is_left(&format!("{list}.{number}.{field}"))).then(|| format!("{list}.{field}"))
}

fn describe_terrain(scenario: &Scenario, terrain: &Terrain) -> Vec<Block> {
    let bushes = terrain.bushes.len();
    let share = percent(bushes as f64 / terrain.frame.cell_count() as f64);
    let pieces = match &scenario.field.given {
        Some(_) => String::new(),
        None => format!("{} pieces, ", scenario.field.wanted_pieces()),
    };
    let sentence = format!("{pieces}{bushes} bushes, {share} % of the cells.");
    vec![Block::Text(sentence), Block::Verbatim(draw_sketch(terrain, scenario))]
}

/// Lists the memory that a run needs, part by part, what can be added as it goes on, and whether the limit allows it.
fn list_memory(scenario: &Scenario, limit: MemoryLimit) -> Vec<Block> {
    let estimate = MemoryEstimate::new(scenario);
    let needed = MemoryPart { name: format!("in all, of {limit} that a run may take"), bytes: estimate.needed() };
    // A part that is tiny beside the others is not worth a line.
    let parts = estimate.parts.iter().filter(|part| part.bytes >= estimate.needed() / 100);
    let term = |part: &MemoryPart| (format!("{:>8}", bytes_text(part.bytes)), part.name.clone());
    let terms = Block::Terms(parts.chain([&needed]).map(term).collect());
    let sentence = if estimate.meter(limit).is_err() {
        "No run takes place: that is more than the limit, and --memory sets another."
    } else if estimate.has_trucks {
        "Searches, floods, curves and the timeline come on top of it; they are counted as they grow, and a run that comes \
         to the limit fails."
    } else {
        "What the timeline holds comes on top of it; that is counted as it grows, and a run that comes to the limit fails."
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
        n => format!("{INDENT}A character stands for {n} x {n} cells.\n"),
    };
    lines.collect::<String>() + &scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{BUILT_IN, Field, GivenField, load};

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

    fn assert_narrow(is_asked_for: fn(&str) -> bool) {
        for (name, _) in BUILT_IN.iter().filter(|(name, _)| is_asked_for(name)) {
            // The places of some lie all over their kilometres.
            let sizes = match *name {
                "landscape" | "brigade" => &["2000"][..],
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

    #[test]
    fn rules_are_explained_with_their_units() {
        let text = in_one_line(&explained("original-2024", &[]));
        for words in [
            "62 tetrominoes of the shapes I, J, Z, T, that fall anywhere",
            "burned for 9 s sets intact ones on fire whose centres are within 30 m; only bushes that were lit",
            "stands 6 s wherever its drive ends puts out one bush",
            "a square of 3 m, 2 m/s (diagonal steps take no longer)",
            "turning radius 12.1 m",
            "it stands 1 s for every expansion",
        ] {
            assert!(text.contains(words), "`{words}` is not in {text}");
        }
    }

    #[test]
    fn costs_of_walks_and_places_are_explained() {
        let changes = ["wumpus.planner=potential", "wumpus.potential.escape=none", "unimog.safety.map=cost"];
        let text = in_one_line(&explained("report-2024", &changes));
        for words in [
            "Gradient descent on a potential field over cell centres: attraction up to 10, repulsion of strength 15",
            "in a local minimum it gives the goal up",
            "a metre costs 1 + 1 times s, s being 0.65 beside a bush, 0.50 at 2 cells from one",
        ] {
            assert!(text.contains(words), "`{words}` is not in {text}");
        }
        let text = in_one_line(&explained("contest", &["wumpus.planner=wavefront", "wumpus.safety.map=brushfire"]));
        assert!(text.contains("exact cost-to-go over cell centres, cost in metres; planning takes"), "{text}");
        assert!(text.contains("1 beside a bush, 1/D at D cells from one"), "{text}");
        assert!(!in_one_line(&explained("contest", &[])).contains("For safety"));
    }

    #[test]
    fn a_truck_is_explained_with_the_planner_that_it_uses() {
        let roadmap = in_one_line(&explained("contest", &["unimog.planner=prm+primitives"]));
        assert!(roadmap.contains("Roadmap of 500 samples") && !roadmap.contains("hybrid A*"), "{roadmap}");
        let curves = in_one_line(&explained("contest", &[]));
        assert!(curves.contains("Roadmap of 200 poses") && curves.contains("by Reeds-Shepp curves"), "{curves}");
        let hybrid = in_one_line(&explained("contest", &["unimog.planner=hybrid-astar", "unimog.hybrid.shortcuts=50"]));
        assert!(hybrid.contains("Hybrid A* with motions of 4 m") && hybrid.contains("then 50 shortcuts"), "{hybrid}");
        assert!(!hybrid.contains("Roadmap of"), "{hybrid}");
        let lattice = in_one_line(&explained("contest", &["unimog.planner=lattice"]));
        assert!(lattice.contains("10 m and 24 headings") && lattice.contains("of 1.25 m and 72 headings"), "{lattice}");
    }

    #[test]
    fn speeds_in_turns_are_explained() {
        let fast = in_one_line(&explained("contest", &["unimog.speed_mps=10"]));
        assert!(fast.contains("On its circle of 13 m, 10 m/s is 7.7 m/s2 to the side. It goes"), "{fast}");
        let limited = in_one_line(&explained("contest", &["unimog.speed_mps=10", "unimog.limits.lateral_mps2=3"]));
        assert!(limited.contains("7.7 m/s2 to the side; 3 m/s2 allows 6.2 m/s there."), "{limited}");
        let slow = in_one_line(&explained("contest", &["unimog.speed_mps=2", "unimog.reverse_speed_mps=1"]));
        assert!(slow.contains("2 m/s is 0.3 m/s2 to the side."), "{slow}");
    }

    #[test]
    fn defaults_are_listed_apart_from_given_values() {
        assert!(in_one_line(&explained("contest", &[])).contains("values are given. Field of seed"));
        let text = in_one_line(&explained("smoke", &["unimog.prm.neighbours=7"]));
        let left = text.split_once("left to their defaults: ").expect("some values are left").1;
        assert!(left.contains("suppression.dwell_s=5"), "{left}");
        assert!(left.contains("unimog.prm.max_edge_m=30"), "{left}");
        assert!(!left.contains("prm.neighbours") && !left.contains("prm.samples"), "{left}");
    }

    #[test]
    fn a_default_that_one_agent_overrules_is_listed_by_agent() {
        let text = in_one_line(&explained("fleet", &["unimog.1.goal=oldest"]));
        assert!(text.contains("unimog.0.goal=") && text.contains("unimog.2.goal="), "{text}");
        assert!(!text.contains("unimog.1.goal=") && text.contains(" unimog.retarget="), "{text}");
    }

    #[test]
    fn a_field_that_cannot_be_is_explained_too() {
        let text = explained("smoke", &["field.start_clearance_m=200"]);
        assert!(text.contains("There is none: no placement left for piece 1 of 10"), "{text}");
    }

    fn drawn(map: &str) -> String {
        let wumpus_alone = load("wumpus-alone", &["wumpus.start_m=[2.5, 2.5]".into()]).expect("this scenario is right");
        let given = GivenField::parse(map, 5.0).expect("this map is right");
        let scenario = Scenario { field: Field { given: Some(given), ..Field::default() }, ..wumpus_alone };
        draw_sketch(&Terrain::from_scenario(&scenario, 1).expect("a given field needs no drawing"), &scenario)
    }

    #[test]
    fn a_map_is_drawn_as_it_was_given() {
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
