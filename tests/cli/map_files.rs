//! `wildfire map`: the files that it was asked for appear, and are what they are called.

use std::fs;
use std::path::Path;

use crate::children::output_of;
use crate::story::Story;

const COMPUTATIONS: [&str; 8] = [
    "occupancy",
    "brushfire",
    "cost",
    "wavefront --goal 2,5 --start 2,1",
    "attraction --goal 2,5",
    "repulsion --true-distance",
    "total --goal 2,5",
    "descend --goal 2,5 --start 2,1 --escape wavefront",
];

fn story() -> Story {
    let story = Story::begin();
    story.file("map.txt", "000000\n011100\n000100\n011100\n");
    story.file("open.txt", "00\n00\n");
    story
}

#[test]
fn every_command_writes_every_file() {
    let story = story();
    for map in ["map.txt", "open.txt --remove-edges 0"] {
        for computation in COMPUTATIONS.iter().filter(|computation| map == "map.txt" || !computation.contains("goal")) {
            let arguments = format!(
                "map {computation} {map} --csv v.csv --npy v.npy --png v.png --overlay o.png --surface s.png --colormap jet"
            );
            let answer = story.tell(&arguments.split_whitespace().collect::<Vec<_>>()).expect_code(0);
            for name in ["v.csv", "v.npy", "v.png", "o.png", "s.png"] {
                assert!(answer.stderr.contains(&format!("wrote {name}\n")), "{}", answer.stderr);
            }
            let bytes = |name: &str| fs::read(story.path(name)).expect("it was written");
            assert!(bytes("v.npy").starts_with(b"\x93NUMPY"), "{computation}");
            for name in ["v.png", "o.png", "s.png"] {
                let picture = image::load_from_memory(&bytes(name)).expect("a picture");
                assert!(picture.width() > 100 && picture.height() > 100, "{computation}: {name}");
            }
            assert!(!story.read("v.csv").contains(' '), "{computation}");
        }
    }
}

#[test]
fn quiet_leaves_the_result_and_takes_the_notes() {
    let story = story();
    let answer = story.tell(&["--quiet", "map", "brushfire", "open.txt", "--csv", "v.csv"]).expect_code(0);
    assert!(answer.stderr.is_empty(), "{}", answer.stderr);
    assert!(answer.stdout.contains("No obstacle"), "{}", answer.stdout);
}

#[test]
fn same_command_writes_the_same_bytes() {
    let story = story();
    let draw = |name: &str| {
        let arguments = ["map", "wavefront", "map.txt", "--goal", "2,5", "--start", "2,1", "--png", name];
        story.tell(&arguments).expect_code(0);
        fs::read(story.path(name)).expect("it was written")
    };
    assert!(draw("one.png") == draw("two.png"), "the pictures differ");
}

#[test]
fn colours_change_the_picture_and_nothing_else() {
    let story = story();
    let draw = |colours: &str| {
        let arguments = ["map", "brushfire", "map.txt", "--png", "a.png", "--csv", "a.csv", "--colormap", colours];
        story.tell(&arguments).expect_code(0);
        (fs::read(story.path("a.png")).expect("it was written"), story.read("a.csv"))
    };
    let (viridis, jet) = (draw("viridis"), draw("jet"));
    assert!(viridis.0 != jet.0 && viridis.1 == jet.1);
}

/// A grey image in which walls are a little lighter than the default tolerance.
fn grey_walls(story: &Story) {
    story.file("walls.pgm", "P2 4 3 255\n90 90 90 90\n90 220 220 90\n90 90 90 90\n");
}

#[test]
fn tolerance_is_selected_and_reported() {
    let story = story();
    grey_walls(&story);
    let object = |options: &[&str]| -> serde_json::Value {
        let args = [&["map", "occupancy", "walls.pgm", "--json"], options].concat();
        serde_json::from_str(&story.tell(&args).expect_code(0).stdout).expect("JSON")
    };
    assert_eq!((&object(&[])["occupied"], &object(&[])["tolerance"]), (&0.into(), &50.into()));
    let auto = object(&["--tolerance", "auto"]);
    assert_eq!((&auto["occupied"], &auto["tolerance"]), (&10.into(), &154.into()));
    assert!(auto["notes"].to_string().contains("walls.pgm: the tolerance is 154, by Otsu's method."), "{auto}");
    let negative = object(&["--invert", "--tolerance", "auto"]);
    assert_eq!(negative["occupied"], 2);
    let doubts = story.tell(&["map", "occupancy", "walls.pgm", "--tolerance", "95"]).expect_code(0).stdout;
    let text = doubts.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("--tolerance auto picks one"), "{text}");
    assert!(text.contains("--invert takes light pixels instead"), "{text}");
}

#[test]
fn maps_are_resized_without_losing_walls() {
    let story = story();
    let csv = |size: &str| {
        story.tell(&["map", "occupancy", "map.txt", "--resize", size, "--csv", "v.csv"]).expect_code(0);
        story.read("v.csv")
    };
    assert_eq!(csv("3x2"), "1,1,0\n1,1,0\n");
    assert_eq!(csv("6x4"), "0,0,0,0,0,0\n0,1,1,1,0,0\n0,0,0,1,0,0\n0,1,1,1,0,0\n");
    assert_eq!(csv("1x1"), "1\n");
    let refusal = story.tell(&["map", "occupancy", "map.txt", "--resize", "0x3"]).expect_code(2);
    assert!(refusal.stderr.contains("COLSxROWS"), "{}", refusal.stderr);
}

#[test]
fn what_occupancy_writes_is_a_map_again() {
    let story = story();
    let args = ["map", "occupancy", "map.txt", "--csv", "v.csv", "--npy", "v.npy"];
    story.tell(&args).expect_code(0);
    let first = story.read("v.csv");
    for map in ["v.csv", "v.npy"] {
        story.tell(&["map", "occupancy", map, "--csv", "again.csv"]).expect_code(0);
        assert_eq!(story.read("again.csv"), first, "{map}");
    }
}

#[test]
fn a_scenario_is_begun_with_a_map_and_runs() {
    let story = story();
    fs::create_dir(story.path("maps")).expect("writable");
    story.file("maps/hall.txt", &format!("{}\n", ["..........##.............."; 20].join("\n")));
    story.tell(&["new", "scenario", "--from-map", "maps/hall.txt", "hall.toml", "--cell-m", "4"]).expect_code(0);
    let text = story.read("hall.toml");
    assert!(text.contains("map = \"maps/hall.txt\"\ncell_m = 4.0\n"), "{text}");
    assert!(text.contains("26 x 20 cells of 4 m, 104 x 80 m, 40 bushes (7.7 % of the cells)"), "{text}");
    story.tell(&["run", "hall.toml", "--seed", "1", "--set", "duration_s=60"]).expect_code(0);

    story.file("maps/plan.pgm", "P2 3 2 255\n0 255 90\n255 255 255\n");
    let printed =
        story.tell(&["new", "scenario", "--from-map", "maps/plan.pgm", "--cell-m", "40", "--tolerance", "auto"]);
    let printed = printed.expect_code(0).stdout;
    assert!(printed.contains("map_tolerance = \"auto\"") && printed.contains("2 bushes"), "{printed}");
    let missing = story.tell(&["new", "scenario", "--from-map", "nowhere.png", "other.toml"]).expect_code(2);
    assert!(missing.stderr.contains("nowhere.png") && !story.path("other.toml").exists(), "{}", missing.stderr);
    let plan = story.tell(&["new", "plan", "--from-map", "maps/hall.txt"]).expect_code(2);
    assert!(plan.stderr.contains("--from-map applies only to a scenario"), "{}", plan.stderr);
}

#[test]
fn what_there_is_to_say_of_a_map_is_said_of_a_scenario_and_a_page() {
    let story = story();
    // Light walls on white.
    let rows = (0..20).map(|row| if row == 9 { "76 ".repeat(30) } else { "255 ".repeat(30) });
    story.file("light.pgm", &format!("P2 30 20 255\n{}", rows.collect::<String>()));
    let doubt = "light.pgm: With --tolerance auto, 165, 5.0 % of the cells would be occupied instead of 0.0 %.";
    let created = story.tell(&["new", "scenario", "--from-map", "light.pgm", "light.toml"]).expect_code(0);
    assert!(created.stderr.contains(doubt), "{}", created.stderr);
    assert!(created.stderr.contains("Nothing can burn: the field has no bushes."), "{}", created.stderr);
    let args = ["map", "report", "light.pgm", "--goal", "0,0", "--start", "2,2", "--out", "lab"];
    let page = story.tell(&args).expect_code(0);
    assert!(page.stderr.contains(doubt), "{}", page.stderr);
    let quiet = story.tell(&[&["--quiet"][..], &args].concat()).expect_code(0);
    assert!(quiet.stderr.is_empty(), "{}", quiet.stderr);
    let refusal = story.tell(&[&args[..8], &["-"][..]].concat()).expect_code(2);
    assert!(refusal.stderr.contains("expected a folder"), "{}", refusal.stderr);

    story.file("table.csv", &"0,0,0,0,0,0,0,0,0,0,0,1\n".repeat(12));
    let created = story.tell(&["new", "scenario", "--from-map", "table.csv", "--tolerance", "9", "--cell-m", "10"]);
    let created = created.expect_code(0);
    assert!(created.stderr.contains("--tolerance has no effect: the map is not an image."), "{}", created.stderr);
    assert!(!created.stderr.contains("Nothing can burn"), "{}", created.stderr);
}

#[test]
fn what_a_scenario_leaves_out_of_its_map_is_named_by_check_run_and_batch() {
    let story = story();
    // Black walls and red ones, whose grey value is 76: twice as many.
    let rows = (0..20).map(|row| match row {
        9 => "0 0 0 ".repeat(30),
        11 | 12 => "255 0 0 ".repeat(30),
        _ => "255 255 255 ".repeat(30),
    });
    story.file("red.ppm", &format!("P3 30 20 255\n{}", rows.collect::<String>()));
    story.file(
        "lines.geojson",
        r#"{"type": "GeometryCollection", "crs": {"properties": {"name": "EPSG:32632"}}, "geometries": [
        {"type": "Point", "coordinates": [0, 0]}, {"type": "LineString", "coordinates": [[0, 0], [9, 9]]},
        {"type": "Polygon", "coordinates": [[[0,0],[100,0],[100,50],[0,50]], [[10,10],[90,10],[90,40],[10,40]]]}]}"#,
    );
    for (map, doubt) in [
        ("red.ppm", "15.0 % of the cells would be occupied instead of 5.0 %."),
        ("lines.geojson", "Ignored 2 points and lines of the GeoJSON file: only polygons become bushes."),
    ] {
        story.file("mine.toml", &format!("duration_s = 20\nunimog = []\n[[wumpus]]\n[field]\nmap = \"{map}\"\n"));
        let checked = story.tell(&["check", "mine.toml"]).expect_code(0).stdout;
        let run = story.tell(&["run", "mine.toml"]).expect_code(0).stderr;
        let batch = story
            .tell(&["batch", "mine.toml", "--seeds", "1..2", "--out", &format!("{map}-runs")])
            .expect_code(0)
            .stderr;
        for printed in [checked, run, batch] {
            let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
            assert_eq!(printed.matches(doubt).count(), 1, "{map}: {printed}");
            assert!(map != "red.ppm" || printed.contains("`field.map_tolerance = \"auto\"`"), "{printed}");
        }
        let quiet = story.tell(&["--quiet", "run", "mine.toml"]).expect_code(0).stderr;
        assert_eq!(quiet, "");
    }
}

#[test]
#[cfg(unix)]
fn commands_of_a_page_can_be_pasted() {
    let story = story();
    for name in ["my map.txt", "it's $1 #2.txt", "-plain.txt"] {
        story.file(name, "000000\n011100\n000100\n011100\n");
        let args = ["map", "report", "--goal", "0,0", "--start", "3,5", "--out", "lab", "--", name];
        story.tell(&args).expect_code(0);
        let page = story.read("lab/report.html").replace("&#39;", "'").replace("&#x27;", "'").replace("&amp;", "&");
        let start = page.find("wildfire map astar").expect("the page has the command");
        let line = page[start..].split(['<', '"']).next().unwrap_or_default();
        let script = format!("set -- {}; shift; printf '%s\\n' \"$@\"", line.trim());
        let output = output_of(&mut story.shell(&script));
        let read = String::from_utf8(output.stdout).expect("text");
        let read: Vec<&str> = read.lines().collect();
        assert_eq!(read.last(), Some(&name), "{line}");
        story.tell(&read).expect_code(0);
    }
}

#[test]
fn paths_that_do_not_arrive_do_not_look_like_it() {
    let story = story();
    // A descent that begins in a closed room.
    story.file("closed.txt", "000000\n011110\n010010\n011110\n000000\n");
    let args = ["map", "report", "closed.txt", "--goal", "4,5", "--start", "2,2", "--out", "lab"];
    story.tell(&args).expect_code(0);
    let page = story.read("lab/report.html");
    let row = &page[page.find("<td>Gradient descent").or(page.find("Gradient descent")).expect("a row")..];
    assert!(row[..row.find("</tr>").expect("a row ends")].contains("stuck"), "{}", &row[..300]);
}

#[test]
fn a_truck_that_has_no_room_is_told_of_before_the_run() {
    let story = story();
    // Corridors of 2 m.
    let hall = format!("{}\n", [".....#.....#.....#.....#.....#.....#."; 25].join("\n"));
    story.file("hall.txt", &hall);
    let args = ["new", "scenario", "--from-map", "hall.txt", "hall.toml", "--cell-m", "0.4"];
    let created = story.tell(&args).expect_code(0);
    let sentence = "cannot start: no free place was found for it on this field";
    assert!(created.stderr.contains(sentence), "{}", created.stderr);
    let checked = story.tell(&["check", "hall.toml"]).expect_code(0).stdout;
    let checked = checked.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(checked.contains(sentence) && !checked.contains("moved to the nearest free place: truck 0"), "{checked}");
    let run = story.tell(&["run", "hall.toml"]).expect_code(1);
    assert!(run.stderr.split_whitespace().collect::<Vec<_>>().join(" ").contains(sentence), "{}", run.stderr);
}

#[test]
fn a_contest_takes_its_field_from_any_map() {
    let story = story();
    let image = "P2 30 20 255\n".to_owned() + &"255 ".repeat(299) + "0 " + &"255 ".repeat(300);
    story.file("plan.pgm", &image);
    story.file(
        "hall.yaml",
        "image: plan.pgm\nresolution: 4\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n",
    );
    let polygon = "{\"type\": \"Polygon\", \"crs\": {\"properties\": {\"name\": \"EPSG:32632\"}}, \
                   \"coordinates\": [[[0, 0], [300, 0], [300, 200], [290, 200], [290, 10], [0, 10]]]}";
    story.file("wood.geojson", polygon);
    for (map, cells) in
        [("plan.pgm", "30 x 20 cells of 5 m"), ("hall.yaml", "30 x 20 cells of 4 m"), ("wood.geojson", "60 x 40 cells")]
    {
        let set = format!("field.map={map}");
        let printed = story.tell(&["check", "contest", "--all", "--set", &set]).expect_code(0).stdout;
        let text = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(cells), "{text}");
    }
    for (set, expected) in [
        (["field.map=plan.pgm", "field.map_tolerance=300"], "`field.map_tolerance` is 300; expected a whole number"),
        (["field.map=plan.pgm", "field.map_tolerance=some"], "\"auto\""),
        (["field.coverage=0.1", "field.map_invert=true"], "`field.map_invert` also needs `field.map`"),
    ] {
        let refusal = story.tell(&["check", "contest", "--set", set[0], "--set", set[1]]).expect_code(2);
        let text = refusal.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(expected), "{text}");
    }
    story.file("bad.csv", "0,1\n0,2\n");
    let refusal = story.tell(&["check", "contest", "--set", "field.map=bad.csv"]).expect_code(2);
    assert!(refusal.stderr.contains("row 1, column 1"), "{}", refusal.stderr);
}

fn assets() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"))
}

fn story_with_maps() -> Story {
    let story = Story::begin();
    fs::create_dir_all(story.path("assets/maps")).expect("writable");
    for entry in fs::read_dir(assets().join("maps")).expect("the maps are there") {
        let from = entry.expect("readable").path();
        let name = from.file_name().expect("a file has a name");
        fs::copy(&from, story.path("assets/maps").join(name)).expect("writable");
    }
    story
}

/// The subcommands and what they say of themselves.
fn helps(story: &Story) -> Vec<(String, String)> {
    let help = |arguments: &[&str]| story.tell(arguments).expect_code(0).stdout;
    let overview = help(&["map", "--help"]);
    let listed = overview.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    let helps: Vec<_> = names.map(|name| (name.to_owned(), help(&["map", name, "--help"]))).collect();
    assert_eq!(helps.len(), 20, "{overview}");
    helps
}

#[test]
fn examples_of_the_help_run() {
    let story = story_with_maps();
    // Timing takes its time, and its example is for a shell.
    for (subcommand, help) in helps(&story).into_iter().filter(|(subcommand, _)| subcommand != "timing") {
        let help = help.replace("\\\n", " ");
        let lines: Vec<_> = help.lines().filter(|line| line.starts_with("  wildfire map ")).collect();
        assert!(!lines.is_empty(), "{subcommand} has no example");
        for line in lines {
            let arguments: Vec<_> = line.split_whitespace().skip(1).collect();
            story.tell(&arguments).expect_code(0);
        }
    }
}
