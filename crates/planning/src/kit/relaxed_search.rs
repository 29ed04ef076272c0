//! Searches over a lattice of poses that require less clearance in turn, including the last resorts.
//!
//! D. Dolgov, S. Thrun, M. Montemerlo, J. Diebel, "Path planning for autonomous vehicles in unknown semi-structured
//! environments", IJRR 29(5), 2010, section 3: motions of constant curvature, an estimate that is the greater of the
//! curve to the goal on an empty field and of a walk round the bushes, and analytic expansions that end the search.
//!
//! Where the wanted clearance leads nowhere, less is asked for, from both ends in turn (see [`schedule`]). Then a flood is
//! asked; the last searches are on a fine lattice. What is found is improved by shortcuts under the same clearance.

use crate::collision::CollisionChecker;
use crate::memory::MemoryMeter;
use crate::observer::PlanningObserver;
use crate::{Found, FoundBy, Goal, PlanFailure};
use wildfire_base::geometry::Pose;
use wildfire_base::query::SearchPhase;
use wildfire_base::rng::Xoshiro256PlusPlus;
use wildfire_base::vehicle::{Dimensions, Path, Segment};

use super::best_first::{AnalyticExpansion, Candidate, Never, Node, PoseSearch, SearchFailure, SearchOf, SearchSpace};
use super::clearance_profile::ClearanceProfile;
use super::drive_cost::CostModel;
use super::ends::{explain_failure, free_ends, free_poses_in};
use super::floods::{FloodQuery, FloodSearch, LATTICES};
use super::heuristic::PoseHeuristic;
use super::holonomic::HolonomicHeuristic;
use super::lattice::Lattice;
use super::path_improvement::{Improvement, PathImprover};
use super::relaxation::Stage;
use super::target::Target;

/// Share of the wanted clearance that the last stages keep.
const MIN_SHARE: f64 = 0.04;
/// The last stages look for any way, and a greedy search finds one in fewer expansions: their heuristic has this weight at
/// least. On fields with 30 % of their cells under bushes a weight of 1.2 misses 12 drives of a hundred, one of 1.5 three.
const LAST_WEIGHT: f64 = 1.5;

/// The effort of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StageMethod {
    /// Searches from the start and from the goal in turn, each with its maximum of expanded nodes.
    Searches { lattice: LatticeKind, forward: u32, backward: u32 },
    /// The coarsest flood from the start.
    Flood,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LatticeKind {
    /// The lattice of the settings.
    Coarse,
    /// The finest lattice of the floods.
    Fine,
}

const fn searches(share: f64, lattice: LatticeKind, forward: u32, backward: u32) -> Stage<StageMethod> {
    Stage { share, effort: StageMethod::Searches { lattice, forward, backward } }
}

/// Nodes that a search of the coarse lattice expands at most.
const MAX_COARSE: u32 = 5_000;
/// The maximum number of expansions of the first stage.
pub const MAX_FIRST_EXPANSIONS: u32 = MAX_COARSE;

/// Returns the stages, the first of which may expand this number of nodes. The first that succeeds gives the path.
///
/// Long detours are cheaper for the flood than for a search, because it looks at every bin once; tight ends need the
/// short motions of the fine lattice.
const fn schedule(first_expansions: u32) -> [Stage<StageMethod>; 6] {
    [
        searches(1.0, LatticeKind::Coarse, first_expansions, 0),
        searches(2.0 / 3.0, LatticeKind::Coarse, 150, 150),
        searches(1.0 / 3.0, LatticeKind::Coarse, 250, 250),
        searches(MIN_SHARE, LatticeKind::Coarse, MAX_COARSE, MAX_COARSE),
        Stage { share: MIN_SHARE, effort: StageMethod::Flood },
        searches(MIN_SHARE, LatticeKind::Fine, 20_000, 20_000),
    ]
}

/// Searches from both ends take turns of this number of expansions.
const TURN: u32 = 100;
/// The number of floods that are asked: the coarsest alone.
const FLOODS: usize = 1;
/// Of the two sides of a search.
const BACKWARD: usize = 1;
/// A disc is searched from at poses on this number of rings.
const START_RINGS: u32 = 4;

/// The settings of a [`RelaxedSearch`]. Lengths are metres.
#[derive(Clone, Debug)]
pub struct RelaxedSettings {
    /// The wanted clearance.
    pub clearance_m: f64,
    /// The lattice of all searches but the last.
    pub lattice: Lattice,
    /// The cost by which paths are compared.
    pub cost: CostModel,
    pub heuristic_weight: f64,
    /// The effort spent on improving the path found.
    pub improvement: Improvement,
    /// The maximum number of nodes that the first stage expands.
    pub first_expansions: u32,
    /// The maximum number of nodes that one query expands, over all its searches.
    pub max_expansions: u32,
}

/// The searches of one body on one field.
#[derive(Debug)]
pub struct RelaxedSearch {
    checker: CollisionChecker,
    settings: RelaxedSettings,
    memory: MemoryMeter,
    heuristic: PoseHeuristic,
    /// From the start and from the goal.
    coarse: [LatticeSearch; 2],
    fine: Option<[LatticeSearch; 2]>,
    /// Walks to the goal and to the start.
    walks: [HolonomicHeuristic; 2],
    improver: PathImprover,
    floods: FloodSearch,
    /// The state from which every query draws its shortcuts.
    rng: Xoshiro256PlusPlus,
    expansions: u32,
}

/// A search whose nodes note their analytic expansions.
type LatticeSearch = PoseSearch<Option<AnalyticExpansion>, Never>;

/// The drive that a query asks for.
struct DriveEnds<'a> {
    start: Pose,
    target: Target<'a>,
    /// The poses that are given, with the body's clearances there.
    ends: &'a [(Pose, f64)],
}

impl RelaxedSearch {
    /// `rng` decides which shortcuts are tried; every query draws the same numbers.
    pub fn new(
        checker: &CollisionChecker,
        memory: &MemoryMeter,
        settings: RelaxedSettings,
        rng: Xoshiro256PlusPlus,
    ) -> Self {
        let body = checker.body();
        Self {
            checker: checker.clone(),
            memory: memory.clone(),
            heuristic: PoseHeuristic::new(settings.cost, body),
            coarse: [(); 2].map(|()| PoseSearch::new(body, settings.lattice, memory)),
            fine: None,
            walks: [(); 2].map(|()| HolonomicHeuristic::new(memory)),
            improver: PathImprover::new(checker, settings.cost),
            floods: FloodSearch::new(checker, memory),
            rng,
            expansions: 0,
            settings,
        }
    }

    pub fn body(&self) -> &Dimensions {
        self.checker.body()
    }

    /// Returns the nodes that the last query expanded.
    pub fn expansions(&self) -> u32 {
        self.expansions
    }

    /// Finds a path from a pose to a target.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn find(
        &mut self,
        start: Pose,
        target: Target<'_>,
        observer: &mut dyn PlanningObserver,
    ) -> Result<Found, PlanFailure> {
        self.expansions = 0;
        let ends = free_ends(&self.checker, start, target)?;
        let profile = ClearanceProfile::new(self.settings.clearance_m, ends.iter().copied());
        // In open ground the curve alone arrives, without an expansion.
        if let Some(path) = self.heuristic.free_expansion(&self.checker, start, target, &profile) {
            return Ok(Found { path, by: FoundBy::Straight });
        }
        self.relax(&DriveEnds { start, target, ends: &ends }, observer)
            .map_err(|failure| explain_failure(&self.checker, target, failure))
    }

    /// Goes through the schedule until a stage succeeds. The last one tells why not.
    fn relax(&mut self, drive: &DriveEnds<'_>, observer: &mut dyn PlanningObserver) -> Result<Found, PlanFailure> {
        let &DriveEnds { start, target, ends } = drive;
        let field = self.checker.field();
        let body = self.checker.body();
        // The estimates do not depend on a stage's clearance, so all stages share them. Most drives need none from the
        // goal.
        self.walks[0].begin(field, target, target.position_of(start, body));
        let mut walks_back = false;
        let mut ending = SearchFailure::Exhausted;
        for stage in schedule(self.settings.first_expansions) {
            let min_clearance_m = stage.min_clearance_m(self.settings.clearance_m, f64::INFINITY);
            let profile = ClearanceProfile::new(min_clearance_m, ends.iter().copied());
            let (path, by) = match stage.effort {
                StageMethod::Searches { lattice, forward, backward } => {
                    if backward > 0 && !walks_back {
                        self.walks[BACKWARD].begin(self.checker.field(), Target::Pose(start), target.position());
                        walks_back = true;
                    }
                    let starts_behind: Vec<Pose> = match target {
                        _ if backward == 0 => Vec::new(),
                        Target::Pose(end) => vec![end],
                        Target::Discs(discs) => discs
                            .iter()
                            .flat_map(|&disc| free_poses_in(&self.checker, disc, START_RINGS, min_clearance_m))
                            .collect(),
                    };
                    let weight = self.settings.heuristic_weight;
                    // The last stage is after any path: a greedier search finds one within the budget where a careful
                    // one would not.
                    let weight = if stage.share == MIN_SHARE { weight.max(LAST_WEIGHT) } else { weight };
                    let path = self.search(lattice, [forward, backward], drive, &profile, &starts_behind, weight);
                    self.show(lattice, backward > 0, observer);
                    let by = match lattice {
                        LatticeKind::Fine => FoundBy::Lattice,
                        LatticeKind::Coarse if stage.is_relaxed() => FoundBy::Relaxed,
                        LatticeKind::Coarse => FoundBy::Search,
                    };
                    (path, by)
                }
                StageMethod::Flood => (self.flood(start, target, observer), FoundBy::Lattice),
            };
            match path {
                Ok(path) => {
                    let improvement = self.settings.improvement;
                    // The profile of the stage, so that improving never gives up clearance that the path has.
                    let path = self.improver.improve(&path, &profile, improvement, &mut self.rng.clone());
                    return Ok(Found { path: self.heuristic.shorten_end(&self.checker, path, target, &profile), by });
                }
                Err(failed) => ending = failed,
            }
        }
        Err(match ending {
            SearchFailure::Exhausted => PlanFailure::Disconnected,
            SearchFailure::BudgetSpent => PlanFailure::BudgetSpent,
        })
    }

    /// Searches from both ends in turn, until one finds a way or those that are left cannot.
    fn search(
        &mut self,
        lattice: LatticeKind,
        budgets: [u32; 2],
        drive: &DriveEnds<'_>,
        profile: &ClearanceProfile,
        starts_behind: &[Pose],
        weight: f64,
    ) -> Result<Path, SearchFailure> {
        let &DriveEnds { start, target, .. } = drive;
        let Self { checker, settings, memory, heuristic, coarse, fine, walks: [to_goal, to_start], .. } = self;
        let [forward, backward] = match lattice {
            LatticeKind::Coarse => coarse,
            LatticeKind::Fine => fine.get_or_insert_with(|| {
                [(); 2].map(|()| PoseSearch::new(checker.body(), LATTICES[LATTICES.len() - 1], memory))
            }),
        };
        let (checker, heuristic) = (&*checker, &*heuristic);
        let mut ahead = LatticeSpace { checker, heuristic, profile, target, walk: to_goal, weight };
        let back = Target::Pose(start);
        let mut behind = LatticeSpace { checker, heuristic, profile, target: back, walk: to_start, weight };
        forward.begin(&mut ahead, [start], None);
        if budgets[BACKWARD] > 0 {
            backward.begin(&mut behind, starts_behind.iter().copied(), None);
        }
        let mut sides = [(forward, ahead), (backward, behind)];
        let mut left = budgets;
        let mut ending = SearchFailure::Exhausted;
        while left != [0, 0] {
            // They take turns: the one that begins in the narrower place ends soonest, and which that is is not known.
            for (side, (search, space)) in sides.iter_mut().enumerate() {
                if left[side] == 0 {
                    continue;
                }
                // Three limits: of the turn, of the stage and of the whole query.
                let turn = TURN.min(left[side]).min(settings.max_expansions - self.expansions);
                let before = search.expansions;
                let path = search.run(space, before + turn);
                let spent = search.expansions - before;
                self.expansions += spent;
                left[side] -= spent;
                match path {
                    // Driven back, it would begin at the start except for rounding.
                    Ok(path) if side == BACKWARD => return Ok(Path { start, ..path.reversed() }),
                    Ok(path) => return Ok(path),
                    Err(SearchFailure::BudgetSpent) if self.expansions < settings.max_expansions => {
                        ending = SearchFailure::BudgetSpent;
                    }
                    // From a disc only some poses were searched, and beyond the fine lattice there is nothing to try.
                    Err(SearchFailure::Exhausted)
                        if lattice == LatticeKind::Fine || (side == BACKWARD && matches!(target, Target::Discs(_))) =>
                    {
                        left[side] = 0;
                    }
                    // All motions of this lattice were tried from one side; the next stage has others.
                    Err(failure) => return Err(failure),
                }
            }
        }
        Err(ending)
    }

    /// Shows the observer where the searches of a stage looked, first those from the start.
    fn show(&self, lattice: LatticeKind, is_two_sided: bool, observer: &mut dyn PlanningObserver) {
        let [forward, backward] = match lattice {
            LatticeKind::Coarse => &self.coarse,
            LatticeKind::Fine => self.fine.as_ref().expect("it was searched"),
        };
        observer.on_edges_examined(SearchPhase::Local, &mut forward.lines());
        if is_two_sided {
            observer.on_edges_examined(SearchPhase::Local, &mut backward.lines());
        }
    }

    /// Asks the flood for one disc after the other, since it has no order by cost.
    fn flood(
        &mut self,
        start: Pose,
        target: Target<'_>,
        observer: &mut dyn PlanningObserver,
    ) -> Result<Path, SearchFailure> {
        let goals: Vec<Goal> = match target {
            Target::Pose(end) => vec![end.into()],
            Target::Discs(discs) => discs.iter().map(|&disc| disc.into()).collect(),
        };
        let found = goals.into_iter().find_map(|goal| {
            // Goals share what is left of the budget, in the order in which they are listed.
            let budget = self.settings.max_expansions - self.expansions;
            let query = FloodQuery { start, goal, budget, lattices: FLOODS };
            // Why one goal failed does not matter here: another may still be reached.
            self.floods.find_within(&query, observer, &mut self.expansions).ok()
        });
        // A later stage always decides how the query ends, so this reason is never reported.
        found.ok_or(SearchFailure::Exhausted)
    }
}

/// A target, and what leads there.
struct LatticeSpace<'a> {
    checker: &'a CollisionChecker,
    heuristic: &'a PoseHeuristic,
    profile: &'a ClearanceProfile,
    target: Target<'a>,
    /// Towards the target.
    walk: &'a mut HolonomicHeuristic,
    /// Of the heuristic.
    weight: f64,
}

impl SearchSpace for LatticeSpace<'_> {
    type Mark = Option<AnalyticExpansion>;
    type Custom = Never;

    /// One step adds a pose with its expansion, or the motions that follow one.
    fn has_room(&mut self, search: &mut SearchOf<Self>) -> bool {
        let bytes = search.bytes_after(1, search.motions.len());
        search.may_hold(bytes)
    }

    fn weight(&self) -> f64 {
        self.weight
    }

    fn estimate(&mut self, node: &mut Node<Self::Mark>) -> Option<f64> {
        // The steering bounds the way from below, and so do the bushes: the greater of both counts.
        let value = self.heuristic.without_bushes(node.pose, node.reverse, self.target);
        let walked =
            self.walk.cost_to_go_m(self.checker.field(), self.target.position_of(node.pose, self.checker.body()));
        (node.cost_to_go, node.mark) = (value.cost_to_go.max(walked), value.expansion);
        value.expansion.map(|expansion| expansion.cost)
    }

    fn analytic_expansion(&self, node: &Node<Self::Mark>) -> AnalyticExpansion {
        node.mark.expect("only expansions that exist are offered")
    }

    fn offer_successors(&mut self, search: &mut SearchOf<Self>, from: Candidate<Never>) {
        search.offer_motions(from.node, self.heuristic.motion_price(), self.weight);
    }

    fn motion_is_free(&self, from: Pose, motion: Segment) -> bool {
        self.profile.motion_is_free(self.checker, from, motion)
    }

    fn take(&mut self, _: &mut SearchOf<Self>, _: Candidate<Never>, never: Never) -> Option<u32> {
        match never {}
    }
}
