//! Estimates of the cost-to-go from a pose, and paths into the goal on an empty field.

use crate::GoalDisc;
use crate::collision::CollisionChecker;
use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{CurvePrice, Dimensions, Path, ReedsShepp};

use super::best_first::AnalyticExpansion;
use super::clearance_profile::ClearanceProfile;
use super::drive_cost::CostModel;
use super::motion_price::MotionPrice;
use super::target::Target;
use super::turn_straight::TurnStraightSteering;

/// An estimate by turn-straight steering exceeds the straight line by at most this, because reversing may know better.
const DETOUR_CAP_M: f64 = 15.0;

/// The heuristic's result for a pose.
#[derive(Clone, Copy, Debug)]
pub struct HeuristicValue {
    /// The estimated cost from here to the goal.
    pub cost_to_go: f64,
    /// The analytic expansion; `None` where no turn and straight lead into the disc.
    pub expansion: Option<AnalyticExpansion>,
}

/// Estimates the cost-to-go on an empty field.
///
/// It is the first heuristic of Dolgov and others (see [`super::best_first`]), non-holonomic without obstacles;
/// [`super::holonomic`] is the other.
#[derive(Clone, Debug)]
pub struct PoseHeuristic {
    body: Dimensions,
    cost: CostModel,
    curves: ReedsShepp,
    price: CurvePrice,
    steering: TurnStraightSteering,
}

impl PoseHeuristic {
    pub fn new(cost: CostModel, body: &Dimensions) -> Self {
        let price = cost.motion_price(body);
        Self {
            body: *body,
            cost,
            curves: ReedsShepp { radius_m: body.turning_radius_m },
            price: price.curve_price(),
            steering: TurnStraightSteering::new(body, price),
        }
    }

    /// Returns the prices of single motions.
    pub fn motion_price(&self) -> &MotionPrice {
        &self.steering.price
    }

    /// Returns the estimate for a truck that came to `pose` forward or in reverse, or stands there; of several discs,
    /// for the cheapest.
    pub fn without_bushes(&self, pose: Pose, after_reverse: Option<bool>, target: Target<'_>) -> HeuristicValue {
        match target {
            Target::Pose(end) => {
                let expansion = self.curve(pose, after_reverse, end);
                HeuristicValue { cost_to_go: expansion.cost, expansion: Some(expansion) }
            }
            Target::Discs(discs) => {
                let centre = self.body.body_centre(pose);
                let straight = |disc: &GoalDisc| centre.distance(disc.centre) - disc.radius_m;
                // The nearest by the straight line first: its value rules out most of the others.
                let mut nearest = 0;
                let mut nearest_m = straight(&discs[0]);
                for (index, disc) in discs.iter().enumerate().skip(1) {
                    let straight_m = straight(disc);
                    if straight_m.total_cmp(&nearest_m).is_lt() {
                        nearest = index;
                        nearest_m = straight_m;
                    }
                }
                let mut best = self.disc_value(pose, after_reverse, (discs[nearest], nearest_m), f64::INFINITY);
                for (index, disc) in discs.iter().enumerate() {
                    let straight_m = straight(disc);
                    // No way into the disc is shorter than the straight line.
                    if index != nearest && straight_m < best.cost_to_go {
                        let value = self.disc_value(pose, after_reverse, (*disc, straight_m), best.cost_to_go);
                        if value.cost_to_go < best.cost_to_go {
                            best = value;
                        }
                    }
                }
                best
            }
        }
    }

    /// Returns the estimate for one disc, whose rim is so far away in a straight line, or another one that is no less than
    /// the limit.
    fn disc_value(
        &self,
        pose: Pose,
        after_reverse: Option<bool>,
        (disc, straight): (GoalDisc, f64),
        limit: f64,
    ) -> HeuristicValue {
        if straight <= 0.0 {
            return HeuristicValue { cost_to_go: 0.0, expansion: Some(AnalyticExpansion::new([], 0.0)) };
        }
        let max = straight + DETOUR_CAP_M;
        // A way that costs more than the limit still counts where the estimate is capped below it.
        let limit = if max < limit { f64::INFINITY } else { limit };
        let found = self.steering.best_into_below(pose, disc, after_reverse, limit);
        let expansion = found.map(|found| AnalyticExpansion::new(found.pieces(), found.cost));
        HeuristicValue { cost_to_go: expansion.map_or(max, |way| way.cost.min(max)), expansion }
    }

    /// Returns the path of an empty field, if it keeps the clearance.
    pub fn free_expansion(
        &self,
        checker: &CollisionChecker,
        start: Pose,
        target: Target<'_>,
        profile: &ClearanceProfile,
    ) -> Option<Path> {
        let expansion = self.without_bushes(start, None, target).expansion?;
        let is_free = profile.way_is_free(checker, start, expansion.segments());
        is_free.then(|| Path { start, segments: expansion.segments().collect() })
    }

    /// Replaces the end of a path into a disc by a cheaper one, if there is one that keeps the clearance.
    pub fn shorten_end(
        &self,
        checker: &CollisionChecker,
        path: Path,
        target: Target<'_>,
        profile: &ClearanceProfile,
    ) -> Path {
        let Target::Discs(discs) = target else { return path };
        let disc = discs[target.disc_of(path.end(), &self.body)];
        let mut shortened = path.clone();
        self.steering.shorten_end(&mut shortened, disc, |pose, segment| profile.motion_is_free(checker, pose, segment));
        // The steering knows prices of motions only, of which the time of a drive is no sum.
        if self.cost.of(&shortened.segments) < self.cost.of(&path.segments) { shortened } else { path }
    }

    fn curve(&self, pose: Pose, after_reverse: Option<bool>, end: Pose) -> AnalyticExpansion {
        let best = self.curves.cheapest_word(pose, end, &self.price);
        let first = best.curve.segments().next().map(|segment| segment.is_reverse());
        let turns_back = after_reverse.is_some() && first.is_some() && first != after_reverse;
        AnalyticExpansion::new(best.curve.segments(), best.price + if turns_back { self.price.cusp_m } else { 0.0 })
    }
}
