//! Queries of a Wumpus's planner, their answers, and the costs of steps.

use glam::DVec2;

use wildfire_grid::astar::StepCosts;

use super::lattice::WalkLattice;

/// A planner's answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    /// Point indices from the start to a point of reach, or to the local minimum at which the walk ends; `None` if the
    /// cell cannot be approached.
    pub path: Option<Vec<usize>>,
    pub expansions: u32,
    /// The local minimum along the walk or at its end.
    pub minimum: Option<usize>,
}

impl Walk {
    /// Creates a walk without a local minimum, or an answer without a path.
    pub fn straight(path: Option<Vec<usize>>, expansions: u32) -> Self {
        Self { path, expansions, minimum: None }
    }

    /// Returns whether the walk ends at a local minimum.
    pub fn is_stuck(&self) -> bool {
        self.minimum.is_some() && self.path.as_ref().and_then(|path| path.last()) == self.minimum.as_ref()
    }
}

/// The start of a walk and its possible ends.
#[derive(Clone, Copy)]
pub struct WalkQuery<'a> {
    pub lattice: &'a WalkLattice,
    pub start: usize,
    /// The points of reach, by index.
    pub goals: &'a [usize],
    /// The centre of the cell that has to be reached.
    pub centre: DVec2,
}

impl WalkQuery<'_> {
    pub fn is_goal(&self, point: usize) -> bool {
        self.goals.binary_search(&point).is_ok()
    }

    /// Returns the positions of every point of a path and of its predecessor; the first comes after itself.
    pub fn lines(&self, path: &[usize]) -> impl Iterator<Item = [DVec2; 2]> {
        let before = path.iter().take(1).chain(path);
        before.zip(path).map(|(&from, &to)| [from, to].map(|point| self.lattice.position(point)))
    }
}

/// The costs of the steps of a walk.
#[derive(Clone, Debug)]
pub struct WalkCosts {
    /// The costs of an orthogonal and of a diagonal step.
    pub steps: (f64, f64),
    /// By point: the factor of its half of a step, at least 1; empty where all places cost the same.
    pub factors: Option<Vec<f64>>,
}

/// A step costs the mean of the factors at its two ends times its own cost, so it costs the same both ways.
impl StepCosts for &WalkCosts {
    fn cost(&self, k: usize, from: usize, to: usize) -> f64 {
        let cost = self.steps.cost(k, from, to);
        match &self.factors {
            None => cost,
            Some(factors) => cost * (0.5 * (factors[from] + factors[to])),
        }
    }

    fn uniform(&self) -> Option<(f64, f64)> {
        self.factors.is_none().then_some(self.steps)
    }
}
