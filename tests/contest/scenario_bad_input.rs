//! Bad scenarios are refused with a sentence and the place: file, line and column, or the option at fault.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use wildfire::scenario::{self, ScenarioError};

/// A folder of one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("wildfire-{name}-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).expect("the temporary folder is writable");
        Self(path)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) -> String {
        let path = self.0.join(name);
        fs::write(&path, text).expect("the temporary folder is writable");
        path.display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).expect("the test's own folder can be removed");
    }
}

fn refused(source: &str, changes: &[&str]) -> ScenarioError {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    *scenario::load(source, &changes).expect_err("this scenario is wrong")
}

fn place(error: &ScenarioError) -> String {
    error.location.as_ref().map_or("nowhere".into(), ToString::to_string)
}

/// Asserts that a file is refused at `line:column` with a sentence that holds all the words.
fn assert_refused(text: &str, at: &str, fragments: &[&str]) {
    let folder = Folder::new("case");
    let file = folder.write("case.toml", text);
    let error = refused(&file, &[]);
    assert_eq!(place(&error), format!("{file}:{at}"), "{error}\n{text}");
    for word in fragments {
        assert!(error.to_string().contains(word), "`{word}` is not in: {error}\n{text}");
    }
}

#[test]
fn broken_toml_is_placed() {
    assert_refused("wumpus = []\nunimog = [\n", "2:11", &["not TOML"]);
    assert_refused("wumpus = []\nwumpus = []\n", "2:1", &["not TOML", "duplicate"]);
    assert_refused("wumpus = []\nunimog = []\nname = \"a\n", "3:10", &["not TOML"]);
}

#[test]
fn a_number_of_samples_and_a_density_contradict_each_other_unless_a_change_does_it() {
    for table in ["prm", "prm_rs"] {
        let text = format!("wumpus = []\n[[unimog]]\n[unimog.{table}]\nsamples = 100\nsamples_per_hectare = 80\n");
        let fragment = format!("`unimog.{table}.samples_per_hectare` cannot be combined with `unimog.{table}.samples`");
        assert_refused(&text, "5:1", &[&fragment]);
        let change = |change: &str| {
            scenario::load("contest", &[format!("unimog.{table}.{change}")]).expect("the change holds").unimog.remove(0)
        };
        let (dense, counted) = (change("samples_per_hectare=12.5"), change("samples=77"));
        let settings = |truck: &scenario::Unimog| match table {
            "prm" => (truck.prm.samples, truck.prm.samples_per_hectare),
            _ => (truck.prm_rs.samples, truck.prm_rs.samples_per_hectare),
        };
        assert_eq!((settings(&dense).1, settings(&counted)), (Some(12.5), (77, None)));
    }
    let error = refused("contest", &["unimog.prm.samples=5", "unimog.prm.samples_per_hectare=5"]);
    assert!(error.to_string().contains("each says how many samples there are"), "{error}");
    let error = refused("contest", &["field.size_m=5000", "unimog.prm.samples_per_hectare=9999"]);
    assert!(error.to_string().contains("at most 1e7 samples on the field, which has 2500 hectares"), "{error}");
}

#[test]
fn unknown_fields_are_placed_at_their_key() {
    assert_refused(
        "wumpus = []\nunimog = []\n[fire]\nspread_dely_s = 3",
        "4:1",
        &["unknown field `spread_dely_s` in `fire`"],
    );
    assert_refused("wumpus = []\nunimog = []\n[fier]\nspread_delay_s = 3", "3:2", &["unknown field `fier`"]);
    assert_refused("wumpus = []\n\nunimug = []", "3:1", &["unknown field `unimug`"]);
    assert_refused(
        "wumpus = []\n[[unimog]]\n[[unimog]]\n[unimog.prm]\n sampels = 3",
        "5:2",
        &["unknown field `sampels` in `unimog.1.prm`"],
    );
    assert_refused(
        "wumpus = []\nunimog = []\n[[ignition]]\nat_s = 1\ncell = []",
        "5:1",
        &["unknown field `cell` in `ignition.0`"],
    );
    assert_refused("wumpus = []\nunimog = []\n[field]\ngiven = \"..\"", "4:1", &["unknown field `given` in `field`"]);
}

#[test]
fn advice_names_the_nearest_known_field() {
    let folder = Folder::new("advice");
    for (text, advice) in [
        ("wumpus = []\nunimog = []\n[fire]\nspread_dely_s = 3", "did you mean `spread_delay_s`?"),
        ("wumpus = []\nunimog = []\n[fier]\nspread_delay_s = 3", "did you mean `fire`?"),
        ("wumpus = []\n[[unimog]]\nprm = { sampels = 3 }", "did you mean `samples`?"),
        ("unimog = []\n[[wumpus]]\ngoal = \"nearest\"", "did you mean `nearest-intact`?"),
        ("wumpus = []\nunimog = []\n[field]\nmapp = \"m\"", "did you mean `map`?"),
    ] {
        let error = refused(&folder.write("case.toml", text), &[]);
        let help = error.fault.advice().expect("there is advice");
        assert!(help.contains(advice), "{help}");
        assert!(!help.contains("given"), "{help} names a field that is none of the user's");
    }
}

#[test]
fn missing_fields_are_named() {
    assert_refused("wumpus = []", "1:1", &["missing field `unimog`"]);
    assert_refused("", "1:1", &["missing field `wumpus`"]);
    assert_refused(
        "wumpus = []\nunimog = []\n[[ignition]]\nrandom = 1",
        "3:1",
        &["missing field `at_s` in `ignition.0`"],
    );
    assert_refused(
        "wumpus = []\nunimog = []\n[[ignition]]\nat_s = 1",
        "3:1",
        &["ignition.0", "needs one of `cells`, `points_m`, `perimeter` and `random`"],
    );
    assert_refused(
        "wumpus = []\nunimog = []\n[[ignition]]\nat_s = 1\nrandom = 1\ncells = []",
        "3:1",
        &["ignition.0", "needs one of `cells`, `points_m`, `perimeter` and `random`"],
    );
}

#[test]
fn wrong_types_say_what_is_expected() {
    let unimog = "wumpus = []\n[[unimog]]\n[unimog.prm]\n";
    assert_refused(&format!("{unimog}samples = -3"), "4:11", &["`unimog.prm.samples` is -3", "from 0 to 4294967295"]);
    assert_refused(&format!("{unimog}samples = 1.5"), "4:11", &["is 1.5; expected a whole number"]);
    assert_refused(&format!("{unimog}samples = \"many\""), "4:11", &["the text \"many\"", "whole number"]);
    let wumpus = "unimog = []\n[[wumpus]]\n";
    assert_refused(&format!("{wumpus}start_m = [1, 2, 3]"), "3:11", &["expected a list of two numbers"]);
    assert_refused(&format!("{wumpus}start_m = [1]"), "3:11", &["is a list of 1; expected a list of two numbers"]);
    assert_refused(&format!("{wumpus}start_m = 3"), "3:11", &["is 3; expected a list of two numbers"]);
    assert_refused(&format!("{wumpus}start_m = [1, \"x\"]"), "3:15", &["`wumpus.start_m.1`", "expected a number"]);
    assert_refused(&format!("{wumpus}goal = \"nearest\""), "3:8", &["is `nearest`", "no policy of this name"]);
    assert_refused(&format!("{wumpus}goal = 4"), "3:8", &["expected a string in quotes"]);
    let bare = "wumpus = []\nunimog = []\n";
    assert_refused(&format!("{bare}field = 3"), "3:9", &["`field` is 3; expected a table"]);
    assert_refused(&format!("{bare}name = 3"), "3:8", &["`name` is 3; expected a string in quotes"]);
    assert_refused(&format!("{bare}[fire]\nrelight = 1"), "4:11", &["expected true or false"]);
    assert_refused(&format!("{bare}[fire]\nburn_out_s = true"), "4:14", &["a number or \"none\""]);
    assert_refused(&format!("{bare}[fire]\nburn_out_s = \"never\""), "4:14", &["\"never\"", "a number or \"none\""]);
    assert_refused(&format!("{bare}[field]\nshapes = [\"I\", \"K\"]"), "4:16", &["cannot be `K`"]);
    assert_refused("wumpus = []\n[unimog]\nspeed_mps = 3", "2:1", &["`unimog` is a list", "[[unimog]]"]);
    assert_refused(&format!("{bare}[[ignition]]\nat_s = 1\ncells = [[1, 2], [3]]"), "5:18", &["expected a pair"]);
}

#[test]
fn numbers_that_cannot_be_are_refused() {
    for (table, line, column, fragment) in [
        ("", "duration_s = 0", 14, "`duration_s` is 0; expected a number from 0.001 to 1000000"),
        ("", "duration_s = nan", 14, "`duration_s` is NaN; expected a finite number"),
        ("", "name = \"a\\nb\"", 8, "expected a line"),
        ("field", "size_m = inf", 10, "`field.size_m` is inf; expected a finite number"),
        ("field", "size_m = -250", 10, "`field.size_m` is -250"),
        ("field", "size_m = 0", 10, "`field.size_m` is 0"),
        ("field", "size_m = 252", 10, "whole cells of 5 m"),
        ("field", "size_m = 20485", 10, "1 to 4096 whole cells of 5 m"),
        ("field", "size_m = 1e300", 10, "1 to 4096 whole cells of 5 m"),
        ("field", "cell_m = 0", 10, "`field.cell_m` is 0"),
        ("field", "cell_m = -5", 10, "`field.cell_m` is -5"),
        ("field", "coverage = 0.41", 12, "`field.coverage` is 0.41; expected a number from 0 to 0.4"),
        ("field", "coverage = -0.1", 12, "`field.coverage` is -0.1"),
        ("field", "pieces = 251", 10, "`field.pieces` is 251; expected at most 250"),
        ("field", "shapes = []", 10, "at least one"),
        ("field", "shapes = [\"I\", \"I\"]", 10, "different shapes"),
        ("field", "start_clearance_m = -1", 21, "`field.start_clearance_m` is -1"),
        ("fire", "spread_delay_s = -1", 18, "`fire.spread_delay_s` is -1"),
        ("fire", "spread_radius_m = -30", 19, "`fire.spread_radius_m` is -30"),
        ("fire", "burn_out_s = 0", 14, "`fire.burn_out_s` is 0"),
        ("suppression", "reach_m = -1", 11, "`suppression.reach_m` is -1"),
        ("suppression", "dwell_s = 0", 11, "`suppression.dwell_s` is 0; expected a number from 0.1"),
        ("score", "wumpus_ignited = -inf", 18, "expected a finite number"),
        ("[wumpus]", "start_m = [0.5, 100]", 11, "whole body inside the field"),
        ("[wumpus]", "start_m = [100, 260]", 11, "whole body inside the field of 250 x 250 m"),
        ("[wumpus]", "start_m = [nan, 100]", 12, "`wumpus.start_m.0` is NaN"),
        ("[wumpus]", "size_m = -3", 10, "`wumpus.size_m` is -3"),
        ("[wumpus]", "speed_mps = 0", 13, "`wumpus.speed_mps` is 0"),
        ("[wumpus]", "reach_m = -1", 11, "`wumpus.reach_m` is -1"),
        ("[wumpus]", "heuristic_weight = -1", 20, "`wumpus.heuristic_weight` is -1"),
        ("[wumpus]", "seconds_per_expansion = -1", 25, "`wumpus.seconds_per_expansion` is -1"),
        ("[wumpus]", "potential = { q = 0 }", 19, "`wumpus.potential.q` is 0; expected a number from 0.1"),
        ("[wumpus]", "potential = { eta = -1 }", 21, "`wumpus.potential.eta` is -1"),
        ("[wumpus]", "potential = { zeta = -1 }", 22, "`wumpus.potential.zeta` is -1"),
        ("[wumpus]", "potential = { scale = \"no\" }", 23, "expected a number or \"none\""),
        ("[wumpus]", "potential = { escape = \"climb\" }", 24, "`wumpus.potential.escape` cannot be `climb`"),
        (
            "[wumpus]",
            "potential = { escape = \"none\" }\nlattice_m = 0.15\nspeed_mps = 1000\nplanner = \"potential\"",
            24,
            "expected \"wavefront\" if bushes times the steps of a run exceed 2.5e7, over all Wumpuses",
        ),
        ("[wumpus]", "safety = { map = \"costs\" }", 18, "`wumpus.safety.map` cannot be `costs`"),
        ("[unimog]", "safety = { weight = -1 }", 21, "`unimog.safety.weight` is -1"),
        ("[unimog]", "safety = { max_cost = 0 }", 23, "`unimog.safety.max_cost` is 0"),
        ("[unimog]", "safety = { safety_max = 1001 }", 25, "expected a number from 0 to 1000"),
        ("[unimog]", "safety = { safety_min = 801 }", 25, "expected a number from 0 to 800"),
        ("[unimog]", "safety = { safety_distance = 0 }", 30, "expected a number from 1 to 1000"),
        ("[unimog]", "speed_mps = -8", 13, "`unimog.speed_mps` is -8"),
        ("[unimog]", "reverse_speed_mps = 0", 21, "`unimog.reverse_speed_mps` is 0"),
        ("[unimog]", "start = { x_m = 0.5 }", 9, "whole body inside the field"),
        ("[unimog]", "start = { heading_deg = 400 }", 25, "`unimog.start.heading_deg` is 400"),
        ("[unimog]", "vehicle = { width_m = -2 }", 23, "`unimog.vehicle.width_m` is -2"),
        ("[unimog]", "vehicle = { wheelbase_m = 6 }", 27, "`unimog.vehicle.wheelbase_m` is 6"),
        ("[unimog]", "vehicle = { wheelbase_m = 4 }", 27, "front axle under the body"),
        ("[unimog]", "vehicle = { rear_overhang_m = -1 }", 31, "`unimog.vehicle.rear_overhang_m` is -1"),
        ("[unimog]", "vehicle = { turning_radius_m = 0 }", 32, "`unimog.vehicle.turning_radius_m` is 0"),
        ("[unimog]", "vehicle = { turning_radius_m = 1 }", 32, "outside the body"),
        ("[unimog]", "limits = { braking_mps2 = 0 }", 27, "`unimog.limits.braking_mps2` is 0"),
        ("[unimog]", "prm = { samples = 100001 }", 19, "a number from 0 to 100000"),
        ("[unimog]", "prm = { neighbours = 0 }", 22, "a number from 1 to 100"),
        ("[unimog]", "prm = { max_edge_m = 0 }", 22, "`unimog.prm.max_edge_m` is 0"),
        ("[unimog]", "primitives = { headings = 3 }", 27, "a number from 4 to 360"),
        ("[unimog]", "primitives = { clearance_m = 0 }", 30, "a number from 0.01 to 100"),
        ("[unimog]", "primitives = { max_expansions = 0 }", 33, "`unimog.primitives.max_expansions` is 0"),
        ("[unimog]", "hybrid = { headings = 361 }", 23, "a number from 4 to 360"),
        ("[unimog]", "hybrid = { cusp_cost = -1 }", 24, "`unimog.hybrid.cusp_cost` is -1"),
        ("[unimog]", "hybrid = { shortcuts = 1000001 }", 24, "a number from 0 to 1000000"),
        ("[unimog]", "lattice = { max_expansions = 0 }", 30, "a number from 1 to 100000000"),
        ("[ignition]", "at_s = -1\nrandom = 1", 8, "`ignition.0.at_s` is -1"),
        ("[ignition]", "every_s = 0.5\nrandom = 1\nat_s = 1", 11, "`ignition.0.every_s` is 0.5"),
        ("[ignition]", "random = 0\nat_s = 1", 10, "`ignition.0.random` is 0"),
        ("[ignition]", "cells = [[1, 2], [50, 3]]\nat_s = 1", 18, "`ignition.0.cells.1` is (50, 3)"),
        (
            "[ignition]",
            "cells = [[1, 2], [70000, 3]]\nat_s = 1",
            19,
            "is 70000; expected a whole number from 0 to 65535",
        ),
        ("[ignition]", "cells = [[1, 2], [5, -3]]\nat_s = 1", 22, "`ignition.0.cells.1.1` is -3"),
    ] {
        let lists =
            ["wumpus", "unimog"].map(|list| if table.contains(list) { String::new() } else { format!("{list} = []") });
        let header = if table.is_empty() { String::new() } else { format!("[{table}]") };
        let text = format!("{}\n{}\n{header}\n{line}\n", lists[0], lists[1]);
        assert_refused(&text, &format!("4:{column}"), &[fragment]);
    }
}

#[test]
fn work_without_bounds_is_refused() {
    let text = "wumpus = []\nunimog = []\n[field]\nsize_m = 5000\n[fire]\nspread_radius_m = 5000\n";
    assert_refused(text, "6:19", &["`fire.spread_radius_m` is 5000", "pairs"]);
    let lattice = "unimog = []\n[field]\nsize_m = 5000\n[[wumpus]]\nlattice_m = 0.01\n";
    assert_refused(lattice, "5:13", &["`wumpus.lattice_m` is 0.01", "at most 4e9 points", "it would have 2.50e11"]);
    let huge = "wumpus = []\n[field]\ncell_m = 1000\nsize_m = 1000000\n[[unimog]]\nprimitives = { bin_m = 0.01 }\n";
    assert_refused(huge, "6:24", &["`unimog.primitives.bin_m` is 0.01", "16777216 bins along a side", "100000000"]);
    let endless = "duration_s = 1e6\nwumpus = []\n[fire]\nrelight = true\n[suppression]\ndwell_s = 0.1\n[[unimog]]\n";
    assert_refused(endless, "6:11", &["`suppression.dwell_s` is 0.1", "1e6 stops of all trucks"]);
    let trucks = "[[unimog]]\n".repeat(1001);
    assert_refused(&format!("wumpus = []\n{trucks}"), "2:1", &["`unimog` is 1001; expected at most 1000"]);
    let ignitions = "[[ignition]]\nat_s = 1\nrandom = 1\n".repeat(10_001);
    assert_refused(&format!("wumpus = []\nunimog = []\n{ignitions}"), "3:1", &["`ignition` is 10001"]);
}

#[test]
fn contradictions_are_refused() {
    let bare = "wumpus = []\nunimog = []\n[field]\n";
    assert_refused(
        &format!("{bare}coverage = 0.1\npieces = 3"),
        "5:1",
        &["`field.pieces` cannot be combined with `field.coverage`"],
    );
    for (setting, column) in [
        ("size_m = 250", 1),
        ("coverage = 0.1", 1),
        ("pieces = 3", 1),
        (" shapes = [\"I\"]", 2),
        ("overlaps = \"dropped\"", 1),
        ("start_clearance_m = 0", 1),
    ] {
        let text = format!("{bare}map = \"field.txt\"\n{setting}\n");
        assert_refused(&text, &format!("5:{column}"), &["cannot be combined with `field.map`"]);
    }
}

#[test]
fn changes_that_contradict_each_other_are_refused() {
    let error = refused("contest", &["field.coverage=0.2", "field.pieces=4"]);
    assert!(error.to_string().contains("`field.pieces` cannot be combined with `field.coverage`"), "{error}");
    assert_eq!(place(&error), "--set:1:1");
    let error = refused("contest", &["field.map=field.txt", "field.size_m=100"]);
    assert!(error.to_string().contains("`field.size_m` cannot be combined with `field.map`"), "{error}");
}

#[test]
fn faults_in_maps_are_placed_in_the_map() {
    let folder = Folder::new("map");
    let scenario = folder.write("case.toml", "wumpus = []\nunimog = []\n[field]\nmap = \"field.txt\"\n");
    for (map, at, fragment) in [
        ("", "1:1", "map is empty"),
        ("...\n..\n", "2:1", "this row has 2 cells; expected 3 as in the first row"),
        ("...\n.a.\n", "2:2", "`a` is not a cell"),
        ("{\"n\": 3,\n \"cells_cr\": [[0, 3]]}", "2:21", "[0, 3] lies outside a field of 3 x 3 cells"),
        ("{\"n\": 3,\n \"cells_cr\": [[0, 3}", "2:20", "expected `,` or `]`"),
        ("{\"n\": 5000, \"cells_cr\": []}", "1:1", "expected at most 4096"),
    ] {
        let file = folder.write("field.txt", map);
        let error = refused(&scenario, &[]);
        assert_eq!(place(&error), format!("{file}:{at}"), "{error}");
        assert!(error.to_string().contains(fragment), "{error}");
    }
    let too_wide = folder.write("field.txt", ".".repeat(4097));
    assert_eq!(place(&refused(&scenario, &[])), format!("{too_wide}:1:1"));
}

#[test]
fn an_unreadable_map_is_placed_where_it_is_named() {
    let folder = Folder::new("no-map");
    let scenario = folder.write("case.toml", "wumpus = []\nunimog = []\n[field]\nmap = \"nowhere.txt\"\n");
    let error = refused(&scenario, &[]);
    assert_eq!(place(&error), format!("{scenario}:4:7"));
    assert!(error.to_string().contains("nowhere.txt` cannot be read"), "{error}");
    let error = refused(&scenario, &["field.map=elsewhere.txt"]);
    assert_eq!(place(&error), "--set:1:11");
    assert!(error.to_string().contains("`elsewhere.txt` cannot be read"), "{error}");
}

#[test]
fn files_that_cannot_be_scenarios_are_refused() {
    let folder = Folder::new("files");
    let error = refused(&folder.0.display().to_string(), &[]);
    assert!(error.to_string().contains("it is a folder; expected a file"), "{error}");
    let error = refused(&folder.write("latin.toml", b"# caf\xe9\n"), &[]);
    assert!(error.to_string().contains("byte 5 is not UTF-8"), "{error}");
    let error = refused(&folder.write("huge.toml", vec![b'#'; 350_001]), &[]);
    assert!(error.to_string().contains("too large; expected at most 0.35 MB"), "{error}");
    let map = folder.write("huge.txt", vec![b'#'; 32_000_001]);
    let error = refused("contest", &[&format!("field.map={map}")]);
    assert!(error.to_string().contains("too large; expected at most 32 MB"), "{error}");
}

#[test]
fn an_unknown_name_is_answered_with_the_built_in_ones() {
    let error = refused("contst", &[]);
    assert_eq!(error.to_string(), "there is neither a file nor a built-in scenario `contst`");
    let help = error.fault.advice().expect("there is advice");
    assert!(help.contains("did you mean `contest`?") && help.contains("report-2024"), "{help}");
    let help = refused("some/where/else.toml", &[]).fault.advice().expect("there is advice");
    assert!(!help.contains("did you mean"), "{help}");
}

#[test]
fn a_wrong_change_is_placed_in_the_option() {
    for (source, change, at, fragment) in [
        ("wumpus-alone", "unimog.prm.samples=3", "1:1", "`unimog` is an empty list"),
        ("wumpus-alone", "unimog.0.speed_mps=3", "1:1", "`unimog` has no entry 0: it has 0"),
        ("contest", "fier.x=3", "1:1", "unknown field `fier`"),
        ("contest", "fire.x=3", "1:1", "unknown field `x` in `fire`"),
        ("contest", "fire.burn_out_s=-3", "1:17", "`fire.burn_out_s` is -3"),
        ("contest", "fire.burn_out_s=3 m", "1:17", "the text \"3 m\""),
        ("contest", "fire.burn_out_s", "1:1", "path=value"),
        ("contest", "fire.burn_out_s=99999999999999999999999", "1:17", "is 1e23; expected a number from"),
        ("contest", "fire.burn_out_s=1e400", "1:17", "is inf; expected a finite number"),
        ("contest", "=3", "1:1", "path=value"),
        ("contest", "0.3=3", "1:1", "path=value"),
        ("contest", "duration_s.x=3", "1:1", "`duration_s` is a plain value"),
        ("contest", "fire.0=3", "1:1", "`fire` is a table"),
        ("contest", "unimog=3", "1:8", "`unimog` is 3; expected a list"),
        ("fleet", "unimog.prm.samples=-1", "1:20", "`unimog.0.prm.samples` is -1"),
        ("fleet", "unimog.1.start.x_m=0", "1:1", "`unimog.1.start` is partly or wholly outside"),
        ("fleet", "unimog.3.start.x_m=9", "1:1", "`unimog` has no entry 3: it has 3"),
        ("fleet", "unimog.prm.sampels=4", "1:1", "unknown field `sampels` in `unimog.0.prm`"),
        ("contest", "a.b.c.d.e.f.g.h.i=4", "1:1", "has 9 steps"),
    ] {
        let error = refused(source, &["duration_s=60", change]);
        assert_eq!(place(&error), format!("--set:{at}"), "{change}: {error}");
        assert!(error.to_string().contains(fragment), "{change}: {error}");
    }
}

#[test]
fn the_nearest_by_drive_is_looked_for_among_all_that_burns() {
    for (table, at, fragment) in [
        ("[dispatch]\npolicy = \"nearest-by-drive\"\nidle = \"regions\"\n", "3:8", "`stay` or `centroids`"),
        (
            "[dispatch]\npolicy = \"nearest-by-drive\"\n[sight]\nfield = \"radius\"\n",
            "4:9",
            "`everything` or `burning`",
        ),
    ] {
        let text = format!("{table}[[wumpus]]\n[[unimog]]\n");
        assert_refused(&text, at, &[fragment, "nearest-by-drive"]);
    }
    let text = "[[wumpus]]\n[[unimog]]\ngoal = \"nearest-by-drive\"\nretarget = \"on-event\"\n";
    assert_refused(text, "4:12", &["`never`", "nearest-by-drive"]);
}
