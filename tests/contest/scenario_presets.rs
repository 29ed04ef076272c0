//! The built-in scenarios, and scenarios as files: what loads is what was written.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use wildfire::scenario::{self, BUILT_IN, LoadedScenario, MemoryLimit, Scenario, SpreadFrom, Terrain};
use wildfire::sim;
use wildfire::timeline::Outcome;

use crate::reference::both;

fn built_in(name: &str) -> Scenario {
    changed(name, &[])
}

fn changed(name: &str, changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    scenario::load(name, &changes).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn every_built_in_scenario_loads_under_its_name_and_says_what_it_is_for() {
    for (name, text) in BUILT_IN {
        assert_eq!(&built_in(name).name, name);
        assert!(text.starts_with("# "), "{name} opens with a comment");
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{name} has long lines");
    }
}

#[test]
fn every_scenario_file_is_built_in() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    for entry in fs::read_dir(folder).expect("the scenarios folder is there") {
        let path = entry.expect("the scenarios folder can be read").path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let stem = path.file_stem().expect("a file has a name").to_string_lossy().into_owned();
            assert!(BUILT_IN.iter().any(|(name, _)| *name == stem), "{stem} is not built in");
        }
    }
}

#[test]
fn the_documentation_of_the_format_names_every_field_with_its_default() {
    let sections: Vec<&str> = include_str!("../../scenarios/README.md").split("\n## ").collect();
    for (path, default) in LoadedScenario::open("contest-1", &[]).expect("contest-1 loads").values() {
        let steps: Vec<&str> = path.split('.').filter(|step| step.parse::<u32>().is_err()).collect();
        let (header, field) = match steps.split_first().expect("a path has steps") {
            (top, []) => ("Top level", (*top).to_owned()),
            (_, rest @ ["safety", ..]) => ("Safety costs", rest.join(".")),
            (table, rest) => (*table, rest.join(".")),
        };
        let in_section = |section: &&&str| section.trim_start_matches('[').starts_with(header);
        let section = sections.iter().find(in_section).unwrap_or_else(|| panic!("no section for {path}"));
        let row = section.lines().find(|line| line.starts_with(&format!("| `{field}` |")));
        let row = row.unwrap_or_else(|| panic!("no row for {path}"));
        let shown = default.trim_matches('"').trim_end_matches(".0").to_owned();
        assert!(path == "name" || row.contains(&format!("| {shown} |")), "{path} is {default} by default: {row}");
    }
}

#[test]
fn both_contests_spell_out_every_value_and_those_of_the_first_are_the_defaults() {
    let [contest, first] = ["contest", "contest-1"].map(|name| LoadedScenario::open(name, &[]).expect("it loads"));
    for loaded in [&contest, &first] {
        let unsaid: Vec<_> = loaded.values().into_iter().filter(|(path, _)| !loaded.is_set(path)).collect();
        assert_eq!(unsaid, [("ignition".to_owned(), "[]".to_owned())]);
    }
    let defaults = Scenario { name: "contest-1".into(), ..Scenario::default() };
    assert_eq!(first.scenario, defaults);
}

/// Each line that differs says what the first contest has.
#[test]
fn contest_names_what_it_does_not_share_with_the_first() {
    let values = |name| LoadedScenario::open(name, &[]).expect("it loads").values();
    let said = include_str!("../../scenarios/contest.toml").lines().filter(|line| line.contains("# contest-1: ")).map(
        |line| {
            let (value, first) = line.split_once('#').expect("it has a comment");
            let (key, value) = value.split_once('=').expect("it is a value");
            [key, value, first.trim_start_matches(" contest-1:")].map(|text| text.trim().trim_matches('"').to_owned())
        },
    );
    let both = values("contest").into_iter().zip(values("contest-1"));
    let differ = both.filter(|(new, old)| new != old && new.0 != "name").map(|((path, new), (_, old))| {
        let key = path.rsplit('.').next().expect("a path has steps").to_owned();
        [key, new.trim_matches('"').to_owned(), old.trim_matches('"').to_owned()]
    });
    assert_eq!(said.collect::<BTreeSet<_>>(), differ.collect::<BTreeSet<_>>());
}

/// Outcomes of the first contest are those that were published, so they never change.
#[test]
fn the_first_contest_is_played_as_ever() {
    let played = [
        ("prm-rs", (175, 5256.438910195298)),
        ("hybrid-astar", (179, 4961.827929032016)),
        ("prm+primitives", (171, 5262.700976748915)),
    ];
    for (planner, published) in played {
        let scenario = changed("contest-1", &[&format!("unimog.planner={planner}")]);
        let outcome = Outcome::new(&sim::run(&scenario, 7).expect("it runs").timeline);
        let truck = outcome.agents.iter().find(|agent| agent.agent.role.suppresses()).expect("there is a truck");
        assert_eq!((outcome.extinguished, truck.distance_m), published, "{planner}");
    }
}

#[test]
fn presets_differ_from_the_first_contest_only_in_what_they_are_for() {
    let contest = built_in("contest-1");
    let from_contest = |changes: &[&str], name: &str| {
        let mut scenario = changed("contest-1", changes);
        scenario.name = name.into();
        scenario
    };
    let places = "unimog.planner=prm+primitives";
    assert_eq!(built_in("report-2024"), from_contest(&[places, "fire.burn_out_s=none"], "report-2024"));
    assert_eq!(built_in("dense"), from_contest(&["field.coverage=0.2"], "dense"));
    let arena = [
        "field.coverage=0.15",
        "fire.burn_out_s=40",
        "unimog.limits={ acceleration_mps2 = 1.5, braking_mps2 = 3.0, lateral_mps2 = 3.0 }",
        "unimog.rescue=false",
        "unimog.seconds_per_expansion=0.0005",
        "unimog.prm.seconds_per_expansion=0.0005",
        "unimog.primitives.seconds_per_expansion=0.0005",
        "unimog.prm_rs.seconds_per_expansion=0.0005",
        "unimog.hybrid.seconds_per_expansion=0.0005",
        "unimog.lattice.seconds_per_expansion=0.0005",
    ];
    assert_eq!(built_in("arena"), from_contest(&arena, "arena"));
    assert_eq!(built_in("wumpus-alone"), from_contest(&["unimog=[]"], "wumpus-alone"));
    let cautious = [places, "unimog.safety.map=cost", "unimog.safety.weight=4"];
    assert_eq!(built_in("cautious"), from_contest(&cautious, "cautious"));
    let stuck = ["unimog=[]", "wumpus.planner=potential", "wumpus.potential.escape=none"];
    assert_eq!(built_in("local-minima"), from_contest(&stuck, "local-minima"));
    let coursework = [
        places,
        "fire.spread_from=all",
        "fire.burn_out_s=30",
        "suppression.extinguishes=all-in-reach",
        "unimog.speed_mps=10",
        "unimog.reverse_speed_mps=10",
    ];
    assert_eq!(built_in("coursework-2025"), from_contest(&coursework, "coursework-2025"));
    let fleet = built_in("fleet");
    assert_eq!((fleet.wumpus.len(), fleet.unimog.len()), (2, 3));
    assert!(fleet.unimog.iter().all(|truck| truck.limits.acceleration_mps2.is_some()));
    assert_eq!((&fleet.fire, &fleet.field), (&contest.fire, &contest.field));
}

#[test]
fn the_original_keeps_its_own_rules() {
    let original = built_in("original-2024");
    assert_eq!(original.field.wanted_pieces(), 62);
    assert_eq!((original.fire.spread_delay_s, original.fire.burn_out_s), (9.0, None));
    assert_eq!(original.fire.spread_from, SpreadFrom::Ignited);
    assert_eq!((original.suppression.reach_m, original.suppression.dwell_s), (None, 6.0));
    let truck = &original.unimog[0];
    let charged = [truck.prm.seconds_per_expansion, truck.primitives.seconds_per_expansion];
    assert_eq!((charged, original.wumpus[0].seconds_per_expansion), ([1.0, 1.0], 1.0));
    assert_eq!(truck.vehicle.turning_radius_m, 12.1);
}

#[test]
fn resolved_scenarios_survive_toml_and_json() {
    for (name, _) in BUILT_IN {
        let scenario = built_in(name);
        let json = serde_json::to_string(&scenario).expect("a scenario can be written as JSON");
        assert_eq!(serde_json::from_str::<Scenario>(&json).expect("and read"), scenario, "{name}");
        let toml = toml::to_string(&scenario).expect("a scenario can be written as TOML");
        assert_eq!(toml::from_str::<Scenario>(&toml).expect("and read"), scenario, "{name}\n{toml}");
    }
}

#[test]
fn numbers_survive_json_to_the_last_bit() {
    let mut scenario = built_in("smoke");
    for k in 1..1000 {
        scenario.duration_s = 250.0 * f64::from(k) / 7919.0;
        let json = serde_json::to_string(&scenario).expect("a scenario can be written as JSON");
        assert_eq!(serde_json::from_str::<Scenario>(&json).expect("and read"), scenario);
    }
}

#[test]
fn a_resolved_scenario_with_a_map_needs_the_file_no_longer() {
    let folder = std::env::temp_dir().join(format!("wildfire-resolved-{}", std::process::id()));
    fs::create_dir_all(folder.join("maps")).expect("the temporary folder is writable");
    let file = folder.join("mine.toml");
    fs::write(&file, "wumpus = []\nunimog = []\n[field]\nmap = \"maps/field.txt\"\ncell_m = 4\n").unwrap();
    fs::write(folder.join("maps/field.txt"), "#...\n....\n...#\n").unwrap();
    let scenario = built_in(&file.display().to_string());
    let json = serde_json::to_string(&scenario).expect("a scenario can be written as JSON");
    fs::remove_dir_all(&folder).expect("the test's own folder can be removed");

    let read: Scenario = serde_json::from_str(&json).expect("and read");
    assert_eq!(read, scenario);
    assert_eq!((read.name.as_str(), read.field.size_m, read.field.coverage), ("mine", 16.0, 2.0 / 12.0));
    let terrain = Terrain::from_scenario(&read, 9).expect("a given field needs no drawing");
    assert_eq!(terrain.bushes.iter().map(|b| (b.col, b.row)).collect::<Vec<_>>(), [(3, 0), (0, 2)]);
}

#[test]
fn changes_reach_one_agent_or_all() {
    let samples = |changes: &[&str]| -> Vec<u32> {
        changed("fleet", changes).unimog.iter().map(|truck| truck.prm.samples).collect()
    };
    assert_eq!(samples(&["unimog.prm.samples=1000"]), [1000, 1000, 1000]);
    assert_eq!(samples(&["unimog.1.prm.samples=1000"]), [500, 1000, 500]);
    assert_eq!(samples(&["unimog.prm.samples=9", " unimog.2.prm.samples = 7 "]), [9, 9, 7]);
    assert_eq!(samples(&["unimog=[{ prm = { samples = 3 } }]"]), [3]);
}

#[test]
fn a_change_overrules_what_the_file_says_by_other_means() {
    assert_eq!(changed("contest", &["field.pieces=30"]).field.wanted_pieces(), 30);
    assert_eq!(changed("original-2024", &["field.coverage=0.04"]).field.wanted_pieces(), 25);
    let file = std::env::temp_dir().join(format!("wildfire-change-{}.txt", std::process::id()));
    fs::write(&file, "...................#\n".repeat(20)).expect("the temporary folder is writable");
    let map = format!("field.map={}", file.display());
    let smoke = LoadedScenario::open("smoke", &["wumpus.start_m=[50, 50]".into(), map]);
    fs::remove_file(&file).expect("the test's own file can be removed");
    let smoke = smoke.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((smoke.scenario.field.coverage, smoke.scenario.field.size_m), (0.05, 100.0));
    assert!(!smoke.is_set("field.coverage"));
    let text = scenario::explain(&smoke, MemoryLimit::default()).to_text();
    assert!(text.contains("20 bushes, 5 % of the cells") && !text.contains("field.given"), "{text}");
}

#[test]
fn changes_read_numbers_words_and_lists() {
    let scenario = changed(
        "contest",
        &[
            "name=a name with blanks",
            "fire.burn_out_s=none",
            "fire.spread_from=\"all\"",
            "fire.relight=true",
            "wumpus.start_m=[100, 120.5]",
            "duration_s=6e2",
        ],
    );
    assert_eq!(scenario.name, "a name with blanks");
    assert_eq!((scenario.fire.burn_out_s, scenario.fire.spread_from), (None, SpreadFrom::All));
    assert!(scenario.fire.relight);
    assert_eq!((scenario.wumpus[0].start_m, scenario.duration_s), ([100.0, 120.5], 600.0));
}

#[test]
fn reference_fields_are_read_as_they_are_listed() {
    let files =
        both("plan").flat_map(|folder| (0..5).map(move |number| folder.join(format!("field_{number:02}.json"))));
    for file in files.filter(|file| file.exists()) {
        let scenario = changed("wumpus-alone", &[&format!("field.map={}", file.display())]);
        let terrain = Terrain::from_scenario(&scenario, 1).expect("a given field needs no drawing");
        let text = fs::read_to_string(&file).expect("the reference can be read");
        let json: serde_json::Value = serde_json::from_str(&text).expect("the reference is JSON");
        let listed: Vec<(u16, u16)> = serde_json::from_value(json["cells_cr"].clone()).expect("it lists cells");
        let mut by_index: Vec<_> = listed.iter().map(|&(col, row)| (row, col)).collect();
        by_index.sort_unstable();
        by_index.dedup();
        assert_eq!(terrain.bushes.iter().map(|bush| (bush.row, bush.col)).collect::<Vec<_>>(), by_index);
    }
}

#[test]
fn trucks_do_not_change_the_landscape_or_where_lightning_strikes() {
    let fleet = built_in("landscape");
    let nobody = changed("landscape", &["unimog=[]"]);
    assert!(!fleet.unimog.is_empty() && nobody.unimog.is_empty());
    let first = Terrain::from_scenario(&fleet, 1).expect("there is room");
    for seed in 1..6 {
        assert_eq!(Terrain::from_scenario(&fleet, seed).expect("there is room"), first, "seed {seed}");
        assert_eq!(Terrain::from_scenario(&nobody, seed).expect("there is room"), first, "seed {seed}, nobody");
        assert_eq!(scenario::weather(&fleet, seed), scenario::weather(&nobody, seed));
    }
    assert_ne!(scenario::weather(&fleet, 1), scenario::weather(&fleet, 2));
}
