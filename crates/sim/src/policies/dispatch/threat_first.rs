//! The most threatening fire first: each gets the free truck that extinguishes it soonest, before it spreads.
//!
//! That is the dispatcher's rule of thumb: to stop what would become large before what is lost alone. Fires that threaten
//! nothing, or that nobody can stop before they spread, come after all others, the one that is out first before the rest.

use super::nearest_savable::nearest_first;
use super::open_fires::OpenFires;
use super::team::{Assignment, Fire, Team};
use super::threat::threats;
use wildfire_base::geometry::Cell;
use wildfire_timeline::AgentId;

/// Assigns the most threatening fire the truck that can be there first, then the next fire.
#[derive(Clone, Copy, Debug)]
pub struct ThreatFirst;

impl Assignment for ThreatFirst {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        let open = OpenFires::new(team);
        let threats = threats(team, &open.fires);
        let mut levels: Vec<u32> = threats.iter().copied().filter(|&threat| threat > 0).collect();
        levels.sort_unstable();
        levels.dedup();
        let mut free: Vec<usize> = (0..team.trucks.len()).filter(|&truck| team.trucks[truck].is_queried).collect();
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for level in levels.into_iter().rev() {
            if free.is_empty() {
                break;
            }
            let of_level: Vec<usize> = (0..open.fires.len()).filter(|&fire| threats[fire] == level).collect();
            // What counts is to be there before it spreads.
            let urgent = of_level.iter().map(|&fire| {
                let fire = open.fires[fire];
                Fire { burns_out: fire.burns_out.min(fire.spreads_at), ..fire }
            });
            let urgent = OpenFires::with_fires(team, urgent.collect());
            let found = nearest_first(&urgent, &free, &mut vec![false; of_level.len()], effort);
            pairs.extend(found.into_iter().map(|(truck, fire)| (truck, of_level[fire])));
            free.retain(|truck| pairs.iter().all(|(gone, _)| gone != truck));
        }
        let mut taken = vec![false; open.fires.len()];
        pairs.iter().for_each(|&(_, fire)| taken[fire] = true);
        pairs.extend(nearest_first(&open, &free, &mut taken, effort));
        pairs.sort_unstable();
        pairs.into_iter().map(|(truck, fire)| (team.trucks[truck].id, open.fires[fire].cell)).collect()
    }

    fn replans(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples::Sample;
    use super::*;

    #[test]
    fn what_threatens_more_is_put_out_before_what_is_nearer() {
        let mut sample = Sample::with_trucks(&[(50.0, 50.0)]);
        sample.burn((12, 10));
        sample.burn((2, 10));
        let goal = |sample: &Sample| ThreatFirst.assign(&sample.team(), &mut 0);
        assert_eq!(goal(&sample), [(AgentId::unimog(0), (12, 10).into())]);
        sample.grow(&[(1, 10), (0, 10)]);
        assert_eq!(goal(&sample), [(AgentId::unimog(0), (2, 10).into())]);
        // It would spread before the truck is there.
        sample.fires[0].spreads_at = sample.fires[0].since;
        assert_eq!(goal(&sample), [(AgentId::unimog(0), (12, 10).into())]);
    }

    #[test]
    fn no_free_truck_could_stop_a_fire_that_threatens_more_than_its_goal() {
        for seed in 0..60 {
            let sample = Sample::new(seed);
            let team = sample.team();
            let open = OpenFires::new(&team);
            let threats = threats(&team, &open.fires);
            let goals = ThreatFirst.assign(&team, &mut 0);
            for truck in team.queried() {
                let stops =
                    |fire: usize| open.prospect(truck, fire).is_some_and(|p| p.out_at <= open.fires[fire].spreads_at);
                let goal = goals.iter().find(|(id, _)| *id == truck.id).map(|&(_, cell)| cell);
                let goal = (0..open.fires.len()).find(|&fire| Some(open.fires[fire].cell) == goal);
                let selected = goal.map_or(0, |fire| if stops(fire) { threats[fire] } else { 0 });
                let left = (0..open.fires.len()).filter(|&fire| goals.iter().all(|(_, c)| *c != open.fires[fire].cell));
                for fire in left.filter(|&fire| stops(fire)) {
                    assert!(selected >= threats[fire], "seed {seed}, {}", truck.id);
                    assert!(goal.is_some(), "seed {seed}, {} has nothing to go for", truck.id);
                }
            }
        }
    }
}
