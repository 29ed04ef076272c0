//! Traffic: trucks keep clear of each other.
//!
//! The leg of every truck is a reservation: along it while it drives, and of its end from then on. No two reservations
//! come nearer than [`MARGIN_M`], so a truck that keeps to its own is safe whatever the others do. Only three things
//! change a reservation, and each keeps the rule:
//! - a truck sets out when its way is free ([`Traffic::departure`]); or it takes another goal, drives
//!   [round](wildfire_planning::traffic::replan_around) those that stand in the way or, with `traffic.plan = "together"`,
//!   [among](wildfire_planning::traffic::plan_among) the motions of all, or waits until something of the others changes;
//! - a truck that drops its goal drives on to where it may stand for good ([`Traffic::stopping`]);
//! - a truck that has nothing to do, or is blocked itself, gives way to one that could not set out otherwise
//!   ([`deadlock`](super::deadlock)).

use bevy_ecs::prelude::Entity;
use glam::DVec2;

use wildfire_base::geometry::{OrientedRect, Pose};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{SpeedLimits, Trajectory};
use wildfire_base::vehicle::Dimensions;
use wildfire_base::vehicle::Segment;
use wildfire_planning::collision::{CollisionChecker, MIN_CLEARANCE_M, MovingBody, first_conflict, gap_between};
use wildfire_planning::traffic::PredictedMotions;
use wildfire_timeline::AgentId;

pub use wildfire_scenario::TRUCK_MARGIN_M as MARGIN_M;

/// How long a truck puts its departure off for others that pass, before it looks for another way or goal.
const PATIENCE: SimTime = SimTime::from_nanos(20_000_000_000);

/// The step in which departures are put off.
const WAIT_STEP_S: f64 = 0.5;

/// Initial waits after which a truck that plans together with others searches for a path.
const WAITS_S: [f64; 6] = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0];
/// A longer wait has to lead this much farther.
const GAIN_M: f64 = 1.0;

/// A truck that may not stop at once tries again after this time on its way.
const STOP_STEP_S: f64 = 0.25;

/// The number of steps that are tried: where a truck is so slow that they do not suffice, they are longer.
const MAX_STEPS: f64 = 1000.0;

/// Boxes of two motions that are this far from each other prove that the bodies keep [`MARGIN_M`]: a gap may be taken for
/// smaller than it is by the square root of 2, see [`first_conflict`].
const SURELY_APART_M: f64 = 2.0 * MARGIN_M;

/// A box with sides along x and y that a body does not leave, metres.
#[derive(Clone, Copy, Debug)]
struct SweptBox {
    low: DVec2,
    high: DVec2,
}

impl SweptBox {
    /// Bounds where a body is on all of its motion.
    fn new(MovingBody { body, trajectory }: MovingBody<'_>) -> Self {
        let at_start = trajectory.start().position();
        let mut rear_axle = Self { low: at_start, high: at_start };
        for (start, piece) in trajectory.pieces_with_starts() {
            let Some(segment) = piece.segment() else { continue };
            // An arc leaves its chord by its sagitta, at most curvature times length squared over 8 and half its length.
            let length_m = segment.length_m.abs();
            let aside_m = (segment.curvature.abs() * length_m * length_m / 8.0).min(0.5 * length_m);
            let from = start.position();
            let to = segment.end(start).position();
            rear_axle.low = rear_axle.low.min(from.min(to) - aside_m);
            rear_axle.high = rear_axle.high.max(from.max(to) + aside_m);
        }
        rear_axle.widened(farthest_point_m(body))
    }

    fn standing(body: &Dimensions, pose: Pose) -> Self {
        Self { low: pose.position(), high: pose.position() }.widened(farthest_point_m(body))
    }

    fn widened(self, metres: f64) -> Self {
        Self { low: self.low - metres, high: self.high + metres }
    }

    fn is_near(&self, other: &Self) -> bool {
        let apart_m = (self.low - other.high).max(other.low - self.high).max_element();
        // A place that is not a number is near to everything.
        apart_m.is_nan() || apart_m <= SURELY_APART_M
    }
}

/// Returns a leg with an initial wait, which may be 0.
pub fn after_waiting(leg: &Trajectory, seconds: f64) -> Trajectory {
    if seconds > 0.0 { leg.after_waiting(seconds) } else { leg.clone() }
}

/// Returns the distance of a body's farthest point from its rear axle, metres.
fn farthest_point_m(body: &Dimensions) -> f64 {
    let lengthwise = body.rear_overhang_m.max(body.length_m - body.rear_overhang_m);
    (lengthwise * lengthwise + 0.25 * body.width_m * body.width_m).sqrt()
}

/// The present and future positions of a truck.
#[derive(Clone, Debug)]
pub struct Reservation {
    pub entity: Entity,
    pub id: AgentId,
    pub body: Dimensions,
    leg: Trajectory,
    /// True if it stands and will not leave by itself.
    pub is_idle: bool,
    /// Where it is on all of its leg.
    swept: SweptBox,
}

impl Reservation {
    pub fn new(entity: Entity, id: AgentId, body: Dimensions, leg: Trajectory, is_idle: bool) -> Self {
        let swept = SweptBox::new(MovingBody { body: &body, trajectory: &leg });
        Self { entity, id, body, leg, is_idle, swept }
    }

    pub fn leg(&self) -> &Trajectory {
        &self.leg
    }

    /// Assigns the truck another leg.
    pub fn set_leg(&mut self, leg: Trajectory) {
        self.swept = SweptBox::new(MovingBody { body: &self.body, trajectory: &leg });
        self.leg = leg;
    }

    fn moving(&self) -> MovingBody<'_> {
        MovingBody { body: &self.body, trajectory: &self.leg }
    }

    /// Returns when a motion first conflicts with this truck in its last place, as if it stood there all the time. `swept`
    /// is the box of the motion.
    fn first_conflict_at_end(&self, motion: MovingBody<'_>, swept: &SweptBox) -> Option<SimTime> {
        if !SweptBox::standing(&self.body, self.leg.end()).is_near(swept) {
            return None;
        }
        let stand = Trajectory::new(SimTime::ZERO, self.leg.end(), Vec::new());
        let stand = MovingBody { body: &self.body, trajectory: &stand };
        first_conflict(motion, stand, motion.trajectory.start_time(), MARGIN_M)
    }
}

/// A leg that begins with a wait, and when it meets another truck.
#[derive(Debug)]
pub struct Meeting {
    pub wait_s: f64,
    pub leg: Trajectory,
    pub meets_at: SimTime,
}

/// The reservations of the other trucks, as one truck sees them.
#[derive(Clone, Copy, Debug)]
pub struct Traffic<'a> {
    all: &'a [Reservation],
    except: Entity,
}

impl<'a> Traffic<'a> {
    pub fn new(all: &'a [Reservation], except: Entity) -> Self {
        Self { all, except }
    }

    fn others(self) -> impl Iterator<Item = &'a Reservation> {
        self.all.iter().filter(move |other| other.entity != self.except)
    }

    /// Returns the first of the others that a motion comes too near from `from` on.
    fn first_in_conflict(self, motion: MovingBody<'_>, from: SimTime) -> Option<&'a Reservation> {
        let swept = SweptBox::new(motion);
        // Boxes show cheaply that most pairs are far apart.
        let mut near = self.others().filter(|other| other.swept.is_near(&swept));
        near.find(|other| first_conflict(motion, other.moving(), from, MARGIN_M).is_some())
    }

    /// Iterates over the others whose last place blocks a leg, whenever it is driven.
    pub fn standing_on(self, body: &Dimensions, leg: &Trajectory) -> impl Iterator<Item = &'a Reservation> {
        let swept = SweptBox::new(MovingBody { body, trajectory: leg });
        self.others()
            .filter(move |other| other.first_conflict_at_end(MovingBody { body, trajectory: leg }, &swept).is_some())
    }

    /// Returns the metres of a leg before the first truck that stands on it in its last place, if any does.
    pub fn free_m(self, body: &Dimensions, leg: &Trajectory) -> Option<f64> {
        let motion = MovingBody { body, trajectory: leg };
        let swept = SweptBox::new(motion);
        let times = self.others().filter_map(|other| other.first_conflict_at_end(motion, &swept));
        times.map(|time| leg.distance_m(time)).min_by(f64::total_cmp)
    }

    /// Returns a leg that meets others, and the same after the wait of [`WAITS_S`] with which it drives farthest before it
    /// meets one, if that is farther.
    pub fn meetings(self, body: &Dimensions, leg: &Trajectory) -> Vec<Meeting> {
        let mut farthest = Vec::new();
        let mut max_m = f64::NEG_INFINITY;
        // In order of waits, so that a longer one counts only if it leads clearly farther.
        for wait_s in WAITS_S {
            let leg = after_waiting(leg, wait_s);
            let motion = MovingBody { body, trajectory: &leg };
            let swept = SweptBox::new(motion);
            let near = self.others().filter(|other| other.swept.is_near(&swept));
            let times = near.filter_map(|other| first_conflict(motion, other.moving(), leg.sets_out_at(), MARGIN_M));
            // A wait after which it meets nobody is one that `departure` finds.
            let Some(meets_at) = times.min() else { continue };
            let free_m = leg.distance_m(meets_at);
            if free_m > max_m + GAIN_M {
                max_m = free_m;
                // The leg without a wait stays; of the others only the best.
                farthest.truncate(1);
                farthest.push(Meeting { wait_s, leg, meets_at });
            }
        }
        farthest
    }

    /// Returns the motions of the others as a body meets them.
    pub fn predicted_for(self, body: &'a Dimensions) -> MotionsOfOthers<'a> {
        MotionsOfOthers { traffic: self, body }
    }

    /// Returns the leg with the shortest initial wait that lets the others pass, or the truck that blocks it.
    pub fn departure(self, body: &Dimensions, leg: &Trajectory) -> Result<Trajectory, AgentId> {
        self.departure_within(PATIENCE, body, leg)
    }

    /// Returns the same with at most `patience` of waiting.
    pub fn departure_within(
        self,
        patience: SimTime,
        body: &Dimensions,
        leg: &Trajectory,
    ) -> Result<Trajectory, AgentId> {
        // The truck stands where nobody will pass, so only the motion itself is looked at, not the wait before it.
        let conflict =
            |leg: &Trajectory| self.first_in_conflict(MovingBody { body, trajectory: leg }, leg.sets_out_at());
        let Some(first) = conflict(leg) else { return Ok(leg.clone()) };
        // No wait helps against who stands on the way for good.
        if let Some(other) = self.standing_on(body, leg).next() {
            return Err(other.id);
        }
        // When the last of the others has come to rest, waiting changes nothing more.
        let last = self.others().map(|other| other.leg.end_time()).max().unwrap_or_default();
        let longest_s = last.since(leg.start_time()).min(patience).as_seconds();
        // A bounded number of tests, coarser where waits are long.
        let step_s = WAIT_STEP_S.max(longest_s / MAX_STEPS);
        let steps = (longest_s / step_s).ceil() as u32;
        let mut later = (1..=steps).map(|step| leg.after_waiting(f64::from(step) * step_s));
        later.find(|leg| conflict(leg).is_none()).ok_or(first.id)
    }

    /// Returns a leg cut at the first place, from `now` on, where the truck may stand for good.
    pub fn stopping(self, body: &Dimensions, leg: &Trajectory, now: SimTime, limits: &SpeedLimits) -> Trajectory {
        let is_free = |cut: &Trajectory| self.first_in_conflict(MovingBody { body, trajectory: cut }, now).is_none();
        // A leg that has not begun stops where it stands.
        let at_once = if leg.start_time() >= now {
            Trajectory::new(now, leg.start(), Vec::new())
        } else {
            leg.stopping(now, limits)
        };
        // The soonest stop is the usual one: where it blocks nobody, no other is tried.
        if is_free(&at_once) {
            return at_once;
        }
        let begin = now.max(leg.start_time());
        let left_s = leg.end_time().since(begin).as_seconds();
        let step_s = STOP_STEP_S.max(left_s / MAX_STEPS);
        let times = (1..).map(|step| f64::from(step) * step_s).take_while(|&after_s| after_s < left_s);
        let mut cuts = times.map(|after_s| leg.stopping(begin + SimTime::from_seconds(after_s), limits));
        // Its whole leg is its reservation, so at the latest it may stand at the end.
        cuts.find(is_free).unwrap_or_else(|| leg.clone())
    }

    /// Returns the field with the others standing at the ends of their legs, [`MARGIN_M`] larger than they are.
    pub fn with_others_standing(self, checker: &CollisionChecker) -> CollisionChecker {
        // The checker keeps [`MIN_CLEARANCE_M`] from obstacles by itself.
        let wider = MARGIN_M - MIN_CLEARANCE_M;
        let standing = self.others().map(|other| {
            let OrientedRect { centre, half_length, half_width } = other.body.footprint(other.leg.end());
            OrientedRect { centre, half_length: half_length + wider, half_width: half_width + wider }
        });
        checker.with_obstacles(standing)
    }
}

/// The motions of other trucks, as a body meets them.
#[derive(Debug)]
pub struct MotionsOfOthers<'a> {
    traffic: Traffic<'a>,
    body: &'a Dimensions,
}

/// Instants of a motion at which it is compared with the others. The departure tests the whole drive.
const LOOKS: u32 = 4;
/// Metres besides [`MARGIN_M`] that a body keeps at these instants: from others that move, and from others that stand.
const EXTRA_M: [f64; 2] = [0.3, 0.05];

impl PredictedMotions for MotionsOfOthers<'_> {
    fn leave_free(&self, from: Pose, segment: Segment, [begins_s, ends_s]: [f64; 2]) -> bool {
        // The larger of the two, as each of the others may move or stand.
        let swept = SweptBox::standing(self.body, from).widened(segment.length_m.abs() + EXTRA_M[0]);
        self.traffic.others().filter(|other| other.swept.is_near(&swept)).all(|other| {
            (1..=LOOKS).all(|look| {
                let share = f64::from(look) / f64::from(LOOKS);
                let pose = segment.pose_at(from, share * segment.length_m);
                let time = SimTime::from_seconds(begins_s + share * (ends_s - begins_s));
                // A moving truck may come nearer between two looks, so it gets a wider margin.
                let extra_m = EXTRA_M[usize::from(other.leg.end_time() <= time)];
                gap_between(self.body, pose, &other.body, other.leg.pose_at(time)) > MARGIN_M + extra_m
            })
        })
    }

    fn let_stand(&self, pose: Pose, from_s: f64) -> bool {
        let stand = Trajectory::new(SimTime::from_seconds(from_s), pose, Vec::new());
        let motion = MovingBody { body: self.body, trajectory: &stand };
        self.traffic.first_in_conflict(motion, stand.start_time()).is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_ecs::prelude::World;
    use rand::RngExt;
    use wildfire_base::vehicle::{Path, Segment};

    fn straight(start_s: f64, start: Pose, metres: f64) -> Trajectory {
        let path = Path { start, segments: vec![Segment { curvature: 0.0, length_m: metres }] };
        Trajectory::from_path(&path, SimTime::from_seconds(start_s), SpeedLimits::new(8.0, 8.0))
    }

    /// A truck that drives east through x = 0 at 5 s, and the reservation of one that drives north through x = 0.
    fn crossing(passes_s: f64) -> (Trajectory, Reservation, Entity) {
        let mut world = World::new();
        let entity = world.spawn_empty().id();
        let other = world.spawn_empty().id();
        let north = Pose::new(0.0, -24.0, std::f64::consts::FRAC_PI_2);
        let leg = straight(passes_s - 3.0, north, 80.0);
        let body = Dimensions::default();
        let reservation = Reservation::new(other, AgentId::unimog(1), body, leg, false);
        (straight(0.0, Pose::new(-40.0, 0.0, 0.0), 100.0), reservation, entity)
    }

    #[test]
    fn a_truck_that_drops_its_goal_stops_at_once_or_drives_on_over_the_crossing() {
        let (leg, other, entity) = crossing(9.0);
        let (body, others) = (Dimensions::default(), [other]);
        let traffic = Traffic::new(&others, entity);
        for (at_s, min_m, max_m) in [(3.0, -16.0, -16.0), (4.5, 2.0, 6.0), (5.0, 2.0, 6.0), (7.0, 16.0, 16.0)] {
            let now = SimTime::from_seconds(at_s);
            let cut = traffic.stopping(&body, &leg, now, &SpeedLimits::new(8.0, 8.0));
            assert!(cut.end().x >= min_m && cut.end().x <= max_m, "asked at {at_s} s, stands at {:?}", cut.end());
            assert_eq!(cut.pose_at(now), leg.pose_at(now));
        }
    }

    #[test]
    fn a_truck_departs_as_soon_as_the_other_has_passed() {
        for (passes_s, waits) in [(5.0, true), (9.0, false), (3.0, false)] {
            let (leg, other, entity) = crossing(passes_s);
            let (body, others) = (Dimensions::default(), [other]);
            let departs = Traffic::new(&others, entity).departure(&body, &leg).expect("the other passes");
            let wait_s = departs.duration_s() - leg.duration_s();
            assert!(if waits { wait_s > 0.5 && wait_s < 2.0 } else { wait_s == 0.0 }, "{passes_s}: {wait_s} s");
            let motion = MovingBody { body: &body, trajectory: &departs };
            assert!(first_conflict(motion, others[0].moving(), SimTime::ZERO, 0.0).is_none());
        }
    }

    #[test]
    fn a_truck_that_stands_in_the_way_for_good_is_named() {
        let (leg, mut other, entity) = crossing(5.0);
        other.set_leg(straight(0.0, Pose::new(0.0, -30.0, std::f64::consts::FRAC_PI_2), 29.0));
        let (body, others) = (Dimensions::default(), [other]);
        let traffic = Traffic::new(&others, entity);
        assert_eq!(traffic.departure(&body, &leg), Err(AgentId::unimog(1)));
        let free_m = traffic.free_m(&body, &leg).expect("it stands on the way");
        assert!(free_m > 33.0 && free_m < 35.0, "{free_m}");
    }

    /// Boxes only save looks: where they are far apart, so are the bodies at every instant.
    #[test]
    fn boxes_that_are_apart_prove_that_bodies_are() {
        let mut rng = wildfire_base::rng::stream(3, "boxes");
        let mut draw = |low: f64, high: f64| rng.random_range(low..high);
        let body = Dimensions::default();
        let mut apart = 0;
        for _ in 0..400 {
            let mut leg = || {
                let start = Pose::new(draw(0.0, 120.0), draw(0.0, 120.0), draw(-3.1, 3.1));
                let segments = (0..3)
                    .map(|_| Segment { curvature: draw(-1.0 / 13.0, 1.0 / 13.0), length_m: draw(-30.0, 60.0) })
                    .collect();
                Trajectory::from_path(&Path { start, segments }, SimTime::ZERO, SpeedLimits::new(8.0, 8.0))
            };
            let (one, other) = (leg(), leg());
            let moving = |leg| MovingBody { body: &body, trajectory: leg };
            let swept = SweptBox::new(moving(&one));
            let other_swept = SweptBox::new(moving(&other));
            for step in 0..=40 {
                let time = SimTime::from_seconds(one.duration_s() * f64::from(step) / 40.0);
                for corner in body.footprint(one.pose_at(time)).corners() {
                    let inside = corner.cmpge(swept.low - 1e-9).all() && corner.cmple(swept.high + 1e-9).all();
                    assert!(inside, "{corner} is outside of {swept:?}");
                }
            }
            if !swept.is_near(&other_swept) {
                apart += 1;
                assert_eq!(first_conflict(moving(&one), moving(&other), SimTime::ZERO, MARGIN_M), None);
            }
        }
        assert!(apart > 50, "{apart} pairs are apart");
    }
}
