//! One planner in Rust, in Python and as a program: the same outcomes, seed by seed.
//!
//! Here it is written in Rust, and `tests/data/same_planner/outcomes.csv` has what it gives. The same file is what
//! `tests/data/same_planner/planner.py` must give: as a class of Python (`python/tests/test_same_planner.py`) and as a
//! program. `WILDFIRE_REWRITE_DATA=1 cargo test --test contest same_planner` writes it again.

use std::path::Path as FilePath;

use wildfire::batch::execute::{RunResult, RunRow};
use wildfire::batch::plan::RunLabel;
use wildfire::batch::table::{RUN_COLUMNS, is_measured};
use wildfire::geometry::{Cell, DVec2, Pose};
use wildfire::planning::{Goal, GoalDisc, MakeError, Plan, PlanFailure, PlannerContext, Planners, TruckPlanner};
use wildfire::scenario::load;
use wildfire::sim;
use wildfire::timeline::Outcome;
use wildfire::vehicle::{Path, ReedsShepp};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=20;

/// Directions from the goal to where the body's centre stops, with the heading there: all numbers are exact in binary,
/// so that every language reads the same ones.
const PLACES: [(f64, f64, f64); 8] = [
    (1.0, 0.0, 1.5),
    (0.75, 0.75, 2.25),
    (0.0, 1.0, 3.0),
    (-0.75, 0.75, -2.5),
    (-1.0, 0.0, -1.5),
    (-0.75, -0.75, -0.75),
    (0.0, -1.0, 0.0),
    (0.75, -0.75, 0.75),
];

/// Metres from the centre of a goal disc to where the body's centre stops, as a part of the radius.
const OUT: f64 = 0.75;

/// Drives the shortest curve to the first place about the goal whose cell, and all cells around it, are bare; whether the
/// curve is free it does not ask. It needs no randomness and nothing but the cells, so that it is easily written in any
/// language.
struct FirstPlace {
    cols: i32,
    rows: i32,
    cell_m: f64,
    occupied: Vec<bool>,
    radius_m: f64,
}

impl FirstPlace {
    fn new(site: &PlannerContext<'_>) -> Self {
        let frame = site.checker.field().frame();
        Self {
            cols: frame.cols.into(),
            rows: frame.rows.into(),
            cell_m: frame.cell_m,
            occupied: (0..frame.cell_count()).map(|index| is_bush(site, frame.cell(index))).collect(),
            radius_m: site.body.turning_radius_m,
        }
    }

    /// Says whether the cell at a place and those around it are on the field and bare.
    fn is_bare(&self, x: f64, y: f64) -> bool {
        let (col, row) = ((x / self.cell_m).floor() as i32, (y / self.cell_m).floor() as i32);
        (row - 1..=row + 1).all(|row| {
            (col - 1..=col + 1).all(|col| {
                let is_on_field = (0..self.cols).contains(&col) && (0..self.rows).contains(&row);
                is_on_field && !self.occupied[(row * self.cols + col) as usize]
            })
        })
    }

    fn answer(&self, start: Pose, disc: GoalDisc) -> Result<Path, PlanFailure> {
        for (east, north, heading) in PLACES {
            let x = disc.centre.x + OUT * disc.radius_m * east;
            let y = disc.centre.y + OUT * disc.radius_m * north;
            if self.is_bare(x, y) {
                let end = Pose::new(x, y, heading);
                return Ok(ReedsShepp { radius_m: self.radius_m }.shortest(start, end).path(start));
            }
        }
        Err(PlanFailure::GoalBlocked)
    }
}

fn is_bush(site: &PlannerContext<'_>, cell: Cell) -> bool {
    site.checker.field().occupied()[(usize::from(cell.row), usize::from(cell.col))]
}

impl TruckPlanner for FirstPlace {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let disc = match goal {
            Goal::Disc(disc) => disc,
            Goal::Pose(pose) => GoalDisc { centre: DVec2::new(pose.x, pose.y), radius_m: 0.0 },
        };
        self.answer(start, disc).into()
    }
}

/// Writes the outcomes as the rows of `runs.csv`, without what is measured.
fn outcomes() -> String {
    let make =
        |site: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> { Ok(Box::new(FirstPlace::new(site))) };
    let planners = Planners::default().with("first-place", make).expect("the name is free");
    let changes = ["planner.first-place.command=[]", "unimog.planner=first-place"].map(str::to_owned);
    let scenario = load("contest", &changes).expect("it is built in");
    // Which words a planner's failure has is no outcome.
    let columns = || RUN_COLUMNS.iter().filter(|column| !is_measured(column.name) && column.name != "message");
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(columns().map(|column| column.name)).expect("memory takes all");
    for seed in SEEDS {
        let run = sim::run_with(&scenario, seed, &planners).expect("it can take place");
        let result = RunResult::new(Outcome::new(&run.timeline), run.cost);
        let row = RunRow::done(RunLabel::from_scenario(&scenario, seed), result, std::time::Duration::ZERO);
        table.write_record(columns().map(|column| (column.value)(&row).to_string())).expect("memory takes all");
    }
    String::from_utf8(table.into_inner().expect("memory takes all")).expect("words are text")
}

#[test]
fn planner_in_rust_gives_the_outcomes_of_the_file() {
    let path = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/same_planner/outcomes.csv");
    let outcomes = outcomes();
    if std::env::var_os("WILDFIRE_REWRITE_DATA").is_some_and(|value| value == "1") {
        std::fs::write(&path, &outcomes).expect("the repository can be written");
    }
    let expected = std::fs::read_to_string(&path).expect("the file is there");
    for (found, expected) in outcomes.lines().zip(expected.lines()) {
        assert_eq!(found, expected);
    }
    assert_eq!(outcomes.lines().count(), expected.lines().count());
}
