//! Rules of dispatch by the names that scenarios give them.

use super::nearest::NearestByNumber;
use super::policy::{DispatchPolicy, TeamSite, TruckSite};
use super::team::{Assignment, Positioning, TeamRules};
use crate::scenario::{self, Extinguishes, FireModelName, IdleRule, Scenario, SightOfField, Terrain};
use crate::sim::policies::nearest::Nearest;
use crate::sim::policies::{OneByOne, Policy};
use crate::time::SimTime;
use crate::timeline::AgentId;

/// Makes the policy of all trucks of a run, if the scenario dispatches them.
pub fn make(scenario: &Scenario, terrain: &Terrain) -> Option<Box<dyn Policy>> {
    let dispatch = scenario.dispatch.as_ref()?;
    let sight = scenario.sight.clone().unwrap_or_default();
    let is_plain = dispatch.idle == IdleRule::Stay && sight.field != SightOfField::Radius;
    if dispatch.policy == scenario::DispatchPolicy::Nearest && is_plain && dispatch.seconds_per_evaluation == 0.0 {
        return Some(Box::new(OneByOne(Nearest)));
    }
    let site = TeamSite {
        end: SimTime::from_seconds(scenario.duration_s),
        frame: terrain.frame,
        rules: rules(scenario),
        sight,
        bushes: terrain.bushes.clone().into(),
        trucks: (0..).map(AgentId::unimog).zip(&scenario.unimog).map(truck_site).collect(),
    };
    let policy =
        DispatchPolicy::new(site, assignment(dispatch), positioning(dispatch), dispatch.seconds_per_evaluation);
    Some(Box::new(policy))
}

fn truck_site((id, truck): (AgentId, &scenario::Unimog)) -> TruckSite {
    TruckSite { id, speed_mps: truck.speed_mps, start: truck.start_centre() }
}

fn rules(scenario: &Scenario) -> TeamRules {
    let fire = scenario.fire.rules();
    let is_radius = scenario.fire.model == FireModelName::Radius;
    TeamRules {
        reach_m: scenario.suppression.reach_m,
        dwell: SimTime::from_seconds(scenario.suppression.dwell_s),
        extinguishes_all: scenario.suppression.extinguishes == Extinguishes::AllInReach,
        spread: (is_radius && fire.lit_spreads).then_some((fire.spread_radius_m, fire.spread_delay)),
        caught_spreads: fire.caught_spreads,
        burn_out: fire.burn_out.filter(|_| is_radius),
    }
}

fn assignment(dispatch: &scenario::Dispatch) -> Box<dyn Assignment> {
    match dispatch.policy {
        scenario::DispatchPolicy::Nearest
        | scenario::DispatchPolicy::NearestSavable
        | scenario::DispatchPolicy::Hungarian
        | scenario::DispatchPolicy::ThreatFirst
        | scenario::DispatchPolicy::Auction
        | scenario::DispatchPolicy::Rollout => Box::new(NearestByNumber),
    }
}

fn positioning(dispatch: &scenario::Dispatch) -> Option<Box<dyn Positioning>> {
    match dispatch.idle {
        IdleRule::Stay | IdleRule::Centroids | IdleRule::Regions => None,
    }
}
