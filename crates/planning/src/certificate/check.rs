//! The check of a certificate, by code of its own: it shares nothing with the maker but the length of Reeds-Shepp curves.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;
use thiserror::Error;

use super::Certificate;
use crate::collision::CollisionChecker;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::ReedsShepp;

/// The most corners that a certificate may have, and the most positions within its bound: they limit the time of a check.
pub(super) const MAX_CORNERS: usize = 2_000;
pub(super) const MAX_POSITIONS: f64 = 20_000.0;

/// Two potentials may differ by this much more than the distance, in metres; all of them together by less than
/// [`SURE_M`].
const ROUNDING_M: f64 = 1e-8;

/// The length in metres by which the computed bound must exceed the claimed one.
const SURE_M: f64 = 1e-4;

/// Corners match if they are closer than this, in metres; a shape that blocks is smaller than the bush by as much.
const SAME_M: f64 = 1e-6;

/// The narrowest interval of headings, as half its width in radians.
const NARROWEST: f64 = 0.0019;

/// The reason why a certificate proves nothing.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BadCertificate {
    #[error("`{0}` is out of range: expected {1}")]
    OutOfRange(&'static str, &'static str),
    #[error("the corner at ({:.3}, {:.3}) is missing", .0.x, .0.y)]
    MissingCorner(DVec2),
    #[error(
        "({:.3}, {:.3}) and ({:.3}, {:.3}) see each other {distance_m:.3} m apart, but their distances from the {end} \
         differ by {found_m:.3} m", .places[0].x, .places[0].y, .places[1].x, .places[1].y
    )]
    TooSteep { end: &'static str, places: [DVec2; 2], distance_m: f64, found_m: f64 },
    #[error("a path across ({:.3}, {:.3}) may be as short as {found_m:.3} m; the certificate says {claimed_m:.3} m",
        .at.x, .at.y)]
    TooLong { at: DVec2, found_m: f64, claimed_m: f64 },
}

impl Certificate {
    /// Checks that every path of the checker's body between the two poses that keeps the clearance is at least as long as
    /// the certificate says. Other bodies on the field do not count.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn check(&self, checker: &CollisionChecker) -> Result<(), BadCertificate> {
        self.check_numbers()?;
        let [start, goal] = [self.start, self.goal].map(|[x, y, heading]| Pose::new(x, y, heading));
        let curves = ReedsShepp { radius_m: checker.body().turning_radius_m };
        // The curve alone proves the bound: no cut is needed.
        if curves.length_m(start, goal) >= self.bound_m + SURE_M {
            return Ok(());
        }
        let bushes = GrownBushes::new(checker, self.clearance_m);
        // A shape on the cut is smaller by 0.65 steps, and `part` takes off `SAME_M` more: some of the radius must be left.
        if bushes.radius_m - self.step_m < SAME_M {
            return Err(BadCertificate::OutOfRange("step_m", "less than the body's inner radius and the clearance"));
        }
        let places = [self.start, self.goal].map(|[x, y, _]| DVec2::new(x, y));
        let mut corners: Vec<(DVec2, [f64; 2])> =
            self.corners.iter().map(|&[x, y, near, far]| (DVec2::new(x, y), [near, far])).collect();
        // A string bends at corners only, so a list that lacks one proves nothing.
        for centre in &bushes.centres {
            for corner in bushes.outline(*centre, bushes.radius_m) {
                let straight_m = corner.distance(places[0]) + corner.distance(places[1]);
                if straight_m < self.bound_m
                    && !bushes.shuts_out(corner, bushes.radius_m)
                    && !corners.iter().any(|(listed, _)| listed.distance_squared(corner) < SAME_M * SAME_M)
                {
                    return Err(BadCertificate::MissingCorner(corner));
                }
            }
        }
        for (end, name) in ["start", "goal"].into_iter().enumerate() {
            // Only this end has a length from itself.
            let mut lengths: Vec<(DVec2, f64)> = corners.iter().map(|(at, lengths)| (*at, lengths[end])).collect();
            lengths.push((places[end], 0.0));
            // Lengths need not be exact: if none rises faster than the distance between two, they are bounds.
            for (index, &(one, one_m)) in lengths.iter().enumerate() {
                for &(other, other_m) in &lengths[..index] {
                    let distance_m = one.distance(other);
                    let found_m = (one_m - other_m).abs();
                    // `part` looks at every bush, so it is asked only where the lengths rise too fast.
                    if found_m > distance_m + ROUNDING_M && !bushes.part(one, other, bushes.radius_m) {
                        let places = [one, other];
                        return Err(BadCertificate::TooSteep { end: name, places, distance_m, found_m });
                    }
                }
            }
        }
        // An end is the last corner of its own strings only; infinity keeps it out of the other end's.
        corners.extend([(places[0], [0.0, f64::INFINITY]), (places[1], [f64::INFINITY, 0.0])]);
        self.check_cut(&bushes, &corners, checker.body().turning_radius_m)
    }

    fn check_numbers(&self) -> Result<(), BadCertificate> {
        range(is_finite(&self.start), "start", "numbers below a million")?;
        range(is_finite(&self.goal), "goal", "numbers below a million")?;
        range(self.corners.len() <= MAX_CORNERS, "corners", "at most 2000")?;
        range(self.corners.iter().all(|corner| is_finite(corner)), "corners", "numbers below a million")?;
        range(self.clearance_m >= 0.0 && self.clearance_m < 1e3, "clearance_m", "0 to 1000")?;
        range(self.bound_m > 0.0 && self.bound_m < 1e6, "bound_m", "more than 0, below a million")?;
        range(self.step_m >= 1e-4 && self.step_m <= 0.5, "step_m", "0.0001 to 0.5")?;
        range(self.bound_m / self.step_m <= MAX_POSITIONS, "step_m", "at most 20000 positions within the bound")?;
        range(self.cut > 0.0 && self.cut < 1.0, "cut", "more than 0, less than 1")
    }

    fn check_cut(
        &self,
        bushes: &GrownBushes,
        corners: &[(DVec2, [f64; 2])],
        turning_radius_m: f64,
    ) -> Result<(), BadCertificate> {
        let [start, goal] = [self.start, self.goal].map(|[x, y, heading]| Pose::new(x, y, heading));
        let line = goal.position() - start.position();
        // The skew in `bound_in` divides by the distance to an end, so it is small only some steps away from both.
        let nearest_m = self.cut.min(1.0 - self.cut) * line.length();
        if nearest_m < 12.0 * 0.5 * self.step_m {
            return Err(BadCertificate::OutOfRange("cut", "six steps or more from both ends"));
        }
        let half_m = 0.5 * self.step_m;
        // Positions farther out are farther than the bound from both ends together.
        let outermost = (0.5 * self.bound_m / self.step_m).ceil() as i64 + 1;
        // What a pose anywhere in the box may be off its middle: see the head of the module above.
        let shrunk_m = bushes.radius_m - 1.3 * half_m;
        // Every path crosses the cut somewhere, so every position on it must be too far.
        for number in -outermost..=outermost {
            let at = start.position() + line * self.cut + line.perp().normalize() * (number as f64 * self.step_m);
            if bushes.shuts_out(at, shrunk_m) {
                continue;
            }
            let taut_m = [0, 1].map(|end| {
                let ways = corners.iter().map(|(corner, lengths)| (lengths[end] + corner.distance(at), *corner));
                // Ways as long as all that is claimed need no look.
                let ways = ways.filter(|way| way.0 < self.bound_m + self.step_m);
                let open = ways.filter(|&(_, corner)| !bushes.part(corner, at, shrunk_m));
                // All headings at once, since most positions are proven without halving them.
                open.fold(self.bound_m + self.step_m, |min_m, way| way.0.min(min_m)) - half_m
            });
            let parts = [(start, taut_m[0]), (goal, taut_m[1])];
            let needed_m = self.bound_m + SURE_M;
            let found_m = bound_in(parts, (at, 0.0, PI), (turning_radius_m, half_m), needed_m);
            if found_m < needed_m {
                return Err(BadCertificate::TooLong { at, found_m, claimed_m: self.bound_m });
            }
        }
        Ok(())
    }
}

fn is_finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.is_finite() && number.abs() < 1e6)
}

/// Refuses a number by its name unless it is in its range.
fn range(holds: bool, name: &'static str, expected: &'static str) -> Result<(), BadCertificate> {
    holds.then_some(()).ok_or(BadCertificate::OutOfRange(name, expected))
}

/// Returns `needed_m`, or less where a path across a box of poses may be shorter: a box is halved until it is proven or
/// too narrow.
fn bound_in(
    parts: [(Pose, f64); 2],
    (at, heading, half): (DVec2, f64, f64),
    (turning_radius_m, half_m): (f64, f64),
    needed_m: f64,
) -> f64 {
    // The strings alone are quick, and most positions are far enough by them.
    let taut_m = parts[0].1 + parts[1].1;
    if taut_m >= needed_m {
        return needed_m;
    }
    let bound_m: f64 = parts
        .iter()
        .map(|&(end, taut_m)| {
            // What the heading may differ for a pose elsewhere in the box.
            let skew = half_m / (end.position().distance(at) - half_m);
            // A path that is scaled has turns that are scaled too, so the curve may turn that much more sharply.
            let radius_m = turning_radius_m - turning_radius_m * skew;
            let curve_m = ReedsShepp { radius_m }.length_m(end, Pose::new(at.x, at.y, heading));
            taut_m.max((curve_m - radius_m * half - 2.02 * radius_m * skew) / (1.0 + skew))
        })
        .sum();
    if bound_m >= needed_m {
        return needed_m;
    }
    // Halving headings must end, also where the claim is false.
    if half < NARROWEST {
        return bound_m;
    }
    let halves = [heading - 0.5 * half, heading + 0.5 * half];
    halves.into_iter().fold(needed_m, |found_m, heading| {
        // One half that fails settles it: the other half cannot prove the whole.
        if found_m < needed_m {
            return found_m;
        }
        bound_in(parts, (at, heading, 0.5 * half), (turning_radius_m, half_m), needed_m)
    })
}

/// Bushes as the middle of the rear axle meets them.
struct GrownBushes {
    centres: Vec<DVec2>,
    half_cell_m: f64,
    radius_m: f64,
    size: DVec2,
}

impl GrownBushes {
    fn new(checker: &CollisionChecker, clearance_m: f64) -> Self {
        let frame = checker.field().frame();
        let body = checker.body();
        let ground = checker.field().occupied();
        let cells =
            (0..usize::from(frame.rows)).flat_map(|row| (0..usize::from(frame.cols)).map(move |col| (row, col)));
        let bushes = cells.filter(|&cell| ground[cell]);
        // Behind and ahead the body may end nearer than at its sides, and the disc with it.
        let ends_m = body.rear_overhang_m.min(body.length_m - body.rear_overhang_m).max(0.0);
        Self {
            centres: bushes.map(|(row, col)| (DVec2::new(col as f64, row as f64) + 0.5) * frame.cell_m).collect(),
            half_cell_m: 0.5 * frame.cell_m,
            radius_m: ends_m.min(0.5 * body.width_m) + clearance_m,
            size: DVec2::new(frame.width_m(), frame.height_m()),
        }
    }

    /// The corners of the shape that stands for a bush grown by a radius: 16, on the circles about the bush's corners.
    fn outline(&self, centre: DVec2, radius_m: f64) -> [DVec2; 16] {
        std::array::from_fn(|index| {
            let (quarter, third) = (index / 4, index % 4);
            let (sin, cos) = ops::sin_cos((quarter as f64 + third as f64 / 3.0) * FRAC_PI_2);
            let bush = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][quarter];
            centre + DVec2::from(bush) * self.half_cell_m + DVec2::new(cos, sin) * radius_m
        })
    }

    /// Returns whether the middle of the rear axle cannot be at a place: in a bush grown by a radius, or as near to the
    /// border.
    fn shuts_out(&self, at: DVec2, radius_m: f64) -> bool {
        let room_m = at.min_element().min((self.size - at).min_element());
        room_m < radius_m - SAME_M || self.part(at, at, radius_m)
    }

    /// Returns whether a line between two places passes through the inside of a bush grown by a radius: no side of the
    /// shape, nor the line itself, separates them (the separating axes of two convex shapes).
    fn part(&self, one: DVec2, other: DVec2, radius_m: f64) -> bool {
        let reach = DVec2::splat(self.half_cell_m + radius_m);
        let low = one.min(other) - reach;
        let high = one.max(other) + reach;
        let line = other - one;
        self.centres.iter().any(|&centre| {
            // Two cheap tests come before the outline of sixteen corners.
            if centre.x < low.x || centre.y < low.y || centre.x > high.x || centre.y > high.y {
                return false;
            }
            // The shape lies in a square of half side `reach`, whose corners are 1.42 times as far from its centre.
            let far = (centre - one).perp_dot(line).abs();
            if far > 1.5 * reach.x * line.length() && line != DVec2::ZERO {
                return false;
            }
            // Taut strings lie along the sides of the full shape, and rounding must not let it block them.
            let shape = self.outline(centre, radius_m - SAME_M);
            let turned = (0..16).any(|index| {
                let corner = shape[index];
                let side = shape[(index + 1) % 16] - shape[index];
                side.perp_dot(one - corner) <= 0.0 && side.perp_dot(other - corner) <= 0.0
            });
            let sides = shape.map(|corner| line.perp_dot(corner - one));
            let beside = sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0);
            !turned && (line == DVec2::ZERO || !beside)
        })
    }
}
