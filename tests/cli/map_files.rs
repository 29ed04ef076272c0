//! `wildfire map`: the files that it was asked for appear, and are what they are called.

use std::fs;

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
