//! Laws that hold for every planner of the registry, at its default settings.
//!
//! A planner that is added is tested here without a line more. What is particular to one planner, and how often it must
//! succeed, is tested beside it.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::DVec2;

use wildfire_base::geometry::Pose;
use wildfire_base::vehicle::{Dimensions, Path, Segment};

use super::collision::{ClearanceField, CollisionChecker};
use super::judge::Judge;
use super::registry::{OwnedSettings, TruckPlannerKind};
use super::test_fields::{TestField, assert_drivable, drives_in_a_row, drives_to_poses, random_free_pose, shut_court};
use super::{
    Goal, GoalDisc, NearestPlan, NullObserver, Plan, PlanFailure, PlanningObserver, QueryMonitor, SearchPhase,
    TruckPlanner, plan_to_nearest,
};

fn planner(kind: TruckPlannerKind, field: &TestField, seed: u64) -> Box<dyn TruckPlanner> {
    field.make(&OwnedSettings::default(), seed, |context| kind.make(context))
}

fn every_planner(law: impl FnMut(TruckPlannerKind)) {
    TruckPlannerKind::ALL.into_iter().for_each(law);
}

fn disc(pose: Pose, radius_m: f64) -> Goal {
    Goal::Disc(GoalDisc { centre: pose.position(), radius_m })
}

/// Some discs about bushes, and some free poses.
fn some_goals(field: &mut TestField, each: usize) -> Vec<Goal> {
    let mut goals: Vec<Goal> = (0..each).map(|_| Goal::Disc(field.random_goal())).collect();
    goals.extend((0..each).map(|_| Goal::Pose(random_free_pose(field, 0.3))));
    goals
}

#[test]
fn drives_in_a_row_are_drivable_and_seldom_fail_where_the_flood_says_yes() {
    every_planner(|kind| {
        let drives = drives_in_a_row(3, 40, |field, seed| planner(kind, field, seed));
        assert!(drives.solved > 40 && drives.missed <= 2, "{kind}: {drives:?}");
    });
}

#[test]
fn drives_to_poses_end_there_and_are_no_shorter_than_on_an_empty_field() {
    every_planner(|kind| {
        let solved = drives_to_poses(4, 8, |field, seed| planner(kind, field, seed));
        assert!(solved >= 26, "{kind}: {solved} of 32");
    });
}

#[test]
fn a_drive_can_begin_anywhere_on_another() {
    every_planner(|kind| {
        let mut field = TestField::random(4, 25);
        let mut planner = planner(kind, &field, 4);
        let mut pose = field.start;
        for _ in 0..60 {
            let goal = field.random_goal();
            let path = planner.plan(pose, goal.into()).path.expect("an open field");
            assert_drivable(&field.checker, &path, pose, goal);
            // It stops on the way, where the first segment is half driven.
            if let Some(first) = path.segments.first() {
                pose = first.pose_at(pose, 0.5 * first.length_m);
            }
        }
    });
}

/// The number of goals that a planner reaches by paths that may be driven.
fn count_solved(kind: TruckPlannerKind, field: &TestField, goals: &[Goal]) -> usize {
    let judge = Judge::new(field.checker.clone());
    let mut planner = planner(kind, field, 1);
    let plans = goals.iter().filter_map(|&goal| Some((goal, planner.plan(field.start, goal).path.ok()?)));
    plans.map(|(goal, path)| assert_eq!(judge.check(field.start, goal, &path), Ok(()), "{kind}: {goal:?}")).count()
}

/// Field, truck and goals in other units of length are as hard as in metres.
#[test]
fn vehicles_of_every_size_reach_as_many_goals() {
    let mut open = TestField::random(3, 45);
    let goals = [(); 6].map(|()| random_free_pose(&mut open, 0.5));
    // Two bends in a corridor of twice the width of the truck.
    let bends = TestField::drawn(
        &["#########", "#......##", "#.####.##", "#.#######", "#########"],
        Pose::new(9.0, 7.5, FRAC_PI_2),
    );
    let robot =
        Dimensions { length_m: 3.5, width_m: 2.4, wheelbase_m: 2.0, turning_radius_m: 3.4, ..Dimensions::default() };
    let checker = CollisionChecker::new(
        Arc::new(ClearanceField::new(*bends.checker.field().frame(), bends.checker.field().occupied())),
        robot,
    );
    let bends = TestField { checker, start: Pose::new(7.5, 7.0, FRAC_PI_2), ..bends };
    for (field, goals) in [(open, goals.to_vec()), (bends, vec![Pose::new(32.5, 13.0, -FRAC_PI_2)])] {
        every_planner(|kind| {
            let solved = [1.0, 0.05, 0.2, 0.7, 3.0, 20.0].map(|scale| {
                let goals = goals.iter().map(|end| Goal::Pose(Pose { x: scale * end.x, y: scale * end.y, ..*end }));
                count_solved(kind, &field.scaled(scale), &goals.collect::<Vec<_>>())
            });
            assert!(solved[0] > 0 && solved.iter().all(|&of_size| of_size >= solved[0]), "{kind}: {solved:?}");
        });
    }
}

/// A truck 1 to 2.5 cm beside a bush drives on, back, away and to such a place.
#[test]
fn drives_that_keep_a_centimetre_are_found() {
    let field = |start| {
        let mut picture = ["...................."; 20];
        picture[10] = "....##..............";
        TestField::drawn(&picture, start)
    };
    let half_m = 0.5 * Dimensions::default().width_m;
    for gap_m in [0.0101, 0.015, 0.02, 0.025] {
        let beside = |x: f64| Pose::new(x, 50.0 + half_m + gap_m, 0.0);
        let far = Pose::new(80.0, 20.0, 2.0);
        for (start, end) in [
            (beside(22.0), beside(40.0)),
            (beside(24.0), beside(8.0)),
            (beside(14.0), beside(26.0)),
            (beside(24.0), far),
            (far, beside(24.0)),
            (beside(28.0), Segment { curvature: 1.0 / 13.0, length_m: 18.0 }.end(beside(28.0))),
        ] {
            let field = field(start);
            every_planner(|kind| {
                let solved = count_solved(kind, &field, &[Goal::Pose(end)]);
                assert_eq!(solved, 1, "{kind}, {gap_m} m: {start:?} to {end:?}");
            });
        }
    }
}

#[test]
fn a_disc_without_extent_is_met_with_the_middle_of_the_body() {
    every_planner(|kind| {
        let field = TestField::random(4, 15);
        let centre = DVec2::new(60.0, 75.0);
        let path = planner(kind, &field, 4).plan(field.start, GoalDisc { centre, radius_m: 0.0 }.into()).path;
        let end = path.expect("an open field").end();
        assert!(field.checker.body().body_centre(end).distance(centre) < 1e-5, "{kind}: {end:?}");
    });
}

#[test]
fn the_nearest_of_several_discs_is_hardly_farther_than_the_nearest_when_queried_for_each() {
    every_planner(|kind| {
        let (mut together_m, mut apart_m) = (0.0, 0.0);
        for seed in 0..4 {
            let mut field = TestField::random(seed, 40);
            for _ in 0..6 {
                let discs = [(); 4].map(|()| field.random_goal());
                let start = random_free_pose(&mut field, 0.3);
                let mut planner = planner(kind, &field, seed);
                let singles = discs.map(|disc| planner.plan(start, disc.into()).path.ok());
                let shortest = singles.iter().flatten().map(Path::length_m).min_by(f64::total_cmp);
                let body = *field.checker.body();
                let NearestPlan { index, plan } =
                    plan_to_nearest(planner.as_mut(), &body, start, &discs, &mut NullObserver)
                        .expect("there are discs");
                assert_eq!(plan.path.is_ok(), shortest.is_some(), "{kind}, seed {seed}");
                if let (Ok(path), Some(shortest_m)) = (plan.path, shortest) {
                    assert_drivable(&field.checker, &path, start, discs[index]);
                    together_m += path.length_m();
                    apart_m += shortest_m;
                }
            }
        }
        assert!(together_m < 1.1 * apart_m, "{kind}: {together_m} m, {apart_m} m");
    });
}

#[test]
fn without_a_disc_none_is_the_nearest() {
    let field = TestField::random(1, 25);
    let mut planner = planner(TruckPlannerKind::Lattice, &field, 1);
    let body = *field.checker.body();
    assert!(plan_to_nearest(planner.as_mut(), &body, field.start, &[], &mut NullObserver).is_none());
}

#[test]
fn answers_do_not_depend_on_previous_queries() {
    every_planner(|kind| {
        for seed in 0..2 {
            let mut field = TestField::random(seed, 40);
            let goals = some_goals(&mut field, 6);
            let mut one = planner(kind, &field, seed);
            let mut two = planner(kind, &field, seed);
            // The second has answered other queries before: nothing may be left of them.
            for &goal in goals.iter().rev() {
                let _ = two.plan(field.start, goal);
            }
            for &goal in &goals {
                let a = one.plan(field.start, goal);
                let b = two.plan(field.start, goal);
                assert_eq!((a.path, a.found_by, a.effort), (b.path, b.found_by, b.effort));
            }
        }
    });
}

#[test]
fn observers_see_where_searches_look_and_change_no_answer() {
    every_planner(|kind| {
        let mut field = TestField::random(6, 40);
        let goals = some_goals(&mut field, 4);
        let mut seen = planner(kind, &field, 6);
        let mut unseen = planner(kind, &field, 6);
        for goal in goals {
            let mut monitor = QueryMonitor::new(true);
            let Plan { path, found_by, effort, .. } = seen.plan_observed(field.start, goal, &mut monitor);
            let searched = monitor.finish().searches;
            let plan = unseen.plan(field.start, goal);
            assert_eq!((&path, found_by, effort), (&plan.path, plan.found_by, plan.effort));
            assert_eq!(found_by.is_some(), path.is_ok());
            let looked = searched.iter().any(|searched| searched.phase == SearchPhase::Local);
            assert!(looked || effort.local_expansions == 0, "{kind}: what is expanded is shown");
            assert!(searched.windows(2).all(|pair| pair[0].phase < pair[1].phase), "each phase once, in order");
        }
    });
}

/// Counts the lines that it is shown.
#[derive(Default)]
struct CountsLines(usize);

impl PlanningObserver for CountsLines {
    fn begins(&mut self, _work: Option<super::PlanningWork>) {}

    fn on_edges_examined(&mut self, _phase: SearchPhase, lines: &mut dyn Iterator<Item = [DVec2; 2]>) {
        self.0 += lines.count();
    }
}

#[test]
fn a_roadmap_is_shown_where_one_is_reported() {
    every_planner(|kind| {
        let field = TestField::random(2, 25);
        let mut planner = planner(kind, &field, 2);
        let mut shown = CountsLines::default();
        planner.show_roadmap(&mut shown);
        let report = planner.build_report();
        assert_eq!(shown.0 > 0, report.edges > 0, "{kind}: {} lines of {report:?}", shown.0);
        assert!(shown.0 <= report.edges as usize);
    });
}

#[test]
fn a_start_in_the_goal_stays_there() {
    every_planner(|kind| {
        let field = TestField::random(1, 25);
        let centre = field.checker.body().body_centre(field.start);
        for radius_m in [5.0, f64::INFINITY] {
            let plan = planner(kind, &field, 1).plan(field.start, GoalDisc { centre, radius_m }.into());
            assert_eq!(plan.path, Ok(Path::standing(field.start)), "{kind}");
        }
    });
}

#[test]
fn failures_have_their_reasons() {
    every_planner(|kind| {
        let field = shut_court();
        let mut planner = planner(kind, &field, 1);
        let bush = Pose::new(42.0, 40.0, 0.0);
        let court = Pose::new(60.0, 25.0, 0.0);
        let outside = Pose::new(-3.0, 20.0, 0.0);
        let mut reason = |start, goal| planner.plan(start, goal).path.err();
        for start in [bush, outside, Pose { x: f64::NAN, ..field.start }] {
            for goal in [disc(court, 4.0), Goal::Pose(field.start)] {
                assert_eq!(reason(start, goal), Some(PlanFailure::StartBlocked), "{kind}: {start:?}");
            }
        }
        for goal in [Goal::Pose(bush), disc(bush, 1.0), disc(bush, 0.5), Goal::Pose(outside)] {
            assert_eq!(reason(field.start, goal), Some(PlanFailure::GoalBlocked), "{kind}: {goal:?}");
        }
        for goal in [Goal::Pose(court), disc(court, 4.0)] {
            let walled_in = reason(field.start, goal);
            let is_expected = matches!(walled_in, Some(PlanFailure::Disconnected | PlanFailure::BudgetSpent));
            assert!(is_expected, "{kind}: {walled_in:?}");
        }
    });
}

#[test]
fn goals_and_starts_that_cannot_be_are_answered() {
    every_planner(|kind| {
        let field = TestField::random(2, 25);
        let mut planner = planner(kind, &field, 2);
        for wild in [f64::NAN, f64::INFINITY, -1e300, 1e9, -5.0] {
            let place = Pose { x: wild, y: 20.0, heading: 0.0 };
            let turned = Pose { heading: if wild.is_finite() { f64::NAN } else { wild }, ..field.start };
            for goal in [disc(place, 3.0), Goal::Pose(place), Goal::Pose(turned)] {
                assert_eq!(planner.plan(field.start, goal).path, Err(PlanFailure::GoalBlocked), "{kind}: {goal:?}");
            }
            let plan = planner.plan(place, Goal::Pose(field.start));
            assert_eq!(plan.path, Err(PlanFailure::StartBlocked), "{kind}: {wild}");
        }
    });
}
