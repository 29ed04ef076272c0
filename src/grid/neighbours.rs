//! Which cells are neighbours, and in which order they are asked.

/// With how many neighbours a cell is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Connectivity {
    /// Those that share a side.
    Four,
    /// Those that share a side or a corner.
    Eight,
}

/// Whether a diagonal step may pass an occupied cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerCutting {
    /// A diagonal step asks of its two ends only that they are free.
    Allowed,
    /// A diagonal step needs both cells beside it free too.
    Forbidden,
}

/// Which of several equally good neighbours comes first. Row 0 is the north edge in these names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieOrder {
    /// S N E W SE SW NE NW (Daudt, "Autonomous Robotics Lab 1: Brushfire and Wavefront", appendix B).
    CrossFirst,
    /// W N E S NW NE SE SW (Akram and López Musito, "Autonomous Systems, Lab 2", 2024, section 3.3).
    WestFirst,
}

impl Connectivity {
    /// Number of neighbours of a cell inside the grid.
    pub fn count(self) -> usize {
        match self {
            Self::Four => 4,
            Self::Eight => 8,
        }
    }
}

impl TieOrder {
    /// The steps to the neighbours in this order, orthogonal ones first.
    pub fn steps(self, connectivity: Connectivity) -> &'static [(isize, isize)] {
        const CROSS_FIRST: [(isize, isize); 8] = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];
        const WEST_FIRST: [(isize, isize); 8] = [(0, -1), (-1, 0), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, 1), (1, -1)];
        let all = match self {
            Self::CrossFirst => &CROSS_FIRST,
            Self::WestFirst => &WEST_FIRST,
        };
        &all[..connectivity.count()]
    }
}
