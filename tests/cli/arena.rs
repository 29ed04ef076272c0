//! The arena: tracks stay what they are, a board's rows are those of its entries, and one changed digit is found.

use std::fs;

use serde_json::Value;
use wildfire::batch::arena::{ARENA_VERSION, ArenaRow, HASHED_COLUMNS, TRACKS, TrackKind};
use wildfire::batch::table::{RUN_COLUMNS, is_measured};

use crate::story::Story;

fn entry(story: &Story, name: &str, track: &str, values: &str) {
    fs::create_dir_all(story.path(name)).expect("writable");
    story.file(&format!("{name}/entry.toml"), &format!("[entry]\nname = \"{name}\"\ntracks = [\"{track}\"]\n{values}"));
}

/// A board of the quickest track, with two entries.
fn board() -> Story {
    let story = Story::begin();
    entry(&story, "near", "drive", "[unimog]\nplanner = \"hybrid-astar\"\n");
    entry(&story, "far", "drive", "[unimog]\nplanner = \"hybrid-astar\"\nhybrid.heuristic_weight = 2.5\n");
    story.tell(&["arena", "run", "near", "far", "--jobs", "2"]).expect_code(0);
    story
}

#[test]
fn reference_entries_do_what_they_did_when_the_tracks_were_frozen() {
    let printed = Story::begin().tell(&["arena", "verify", "--seeds", "1"]).expect_code(0).stdout;
    assert!(printed.contains("all of the rows that were frozen"), "{printed}");
    for track in &TRACKS {
        let plan = track.golden_plan(track.public_seeds()).expect("the references are right");
        assert_eq!(track.golden().len() as u64, plan.count(), "{}", track.name);
        assert!(track.is_hidden_list(track.hidden), "{}: the list is not the one that was promised", track.name);
        assert!(!track.is_hidden_list(&format!("{}1\n", track.hidden)));
    }
}

#[test]
fn some_rows_of_the_shipped_board_are_those_of_their_runs() {
    let board = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/arena");
    // Among them a run in which a module chose goals that other trucks had taken when its answer counted.
    Story::begin().tell(&["arena", "recompute", board, "--track", "dispatch", "--sample", "0.25%"]).expect_code(0);
}

#[test]
fn hashed_columns_are_outcomes() {
    for name in HASHED_COLUMNS {
        assert!(RUN_COLUMNS.iter().any(|column| column.name == name) && !is_measured(name), "{name}");
    }
}

#[test]
fn rows_are_read_as_they_were_written() {
    let rows = TRACKS[0].golden();
    let text = ArenaRow::write(&rows);
    assert_eq!(ArenaRow::read("golden.csv".as_ref(), text.as_bytes()).expect("they are rows"), rows);
    assert_eq!((TRACKS[0].kind, ARENA_VERSION), (TrackKind::Drive, "1.0"));
}

#[test]
fn a_board_ranks_its_entries_and_is_recomputed() {
    let story = board();
    let rows = story.read("board/drive.csv");
    let ranked: Value =
        serde_json::from_str(&story.tell(&["arena", "rank", "--json"]).expect_code(0).stdout).expect("JSON");
    let entries = ranked[0]["entries"].as_array().expect("a list");
    assert_eq!(entries.iter().map(|entry| &entry["entry"]).collect::<Vec<_>>(), ["near", "far"]);
    let score = |place: usize| entries[place]["score"].as_f64().expect("a number");
    let next = entries[0]["next_less_this"]["difference"].as_f64().expect("a number");
    assert!((score(1) - score(0) - next).abs() < 1e-12 && next < 0.0);
    assert!(entries.iter().all(|entry| entry["class"] == "counted"));
    for file in ["drive.json", "drive.md", "drive.html"] {
        assert!(story.read(&format!("board/{file}")).contains("near"), "{file}");
    }
    // Another number of threads, and another time: the same rows.
    story.tell(&["arena", "run", "near", "far", "--jobs", "1"]).expect_code(0);
    assert_eq!(story.read("board/drive.csv"), rows);
    story.tell(&["arena", "recompute", "--sample", "20%"]).expect_code(0);
}

#[test]
fn failed_runs_count_as_the_worst_score_where_lower_is_better() {
    let story = Story::begin();
    let dispatch = TRACKS.iter().find(|track| track.name == "dispatch").expect("there is one");
    let mut rows = dispatch.golden();
    for name in ["auction", "nearest"] {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/batch/arena/1.0/dispatch");
        let text = fs::read_to_string(format!("{folder}/{name}.toml")).expect("it is a reference");
        fs::create_dir_all(story.path(&format!("board/entries/{name}"))).expect("writable");
        story.file(&format!("board/entries/{name}/entry.toml"), &text);
    }
    rows.iter_mut().filter(|row| row.entry == "auction").for_each(|row| row.score = None);
    story.file("board/dispatch.csv", &ArenaRow::write(&rows));
    let ranked: Value =
        serde_json::from_str(&story.tell(&["arena", "rank", "--json"]).expect_code(0).stdout).expect("JSON");
    let entries = ranked[0]["entries"].as_array().expect("a list");
    assert_eq!(entries.iter().map(|entry| &entry["entry"]).collect::<Vec<_>>(), ["nearest", "auction"]);
    let worst = rows.iter().filter_map(|row| row.score).fold(0.0, f64::max);
    assert_eq!(entries[1]["score"].as_f64(), Some(worst));
}

#[test]
fn one_changed_digit_is_found_and_named() {
    let story = board();
    let rows = story.read("board/drive.csv");
    for (place, name) in [(3, "score"), (4, "effort"), (5, "hash")] {
        let mut lines: Vec<String> = rows.lines().map(str::to_owned).collect();
        let mut values: Vec<String> = lines[17].split(',').map(str::to_owned).collect();
        // A digit in the middle, so that a score stays one in its shortest form.
        let digit = values[place].remove(if place == 4 { 0 } else { 5 });
        values[place].insert(if place == 4 { 0 } else { 5 }, if digit == '7' { '8' } else { '7' });
        lines[17] = values.join(",");
        fs::write(story.path("board/drive.csv"), lines.join("\n") + "\n").expect("writable");
        let printed = story.tell(&["arena", "recompute"]).expect_code(4).stdout;
        let seed = format!("{}, {}, seed {}: {name} ", values[0], values[1], values[2]);
        assert!(printed.contains("1 of 600 runs differ") && printed.replace("\n  ", " ").contains(&seed), "{printed}");
    }
    // A seed that the track does not have cannot be slipped in either.
    let foreign = rows.replacen(",75,", ",76,", 1);
    fs::write(story.path("board/drive.csv"), foreign).expect("writable");
    for command in ["recompute", "rank"] {
        let printed = story.tell(&["arena", command]).expect_code(2).stderr;
        assert!(printed.contains("has a row of seed 76, which the track does not have"), "{printed}");
    }
    // Nor can all entries be shown on the seeds that suit one.
    let few: Vec<&str> = rows.lines().filter(|line| !line.contains(",75,")).collect();
    fs::write(story.path("board/drive.csv"), few.join("\n") + "\n").expect("writable");
    for command in ["recompute", "rank"] {
        let printed = story.tell(&["arena", command]).expect_code(2).stderr;
        assert!(printed.contains("runs; expected the 300 of the track's seeds"), "{printed}");
    }
}

#[test]
fn one_changed_digit_of_a_published_ranking_is_found() {
    let story = board();
    story.tell(&["arena", "rank"]).expect_code(0);
    let recompute = ["arena", "recompute", "--sample", "1%"];
    story.tell(&recompute).expect_code(0);
    for (file, start) in
        [("drive.json", "\"score\""), ("drive.md", "near"), ("drive.html", "near"), ("croissant.json", "sha256")]
    {
        let path = format!("board/{file}");
        let text = story.read(&path);
        let start = text.find(start).expect("it says that");
        let digit = start + text[start..].find(|letter: char| letter.is_ascii_digit()).expect("a number follows");
        let mut changed = text.clone();
        changed.replace_range(digit..=digit, if text[digit..].starts_with('7') { "8" } else { "7" });
        story.file(&path, &changed);
        let printed = story.tell(&recompute).expect_code(4).stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(printed.contains("1 file differs from what follows from the rows"), "{printed}");
        assert!(printed.contains(&format!("{file}, line ")) && printed.contains("; the rows give `"), "{printed}");
        story.file(&path, &text);
    }
    // A file of a track that nobody played.
    story.file("board/fleet.md", "mine is first\n");
    assert!(story.tell(&recompute).expect_code(4).stdout.contains("fleet.md, line 1: `mine is first`"));
}

#[test]
fn names_that_differ_in_case_only_are_refused() {
    let story = board();
    entry(&story, "Near", "drive", "[unimog]\nplanner = \"hybrid-astar\"\n");
    let refusal = "have one folder on macOS and Windows";
    assert!(story.tell(&["arena", "run", "Near"]).expect_code(2).stderr.replace("\n  ", " ").contains(refusal));
    let rows = story.read("board/drive.csv").replace("far,", "Near,");
    story.file("board/drive.csv", &rows);
    for command in ["rank", "recompute"] {
        assert!(
            story.tell(&["arena", command]).expect_code(2).stderr.replace("\n  ", " ").contains(refusal),
            "{command}"
        );
    }
}

#[test]
fn programs_are_left_out_when_a_board_is_recomputed_without_trust() {
    let story = board();
    let program = "[unimog]\nplanner = \"own\"\n[planner.own]\ncommand = [\"cat\"]\n";
    entry(&story, "timed", "drive", program);
    let rows = story.read("board/drive.csv");
    let of_timed = rows.lines().filter(|line| line.starts_with("near,")).map(|line| line.replacen("near", "timed", 1));
    let all = [rows.trim_end().to_owned()].into_iter().chain(of_timed).collect::<Vec<_>>();
    fs::write(story.path("board/drive.csv"), all.join("\n") + "\n").expect("writable");
    fs::create_dir_all(story.path("board/entries/timed")).expect("writable");
    fs::copy(story.path("timed/entry.toml"), story.path("board/entries/timed/entry.toml")).expect("writable");
    let answer = story.tell(&["arena", "recompute", "--sample", "10%"]).expect_code(0);
    assert!(answer.stderr.contains("left out, because they are programs: timed; --trust"), "{}", answer.stderr);
    assert!(answer.stdout.contains("60 runs"), "{}", answer.stdout);
    // A program that does not start here is no reason to doubt the board.
    let answer = story.tell(&["arena", "recompute", "--sample", "10%", "--trust"]).expect_code(0);
    assert!(answer.stderr.contains("left out: timed could not be started in 30 runs: "), "{}", answer.stderr);
    assert!(answer.stdout.contains("60 runs"), "{}", answer.stdout);
    let timed: Vec<&str> = all.iter().flat_map(|lines| lines.lines()).filter(|line| !line.contains("ar,")).collect();
    fs::write(story.path("board/drive.csv"), timed.join("\n") + "\n").expect("writable");
    let printed = story.tell(&["arena", "recompute", "--sample", "10%", "--trust"]).expect_code(2).stderr;
    assert!(printed.contains("nothing could be recomputed: timed could not be started in 30 runs: "), "{printed}");
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let story = board();
    let refused = |args: &[&str], part: &str| {
        let printed = story.tell(args).expect_code(2).stderr;
        assert!(printed.contains(part), "{args:?}: {printed}");
    };
    entry(&story, "fast", "contest", "[unimog]\nplanner = \"prm-rs\"\nspeed_mps = 20\n");
    refused(
        &["arena", "submit-check", "fast"],
        "entry.toml:6: `unimog.speed_mps` is fixed by the rules in arena/1.0/contest/rules.toml",
    );
    entry(&story, "lost", "maze", "[unimog]\nplanner = \"prm-rs\"\n");
    refused(&["arena", "run", "lost"], "there is no track `maze`; expected one of drive, contest");
    story.file("nobody.toml", "[unimog]\nplanner = \"prm-rs\"\n");
    refused(&["arena", "run", "nobody.toml"], "there is no table [entry]");
    refused(&["arena", "run", "near", "--track", "fleet"], "near enters none of these tracks");
    story.file("learned.txt", "1\n2\n3\n");
    refused(
        &["arena", "run", "near", "--seeds", "learned.txt"],
        "is not the list to which the track `drive` committed itself",
    );
    refused(&["arena", "rank", "nowhere"], "nowhere has no rows");
    refused(&["arena", "recompute", "--sample", "0"], "above 0");
    fs::remove_file(story.path("board/entries/far/entry.toml")).expect("it is there");
    refused(&["arena", "rank"], "entry.toml");
    let rows = story.read("board/drive.csv");
    story.file("board/drive.csv", &rows.replacen(",0.9", ",x.9", 1));
    refused(&["arena", "rank"], ": score is \"x.9");
    // More digits than the number has could hide a changed one.
    story.file("board/drive.csv", &rows.replacen(",0.9", ",00.9", 1));
    refused(&["arena", "recompute"], "expected nothing, or a number in its shortest form");
}

#[test]
fn a_list_of_hidden_seeds_is_played_when_its_hash_is_the_promised_one() {
    let story = board();
    story.tell(&["arena", "tracks", "--out", "tracks"]).expect_code(0);
    let args = ["arena", "run", "near", "--board", "season", "--seeds", "tracks/drive/hidden.txt"];
    story.tell(&args).expect_code(0);
    let seeds = |file: &str| {
        let rows = ArenaRow::read(file.as_ref(), story.read(file).as_bytes()).expect("rows");
        rows.iter().map(|row| row.seed).collect::<std::collections::BTreeSet<_>>()
    };
    assert!(seeds("season/drive.csv").is_disjoint(&seeds("board/drive.csv")));
    assert_eq!(seeds("season/drive.csv").len(), 75);
}
