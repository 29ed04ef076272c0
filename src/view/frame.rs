//! What happens in one frame, without the screen.

use bevy::app::{App, Plugin, Update};
use bevy::prelude::{IntoScheduleConfigs, Res, ResMut, SystemCondition, SystemSet, Time, resource_exists_and_changed};
use bevy::window::WindowEvent;

use super::input::listen;
use super::mouse::Mouse;
use super::reels::Step;
use super::{Player, Reels, Sheet, Viewer};
use crate::picture::film::Shot;
use crate::time::SimTime;

/// The steps of a frame, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, SystemSet)]
pub enum ViewSystems {
    /// The time since the last frame passes as it was left: what is asked for now comes after it.
    Time,
    Input,
    /// Runs that were sent for arrive.
    Reels,
    /// The sheet is painted, if anything on it may have changed.
    Paint,
}

/// Time, keys, mouse and further runs; needs a [`Player`], a [`Viewer`], [`Reels`] and a [`Sheet`].
pub struct PlayerPlugin;

impl Plugin for PlayerPlugin {
    fn build(&self, app: &mut App) {
        let anything_changed = resource_exists_and_changed::<Player>
            .or_eager(resource_exists_and_changed::<Viewer>)
            .or_eager(resource_exists_and_changed::<Reels>)
            .or_eager(is_blank);
        app.add_message::<WindowEvent>()
            .init_resource::<Mouse>()
            .configure_sets(
                Update,
                (ViewSystems::Time, ViewSystems::Input, ViewSystems::Reels, ViewSystems::Paint).chain(),
            )
            .add_systems(
                Update,
                (
                    pass_time.in_set(ViewSystems::Time),
                    listen.in_set(ViewSystems::Input),
                    receive_films.in_set(ViewSystems::Reels).run_if(is_waiting),
                    paint.in_set(ViewSystems::Paint).run_if(anything_changed),
                ),
            );
    }
}

/// The clock goes on, unless the viewer holds it.
fn pass_time(mut player: ResMut<Player>, mouse: Res<Mouse>, time: Res<Time>) {
    if !player.is_paused() && !mouse.scrubs() {
        player.advance(time.delta());
    }
}

fn is_waiting(reels: Res<Reels>) -> bool {
    reels.is_waiting()
}

fn receive_films(mut reels: ResMut<Reels>, mut player: ResMut<Player>, mut viewer: ResMut<Viewer>) {
    match reels.receive() {
        None => {}
        Some(Err(reason)) => viewer.message = Some(reason),
        Some(Ok(step)) => {
            viewer.message = None;
            viewer.look.selected = None;
            player.change_end(reels.end());
            if step == Step::Rerun {
                player.seek(SimTime::ZERO);
                player.play();
            }
        }
    }
}

fn is_blank(sheet: Res<Sheet>) -> bool {
    sheet.is_blank()
}

fn paint(reels: Res<Reels>, player: Res<Player>, viewer: Res<Viewer>, mut sheet: ResMut<Sheet>) {
    let look = viewer.look(&player);
    let shot = Shot { films: &reels.films(), time: player.clock(), look: &look };
    sheet.paint(&shot);
}
