//! Sampling-based planners on the plane of a grid: RRT, RRT* and PRM for a point robot.
//!
//! A cell is a closed square: segments touch no occupied one, not even at its edge or corner, see
//! [`is_free_segment`](crate::segment::is_free_segment). Points are drawn with equal chance over the whole plane, from
//! a stream of their own, so that a seed names the same tree or roadmap everywhere.

mod point_index;
mod prm;
mod rrt;

pub use prm::{PrmSettings, probabilistic_roadmap};
pub use rrt::{RrtSettings, TreeKind, grow_tree};

use rand::{Rng, RngExt};

use crate::parameter::BadParameter;
use crate::segment::{GridPoint, UNITS};
use crate::{CornerCutting, Grid};
use wildfire_base::geometry::ops;

/// The rule for segments: no occupied cell is touched.
const CORNERS: CornerCutting = CornerCutting::Forbidden;

/// The maximum number of samples.
pub const MAX_SAMPLES: u32 = 100_000;

/// The maximum number of neighbours to which a point is joined.
pub const MAX_NEIGHBOURS: u32 = 1000;

/// The result of a query for a path between points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointRoute {
    Found,
    /// The samples were used up.
    NotFound,
    StartOccupied,
}

/// A tree or a roadmap over points, and the path found in it.
#[derive(Clone, Debug, PartialEq)]
pub struct PointGraph {
    /// The points; the start is the first.
    pub points: Vec<GridPoint>,
    /// The pairs of joined points, in the order in which they were joined.
    pub edges: Vec<[u32; 2]>,
    /// The length of the path from the start to each point; infinite where there is none.
    pub costs: Vec<f64>,
    pub answer: PointRoute,
    /// The points from start to goal; empty without a path.
    pub path: Vec<GridPoint>,
    /// The length of the path in cells.
    pub cost: Option<f64>,
    /// The number of samples.
    pub samples: u32,
    /// The paths that RRT* had on the way, each shorter than the one before; looked for at most a hundred times.
    pub earlier: Vec<EarlierPath>,
}

/// A path that a growing tree had before it was done.
#[derive(Clone, Debug, PartialEq)]
pub struct EarlierPath {
    /// The number of edges of the tree then.
    pub edges: usize,
    /// The points from start to goal.
    pub path: Vec<GridPoint>,
}

impl PointGraph {
    /// The answer to a start in an obstacle: nothing was drawn.
    fn from_occupied_start() -> Self {
        Self {
            points: Vec::new(),
            edges: Vec::new(),
            costs: Vec::new(),
            answer: PointRoute::StartOccupied,
            path: Vec::new(),
            cost: None,
            samples: 0,
            earlier: Vec::new(),
        }
    }
}

fn draw_point(occupied: &Grid<bool>, rng: &mut impl Rng) -> GridPoint {
    // The row is drawn before the column: another order would make other trees of the same seeds.
    let row = rng.random_range(0..occupied.rows() as i64 * UNITS);
    GridPoint::from_units(row, rng.random_range(0..occupied.cols() as i64 * UNITS))
}

/// Returns how many nearest neighbours RRT* and PRM* consider among `count` points in the plane: 2e ln n (S. Karaman,
/// E. Frazzoli, "Sampling-based algorithms for optimal motion planning", International Journal of Robotics Research 30(7),
/// 2011, section 3.3.3).
fn neighbours_of_many(count: usize) -> usize {
    ((2.0 * std::f64::consts::E * ops::ln(count as f64)).ceil() as usize).max(1)
}

/// The square of a distance in cells, in units; the whole plane if there is no limit.
fn squared_units(cells: Option<f64>) -> i64 {
    // A cast of a number that is too large ends at the greatest.
    cells.map_or(i64::MAX, |cells| (cells * UNITS as f64 * (cells * UNITS as f64)) as i64)
}

fn check_samples(samples: u32) -> Result<(), BadParameter> {
    let is_good = (1..=MAX_SAMPLES).contains(&samples);
    BadParameter::unless(is_good, "the number of samples", "from 1 to 100000", samples.into())
}

fn check_neighbours(neighbours: Option<u32>) -> Result<(), BadParameter> {
    let found = neighbours.unwrap_or(1);
    let is_good = (1..=MAX_NEIGHBOURS).contains(&found);
    BadParameter::unless(is_good, "the number of neighbours", "from 1 to 1000", found.into())
}

fn check_radius(radius: Option<f64>) -> Result<(), BadParameter> {
    radius.map_or(Ok(()), |radius| BadParameter::unless_positive("the radius", radius))
}
