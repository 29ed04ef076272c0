//! Paths with their figures, and an independent audit of them.

use wildfire_audit::{AuditField, MotionLimits, Outline, SampleStep, audit_leg};
use wildfire_base::geometry::{Pose, ops};
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::{SpeedLimits, Trajectory};
use wildfire_base::vehicle::{Dimensions, Path};
use wildfire_planning::collision::CollisionChecker;
use wildfire_planning::judge::{DriveFigures, Judge};
use wildfire_planning::{END_M, END_RAD, Goal};
use wildfire_scenario::Problem;
use wildfire_timeline::Body;

/// A path, its figures, and its first violation.
#[derive(Debug)]
pub struct Drive {
    pub path: Path,
    pub figures: DriveFigures,
    /// The first violation, in words.
    pub violation: Option<String>,
}

/// Measures paths from the start of one problem and audits them with shapes that planners do not use.
pub struct DriveAudit<'a> {
    start: Pose,
    checker: &'a CollisionChecker,
    judge: Judge,
    audit_field: AuditField,
    limits: SpeedLimits,
}

impl<'a> DriveAudit<'a> {
    pub fn new(problem: &Problem, checker: &'a CollisionChecker) -> Self {
        let outline = Outline::new(&Body::Truck(problem.truck.vehicle));
        let audit_field = AuditField::new(problem.terrain.frame, &problem.terrain.bushes, outline);
        let judge = Judge::new(checker.clone());
        Self { start: problem.start, checker, judge, audit_field, limits: problem.truck.speed_limits() }
    }

    pub fn drive(&self, goal: Goal, path: Path) -> Drive {
        let trajectory = Trajectory::from_path(&path, SimTime::ZERO, self.limits);
        Drive {
            figures: self.judge.figures(self.start, goal, &path, self.limits),
            violation: self.violation(goal, &trajectory),
            path,
        }
    }

    fn violation(&self, goal: Goal, trajectory: &Trajectory) -> Option<String> {
        let turning_radius_m = Some(self.checker.body().turning_radius_m);
        let motion = MotionLimits { turning_radius_m, limits: Some(self.limits) };
        let audited = audit_leg(&self.audit_field, &motion, trajectory, SampleStep::default());
        let on_the_way = audited.err().map(|violation| violation.to_string());
        let start = trajectory.start();
        let end = trajectory.end();
        on_the_way.or_else(|| {
            let start = missed(Goal::Pose(self.start), start, self.checker.body());
            let end = missed(goal, end, self.checker.body());
            start.map(|by| format!("it begins {by} away from the start")).or(end.map(|by| format!("it ends {by} away")))
        })
    }
}

/// Returns the distance by which a pose misses the goal; `None` if it reaches it.
pub fn missed(goal: Goal, pose: Pose, body: &Dimensions) -> Option<String> {
    let (gap_m, turn) = match goal {
        Goal::Pose(goal) => (pose.position().distance(goal.position()), ops::wrap_angle(pose.heading - goal.heading)),
        Goal::Disc(disc) => (body.body_centre(pose).distance(disc.centre) - disc.radius_m, 0.0),
    };
    let is_met = gap_m <= END_M && turn.abs() <= END_RAD;
    (!is_met).then(|| format!("{gap_m:.4} m and {:.4} rad", turn.abs()))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
    use wildfire_base::vehicle::Segment;
    use wildfire_grid::Grid;
    use wildfire_planning::GoalDisc;
    use wildfire_planning::collision::ClearanceField;
    use wildfire_scenario::{Terrain, Unimog};

    const START: Pose = Pose { x: 20.0, y: 22.5, heading: 0.0 };

    fn straight(metres: f64) -> Path {
        Path { start: START, segments: vec![Segment { curvature: 0.0, length_m: metres }] }
    }

    /// A field of 100 m with one bush from (50, 20) to (55, 25).
    fn judged(goal: Goal, path: Path) -> Drive {
        let frame = FieldFrame { cols: 20, rows: 20, cell_m: 5.0 };
        let mut occupied = Grid::filled(20, 20, false);
        let bush = Cell { col: 10, row: 4 };
        occupied[(usize::from(bush.row), usize::from(bush.col))] = true;
        let checker = CollisionChecker::new(Arc::new(ClearanceField::new(frame, &occupied)), Dimensions::default());
        let terrain = Terrain::from_occupied(frame, occupied);
        let truck = Unimog::default();
        let problem = Problem { name: "test".into(), terrain, truck, start: START, goals: vec![goal] };
        DriveAudit::new(&problem, &checker).drive(goal, path)
    }

    fn pose(x: f64) -> Goal {
        Goal::Pose(Pose { x, ..START })
    }

    #[test]
    fn a_straight_drive_has_the_figures_that_one_can_reckon() {
        let drive = judged(pose(45.0), straight(25.0));
        assert_eq!((drive.violation, drive.figures.cusps, drive.figures.length_m), (None, 0, 25.0));
        assert!((drive.figures.lower_bound_ratio.expect("the truck has to drive") - 1.0).abs() < 1e-12);
        assert!((drive.figures.drive_s - 25.0 / Unimog::default().speed_mps).abs() < 1e-9);
        // The front bumper is 3.95 m ahead of the rear axle.
        assert!(
            (drive.figures.min_clearance_m - (50.0 - 45.0 - 3.95)).abs() < 0.1,
            "{}",
            drive.figures.min_clearance_m
        );
    }

    #[test]
    fn violations_are_seen_by_shapes_and_ends() {
        let violation = |goal, path| judged(goal, path).violation.expect("something is wrong with it");
        assert!(violation(pose(48.0), straight(28.0)).contains("(10, 4)"));
        assert!(violation(pose(45.0), straight(24.99)).contains("ends 0.0100 m and 0.0000 rad away"));
        let tight = Path { start: START, segments: vec![Segment { curvature: 1.0 / 12.9, length_m: 9.0 }] };
        assert!(violation(Goal::Pose(tight.end()), tight).contains("12.9"));
        let elsewhere = Path { start: Pose { y: 22.51, ..START }, ..straight(5.0) };
        assert!(violation(Goal::Pose(elsewhere.end()), elsewhere).contains("begins 0.0100 m"));
        let disc = |radius_m| Goal::Disc(GoalDisc { centre: DVec2::new(46.5, 22.5), radius_m });
        assert!(violation(disc(1.9), straight(23.0)).contains("ends 0.1000 m"));
        assert_eq!(judged(disc(2.0), straight(23.0)).violation, None);
    }

    #[test]
    fn nothing_bounds_a_drive_that_is_there_already() {
        let disc = Goal::Disc(GoalDisc { centre: DVec2::new(25.0, 25.0), radius_m: 10.0 });
        let drive = judged(disc, Path::standing(START));
        assert_eq!((drive.violation, drive.figures.lower_bound_ratio, drive.figures.drive_s), (None, None, 0.0));
    }
}
