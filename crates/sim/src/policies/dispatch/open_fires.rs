//! The fires of a decision, and what a truck needs to save one.
//!
//! A fire is savable for a truck that can have put it out before it burns out and before the run ends: at the speed of the
//! truck, on a way as long as drives usually are, with the dwell at its end. The others are hopeless, and a drive to
//! one is wasted.

use glam::DVec2;

use super::place_index::PlaceIndex;
use super::team::{Fire, Team, TeamTruck, WAY_FACTOR};
use wildfire_base::geometry::Cell;
use wildfire_base::time::SimTime;

/// A fire that a truck can extinguish in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SavableFire {
    /// The time at which it is extinguished.
    pub out_at: SimTime,
    /// The straight distance from the truck to the fire.
    pub metres: f64,
    /// The number of the fire among the open fires.
    pub fire: usize,
}

/// The fires that are not the goal of any truck outside this decision, by cell index.
#[derive(Clone, Debug)]
pub struct OpenFires<'a> {
    pub team: &'a Team<'a>,
    pub fires: Vec<Fire>,
    pub index: PlaceIndex,
    /// The latest deadline of the fires.
    pub last_due: SimTime,
}

impl<'a> OpenFires<'a> {
    pub fn new(team: &'a Team<'a>) -> Self {
        let mut claimed: Vec<Cell> =
            team.trucks.iter().filter(|truck| !truck.is_queried).filter_map(|truck| truck.goal).collect();
        claimed.sort_unstable();
        let fires: Vec<Fire> =
            team.fires.iter().filter(|fire| claimed.binary_search(&fire.cell).is_err()).copied().collect();
        Self::with_fires(team, fires)
    }

    /// Takes these fires, whichever trucks go for them.
    pub fn with_fires(team: &'a Team<'a>, fires: Vec<Fire>) -> Self {
        let index = PlaceIndex::new(&team.frame, fires.iter().map(|fire| fire.place).collect());
        let last_due = fires.iter().map(|fire| team.due(fire)).max().unwrap_or_default();
        Self { team, fires, index, last_due }
    }

    /// Finds the savable, accepted fires that are nearest to a truck, nearest first; ties go to the smaller cell index.
    pub fn nearest_savable(
        &self,
        truck: &TeamTruck,
        count: usize,
        mut accept: impl FnMut(usize) -> bool,
    ) -> Vec<SavableFire> {
        let is_savable = |fire: usize| accept(fire) && self.prospect(truck, fire).is_some();
        let left = self.last_due.since(self.team.sets_out_at(truck));
        let found = self.index.nearest(truck.place, count, self.team.range_m(truck.speed_mps, left), is_savable);
        found.into_iter().filter_map(|(_, fire)| self.prospect(truck, fire)).collect()
    }

    /// Returns when a truck extinguishes a fire if it sets out for it; `None` if that is too late.
    pub fn prospect(&self, truck: &TeamTruck, fire: usize) -> Option<SavableFire> {
        let place = self.fires[fire].place;
        let out_at = self.team.sets_out_at(truck) + self.team.stop_time(truck.speed_mps, truck.place, place);
        let is_savable = out_at <= self.team.due(&self.fires[fire]);
        is_savable.then(|| SavableFire { out_at, metres: (place - truck.place).length(), fire })
    }
}

impl Team<'_> {
    /// Returns the last instant at which extinguishing a fire saves it: extinction comes before burn-out, and before
    /// the end.
    pub fn due(&self, fire: &Fire) -> SimTime {
        fire.burns_out.min(self.end)
    }

    /// Returns the earliest instant at which a truck can set out.
    pub fn sets_out_at(&self, truck: &TeamTruck) -> SimTime {
        truck.free_at.max(self.now)
    }

    /// Estimates the time from departure until a fire is extinguished: the drive and the dwell.
    pub fn stop_time(&self, speed_mps: f64, from: DVec2, to: DVec2) -> SimTime {
        self.drive_time(speed_mps, from, to) + self.rules.dwell
    }

    /// Returns the straight distance within which a truck can reach a fire in a given time, dwell included; negative if
    /// the time is too short for any.
    pub fn range_m(&self, speed_mps: f64, time: SimTime) -> f64 {
        if time < self.rules.dwell {
            return -1.0;
        }
        // Times are rounded to the nanosecond, and what just fits must not be missed.
        let range_m = ((time - self.rules.dwell).as_seconds() + 1e-6) * speed_mps / WAY_FACTOR;
        range_m + self.rules.reach_m.unwrap_or_default() + 1e-6
    }

    /// Lists the trucks that are asked, by number.
    pub fn queried(&self) -> impl Iterator<Item = &TeamTruck> {
        self.trucks.iter().filter(|truck| truck.is_queried)
    }
}
