//! The directions in which fire is followed from cell to cell, refined until no fire is too narrow for them.
//!
//! The time of a fire along a vector is a norm F with drift, whose unit ball is the ellipse. The first fire from between
//! two neighbours in direction, u and v, is found right only where they are *acute* for F: grad F(u) . v >= 0 and
//! grad F(v) . u >= 0. 32 directions are, for every heading, up to fires three times as long as wide; near the axis of
//! narrower ones they are not, and what is between them comes too late, however small the cells are. There u + v is put
//! between u and v until all pairs are acute. Directions are vectors of the integer lattice, and two neighbours span no
//! other point of it, so that this is a walk down the Stern-Brocot tree; a fire that is n times as long as wide needs
//! directions of about n cells.
//!
//! Source: Mirebeau, "Efficient fast marching with Finsler metrics", Numerische Mathematik 126, 2014, sections 1 and 3.

use super::rules::Neighbours;
use crate::surface::Ellipse;
use wildfire_base::geometry::DVec2;

/// The farthest direction, in columns or rows: enough for fires nine times as long as wide.
const MAX_REACH: i32 = 12;

/// Radius in cells of exact times round an ignition; where directions are refined, in multiples of their reach.
const EXACT_REACH: i32 = 3;
const NARROW_EXACT_REACHES: i32 = 4;

/// Least acuteness of pairs where directions are refined; 0 would do, and leaves narrow heads late by up to 1.2 %.
const REFINED_ACUTENESS: f64 = 0.25;

/// Cells whose ellipses directions suit, at most, where every cell has its own.
const MAX_SAMPLES: usize = 1024;

/// Directions as column and row offsets without a common divisor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DirectionSet {
    /// Counter-clockwise from east; two neighbours have determinant 1.
    steps: Vec<(i32, i32)>,
    /// Neighbours between which there are others now.
    refined: Vec<[(i32, i32); 2]>,
}

impl DirectionSet {
    /// Creates the directions to some neighbours, with those between them that make all pairs acute for all ellipses.
    pub fn new(neighbours: Neighbours, ellipses: &[Ellipse]) -> Self {
        let reach = neighbours.reach();
        let offsets = (-reach..=reach).flat_map(|row| (-reach..=reach).map(move |col| (col, row)));
        let mut coarse: Vec<_> = offsets.filter(|&(col, row)| divisor(col.abs(), row.abs()) == 1).collect();
        // By half of the circle, then by the cross product: no angles, no ties.
        let half = |(col, row): (i32, i32)| row < 0 || (row == 0 && col < 0);
        coarse.sort_unstable_by(|&a, &b| half(a).cmp(&half(b)).then_with(|| 0.cmp(&(a.0 * b.1 - a.1 * b.0))));
        let mut steps = Vec::with_capacity(coarse.len());
        let mut refined = Vec::new();
        for (place, &first) in coarse.iter().enumerate() {
            let last = coarse[(place + 1) % coarse.len()];
            let mut from = first;
            // Depth first, with the pending ends on a stack, so that steps come out in order of direction.
            let mut pending = vec![last];
            // Only pairs that fail are refined, and then beyond bare acuteness.
            let needed = if min_acuteness(ellipses, first, last) < 0.0 { REFINED_ACUTENESS } else { 0.0 };
            while let Some(&to) = pending.last() {
                // The mediant: of all steps between two neighbours it is the shortest.
                let between = (from.0 + to.0, from.1 + to.1);
                let is_in_reach = between.0.abs().max(between.1.abs()) <= MAX_REACH;
                if is_in_reach && min_acuteness(ellipses, from, to) < needed {
                    pending.push(between);
                } else {
                    steps.push(from);
                    from = to;
                    pending.pop();
                }
            }
            // Without a step between them `first` is the last that was pushed.
            if steps.last() != Some(&first) {
                refined.push([first, last]);
            }
        }
        Self { steps, refined }
    }

    pub fn steps(&self) -> &[(i32, i32)] {
        &self.steps
    }

    /// Returns the farthest direction, in columns or rows.
    pub fn reach(&self) -> i32 {
        self.steps.iter().map(|&(cols, rows)| cols.abs().max(rows.abs())).max().unwrap_or(0)
    }

    /// Returns the offsets of the cells round an ignition whose times are exact: a front is far from straight there, and
    /// a narrow one ahead of it is for longer.
    pub fn exact_offsets(&self) -> Vec<(i32, i32)> {
        let reach = self.exact_reach();
        let offsets = (-reach..=reach).flat_map(|row| (-reach..=reach).map(move |col| (col, row)));
        let cross = |one: (i32, i32), other: (i32, i32)| one.0 * other.1 - one.1 * other.0;
        offsets
            .filter(|&offset: &(i32, i32)| {
                let square = offset.0 * offset.0 + offset.1 * offset.1;
                (1..=EXACT_REACH * EXACT_REACH).contains(&square)
                    || (square <= reach * reach
                        && self.refined.iter().any(|&[from, to]| cross(from, offset) >= 0 && cross(offset, to) >= 0))
            })
            .collect()
    }

    /// Returns the farthest of those, in columns or rows at most.
    pub fn exact_reach(&self) -> i32 {
        if self.refined.is_empty() { EXACT_REACH } else { NARROW_EXACT_REACHES * self.reach() }
    }
}

fn min_acuteness(ellipses: &[Ellipse], first: (i32, i32), second: (i32, i32)) -> f64 {
    let [first, second] = [first, second].map(|(cols, rows)| DVec2::new(f64::from(cols), f64::from(rows)));
    let burning = ellipses.iter().filter(|ellipse| ellipse.burns());
    burning.map(|ellipse| ellipse.acuteness(first, second)).fold(1.0, f64::min)
}

fn divisor(a: i32, b: i32) -> i32 {
    if b == 0 { a } else { divisor(b, a % b) }
}

/// Returns indices of cells spread evenly over a field whose cells have ellipses of their own: all cells of a small one.
pub fn sampled_cells(cell_count: usize) -> impl Iterator<Item = usize> {
    // Multiples of the golden ratio modulo 1 fall on no column or row more often than on others.
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    let spread = move |number: u64| ((u128::from(number.wrapping_mul(GOLDEN)) * cell_count as u128) >> 64) as usize;
    let is_small = cell_count <= MAX_SAMPLES;
    (0..cell_count.min(MAX_SAMPLES)).map(move |number| if is_small { number } else { spread(number as u64) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::geometry::{DVec3, compass};

    /// An ellipse of the shape `length_to_width` with its head to an azimuth.
    fn ellipse(length_to_width: f64, azimuth: f64) -> Ellipse {
        let eccentricity = (1.0 - 1.0 / (length_to_width * length_to_width)).sqrt();
        let heading: DVec3 = compass::unit_toward(azimuth).extend(0.0);
        Ellipse::new(1.0, eccentricity, heading, DVec2::ZERO)
    }

    fn all_azimuths(length_to_width: f64) -> impl Iterator<Item = Ellipse> {
        (0..360).map(move |azimuth| ellipse(length_to_width, f64::from(azimuth)))
    }

    #[test]
    fn thirty_two_directions_suit_fires_three_times_as_long_as_wide() {
        let coarse = DirectionSet::new(Neighbours::ThirtyTwo, &[]);
        assert_eq!((coarse.steps().len(), coarse.reach(), coarse.exact_reach()), (32, 3, 3));
        for narrow in all_azimuths(3.0) {
            assert_eq!(DirectionSet::new(Neighbours::ThirtyTwo, &[narrow]), coarse);
        }
    }

    /// The counts were found by a separate program.
    #[test]
    fn narrow_fires_need_few_more_directions() {
        for (length_to_width, neighbours, count, reach) in [
            (3.4, Neighbours::ThirtyTwo, 34, 4),
            (5.0, Neighbours::ThirtyTwo, 38, 6),
            (8.0, Neighbours::ThirtyTwo, 46, 10),
            (2.0, Neighbours::Eight, 12, 3),
            (8.0, Neighbours::Eight, 27, 10),
        ] {
            let sets: Vec<_> =
                all_azimuths(length_to_width).map(|narrow| DirectionSet::new(neighbours, &[narrow])).collect();
            assert_eq!(sets.iter().map(|set| set.steps().len()).max(), Some(count));
            assert_eq!(sets.iter().map(DirectionSet::reach).max(), Some(reach));
        }
    }

    #[test]
    fn neighbours_are_acute_and_span_no_other_cell() {
        for neighbours in [Neighbours::Eight, Neighbours::Sixteen, Neighbours::ThirtyTwo] {
            for narrow in all_azimuths(7.0) {
                let set = DirectionSet::new(neighbours, &[narrow]);
                let steps = set.steps();
                for (place, &one) in steps.iter().enumerate() {
                    let other = steps[(place + 1) % steps.len()];
                    assert_eq!(one.0 * other.1 - one.1 * other.0, 1);
                    assert!(min_acuteness(&[narrow], one, other) >= 0.0, "{one:?} {other:?}");
                }
            }
        }
    }

    #[test]
    fn samples_are_all_cells_of_a_small_field_and_no_more_of_some_columns_of_a_large_one() {
        assert!(sampled_cells(1000).eq(0..1000));
        let mut columns = [0; 16];
        sampled_cells(1024 * 1024).for_each(|index| columns[index % 1024 / 64] += 1);
        assert!(columns.iter().all(|count| (56..=72).contains(count)), "{columns:?}");
    }
}
