//! Explains a scenario in plain sentences, for `wildfire check`.

use super::explain_agents::{describe_truck, describe_wumpus};
use super::load::LoadedScenario;
use super::sketch::draw_sketch;
use super::warnings::warnings;
use super::{
    Extinguishes, Field, IgnitionCells, MemoryEstimate, MemoryLimit, MemoryPart, Overlaps, Scenario, SpreadFrom,
    Terrain, bytes_text,
};

/// The widest line, in characters.
pub(super) const WIDTH: usize = 80;

/// The seed whose field is shown.
pub(super) const SHOWN_SEED: u64 = 1;

/// Explains a scenario: its rules and agents in sentences with units, the values left to defaults, the field of seed 1
/// with a map, the memory that a run takes beside its limit, and warnings. No line is wider than 80 characters.
pub fn explain(loaded: &LoadedScenario, limit: MemoryLimit) -> String {
    let scenario = &loaded.scenario;
    let mut text = format!("{}: {} s of simulated time at most.\n", scenario.name, scenario.duration_s);
    add_section(&mut text, "Field", [describe_field(&scenario.field)]);
    add_section(&mut text, "Fire", [describe_fire(scenario)]);
    add_section(&mut text, "Suppression", [describe_suppression(scenario)]);
    add_section(&mut text, "Score", [describe_score(scenario)]);
    add_section(&mut text, "Wumpuses", describe_agents(&scenario.wumpus, describe_wumpus));
    add_section(&mut text, "Trucks", describe_agents(&scenario.unimog, describe_truck));
    if !scenario.ignition.is_empty() {
        add_section(&mut text, "Ignitions", [describe_ignitions(scenario)]);
    }
    add_section(&mut text, "Values", [list_defaults(loaded)]);
    let terrain = Terrain::from_scenario(scenario, SHOWN_SEED);
    match &terrain {
        Ok(terrain) => text += &describe_terrain(scenario, terrain),
        Err(error) => add_section(&mut text, "Field of seed 1", [format!("There is none: {error}.")]),
    }
    text += &list_memory(scenario, limit);
    let warnings = warnings(scenario, terrain.as_ref().ok());
    if !warnings.is_empty() {
        add_section(&mut text, "Warnings", warnings);
    }
    text
}

fn add_section(text: &mut String, title: &str, paragraphs: impl IntoIterator<Item = String>) {
    *text += &format!("\n{title}\n");
    for paragraph in paragraphs {
        *text += &wrapped(&paragraph);
    }
}

/// Wraps a paragraph: its first line is indented by two spaces, further lines by four.
fn wrapped(paragraph: &str) -> String {
    let (mut text, mut line) = (String::new(), String::from(" "));
    for word in paragraph.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > WIDTH && line.trim() != "" {
            text += &format!("{line}\n");
            line = "   ".into();
        }
        line += " ";
        line += word;
    }
    text + &line + "\n"
}

fn describe_field(field: &Field) -> String {
    let frame = field.frame();
    let size = format!(
        "{} x {} m, {} x {} cells of {} m.",
        frame.width_m(),
        frame.height_m(),
        frame.cols,
        frame.rows,
        frame.cell_m
    );
    if let Some(map) = &field.map {
        return format!("{size} The bushes are those of the map {}, the same for every seed.", map.display());
    }
    let shapes: Vec<String> = field.shapes.iter().map(|shape| format!("{shape:?}")).collect();
    let overlaps = match field.overlaps {
        Overlaps::Never => "that never overlap",
        Overlaps::Dropped => "that fall anywhere, cells covered twice counting once",
    };
    let limit = match field.pieces {
        Some(_) => String::new(),
        None => format!(" (the most within {} % of the cells)", percent(field.coverage)),
    };
    format!(
        "{size} {} tetrominoes{limit} of the shapes {}, {overlaps}. No bush within {} m of where an agent's body \
         starts.",
        field.wanted_pieces(),
        shapes.join(", "),
        field.start_clearance_m
    )
}

fn describe_fire(scenario: &Scenario) -> String {
    let fire = &scenario.fire;
    let spread = match fire.spread_from {
        SpreadFrom::None => "Fire does not spread.".into(),
        from => format!(
            "A bush that has burned for {} s sets intact ones on fire whose centres are within {} m; {}.",
            fire.spread_delay_s,
            fire.spread_radius_m,
            if from == SpreadFrom::All { "every burning bush does so" } else { "only bushes that were lit do so" }
        ),
    };
    let end =
        fire.burn_out_s.map_or("It burns until it is put out.".into(), |s| format!("A bush burns out after {s} s."));
    let again =
        if fire.relight { "An extinguished bush can burn again." } else { "An extinguished bush is safe for good." };
    format!("{spread} {end} {again}")
}

fn describe_suppression(scenario: &Scenario) -> String {
    let rule = &scenario.suppression;
    let reach = rule.reach_m.map_or("wherever its drive ends".into(), |m| {
        format!("with its body's centre within {m} m of the bush's centre")
    });
    let effect = match rule.extinguishes {
        Extinguishes::One => "one bush",
        Extinguishes::AllInReach => "all that burns in reach",
    };
    format!("A truck that stands {} s {reach} puts out {effect}.", rule.dwell_s)
}

fn describe_score(scenario: &Scenario) -> String {
    let score = &scenario.score;
    format!(
        "Wumpuses: {} for a bush that catches fire, {} for one that burns out. Trucks: {} for one put out.",
        score.wumpus_ignited, score.wumpus_burned_out, score.truck_extinguished
    )
}

fn describe_agents<A>(agents: &[A], describe: impl Fn(&A) -> String) -> Vec<String> {
    if agents.is_empty() {
        return vec!["None.".into()];
    }
    agents.iter().enumerate().map(|(number, agent)| format!("{number}: {}", describe(agent))).collect()
}

fn describe_ignitions(scenario: &Scenario) -> String {
    let (mut random, mut named) = (0_u64, 0);
    for ignition in &scenario.ignition {
        match &ignition.cells {
            IgnitionCells::Random(count) => random += u64::from(*count),
            IgnitionCells::Cells(cells) => named += cells.len(),
        }
    }
    let times = scenario.ignition.iter().map(|ignition| ignition.at_s);
    let (first, last) = (times.clone().fold(f64::INFINITY, f64::min), times.fold(0.0, f64::max));
    let count = scenario.ignition.len();
    format!("{count} from {first} s to {last} s: {random} random bushes and {named} named cells.")
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
    let agents = match list {
        "wumpus" => scenario.wumpus.len(),
        "unimog" => scenario.unimog.len(),
        _ => return None,
    };
    let (_, field) = rest.split_once('.')?;
    (0..agents).all(|number| is_left(&format!("{list}.{number}.{field}"))).then(|| format!("{list}.{field}"))
}

fn describe_terrain(scenario: &Scenario, terrain: &Terrain) -> String {
    let bushes = terrain.bushes.len();
    let share = percent(bushes as f64 / terrain.frame.cell_count() as f64);
    let pieces = match &scenario.field.given {
        Some(_) => String::new(),
        None => format!("{} pieces, ", scenario.field.wanted_pieces()),
    };
    let drawing = draw_sketch(terrain, scenario);
    format!("\nField of seed {SHOWN_SEED}\n  {pieces}{bushes} bushes, {share} % of the cells.\n{drawing}")
}

/// Lists the memory that a run needs, part by part, what can be added as it goes on, and whether the limit allows it.
fn list_memory(scenario: &Scenario, limit: MemoryLimit) -> String {
    let estimate = MemoryEstimate::new(scenario);
    let needed = MemoryPart { name: format!("in all, of {limit} that a run may take"), bytes: estimate.needed() };
    // A part that is tiny beside the others is not worth a line.
    let parts = estimate.parts.iter().filter(|part| part.bytes >= estimate.needed() / 100);
    let line = |part: &MemoryPart| format!("  {:>8}  {}\n", bytes_text(part.bytes), part.name);
    let lines: String = parts.chain([&needed]).map(line).collect();
    let mut text = format!("\nMemory of a run, at most\n{lines}");
    if estimate.meter(limit).is_err() {
        return text + &wrapped("No run takes place: that is more than the limit, and --memory sets another.");
    }
    let grown = match estimate.grows {
        0 => "What the timeline holds comes on top of it".into(),
        grows => {
            let most = bytes_text(grows);
            format!(
                "Searches, floods and curves can add up to {most} where drives are hard, and the timeline what it holds"
            )
        }
    };
    text += &wrapped(&format!("{grown}; that is counted as it grows, and a run that comes to the limit fails."));
    text
}

/// Converts a share to percent, rounded to hundredths.
fn percent(share: f64) -> f64 {
    (share * 1e4).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::BUILT_IN;

    fn explained(source: &str, changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        explain(&LoadedScenario::open(source, &changes).expect("this scenario is right"), MemoryLimit::default())
    }

    fn in_one_line(text: &str) -> String {
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn no_line_is_wider_than_eighty_characters() {
        for (name, _) in BUILT_IN {
            for size in ["250", "1000", "2000"] {
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
}
