//! `wildfire render`: stills, films and pages from scenarios, recordings and batches.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use gif::{ColorOutput, DecodeOptions};

use crate::children::{command, end_of, output_of, send, wait_until};
use crate::story::{Answer, Story, refuse};

const SMALL: [&str; 2] = ["--size", "320x240"];

fn render(story: &Story, arguments: &[&str]) -> Answer {
    story.tell(&[&["render"], arguments, &SMALL].concat())
}

/// Red, green and blue of a PNG's pixels, row by row.
fn pixels(path: &Path) -> Vec<u8> {
    image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).into_rgb8().into_raw()
}

/// Delays and pixels of a GIF's frames, each drawn over the one before.
fn frames(path: &Path) -> Vec<(u16, Vec<u8>)> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::RGBA);
    let mut decoder = options.read_info(File::open(path).expect("it was written")).expect("it is a GIF");
    let width = usize::from(decoder.width());
    let mut sheet = vec![0; 3 * width * usize::from(decoder.height())];
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("its frames are whole") {
        for (index, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] == 255) {
            let (row, col) = (index / usize::from(frame.width), index % usize::from(frame.width));
            let at = (row + usize::from(frame.top)) * width + col + usize::from(frame.left);
            sheet[3 * at..][..3].copy_from_slice(&pixel[..3]);
        }
        frames.push((frame.delay, sheet.clone()));
    }
    frames
}

#[test]
fn still_of_a_scenario_is_that_of_its_recording_and_of_its_batch() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--seed", "7", "--out", "run.wildfire"]).expect_code(0);
    story.tell(&["batch", "smoke", "--seeds", "3,7", "--out", "recorded", "--record", "all"]).expect_code(0);
    story.tell(&["batch", "smoke", "--seeds", "3,7", "--out", "simulated"]).expect_code(0);
    let sources: [&[&str]; 4] =
        [&["smoke", "--seed", "7"], &["run.wildfire"], &["recorded", "--seed", "7"], &["simulated", "--seed", "7"]];
    for (source, out) in sources.iter().zip(["1.png", "2.png", "3.png", "4.png"]) {
        render(&story, &[source, &["--at", "60", "-o", out][..]].concat()).expect_code(0);
    }
    let first = fs::read(story.path("1.png")).expect("it was written");
    for other in ["2.png", "3.png", "4.png"] {
        assert!(fs::read(story.path(other)).expect("it was written") == first, "{other} is another picture");
    }
    assert_eq!(image::image_dimensions(story.path("1.png")).expect("a picture"), (320, 240));
}

#[test]
fn batch_shows_its_first_run_unless_told_another() {
    let story = Story::begin();
    story.tell(&["batch", "smoke", "--seeds", "3,7", "--out", "out"]).expect_code(0);
    for (source, out) in [(&["out"][..], "batch.png"), (&["smoke", "--seed", "3"], "three.png")] {
        render(&story, &[source, &["-o", out]].concat()).expect_code(0);
    }
    assert!(pixels(&story.path("batch.png")) == pixels(&story.path("three.png")));
    refuse(&story, &["render", "out", "--seed", "5", "-o", "x.png"], &["no seed 5", "3,7"]);
    refuse(&story, &["render", "out", "--set", "fire.burn_out_s=3", "-o", "x.png"], &["out", "expected a scenario"]);
}

#[test]
fn time_seed_and_second_run_change_the_picture() {
    let story = Story::begin();
    let looks: [&[&str]; 7] = [
        &["--at", "30"],
        &["--at", "60"],
        &["--at", "60", "--seed", "2"],
        &["--at", "60", "--with-seed", "2"],
        &["--at", "60", "--with-set", "unimog.planner=hybrid-astar"],
        &["--at", "60", "--zoom", "4", "--centre", "20,20"],
        &["--at", "60", "--follow", "fleet"],
    ];
    let mut seen = Vec::new();
    for look in looks {
        render(&story, &[&["smoke", "-o", "look.png"], look].concat()).expect_code(0);
        let pixels = pixels(&story.path("look.png"));
        assert!(!seen.contains(&pixels), "{look:?} looks like one before");
        seen.push(pixels);
    }
}

#[test]
fn same_source_is_named_once_or_twice() {
    let story = Story::begin();
    let changed = ["--set", "fire.burn_out_s=20", "--at", "50"];
    let named = ["--with", "smoke", "--with-set", "fire.burn_out_s=20", "--with-seed", "2"];
    render(&story, &[&["smoke", "-o", "named.png"], &changed[..], &named].concat()).expect_code(0);
    render(&story, &[&["smoke", "-o", "alone.png"], &changed[..], &["--with-seed", "2"]].concat()).expect_code(0);
    assert!(pixels(&story.path("named.png")) == pixels(&story.path("alone.png")));
}

#[test]
fn gif_shows_the_moments_asked_for_and_ends_with_the_still() {
    let story = Story::begin();
    let film = ["--from", "10", "--to", "50", "--speed", "10", "--fps", "5", "--gif", "film.gif"];
    render(&story, &[&["smoke", "--at", "50", "-o", "still.png"], &film[..]].concat()).expect_code(0);
    let frames = frames(&story.path("film.gif"));
    assert_eq!(frames.len(), 21, "two simulated seconds a frame, and both ends");
    assert!(frames[..20].iter().all(|(delay, _)| *delay == 20));
    let (_, last) = &frames[20];
    let still = pixels(&story.path("still.png"));
    let far = last.iter().zip(&still).filter(|(shown, exact)| shown.abs_diff(**exact) > 12).count();
    assert!(far * 200 < still.len(), "{far} of {} channels are another", still.len());
    let (_, first) = &frames[0];
    assert!(first != last, "nothing happens");
}

#[test]
fn gif_is_the_same_file_every_time_and_loops() {
    let story = Story::begin();
    for out in ["one.gif", "two.gif"] {
        render(&story, &["smoke", "--to", "20", "--speed", "20", "--gif", out]).expect_code(0);
    }
    let one = fs::read(story.path("one.gif")).expect("it was written");
    assert!(one == fs::read(story.path("two.gif")).expect("it was written"));
    assert!(one.windows(11).any(|bytes| bytes == b"NETSCAPE2.0"), "it does not loop");
}

#[test]
fn recordings_that_are_none_are_refused_in_words() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--out", "run.wildfire"]).expect_code(0);
    let whole = fs::read(story.path("run.wildfire")).expect("it was written");
    let mut newer = whole.clone();
    newer[8] = 200;
    let mut damaged = whole.clone();
    *damaged.last_mut().expect("it has bytes") ^= 1;
    let files: [(&str, &[u8]); 6] = [
        ("short.wildfire", &whole[..whole.len() / 2]),
        ("empty.wildfire", b""),
        ("newer.wildfire", &newer),
        ("damaged.wildfire", &damaged),
        ("foreign.wildfire", b"PNG or whatever it is"),
        ("renamed.dat", &newer),
    ];
    for (name, bytes) in files {
        fs::write(story.path(name), bytes).expect("the scratch folder is writable");
    }
    for (name, fragment) in [
        ("missing.wildfire", "missing.wildfire does not exist"),
        ("short.wildfire", "truncated"),
        ("empty.wildfire", "truncated"),
        ("newer.wildfire", "newer"),
        ("damaged.wildfire", "checksum"),
        ("foreign.wildfire", "not a wildfire recording"),
        ("renamed.dat", "newer"),
    ] {
        refuse(&story, &["render", name, "-o", "x.png"], &[name, fragment]);
        refuse(&story, &["render", "smoke", "--with", name, "-o", "x.png"], &[name, fragment]);
    }
    fs::rename(story.path("run.wildfire"), story.path("run.dat")).expect("the scratch folder is writable");
    render(&story, &["run.dat", "-o", "x.png"]).expect_code(0);
}

#[test]
fn recording_has_its_own_seed_and_values() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--out", "run.wildfire"]).expect_code(0);
    for (option, value) in [("--seed", "1"), ("--with-seed", "2"), ("--set", "fire.burn_out_s=9")] {
        refuse(&story, &["render", "run.wildfire", option, value, "-o", "x.png"], &["run.wildfire", "expected"]);
    }
}

#[test]
fn events_are_moments_of_a_still() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--seed", "7", "--out", "run.wildfire"]).expect_code(0);
    let still = |at: &[&str], out: &str| {
        render(&story, &[&["smoke", "--seed", "7", "-o", out], at].concat()).expect_code(0);
        fs::read(story.path(out)).expect("it was written")
    };
    assert!(still(&["--at", "end"], "end.png") == still(&[], "default.png"));
    let search = still(&["--at", "largest-search"], "search.png");
    assert!(search != still(&["--at", "end", "--layers", "wumpus-search"], "other.png"));
    let fire = still(&["--at", "first-fire"], "fire.png");
    assert!(fire != still(&["--at", "0"], "start.png") && fire != still(&["--at", "end"], "end.png"));
    let none = ["render", "run.wildfire", "--at", "largest-search", "-o", "x.png"];
    refuse(&story, &none, &["--at largest-search: the recording has no searches", "--record-searches"]);
}

#[test]
fn looks_that_make_no_sense_are_refused() {
    let story = Story::begin();
    let late = story.tell(&["render", "smoke", "--at", "1000000", "-o", "late.png"]).expect_code(0);
    assert!(late.stderr.contains("--at is 1000000.000 s, but the run ends at"), "{}", late.stderr);
    let refused: [(&[&str], &[&str]); 21] = [
        (&["--at=-1"], &["--at", "at least 0"]),
        (&["--at", "nan"], &["--at", "seconds", "first-fire, first-failure, largest-search, end"]),
        (&["--at", "first-failure"], &["--at first-failure: every plan of this run succeeds"]),
        (&["--at", "first-fire", "--set", "wumpus=[]"], &["--at first-fire: nothing burns in this run"]),
        (&["--size", "100x100"], &["--size", "8192x8192"]),
        (&["--size", "1000000x1000000"], &["--size", "8192x8192"]),
        (&["--layers", "roads"], &["--layers", "wumpus-search"]),
        (&["--follow", "unimog/9"], &["--follow", "no unimog/9", "unimog/0"]),
        (&["--follow", "somebody"], &["--follow", "such as unimog/0", "fleet"]),
        (&["--follow", "fleet", "--zoom", "3"], &["--zoom is 3", "--follow fleet"]),
        (&["--follow", "fleet", "--set", "unimog=[]"], &["--follow fleet", "a truck"]),
        (&["--zoom", "0"], &["--zoom", "200"]),
        (&["--centre", "1"], &["--centre", "such as"]),
        (&["--centre", "5000,1"], &["--centre is 5000,1", "field"]),
        (&["--select", "0,0,0"], &["--select", "column and row"]),
        (&["--select", "60000,60000"], &["--select", "nothing grows"]),
        (&["--select", "wumpus/5"], &["--select", "no wumpus/5"]),
        (&["--seed", "x"], &["--seed"]),
        (&["--from", "5"], &["--gif"]),
        (&["--html", "y.png"], &["y.png", "a page", ".html or .htm"]),
        (&["--html", "nowhere/x.html"], &["nowhere/x.html", "the folder does not exist"]),
    ];
    for (look, fragments) in refused {
        refuse(&story, &[&["render", "smoke", "-o", "x.png"], look].concat(), fragments);
    }
    refuse(&story, &["render", "nothing", "-o", "x.png"], &["nothing", "contest"]);
    refuse(&story, &["render", "smoke"], &["--out", "--gif", "--mp4"]);
    refuse(&story, &["render", "smoke", "-o", "x.gif"], &["x.gif", "PNG", "--gif"]);
    refuse(&story, &["render", "smoke", "--gif", "x", "--mp4", "x"], &["x is named for two files"]);
    refuse(&story, &["render", "nothing", "--html", "x.html"], &["nothing", "contest"]);
    refuse(&story, &["render", "smoke", "--html", "x.html", "--from", "5"], &["--gif"]);
    story.file("notes.wildfire", "no recording");
    refuse(&story, &["render", "notes.wildfire", "--html", "x.html"], &["notes.wildfire"]);
    refuse(&story, &["render", "notes.wildfire", "--html", "notes.wildfire"], &["is named for two files"]);
    fs::create_dir(story.path("folder")).expect("the scratch folder is writable");
    refuse(&story, &["render", "folder", "-o", "x.png"], &["folder", "no batch plan"]);
    refuse(&story, &["render", "smoke", "-o", "nowhere/x.png"], &["nowhere/x.png", "the folder does not exist"]);
}

#[test]
fn page_of_a_scenario_is_that_of_its_recording_with_searches_and_takes_the_place_of_a_file() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--seed", "7", "--record-searches", "--out", "run.wildfire"]).expect_code(0);
    story.file("recorded.html", "what was there before");
    story.tell(&["render", "run.wildfire", "--page", "recorded.html"]).expect_code(0);
    story.tell(&["render", "smoke", "--seed", "7", "--page", "simulated.html"]).expect_code(0);
    let page = |name: &str| fs::read_to_string(story.path(name)).expect("it was written");
    assert_eq!(page("recorded.html"), page("simulated.html"));
    story.tell(&["render", "smoke", "--seed", "7", "--at", "0:30", "--page", "later.html"]).expect_code(0);
    assert!(page("later.html") != page("simulated.html"), "the page does not begin later");
    story.tell(&["render", "smoke", "--with-seed", "2", "--page", "two.html"]).expect_code(0);
    assert!(page("two.html").contains("<title>smoke, seed 1 and smoke, seed 2 – wildfire</title>"));
}

#[test]
fn page_holds_names_of_users_as_text() {
    let story = Story::begin();
    let name = "</script><b>&\u{202e}";
    story.file("a.toml", &format!("name = '{name}'\nduration_s = 20\n[[wumpus]]\n[[unimog]]\n"));
    story.tell(&["render", "a.toml", "--page", "a.html"]).expect_code(0);
    let page = fs::read_to_string(story.path("a.html")).expect("it was written");
    assert_eq!(page.matches("</script>").count(), 2, "the data and the script end once each");
    assert!(page.contains("&lt;/script&gt;&lt;b&gt;&amp;"), "the name is not shown as it is");
    assert!(!page.contains('\u{202e}'), "the name turns the direction of writing");
}

#[test]
fn films_without_end_are_refused() {
    let story = Story::begin();
    let film = |options: &[&'static str]| [&["render", "contest", "--gif", "x.gif"], options].concat();
    refuse(&story, &film(&["--speed", "0.1", "--fps", "50"]), &["frames", "at most 100000"]);
    refuse(&story, &film(&["--fps", "51"]), &["--fps", "50"]);
    refuse(&story, &film(&["--speed", "0"]), &["--speed", "0.1"]);
    refuse(&story, &film(&["--from", "20", "--to", "10"]), &["--from is 20", "--to, 10"]);
}

#[test]
fn searches_are_shown_where_they_are_known_and_else_missed_in_words() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--out", "plain.wildfire"]).expect_code(0);
    story.tell(&["run", "smoke", "--out", "searched.wildfire", "--record-searches"]).expect_code(0);
    let layers = ["--layers", "roadmap,wumpus-search", "-o", "x.png"];
    for source in ["smoke", "searched.wildfire"] {
        let answer = render(&story, &[&[source], &layers[..]].concat()).expect_code(0);
        assert!(!answer.stderr.contains("--record-searches"), "{source}: {}", answer.stderr);
    }
    render(&story, &[&["plain.wildfire"], &layers[..]].concat())
        .expect_code(0)
        .expect_complaint(&["roadmap", "--record-searches"]);
}

#[cfg(unix)]
mod with_ffmpeg {
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    const FILM: [&str; 8] = ["render", "smoke", "--to", "20", "--size", "320x240", "--mp4", "film.mp4"];

    /// Tells the program to make a film where `ffmpeg` is this script, which fails, or is missing.
    fn film_by(story: &Story, script: Option<&str>) -> Answer {
        let tools = story.path("tools");
        fs::create_dir(&tools).expect("the scratch folder is writable");
        if let Some(script) = script {
            fs::write(tools.join("ffmpeg"), format!("#!/bin/sh\n{script}\n")).expect("writable");
            fs::set_permissions(tools.join("ffmpeg"), fs::Permissions::from_mode(0o755)).expect("writable");
        }
        let mut command = story.command(&FILM);
        let answer = Answer::of(&output_of(command.env("PATH", &tools)));
        assert_eq!(story.entries(), ["tools"], "something half written is left");
        answer
    }

    #[test]
    fn film_is_made_of_all_frames() {
        let Ok(probe) = Command::new("ffprobe").arg("-version").output() else {
            eprintln!("skipped: ffmpeg is not installed");
            return;
        };
        assert!(probe.status.success());
        let story = Story::begin();
        story.tell(&FILM).expect_code(0);
        assert_eq!(story.entries(), ["film.mp4"]);
        let mut ask = command("ffprobe");
        ask.args(["-v", "error", "-count_frames", "-show_entries"]);
        ask.args(["stream=codec_name,width,height,pix_fmt,nb_read_frames", "-of", "csv=p=0"])
            .arg(story.path("film.mp4"));
        let found = output_of(&mut ask);
        assert_eq!(String::from_utf8_lossy(&found.stdout).trim(), "h264,320,240,yuv420p,8");
    }

    #[test]
    fn missing_ffmpeg_is_named_with_its_package() {
        let story = Story::begin();
        film_by(&story, None).expect_code(3).expect_complaint(&["ffmpeg", "apt-get install ffmpeg", "--gif"]);
    }

    #[test]
    fn failing_ffmpeg_is_quoted() {
        let story = Story::begin();
        let script = "echo first >&2; echo 'Unknown encoder libx264' >&2; exit 1";
        film_by(&story, Some(script)).expect_code(3).expect_complaint(&["film.mp4", "Unknown encoder libx264"]);
    }

    #[test]
    fn ffmpeg_that_fails_at_the_end_is_quoted() {
        let story = Story::begin();
        let script = "while read line; do :; done; echo 'No space left' >&2; exit 28";
        film_by(&story, Some(script)).expect_code(3).expect_complaint(&["film.mp4", "No space left"]);
    }

    #[test]
    fn ffmpeg_that_is_killed_is_no_film() {
        let story = Story::begin();
        film_by(&story, Some("kill -9 $$")).expect_code(3).expect_complaint(&["film.mp4", "signal"]);
    }

    #[test]
    fn odd_sides_are_refused_with_mp4_only() {
        let story = Story::begin();
        refuse(&story, &["render", "smoke", "--mp4", "x.mp4", "--size", "321x240"], &["321x240", "even"]);
        story.tell(&["render", "smoke", "-o", "x.png", "--size", "321x241"]).expect_code(0);
    }
}

#[test]
#[cfg(unix)]
fn interrupted_film_leaves_nothing() {
    let story = Story::begin();
    let film = ["render", "--gif", "film.gif", "--to", "1500", "--speed", "1", "--fps", "50", "--size", "320x240"];
    let mut command = story.command(&film);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program can be started");
    wait_until("it writes", || {
        assert!(child.try_wait().expect("it can be asked").is_none(), "it ended before it wrote anything");
        !story.entries().is_empty()
    });
    send("INT", &child);
    Answer::of(&end_of(child)).expect_code(130).expect_complaint(&["stopped"]);
    assert_eq!(story.entries(), [""; 0]);
}

#[test]
#[cfg(not(feature = "view"))]
fn play_without_its_window_writes_a_page() {
    let story = Story::begin();
    let play = |args: &[&str]| {
        let mut command = story.command(&[&["play", "smoke", "--seed", "3"], args].concat());
        command.env("TMPDIR", story.path("")).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        Answer::of(&output_of(&mut command))
    };
    let answer = play(&["--at", "50%"]).expect_code(0);
    let page = answer.stdout.trim_end();
    assert!(page.ends_with("wildfire-smoke-seed-3.html"), "{page}");
    assert!(answer.stderr.contains("open that file in a browser"), "{}", answer.stderr);
    story.tell(&["render", "smoke", "--seed", "3", "--page", "same.html"]).expect_code(0);
    let size = |path: &Path| fs::metadata(path).expect("it was written").len();
    assert!(size(Path::new(page)).abs_diff(size(&story.path("same.html"))) < 100);
    let refused = play(&["--window"]).expect_code(3);
    assert!(refused.stderr.contains("cargo run --release --features view -- play"), "{}", refused.stderr);
    assert_eq!((refused.stderr.lines().count(), refused.stdout.as_str()), (1, ""));
}

#[test]
fn a_name_with_letters_that_the_font_lacks_is_noted_once() {
    let story = Story::begin();
    let small = "duration_s = 20\n[[wumpus]]\n[[unimog]]\n";
    for (file, name) in [("a.toml", "Größe 火災 火"), ("b.toml", "火災 été"), ("c.toml", "Größe, Πυρ, Жар")]
    {
        story.file(file, &format!("name = \"{name}\"\n{small}"));
    }
    let note = "pictures show boxes for 火 (U+706B), 災 (U+707D): their font covers Latin, Greek and Cyrillic\n";
    let commands: [&[&str]; 5] = [
        &["render", "a.toml", "--size", "320x240", "-o", "a.png", "--gif", "a.gif", "--to", "5"],
        &["render", "a.toml", "--with", "b.toml", "--size", "480x240", "-o", "a.png"],
        &["render", "c.toml", "--with", "a.toml", "--size", "480x240", "-o", "a.png"],
        &["plan", "--scenario", "a.toml", "--goals", "1", "--png", "a.png"],
        &["report", "batch"],
    ];
    story.tell(&["batch", "a.toml", "c.toml", "--seeds", "1..2", "--out", "batch"]).expect_code(0);
    for arguments in commands {
        let answer = story.tell(arguments).expect_code(0);
        assert_eq!(answer.stderr.matches("pictures show boxes").count(), 1, "{arguments:?}: {}", answer.stderr);
        assert!(answer.stderr.contains(note), "{arguments:?}: {}", answer.stderr);
        let quiet = story.tell(&[&["--quiet"], arguments].concat()).expect_code(0);
        assert!(!quiet.stderr.contains("pictures show"), "{arguments:?}: {}", quiet.stderr);
    }
    for arguments in [
        &["render", "c.toml", "--size", "320x240", "-o", "c.png"][..],
        &["plan", "--scenario", "a.toml", "--goals", "1"],
    ] {
        let answer = story.tell(arguments).expect_code(0);
        assert!(!answer.stderr.contains("pictures show"), "{arguments:?}: {}", answer.stderr);
    }
}

#[test]
fn tour_is_a_film_of_the_stops_that_a_run_has() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--seed", "7", "--record-searches", "--out", "run.wildfire"]).expect_code(0);
    render(&story, &["run.wildfire", "--gif", "tour.gif", "--tour", "--fps", "1"]).expect_code(0);
    // Six stops of eight frames; the clock goes back where a stop is earlier than the one before.
    let film = frames(&story.path("tour.gif"));
    assert!((30..=48).contains(&film.len()), "{} frames", film.len());
    render(&story, &["run.wildfire", "--gif", "again.gif", "--tour", "--fps", "1"]).expect_code(0);
    assert!(film == frames(&story.path("again.gif")), "another film of the same run");
    refuse(&story, &["render", "smoke", "--tour", "-o", "still.png"], &["--gif"]);
    refuse(&story, &["render", "smoke", "--tour", "--gif", "film.gif", "--from", "3"], &["--from"]);
    refuse(&story, &["render", "smoke", "--tour", "--gif", "film.gif", "--with-seed", "3"], &["--with-seed"]);
}

#[test]
fn examples_of_the_help_are_understood() {
    let story = Story::begin();
    story.tell(&["run", "smoke", "--out", "run.wildfire"]).expect_code(0);
    let help = story.tell(&["render", "--help"]).expect_code(0).stdout;
    let examples: Vec<_> = help.lines().filter_map(|line| line.strip_prefix("  wildfire ")).collect();
    assert!(examples.len() >= 5, "{help}");
    for example in examples {
        // An output that cannot be written is what is found first, once the arguments make sense.
        let args: Vec<_> = example.split_whitespace().collect();
        let outputs =
            ["still.png", "film.gif", "film.mp4", "tour.mp4", "run.html", "two.png", "near.png", "search.png"];
        let nowhere: Vec<String> = args
            .iter()
            .map(|word| if outputs.contains(word) { format!("nowhere/{word}") } else { (*word).to_owned() })
            .collect();
        let nowhere: Vec<&str> = nowhere.iter().map(String::as_str).collect();
        refuse(&story, &nowhere, &["nowhere/", "the folder does not exist"]);
    }
}
