//! A field with its bushes and the drives on it, to scale: north is up.

use std::f64::consts::TAU;

use crate::canvas::{Canvas, Point};
use crate::colours::{INK, OBSTACLE, Rgb, WAYS};
use crate::legend::Symbol;
use crate::marks::Mark;
use crate::png::Picture;
use crate::way_lines::{PoseMark, WayRun, draw_cusp, draw_run, way_runs};
use crate::world_sheet::{WorldFrame, WorldSheet};
use wildfire_base::geometry::{Cell, FieldFrame, Pose, ops};
use wildfire_base::query::{Goal, GoalDisc};
use wildfire_base::vehicle::Path;

/// Pixels of marks; goals can be many.
const START_MARK: f32 = 9.0;
const GOAL_MARK: f32 = 6.0;
/// The first planner's paths are drawn as wide as this, and each further one's wider by [`WIDER`], under those before:
/// paths that coincide are all seen.
const WIDTH: f32 = 2.0;
const WIDER: f32 = 2.0;
/// Corners of a goal disc.
const CORNERS: u32 = 72;

/// A field and drives on it from one start.
#[derive(Clone, Copy)]
pub struct DriveScene<'a> {
    pub title: &'a str,
    pub frame: FieldFrame,
    pub bushes: &'a [Cell],
    /// Of the rear axle; what is no number, or off the field, is not shown.
    pub start: Pose,
    /// Each with whether any drive gets there.
    pub goals: &'a [(Goal, bool)],
    /// One for each planner; beyond the fourth, colours repeat.
    pub ways: &'a [DrivenWays<'a>],
}

/// The paths of one planner, with a name for the key.
pub struct DrivenWays<'a> {
    pub name: String,
    pub paths: Vec<&'a Path>,
}

/// Draws the drives to scale, reverse dashed, with bushes, start, goals, cusps, a key, and metres east and north along the
/// edges.
///
/// The field's longer side takes 720 pixels.
pub fn draw_drives(scene: &DriveScene) -> Picture {
    let lines: Vec<Vec<Vec<WayRun>>> =
        scene.ways.iter().map(|ways| ways.paths.iter().map(|path| way_runs(path)).collect()).collect();
    let frame = WorldFrame::from_size(scene.frame.width_m(), scene.frame.height_m());
    let WorldSheet { mut canvas, frame } = WorldSheet::new(scene.title, frame, key(scene, &lines));
    draw_bushes(&mut canvas, &frame, scene);
    for (index, paths) in lines.iter().enumerate().rev() {
        for run in paths.iter().flatten() {
            let points: Vec<Point> = run.places.iter().map(|&place| frame.at(place)).collect();
            draw_run(&mut canvas, &points, WIDTH + WIDER * index as f32, colour(index), run.is_reverse);
        }
    }
    // Cusps come after all paths, since one may lie under another path.
    for run in lines.iter().flatten().flat_map(|runs| runs.iter().skip(1)) {
        draw_cusp(&mut canvas, frame.at(run.places[0]));
    }
    scene.goals.iter().for_each(|&(goal, is_reached)| draw_goal(&mut canvas, &frame, scene, goal, is_reached));
    if is_shown(scene, (scene.start.x, scene.start.y)) {
        PoseMark::Start.draw(&mut canvas, frame.at((scene.start.x, scene.start.y)), scene.start.heading, START_MARK);
    }
    canvas.finish()
}

/// Cells are drawn from rounded edge to rounded edge, so that neighbours show no seam.
fn draw_bushes(canvas: &mut Canvas, frame: &WorldFrame, scene: &DriveScene) {
    let corner = |col: u16, row: u16| {
        let (x, y) = frame.at((f64::from(col) * scene.frame.cell_m, f64::from(row) * scene.frame.cell_m));
        (x.round(), y.round())
    };
    for &Cell { col, row } in scene.bushes {
        let (left, bottom) = corner(col, row);
        let (right, top) = corner(col + 1, row + 1);
        canvas.fill_rect(left, top, (right - left).max(1.0), (bottom - top).max(1.0), OBSTACLE);
    }
}

fn draw_goal(canvas: &mut Canvas, frame: &WorldFrame, scene: &DriveScene, goal: Goal, is_reached: bool) {
    let place = match goal {
        Goal::Pose(pose) => (pose.x, pose.y),
        Goal::Disc(disc) => (disc.centre.x, disc.centre.y),
    };
    if !is_shown(scene, place) {
        return;
    }
    match goal {
        Goal::Pose(pose) => PoseMark::Goal.draw(canvas, frame.at(place), pose.heading, GOAL_MARK),
        Goal::Disc(disc) => draw_disc(canvas, frame, scene, disc),
    }
    if !is_reached {
        Mark::Stuck.draw(canvas, frame.at(place), GOAL_MARK);
    }
}

/// The circle as far as it lies on the field, and a star in its middle.
fn draw_disc(canvas: &mut Canvas, frame: &WorldFrame, scene: &DriveScene, disc: GoalDisc) {
    let place = |corner: u32| {
        let (sin, cos) = ops::sin_cos(TAU * f64::from(corner) / f64::from(CORNERS));
        (disc.centre.x + disc.radius_m * cos, disc.centre.y + disc.radius_m * sin)
    };
    let sides = (0..CORNERS).map(|corner| [place(corner), place(corner + 1)]);
    for side in sides.filter(|side| side.iter().all(|&place| is_shown(scene, place))) {
        canvas.polyline(&side.map(|place| frame.at(place)), 1.0, INK);
    }
    Mark::Goal.draw(canvas, frame.at((disc.centre.x, disc.centre.y)), GOAL_MARK);
}

fn is_shown(scene: &DriveScene, (x, y): (f64, f64)) -> bool {
    (0.0..=scene.frame.width_m()).contains(&x) && (0.0..=scene.frame.height_m()).contains(&y)
}

fn colour(way: usize) -> Rgb {
    WAYS[way % WAYS.len()]
}

fn key<'a>(scene: &DriveScene<'a>, lines: &[Vec<Vec<WayRun>>]) -> Vec<(Symbol, &'a str)> {
    let ways = scene.ways.iter().enumerate().map(|(index, ways)| (Symbol::Way(colour(index)), ways.name.as_str()));
    let has = |feature: &dyn Fn(&[WayRun]) -> bool| lines.iter().flatten().any(|runs| feature(runs));
    let goal = |wanted: fn(&Goal) -> bool| scene.goals.iter().any(|(goal, _)| wanted(goal));
    let marks = [
        (has(&|runs| runs.iter().any(|run| run.is_reverse)), Symbol::Reverse, "in reverse"),
        (has(&|runs| runs.len() > 1), Symbol::Cusp, "cusp"),
        (true, Symbol::Pose(PoseMark::Start), PoseMark::Start.name()),
        (goal(|goal| matches!(goal, Goal::Pose(_))), Symbol::Pose(PoseMark::Goal), "goal pose"),
        (goal(|goal| matches!(goal, Goal::Disc(_))), Symbol::Mark(Mark::Goal), "goal, in its disc"),
        (scene.goals.iter().any(|(_, is_reached)| !is_reached), Symbol::Mark(Mark::Stuck), "not reached"),
        (!scene.bushes.is_empty(), Symbol::Cell(OBSTACLE), "bush"),
    ];
    ways.chain(marks.into_iter().filter(|(is_there, ..)| *is_there).map(|(_, symbol, name)| (symbol, name))).collect()
}
