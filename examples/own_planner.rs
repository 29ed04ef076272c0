//! A custom planner, compared with a built-in one on the same queries and in the contest:
//! `cargo run --example own_planner`.
//!
//! It drives the shortest Reeds-Shepp curve if that is free; otherwise it joins two curves at a random pose. It is meant as a
//! starting point for your own planner. Like the built-in planners it uses [`CollisionChecker`] for all collision tests, so
//! its paths are as exact as theirs.

#![expect(clippy::print_stdout, reason = "an example prints what it finds")]

use std::error::Error;
use std::f64::consts::TAU;
use std::sync::Arc;

use rand::RngExt;
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::Pose;
use wildfire::own_planner::{MakeError, PlannerContext, Planners, run_with};
use wildfire::planning::{Effort, Found, FoundBy, Goal, Plan, PlanFailure, TruckPlanner};
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::scenario::{Terrain, load};
use wildfire::sim::RunError;
use wildfire::timeline::Outcome;
use wildfire::vehicle::{Path, ReedsShepp};

/// The clearance of the body to bushes and border, in metres.
const CLEARANCE_M: f64 = 0.3;
/// The budget counts samples, not seconds, so that the same seed gives the same plan.
const MAX_DRAWS: u32 = 2000;

struct ThroughOnePose {
    checker: CollisionChecker,
    rng: Xoshiro256PlusPlus,
}

impl ThroughOnePose {
    /// Returns the shortest curve if the body is free all along it.
    fn free_curve(&self, from: Pose, to: Pose) -> Option<Path> {
        let curves = ReedsShepp { radius_m: self.checker.body().turning_radius_m };
        let path = curves.shortest(from, to).path(from);
        let is_free = path.legs().all(|(pose, segment)| self.checker.motion_is_free(pose, segment, CLEARANCE_M));
        is_free.then_some(path)
    }

    fn draw_pose(&mut self) -> Pose {
        let frame = *self.checker.field().frame();
        let mut draw = || self.rng.random::<f64>();
        Pose::new(draw() * frame.width_m(), draw() * frame.height_m(), (draw() - 0.5) * TAU)
    }

    /// Returns the goal pose, or a random one with the body's centre in the goal disc.
    fn draw_end(&mut self, goal: Goal) -> Pose {
        match goal {
            Goal::Pose(end) => end,
            Goal::Disc(disc) => {
                let mut direction = || Pose::new(0.0, 0.0, (self.rng.random::<f64>() - 0.5) * TAU);
                let (out, end) = (direction(), direction());
                let from_centre = self.checker.body().body_centre(end);
                let centre = disc.centre + out.direction() * (disc.radius_m * self.rng.random::<f64>());
                Pose::new(centre.x - from_centre.x, centre.y - from_centre.y, end.heading)
            }
        }
    }
}

impl TruckPlanner for ThroughOnePose {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let mut effort = Effort::default();
        let end = self.draw_end(goal);
        let mut found = self.free_curve(start, end).map(|path| Found { path, by: FoundBy::Straight });
        while found.is_none() && effort.local_expansions < MAX_DRAWS {
            effort.local_expansions += 1;
            let (via, end) = (self.draw_pose(), self.draw_end(goal));
            let halves = self.free_curve(start, via).zip(self.free_curve(via, end));
            found = halves.map(|(mut path, rest)| {
                path.segments.extend(rest.segments);
                Found { path, by: FoundBy::Search }
            });
        }
        Plan::new(found.ok_or(PlanFailure::BudgetSpent), effort)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    compare_queries()?;
    enter_the_contest()
}

/// Sends the same queries to both planners.
fn compare_queries() -> Result<(), Box<dyn Error>> {
    let scenario = load("contest", &[])?;
    let truck = &scenario.unimog[0];
    let terrain = Terrain::from_scenario(&scenario, 1)?;
    let field = Arc::new(ClearanceField::new(terrain.frame, &terrain.occupied));
    let checker = CollisionChecker::new(field, truck.vehicle);
    let mut custom = ThroughOnePose { checker: checker.clone(), rng: rng::stream(1, "own-planner") };
    let mut built_in = truck.build_planner(&checker, 1)?;

    println!("goal                 own planner          {}", truck.planner);
    let start = truck.start.pose();
    for _ in 0..8 {
        let goal = loop {
            let pose = custom.draw_pose();
            if checker.pose_is_free(pose, CLEARANCE_M) {
                break pose;
            }
        };
        let answer = |plan: Plan| match plan.path {
            Ok(path) => format!("{:6.1} m, {} cusps", path.length_m(), path.cusps()),
            Err(failure) => failure.to_string(),
        };
        let (custom, built_in) = (custom.plan(start, Goal::Pose(goal)), built_in.plan(start, Goal::Pose(goal)));
        println!("({:5.1}, {:5.1}) m   {:20} {}", goal.x, goal.y, answer(custom), answer(built_in));
    }
    Ok(())
}

/// Runs the contest with both planners on the same fields. Neither is rescued: a fire without a path burns on.
fn enter_the_contest() -> Result<(), Box<dyn Error>> {
    let make = |site: &PlannerContext<'_>| -> Result<Box<dyn TruckPlanner>, MakeError> {
        Ok(Box::new(ThroughOnePose { checker: site.checker.clone(), rng: (site.stream)("own-planner") }))
    };
    let planners = Planners::default().with("through-one-pose", make)?;
    println!("\nbushes saved of all, planner by planner");
    for name in ["through-one-pose", "prm-rs"] {
        let changes = [
            "planner.through-one-pose.command=[]".to_owned(),
            format!("unimog.planner={name}"),
            "unimog.rescue=false".to_owned(),
        ];
        let scenario = load("contest", &changes)?;
        let outcomes = (1..=5).map(|seed| Ok(Outcome::new(&run_with(&scenario, seed, &planners)?.timeline)));
        let outcomes = outcomes.collect::<Result<Vec<_>, RunError>>()?;
        let saved: Vec<String> = outcomes
            .iter()
            .map(|outcome| format!("{}/{}", outcome.obstacles - outcome.burned(), outcome.obstacles))
            .collect();
        println!("{name:20} {}", saved.join("  "));
    }
    Ok(())
}
