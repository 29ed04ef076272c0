//! What the viewer has chosen to see, and what they are told.

use bevy::prelude::Resource;

use super::Player;
use crate::picture::film::{Film, Look, Status};
use crate::timeline::AgentId;

/// What the viewer has chosen to see, and what they are told.
#[derive(Clone, Debug, PartialEq, Resource)]
pub struct Viewer {
    /// Without a status, which follows from the player.
    pub look: Look,
    /// Until the next key.
    pub message: Option<String>,
}

impl Viewer {
    /// The look of the window's frame.
    pub fn look(&self, player: &Player) -> Look {
        let status = Status { is_paused: player.is_paused(), speed: player.speed(), message: self.message.clone() };
        Look { status: Some(status), ..self.look.clone() }
    }

    /// Goes with the next agent of a run, and with none after the last.
    pub fn follow_next(&mut self, film: &Film) {
        let agents: Vec<AgentId> = film.timeline().setting.agents.iter().map(|agent| agent.id).collect();
        let next = match self.look.follows {
            None => 0,
            Some(followed) => agents.iter().position(|&agent| agent == followed).map_or(0, |at| at + 1),
        };
        self.look.follows = agents.get(next).copied();
    }
}
