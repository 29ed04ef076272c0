//! Runs to show, and what a window that shows them should look like.

use wildfire::picture::Picture;
use wildfire::picture::film::{Film, Look, Shot, Status, still};
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
pub fn with_status(look: &Look, is_paused: bool, speed: f64) -> Look {
    Look { status: Some(Status { is_paused, speed, message: None }), ..look.clone() }
}

pub fn picture(films: &[&Film], time: SimTime, look: &Look, size: (u32, u32)) -> Picture {
    still(&Shot { films, time, look }, size)
}
