//! Conformance: what independent tools answered to the same questions, file by file.
//!
mod answers;
mod case;
mod compare;

use std::fs;
use std::path::{Path, PathBuf};

use wildfire::grid::octile::shortest_path;
use wildfire::grid::place::octile_length;
use wildfire::grid::{Connectivity, CornerCutting, Grid, Place, Route};
use wildfire::map_files;

use crate::answers::{both, larger};

use case::Case;
use compare::Tally;

fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the reference is readable");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("the reference is readable").path()).collect();
    paths.sort();
    paths
}

/// Compares every file of every case in a folder.
fn compare_cases(folder: &Path) -> (usize, Tally) {
    let cases: Vec<PathBuf> = entries(folder).into_iter().filter(|path| path.join("case.json").exists()).collect();
    let mut tally = Tally::default();
    for case in &cases {
        Case::read(case).compare(&mut tally);
    }
    (cases.len(), tally)
}

#[expect(clippy::print_stdout, reason = "says what was compared")]
fn reproduce_cases(folder: &Path) {
    let (cases, tally) = compare_cases(folder);
    assert!(cases > 0, "{} holds no cases", folder.display());
    println!("{}: {cases} cases, {tally}", folder.display());
}

#[test]
fn grid_cases_are_reproduced() {
    both("grid").for_each(|folder| reproduce_cases(&folder));
}

#[test]
fn maps_of_the_reports_are_reproduced() {
    larger("originals").iter().for_each(|folder| reproduce_cases(folder));
}

/// A line of a scenario of the Moving AI benchmark: bucket, map, width, height, start x and y, goal x and y, optimum.
struct Problem {
    start: Place,
    goal: Place,
    optimum: f64,
}

fn problem(line: &str) -> Problem {
    let fields: Vec<&str> = line.split_whitespace().collect();
    let whole = |index: usize| fields[index].parse::<usize>().expect("scenario lines hold whole numbers");
    let optimum = fields[8].parse().expect("scenario lines end with a length");
    Problem { start: (whole(5), whole(4)), goal: (whole(7), whole(6)), optimum }
}

fn solve(occupied: &Grid<bool>, problem: &Problem) -> f64 {
    let (start, goal) = (problem.start, problem.goal);
    let route = shortest_path(occupied, start, goal, Connectivity::Eight, CornerCutting::Forbidden);
    let route = route.expect("start and goal are free");
    let Route::Found(path) = route else { panic!("{start:?} to {goal:?}: {route:?}") };
    assert_eq!((path[0], path[path.len() - 1]), (start, goal));
    octile_length(&path)
}

/// Rounded as the benchmark's files are.
fn in_six_digits(length: f64) -> f64 {
    format!("{length:.5e}").parse().expect("it is a number")
}

#[test]
fn moving_ai_optima_are_reproduced() {
    let mut compared = 0;
    let is_scenario = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "scen");
    let files = both("movingai").flat_map(|folder| entries(&folder));
    for path in files.filter(is_scenario) {
        let occupied = map_files::read(&path.with_extension("map"), 50).unwrap().occupied;
        let text = fs::read_to_string(&path).unwrap();
        for line in text.lines().skip(1) {
            let problem = problem(line);
            let length = in_six_digits(solve(&occupied, &problem));
            assert!((length - problem.optimum).abs() < 1e-4, "{}: {line}: {length}", path.display());
            compared += 1;
        }
    }
    assert!(compared >= 60, "{compared} scenario lines");
    println!("movingai: {compared} scenario lines");
}
