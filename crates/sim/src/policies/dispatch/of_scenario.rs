//! The policy of a team that its scenario asks for.

use super::policy::{DispatchPolicy, FleetContext, TruckContext};
use super::team::{Assignment, StagingRule, TeamRules};
use super::{AssignmentRule, IdleRule, NearestByDrive, make};
use crate::policies::learned::Networks;
use crate::policies::nearest::Nearest;
use crate::policies::{PerAgentPolicy, Policy};
use wildfire_base::time::SimTime;
use wildfire_scenario::{self as scenario, Extinguishes, FireModelName, Scenario, SightOfField, Terrain};
use wildfire_timeline::{AgentId, WaterRules};

/// Makes the policy of all trucks of a run, if the scenario dispatches them.
pub fn policy_of(scenario: &Scenario, terrain: &Terrain, water: Option<WaterRules>) -> Option<Box<dyn Policy>> {
    let dispatch = scenario.dispatch.as_ref()?;
    let sight = scenario.sight.clone().unwrap_or_default();
    let is_plain = dispatch.idle == scenario::IdleRule::Stay && sight.field != SightOfField::Radius;
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
    let (assignment, positioning) = halves(dispatch, &Networks::new(scenario.learned.as_ref()));
    let policy = DispatchPolicy::new(site, assignment, positioning, dispatch.seconds_per_evaluation);
    Some(Box::new(policy))
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
        spread: (is_radius && fire.sources_spread).then_some((fire.spread_radius_m, fire.spread_delay)),
        caught_spreads: fire.caught_spreads,
        burn_out: fire.burn_out.filter(|_| is_radius),
    }
}

/// Makes what the scenario names: who goes where, and where the others wait if they do not stay where they are.
fn halves(dispatch: &scenario::Dispatch, networks: &Networks) -> (Box<dyn Assignment>, Option<Box<dyn StagingRule>>) {
    let idle = match dispatch.idle {
        scenario::IdleRule::Stay => IdleRule::Stay,
        scenario::IdleRule::Centroids => IdleRule::Centroids,
        scenario::IdleRule::Regions => IdleRule::Regions,
        scenario::IdleRule::Learned => IdleRule::Learned,
    };
    let rule = match dispatch.policy {
        scenario::DispatchPolicy::Nearest => AssignmentRule::Nearest,
        scenario::DispatchPolicy::NearestByDrive => AssignmentRule::NearestByDrive,
        scenario::DispatchPolicy::NearestSavable => AssignmentRule::NearestSavable,
        scenario::DispatchPolicy::Hungarian => AssignmentRule::Hungarian,
        scenario::DispatchPolicy::ThreatFirst => AssignmentRule::ThreatFirst,
        scenario::DispatchPolicy::Auction => AssignmentRule::Auction,
        scenario::DispatchPolicy::Rollout => AssignmentRule::Rollout { rollouts: dispatch.rollouts },
    };
    let (assignment, positioning) = make(rule, idle, networks);
    (assignment, (idle != IdleRule::Stay).then_some(positioning))
}
