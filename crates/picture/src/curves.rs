//! Paths between two poses, drawn to scale as on a map: north is up.

use crate::canvas::{Canvas, Point};
use crate::colours::{INK, PAPER, Rgb, WAYS};
use crate::legend::Symbol;
use crate::png::Picture;
use crate::way_lines::{PoseMark, WayRun, draw_cusp, draw_run, way_runs};
use crate::world_sheet::{WorldFrame, WorldSheet};
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Dimensions, Path};

const MARK: f32 = 10.0;
/// The width of the first path; each further one is wider by [`WIDER`] and drawn below, so that coinciding paths are all
/// visible.
const WIDTH: f32 = 3.0;
const WIDER: f32 = 2.5;

/// Paths from one pose of the rear axle to another, with everything drawn around them.
#[derive(Clone, Copy)]
pub struct CurveScene<'a> {
    pub title: &'a str,
    pub start: Pose,
    pub goal: Pose,
    /// Each with its name for the key; beyond the fourth, colours repeat.
    pub ways: &'a [(&'a str, &'a Path)],
    /// The vehicle whose outline is drawn at both poses, if any.
    pub body: Option<&'a Dimensions>,
    /// Length in metres of what is shown at least: ways may have no length.
    pub min_m: f64,
}

/// Draws the paths to scale, reverse dashed, with start, goal, cusps, a key, and metres east and north along the edges.
///
/// The longer side of the drawing takes 720 pixels, the shorter one at least 288.
pub fn draw_curves(scene: &CurveScene) -> Picture {
    let lines: Vec<Vec<WayRun>> = scene.ways.iter().map(|(_, path)| way_runs(path)).collect();
    let outlines: Vec<_> = bodies(scene).collect();
    let driven = lines.iter().flatten().flat_map(|run| run.places.iter());
    let ends = [scene.start, scene.goal].map(|pose| (pose.x, pose.y));
    let places = driven.chain(outlines.iter().flatten()).chain(&ends).copied();
    let frame = WorldFrame::fit(places, scene.min_m);

    let WorldSheet { mut canvas, frame } = WorldSheet::new(scene.title, frame, key(scene, &lines));
    for outline in &outlines {
        let corners: Vec<Point> = outline.iter().chain(&outline[..1]).map(|&place| frame.at(place)).collect();
        canvas.polyline(&corners, 1.5, INK);
    }
    draw_ways(&mut canvas, &frame, &lines);
    for (mark, pose) in [(PoseMark::Goal, scene.goal), (PoseMark::Start, scene.start)] {
        mark.draw(&mut canvas, frame.at((pose.x, pose.y)), pose.heading, MARK);
    }
    canvas.finish()
}

/// The corners of the vehicle at start and goal.
fn bodies(scene: &CurveScene) -> impl Iterator<Item = [(f64, f64); 4]> {
    let at = |pose| Some(scene.body?.footprint(pose).corners().map(|corner| (corner.x, corner.y)));
    [at(scene.start), at(scene.goal)].into_iter().flatten()
}

fn draw_ways(canvas: &mut Canvas, frame: &WorldFrame, lines: &[Vec<WayRun>]) {
    for (index, runs) in lines.iter().enumerate().rev() {
        for run in runs {
            let points: Vec<Point> = run.places.iter().map(|&place| frame.at(place)).collect();
            draw_run(canvas, &points, WIDTH + WIDER * index as f32, colour(index), run.is_reverse);
        }
    }
    for &place in lines.iter().flat_map(|runs| cusps(runs)) {
        draw_cusp(canvas, frame.at(place));
    }
}

/// Returns the places where all runs but the first begin.
fn cusps(runs: &[WayRun]) -> impl Iterator<Item = &(f64, f64)> {
    runs.iter().skip(1).map(|run| &run.places[0])
}

fn colour(way: usize) -> Rgb {
    WAYS[way % WAYS.len()]
}

fn key<'a>(scene: &CurveScene<'a>, lines: &[Vec<WayRun>]) -> Vec<(Symbol, &'a str)> {
    let ways = scene.ways.iter().enumerate().map(|(index, (name, _))| (Symbol::Way(colour(index)), *name));
    let has_reverse = lines.iter().flatten().any(|run| run.is_reverse);
    let reverse = has_reverse.then_some((Symbol::Reverse, "in reverse"));
    let has_cusps = lines.iter().any(|runs| runs.len() > 1);
    let cusp = has_cusps.then_some((Symbol::Cusp, "cusp"));
    let body = scene.body.map(|_| (Symbol::Cell(PAPER), "truck"));
    let ends = [PoseMark::Start, PoseMark::Goal].map(|mark| (Symbol::Pose(mark), mark.name()));
    ways.chain(reverse).chain(cusp).chain(ends).chain(body).collect()
}
