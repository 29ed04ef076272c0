//! Overlap of a body with bushes and border, by rapier's shapes.

use glam::DVec2;
use rapier2d::parry::bounding_volume::Aabb;
use rapier2d::parry::math::{Pose as ShapePose, Vector};
use rapier2d::parry::query::sat::cuboid_cuboid_find_local_separating_normal_oneway as separation;
use rapier2d::parry::shape::Cuboid;

use crate::geometry::{Cell, FieldFrame, Pose};
use crate::vehicle::Dimensions;

/// Less than this is not an offence, in metres: the shapes compute in single precision.
const ALLOWED_M: f64 = 1e-3;

/// Bushes and border as rapier's shapes see them.
#[derive(Clone, Debug)]
pub struct Ground {
    frame: FieldFrame,
    is_bush: Vec<bool>,
    bush: Cuboid,
}

/// What a body touches, and how deep in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Touch {
    Bush { cell: Cell, depth_m: f64 },
    Border { depth_m: f64 },
}

impl Ground {
    /// A field of bushes; cells outside of the frame are ignored.
    pub fn new(frame: FieldFrame, bushes: &[Cell]) -> Self {
        let mut is_bush = vec![false; frame.cell_count()];
        for &cell in bushes.iter().filter(|cell| cell.col < frame.cols && cell.row < frame.rows) {
            is_bush[frame.index(cell)] = true;
        }
        Self { frame, is_bush, bush: Cuboid::new(Vector::splat(0.5 * frame.cell_m as f32)) }
    }

    pub fn frame(&self) -> &FieldFrame {
        &self.frame
    }

    /// What a truck overlaps at a pose of its rear axle, by more than a millimetre; a pose that is not a number counts
    /// as outside.
    pub fn touch(&self, body: &Dimensions, pose: Pose) -> Option<Touch> {
        let shape = Cuboid::new(Vector::new(0.5 * body.length_m as f32, 0.5 * body.width_m as f32));
        let turned = ShapePose::new(Vector::ZERO, pose.heading as f32);
        let ahead = turned.rotation * Vector::new(1.0, 0.0);
        let ahead = DVec2::new(ahead.x.into(), ahead.y.into());
        let centre = pose.position() + ahead * (0.5 * body.length_m - body.rear_overhang_m);
        let outline = shape.aabb(&turned);
        self.touch_border(centre, &outline).or_else(|| self.touch_bush(centre, &shape, &turned, &outline))
    }

    fn touch_border(&self, centre: DVec2, outline: &Aabb) -> Option<Touch> {
        let half = half_extents(outline);
        let inside = (centre - half).min(DVec2::new(self.frame.width_m(), self.frame.height_m()) - centre - half);
        let depth_m = -inside.min_element();
        let is_free = inside.x >= -ALLOWED_M && inside.y >= -ALLOWED_M;
        (!is_free).then_some(Touch::Border { depth_m })
    }

    fn touch_bush(&self, centre: DVec2, shape: &Cuboid, turned: &ShapePose, outline: &Aabb) -> Option<Touch> {
        let half = half_extents(outline);
        let first = ((centre - half) / self.frame.cell_m).floor().max(DVec2::ZERO);
        let last = ((centre + half) / self.frame.cell_m).floor();
        let last_col = (last.x as usize).min(usize::from(self.frame.cols) - 1);
        let last_row = (last.y as usize).min(usize::from(self.frame.rows) - 1);
        for row in first.y as usize..=last_row {
            for col in first.x as usize..=last_col {
                let cell = Cell { col: col as u16, row: row as u16 };
                if !self.is_bush[self.frame.index(cell)] {
                    continue;
                }
                // Relative to the body, so that single precision loses nothing on large fields.
                let offset = self.frame.centre(cell) - centre;
                let beside = ShapePose::translation(offset.x as f32, offset.y as f32);
                let depth_m = depth(shape, turned, &self.bush, &beside);
                if depth_m > ALLOWED_M {
                    return Some(Touch::Bush { cell, depth_m });
                }
            }
        }
        None
    }
}

/// How deep two cuboids overlap, in metres; negative where a line along a side of either keeps them apart.
///
/// `contact_cuboid_cuboid` would be the obvious query, but misses overlaps whose deepest corner lies beside the other
/// cuboid's face.
fn depth(one: &Cuboid, one_at: &ShapePose, other: &Cuboid, other_at: &ShapePose) -> f64 {
    let (seen, _) = separation(one, other, &one_at.inv_mul(other_at));
    let (seen_back, _) = separation(other, one, &other_at.inv_mul(one_at));
    -f64::from(seen.max(seen_back))
}

fn half_extents(outline: &Aabb) -> DVec2 {
    let half = outline.half_extents();
    DVec2::new(half.x.into(), half.y.into())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;
    use crate::geometry::ops;

    fn ground() -> Ground {
        Ground::new(FieldFrame { cols: 10, rows: 10, cell_m: 5.0 }, &[Cell { col: 5, row: 5 }])
    }

    fn touch(x: f64, y: f64, heading: f64) -> Option<Touch> {
        ground().touch(&Dimensions::default(), Pose::new(x, y, heading))
    }

    #[test]
    fn a_millimetre_decides_at_a_bush() {
        // The bush reaches from 25 m to 30 m, the truck 3.95 m ahead and 1.1 m to either side of its rear axle.
        assert_eq!(touch(25.0 - 3.95 + 0.0005, 27.0, 0.0), None);
        let Some(Touch::Bush { cell, depth_m }) = touch(25.0 - 3.95 + 0.002, 27.0, 0.0) else {
            panic!("two millimetres are an overlap");
        };
        assert_eq!(cell, Cell { col: 5, row: 5 });
        assert!((depth_m - 0.002).abs() < 1e-4);
        assert_eq!(touch(30.0 + 1.1 - 0.0005, 27.0, FRAC_PI_2), None);
        assert!(touch(30.0 + 1.1 - 0.002, 27.0, FRAC_PI_2).is_some());
        assert!(touch(30.0 + 0.95 - 0.002, 27.0, 0.0).is_some());
    }

    #[test]
    fn a_corner_beside_a_corner_is_free_and_one_inside_is_not() {
        // Front left corner at the bush's south-west corner: (3.95, 1.1) turned by 45 degrees.
        let turned = DVec2::new(3.95 - 1.1, 3.95 + 1.1) * ops::cos(FRAC_PI_4);
        let at_corner = DVec2::new(25.0, 25.0) - turned;
        let free = at_corner + DVec2::new(-0.01, 0.0);
        let inside = at_corner + DVec2::new(0.05, 0.05);
        assert_eq!(touch(free.x - 0.1, free.y - 0.1, FRAC_PI_4), None);
        assert!(touch(inside.x, inside.y, FRAC_PI_4).is_some());
    }

    #[test]
    fn a_millimetre_decides_at_the_border() {
        assert_eq!(touch(0.95 - 0.0005, 10.0, 0.0), None);
        let Some(Touch::Border { depth_m }) = touch(0.95 - 0.002, 10.0, 0.0) else {
            panic!("two millimetres are outside");
        };
        assert!((depth_m - 0.002).abs() < 1e-5);
        assert!(touch(50.0 - 3.95 + 0.002, 10.0, 0.0).is_some());
        assert!(touch(10.0, 50.0 - 1.1 + 0.002, 0.0).is_some());
        assert!(touch(10.0, 1.1 - 0.002, 0.0).is_some());
        assert!(touch(-500.0, 20.0, 0.0).is_some());
        assert!(touch(f64::NAN, 20.0, 0.0).is_some());
        assert!(touch(20.0, 20.0, f64::NAN).is_some());
    }
}
