//! The window's logic without a window, with time driven by hand.

use std::sync::Mutex;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;
use std::time::Duration;

use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::entity::Entity;
use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyCode, KeyboardInput, NativeKeyCode};
use bevy::input::mouse::{MouseButton, MouseButtonInput, MouseScrollUnit, MouseWheel};
use bevy::input::touch::TouchPhase;
use bevy::math::Vec2;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{CursorMoved, WindowEvent};
use glam::DVec2;
use wildfire::picture::film::{CameraTarget, Layer, Projection, RunView, ViewOptions};
use wildfire::time::SimTime;
use wildfire::timeline::Outcome;
use wildfire::view::{FrameBuffer, Player, PlayerPlugin, RunLoader, RunSet, Viewer, ViewerConfig, insert_resources};

use crate::expected::{picture, seconds, simulated, with_status};

const SIZE: (u32, u32) = (400, 300);
const FRAME: Duration = Duration::from_millis(20);

struct Window {
    app: App,
}

impl Window {
    fn open(runs: Vec<(RunView, Option<Box<dyn RunLoader>>)>, speed: f64) -> Self {
        let start = SimTime::ZERO;
        let config = ViewerConfig { runs, options: ViewOptions::default(), speed, start, is_paused: false, size: SIZE };
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, PlayerPlugin)).insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
        insert_resources(&mut app, config);
        // Bevy's clock starts with its first frame.
        app.update();
        Self { app }
    }

    fn frames(&mut self, count: usize) {
        (0..count).for_each(|_| self.app.update());
    }

    fn press(&mut self, key: Key) {
        for state in [ButtonState::Pressed, ButtonState::Released] {
            let event = KeyboardInput {
                key_code: KeyCode::Unidentified(NativeKeyCode::Unidentified),
                logical_key: key.clone(),
                state,
                text: None,
                repeat: false,
                window: Entity::PLACEHOLDER,
            };
            self.app.world_mut().write_message(WindowEvent::KeyboardInput(event));
        }
    }

    fn type_letter(&mut self, letter: &str) {
        self.press(Key::Character(letter.into()));
    }

    fn mouse_to(&mut self, x: f64, y: f64) {
        let position = Vec2::new(x as f32, y as f32);
        let event = CursorMoved { window: Entity::PLACEHOLDER, position, delta: None };
        self.app.world_mut().write_message(WindowEvent::CursorMoved(event));
    }

    fn button(&mut self, state: ButtonState) {
        let event = MouseButtonInput { button: MouseButton::Left, state, window: Entity::PLACEHOLDER };
        self.app.world_mut().write_message(WindowEvent::MouseButtonInput(event));
    }

    fn player(&self) -> &Player {
        self.app.world().resource()
    }

    fn message(&self) -> Option<String> {
        self.app.world().resource::<Viewer>().message.clone()
    }

    fn runs(&self) -> Vec<&RunView> {
        self.app.world().resource::<RunSet>().runs()
    }

    /// Whether the sheet that was painted last is a still at that time.
    fn shows(&mut self, time: SimTime) -> bool {
        let painted = self.app.world_mut().resource_mut::<FrameBuffer>().take_painted().expect("something changed");
        let options = with_status(
            &self.app.world().resource::<Viewer>().options,
            self.player().is_paused(),
            self.player().speed(),
        );
        let expected = picture(&self.runs(), time, &options, SIZE);
        let (pixels, _) = painted.as_chunks::<4>();
        let width = SIZE.0 as usize;
        let is_expected = |(at, pixel): (usize, &[u8; 4])| {
            expected.pixel((at % width) as u32, (at / width) as u32) == [pixel[0], pixel[1], pixel[2]]
        };
        self.player().clock() == time && pixels.iter().enumerate().all(is_expected)
    }
}

fn one(name: &str, seed: u64) -> Vec<(RunView, Option<Box<dyn RunLoader>>)> {
    vec![(RunView::new(simulated(name, seed), None), None)]
}

#[test]
fn what_is_shown_is_the_state_at_the_clock_and_nothing_changes_the_run() {
    let timeline = simulated("contest", 1);
    let outcome = Outcome::new(&timeline);
    for speed in [1.0, 50.0] {
        let mut window = Window::open(one("contest", 1), speed);
        let frame_s = speed * FRAME.as_secs_f64();
        window.frames(5);
        assert!(window.shows(seconds(5.0 * frame_s)));
        window.press(Key::Space);
        window.frames(3);
        // The time before the key passes, that after it does not.
        assert!(window.shows(seconds(6.0 * frame_s)));
        window.press(Key::End);
        window.frames(1);
        assert!(window.shows(timeline.end_time()));
        window.press(Key::Home);
        window.press(Key::ArrowRight);
        window.press(Key::ArrowRight);
        window.type_letter("2");
        window.frames(1);
        assert!(window.shows(seconds(20.0)));
        assert!(!window.app.world().resource::<Viewer>().options.layers.contains(Layer::Suppression));
        window.press(Key::Space);
        window.frames(2);
        assert!(window.shows(seconds(20.0 + frame_s)));
        let run = window.runs()[0];
        assert_eq!(run.timeline(), &timeline);
        assert_eq!(Outcome::new(run.timeline()), outcome);
    }
}

#[test]
fn steps_go_from_event_to_event_and_pause() {
    let mut window = Window::open(one("smoke", 1), 1.0);
    let run = RunView::new(simulated("smoke", 1), None);
    let mut time = window.player().clock();
    for _ in 0..20 {
        time = run.index().next_event(time).expect("more than twenty events");
        window.type_letter(".");
        window.frames(1);
        assert!(window.shows(time));
    }
    time = run.index().previous_event(time).expect("an earlier one");
    window.type_letter(",");
    window.frames(4);
    assert!(window.shows(time) && window.player().is_paused());
}

#[test]
fn clock_stands_while_the_mouse_has_hold_of_the_timeline() {
    let mut window = Window::open(one("contest", 1), 50.0);
    let timeline = window.app.world().resource::<FrameBuffer>().layout().timeline;
    let middle = f64::from(timeline.left) + 0.5 * f64::from(timeline.width);
    let y = f64::from(timeline.top) + 0.5 * f64::from(timeline.height);
    window.mouse_to(middle, y);
    window.button(ButtonState::Pressed);
    window.frames(10);
    let half = seconds(0.5 * window.player().end().as_seconds());
    assert!(window.shows(half));
    window.mouse_to(-10.0, 0.0);
    window.frames(10);
    assert!(window.shows(SimTime::ZERO));
    window.button(ButtonState::Released);
    window.frames(3);
    assert!(window.shows(seconds(2.0 * 50.0 * FRAME.as_secs_f64())));
}

#[test]
fn what_is_dragged_away_from_an_agent_stays_as_it_was_seen() {
    let mut window = Window::open(one("contest", 1), 50.0);
    window.frames(100);
    window.press(Key::Space);
    window.type_letter("f");
    window.type_letter("f");
    window.frames(1);
    let pane = window.app.world().resource::<FrameBuffer>().layout().fields[0];
    let (x, y) = (f64::from(pane.left + pane.width / 2), f64::from(pane.top + pane.height / 2));
    let seen = |window: &Window| {
        let (run, options) = (window.runs()[0], &window.app.world().resource::<Viewer>().options);
        let state = run.state_at(window.player().clock());
        Projection::from_options(run, &state, options, (pane.width, pane.height)).place(DVec2::splat(125.0))
    };
    let before = seen(&window);
    window.mouse_to(x, y);
    window.button(ButtonState::Pressed);
    window.mouse_to(x + 8.0, y - 6.0);
    window.button(ButtonState::Released);
    window.frames(1);
    assert!(seen(&window).distance(before + DVec2::new(8.0, -6.0)) < 1e-6);
    assert_eq!(window.app.world().resource::<Viewer>().options.follows, None);
}

#[test]
fn following_begins_with_the_fleet_where_there_is_one_and_ends_after_the_last_agent() {
    for (name, has_fleet) in [("fleet", true), ("contest", false)] {
        let mut window = Window::open(one(name, 1), 50.0);
        let agents = window.runs()[0].timeline().setting.agents.iter().map(|start| CameraTarget::Agent(start.id));
        let fleet = has_fleet.then_some(CameraTarget::Fleet);
        let all: Vec<Option<CameraTarget>> = fleet.into_iter().chain(agents).map(Some).chain([None]).collect();
        for expected in all {
            window.type_letter("f");
            window.frames(1);
            assert_eq!(window.app.world().resource::<Viewer>().options.follows, expected, "{name}");
        }
    }
}

#[test]
fn the_wheel_lets_the_fleet_go_and_zooms_from_what_was_seen() {
    let mut window = Window::open(one("fleet", 1), 50.0);
    window.frames(100);
    window.press(Key::Space);
    window.type_letter("f");
    window.frames(1);
    let pane = window.app.world().resource::<FrameBuffer>().layout().fields[0];
    let seen = |window: &Window| {
        let (run, options) = (window.runs()[0], &window.app.world().resource::<Viewer>().options);
        let state = run.state_at(window.player().clock());
        Projection::from_options(run, &state, options, (pane.width, pane.height))
    };
    let before = seen(&window);
    let at = (f64::from(pane.width / 2), f64::from(pane.height / 2));
    window.mouse_to(f64::from(pane.left) + at.0, f64::from(pane.top) + at.1);
    let wheel = MouseWheel {
        unit: MouseScrollUnit::Line,
        x: 0.0,
        y: 1.0,
        window: Entity::PLACEHOLDER,
        phase: TouchPhase::Moved,
    };
    window.app.world_mut().write_message(WindowEvent::MouseWheel(wheel));
    window.frames(1);
    let after = seen(&window);
    assert_eq!(window.app.world().resource::<Viewer>().options.follows, None);
    assert!(after.pixels_per_metre > before.pixels_per_metre);
    assert!((after.world(at) - before.world(at)).length() < 1e-6);
}

#[test]
fn nothing_is_painted_while_nothing_changes() {
    let mut window = Window::open(one("smoke", 1), 1.0);
    window.press(Key::Space);
    window.frames(1);
    let frame_buffer = |window: &mut Window| window.app.world_mut().resource_mut::<FrameBuffer>().take_painted();
    assert!(frame_buffer(&mut window).is_some());
    window.frames(5);
    assert!(frame_buffer(&mut window).is_none());
    window.type_letter("?");
    window.frames(1);
    assert!(frame_buffer(&mut window).is_some());
}

/// Gives a run when it is told to.
struct OnDemand {
    go: Mutex<Receiver<Result<(), String>>>,
}

fn on_demand() -> (Sender<Result<(), String>>, Box<dyn RunLoader>) {
    let (tell, go) = mpsc::channel();
    (tell, Box::new(OnDemand { go: Mutex::new(go) }))
}

impl RunLoader for OnDemand {
    fn load(&self, seed: u64) -> Result<RunView, String> {
        let received = self.go.lock().expect("one thread at a time").recv();
        received.unwrap_or_else(|gone| Err(gone.to_string())).map(|()| RunView::new(simulated("smoke", seed), None))
    }

    fn seeds(&self) -> Option<&[u64]> {
        None
    }
}

/// Lets frames go by until what was sent for is there.
fn wait_for_runs(window: &mut Window) {
    for _ in 0..10_000_000 {
        if !window.app.world().resource::<RunSet>().is_waiting() {
            return;
        }
        window.frames(1);
        thread::yield_now();
    }
    panic!("the run does not come");
}

#[test]
fn next_seed_is_simulated_while_the_present_run_goes_on() {
    let (tell, source) = on_demand();
    let mut window = Window::open(vec![(RunView::new(simulated("smoke", 7), None), Some(source))], 1.0);
    window.frames(10);
    window.type_letter("r");
    window.frames(10);
    assert_eq!(window.message().as_deref(), Some("simulating seed 8 ..."));
    assert_eq!(window.player().clock(), seconds(20.0 * FRAME.as_secs_f64()));
    tell.send(Ok(())).expect("somebody waits");
    wait_for_runs(&mut window);
    assert_eq!(window.runs()[0].timeline(), &simulated("smoke", 8));
    assert_eq!(window.message(), None);
    assert!(window.shows(SimTime::ZERO));
}

#[test]
fn seed_that_cannot_be_had_is_a_message_and_the_present_run_stays() {
    let (tell, source) = on_demand();
    let mut window = Window::open(vec![(RunView::new(simulated("smoke", 7), None), Some(source))], 1.0);
    window.type_letter("p");
    tell.send(Err("no room on the field".into())).expect("somebody waits");
    window.frames(1);
    wait_for_runs(&mut window);
    assert_eq!(window.message().as_deref(), Some("no room on the field"));
    assert_eq!(window.runs()[0].timeline().setting.seed, 7);
}
