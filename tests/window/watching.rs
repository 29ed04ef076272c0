//! The real window, from opening to closing.

use glam::DVec2;
use tempfile::TempDir;
use wildfire::geometry::ops;
use wildfire::picture::Picture;
use wildfire::picture::film::{
    Camera, CameraTarget, FrameLayout, Layer, Layers, Projection, RunView, Selected, ViewOptions,
};
use wildfire::time::SimTime;
use wildfire::time::wall::WallStopwatch;
use wildfire::timeline::{self, BushState};

use crate::display::{Window, hands, say, wait_for};
use crate::expected::{picture, seconds, simulated, with_status};
use crate::xwd::Screenshot;

const SIZE: (u32, u32) = (640, 480);
const SIZE_ARGUMENT: &str = "640x480";
const SPEED: f64 = 10.0;

/// A folder with recordings of seeds, whose runs have no CPU times, which differ from run to run.
fn recorded(seeds: &[u64]) -> (TempDir, Vec<RunView>) {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let runs = seeds.iter().map(|seed| {
        let timeline = simulated("contest", *seed);
        timeline::file::write(&timeline, &folder.path().join(format!("{seed}.wildfire"))).expect("writable");
        RunView::new(timeline, None)
    });
    let runs = runs.collect();
    (folder, runs)
}

fn open(folder: &TempDir, arguments: &[&str]) -> Window {
    Window::open(folder.path(), &[&["--size", SIZE_ARGUMENT], arguments].concat())
}

/// The frame that a window shows.
struct Frame<'a> {
    runs: Vec<&'a RunView>,
    options: ViewOptions,
}

impl<'a> Frame<'a> {
    fn new(runs: &'a [RunView], options: ViewOptions) -> Self {
        Self { runs: runs.iter().collect(), options }
    }

    /// Paused at that time.
    fn picture(&self, time: SimTime) -> Picture {
        picture(&self.runs, time, &with_status(&self.options, true, SPEED), SIZE)
    }

    /// Waits until the window shows the frame of that time, paused.
    fn wait_for(&self, window: &Window, time: SimTime) -> Screenshot {
        let expected = self.picture(time);
        wait_for(&format!("the frame at {time}"), || {
            window.screenshot().filter(|seen| seen.differences(&expected) == 0)
        })
    }
}

/// Red and yellow, as nothing else on the field is.
fn is_fire_coloured([red, green, blue]: [u8; 3]) -> bool {
    red > 180 && blue < 110 && red.saturating_sub(blue) > 90 && green > 50
}

#[test]
fn burning_cells_are_seen_where_the_timeline_says() {
    let Some(_hands) = hands() else { return };
    let (folder, runs) = recorded(&[1]);
    let (timeline, pane) = (runs[0].timeline(), FrameLayout::new(SIZE, 1).fields[0]);
    // Good drivers leave few fires at any other time.
    let burning_at = |&minute: &u32| {
        let bushes = timeline.state_at(seconds(f64::from(60 * minute))).bushes;
        bushes.iter().filter(|state| matches!(state, BushState::Burning { .. })).count()
    };
    let at = 60 * (1..60).max_by_key(burning_at).expect("an hour has minutes");
    let start = WallStopwatch::start();
    let window = open(&folder, &["1.wildfire", "--at", &at.to_string(), "--paused", "--layers", "none"]);
    let frame = Frame::new(&runs, ViewOptions { layers: Layers::NONE, ..ViewOptions::default() });
    let seen = frame.wait_for(&window, seconds(f64::from(at)));
    say(&format!("from the start to the first frame seen: {:.1} s", start.elapsed().as_secs_f64()));
    let (setting, state) = (&timeline.setting, timeline.state_at(seconds(f64::from(at))));
    let projection =
        Projection::new(&setting.frame, frame.options.camera, (f64::from(pane.width), f64::from(pane.height)));
    let is_free = |point: DVec2| state.agents.iter().all(|agent| agent.pose.position().distance(point) > 20.0);
    let (mut burning, mut others) = (0, 0);
    for (&cell, vegetation) in setting.bushes.iter().zip(&state.bushes) {
        let centre = setting.frame.centre(cell);
        if is_free(centre) {
            let (x, y) = projection.at(centre);
            let colour = seen.pixel(pane.left + x as u32, pane.top + y as u32);
            let burns = matches!(vegetation, BushState::Burning { .. });
            assert_eq!(is_fire_coloured(colour), burns, "{cell:?} {vegetation:?} {colour:?}");
            *(if burns { &mut burning } else { &mut others }) += 1;
        }
    }
    assert!(burning > 3 && others > 3, "{burning} burning, {others} others");
}

#[test]
fn keys_and_mouse_do_what_help_says() {
    let Some(_hands) = hands() else { return };
    let (folder, runs) = recorded(&[1]);
    let window = open(&folder, &["1.wildfire", "--at", "600", "--paused"]);
    let mut frame = Frame::new(&runs, ViewOptions::default());
    let at_600 = frame.wait_for(&window, seconds(600.0));
    window.wait_for_title("contest, seed 1 - 0:10:00.0 - paused");

    window.press(&["Right"]);
    frame.wait_for(&window, seconds(610.0));
    window.wait_for_title("0:10:10.0 - paused");
    window.press(&["shift+Left", "Left"]);
    frame.wait_for(&window, seconds(540.0));
    window.press(&["period"]);
    let event = runs[0].index().next_event(seconds(540.0)).expect("the run goes on");
    frame.wait_for(&window, event);
    window.press(&["End"]);
    frame.wait_for(&window, runs[0].timeline().end_time());
    window.press(&["Home"]);
    let at_start = frame.wait_for(&window, SimTime::ZERO);
    assert!(at_start != at_600);

    let timeline = FrameLayout::new(SIZE, 1).timeline;
    let (left, y) = (f64::from(timeline.left), f64::from(timeline.top + timeline.height / 2));
    let half = (left + 0.5 * f64::from(timeline.width)).floor();
    window.drag((left + 20.0, y), (half, y));
    let share = (half - left) / f64::from(timeline.width);
    let scrubbed = seconds(share * runs[0].timeline().end_time().as_seconds());
    let before = frame.wait_for(&window, scrubbed);

    window.press(&[&key_of(Layer::GridLines)]);
    frame.options.layers.toggle(Layer::GridLines);
    let with_grid = frame.wait_for(&window, scrubbed);
    assert!(with_grid != before);
    window.press(&[&key_of(Layer::GridLines)]);
    frame.options.layers.toggle(Layer::GridLines);

    let (pane, field) = (FrameLayout::new(SIZE, 1).fields[0], runs[0].timeline().setting.frame);
    let (size, at) = ((f64::from(pane.width), f64::from(pane.height)), (150.0, 100.0));
    window.mouse_to((f64::from(pane.left) + at.0, f64::from(pane.top) + at.1));
    window.click("4");
    // Of the wheels that are buttons winit 0.30 takes the press for a notch, and the release for another.
    let zoomed = |camera: Camera| camera.zoomed(&field, size, ops::exp(0.2), at);
    frame.options.camera = zoomed(zoomed(Camera::WHOLE));
    frame.wait_for(&window, scrubbed);
    window.press(&["z"]);
    frame.options.camera = Camera::WHOLE;
    frame.wait_for(&window, scrubbed);

    let bush = runs[0].timeline().setting.bushes[0];
    let (x, y) = Projection::new(&field, Camera::WHOLE, size).at(field.centre(bush));
    window.mouse_to((f64::from(pane.left) + f64::from(x), f64::from(pane.top) + f64::from(y)));
    window.click("1");
    frame.options.selected = Some((0, Selected::Bush(bush)));
    frame.wait_for(&window, scrubbed);
    window.press(&["Escape", "f"]);
    frame.options.selected = None;
    frame.options.follows = Some(CameraTarget::Agent(runs[0].timeline().setting.agents[0].id));
    frame.wait_for(&window, scrubbed);

    window.press(&["question"]);
    frame.options.shows_help = true;
    frame.wait_for(&window, scrubbed);
    window.press(&["Escape"]);
    frame.options.shows_help = false;
    frame.wait_for(&window, scrubbed);

    window.press(&["q"]);
    let (status, stderr) = window.wait_for_end();
    assert_eq!((status.code(), stderr.as_str()), (Some(0), ""));
}

fn key_of(layer: Layer) -> String {
    layer.key().to_ascii_lowercase().to_string()
}

#[test]
fn pause_holds_and_playing_goes_on() {
    let Some(_hands) = hands() else { return };
    let (folder, runs) = recorded(&[1]);
    let window = open(&folder, &["1.wildfire", "--at", "600", "--paused"]);
    let frame = Frame::new(&runs, ViewOptions::default());
    let first = frame.wait_for(&window, seconds(600.0));
    // Many frames could have gone by while three screenshots were taken.
    assert!((0..3).all(|_| window.screenshot().as_ref() == Some(&first)));
    window.press(&["space"]);
    let second = wait_for("a later frame", || window.screenshot().filter(|seen| *seen != first));
    wait_for("a still later frame", || window.screenshot().filter(|seen| *seen != second));
    window.press(&["space"]);
    window.wait_for_title("paused");
    let clock = title_clock(&window.title());
    assert!(clock > 600.0, "{clock}");
}

/// Seconds on the clock in a title such as `contest, seed 7 - 0:10:00.0 - paused`.
fn title_clock(title: &str) -> f64 {
    let clock = title.split(" - ").nth(1).expect("a title has a clock");
    clock.split(':').fold(0.0, |sum, part| 60.0 * sum + part.parse::<f64>().expect("a number"))
}

#[test]
fn still_is_what_the_window_shows_and_replaces_none() {
    let Some(_hands) = hands() else { return };
    let (folder, runs) = recorded(&[1]);
    let window = open(&folder, &["1.wildfire", "--at", "600", "--paused"]);
    let frame = Frame::new(&runs, ViewOptions::default());
    let seen = frame.wait_for(&window, seconds(600.0));
    window.press(&["s"]);
    let first = folder.path().join("contest-seed-1-600.0s.png");
    wait_for("a still", || first.is_file().then_some(()));
    window.press(&["s"]);
    let second = folder.path().join("contest-seed-1-600.0s-2.png");
    wait_for("a second still", || second.is_file().then_some(()));
    let saved = image::open(&first).expect("a PNG file").into_rgb8();
    let expected = picture(&frame.runs, seconds(600.0), &frame.options, SIZE);
    let pane = FrameLayout::new(SIZE, 1).fields[0];
    for (x, y, pixel) in saved.enumerate_pixels() {
        assert_eq!(pixel.0, expected.pixel(x, y));
        let is_seen = pixel.0.iter().zip(seen.pixel(x, y)).all(|(&saved, seen)| saved.abs_diff(seen) <= 2);
        assert!(is_seen || !pane.contains((f64::from(x), f64::from(y))), "pixel {x}, {y}");
    }
    assert_eq!(std::fs::read(&first).expect("readable"), std::fs::read(&second).expect("readable"));
}

#[test]
fn two_runs_are_compared_on_one_clock() {
    let Some(_hands) = hands() else { return };
    let (folder, runs) = recorded(&[7, 8]);
    let window = open(&folder, &["7.wildfire", "--with", "8.wildfire", "--at", "600", "--paused"]);
    let frame = Frame::new(&runs, ViewOptions::default());
    let seen = frame.wait_for(&window, seconds(600.0));
    window.wait_for_title("contest, seed 7 | contest, seed 8 - 0:10:00.0 - paused");
    let panes = FrameLayout::new(SIZE, 2).fields;
    let (width, height) = (panes[0].width.min(panes[1].width), panes[0].height);
    let differing = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).filter(|&(x, y)| {
        seen.pixel(panes[0].left + x, panes[0].top + y) != seen.pixel(panes[1].left + x, panes[1].top + y)
    });
    assert!(differing.count() > (width * height / 100) as usize);
    window.press(&["Right"]);
    frame.wait_for(&window, seconds(610.0));
}

#[test]
fn resized_window_shows_a_frame_of_its_new_size() {
    let Some(_hands) = hands() else { return };
    let (folder, runs) = recorded(&[1]);
    let window = open(&folder, &["1.wildfire", "--at", "600", "--paused"]);
    window.wait_for_title("paused");
    window.resize((801, 503));
    let options = with_status(&ViewOptions::default(), true, SPEED);
    let expected = picture(&[&runs[0]], seconds(600.0), &options, (801, 503));
    wait_for("the larger frame", || window.screenshot().filter(|seen| seen.differences(&expected) == 0));
}

#[test]
fn next_seed_of_a_scenario_is_simulated_and_shown() {
    let Some(_hands) = hands() else { return };
    let folder = tempfile::tempdir().expect("a scratch folder");
    let window = open(&folder, &["smoke", "--seed", "7", "--paused"]);
    window.wait_for_title("smoke, seed 7 - 0:00:00.0 - paused");
    window.press(&["n"]);
    window.wait_for_title("smoke, seed 8 - 0:00:00.0 - paused");
    window.press(&["p"]);
    window.wait_for_title("smoke, seed 7 - 0:00:00.0 - paused");
    window.press(&["r"]);
    wait_for("seed 8 from the beginning", || window.title().starts_with("smoke, seed 8 - ").then_some(()));
}

#[test]
fn window_that_is_taken_away_ends_the_program_and_leaves_the_recording() {
    let Some(_hands) = hands() else { return };
    let (folder, runs) = recorded(&[1]);
    let recording = folder.path().join("1.wildfire");
    let before = std::fs::read(&recording).expect("readable");
    let window = open(&folder, &["1.wildfire", "--at", "600", "--paused"]);
    Frame::new(&runs, ViewOptions::default()).wait_for(&window, seconds(600.0));
    window.destroy();
    let (status, stderr) = window.wait_for_end();
    assert_eq!(status.code(), Some(3), "{stderr}");
    assert!(!stderr.contains("panic"), "{stderr}");
    assert_eq!(std::fs::read(&recording).expect("readable"), before);
}
