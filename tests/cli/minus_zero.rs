//! Zero with a minus, in every option that takes a number: it is zero, and nothing else comes of it.

use crate::story::{Answer, Story};

/// Commands with an option that takes a number, with `@` in its place; the rest is right.
const COMMANDS: &[&str] = &[
    "run smoke --seed @ --events events.csv",
    "run smoke --trace trace.csv --step @",
    "batch smoke --jobs @",
    "batch smoke --seeds 1 --dry-run --set unimog.vehicle.rear_overhang_m=@",
    "audit run.wildfire --jobs @",
    "audit run.wildfire --step @",
    "curve --from @,@,@ --to 1,2,3",
    "curve --from 1,2,3 --to @,@,@",
    "curve --from 0,0,0 --to 1,2,3 --radius @",
    "curve --from 0,0,0 --to 1,2,3 --reverse-factor @",
    "curve --from 0,0,0 --to 1,2,3 --cusp-m @",
    "curve --from 0,0,0 --to 1,2,3 --reverse-factor @ --cusp-m @ --json",
    "curve --from 0,0,0 --to 1,2,3 --csv poses.csv --step @",
    "map occupancy map.txt --remove-edges @",
    "map occupancy map.pgm --tolerance @",
    "map cost map.txt --max-cost @",
    "map cost map.txt --safety-max @",
    "map cost map.txt --safety-min @",
    "map cost map.txt --safety-distance @",
    "map cost map.txt --cost-rate @",
    "map wavefront map.txt --goal @,@",
    "map wavefront map.txt --goal 0,0 --start @,@",
    "map wavefront map.txt --goal 0,0 --scale @",
    "map attraction map.txt --goal 0,0 --zeta @",
    "map attraction map.txt --goal 0,0 --scale @",
    "map repulsion map.txt --q @",
    "map repulsion map.txt --eta @",
    "map descend map.txt --goal 0,0 --start @,1",
    "plan --scenario smoke --goals 1 --seed @",
    "plan --scenario smoke --goals @",
    "plan --scenario smoke --cells @",
    "render run.wildfire -o still.png --size 320x240 --at @",
    "render run.wildfire -o still.png --size 320x240 --zoom @",
    "render run.wildfire -o still.png --size 320x240 --zoom 2 --centre @,@",
    "render run.wildfire -o still.png --size 320x240 --select @,@",
    "render smoke -o still.png --size 320x240 --seed @ --with-seed @",
    "render run.wildfire --gif film.gif --size 320x240 --from @ --to 60",
    "render run.wildfire --gif film.gif --size 320x240 --to @",
    "render run.wildfire --gif film.gif --size 320x240 --speed @",
    "render run.wildfire --gif film.gif --size 320x240 --fps @",
];

fn story() -> Story {
    let story = Story::begin();
    story.tell(&["--quiet", "run", "smoke", "--out", "run.wildfire"]).expect_code(0);
    story.file("map.txt", "0000\n0010\n0000\n");
    story.file("map.pgm", "P2 4 1 255\n0 10 60 255\n");
    story
}

fn tell(story: &Story, command: &str, number: &str) -> Answer {
    let line = command.replace('@', number);
    story.tell(&line.split(' ').collect::<Vec<_>>())
}

/// Returns the lines of an answer except measured ones, without the sign of the number that was asked for.
fn printed_lines(text: &str) -> Vec<String> {
    let lines = text.lines().take_while(|line| !line.contains("CPU") && !line.contains(" ms"));
    lines.map(|line| line.replace("-0", "0").replace("0.0", "0")).collect()
}

#[test]
fn minus_zero_is_zero_in_every_option_that_takes_a_number() {
    let story = story();
    let files = ["events.csv", "still.png", "film.gif", "poses.csv"];
    let written = || files.map(|name| std::fs::read(story.path(name)).ok());
    for command in COMMANDS {
        let zero = tell(&story, command, "0");
        let expected = written();
        assert!(matches!(zero.code, Some(0 | 2)), "{command}: {:?} {}", zero.code, zero.stderr);
        for number in ["-0", "-0.0"] {
            let found = tell(&story, command, number);
            if number == "-0.0" && zero.code == Some(0) && found.code == Some(2) {
                // Whole numbers have no point, with a minus or without.
                assert_eq!(tell(&story, command, "0.0").code, Some(2), "{command}: {}", found.stderr);
                continue;
            }
            assert_eq!(found.code, zero.code, "{command} with {number}: {}", found.stderr);
            assert_eq!(printed_lines(&found.stdout), printed_lines(&zero.stdout), "{command} with {number}");
            assert!(!found.stderr.contains("panicked"), "{command} with {number}: {}", found.stderr);
            assert!(written() == expected, "{command} writes something else with {number}");
        }
    }
}

#[test]
fn a_reverse_factor_of_minus_zero_makes_a_curve() {
    let arguments = ["curve", "--from", "0,0,0", "--to", "1,2,3", "--reverse-factor", "-0"];
    let answer = Story::begin().tell(&arguments).expect_code(0);
    assert!(answer.stdout.contains("Reeds-Shepp"), "{}", answer.stdout);
}

#[test]
fn minus_zero_in_a_table_of_pairs_is_zero() {
    let story = Story::begin();
    let lengths = |zero: &str| {
        story.file("pairs.csv", &format!("x0,y0,th0,x1,y1,th1\n{zero},{zero},{zero},{zero},5,{zero}\n"));
        story.tell(&["curve", "--pairs", "pairs.csv", "--csv", "lengths.csv"]).expect_code(0);
        story.read("lengths.csv").lines().map(|line| line.replace(zero, "0")).collect::<Vec<_>>()
    };
    assert_eq!(lengths("-0.0"), lengths("0.0"));
}
