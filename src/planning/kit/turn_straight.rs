use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::geometry::{Pose, ops};
use crate::planning::GoalDisc;
use crate::vehicle::{Dimensions, Segment};

use super::motion_price::Price;

/// Shorter pieces are left out.
const SHORTEST_M: f64 = 1e-6;
/// How far towards the disc's edge a straight after a change of direction is aimed.
const EDGE_SHARE: f64 = 0.8;

const NOTHING: Segment = Segment { curvature: 0.0, length_m: 0.0 };

/// A turn at the smallest radius, then a straight; either may be absent (of length 0), not both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    pub turn: Segment,
    pub straight: Segment,
    pub cost: f64,
}

impl Aim {
    /// The pieces that are there.
    pub fn pieces(&self) -> impl Iterator<Item = Segment> + use<> {
        [self.turn, self.straight].into_iter().filter(|piece| piece.length_m != 0.0)
    }
}

/// Finds turn-then-straight motions that bring the centre of one body to a place or into a disc, at one price list,
/// without what places cost.
///
/// With T the target seen from the turning circle's centre, R the radius, u the heading after the turn and n the unit
/// vector from that centre to the axle, T = (R - o) n + t u, where t is how far ahead the target is then and o how far
/// to the left of the body's axis (mirrored for right turns). This gives u in closed form. The straight is cut where
/// the body's centre enters the disc. If it enters on the turning circle already, the turn is cut there, by the law of
/// cosines.
///
/// Where turn and straight go the same way, o = 0 makes the motion shortest (if t exceeds the disc's radius): the
/// derivative of its length by the turning angle is o (1 - t / s) with s the half chord. Where the direction changes in
/// between, the derivative 2 R + o (t / s - 1) vanishes on the disc's near side only; o is set to a share of the radius
/// there.
#[derive(Clone, Debug)]
pub struct Aiming {
    radius: f64,
    /// From the axle to the body's centre.
    ahead: f64,
    /// From the turning centre to the body's centre, and the angle between that line and the axle's.
    centre_radius: f64,
    centre_angle: f64,
    pub price: Price,
}

impl Aiming {
    pub fn new(body: &Dimensions, price: Price) -> Self {
        let (radius, ahead) = (body.turning_radius_m, body.centre_offset_m());
        Self { radius, ahead, centre_radius: ops::hypot(radius, ahead), centre_angle: ops::atan2(radius, ahead), price }
    }

    /// The cheapest aim from a pose whose body centre is outside the disc; a disc of radius 0 is a place.
    ///
    /// `after_reverse` says which way the truck came, for the price of a change of direction. Of equals, the first
    /// found: the nearer side, then turns alone, then forward before reverse.
    pub fn best_into(&self, pose: Pose, disc: GoalDisc, after_reverse: Option<bool>) -> Option<Aim> {
        let mut best: Option<Aim> = None;
        self.collect(pose, disc, after_reverse, &mut |aim| {
            if best.is_none_or(|best| aim.cost < best.cost) {
                best = Some(aim);
            }
            best.map_or(f64::INFINITY, |best| best.cost)
        });
        best
    }

    /// Hands all aims to `take`, which answers with the cost from which on aims need not be worked out any more.
    fn collect(&self, pose: Pose, disc: GoalDisc, after_reverse: Option<bool>, take: &mut impl FnMut(Aim) -> f64) {
        let direction = pose.direction();
        let offset = disc.centre - pose.position();
        let (x, y) = (offset.dot(direction), direction.perp_dot(offset));
        let near_side = 1f64.copysign(y);
        let mut limit = f64::INFINITY;
        for side in [near_side, -near_side] {
            let target = DVec2::new(x, side * y - self.radius);
            self.on_side(side, target, disc.radius_m, after_reverse, &mut limit, take);
        }
    }

    /// Aims that turn to one side; `target` is seen from the turning centre, y mirrored for the right.
    fn on_side(
        &self,
        side: f64,
        target: DVec2,
        disc_radius: f64,
        after_reverse: Option<bool>,
        limit: &mut f64,
        take: &mut impl FnMut(Aim) -> f64,
    ) {
        let turn = |angle: f64| Segment { curvature: side / self.radius, length_m: angle * self.radius };
        let (enters_forward, enters_reverse) = self.entries(target, disc_radius);
        for angle in [enters_forward, -enters_reverse] {
            if angle.is_finite() {
                *limit = take(self.priced(turn(angle), NOTHING, after_reverse));
            }
        }
        for sign in [1.0, -1.0] {
            for (offset, forward) in [(0.0, sign > 0.0), (-EDGE_SHARE * disc_radius, sign < 0.0)] {
                if let Some((angle, straight)) = self.tangent(target, sign, offset, disc_radius, *limit) {
                    let (angle, entry) = if forward { (angle, enters_forward) } else { (angle - TAU, enters_reverse) };
                    if angle.abs() < entry {
                        *limit = take(self.priced(turn(angle), straight, after_reverse));
                    }
                }
            }
        }
    }

    /// The turning angles, forward and reverse, at which the body's centre enters the disc; infinite if never.
    fn entries(&self, target: DVec2, disc_radius: f64) -> (f64, f64) {
        let distance_squared = target.length_squared();
        let between = (self.centre_radius * self.centre_radius + distance_squared - disc_radius * disc_radius)
            / (2.0 * self.centre_radius * distance_squared.sqrt());
        if disc_radius <= 0.0 || between >= 1.0 {
            return (f64::INFINITY, f64::INFINITY);
        }
        let (half, middle) = (ops::acos(between), ops::atan2(target.y, target.x) + self.centre_angle);
        (full_turn(middle - half), TAU - full_turn(middle + half))
    }

    /// The forward turning angle, in [0, 2 pi), after which a straight (forward for `sign` 1, reverse for -1) leads
    /// into the disc, and that straight; the disc's centre then lies `offset` to the left of the axis.
    ///
    /// `None` where there is none, or its straight alone costs the limit.
    fn tangent(&self, target: DVec2, sign: f64, offset: f64, disc_radius: f64, limit: f64) -> Option<(f64, Segment)> {
        let lever = self.radius - offset;
        let along_squared = target.length_squared() - lever * lever;
        if along_squared < 0.0 {
            return None;
        }
        let along = sign * along_squared.sqrt();
        let length_m = along.abs() - sign * self.ahead - (disc_radius * disc_radius - offset * offset).sqrt();
        let straight = Segment { curvature: 0.0, length_m: sign * length_m };
        let (sin, cos) = (lever * target.x + along * target.y, along * target.x - lever * target.y);
        let wanted = length_m >= 0.0 && self.price.of(straight, None) < limit;
        wanted.then(|| (full_turn(ops::atan2(sin, cos)), straight))
    }

    fn priced(&self, turn: Segment, straight: Segment, after_reverse: Option<bool>) -> Aim {
        let keep = |piece: Segment| if piece.length_m.abs() < SHORTEST_M { NOTHING } else { piece };
        let mut aim = Aim { turn: keep(turn), straight: keep(straight), cost: 0.0 };
        let mut before = after_reverse;
        for piece in aim.pieces() {
            aim.cost += self.price.of(piece, before);
            before = Some(piece.is_reverse());
        }
        aim
    }
}

/// The same angle in [0, 2 pi).
fn full_turn(angle: f64) -> f64 {
    let wrapped = ops::wrap_angle(angle);
    // Rounding must not turn a straight approach into a full circle.
    if wrapped > -1e-9 && wrapped < 0.0 {
        0.0
    } else if wrapped < 0.0 {
        (wrapped + PI) + PI
    } else {
        wrapped
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::planning::kit::local_search::PrimitiveSettings;
    use crate::planning::test_fields::random_pose;
    use crate::rng;
    use crate::vehicle::Path;

    fn aiming() -> (Dimensions, Aiming) {
        let body = Dimensions::default();
        (body, Aiming::new(&body, Price::new(&PrimitiveSettings::default(), &body, None)))
    }

    fn all(aiming: &Aiming, pose: Pose, disc: GoalDisc, after_reverse: Option<bool>) -> Vec<Aim> {
        let mut aims = Vec::new();
        aiming.collect(pose, disc, after_reverse, &mut |aim| {
            aims.push(aim);
            f64::INFINITY
        });
        aims
    }

    #[test]
    fn aims_end_on_the_rim_and_enter_the_disc_nowhere_before() {
        let (body, aiming) = aiming();
        let mut rng = rng::stream(1, "aim");
        let mut seen = 0;
        for _ in 0..2_000 {
            let pose = random_pose(&mut rng, 60.0);
            let centre = random_pose(&mut rng, 60.0).position();
            let disc = GoalDisc { centre, radius_m: rng.random_range(0.5..15.0) };
            if body.body_centre(pose).distance(centre) <= disc.radius_m {
                continue;
            }
            let aims = all(&aiming, pose, disc, None);
            let least = aims.iter().map(|aim| aim.cost).fold(f64::INFINITY, f64::min);
            assert_eq!(aiming.best_into(pose, disc, None).map_or(f64::INFINITY, |best| best.cost), least);
            for aim in &aims {
                let path = Path { start: pose, segments: aim.pieces().collect() };
                let end = body.body_centre(path.end()).distance(centre);
                assert!((end - disc.radius_m).abs() < 1e-9, "ends at {end} of {}", disc.radius_m);
                assert!((aim.cost - aiming.price.of_all(path.start, &path.segments)).abs() < 1e-9);
                for (from, segment) in path.legs() {
                    for k in 0..50 {
                        let on_way = segment.pose_at(from, segment.length_m * f64::from(k) / 50.0);
                        assert!(body.body_centre(on_way).distance(centre) >= disc.radius_m - 1e-9);
                    }
                }
                seen += 1;
            }
        }
        assert!(seen > 8_000);
    }

    #[test]
    fn aims_at_a_place_bring_the_body_centre_there() {
        let (body, aiming) = aiming();
        let mut rng = rng::stream(2, "aim");
        for _ in 0..500 {
            let (pose, place) = (random_pose(&mut rng, 60.0), random_pose(&mut rng, 60.0).position());
            for aim in all(&aiming, pose, GoalDisc { centre: place, radius_m: 0.0 }, Some(true)) {
                let path = Path { start: pose, segments: aim.pieces().collect() };
                assert!(body.body_centre(path.end()).distance(place) < 1e-9);
            }
        }
    }

    #[test]
    fn no_turn_then_straight_of_a_fine_grid_is_shorter_than_the_best_aim() {
        let (body, aiming) = aiming();
        let mut rng = rng::stream(3, "aim");
        for _ in 0..60 {
            let pose = random_pose(&mut rng, 50.0);
            let disc = GoalDisc { centre: random_pose(&mut rng, 50.0).position(), radius_m: 8.0 };
            if body.body_centre(pose).distance(disc.centre) <= disc.radius_m {
                continue;
            }
            let best = aiming.best_into(pose, disc, None).map_or(f64::INFINITY, |aim| aim.cost);
            for side in [-1.0, 1.0] {
                for turn in -80..=80 {
                    let turn = Segment { curvature: side / 13.0, length_m: f64::from(turn) * 0.5 };
                    for straight in -60..=60 {
                        let straight = Segment { curvature: 0.0, length_m: f64::from(straight) };
                        let end = straight.end(turn.end(pose));
                        if body.body_centre(end).distance(disc.centre) <= disc.radius_m {
                            // A straight that misses the centre may be cheaper than one aimed at it, but not by much.
                            let cost = aiming.price.of_all(pose, &[turn, straight]);
                            assert!(cost > best - 2.5, "grid {cost}, aim {best}");
                        }
                    }
                }
            }
        }
    }
}
