//! `wildfire map` told what it cannot do: a sentence that names the place, exit code 2 or 3, and nothing written.

use crate::story::{Story, refuse};

fn story() -> Story {
    let story = Story::begin();
    story.file("map.txt", "0100\n0000\n");
    story
}

fn refuse_map(story: &Story, arguments: &str, fragments: &[&str]) {
    let arguments: Vec<_> = std::iter::once("map").chain(arguments.split_whitespace()).collect();
    refuse(story, &arguments, fragments);
}

#[test]
fn goal_outside_or_in_an_obstacle_is_refused_with_file_row_and_column() {
    let story = story();
    for command in ["wavefront", "wavefront --start 1,0", "descend --start 1,0"] {
        refuse_map(
            &story,
            &format!("{command} map.txt --goal 0,1"),
            &["map.txt: the goal at row 0, column 1 is occupied"],
        );
    }
    for command in ["wavefront", "attraction", "total", "descend --start 1,0"] {
        let fragments = ["map.txt: the goal at row 2, column 0 lies outside the map of 2 rows and 4 columns"];
        refuse_map(&story, &format!("{command} map.txt --goal 2,0 --json"), &fragments);
    }
}

#[test]
fn searches_refuse_wrong_ends_as_the_wavefront_does() {
    let story = story();
    for command in
        ["astar", "dijkstra", "greedy", "theta", "jps", "rrt", "rrt-star", "prm", "voronoi", "report --out new"]
    {
        let occupied = ["map.txt: the goal at row 0, column 1 is occupied"];
        refuse_map(&story, &format!("{command} map.txt --goal 0,1 --start 1,0"), &occupied);
        let outside = ["map.txt: the goal at row 2, column 0 lies outside the map of 2 rows and 4 columns"];
        refuse_map(&story, &format!("{command} map.txt --goal 2,0 --start 1,0"), &outside);
        let start = ["map.txt: the start at row 0, column 4 lies outside the map of 2 rows and 4 columns"];
        refuse_map(&story, &format!("{command} map.txt --goal 1,0 --start 0,4"), &start);
    }
    refuse_map(&story, "report map.txt --goal 1,0 --start 1,1 --out map.txt", &["map.txt: it is not a folder"]);
    refuse_map(
        &story,
        "report map.txt --goal 1,0 --start 1,1 --out no/lab",
        &["no/lab: its parent folder does not exist"],
    );
}

#[test]
fn start_outside_the_map_is_refused() {
    let story = story();
    for command in ["wavefront", "wavefront --shortest", "descend", "descend --escape wavefront"] {
        let fragments = ["map.txt: the start at row 0, column 4 lies outside the map of 2 rows and 4 columns"];
        refuse_map(&story, &format!("{command} map.txt --goal 1,0 --start 0,4 --csv v.csv"), &fragments);
    }
}

#[test]
fn places_that_are_none_are_answered_with_what_was_expected() {
    let story = story();
    for goal in ["3", "3;4", "-1,0", "1.5,0", "a,b", "99999999999999999999,0"] {
        refuse_map(
            &story,
            &format!("wavefront map.txt --goal {goal}"),
            &[goal, "--goal", "ROW,COLUMN", "whole numbers"],
        );
    }
    refuse_map(&story, "descend map.txt --goal 1,0 --start x", &["--start", "such as 3,17"]);
}

#[test]
fn a_place_outside_that_lies_inside_as_column_and_row_is_suggested() {
    let story = story();
    story.file("wide.txt", "0000000000\n0000000000\n");
    refuse_map(&story, "wavefront wide.txt --goal 7,1", &["the goal at row 7", "did you mean 1,7?"]);
    refuse_map(&story, "astar wide.txt --goal 1,7 --start 9,0", &["the start at row 9", "did you mean 0,9?"]);
    let args = ["map", "report", "wide.txt", "--goal", "7,1", "--start", "0,0", "--out", "lab"];
    assert!(story.tell(&args).expect_code(2).stderr.contains("did you mean 1,7?"));
    let refused = story.tell(&["map", "wavefront", "wide.txt", "--goal", "7,7"]).expect_code(2).stderr;
    assert!(!refused.contains("did you mean"), "{refused}");
}

#[test]
fn neighbours_have_one_name_and_their_old_one_is_read_still() {
    let story = story();
    let values = |option: &str| {
        story.tell(&["map", "brushfire", "map.txt", option, "4", "--csv", "values.csv"]).expect_code(0);
        story.read("values.csv")
    };
    assert_eq!(values("--neighbours"), values("--connectivity"));
    let help = story.tell(&["map", "brushfire", "--help"]).expect_code(0).stdout;
    assert!(help.contains("--neighbours <4|8>") && !help.contains("--connectivity"), "{help}");
}

#[test]
fn parameters_that_make_no_sense_are_refused() {
    let story = story();
    for (arguments, fragment) in [
        ("cost map.txt --safety-distance 0", "the safety distance must be at least 1 cell, not 0"),
        ("cost map.txt --safety-distance -3", "a whole number from 1"),
        ("cost map.txt --cost-rate nan", "the cost rate must be a number"),
        ("cost map.txt --safety-min 900", "--safety-min, the cost at the outer edge"),
        ("cost map.txt --safety-max 100", "--safety-min"),
        ("cost map.txt --safety-max 2000", "must be at most --max-cost, the largest cost, not 2000"),
        ("rrt map.txt --goal 1,0 --start 1,1 --step far", "a number of cells, or `auto`"),
        ("cost map.txt --max-cost ten", "expected a number"),
        ("repulsion map.txt --q 0", "q must be a number above 0"),
        ("repulsion map.txt --eta -1", "eta must be a number from 0"),
        ("total map.txt --goal 1,0 --eta inf", "eta must be a number from 0"),
        ("descend map.txt --goal 1,0 --start 1,1 --q -1", "q must be a number above 0"),
        ("descend map.txt --goal 1,0 --start 1,1 --q 5,0", "q must be a number above 0"),
        ("descend map.txt --goal 1,0 --start 1,1 --q 5,,6", "separated by commas"),
        ("total map.txt --goal 1,0 --eta 5,6", "--q or --eta must be 1, except of `descend`, not 2"),
        (
            "descend map.txt --goal 1,0 --start 1,1 --q 1,2,3,4,5,6,7,8,9 --eta 1,2,3,4,5,6,7,8",
            "pairs of --q and --eta must be at most 64, not 72",
        ),
        ("attraction map.txt --goal 1,0 --zeta -1", "zeta must be a number"),
        ("attraction map.txt --goal 1,0 --scale -1", "the scale must be a number"),
        ("attraction map.txt --goal 1,0 --scale all", "a number or `none`"),
        ("wavefront map.txt --goal 1,0 --scale -1", "the scale must be a number above 0"),
        ("wavefront map.txt --goal 1,0 --scale 0", "the scale must be a number above 0"),
        ("wavefront map.txt --goal 1,0 --scale all", "a number or `none`"),
        ("jps map.txt --goal 1,0 --start 1,1 --neighbours 4", "possible values: 8"),
        ("rrt map.txt --goal 1,0 --start 1,1 --step 0", "the step must be a number of cells from 0.1"),
        ("rrt map.txt --goal 1,0 --start 1,1 --goal-bias 2", "the goal bias must be a number from 0 to 1, not 2"),
        ("rrt-star map.txt --goal 1,0 --start 1,1 --samples 0", "the number of samples must be from 1 to 100000"),
        ("rrt-star map.txt --goal 1,0 --start 1,1 --radius 0", "the radius must be a number above 0"),
        ("prm map.txt --goal 1,0 --start 1,1 --neighbours 5000", "the number of neighbours must be from 1 to 1000"),
        ("brushfire map.txt --connectivity 6", "possible values: 4, 8"),
        ("occupancy map.txt --tolerance 256", "from 0 to 255"),
        ("occupancy map.txt --tolerance -1", "from 0 to 255"),
        ("occupancy map.txt --remove-edges -1", "from 0 to 32767"),
    ] {
        refuse_map(&story, &format!("{arguments} --csv values.csv"), &[fragment]);
    }
}

#[test]
fn options_that_do_not_go_together_are_refused() {
    let story = story();
    for (arguments, fragment) in [
        ("descend map.txt --goal 1,0", "--start"),
        ("descend map.txt --start 1,0", "--goal"),
        ("wavefront map.txt", "--goal"),
        ("astar map.txt --goal 1,0", "--start"),
        ("voronoi map.txt --goal 1,0", "--start"),
        ("voronoi map.txt --path path.csv", "--path needs --start"),
        ("euclidean map.txt --gif film.gif", "--gif"),
        ("rrt map.txt --goal 1,0 --start 1,1 --expansions order.csv", "--expansions"),
        ("wavefront map.txt --goal 1,0 --shortest", "--start"),
        ("wavefront map.txt --goal 1,0 --tie-order west-first", "--start"),
        ("wavefront map.txt --goal 1,0 --start 1,1 --shortest --tie-order west-first", "cannot be used with"),
        ("wavefront map.txt --goal 1,0 --path path.csv", "--path needs --start"),
        ("brushfire map.txt --path path.csv", "--path needs --start"),
        ("brushfire map.txt --colormap jet", "--png"),
        ("brushfire map.txt --values", "--png"),
        ("brushfire map.txt --png x.png --values --resize 61x2", "61 columns and 2 rows; expected at most 60 of each"),
        ("descend map.txt --goal 1,0 --start 1,1 --q 5,6 --npy x.npy", "--npy is for a single descent"),
        ("descend map.txt --goal 1,0 --start 1,1 --q 5,6 --png x.png --values", "--values is for a single descent"),
        ("brushfire map.txt --goal 1,0", "--goal"),
        ("brushfire", "MAP"),
        ("timing", "MAP"),
        ("timing map.txt --csv values.csv", "--csv"),
        ("", "brushfire"),
    ] {
        refuse_map(&story, arguments, &[fragment]);
    }
}

#[test]
fn files_that_are_no_maps_are_refused_with_the_place() {
    let story = story();
    story.file("ragged.txt", "000\n00\n");
    story.file("letter.txt", "000\n0x0\n");
    story.file("empty.txt", "");
    std::fs::create_dir(story.path("folder")).expect("writable");
    for (map, fragment) in [
        ("ragged.txt", "ragged.txt: row 1, column 2"),
        ("letter.txt", "letter.txt: row 1, column 1"),
        ("empty.txt", "empty.txt: the file is empty"),
        ("folder", "folder: this is a folder"),
        ("nowhere.txt", "nowhere.txt: cannot be read"),
    ] {
        refuse_map(&story, &format!("brushfire {map} --csv values.csv"), &[fragment]);
        refuse_map(&story, &format!("timing {map}"), &[fragment]);
    }
}

#[test]
fn one_file_for_two_purposes_is_refused() {
    let story = story();
    refuse_map(&story, "brushfire map.txt --csv a --npy ./a", &["a is named for two files"]);
    refuse_map(&story, "brushfire map.txt --png map.txt", &["map.txt is named for two files"]);
    assert_eq!(story.read("map.txt"), "0100\n0000\n");
}

#[test]
fn places_in_no_folder_are_refused_and_nothing_is_computed() {
    let story = story();
    for output in ["--csv", "--npy", "--png", "--overlay", "--surface", "--path"] {
        let arguments = ["map", "wavefront", "map.txt", "--goal", "1,0", "--start", "1,1", output, "nowhere/file"];
        refuse(&story, &arguments, &["nowhere/file", "the folder does not exist"]);
    }
    refuse_map(&story, "brushfire map.txt --csv .", &["cannot write .: it is a folder"]);
}

#[test]
#[cfg(target_os = "linux")]
fn file_that_cannot_be_written_costs_neither_the_answer_nor_the_other_files() {
    let story = story();
    let arguments = ["map", "brushfire", "map.txt", "--csv", "/sys/v.csv", "--npy", "values.npy"];
    let answer =
        story.tell(&arguments).expect_code(3).expect_complaint(&["cannot write /sys/v.csv", "wrote values.npy"]);
    assert!(answer.stdout.contains("maximum 3"), "{}", answer.stdout);
    assert_eq!(story.entries(), ["map.txt", "values.npy"]);
}

#[test]
fn tolerance_on_a_map_without_greys_is_noted() {
    let answer = story().tell(&["map", "occupancy", "map.txt", "--tolerance", "90", "--json"]).expect_code(0);
    assert_eq!(answer.stderr, "--tolerance has no effect: the map is not an image.\n");
}
