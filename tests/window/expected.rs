//! Runs to show, and what a window that shows them should look like.

use wildfire::picture::Picture;
use wildfire::picture::film::{FrameRequest, RunView, Status, ViewOptions, still};
use wildfire::time::SimTime;
use wildfire::timeline::Timeline;
use wildfire::{scenario, sim};

pub fn simulated(name: &str, seed: u64) -> Timeline {
    let scenario = scenario::load(name, &[]).expect("the built-in loads");
    sim::run(&scenario, seed).expect("it runs").timeline
}

pub fn seconds(seconds: f64) -> SimTime {
    SimTime::from_seconds(seconds)
}

/// The look of a window: `look`, and what the player says.
pub fn with_status(options: &ViewOptions, is_paused: bool, speed: f64) -> ViewOptions {
    ViewOptions { status: Some(Status { is_paused, speed, message: None }), ..options.clone() }
}

pub fn picture(runs: &[&RunView], time: SimTime, options: &ViewOptions, size: (u32, u32)) -> Picture {
    still(&FrameRequest { runs, time, options }, size)
}
