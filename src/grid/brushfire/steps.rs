//! Counts of steps to the nearest obstacle, in the widths that vectors of them come in.

/// How many steps it is to an obstacle, or that none is known.
pub trait Steps: Copy + Ord {
    const ZERO: Self;
    /// More than any count.
    const UNKNOWN: Self;

    /// So many steps more; [`UNKNOWN`](Self::UNKNOWN) if that is too many.
    fn plus(self, steps: u8) -> Self;

    fn from_count(count: u16) -> Self;

    fn count(self) -> u16;
}

impl Steps for u8 {
    const ZERO: Self = 0;
    const UNKNOWN: Self = Self::MAX;

    fn plus(self, steps: u8) -> Self {
        self.saturating_add(steps)
    }

    fn from_count(count: u16) -> Self {
        count.min(Self::MAX.into()) as Self
    }

    fn count(self) -> u16 {
        self.into()
    }
}

/// Counted from the lowest number upwards, since the vectors of every x86-64 know the minimum of signed words only.
impl Steps for i16 {
    const ZERO: Self = Self::MIN;
    const UNKNOWN: Self = Self::MAX;

    fn plus(self, steps: u8) -> Self {
        self.saturating_add(steps.into())
    }

    fn from_count(count: u16) -> Self {
        count.wrapping_add_signed(Self::MIN) as Self
    }

    fn count(self) -> u16 {
        (self as u16).wrapping_add_signed(Self::MIN)
    }
}
