//! Wumpuses in a scenario: their settings, ranges, description, warnings and memory.

use std::iter;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::agents::{
    AgentList, AgentsMemory, BlockedStarts, FieldMeasures, SHOWN_ALIKE, SHOWN_SEED, ScenarioField, SketchedStart,
};
use super::goal::WumpusGoal;
use crate::faults::check::{Check, TablePath};
use crate::{MemoryPart, Scenario, Terrain};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_base::or_none;
use wildfire_base::ranges;
use wildfire_base::ranges::number_text;
use wildfire_grid::potential::{Attraction, Repulsion, RepulsionDistance};
use wildfire_planning::kit::safety::{SafetyMap, SafetySettings};
use wildfire_planning::walk::{CostToGoEstimate, LatticeShape, PotentialSettings, WalkLattice, WalkMethod};

/// The most points of a Wumpus's lattice: their numbers have to fit into 32 bits. Memory allows far fewer.
const MAX_LATTICE_POINTS: f64 = 4e9;

/// The most goals that Wumpuses may try without success: all bushes from every point that they have time to reach. A try takes
/// about 250 bytes of the timeline; runs stay far below the bound, because a Wumpus on which all goals fail stays where
/// it is.
const MAX_TRIES: f64 = 2.5e7;

/// The most points of all lattices on which is looked for what can be lit, and for free places: a fifth of a second.
const MAX_POINTS_EXAMINED: f64 = 5e6;

/// The memory that a Wumpus takes alone: its walk as it is computed and taken, of up to 20,000 points, which a walk across
/// the largest field has, and its small things.
const BYTES_OF_A_WUMPUS: u64 = 500_000;

/// The most pairs of a bush and a place near it that the search for the nearest place looks at.
const MAX_LOOKS: f64 = 1e7;

/// An arsonist on a lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Wumpus {
    /// x, y of its centre.
    pub start_m: [f64; 2],
    /// Side of its square body.
    pub size_m: f64,
    pub speed_mps: f64,
    /// From a lattice point to the centre of the cell that it lights, inclusive.
    pub reach_m: f64,
    pub goal: WumpusGoal,
    /// Whether a Wumpus keeps a goal that is no longer intact.
    pub keep_goal: bool,
    /// Spacing of its lattice, anchored at its start; `"none"`: the cell centres.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub lattice_m: Option<f64>,
    pub planner: WumpusPlanner,
    pub step_cost: StepCost,
    pub step_time: StepTime,
    pub heuristic: WumpusHeuristic,
    /// 1 finds shortest paths; more is greedier.
    pub heuristic_weight: f64,
    /// Simulated planning time charged, during which it stands still.
    pub seconds_per_expansion: f64,
    pub potential: WumpusPotential,
    pub safety: SafetySettings,
}

impl Default for Wumpus {
    fn default() -> Self {
        Self {
            start_m: [202.5, 202.5],
            size_m: 3.0,
            speed_mps: 2.0,
            reach_m: 6.25,
            goal: WumpusGoal::RandomIntact,
            keep_goal: false,
            lattice_m: None,
            planner: WumpusPlanner::Astar,
            step_cost: StepCost::Metres,
            step_time: StepTime::Distance,
            heuristic: WumpusHeuristic::Octile,
            heuristic_weight: 1.0,
            seconds_per_expansion: 0.0,
            potential: WumpusPotential::default(),
            safety: SafetySettings::default(),
        }
    }
}

impl Wumpus {
    /// Returns the centre of its body at the start.
    pub fn start_centre(&self) -> DVec2 {
        DVec2::from(self.start_m)
    }

    /// Returns the lattice that it walks on.
    pub fn lattice_shape(&self, frame: &FieldFrame) -> LatticeShape {
        let (anchor, step_m) = match self.lattice_m {
            Some(step_m) => (self.start_centre(), step_m),
            None => (frame.centre(Cell::default()), frame.cell_m),
        };
        LatticeShape { anchor, step_m, size_m: self.size_m }
    }

    /// Returns the method by which its planner finds walks.
    pub fn walk_method(&self) -> WalkMethod {
        match self.planner {
            WumpusPlanner::Astar => WalkMethod::Astar {
                estimate: match self.heuristic {
                    WumpusHeuristic::Octile => CostToGoEstimate::Octile,
                    WumpusHeuristic::ParentEuclidean => CostToGoEstimate::ParentEuclidean,
                },
                weight: self.heuristic_weight,
            },
            WumpusPlanner::Wavefront => WalkMethod::Wavefront,
            WumpusPlanner::Potential => {
                let potential = &self.potential;
                WalkMethod::Potential(PotentialSettings {
                    attraction: Attraction::Squared { zeta: potential.zeta },
                    scale: potential.scale,
                    repulsion: Repulsion { q: potential.q, eta: potential.eta, distance: RepulsionDistance::Brushfire },
                    escapes: potential.escape == Escape::Wavefront,
                })
            }
        }
    }

    /// Says whether it gives a goal up in a local minimum, and may so try many goals without success.
    fn gives_up_in_minima(&self) -> bool {
        self.planner == WumpusPlanner::Potential && self.potential.escape == Escape::None
    }

    /// Returns the parts of the ground on which it walks, which Wumpuses share whose parts are equal.
    fn ground(&self, frame: &FieldFrame) -> WalkGround {
        WalkGround {
            shape: self.lattice_shape(frame),
            method: self.walk_method(),
            step_cost: self.step_cost,
            safety: self.safety.clone(),
            reach_m: self.reach_m,
        }
    }

    /// Bounds the memory that it alone takes in a run of this length.
    fn bytes_without_ground(&self, field: &FieldMeasures, duration_s: f64) -> u64 {
        if !self.gives_up_in_minima() {
            return BYTES_OF_A_WUMPUS;
        }
        let shape = self.lattice_shape(&field.frame);
        // Goals that it failed on, by the point it tried from: entries of a tree whose nodes may be half empty.
        let places =
            WalkLattice::point_count(&field.frame, &shape).min(duration_s * self.speed_mps / shape.step_m + 1.0);
        let failed = field.bushes as f64 * places * 3.0 * size_of::<(usize, Cell)>() as f64;
        BYTES_OF_A_WUMPUS + failed as u64
    }
}

/// What Wumpuses of equal bodies and rules share.
struct WalkGround {
    shape: LatticeShape,
    method: WalkMethod,
    step_cost: StepCost,
    safety: SafetySettings,
    reach_m: f64,
}

impl WalkGround {
    fn has_lattice_of(&self, other: &Self) -> bool {
        self.shape == other.shape
    }

    fn has_planner_of(&self, other: &Self) -> bool {
        let has_same_rules = self.method == other.method && self.step_cost == other.step_cost;
        self.has_lattice_of(other) && has_same_rules && self.safety == other.safety
    }

    fn has_targets_of(&self, other: &Self) -> bool {
        self.has_lattice_of(other) && self.reach_m == other.reach_m
    }
}

/// The Wumpus's path planner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WumpusPlanner {
    Astar,
    /// Down the exact cost-to-go, from one sweep over the whole lattice for each goal.
    Wavefront,
    /// Down the gradient of a potential field, into local minima too.
    Potential,
}

/// The potential field of a Wumpus whose planner is `potential`; distances are lattice steps.
///
/// Numbers have the defaults of `wildfire map total`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WumpusPotential {
    /// Factor of the attraction, half the squared distance; matters only without a scale.
    pub zeta: f64,
    /// The greatest attraction on the lattice; `"none"`: as `zeta` makes it.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub scale: Option<f64>,
    /// The distance within which bushes repel, and the distance from the goal within which no bush repels.
    pub q: f64,
    /// Strength of repulsion.
    pub eta: f64,
    pub escape: Escape,
}

impl Default for WumpusPotential {
    fn default() -> Self {
        Self { zeta: 1.0, scale: Some(10.0), q: 5.0, eta: 15.0, escape: Escape::Wavefront }
    }
}

/// Selects what a Wumpus does in a local minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Escape {
    /// It continues down the exact cost-to-go.
    Wavefront,
    /// It gives up the goal.
    None,
}

/// The cost of a lattice step in the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StepCost {
    Metres,
    /// Every step 1, diagonals too.
    Moves,
}

/// The time that a lattice step takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StepTime {
    /// Its length at the Wumpus's speed.
    Distance,
    /// Every step as long as an orthogonal step, diagonals too.
    Uniform,
}

/// The estimate of the cost-to-go in the Wumpus's search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WumpusHeuristic {
    /// Length of the shortest lattice path on an empty field; admissible.
    Octile,
    /// Straight line from the node's parent, in metres whatever a step costs, as the original program has it.
    ParentEuclidean,
}

impl AgentList for Vec<Wumpus> {
    fn key(&self) -> &'static str {
        "wumpus"
    }

    fn title(&self) -> &'static str {
        "Wumpuses"
    }

    fn len(&self) -> usize {
        self.len()
    }

    fn starts(&self) -> Vec<SketchedStart> {
        self.iter()
            .map(|wumpus| {
                let centre = wumpus.start_centre();
                SketchedStart { centre, place: centre, letter: 'W' }
            })
            .collect()
    }

    fn check(&self, scenario: &Scenario) -> Check {
        let frame = scenario.field.frame();
        // A piece is a tetromino, which has four cells.
        let bushes = 4.0 * f64::from(scenario.field.wanted_pieces());
        let mut tries = 0.0;
        for (number, wumpus) in self.iter().enumerate() {
            let table = TablePath::entry(self.key(), number);
            check_wumpus(&table, wumpus, &frame)?;
            wumpus.goal.check(&table, "goal", &scenario.policy)?;
            let pitch_m = wumpus.lattice_m.unwrap_or(frame.cell_m);
            // There is at least one point a side, as a pitch may be wider than the field.
            let point_count = (frame.width_m() / pitch_m).max(1.0) * (frame.height_m() / pitch_m).max(1.0);
            if point_count > MAX_LATTICE_POINTS {
                let expected = format!(
                    "a lattice of at most {MAX_LATTICE_POINTS:e} points; on this field it would have {point_count:.2e}"
                );
                return table.refuse("lattice_m", number_text(pitch_m), expected);
            }
            if wumpus.gives_up_in_minima() {
                // A Wumpus tries at each point that it comes to, and comes to no more than its speed allows.
                tries += bushes * point_count.min(scenario.duration_s * wumpus.speed_mps / pitch_m);
            }
            if tries > MAX_TRIES {
                let expected =
                    format!("\"wavefront\" if bushes times the steps of a run exceed {MAX_TRIES:e}, over all Wumpuses");
                return table.inner("potential").refuse("escape", "\"none\"".into(), expected);
            }
        }
        Ok(())
    }

    fn unused(&self, _: &Scenario, number: usize) -> Vec<&'static str> {
        let mut unused = match self[number].planner {
            WumpusPlanner::Astar => vec!["potential"],
            WumpusPlanner::Wavefront => vec!["potential", "heuristic", "heuristic_weight"],
            WumpusPlanner::Potential => vec!["heuristic", "heuristic_weight"],
        };
        unused.extend((self[number].safety.map == SafetyMap::None).then_some("safety"));
        unused
    }

    fn facts(&self, _: usize) -> Vec<String> {
        Vec::new()
    }

    fn warn(&self, _: &Scenario, found: &mut Vec<String>) {
        for (number, wumpus) in self.iter().enumerate() {
            let is_like = |other: &Wumpus| Wumpus { start_m: wumpus.start_m, ..other.clone() } == *wumpus;
            if self[..number].iter().filter(|other| is_like(other)).count() < SHOWN_ALIKE {
                warn_of_wumpus(number, wumpus, found);
            }
        }
    }

    fn blocked_starts(&self, field: &ScenarioField<'_>) -> BlockedStarts {
        let terrain = field.terrain;
        let has_place = |wumpus: &Wumpus, shape: LatticeShape| {
            // A larger lattice takes longer to look through than a check may; the run then finds out.
            let is_large = WalkLattice::point_count(&terrain.frame, &shape) > MAX_POINTS_EXAMINED;
            is_large || {
                let lattice = WalkLattice::new(terrain.frame, &terrain.occupied, shape);
                lattice.nearest_free(wumpus.start_centre()).is_some()
            }
        };
        let is_blocked = |wumpus: &Wumpus| !square_is_free(terrain, wumpus.start_centre(), wumpus.size_m);
        let mut starts = BlockedStarts::default();
        let mut with_places: Vec<LatticeShape> = Vec::new();
        for (number, wumpus) in self.iter().enumerate().filter(|(_, wumpus)| is_blocked(wumpus)) {
            let shape = wumpus.lattice_shape(&terrain.frame);
            // Only a few shapes occur, and whether a lattice has a free point does not depend on the Wumpus.
            if !with_places.contains(&shape) {
                if !has_place(wumpus, shape) {
                    starts.without_place = Some(format!("Wumpus {number}"));
                    // One Wumpus without a place is enough to refuse every run.
                    break;
                }
                with_places.push(shape);
            }
            starts.moved.push(format!("Wumpus {number}"));
        }
        starts
    }

    fn warn_of_field(&self, field: &ScenarioField<'_>, found: &mut Vec<String>) {
        warn_of_idle_wumpuses(self, field.terrain, found);
    }

    fn memory(&self, field: &FieldMeasures, duration_s: f64) -> AgentsMemory {
        let grounds: Vec<WalkGround> = self.iter().map(|wumpus| wumpus.ground(&field.frame)).collect();
        // Wumpuses of one shape share lattices and planners in a run, so only the first of each counts.
        let is_first = |number: usize, is_shared: fn(&WalkGround, &WalkGround) -> bool| {
            !grounds[..number].iter().any(|before| is_shared(&grounds[number], before))
        };
        let mut shared = [0, 0, 0];
        for (number, ground) in grounds.iter().enumerate() {
            let bytes = field.walk(WalkLattice::point_count(&field.frame, &ground.shape) as u64);
            let sharing = [WalkGround::has_lattice_of, WalkGround::has_planner_of, WalkGround::has_targets_of];
            for ((sum, bytes), is_shared) in shared.iter_mut().zip(bytes).zip(sharing) {
                *sum += if is_first(number, is_shared) { bytes } else { 0 };
            }
        }
        let agents = self.iter().map(|wumpus| wumpus.bytes_without_ground(field, duration_s)).sum();
        let [lattices, planners, targets] = shared;
        let parts = [
            ("the lattices of Wumpuses", lattices),
            ("the planners of Wumpuses", planners),
            ("what Wumpuses can light", targets),
            ("the Wumpuses", agents),
        ];
        let parts = parts.map(|(name, bytes)| MemoryPart::new(name, bytes)).to_vec();
        AgentsMemory { parts, ..AgentsMemory::default() }
    }
}

fn check_wumpus(table: &TablePath, wumpus: &Wumpus, frame: &FieldFrame) -> Check {
    let centre = wumpus.start_centre();
    let corners = [(1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| centre + 0.5 * wumpus.size_m * DVec2::new(x, y));
    table.inside("start_m", &corners, frame)
}

ranges! { WumpusPotential { zeta: 0.0..=1e6, scale: 0.0..=1e6, q: 0.1..=1000.0, eta: 0.0..=1e6 } }

ranges! { Wumpus {
    size_m: 0.01..=100.0, speed_mps: 0.001..=1000.0, reach_m: 0.0..=1e6, lattice_m: 0.01..=1000.0,
    heuristic_weight: 0.0..=1000.0, seconds_per_expansion: 0.0..=1e6;
    potential, safety
} }

/// Warns of settings of planners that the Wumpus does not use.
fn warn_of_wumpus(number: usize, wumpus: &Wumpus, found: &mut Vec<String>) {
    let usual = Wumpus::default();
    let heuristic = (wumpus.heuristic, wumpus.heuristic_weight) != (usual.heuristic, usual.heuristic_weight);
    if heuristic && wumpus.planner != WumpusPlanner::Astar {
        found.push(format!(
            "The `heuristic` and `heuristic_weight` of Wumpus {number} have no effect: only the planner \"astar\" \
             uses them."
        ));
    }
    let goes_by_cost = wumpus.planner != WumpusPlanner::Potential || wumpus.potential.escape == Escape::Wavefront;
    if wumpus.safety.map != SafetyMap::None && !goes_by_cost {
        found.push(format!(
            "The `safety` of Wumpus {number} has no effect: descent on a potential field uses costs only in its escape."
        ));
    }
    if wumpus.potential != WumpusPotential::default() && wumpus.planner != WumpusPlanner::Potential {
        found.push(format!(
            "The `potential` of Wumpus {number} has no effect: only the planner \"potential\" uses \
            it."
        ));
    }
}

/// Warns of Wumpuses that can come nowhere within reach of a bush's centre.
fn warn_of_idle_wumpuses(wumpuses: &[Wumpus], terrain: &Terrain, found: &mut Vec<String>) {
    let mut points = 0.0;
    let mut last: Option<(LatticeShape, WalkLattice)> = None;
    for (number, wumpus) in wumpuses.iter().enumerate() {
        let shape = wumpus.lattice_shape(&terrain.frame);
        // Copies of an entry follow one another and share the lattice of the one before.
        if last.as_ref().is_none_or(|(last_shape, _)| *last_shape != shape) {
            points += WalkLattice::point_count(&terrain.frame, &shape);
            // The budget is for all Wumpuses together; those that are left are not warned of.
            if points > MAX_POINTS_EXAMINED {
                return;
            }
            last = Some((shape, WalkLattice::new(terrain.frame, &terrain.occupied, shape)));
        }
        let Some((_, lattice)) = &last else { continue };
        let Some(start) = lattice.nearest_free(wumpus.start_centre()) else { continue };
        // Most often a bush is near, and nobody has to know all that can be reached.
        let bushes = &terrain.bushes;
        if bushes.iter().any(|&cell| lattice.points_of_reach(cell, wumpus.reach_m).any(|point| point == start)) {
            continue;
        }
        let reached = lattice.reachable_from(start);
        let stands = |cell, reach_m| lattice.points_of_reach(cell, reach_m).filter(|&point| reached[point]);
        if bushes.is_empty() || bushes.iter().any(|&cell| stands(cell, wumpus.reach_m).next().is_some()) {
            continue;
        }
        // Farther and farther away, as long as that is quick: most often the nearest place is a cell or two away.
        let is_quick = |within_m: &f64| {
            let across = 2.0 * within_m / lattice.step_m() + 1.0;
            bushes.len() as f64 * across * across <= MAX_LOOKS
        };
        let farther = iter::successors(Some(terrain.frame.cell_m), |metres| Some(2.0 * metres));
        let min_m = farther.take_while(is_quick).find_map(|within_m| {
            let metres = |cell| {
                let centre = lattice.centre(cell);
                stands(cell, within_m).map(|point| lattice.position(point).distance(centre)).reduce(f64::min)
            };
            bushes.iter().filter_map(|&cell| metres(cell)).reduce(f64::min)
        });
        found.push(format!(
            "On the field of seed {SHOWN_SEED} Wumpus {number} can light none of the {} bushes: no bush's centre is \
             within `reach_m`, {} m, of a place that it can reach{}.",
            bushes.len(),
            wumpus.reach_m,
            min_m.map_or(String::new(), |min_m| format!("; the nearest is {min_m:.3} m away"))
        ));
    }
}

fn square_is_free(terrain: &Terrain, centre: DVec2, size_m: f64) -> bool {
    let touching = 0.5 * (size_m + terrain.frame.cell_m);
    terrain.bushes.iter().all(|&bush| (terrain.frame.centre(bush) - centre).abs().max_element() >= touching)
}
