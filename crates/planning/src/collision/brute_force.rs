//! Slow answers for the tests, computed by code that shares nothing with the fast ones.

use glam::DVec2;
use rand::{Rng, RngExt};

use super::ClearanceField;
use wildfire_base::geometry::{Cell, FieldFrame, OrientedRect, Pose};
use wildfire_grid::Grid;

/// A random field of bushes: its frame, the field and the bushes' corners, counter-clockwise.
pub struct RandomBushes {
    pub field: ClearanceField,
    pub bushes: Vec<[DVec2; 4]>,
}

impl RandomBushes {
    pub fn random(rng: &mut impl Rng, cell_m: f64, density: f64) -> Self {
        let frame = FieldFrame { cols: rng.random_range(3..20), rows: rng.random_range(3..20), cell_m };
        let values: Vec<bool> = (0..frame.cell_count()).map(|_| rng.random_bool(density)).collect();
        let occupied = Grid::from_values(frame.rows.into(), frame.cols.into(), values);
        let bushes = (0..frame.cell_count()).filter(|&i| occupied.values()[i]).map(|i| frame.cell(i));
        let bushes = bushes.map(|cell| square(&frame, cell)).collect();
        Self { field: ClearanceField::new(frame, &occupied), bushes }
    }

    pub fn random_point(&self, rng: &mut impl Rng) -> DVec2 {
        let frame = self.field.frame();
        DVec2::new(rng.random_range(0.0..frame.width_m()), rng.random_range(0.0..frame.height_m()))
    }

    pub fn random_pose(&self, rng: &mut impl Rng) -> Pose {
        let point = self.random_point(rng);
        Pose::new(point.x, point.y, rng.random_range(-3.2..3.2))
    }

    pub fn point_distance(&self, point: DVec2) -> f64 {
        let border = self.field.frame().border_distance(point);
        self.bushes.iter().map(|bush| point_to_polygon(point, bush)).fold(border, f64::min)
    }

    /// Distance from a rectangle to the nearest bush or the border; 0 or less on contact or outside.
    pub fn rectangle_distance(&self, rectangle: &OrientedRect) -> f64 {
        let corners = rectangle.corners();
        let border = corners.map(|corner| self.field.frame().border_distance(corner));
        let border = border.into_iter().fold(f64::INFINITY, f64::min);
        self.bushes.iter().map(|bush| polygon_to_polygon(&corners, bush)).fold(border, f64::min)
    }
}

fn square(frame: &FieldFrame, cell: Cell) -> [DVec2; 4] {
    let half = 0.5 * frame.cell_m;
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| frame.centre(cell) + DVec2::new(x, y) * half)
}

/// Distance to a convex polygon with counter-clockwise corners; 0 inside.
fn point_to_polygon(point: DVec2, polygon: &[DVec2; 4]) -> f64 {
    if edges(polygon).all(|(a, b)| (b - a).perp_dot(point - a) >= 0.0) {
        return 0.0;
    }
    edges(polygon).map(|(a, b)| point_to_segment(point, a, b)).fold(f64::INFINITY, f64::min)
}

/// Distance of two convex polygons with counter-clockwise corners; 0 on contact.
pub fn polygon_to_polygon(one: &[DVec2; 4], other: &[DVec2; 4]) -> f64 {
    let crossing = edges(one).any(|(a, b)| edges(other).any(|(c, d)| segments_cross(a, b, c, d)));
    if crossing {
        return 0.0;
    }
    let distances = one.iter().map(|&corner| point_to_polygon(corner, other));
    distances.chain(other.iter().map(|&corner| point_to_polygon(corner, one))).fold(f64::INFINITY, f64::min)
}

fn edges(polygon: &[DVec2; 4]) -> impl Iterator<Item = (DVec2, DVec2)> {
    (0..4).map(|k| (polygon[k], polygon[(k + 1) % 4]))
}

fn point_to_segment(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    (point - a.lerp(b, along)).length()
}

fn segments_cross(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
