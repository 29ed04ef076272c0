//! The payload of a recording before deflation: postcard records in which cells and agents are places in their lists,
//! times are differences, and what can be computed again is left out.

use serde::{Deserialize, Serialize};

use super::FileError;
use crate::fire::FireRules;
use crate::geometry::{FieldFrame, Pose};
use crate::planning::{Effort, PlanFailure, SearchPhase};
use crate::time::SimTime;
use crate::timeline::{AgentId, AgentStart, Body, EndReason, RestReason, Rules, Setting};
use crate::trajectory::SpeedLimits;

/// The payload; since format 3 a [`Supplement`] follows.
#[derive(Serialize, Deserialize)]
pub struct Payload<'a> {
    pub scenario: &'a str,
    pub seed: u64,
    pub program_version: &'a str,
    pub frame: FieldFrame,
    /// Index of each bush, less that of the one before it.
    pub bush_steps: Vec<u32>,
    pub agents: Vec<AgentRecord>,
    pub rules: RulesRecord,
    pub facts: u32,
    /// Per fact, in order: nanoseconds since the fact before it.
    pub delays: &'a [u8],
    /// Per fact: a [`Record`], then what it announces.
    pub records: &'a [u8],
    pub recurring_numbers: Vec<f64>,
    pub single_numbers: Vec<f64>,
    pub number_references: &'a [u8],
}

/// What all formats hold of an agent.
#[derive(Serialize, Deserialize)]
pub struct AgentRecord {
    id: AgentId,
    pose: Pose,
    body: Body,
}

/// What all formats hold of the rules.
#[derive(Serialize, Deserialize)]
pub struct RulesRecord {
    duration: SimTime,
    suppression_reach_m: Option<f64>,
    suppression_dwell: SimTime,
    relight: bool,
    score_wumpus_ignited: f64,
    score_wumpus_burned_out: f64,
    score_truck_extinguished: f64,
}

/// What format 3 adds to the setting.
#[derive(Default, Serialize, Deserialize)]
pub struct Supplement {
    /// In the order of the agents; none are there where nothing is known of any.
    limits: Vec<Option<SpeedLimits>>,
    extinguishes_all: Option<bool>,
    fire: Option<FireRules>,
}

impl From<&AgentStart> for AgentRecord {
    fn from(&AgentStart { id, pose, body, limits: _ }: &AgentStart) -> Self {
        Self { id, pose, body }
    }
}

impl From<Rules> for RulesRecord {
    fn from(rules: Rules) -> Self {
        Self {
            duration: rules.duration,
            suppression_reach_m: rules.suppression_reach_m,
            suppression_dwell: rules.suppression_dwell,
            relight: rules.relight,
            score_wumpus_ignited: rules.score_wumpus_ignited,
            score_wumpus_burned_out: rules.score_wumpus_burned_out,
            score_truck_extinguished: rules.score_truck_extinguished,
        }
    }
}

impl From<&Setting> for Supplement {
    fn from(setting: &Setting) -> Self {
        Self {
            limits: setting.agents.iter().map(|agent| agent.limits).collect(),
            extinguishes_all: setting.rules.extinguishes_all,
            fire: setting.rules.fire,
        }
    }
}

impl Supplement {
    pub fn agents(&self, records: &[AgentRecord]) -> Vec<AgentStart> {
        let limits = self.limits.iter().copied().chain(std::iter::repeat(None));
        let agent = |(&AgentRecord { id, pose, body }, limits)| AgentStart { id, pose, body, limits };
        records.iter().zip(limits).map(agent).collect()
    }

    pub fn rules(&self, record: &RulesRecord) -> Rules {
        Rules {
            duration: record.duration,
            suppression_reach_m: record.suppression_reach_m,
            suppression_dwell: record.suppression_dwell,
            extinguishes_all: self.extinguishes_all,
            fire: self.fire,
            relight: record.relight,
            score_wumpus_ignited: record.score_wumpus_ignited,
            score_wumpus_burned_out: record.score_wumpus_burned_out,
            score_truck_extinguished: record.score_truck_extinguished,
        }
    }
}

/// A fact; `agent` and `bush` are places in the setting's lists.
#[derive(Serialize, Deserialize)]
pub enum Record {
    /// Three numbers hold the pose.
    StartMoved {
        agent: u32,
    },
    RoadmapBuilt {
        agent: u32,
        samples: u32,
        edges: u32,
        components: u32,
    },
    /// So many steps from bush to bush follow, as `i32`.
    OutOfReach {
        agent: u32,
        count: u32,
    },
    Lit {
        bush: u32,
        agent: u32,
    },
    Spread {
        bush: u32,
        from: u32,
    },
    Scheduled {
        bush: u32,
    },
    BurnedOut {
        bush: u32,
    },
    Extinguished {
        bush: u32,
        agent: u32,
    },
    /// A [`Leg`] follows.
    Planned {
        agent: u32,
        bush: u32,
        effort: Effort,
        by_lattice: bool,
    },
    /// `charged_ns` from the fact's time on.
    PlanFailed {
        agent: u32,
        bush: u32,
        reason: PlanFailure,
        effort: Effort,
        charged_ns: u64,
    },
    /// A [`Leg`] follows.
    Dropped {
        agent: u32,
        bush: u32,
    },
    Suppressing {
        agent: u32,
        bush: u32,
    },
    SuppressionEnded {
        agent: u32,
        bush: u32,
    },
    Rested {
        agent: u32,
        reason: RestReason,
    },
    Ended {
        reason: EndReason,
    },
    /// Two numbers hold the place. Since format 2.
    LocalMinimum {
        agent: u32,
        bush: u32,
    },
    /// Since format 3.
    Blocked {
        agent: u32,
        bush: u32,
        by: u32,
    },
    /// A [`Leg`] follows. Since format 3.
    GaveWay {
        agent: u32,
        to: u32,
    },
    /// A graph of so many places and edges follows. Since format 4.
    Searched {
        agent: u32,
        phase: SearchPhase,
        places: u32,
        edges: u32,
    },
}

/// A leg: where and when it begins, and how many [`PieceKind`]s follow.
#[derive(Serialize, Deserialize)]
pub struct Leg {
    pub origin: Origin,
    pub pieces: u32,
}

#[derive(Serialize, Deserialize)]
pub enum Origin {
    /// Where the agent's last leg ended, so many nanoseconds after the fact.
    LastEnd { delay_ns: u64 },
    /// Where and when the agent's last leg began, and along so many of its pieces.
    LastStart { shared: u32 },
    /// From a pose in three numbers; nanoseconds after the fact, or before it.
    Elsewhere { delay_ns: i64 },
}

#[derive(Serialize, Deserialize)]
pub enum PieceKind {
    /// Four numbers: curvature, length, speed, acceleration.
    Drive,
    /// One number: the heading.
    Turn,
    /// One number: seconds.
    Wait,
}

/// Adds a value's bytes to others.
pub fn append(bytes: &mut Vec<u8>, value: &impl Serialize) {
    let taken = std::mem::take(bytes);
    *bytes = postcard::to_extend(value, taken).expect("plain values fit a vector that grows");
}

/// Reads a value from the front of some bytes.
pub fn take<'a, T: Deserialize<'a>>(bytes: &mut &'a [u8]) -> Result<T, FileError> {
    let (value, rest) =
        postcard::take_from_bytes(bytes).map_err(|_| FileError::Damaged("a record in it cannot be read"))?;
    *bytes = rest;
    Ok(value)
}
