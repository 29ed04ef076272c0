//! Idle trucks spread over the intact bushes as by [`super::Centroids`], but bushes count more or less by what a network makes
//! of recent ignitions: an arsonist on foot is not far from where it was.

use std::sync::Arc;

use glam::DVec2;

use super::super::team::{StagingRule, Team, TeamTruck};
use super::centroids::{posts, waits_at, worth_m};
use super::spread_out::{BushBlock, BushDensity, spread_out};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;
use wildfire_scenario::Network;
use wildfire_timeline::AgentId;

/// The ignitions that are remembered, the latest.
const REMEMBERED: usize = 8;

/// The age from which an ignition is forgotten.
const FORGOTTEN: SimTime = SimTime::from_nanos(300_000_000_000);

/// The least weight of a bush: none is left out altogether.
const MIN: f64 = 0.02;

/// Sends idle trucks to centroids of weighted bushes.
#[derive(Clone, Debug)]
pub struct LearnedPosts {
    census: BushDensity,
    network: Arc<Network>,
    /// The cells of recent ignitions, their places and times, the latest last.
    ignitions: Vec<(Cell, DVec2, SimTime)>,
}

impl LearnedPosts {
    pub fn new(network: Arc<Network>) -> Self {
        Self { census: BushDensity::default(), network, ignitions: Vec::new() }
    }

    /// Remembers fires that arsonists have lit: where only those spread, the others are left out.
    fn remember(&mut self, team: &Team<'_>) {
        // Where only sources spread, a fire that will spread is the work of an arsonist.
        let tells = team.rules.spread.is_some() && !team.rules.caught_spreads;
        for fire in team.fires.iter().filter(|fire| !tells || fire.spreads_at < SimTime::MAX) {
            if !self.ignitions.iter().any(|(cell, _, since)| (*cell, *since) == (fire.cell, fire.since)) {
                self.ignitions.push((fire.cell, fire.place, fire.since));
            }
        }
        self.ignitions.retain(|(.., since)| team.now.since(*since) < FORGOTTEN);
        self.ignitions.sort_by_key(|(.., since)| *since);
        self.ignitions.drain(..self.ignitions.len().saturating_sub(REMEMBERED));
    }

    fn weight(&self, place: DVec2, now: SimTime, idle_share: f64) -> f64 {
        let mut weight = 1.0;
        for (_, place_ignited, since) in &self.ignitions {
            let age_s = now.since(*since).as_seconds();
            // Hundreds of metres and minutes keep the inputs of the network near 1.
            weight += self.network.value(&[(*place_ignited - place).length() / 100.0, age_s / 60.0, idle_share]);
        }
        weight.max(MIN)
    }
}

impl StagingRule for LearnedPosts {
    fn staging_points(&mut self, team: &Team<'_>, idle: &[AgentId]) -> Vec<(AgentId, DVec2)> {
        self.remember(team);
        let trucks: Vec<&TeamTruck> = team.trucks.iter().filter(|truck| idle.contains(&truck.id)).collect();
        let share = trucks.len() as f64 / team.trucks.len() as f64;
        let counted: Vec<BushBlock> = self.census.blocks(team).to_vec();
        let blocks: Vec<BushBlock> = counted
            .iter()
            .map(|block: &BushBlock| BushBlock {
                bushes: block.bushes * self.weight(block.place, team.now, share),
                ..*block
            })
            .collect();
        let mut sites: Vec<DVec2> = trucks.iter().map(|truck| waits_at(truck)).collect();
        spread_out(&blocks, &mut sites);
        posts(&trucks, &sites, worth_m(team, trucks.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::samples::Sample;
    use super::*;
    use crate::policies::learned::Networks;

    #[test]
    fn trucks_wait_nearer_to_where_a_fire_just_ignited() {
        let mut sample = Sample::with_trucks(&[(10.0, 10.0)]);
        let cells: Vec<(u16, u16)> = (0..50).flat_map(|col| (0..50).map(move |row| (col, row))).collect();
        sample.grow(&cells);
        let staging_point = |sample: &Sample| {
            let mut posts = LearnedPosts::new(Networks::new(None).posts);
            posts.staging_points(&sample.team(), &[sample.trucks[0].id])[0].1
        };
        assert!((staging_point(&sample) - DVec2::splat(125.0)).length() < 1e-6, "without fires it is in the middle");
        sample.burn((45, 45));
        let near = staging_point(&sample);
        assert!(near.x > 135.0 && near.y > 135.0, "{near}");
    }

    #[test]
    fn ignitions_are_forgotten_the_oldest_first() {
        let mut sample = Sample::with_trucks(&[(125.0, 125.0)]);
        let mut posts = LearnedPosts::new(Networks::new(None).posts);
        for col in 0..12 {
            sample.burn((3 * col, 20));
        }
        posts.remember(&sample.team());
        assert_eq!(posts.ignitions.len(), REMEMBERED);
        sample.now_s = 301.0;
        posts.remember(&Team { fires: Vec::new(), ..sample.team() });
        assert_eq!(posts.ignitions, []);
    }
}
