//! What a truck sees when it decides, and which fire it likes best.

use glam::DVec2;

use crate::fire::{BushState, FireField};
use crate::geometry::{Cell, FieldFrame};
use crate::scenario::TruckGoal;
use crate::time::SimTime;

use super::traffic::Traffic;

/// What a decision may look at.
pub struct Situation<'a> {
    pub now: SimTime,
    pub frame: &'a FieldFrame,
    pub fires: &'a FireField,
    /// Goals of the other trucks.
    pub claimed: &'a [Cell],
    pub traffic: Traffic<'a>,
}

impl Situation<'_> {
    /// The best burning cell by a policy among those that `may` be chosen and that no other truck has.
    pub fn best(&self, policy: TruckGoal, centre: DVec2, may: impl Fn(Cell) -> bool) -> Option<Cell> {
        let open = self.fires.burning().filter(|cell| !self.claimed.contains(cell) && may(*cell));
        let distance = |cell: Cell| (self.frame.centre(cell) - centre).length_squared();
        let nearest = |a: &Cell, b: &Cell| distance(*a).total_cmp(&distance(*b));
        let ignited_at = |cell: Cell| match self.fires.state(cell) {
            Some(BushState::Burning { since }) => since,
            _ => unreachable!("only burning cells are compared"),
        };
        // Burning cells come by index and the first of equals wins, so ties go to the smaller index.
        match policy {
            TruckGoal::NearestBurning => open.min_by(nearest),
            TruckGoal::Oldest => open.min_by(|a, b| ignited_at(*a).cmp(&ignited_at(*b)).then_with(|| nearest(a, b))),
            TruckGoal::LargestCluster => {
                let sizes = cluster_sizes(self.frame, self.fires);
                let size = |cell: &Cell| sizes[self.frame.index(*cell)];
                open.min_by(|a, b| size(b).cmp(&size(a)).then_with(|| nearest(a, b)))
            }
        }
    }
}

/// By cell index: how many burning cells hang together with this burning cell over sides and corners.
fn cluster_sizes(frame: &FieldFrame, fires: &FireField) -> Vec<u32> {
    let mut sizes = vec![0; frame.cell_count()];
    for seed in fires.burning() {
        if sizes[frame.index(seed)] != 0 {
            continue;
        }
        let mut cluster = vec![seed];
        sizes[frame.index(seed)] = 1;
        let mut next = 0;
        while let Some(&cell) = cluster.get(next) {
            next += 1;
            for (cols, rows) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                let Some(other) = frame.offset(cell, cols, rows) else { continue };
                if fires.is_burning(other) && sizes[frame.index(other)] == 0 {
                    sizes[frame.index(other)] = 1;
                    cluster.push(other);
                }
            }
        }
        for cell in &cluster {
            sizes[frame.index(*cell)] = cluster.len() as u32;
        }
    }
    sizes
}
