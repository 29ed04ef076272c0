//! Ground that slows trucks: the roads of a landscape, and when trucks are ready.

use wildfire::audit::{SampleStep, ViolationKind, audit_timeline};
use wildfire::scenario;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{AgentFact, Fact, Outcome, Timeline, file};

fn run(changes: &[&str], seed: u64) -> Timeline {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let scenario = scenario::load("initial-attack", &changes).expect("it is right");
    sim::run(&scenario, seed).expect("it takes place").timeline
}

/// The seconds and metres of the first drive to a fire.
fn first_drive(timeline: &Timeline) -> (SimTime, f64, f64) {
    let mut drives = timeline.events.iter().filter_map(|event| match &event.fact {
        Fact::Agent(_, AgentFact::Planned { trajectory, .. }) => Some((event.time, trajectory)),
        _ => None,
    });
    let (time, leg) = drives.next().expect("a truck drives");
    (time, leg.duration_s(), leg.distance_m(SimTime::MAX))
}

#[test]
fn trucks_keep_to_the_speed_of_the_ground_and_recordings_say_it() {
    for seed in 1..4 {
        let timeline = run(&["duration_s=3600"], seed);
        let audit = |timeline: &Timeline| audit_timeline(timeline, SampleStep::default()).violation;
        assert_eq!(audit(&timeline), None, "seed {seed}");
        let bytes = file::encode(&timeline).expect("it can be recorded");
        let read = file::decode(&bytes).expect("and read");
        assert!(read == timeline, "seed {seed}");
        // The same drives are too fast where the ground is slower.
        let mut slower = read;
        slower.setting.ground_shares.iter_mut().for_each(|(_, shares)| shares.iter_mut().for_each(|it| *it *= 0.9));
        let violation = audit(&slower).expect("they are too fast now");
        assert!(matches!(violation.kind, ViolationKind::Speed { .. }), "{violation}");
        assert_eq!(Outcome::new(&timeline).truck_stuck_s, 0.0, "seed {seed}");
    }
}

#[test]
fn trucks_set_out_when_they_are_ready_and_planning_for_roads_gets_them_there_sooner() {
    let (mut by_road_s, mut straight_s) = (0.0, 0.0);
    for seed in 1..7 {
        // Fires far from the station tell.
        let (set_out, drive_s, _) = first_drive(&run(&["duration_s=1200"], seed));
        assert_eq!(set_out, SimTime::from_seconds(300.0), "seed {seed}");
        by_road_s += drive_s;
        let (_, drive_s, _) = first_drive(&run(&["duration_s=1200", "unimog.planner=hybrid-astar"], seed));
        straight_s += drive_s;
    }
    assert!(by_road_s < 0.8 * straight_s, "{by_road_s} s by road, {straight_s} s straight");
}

#[test]
fn ground_that_does_not_exist_is_refused() {
    for (change, fragment) in [
        ("unimog.speed_by_ground={ GR22 = 0.5 }", "speed_by_ground.GR22"),
        ("unimog.speed_by_ground={ other = 1.5 }", "speed_by_ground.other"),
        ("unimog.speed_by_ground={ other = 0 }", "speed_by_ground.other"),
    ] {
        let error = scenario::load("initial-attack", &[change.to_owned()]).expect_err("this is wrong").to_string();
        assert!(error.contains(fragment), "{change}: {error}");
    }
}
