//! The planner `prm-rs`: a probabilistic roadmap over poses, joined by Reeds-Shepp curves.
//!
//! After L. E. Kavraki, P. Svestka, J.-C. Latombe, M. H. Overmars, "Probabilistic roadmaps for path planning in
//! high-dimensional configuration spaces", IEEE Trans. Robotics and Automation 12(4), 1996. Milestones are poses: some
//! drawn evenly, with headings along the bushes that are near, some that pass the corners of bushes. Each is joined to its
//! nearest predecessors by curves that can be driven both ways. Curves are swept while components of the roadmap are joined
//! where they would join some, and otherwise when a search first asks (R. Bohlin, L. E. Kavraki, "Path planning using lazy
//! PRM", ICRA 2000). About milestones that are not joined to the most, more poses are tried. Components are joined while the
//! roadmap is made, or when a query fails on it.
//!
//! A query searches the roadmap, and motions about the start, together: A* whose candidates wait at what the whole path
//! would cost, curves from the start and analytic expansions among them. Where the wanted clearance leads nowhere,
//! less is asked for; where that does not serve either, the searches of `hybrid-astar` take over. What the roadmap gives is
//! improved by shortcuts under the same clearance.
//!
//! Poses are those of the rear axle, positions in a goal disc those of the body's centre; world frame, metres.

mod near;
mod roadmap;
mod sample;
mod search;
mod settings;

pub use settings::{Join, PrmRsSettings};

use crate::collision::CollisionChecker;
use crate::kit::clearance_profile::ClearanceProfile;
use crate::kit::drive_cost::CostModel;
use crate::kit::ends::free_ends;
use crate::kit::heuristic::PoseHeuristic;
use crate::kit::milestone_tiles::is_small;
use crate::kit::path_improvement::{Improvement, PathImprover};
use crate::kit::relaxed_search::RelaxedSearch;
use crate::kit::target::Target;
use crate::memory::MemoryMeter;
use crate::observer::{NullObserver, PlanningObserver, PlanningWork};
use crate::registry::{BuiltInPlanner, Charge, PlannerContext, RoadmapSize, TruckPlannerSettings};
use crate::{BuildReport, Effort, Found, FoundBy, Goal, GoalDisc, NearestPlan, Plan, TruckPlanner};
use glam::DVec2;
use rand::Rng;
use roadmap::{Roadmap, RoadmapSite, SCHEDULE};
use sample::Sampler;
use search::{RoadmapQuery, RoadmapSearch};
use wildfire_base::geometry::{FieldFrame, Pose};
use wildfire_base::query::SearchPhase;
use wildfire_base::rng::Xoshiro256PlusPlus;
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_base::vehicle::Path;

/// A roadmap that grows forgets everything before a query once it has more milestones than this: some 20 MB.
const MAX_REMEMBERED: usize = 40_000;

/// The planner for one body on one field.
#[derive(Debug)]
pub struct PrmRs {
    checker: CollisionChecker,
    improvement: Improvement,
    heuristic: PoseHeuristic,
    roadmap: Roadmap,
    /// Whether its components are still to be joined.
    is_unjoined: bool,
    memory: MemoryMeter,
    search: RoadmapSearch,
    improver: PathImprover,
    /// The state from which every query draws its shortcuts.
    rng: Xoshiro256PlusPlus,
    fallback: RelaxedSearch,
    report: BuildReport,
}

impl PrmRs {
    /// The stream `prm-rs` decides where the roadmap's poses lie, `shortcuts` which shortcuts are tried.
    pub fn build(context: &PlannerContext<'_>) -> Self {
        let roadmap =
            if is_small(context.checker.field().frame()) { whole_roadmap(context) } else { growing_roadmap(context) };
        Self::with(context, roadmap)
    }

    fn with(context: &PlannerContext<'_>, (roadmap, report): (Roadmap, BuildReport)) -> Self {
        let &PlannerContext { checker, memory, .. } = context;
        let TruckPlannerSettings { prm_rs: settings, hybrid, .. } = *context.settings;
        let cost = roadmap_site(context).cost;
        let shortcuts = (context.stream)("shortcuts");
        Self {
            is_unjoined: !roadmap.is_lazy() && settings.join == Join::WhenNeeded,
            memory: memory.clone(),
            checker: checker.clone(),
            improvement: improvement(settings),
            heuristic: PoseHeuristic::new(cost, checker.body()),
            search: RoadmapSearch::new(checker.body(), memory, &roadmap),
            roadmap,
            improver: PathImprover::new(checker, cost),
            rng: shortcuts.clone(),
            fallback: RelaxedSearch::new(checker, memory, hybrid.search(context.cost, context.limits), shortcuts),
            report,
        }
    }

    /// Finds a path by way of the roadmap, or by an analytic expansion of the start, and the clearance that it keeps
    /// where it may be improved.
    fn find(
        &mut self,
        start: Pose,
        target: Target<'_>,
        effort: &mut Effort,
        observer: &mut dyn PlanningObserver,
    ) -> Option<(Found, Option<ClearanceProfile>)> {
        // What is wrong with the ends is reported by the fallback, which looks at them again.
        let ends = free_ends(&self.checker, start, target).ok()?;
        let found = self.find_between(&ends, start, target, effort, observer);
        if found.is_some() || !self.is_unjoined {
            return found;
        }
        // Joining sweeps many edges, so it waits for the first query that fails without it, and is done once.
        self.is_unjoined = false;
        self.roadmap.join_components();
        self.roadmap.build_graph();
        // Its notes are numbered by the nodes and links of the old graph.
        self.search = RoadmapSearch::new(self.checker.body(), &self.memory, &self.roadmap);
        self.find_between(&ends, start, target, effort, observer)
    }

    /// Does the same between poses that are free, each given with its clearance.
    fn find_between(
        &mut self,
        ends: &[(Pose, f64)],
        start: Pose,
        target: Target<'_>,
        effort: &mut Effort,
        observer: &mut dyn PlanningObserver,
    ) -> Option<(Found, Option<ClearanceProfile>)> {
        // Where a growing roadmap does not serve at the wanted clearance, the lattice search asks for less sooner.
        let levels = if self.roadmap.is_lazy() { 1 } else { SCHEDULE.len() };
        for (level, stage) in SCHEDULE.iter().enumerate().take(levels) {
            let profile = ClearanceProfile::new(self.roadmap.clearance_m(level), ends.iter().copied());
            if level == 0
                && let Some(path) = self.heuristic.free_expansion(&self.checker, start, target, &profile)
            {
                return Some((Found { path, by: FoundBy::Straight }, None));
            }
            let query = RoadmapQuery {
                checker: &self.checker,
                heuristic: &self.heuristic,
                profile: &profile,
                level,
                start,
                target,
            };
            // With each level the profile asks for less clearance, so that the first path found keeps the most.
            let path = self.search.run(&query, &mut self.roadmap);
            observer.on_edges_examined(SearchPhase::Query, &mut self.search.lines(false));
            observer.on_edges_examined(SearchPhase::Local, &mut self.search.lines(true));
            *effort += self.search.effort();
            if let Ok(path) = path {
                let by = match self.search.used_roadmap() {
                    _ if stage.is_relaxed() => FoundBy::Relaxed,
                    true => FoundBy::Roadmap,
                    false => FoundBy::Search,
                };
                return Some((Found { path, by }, Some(profile)));
            }
        }
        None
    }
}

/// Returns what the roadmap needs of the truck and the field.
fn roadmap_site<'a>(context: &PlannerContext<'a>) -> RoadmapSite<'a> {
    let settings = context.settings.prm_rs;
    let cost = CostModel::new(context.cost, context.limits, settings.cusp_cost);
    RoadmapSite { checker: context.checker, memory: context.memory, settings, cost }
}

/// Returns what is tried on paths that the roadmap gives.
fn improvement(settings: &PrmRsSettings) -> Improvement {
    Improvement { shortcuts: settings.shortcuts, pulls: settings.pulls }
}

/// Builds the roadmap of a whole field.
fn whole_roadmap(context: &PlannerContext<'_>) -> (Roadmap, BuildReport) {
    let checker = context.checker;
    let settings = context.settings.prm_rs;
    let mut rng = (context.stream)("prm-rs");
    let mut watch = CpuStopwatch::start();
    let mut sampler = Sampler::new(checker, settings.clearance_m, &mut rng);
    // Corner samples come after the random ones, so that their number does not change these.
    let mut poses = sampler.draw(settings.samples_on(checker.field().frame()));
    poses.extend(sampler.corner_samples(settings.corner_places));
    let sampling = watch.elapsed_since_last();
    let mut roadmap = Roadmap::new(&roadmap_site(context));
    roadmap.add_milestones(poses);
    let (tried, components) = match settings.join {
        Join::AtOnce => (roadmap.join_components(), roadmap.components()),
        // No curve has been swept yet, so connections are still open.
        Join::WhenNeeded => (0, 0),
    };
    roadmap.build_graph();
    let report = BuildReport {
        samples: roadmap.node_count() as u32,
        draws: sampler.draws + tried,
        edges: roadmap.edge_count() as u32,
        components,
        sampling,
        connecting: watch.elapsed_since_last(),
        ..BuildReport::default()
    };
    (roadmap, report)
}

/// Prepares a roadmap that grows; there is nothing to report of it yet.
fn growing_roadmap(context: &PlannerContext<'_>) -> (Roadmap, BuildReport) {
    let key = (context.stream)("prm-rs").next_u64();
    (Roadmap::lazy(&roadmap_site(context), key), BuildReport::default())
}

impl TruckPlanner for PrmRs {
    fn build_report(&self) -> BuildReport {
        self.report
    }

    fn show_roadmap(&mut self, observer: &mut dyn PlanningObserver) {
        observer.on_edges_examined(SearchPhase::Roadmap, &mut self.roadmap.free_lines());
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        self.plan_observed(start, goal, &mut NullObserver)
    }

    fn plan_observed(&mut self, start: Pose, goal: Goal, observer: &mut dyn PlanningObserver) -> Plan {
        self.plan_into(start, Target::from(&goal.with_margin()), observer)
    }

    fn plan_to_nearest(
        &mut self,
        start: Pose,
        discs: &[GoalDisc],
        observer: &mut dyn PlanningObserver,
    ) -> Option<NearestPlan> {
        let discs: Vec<GoalDisc> = discs.iter().map(|disc| disc.with_margin()).collect();
        let plan = self.plan_into(start, Target::Discs(&discs), observer);
        let end = plan.path.as_ref().map_or(start, Path::end);
        Some(NearestPlan { index: Target::Discs(&discs).disc_of(end, self.checker.body()), plan })
    }
}

impl PrmRs {
    fn plan_into(&mut self, start: Pose, target: Target<'_>, observer: &mut dyn PlanningObserver) -> Plan {
        observer.begins(Some(PlanningWork::Roadmap));
        // Only between queries: a search holds numbers of nodes.
        self.roadmap.forget_beyond(MAX_REMEMBERED);
        let mut effort = Effort::default();
        let found = self.find(start, target, &mut effort, observer);
        let found = match found {
            Some((Found { path, by }, Some(profile))) => {
                observer.begins(Some(PlanningWork::Local));
                // The stream is cloned, so that a query draws the same numbers whatever was asked before.
                let path = self.improver.improve(&path, &profile, self.improvement, &mut self.rng.clone());
                Ok(Found { path: self.heuristic.shorten_end(&self.checker, path, target, &profile), by })
            }
            // The cheapest curve on an empty field cannot be improved.
            Some((found, None)) => Ok(found),
            None => {
                observer.begins(Some(PlanningWork::Local));
                // To an observer the fallback is no search of its own: where it begins was shown.
                let found = self.fallback.find(start, target, &mut ConnectionsOnly(observer));
                effort.local_expansions += self.fallback.expansions();
                found
            }
        };
        observer.begins(None);
        Plan::new(found, effort)
    }
}

/// Shows an observer the lines that lead from one place to another, and not where searches began: the search that is the
/// fallback goes on from the start, and is no search of its own.
struct ConnectionsOnly<'a>(&'a mut dyn PlanningObserver);

impl PlanningObserver for ConnectionsOnly<'_> {
    fn begins(&mut self, _work: Option<PlanningWork>) {}

    fn on_edges_examined(&mut self, phase: SearchPhase, lines: &mut dyn Iterator<Item = [DVec2; 2]>) {
        self.0.on_edges_examined(phase, &mut lines.filter(|[from, to]| from != to));
    }
}

/// Makes planners of the name `prm-rs`.
pub struct PrmRsFactory;

impl BuiltInPlanner for PrmRsFactory {
    fn make(&self, context: &PlannerContext<'_>) -> Box<dyn TruckPlanner> {
        Box::new(PrmRs::build(context))
    }

    fn tables(&self) -> &'static [&'static str] {
        &["prm_rs", "hybrid"]
    }

    fn knows_time(&self) -> bool {
        true
    }

    fn charge(&self, settings: &TruckPlannerSettings<'_>) -> Charge {
        Charge { roadmap_s: settings.prm_rs.seconds_per_expansion, local_s: settings.hybrid.seconds_per_expansion }
    }

    /// A roadmap that grows has no size of its own.
    fn roadmap_size(
        &self,
        settings: &TruckPlannerSettings<'_>,
        frame: &FieldFrame,
        bushes: usize,
    ) -> Option<RoadmapSize> {
        let PrmRsSettings { corner_places, neighbours, max_edge_m, .. } = *settings.prm_rs;
        let samples = u64::from(settings.prm_rs.samples_on(frame));
        let at_corners = 4 * bushes as u64 * u64::from(corner_places);
        is_small(frame).then_some(RoadmapSize { milestones: samples + at_corners, neighbours, max_edge_m })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::MemoryMeter;
    use crate::reachability::Reachability;
    use crate::registry::OwnedSettings;
    use crate::test_fields::{TestField, drives_in_a_row, drives_to_poses, paths_that_keep, shut_court};
    use crate::{GoalDisc, PlanFailure};

    fn planner(field: &TestField, seed: u64) -> PrmRs {
        let prm_rs = PrmRsSettings { samples: 100, ..PrmRsSettings::default() };
        field.make(&OwnedSettings { prm_rs, ..OwnedSettings::default() }, seed, PrmRs::build)
    }

    #[test]
    fn drives_in_a_row_are_drivable_and_fail_only_where_the_flood_says_no() {
        for walks in [25, 45] {
            let drives = drives_in_a_row(8, walks, |field, seed| Box::new(planner(field, seed)));
            assert!(drives.solved >= 140 && drives.missed == 0, "{walks} walks: {drives:?}");
        }
    }

    /// The planner as it is on a large field.
    fn lazy(field: &TestField, seed: u64) -> PrmRs {
        field.make(&OwnedSettings::default(), seed, |context| PrmRs::with(context, growing_roadmap(context)))
    }

    #[test]
    fn on_a_growing_roadmap_drives_are_drivable_and_fail_hardly_where_the_flood_says_yes() {
        for walks in [25, 45] {
            let drives = drives_in_a_row(8, walks, |field, seed| Box::new(lazy(field, seed)));
            assert!(drives.solved + drives.unreachable >= 143 && drives.missed <= 1, "{walks} walks: {drives:?}");
        }
    }

    #[test]
    fn a_growing_roadmap_answers_the_same_whatever_the_previous_queries() {
        let mut field = TestField::random(3, 40);
        let goals: Vec<GoalDisc> = (0..12).map(|_| field.random_goal()).collect();
        let mut kept = lazy(&field, 3);
        for &goal in goals.iter().chain(goals.iter().rev()) {
            let one = kept.plan(field.start, goal.into());
            let two = lazy(&field, 3).plan(field.start, goal.into());
            assert_eq!((one.path, one.found_by, one.effort), (two.path, two.found_by, two.effort));
            kept.roadmap.forget_beyond(300);
        }
    }

    #[test]
    fn small_fields_have_one_roadmap_and_large_ones_none_until_a_drive_needs_it() {
        let frame = |cells| FieldFrame { cols: cells, rows: cells, cell_m: 5.0 };
        assert!(is_small(&frame(100)) && !is_small(&frame(101)));
        let mut field = TestField::random(1, 40);
        let mut planner = lazy(&field, 1);
        assert_eq!((planner.roadmap.node_count(), planner.build_report().samples), (0, 0));
        for _ in 0..8 {
            let goal = field.random_goal();
            planner.plan(field.start, goal.into());
        }
        assert!(planner.roadmap.node_count() > 0);
    }

    #[test]
    fn dense_fields_are_served_as_far_as_the_flood_reaches() {
        let mut served = 0;
        for seed in 0..4 {
            let mut field = TestField::random(seed, 60);
            let mut planner = planner(&field, seed);
            let mut reachability = Reachability::new(&field.checker, &MemoryMeter::unlimited(), field.start);
            for _ in 0..8 {
                let goal = field.random_goal();
                let is_solved = planner.plan(field.start, goal.into()).path.is_ok();
                assert!(is_solved || !reachability.reaches(goal), "seed {seed}: {goal:?} is in reach");
                served += u32::from(is_solved);
            }
        }
        assert!(served >= 25, "{served} of 32");
    }

    #[test]
    fn drives_to_poses_end_there_and_are_no_shorter_than_on_an_empty_field() {
        let solved = drives_to_poses(8, 10, |field, seed| Box::new(planner(field, seed)));
        assert!(solved >= 78, "{solved} of 80");
    }

    #[test]
    fn the_wanted_clearance_is_kept_where_start_and_goal_have_it() {
        let kept = paths_that_keep(PrmRsSettings::default().clearance_m, |field, seed| Box::new(planner(field, seed)));
        assert!(kept > 15, "{kept} paths keep it");
    }

    #[test]
    fn what_is_walled_in_is_disconnected() {
        let field = shut_court();
        let mut planner = planner(&field, 1);
        let court = Pose::new(60.0, 25.0, 0.0);
        for goal in [Goal::Pose(court), Goal::Disc(GoalDisc { centre: court.position(), radius_m: 4.0 })] {
            assert_eq!(planner.plan(field.start, goal).path, Err(PlanFailure::Disconnected));
        }
    }

    #[test]
    fn the_report_counts_what_was_built_and_the_same_seed_builds_the_same() {
        let field = TestField::random(3, 25);
        let one = planner(&field, 3);
        let two = planner(&field, 3);
        let counts = |planner: &PrmRs| {
            let BuildReport { samples, draws, edges, components, .. } = planner.build_report();
            [samples, draws, edges, components]
        };
        assert_eq!(counts(&one), counts(&two));
        let poses = |planner: &PrmRs| -> Vec<Pose> {
            (0..planner.roadmap.node_count() as u32).map(|node| planner.roadmap.pose(node)).collect()
        };
        assert_eq!(poses(&one), poses(&two));
        let [samples, draws, edges, components] = counts(&one);
        assert!(samples >= 100 && draws >= samples && edges >= samples && (1..samples / 10).contains(&components));
    }

    #[test]
    fn without_a_roadmap_motions_and_the_lattice_search_do_it() {
        let mut field = TestField::random(5, 25);
        let prm_rs = PrmRsSettings { samples: 0, corner_places: 0, ..PrmRsSettings::default() };
        let mut bare = field.make(&OwnedSettings { prm_rs, ..OwnedSettings::default() }, 5, PrmRs::build);
        for _ in 0..10 {
            let goal = field.random_goal();
            let plan = bare.plan(field.start, goal.into());
            assert!(plan.path.is_ok() && plan.effort.roadmap_expansions == 0);
        }
    }

    #[test]
    fn a_full_field_builds_nothing() {
        let field = TestField::drawn(&["####", "####", "####"], Pose::new(9.0, 9.0, 0.0));
        let report = planner(&field, 1).build_report();
        assert_eq!((report.samples, report.edges, report.components), (0, 0, 0));
    }
}
