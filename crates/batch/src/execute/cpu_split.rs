//! The CPU time of a run by phase, as named in the contest's Table II.

use std::time::Duration;

use wildfire_sim::{AgentCost, RunCost};
use wildfire_timeline::AgentId;

/// CPU time by phase in seconds, summed over agents of a kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CpuSplit {
    pub terrain_s: f64,
    pub clearance_field_s: f64,
    /// Sampling of roadmaps.
    pub sampling_s: f64,
    /// Connecting of roadmaps.
    pub map_generation_s: f64,
    pub roadmap_search_s: f64,
    /// The trucks' motion primitives.
    pub local_search_s: f64,
    /// The trucks' reachability floods and the searches that follow them.
    pub reachability_s: f64,
    /// Making the trucks' custom planners, including the starts of their programs.
    pub custom_start_s: f64,
    /// Queries to custom planners.
    pub custom_queries_s: f64,
    /// Decisions of the policy that dispatches the trucks.
    pub dispatch_s: f64,
    /// Custom policies of trucks and Wumpuses, including the starts of their programs.
    pub policy_s: f64,
    /// All planning of Wumpuses.
    pub wumpus_s: f64,
    pub run_s: f64,
}

impl CpuSplit {
    pub fn from_cost(cost: &RunCost) -> Self {
        let trucks = |phase: fn(&AgentCost) -> Duration| sum_over(cost, is_truck, phase);
        Self {
            terrain_s: cost.terrain.as_secs_f64(),
            clearance_field_s: cost.clearance_field.as_secs_f64(),
            sampling_s: trucks(|agent| agent.sampling),
            map_generation_s: trucks(|agent| agent.connecting),
            roadmap_search_s: trucks(|agent| agent.roadmap_search),
            local_search_s: trucks(|agent| agent.local_search),
            reachability_s: trucks(|agent| agent.reachability),
            custom_start_s: trucks(|agent| agent.starting),
            custom_queries_s: trucks(|agent| agent.queries),
            dispatch_s: cost.dispatch.as_secs_f64(),
            policy_s: cost.policies.as_secs_f64(),
            wumpus_s: sum_over(cost, |id| !is_truck(id), all_phases),
            run_s: cost.total.as_secs_f64(),
        }
    }

    /// Returns the time of the probabilistic roadmap alone: clearance field, sampling, map generation, roadmap search.
    pub fn prm_total_s(&self) -> f64 {
        self.clearance_field_s + self.sampling_s + self.map_generation_s + self.roadmap_search_s
    }

    /// Returns the time of all planning of trucks.
    pub fn unimog_total_s(&self) -> f64 {
        let built_in_s = self.prm_total_s() + self.local_search_s + self.reachability_s;
        built_in_s + self.custom_start_s + self.custom_queries_s + self.dispatch_s
    }

    /// Returns whether a truck has a custom planner.
    pub fn has_custom_planner(&self) -> bool {
        self.custom_start_s + self.custom_queries_s > 0.0
    }

    pub fn planners_s(&self) -> f64 {
        self.unimog_total_s() + self.wumpus_s
    }

    /// Returns the time outside terrain, planners and policies: events, fire, bookkeeping.
    pub fn rest_s(&self) -> f64 {
        (self.run_s - self.terrain_s - self.planners_s() - self.policy_s).max(0.0)
    }
}

fn is_truck(agent: AgentId) -> bool {
    agent.role.suppresses()
}

fn all_phases(agent: &AgentCost) -> Duration {
    agent.sampling + agent.connecting + agent.roadmap_search + agent.local_search + agent.reachability
}

fn sum_over(cost: &RunCost, is_selected: impl Fn(AgentId) -> bool, phase: impl Fn(&AgentCost) -> Duration) -> f64 {
    let of_kind = cost.agents.iter().filter(|agent| is_selected(agent.agent));
    of_kind.map(phase).sum::<Duration>().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agent_cost(agent: AgentId, unit_ms: u64) -> AgentCost {
        let part = |factor| Duration::from_millis(unit_ms * factor);
        AgentCost {
            agent,
            sampling: part(1),
            connecting: part(2),
            roadmap_search: part(3),
            local_search: part(4),
            reachability: part(5),
            starting: part(6),
            queries: part(7),
            ..AgentCost::new(agent)
        }
    }

    #[test]
    fn parts_add_up_to_the_run() {
        let cost = RunCost {
            terrain: Duration::from_millis(7),
            clearance_field: Duration::from_millis(11),
            dispatch: Duration::from_millis(3),
            policies: Duration::from_millis(5),
            agents: vec![
                agent_cost(AgentId::wumpus(0), 100),
                agent_cost(AgentId::unimog(0), 10),
                agent_cost(AgentId::unimog(1), 1),
            ],
            total: Duration::from_secs(2),
            ..RunCost::default()
        };
        let split = CpuSplit::from_cost(&cost);
        let close = |found: f64, expected_ms: f64| assert!((found * 1e3 - expected_ms).abs() < 1e-9, "{expected_ms}");
        close(split.sampling_s, 11.0);
        close(split.local_search_s, 44.0);
        close(split.prm_total_s(), 11.0 + 11.0 + 22.0 + 33.0);
        close(split.unimog_total_s(), 11.0 + 165.0 + 143.0 + 3.0);
        close(split.wumpus_s, 1500.0);
        close(split.terrain_s + split.planners_s() + split.policy_s + split.rest_s(), 2000.0);
    }
}
