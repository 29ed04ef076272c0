//! What the pane of a field shows: fire is where the timeline says, differences are
//! outlined.

use wildfire::fire::BushStateKind;
use wildfire::geometry::DVec2;
use wildfire::picture::bush_colour;
use wildfire::picture::film::{
    Camera, CameraTarget, FrameRenderer, FrameRequest, Layer, Layers, PixelRect, Projection, RunView, Selected,
    ViewOptions, pick,
};
use wildfire::scenario;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{AgentId, Body, BushState, State};

const SIZE: (u32, u32) = (560, 420);
const DIFFERENT: [u8; 3] = [255, 0, 220];
const WATER: [u8; 3] = [0, 114, 178];

fn run(seed: u64, changes: &[&str]) -> RunView {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let scenario = scenario::load("smoke", &changes).expect("the built-in loads");
    RunView::new(sim::run_recording_searches(&scenario, seed).expect("it runs").timeline, None)
}

fn seconds(seconds: f64) -> SimTime {
    SimTime::from_seconds(seconds)
}

/// The pane of the first run, as red, green, blue and opacity.
struct Seen {
    pane: PixelRect,
    bytes: Vec<u8>,
}

impl Seen {
    fn new(runs: &[&RunView], time: SimTime, options: &ViewOptions) -> Self {
        let mut renderer = FrameRenderer::new(SIZE, runs.len());
        let pane = renderer.layout().fields[0];
        let bytes = renderer.paint(&FrameRequest { runs, time, options }).to_vec();
        Self { pane, bytes }
    }

    fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        let index = ((self.pane.top + y) * SIZE.0 + self.pane.left + x) as usize * 4;
        [self.bytes[index], self.bytes[index + 1], self.bytes[index + 2]]
    }

    fn count(&self, colour: [u8; 3]) -> usize {
        let places = (0..self.pane.height).flat_map(|y| (0..self.pane.width).map(move |x| (x, y)));
        places.filter(|&(x, y)| self.pixel(x, y) == colour).count()
    }
}

fn projection(run: &RunView, state: &State, options: &ViewOptions, pane: PixelRect) -> Projection {
    Projection::from_options(run, state, options, (pane.width, pane.height))
}

fn looks() -> Vec<ViewOptions> {
    let camera = |x: f64, y: f64, zoom: f64| Camera { centre: DVec2::new(x, y), zoom };
    let all: Layers = Layer::ALL.into_iter().collect();
    let plain = ViewOptions::default();
    vec![
        plain.clone(),
        ViewOptions { layers: all, ..plain.clone() },
        ViewOptions { layers: all.without(Layer::Wavefront), camera: camera(0.3, 0.6, 3.0), ..plain.clone() },
        ViewOptions {
            follows: Some(CameraTarget::Agent(AgentId::unimog(0))),
            layers: Layers::NONE.with(Layer::Clearance),
            ..plain.clone()
        },
        ViewOptions {
            camera: camera(0.5, 0.5, 0.5),
            selected: Some((0, Selected::Agent(AgentId::wumpus(0)))),
            ..plain.clone()
        },
        ViewOptions { camera: camera(0.9, 0.1, 12.0), layers: Layers::NONE.with(Layer::Paths), ..plain },
    ]
}

#[test]
fn every_layer_shows_something() {
    let run = run(1, &[]);
    let state = [60.0, 70.0, 80.0, 90.0].map(|time_s| run.state_at(seconds(time_s)));
    let shown = |layers: Layers, time: SimTime| {
        let camera = Camera { zoom: 2.0, ..Camera::WHOLE };
        Seen::new(&[&run], time, &ViewOptions { layers, camera, ..ViewOptions::default() }).bytes
    };
    for layer in Layer::all_of(false) {
        let differs = |state: &State| shown(Layers::NONE.with(layer), state.time) != shown(Layers::NONE, state.time);
        assert!(state.iter().any(differs), "{layer:?}");
    }
}

/// Cells whose middle nothing but bush and flames can cover: no agent is near, and no jet of water.
fn undisturbed<'a>(run: &'a RunView, state: &'a State) -> impl Iterator<Item = (DVec2, BushStateKind)> + 'a {
    let setting = &run.timeline().setting;
    let bushes = setting.bushes.iter().zip(&state.bushes);
    bushes.map(|(&cell, &bush)| (setting.frame.centre(cell), bush.kind())).filter(|(centre, _)| {
        let distance = |index: usize| (setting.agents[index].body.centre(state.agents[index].pose) - *centre).length();
        (0..state.agents.len()).all(|index| distance(index) > 14.0)
    })
}

#[test]
fn bushes_have_the_colours_of_their_fates_where_they_stand() {
    let run = run(3, &[]);
    let mut found = [0; 4];
    for time_s in [20.0, 45.0, 70.0, 120.0, 200.0] {
        let state = run.state_at(seconds(time_s));
        for zoom in [0.5, 1.0, 1.7] {
            let options = ViewOptions {
                camera: Camera { zoom, ..Camera::WHOLE },
                layers: Layers::NONE.with(Layer::Ages),
                ..ViewOptions::default()
            };
            let seen = Seen::new(&[&run], state.time, &options);
            let projection = projection(&run, &state, &options, seen.pane);
            let is_flat = projection.pixels_per_metre * 5.0 < 8.0;
            for (centre, kind) in undisturbed(&run, &state) {
                let (x, y) = projection.at(centre);
                // What stands before a bush may hide it, and so may a scale in a corner.
                let is_inside = |at: f32, side: u32| (20.0..side as f32 - 60.0).contains(&at);
                if !is_inside(x, seen.pane.width) || !is_inside(y, seen.pane.height) {
                    continue;
                }
                let colour @ [red, green, blue] = seen.pixel(x as u32, y as u32);
                let fits = match kind {
                    _ if is_flat => colour == bush_colour(kind),
                    BushStateKind::Burning => red > 180 && red > green && green > blue,
                    BushStateKind::Intact => green > red && green > blue,
                    BushStateKind::BurnedOut => red.max(green).max(blue) < 160 && red.abs_diff(blue) < 24,
                    BushStateKind::Extinguished => blue > red && green > red,
                };
                assert!(fits, "{kind:?} at {centre} and {time_s} s, zoom {zoom}: {colour:?}");
                found[BushStateKind::ALL.iter().position(|&state| state == kind).expect("all are listed")] += 1;
            }
        }
    }
    assert!(found.iter().all(|&count| count > 5), "these times cannot tell: {found:?}");
}

#[test]
fn only_fates_that_differ_are_outlined() {
    let options = ViewOptions { layers: Layers::NONE, ..ViewOptions::default() };
    let (here, twin) = (run(1, &[]), run(1, &[]));
    let (slow, elsewhere) = (run(1, &["unimog.speed_mps=2"]), run(2, &[]));
    let mut differed = 0;
    for time_s in [0.0, 60.0, 120.0, 290.0] {
        let time = seconds(time_s);
        let outlined = |rival: &RunView| Seen::new(&[&here, rival], time, &options).count(DIFFERENT);
        assert_eq!(outlined(&twin), 0, "the same run at {time}");
        assert_eq!(outlined(&elsewhere), 0, "another field at {time}");
        let kinds = |run: &RunView| run.state_at(time).bushes.into_iter().map(BushState::kind).collect::<Vec<_>>();
        let differs = kinds(&here) != kinds(&slow);
        assert_eq!(outlined(&slow) > 0, differs, "another truck at {time}");
        differed += usize::from(differs);
    }
    assert!((1..4).contains(&differed), "these times cannot tell: {differed}");
}

#[test]
fn outlines_leave_the_inside_of_their_cells() {
    let (here, twin, slow) = (run(1, &[]), run(1, &[]), run(1, &["unimog.speed_mps=2"]));
    let time = seconds(290.0);
    let (state, other) = (here.state_at(time), slow.state_at(time));
    let setting = &here.timeline().setting;
    let mut outlined = 0;
    for zoom in [0.7, 1.0, 3.0] {
        let options =
            ViewOptions { layers: Layers::NONE, camera: Camera { zoom, ..Camera::WHOLE }, ..ViewOptions::default() };
        let (plain, marked) = (Seen::new(&[&here, &twin], time, &options), Seen::new(&[&here, &slow], time, &options));
        let projection = projection(&here, &state, &options, plain.pane);
        for (&cell, (bush, rival)) in setting.bushes.iter().zip(state.bushes.iter().zip(&other.bushes)) {
            let ((left, top), (right, bottom)) = projection.cell(&setting.frame, cell);
            let is_seen = left >= 0 && top >= 0 && right < plain.pane.width as i32 && bottom < plain.pane.height as i32;
            if !is_seen || bush.kind() == rival.kind() {
                continue;
            }
            for (x, y) in (top + 3..bottom - 3).flat_map(|y| (left + 3..right - 3).map(move |x| (x as u32, y as u32))) {
                assert_eq!(plain.pixel(x, y), marked.pixel(x, y), "{x}, {y} in {cell}, zoom {zoom}");
                outlined += 1;
            }
        }
    }
    assert!(outlined > 50, "this time cannot tell: {outlined}");
}

#[test]
fn what_is_under_the_mouse_is_what_is_drawn_there() {
    let run = run(1, &[]);
    let setting = &run.timeline().setting;
    let pane = (400, 300);
    for options in looks() {
        let state = run.state_at(seconds(50.0));
        let projection = Projection::from_options(&run, &state, &options, pane);
        let picked = |point: DVec2| {
            let (x, y) = projection.at(point);
            pick(&run, &state, &options, pane, (f64::from(x), f64::from(y)))
        };
        for (start, agent) in setting.agents.iter().zip(&state.agents) {
            assert_eq!(picked(start.body.centre(agent.pose)), Some(Selected::Agent(start.id)));
        }
        let half_body_m = |body: &Body| match body {
            Body::Square { size_m } => 0.5 * size_m,
            Body::Truck(body) => 0.5 * body.length_m,
        };
        for index in 0..setting.frame.cell_count() {
            let centre = setting.frame.centre(setting.frame.cell(index));
            let reach = |body: &Body| {
                half_body_m(body).max(9.0 / projection.pixels_per_metre) + 7.0 / projection.pixels_per_metre
            };
            let is_clear = setting
                .agents
                .iter()
                .zip(&state.agents)
                .all(|(start, agent)| (start.body.centre(agent.pose) - centre).length() > reach(&start.body));
            if is_clear {
                let cell = setting.frame.cell(index);
                let expected = setting.bush_index(cell).map(|_| Selected::Bush(cell));
                assert_eq!(picked(centre), expected, "{cell}");
            }
        }
        assert_eq!(picked(DVec2::new(-30.0, -30.0)), None, "off the field");
    }
}

#[test]
fn who_is_followed_is_in_the_middle() {
    let run = run(1, &[]);
    for agent in [AgentId::wumpus(0), AgentId::unimog(0)] {
        let options = ViewOptions { follows: Some(CameraTarget::Agent(agent)), ..ViewOptions::default() };
        for time_s in [0.0, 33.0, 80.0] {
            let state = run.state_at(seconds(time_s));
            let index = run.timeline().setting.agent_index(agent).expect("it is there");
            let centre = run.timeline().setting.agents[index].body.centre(state.agents[index].pose);
            let (x, y) = Projection::from_options(&run, &state, &options, (500, 300)).at(centre);
            assert!((x - 250.0).abs() < 0.01 && (y - 150.0).abs() < 0.01, "{agent} at {x}, {y}");
        }
    }
}

#[test]
fn places_with_water_are_drops() {
    let drops = |changes: &[&str]| {
        let run = run(1, changes);
        let seen = Seen::new(&[&run], seconds(0.0), &ViewOptions::default());
        let places: Vec<DVec2> = run.timeline().setting.water.iter().flat_map(|water| water.places.clone()).collect();
        let state = run.timeline().state_at(seconds(0.0));
        let projection = projection(&run, &state, &ViewOptions::default(), seen.pane);
        let at = places.iter().map(|&place| projection.at(place));
        let drawn = at.filter(|&(x, y)| seen.pixel(x as u32, y as u32) == WATER).count();
        (places.len(), drawn, seen.count(WATER))
    };
    assert_eq!(drops(&[]), (0, 0, 0));
    let table = ["field.coverage=0.01", "water.tank_l=500", "water.place=[{x_m=40,y_m=60},{x_m=80,y_m=75}]"];
    let (places, drawn, pixels) = drops(&table);
    assert_eq!((places, drawn), (2, 2));
    assert!(pixels > 100, "{pixels} pixels of water");
}
