use crate::geometry::Pose;
use crate::planning::Goal;

/// Share of the wanted clearance that the last searches keep.
const LEAST_SHARE: f64 = 0.04;

/// A search of the ladder.
#[derive(Clone, Copy, Debug)]
pub struct Rung {
    /// Share of the wanted clearance.
    pub share: f64,
    /// From the goal to the start, which only a goal pose allows.
    pub backward: bool,
    pub lattice: LatticeKind,
    /// Nodes that it may expand.
    pub budget: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatticeKind {
    /// The one of the settings.
    Coarse,
    /// The finest of the floods.
    Fine,
}

impl Rung {
    const fn coarse(share: f64, backward: bool, budget: u32) -> Self {
        Self { share, backward, lattice: LatticeKind::Coarse, budget }
    }

    /// From where it searches, and to where.
    pub fn ends(&self, start: Pose, goal: Goal) -> Option<(Pose, Goal)> {
        match goal {
            Goal::Pose(end) if self.backward => Some((end, Goal::Pose(start))),
            Goal::Disc(_) if self.backward => None,
            _ => Some((start, goal)),
        }
    }
}

/// The first that succeeds gives the path.
pub const LADDER: [Rung; 10] = [
    Rung::coarse(1.0, false, 300),
    Rung::coarse(2.0 / 3.0, false, 400),
    Rung::coarse(2.0 / 3.0, true, 400),
    Rung::coarse(1.0 / 3.0, false, 800),
    Rung::coarse(1.0 / 3.0, true, 800),
    Rung::coarse(LEAST_SHARE, false, 1_500),
    Rung::coarse(LEAST_SHARE, true, 1_500),
    Rung::coarse(LEAST_SHARE, false, 10_000),
    Rung::coarse(LEAST_SHARE, true, 10_000),
    Rung { share: LEAST_SHARE, backward: false, lattice: LatticeKind::Fine, budget: 40_000 },
];
