//! Checks of scenarios: ranges that bound time, bodies that are possible, starts inside the field. Memory is bounded in
//! [`super::memory`].
//!
//! `scenarios/README.md` documents the limits.

use std::ops::RangeInclusive;

use super::error::Fault;
use super::field::{MAX_CELLS_A_SIDE, MAX_COVERAGE};
use super::path::{FieldPath, PathStep};
use super::wording::shortened;
use super::{Escape, Field, Ignition, IgnitionCells, Scenario, Unimog, Wumpus, WumpusPlanner, WumpusPotential};
use crate::geometry::{DVec2, FieldFrame, ops};
use crate::ranges::{SettingsTable, number_text};
use crate::vehicle::Dimensions;

/// The most agents of a kind.
pub const MAX_AGENTS: usize = 100;
/// The most `[[ignition]]` entries, and the most cells that they name in all.
const MAX_IGNITIONS: usize = 10_000;
/// The most points of all Wumpuses' lattices: a walk may look at all of them.
const MAX_WUMPUS_NODES: f64 = 4e6;
/// The most goals that Wumpuses may try in vain: all bushes from every point that they have time to reach. A try takes about
/// 250 bytes of the timeline; runs stay far below the bound, because a Wumpus on which all goals fail stays where it is.
const MAX_TRIES: f64 = 2.5e7;
/// The most pairs of a burning cell and a neighbour in its radius.
const MAX_SPREAD_PAIRS: f64 = 1e9;
/// The most stops of all trucks in a run in which a cell can burn again and again; each adds to the timeline.
const MAX_STOPS: f64 = 1e6;
/// The most characters of a scenario's name, which goes into tables and file names.
const MAX_NAME: usize = 100;

/// The largest steering angle, degrees: beyond it front wheels push the truck sideways rather than turn it.
const MAX_STEERING_DEG: f64 = 60.0;

/// The distance by which a body may stick out of the field through rounding, metres.
const ROUNDING_M: f64 = 1e-9;

/// A value that is refused.
pub struct Refusal {
    pub path: FieldPath,
    found: String,
    expected: String,
}

impl Refusal {
    pub fn fault(&self) -> Fault {
        let (found, expected) = (self.found.clone(), self.expected.clone());
        Fault::Value { field: self.path.to_string(), found, expected }
    }
}

/// The result of a check: nothing, or the first value that is refused.
pub type Check = Result<(), Box<Refusal>>;

/// Returns the range from `least` to `most`, both included.
const fn from(least: f64, most: f64) -> RangeInclusive<f64> {
    least..=most
}

/// Checks every value of a scenario that serde cannot.
pub fn check(scenario: &Scenario) -> Check {
    check_name("name", &scenario.name)?;
    let top = TablePath::named("");
    top.number("duration_s", scenario.duration_s, from(0.001, 1e6))?;
    check_field(&scenario.field)?;
    check_rules(scenario)?;
    for (name, count) in [("wumpus", scenario.wumpus.len()), ("unimog", scenario.unimog.len())] {
        top.count(name, count, MAX_AGENTS)?;
    }
    let frame = scenario.field.frame();
    let bushes = 4.0 * f64::from(scenario.field.wanted_pieces());
    let (mut points, mut tries) = (0.0, 0.0);
    for (number, wumpus) in scenario.wumpus.iter().enumerate() {
        let table = TablePath::entry("wumpus", number);
        check_wumpus(&table, wumpus, &frame)?;
        let pitch_m = wumpus.lattice_m.unwrap_or(frame.cell_m);
        let own_points = (frame.width_m() / pitch_m).max(1.0) * (frame.height_m() / pitch_m).max(1.0);
        points += own_points;
        if points > MAX_WUMPUS_NODES {
            let expected = format!("lattices of at most {MAX_WUMPUS_NODES:e} points, over all Wumpuses");
            return table.refuse("lattice_m", number_text(pitch_m), expected);
        }
        if wumpus.planner == WumpusPlanner::Potential && wumpus.potential.escape == Escape::None {
            tries += bushes * own_points.min(scenario.duration_s * wumpus.speed_mps / pitch_m);
        }
        if tries > MAX_TRIES {
            let expected = format!(
                "\"wavefront\", where bushes times the steps of a run are more than {MAX_TRIES:e}, over all Wumpuses"
            );
            return table.inner("potential").refuse("escape", "\"none\"".into(), expected);
        }
    }
    for (number, unimog) in scenario.unimog.iter().enumerate() {
        check_unimog(&TablePath::entry("unimog", number), unimog, &frame)?;
    }
    check_ignitions(&scenario.ignition, &frame)
}

/// Checks a name that goes into tables and file names.
pub fn check_name(field: &str, name: &str) -> Check {
    let fits = (1..=MAX_NAME).contains(&name.chars().count()) && !name.chars().any(char::is_control);
    let expected = || format!("a line of 1 to {MAX_NAME} characters");
    if fits { Ok(()) } else { TablePath::named("").refuse(field, shortened(&format!("{name:?}")), expected()) }
}

fn check_field(field: &Field) -> Check {
    let table = TablePath::named("field");
    table.number("cell_m", field.cell_m, from(0.01, 1000.0))?;
    table.number("start_clearance_m", field.start_clearance_m, from(0.0, 1e6))?;
    if field.given.is_some() {
        return Ok(());
    }
    let side = field.size_m / field.cell_m;
    let expected = || format!("1 to {MAX_CELLS_A_SIDE} whole cells of {} m", field.cell_m);
    let whole = (side - side.round()).abs() <= 1e-9 * side;
    if !(whole && (1.0..=f64::from(MAX_CELLS_A_SIDE)).contains(&side.round())) {
        return table.refuse("size_m", number_text(field.size_m), expected());
    }
    table.number("coverage", field.coverage, from(0.0, MAX_COVERAGE))?;
    let most = (MAX_COVERAGE * field.frame().cell_count() as f64 / 4.0) as usize;
    table.count("pieces", field.pieces.unwrap_or(0) as usize, most)?;
    let repeated = (1..field.shapes.len()).any(|n| field.shapes[..n].contains(&field.shapes[n]));
    if field.shapes.is_empty() || repeated {
        return table.refuse(
            "shapes",
            format!("{:?}", field.shapes),
            "a list of different shapes, at least one".into(),
        );
    }
    Ok(())
}

fn check_rules(scenario: &Scenario) -> Check {
    let (fire, suppression, score) = (&scenario.fire, &scenario.suppression, &scenario.score);
    let table = TablePath::named("fire");
    table.number("spread_delay_s", fire.spread_delay_s, from(0.0, 1e6))?;
    table.number("spread_radius_m", fire.spread_radius_m, from(0.0, 1e6))?;
    table.optional("burn_out_s", fire.burn_out_s, from(0.001, 1e6))?;
    check_spread_work(&table, scenario)?;
    let table = TablePath::named("suppression");
    table.optional("reach_m", suppression.reach_m, from(0.0, 1e6))?;
    table.number("dwell_s", suppression.dwell_s, from(0.1, 1e6))?;
    let stops = scenario.unimog.len() as f64 * scenario.duration_s / suppression.dwell_s;
    if fire.relight && stops > MAX_STOPS {
        let expected = format!("with `fire.relight`, time for at most {MAX_STOPS:e} stops of all trucks in the run");
        return table.refuse("dwell_s", number_text(suppression.dwell_s), expected);
    }
    let table = TablePath::named("score");
    table.number("wumpus_ignited", score.wumpus_ignited, from(-1e6, 1e6))?;
    table.number("wumpus_burned_out", score.wumpus_burned_out, from(-1e6, 1e6))?;
    table.number("truck_extinguished", score.truck_extinguished, from(-1e6, 1e6))
}

/// Bounds the work of spreading, which looks at every bush in the radius of every burning one.
fn check_spread_work(table: &TablePath, scenario: &Scenario) -> Check {
    let cells = scenario.field.frame().cell_count() as f64;
    let across = 2.0 * scenario.fire.spread_radius_m / scenario.field.cell_m + 1.0;
    if cells * (across * across).min(cells) <= MAX_SPREAD_PAIRS {
        return Ok(());
    }
    let expected = format!("at most {MAX_SPREAD_PAIRS:e} pairs of a cell and a cell in its radius");
    table.refuse("spread_radius_m", number_text(scenario.fire.spread_radius_m), expected)
}

fn check_wumpus(table: &TablePath, wumpus: &Wumpus, frame: &FieldFrame) -> Check {
    table.number("size_m", wumpus.size_m, from(0.01, 100.0))?;
    table.number("speed_mps", wumpus.speed_mps, from(0.001, 1000.0))?;
    table.number("reach_m", wumpus.reach_m, from(0.0, 1e6))?;
    table.optional("lattice_m", wumpus.lattice_m, from(0.01, 1000.0))?;
    table.number("heuristic_weight", wumpus.heuristic_weight, from(0.0, 1000.0))?;
    table.number("seconds_per_expansion", wumpus.seconds_per_expansion, from(0.0, 1e6))?;
    check_potential(&table.inner("potential"), &wumpus.potential)?;
    table.inner("safety").settings(&wumpus.safety, frame)?;
    let centre = wumpus.start_centre();
    let corners = [(1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| centre + 0.5 * wumpus.size_m * DVec2::new(x, y));
    table.inside("start_m", &corners, frame)
}

fn check_potential(table: &TablePath, potential: &WumpusPotential) -> Check {
    table.number("zeta", potential.zeta, from(0.0, 1e6))?;
    table.optional("scale", potential.scale, from(0.0, 1e6))?;
    table.number("q", potential.q, from(0.1, 1000.0))?;
    table.number("eta", potential.eta, from(0.0, 1e6))
}

fn check_unimog(table: &TablePath, unimog: &Unimog, frame: &FieldFrame) -> Check {
    check_vehicle(&table.inner("vehicle"), &unimog.vehicle)?;
    table.number("speed_mps", unimog.speed_mps, from(0.001, 1000.0))?;
    table.number("reverse_speed_mps", unimog.reverse_speed_mps, from(0.001, 1000.0))?;
    let limits = table.inner("limits");
    limits.optional("acceleration_mps2", unimog.limits.acceleration_mps2, from(0.001, 1000.0))?;
    limits.optional("braking_mps2", unimog.limits.braking_mps2, from(0.001, 1000.0))?;
    limits.optional("lateral_mps2", unimog.limits.lateral_mps2, from(0.001, 1000.0))?;
    check_planner_settings(table, unimog, frame)?;
    table.inner("start").number("heading_deg", unimog.start.heading_deg, from(-360.0, 360.0))?;
    table.inside("start", &unimog.vehicle.footprint(unimog.start.pose()).corners(), frame)
}

/// Checks that the first truck's planners can work on a field that may not be the one of their scenario.
pub fn check_planners(unimog: &Unimog, frame: &FieldFrame) -> Check {
    check_planner_settings(&TablePath::entry("unimog", 0), unimog, frame)
}

fn check_planner_settings(table: &TablePath, unimog: &Unimog, frame: &FieldFrame) -> Check {
    unimog.planner_settings().tables().try_for_each(|own| table.inner(own.name).settings(own.settings, frame))
}

/// Checks that a body is possible, and that its steering reaches its turning radius.
pub fn check_vehicle(table: &TablePath, body: &Dimensions) -> Check {
    table.number("length_m", body.length_m, from(0.1, 100.0))?;
    table.number("width_m", body.width_m, from(0.1, 100.0))?;
    table.number("rear_overhang_m", body.rear_overhang_m, from(0.0, body.length_m))?;
    table.number("wheelbase_m", body.wheelbase_m, from(0.1, body.length_m))?;
    if body.rear_overhang_m + body.wheelbase_m > body.length_m + ROUNDING_M {
        let room = body.length_m - body.rear_overhang_m;
        let expected = format!("a front axle under the body, at most {room} m ahead of the rear axle");
        return table.refuse("wheelbase_m", body.wheelbase_m.to_string(), expected);
    }
    table.number("turning_radius_m", body.turning_radius_m, from(0.1, 10_000.0))?;
    if body.turning_radius_m < 0.5 * body.width_m {
        let expected = "a centre of turning outside the body, at least half the width away".into();
        return table.refuse("turning_radius_m", body.turning_radius_m.to_string(), expected);
    }
    if body.max_steering_rad().to_degrees() > MAX_STEERING_DEG {
        let least_m = body.wheelbase_m / ops::tan(MAX_STEERING_DEG.to_radians());
        let expected = format!("at least {least_m:.3}, which steering by {MAX_STEERING_DEG} degrees gives");
        return table.refuse("turning_radius_m", body.turning_radius_m.to_string(), expected);
    }
    Ok(())
}

fn check_ignitions(ignitions: &[Ignition], frame: &FieldFrame) -> Check {
    let top = TablePath::named("");
    top.count("ignition", ignitions.len(), MAX_IGNITIONS)?;
    let mut named = 0;
    for (number, ignition) in ignitions.iter().enumerate() {
        let table = TablePath::entry("ignition", number);
        table.number("at_s", ignition.at_s, from(0.0, 1e6))?;
        match &ignition.cells {
            IgnitionCells::Random(count) => {
                table.number("random", (*count).into(), from(1.0, frame.cell_count() as f64))?;
            }
            IgnitionCells::Cells(cells) => {
                named += cells.len();
                top.count("ignition", named, MAX_IGNITIONS)?;
                let outside = cells.iter().position(|cell| cell.col >= frame.cols || cell.row >= frame.rows);
                if let Some(index) = outside {
                    let expected =
                        format!("a cell of the field of {} x {} cells, counted from 0", frame.cols, frame.rows);
                    return table.inner("cells").refuse_step(
                        PathStep::Index(index),
                        cells[index].to_string(),
                        expected,
                    );
                }
            }
        }
    }
    Ok(())
}

/// Checks the number that a path leads to.
pub fn check_number(path: FieldPath, number: f64, range: RangeInclusive<f64>) -> Check {
    if range.contains(&number) {
        return Ok(());
    }
    let expected = format!("a number from {} to {}", range.start(), range.end());
    Err(Box::new(Refusal { path, found: number_text(number), expected }))
}

/// The path of a table of the scenario, to name values in faults.
pub struct TablePath(FieldPath);

impl TablePath {
    pub fn named(dotted: &str) -> Self {
        Self(FieldPath::parse(dotted))
    }

    fn entry(list: &str, number: usize) -> Self {
        Self(FieldPath(vec![PathStep::key(list), PathStep::Index(number)]))
    }

    fn inner(&self, name: &str) -> Self {
        Self(self.0.join(PathStep::key(name)))
    }

    pub fn number(&self, name: &str, value: f64, range: RangeInclusive<f64>) -> Check {
        check_number(self.0.join(PathStep::key(name)), value, range)
    }

    pub fn optional(&self, name: &str, value: Option<f64>, range: RangeInclusive<f64>) -> Check {
        value.map_or(Ok(()), |value| self.number(name, value, range))
    }

    fn settings(&self, settings: &dyn SettingsTable, frame: &FieldFrame) -> Check {
        settings.check(frame).or_else(|wrong| self.refuse(wrong.name, wrong.found, wrong.expected))
    }

    pub fn count(&self, name: &str, count: usize, most: usize) -> Check {
        if count <= most { Ok(()) } else { self.refuse(name, count.to_string(), format!("at most {most}")) }
    }

    fn inside(&self, name: &str, corners: &[DVec2], frame: &FieldFrame) -> Check {
        if corners.iter().all(|&corner| frame.border_distance(corner) >= -ROUNDING_M) {
            return Ok(());
        }
        let expected =
            format!("a place with the whole body inside the field of {} x {} m", frame.width_m(), frame.height_m());
        self.refuse(name, "partly or wholly outside".into(), expected)
    }

    pub fn refuse(&self, name: &str, found: String, expected: String) -> Check {
        self.refuse_step(PathStep::key(name), found, expected)
    }

    fn refuse_step(&self, step: PathStep, found: String, expected: String) -> Check {
        Err(Box::new(Refusal { path: self.0.join(step), found, expected }))
    }
}
