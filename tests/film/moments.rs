//! Laws of films: what is derived from a timeline once agrees with the timeline at any time, parts of a frame have room,
//! and its chart tells the time.

use std::time::Duration;

use rand::RngExt;
use wildfire::fire::BushStateKind;
use wildfire::picture::bush_colour;
use wildfire::picture::film::{FrameLayout, FramePart, FrameRequest, PixelRect, RunView, ViewOptions, still};
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::time::SimTime;
use wildfire::timeline::{Activity, AgentId, CpuSample, Fact, FireFact, Outcome, Timeline};

/// Ten minutes of trucks and Wumpuses on a field where bushes burn again.
fn timeline(seed: u64) -> Timeline {
    let changes = ["duration_s=600", "fire.relight=true", "fire.burn_out_s=40"];
    let scenario = wildfire::scenario::load("fleet", &changes.map(String::from)).expect("the built-in loads");
    wildfire::sim::run(&scenario, seed).expect("it runs").timeline
}

fn empty() -> Timeline {
    let changes = ["wumpus=[]", "unimog=[]", "field.coverage=0"];
    let scenario = wildfire::scenario::load("contest", &changes.map(String::from)).expect("the built-in loads");
    wildfire::sim::run(&scenario, 1).expect("it runs").timeline
}

fn rng(name: &str) -> Xoshiro256PlusPlus {
    rng::stream(1, name)
}

/// Times of facts, times just before them, and any others, some of them after the end.
fn times(timeline: &Timeline, count: usize) -> Vec<SimTime> {
    let mut rng = rng("tests/film/times");
    let mut time = || {
        let fact = timeline.events[rng.random_range(0..timeline.events.len())].time.as_nanos();
        let anywhere = rng.random_range(0..=timeline.end_time().as_nanos() * 11 / 10);
        SimTime::from_nanos([fact, fact.saturating_sub(1), anywhere][rng.random_range(0..3)])
    };
    (0..count).map(|_| time()).collect()
}

#[test]
fn states_of_a_film_are_those_of_its_timeline() {
    for seed in 1..4 {
        let run = RunView::new(timeline(seed), None);
        for time in times(run.timeline(), 300) {
            assert_eq!(run.state_at(time), run.timeline().state_at(time), "at {time}");
        }
    }
}

#[test]
fn counts_are_those_of_the_state() {
    let run = RunView::new(timeline(1), None);
    for time in times(run.timeline(), 300) {
        let (counts, state) = (run.counts_at(time), run.timeline().state_at(time));
        for kind in BushStateKind::ALL {
            let count = state.bushes.iter().filter(|&&bush| bush.kind() == kind).count();
            assert_eq!(counts.count(kind) as usize, count, "{kind:?} at {time}");
        }
    }
}

#[test]
fn in_the_end_a_film_tells_the_outcome() {
    let run = RunView::new(timeline(2), None);
    let (timeline, outcome) = (run.timeline(), Outcome::new(run.timeline()));
    let counts = run.counts_at(timeline.end_time());
    let rules = &timeline.setting.rules;
    assert_eq!((counts.wumpus_score(rules), counts.truck_score(rules)), (outcome.wumpus_score, outcome.truck_score));
    assert_eq!(counts.burned(), outcome.burned());
    assert!(outcome.wumpus_score > 0.0 && outcome.truck_score > 0.0, "something happened");
    for (index, agent) in outcome.agents.iter().enumerate() {
        let stats = run.stats_at(index, SimTime::MAX);
        assert_eq!((stats.plans, stats.cells), (agent.plans, agent.cells));
        assert_eq!(stats.failures, agent.failures.sum());
        assert_eq!(stats.expansions, agent.roadmap_expansions + agent.local_expansions);
        assert!((stats.distance_m - agent.distance_m).abs() < 1e-6, "{} m, {} m", stats.distance_m, agent.distance_m);
        assert_eq!(stats.spent(Activity::Driving).as_seconds(), agent.driving_s);
        assert_eq!(stats.spent(Activity::Planning).as_seconds(), agent.planning_s);
        assert_eq!(stats.spent(Activity::Suppressing).as_seconds(), agent.suppressing_s);
        assert_eq!(stats.spent(Activity::Standing).as_seconds(), agent.standing_s);
        assert_eq!(stats.spent(Activity::Waiting).as_seconds(), agent.waiting_s);
    }
}

#[test]
fn what_an_agent_did_grows_and_its_time_passes() {
    let run = RunView::new(timeline(3), None);
    let mut times = times(run.timeline(), 100);
    times.sort_unstable();
    for agent in 0..run.timeline().setting.agents.len() {
        let mut before = run.stats_at(agent, SimTime::ZERO);
        for &time in &times {
            let stats = run.stats_at(agent, time);
            let activities =
                [Activity::Standing, Activity::Planning, Activity::Driving, Activity::Suppressing, Activity::Waiting];
            let spent: u64 = activities.iter().map(|&activity| stats.spent(activity).as_nanos()).sum();
            assert_eq!(spent, time.min(run.timeline().end_time()).as_nanos());
            assert!(stats.plans >= before.plans && stats.distance_m >= before.distance_m - 1e-9);
            before = stats;
        }
    }
}

#[test]
fn the_story_of_a_bush_is_all_that_happened_to_it() {
    let run = RunView::new(timeline(1), None);
    let timeline = run.timeline();
    let mut changes = 0;
    for (bush, &cell) in timeline.setting.bushes.iter().enumerate() {
        for event in run.changes_of(bush) {
            assert!(timeline.events.iter().any(|other| std::ptr::eq(other, event)));
            assert_eq!(event.fact.cell(), Some(cell));
            changes += 1;
        }
        assert!(run.changes_of(bush).is_sorted_by_key(|event| event.time));
    }
    let is_change = |fact: &Fact| {
        matches!(
            fact,
            Fact::Fire(FireFact::Ignited { .. })
                | Fact::Fire(FireFact::BurnedOut { .. })
                | Fact::Fire(FireFact::Extinguished { .. })
        )
    };
    assert_eq!(changes, timeline.events.iter().filter(|event| is_change(&event.fact)).count());
}

#[test]
fn stepping_meets_every_event_once_forth_and_back() {
    let run = RunView::new(timeline(1), None);
    let mut expected: Vec<SimTime> = run.timeline().events.iter().map(|event| event.time).collect();
    expected.dedup();
    assert_eq!(expected[0], SimTime::ZERO);
    let forth: Vec<_> = std::iter::successors(Some(SimTime::ZERO), |&time| run.index().next_event(time)).collect();
    assert_eq!(forth, expected);
    let mut back: Vec<_> =
        std::iter::successors(run.index().previous_event(SimTime::MAX), |&time| run.index().previous_event(time))
            .collect();
    back.reverse();
    assert_eq!(back, expected);
}

#[test]
fn cpu_time_until_a_time_is_the_sum_of_what_was_spent() {
    let mut rng = rng("tests/film/spending");
    let agents = [AgentId::wumpus(0), AgentId::unimog(0), AgentId::unimog(3)];
    let mut cpu_samples: Vec<CpuSample> = (0..200)
        .map(|_| CpuSample {
            time: SimTime::from_nanos(rng.random_range(0..50)),
            agent: agents[rng.random_range(0..3)],
            cpu: Duration::from_micros(rng.random_range(0..1000)),
        })
        .collect();
    cpu_samples.sort_by_key(|spent| spent.time);
    let run = RunView::new(empty(), Some(cpu_samples.clone()));
    for time in (0..60).map(SimTime::from_nanos) {
        let sum = |of: Option<AgentId>| {
            let spent =
                cpu_samples.iter().filter(|spent| spent.time <= time && of.is_none_or(|agent| spent.agent == agent));
            spent.map(|spent| spent.cpu).sum::<Duration>()
        };
        assert_eq!(run.cpu_until(time), Some(sum(None)));
        for agent in agents {
            assert_eq!(run.cpu_of_agent_until(agent, time), Some(sum(Some(agent))));
        }
    }
    assert_eq!(RunView::new(empty(), None).cpu_until(SimTime::MAX), None);
}

fn sizes() -> impl Iterator<Item = (u32, u32)> {
    let mut rng = rng("tests/film/sizes");
    let mut side = move |min: u32| match rng.random_range(0..4) {
        0 => min,
        1 => FrameLayout::MAX_SIDE,
        2 => rng.random_range(min..=1500),
        _ => rng.random_range(min..=FrameLayout::MAX_SIDE),
    };
    (0..2000).map(move |_| (side(FrameLayout::MIN_WIDTH), side(FrameLayout::MIN_HEIGHT)))
}

fn overlap(one: &PixelRect, other: &PixelRect) -> bool {
    one.left < other.right() && other.left < one.right() && one.top < other.bottom() && other.top < one.bottom()
}

#[test]
fn parts_of_a_frame_have_room_on_sheets_of_every_size() {
    for ((width, height), runs) in sizes().zip([1, 2].into_iter().cycle()) {
        let layout = FrameLayout::new((width, height), runs);
        let parts: Vec<PixelRect> = layout.fields.iter().copied().chain(layout.panel).chain([layout.chart]).collect();
        assert_eq!(layout.fields.len(), runs);
        for (index, part) in parts.iter().enumerate() {
            assert!(part.right() <= width && part.bottom() <= height, "{part:?} of {width} x {height}");
            assert!(parts[..index].iter().all(|other| !overlap(part, other)), "{layout:?}");
        }
        let area: u64 = parts.iter().map(|part| u64::from(part.width) * u64::from(part.height)).sum();
        assert_eq!(area, u64::from(width) * u64::from(height), "nothing is left over of {width} x {height}");
        assert!(layout.fields.iter().all(|pane| pane.width >= 100 && pane.height >= 100), "{layout:?}");
        assert!(layout.timeline.left > layout.chart.left && layout.timeline.right() < layout.chart.right());
    }
}

#[test]
fn places_on_the_timeline_are_times_and_back() {
    for (size, runs) in sizes().take(200).zip([1, 2].into_iter().cycle()) {
        let layout = FrameLayout::new(size, runs);
        let y = f64::from(layout.chart.top + layout.chart.height / 2);
        for share in [0.0, 0.1, 0.5, 0.999, 1.0] {
            let FramePart::Timeline { share: found } = layout.place_at((layout.timeline_x(share), y)) else {
                panic!("no timeline at {share} of {layout:?}");
            };
            assert!((found - share).abs() < 1e-9, "{found} for {share}");
        }
        assert_eq!(layout.place_at((0.0, y)), FramePart::Timeline { share: 0.0 });
        assert_eq!(layout.place_at((f64::from(layout.width) - 0.5, y)), FramePart::Timeline { share: 1.0 });
        for (run_index, pane) in layout.fields.iter().enumerate() {
            let at = (f64::from(pane.left) + 2.5, f64::from(pane.top) + 7.0);
            assert_eq!(layout.place_at(at), FramePart::Field { run_index, at: (2.5, 7.0) });
        }
    }
}

/// The colours of a still in the chart, in the middle of the upper half of its first area.
fn is_state_shown(run: &RunView, time: SimTime, kind: BushStateKind) -> bool {
    let options = ViewOptions::default();
    let layout = FrameLayout::new((800, 600), 1);
    let picture = still(&FrameRequest { runs: &[run], time, options: &options }, (800, 600));
    let mut pixels = (layout.timeline.left..layout.timeline.right())
        .flat_map(|x| (layout.chart.top..layout.chart.bottom()).map(move |y| (x, y)));
    pixels.any(|(x, y)| picture.pixel(x, y) == bush_colour(kind))
}

#[test]
fn the_chart_is_pale_ahead_of_the_time_and_strong_behind_it() {
    let run = RunView::new(timeline(1), None);
    assert!(!is_state_shown(&run, SimTime::ZERO, BushStateKind::Intact));
    assert!(!is_state_shown(&run, SimTime::ZERO, BushStateKind::BurnedOut));
    for kind in BushStateKind::ALL {
        let lasts = run.counts_at(run.timeline().end_time()).count(kind) > 0;
        assert!(is_state_shown(&run, SimTime::MAX, kind) || !lasts, "{kind:?}");
    }
    assert!(is_state_shown(&run, SimTime::MAX, BushStateKind::Intact));
}
