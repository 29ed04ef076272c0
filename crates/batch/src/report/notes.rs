//! Notes on a finished run that its numbers do not show: agents with almost no options.

use crate::execute::RunResult;
use wildfire_planning::is_hardly_connected;

/// Returns sentences about the agents of a run whose plans could hardly succeed, in the order of the agents.
pub fn notes(result: &RunResult) -> Vec<String> {
    let outcome = &result.outcome;
    let notes = outcome.agents.iter().filter_map(|agent| {
        let (name, bushes) = (agent.agent, outcome.obstacles);
        let milestones = agent.roadmap_samples;
        let components = agent.roadmap_components;
        // Of a field without bushes, "none of the 0" would be true and say nothing.
        if name.role.lights() && bushes > 0 && agent.out_of_reach == bushes {
            Some(format!("{name} can light nothing: none of the {bushes} bushes is in its reach."))
        } else if name.role.suppresses() && is_hardly_connected(milestones, components) {
            Some(format!(
                "The roadmap of {name} is hardly connected: {milestones} milestones in {components} components."
            ))
        } else {
            None
        }
    });
    notes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_sim::RunCost;
    use wildfire_timeline::{AgentId, AgentOutcome, Outcome};

    #[test]
    fn agents_that_can_do_nothing_are_named_and_others_are_not() {
        let wumpus =
            |number, out_of_reach| AgentOutcome { out_of_reach, ..AgentOutcome::idle(AgentId::wumpus(number)) };
        let truck = |number, roadmap_samples, roadmap_components| AgentOutcome {
            roadmap_samples,
            roadmap_components,
            ..AgentOutcome::idle(AgentId::unimog(number))
        };
        let agents = vec![
            wumpus(0, 247),
            wumpus(1, 248),
            truck(0, 500, 1),
            truck(1, 500, 499),
            truck(2, 0, 0),
            truck(3, 500, 50),
            truck(4, 499, 50),
            truck(5, 3, 1),
        ];
        let of = |obstacles| {
            let outcome = Outcome { obstacles, agents: agents.clone(), ..Outcome::default() };
            notes(&RunResult::new(outcome, RunCost::default()))
        };
        let expected = [
            "wumpus/1 can light nothing: none of the 248 bushes is in its reach.",
            "The roadmap of unimog/1 is hardly connected: 500 milestones in 499 components.",
            "The roadmap of unimog/4 is hardly connected: 499 milestones in 50 components.",
        ];
        assert_eq!(of(248), expected);
        assert_eq!(of(0), expected[1..], "where nothing grows there is nothing to light");
    }
}
