//! What decisions cost.

use std::time::Duration;

use super::AgentId;
use crate::time::SimTime;

/// CPU time that a decision of an agent took, its plans above all; measured, and so no part of a timeline.
#[derive(Clone, Copy, Debug)]
pub struct CpuSample {
    pub time: SimTime,
    pub agent: AgentId,
    pub cpu: Duration,
}
