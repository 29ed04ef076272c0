//! Files that the program's user names: one cause, one exit code, whichever command reads or writes them.

use std::fs;

use crate::children::{self, output_of};
use crate::story::{Answer, Story, refuse};

/// Every option of every command that writes a single file, how the file's name may end, and what it begins with.
const OUTPUTS: [(&str, &str, &[u8]); 30] = [
    ("run smoke --out", "wildfire", b"WILDFIRE"),
    ("run smoke --events", "csv", b"t_s,event"),
    ("run smoke --trace", "csv", b"t_s,agent"),
    ("render smoke --size 320x240 -o", "png", b"\x89PNG"),
    ("render smoke --size 320x240 --to 60 --gif", "gif", b"GIF8"),
    ("render smoke --html", "html", b"<!DOCTYPE html>"),
    ("export smoke --format json -o", "json", b"{\"format\":1,"),
    ("export smoke --format npz --step 5 -o", "npz", b"PK\x03\x04"),
    ("export smoke --format mcap --step 5 -o", "mcap", b"\x89MCAP0\r\n"),
    ("map brushfire map.txt --csv", "csv", b"2,1"),
    ("map brushfire map.txt --npy", "npy", b"\x93NUMPY"),
    ("map brushfire map.txt --png", "png", b"\x89PNG"),
    ("map brushfire map.txt --overlay", "png", b"\x89PNG"),
    ("map brushfire map.txt --surface", "png", b"\x89PNG"),
    ("map wavefront map.txt --goal 1,0 --start 1,3 --path", "csv", b"1,3\n"),
    ("map astar map.txt --goal 1,0 --start 1,3 --expansions", "csv", b"order,row,col,cost\n0,1,3,0\n"),
    ("map astar map.txt --goal 1,0 --start 1,3 --gif", "gif", b"GIF8"),
    ("map prm map.txt --goal 1,0 --start 1,3 --edges", "csv", b"order,from_row"),
    ("map rrt map.txt --goal 1,0 --start 1,3 --gif", "gif", b"GIF8"),
    ("curve --from 0,0,0 --to 20,15,180 --csv", "csv", b"curve,s_m"),
    ("curve --from 0,0,0 --to 20,15,180 --png", "png", b"\x89PNG"),
    ("curve --pairs pairs.csv --csv", "csv", b"x0,y0"),
    ("plan field.json --csv", "csv", b"field,goal"),
    ("plan field.json --paths", "csv", b"field,goal"),
    ("plan field.json --ompl", "log", b"wildfire version"),
    ("plan field.json --png", "png", b"\x89PNG"),
    ("plan --scenario smoke --goals 1 --ompl", "txt", b"wildfire version"),
    ("map total map.txt --goal 1,0 --csv", "txt", b""),
    ("new scenario", "toml", b"# A custom scenario"),
    ("new plan", "toml", b"#"),
];

/// Every way to name a file to be read, with `{}` for its name, and whether a folder is expected.
const INPUTS: [(&str, bool); 21] = [
    ("check {}", false),
    ("run {}", false),
    ("batch {} --out new", false),
    ("batch smoke {} --out new", false),
    ("batch smoke --seeds @{} --out new", false),
    ("render {} -o new.png", false),
    ("render smoke --with {} -o new.png", false),
    ("export {} -o new.json", false),
    ("plan {}", false),
    ("plan --scenario {}", false),
    ("map brushfire {}", false),
    ("map timing {}", false),
    ("check --set field.map={}", false),
    ("curve --pairs {} --csv new.csv", false),
    ("audit {}", false),
    ("compare {}", false),
    ("batch --resume {}", true),
    ("status {}", true),
    ("merge {}", true),
    ("report {}", true),
    ("audit {}", true),
];

const FIELD: &str = r#"{"n": 10, "cell_m": 5, "cells_cr": [], "start": [12, 25, 0], "goals": [{"pose": [38, 25, 0]}]}"#;

fn story() -> Story {
    let story = Story::begin();
    story.file("map.txt", "0100\n0000\n");
    story.file("pairs.csv", "x0,y0,th0,x1,y1,th1\n0,0,0,9,9,1\n");
    story.file("field.json", FIELD);
    story.tell(&["run", "smoke", "--out", "smoke.wildfire"]).expect_code(0);
    story
}

fn split_args(command: &str) -> Vec<&str> {
    command.split_whitespace().collect()
}

#[test]
fn file_of_another_format_than_its_name_says_is_refused() {
    let story = story();
    for (command, ending, _) in OUTPUTS {
        for name in ["new.svg", "new", "new.jpg", ".csv"] {
            refuse(&story, &[&split_args(command)[..], &[name]].concat(), &[name, "expected a name that ends in ."]);
        }
        for other in ["png", "npy", "wildfire"].into_iter().filter(|other| *other != ending) {
            let name = format!("new.{other}");
            refuse(&story, &[&split_args(command)[..], &[&name]].concat(), &[&name, "expected a name that ends in ."]);
        }
    }
    story.tell(&["map", "brushfire", "map.txt", "--png", "NEW.PNG"]).expect_code(0);
    assert!(fs::read(story.path("NEW.PNG")).expect("it was written").starts_with(b"\x89PNG"));
}

#[test]
fn dash_is_stdout_for_every_output_and_the_words_go_to_stderr() {
    let story = story();
    for (command, ending, start) in OUTPUTS {
        let before = story.entries();
        let piped = output_of(&mut story.command(&[&split_args(command)[..], &["-"]].concat()));
        assert_eq!(piped.status.code(), Some(0), "{command}: {}", String::from_utf8_lossy(&piped.stderr));
        assert!(piped.stdout.starts_with(start), "{command}: {:?}", &piped.stdout[..piped.stdout.len().min(40)]);
        assert_eq!(story.entries(), before, "{command}");
        let name = format!("new.{ending}");
        let filed = story.tell(&[&split_args(command)[..], &[&name]].concat()).expect_code(0);
        assert_eq!(filed.stdout.is_empty(), piped.stderr.is_empty(), "{command}: the words are lost, or there twice");
        let has_times = command.starts_with("plan") && !command.contains("--png") && !command.contains("--paths");
        let written = fs::read(story.path(&name)).expect("it was written");
        assert!(has_times || written == piped.stdout, "{command}: file and stdout differ");
        fs::remove_file(story.path(&name)).expect("it is there");
    }
}

#[test]
fn two_results_on_stdout_are_refused() {
    let story = story();
    for command in [
        "run smoke --events - --trace -",
        "run smoke --json --out -",
        "map brushfire map.txt --csv - --npy -",
        "map brushfire map.txt --json --png -",
        "curve --from 0,0,0 --to 9,9,9 --json --csv -",
        "plan field.json --json --csv -",
        "plan field.json --paths - --ompl -",
        "render smoke -o - --gif -",
        "render smoke -o - --html -",
    ] {
        refuse(&story, &split_args(command), &["- is stdout, which takes a single output; expected it once"]);
    }
    refuse(&story, &split_args("render - --with - -o new.png"), &["- is stdin, which can be read only once"]);
}

#[test]
#[cfg(unix)]
fn output_that_is_no_file_is_refused_and_never_opened() {
    let story = story();
    let made = std::process::Command::new("mkfifo").arg(story.path("pipe.csv")).status().expect("mkfifo is there");
    assert!(made.success());
    let _socket = std::os::unix::net::UnixListener::bind(story.path("socket.csv")).expect("sockets can be made");
    fs::create_dir(story.path("folder.csv")).expect("writable");
    std::os::unix::fs::symlink("/dev/full", story.path("link.csv")).expect("links can be made");
    for (command, _, _) in OUTPUTS {
        for (name, what) in [
            ("pipe.csv", "a pipe"),
            ("socket.csv", "a socket"),
            ("folder.csv", "a folder"),
            ("link.csv", "a device"),
            ("/dev/null", "a device"),
            ("/dev/full", "a device"),
        ] {
            let folder_for_recordings = command.ends_with("--out") && name == "folder.csv";
            if !folder_for_recordings {
                refuse(
                    &story,
                    &[&split_args(command)[..], &[name]].concat(),
                    &[name, "it is", what, "expected a file"],
                );
            }
        }
    }
}

#[test]
fn one_cause_of_an_input_has_one_exit_code_in_all_commands() {
    let story = story();
    story.file("file", "");
    fs::write(story.path("garbage"), b"\xFF\0 no such thing [\n").expect("writable");
    fs::create_dir(story.path("folder")).expect("writable");
    for (command, _) in INPUTS {
        for name in ["missing", "missing/below", "file/below", "garbage", "folder"] {
            refuse(&story, &split_args(&command.replace("{}", name)), &[name]);
        }
    }
}

#[test]
fn one_cause_of_an_output_has_one_exit_code_in_all_commands() {
    let story = story();
    story.file("file", "");
    for (command, ending, _) in OUTPUTS {
        for folder in ["missing", "file", "missing/below"] {
            let name = format!("{folder}/new.{ending}");
            refuse(&story, &[&split_args(command)[..], &[&name]].concat(), &[&name, "the folder does not exist"]);
        }
    }
    for command in
        ["batch smoke --out file", "batch smoke --out file/below", "batch smoke --out file/below --shard 1/2"]
    {
        refuse(&story, &split_args(command), &["file", "expected a folder"]);
    }
}

/// Runs the program as a user without permissions on files that only permissions keep from being read or written.
#[test]
#[cfg(unix)]
fn what_may_not_be_read_or_written_is_the_environment_in_all_commands() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;

    /// The user who owns nothing.
    const NOBODY: u32 = 65534;

    let story = story();
    let allow = |name: &str, mode| fs::set_permissions(story.path(name), fs::Permissions::from_mode(mode));
    let is_root = fs::metadata("/proc/self").is_ok_and(|found| found.uid() == 0);
    // Other users may not be allowed to look where the tests are built.
    let programs = tempfile::tempdir().expect("a scratch folder");
    let program = programs.path().join("wildfire");
    fs::copy(env!("CARGO_BIN_EXE_wildfire"), &program).expect("there is room");
    fs::set_permissions(programs.path(), fs::Permissions::from_mode(0o755)).expect("it is ours");
    let tell = |arguments: &[&str]| {
        let mut command = children::command(&program);
        command.args(arguments).current_dir(story.path("."));
        if is_root {
            command.uid(NOBODY).gid(NOBODY);
        }
        Answer::of(&output_of(&mut command))
    };
    // The umask of the caller may keep all this for itself.
    let shown = output_of(children::command("chmod").args(["-R", "a+rX"]).args([&story.path("."), &program]));
    assert!(shown.status.success());
    story.file("secret", "precious");
    story.file("secret.wildfire", "precious");
    for folder in ["hidden", "fixed"] {
        fs::create_dir(story.path(folder)).expect("writable");
    }
    for (name, mode) in [("secret", 0), ("secret.wildfire", 0), ("hidden", 0), ("fixed", 0o555), (".", 0o755)] {
        allow(name, mode).expect("it is ours");
    }
    for (command, takes_folder) in INPUTS {
        let names: &[&str] = match takes_folder {
            true => &["hidden"],
            false if command.starts_with("audit") || command.starts_with("render {}") => &["secret.wildfire", "hidden"],
            false => &["secret", "hidden/below"],
        };
        for name in names {
            tell(&split_args(&command.replace("{}", name))).expect_code(3).expect_complaint(&[name]);
        }
    }
    for (command, ending, _) in OUTPUTS {
        for folder in ["fixed", "hidden"] {
            let name = format!("{folder}/new.{ending}");
            tell(&[&split_args(command)[..], &[&name]].concat()).expect_code(3).expect_complaint(&[&name]);
        }
    }
    tell(&["batch", "smoke", "--out", "fixed/new"]).expect_code(3).expect_complaint(&["fixed/new"]);
    allow("hidden", 0o755).expect("it is ours, to be removed");
}
