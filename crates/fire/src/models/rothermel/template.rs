//! The straight ways from a cell to those around it, and the cells that each of them crosses.
//!
//! Ways are column and row offsets without a common divisor, so that none goes on beyond another. Which cells a way
//! crosses, and by which part of its length, follows from whole numbers and is computed once.

use super::directions::DirectionSet;
use super::rates::{Pair, vector};
use wildfire_base::geometry::DVec2;

/// A straight way between the centres of two cells. Places of cells are differences of indices from its beginning.
#[derive(Clone, Debug)]
pub struct Edge {
    pub cols: i32,
    pub rows: i32,
    pub end: isize,
    crossed: Box<[(isize, f64)]>,
    corners: Box<[[isize; 2]]>,
}

impl Edge {
    fn new((cols, rows): (i32, i32), stride: usize) -> Self {
        let place = |(col, row): (i32, i32)| row as isize * stride as isize + col as isize;
        let mut crossed = Vec::new();
        let mut corners = Vec::new();
        // Time along the way is counted in parts of `scale`; borders of columns (rows) come at odd multiples of `rows`
        // (`cols`), so that all of it is whole numbers and a corner is where two are equal.
        let across = cols.abs().max(1);
        let up = rows.abs().max(1);
        let scale = 2 * across * up;
        let next_border = |done: i32, all: i32, step: i32| if done < all { (2 * done + 1) * step } else { scale };
        let (mut at, mut col, mut row) = (0, 0, 0);
        while at < scale {
            let border_col = next_border(col, cols.abs(), up);
            let border_row = next_border(row, rows.abs(), across);
            let until = border_col.min(border_row);
            let cell = |col: i32, row: i32| place((col * cols.signum(), row * rows.signum()));
            crossed.push((cell(col, row), f64::from(until - at) / f64::from(scale)));
            // At the end of the way two borders meet as well: that is the goal's middle, not a corner.
            if border_col == border_row && until < scale {
                corners.push([cell(col + 1, row), cell(col, row + 1)]);
            }
            col += i32::from(border_col == until);
            row += i32::from(border_row == until);
            at = until;
        }
        Self { cols, rows, end: place((cols, rows)), crossed: crossed.into(), corners: corners.into() }
    }

    /// The cells that it crosses, its two ends among them, from its beginning on, with the part of its length in each.
    #[inline]
    pub fn crossed(&self) -> &[(isize, f64)] {
        &self.crossed
    }

    /// For each corner that it passes through, the two cells beside it.
    #[inline]
    pub fn corners(&self) -> &[[isize; 2]] {
        &self.corners
    }
}

/// The ways of one set of directions.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeSet {
    /// Numbers of ways, counter-clockwise from east, so that neighbours in this list are neighbours in direction.
    pub ways: Vec<u16>,
    /// By number of a way, its place in that list.
    places: Vec<Option<u16>>,
    /// By the place of the first of two ways, on a plane.
    pub pairs: Vec<Pair>,
    /// Numbers of the ways round an ignition, sorted.
    disc: Vec<u16>,
}

impl EdgeSet {
    /// Returns the place of a way in the list, if it is one of the set.
    #[inline]
    pub fn place(&self, way: usize) -> Option<usize> {
        self.places.get(way).copied().flatten().map(usize::from)
    }

    /// Iterates over the numbers of its ways in order of direction.
    #[inline]
    pub fn numbers(&self) -> impl Iterator<Item = usize> {
        self.ways.iter().map(|&number| usize::from(number))
    }

    /// Returns the way at a place and its neighbour counter-clockwise.
    pub fn pair(&self, place: usize) -> [usize; 2] {
        [place, (place + 1) % self.ways.len()].map(|place| usize::from(self.ways[place]))
    }
}

/// The ways from a cell in each interval of the weather, for a grid whose rows lie `stride` apart.
#[derive(Clone, Debug)]
pub struct Template {
    /// Those of all sets.
    pub ways: Vec<Edge>,
    /// Those round an ignition.
    disc: Vec<Edge>,
    /// The vectors of the ways, in metres.
    pub vectors: Vec<DVec2>,
    sets: Vec<EdgeSet>,
    /// By interval of the weather.
    set_of: Vec<u16>,
}

impl Template {
    /// Creates the ways of the sets of directions of all intervals; `gradient` is that of a plane.
    pub fn new(directions: &[DirectionSet], stride: usize, cell_m: f64, gradient: Option<DVec2>) -> Self {
        let mut template =
            Self { ways: Vec::new(), disc: Vec::new(), vectors: Vec::new(), sets: Vec::new(), set_of: Vec::new() };
        for set in directions {
            // Weather that changes little keeps its directions; their ways are shared.
            let existing = directions.iter().position(|other| other == set).expect("it is one of them");
            let number = template.set_of.get(existing).copied().unwrap_or_else(|| {
                let set = template.edge_set(set, stride, cell_m, gradient);
                template.sets.push(set);
                template.sets.len() as u16 - 1
            });
            template.set_of.push(number);
        }
        template
    }

    fn edge_set(&mut self, set: &DirectionSet, stride: usize, cell_m: f64, gradient: Option<DVec2>) -> EdgeSet {
        let mut numbers = Vec::new();
        for &step in set.steps() {
            // Sets of other weather share the ways that they have in common, with their numbers.
            let (number, is_new) = number_of(&mut self.ways, step, stride);
            numbers.push(number);
            if is_new {
                self.vectors.push(vector(&self.ways[usize::from(number)], cell_m));
            }
        }
        let mut disc: Vec<u16> =
            set.exact_offsets().into_iter().map(|step| number_of(&mut self.disc, step, stride).0).collect();
        // Sorted, so that membership is a binary search.
        disc.sort_unstable();
        // Ways that later sets add lie beyond the end of this list, which `place` takes for absent.
        let mut places = vec![None; self.ways.len()];
        for (place, &number) in numbers.iter().enumerate() {
            places[usize::from(number)] = Some(place as u16);
        }
        // The last direction is the first one's neighbour.
        let next = numbers.iter().cycle().skip(1);
        let pairs = numbers
            .iter()
            .zip(next)
            // Only on a plane is a pair the same at every cell.
            .filter_map(|(&one, &other)| {
                gradient.map(|gradient| {
                    Pair::new(gradient, self.vectors[usize::from(one)], self.vectors[usize::from(other)])
                })
            })
            .collect();
        EdgeSet { places, pairs, disc, ways: numbers }
    }

    /// Returns the ways of an interval of the weather.
    #[inline]
    pub fn set(&self, interval: usize) -> &EdgeSet {
        &self.sets[self.set_number(interval)]
    }

    /// Returns the place of the ways of an interval of the weather among [`Self::sets`].
    #[inline]
    pub fn set_number(&self, interval: usize) -> usize {
        usize::from(self.set_of[interval])
    }

    pub fn sets(&self) -> &[EdgeSet] {
        &self.sets
    }

    /// Returns the ways round an ignition in an interval of the weather, by their numbers among all.
    pub fn disc(&self, interval: usize) -> impl Iterator<Item = usize> {
        self.set(interval).disc.iter().map(|&of_disc| self.ways.len() + usize::from(of_disc))
    }

    /// Says whether an interval of the weather has a way, or has it round an ignition.
    pub fn contains(&self, interval: usize, number: usize) -> bool {
        let set = self.set(interval);
        match number.checked_sub(self.ways.len()) {
            Some(of_disc) => set.disc.binary_search(&(of_disc as u16)).is_ok(),
            None => set.place(number).is_some(),
        }
    }

    /// Returns the number of all ways, those round an ignition included.
    pub fn count(&self) -> usize {
        self.ways.len() + self.disc.len()
    }

    /// Returns a way by its number, those round an ignition after the others.
    #[inline]
    pub fn way(&self, number: usize) -> &Edge {
        self.ways.get(number).unwrap_or_else(|| &self.disc[number - self.ways.len()])
    }
}

/// Returns the number of a way in a list, and whether it was added to it just now.
fn number_of(ways: &mut Vec<Edge>, step: (i32, i32), stride: usize) -> (u16, bool) {
    let existing = ways.iter().position(|way| (way.cols, way.rows) == step);
    let number = existing.unwrap_or(ways.len()) as u16;
    if existing.is_none() {
        ways.push(Edge::new(step, stride));
    }
    (number, existing.is_none())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::Neighbours;

    const STRIDE: usize = 100;

    fn unrefined(neighbours: Neighbours) -> Template {
        Template::new(&[DirectionSet::new(neighbours, &[])], STRIDE, 5.0, None)
    }

    fn offset(place: isize) -> (i32, i32) {
        let row = (place as f64 / STRIDE as f64).round() as i32;
        (place as i32 - row * STRIDE as i32, row)
    }

    #[test]
    fn there_are_as_many_ways_as_neighbours_in_order_of_direction() {
        for neighbours in [Neighbours::Eight, Neighbours::Sixteen, Neighbours::ThirtyTwo] {
            let ways = unrefined(neighbours).ways;
            assert_eq!(ways.len(), neighbours.count());
            for (number, way) in ways.iter().enumerate() {
                let next = &ways[(number + 1) % ways.len()];
                assert_eq!(way.cols * next.rows - way.rows * next.cols, 1, "two neighbours span no other cell");
            }
        }
    }

    #[test]
    fn crossed_cells_are_those_that_points_of_the_way_lie_in() {
        let template = unrefined(Neighbours::ThirtyTwo);
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
        for way in unrefined(Neighbours::ThirtyTwo).ways {
            let is_odd = way.cols % 2 != 0 && way.rows % 2 != 0;
            assert_eq!(way.corners().len(), usize::from(is_odd));
            for &[a, b] in way.corners() {
                // Both lie as far from the middle of the way, across it.
                let (a_col, a_row) = offset(a);
                let (b_col, b_row) = offset(b);
                assert_eq!((a_col + b_col, a_row + b_row), (way.cols, way.rows));
            }
        }
    }
}
