//! The policy of a team that its scenario asks for.

use std::sync::Arc;

use super::policy::{DispatchPolicy, FleetContext, TruckContext};
use super::team::{Assignment, StagingRule, TeamRules};
use super::{
    Auction, Centroids, Hungarian, LearnedPosts, NearestByDrive, NearestByNumber, NearestSavable, Regions,
    RegionsFirst, Rollout, ThreatFirst,
};
use crate::policies::learned::Networks;
use crate::policies::nearest::Nearest;
use crate::policies::{PerAgentPolicy, Policy};
use wildfire_base::time::SimTime;
use wildfire_scenario::{self as scenario, Extinguishes, FireModelName, IdleRule, Scenario, SightOfField, Terrain};
use wildfire_timeline::{AgentId, WaterRules};

/// Makes the policy of all trucks of a run, if the scenario dispatches them.
pub fn policy_of(scenario: &Scenario, terrain: &Terrain, water: Option<WaterRules>) -> Option<Box<dyn Policy>> {
    let dispatch = scenario.dispatch.as_ref()?;
    let sight = scenario.sight.clone().unwrap_or_default();
    // Rules that a truck can follow alone need no team: it then decides when it is free.
    let is_plain = dispatch.idle == IdleRule::Stay && sight.field != SightOfField::Radius;
    // Trucks that decide alone are charged nothing for it, so a charge needs the team.
    if is_plain && dispatch.seconds_per_evaluation == 0.0 {
        match dispatch.policy {
            scenario::DispatchPolicy::Nearest => return Some(Box::new(PerAgentPolicy(Nearest))),
            scenario::DispatchPolicy::NearestByDrive => return Some(Box::new(NearestByDrive)),
            _ => {}
        }
    }
    let site = FleetContext {
        end: SimTime::from_seconds(scenario.duration_s),
        frame: terrain.frame,
        rules: rules(scenario),
        sight,
        water,
        bushes: terrain.bushes.clone().into(),
        trucks: (0..).map(AgentId::unimog).zip(&scenario.unimog).map(truck_site).collect(),
    };
    let rules = DispatchRules::new(dispatch, &Networks::new(scenario.learned.as_ref()));
    Some(Box::new(DispatchPolicy::new(site, rules, dispatch.seconds_per_evaluation)))
}

fn truck_site((id, truck): (AgentId, &scenario::Unimog)) -> TruckContext {
    TruckContext { id, speed_mps: truck.speed_mps, start: truck.start_centre() }
}

fn rules(scenario: &Scenario) -> TeamRules {
    let fire = scenario.fire.rules();
    let is_radius = scenario.fire.model == FireModelName::Radius;
    TeamRules {
        reach_m: scenario.suppression.reach_m,
        dwell: SimTime::from_seconds(scenario.suppression.dwell_s),
        extinguishes_all: scenario.suppression.extinguishes == Extinguishes::AllInReach,
        // Under other models the team knows no time of spreading or burning out.
        spread: (is_radius && fire.sources_spread).then_some((fire.spread_radius_m, fire.spread_delay)),
        caught_spreads: fire.caught_spreads,
        burn_out: fire.burn_out.filter(|_| is_radius),
    }
}

/// The rules of a team's policy, which are asked in turn for one run.
#[derive(Clone)]
pub struct DispatchRules {
    pub assignment: Box<dyn Assignment>,
    /// Trucks stay where they are if there is none.
    pub staging: Option<Box<dyn StagingRule>>,
}

impl DispatchRules {
    /// Makes the rules that a scenario names.
    pub fn new(dispatch: &scenario::Dispatch, networks: &Networks) -> Self {
        let assignment: Box<dyn Assignment> = match dispatch.policy {
            scenario::DispatchPolicy::Nearest => Box::new(NearestByNumber),
            scenario::DispatchPolicy::NearestByDrive => Box::new(NearestByDrive),
            scenario::DispatchPolicy::NearestSavable => Box::new(NearestSavable),
            scenario::DispatchPolicy::Hungarian => Box::new(Hungarian),
            scenario::DispatchPolicy::ThreatFirst => Box::new(ThreatFirst),
            scenario::DispatchPolicy::Auction => Box::new(Auction),
            scenario::DispatchPolicy::Rollout => Box::new(Rollout { rollouts: dispatch.rollouts }),
        };
        match dispatch.idle {
            IdleRule::Stay => Self { assignment, staging: None },
            IdleRule::Centroids => Self { assignment, staging: Some(Box::<Centroids>::default()) },
            IdleRule::Learned => {
                let learned = LearnedPosts::new(Arc::clone(&networks.posts));
                Self { assignment, staging: Some(Box::new(learned)) }
            }
            // Trucks also serve their own regions first.
            IdleRule::Regions => {
                Self { assignment: Box::new(RegionsFirst(assignment)), staging: Some(Box::<Regions>::default()) }
            }
        }
    }
}
