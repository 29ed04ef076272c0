//! Idle trucks spread over the intact bushes, each at the centroid of those to which it is nearest.
//!
//! In the literature of initial attack prepositioning is the main lever (Haight and Fried, "Deploying wildland fire
//! suppression resources with a scenario-based standard response model", INFOR 45(1), 2007): who is near when a fire begins
//! stops it before it spreads.

use glam::DVec2;

use super::super::hungarian::min_total;
use super::super::team::{AS_GOOD_M, StagingRule, Team, TeamTruck};
use super::spread_out::{BushDensity, spread_out};
use wildfire_timeline::AgentId;

/// A truck goes to a new place only if it is at least this far from where it is, or was sent before: a shorter way gains less
/// than the drive disturbs.
const MIN_WORTH_M: f64 = 25.0;

/// The same as a share of the room that each idle truck has, the side of its square of the field. Whenever one of them leaves
/// for a fire or comes back, all places shift a little; to follow that would keep all trucks driving all the time.
const WORTH_SHARE: f64 = 0.3;

/// A truck on its way is redirected only if the way is at most this share of the one that is left to it. With
/// every fire other trucks are idle, and the best places of three are far from those of four: who followed each turn of that
/// would never arrive.
const NEARER_SHARE: f64 = 0.5;

/// Sends idle trucks to centroids of intact bushes, the whole team at the least sum of squared distances.
#[derive(Clone, Debug, Default)]
pub struct Centroids {
    census: BushDensity,
}

impl StagingRule for Centroids {
    fn staging_points(&mut self, team: &Team<'_>, idle: &[AgentId]) -> Vec<(AgentId, DVec2)> {
        let trucks: Vec<&TeamTruck> = team.trucks.iter().filter(|truck| idle.contains(&truck.id)).collect();
        let mut sites: Vec<DVec2> = trucks.iter().map(|truck| waits_at(truck)).collect();
        spread_out(self.census.blocks(team), &mut sites);
        posts(&trucks, &sites, worth_m(team, trucks.len()))
    }
}

/// Returns the shortest distance that is worth a drive if this number of trucks share the field.
pub fn worth_m(team: &Team<'_>, trucks: usize) -> f64 {
    let room_m2 = team.frame.width_m() * team.frame.height_m() / trucks.max(1) as f64;
    (WORTH_SHARE * room_m2.sqrt()).max(MIN_WORTH_M)
}

/// Returns the place at which a truck waits, or to which it has been sent to wait.
pub fn waits_at(truck: &TeamTruck) -> DVec2 {
    truck.staging_point.unwrap_or(truck.place)
}

/// Assigns each truck a site and returns those that are far enough away to be worth a drive. There are as many sites as
/// trucks.
pub fn posts(trucks: &[&TeamTruck], sites: &[DVec2], worth_m: f64) -> Vec<(AgentId, DVec2)> {
    // Squares prefer two ways of middle length to a short one and a long one, which takes longer until all are there.
    let site_of =
        min_total(trucks.len(), sites.len(), |truck, site| (trucks[truck].place - sites[site]).length_squared());
    let is_worth = |truck: &TeamTruck, site: DVec2| {
        let left_m = (waits_at(truck) - truck.place).length();
        let is_there = left_m <= AS_GOOD_M;
        let is_nearer = (site - truck.place).length() <= NEARER_SHARE * left_m;
        (waits_at(truck) - site).length() >= worth_m && (is_there || is_nearer)
    };
    let sent = trucks.iter().zip(site_of).filter(|(truck, site)| is_worth(truck, sites[*site]));
    sent.map(|(truck, site)| (truck.id, sites[site])).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::samples::Sample;
    use super::*;

    fn grown() -> Sample {
        let mut sample = Sample::with_trucks(&[(20.0, 20.0), (21.0, 20.0), (230.0, 20.0), (22.0, 21.0)]);
        let cells: Vec<(u16, u16)> = (0..50).flat_map(|col| (0..50).map(move |row| (col, row))).collect();
        sample.grow(&cells);
        sample
    }

    #[test]
    fn trucks_spread_over_the_field_and_then_stay() {
        let mut sample = grown();
        let idle: Vec<AgentId> = sample.trucks.iter().map(|truck| truck.id).collect();
        let posts = Centroids::default().staging_points(&sample.team(), &idle);
        assert_eq!(posts.len(), 4, "a quarter of the field for each");
        for (number, (id, staging_point)) in posts.iter().enumerate() {
            assert_eq!(*id, idle[number]);
            sample.trucks[number].staging_point = Some(*staging_point);
            for (_, other) in &posts[..number] {
                assert!((*staging_point - *other).length() > 80.0, "{staging_point} and {other} are one place");
            }
        }
        // Under way, and when they are there, nobody is sent anywhere else.
        assert_eq!(Centroids::default().staging_points(&sample.team(), &idle), []);
        for truck in &mut sample.trucks {
            truck.place = truck.staging_point.expect("each has one");
        }
        assert_eq!(Centroids::default().staging_points(&sample.team(), &idle), []);
    }

    #[test]
    fn a_truck_on_its_way_is_sent_to_a_place_that_is_much_nearer_or_goes_on() {
        let mut truck = Sample::with_trucks(&[(20.0, 20.0)]).trucks[0];
        truck.staging_point = Some(DVec2::new(120.0, 20.0));
        let sent = |site: DVec2| posts(&[&truck], &[site], 25.0).len();
        assert_eq!(sent(DVec2::new(20.0, 71.0)), 0);
        assert_eq!(sent(DVec2::new(20.0, 69.0)), 1);
        let there = TeamTruck { place: DVec2::new(110.0, 20.0), ..truck };
        assert_eq!(posts(&[&there], &[DVec2::new(20.0, 71.0)], 25.0).len(), 1);
    }

    #[test]
    fn only_idle_trucks_are_sent() {
        let sample = grown();
        let posts = Centroids::default().staging_points(&sample.team(), &[AgentId::unimog(2)]);
        let [(id, staging_point)] = posts[..] else { panic!("one truck is idle: {posts:?}") };
        assert_eq!(id, AgentId::unimog(2));
        assert!((staging_point - DVec2::splat(125.0)).length() < 1e-6, "alone it waits in the middle: {staging_point}");
    }
}
