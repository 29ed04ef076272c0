//! The straight ways from a cell to those around it, and the cells that each of them crosses.
//!
//! Ways are column and row offsets without a common divisor, so that none goes on beyond another. Which cells a way
//! crosses, and by which part of its length, follows from whole numbers and is computed once.

use super::rules::Neighbours;

/// The farthest way of any template, in columns or rows; also the reach of the exact start round an ignition.
pub const REACH: i32 = 3;

/// The most cells that a way crosses, and the most corners that it passes through, up to [`REACH`].
const MOST_CROSSED: usize = 6;
const MOST_CORNERS: usize = 2;

/// A straight way between the centres of two cells. Places of cells are differences of indices from its beginning.
#[derive(Clone, Debug)]
pub struct Way {
    pub cols: i32,
    pub rows: i32,
    pub end: isize,
    crossed: [(isize, f64); MOST_CROSSED],
    crossed_count: u8,
    corners: [[isize; 2]; MOST_CORNERS],
    corner_count: u8,
}

impl Way {
    fn new((cols, rows): (i32, i32), stride: usize) -> Self {
        let place = |(col, row): (i32, i32)| row as isize * stride as isize + col as isize;
        let mut way = Self {
            cols,
            rows,
            end: place((cols, rows)),
            crossed: [(0, 0.0); MOST_CROSSED],
            crossed_count: 0,
            corners: [[0; 2]; MOST_CORNERS],
            corner_count: 0,
        };
        // Time along the way is counted in parts of `scale`; borders of columns (rows) come at odd multiples of `rows`
        // (`cols`), so that all of it is whole numbers and a corner is where two are equal.
        let (across, up) = (cols.abs().max(1), rows.abs().max(1));
        let scale = 2 * across * up;
        let next_border = |done: i32, all: i32, step: i32| if done < all { (2 * done + 1) * step } else { scale };
        let (mut at, mut col, mut row) = (0, 0, 0);
        while at < scale {
            let (border_col, border_row) = (next_border(col, cols.abs(), up), next_border(row, rows.abs(), across));
            let until = border_col.min(border_row);
            let cell = |col: i32, row: i32| place((col * cols.signum(), row * rows.signum()));
            way.crossed[usize::from(way.crossed_count)] = (cell(col, row), f64::from(until - at) / f64::from(scale));
            way.crossed_count += 1;
            if border_col == border_row && until < scale {
                way.corners[usize::from(way.corner_count)] = [cell(col + 1, row), cell(col, row + 1)];
                way.corner_count += 1;
            }
            col += i32::from(border_col == until);
            row += i32::from(border_row == until);
            at = until;
        }
        way
    }

    /// The cells that it crosses, its two ends among them, from its beginning on, with the part of its length in each.
    #[inline]
    pub fn crossed(&self) -> &[(isize, f64)] {
        &self.crossed[..usize::from(self.crossed_count)]
    }

    /// For each corner that it passes through, the two cells beside it.
    #[inline]
    pub fn corners(&self) -> &[[isize; 2]] {
        &self.corners[..usize::from(self.corner_count)]
    }
}

/// The ways from a cell, for a grid whose rows lie `stride` apart.
#[derive(Clone, Debug)]
pub struct Template {
    /// Counter-clockwise from east, so that neighbours in this list are neighbours in direction.
    pub ways: Vec<Way>,
    /// Those to all cells whose centres are within three cells, whatever the number of neighbours.
    pub disc: Vec<Way>,
}

impl Template {
    pub fn new(neighbours: Neighbours, stride: usize) -> Self {
        let reach = neighbours.reach();
        let offsets = |reach: i32| (-reach..=reach).flat_map(move |row| (-reach..=reach).map(move |col| (col, row)));
        let mut steps: Vec<_> = offsets(reach).filter(|&(col, row)| gcd(col.abs(), row.abs()) == 1).collect();
        // By half of the circle, then by the cross product: no angles, no ties.
        let half = |(col, row): (i32, i32)| row < 0 || (row == 0 && col < 0);
        steps.sort_unstable_by(|&a, &b| half(a).cmp(&half(b)).then_with(|| 0.cmp(&(a.0 * b.1 - a.1 * b.0))));
        let within = |&(col, row): &(i32, i32)| (1..=REACH * REACH).contains(&(col * col + row * row));
        Self {
            ways: steps.into_iter().map(|step| Way::new(step, stride)).collect(),
            disc: offsets(REACH).filter(within).map(|step| Way::new(step, stride)).collect(),
        }
    }
}

fn gcd(a: i32, b: i32) -> i32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRIDE: usize = 100;

    fn offset(place: isize) -> (i32, i32) {
        let row = (place as f64 / STRIDE as f64).round() as i32;
        (place as i32 - row * STRIDE as i32, row)
    }

    #[test]
    fn there_are_as_many_ways_as_neighbours_in_order_of_direction() {
        for neighbours in [Neighbours::Eight, Neighbours::Sixteen, Neighbours::ThirtyTwo] {
            let ways = Template::new(neighbours, STRIDE).ways;
            assert_eq!(ways.len(), neighbours.count());
            for (number, way) in ways.iter().enumerate() {
                let next = &ways[(number + 1) % ways.len()];
                assert_eq!(way.cols * next.rows - way.rows * next.cols, 1, "two neighbours span no other cell");
            }
        }
    }

    #[test]
    fn crossed_cells_are_those_that_points_of_the_way_lie_in() {
        let template = Template::new(Neighbours::ThirtyTwo, STRIDE);
        for way in template.ways.iter().chain(&template.disc) {
            let samples = 100_000;
            let mut parts = std::collections::BTreeMap::new();
            for sample in 0..samples {
                let part = (f64::from(sample) + 0.5) / f64::from(samples);
                let near = |steps: i32| (f64::from(steps) * part).round() as i32;
                *parts.entry((near(way.cols), near(way.rows))).or_insert(0) += 1;
            }
            assert_eq!(parts.len(), way.crossed().len(), "{:?}", (way.cols, way.rows));
            for &(place, part) in way.crossed() {
                let sampled = f64::from(parts[&offset(place)]) / f64::from(samples);
                assert!((sampled - part).abs() < 1e-4, "{:?}: {sampled} {part}", (way.cols, way.rows));
            }
            let whole: f64 = way.crossed().iter().map(|(_, part)| part).sum();
            assert!((whole - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn ways_of_odd_offsets_pass_through_a_corner() {
        for way in Template::new(Neighbours::ThirtyTwo, STRIDE).ways {
            let is_odd = way.cols % 2 != 0 && way.rows % 2 != 0;
            assert_eq!(way.corners().len(), usize::from(is_odd));
            for &[a, b] in way.corners() {
                // Both lie as far from the middle of the way, across it.
                let ((a_col, a_row), (b_col, b_row)) = (offset(a), offset(b));
                assert_eq!((a_col + b_col, a_row + b_row), (way.cols, way.rows));
            }
        }
    }
}
