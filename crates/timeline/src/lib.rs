#![doc = include_str!("../README.md")]
//!
//! The record of a run: facts in chronological order, the state at any time, the outcome, the file.
//!
//! The simulation appends facts; windows, pictures, tables and audits read only these. The facts of one instant are in the
//! order in which they happened, and a state or a count at a time is the one after all facts of that time.

mod agent_id;
mod burn_map;
mod clairvoyant;
mod cpu;
pub mod export;
mod fact;
pub mod file;
mod index;
mod outcome;
mod progress;
mod replay;
#[doc(hidden)]
#[cfg(any(test, feature = "testing"))]
pub mod sample;
mod setting;
mod water;

pub use agent_id::{AgentId, Role};
pub use burn_map::{BurnMap, FireBehavior, Front};
pub use cpu::{CpuHistory, CpuSample};
pub use fact::{AgentFact, BushIgnition, Cause, EndReason, Event, Fact, FireFact, GroundEvent, GroundFact, RestReason};
pub use index::{
    AgentStats, Burning, BushCounts, ClearedCell, FollowedLeg, FoundSearch, GroundCounts, GroundIndex, RecordedSearch,
    RunIndex, SpreadMoment, SuppressionSpan, Wetting,
};
pub use outcome::{AgentOutcome, FLOCK_M, GroundOutcome, LineOutcome, Outcome, Winner};
pub use progress::Activity;
pub use replay::{AgentState, ChangedBush, Replay, State};
pub use setting::{AgentStart, Body, CrewRules, FlamingTimes, LineRules, Rules, Setting, SpreadSetting};
pub use water::{WaterEnergy, WaterRules};

use wildfire_base::time::SimTime;
pub use wildfire_fire::{BushState, BushStateKind};

/// A finished run: the setting, and the facts in the order in which they happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    /// The field, the agents and the rules.
    pub setting: Setting,
    /// Facts with their times, in the order in which they happened.
    pub events: Vec<Event>,
    /// The changes of the ground, in order of time; empty where only bushes burn.
    pub ground: Vec<GroundEvent>,
}

impl Timeline {
    /// Returns the end of the run: the time of its `Ended` fact, or its duration if there is none.
    pub fn end_time(&self) -> SimTime {
        let ended = self.events.iter().rev().find(|event| matches!(event.fact, Fact::Ended { .. }));
        ended.map_or(self.setting.rules.duration, |event| event.time)
    }

    /// Returns the state after all events at `time`; beyond the end, the state at the end.
    ///
    /// Costs a replay from the start, some tens of nanoseconds a fact. To go through a run in order keep a [`Replay`].
    pub fn state_at(&self, time: SimTime) -> State {
        let mut replay = Replay::new(self);
        replay.seek(time);
        replay.state()
    }
}
