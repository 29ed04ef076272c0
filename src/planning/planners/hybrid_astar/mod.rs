//! The planner `hybrid-astar`: a search over a lattice of poses that looks ahead with Reeds-Shepp curves.
//!
//! D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel, "Path planning for autonomous vehicles in unknown semi-structured
//! environments", IJRR 29(5), 2010, section 3: motions of constant curvature, an estimate that is the greater of the
//! curve to the goal on an empty field and of a walk round the bushes, and curves into the goal that end the search.
//! Here motions are swept only when their turn comes (R. Bohlin, L. E. Kavraki, "Path planning using lazy PRM", ICRA
//! 2000), and the curves into the goal wait in the same queue, at what the whole path would cost.
//!
//! Searches come in a ladder: where the wanted clearance leads nowhere, less is asked for, from both ends in turn. Then
//! the flood of [`super::lattice`] is asked; the last searches are on a fine lattice. What is found is improved
//! by shortcuts under the same clearance.
//!
//! Poses are those of the rear axle, places in a goal disc those of the body's centre; world frame, metres.

mod ladder;
mod search;
mod settings;

pub use settings::{HybridSettings, Maker};

use crate::collision::{CollisionChecker, LEAST_CLEARANCE_M};
use crate::geometry::{FieldFrame, Pose};
use crate::rng::Xoshiro256PlusPlus;
use crate::time::cpu::CpuStopwatch;
use crate::vehicle::{Dimensions, Path};

use super::lattice::{LatticePlanner, LatticeSettings};
use crate::planning::kit::clearance_profile::ClearanceFloor;
use crate::planning::kit::ends::{free_ends, free_poses, has_free_pose};
use crate::planning::kit::heuristic::Lookout;
use crate::planning::kit::holonomic::{Cells, Wave};
use crate::planning::kit::local_search::Ending;
use crate::planning::kit::shortcuts::Improver;
use crate::planning::memory::{MemoryMeter, PlannerMemory};
use crate::planning::reachability::{Floods, LATTICES, Lattice};
use crate::planning::search_graph::{SearchPhase, SearchRecorder};
use crate::planning::{BuildReport, Effort, Found, FoundBy, Goal, Plan, PlanFailure, QueryTime, TruckPlanner};
use ladder::{LADDER, LatticeKind, Method, Rung, TURN};
use search::{Search, Task};

const FINEST: Lattice = LATTICES[LATTICES.len() - 1];
/// The number of floods that are asked: the coarsest alone.
const FLOODS: usize = 1;
/// Of the two sides of a search.
const BACKWARD: usize = 1;
/// A disc is searched from at poses on so many rings.
const START_RINGS: u32 = 4;

/// The planner for one body on one field.
#[derive(Debug)]
pub struct HybridAstar {
    checker: CollisionChecker,
    settings: HybridSettings,
    memory: MemoryMeter,
    cells: Cells,
    lookout: Lookout,
    /// From the start and from the goal.
    coarse: [Search; 2],
    fine: Option<[Search; 2]>,
    /// To the goal and to the start.
    waves: [Wave; 2],
    improver: Improver,
    lattice: LatticePlanner,
    /// Where every query begins to draw its shortcuts.
    rng: Xoshiro256PlusPlus,
    expansions: u32,
    recorder: SearchRecorder,
}

impl HybridAstar {
    /// `rng` decides which shortcuts are tried; every query draws the same numbers.
    pub fn build(
        checker: &CollisionChecker,
        memory: &MemoryMeter,
        settings: &HybridSettings,
        rng: Xoshiro256PlusPlus,
    ) -> Self {
        let lattice = Lattice { bin_m: settings.bin_m, headings: settings.headings, step_m: settings.step_m };
        Self {
            checker: checker.clone(),
            settings: settings.clone(),
            memory: memory.clone(),
            cells: Cells::new(checker),
            lookout: Lookout::new(settings.cusp_cost, checker.body()),
            coarse: searches(settings, lattice, checker.body(), memory),
            fine: None,
            waves: Default::default(),
            improver: Improver::new(checker, settings.cusp_cost),
            lattice: LatticePlanner::build(checker, memory, &LatticeSettings::default()),
            rng,
            expansions: 0,
            recorder: SearchRecorder::default(),
        }
    }

    /// The most bytes that it takes.
    pub fn memory(frame: &FieldFrame, settings: &HybridSettings) -> PlannerMemory {
        let most = |kind: LatticeKind, side: usize| {
            let budgets = LADDER.iter().filter_map(|rung| match rung.method {
                Method::Searches { lattice, forward, backward } if lattice == kind => Some([forward, backward][side]),
                _ => None,
            });
            Search::most_bytes(budgets.max().unwrap_or(0).min(settings.max_expansions))
        };
        let kinds = [LatticeKind::Coarse, LatticeKind::Fine];
        let searches: u64 = kinds.into_iter().map(|kind| most(kind, 0) + most(kind, BACKWARD)).sum();
        let flood = Floods::most_bytes(frame, FLOODS, settings.max_expansions);
        let cells = Cells::bytes(frame) + 2 * Wave::most_bytes(frame);
        PlannerMemory { held: cells, grows: searches + flood, ..PlannerMemory::default() }
    }

    fn find(&mut self, start: Pose, goal: Goal) -> Result<Found, PlanFailure> {
        let ends = free_ends(&self.checker, start, goal)?;
        if let Some(path) = self.straight_away(start, goal, &ends) {
            return Ok(Found { path, by: FoundBy::Straight });
        }
        self.climb(start, goal, &ends).map_err(|failure| match goal {
            Goal::Disc(disc) if !has_free_pose(&self.checker, disc) => PlanFailure::GoalBlocked,
            _ => failure,
        })
    }

    /// The way that an empty field would allow, if the wanted clearance is kept on it.
    fn straight_away(&self, start: Pose, goal: Goal, ends: &[(Pose, f64)]) -> Option<Path> {
        let floor = ClearanceFloor::new(self.settings.clearance_m, ends.iter().copied());
        self.lookout.straight_away(&self.checker, start, goal, &floor)
    }

    /// One rung after the other, until one succeeds. The last one tells why not.
    fn climb(&mut self, start: Pose, goal: Goal, ends: &[(Pose, f64)]) -> Result<Found, PlanFailure> {
        self.waves[0].begin(&self.cells, goal);
        self.waves[1].begin(&self.cells, Goal::Pose(start));
        let mut ending = Ending::Exhausted;
        for Rung { share, method } in LADDER {
            let clearance_m = (share * self.settings.clearance_m).max(LEAST_CLEARANCE_M);
            let floor = ClearanceFloor::new(clearance_m, ends.iter().copied());
            let path = match method {
                Method::Searches { lattice, forward, backward } => {
                    let path = self.search(lattice, [forward, backward], start, goal, (&floor, clearance_m));
                    self.record(lattice, backward > 0);
                    path
                }
                Method::Flood => self.flood(start, goal),
            };
            match path {
                Ok(path) => {
                    let by = match method {
                        Method::Flood | Method::Searches { lattice: LatticeKind::Fine, .. } => FoundBy::Lattice,
                        Method::Searches { .. } if share < 1.0 => FoundBy::Relaxed,
                        Method::Searches { .. } => FoundBy::Search,
                    };
                    return Ok(Found { path: self.improve(path, goal, &floor), by });
                }
                Err(failed) => ending = failed,
            }
        }
        Err(if ending == Ending::Exhausted { PlanFailure::Disconnected } else { PlanFailure::BudgetSpent })
    }

    /// Searches from both ends in turn, until one finds a way or those that are left cannot.
    fn search(
        &mut self,
        lattice: LatticeKind,
        budgets: [u32; 2],
        start: Pose,
        goal: Goal,
        (floor, clearance_m): (&ClearanceFloor, f64),
    ) -> Result<Path, Ending> {
        let Self { checker, settings, memory, cells, lookout, coarse, fine, waves: [to_goal, to_start], .. } = self;
        let [forward, backward] = match lattice {
            LatticeKind::Coarse => coarse,
            LatticeKind::Fine => fine.get_or_insert_with(|| searches(settings, FINEST, checker.body(), memory)),
        };
        let mut ahead = Task { checker, lookout, floor, goal, cells, wave: to_goal };
        let mut back = Task { checker, lookout, floor, goal: Goal::Pose(start), cells, wave: to_start };
        forward.begin(&mut ahead, [start]);
        match goal {
            _ if budgets[1] == 0 => {}
            Goal::Pose(end) => backward.begin(&mut back, [end]),
            Goal::Disc(disc) => backward.begin(&mut back, free_poses(checker, disc, START_RINGS, clearance_m)),
        }
        let is_disc = matches!(goal, Goal::Disc(_));
        let mut sides = [(forward, ahead), (backward, back)];
        let mut left = budgets;
        let mut ending = Ending::Exhausted;
        while left != [0, 0] {
            for (side, (search, task)) in sides.iter_mut().enumerate() {
                if left[side] == 0 {
                    continue;
                }
                let turn = TURN.min(left[side]).min(settings.max_expansions - self.expansions);
                let (path, spent) = search.carry_on(task, turn);
                self.expansions += spent;
                left[side] -= spent;
                match path {
                    // Driven back, it would begin at the start but for rounding.
                    Ok(path) if side == BACKWARD => return Ok(Path { start, ..path.reversed() }),
                    Ok(path) => return Ok(path),
                    Err(Ending::BudgetSpent) if self.expansions < settings.max_expansions => {
                        ending = Ending::BudgetSpent;
                    }
                    // From a disc only some poses were searched, and beyond the fine lattice there is nothing to try.
                    Err(Ending::Exhausted) if lattice == LatticeKind::Fine || (side == BACKWARD && is_disc) => {
                        left[side] = 0;
                    }
                    Err(failure) => return Err(failure),
                }
            }
        }
        Err(ending)
    }

    /// Records what the searches of a rung looked at, first those from the start.
    fn record(&mut self, lattice: LatticeKind, is_two_sided: bool) {
        let [forward, backward] = match lattice {
            LatticeKind::Coarse => &self.coarse,
            LatticeKind::Fine => self.fine.as_ref().expect("it was searched"),
        };
        self.recorder.add(forward.reached());
        if is_two_sided {
            self.recorder.add(backward.reached());
        }
    }

    fn flood(&mut self, start: Pose, goal: Goal) -> Result<Path, Ending> {
        let (path, spent) =
            self.lattice.find_within(self.settings.max_expansions - self.expansions, FLOODS, start, goal);
        self.expansions += spent;
        let searched = self.lattice.take_searched();
        self.recorder.add(searched.iter().flat_map(|searched| searched.graph.lines()));
        path.map_err(|_| Ending::Exhausted)
    }

    fn improve(&mut self, path: Path, goal: Goal, floor: &ClearanceFloor) -> Path {
        let mut rng = self.rng.clone();
        let path = self.improver.improve(&path, floor, self.settings.shortcuts, &mut rng);
        self.lookout.end_sooner(&self.checker, path, goal, floor)
    }
}

fn searches(settings: &HybridSettings, lattice: Lattice, body: &Dimensions, memory: &MemoryMeter) -> [Search; 2] {
    [(); 2].map(|()| Search::new(settings, lattice, body, memory))
}

impl TruckPlanner for HybridAstar {
    fn build_report(&self) -> BuildReport {
        BuildReport::default()
    }

    fn record_searches(&mut self) {
        self.recorder.switch_on();
        self.lattice.record_searches();
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let mut watch = CpuStopwatch::start();
        self.expansions = 0;
        let path = self.find(start, goal.inner());
        let effort = Effort { roadmap_expansions: 0, local_expansions: self.expansions };
        let time = QueryTime { local: watch.lap(), ..QueryTime::default() };
        Plan::new(path, effort, time, Vec::from_iter(self.recorder.take(SearchPhase::Local)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::MOTION_TOLERANCE_M;
    use crate::planning::GoalDisc;
    use crate::planning::test_fields::{
        TestField, assert_ends_in, drives_in_a_row, least_clearance, random_free_pose, random_pose, shut_court,
    };
    use crate::rng;
    use crate::vehicle::{Dimensions, ReedsShepp};
    use glam::DVec2;

    fn planner(field: &TestField, seed: u64) -> HybridAstar {
        HybridAstar::build(
            &field.checker,
            &MemoryMeter::unlimited(),
            &HybridSettings::default(),
            rng::stream(seed, "hybrid"),
        )
    }

    #[test]
    fn drives_in_a_row_are_drivable_and_fail_hardly_where_the_flood_says_yes() {
        for walks in [25, 45] {
            let drives = drives_in_a_row(8, walks, planner);
            assert!(drives.solved + drives.unreachable >= 143 && drives.missed <= 1, "{walks} walks: {drives:?}");
        }
    }

    #[test]
    fn drives_to_poses_end_there_and_are_no_shorter_than_on_an_empty_field() {
        let curves = ReedsShepp { radius_m: Dimensions::default().turning_radius_m };
        let mut solved = 0;
        for seed in 0..8 {
            let mut field = TestField::random(seed, 40);
            let mut planner = planner(&field, seed);
            for _ in 0..10 {
                let (start, end) = (field.start, random_free_pose(&mut field, 0.3));
                let Ok(path) = planner.plan(start, Goal::Pose(end)).path else { continue };
                assert_ends_in(&field.checker, &path, Goal::Pose(end));
                assert!(path.segments.iter().all(|segment| segment.curvature.abs() <= 1.0 / curves.radius_m));
                assert!(least_clearance(&field.checker, &path) > 0.0);
                assert!(path.length_m() >= curves.length_m(start, end) - 1e-9);
                solved += 1;
            }
        }
        assert!(solved >= 76, "{solved} of 80");
    }

    #[test]
    fn the_wanted_clearance_is_kept_where_start_and_goal_have_it() {
        let field = TestField::random(4, 15);
        let mut planner = planner(&field, 4);
        let mut rng = rng::stream(4, "goals");
        let mut kept = 0;
        for _ in 0..40 {
            let goal = random_pose(&mut rng, 150.0);
            if field.checker.pose_is_free(goal, 1.0)
                && let Ok(path) = planner.plan(field.start, Goal::Pose(goal)).path
            {
                kept += u32::from(least_clearance(&field.checker, &path) > 0.75 - MOTION_TOLERANCE_M);
            }
        }
        assert!(kept > 15, "{kept} paths keep it");
    }

    #[test]
    fn a_place_is_met_with_the_middle_of_the_body() {
        let field = TestField::random(4, 15);
        let mut planner = planner(&field, 4);
        let centre = DVec2::new(60.0, 75.0);
        let path = planner.plan(field.start, Goal::Disc(GoalDisc { centre, radius_m: 0.0 })).path;
        let end = path.expect("an open field").end();
        assert!(field.checker.body().body_centre(end).distance(centre) < 1e-6);
    }

    #[test]
    fn answers_do_not_depend_on_what_was_asked_before() {
        for seed in 0..3 {
            let mut field = TestField::random(seed, 40);
            let mut goals: Vec<Goal> = (0..6).map(|_| Goal::Disc(field.random_goal())).collect();
            goals.extend((0..4).map(|_| Goal::Pose(random_free_pose(&mut field, 0.3))));
            let (mut one, mut two) = (planner(&field, seed), planner(&field, seed));
            for &goal in goals.iter().rev() {
                let _ = two.plan(field.start, goal);
            }
            for &goal in &goals {
                let (a, b) = (one.plan(field.start, goal), two.plan(field.start, goal));
                assert_eq!((a.path, a.effort), (b.path, b.effort));
            }
        }
    }

    #[test]
    fn a_start_in_the_goal_stays_there() {
        let field = TestField::random(1, 25);
        let centre = field.checker.body().body_centre(field.start);
        for radius_m in [5.0, f64::INFINITY] {
            let plan = planner(&field, 1).plan(field.start, GoalDisc { centre, radius_m }.into());
            assert_eq!(plan.path, Ok(Path::standing(field.start)));
        }
    }

    #[test]
    fn failures_have_their_reasons() {
        let field = shut_court();
        let mut planner = planner(&field, 1);
        let (bush, court) = (Pose::new(42.0, 40.0, 0.0), Pose::new(60.0, 25.0, 0.0));
        let disc = |pose: Pose, radius_m| Goal::Disc(GoalDisc { centre: pose.position(), radius_m });
        let mut reason = |start, goal| planner.plan(start, goal).path.err();
        assert_eq!(reason(bush, disc(court, 4.0)), Some(PlanFailure::StartBlocked));
        assert_eq!(reason(Pose::new(f64::NAN, 20.0, 0.0), disc(court, 4.0)), Some(PlanFailure::StartBlocked));
        assert_eq!(reason(field.start, Goal::Pose(bush)), Some(PlanFailure::GoalBlocked));
        assert_eq!(reason(field.start, Goal::Pose(Pose::new(-5.0, 20.0, 0.0))), Some(PlanFailure::GoalBlocked));
        assert_eq!(reason(field.start, disc(bush, 1.0)), Some(PlanFailure::GoalBlocked));
        assert_eq!(reason(field.start, Goal::Pose(court)), Some(PlanFailure::Disconnected));
        assert_eq!(reason(field.start, disc(court, 4.0)), Some(PlanFailure::Disconnected));
        let short = HybridSettings { max_expansions: 1, ..HybridSettings::default() };
        let mut hasty = HybridAstar::build(&field.checker, &MemoryMeter::unlimited(), &short, rng::stream(1, "hybrid"));
        let behind = Goal::Pose(Pose::new(88.0, 25.0, 1.0));
        let plan = hasty.plan(field.start, behind);
        assert_eq!((plan.path, plan.effort.local_expansions), (Err(PlanFailure::BudgetSpent), 1));
    }

    #[test]
    fn no_path_is_shorter_than_a_walker_is_promised() {
        for seed in 0..6 {
            let mut field = TestField::random(seed, 45);
            let mut planner = planner(&field, seed);
            for _ in 0..8 {
                let disc = field.random_goal();
                let mut wave = Wave::default();
                wave.begin(&planner.cells, Goal::Disc(disc));
                let promised = wave.least_m(&planner.cells, field.checker.body().body_centre(field.start));
                if let Ok(path) = planner.plan(field.start, disc.into()).path {
                    assert!(promised <= path.length_m() + 1e-9, "{promised} m, but {} m", path.length_m());
                }
            }
        }
    }

    #[test]
    fn goals_that_cannot_be_are_answered() {
        let field = TestField::random(2, 25);
        let mut planner = planner(&field, 2);
        for wild in [f64::NAN, f64::INFINITY, -1e300, 1e9, -5.0] {
            let disc = GoalDisc { centre: DVec2::new(wild, 20.0), radius_m: 3.0 };
            let plan = planner.plan(field.start, disc.into());
            assert_eq!((plan.path, plan.effort), (Err(PlanFailure::GoalBlocked), Effort::default()), "{wild}");
            let pose = Goal::Pose(Pose { x: wild, y: 5.0, heading: 0.0 });
            assert_eq!(planner.plan(field.start, pose).path, Err(PlanFailure::GoalBlocked), "{wild}");
            let turned = Goal::Pose(Pose { heading: if wild.is_finite() { f64::NAN } else { wild }, ..field.start });
            assert_eq!(planner.plan(field.start, turned).path, Err(PlanFailure::GoalBlocked), "{wild}");
        }
    }
}
