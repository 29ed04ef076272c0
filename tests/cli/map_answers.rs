//! `wildfire map`: values, ways and words, checked by hand on maps of a few cells.

use std::f64::consts::SQRT_2;

use serde_json::{Value, json};

use crate::story::{Answer, Story, widest};

/// A U that opens to the west; goals lie behind it.
const TRAP: &str = "000000\n011100\n000100\n011100\n";

fn story() -> Story {
    let story = Story::begin();
    story.file("trap.txt", TRAP);
    story.file("line.txt", &format!("1{}\n", "0".repeat(49)));
    story.file("open.txt", "000\n000\n");
    story.file("full.txt", "11\n11\n");
    story.file("cell.txt", "0\n");
    story.file("enclosed.txt", "00000\n01110\n01010\n01110\n00000\n");
    story
}

/// What `wildfire map` answers with success.
fn tell(story: &Story, arguments: &str) -> Answer {
    let arguments: Vec<_> = std::iter::once("map").chain(arguments.split_whitespace()).collect();
    story.tell(&arguments).expect_code(0)
}

/// The lines of the values that a command writes.
fn values(story: &Story, arguments: &str) -> Vec<String> {
    tell(story, &format!("{arguments} --csv values.csv"));
    story.read("values.csv").lines().map(str::to_owned).collect()
}

fn path(story: &Story, arguments: &str) -> Vec<String> {
    tell(story, &format!("{arguments} --path path.csv"));
    story.read("path.csv").lines().map(str::to_owned).collect()
}

fn object(story: &Story, arguments: &str) -> Value {
    let stdout = tell(story, &format!("{arguments} --json")).stdout;
    assert_eq!(stdout.lines().count(), 1, "{stdout}");
    serde_json::from_str(&stdout).expect("the answer is JSON")
}

#[test]
fn occupancy_is_told_by_the_tolerance_and_edges_can_be_removed() {
    let story = story();
    story.file("grey.pgm", "P2\n4 3\n255\n0 0 0 0\n49 50 51 255\n0 0 0 0\n");
    assert_eq!(values(&story, "occupancy grey.pgm"), ["1,1,1,1", "1,1,0,0", "1,1,1,1"]);
    assert_eq!(values(&story, "occupancy grey.pgm --tolerance 49"), ["1,1,1,1", "1,0,0,0", "1,1,1,1"]);
    assert_eq!(values(&story, "occupancy grey.pgm --remove-edges 1"), ["0,0,0,0", "0,1,0,0", "0,0,0,0"]);
    assert_eq!(values(&story, "occupancy grey.pgm --remove-edges 9"), ["0,0,0,0"; 3]);
}

#[test]
fn brushfire_counts_from_obstacles() {
    let story = story();
    let eight = ["2,2,2,2,2,3", "2,1,1,1,2,3", "2,2,2,1,2,3", "2,1,1,1,2,3"];
    assert_eq!(values(&story, "brushfire trap.txt"), eight);
    assert_eq!(values(&story, "brushfire trap.txt --connectivity 8"), eight);
    let four = ["3,2,2,2,3,4", "2,1,1,1,2,3", "3,2,2,1,2,3", "2,1,1,1,2,3"];
    assert_eq!(values(&story, "brushfire trap.txt --connectivity 4"), four);
    let from_zero = ["1,1,1,1,1,2", "1,0,0,0,1,2", "1,1,1,0,1,2", "1,0,0,0,1,2"];
    assert_eq!(values(&story, "brushfire trap.txt --convention obstacle-zero"), from_zero);
}

#[test]
fn cost_falls_in_two_zones() {
    let story = story();
    let at = |arguments: &str, distances: &[usize]| {
        let line = values(&story, &format!("cost line.txt {arguments}")).remove(0);
        let costs: Vec<_> = line.split(',').collect();
        distances.iter().map(|&distance| costs[distance].to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(at("", &[0, 1, 11, 12, 33, 34, 49]), ["1000", "775", "525", "320", "5", "0", "0"]);
    assert_eq!(at("--form continuous", &[0, 1, 11, 12, 13, 45, 46]), ["1000", "775", "525", "500", "485", "5", "0"]);
    let changed = "--max-cost 100 --safety-max 50 --safety-min 20 --safety-distance 3 --cost-rate 0.5";
    assert_eq!(at(changed, &[0, 1, 2, 3, 4, 40, 41]), ["100", "40", "30", "18.5", "18", "0", "0"]);
}

#[test]
fn wavefront_counts_steps_to_the_goal() {
    let story = story();
    let eight = ["7,6,5,4,4,4", "7,1,1,1,3,3", "8,8,9,1,3,2", "9,1,1,1,3,3"];
    assert_eq!(values(&story, "wavefront trap.txt --goal 2,5"), eight);
    let four = ["9,8,7,6,5,4", "10,1,1,1,4,3", "11,12,13,1,3,2", "12,1,1,1,4,3"];
    assert_eq!(values(&story, "wavefront trap.txt --goal 2,5 --connectivity 4"), four);
    assert_eq!(values(&story, "wavefront trap.txt --goal 2,5 --connectivity 4 --no-corner-cutting"), four);
    let corners = ["8,7,6,5,4,4", "9,1,1,1,3,3", "10,11,12,1,3,2", "11,1,1,1,3,3"];
    assert_eq!(values(&story, "wavefront trap.txt --goal 2,5 --no-corner-cutting"), corners);
    let scaled = values(&story, "wavefront trap.txt --goal 2,5 --connectivity 4 --scale 26");
    assert_eq!(scaled[2], "22,24,26,2,6,4", "obstacles are scaled like all values");
}

#[test]
fn path_follows_the_order_that_was_asked_for() {
    let story = story();
    assert_eq!(path(&story, "wavefront open.txt --goal 1,2 --start 0,0"), ["0,0", "0,1", "1,2"]);
    let west = "wavefront open.txt --goal 1,2 --start 0,0 --tie-order west-first";
    assert_eq!(path(&story, west), ["0,0", "0,1", "1,2"]);
    let four = "wavefront open.txt --goal 1,2 --start 0,0 --connectivity 4";
    assert_eq!(path(&story, four), ["0,0", "1,0", "1,1", "1,2"]);
    assert_eq!(path(&story, &format!("{four} --tie-order west-first")), ["0,0", "0,1", "0,2", "1,2"]);
    assert_eq!(path(&story, "wavefront open.txt --goal 1,2 --start 1,2"), ["1,2"]);
}

#[test]
fn shortest_path_beats_the_one_with_the_fewest_steps() {
    let story = story();
    // Two lanes of six steps: the upper begins straight on and then zigzags, the lower is straight for longer.
    story.file("lanes.txt", "1101011\n0010101\n1011110\n1100001\n");
    let answer = |more: &str| object(&story, &format!("wavefront lanes.txt --start 1,0 --goal 2,6 {more}"));
    let (few, short) = (answer(""), answer("--shortest"));
    assert_eq!((&few["steps"], &short["steps"]), (&json!(6), &json!(6)));
    let close = |length: &Value, expected: f64| length.as_f64().is_some_and(|length| (length - expected).abs() < 1e-12);
    assert!(close(&few["length"], 1.0 + 5.0 * SQRT_2) && close(&short["length"], 3.0 + 3.0 * SQRT_2), "{few} {short}");
    let around = |more: &str| object(&story, &format!("wavefront trap.txt --goal 2,5 --start 2,1 --shortest {more}"));
    assert!(close(&around("")["length"], 2.0 + 4.0 * SQRT_2));
    assert!(close(&around("--no-corner-cutting")["length"], 8.0 + SQRT_2));
    assert!(close(&around("--connectivity 4")["length"], 10.0));
}

#[test]
fn attraction_grows_with_the_distance_from_the_goal() {
    let story = story();
    assert_eq!(values(&story, "attraction open.txt --goal 0,0 --scale none"), ["0,0.5,2", "0.5,1,2.5"]);
    assert_eq!(values(&story, "attraction open.txt --goal 0,0"), ["0,2,8", "2,4,10"]);
    assert_eq!(values(&story, "attraction open.txt --goal 0,0 --scale 5"), ["0,1,4", "1,2,5"]);
    assert_eq!(values(&story, "attraction open.txt --goal 0,0 --scale none --zeta 2"), ["0,1,4", "1,2,5"]);
    let manhattan = "attraction open.txt --goal 0,0 --distance manhattan --scale none";
    assert_eq!(values(&story, manhattan), ["0,1,2", "1,2,3"]);
}

#[test]
fn repulsion_falls_with_the_brushfire_value() {
    let story = story();
    let first = |arguments: &str| {
        let line = values(&story, &format!("repulsion line.txt {arguments}")).remove(0);
        line.split(',').take(6).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(first(""), "4.8 0.675 0.133333333333 0.01875 0 0");
    assert_eq!(first("--q 2 --eta 8"), "1 0 0 0 0 0");
    assert_eq!(first("--true-distance"), "inf 4.8 0.675 0.133333333333 0.01875 0");
}

#[test]
fn total_is_the_sum_of_both() {
    let story = story();
    let sum = values(&story, "total line.txt --goal 0,5 --scale none").remove(0);
    let parts: Vec<_> = sum.split(',').take(7).collect();
    assert_eq!(parts, ["17.3", "8.675", "4.63333333333", "2.01875", "0.5", "0", "0.5"]);
}

#[test]
fn descent_is_stuck_in_the_trap_and_the_wavefront_leads_on() {
    let story = story();
    let descend = "descend trap.txt --goal 2,5 --start 2,1";
    let stuck = object(&story, descend);
    assert_eq!((&stuck["answer"], &stuck["minimum"]), (&json!("stuck"), &json!([2, 2])));
    assert_eq!((&stuck["path"], &stuck["steps"]), (&json!([[2, 1], [2, 2]]), &json!(1)));
    let printed = tell(&story, descend).stdout;
    assert!(printed.contains("Stuck in a local minimum at row 2, column 2: 1 step, length 1.000."), "{printed}");
    let led = object(&story, &format!("{descend} --escape wavefront"));
    assert_eq!((&led["answer"], &led["minimum"]), (&json!("reached"), &json!([2, 2])));
    let cells = led["path"].as_array().expect("there is a path");
    assert_eq!((cells.first(), cells.last()), (Some(&json!([2, 1])), Some(&json!([2, 5]))));
    assert_eq!(led["path_cells"], json!(cells.len()));
    assert!(cells.windows(2).all(|pair| pair[0] != pair[1]), "no cell twice in a row");
}

#[test]
fn descent_that_arrives_is_told_with_its_length() {
    let story = story();
    let descend = "descend open.txt --goal 1,2 --start 0,0";
    let answer = object(&story, descend);
    assert_eq!((&answer["answer"], &answer["minimum"]), (&json!("reached"), &Value::Null));
    assert_eq!(answer["steps"], json!(2));
    assert!(tell(&story, descend).stdout.contains("Reached the goal: 2 steps, length 2.414."));
    let corners = object(&story, "descend trap.txt --goal 0,2 --start 2,1 --no-corner-cutting");
    assert_eq!(corners["parameters"]["no_corner_cutting"], json!(true));
}

#[test]
fn a_sweep_has_the_descents_of_its_pairs() {
    let story = story();
    let descend = "descend trap.txt --goal 2,5 --start 2,1";
    let swept = object(&story, &format!("{descend} --q 1,5 --eta 0,15"));
    let descents = swept["descents"].as_array().expect("a list");
    let pairs = [(1.0, 0.0), (1.0, 15.0), (5.0, 0.0), (5.0, 15.0)];
    assert_eq!(descents.len(), pairs.len());
    for (descent, (q, eta)) in descents.iter().zip(pairs) {
        let alone = object(&story, &format!("{descend} --q {q} --eta {eta}"));
        for member in ["answer", "minimum", "steps", "length", "maximum"] {
            assert_eq!(descent[member], alone[member], "{member} of {q}, {eta}");
        }
        assert_eq!((&descent["q"], &descent["eta"]), (&json!(q), &json!(eta)));
    }
    let rows = values(&story, &format!("{descend} --q 1,5 --eta 0,15"));
    assert_eq!((rows.len(), rows[0].as_str()), (5, "q,eta,answer,steps,length,minimum_row,minimum_col"));
    tell(&story, &format!("{descend} --q 1,5 --png sheet.png"));
    assert_eq!(values(&story, "occupancy sheet.png"), values(&story, "occupancy trap.txt"), "the sheet is a map too");
}

#[test]
fn values_in_cells_leave_the_map_as_it_is() {
    let story = story();
    tell(&story, "brushfire trap.txt --png bare.png");
    tell(&story, "brushfire trap.txt --values --png written.png");
    let sizes = ["bare.png", "written.png"].map(|name| image::image_dimensions(story.path(name)).expect("a picture"));
    assert_eq!(sizes[0], sizes[1]);
    assert_ne!(std::fs::read(story.path("bare.png")).ok(), std::fs::read(story.path("written.png")).ok());
    assert_eq!(values(&story, "brushfire written.png"), values(&story, "brushfire trap.txt"));
}

#[test]
fn map_without_obstacles_is_said_and_zero() {
    let story = story();
    for computation in ["brushfire", "brushfire --connectivity 4", "cost", "repulsion", "repulsion --true-distance"] {
        assert_eq!(values(&story, &format!("{computation} open.txt")), ["0,0,0"; 2], "{computation}");
        let printed = tell(&story, &format!("{computation} open.txt")).stdout;
        assert!(printed.contains("No obstacle: no cell of the map is occupied."), "{printed}");
        let answer = object(&story, &format!("{computation} open.txt"));
        assert_eq!((&answer["no_obstacle"], &answer["occupied"]), (&json!(true), &json!(0)));
    }
    let note = tell(&story, "brushfire open.txt --json").stderr;
    assert_eq!(note, "No obstacle: no cell of the map is occupied.\n");
    assert!(tell(&story, "brushfire open.txt --json --quiet").stderr.is_empty());
    assert_eq!(object(&story, "brushfire trap.txt")["no_obstacle"], json!(false));
}

#[test]
fn full_map_is_all_obstacle() {
    let story = story();
    assert_eq!(values(&story, "brushfire full.txt"), ["1,1"; 2]);
    assert_eq!(values(&story, "cost full.txt"), ["1000,1000"; 2]);
    assert_eq!(values(&story, "repulsion full.txt"), ["4.8,4.8"; 2]);
    assert_eq!(values(&story, "total full.txt --goal 0,0"), ["4.8,9.8", "9.8,14.8"]);
    assert_eq!(object(&story, "total full.txt --goal 0,0 --true-distance")["maximum"], Value::Null);
    let printed = tell(&story, "attraction full.txt --goal 1,1").stdout;
    assert!(printed.contains("The goal, row 1, column 1, lies in an obstacle."), "{printed}");
    assert!(printed.contains("No free cell"), "{printed}");
}

#[test]
fn enclosed_goal_and_unreachable_start_are_answers() {
    let story = story();
    for search in ["wavefront", "wavefront --shortest", "wavefront --connectivity 4"] {
        for (start, goal) in [("0,0", "2,2"), ("2,2", "0,0")] {
            let arguments = format!("{search} enclosed.txt --goal {goal} --start {start}");
            let answer = object(&story, &arguments);
            assert_eq!(answer["answer"], json!("unreachable"), "{arguments}");
            assert_eq!(
                (&answer["path"], &answer["steps"], &answer["length"]),
                (&Value::Null, &Value::Null, &Value::Null)
            );
            assert!(tell(&story, &arguments).stdout.contains("Unreachable: no path leads from the start"));
            assert!(path(&story, &arguments).is_empty());
        }
    }
    assert_eq!(object(&story, "wavefront enclosed.txt --goal 2,2")["unreached"], json!(16));
    assert_eq!(values(&story, "wavefront enclosed.txt --goal 2,2")[2], "0,1,2,1,0");
    let escape = object(&story, "descend enclosed.txt --goal 2,2 --start 0,0 --escape wavefront");
    assert_eq!(escape["answer"], json!("unreachable"));
    assert!(!escape["minimum"].is_null());
    assert_eq!(object(&story, "descend enclosed.txt --goal 2,2 --start 0,0")["answer"], json!("stuck"));
}

#[test]
fn start_in_an_obstacle_is_an_answer() {
    let story = story();
    for search in ["wavefront", "wavefront --shortest", "descend", "descend --escape wavefront"] {
        let arguments = format!("{search} trap.txt --goal 2,5 --start 1,1");
        let answer = object(&story, &arguments);
        assert_eq!((&answer["answer"], &answer["path"]), (&json!("start-occupied"), &Value::Null), "{arguments}");
        assert!(tell(&story, &arguments).stdout.contains("the start, row 1, column 1, lies in an obstacle"));
    }
}

#[test]
fn map_of_one_cell_has_every_answer() {
    let story = story();
    for (computation, value) in [
        ("occupancy", "0"),
        ("brushfire", "0"),
        ("cost", "0"),
        ("wavefront --goal 0,0 --start 0,0", "2"),
        ("wavefront --goal 0,0 --start 0,0 --shortest", "2"),
        ("attraction --goal 0,0", "0"),
        ("total --goal 0,0", "0"),
        ("descend --goal 0,0 --start 0,0", "0"),
    ] {
        assert_eq!(values(&story, &format!("{computation} cell.txt")), [value], "{computation}");
    }
}

#[test]
fn json_has_its_members_in_one_order() {
    let story = story();
    let members = "program_version map rows cols cells occupied no_obstacle tolerance near_tolerance remove_edges \
                   command parameters maximum unreached answer minimum path_cells steps length cost shortest_cost cost_bound expansions touched samples vertices \
                   edges path notes measured";
    for arguments in
        ["occupancy trap.txt", "wavefront trap.txt --goal 2,5 --start 0,0", "descend trap.txt --goal 2,5 --start 2,1"]
    {
        let stdout = tell(&story, &format!("{arguments} --json")).stdout;
        let places: Vec<_> = members.split_whitespace().map(|name| stdout.find(&format!("\"{name}\":"))).collect();
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{stdout}");
        let count = object(&story, arguments).as_object().map(serde_json::Map::len);
        assert_eq!(count, Some(members.split_whitespace().count()), "{stdout}");
    }
}

#[test]
fn json_tells_what_was_asked_and_what_came_of_it() {
    let story = story();
    let answer = object(&story, "wavefront trap.txt --goal 2,5 --start 2,1");
    let parameters = json!({
        "goal": [2, 5], "start": [2, 1], "connectivity": 8, "tie_order": "cross-first", "shortest": false,
        "no_corner_cutting": false, "scale": null,
    });
    assert_eq!(answer["parameters"], parameters);
    assert_eq!((&answer["map"], &answer["command"]), (&json!("trap.txt"), &json!("wavefront")));
    assert_eq!((&answer["rows"], &answer["cols"], &answer["cells"]), (&json!(4), &json!(6), &json!(24)));
    assert_eq!((&answer["occupied"], &answer["maximum"], &answer["unreached"]), (&json!(7), &json!(9), &json!(0)));
    assert_eq!((&answer["steps"], &answer["path_cells"]), (&json!(6), &json!(7)));
    assert_eq!(answer["tolerance"], Value::Null);
    for name in ["cpu_read_s", "cpu_map_s", "cpu_path_s"] {
        assert!(answer["measured"][name].as_f64().is_some_and(|seconds| seconds >= 0.0), "{name}");
    }
    let plain = object(&story, "occupancy trap.txt");
    assert_eq!(plain["measured"]["cpu_path_s"], Value::Null);
    for name in ["unreached", "answer", "minimum", "path_cells", "steps", "length", "path"] {
        assert_eq!(plain[name], Value::Null, "{name}");
    }
}

#[test]
fn searches_answer_cost_expansions_and_cells_touched() {
    let story = story();
    for (command, cost) in
        [("astar", 2.0 + 4.0 * SQRT_2), ("dijkstra", 2.0 + 4.0 * SQRT_2), ("jps", 2.0 + 4.0 * SQRT_2)]
    {
        let answer = object(&story, &format!("{command} trap.txt --goal 2,5 --start 2,1"));
        assert_eq!((&answer["answer"], &answer["command"]), (&json!("reached"), &json!(command)));
        assert!(answer["cost"].as_f64().is_some_and(|found| (found - cost).abs() < 1e-12), "{answer}");
        assert_eq!((&answer["cost"], &answer["path_cells"]), (&answer["length"], &json!(7)));
        let (expansions, touched) = (answer["expansions"].as_u64(), answer["touched"].as_u64());
        assert!(expansions > Some(2) && expansions <= touched && touched <= Some(17), "{answer}");
    }
    let corners = object(&story, "astar trap.txt --goal 2,5 --start 2,1 --no-corner-cutting");
    assert!(corners["cost"].as_f64().is_some_and(|found| (found - 8.0 - SQRT_2).abs() < 1e-12));
    let four = object(&story, "greedy trap.txt --goal 2,5 --start 2,1 --connectivity 4");
    assert_eq!((&four["answer"], &four["cost"]), (&json!("reached"), &json!(10.0)));
    let printed = tell(&story, "astar trap.txt --goal 2,5 --start 2,1").stdout;
    assert!(
        printed.contains("Reached the goal: 6 steps, length 7.657.") && printed.contains("touched, cost 7.657."),
        "{printed}"
    );
    let values = values(&story, "dijkstra open.txt --goal 1,2 --start 0,0");
    assert_eq!(values, ["0,1,2", "1,1.41421356237,2.41421356237"]);
}

#[test]
fn order_of_expansion_is_a_table_and_a_film() {
    let story = story();
    tell(&story, "dijkstra open.txt --goal 1,2 --start 0,0 --expansions order.csv --gif film.gif");
    let order = "order,row,col,cost\n0,0,0,0\n1,0,1,1\n2,1,0,1\n3,1,1,1.41421356237\n4,0,2,2\n";
    assert_eq!(story.read("order.csv"), order);
    let film = std::fs::read(story.path("film.gif")).expect("it was written");
    assert!(film.starts_with(b"GIF89a"));
    tell(&story, "prm open.txt --goal 1,2 --start 0,0 --samples 5 --edges edges.csv --gif roadmap.gif --surface s.png");
    let edges = story.read("edges.csv");
    assert!(edges.starts_with("order,from_row,from_col,to_row,to_col\n0,0,0,"), "{edges}");
}

#[test]
fn any_angle_path_is_a_row_of_turning_cells() {
    let story = story();
    assert_eq!(path(&story, "theta open.txt --goal 1,2 --start 0,0"), ["0,0", "1,2"]);
    let answer = object(&story, "theta open.txt --goal 1,2 --start 0,0");
    assert_eq!((&answer["steps"], &answer["cost"]), (&json!(1), &json!(5.0_f64.sqrt())));
    assert!(tell(&story, "theta open.txt --goal 1,2 --start 0,0").stdout.contains("1 segment, length 2.236."));
    let around = path(&story, "theta trap.txt --goal 2,5 --start 2,1 --no-corner-cutting");
    assert_eq!((around.first().map(String::as_str), around.last().map(String::as_str)), (Some("2,1"), Some("2,5")));
}

#[test]
fn euclidean_distances_are_exact() {
    let story = story();
    let found = values(&story, "euclidean trap.txt");
    assert_eq!(found[0], "1.41421356237,1,1,1,1.41421356237,2.2360679775");
    assert_eq!(found[2], "1.41421356237,1,1,0,1,2");
    assert_eq!(values(&story, "euclidean open.txt"), ["0,0,0"; 2]);
    assert!(tell(&story, "euclidean open.txt").stdout.contains("No obstacle"));
}

#[test]
fn diagram_lies_between_the_walls_and_a_path_keeps_to_it() {
    let story = story();
    story.file("room.txt", &"000000000\n".repeat(5));
    let diagram = values(&story, "voronoi room.txt");
    assert_eq!(diagram[1], "0,2,0,0,0,0,0,2,0");
    assert_eq!(diagram[2], "0,0,3,3,3,3,3,0,0");
    let way = path(&story, "voronoi room.txt --start 2,0 --goal 2,8");
    assert_eq!((way[0].as_str(), way[8].as_str(), way.len()), ("2,0", "2,8", 9));
    assert!((2..7).all(|col| way[col] == format!("2,{col}")), "{way:?}");
    assert_eq!(object(&story, "voronoi room.txt")["answer"], Value::Null);
}

#[test]
fn trees_and_roadmaps_answer_by_their_seed() {
    let story = story();
    for command in ["rrt", "rrt-star --samples 300", "prm --samples 100"] {
        let arguments = format!("{command} trap.txt --goal 2,5 --start 2,1 --seed 3");
        let (answer, again) = (object(&story, &arguments), object(&story, &arguments));
        assert_eq!((&answer["answer"], &answer["path"]), (&json!("reached"), &again["path"]), "{command}");
        let cells = answer["path"].as_array().expect("a path");
        assert_eq!((cells.first(), cells.last()), (Some(&json!([2.0, 1.0])), Some(&json!([2.0, 5.0]))));
        assert_eq!(answer["cost"], answer["length"]);
        assert!(answer["vertices"].as_u64() > Some(2) && answer["edges"].as_u64() > Some(2), "{answer}");
        let way = path(&story, &arguments);
        assert_eq!((way[0].as_str(), way[way.len() - 1].as_str()), ("2,1", "2,5"));
        let other = object(&story, &format!("{command} trap.txt --goal 2,5 --start 2,1 --seed 4"));
        assert_ne!(answer["path"], other["path"], "{command}");
    }
    let closed = object(&story, "rrt enclosed.txt --goal 2,2 --start 0,0 --samples 50");
    assert_eq!(
        (&closed["answer"], &closed["samples"], &closed["path"]),
        (&json!("not-found"), &json!(50), &Value::Null)
    );
    assert!(tell(&story, "rrt enclosed.txt --goal 2,2 --start 0,0 --samples 50").stdout.contains("No path found"));
}

#[test]
fn every_search_answers_an_occupied_start_and_a_walled_goal() {
    let story = story();
    for search in ["astar", "dijkstra", "greedy", "theta", "jps", "rrt --samples 9", "rrt-star --samples 9", "prm"] {
        let answer = object(&story, &format!("{search} trap.txt --goal 2,5 --start 1,1"));
        assert_eq!((&answer["answer"], &answer["path"]), (&json!("start-occupied"), &Value::Null), "{search}");
        let answer = object(&story, &format!("{search} enclosed.txt --goal 2,2 --start 0,0"));
        let is_tree = search.starts_with("rrt") || search == "prm";
        assert_eq!(answer["answer"], json!(if is_tree { "not-found" } else { "unreachable" }), "{search}");
        let answer = object(&story, &format!("{search} cell.txt --goal 0,0 --start 0,0"));
        assert_eq!((&answer["answer"], &answer["cost"]), (&json!("reached"), &json!(0.0)), "{search}");
    }
}

#[test]
fn pictures_of_maps_are_maps_again() {
    let story = story();
    let map = values(&story, "occupancy trap.txt");
    for (computation, picture) in
        [("occupancy", "png"), ("brushfire", "overlay"), ("wavefront --goal 2,5", "surface"), ("euclidean", "png")]
    {
        tell(&story, &format!("{computation} trap.txt --{picture} shown.png")).expect_code(0);
        assert_eq!(values(&story, "occupancy shown.png"), map, "{computation}");
    }
}

#[test]
fn report_is_one_page_with_every_picture() {
    let story = story();
    story.tell(&["map", "report", "trap.txt", "--goal", "2,5", "--start", "2,1", "--out", "lab"]).expect_code(0);
    let page = story.read("lab/report.html");
    assert_eq!(page.matches("data:image/png;base64,").count(), 18);
    assert!(!page.contains("http") && page.contains("<td>7.657</td>") && page.contains("wildfire map astar"), "{page}");
    let table = story.read("lab/searches.csv");
    let names: Vec<&str> = table.lines().filter_map(|line| line.split(',').next()).collect();
    assert_eq!(names, ["search", "dijkstra", "astar", "greedy", "jps", "theta", "rrt", "rrt-star", "prm"]);
}

#[test]
fn small_map_is_shown_with_the_path_marked() {
    let story = story();
    let shown = tell(&story, "wavefront trap.txt --goal 2,5 --start 2,0").stdout;
    let table = " 7*6*5*4 4 4\n*7 1 1 1*3 3\n*8 8 9 1 3*2\n 9 1 1 1 3 3\n";
    assert!(shown.ends_with(&format!("\n\n{table}")), "{shown}");
    assert!(widest(&shown) <= 80, "{shown}");
}

#[test]
fn large_map_is_summed_up_only() {
    let story = story();
    let row = "01".repeat(41) + "\n";
    story.file("wide.txt", &row);
    story.file("high.txt", &"01\n".repeat(41));
    for map in ["wide.txt", "high.txt"] {
        assert_eq!(tell(&story, &format!("occupancy {map}")).stdout.lines().count(), 4);
    }
    assert_eq!(tell(&story, "brushfire trap.txt --csv v.csv").stdout.lines().count(), 4, "values are in the file");
}

#[test]
fn timing_prints_a_row_for_each_map() {
    let story = story();
    let table = tell(&story, "timing trap.txt full.txt").stdout;
    let rows: Vec<Vec<&str>> = table.lines().skip(5).take(2).map(|line| line.split_whitespace().collect()).collect();
    assert_eq!((rows[0][0], rows[0][1], rows[0][4]), ("trap.txt", "24", "2,2"));
    assert_eq!((rows[1][0], rows[1][1], rows[1][3]), ("full.txt", "4", "-"));
    assert!(table.contains("nearest the centre") && widest(&table) <= 80, "{table}");
    let timings = object(&story, "timing trap.txt full.txt");
    assert_eq!(timings["connectivity"], json!(8));
    assert_eq!((&timings["maps"][0]["goal"], &timings["maps"][0]["cells"]), (&json!([2, 2]), &json!(24)));
    assert!(timings["maps"][0]["wavefront_s"].as_f64().is_some_and(|seconds| seconds > 0.0));
    assert_eq!((&timings["maps"][1]["goal"], &timings["maps"][1]["wavefront_s"]), (&Value::Null, &Value::Null));
}

/// Writes a plain PGM of 20 pixels, with a count for each grey value.
fn greys(story: &Story, name: &str, counts: &[(usize, u8)]) {
    let pixels: Vec<String> = counts.iter().flat_map(|&(count, grey)| vec![grey.to_string(); count]).collect();
    story.file(name, &format!("P2 20 {} 255\n{}\n", pixels.len() / 20, pixels.join(" ")));
}

#[test]
fn obstacles_that_are_not_quite_dark_enough_are_said() {
    let story = story();
    greys(&story, "soft.pgm", &[(94, 255), (4, 70), (2, 30)]);
    let text = tell(&story, "occupancy soft.pgm").stdout;
    assert!(text.contains("\nTolerance 50: 6.0 % of the pixels within 20 grey levels of it\n"), "{text}");
    assert!(text.contains("\n6.0 % of the pixels are within 20 grey levels of the tolerance, 50: "), "{text}");
    let printed = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        printed.contains("with --tolerance auto, 162, 6.0 % of the cells would be occupied instead of 2.0 %"),
        "{printed}"
    );
    let answer = tell(&story, "occupancy soft.pgm --json");
    assert!(answer.stderr.contains("6.0 % of the pixels"), "{}", answer.stderr);
    let answer = object(&story, "occupancy soft.pgm");
    assert_eq!((&answer["near_tolerance"], answer["notes"].as_array().map(Vec::len)), (&json!(0.06), Some(1)));

    greys(&story, "sharp.pgm", &[(95, 255), (5, 70)]);
    let answer = object(&story, "occupancy sharp.pgm");
    assert_eq!(
        (&answer["near_tolerance"], &answer["notes"]),
        (
            &json!(0.05),
            &json!([
                "With --tolerance auto, 162, 5.0 % of the cells would be occupied instead of 0.0 %.",
                "No obstacle: no cell of the map is occupied."
            ])
        )
    );
    assert_eq!(object(&story, "occupancy sharp.pgm --tolerance 49")["near_tolerance"], json!(0.0));
    assert_eq!(object(&story, "occupancy trap.txt")["near_tolerance"], Value::Null);
}

#[test]
fn an_image_that_is_white_on_black_is_said() {
    let story = story();
    greys(&story, "inverted.pgm", &[(61, 0), (39, 255)]);
    let text = tell(&story, "occupancy inverted.pgm").stdout;
    assert!(text.contains("61.0 % of the cells are occupied: the image may be inverted"), "{text}");
    let answer = tell(&story, "timing inverted.pgm --remove-edges 0");
    assert!(answer.stderr.contains("inverted.pgm: 61.0 % of the cells are occupied"), "{}", answer.stderr);
    greys(&story, "dense.pgm", &[(60, 0), (40, 255)]);
    for map in ["dense.pgm", "full.txt"] {
        let text = tell(&story, &format!("occupancy {map}")).stdout;
        assert!(!text.contains("inverted"), "{text}");
    }
}

#[test]
fn a_weight_is_reported_with_its_bound_and_what_it_costs() {
    let story = story();
    let ends = "--goal 2,5 --start 2,1";
    let shortest = object(&story, &format!("astar trap.txt {ends}"));
    assert_eq!((&shortest["cost_bound"], &shortest["shortest_cost"]), (&Value::Null, &Value::Null));
    for (options, bound) in [("--weight 3", json!(3.0)), ("--heuristic manhattan", json!(SQRT_2))] {
        let found = object(&story, &format!("a* trap.txt {ends} {options}"));
        assert_eq!((&found["cost_bound"], &found["shortest_cost"]), (&bound, &shortest["cost"]), "{options}");
        assert!(found["notes"].to_string().contains("may be longer than the shortest, at most"), "{found}");
    }
    let greedy = object(&story, &format!("greedy trap.txt {ends}"));
    assert_eq!((&greedy["cost_bound"], &greedy["shortest_cost"]), (&Value::Null, &shortest["cost"]));
    let [zero, dijkstra] =
        ["astar --heuristic zero", "dijkstra"].map(|command| object(&story, &format!("{command} trap.txt {ends}")));
    assert_eq!((&zero["cost"], &zero["expansions"]), (&dijkstra["cost"], &dijkstra["expansions"]));
}

#[test]
fn fronts_that_spread_are_films() {
    let story = story();
    for command in
        ["brushfire trap.txt", "nf1 trap.txt --goal 2,5 --start 2,1", "wavefront trap.txt --goal 2,5 --scale 9"]
    {
        tell(&story, &format!("{command} --gif front.gif"));
        let film = std::fs::read(story.path("front.gif")).expect("it was written");
        // A graphic control extension opens each frame (GIF89a, section 23).
        let frames = film.windows(3).filter(|bytes| bytes.starts_with(b"\x21\xf9\x04")).count();
        assert!(film.starts_with(b"GIF89a") && frames > 3, "{command}: {frames} frames");
    }
}
