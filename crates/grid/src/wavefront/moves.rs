//! The three rules for steps, for sets of cells inside a tile and for steps across a side into the next tile.
//!
//! Beside a side, cells are known by their steps to the goal: [`WALL`] if occupied, [`FAR`] if none are known yet.

use crate::wavefront::cells::{SIDE, TileSet};

/// The steps at an occupied cell. It is below all others, so nothing seems to improve it.
pub const WALL: i32 = -1;
/// The steps at a free cell that no wave has reached. It leaves room for sums, and a map has fewer cells.
pub const FAR: i32 = i32::MAX / 2;

/// Returns `FAR` or more if the condition holds, otherwise the steps unchanged.
#[inline(always)]
pub fn far_if(condition: bool, steps: i32) -> i32 {
    // All bits of FAR but the sign's neighbour are set. A choice would become a branch that nobody can predict.
    steps | (-i32::from(condition) & FAR)
}

/// The steps at the cells along a side.
pub type SideSteps = [i32; SIDE];

pub trait Moves {
    /// The cells one step away from `front`, some of them perhaps not free.
    fn grow(front: TileSet, free: TileSet) -> TileSet;

    /// The steps with which paths over the cells of `from` arrive on those of `to`, the line beside it.
    fn arrivals(from: &SideSteps, to: &SideSteps) -> SideSteps;

    /// The steps with which a diagonal step arrives from a cell, past the two cells `beside`.
    fn diagonal_arrival(from: i32, beside: [i32; 2]) -> i32;
}

/// Steps over sides.
pub struct Straight;

/// Steps over sides and corners.
pub struct AnyDiagonal;

/// Steps over sides, and over corners between two free cells.
pub struct OpenDiagonal;

impl Moves for Straight {
    #[inline(always)]
    fn grow(front: TileSet, free: TileSet) -> TileSet {
        // A front is free anyway. Without this the compiler moves every word of it out of the vector registers.
        let front = front & free;
        front.north() | front.south() | front.west() | front.east()
    }

    #[inline(always)]
    fn arrivals(from: &SideSteps, _to: &SideSteps) -> SideSteps {
        std::array::from_fn(|i| leave(from[i]))
    }

    fn diagonal_arrival(_from: i32, _beside: [i32; 2]) -> i32 {
        FAR
    }
}

impl Moves for AnyDiagonal {
    #[inline(always)]
    fn grow(front: TileSet, _free: TileSet) -> TileSet {
        let row = front | front.west() | front.east();
        row | row.north() | row.south()
    }

    #[inline(always)]
    fn arrivals(from: &SideSteps, _to: &SideSteps) -> SideSteps {
        let leaving = padded(&std::array::from_fn(|i| leave(from[i])));
        std::array::from_fn(|i| leaving[i].min(leaving[i + 1]).min(leaving[i + 2]))
    }

    fn diagonal_arrival(from: i32, _beside: [i32; 2]) -> i32 {
        leave(from)
    }
}

impl Moves for OpenDiagonal {
    #[inline(always)]
    fn grow(front: TileSet, free: TileSet) -> TileSet {
        let [north, south] = [front.north() & free, front.south() & free];
        let [west, east] = [front.west() & free, front.east() & free];
        let over_west = (north.west() & west.north()) | (south.west() & west.south());
        let over_east = (north.east() & east.north()) | (south.east() & east.south());
        north | south | west | east | over_west | over_east
    }

    #[inline(always)]
    fn arrivals(from: &SideSteps, to: &SideSteps) -> SideSteps {
        let (from, to) = (padded(from), padded(to));
        std::array::from_fn(|i| {
            let before = Self::diagonal_arrival(from[i], [from[i + 1], to[i]]);
            let behind = Self::diagonal_arrival(from[i + 2], [from[i + 1], to[i + 2]]);
            leave(from[i + 1]).min(before).min(behind)
        })
    }

    fn diagonal_arrival(from: i32, beside: [i32; 2]) -> i32 {
        far_if((beside[0] == WALL) | (beside[1] == WALL), leave(from))
    }
}

fn leave(from: i32) -> i32 {
    far_if(from == WALL, from + 1)
}

/// A line between two more cells, from which nothing arrives.
fn padded(line: &SideSteps) -> [i32; SIDE + 2] {
    let mut padded = [FAR; SIDE + 2];
    padded[1..=SIDE].copy_from_slice(line);
    padded
}
