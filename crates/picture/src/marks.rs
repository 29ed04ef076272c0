//! Path, start, goal and the place where a descent is stuck: distinguished by shape, readable on any colour.

use crate::canvas::{Canvas, Point};
use crate::colours::{GOAL, INK, PAPER, PATH, Rgb};
use crate::scene::MapScene;
use wildfire_base::geometry::ops;
use wildfire_grid::Place;

/// A mark on a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    Start,
    Goal,
    Stuck,
}

wildfire_base::names! { Mark { Start: "start", Goal: "goal", Stuck: "local minimum" } }

impl Mark {
    pub fn draw(self, canvas: &mut Canvas, at: Point, radius: f32) {
        match self {
            Self::Start => draw_disc(canvas, at, radius),
            Self::Goal => draw_star(canvas, at, radius),
            Self::Stuck => draw_cross(canvas, at, radius),
        }
    }
}

/// The marks that a scene has, as the key lists them; they are drawn in the opposite order.
pub fn scene_marks(scene: &MapScene) -> impl DoubleEndedIterator<Item = (Mark, Place)> {
    let marks = [(Mark::Start, scene.start), (Mark::Goal, scene.goal), (Mark::Stuck, scene.stuck)];
    marks.into_iter().filter_map(|(mark, place)| Some((mark, place?)))
}

fn draw_disc(canvas: &mut Canvas, at: Point, radius: f32) {
    canvas.fill_disc(at, radius, PAPER);
    canvas.fill_disc(at, 0.84 * radius, INK);
    canvas.fill_disc(at, 0.52 * radius, PAPER);
}

fn draw_star(canvas: &mut Canvas, at: Point, radius: f32) {
    for (share, colour) in [(1.5, PAPER), (1.25, INK), (0.9, GOAL)] {
        canvas.fill(&star(at, share * radius), colour);
    }
}

/// Five points; the inner corners of a pentagram lie at 0.382 of the radius, fuller ones read better when small.
fn star((x, y): Point, radius: f32) -> Vec<Point> {
    (0..10)
        .map(|index: u8| {
            let (sin, cos) = ops::sin_cos(f64::from(index) * std::f64::consts::PI / 5.0);
            let length = if index.is_multiple_of(2) { radius } else { 0.5 * radius };
            (x + length * to_f32(sin), y - length * to_f32(cos))
        })
        .collect()
}

fn draw_cross(canvas: &mut Canvas, (x, y): Point, radius: f32) {
    let arm = 0.7 * radius;
    for (width, colour) in [(0.75, PAPER), (0.4, INK)] {
        canvas.polyline(&[(x - arm, y - arm), (x + arm, y + arm)], width * radius, colour);
        canvas.polyline(&[(x - arm, y + arm), (x + arm, y - arm)], width * radius, colour);
    }
}

/// A line of the path's colour with a halo.
pub fn draw_path(canvas: &mut Canvas, points: &[Point], width: f32) {
    let halo = width + 2.0 * (0.5 * width).max(1.0);
    for (width, colour) in [(halo, PAPER), (width, PATH)] as [(f32, Rgb); 2] {
        canvas.polyline(points, width, colour);
    }
}

/// The corners of a path: cells where it begins, turns or ends.
pub fn corners(path: &[Place]) -> Vec<Place> {
    let step = |from: Place, to: Place| (to.0.wrapping_sub(from.0), to.1.wrapping_sub(from.1));
    (0..path.len())
        .filter(|&index: &usize| {
            let inner = index > 0 && index + 1 < path.len();
            !inner || step(path[index - 1], path[index]) != step(path[index], path[index + 1])
        })
        .map(|index| path[index])
        .collect()
}

#[expect(clippy::cast_possible_truncation, reason = "pixels are drawn in single precision")]
pub fn to_f32(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_stretches_have_no_corners() {
        assert_eq!(corners(&[(0, 0), (0, 1), (0, 2), (1, 3), (2, 4), (2, 3)]), [(0, 0), (0, 2), (2, 4), (2, 3)]);
        assert_eq!(corners(&[(3, 3)]), [(3, 3)]);
        assert_eq!(corners(&[]), []);
    }

    #[test]
    fn marks_show_on_every_ground() {
        for ground in [PAPER, INK, PATH] {
            for mark in [Mark::Start, Mark::Goal, Mark::Stuck] {
                let mut canvas = Canvas::new(20, 20, ground);
                mark.draw(&mut canvas, (10.0, 10.0), 7.0);
                let picture = canvas.finish();
                let pixels: Vec<Rgb> = (0..400).map(|index| picture.pixel(index % 20, index / 20)).collect();
                let other = pixels.iter().filter(|&&pixel| pixel != ground).count();
                assert!(other > 40, "{mark:?} leaves {other} pixels on {ground:?}");
            }
        }
    }
}
