//! Overlap of a body with bushes, border and other bodies, by rapier's shapes.

use glam::DVec2;
use rapier2d::parry::math::{Pose as ShapePose, Rotation, Vector};
use rapier2d::parry::query::sat::cuboid_cuboid_find_local_separating_normal_oneway as separation;
use rapier2d::parry::shape::Cuboid;

use wildfire_base::geometry::{Cell, FieldFrame, Pose};
use wildfire_timeline::Body;

/// Less than this is not a violation, in metres: the shapes compute in single precision.
pub const ALLOWED_M: f64 = 1e-3;

/// Beyond the circle about a body by so much nothing touches it, in metres.
const MARGIN_M: f64 = 1e-3;

/// Squares along the side of a cell, or along the radius of a body if that is longer.
const SQUARES: f64 = 4.0;

/// A touch of a body: with what, and how deep in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    Bush { cell: Cell, depth_m: f64 },
    Border { depth_m: f64 },
}

/// Where a body is: the place of its origin, and the unit vector of its heading.
#[derive(Clone, Copy, Debug)]
pub struct UnitPose {
    pub place: DVec2,
    pub facing: DVec2,
}

impl UnitPose {
    pub fn new(pose: Pose) -> Self {
        Self { place: pose.position(), facing: pose.direction() }
    }
}

/// A rectangular body: half of its extents, and how far ahead of its origin its centre is, in metres.
#[derive(Clone, Copy, Debug)]
pub struct Outline {
    pub half: DVec2,
    pub ahead_m: f64,
    /// True if it turns with its heading; a Wumpus's sides stay parallel to the field's.
    pub turns: bool,
}

impl Outline {
    /// A truck's rectangle about its rear axle, or a Wumpus's square about its pose.
    pub fn new(body: &Body) -> Self {
        match body {
            Body::Truck(body) => Self {
                half: 0.5 * DVec2::new(body.length_m, body.width_m),
                ahead_m: 0.5 * body.length_m - body.rear_overhang_m,
                turns: true,
            },
            Body::Square { size_m } => Self { half: DVec2::splat(0.5 * size_m), ahead_m: 0.0, turns: false },
        }
    }

    pub fn centre(&self, at: UnitPose) -> DVec2 {
        at.place + at.facing * self.ahead_m
    }

    /// Radius of the circle about the centre that holds the body.
    pub fn radius_m(&self) -> f64 {
        self.half.length()
    }

    /// Computes how deep two bodies overlap, in metres; not above 0 where they do not.
    pub fn overlap_m(&self, at: UnitPose, other: &Self, other_at: UnitPose) -> f64 {
        let offset = other.centre(other_at) - self.centre(at);
        depth(&self.shape(), &self.turned(at, DVec2::ZERO), &other.shape(), &other.turned(other_at, offset))
    }

    fn shape(&self) -> Cuboid {
        Cuboid::new(single(self.half))
    }

    /// The pose of its shape, with the centre at `offset`.
    fn turned(&self, at: UnitPose, offset: DVec2) -> ShapePose {
        let facing = if self.turns { single(at.facing) } else { Vector::X };
        ShapePose { rotation: Rotation::from_cos_sin_unchecked(facing.x, facing.y), translation: single(offset) }
    }
}

/// Bushes and border of a field, for bodies of one outline.
///
/// A coarse map of where the circle about such a body can touch anything answers for most places.
#[derive(Clone, Debug)]
pub struct AuditField {
    frame: FieldFrame,
    is_bush: Vec<bool>,
    bush: Cuboid,
    outline: Outline,
    shape: Cuboid,
    /// Row by row from the south-west: whether a body whose centre is in this square may touch something.
    is_near: Vec<bool>,
    side_m: f64,
    squares: [usize; 2],
}

impl AuditField {
    /// A field of bushes; cells outside of the frame are ignored.
    pub fn new(frame: FieldFrame, bushes: &[Cell], outline: Outline) -> Self {
        // Finer squares would take more memory, coarser ones sort out less.
        let side_m = frame.cell_m.max(outline.radius_m()) / SQUARES;
        let squares = [frame.width_m(), frame.height_m()].map(|extent| (extent / side_m).ceil().max(1.0) as usize);
        let mut field = Self {
            frame,
            is_bush: vec![false; frame.cell_count()],
            bush: Cuboid::new(Vector::splat(0.5 * frame.cell_m as f32)),
            outline,
            shape: outline.shape(),
            is_near: vec![false; squares[0] * squares[1]],
            side_m,
            squares,
        };
        field.mark_border();
        // Recordings may come from anywhere: bushes beyond the field are passed over.
        for &cell in bushes.iter().filter(|cell| cell.col < frame.cols && cell.row < frame.rows) {
            field.is_bush[frame.index(cell)] = true;
            field.mark_bush(cell);
        }
        field
    }

    /// Returns how many cells lie under a body, at most.
    pub fn cells_under_body(&self) -> f64 {
        let along = 2.0 * self.outline.radius_m() / self.frame.cell_m + 1.0;
        along * along
    }

    /// Finds what the body overlaps by more than a millimetre; a place that is not a number counts as outside.
    pub fn touch(&self, at: UnitPose) -> Option<Contact> {
        let centre = self.outline.centre(at);
        if self.is_far(centre) {
            return None;
        }
        let turned = self.outline.turned(at, DVec2::ZERO);
        let outline = self.shape.aabb(&turned).half_extents();
        let half = DVec2::new(outline.x.into(), outline.y.into());
        self.touch_border(centre, half).or_else(|| self.touch_bush(centre, half, &turned))
    }

    fn touch_border(&self, centre: DVec2, half: DVec2) -> Option<Contact> {
        let inside = (centre - half).min(DVec2::new(self.frame.width_m(), self.frame.height_m()) - centre - half);
        let depth_m = -inside.min_element();
        let is_free = inside.x >= -ALLOWED_M && inside.y >= -ALLOWED_M;
        (!is_free).then_some(Contact::Border { depth_m })
    }

    fn touch_bush(&self, centre: DVec2, half: DVec2, turned: &ShapePose) -> Option<Contact> {
        // Casts below clamp at 0, where a body leans over the border.
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
                let beside = ShapePose { rotation: Rotation::IDENTITY, translation: single(offset) };
                let depth_m = depth(&self.shape, turned, &self.bush, &beside);
                if depth_m > ALLOWED_M {
                    return Some(Contact::Bush { cell, depth_m });
                }
            }
        }
        None
    }

    /// Returns true if nothing is within the circle about a body whose centre is here; never outside of the field.
    fn is_far(&self, centre: DVec2) -> bool {
        let place = centre / self.side_m;
        let inside = place.x >= 0.0 && place.y >= 0.0;
        let (col, row) = (place.x as usize, place.y as usize);
        inside && col < self.squares[0] && row < self.squares[1] && !self.is_near[row * self.squares[0] + col]
    }

    fn mark_border(&mut self) {
        let radius_m = self.outline.radius_m() + MARGIN_M;
        let side_m = self.side_m;
        let [cols, rows] = self.squares;
        let is_inside = |square: usize, extent: f64| {
            // All of the square has to be that far inside.
            square as f64 * side_m >= radius_m && (square + 1) as f64 * side_m <= extent - radius_m
        };
        for row in 0..rows {
            for col in 0..cols {
                let inside = is_inside(col, self.frame.width_m()) && is_inside(row, self.frame.height_m());
                self.is_near[row * cols + col] = !inside;
            }
        }
    }

    fn mark_bush(&mut self, cell: Cell) {
        let around = DVec2::splat(0.5 * self.frame.cell_m + self.outline.radius_m() + MARGIN_M);
        let centre = self.frame.centre(cell);
        let [first, last] = [centre - around, centre + around].map(|corner| (corner / self.side_m).floor());
        let last_col = (last.x.max(0.0) as usize).min(self.squares[0] - 1);
        let last_row = (last.y.max(0.0) as usize).min(self.squares[1] - 1);
        for row in first.y.max(0.0) as usize..=last_row {
            let start = row * self.squares[0];
            self.is_near[start + first.x.max(0.0) as usize..=start + last_col].fill(true);
        }
    }
}

/// Computes how deep two cuboids overlap, in metres; negative where a line along a side of either keeps them apart.
///
/// `contact_cuboid_cuboid` would be the obvious query, but misses overlaps whose deepest corner lies beside the other
/// cuboid's face.
fn depth(one: &Cuboid, one_at: &ShapePose, other: &Cuboid, other_at: &ShapePose) -> f64 {
    let (seen, _) = separation(one, other, &one_at.inv_mul(other_at));
    let (seen_back, _) = separation(other, one, &other_at.inv_mul(one_at));
    -f64::from(seen.max(seen_back))
}

fn single(vector: DVec2) -> Vector {
    Vector::new(vector.x as f32, vector.y as f32)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    use super::*;
    use wildfire_base::geometry::ops;
    use wildfire_base::vehicle::Dimensions;

    const FRAME: FieldFrame = FieldFrame { cols: 10, rows: 10, cell_m: 5.0 };

    fn truck() -> Outline {
        Outline::new(&Body::Truck(Dimensions::default()))
    }

    fn stance(x: f64, y: f64, heading: f64) -> UnitPose {
        UnitPose::new(Pose { x, y, heading })
    }

    fn touch(x: f64, y: f64, heading: f64) -> Option<Contact> {
        AuditField::new(FRAME, &[Cell { col: 5, row: 5 }], truck()).touch(stance(x, y, heading))
    }

    #[test]
    fn a_millimetre_decides_at_a_bush() {
        // The bush reaches from 25 m to 30 m, the truck 3.95 m ahead and 1.1 m to either side of its rear axle.
        assert_eq!(touch(25.0 - 3.95 + 0.0005, 27.0, 0.0), None);
        let Some(Contact::Bush { cell, depth_m }) = touch(25.0 - 3.95 + 0.002, 27.0, 0.0) else {
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
        let Some(Contact::Border { depth_m }) = touch(0.95 - 0.002, 10.0, 0.0) else {
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

    #[test]
    fn the_coarse_map_hides_no_touch() {
        let bushes =
            [Cell { col: 5, row: 5 }, Cell { col: 2, row: 7 }, Cell { col: 0, row: 0 }, Cell { col: 9, row: 9 }];
        for (cell_m, body) in [(5.0, truck()), (0.7, truck()), (40.0, Outline::new(&Body::Square { size_m: 3.0 }))] {
            let frame = FieldFrame { cell_m, ..FRAME };
            let coarse = AuditField::new(frame, &bushes, body);
            let fine = AuditField { is_near: vec![true; coarse.is_near.len()], ..coarse.clone() };
            for k in 0..40_000 {
                let share = |step: f64| 1.2 * (f64::from(k) * step).fract() - 0.1;
                let [x, y] = [0.618_034, 0.414_214].map(|step| share(step) * frame.width_m());
                let at = stance(x, y, f64::from(k));
                assert_eq!(coarse.touch(at), fine.touch(at), "{at:?}");
            }
            assert!(coarse.is_near.contains(&false) || cell_m < 1.0, "the map says nothing");
        }
    }

    #[test]
    fn a_millimetre_decides_between_two_bodies() {
        let overlap =
            |x: f64, y: f64, heading: f64| truck().overlap_m(stance(0.0, 0.0, 0.0), &truck(), stance(x, y, heading));
        assert!((overlap(4.9 - 0.002, 0.0, 0.0) - 0.002).abs() < 1e-5);
        assert!(overlap(4.9 + 0.002, 0.0, 0.0) < 0.0);
        assert!(overlap(3.0, 2.2 + 0.002, PI) < 0.0 && overlap(3.0, 2.2 - 0.002, PI) > 0.001);
        // Across the front: half of its width and all of its length ahead of the rear axle.
        assert!(
            overlap(3.95 + 1.1 + 0.002, 0.0, FRAC_PI_2) < 0.0 && overlap(3.95 + 1.1 - 0.002, 0.0, FRAC_PI_2) > 0.001
        );
    }
}
