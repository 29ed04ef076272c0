//! The title of the window: what runs, when, and whether it is paused.

use std::time::Duration;

use bevy::prelude::{Local, Query, Real, Res, Time, Window, With};
use bevy::window::PrimaryWindow;

use super::{Player, RunSet};
use crate::picture::film::{RunView, format_clock};

/// While playing the title changes no more often than this.
const PERIOD: Duration = Duration::from_millis(250);

pub fn set_title(
    mut windows: Query<&mut Window, With<PrimaryWindow>>,
    mut changed: Local<Duration>,
    time: Res<Time<Real>>,
    player: Res<Player>,
    runs: Res<RunSet>,
) {
    let is_early = time.elapsed() < *changed + PERIOD;
    let (false, Ok(mut window)) = (is_early && !player.is_paused(), windows.single_mut()) else { return };
    let title = title(&player, &runs);
    if window.title != title {
        window.title = title;
        *changed = time.elapsed();
    }
}

fn title(player: &Player, runs: &RunSet) -> String {
    let runs: Vec<String> = runs.runs().into_iter().map(run_title).collect();
    let pace = if player.is_paused() { "paused".into() } else { format!("{} x", player.speed()) };
    format!("{} - {} - {pace}", runs.join(" | "), format_clock(player.clock()))
}

fn run_title(run: &RunView) -> String {
    format!("{}, seed {}", run.title(), run.timeline().setting.seed)
}
