//! Turns followed by straights, to a position or into a disc, at any final heading.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use crate::GoalDisc;
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::vehicle::{Dimensions, Path, Segment};

use super::motion_price::MotionPrice;

/// Shorter pieces are left out.
const SHORTEST_M: f64 = 1e-6;
/// A straight after a change of direction is aimed this far towards the disc's edge.
const EDGE_SHARE: f64 = 0.8;

/// Positions on a path from which the goal is steered into lie this far apart.
const KNOT_M: f64 = 4.0;
/// A new end must be better by this.
const WORTH_M: f64 = 0.05;
/// Exits that are swept before the path is left as it is.
const MAX_TRIES: usize = 6;

/// A turn whose straight alone costs nearly as much as the limit is worked out, so that rounding decides nothing.
const LIMIT_SLACK_M: f64 = 1e-3;
/// What points as little as this, in radians, to the right of an axis may count as ahead by rounding.
const AHEAD_RAD: f64 = 1e-6;

const NOTHING: Segment = Segment { curvature: 0.0, length_m: 0.0 };

/// A turn at the smallest radius, then a straight; either may be absent (of length 0), not both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnStraight {
    pub turn: Segment,
    pub straight: Segment,
    pub cost: f64,
}

impl TurnStraight {
    /// Returns the pieces that are present.
    pub fn pieces(&self) -> impl Iterator<Item = Segment> + use<> {
        [self.turn, self.straight].into_iter().filter(|piece| piece.length_m != 0.0)
    }
}

/// A position on a path from which the goal can be steered into.
#[derive(Clone, Copy, Debug)]
struct Exit {
    /// Cost of the whole path when it leaves here.
    cost: f64,
    pose: Pose,
    /// The segment left, and the part of it driven before.
    index: usize,
    travelled_m: f64,
    way: TurnStraight,
}

/// A pose from which a disc is to be steered into.
#[derive(Clone, Copy, Debug)]
struct Approach {
    pose: Pose,
    disc: GoalDisc,
    /// The direction in which the truck came.
    after_reverse: Option<bool>,
    /// What costs as much as this need not be worked out.
    limit: f64,
}

/// A straight to be found, with the turn before it.
#[derive(Clone, Copy, Debug)]
struct StraightAim {
    /// 1 if the straight is driven forward, -1 in reverse.
    sign: f64,
    /// Metres from the body's axis to the left, where the disc's centre is to lie.
    offset: f64,
    turns_forward: bool,
}

/// Turn-straight steering (CS): finds motions that bring the centre of one body to a position or into a disc, at one
/// price list, without the surcharge of places.
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
pub struct TurnStraightSteering {
    radius: f64,
    /// From the axle to the body's centre.
    centre_offset: f64,
    /// From the turning centre to the body's centre, and the angle between that line and the axle's.
    centre_radius: f64,
    centre_angle: f64,
    pub price: MotionPrice,
}

impl TurnStraightSteering {
    pub fn new(body: &Dimensions, price: MotionPrice) -> Self {
        let radius = body.turning_radius_m;
        let centre_offset = body.centre_offset_m();
        Self {
            radius,
            centre_offset,
            centre_radius: ops::hypot(radius, centre_offset),
            centre_angle: ops::atan2(radius, centre_offset),
            price,
        }
    }

    /// Returns the cheapest from a pose whose body centre is outside the disc; a disc of radius 0 is a position.
    ///
    /// `after_reverse` says which way the truck came, for the price of a change of direction. Of equals, the first
    /// found: the nearer side, then turns alone, then forward before reverse.
    pub fn best_into(&self, pose: Pose, disc: GoalDisc, after_reverse: Option<bool>) -> Option<TurnStraight> {
        self.best_into_below(pose, disc, after_reverse, f64::INFINITY)
    }

    /// Returns the same if it costs less than a limit; otherwise nothing, or one that costs no less than the limit.
    pub fn best_into_below(
        &self,
        pose: Pose,
        disc: GoalDisc,
        after_reverse: Option<bool>,
        limit: f64,
    ) -> Option<TurnStraight> {
        let mut best: Option<TurnStraight> = None;
        self.collect(Approach { pose, disc, after_reverse, limit }, &mut |found| {
            if best.is_none_or(|best| found.cost < best.cost) {
                best = Some(found);
            }
            best.map_or(limit, |best| best.cost.min(limit))
        });
        best
    }

    /// Returns all from a pose whose body centre is outside the disc, the cheapest first.
    pub fn all_into(&self, pose: Pose, disc: GoalDisc) -> Vec<TurnStraight> {
        let mut ways = Vec::new();
        let limit = f64::INFINITY;
        self.collect(Approach { pose, disc, after_reverse: None, limit }, &mut |found| {
            ways.push(found);
            limit
        });
        ways.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        ways
    }

    /// Hands all of them to `take`, which answers with the cost from which on none needs to be worked out any more.
    fn collect(&self, approach: Approach, take: &mut impl FnMut(TurnStraight) -> f64) {
        let Approach { pose, disc, after_reverse, mut limit } = approach;
        let direction = pose.direction();
        let offset = disc.centre - pose.position();
        let x = offset.dot(direction);
        let y = direction.perp_dot(offset);
        let near_side = 1f64.copysign(y);
        for side in [near_side, -near_side] {
            // Seen from the turning circle's centre, mirrored for turns to the right.
            let target = DVec2::new(x, side * y - self.radius);
            let turn = |angle: f64| Segment { curvature: side / self.radius, length_m: angle * self.radius };
            let (enters_forward, enters_reverse) = self.entries(target, disc.radius_m);
            // Turns alone, which enter the disc on the turning circle.
            for angle in [enters_forward, -enters_reverse] {
                if angle.is_finite() {
                    limit = take(self.priced(turn(angle), NOTHING, after_reverse));
                }
            }
            // Turns that end before that, and a straight, forward first; each is aimed where it is shortest.
            for sign in [1.0, -1.0] {
                for (offset, turns_forward) in [(0.0, sign > 0.0), (-EDGE_SHARE * disc.radius_m, sign < 0.0)] {
                    let aim = StraightAim { sign, offset, turns_forward };
                    if let Some((angle, straight)) = self.tangent(target, aim, disc.radius_m, limit) {
                        let entry = if turns_forward { enters_forward } else { enters_reverse };
                        // A turn past its entry is in the disc already, and was offered without a straight.
                        if angle.abs() < entry {
                            limit = take(self.priced(turn(angle), straight, after_reverse));
                        }
                    }
                }
            }
        }
    }

    /// Returns the turning angles, forward and reverse, at which the body's centre enters the disc; infinite if never.
    fn entries(&self, target: DVec2, disc_radius: f64) -> (f64, f64) {
        let distance_squared = target.length_squared();
        let between = (self.centre_radius * self.centre_radius + distance_squared - disc_radius * disc_radius)
            / (2.0 * self.centre_radius * distance_squared.sqrt());
        if disc_radius <= 0.0 || between >= 1.0 {
            return (f64::INFINITY, f64::INFINITY);
        }
        let half = ops::acos(between);
        let middle = ops::atan2(target.y, target.x) + self.centre_angle;
        (full_turn(middle - half), TAU - full_turn(middle + half))
    }

    /// Returns the turning angle, less than a full turn, after which a straight leads into the disc, and that straight.
    ///
    /// `None` where there is none, or it is known without the angle that both together cost the limit.
    fn tangent(&self, target: DVec2, aim: StraightAim, disc_radius: f64, limit: f64) -> Option<(f64, Segment)> {
        let StraightAim { sign, offset, turns_forward } = aim;
        let lever = self.radius - offset;
        let along_squared = target.length_squared() - lever * lever;
        // No tangent of the turning circle leads to a target inside of it.
        if along_squared < 0.0 {
            return None;
        }
        let along = sign * along_squared.sqrt();
        let length_m = along.abs() - sign * self.centre_offset - (disc_radius * disc_radius - offset * offset).sqrt();
        let straight = Segment { curvature: 0.0, length_m: sign * length_m };
        let sin = lever * target.x + along * target.y;
        let cos = along * target.x - lever * target.y;
        let straight_cost = self.price.cost(straight, None);
        if !(length_m >= 0.0 && straight_cost < limit) {
            return None;
        }
        // Most are ruled out by the quarter of the circle in which the turn ends.
        let min_turn_m = self.radius * min_turn(sin, cos, turns_forward);
        let turn =
            Segment { curvature: 1.0 / self.radius, length_m: if turns_forward { min_turn_m } else { -min_turn_m } };
        if straight_cost + self.price.cost(turn, None) > limit + LIMIT_SLACK_M {
            return None;
        }
        let angle = full_turn(ops::atan2(sin, cos));
        Some((if turns_forward { angle } else { angle - TAU }, straight))
    }

    #[inline]
    fn priced(&self, turn: Segment, straight: Segment, after_reverse: Option<bool>) -> TurnStraight {
        // A turn that is only rounding may go the other way, and would be charged as a cusp.
        let keep = |piece: Segment| if piece.length_m.abs() < SHORTEST_M { NOTHING } else { piece };
        let mut way = TurnStraight { turn: keep(turn), straight: keep(straight), cost: 0.0 };
        let mut before = after_reverse;
        for piece in way.pieces() {
            way.cost += self.price.cost(piece, before);
            before = Some(piece.is_reverse());
        }
        way
    }

    /// Replaces the end of a path by a motion into the goal, where that is cheaper and free, cheapest first.
    ///
    /// `is_free` tells whether the truck may drive a segment from a pose.
    pub fn shorten_end(&self, path: &mut Path, goal: GoalDisc, is_free: impl Fn(Pose, Segment) -> bool) {
        let mut exits = self.exits(path, goal);
        exits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let free = exits.iter().take(MAX_TRIES).find(|exit| {
            let mut pose = exit.pose;
            exit.way.pieces().all(|piece| {
                let from = pose;
                pose = piece.end(from);
                is_free(from, piece)
            })
        });
        let Some(exit) = free else { return };
        let last = path.segments[exit.index];
        path.segments.truncate(exit.index);
        // Of a segment at whose beginning the exit is, nothing remains.
        if exit.travelled_m != 0.0 {
            path.segments.push(Segment { length_m: exit.travelled_m, ..last });
        }
        path.segments.extend(exit.way.pieces());
    }

    /// Returns all exits that make the path cheaper, in the order of the path.
    fn exits(&self, path: &Path, goal: GoalDisc) -> Vec<Exit> {
        let limit = self.price.path_cost(path.start, &path.segments) - WORTH_M;
        let mut exits = Vec::new();
        let mut pose = path.start;
        let mut cost = 0.0;
        let mut before = None;
        for (index, &segment) in path.segments.iter().enumerate() {
            let pieces = (segment.length_m.abs() / KNOT_M).ceil();
            for k in 0..pieces as u32 {
                let travelled_m = segment.length_m * f64::from(k) / pieces;
                // At a joint the truck came by the segment before, which decides about a cusp.
                let (here, spent, came) = if k == 0 {
                    (pose, cost, before)
                } else {
                    let driven = Segment { length_m: travelled_m, ..segment };
                    let spent = cost + self.price.cost(driven, before) + self.price.surcharge(pose, driven);
                    (driven.end(pose), spent, Some(segment.is_reverse()))
                };
                // No way into the disc is shorter than the straight line.
                let centre = here.position() + here.direction() * self.centre_offset;
                let gap = centre.distance(goal.centre) - goal.radius_m;
                if gap <= 0.0 || spent + gap > limit {
                    continue;
                }
                let Some(way) = self.best_into(here, goal, came) else { continue };
                let whole = spent + (way.cost + self.price.way_surcharge(here, way.pieces()));
                if whole < limit {
                    exits.push(Exit { cost: whole, pose: here, index, travelled_m, way });
                }
            }
            cost += self.price.cost(segment, before) + self.price.surcharge(pose, segment);
            before = Some(segment.is_reverse());
            pose = segment.end(pose);
        }
        exits
    }
}

/// Returns what no turn is less than, in radians, that is driven forward or in reverse and ends in a direction given by
/// multiples of its sine and its cosine.
fn min_turn(sin: f64, cos: f64, forward: bool) -> f64 {
    let quarters = match (sin >= 0.0, cos >= 0.0) {
        (true, true) => [0.0, 3.0],
        (true, false) => [1.0, 2.0],
        (false, false) => [2.0, 1.0],
        (false, true) if sin > -AHEAD_RAD * cos => [0.0, 0.0],
        (false, true) => [3.0, 0.0],
    };
    FRAC_PI_2 * if forward { quarters[0] } else { quarters[1] }
}

/// Returns the same angle in [0, 2 pi).
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
    use crate::kit::local_search::PrimitiveSettings;
    use crate::test_fields::random_pose;
    use wildfire_base::rng;

    fn steering() -> (Dimensions, TurnStraightSteering) {
        let body = Dimensions::default();
        (body, TurnStraightSteering::new(&body, MotionPrice::new(&PrimitiveSettings::default(), &body, None)))
    }

    fn all(
        steering: &TurnStraightSteering,
        pose: Pose,
        disc: GoalDisc,
        after_reverse: Option<bool>,
    ) -> Vec<TurnStraight> {
        let mut aims = Vec::new();
        let limit = f64::INFINITY;
        steering.collect(Approach { pose, disc, after_reverse, limit }, &mut |aim| {
            aims.push(aim);
            limit
        });
        aims
    }

    #[test]
    fn aims_end_on_the_rim_and_enter_the_disc_nowhere_before() {
        let (body, steering) = steering();
        let mut rng = rng::stream(1, "aim");
        let mut seen = 0;
        for _ in 0..2_000 {
            let pose = random_pose(&mut rng, 60.0);
            let centre = random_pose(&mut rng, 60.0).position();
            let disc = GoalDisc { centre, radius_m: rng.random_range(0.5..15.0) };
            if body.body_centre(pose).distance(centre) <= disc.radius_m {
                continue;
            }
            let aims = all(&steering, pose, disc, None);
            let mut first_of_best: Option<TurnStraight> = None;
            for &aim in &aims {
                first_of_best = first_of_best.filter(|best| aim.cost >= best.cost).or(Some(aim));
            }
            assert_eq!(steering.best_into(pose, disc, None), first_of_best);
            // A limit leaves out what costs as much, and nothing else.
            let min = first_of_best.map_or(f64::INFINITY, |best| best.cost);
            for limit in [0.5 * min, min, min + 1e-9, 2.0 * min] {
                let below = steering.best_into_below(pose, disc, None, limit).filter(|best| best.cost < limit);
                assert_eq!(below, first_of_best.filter(|best| best.cost < limit), "below {limit}");
            }
            for aim in &aims {
                let path = Path { start: pose, segments: aim.pieces().collect() };
                let end = body.body_centre(path.end()).distance(centre);
                assert!((end - disc.radius_m).abs() < 1e-9, "ends at {end} of {}", disc.radius_m);
                assert!((aim.cost - steering.price.path_cost(path.start, &path.segments)).abs() < 1e-9);
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
        let (body, steering) = steering();
        let mut rng = rng::stream(2, "aim");
        for _ in 0..500 {
            let pose = random_pose(&mut rng, 60.0);
            let place = random_pose(&mut rng, 60.0).position();
            for aim in all(&steering, pose, GoalDisc { centre: place, radius_m: 0.0 }, Some(true)) {
                let path = Path { start: pose, segments: aim.pieces().collect() };
                assert!(body.body_centre(path.end()).distance(place) < 1e-9);
            }
        }
    }

    #[test]
    fn no_turn_then_straight_of_a_fine_grid_is_shorter_than_the_best_aim() {
        let (body, steering) = steering();
        let mut rng = rng::stream(3, "aim");
        for _ in 0..60 {
            let pose = random_pose(&mut rng, 50.0);
            let disc = GoalDisc { centre: random_pose(&mut rng, 50.0).position(), radius_m: 8.0 };
            if body.body_centre(pose).distance(disc.centre) <= disc.radius_m {
                continue;
            }
            let best = steering.best_into(pose, disc, None).map_or(f64::INFINITY, |aim| aim.cost);
            for side in [-1.0, 1.0] {
                for turn in -80..=80 {
                    let turn = Segment { curvature: side / 13.0, length_m: f64::from(turn) * 0.5 };
                    for straight in -60..=60 {
                        let straight = Segment { curvature: 0.0, length_m: f64::from(straight) };
                        let end = straight.end(turn.end(pose));
                        if body.body_centre(end).distance(disc.centre) <= disc.radius_m {
                            // A straight that misses the centre may be cheaper than one aimed at it, but not by much.
                            let cost = steering.price.path_cost(pose, &[turn, straight]);
                            assert!(cost > best - 2.5, "grid {cost}, aim {best}");
                        }
                    }
                }
            }
        }
    }
}
