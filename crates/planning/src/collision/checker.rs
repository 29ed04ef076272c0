//! Collision checks of a truck's body at a pose, or along a motion.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec2;

use super::field::Interpolated;
use super::rectangle::Rectangle;
use super::{ClearanceField, sweep};
use wildfire_base::geometry::{Cell, OrientedRect, Pose, ops};
use wildfire_base::vehicle::{Dimensions, Segment};

/// The clearance in metres that a body keeps in any case, whatever is asked for.
pub const MIN_CLEARANCE_M: f64 = 0.01;

/// The distance in metres by which a motion may undercut the minimum clearance between sampled poses. For clearances
/// below 0.06 m it is half of the clearance.
pub const MOTION_TOLERANCE_M: f64 = 0.03;

/// A long body is covered by no more discs than this; a longer one has larger discs.
const MAX_DISCS: usize = 8;

/// Where the discs prove this much beyond the minimum clearance, the exact distance is not worth its time.
const AMPLE_M: f64 = 0.15;

/// The exact distance looks this far beyond the minimum clearance.
const EXACT_REACH_M: f64 = 1.5;

/// Less than the root of a half: see [`Rectangle::gap_to`].
const SURE_SHARE: f64 = 0.7;

/// Metres that decide nothing: far more than sums and roots of metres are rounded by.
const ROUNDING_M: f64 = 1e-6;

/// A collision checker for one body on one field.
///
/// # Method
/// The body is covered by equal discs along its middle line. If the field's lower bound at every disc's centre exceeds
/// the disc's radius by the minimum clearance, the body keeps it. The largest disc about such a centre that lies *inside*
/// the body gives the opposite: if it certainly comes too near to a bush, so does the body. What neither decides is
/// computed exactly. The border is always exact.
#[derive(Clone, Debug)]
pub struct CollisionChecker {
    field: Arc<ClearanceField>,
    body: Dimensions,
    /// From the body's middle outwards.
    discs: Vec<Disc>,
    /// Of every disc.
    cover_radius: f64,
    /// Of the disc about the centre of the first that holds all of the body.
    outer_radius: f64,
    /// The clearance that the body keeps in any case, metres.
    min_clearance_m: f64,
    /// Other bodies that stand on the field, each with the radius of the circle about it.
    obstacles: Vec<(Rectangle, f64)>,
    /// Questions that it and its copies were asked, where somebody counts them.
    calls: Option<Arc<AtomicU64>>,
}

/// The thing that a body has too little clearance from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    Bush(Cell),
    /// The field's border.
    Border,
    /// Another body that stands on the field.
    Body,
}

/// The nearest obstacle, and its distance from the body.
#[derive(Clone, Copy, Debug)]
pub struct NearestObstacle {
    pub obstacle: Obstacle,
    pub gap_m: f64,
}

#[derive(Clone, Copy, Debug)]
struct Disc {
    /// From the body's centre forward to the disc's centre.
    offset: f64,
    /// Radius of the largest disc about the same centre that the body holds.
    inner_radius: f64,
}

impl CollisionChecker {
    /// Creates a checker for a body on a field without other bodies.
    pub fn new(field: Arc<ClearanceField>, body: Dimensions) -> Self {
        let (discs, cover_radius) = cover(&body);
        let outer_radius = ops::hypot(0.5 * body.length_m + discs[0].offset.abs(), 0.5 * body.width_m);
        let min_clearance_m = MIN_CLEARANCE_M;
        Self { field, body, discs, cover_radius, outer_radius, min_clearance_m, obstacles: Vec::new(), calls: None }
    }

    /// Returns a checker that keeps another clearance than [`MIN_CLEARANCE_M`] in any case.
    pub fn with_min_clearance(self, min_clearance_m: f64) -> Self {
        Self { min_clearance_m, ..self }
    }

    /// Returns a checker with these rectangles as additional obstacles.
    ///
    /// They count as bushes do, except in the field's own answers to points and lines.
    pub fn with_obstacles(&self, obstacles: impl IntoIterator<Item = OrientedRect>) -> Self {
        let mut crowded = self.clone();
        let obstacles = obstacles.into_iter().map(Rectangle::from);
        crowded.obstacles.extend(obstacles.map(|outline| (outline, outline.radius())));
        crowded
    }

    /// Returns a checker that counts the clearance queries to it and its clones.
    pub fn counting(&self, calls: &Arc<AtomicU64>) -> Self {
        Self { calls: Some(Arc::clone(calls)), ..self.clone() }
    }

    #[inline]
    fn count_call(&self) {
        if let Some(calls) = &self.calls {
            calls.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Returns the distances that answer queries first.
    pub fn field(&self) -> &ClearanceField {
        &self.field
    }

    /// Returns the body.
    pub fn body(&self) -> &Dimensions {
        &self.body
    }

    /// Returns a lower bound of the distance in metres from the body to the nearest bush or border; not positive on
    /// contact.
    ///
    /// Below one metre the answer is the exact distance.
    pub fn clearance(&self, pose: Pose) -> f64 {
        const NEAR_M: f64 = 1.0;
        self.count_call();
        let rectangle = self.place(pose);
        let border = self.border_gap(&rectangle);
        // Outside the field the lattice has only the values of its edge, which mean nothing there.
        if border <= 0.0 {
            return border;
        }
        let cover = self.cover_clearance(&rectangle).min(border);
        // Exact distances look at bushes one by one, and are promised only below a metre.
        if cover >= NEAR_M { cover } else { rectangle.bush_gap(&self.field, EXACT_REACH_M).min(border) }
    }

    /// Returns whether the body at this pose keeps at least `min_clearance` metres, and [`MIN_CLEARANCE_M`] in any
    /// case.
    pub fn pose_is_free(&self, pose: Pose, min_clearance: f64) -> bool {
        self.count_call();
        let min_clearance = min_clearance.max(self.min_clearance_m);
        self.clearance_from(&self.place(pose), min_clearance, min_clearance).is_some()
    }

    /// Returns whether the body keeps at least `min_clearance` metres, and [`MIN_CLEARANCE_M`] in any case, all along
    /// a segment from `start`, ends included.
    ///
    /// A motion that keeps it everywhere is accepted. An accepted motion keeps it at every pose that was looked at and
    /// [`MOTION_TOLERANCE_M`] less everywhere, and touches nothing.
    pub fn motion_is_free(&self, start: Pose, segment: Segment, min_clearance: f64) -> bool {
        self.count_call();
        let motion = SweptMotion::new(start, segment, &self.body);
        let (min_clearance, tolerance) = self.clearance_and_tolerance(min_clearance);
        sweep::holds_everywhere(motion.length_m, motion.rate, tolerance, |travelled, enough| {
            self.excess(&motion, travelled, min_clearance, enough)
        })
    }

    /// Returns the metres of a segment, from its start on, that provably keep the minimum clearance minus the tolerance
    /// of [`CollisionChecker::motion_is_free`]; 0 if the start does not keep it, the whole length if all of it is free.
    pub fn motion_prefix_free(&self, start: Pose, segment: Segment, min_clearance: f64) -> f64 {
        self.count_call();
        let motion = SweptMotion::new(start, segment, &self.body);
        let (min_clearance, tolerance) = self.clearance_and_tolerance(min_clearance);
        let prefix = sweep::proven_prefix(motion.length_m, motion.rate, tolerance, |travelled| {
            self.excess(&motion, travelled, min_clearance, f64::INFINITY)
        });
        // A circle that is free all round is free however often it is driven.
        if prefix == motion.length_m { segment.length_m.abs() } else { prefix }
    }

    /// Returns the metres along a segment at which [`CollisionChecker::motion_is_free`] refuses it; `None` if it does
    /// not.
    ///
    /// That is the first place beyond what is proven to be free; of a motion that comes too near only by less than the
    /// tolerance it is the place that was looked at first.
    pub fn refused_at(&self, start: Pose, segment: Segment, min_clearance: f64) -> Option<f64> {
        self.count_call();
        let motion = SweptMotion::new(start, segment, &self.body);
        let (min_clearance, tolerance) = self.clearance_and_tolerance(min_clearance);
        let mut refused = None;
        let is_free = sweep::holds_everywhere(motion.length_m, motion.rate, tolerance, |travelled, enough| {
            let excess = self.excess(&motion, travelled, min_clearance, enough);
            refused = refused.or(excess.is_none().then_some(travelled));
            excess
        });
        if is_free {
            return None;
        }
        let prefix = self.motion_prefix_free(start, segment, min_clearance);
        Some(if prefix < motion.length_m { prefix } else { refused.unwrap_or(prefix) })
    }

    /// Returns the obstacle nearest to the body; its distance is not positive on contact. Beyond the reach
    /// of exact distances it is the border.
    pub fn nearest_obstacle(&self, pose: Pose) -> NearestObstacle {
        self.count_call();
        let rectangle = self.place(pose);
        let frame = self.field.frame();
        let half_cell = 0.5 * frame.cell_m;
        let near = self.field.bushes_near(rectangle.centre, rectangle.half_box() + DVec2::splat(EXACT_REACH_M));
        let bushes = near.filter_map(|centre| {
            let squared = rectangle.squared_gap_to_square(centre, half_cell, EXACT_REACH_M * EXACT_REACH_M);
            let is_near = squared < EXACT_REACH_M * EXACT_REACH_M;
            let obstacle = Obstacle::Bush(frame.cell_at(centre)?);
            is_near.then_some(NearestObstacle { obstacle, gap_m: squared.sqrt() })
        });
        let bodies = self.obstacles.iter();
        let bodies =
            bodies.map(|(other, _)| NearestObstacle { obstacle: Obstacle::Body, gap_m: rectangle.gap_to(other) });
        let border = NearestObstacle { obstacle: Obstacle::Border, gap_m: rectangle.border_gap(frame) };
        bodies.chain(bushes).fold(border, |nearest, other| if other.gap_m < nearest.gap_m { other } else { nearest })
    }

    fn clearance_and_tolerance(&self, min_clearance: f64) -> (f64, f64) {
        let min_clearance = min_clearance.max(self.min_clearance_m);
        (min_clearance, MOTION_TOLERANCE_M.min(0.5 * min_clearance))
    }

    #[inline]
    fn excess(&self, motion: &SweptMotion, travelled: f64, min_clearance: f64, enough: f64) -> Option<f64> {
        let (centre, axis) = motion.body_at(travelled);
        let clearance = self.clearance_from(&self.rectangle(centre, axis), min_clearance, min_clearance + enough);
        clearance.map(|clearance| clearance - min_clearance)
    }

    fn place(&self, pose: Pose) -> Rectangle {
        let axis = pose.direction();
        self.rectangle(pose.position() + axis * self.body.centre_offset_m(), axis)
    }

    fn rectangle(&self, centre: DVec2, axis: DVec2) -> Rectangle {
        Rectangle { centre, axis, half_length: 0.5 * self.body.length_m, half_width: 0.5 * self.body.width_m }
    }

    /// A lower bound, no less than `min_clearance`, of the body's clearance; `None` if the true clearance is less.
    ///
    /// A lower bound of `enough` is not made better.
    #[inline]
    fn clearance_from(&self, rectangle: &Rectangle, min_clearance: f64, enough: f64) -> Option<f64> {
        let clearance = self.clearance_on_field(rectangle, min_clearance, enough)?;
        let clearance = if self.obstacles.is_empty() { clearance } else { self.obstacle_gap(rectangle, clearance) };
        (clearance >= min_clearance).then_some(clearance)
    }

    /// Does the same as if no other bodies stood on the field.
    #[inline]
    fn clearance_on_field(&self, rectangle: &Rectangle, min_clearance: f64, enough: f64) -> Option<f64> {
        // Each kind of lattice has its own copy: what a coarse one needs besides stays out of the other's way.
        if self.field.is_coarse() {
            self.clearance_by(rectangle, min_clearance, enough, |point| self.field.interpolate(point))
        } else {
            self.clearance_by(rectangle, min_clearance, enough, |point| self.field.read_lattice(point))
        }
    }

    #[inline(always)]
    fn clearance_by(
        &self,
        rectangle: &Rectangle,
        min_clearance: f64,
        enough: f64,
        interpolate: impl Fn(DVec2) -> Interpolated,
    ) -> Option<f64> {
        let border = rectangle.border_gap(self.field.frame());
        // From cheap to costly: the border, discs on the lattice of distances, and bushes one by one.
        if border < min_clearance {
            return None;
        }
        let mut min_squared = f64::INFINITY;
        // Metres from a bush to the body, which holds the inner discs, are at most this much and the lattice's spread.
        let mut max_gap = f64::INFINITY;
        for (number, disc) in self.discs.iter().enumerate() {
            let bound = interpolate(rectangle.centre + rectangle.axis * disc.offset);
            if bound.is_surely_below(disc.inner_radius + min_clearance) {
                return None;
            }
            let squared = bound.min_squared();
            // In the open, what is known about the first is enough for all of the body.
            let open = self.outer_radius + enough + ROUNDING_M;
            if number == 0 && squared >= open * open && border >= enough + ROUNDING_M {
                return Some((squared.sqrt() - self.outer_radius).min(border));
            }
            min_squared = lesser(min_squared, squared);
            max_gap = lesser(max_gap, bound.distance_m() - disc.inner_radius);
        }
        let cover = min_squared.max(0.0).sqrt() - self.cover_radius;
        // Discs cover the body, so they underestimate: enough by them is enough.
        if cover >= min_clearance + AMPLE_M {
            return Some(cover.min(border));
        }
        // The nearest bush is nearer than this, so that a look at those farther away would change nothing.
        let reach = (min_clearance + EXACT_REACH_M).min(max_gap.max(0.0) + self.field.max_spread_m());
        let exact = rectangle.bush_gap(&self.field, reach);
        (exact >= min_clearance).then_some(exact.min(border))
    }

    /// Metres to the field's border and to obstacles besides bushes; negative where a corner is outside.
    fn border_gap(&self, rectangle: &Rectangle) -> f64 {
        let border = rectangle.border_gap(self.field.frame());
        self.obstacles.iter().map(|(other, _)| rectangle.gap_to(other)).fold(border, f64::min)
    }

    /// Metres to the nearest of the obstacles besides bushes, or `limit`, not negative, if that is less.
    fn obstacle_gap(&self, rectangle: &Rectangle, limit: f64) -> f64 {
        let radius = rectangle.radius();
        self.obstacles.iter().fold(limit, |min, (other, other_radius)| {
            // A gap is at least the part `SURE_SHARE` of what lies between the circles about both bodies, so that most
            // bodies of a crowd are left out without a root.
            let far = min.max(0.0) / SURE_SHARE + radius + other_radius;
            if (other.centre - rectangle.centre).length_squared() >= far * far {
                min
            } else {
                min.min(rectangle.gap_to(other))
            }
        })
    }

    fn cover_clearance(&self, rectangle: &Rectangle) -> f64 {
        let squared = self
            .discs
            .iter()
            .map(|disc| self.field.interpolate(rectangle.centre + rectangle.axis * disc.offset).min_squared());
        squared.fold(f64::INFINITY, f64::min).max(0.0).sqrt() - self.cover_radius
    }
}

/// Returns the lesser of two numbers. Where neither is NaN, as here, it takes one instruction.
#[inline]
fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// Discs of one radius whose union holds the body: as many as the length has widths.
fn cover(body: &Dimensions) -> (Vec<Disc>, f64) {
    let half_length = 0.5 * body.length_m;
    let half_width = 0.5 * body.width_m;
    let count = (body.length_m / body.width_m).ceil().clamp(1.0, MAX_DISCS as f64);
    let half_share = half_length / count;
    let disc = |index: usize| {
        let offset = (2 * index + 1) as f64 * half_share - half_length;
        Disc { offset, inner_radius: half_width.min(half_length - offset.abs()) }
    };
    let mut discs: Vec<Disc> = (0..count as usize).map(disc).collect();
    // The inner discs in the middle are the largest, so that what collides is known soonest by them.
    discs.sort_by(|a, b| a.offset.abs().total_cmp(&b.offset.abs()));
    (discs, ops::hypot(half_share, half_width))
}

/// A length, but no more than once round the circle, after which the same poses come again.
fn once_round(length_m: f64, curvature: f64) -> f64 {
    let round = TAU / curvature.abs();
    // An infinite length stays infinite, so that the sweep refuses it.
    if length_m.is_finite() && length_m > round { round } else { length_m }
}

/// A segment as its sweep needs it.
struct SweptMotion {
    start: Pose,
    axis: DVec2,
    curvature: f64,
    length_m: f64,
    /// 1 forward, -1 in reverse.
    sense: f64,
    centre_offset: f64,
    /// Metres that the fastest point of the body moves for a metre of the rear axle.
    rate: f64,
}

impl SweptMotion {
    fn new(start: Pose, segment: Segment, body: &Dimensions) -> Self {
        let Segment { curvature, length_m } = segment;
        Self {
            start,
            axis: start.direction(),
            curvature,
            length_m: once_round(length_m.abs(), curvature),
            sense: 1f64.copysign(length_m),
            centre_offset: body.centre_offset_m(),
            rate: body.farthest_point_rate(curvature),
        }
    }

    /// Centre and direction of the body after `travelled` metres.
    #[inline]
    fn body_at(&self, travelled: f64) -> (DVec2, DVec2) {
        let signed = self.sense * travelled;
        let turn = self.curvature * signed;
        // A straight has no centre to turn about, and the formula below would divide by zero.
        if turn == 0.0 {
            return (self.start.position() + self.axis * (signed + self.centre_offset), self.axis);
        }
        let (sin, cos) = ops::recurring_sin_cos(turn);
        // In the frame of the start: the rear axle is at (sin, 1 - cos) / curvature.
        let axis = self.axis.rotate(DVec2::new(cos, sin));
        let chord = self.axis.rotate(DVec2::new(sin, 1.0 - cos)) / self.curvature;
        (self.start.position() + chord + axis * self.centre_offset, axis)
    }
}

#[cfg(test)]
mod tests {
    use rand::{Rng, RngExt};

    use super::super::brute_force::RandomBushes;
    use super::*;
    use wildfire_base::geometry::FieldFrame;
    use wildfire_base::rng;
    use wildfire_grid::Grid;

    fn random_body(rng: &mut impl Rng) -> Dimensions {
        if rng.random_bool(0.5) {
            return Dimensions::default();
        }
        let length_m = rng.random_range(0.5..12.0);
        Dimensions {
            length_m,
            width_m: rng.random_range(0.3..4.0),
            rear_overhang_m: rng.random_range(0.0..length_m),
            ..Dimensions::default()
        }
    }

    /// A field, its brute force and a checker for a body on it.
    fn checker(rng: &mut impl Rng) -> (RandomBushes, CollisionChecker) {
        let cell_m = [5.0, 5.0, 2.3][rng.random_range(0..3)];
        let mut test = RandomBushes::random(rng, cell_m, 0.05);
        while test.field.frame().width_m().min(test.field.frame().height_m()) < 25.0 {
            test = RandomBushes::random(rng, cell_m, 0.05);
        }
        let RandomBushes { field, bushes } = test;
        let field = Arc::new(field);
        let checker = CollisionChecker::new(field.clone(), random_body(rng));
        let copy = ClearanceField::new(*field.frame(), field.occupied());
        (RandomBushes { field: copy, bushes }, checker)
    }

    #[test]
    fn discs_cover_the_body_and_inner_discs_lie_in_it() {
        let mut rng = rng::stream(1, "collision/checker");
        for _ in 0..200 {
            let body = random_body(&mut rng);
            let (discs, radius) = cover(&body);
            let half_length = 0.5 * body.length_m;
            let half_width = 0.5 * body.width_m;
            for disc in &discs {
                assert!(disc.inner_radius <= half_width + 1e-12);
                assert!(disc.offset.abs() + disc.inner_radius <= half_length + 1e-12);
            }
            for _ in 0..100 {
                let x = rng.random_range(-half_length..half_length);
                let y = rng.random_range(-half_width..half_width);
                assert!(discs.iter().any(|disc| ops::hypot(x - disc.offset, y) <= radius + 1e-12));
            }
        }
    }

    #[test]
    fn the_unimog_has_the_discs_that_its_size_asks_for() {
        let (discs, radius) = cover(&Dimensions::default());
        assert_eq!(discs.len(), 3);
        assert!((radius - 1.370).abs() < 1e-3);
        assert!(discs[0].inner_radius == 1.1 && (discs[1].inner_radius - 0.817).abs() < 1e-3);
    }

    #[test]
    fn knowing_no_more_than_is_needed_decides_as_knowing_all() {
        let mut rng = rng::stream(8, "collision/checker");
        let (mut free, mut refused) = (0, 0);
        for _ in 0..40 {
            let (test, checker) = checker(&mut rng);
            for _ in 0..200 {
                let start = test.random_pose(&mut rng);
                let curvature = f64::from(rng.random_range(-1..=1)) * checker.body().max_curvature();
                let segment = Segment { curvature, length_m: rng.random_range(-12.0..12.0) };
                let clearance_m = rng.random_range(0.0..1.0);
                let (min, tolerance) = checker.clearance_and_tolerance(clearance_m);
                let motion = SweptMotion::new(start, segment, checker.body());
                let by_all = sweep::holds_everywhere(motion.length_m, motion.rate, tolerance, |travelled, _| {
                    checker.excess(&motion, travelled, min, f64::INFINITY)
                });
                assert_eq!(checker.motion_is_free(start, segment, clearance_m), by_all, "{start:?} {segment:?}");
                if by_all { free += 1 } else { refused += 1 }
            }
        }
        assert!(free > 300 && refused > 300, "{free} free, {refused} refused");
    }

    #[test]
    fn in_a_crowd_a_pose_is_free_if_it_is_so_on_the_field_and_beside_everybody() {
        let mut rng = rng::stream(7, "collision/checker");
        let (mut free, mut crowded_out) = (0, 0);
        for _ in 0..40 {
            let (test, alone) = checker(&mut rng);
            let others: Vec<OrientedRect> =
                (0..12).map(|_| random_body(&mut rng).footprint(test.random_pose(&mut rng))).collect();
            let crowd = alone.with_obstacles(others.iter().copied());
            for _ in 0..200 {
                let pose = test.random_pose(&mut rng);
                let min_clearance: f64 = rng.random_range(0.05..3.0);
                let outline = Rectangle::from(alone.body().footprint(pose));
                let is_apart = others.iter().all(|&other| outline.gap_to(&other.into()) >= min_clearance);
                let is_free = alone.pose_is_free(pose, min_clearance);
                assert_eq!(crowd.pose_is_free(pose, min_clearance), is_free && is_apart, "{pose:?} {min_clearance}");
                if is_free && is_apart { free += 1 } else { crowded_out += u32::from(is_free) }
            }
        }
        assert!(free > 300 && crowded_out > 100, "{free} free, {crowded_out} crowded out");
    }

    #[test]
    fn clearance_is_a_lower_bound_and_exact_below_a_metre() {
        let mut rng = rng::stream(2, "collision/checker");
        for _ in 0..40 {
            let (test, checker) = checker(&mut rng);
            for _ in 0..300 {
                let pose = test.random_pose(&mut rng);
                let clearance = checker.clearance(pose);
                let exact = test.rectangle_distance(&checker.body().footprint(pose));
                assert!(clearance <= exact + 1e-9, "{pose:?}: {clearance}, truly {exact}");
                assert!(exact >= 1.0 || (clearance - exact).abs() < 1e-9, "{pose:?}: {clearance}, truly {exact}");
                let floor: f64 = rng.random_range(-0.5..1.5);
                let wanted = exact >= floor.max(MIN_CLEARANCE_M);
                assert_eq!(checker.pose_is_free(pose, floor), wanted, "{pose:?}: {exact}, floor {floor}");
            }
        }
    }

    #[test]
    fn motions_are_free_as_dense_samples_say_up_to_the_tolerance() {
        let mut rng = rng::stream(3, "collision/checker");
        let (mut free, mut refused) = (0, 0);
        for _ in 0..30 {
            let (test, checker) = checker(&mut rng);
            for _ in 0..60 {
                let start = test.random_pose(&mut rng);
                if !checker.pose_is_free(start, 0.0) {
                    continue;
                }
                let curvature = [0.0, 1.0, -1.0][rng.random_range(0..3)] * rng.random_range(0.02..0.2);
                let segment = Segment { curvature, length_m: rng.random_range(-15.0..15.0) };
                let floor = [0.0, 0.03, 0.25, 0.75][rng.random_range(0..4)];
                let (floor, tolerance) = checker.clearance_and_tolerance(floor);
                let steps = (segment.length_m.abs() / 0.02).ceil().max(1.0);
                let places = (0..=steps as u32).map(|k| segment.length_m * f64::from(k) / steps);
                let min = places
                    .map(|place| test.rectangle_distance(&checker.body().footprint(segment.pose_at(start, place))));
                let min = min.fold(f64::INFINITY, f64::min);
                let answer = checker.motion_is_free(start, segment, floor);
                if answer {
                    free += 1;
                    assert!(min > 0.0 && min >= floor - tolerance - 1e-9, "{start:?} {segment:?}: {min}");
                } else {
                    refused += 1;
                    // Between two samples, the clearance can be less by half their distance, times the rate.
                    assert!(min < floor + 0.03, "{start:?} {segment:?}: {min}");
                }
                let prefix = checker.motion_prefix_free(start, segment, floor);
                assert!((0.0..=segment.length_m.abs()).contains(&prefix));
                assert!(!checker.pose_is_free(start, floor) || min < floor + 0.03 || prefix == segment.length_m.abs());
                let cut = Segment { length_m: prefix.copysign(segment.length_m), ..segment };
                let within = (0..=20).map(|k| cut.pose_at(start, cut.length_m * f64::from(k) / 20.0));
                for pose in within.filter(|_| prefix > 0.0) {
                    let exact = test.rectangle_distance(&checker.body().footprint(pose));
                    assert!(exact >= floor - tolerance - 1e-9, "{start:?} {cut:?}: {exact}");
                }
            }
        }
        assert!(free > 100 && refused > 100, "{free} free, {refused} refused");
    }

    /// Clearance changes by less than 3 cm over 2 cm of way, so millimetres matter only where little is left.
    #[test]
    fn accepted_motions_touch_nothing_at_any_millimetre() {
        let mut rng = rng::stream(4, "collision/checker");
        let (mut free, mut close) = (0, 0);
        for _ in 0..40 {
            let (test, checker) = checker(&mut rng);
            for _ in 0..60 {
                let curvature = f64::from(rng.random_range(-1..=1)) * checker.body().max_curvature();
                let segment = Segment { curvature, length_m: rng.random_range(-15.0..15.0) };
                let start = test.random_pose(&mut rng);
                if !checker.motion_is_free(start, segment, 0.0) {
                    continue;
                }
                free += 1;
                let gap = |metres: f64| {
                    let pose = segment.pose_at(start, metres.min(segment.length_m.abs()).copysign(segment.length_m));
                    test.rectangle_distance(&checker.body().footprint(pose))
                };
                for step in 0..=(segment.length_m.abs() / 0.02).ceil() as u32 {
                    let metres = 0.02 * f64::from(step);
                    if gap(metres) < 0.05 {
                        close += 1;
                        assert!((0..20).all(|mm| gap(metres + 1e-3 * f64::from(mm)) > 0.0), "{start:?} {segment:?}");
                    }
                }
            }
        }
        assert!(free > 300 && close > 100, "{free} free, {close} places close to something");
    }

    /// The Unimog on a field of 50 m without bushes.
    fn bare_ground() -> CollisionChecker {
        let frame = FieldFrame { cols: 10, rows: 10, cell_m: 5.0 };
        let field = ClearanceField::new(frame, &Grid::filled(10, 10, false));
        CollisionChecker::new(Arc::new(field), Dimensions::default())
    }

    #[test]
    fn nonsense_motions_are_not_free() {
        let checker = bare_ground();
        let start = Pose::new(25.0, 25.0, 0.0);
        for length_m in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            assert!(!checker.motion_is_free(start, Segment { curvature: 0.0, length_m }, 0.1));
        }
        assert!(!checker.motion_is_free(start, Segment { curvature: f64::NAN, length_m: 1.0 }, 0.1));
        assert!(!checker.pose_is_free(Pose { x: f64::NAN, ..start }, 0.1));
        assert!(!checker.motion_is_free(start, Segment { curvature: 0.1, length_m: f64::NAN }, 0.1));
        assert_eq!(checker.motion_prefix_free(start, Segment { curvature: 0.1, length_m: f64::NAN }, 0.1), 0.0);
        assert!(checker.motion_is_free(start, Segment { curvature: 0.0, length_m: 0.0 }, 0.1));
    }

    #[test]
    fn going_round_forever_is_as_free_as_going_round_once() {
        let checker = bare_ground();
        let round = Segment { curvature: 1.0 / 13.0, length_m: 1e15 };
        let start = Pose::new(25.0, 10.0, 0.0);
        assert!(checker.motion_is_free(start, round, 0.5));
        assert_eq!(checker.motion_prefix_free(start, round, 0.5), 1e15);
    }
}
