//! Laws of frames: they follow from their shots alone, and any run can be shown on a sheet of any size.

use rand::RngExt;
use wildfire::geometry::{Cell, DVec2, FieldFrame};
use wildfire::picture::film::{
    Camera, CameraTarget, FrameLayout, FrameRenderer, FrameRequest, Layer, Layers, RunView, Selected, Status,
    ViewOptions, still,
};
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::time::SimTime;
use wildfire::timeline::{AgentId, AgentStart, Timeline};
use wildfire::{scenario, sim};

/// Six minutes on a small field, with all that searches looked at.
fn timeline(seed: u64, changes: &[&str]) -> Timeline {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let smoke = scenario::load("smoke", &changes).expect("the built-in loads");
    sim::run_recording_searches(&smoke, seed).expect("it runs").timeline
}

fn run(seed: u64, changes: &[&str]) -> RunView {
    RunView::new(timeline(seed, changes), None)
}

/// What is shown, to be changed bit by bit.
struct Viewer<'a> {
    runs: Vec<&'a RunView>,
    time: SimTime,
    options: ViewOptions,
    rng: Xoshiro256PlusPlus,
}

impl Viewer<'_> {
    fn request(&self, count: usize) -> FrameRequest<'_> {
        FrameRequest { runs: &self.runs[..count], time: self.time, options: &self.options }
    }

    /// Changes one thing, and often the time by little, as a player does.
    fn change(&mut self) {
        let rng = &mut self.rng;
        match rng.random_range(0..12) {
            0 => self.time = SimTime::from_seconds(rng.random_range(0.0..320.0)),
            1..3 => self.time += SimTime::from_seconds([1e-9, 0.125, 5.0][rng.random_range(0..3)]),
            3..6 => self.options.layers.toggle(Layer::ALL[rng.random_range(0..Layer::ALL.len())]),
            6 => {
                let centre = DVec2::new(rng.random_range(0.0..=1.0), rng.random_range(0.0..=1.0));
                self.options.camera = Camera { centre, zoom: [0.5, 1.0, 1.7, 3.0, 6.0, 200.0][rng.random_range(0..6)] };
            }
            7 => {
                let agents = [AgentId::unimog(0), AgentId::unimog(9)].map(CameraTarget::Agent);
                let followed = [None, Some(agents[0]), Some(agents[1]), Some(CameraTarget::Fleet)];
                self.options.follows = followed[rng.random_range(0..4)];
            }
            8 => self.options.selected = self.selected(),
            9 => self.options.shows_help = !self.options.shows_help,
            10 => self.options.status = self.status(),
            _ => {
                let (one, other) = (rng.random_range(0..self.runs.len()), rng.random_range(0..self.runs.len()));
                self.runs.swap(one, other);
            }
        }
    }

    fn selected(&mut self) -> Option<(usize, Selected)> {
        let setting = &self.runs[0].timeline().setting;
        let bush = setting.bushes[self.rng.random_range(0..setting.bushes.len())];
        let agents = [AgentId::wumpus(0), AgentId::unimog(0), AgentId::wumpus(7)];
        let all =
            agents.map(Selected::Agent).into_iter().chain([bush, Cell { col: 999, row: 999 }].map(Selected::Bush));
        let selected = all.map(Some).chain([None]).nth(self.rng.random_range(0..6)).flatten();
        selected.map(|selected| (self.rng.random_range(0..3), selected))
    }

    fn status(&mut self) -> Option<Status> {
        let (is_paused, speed) = (self.rng.random(), [0.1, 50.0, 1000.0][self.rng.random_range(0..3)]);
        let message = self.rng.random_bool(0.5).then(|| "saved as still-12.png".to_owned());
        self.rng.random_bool(0.7).then_some(Status { is_paused, speed, message })
    }
}

#[test]
fn a_frame_follows_from_its_request_alone() {
    let runs = [run(1, &[]), run(1, &["unimog.speed_mps=2"]), run(2, &[]), run(1, &[])];
    for (size, count, has_panel) in [((480, 360), 1, true), ((330, 250), 2, false), ((700, 420), 2, true)] {
        let mut renderer = FrameRenderer::new(size, count);
        assert_eq!(renderer.layout().panel.is_some(), has_panel);
        let mut viewer = Viewer {
            runs: runs.iter().collect(),
            time: SimTime::from_seconds(60.0),
            options: ViewOptions {
                layers: Layers::default().with(Layer::Wavefront).with(Layer::LocalSearch),
                ..ViewOptions::default()
            },
            rng: rng::stream(u64::from(size.0), "tests/film_frames"),
        };
        for step in 0..40 {
            viewer.change();
            let request = viewer.request(count);
            let was_shown = renderer.shows(&request);
            let kept = renderer.paint(&request).to_vec();
            assert!(renderer.shows(&request));
            assert!(
                kept == FrameRenderer::new(size, count).paint(&request),
                "step {step}, {size:?}, {}, {was_shown}, {:?}",
                request.time,
                request.options
            );
        }
    }
}

#[test]
fn a_renderer_knows_what_it_shows() {
    let runs = [run(1, &[]), run(1, &[])];
    let (time, options) = (SimTime::from_seconds(40.0), ViewOptions::default());
    let request = FrameRequest { runs: &[&runs[0]], time, options: &options };
    let mut renderer = FrameRenderer::new((330, 250), 1);
    assert!(!renderer.shows(&request));
    renderer.paint(&request);
    assert!(renderer.shows(&request));
    assert!(!renderer.shows(&FrameRequest { runs: &[&runs[1]], ..request }), "another view of the same run");
    assert!(!renderer.shows(&FrameRequest { time: time + SimTime::from_nanos(1), ..request }));
    assert!(
        !renderer
            .shows(&FrameRequest { options: &ViewOptions { shows_help: true, ..ViewOptions::default() }, ..request })
    );
}

/// Looks that show as much as there is, from far away to very near.
fn looks(timeline: &Timeline) -> impl Iterator<Item = ViewOptions> + Clone {
    let agent = timeline.setting.agents.last().map(|agent| agent.id);
    let bush = timeline.setting.bushes.last().map(|&bush| (0, Selected::Bush(bush)));
    [Camera::MIN_ZOOM, 1.0, 13.0, Camera::MAX_ZOOM].into_iter().enumerate().map(move |(index, zoom)| ViewOptions {
        camera: Camera { zoom, ..Camera::WHOLE },
        follows: [agent.map(CameraTarget::Agent), Some(CameraTarget::Fleet)][index % 2],
        layers: Layer::ALL.into_iter().collect(),
        selected: agent.filter(|_| index < 2).map(|agent| (0, Selected::Agent(agent))).or(bush),
        shows_help: index == 3,
        status: Some(Status { is_paused: false, speed: 1e-3, message: Some("a long message ".repeat(20)) }),
    })
}

fn assert_can_be_shown(timeline: Timeline, size: (u32, u32)) {
    let run = RunView::new(timeline, None);
    for time in [SimTime::ZERO, SimTime::from_seconds(70.0), SimTime::MAX] {
        for options in looks(run.timeline()) {
            for runs in [&[&run][..], &[&run, &run]] {
                let picture = still(&FrameRequest { runs, time, options: &options }, size);
                assert_eq!((picture.width(), picture.height()), size);
            }
        }
    }
}

#[test]
fn sheets_of_any_size_are_painted() {
    let (run, other) = (run(1, &[]), run(2, &[]));
    let sizes = [(320, 240), (320, FrameLayout::MAX_SIDE), (FrameLayout::MAX_SIDE, 240), (641, 479), (700, 1500)];
    for (options, size) in looks(run.timeline()).cycle().zip(sizes) {
        for runs in [&[&run][..], &[&run, &other]] {
            let picture = still(&FrameRequest { runs, time: SimTime::from_seconds(70.0), options: &options }, size);
            assert_eq!((picture.width(), picture.height()), size);
        }
    }
}

#[test]
fn a_field_where_nothing_is_can_be_shown() {
    assert_can_be_shown(timeline(1, &["wumpus=[]", "unimog=[]", "field.coverage=0"]), (640, 480));
}

#[test]
fn agents_without_bushes_can_be_shown() {
    assert_can_be_shown(timeline(1, &["field.coverage=0"]), (480, 640));
}

#[test]
fn a_field_of_one_cell_without_time_can_be_shown() {
    let mut timeline = timeline(1, &["wumpus=[]", "unimog=[]", "field.coverage=0"]);
    timeline.events.clear();
    timeline.setting.rules.duration = SimTime::ZERO;
    timeline.setting.frame = FieldFrame { cols: 1, rows: 1, cell_m: 1e-3 };
    timeline.setting.scenario = "\u{1f525} a scenario with a name that nobody would ever want to read".repeat(30);
    let run = RunView::new(timeline.clone(), None);
    assert_eq!((run.index().next_event(SimTime::ZERO), run.index().previous_event(SimTime::MAX)), (None, None));
    assert_can_be_shown(timeline.clone(), (640, 480));
    timeline.setting.bushes = vec![Cell { col: 0, row: 0 }];
    assert_can_be_shown(timeline, (400, 300));
}

#[test]
fn a_crowd_can_be_shown() {
    let mut timeline = timeline(1, &[]);
    let truck = *timeline.setting.agents.last().expect("there is a truck");
    timeline.setting.agents.extend((1..10).map(|number| AgentStart { id: AgentId::unimog(number), ..truck }));
    assert_can_be_shown(timeline, (900, 500));
}
