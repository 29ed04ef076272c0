//! What the pane of a field shows: fire is where the timeline says, differences are
//! outlined.

use wildfire::geometry::DVec2;
use wildfire::picture::film::{
    Camera, Fate, Film, Layer, Layers, Look, Painter, Projection, Rectangle, Selected, Shot, pick,
};
use wildfire::scenario;
use wildfire::sim;
use wildfire::time::SimTime;
use wildfire::timeline::{AgentId, Body, State};

const SIZE: (u32, u32) = (560, 420);
const DIFFERENT: [u8; 3] = [255, 0, 220];

fn film(seed: u64, changes: &[&str]) -> Film {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let scenario = scenario::load("smoke", &changes).expect("the built-in loads");
    Film::new(sim::run_recording_searches(&scenario, seed).expect("it runs").timeline, None)
}

fn seconds(seconds: f64) -> SimTime {
    SimTime::from_seconds(seconds)
}

/// The pane of the first run, as red, green, blue and opacity.
struct Seen {
    pane: Rectangle,
    bytes: Vec<u8>,
}

impl Seen {
    fn of(films: &[&Film], time: SimTime, look: &Look) -> Self {
        let mut painter = Painter::new(SIZE, films.len());
        let pane = painter.layout().fields[0];
        let bytes = painter.paint(&Shot { films, time, look }).to_vec();
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

fn projection(film: &Film, state: &State, look: &Look, pane: Rectangle) -> Projection {
    Projection::of(film, state, look, (pane.width, pane.height))
}

fn looks() -> Vec<Look> {
    let camera = |x: f64, y: f64, zoom: f64| Camera { centre: DVec2::new(x, y), zoom };
    let all: Layers = Layer::ALL.into_iter().collect();
    let plain = Look::default();
    vec![
        plain.clone(),
        Look { layers: all, ..plain.clone() },
        Look { layers: all.without(Layer::Wavefront), camera: camera(0.3, 0.6, 3.0), ..plain.clone() },
        Look { follows: Some(AgentId::unimog(0)), layers: Layers::NONE.with(Layer::Clearance), ..plain.clone() },
        Look {
            camera: camera(0.5, 0.5, 0.5),
            selected: Some((0, Selected::Agent(AgentId::wumpus(0)))),
            ..plain.clone()
        },
        Look { camera: camera(0.9, 0.1, 12.0), layers: Layers::NONE.with(Layer::Paths), ..plain },
    ]
}

#[test]
fn every_layer_shows_something() {
    let film = film(1, &[]);
    let state = [60.0, 70.0, 80.0, 90.0].map(|time_s| film.state_at(seconds(time_s)));
    let shown = |layers: Layers, time: SimTime| {
        let camera = Camera { zoom: 2.0, ..Camera::WHOLE };
        Seen::of(&[&film], time, &Look { layers, camera, ..Look::default() }).bytes
    };
    for layer in Layer::ALL {
        let differs = |state: &State| shown(Layers::NONE.with(layer), state.time) != shown(Layers::NONE, state.time);
        assert!(state.iter().any(differs), "{layer:?}");
    }
}

/// Cells whose middle nothing but bush and flames can cover: no agent is near, and no jet of water.
fn undisturbed<'a>(film: &'a Film, state: &'a State) -> impl Iterator<Item = (DVec2, Fate)> + 'a {
    let setting = &film.timeline().setting;
    let bushes = setting.bushes.iter().zip(&state.bushes);
    bushes.map(|(&cell, &bush)| (setting.frame.centre(cell), Fate::of(bush))).filter(|(centre, _)| {
        let distance = |index: usize| (setting.agents[index].body.centre(state.agents[index].pose) - *centre).length();
        (0..state.agents.len()).all(|index| distance(index) > 14.0)
    })
}

#[test]
fn bushes_have_the_colours_of_their_fates_where_they_stand() {
    let film = film(3, &[]);
    let mut found = [0; 4];
    for time_s in [20.0, 45.0, 70.0, 120.0, 200.0] {
        let state = film.state_at(seconds(time_s));
        for zoom in [0.5, 1.0, 1.7] {
            let look = Look {
                camera: Camera { zoom, ..Camera::WHOLE },
                layers: Layers::NONE.with(Layer::Ages),
                ..Look::default()
            };
            let seen = Seen::of(&[&film], state.time, &look);
            let projection = projection(&film, &state, &look, seen.pane);
            let is_flat = projection.pixels_per_metre * 5.0 < 8.0;
            for (centre, fate) in undisturbed(&film, &state) {
                let (x, y) = projection.at(centre);
                // What stands before a bush may hide it, and so may a scale in a corner.
                let is_inside = |at: f32, side: u32| (20.0..side as f32 - 60.0).contains(&at);
                if !is_inside(x, seen.pane.width) || !is_inside(y, seen.pane.height) {
                    continue;
                }
                let colour @ [red, green, blue] = seen.pixel(x as u32, y as u32);
                let fits = match fate {
                    _ if is_flat => colour == fate.colour(),
                    Fate::Burning => red > 180 && red > green && green > blue,
                    Fate::Intact => green > red && green > blue,
                    Fate::BurnedOut => red.max(green).max(blue) < 160 && red.abs_diff(blue) < 24,
                    Fate::Extinguished => blue > red && green > red,
                };
                assert!(fits, "{fate:?} at {centre} and {time_s} s, zoom {zoom}: {colour:?}");
                found[Fate::ALL.iter().position(|&known| known == fate).expect("all are listed")] += 1;
            }
        }
    }
    assert!(found.iter().all(|&count| count > 5), "these times cannot tell: {found:?}");
}

#[test]
fn only_fates_that_differ_are_outlined() {
    let look = Look { layers: Layers::NONE, ..Look::default() };
    let (here, twin) = (film(1, &[]), film(1, &[]));
    let (slow, elsewhere) = (film(1, &["unimog.speed_mps=2"]), film(2, &[]));
    let mut differed = 0;
    for time_s in [0.0, 60.0, 120.0, 290.0] {
        let time = seconds(time_s);
        let outlined = |rival: &Film| Seen::of(&[&here, rival], time, &look).count(DIFFERENT);
        assert_eq!(outlined(&twin), 0, "the same run at {time}");
        assert_eq!(outlined(&elsewhere), 0, "another field at {time}");
        let fates = |film: &Film| film.state_at(time).bushes.into_iter().map(Fate::of).collect::<Vec<_>>();
        let differs = fates(&here) != fates(&slow);
        assert_eq!(outlined(&slow) > 0, differs, "another truck at {time}");
        differed += usize::from(differs);
    }
    assert!((1..4).contains(&differed), "these times cannot tell: {differed}");
}

#[test]
fn outlines_leave_the_inside_of_their_cells() {
    let (here, twin, slow) = (film(1, &[]), film(1, &[]), film(1, &["unimog.speed_mps=2"]));
    let time = seconds(290.0);
    let (state, other) = (here.state_at(time), slow.state_at(time));
    let setting = &here.timeline().setting;
    let mut outlined = 0;
    for zoom in [0.7, 1.0, 3.0] {
        let look = Look { layers: Layers::NONE, camera: Camera { zoom, ..Camera::WHOLE }, ..Look::default() };
        let (plain, marked) = (Seen::of(&[&here, &twin], time, &look), Seen::of(&[&here, &slow], time, &look));
        let projection = projection(&here, &state, &look, plain.pane);
        for (&cell, (bush, rival)) in setting.bushes.iter().zip(state.bushes.iter().zip(&other.bushes)) {
            let ((left, top), (right, bottom)) = projection.cell(&setting.frame, cell);
            let is_seen = left >= 0 && top >= 0 && right < plain.pane.width as i32 && bottom < plain.pane.height as i32;
            if !is_seen || Fate::of(*bush) == Fate::of(*rival) {
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
    let film = film(1, &[]);
    let setting = &film.timeline().setting;
    let pane = (400, 300);
    for look in looks() {
        let state = film.state_at(seconds(50.0));
        let projection = Projection::of(&film, &state, &look, pane);
        let picked = |point: DVec2| {
            let (x, y) = projection.at(point);
            pick(&film, &state, &look, pane, (f64::from(x), f64::from(y)))
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
    let film = film(1, &[]);
    for agent in [AgentId::wumpus(0), AgentId::unimog(0)] {
        let look = Look { follows: Some(agent), ..Look::default() };
        for time_s in [0.0, 33.0, 80.0] {
            let state = film.state_at(seconds(time_s));
            let index = film.timeline().setting.agent_index(agent).expect("it is there");
            let centre = film.timeline().setting.agents[index].body.centre(state.agents[index].pose);
            let (x, y) = Projection::of(&film, &state, &look, (500, 300)).at(centre);
            assert!((x - 250.0).abs() < 0.01 && (y - 150.0).abs() < 0.01, "{agent} at {x}, {y}");
        }
    }
}
