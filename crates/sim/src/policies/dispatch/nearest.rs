//! The nearest fire for one truck after the other, in order of their numbers: each takes the nearest that no other
//! truck has, in a straight line; ties go to the smaller cell index.

use super::team::{Assignment, Team};
use wildfire_base::geometry::Cell;
use wildfire_timeline::AgentId;

/// Assigns each truck the nearest fire that is left.
#[derive(Clone, Copy, Debug)]
pub struct NearestByNumber;

impl Assignment for NearestByNumber {
    fn assign(&mut self, team: &Team<'_>, effort: &mut u64) -> Vec<(AgentId, Cell)> {
        // Trucks that are not asked keep their fires.
        let mut taken: Vec<Cell> =
            team.trucks.iter().filter(|truck| !truck.is_queried).filter_map(|truck| truck.goal).collect();
        let mut goals = Vec::new();
        for truck in team.trucks.iter().filter(|truck| truck.is_queried) {
            let left = team.fires.iter().filter(|fire| !taken.contains(&fire.cell));
            let squared_m = |place: glam::DVec2| (place - truck.place).length_squared();
            // Of equally near ones the first, which has the smallest cell index.
            let nearest = left.min_by(|a, b| squared_m(a.place).total_cmp(&squared_m(b.place)));
            *effort += team.fires.len() as u64;
            if let Some(fire) = nearest {
                taken.push(fire.cell);
                goals.push((truck.id, fire.cell));
            }
        }
        goals
    }

    fn replans(&self) -> bool {
        false
    }
}
