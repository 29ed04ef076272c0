//! What a frame of the window costs beside a frame of an empty one, on the display that DISPLAY names.
//!
//! Windows of the same size and present mode are opened in turn, each in a process of its own, since a process has one
//! event loop only: an empty one with bevy's default plugins and a camera, the same without multisampling, which the
//! sprite needs no more than an empty window does, and one that plays the contest at 50 times from 600 s on with all that
//! fire does. All that is shown is one sprite, hence one draw call.
//!
//! `cargo bench --features view --bench window -- 10` looks at each window for 10 seconds.

use std::env;
use std::error::Error;
use std::process::{Command, ExitCode};

use bevy::DefaultPlugins;
use bevy::app::{App, AppExit, Last, PluginGroup, Startup};
use bevy::prelude::{Camera2d, Commands, IntoScheduleConfigs, MessageWriter, Msaa, Query, Res, ResMut, Resource};
use bevy::window::{PresentMode, Window, WindowPlugin, WindowResolution};
use bevy::winit::WinitSettings;
use wildfire::picture::film::{RunView, ViewOptions};
use wildfire::time::SimTime;
use wildfire::time::wall::WallStopwatch;
use wildfire::view::{self, ViewerConfig};
use wildfire::{scenario, sim};

const SIDE: u32 = 1000;
const ROUNDS: usize = 3;
const SECONDS: f64 = 5.0;
/// Frames until shaders are loaded and caches filled.
const WARM_UP_FRAMES: usize = 20;

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "a benchmark prints its figures")]
fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let args: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let seconds = args.last().and_then(|word| word.parse().ok()).unwrap_or(SECONDS);
    let report = match args.first() {
        Some(&"empty") => watch(empty_window(Msaa::default()), seconds),
        Some(&"unsampled") => watch(empty_window(Msaa::Off), seconds),
        Some(&"playing") => playing_window().and_then(|(begin, app)| watch((begin, app), seconds)),
        _ => compare(seconds),
    };
    match report {
        Ok(report) => {
            println!("{report}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

type Answer<T> = Result<T, Box<dyn Error>>;

/// What a window's process reports: milliseconds from its start to the first frames, and of the median frame.
struct Watched {
    start_ms: f64,
    frame_ms: f64,
}

fn compare(seconds: f64) -> Answer<String> {
    if env::var_os("DISPLAY").is_none_or(|display| display.is_empty()) {
        return Err("there is no display: set DISPLAY, or run it with xvfb-run".into());
    }
    let (mut empty, mut unsampled, mut playing) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        empty.push(child("empty", seconds)?);
        unsampled.push(child("unsampled", seconds)?);
        playing.push(child("playing", seconds)?);
    }
    let [empty, unsampled, playing] = [empty, unsampled, playing].map(|windows| median_of(&windows));
    Ok(format!(
        "{SIDE} x {SIDE}, medians of {ROUNDS} windows of each kind, {seconds} s each\n\
         empty window: {:.1} ms a frame, {:.0} frames a second; without multisampling {:.1} ms\n\
         contest at 50 x: {:.1} ms a frame, {:.0} frames a second\n\
         ratio of frame times: {:.2}; to the one without multisampling {:.2}\n\
         contest, simulated, to its first frames: {:.2} s (empty window: {:.2} s)",
        empty.frame_ms,
        1e3 / empty.frame_ms,
        unsampled.frame_ms,
        playing.frame_ms,
        1e3 / playing.frame_ms,
        playing.frame_ms / empty.frame_ms,
        playing.frame_ms / unsampled.frame_ms,
        playing.start_ms / 1e3,
        empty.start_ms / 1e3,
    ))
}

fn child(kind: &str, seconds: f64) -> Answer<Watched> {
    let output = Command::new(env::current_exe()?).args([kind, &seconds.to_string()]).output()?;
    let printed = String::from_utf8_lossy(&output.stdout);
    let figures: Vec<f64> = printed.split_whitespace().filter_map(|figure| figure.parse().ok()).collect();
    match figures[..] {
        [start_ms, frame_ms] if output.status.success() => Ok(Watched { start_ms, frame_ms }),
        _ => Err(format!("the {kind} window: {}", String::from_utf8_lossy(&output.stderr).trim()).into()),
    }
}

fn median_of(windows: &[Watched]) -> Watched {
    let of = |figure: fn(&Watched) -> f64| median(windows.iter().map(figure).collect());
    Watched { start_ms: of(|window| window.start_ms), frame_ms: of(|window| window.frame_ms) }
}

fn median(mut figures: Vec<f64>) -> f64 {
    figures.sort_by(f64::total_cmp);
    figures.get(figures.len() / 2).copied().unwrap_or(f64::NAN)
}

fn empty_window(msaa: Msaa) -> (WallStopwatch, App) {
    let begin = WallStopwatch::start();
    let window = Window { resolution: WindowResolution::new(SIDE, SIDE), ..Window::default() };
    let mut app = App::new();
    app.add_plugins(DefaultPlugins.set(WindowPlugin { primary_window: Some(window), ..WindowPlugin::default() }))
        .insert_resource(WinitSettings::continuous())
        .add_systems(Startup, move |mut commands: Commands| _ = commands.spawn((Camera2d, msaa)));
    (begin, app)
}

fn playing_window() -> Answer<(WallStopwatch, App)> {
    let contest = scenario::load("contest", &[]).map_err(|error| error.to_string())?;
    let run = sim::run(&contest, 1).map_err(|error| error.to_string())?;
    let begin = WallStopwatch::start();
    let config = ViewerConfig {
        runs: vec![(RunView::new(run.timeline, None), None)],
        options: ViewOptions::default(),
        speed: 50.0,
        start: SimTime::from_seconds(600.0),
        is_paused: false,
        size: (SIDE, SIDE),
    };
    Ok((begin, view::window(config)?))
}

/// Times of the frames, in milliseconds since the start.
#[derive(Resource)]
struct Frames {
    begin: WallStopwatch,
    ends_ms: Vec<f64>,
    seconds: f64,
}

/// Runs the window for so many seconds and says its two figures.
fn watch((begin, mut app): (WallStopwatch, App), seconds: f64) -> Answer<String> {
    app.insert_resource(Frames { begin, ends_ms: Vec::new(), seconds })
        .add_systems(Startup, |mut windows: Query<&mut Window>| {
            windows.iter_mut().for_each(|mut window| window.present_mode = PresentMode::AutoNoVsync);
        })
        .add_systems(Last, (note_frame, report).chain());
    app.run();
    Ok(String::new())
}

fn note_frame(mut frames: ResMut<Frames>) {
    let now_ms = frames.begin.elapsed().as_secs_f64() * 1e3;
    frames.ends_ms.push(now_ms);
}

/// The world is gone when the window is closed, so the figures are said before.
#[expect(clippy::print_stdout, reason = "a benchmark prints its figures")]
fn report(frames: Res<Frames>, mut exit: MessageWriter<AppExit>) {
    let ends_ms = frames.ends_ms.get(WARM_UP_FRAMES..).unwrap_or_default();
    let (Some(first), Some(last)) = (ends_ms.first(), ends_ms.last()) else { return };
    if last - first > frames.seconds * 1e3 {
        let frame_ms = median(ends_ms.windows(2).map(|pair| pair[1] - pair[0]).collect());
        println!("{} {frame_ms}", frames.ends_ms[STARTED]);
        exit.write(AppExit::Success);
    }
}

/// By the end of this frame the picture of the first is on the display, where bevy paints a frame while the next is
/// prepared.
const STARTED: usize = 3;
