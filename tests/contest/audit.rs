//! The planners' collision layer and the audit answer the same questions by different means; they must agree.

use std::sync::Arc;

use rand::RngExt;
use wildfire::audit::{AuditField, MotionLimits, Outline, SampleStep, UnitPose, audit_leg};
use wildfire::collision::{ClearanceField, CollisionChecker};
use wildfire::geometry::{Cell, FieldFrame, Pose};
use wildfire::grid::Grid;
use wildfire::rng::{self, Xoshiro256PlusPlus};
use wildfire::time::SimTime;
use wildfire::timeline::Body;
use wildfire::trajectory::{SpeedLimits, Trajectory};
use wildfire::vehicle::{Dimensions, Path, Segment};

const FRAME: FieldFrame = FieldFrame { cols: 16, rows: 16, cell_m: 5.0 };

fn random_field(rng: &mut Xoshiro256PlusPlus) -> (AuditField, CollisionChecker) {
    let bushes: Vec<Cell> = (0..FRAME.cell_count()).filter(|_| rng.random_bool(0.1)).map(|i| FRAME.cell(i)).collect();
    let mut occupied = Grid::filled(FRAME.rows.into(), FRAME.cols.into(), false);
    for &cell in &bushes {
        occupied.values_mut()[FRAME.index(cell)] = true;
    }
    let field = Arc::new(ClearanceField::new(FRAME, &occupied));
    let truck = Outline::new(&Body::Truck(Dimensions::default()));
    (AuditField::new(FRAME, &bushes, truck), CollisionChecker::new(field, Dimensions::default()))
}

fn random_pose(rng: &mut Xoshiro256PlusPlus) -> Pose {
    Pose::new(rng.random_range(0.0..80.0), rng.random_range(0.0..80.0), rng.random_range(-3.1..3.1))
}

#[test]
fn poses_that_touch_for_one_touch_for_the_other() {
    let mut rng = rng::stream(1, "tests/audit");
    let mut touching = 0;
    for _ in 0..20 {
        let (audit_field, checker) = random_field(&mut rng);
        for _ in 0..2000 {
            let pose = random_pose(&mut rng);
            let touch = audit_field.touch(UnitPose::new(pose));
            let clearance = checker.clearance(pose);
            assert!(touch.is_none() || clearance <= 0.0, "{pose:?}: {touch:?}, clearance {clearance}");
            // Less than a millimetre of overlap is forgiven by the audit; so little is rare.
            touching += u32::from(touch.is_some() != (clearance <= 0.0));
        }
    }
    assert!(touching < 100, "{touching} of 40000 poses overlap by less than a millimetre");
}

#[test]
fn motions_that_are_free_pass_the_audit() {
    let mut rng = rng::stream(2, "tests/audit");
    let limits = SpeedLimits {
        acceleration_mps2: Some(2.0),
        braking_mps2: Some(4.0),
        lateral_mps2: Some(3.0),
        ..SpeedLimits::new(10.0, 5.0)
    };
    let mut legs = 0;
    for _ in 0..40 {
        let (audit_field, checker) = random_field(&mut rng);
        let mut path = Path { start: random_pose(&mut rng), segments: Vec::new() };
        if !checker.pose_is_free(path.start, 0.0) {
            continue;
        }
        for _ in 0..60 {
            let curvature = f64::from(rng.random_range(-1..=1)) * checker.body().max_curvature();
            let segment = Segment { curvature, length_m: rng.random_range(-12.0..12.0) };
            if checker.motion_is_free(path.end(), segment, 0.0) {
                path.segments.push(segment);
            }
        }
        let leg = Trajectory::from_path(&path, SimTime::from_seconds(3.0), limits);
        let cut = leg.stopping(leg.start_time() + SimTime::from_seconds(0.4 * leg.duration_s()), &limits);
        let motion = MotionLimits { turning_radius_m: Some(checker.body().turning_radius_m), limits: Some(limits) };
        for leg in [leg, cut] {
            let audited = audit_leg(&audit_field, &motion, &leg, SampleStep::default());
            legs += audited.unwrap_or_else(|violation| panic!("{violation}")).legs;
        }
    }
    assert!(legs > 40, "{legs} legs");
}
