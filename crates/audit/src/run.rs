//! The audit of a whole run.

use super::driven::DrivenLegs;
use super::field::{AuditField, Outline};
use super::fires::audit_fires;
use super::ground::audit_ground;
use super::leg::{MotionLimits, SampleStep, audit_leg, work_of_pose};
use super::line::audit_line;
use super::meeting::{MovingTruck, audit_meetings};
use super::spread::audit_spread;
use super::suppression::audit_acts;
use super::water::audit_water;
use super::{Audited, Violation, ViolationKind};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;
use wildfire_timeline::{AgentStart, Body, Timeline};

/// The work that the legs of one agent may take, in looks at a cell.
const MAX_WORK: f64 = 1e11;

/// The result of an audit.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The amount that was looked at; of an agent's legs, those before its first violation.
    pub audited: Audited,
    /// The first in time.
    pub violation: Option<Violation>,
    /// True if the timeline says how fast everybody may go, and how fire behaves; those before format 3 do not.
    pub knows_limits: bool,
}

/// Holds a finished run against the rules.
pub fn audit_timeline(timeline: &Timeline, step: SampleStep) -> Verdict {
    let setting = &timeline.setting;
    let all_driven: Vec<DrivenLegs<'_>> = setting.agents.iter().map(|agent| DrivenLegs::new(agent, timeline)).collect();
    let mut audited = Audited::default();
    let mut violations: Vec<Option<Violation>> = Vec::new();
    let mut drivers = Vec::new();
    for (agent, driven) in setting.agents.iter().zip(&all_driven) {
        let outline = Outline::new(&agent.body);
        let field = AuditField::new(setting.frame, &setting.obstacles(), outline);
        violations.push(driven.audit().err());
        // Only legs of a bounded length are held against the ground.
        let legs = audit_legs(driven, &field, &motion(agent), step, &mut audited);
        violations.push(legs.and_then(|()| audit_ground(setting, driven, agent.limits)).err());
        // Only trucks keep clear of each other; Wumpuses walk through.
        if let Body::Truck(_) = agent.body {
            drivers.push(MovingTruck { driven, outline });
        }
    }
    violations.push(audit_meetings(&drivers, timeline.end_time(), step).err());
    // Where fire goes over ground, `audit_spread` follows the bushes on it too.
    violations.push(if setting.spread.is_some() { audit_spread(timeline) } else { audit_fires(timeline) }.err());
    violations.push(audit_line(timeline).err());
    violations.push(audit_water(timeline).err());
    match audit_acts(timeline) {
        Ok(extinctions) => audited.extinctions += extinctions,
        Err(violation) => violations.push(Some(violation)),
    }
    let knows_fire = setting.rules.fire.is_some() || setting.spread.is_some();
    let knows_limits = knows_fire && setting.agents.iter().all(|agent| agent.limits.is_some());
    Verdict {
        audited,
        // What comes first in time is likely the cause of the rest.
        violation: violations.into_iter().flatten().min_by_key(|violation| violation.time),
        knows_limits,
    }
}

fn audit_legs(
    driven: &DrivenLegs<'_>,
    field: &AuditField,
    motion: &MotionLimits,
    step: SampleStep,
    audited: &mut Audited,
) -> Result<(), Violation> {
    // A leg without pieces, as the start must be free as well.
    let start = Trajectory::new(SimTime::ZERO, driven.start, Vec::new());
    let mut work = 0.0;
    for leg in std::iter::once(&start).chain(driven.legs()) {
        let violation = |violation| Violation { agent: Some(driven.id), ..violation };
        let examined = audit_leg(field, motion, leg, step).map_err(violation)?;
        work += examined.poses as f64 * work_of_pose(field);
        // Each leg is bounded by itself; this bounds all of them.
        if work > MAX_WORK {
            let time = leg.end_time();
            let place = leg.end().position();
            return Err(violation(Violation { time, agent: None, place, kind: ViolationKind::Endless }));
        }
        *audited += examined;
    }
    Ok(())
}

fn motion(agent: &AgentStart) -> MotionLimits {
    let turning_radius_m = match agent.body {
        Body::Truck(body) => Some(body.turning_radius_m),
        Body::Square { .. } => None,
    };
    MotionLimits { turning_radius_m, limits: agent.limits }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::{Cell, FieldFrame, Pose};
    use wildfire_base::trajectory::SpeedLimits;
    use wildfire_base::vehicle::{Dimensions, Path, Segment};
    use wildfire_timeline::{AgentFact, AgentId, Cause, Event, Fact, FireFact, Setting, sample};

    const TRUCK: AgentId = AgentId::unimog(0);
    const SECOND: AgentId = AgentId::unimog(1);
    const NEAR: Cell = Cell { col: 10, row: 10 };
    const FAR: Cell = Cell { col: 10, row: 18 };
    const LIMITS: SpeedLimits = SpeedLimits {
        forward_mps: 8.0,
        reverse_mps: 8.0,
        acceleration_mps2: None,
        braking_mps2: None,
        lateral_mps2: None,
        steering: None,
    };

    fn seconds(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds)
    }

    fn at(time_s: f64, fact: Fact) -> Event {
        Event { time: seconds(time_s), fact }
    }

    fn drive(start_s: f64, start: Pose, lengths_m: &[f64]) -> Trajectory {
        let segments = lengths_m.iter().map(|&length_m| Segment { curvature: 0.0, length_m }).collect();
        Trajectory::from_path(&Path { start, segments }, seconds(start_s), LIMITS)
    }

    fn planned(time_s: f64, trajectory: Trajectory) -> Event {
        let effort = Default::default();
        at(time_s, Fact::Agent(TRUCK, AgentFact::Planned { goal: NEAR, trajectory, effort, found_by: None }))
    }

    fn dropped(time_s: f64, trajectory: Trajectory) -> Event {
        at(time_s, Fact::Agent(TRUCK, AgentFact::Dropped { goal: NEAR, trajectory }))
    }

    fn ignited(time_s: f64, cell: Cell, cause: Cause) -> Event {
        at(time_s, Fact::Fire(FireFact::Ignited { cell, cause }))
    }

    fn extinguished(time_s: f64) -> Event {
        at(time_s, Fact::Fire(FireFact::Extinguished { cell: NEAR, by: TRUCK }))
    }

    fn burned_out(time_s: f64, cell: Cell) -> Event {
        at(time_s, Fact::Fire(FireFact::BurnedOut { cell }))
    }

    /// A truck that starts at (20, 46) m, facing east, on a field of 100 m with bushes from (50, 50) to (55, 55) m and
    /// from (50, 90) to (55, 95) m; another truck stands in the south-west.
    fn start() -> Pose {
        Pose::new(20.0, 46.0, 0.0)
    }

    fn setting() -> Setting {
        let truck = |id, pose| AgentStart { id, pose, body: Body::Truck(Dimensions::default()), limits: Some(LIMITS) };
        Setting {
            scenario: "audit".into(),
            frame: FieldFrame { cols: 20, rows: 20, cell_m: 5.0 },
            bushes: vec![NEAR, FAR],
            agents: vec![truck(TRUCK, start()), truck(SECOND, Pose::new(10.0, 10.0, 0.0))],
            ..sample::small_setting(&[])
        }
    }

    fn run(events: Vec<Event>) -> Verdict {
        audit_timeline(&Timeline { setting: setting(), events, ground: Vec::new() }, SampleStep::default())
    }

    /// To a place south of the bush in 3 s, 5 s beside it, a drive that is dropped under way, another one.
    fn proper_run() -> Vec<Event> {
        let there = drive(1.0, start(), &[24.0]);
        let away = drive(9.0, there.end(), &[-16.0]);
        let cut = away.stopping(seconds(10.0), &SpeedLimits { braking_mps2: None, ..LIMITS });
        let on = drive(10.0, cut.end(), &[4.0, -6.0]);
        vec![
            ignited(0.5, NEAR, Cause::Scheduled),
            planned(0.5, there),
            extinguished(9.0),
            planned(9.0, away),
            dropped(10.0, cut),
            planned(10.0, on),
        ]
    }

    fn violation(events: Vec<Event>) -> Violation {
        run(events).violation.expect("the damage is planted")
    }

    fn kind(events: Vec<Event>) -> ViolationKind {
        violation(events).kind
    }

    #[test]
    fn a_proper_run_passes_and_all_of_it_is_looked_at() {
        let verdict = run(proper_run());
        assert_eq!(verdict.violation, None);
        assert_eq!((verdict.audited.legs, verdict.audited.extinctions), (3, 1));
        assert!((verdict.audited.metres - (24.0 + 8.0 + 10.0)).abs() < 1e-6);
        assert!(verdict.knows_limits);
    }

    #[test]
    fn a_leg_that_begins_elsewhere_is_found() {
        let mut events = proper_run();
        let moved = Pose { y: start().y - 0.001, ..start() };
        events[1] = planned(0.5, drive(1.0, moved, &[24.0]));
        assert!(matches!(kind(events), ViolationKind::Discontinuous { .. }));
        let turned = Pose { heading: 0.001, ..start() };
        assert!(matches!(kind(vec![planned(0.5, drive(1.0, turned, &[24.0]))]), ViolationKind::Discontinuous { .. }));
    }

    #[test]
    fn a_leg_that_begins_too_early_is_found() {
        let mut events = proper_run();
        events.remove(4);
        assert!(matches!(kind(events), ViolationKind::StillUnderWay { .. }));
    }

    #[test]
    fn driving_on_past_a_cut_is_found() {
        let there = drive(1.0, start(), &[24.0]);
        let mut events = proper_run();
        events[5] = planned(10.0, drive(10.0, drive(9.0, there.end(), &[-8.5]).end(), &[4.0, -6.0]));
        assert!(matches!(kind(events), ViolationKind::Discontinuous { metres, .. } if (metres - 0.5).abs() < 1e-6));
    }

    #[test]
    fn a_cut_leg_that_is_not_the_planned_one_is_found() {
        let there = drive(1.0, start(), &[24.0]);
        let mut events = proper_run();
        events[4] = dropped(10.0, drive(9.0, there.end(), &[-7.9]));
        assert_eq!(kind(events), ViolationKind::CutDiffers);
        let bend = Segment { curvature: -1.0 / 13.0, length_m: -4.0 };
        let path = Path { start: there.end(), segments: vec![Segment { curvature: 0.0, length_m: -8.0 }, bend] };
        let mut events = proper_run();
        events[4] = dropped(10.0, Trajectory::from_path(&path, seconds(9.0), LIMITS));
        assert_eq!(kind(events), ViolationKind::CutDiffers, "it leaves the planned way after it was dropped");
    }

    #[test]
    fn a_fire_that_goes_out_too_early_is_found() {
        for time_s in [8.999_999_999, 3.0] {
            let mut events = proper_run();
            events[2] = extinguished(time_s);
            assert!(matches!(kind(events), ViolationKind::NotStanding { cell: NEAR, .. }));
        }
    }

    #[test]
    fn a_fire_that_goes_out_too_far_away_is_found() {
        let violation = violation(vec![ignited(1.0, NEAR, Cause::Scheduled), extinguished(50.0)]);
        assert!(matches!(violation.kind, ViolationKind::OutOfReach { cell: NEAR, .. }));
        let message = violation.to_string();
        assert!(
            message.starts_with("at 50.000 s, (20.000, 46.000) m: unimog/0: the fire at cell (10, 10)"),
            "{message}"
        );
    }

    #[test]
    fn ten_metres_are_within_reach_and_ten_centimetres_more_are_not() {
        for (metres, is_within) in [(10.0, true), (10.1, false)] {
            let events = vec![ignited(1.0, NEAR, Cause::Scheduled), extinguished(50.0)];
            let mut timeline = Timeline { setting: setting(), events, ground: Vec::new() };
            // The body's centre is 1.5 m ahead of the rear axle, west of the bush's centre.
            timeline.setting.agents[0].pose = Pose::new(52.5 - metres - 1.5, 52.5, 0.0);
            let violation = audit_timeline(&timeline, SampleStep::default()).violation;
            assert_eq!(violation.is_none(), is_within, "{violation:?}");
            let message = violation.map(|violation| violation.to_string()).unwrap_or_default();
            assert_eq!(message.contains("goes out 10.100 m away, beyond the reach of 10 m"), !is_within, "{message}");
        }
    }

    #[test]
    fn one_dwell_puts_out_one_fire() {
        let mut timeline = Timeline { setting: setting(), events: proper_run(), ground: Vec::new() };
        let beside = Cell { col: 9, row: 10 };
        timeline.setting.bushes.insert(0, beside);
        timeline.events.insert(1, ignited(0.5, beside, Cause::Scheduled));
        for (time_s, is_second) in [(9.0, true), (9.5, false)] {
            let mut timeline = timeline.clone();
            timeline.events.insert(4, at(time_s, Fact::Fire(FireFact::Extinguished { cell: beside, by: TRUCK })));
            timeline.events.truncate(5);
            let kind =
                audit_timeline(&timeline, SampleStep::default()).violation.expect("it stood five seconds only").kind;
            assert_eq!(kind == ViolationKind::SecondFire { cell: beside }, is_second, "{kind:?}");
            assert_eq!(matches!(kind, ViolationKind::NotStanding { since, .. } if since == seconds(9.0)), !is_second);
            timeline.setting.rules.extinguishes_all = Some(true);
            assert_eq!(audit_timeline(&timeline, SampleStep::default()).violation.is_none(), is_second);
        }
    }

    #[test]
    fn only_what_burns_goes_out() {
        let mut events = proper_run();
        events.remove(0);
        assert_eq!(kind(events), ViolationKind::NotBurning { cell: NEAR });
        let twice = vec![ignited(0.0, NEAR, Cause::Scheduled), ignited(1.0, NEAR, Cause::Scheduled)];
        assert_eq!(kind(twice), ViolationKind::CannotBurn { cell: NEAR });
        let again = vec![ignited(0.0, NEAR, Cause::Scheduled), burned_out(60.0, NEAR), burned_out(61.0, NEAR)];
        assert_eq!(kind(again), ViolationKind::NotBurning { cell: NEAR });
    }

    #[test]
    fn fires_burn_out_at_their_time() {
        let ignition = ignited(0.0, NEAR, Cause::Scheduled);
        assert_eq!(run(vec![ignition.clone(), burned_out(60.0, NEAR)]).violation, None);
        let due = Some(seconds(60.0));
        assert_eq!(
            kind(vec![ignition.clone(), burned_out(59.0, NEAR)]),
            ViolationKind::WrongBurnOut { cell: NEAR, due }
        );
        let forgotten = violation(vec![ignition]);
        assert_eq!((forgotten.kind, forgotten.time), (ViolationKind::WrongBurnOut { cell: NEAR, due }, seconds(60.0)));
        assert_eq!(run(vec![ignited(40.0, NEAR, Cause::Scheduled), burned_out(100.0, NEAR)]).violation, None);
        assert!(run(vec![ignited(40.0, NEAR, Cause::Scheduled)]).violation.is_some(), "what is due at the end happens");
    }

    #[test]
    fn fire_spreads_when_and_as_far_as_it_does() {
        let spread = |time_s| ignited(time_s, FAR, Cause::Spread(NEAR));
        let ignition = || ignited(50.0, NEAR, Cause::Scheduled);
        let too_far = kind(vec![ignition(), spread(60.0)]);
        assert!(matches!(too_far, ViolationKind::TooFarToSpread { metres: 40.0, .. }), "{too_far:?}");
        assert_eq!(kind(vec![ignition(), spread(59.0)]), ViolationKind::NoSource { cell: FAR, from: NEAR });
        assert_eq!(kind(vec![spread(60.0)]), ViolationKind::NoSource { cell: FAR, from: NEAR });
        let mut wide = Timeline { setting: setting(), events: vec![ignition()], ground: Vec::new() };
        wide.setting.rules.fire.as_mut().expect("it is set").spread_radius_m = 40.1;
        let spared = audit_timeline(&wide, SampleStep::default()).violation.expect("it should have caught fire");
        assert_eq!(
            (spared.kind, spared.time),
            (ViolationKind::SparedBySpread { cell: FAR, from: NEAR }, seconds(60.0))
        );
        wide.events.push(spread(60.0));
        assert_eq!(audit_timeline(&wide, SampleStep::default()).violation, None);
    }

    #[test]
    fn pieces_burn_and_go_out_as_a_whole() {
        let of_pieces = |events| {
            let setting = Setting { pieces: vec![7, 7], ..setting() };
            audit_timeline(&Timeline { setting, events, ground: Vec::new() }, SampleStep::default()).violation
        };
        let scheduled = |time_s, cell| ignited(time_s, cell, Cause::Scheduled);
        let both = vec![scheduled(1.0, NEAR), scheduled(1.0, FAR), burned_out(61.0, NEAR), burned_out(61.0, FAR)];
        assert_eq!(of_pieces(both.clone()), None);
        let torn = of_pieces(vec![scheduled(1.0, NEAR), scheduled(2.0, FAR)]).expect("the other bush burns later");
        assert_eq!((torn.kind, torn.time), (ViolationKind::TornPiece { cell: FAR }, seconds(1.0)));
        // FAR is out of the truck's reach, but it goes out with NEAR.
        let mut stop = proper_run();
        stop.insert(1, scheduled(0.5, FAR));
        stop.insert(4, at(9.0, Fact::Fire(FireFact::Extinguished { cell: FAR, by: TRUCK })));
        assert_eq!(of_pieces(stop.clone()), None);
        stop.remove(4);
        let left = of_pieces(stop).expect("half of the piece burns on");
        assert_eq!(left.kind, ViolationKind::TornPiece { cell: FAR });
    }

    #[test]
    fn without_rules_of_fire_its_times_are_free() {
        let events = vec![ignited(1.0, NEAR, Cause::Scheduled), ignited(2.0, FAR, Cause::Spread(NEAR))];
        let mut timeline = Timeline { setting: setting(), events, ground: Vec::new() };
        timeline.setting.rules.fire = None;
        let verdict = audit_timeline(&timeline, SampleStep::default());
        assert_eq!((verdict.violation, verdict.knows_limits), (None, false));
    }

    #[test]
    fn trucks_light_nothing() {
        assert_eq!(kind(vec![ignited(1.0, NEAR, Cause::Agent(TRUCK))]), ViolationKind::WrongAgent);
    }

    #[test]
    fn the_last_leg_is_looked_at_too() {
        let mut events = proper_run();
        let Fact::Agent(_, AgentFact::Planned { trajectory, .. }) = &events[5].fact else {
            panic!("the run ends with a leg")
        };
        events[5] = planned(10.0, drive(10.0, trajectory.start(), &[70.0]));
        assert!(violation(events).to_string().contains("outside of the field"));
    }

    #[test]
    fn an_unknown_truck_is_found() {
        let fire = ignited(0.0, NEAR, Cause::Scheduled);
        let by = AgentId::unimog(7);
        assert_eq!(
            kind(vec![fire, at(1.0, Fact::Fire(FireFact::Extinguished { cell: NEAR, by }))]),
            ViolationKind::WrongAgent
        );
    }

    #[test]
    fn trucks_that_meet_are_found_when_they_do() {
        let past = |offset_m: f64| {
            let mut timeline = Timeline {
                setting: setting(),
                events: vec![planned(0.0, drive(2.0, start(), &[24.0]))],
                ground: Vec::new(),
            };
            timeline.setting.agents[1].pose = Pose::new(44.0, 46.0 + offset_m, 1.57);
            audit_timeline(&timeline, SampleStep::default()).violation
        };
        assert_eq!(past(-1.1 - 3.95 - 0.01), None, "it passes a centimetre away");
        let met = past(-1.1 - 3.95 + 0.02).expect("two centimetres are an overlap");
        assert!(matches!(met.kind, ViolationKind::Overlap { other: SECOND, .. }), "{met}");
        // The other truck's side is 1.1 m west of its axle; the bumper is 3.95 m ahead of this one's.
        let expected_s = 2.0 + (24.0 - 1.1 - 3.95) / 8.0;
        assert!((met.time.as_seconds() - expected_s).abs() < 0.005, "{met}");
    }

    #[test]
    fn trucks_that_start_on_one_place_overlap() {
        let mut setting = setting();
        setting.agents[1].pose = Pose::new(21.0, 46.0, 3.0);
        let violation =
            audit_timeline(&Timeline { setting, events: Vec::new(), ground: Vec::new() }, SampleStep::default())
                .violation;
        assert!(violation.is_some_and(|violation| violation.time == SimTime::ZERO));
    }
}
