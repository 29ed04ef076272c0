//! What it costs to draw frames of runs, on the thread's CPU clock: stills, and frames that follow one another as in a
//! window that plays.
//!
//! `cargo bench --bench frames` draws sheets of 1000 x 1000 pixels with the usual layers, from 600 s on; a hundred trucks on four
//! million cells from half an hour on, the whole field and with the camera on the fleet; and a fire on a million cells of
//! grass, from an hour on.

use wildfire::picture::film::{CameraTarget, FrameRenderer, FrameRequest, RunView, ViewOptions, still};
use wildfire::time::SimTime;
use wildfire::time::cpu::CpuStopwatch;
use wildfire::{scenario, sim};

const SIZE: (u32, u32) = (1000, 1000);
const FROM_S: f64 = 600.0;
const CROWD_FROM_S: f64 = 1800.0;
const FRAMES: u32 = 300;
/// Simulated seconds from frame to frame: at twenty frames a second, once and fifty times as fast as the clock.
const STEPS_S: [f64; 2] = [0.05, 2.5];

fn main() {
    print(format_args!("{:28} {:>9} {:>14} {:>14}", "ms, medians (p95)", "a still", "1 x", "50 x"));
    let whole = ViewOptions::default();
    report("contest", &[run("contest", 1)], FROM_S, &whole);
    report("fleet", &[run("fleet", 1)], FROM_S, &whole);
    report("contest, two runs", &[run("contest", 1), run("contest", 2)], FROM_S, &whole);
    report("report-2024", &[run("report-2024", 1)], FROM_S, &whole);
    report("brigade", &[run("brigade", 1)], CROWD_FROM_S, &whole);
    let county = [run("county", 1)];
    report("county", &county, CROWD_FROM_S, &whole);
    let fleet = ViewOptions { follows: Some(CameraTarget::Fleet), ..whole.clone() };
    report("county, fleet followed", &county, CROWD_FROM_S, &fleet);
    report("1000 x 1000 cells of grass", &[changed_run("contest", &GRASS, 1)], 3600.0, &whole);
}

/// Twenty fires on 25 square kilometres, without agents.
const GRASS: [&str; 8] = [
    "field.size_m=5000",
    "field.coverage=0.005",
    "fire.model=rothermel",
    "wumpus=[]",
    "unimog=[]",
    "duration_s=7200",
    "ignition=[{at_s=0,random=20}]",
    "wind=[{at_s=0,speed_mps=5,toward_deg=20}]",
];

fn run(name: &str, seed: u64) -> RunView {
    changed_run(name, &[], seed)
}

fn changed_run(name: &str, changes: &[&str], seed: u64) -> RunView {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let scenario = scenario::load(name, &changes).expect("it is built in");
    RunView::new(sim::run(&scenario, seed).expect("it takes place").timeline, None)
}

fn report(name: &str, runs: &[RunView], from_s: f64, options: &ViewOptions) {
    let runs: Vec<&RunView> = runs.iter().collect();
    let request = |time_s: f64| FrameRequest { runs: &runs, time: SimTime::from_seconds(time_s), options };
    let stills = timed(20, |_| drop(still(&request(from_s), SIZE)));
    let playing = STEPS_S.map(|step_s| {
        let mut renderer = FrameRenderer::new(SIZE, runs.len());
        timed(FRAMES, |frame| {
            renderer.paint(&request(from_s + step_s * f64::from(frame)));
        })
    });
    let [once, fast] = playing.map(|times| format!("{:.2} ({:.2})", quantile(&times, 0.5), quantile(&times, 0.95)));
    print(format_args!("{name:28} {:>9.1} {once:>14} {fast:>14}", quantile(&stills, 0.5)));
}

/// Milliseconds of each turn, ascending.
fn timed(turns: u32, mut turn: impl FnMut(u32)) -> Vec<f64> {
    let mut watch = CpuStopwatch::start();
    let mut times: Vec<f64> = (0..turns)
        .map(|index| {
            turn(index);
            1e3 * watch.elapsed_since_last().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times
}

fn quantile(ascending: &[f64], share: f64) -> f64 {
    ascending[(share * (ascending.len() - 1) as f64).round() as usize]
}

#[expect(clippy::print_stdout, reason = "a benchmark prints its figures")]
fn print(line: std::fmt::Arguments) {
    println!("{line}");
}
