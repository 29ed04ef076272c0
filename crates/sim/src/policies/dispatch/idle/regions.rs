//! Regions of the trucks: each covers the part of the field that is nearer to its start than to any other's.
//!
//! A truck serves the fires of its own region first, and helps elsewhere when it has none there; idle, it waits among the
//! intact bushes of its region. Trucks that start at one place share a region.

use glam::DVec2;

use super::super::team::{Assignment, StagingRule, Team, TeamTruck};
use super::centroids::{posts, waits_at, worth_m};
use super::spread_out::{BushBlock, BushDensity, spread_out};
use wildfire_base::geometry::Cell;
use wildfire_timeline::AgentId;

/// Sends idle trucks to the centroid of the intact bushes in their regions.
#[derive(Clone, Debug, Default)]
pub struct Regions {
    census: BushDensity,
}

impl StagingRule for Regions {
    fn staging_points(&mut self, team: &Team<'_>, idle: &[AgentId]) -> Vec<(AgentId, DVec2)> {
        let starts = starts(team);
        let blocks = self.census.blocks(team);
        let mut all = Vec::new();
        for region in 0..starts.len() {
            let within: Vec<BushBlock> =
                blocks.iter().copied().filter(|block| region_of(&starts, block.place) == region).collect();
            let trucks: Vec<&TeamTruck> = team
                .trucks
                .iter()
                .filter(|truck| region_of(&starts, truck.start) == region && idle.contains(&truck.id))
                .collect();
            // From their starts and not from where they are: the sites of a region do not depend on who is where.
            let mut sites: Vec<DVec2> = trucks.iter().map(|truck| truck.start).collect();
            spread_out(&within, &mut sites);
            // With nothing to watch, a drive back to the start gains nothing.
            if within.is_empty() {
                sites = trucks.iter().map(|truck| waits_at(truck)).collect();
            }
            all.extend(posts(&trucks, &sites, worth_m(team, idle.len())));
        }
        all.sort_unstable_by_key(|&(id, _)| id);
        all
    }
}

/// Assigns fires by another rule: first those of each region to its own trucks, then the rest to the trucks that are
/// left.
#[derive(Clone)]
pub struct RegionsFirst(pub Box<dyn Assignment>);

impl Assignment for RegionsFirst {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        let starts = starts(team);
        // Fires that somebody keeps whatever is decided, from whichever region.
        let kept: Vec<Cell> =
            team.trucks.iter().filter(|truck| !truck.is_queried).filter_map(|truck| truck.goal).collect();
        let mut goals: Vec<(AgentId, Cell)> = Vec::new();
        for region in 0..starts.len() {
            let mut part = team.clone();
            part.fires.retain(|fire| region_of(&starts, fire.place) == region && !kept.contains(&fire.cell));
            part.trucks.retain(|truck| region_of(&starts, truck.start) == region);
            goals.extend(self.0.assign(&part, effort));
        }
        let mut rest = team.clone();
        rest.fires.retain(|fire| goals.iter().all(|&(_, cell)| cell != fire.cell));
        rest.trucks.retain(|truck| goals.iter().all(|&(id, _)| id != truck.id));
        goals.extend(self.0.assign(&rest, effort));
        goals.sort_unstable_by_key(|&(id, _)| id);
        goals
    }

    fn replans(&self) -> bool {
        self.0.replans()
    }
}

/// The places at which trucks start, each once, in the order of the trucks.
fn starts(team: &Team<'_>) -> Vec<DVec2> {
    let mut starts: Vec<DVec2> = Vec::new();
    for truck in &team.trucks {
        if !starts.contains(&truck.start) {
            starts.push(truck.start);
        }
    }
    starts
}

/// The region that a place belongs to: that of the nearest start, of equally near ones the first.
fn region_of(starts: &[DVec2], place: DVec2) -> usize {
    let squared = |start: &DVec2| (*start - place).length_squared();
    (0..starts.len()).min_by(|&a, &b| squared(&starts[a]).total_cmp(&squared(&starts[b]))).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::super::super::nearest_savable::NearestSavable;
    use super::super::super::samples::Sample;
    use super::*;

    #[test]
    fn a_truck_serves_its_region_first_and_then_helps() {
        let mut sample = Sample::with_trucks(&[(50.0, 50.0), (150.0, 50.0)]);
        // Both fires lie in the region of the second truck, which is near to neither.
        sample.trucks[0].place = DVec2::new(150.0, 100.0);
        sample.trucks[1].place = DVec2::new(100.0, 200.0);
        sample.burn((30, 21));
        let assign = |sample: &Sample| RegionsFirst(Box::new(NearestSavable)).assign(&sample.team(), &mut 0);
        assert_eq!(assign(&sample), [(AgentId::unimog(1), (30, 21).into())]);
        sample.burn((33, 30));
        assert_eq!(assign(&sample), [(AgentId::unimog(0), (30, 21).into()), (AgentId::unimog(1), (33, 30).into()),]);
    }

    #[test]
    fn idle_trucks_wait_in_their_regions() {
        let mut sample = Sample::with_trucks(&[(60.0, 125.0), (190.0, 125.0), (190.0, 125.0)]);
        let cells: Vec<(u16, u16)> = (0..50).flat_map(|col| (0..50).map(move |row| (col, row))).collect();
        sample.grow(&cells);
        let team = sample.team();
        let idle: Vec<AgentId> = team.trucks.iter().map(|truck| truck.id).collect();
        let posts = Regions::default().staging_points(&team, &idle);
        for (id, staging_point) in &posts {
            let start = team.trucks[usize::from(id.number)].start;
            assert_eq!(
                region_of(&starts(&team), *staging_point),
                region_of(&starts(&team), start),
                "{id} waits at {staging_point}"
            );
        }
        let [(_, one), (_, two)] = posts[..] else { panic!("the two who share a start share its region: {posts:?}") };
        assert!((one - two).length() > 50.0);
    }
}
