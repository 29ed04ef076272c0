//! Line that crews build: fire ends there, and the audit finds what is forged by code of its own.

use wildfire::audit::{SampleStep, audit_timeline};
use wildfire::geometry::{Cell, DVec2};
use wildfire::planning::MakeError;
use wildfire::scenario;
use wildfire::sim::policies::{Action, FirelineContext, Observation, Policies, Policy, PolicyContext};
use wildfire::sim::{self, CustomRegistry};
use wildfire::time::SimTime;
use wildfire::timeline::{AgentId, GroundEvent, GroundFact, Outcome, Timeline, file};

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
    let places = "line.protect=[{x_m=500,y_m=400,radius_m=30},{x_m=250,y_m=250,radius_m=25}]";
    let changes: [&[&str]; 5] = [
        &["line.policy=parallel", "line.flame_half_m=0.1", "line.flame_scale_m=0.1"],
        &["line.from=head", "crew.0.count=9", "fire.rothermel.neighbours=8"],
        &["crew.0.count=6", "line.flame_half_m=0.2", "line.flame_scale_m=0.1", "fire.rothermel.slope_deg=15"],
        &["line.policy=parallel", "fire.embers.per_mj=0.01", "wind.0.speed_mps=6", "duration_s=4000"],
        &["line.policy=point-protection", places, "line.flame_half_m=0.2", "line.flame_scale_m=0.1", "crew.0.count=12"],
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
    let timeline = run(&["line.policy=parallel", "line.flame_half_m=0.1", "line.flame_scale_m=0.1"], 1);
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

#[test]
fn places_are_protected_in_the_order_in_which_the_fire_comes_and_others_are_left() {
    let places = [(560.0, 530.0), (380.0, 330.0), (20.0, 580.0)].map(|(x_m, y_m)| DVec2::new(x_m, y_m));
    let entries = places.map(|place| format!("{{x_m={},y_m={},radius_m=40}}", place.x, place.y)).join(",");
    let policy = ["line.policy=point-protection", "line.holds=always", &format!("line.protect=[{entries}]")];
    let burned_at = |timeline: &Timeline, place: DVec2| {
        let near = |event: &&GroundEvent| (timeline.setting.frame.centre(event.cell) - place).length() < 35.0;
        timeline.ground.iter().filter(near).filter(|event| !is_cleared(event)).count()
    };
    let flanks = |timeline: &Timeline| -> Vec<u8> {
        let flank = |event: &GroundEvent| match event.fact {
            GroundFact::Cleared { flank, .. } => Some(flank),
            _ => None,
        };
        timeline.ground.iter().filter_map(flank).collect()
    };
    let free = run(&["crew.0.count=0"], 1);
    assert_eq!(places.map(|place| burned_at(&free, place) > 0), [true, true, false]);
    let fought = run(&[&policy[..], &["crew.0.count=12"]].concat(), 1);
    assert_eq!(places.map(|place| burned_at(&fought, place)), [0; 3]);
    let built = flanks(&fought);
    let [second, end] = [built.iter().position(|&flank| flank > 1), built.iter().rposition(|&flank| flank < 2)];
    assert!(second > end && end > Some(50) && built.iter().max() == Some(&3), "{built:?}");
    let late = flanks(&run(&[&policy[..], &["crew.0.at_s=9000"]].concat(), 1));
    assert!(!late.is_empty() && late.iter().all(|&flank| flank > 1), "fire is at the first place: {late:?}");
}

#[test]
fn crews_that_are_ready_before_the_fire_build_line_too() {
    let early = run(&["crew.0.at_s=0", "crew.0.count=12", "line.holds=always"], 1);
    assert!(early.ground.iter().filter(|event| is_cleared(event)).count() > 10);
    assert_eq!(audit_timeline(&early, SampleStep::default()).violation, None);
    let free = run(&["crew.0.count=0"], 1);
    assert!(10 * burned(&early) < burned(&free), "{} of {}", burned(&early), burned(&free));
}

/// Lets crews build through points, as a custom policy answers.
struct Through(Vec<DVec2>);

impl Policy for Through {
    fn choose(&mut self, _: &Observation<'_>, _: &[AgentId]) -> Vec<(AgentId, Action)> {
        Vec::new()
    }

    fn line(&mut self, seen: &Observation<'_>, line: &FirelineContext<'_>) -> Vec<DVec2> {
        let burned = seen.fires.with_fuel().filter(|&cell| seen.fires.ignited_at(cell).is_some()).count();
        let by_now = line.forecast.seconds.iter().filter(|&&time_s| time_s <= seen.now.as_seconds()).count();
        assert!(burned > 10 && by_now == burned);
        assert!(seen.now.as_seconds() == 900.0 && line.crews[0].rate_m_h == 274.3 && line.wind_mps.x > 2.0);
        self.0.clone()
    }
}

#[test]
fn a_custom_policy_encloses_the_fire_between_line_and_a_road_and_no_line_is_a_bad_answer() {
    let changes = ["line.policy=own", "policy.own.command=[]", "line.holds=always", "crew.0.count=30"];
    let road = "landscape.roads=[{width_m=15,points_m=[[100,0],[100,600]]}]";
    let changes: Vec<String> = changes.into_iter().chain([road]).map(str::to_owned).collect();
    let scenario = scenario::load("line", &changes).expect("it is right");
    let run = |points: &[(f64, f64)]| {
        let points: Vec<DVec2> = points.iter().map(|&(x_m, y_m)| DVec2::new(x_m, y_m)).collect();
        let maker = move |_: &PolicyContext<'_>| -> Result<Box<dyn Policy>, MakeError> {
            Ok(Box::new(Through(points.clone())))
        };
        let policies = Policies::default().with("own", maker).expect("it is free");
        sim::run_with_options(&scenario, 1, &CustomRegistry::from(policies).into()).expect("it takes place")
    };
    let fought = run(&[(97.0, 130.0), (330.0, 130.0), (330.0, 400.0), (60.0, 400.0)]).timeline;
    let within = |place: DVec2| place.x > 100.0 && place.x < 330.0 && place.y > 130.0 && place.y < 400.0;
    let mut ground = fought.ground.iter().filter(|event| !is_cleared(event));
    assert!(ground.all(|event| within(fought.setting.frame.centre(event.cell))) && burned(&fought) > 300);
    assert_eq!(audit_timeline(&fought, SampleStep::default()).violation, None);
    let mut hasty = fought.clone();
    let built = hasty.ground.iter_mut().filter(|event| is_cleared(event));
    built.for_each(|event| event.time = SimTime::from_seconds(0.95 * event.time.as_seconds()));
    hasty.ground.sort_by_key(|event| event.time);
    assert!(audit_timeline(&hasty, SampleStep::default()).violation.is_some(), "nobody builds so fast");
    let last = fought.ground.iter().rfind(|event| is_cleared(event)).expect("line was built");
    assert!((100.0..115.0).contains(&fought.setting.frame.centre(last.cell).x), "it ends at the road: {last:?}");
    for (points, fragment) in [
        (&[][..], "no line of 0 points can be built"),
        (&[(1.0, f64::NAN), (2.0, 2.0)], "(1, NaN) is not on the field"),
        (&[(1.0, 1.0), (2.0, 601.0)], "(2, 601) is not on the field of 600 x 600 m"),
        (&[(5.0, 5.0); 10_001], "expected 2 to 10000"),
    ] {
        let idle = run(points);
        let asks = idle.asks.expect("it was asked");
        assert!((asks.asked, asks.bad_answer) == (1, 1) && !idle.timeline.ground.iter().any(is_cleared));
        assert!(idle.messages.to_string().contains(fragment), "{}", idle.messages);
    }
}
