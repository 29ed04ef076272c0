//! Exact distances from a rectangle to squares and to the border.

use std::ops::ControlFlow;

use glam::DVec2;

use super::ClearanceField;
use wildfire_base::geometry::{FieldFrame, OrientedRect};

/// A body's outline, with its direction as a unit vector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    pub centre: DVec2,
    /// The unit vector along the length.
    pub axis: DVec2,
    pub half_length: f64,
    pub half_width: f64,
}

impl From<OrientedRect> for Rectangle {
    fn from(outline: OrientedRect) -> Self {
        let OrientedRect { centre, half_length, half_width } = outline;
        Self { centre: centre.position(), axis: centre.direction(), half_length, half_width }
    }
}

impl Rectangle {
    /// Returns half the extents of the smallest axis-parallel box around the rectangle.
    pub fn half_box(&self) -> DVec2 {
        let cos = self.axis.x.abs();
        let sin = self.axis.y.abs();
        DVec2::new(cos * self.half_length + sin * self.half_width, sin * self.half_length + cos * self.half_width)
    }

    /// Returns the exact distance to the field's border; negative where a corner is outside or the position is not a
    /// number.
    #[inline]
    pub fn border_gap(&self, frame: &FieldFrame) -> f64 {
        let half = self.half_box();
        let low = self.centre - half;
        let high = DVec2::new(frame.width_m(), frame.height_m()) - self.centre - half;
        // Every comparison with NaN is false, so callers would take such a position for free.
        if low.is_nan() || high.is_nan() {
            return f64::NEG_INFINITY;
        }
        // NaN is ruled out, and a plain comparison takes one instruction.
        [low.y, high.x, high.y].into_iter().fold(low.x, |min, gap| if gap < min { gap } else { min })
    }

    /// Returns the exact distance to the nearest bush, or `reach` if none is nearer; 0 on contact.
    #[inline]
    pub fn bush_gap(&self, field: &ClearanceField, reach: f64) -> f64 {
        let half_cell = 0.5 * field.frame().cell_m;
        let mut near = field.bushes_near(self.centre, self.half_box() + DVec2::splat(reach));
        // On contact nothing is nearer.
        let min =
            near.try_fold(reach * reach, |min, centre| match self.squared_gap_to_square(centre, half_cell, min) {
                0.0 => ControlFlow::Break(0.0),
                squared => ControlFlow::Continue(squared),
            });
        let (ControlFlow::Break(min) | ControlFlow::Continue(min)) = min;
        min.sqrt()
    }

    /// Returns the squared distance to an axis-parallel square, or `limit` if that is less; 0 on contact.
    ///
    /// Two convex shapes overlap if and only if no line along a side of either separates them (the separating axis
    /// theorem); if they do not, the shortest way between two rectangles begins or ends at a corner.
    #[inline]
    pub fn squared_gap_to_square(&self, square_centre: DVec2, half_side: f64, limit: f64) -> f64 {
        let offset = square_centre - self.centre;
        // The square as the rectangle sees it, along its length and its width.
        let u = offset.dot(self.axis);
        let v = self.axis.perp_dot(offset);
        let diagonal = half_side * (self.axis.x.abs() + self.axis.y.abs());
        let body_gap = (u.abs() - self.half_length).max(v.abs() - self.half_width) - diagonal;
        let world_gap = (offset.abs() - self.half_box()).max_element() - half_side;
        let separation = body_gap.max(world_gap);
        // By the axes of both shapes no line separates them: they overlap.
        if separation <= 0.0 {
            return 0.0;
        }
        if separation * separation >= limit {
            return limit;
        }
        let mut min = limit;
        let half = DVec2::new(self.half_length, self.half_width);
        // The nearest points of two rectangles apart include a corner of one of them.
        for (along, across) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            let corner = self.axis * (along * half.x) + self.axis.perp() * (across * half.y);
            min = min.min(((corner - offset).abs() - half_side).max(DVec2::ZERO).length_squared());
            let other = offset + DVec2::new(along, across) * half_side;
            let seen = DVec2::new(other.dot(self.axis), self.axis.perp_dot(other));
            min = min.min((seen.abs() - half).max(DVec2::ZERO).length_squared());
        }
        min
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::brute_force::RandomBushes;
    use super::*;
    use wildfire_base::geometry::OrientedRect;
    use wildfire_base::rng;

    #[test]
    fn gaps_equal_brute_force() {
        let mut rng = rng::stream(1, "collision/rectangle");
        let mut contacts = 0;
        for round in 0..40 {
            let test = RandomBushes::random(&mut rng, [5.0, 1.1][round % 2], 0.1);
            for _ in 0..300 {
                let pose = test.random_pose(&mut rng);
                let half_length = rng.random_range(0.1..4.0);
                let half_width = rng.random_range(0.1..2.0);
                let outline = OrientedRect { centre: pose, half_length, half_width };
                let rectangle = Rectangle { centre: pose.position(), axis: pose.direction(), half_length, half_width };
                let border = rectangle.border_gap(test.field.frame());
                let gap = rectangle.bush_gap(&test.field, 3.0).min(border);
                let expected = test.rectangle_distance(&outline).min(3.0);
                assert!((gap - expected).abs() < 1e-9, "{outline:?}: {gap}, brute force {expected}");
                contacts += u32::from(expected <= 0.0);
            }
        }
        assert!(contacts > 100, "{contacts} contacts");
    }
}
