//! Pages that compute runs, and games that come from them.

use std::fs;

use data_encoding::BASE64;
use serde_json::Value;

use crate::story::Story;

/// The first bytes of every module.
const MODULE: &str = "\0asm\x01\0\0\0";

/// A game in which the Wumpus waits when it is asked first, and whose player left then.
const GAME: &str = r#"{"wildfire_game": 1, "scenario": {"name": "smoke"}, "seed": 3, "plays": ["wumpus"],
    "answers": [{"t_ns": 0, "side": "wumpus", "number": 0, "choice": "wait"}]}"#;

#[test]
fn a_page_carries_the_module_and_what_it_begins_with() {
    let story = Story::begin();
    story.file("m.wasm", MODULE);
    story.file("game.json", GAME);
    story
        .tell(&["page", "fleet", "--seed", "9", "--side", "unimog", "--module", "m.wasm", "-o", "p.html"])
        .expect_code(0);
    let page = story.read("p.html");
    assert!(page.contains(r#""scenario":{"name":"fleet"},"seed":9,"plays":["unimog"]"#));
    assert!(page.contains(r#"id="module""#) && page.contains(r#"id="run-data""#));
    for place in ["@POLICY@", "@DESK@", "@QUESTION@", "@COVER@", "@DATA@", "@TITLE@", "@SCRIPT@", "@MODULE@"] {
        assert!(!page.contains(place), "{place} is not filled in");
    }
    story.tell(&["page", "--game", "game.json", "--module", "m.wasm", "-o", "g.html"]).expect_code(0);
    assert!(story.read("g.html").contains(r#""choice":"wait""#));
}

#[test]
fn the_program_has_the_module_of_the_shipped_page() {
    let story = Story::begin();
    story.tell(&["page", "-o", "p.html"]).expect_code(0);
    let page = story.read("p.html");
    let shipped = include_str!("../../assets/play.html");
    assert_eq!(page, shipped, "assets/play.html is not what `wildfire page` writes; .ci/renew makes it so");
    assert!(page.len() < 2_600_000, "{} bytes", page.len());
    let module = page.split("id=\"module\">").nth(1).and_then(|rest| rest.split('<').next()).expect("it is there");
    let packed = BASE64.decode(module.as_bytes()).expect("it is base 64");
    let module = miniz_oxide::inflate::decompress_to_vec_zlib(&packed).expect("it is compressed");
    assert!(module.starts_with(MODULE.as_bytes()), "a WebAssembly module");
}

#[test]
fn what_cannot_be_a_page_is_refused() {
    let story = Story::begin();
    story.file("m.wasm", MODULE);
    story.file("text.wasm", "(module)");
    story.file("game.json", &GAME.replace("game\": 1", "game\": 7"));
    story.file("nearest.json", &GAME.replace("wait", "go-to-nearest"));
    story.file("wrong.toml", "[fires]\n");
    for (args, sentence) in [
        (&["page", "-o", "p.html", "--module", "gone.wasm"][..], "gone.wasm: it cannot be read"),
        (&["page", "-o", "p.html", "--module", "text.wasm"], "text.wasm: it is no WebAssembly module"),
        (&["page", "-o", "p.png", "--module", "m.wasm"], "p.png would hold a page"),
        (&["page", "nowhere", "-o", "p.html", "--module", "m.wasm"], "nor a built-in scenario `nowhere`"),
        (&["page", "wrong.toml", "-o", "p.html", "--module", "m.wasm"], "unknown field `fires`"),
        (&["page", "--game", "game.json", "-o", "p.html", "--module", "m.wasm"], "the game has format 7; expected 1"),
        (&["run", "--answers", "game.json"], "the game has format 7; expected 1"),
        (&["run", "--answers", "m.wasm"], "m.wasm"),
        (&["run", "--answers", "nearest.json"], "answer 1 sends wumpus/0 to the nearest fire; only trucks can"),
        (&["run", "dense", "--answers", "game.json"], "cannot be used with"),
    ] {
        let answer = story.tell(args).expect_code(2);
        assert!(answer.stderr.contains(sentence), "{args:?}: {}", answer.stderr);
    }
    assert!(!story.path("p.html").exists() && !story.path("p.png").exists());
}

#[test]
fn a_game_that_does_not_go_to_its_end_is_no_run() {
    let story = Story::begin();
    story.file("game.json", GAME);
    let answer = story.tell(&["run", "--answers", "game.json", "--out", "run.wildfire"]).expect_code(2);
    assert!(answer.stderr.contains("wumpus/0 is asked at"), "{}", answer.stderr);
    assert!(answer.stderr.contains("there are 1 answers"), "{}", answer.stderr);
    assert!(!story.path("run.wildfire").exists());
}

#[test]
fn lessons_are_self_contained_and_their_data_keep_the_laws() {
    let story = Story::begin();
    story.tell(&["lessons", "course"]).expect_code(0);
    let mut names: Vec<String> = Vec::new();
    for entry in fs::read_dir(story.path("course")).expect("the folder is there") {
        names.push(entry.expect("readable").file_name().into_string().expect("a name"));
    }
    names.sort();
    assert_eq!(names.len(), 8, "{names:?}");
    let mut bytes = 0;
    for name in &names {
        let page = story.read(&format!("course/{name}"));
        bytes += page.len();
        for foreign in ["http:", "https:", "src=", "@import", "url(", "{{", "@DATA@", "@TEXT@", "@SCRIPT@"] {
            assert!(!page.contains(foreign), "{name} has {foreign}");
        }
        for link in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap_or_default()) {
            assert!(names.iter().any(|name| name == link), "{name} links to {link}");
        }
        assert_eq!(page.contains("class=\"quiz\""), name != "index.html", "{name}");
    }
    assert!(bytes < 1_500_000, "{bytes} bytes");
    // The commands that the lessons name print the same numbers. `.ci/lessons` compares all that the pages show.
    let mut compared = 0;
    for name in ["1-fronts.html", "2-astar.html", "3-potentials.html"] {
        for board in lesson_data(&story, name)["boards"].as_array().expect("boards") {
            let map = board["file"].as_str().expect("a file");
            let cols = board["cols"].as_u64().expect("columns") as usize;
            let walls = board["walls"].as_str().expect("walls").as_bytes();
            let rows = walls.chunks(cols).map(|row| String::from_utf8_lossy(row).into_owned() + "\n");
            story.file(map, &rows.collect::<String>());
            let end =
                |end: &str| board[end].as_u64().map(|cell| format!("{},{}", cell / cols as u64, cell % cols as u64));
            let ends = [end("start").expect("a start"), end("goal").expect("a goal")];
            for run in board["runs"].as_array().expect("runs") {
                let args: Vec<&str> = run["args"].as_str().expect("arguments").split(' ').collect();
                let ends = if args[0] == "brushfire" { vec![] } else { vec!["--start", &ends[0], "--goal", &ends[1]] };
                let answer = story.tell(&[&["map", args[0], map, "--json"], &ends[..], &args[1..]].concat());
                let found: Value = serde_json::from_str(&answer.expect_code(0).stdout).expect("it is JSON");
                if run["expanded"].is_u64() {
                    assert_eq!(found["expansions"], run["expanded"], "{map}: {args:?}");
                    let cost = |value: &Value| (value.as_f64().expect("a cost") * 1000.0).round();
                    assert_eq!(cost(&found["cost"]), cost(&run["cost"]), "{map}: {args:?}");
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 4 * 8 + 5);
    let pairs = lesson_data(&story, "6-intervals.html");
    let length = |value: &Value| value.as_array().map(Vec::len);
    assert_eq!(length(&pairs["metrics"][0]["differences"]), pairs["seeds"].as_u64().map(|seeds| seeds as usize));
    // Student's t for 2 and for 100 pairs: 12.706 and 1.984 (tables).
    assert_eq!((&pairs["reach"][0], &pairs["reach"][98]), (&12.7062.into(), &1.9842.into()));
    // The same seed has the same bushes under every policy.
    let policies = lesson_data(&story, "7-dispatch.html")["policies"].take();
    assert!((1..4).all(|policy| policies[policy]["films"][0]["bushes"] == policies[0]["films"][0]["bushes"]));
    // RRT* is never longer with more samples.
    for board in lesson_data(&story, "4-sampling.html")["boards"].as_array().expect("boards") {
        for seed in board["costs"]["seeds"].as_array().expect("seeds") {
            let costs: Vec<f64> = seed.as_array().expect("costs").iter().filter_map(Value::as_f64).collect();
            assert!(!costs.is_empty() && costs.windows(2).all(|pair| pair[1] <= pair[0]), "{seed}");
        }
    }
    // The earlier spelling writes the same.
    story.tell(&["page", "--lessons", "again"]).expect_code(0);
    assert_eq!(story.read("again/5-curves.html"), story.read("course/5-curves.html"));
    let answer = story.tell(&["page", "--lessons", "course", "-o", "p.html"]).expect_code(2);
    assert!(answer.stderr.contains("cannot be used with"), "{}", answer.stderr);
}

/// The data that a lesson shows.
fn lesson_data(story: &Story, name: &str) -> Value {
    let page = story.read(&format!("course/{name}"));
    let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next());
    serde_json::from_str(data.expect("a lesson has data")).expect("they are JSON")
}
