//! The whole program with one planner more, in a crate of its own.

use std::process::ExitCode;

use wildfire::own_planner::{MakeError, PlannerContext, Planners, ReedsShepp, main_with};
use wildfire::{CollisionChecker, Goal, Plan, PlanFailure, Pose, TruckPlanner};

/// Drives the shortest curve to a place before the fire, if that is free.
struct Bold(CollisionChecker);

impl TruckPlanner for Bold {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let Goal::Disc(disc) = goal else { return Plan::from(Err(PlanFailure::GoalBlocked)) };
        let ahead = (disc.centre - start.position()).normalize_or_zero() * (disc.radius_m - 3.0);
        let end = Pose::new(disc.centre.x - ahead.x, disc.centre.y - ahead.y, start.heading);
        let curves = ReedsShepp { radius_m: self.0.body().turning_radius_m };
        let path = curves.shortest(start, end).path(start);
        let is_free = path.legs().all(|(pose, segment)| self.0.motion_is_free(pose, segment, 0.1));
        Plan::from(if is_free { Ok(path) } else { Err(PlanFailure::Disconnected) })
    }
}

fn main() -> ExitCode {
    let make = |context: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
        Ok(Box::new(Bold(context.checker.clone())))
    };
    main_with(Planners::default().with("bold", make).expect("the name is free"))
}
