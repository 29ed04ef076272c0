//! The identity of an agent: its role, and its number within the role.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The role of an agent in the contest. Abilities are queried here; only code that simulates or draws an agent tests
/// which role it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    Wumpus,
    Unimog,
}

wildfire_base::names! { Role { Wumpus: "wumpus", Unimog: "unimog" } }

impl Role {
    /// Returns true if agents of the role set bushes on fire.
    pub const fn lights(self) -> bool {
        matches!(self, Self::Wumpus)
    }

    /// Returns true if agents of the role extinguish fires.
    pub const fn suppresses(self) -> bool {
        matches!(self, Self::Unimog)
    }

    /// Returns true if agents of the role move on wheels, so that they can neither turn on the spot nor stand where
    /// another does.
    pub const fn drives(self) -> bool {
        matches!(self, Self::Unimog)
    }
}

/// An agent of a run: its role, and its number within the role, from 0. Agents are ordered by both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(from = "WrittenId", into = "WrittenId")]
pub struct AgentId {
    pub role: Role,
    pub number: u16,
}

impl AgentId {
    pub const fn wumpus(number: u16) -> Self {
        Self { role: Role::Wumpus, number }
    }

    pub const fn unimog(number: u16) -> Self {
        Self { role: Role::Unimog, number }
    }
}

impl fmt::Display for AgentId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.role.name(), self.number)
    }
}

/// An agent's name as recordings and journals hold it.
#[derive(Serialize, Deserialize)]
#[serde(rename = "AgentId")]
enum WrittenId {
    Wumpus(u16),
    Unimog(u16),
}

impl From<WrittenId> for AgentId {
    fn from(written: WrittenId) -> Self {
        match written {
            WrittenId::Wumpus(number) => Self::wumpus(number),
            WrittenId::Unimog(number) => Self::unimog(number),
        }
    }
}

impl From<AgentId> for WrittenId {
    fn from(AgentId { role, number }: AgentId) -> Self {
        match role {
            Role::Wumpus => Self::Wumpus(number),
            Role::Unimog => Self::Unimog(number),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_read_and_are_written_as_they_always_were() {
        for (agent, name, json) in
            [(AgentId::wumpus(0), "wumpus/0", r#"{"Wumpus":0}"#), (AgentId::unimog(7), "unimog/7", r#"{"Unimog":7}"#)]
        {
            assert_eq!(agent.to_string(), name);
            assert_eq!(serde_json::to_string(&agent).expect("it is plain data"), json);
            assert_eq!(serde_json::from_str::<AgentId>(json).expect("it was just written"), agent);
        }
        assert_eq!(postcard::to_allocvec(&AgentId::unimog(3)).expect("it is plain data"), [1, 3]);
    }

    #[test]
    fn wumpuses_come_before_trucks_and_then_numbers_count() {
        let mut agents = [AgentId::unimog(0), AgentId::wumpus(2), AgentId::unimog(1), AgentId::wumpus(0)];
        agents.sort();
        assert_eq!(agents.map(|agent| agent.to_string()), ["wumpus/0", "wumpus/2", "unimog/0", "unimog/1"]);
    }
}
