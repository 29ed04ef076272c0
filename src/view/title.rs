//! The title of the window: what runs, when, and whether it is paused.

use std::time::Duration;

use bevy::prelude::{Local, Query, Real, Res, Time, Window, With};
use bevy::window::PrimaryWindow;

use super::{Player, Reels};
use crate::picture::film::{Film, clock};

/// While playing the title changes no more often than this.
const PERIOD: Duration = Duration::from_millis(250);

pub fn set_title(
    mut windows: Query<&mut Window, With<PrimaryWindow>>,
    mut changed: Local<Duration>,
    time: Res<Time<Real>>,
    player: Res<Player>,
    reels: Res<Reels>,
) {
    let is_early = time.elapsed() < *changed + PERIOD;
    let (false, Ok(mut window)) = (is_early && !player.is_paused(), windows.single_mut()) else { return };
    let title = title(&player, &reels);
    if window.title != title {
        window.title = title;
        *changed = time.elapsed();
    }
}

fn title(player: &Player, reels: &Reels) -> String {
    let runs: Vec<String> = reels.films().into_iter().map(run_title).collect();
    let pace = if player.is_paused() { "paused".into() } else { format!("{} x", player.speed()) };
    format!("{} - {} - {pace}", runs.join(" | "), clock(player.clock()))
}

fn run_title(film: &Film) -> String {
    format!("{}, seed {}", film.title(), film.timeline().setting.seed)
}
