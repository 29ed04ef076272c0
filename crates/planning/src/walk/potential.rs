//! Potential fields for a Wumpus: attraction of the goal, repulsion of bushes (Khatib 1986).

use wildfire_grid::brushfire::brushfire;
use wildfire_grid::potential::{self, Attraction, Repulsion};
use wildfire_grid::{Connectivity, Grid, Place};

use super::lattice::WalkLattice;
use super::query::{Walk, WalkCosts, WalkQuery};
use super::wavefront;
use crate::{PlanningObserver, SearchPhase};

/// The forces that attract a Wumpus to its goal and repel it from bushes; distances are lattice steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PotentialSettings {
    pub attraction: Attraction,
    /// The factor for the attraction after division by its maximum over the lattice; `None` leaves it unchanged.
    pub scale: Option<f64>,
    pub repulsion: Repulsion,
    /// True if a stuck walk continues down the exact cost-to-go.
    pub escapes: bool,
}

/// The potential over one lattice, without the attraction of a goal.
#[derive(Clone, Debug)]
pub struct PotentialField {
    settings: PotentialSettings,
    /// From the brushfire, with eight neighbours, of the points that the body cannot stand on.
    repulsion: Grid<f64>,
}

impl PotentialField {
    pub fn new(lattice: &WalkLattice, settings: PotentialSettings) -> Self {
        let repulsion = match brushfire(&lattice.blocked(), Connectivity::Eight) {
            Some(values) => potential::repulsion(&values, &settings.repulsion),
            None => Grid::filled(lattice.rows(), lattice.cols(), 0.0),
        };
        Self { settings, repulsion }
    }

    /// Descends to the lowest neighbour, as long as one is strictly lower, to a point of reach or a local minimum.
    ///
    /// Ties go to the first in the order of [`WalkLattice::steps`]. Every point whose neighbours are compared is an
    /// expansion; an escape adds those of its sweep.
    pub fn walk(&self, costs: &WalkCosts, query: &WalkQuery<'_>, observer: &mut dyn PlanningObserver) -> Walk {
        let potential = self.towards(query);
        let mut path = vec![query.start];
        let mut here = query.start;
        let mut expansions = 0;
        while !query.is_goal(here) {
            expansions += 1;
            let lowest = query.lattice.steps(here).map(|(_, next)| next);
            let lowest = lowest.min_by(|&a, &b| potential.at(a).total_cmp(&potential.at(b)));
            // Strictly lower, or a plateau would be walked in circles.
            let Some(next) = lowest.filter(|&next| potential.at(next) < potential.at(here)) else {
                // Before an escape, which shows the lines of its sweep itself.
                observer.on_edges_examined(SearchPhase::Walk, &mut query.lines(&path));
                if !self.settings.escapes {
                    return Walk { minimum: Some(here), ..Walk::straight(Some(path), expansions) };
                }
                // The way on begins at the minimum, which is not to be there twice.
                path.pop();
                let onward = wavefront::walk(costs, &WalkQuery { start: here, ..*query }, observer);
                path.extend(onward.path.iter().flatten());
                let path = onward.path.is_some().then_some(path);
                return Walk { minimum: Some(here), ..Walk::straight(path, expansions + onward.expansions) };
            };
            here = next;
            path.push(here);
        }
        observer.on_edges_examined(SearchPhase::Walk, &mut query.lines(&path));
        Walk::straight(Some(path), expansions)
    }

    /// The potential that leads to the goal of a query.
    pub(super) fn towards(&self, query: &WalkQuery<'_>) -> Potential<'_> {
        let rows = query.lattice.rows();
        let cols = query.lattice.cols();
        let goal = query.lattice.nearest(query.centre);
        let greatest = self.settings.attraction.greatest(rows, cols, goal);
        Potential { field: self, goal, greatest }
    }
}

/// The potential for one goal, computed only where it is needed: a descent visits few points of the lattice.
pub struct Potential<'a> {
    field: &'a PotentialField,
    goal: Place,
    /// The greatest attraction on the lattice.
    greatest: f64,
}

impl Potential<'_> {
    /// Returns attraction and repulsion at a point, as the maps of [`wildfire_grid::potential`] define them.
    ///
    /// Nothing repels within the repulsion's own reach of the goal's centre: what can be set on fire is an obstacle,
    /// and else it would keep off whoever comes for it (Ge and Cui, "New potential functions for mobile robot path
    /// planning", IEEE Trans. Robotics and Automation 16(5), 2000).
    pub fn at(&self, point: usize) -> f64 {
        let PotentialSettings { attraction, scale, repulsion, .. } = self.field.settings;
        let cols = self.field.repulsion.cols();
        let rows_off = (point / cols).abs_diff(self.goal.0);
        let cols_off = (point % cols).abs_diff(self.goal.1);
        // A lattice of one point has no attraction to divide by.
        let attraction = match scale.filter(|_| self.greatest > 0.0) {
            Some(scale) => attraction.at(rows_off, cols_off) / self.greatest * scale,
            None => attraction.at(rows_off, cols_off),
        };
        let rows_off = rows_off as f64;
        let cols_off = cols_off as f64;
        let is_calm = rows_off * rows_off + cols_off * cols_off <= repulsion.q * repulsion.q;
        if is_calm { attraction } else { attraction + self.field.repulsion.values()[point] }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_lattices::{FRAME, field, on_cells};
    use super::*;

    #[test]
    fn away_from_the_goal_the_potential_is_the_total_map() {
        let occupied = field(5, 0.1);
        let lattice = on_cells(&occupied);
        for (scale, zeta) in [(Some(10.0), 1.0), (None, 0.3)] {
            let attraction = Attraction::Squared { zeta };
            let settings = PotentialSettings { attraction, scale, repulsion: Repulsion::default(), escapes: true };
            let prepared = PotentialField::new(&lattice, settings);
            let (row, col) = (7, 17);
            let centre = lattice.position(row * lattice.cols() + col);
            let query = WalkQuery { lattice: &lattice, start: 0, goals: &[], centre };
            let potential = prepared.towards(&query);
            let brushfire = brushfire(&occupied, Connectivity::Eight).expect("something is occupied");
            let attraction = potential::attraction(lattice.rows(), lattice.cols(), (row, col), attraction, scale);
            let total = potential::total(attraction.clone(), &brushfire, &settings.repulsion);
            let mut differing = 0;
            for point in 0..lattice.points() {
                let is_calm = (lattice.position(point) - centre).length() <= 5.0 * FRAME.cell_m;
                let expected = if is_calm { &attraction } else { &total };
                assert_eq!(potential.at(point), expected.values()[point]);
                differing += usize::from(attraction.values()[point] != total.values()[point]);
            }
            assert!(differing > 100, "repulsion is felt at {differing} points");
        }
    }
}
