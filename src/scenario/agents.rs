//! The agents: where they start, what they are made of, how they choose and plan.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::or_none;
use crate::collision::CollisionChecker;
use crate::geometry::{Cell, DVec2, FieldFrame, Pose};
use crate::grid::potential::{Attraction, Repulsion, RepulsionDistance};
use crate::planning::memory::MemoryMeter;
use crate::planning::walk::{Estimate, LatticeShape, PotentialSettings, WalkMethod};
use crate::planning::{
    HybridSettings, LatticeSettings, PrimitiveSettings, PrmRsSettings, PrmSettings, SafetySettings, Site, TruckPlanner,
    TruckPlannerKind, TruckPlannerSettings,
};
use crate::rng;
use crate::trajectory::SpeedLimits;
use crate::vehicle::Dimensions;

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
    /// Keep a goal that is no longer intact.
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
                    WumpusHeuristic::Octile => Estimate::Octile,
                    WumpusHeuristic::ParentEuclidean => Estimate::ParentEuclidean,
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
}

/// Chooses the intact cell that a Wumpus goes for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WumpusGoal {
    RandomIntact,
    NearestIntact,
    FarthestFromTruck,
}

/// The planner by which a Wumpus finds its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WumpusPlanner {
    Astar,
    /// Down the exact cost-to-go, from one sweep over all of the lattice for every goal.
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
    /// Factor of half the squared distance that attracts; it only matters without a scale.
    pub zeta: f64,
    /// The greatest attraction on the lattice; `"none"`: as `zeta` makes it.
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub scale: Option<f64>,
    /// The distance within which bushes repel, and the distance from its goal within which none does.
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

/// Says what a Wumpus does in a local minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Escape {
    /// It goes on down the exact cost-to-go.
    Wavefront,
    /// It gives the goal up there.
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
    /// Every step as long as an orthogonal one, diagonals too.
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

/// A fire truck.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Unimog {
    pub start: StartPose,
    pub vehicle: Dimensions,
    pub speed_mps: f64,
    pub reverse_speed_mps: f64,
    pub limits: Limits,
    pub goal: TruckGoal,
    pub retarget: Retarget,
    pub planner: TruckPlannerKind,
    pub prm: PrmSettings,
    pub primitives: PrimitiveSettings,
    pub prm_rs: PrmRsSettings,
    pub hybrid: HybridSettings,
    pub lattice: LatticeSettings,
    pub safety: SafetySettings,
}

impl Default for Unimog {
    fn default() -> Self {
        Self {
            start: StartPose::default(),
            vehicle: Dimensions::default(),
            speed_mps: 8.0,
            reverse_speed_mps: 8.0,
            limits: Limits::default(),
            goal: TruckGoal::NearestBurning,
            retarget: Retarget::Never,
            planner: TruckPlannerKind::PrmRs,
            prm: PrmSettings::default(),
            primitives: PrimitiveSettings::default(),
            prm_rs: PrmRsSettings::default(),
            hybrid: HybridSettings::default(),
            lattice: LatticeSettings::default(),
            safety: SafetySettings::default(),
        }
    }
}

impl Unimog {
    /// Builds its planner for a field as the run of a seed does; it reports to `memory` what it holds as it grows.
    /// `number` is its place among the trucks.
    pub fn build_planner(
        &self,
        checker: &CollisionChecker,
        memory: &MemoryMeter,
        seed: u64,
        number: usize,
    ) -> Box<dyn TruckPlanner> {
        let stream = |name: &str| rng::stream(seed, &format!("truck/{number}/{name}"));
        self.planner.maker().make(&Site { checker, memory, settings: &self.planner_settings(), stream: &stream })
    }

    /// Returns the tables of planners' settings.
    pub fn planner_settings(&self) -> TruckPlannerSettings<'_> {
        TruckPlannerSettings {
            prm: &self.prm,
            primitives: &self.primitives,
            prm_rs: &self.prm_rs,
            hybrid: &self.hybrid,
            lattice: &self.lattice,
            safety: &self.safety,
        }
    }

    /// Returns its limits of speed and of acceleration.
    pub fn speed_limits(&self) -> SpeedLimits {
        SpeedLimits {
            forward_mps: self.speed_mps,
            reverse_mps: self.reverse_speed_mps,
            acceleration_mps2: self.limits.acceleration_mps2,
            braking_mps2: self.limits.braking_mps2,
            lateral_mps2: self.limits.lateral_mps2,
        }
    }

    /// Returns the centre of its body at the start.
    pub fn start_centre(&self) -> DVec2 {
        self.vehicle.body_centre(self.start.pose())
    }
}

/// Pose of the rear axle at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct StartPose {
    pub x_m: f64,
    pub y_m: f64,
    pub heading_deg: f64,
}

impl Default for StartPose {
    fn default() -> Self {
        Self { x_m: 50.0, y_m: 50.0, heading_deg: 0.0 }
    }
}

impl StartPose {
    pub fn pose(&self) -> Pose {
        Pose::new(self.x_m, self.y_m, self.heading_deg.to_radians())
    }
}

/// Limits of acceleration in m/s2; `"none"`: speed changes at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub acceleration_mps2: Option<f64>,
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub braking_mps2: Option<f64>,
    #[serde(with = "or_none")]
    #[schemars(with = "or_none::NumberOrNone")]
    pub lateral_mps2: Option<f64>,
}

/// Chooses the burning cell that a truck goes for. Distances run from its body's centre to the cell's; ties go to the
/// lower cell index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TruckGoal {
    NearestBurning,
    /// The fire that has burned longest.
    Oldest,
    /// The nearest fire of the largest group of burning cells that touch, sides or corners.
    LargestCluster,
}

/// Says when a truck that is driving chooses its goal anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Retarget {
    Never,
    /// Whenever a bush ignites.
    OnEvent,
}
