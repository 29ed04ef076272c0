//! What the viewer has chosen to see, and what they are told.

use bevy::prelude::Resource;

use super::Player;
use crate::picture::film::{RunView, Status, ViewOptions};
use crate::timeline::AgentId;

/// What the viewer has chosen to see, and what they are told.
#[derive(Clone, Debug, PartialEq, Resource)]
pub struct Viewer {
    /// Without a status, which follows from the player.
    pub options: ViewOptions,
    /// Until the next key.
    pub message: Option<String>,
}

impl Viewer {
    /// The look of the window's frame.
    pub fn options(&self, player: &Player) -> ViewOptions {
        let status = Status { is_paused: player.is_paused(), speed: player.speed(), message: self.message.clone() };
        ViewOptions { status: Some(status), ..self.options.clone() }
    }

    /// Goes with the next agent of a run, and with none after the last.
    pub fn follow_next(&mut self, run: &RunView) {
        let agents: Vec<AgentId> = run.timeline().setting.agents.iter().map(|agent| agent.id).collect();
        let next = match self.options.follows {
            None => 0,
            Some(followed) => agents.iter().position(|&agent| agent == followed).map_or(0, |at| at + 1),
        };
        self.options.follows = agents.get(next).copied();
    }
}
