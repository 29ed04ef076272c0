//! Line that crews build: fire ends there, and the audit finds what is forged by code of its own.

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::geometry::Cell;
use wildfire::scenario;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{GroundEvent, GroundFact, Outcome, Timeline, file};

fn run(changes: &[&str], seed: u64) -> Timeline {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    sim::run(&scenario::load("line", &changes).expect("it is right"), seed).expect("it takes place").timeline
}

fn burned(timeline: &Timeline) -> usize {
    timeline.ground.iter().filter(|event| matches!(event.fact, GroundFact::Ignited(_))).count()
}

fn is_cleared(event: &GroundEvent) -> bool {
    matches!(event.fact, GroundFact::Cleared { .. })
}

#[test]
fn a_line_that_closes_contains_the_fire_and_none_changes_nothing() {
    let free = run(&["crew.0.count=0"], 1);
    for changes in ["line.policy=parallel", "line.from=rear", "crew.0.count=9"] {
        let fought = run(&["line.holds=always", changes], 1);
        assert!(4 * burned(&fought) < burned(&free), "{changes:?}: {} of {}", burned(&fought), burned(&free));
        assert!(fought.end_time() < free.end_time(), "nothing is left to burn");
    }
    assert_eq!(run(&["crew.0.rate_m_h=0"], 1).ground, free.ground);
    let is_wrong = |change: &str| scenario::load("line", &[change.to_owned()]).is_err();
    assert!(["fire.model=radius", "crew.0.rate_by_fuel.GR22=3", "crew.0.speed_mps=0"].into_iter().all(is_wrong));
    assert!(["line.policy=point-protection", "line.protect=[{x_m=9,y_m=9,radius_m=9}]"].into_iter().all(is_wrong));
}

#[test]
fn audits_and_recordings_know_line_and_chance_is_the_same_in_every_run() {
    let places =
        "line.protect=[{x_m=500,y_m=400,radius_m=30},{x_m=250,y_m=250,radius_m=25},{x_m=590,y_m=590,radius_m=20}]";
    let changes: [&[&str]; 5] = [
        &["line.policy=parallel", "line.flame_half_m=0.6"],
        &["line.from=head", "crew.0.count=9", "fire.rothermel.neighbours=8"],
        &["crew.0.count=6", "line.flame_half_m=0.8", "fire.rothermel.slope_deg=15"],
        &["line.policy=parallel", "fire.embers.per_mj=0.01", "wind.0.speed_mps=6", "duration_s=4000"],
        &["line.policy=point-protection", places, "line.flame_half_m=0.8", "crew.0.count=12"],
    ];
    for (changes, seed) in changes.into_iter().zip(1..) {
        let timeline = run(changes, seed);
        assert_eq!(audit_timeline(&timeline, SampleStep::default()).violation, None, "{changes:?}");
        let line = Outcome::new(&timeline).ground.and_then(|ground| ground.line).expect("there are crews");
        assert!(line.built_m > 100.0 && line.lost_m < line.built_m, "{changes:?}: {line:?}");
        assert!(file::decode(&file::encode(&timeline).expect("it is kept")).expect("and read") == timeline);
        assert!(run(changes, seed) == timeline, "{changes:?}");
    }
}

#[test]
fn forged_line_is_found() {
    let timeline = run(&["line.policy=parallel", "line.flame_half_m=0.6"], 1);
    let is_found = |forge: &dyn Fn(&mut Timeline)| {
        let mut timeline = timeline.clone();
        forge(&mut timeline);
        timeline.ground.sort_by_key(|event| event.time);
        audit_timeline(&timeline, SampleStep::default()).violation.is_some()
    };
    let each = |timeline: &mut Timeline, forge: &dyn Fn(&mut SimTime, &mut u8, &mut u32, &mut bool)| {
        for GroundEvent { time, fact, .. } in &mut timeline.ground {
            if let GroundFact::Cleared { flank, along_mm, holds } = fact {
                forge(time, flank, along_mm, holds);
            }
        }
    };
    assert!(!is_found(&|_| ()));
    assert!(is_found(&|run| each(run, &|time, _, _, _| *time = SimTime::from_seconds(0.9 * time.as_seconds()))));
    assert!(is_found(&|run| each(run, &|_, _, along_mm, _| *along_mm += *along_mm / 4)));
    assert!(is_found(&|run| each(run, &|_, flank, _, _| *flank = 2)));
    assert!(is_found(&|run| run.ground.retain(|event| !is_cleared(event))), "fire stops without line");
    assert!(is_found(&|run| each(run, &|_, _, _, holds| *holds = true)), "fire crosses what holds");
    assert!(is_found(&|run| run.setting.line = None), "there are no crews");
    let cell = Cell { col: 118, row: 2 };
    assert!(is_found(&|run| run
        .ground
        .iter_mut()
        .filter(|event| is_cleared(event))
        .for_each(|event| event.cell = cell)));
}
