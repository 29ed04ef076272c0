//! What a query on the roadmap remembers while it searches.

use crate::grid::open_list::{OpenList, Ranked};

/// Stands for the start where a milestone's number is asked for.
pub const START: u32 = u32::MAX;

/// Ways into the goal that one milestone may offer.
const GOAL_OFFERS: u64 = 9;

/// A way to a milestone or a goal place that is still to be judged.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Estimated cost of the whole route, by which the search is ordered.
    pub key: f64,
    pub cost: f64,
    pub to: u32,
    pub from: u32,
}

impl Ranked for Candidate {
    type Tie = (u32, u32);

    fn priority(&self) -> f64 {
        self.key
    }

    fn cost(&self) -> f64 {
        self.cost
    }

    fn tie(&self) -> (u32, u32) {
        (self.to, self.from)
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Visit {
    pub generation: u32,
    pub closed: bool,
    pub cost: f64,
    pub parent: u32,
}

/// Memory that queries share, so that they need not allocate.
#[derive(Debug, Default)]
pub struct RoadmapScratch {
    generation: u32,
    pub visits: Vec<Visit>,
    pub open: OpenList<Candidate>,
    pub near: Vec<(f64, u32)>,
    /// Milestones whose cost is final, in the order in which it became so.
    pub closed: Vec<u32>,
    /// Milestones expanded by the last query.
    pub expansions: u32,
}

impl RoadmapScratch {
    /// The most bytes that queries take on a roadmap of these numbers of milestones and edges, in lists that double.
    pub fn most_bytes(milestones: u64, edges: u64) -> u64 {
        let of_each = size_of::<Visit>() + size_of::<u32>() + size_of::<(f64, u32)>();
        // An edge is offered from both its ends; a milestone near the goal offers the ways into it.
        let candidates = 2 * edges + GOAL_OFFERS * milestones;
        2 * (milestones * of_each as u64 + candidates * size_of::<Candidate>() as u64)
    }

    pub fn begin(&mut self, milestones: usize) {
        if self.visits.len() != milestones || self.generation == u32::MAX {
            self.visits = vec![Visit { generation: 0, closed: false, cost: 0.0, parent: START }; milestones];
            self.generation = 0;
        }
        self.generation += 1;
        self.open.clear();
        self.closed.clear();
        self.expansions = 0;
    }

    pub fn visit(&mut self, milestone: u32) -> &mut Visit {
        let visit = &mut self.visits[milestone as usize];
        if visit.generation != self.generation {
            *visit = Visit { generation: self.generation, closed: false, cost: f64::INFINITY, parent: START };
        }
        visit
    }
}
