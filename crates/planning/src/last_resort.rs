//! What every built-in planner tries before it gives up.
//!
//! The last stages of planners keep 2 to 5 cm, and their lattices suit the contest's truck. Where they lead nowhere, these
//! are tried in turn; each keeps the least clearance of all paths, and takes no part in a query that succeeds:
//!
//! 1. single curves into the goal, and a turn and a straight into a disc;
//! 2. for a vehicle of another length than the contest's truck, the searches of `hybrid-astar` on a field that is scaled
//!    until the vehicle is as long: see [`VehicleUnits`];
//! 3. from a start or to a goal pose that is tighter than the stages, a straight or an arc to where there is room, and the
//!    planner itself between these places.

use crate::collision::{CollisionChecker, MIN_CLEARANCE_M};
use crate::kit::drive_cost::DriveCost;
use crate::kit::relaxed_search::{RelaxedSearch, RelaxedSettings};
use crate::kit::target::Target;
use crate::kit::turn_straight::TurnStraightSteering;
use crate::kit::vehicle_units::{UnscaledLines, VehicleUnits};
use crate::memory::MemoryMeter;
use crate::observer::{NullObserver, PlanningObserver, PlanningWork};
use crate::registry::PlannerContext;
use crate::{BuildReport, Effort, FoundBy, Goal, GoalDisc, NearestPlan, Plan, PlanFailure, TruckPlanner};
use wildfire_base::geometry::Pose;
use wildfire_base::rng::Xoshiro256PlusPlus;
use wildfire_base::vehicle::{CurvePrice, Path, ReedsShepp, Segment};

/// A pose with less clearance is tight, in metres: somewhat more than the last stages of planners keep.
const TIGHT_M: f64 = 0.06;
/// Lengths of the ways out of a tight pose, in body lengths.
const WAYS_OUT: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Ways out that are tried at each end, the shortest first.
const MAX_WAYS_OUT: usize = 2;

/// A built-in planner, and what it tries last.
pub struct LastResort {
    planner: Box<dyn TruckPlanner>,
    checker: CollisionChecker,
    steering: TurnStraightSteering,
    settings: RelaxedSettings,
    rng: Xoshiro256PlusPlus,
    memory: MemoryMeter,
    /// Made by the first query that needs it; `None` for a vehicle as long as the contest's truck.
    scaled: Option<Option<(VehicleUnits, RelaxedSearch)>>,
}

impl LastResort {
    /// Wraps a planner that was built for this context.
    pub fn new(planner: Box<dyn TruckPlanner>, context: &PlannerContext<'_>) -> Self {
        let settings = context.settings.hybrid.search(DriveCost::Length, context.limits);
        Self {
            planner,
            checker: context.checker.clone(),
            steering: TurnStraightSteering::new(context.body, settings.cost.motion_price(context.body)),
            settings,
            rng: (context.stream)("shortcuts"),
            memory: context.memory.clone(),
            scaled: None,
        }
    }

    /// Tries all that is left for a query that failed, and adds what is expanded to its effort.
    fn find(
        &mut self,
        start: Pose,
        goal: Goal,
        effort: &mut Effort,
        observer: &mut dyn PlanningObserver,
    ) -> Option<(Path, FoundBy)> {
        // Curves need no search, so they come before all that counts as effort.
        if let Some(path) = self.single_curve(start, goal) {
            return Some((path, FoundBy::Relaxed));
        }
        observer.begins(Some(PlanningWork::Local));
        let scaled = self.scaled_search(start, goal, effort, observer);
        observer.begins(None);
        scaled.or_else(|| self.between_ways_out(start, goal, effort, observer))
    }

    fn is_free(&self, path: &Path) -> bool {
        path.legs().all(|(from, segment)| self.checker.motion_is_free(from, segment, MIN_CLEARANCE_M))
    }

    fn single_curve(&self, start: Pose, goal: Goal) -> Option<Path> {
        match goal.with_margin() {
            Goal::Pose(end) => {
                let mut curves = Vec::new();
                let radius_m = self.checker.body().turning_radius_m;
                ReedsShepp { radius_m }.candidates(start, end, &CurvePrice::LENGTH, &mut curves);
                curves.iter().map(|priced| priced.curve.path(start)).find(|path| self.is_free(path))
            }
            Goal::Disc(disc) => {
                let ways = self.steering.all_into(start, disc).into_iter();
                ways.map(|way| Path { start, segments: way.pieces().collect() }).find(|path| self.is_free(path))
            }
        }
    }

    fn scaled_search(
        &mut self,
        start: Pose,
        goal: Goal,
        effort: &mut Effort,
        observer: &mut dyn PlanningObserver,
    ) -> Option<(Path, FoundBy)> {
        let checker = &self.checker;
        let memory = &self.memory;
        let settings = &self.settings;
        let rng = &self.rng;
        let scaled = self.scaled.get_or_insert_with(|| {
            let units = VehicleUnits::new(checker)?;
            let search = RelaxedSearch::new(&units.checker, memory, settings.clone(), rng.clone());
            Some((units, search))
        });
        let (units, search) = scaled.as_mut()?;
        let scaled_goal = units.goal(goal.with_margin());
        let found = search.find(units.pose(start), Target::from(&scaled_goal), &mut UnscaledLines { observer, units });
        effort.local_expansions += search.expansions();
        let found = found.ok()?;
        let path = units.path_from(start, &found.path);
        // Scaling rounds, so the path is swept once more on the field that it is driven on.
        self.is_free(&path).then_some((path, found.by))
    }

    fn between_ways_out(
        &mut self,
        start: Pose,
        goal: Goal,
        effort: &mut Effort,
        observer: &mut dyn PlanningObserver,
    ) -> Option<(Path, FoundBy)> {
        let starts = self.ways_out(start);
        let ends = if let Goal::Pose(end) = goal { self.ways_out(end) } else { vec![None] };
        // Up to four pairs, as each of them is a whole query.
        for (out, back) in starts.iter().flat_map(|out| ends.iter().map(move |back| (*out, *back))) {
            // Without a way out at either end this is the very query that failed.
            if out.is_none() && back.is_none() {
                continue;
            }
            let from = out.map_or(start, |segment| segment.end(start));
            let to = match (goal, back) {
                (Goal::Pose(end), Some(segment)) => Goal::Pose(segment.end(end)),
                _ => goal,
            };
            let plan = self.planner.plan_observed(from, to, observer);
            *effort += plan.effort;
            if let Ok(between) = plan.path {
                // A way out of the goal's pose is driven back into it.
                let back = back.map(|segment| Segment { length_m: -segment.length_m, ..segment });
                let segments = out.into_iter().chain(between.segments).chain(back).collect();
                return Some((Path { start, segments }.joined(), FoundBy::Relaxed));
            }
        }
        None
    }

    /// Returns the shortest free motions from a tight pose to where it is not, or to stay where there is room.
    fn ways_out(&self, pose: Pose) -> Vec<Option<Segment>> {
        if self.checker.clearance(pose) >= TIGHT_M {
            return vec![None];
        }
        let body = self.checker.body();
        let turns = [0.0, 1.0, -1.0].map(|side| side * body.max_curvature());
        let ways = WAYS_OUT.into_iter().flat_map(|lengths| {
            let length_m = lengths * body.length_m;
            [length_m, -length_m]
                .into_iter()
                .flat_map(move |length_m| turns.into_iter().map(move |curvature| Segment { curvature, length_m }))
        });
        ways.filter(|segment| {
            // One pose is looked at in a fraction of the time of a sweep.
            self.checker.pose_is_free(segment.end(pose), TIGHT_M)
                && self.checker.motion_is_free(pose, *segment, MIN_CLEARANCE_M)
        })
        .take(MAX_WAYS_OUT)
        .map(Some)
        .collect()
    }
}

impl TruckPlanner for LastResort {
    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        let mut plan = self.planner.plan_observed(start, goal, observer);
        // A blocked start or goal stays blocked, whatever else is searched.
        if let Err(PlanFailure::Disconnected | PlanFailure::BudgetSpent) = plan.path
            && let Some((path, by)) = self.find(start, goal, &mut plan.effort, observer)
        {
            plan.path = Ok(path);
            plan.found_by = Some(by);
        }
        plan
    }

    fn plan_to_nearest(
        &mut self,
        start: Pose,
        discs: &[GoalDisc],
        observer: &mut dyn PlanningObserver,
    ) -> Option<NearestPlan> {
        let NearestPlan { index, mut plan } = self.planner.plan_to_nearest(start, discs, observer)?;
        if let Err(PlanFailure::Disconnected | PlanFailure::BudgetSpent) = plan.path {
            // Which is nearest by drive is open here: the first disc with a way counts.
            for (index, &disc) in discs.iter().enumerate() {
                if let Some((path, by)) = self.find(start, disc.into(), &mut plan.effort, observer) {
                    let plan = Plan { path: Ok(path), found_by: Some(by), ..plan };
                    return Some(NearestPlan { index, plan });
                }
            }
        }
        Some(NearestPlan { index, plan })
    }

    fn build_report(&self) -> BuildReport {
        self.planner.build_report()
    }

    fn show_roadmap(&mut self, observer: &mut dyn PlanningObserver) {
        self.planner.show_roadmap(observer);
    }
}
