//! What happens in one frame, without the screen.

use bevy::app::{App, Plugin, Update};
use bevy::prelude::{IntoScheduleConfigs, Res, ResMut, SystemCondition, SystemSet, Time, resource_exists_and_changed};
use bevy::window::WindowEvent;

use super::input::listen;
use super::mouse::Mouse;
use super::run_set::SeedStep;
use super::{FrameBuffer, Player, RunSet, Viewer};
use crate::picture::film::FrameRequest;
use crate::time::SimTime;

/// The steps of a frame, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, SystemSet)]
pub enum ViewSystems {
    /// The time since the last frame passes as it was left: what is asked for now comes after it.
    Time,
    Input,
    /// Runs that were requested arrive.
    RunSet,
    /// The frame is drawn, if anything on it may have changed.
    Paint,
}

/// Time, keys, mouse and further runs; needs a [`Player`], a [`Viewer`], [`RunSet`] and a [`FrameBuffer`].
pub struct PlayerPlugin;

impl Plugin for PlayerPlugin {
    fn build(&self, app: &mut App) {
        let anything_changed = resource_exists_and_changed::<Player>
            .or_eager(resource_exists_and_changed::<Viewer>)
            .or_eager(resource_exists_and_changed::<RunSet>)
            .or_eager(is_blank);
        app.add_message::<WindowEvent>()
            .init_resource::<Mouse>()
            .configure_sets(
                Update,
                (ViewSystems::Time, ViewSystems::Input, ViewSystems::RunSet, ViewSystems::Paint).chain(),
            )
            .add_systems(
                Update,
                (
                    pass_time.in_set(ViewSystems::Time),
                    listen.in_set(ViewSystems::Input),
                    receive_runs.in_set(ViewSystems::RunSet).run_if(is_waiting),
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

fn is_waiting(runs: Res<RunSet>) -> bool {
    runs.is_waiting()
}

fn receive_runs(mut runs: ResMut<RunSet>, mut player: ResMut<Player>, mut viewer: ResMut<Viewer>) {
    match runs.receive() {
        None => {}
        Some(Err(reason)) => viewer.message = Some(reason),
        Some(Ok(step)) => {
            viewer.message = None;
            viewer.options.selected = None;
            player.change_end(runs.end());
            if step == SeedStep::Rerun {
                player.seek(SimTime::ZERO);
                player.play();
            }
        }
    }
}

fn is_blank(frame_buffer: Res<FrameBuffer>) -> bool {
    frame_buffer.is_blank()
}

fn paint(runs: Res<RunSet>, player: Res<Player>, viewer: Res<Viewer>, mut frame_buffer: ResMut<FrameBuffer>) {
    let options = viewer.options(&player);
    let request = FrameRequest { runs: &runs.runs(), time: player.clock(), options: &options };
    frame_buffer.paint(&request);
}
