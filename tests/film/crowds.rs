//! Laws of frames of large fields and of many agents: a fire of one cell is seen, no frame depends on those before it, and a
//! camera on the fleet keeps it in view without a jump.

use rand::RngExt;
use wildfire::fire::BushStateKind;
use wildfire::geometry::{Cell, DVec2, FieldFrame, Pose};
use wildfire::picture::bush_colour;
use wildfire::picture::film::{
    Camera, CameraTarget, FrameRenderer, FrameRequest, Projection, RunView, Selected, ViewOptions, still,
};
use wildfire::rng;
use wildfire::time::SimTime;
use wildfire::timeline::{Activity, AgentId, AgentStart, BushState, Cause, Event, Fact, FireFact, State, Timeline};
use wildfire::{scenario, sim};

const SIZE: (u32, u32) = (640, 420);

/// Five minutes of six trucks and five Wumpuses on a field whose cells are smaller than three pixels.
fn crowd() -> RunView {
    let changes = ["field.size_m=500", "field.coverage=0.05", "wumpus.count=5", "unimog.count=6", "duration_s=300"];
    let smoke = scenario::load("smoke", &changes.map(String::from)).expect("the built-in loads");
    RunView::new(sim::run(&smoke, 1).expect("it runs").timeline, None)
}

/// Ten kilometres of few bushes, one of which burns from the start; agents stand in a square about it.
fn one_fire(seed: u64, agents: usize) -> (Timeline, Cell) {
    let smoke = scenario::load("smoke", &[]).expect("the built-in loads");
    let mut timeline = sim::run(&smoke, 1).expect("it runs").timeline;
    let mut rng = rng::stream(seed, "tests/film_crowds/one_fire");
    let frame = FieldFrame { cols: 2000, rows: 2000, cell_m: 5.0 };
    timeline.setting.frame = frame;
    let mut indices: Vec<usize> = (0..3000).map(|_| rng.random_range(0..frame.cell_count())).collect();
    indices.sort_unstable();
    indices.dedup();
    timeline.setting.bushes = indices.into_iter().map(|index| frame.cell(index)).collect();
    let fire = timeline.setting.bushes[rng.random_range(0..timeline.setting.bushes.len())];
    let truck = *timeline.setting.agents.last().expect("there is a truck");
    timeline.setting.agents = (0..agents)
        .map(|number| {
            let at = frame.centre(fire) + DVec2::new((number % 5) as f64, (number / 5) as f64) * 40.0 - 80.0;
            AgentStart { id: AgentId::unimog(number as u16), pose: Pose::new(at.x, at.y, 0.3), ..truck }
        })
        .collect();
    let ignition = Fact::Fire(FireFact::Ignited { cell: fire, cause: Cause::Scheduled });
    timeline.events = vec![Event { time: SimTime::ZERO, fact: ignition }];
    (timeline, fire)
}

#[test]
fn the_fire_of_one_cell_is_seen_on_ten_kilometres() {
    for (seed, agents) in [(1, 0), (2, 0), (3, 1), (4, 25), (5, 25), (6, 100)] {
        let (timeline, fire) = one_fire(seed, agents);
        let run = RunView::new(timeline, None);
        let options = ViewOptions::default();
        let picture = still(&FrameRequest { runs: &[&run], time: SimTime::ZERO, options: &options }, SIZE);
        let pane = FrameRenderer::new(SIZE, 1).layout().fields[0];
        let state = run.state_at(SimTime::ZERO);
        let projection = Projection::from_options(&run, &state, &options, (pane.width, pane.height));
        let (x, y) = projection.at(run.timeline().setting.frame.centre(fire));
        let near = |at: f32, from: u32| (from + at as u32).saturating_sub(4)..from + at as u32 + 4;
        let burning = bush_colour(BushStateKind::Burning);
        let places = near(y, pane.top).flat_map(|y| near(x, pane.left).map(move |x| (x, y)));
        let seen = places.filter(|&(x, y)| picture.pixel(x, y) == burning).count();
        assert!(seen >= 4, "seed {seed}, {agents} agents: {seen} pixels");
    }
}

#[test]
fn frames_of_a_crowd_follow_from_their_requests_alone() {
    let run = crowd();
    let mut renderer = FrameRenderer::new(SIZE, 1);
    let followed = [None, Some(CameraTarget::Fleet), Some(CameraTarget::Agent(AgentId::unimog(2)))];
    let mut rng = rng::stream(1, "tests/film_crowds/requests");
    let mut time_s: f64 = 30.0;
    for step in 0..60 {
        time_s = if step % 7 == 6 { rng.random_range(0.0..310.0) } else { time_s + rng.random_range(0.0..3.0) };
        let options = ViewOptions {
            camera: Camera { zoom: [1.0, 0.5, 1.6, 5.0][step / 9 % 4], ..Camera::WHOLE },
            follows: followed[step / 6 % 3],
            selected: (step % 5 == 0).then_some((0, Selected::Agent(AgentId::wumpus(3)))),
            ..ViewOptions::default()
        };
        let request = FrameRequest { runs: &[&run], time: SimTime::from_seconds(time_s), options: &options };
        let fresh = FrameRenderer::new(SIZE, 1).paint(&request).to_vec();
        assert!(renderer.paint(&request) == fresh, "step {step}, {time_s} s");
    }
}

fn projection(run: &RunView, state: &State, pane: (u32, u32)) -> Projection {
    let options = ViewOptions { follows: Some(CameraTarget::Fleet), ..ViewOptions::default() };
    Projection::from_options(run, state, &options, pane)
}

#[test]
fn all_trucks_that_do_something_are_in_view_of_the_camera_on_the_fleet() {
    let run = crowd();
    let (mut at_work, mut nearer) = (0, 0);
    for step in 0..310 {
        let state = run.state_at(SimTime::from_seconds(f64::from(step) * 0.97));
        for pane in [(640, 420), (300, 500)] {
            let projection = projection(&run, &state, pane);
            let whole =
                Projection::new(&run.timeline().setting.frame, Camera::WHOLE, (f64::from(pane.0), f64::from(pane.1)));
            nearer += usize::from(projection.pixels_per_metre > 1.2 * whole.pixels_per_metre);
            for agent in state.agents.iter().filter(|agent| agent.id.role.suppresses()) {
                let (x, y) = projection.at(agent.pose.position());
                let is_in_view = x > 0.0 && y > 0.0 && x < pane.0 as f32 && y < pane.1 as f32;
                assert!(is_in_view || agent.activity == Activity::Standing, "{} at {}: {x}, {y}", agent.id, state.time);
                at_work += usize::from(agent.activity != Activity::Standing);
            }
        }
    }
    assert!(at_work > 100 && nearer > 20, "this run cannot tell: {at_work} at work, {nearer} times nearer");
}

#[test]
fn the_camera_on_the_fleet_does_not_jump() {
    let run = crowd();
    let pane = (640, 420);
    let seen = |time_s: f64| projection(&run, &run.state_at(SimTime::from_seconds(time_s)), pane);
    let (mut before, mut moved) = (seen(0.0), 0.0);
    for step in 1..=3000 {
        let now = seen(f64::from(step) * 0.1);
        // A tenth of a second, of the half a minute within which the camera goes from one box to the other.
        for corner in [(0.0, 0.0), (f64::from(pane.0), f64::from(pane.1))] {
            let shift = (now.place(before.world(corner)) - DVec2::from(corner)).length();
            assert!(shift < 12.0, "{shift} pixels at step {step}");
            moved += shift;
        }
        before = now;
    }
    assert!(moved > 100.0, "it moved by {moved} pixels only");
}

#[test]
fn a_fleet_that_rests_is_in_view_whole_and_no_fleet_leaves_the_camera_alone() {
    let (mut timeline, _) = one_fire(7, 30);
    timeline.events.clear();
    let run = RunView::new(timeline.clone(), None);
    let state = run.state_at(SimTime::ZERO);
    assert!(state.bushes.iter().all(|bush| *bush == BushState::Intact));
    let resting = projection(&run, &state, SIZE);
    let whole = Projection::new(&timeline.setting.frame, Camera::WHOLE, (f64::from(SIZE.0), f64::from(SIZE.1)));
    assert!(resting.pixels_per_metre > 3.0 * whole.pixels_per_metre);
    for agent in &state.agents {
        let (x, y) = resting.at(agent.pose.position());
        assert!(x > 0.0 && y > 0.0 && x < SIZE.0 as f32 && y < SIZE.1 as f32, "{}: {x}, {y}", agent.id);
    }
    timeline.setting.agents.clear();
    let run = RunView::new(timeline, None);
    assert_eq!(projection(&run, &run.state_at(SimTime::ZERO), SIZE), whole);
}
