//! The maps under `assets/maps/` are what the code here draws, and do what their README says.
//!
//! `WILDFIRE_WRITE_MAPS=1 cargo test --test grid maps_are_what` writes them again.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use wildfire::grid::brushfire::brushfire;
use wildfire::grid::descent::{Descent, descend};
use wildfire::grid::potential::{self, Attraction, Repulsion};
use wildfire::grid::{Connectivity, CornerCutting, TieOrder};
use wildfire::grid::{Grid, Place, drawn, place};
use wildfire::{map_files, rng};

/// Occupied cells of images are drawn black, free ones white.
const BLACK: u8 = 0;
const WHITE: u8 = 255;

/// The default tolerance of the command line.
const TOLERANCE: u8 = 50;

enum Example {
    Cells(Grid<bool>),
    Grey(Grid<u8>),
}

fn examples() -> Vec<(&'static str, Example)> {
    let rng = |name| rng::stream(1, name);
    vec![
        ("basic-14x20.txt", Example::Cells(drawn::blobs(14, 20, 6, 1..=2, &mut rng("basic")))),
        ("maze.txt", Example::Cells(drawn::maze(21, 31, 1, &mut rng("maze")))),
        ("two-rooms.txt", Example::Cells(drawn::two_rooms(16, 31))),
        ("u-trap.txt", Example::Cells(drawn::u_trap(20, 30))),
        ("drawing.png", Example::Grey(drawing::garden())),
        ("maze-242x242.png", black_on_white(&drawn::maze(242, 242, 9, &mut rng("maze-242x242")))),
        ("maze-687x802.png", black_on_white(&drawn::maze(687, 802, 13, &mut rng("maze-687x802")))),
        ("obstacles-683x803.png", black_on_white(&drawn::blobs(683, 803, 90, 8..=40, &mut rng("obstacles-683x803")))),
    ]
}

fn black_on_white(occupied: &Grid<bool>) -> Example {
    let values = occupied.values().iter().map(|&occupied| if occupied { BLACK } else { WHITE }).collect();
    Example::Grey(Grid::from_values(occupied.rows(), occupied.cols(), values))
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/maps")
}

fn read(name: &str) -> map_files::MapFile {
    map_files::read(&folder().join(name), TOLERANCE).expect("a map of the project")
}

#[test]
fn maps_are_what_the_code_draws() {
    let writes = env::var_os("WILDFIRE_WRITE_MAPS").is_some();
    for (name, example) in examples() {
        let path = folder().join(name);
        if writes {
            let written = match &example {
                Example::Cells(occupied) => map_files::write_text(&path, occupied),
                Example::Grey(grey) => map_files::write_png(&path, grey),
            };
            written.expect("the folder is writable");
        }
        let found = read(name);
        match example {
            Example::Cells(occupied) => assert!(found.occupied == occupied, "{name} differs from what is drawn"),
            Example::Grey(grey) => assert!(found.grey == Some(grey), "{name} differs from what is drawn"),
        }
        assert!(found.notes.is_empty(), "{name} is read as it is");
        // The drawing has soft edges, on purpose.
        assert!(found.doubts().is_empty() || name == "drawing.png", "{name} is doubtful");
    }
}

/// A line of the README's table: file, rows, columns, start, goal.
struct Entry {
    name: String,
    size: Place,
    start: Place,
    goal: Place,
}

fn entries() -> Vec<Entry> {
    let readme = fs::read_to_string(folder().join("README.md")).expect("the folder has a README");
    let rows = readme.lines().filter(|line| line.starts_with("| `"));
    rows.map(|line| {
        let fields: Vec<&str> = line.trim_matches('|').split('|').map(|field| field.trim().trim_matches('`')).collect();
        let pair = |text: &str, separator| -> Place {
            let (first, second) = text.split_once(separator).expect("a pair of numbers");
            (first.parse().expect("a number"), second.parse().expect("a number"))
        };
        let (size, start, goal) = (pair(fields[1], " x "), pair(fields[2], ","), pair(fields[3], ","));
        Entry { name: fields[0].to_owned(), size, start, goal }
    })
    .collect()
}

#[test]
fn readme_lists_every_map_with_its_size() {
    let mut listed: Vec<String> = entries().into_iter().map(|entry| entry.name).collect();
    listed.sort();
    let files = fs::read_dir(folder()).expect("the folder is there").map(|entry| entry.expect("readable").file_name());
    let mut found: Vec<String> = files.map(|name| name.to_string_lossy().into_owned()).collect();
    found.retain(|name| name != "README.md");
    found.sort();
    assert_eq!(listed, found);
    for Entry { name, size, .. } in entries() {
        let map = read(&name).occupied;
        assert_eq!((map.rows(), map.cols()), size, "{name}");
    }
}

#[test]
fn start_and_goal_of_every_map_are_free_and_joined() {
    for Entry { name, start, goal, .. } in entries() {
        let map = read(&name).occupied;
        assert_eq!(place::check_free(&map, start), Ok(()), "{name}");
        assert_eq!(place::check_free(&map, goal), Ok(()), "{name}");
        assert!(are_joined(map, start, goal), "{name}");
    }
}

/// Whether four-neighbour steps lead from one free cell to another.
fn are_joined(mut occupied: Grid<bool>, start: Place, goal: Place) -> bool {
    let mut open = vec![start];
    while let Some(here) = open.pop() {
        for &step in TieOrder::CrossFirst.steps(Connectivity::Four) {
            if let Some(next) = place::step(&occupied, here, step, CornerCutting::Allowed) {
                occupied[next] = true;
                open.push(next);
            }
        }
    }
    occupied[goal]
}

#[test]
fn descent_is_caught_in_the_u_trap() {
    let entry = entries().into_iter().find(|entry| entry.name == "u-trap.txt").expect("it is listed");
    let map = read(&entry.name).occupied;
    for connectivity in [Connectivity::Four, Connectivity::Eight] {
        let distance = brushfire(&map, connectivity).expect("the trap is an obstacle");
        let attraction =
            potential::attraction(map.rows(), map.cols(), entry.goal, Attraction::Squared { zeta: 1.0 }, Some(10.0));
        let total = potential::total(attraction, &distance, &Repulsion::default());
        let descent = descend(&total, &map, entry.start, entry.goal, connectivity, CornerCutting::Allowed);
        assert!(matches!(descent, Ok(Descent::Stuck(_))), "{descent:?}");
    }
}

#[test]
fn drawing_has_greys_between_black_and_white() {
    let grey = read("drawing.png").grey.expect("an image");
    let soft = grey.values().iter().filter(|&&value| (64..192).contains(&value)).count();
    assert!(soft > 500, "edges are soft, so that the tolerance matters");
    let occupied = |tolerance| grey.values().iter().filter(|&&value| value <= tolerance).count();
    assert!(occupied(25) < occupied(TOLERANCE) && occupied(TOLERANCE) < occupied(150));
}

/// A garden seen from above, drawn with soft edges: a house with two rooms, a lake with an island, trees and a hedge.
mod drawing {
    use wildfire::grid::Grid;

    const ROWS: usize = 150;
    const COLS: usize = 200;
    const PAPER: f64 = 248.0;

    /// (row, column), in cells.
    type Point = (f64, f64);

    /// Corners of the house's walls, with a door to the south and one between the rooms.
    const WALLS: &[(Point, Point)] = &[
        ((18.0, 112.0), (18.0, 182.0)),
        ((18.0, 182.0), (66.0, 182.0)),
        ((66.0, 182.0), (66.0, 136.0)),
        ((66.0, 124.0), (66.0, 112.0)),
        ((66.0, 112.0), (18.0, 112.0)),
        ((18.0, 148.0), (36.0, 148.0)),
        ((48.0, 148.0), (66.0, 148.0)),
    ];

    /// The hedge in the west, with a gate.
    const HEDGE: &[(Point, Point)] =
        &[((10.0, 14.0), (52.0, 14.0)), ((68.0, 14.0), (138.0, 14.0)), ((138.0, 14.0), (138.0, 78.0))];

    /// Middle, half height and half width.
    const LAKE: &[(Point, Point)] = &[((92.0, 58.0), (24.0, 30.0)), ((104.0, 84.0), (15.0, 22.0))];

    const ISLAND: (Point, f64) = ((92.0, 54.0), 8.0);

    /// Middle and radius of crowns.
    const TREES: &[(Point, f64)] = &[
        ((24.0, 40.0), 9.0),
        ((38.0, 60.0), 7.0),
        ((18.0, 78.0), 8.0),
        ((48.0, 88.0), 6.0),
        ((92.0, 132.0), 8.0),
        ((92.0, 160.0), 8.0),
        ((92.0, 186.0), 7.0),
        ((122.0, 120.0), 7.0),
        ((120.0, 146.0), 9.0),
        ((122.0, 174.0), 8.0),
    ];

    pub fn garden() -> Grid<u8> {
        let value = |at: usize| grey(((at / COLS) as f64, (at % COLS) as f64)).round() as u8;
        Grid::from_values(ROWS, COLS, (0..ROWS * COLS).map(value).collect())
    }

    fn grey(at: Point) -> f64 {
        let lake = nearest(LAKE, |&(middle, halves)| to_ellipse(at, middle, halves));
        let island = to_disc(at, ISLAND.0, ISLAND.1);
        let inks = [
            ink(nearest(WALLS, |&(from, to)| to_segment(at, from, to)) - 1.5, 1.5, 0.0),
            ink(nearest(HEDGE, |&(from, to)| to_segment(at, from, to)) - 2.5, 4.0, 30.0),
            ink(nearest(TREES, |&(middle, radius)| to_disc(at, middle, radius)), 6.0, 15.0),
            ink(lake.max(-island), 12.0, 40.0),
        ];
        inks.into_iter().fold(PAPER, f64::min)
    }

    /// Grey value at a signed distance from an edge, negative within: `core` inside, paper outside, blended over `width`.
    fn ink(distance: f64, width: f64, core: f64) -> f64 {
        let cover = (0.5 - distance / width).clamp(0.0, 1.0);
        PAPER + (core - PAPER) * cover * cover * (3.0 - 2.0 * cover)
    }

    fn nearest<T>(shapes: &[T], distance: impl Fn(&T) -> f64) -> f64 {
        shapes.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    fn length(rows: f64, cols: f64) -> f64 {
        (rows * rows + cols * cols).sqrt()
    }

    fn to_disc(at: Point, middle: Point, radius: f64) -> f64 {
        length(at.0 - middle.0, at.1 - middle.1) - radius
    }

    /// About the distance to an ellipse: exact on its axes' ends in the direction of the shorter one.
    fn to_ellipse(at: Point, middle: Point, halves: Point) -> f64 {
        (length((at.0 - middle.0) / halves.0, (at.1 - middle.1) / halves.1) - 1.0) * halves.0.min(halves.1)
    }

    fn to_segment(at: Point, from: Point, to: Point) -> f64 {
        let along = (to.0 - from.0, to.1 - from.1);
        let offset = (at.0 - from.0, at.1 - from.1);
        let share = (offset.0 * along.0 + offset.1 * along.1) / (along.0 * along.0 + along.1 * along.1);
        let share = share.clamp(0.0, 1.0);
        length(offset.0 - share * along.0, offset.1 - share * along.1)
    }
}
