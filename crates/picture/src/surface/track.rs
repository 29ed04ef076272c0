//! Path and marks on a surface.

use crate::canvas::{Canvas, Point};
use crate::colours::PATH;
use crate::marks::{draw_path, scene_marks, to_f32};
use crate::scene::MapScene;
use crate::surface::camera::{SpacePoint, SurfaceCamera};
use crate::surface::relief::Relief;
use crate::values::ValueScale;
use crate::zoom::BlockFace;
use wildfire_grid::Place;

const WIDTH: f32 = 2.4;
const MARK: f32 = 7.0;
/// The line is followed in steps of about this length, in pixels.
const STEP: f32 = 2.0;
const DOT: f32 = 1.2;
const DOTS_APART: f32 = 6.0;
/// The height by which the surface must rise above the line of sight to hide what is behind, as a share of the highest
/// level; the path lies on the surface and must not hide itself.
const TOLERANCE: f32 = 0.02;

/// The surface that a path is drawn on.
pub struct SurfaceTrack<'a> {
    pub scene: &'a MapScene<'a>,
    pub relief: &'a Relief,
    pub heights: Option<&'a ValueScale>,
    pub camera: SurfaceCamera,
}

impl SurfaceTrack<'_> {
    /// Draws the path, dotted where the surface hides it, and the marks, which nothing hides.
    pub fn draw_track(&self, canvas: &mut Canvas) {
        let line: Vec<(Point, bool)> = self.line().into_iter().map(|(at, spot)| (at, self.is_hidden(spot))).collect();
        for run in line.chunk_by(|(_, before), (_, after)| before == after) {
            let points: Vec<Point> = run.iter().map(|&(at, _)| at).collect();
            if run[0].1 { draw_dots(canvas, &points) } else { draw_path(canvas, &points, WIDTH) }
        }
        for (mark, place) in scene_marks(self.scene).rev() {
            mark.draw(canvas, self.camera.spot(self.cell(place)), MARK);
        }
    }

    /// Returns the centre of a cell, on the surface; at its own value where its tile is drawn as something else.
    fn cell(&self, place: Place) -> SpacePoint {
        let (x, y) = self.relief.centre(place);
        let cell_level =
            self.scene.value_at(place).zip(self.heights).map(|(value, heights)| to_f32(heights.fraction(value)));
        let level = match (self.relief.face_at(x, y), cell_level) {
            (BlockFace::Obstacle | BlockFace::WithoutValue, Some(cell_level)) => cell_level,
            _ => self.relief.level_at(x, y),
        };
        SpacePoint { x, y, level }
    }

    /// Divides the path into small steps, since a part of a step between cells may be hidden; shorter steps are left
    /// out.
    fn line(&self) -> Vec<(Point, SpacePoint)> {
        let mut line: Vec<(Point, SpacePoint)> = Vec::new();
        for &place in self.scene.path {
            let spot = self.cell(place);
            let at = self.camera.spot(spot);
            let Some(&(last_at, last)) = line.last() else {
                line.push((at, spot));
                continue;
            };
            // Where cells are smaller than a step, points are skipped until one is far enough from the last.
            let steps = (distance(last_at, at) / STEP).floor();
            let mut step = 1.0;
            while step <= steps {
                let spot = self.between(last, spot, step / steps);
                line.push((self.camera.spot(spot), spot));
                step += 1.0;
            }
        }
        line
    }

    /// Returns a spot on the way between two cells, on the surface if both are.
    fn between(&self, from: SpacePoint, to: SpacePoint, share: f32) -> SpacePoint {
        let along = |from: f32, to: f32| from + (to - from) * share;
        let x = along(from.x, to.x);
        let y = along(from.y, to.y);
        let level = along(from.level, to.level);
        match self.relief.face_at(x, y) {
            BlockFace::Value(_) => SpacePoint { x, y, level: self.relief.level_at(x, y) },
            BlockFace::Obstacle | BlockFace::WithoutValue => SpacePoint { x, y, level },
        }
    }

    /// Returns whether the surface rises above the line of sight from a spot to the viewer.
    fn is_hidden(&self, spot: SpacePoint) -> bool {
        // Less than half a tile, so that no tile between spot and viewer is stepped over.
        let step = 0.4 / self.relief.tiles.rows().max(self.relief.tiles.cols()) as f32;
        let mut above = self.camera.towards_viewer(spot, step);
        above.any(|above| self.relief.level_at(above.x, above.y) > above.level + TOLERANCE)
    }
}

fn draw_dots(canvas: &mut Canvas, line: &[Point]) {
    let mut last: Option<Point> = None;
    for &at in line {
        if last.is_none_or(|last| distance(last, at) >= DOTS_APART) {
            canvas.fill_disc(at, DOT, PATH);
            last = Some(at);
        }
    }
}

fn distance(from: Point, to: Point) -> f32 {
    let (x, y) = (to.0 - from.0, to.1 - from.1);
    (x * x + y * y).sqrt()
}
