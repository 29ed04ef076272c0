use super::clearance_profile::ClearanceFloor;
use super::local_search::PrimitiveSettings;
use super::motion_price::Price;
use super::shorten::shorten;
use super::turn_straight::Aiming;
use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::planning::Goal;
use crate::vehicle::{CurvePrice, Dimensions, Path, ReedsShepp, Segment};

use super::holonomic::{Cells, Wave};

/// An estimate by aims exceeds the straight line by at most this, because reversing may know better.
const DETOUR_CAP_M: f64 = 15.0;
/// Segments of the longest Reeds-Shepp word.
const MAX_SEGMENTS: usize = 5;

/// A way into the goal that nothing is known to be free of: a Reeds-Shepp curve, or an aim into a disc.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    segments: [Segment; MAX_SEGMENTS],
    count: usize,
    /// Metres, and what changes of direction cost, the first after the drive so far included.
    pub cost: f64,
}

impl Approach {
    fn new(way: impl IntoIterator<Item = Segment>, cost: f64) -> Self {
        let nothing = Segment { curvature: 0.0, length_m: 0.0 };
        let mut approach = Self { segments: [nothing; MAX_SEGMENTS], count: 0, cost };
        for (place, segment) in approach.segments.iter_mut().zip(way) {
            *place = segment;
            approach.count += 1;
        }
        approach
    }

    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        self.segments[..self.count].iter().copied()
    }
}

/// What a pose promises.
#[derive(Clone, Copy, Debug)]
pub struct Outlook {
    /// Estimated cost from here on.
    pub to_go: f64,
    /// `None` where no aim leads into the disc.
    pub approach: Option<Approach>,
}

/// Estimates what is still to drive, as if on an empty field or as a walker, whichever is more.
#[derive(Clone, Debug)]
pub struct Lookout {
    body: Dimensions,
    curves: ReedsShepp,
    price: CurvePrice,
    aiming: Aiming,
}

impl Lookout {
    /// `cusp_m` is what a change of direction costs.
    pub fn new(cusp_m: f64, body: &Dimensions) -> Self {
        let prices = PrimitiveSettings { turn_cost: 0.0, reverse_cost: 0.0, cusp_cost: cusp_m, ..Default::default() };
        Self {
            body: *body,
            curves: ReedsShepp { radius_m: body.turning_radius_m },
            price: CurvePrice { reverse_factor: 1.0, cusp_m },
            aiming: Aiming::new(body, Price::new(&prices, body, None)),
        }
    }

    /// What is promised to a truck that came to `pose` forward or in reverse, or stands there.
    pub fn outlook(
        &self,
        pose: Pose,
        after_reverse: Option<bool>,
        goal: Goal,
        (cells, wave): (&Cells, &mut Wave),
    ) -> Outlook {
        let outlook = self.without_bushes(pose, after_reverse, goal);
        let walked = wave.least_m(cells, goal.place_of(pose, &self.body));
        Outlook { to_go: outlook.to_go.max(walked), ..outlook }
    }

    /// The same on an empty field.
    pub fn without_bushes(&self, pose: Pose, after_reverse: Option<bool>, goal: Goal) -> Outlook {
        let (to_go, approach) = match goal {
            Goal::Pose(end) => {
                let approach = self.curve(pose, after_reverse, end);
                (approach.cost, Some(approach))
            }
            Goal::Disc(disc) => {
                let straight = self.body.body_centre(pose).distance(disc.centre) - disc.radius_m;
                let aim = self.aiming.best_into(pose, disc, after_reverse);
                let approach = aim.map(|aim| Approach::new(aim.pieces(), aim.cost));
                if straight <= 0.0 {
                    (0.0, Some(Approach::new([], 0.0)))
                } else {
                    let most = straight + DETOUR_CAP_M;
                    (approach.map_or(most, |approach| approach.cost.min(most)), approach)
                }
            }
        };
        Outlook { to_go, approach }
    }

    /// The way that an empty field would allow, if it keeps the floor.
    pub fn straight_away(
        &self,
        checker: &CollisionChecker,
        start: Pose,
        goal: Goal,
        floor: &ClearanceFloor,
    ) -> Option<Path> {
        let approach = self.without_bushes(start, None, goal).approach?;
        let is_free = floor.way_is_free(checker, start, approach.segments());
        is_free.then(|| Path { start, segments: approach.segments().collect() })
    }

    /// A path to the goal with another way into it, if it is a disc and that is cheaper.
    pub fn end_sooner(&self, checker: &CollisionChecker, mut path: Path, goal: Goal, floor: &ClearanceFloor) -> Path {
        if let Goal::Disc(disc) = goal {
            let is_free = |pose, segment| floor.motion_is_free(checker, pose, segment);
            shorten(&self.body, &self.aiming, is_free, path.start, disc, &mut path.segments);
        }
        path
    }

    fn curve(&self, pose: Pose, after_reverse: Option<bool>, end: Pose) -> Approach {
        let best = self.curves.cheapest(pose, end, &self.price);
        let first = best.curve.segments().next().map(|segment| segment.is_reverse());
        let turns_back = after_reverse.is_some() && first.is_some() && first != after_reverse;
        Approach::new(best.curve.segments(), best.price + if turns_back { self.price.cusp_m } else { 0.0 })
    }
}
