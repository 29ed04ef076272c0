//! The steps of one frame without the screen, and the viewer's choices.

use bevy::app::{App, Plugin, Update};
use bevy::prelude::{
    IntoScheduleConfigs, Res, ResMut, Resource, SystemCondition, SystemSet, Time, resource_exists_and_changed,
};
use bevy::window::WindowEvent;

use crate::input::read_input;
use crate::mouse::Mouse;
use crate::run_set::SeedStep;
use crate::{FrameBuffer, Player, RunSet};
use wildfire_base::time::SimTime;
use wildfire_picture::film::{CameraTarget, FrameRequest, RunView, Status, ViewOptions};

/// The steps of a frame, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, SystemSet)]
pub enum ViewSystems {
    /// The time since the last frame passes as it was left: what is asked for now comes after it.
    Time,
    Input,
    /// Runs that were requested arrive.
    Runs,
    /// The frame is drawn, if anything on it may have changed.
    Draw,
}

/// Time, keys, mouse and further runs; needs a [`Player`], a [`Viewer`], [`RunSet`] and a [`FrameBuffer`].
pub struct PlayerPlugin;

impl Plugin for PlayerPlugin {
    fn build(&self, app: &mut App) {
        // Each remembers when it was last evaluated: one that is passed over would report an old change and draw a frame twice.
        let anything_changed = resource_exists_and_changed::<Player>
            .or_eager(resource_exists_and_changed::<Viewer>)
            .or_eager(resource_exists_and_changed::<RunSet>)
            .or_eager(is_blank);
        app.add_message::<WindowEvent>()
            .init_resource::<Mouse>()
            .configure_sets(
                Update,
                (ViewSystems::Time, ViewSystems::Input, ViewSystems::Runs, ViewSystems::Draw).chain(),
            )
            .add_systems(
                Update,
                (
                    pass_time.in_set(ViewSystems::Time),
                    read_input.in_set(ViewSystems::Input),
                    receive_runs.in_set(ViewSystems::Runs).run_if(is_waiting),
                    draw_frame.in_set(ViewSystems::Draw).run_if(anything_changed),
                ),
            );
    }
}

/// Advances the clock, unless the viewer holds it.
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
            // A seed has bushes of its own, so what was picked in the old run need not exist in the new one.
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

fn draw_frame(runs: Res<RunSet>, player: Res<Player>, viewer: Res<Viewer>, mut frame_buffer: ResMut<FrameBuffer>) {
    let options = viewer.options(&player);
    let request = FrameRequest { runs: &runs.runs(), time: player.clock(), options: &options };
    frame_buffer.paint(&request);
}

/// The viewer's choices, and the message shown to them.
#[derive(Clone, Debug, PartialEq, Resource)]
pub struct Viewer {
    /// Without a status, which follows from the player.
    pub options: ViewOptions,
    /// Until the next key.
    pub message: Option<String>,
}

impl Viewer {
    /// Returns the options of the window's frame.
    pub fn options(&self, player: &Player) -> ViewOptions {
        let status = Status { is_paused: player.is_paused(), speed: player.speed(), message: self.message.clone() };
        ViewOptions { status: Some(status), ..self.options.clone() }
    }

    /// Follows the fleet of a run if it has several trucks, then one agent after the other, and none after the last.
    pub fn follow_next(&mut self, run: &RunView) {
        let agents = &run.timeline().setting.agents;
        let is_fleet = agents.iter().filter(|agent| agent.id.role.suppresses()).count() > 1;
        let fleet = is_fleet.then_some(CameraTarget::Fleet);
        let all: Vec<CameraTarget> =
            fleet.into_iter().chain(agents.iter().map(|agent| CameraTarget::Agent(agent.id))).collect();
        let next = match self.options.follows {
            None => 0,
            Some(followed) => all.iter().position(|&other| other == followed).map_or(0, |at| at + 1),
        };
        self.options.follows = all.get(next).copied();
    }
}
