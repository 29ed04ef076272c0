//! The planner `prm-rs`: a probabilistic roadmap over poses, joined by Reeds-Shepp curves.

mod near;
mod roadmap;
mod sample;
mod search;
mod settings;

pub use settings::PrmRsSettings;

use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::rng::Xoshiro256PlusPlus;
use crate::time::cpu::CpuStopwatch;
use crate::vehicle::Path;

use super::clearance_floor::ClearanceFloor;
use super::ends::free_clearance;
use super::hybrid_astar::outlook::Lookout;
use super::improve::Improver;
use super::{
    BuildReport, Effort, Goal, GoalDisc, HybridAstar, HybridSettings, Plan, QueryTime, TruckPlanner, primitives,
};
use roadmap::{LEVELS, Roadmap};
use sample::Sampler;
use search::{Search, Task};

#[expect(clippy::disallowed_types, reason = "x")]
pub fn knob(number: usize, default: f64) -> f64 {
    static K: std::sync::OnceLock<Vec<Option<f64>>> = std::sync::OnceLock::new();
    K.get_or_init(|| (0..12).map(|k| std::env::var(format!("K{k}")).ok().and_then(|v| v.parse().ok())).collect())
        [number]
        .unwrap_or(default)
}

/// The planner for one body on one field.
#[derive(Debug)]
pub struct PrmRs {
    checker: CollisionChecker,
    settings: PrmRsSettings,
    lookout: Lookout,
    roadmap: Roadmap,
    search: Search,
    improver: Improver,
    /// Where every query begins to draw its shortcuts.
    shortcuts: Xoshiro256PlusPlus,
    fallback: HybridAstar,
    report: BuildReport,
    effort: Effort,
}

impl PrmRs {
    /// `rng` decides where the roadmap's poses lie, `shortcuts` which shortcuts are tried.
    pub fn build(
        checker: &CollisionChecker,
        settings: &PrmRsSettings,
        hybrid: &HybridSettings,
        mut rng: Xoshiro256PlusPlus,
        shortcuts: Xoshiro256PlusPlus,
    ) -> Self {
        let mut watch = CpuStopwatch::start();
        let mut sampler = Sampler::new(checker, settings.clearance_m, &mut rng);
        let mut poses = sampler.draw(settings.samples);
        poses.extend(sampler.at_corners(settings.corner_places));
        let sampling = watch.lap();
        let mut roadmap = Roadmap::new(checker, settings);
        roadmap.add(poses);
        roadmap.finish();
        let report = BuildReport {
            samples: roadmap.node_count() as u32,
            draws: sampler.draws,
            edges: roadmap.edge_count() as u32,
            components: roadmap.components,
            sampling,
            connecting: watch.lap(),
        };
        Self {
            checker: checker.clone(),
            settings: settings.clone(),
            lookout: Lookout::new(&HybridSettings { cusp_cost: settings.cusp_cost, ..hybrid.clone() }, checker.body()),
            search: Search::new(checker.body(), &roadmap),
            roadmap,
            improver: Improver::new(checker, settings.cusp_cost),
            shortcuts: shortcuts.clone(),
            fallback: HybridAstar::build(checker, hybrid, shortcuts),
            report,
            effort: Effort::default(),
        }
    }

    /// A path by way of the roadmap, or straight away, and the floor that it keeps.
    fn find(&mut self, start: Pose, goal: Goal) -> Option<(Path, Option<ClearanceFloor>)> {
        let mut ends = vec![(start, free_clearance(&self.checker, start)?)];
        if let Goal::Pose(end) = goal {
            ends.push((end, free_clearance(&self.checker, end)?));
        }
        for level in 0..LEVELS {
            let floor = ClearanceFloor::new(self.roadmap.clearance_m(level), ends.iter().copied());
            if level == 0
                && let Some(path) = self.straight_away(start, goal, &floor)
            {
                return Some((path, None));
            }
            let task = Task { checker: &self.checker, lookout: &self.lookout, floor: &floor, level, start, goal };
            let path = self.search.run(&task, &mut self.roadmap);
            self.effort.roadmap_expansions += self.search.roadmap_expansions;
            self.effort.local_expansions += self.search.local_expansions;
            if let Some(path) = path {
                return Some((path, Some(floor)));
            }
        }
        None
    }

    /// The way that an empty field would allow, if it is free.
    fn straight_away(&self, start: Pose, goal: Goal, floor: &ClearanceFloor) -> Option<Path> {
        let approach = self.lookout.without_bushes(start, None, goal).approach?;
        let is_free = floor.way_is_free(&self.checker, start, approach.segments());
        is_free.then(|| Path { start, segments: approach.segments().collect() })
    }

    fn improve(&mut self, path: &Path, goal: Goal, floor: &ClearanceFloor) -> Path {
        let mut rng = self.shortcuts.clone();
        let path = self.improver.improve(path, floor, self.settings.shortcuts, &mut rng);
        match goal {
            Goal::Pose(_) => path,
            Goal::Disc(disc) => self.end_sooner(path, disc, floor),
        }
    }

    /// The path with another way into the disc, where that is cheaper.
    fn end_sooner(&self, mut path: Path, disc: GoalDisc, floor: &ClearanceFloor) -> Path {
        let is_free = |pose, segment| floor.motion_is_free(&self.checker, pose, segment);
        let body = self.checker.body();
        primitives::shorten(body, self.lookout.aiming(), is_free, path.start, disc, &mut path.segments);
        path
    }
}

impl TruckPlanner for PrmRs {
    fn build_report(&self) -> BuildReport {
        self.report
    }

    fn plan(&mut self, start: Pose, goal: Goal) -> Plan {
        let mut watch = CpuStopwatch::start();
        self.effort = Effort::default();
        let found = self.find(start, goal.inner());
        let mut effort = self.effort;
        let roadmap = watch.lap();
        match found {
            Some((path, floor)) => {
                let path = match floor {
                    Some(floor) => self.improve(&path, goal.inner(), &floor),
                    None => path,
                };
                Plan { path: Ok(path), effort, time: QueryTime { roadmap, local: watch.lap() } }
            }
            None => {
                let plan = self.fallback.plan(start, goal);
                effort.local_expansions += plan.effort.local_expansions;
                Plan { effort, time: QueryTime { roadmap, local: watch.lap() }, ..plan }
            }
        }
    }
}
