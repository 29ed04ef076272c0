/// Share of the wanted clearance that the last searches keep.
const LEAST_SHARE: f64 = 0.04;

/// An attempt to find a way that keeps a clearance.
#[derive(Clone, Copy, Debug)]
pub struct Rung {
    /// Share of the wanted clearance.
    pub share: f64,
    pub method: Method,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Searches from the start and from the goal in turn, each of which may expand so many nodes.
    Searches { lattice: LatticeKind, forward: u32, backward: u32 },
    /// The coarsest flood from the start.
    Flood,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatticeKind {
    /// The one of the settings.
    Coarse,
    /// The finest of the floods.
    Fine,
}

impl Rung {
    const fn searches(share: f64, lattice: LatticeKind, forward: u32, backward: u32) -> Self {
        Self { share, method: Method::Searches { lattice, forward, backward } }
    }
}

/// The first that succeeds gives the path.
///
/// Long detours are cheaper for the flood than for a search, because it looks at every bin once; tight ends need the
/// short motions of the fine lattice.
pub const LADDER: [Rung; 6] = [
    Rung::searches(1.0, LatticeKind::Coarse, 250, 0),
    Rung::searches(2.0 / 3.0, LatticeKind::Coarse, 150, 150),
    Rung::searches(1.0 / 3.0, LatticeKind::Coarse, 250, 250),
    Rung::searches(LEAST_SHARE, LatticeKind::Coarse, 5_000, 5_000),
    Rung { share: LEAST_SHARE, method: Method::Flood },
    Rung::searches(LEAST_SHARE, LatticeKind::Fine, 20_000, 20_000),
];

/// Searches from both ends take turns of so many expansions.
pub const TURN: u32 = 100;
