//! The CPU time of a run's decisions, one by one and accumulated over time.

use std::time::Duration;

use super::AgentId;
use wildfire_base::time::SimTime;

/// The CPU time of an agent's decision, mostly planning; it is measured, and therefore not part of a timeline.
#[derive(Clone, Copy, Debug)]
pub struct CpuSample {
    pub time: SimTime,
    pub agent: AgentId,
    pub cpu: Duration,
}

/// Accumulated CPU time, as steps: each value holds from its time on.
#[derive(Debug)]
pub struct CpuHistory {
    all: Vec<(SimTime, Duration)>,
    /// In order of the agents.
    by_agent: Vec<(AgentId, Vec<(SimTime, Duration)>)>,
}

impl CpuHistory {
    /// Creates the history from `cpu_samples` in order of time.
    pub fn new(cpu_samples: &[CpuSample]) -> Self {
        let mut agents: Vec<AgentId> = cpu_samples.iter().map(|spent| spent.agent).collect();
        agents.sort_unstable();
        agents.dedup();
        Self {
            all: sums(cpu_samples.iter()),
            by_agent: agents
                .into_iter()
                .map(|agent| (agent, sums(cpu_samples.iter().filter(|spent| spent.agent == agent))))
                .collect(),
        }
    }

    pub fn until(&self, time: SimTime) -> Duration {
        sum_at(&self.all, time)
    }

    pub fn of_agent_until(&self, agent: AgentId, time: SimTime) -> Duration {
        let place = self.by_agent.binary_search_by_key(&agent, |(id, _)| *id);
        place.map_or(Duration::ZERO, |place| sum_at(&self.by_agent[place].1, time))
    }
}

fn sums<'a>(cpu_samples: impl Iterator<Item = &'a CpuSample>) -> Vec<(SimTime, Duration)> {
    cpu_samples
        .scan(Duration::ZERO, |total, spent| {
            *total = total.saturating_add(spent.cpu);
            Some((spent.time, *total))
        })
        .collect()
}

fn sum_at(sums: &[(SimTime, Duration)], time: SimTime) -> Duration {
    let until = sums.partition_point(|sum| sum.0 <= time);
    until.checked_sub(1).map_or(Duration::ZERO, |last| sums[last].1)
}
