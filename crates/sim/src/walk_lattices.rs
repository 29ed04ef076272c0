//! The grounds on which Wumpuses walk: Wumpuses of equal bodies and rules share one lattice, one planner with its
//! memory, and one list of what they can light.
//!
//! Each part is made when the first Wumpus needs it, so that setting out costs the same for one Wumpus and for a hundred.

use std::f64::consts::SQRT_2;
use std::sync::{Arc, MutexGuard};

use bevy_ecs::prelude::*;
use glam::DVec2;

use crate::shared::Shared;
use wildfire_base::geometry::{Cell, FieldFrame};
use wildfire_planning::kit::safety::{Safety, SafetySettings};
use wildfire_planning::walk::{LatticeShape, WalkCosts, WalkLattice, WalkMethod, WalkPlanner};
use wildfire_scenario::{self as scenario, StepCost, Terrain};

/// The planners of a run, each for all Wumpuses of equal rules. They keep what they learn from query to query.
#[derive(Resource, Clone, Default)]
pub struct WalkPlanners(Vec<Shared<WalkPlanner>>);

/// The place of a Wumpus's planner among those of the run.
#[derive(Clone, Copy, Debug)]
pub struct WalkPlannerId(usize);

impl WalkPlanners {
    pub fn lock(&self, id: WalkPlannerId) -> MutexGuard<'_, WalkPlanner> {
        self.0[id.0].lock()
    }
}

/// The cells that a Wumpus can approach from its start, and those that it cannot, each by cell index.
#[derive(Debug)]
pub struct Targets {
    frame: FieldFrame,
    pub cells: Vec<Cell>,
    pub walled_in: Vec<Cell>,
}

impl Targets {
    /// Returns true if a cell can be approached.
    pub fn contains(&self, cell: Cell) -> bool {
        self.cells.binary_search_by_key(&self.frame.index(cell), |&cell| self.frame.index(cell)).is_ok()
    }
}

/// The place of one Wumpus on its ground.
pub struct LatticePosition {
    pub lattice: Arc<WalkLattice>,
    /// The free point nearest to its start.
    pub point: usize,
    pub targets: Arc<Targets>,
    pub planner: WalkPlannerId,
}

/// The grounds of a run while its Wumpuses are created.
pub struct WalkLattices<'a> {
    terrain: &'a Terrain,
    /// By cell index.
    lightable: Vec<Cell>,
    lattices: Vec<SharedLattice>,
    planner_keys: Vec<(usize, PlannerKey)>,
    planners: WalkPlanners,
}

/// What planners of one lattice differ in.
#[derive(PartialEq)]
struct PlannerKey {
    method: WalkMethod,
    step_cost: StepCost,
    safety: SafetySettings,
}

struct SharedLattice {
    shape: LatticeShape,
    lattice: Arc<WalkLattice>,
    /// By point: the number of the connected part that it belongs to, from 1; 0 as long as nobody asked.
    parts: Vec<u32>,
    part_count: u32,
    /// By part and reach.
    targets: Vec<((u32, f64), Arc<Targets>)>,
}

impl<'a> WalkLattices<'a> {
    /// Prepares grounds on a field of which the cells in `lightable`, by index, can be lit.
    pub fn new(terrain: &'a Terrain, lightable: Vec<Cell>) -> Self {
        let lattices = Vec::new();
        let planner_keys = Vec::new();
        Self { terrain, lightable, lattices, planner_keys, planners: WalkPlanners::default() }
    }

    /// Places a Wumpus on the free point of its lattice that is nearest to its start; `None` if no point is free.
    pub fn place(&mut self, settings: &scenario::Wumpus) -> Option<LatticePosition> {
        let number = self.lattice_number(settings.lattice_shape(&self.terrain.frame));
        let ground = &mut self.lattices[number];
        let point = ground.lattice.nearest_free(DVec2::from(settings.start_m))?;
        let targets = ground.targets_from(point, settings.reach_m, &self.lightable, self.terrain.frame);
        let lattice = Arc::clone(&ground.lattice);
        Some(LatticePosition { lattice, point, targets, planner: self.planner_of(number, settings) })
    }

    /// Returns the planners of all Wumpuses that were placed.
    pub fn into_planners(self) -> WalkPlanners {
        self.planners
    }

    fn lattice_number(&mut self, shape: LatticeShape) -> usize {
        let existing = self.lattices.iter().position(|existing| existing.shape == shape);
        existing.unwrap_or_else(|| {
            let lattice = WalkLattice::new(self.terrain.frame, &self.terrain.occupied, shape);
            let parts = vec![0; lattice.points()];
            let lattice = Arc::new(lattice);
            let targets = Vec::new();
            self.lattices.push(SharedLattice { shape, lattice, parts, part_count: 0, targets });
            self.lattices.len() - 1
        })
    }

    fn planner_of(&mut self, lattice: usize, settings: &scenario::Wumpus) -> WalkPlannerId {
        let method = settings.walk_method();
        let safety = settings.safety.clone();
        let key = (lattice, PlannerKey { method, step_cost: settings.step_cost, safety });
        let existing = self.planner_keys.iter().position(|existing| *existing == key);
        WalkPlannerId(existing.unwrap_or_else(|| {
            let lattice = &self.lattices[lattice].lattice;
            let costs = walk_costs(settings, self.terrain, lattice);
            self.planners.0.push(Shared::new(WalkPlanner::new(lattice, method, costs)));
            self.planner_keys.push(key);
            self.planners.0.len() - 1
        }))
    }
}

impl SharedLattice {
    /// Lists what can be lit from the part of the lattice that a point belongs to.
    fn targets_from(&mut self, point: usize, reach_m: f64, lightable: &[Cell], frame: FieldFrame) -> Arc<Targets> {
        if self.parts[point] == 0 {
            self.part_count += 1;
            self.lattice.mark_part(point, &mut self.parts, self.part_count);
        }
        let part = self.parts[point];
        if let Some((_, cached)) = self.targets.iter().find(|&&(of, _)| of == (part, reach_m)) {
            return Arc::clone(cached);
        }
        let (cells, walled_in) = lightable
            .iter()
            .partition(|&&cell| self.lattice.points_of_reach(cell, reach_m).any(|p| self.parts[p] == part));
        let targets = Arc::new(Targets { frame, cells, walled_in });
        self.targets.push(((part, reach_m), Arc::clone(&targets)));
        targets
    }
}

fn walk_costs(settings: &scenario::Wumpus, terrain: &Terrain, lattice: &WalkLattice) -> WalkCosts {
    let step_m = lattice.step_m();
    let steps = match settings.step_cost {
        StepCost::Metres => (step_m, step_m * SQRT_2),
        StepCost::Moves => (1.0, 1.0),
    };
    let factors = Safety::new(terrain.frame, &terrain.occupied, &settings.safety)
        .map(|safety| (0..lattice.points()).map(|point| 1.0 + safety.surcharge_at(lattice.position(point))).collect());
    WalkCosts { steps, factors }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;
    use wildfire_grid::Grid;
    use wildfire_scenario::Wumpus;

    fn terrain() -> Terrain {
        let scenario = scenario::load("dense", &[]).expect("the preset loads");
        Terrain::from_scenario(&scenario, 3).expect("it has a field")
    }

    #[test]
    fn equal_wumpuses_share_everything_and_others_only_what_is_equal() {
        let terrain = terrain();
        let mut grounds = WalkLattices::new(&terrain, terrain.bushes.clone());
        let mut place = |wumpus: Wumpus| grounds.place(&wumpus).expect("there is room");
        let first = place(Wumpus::default());
        let elsewhere = place(Wumpus { start_m: [52.5, 57.5], ..Wumpus::default() });
        assert!(Arc::ptr_eq(&first.lattice, &elsewhere.lattice) && first.point != elsewhere.point);
        assert!(Arc::ptr_eq(&first.targets, &elsewhere.targets) && first.planner.0 == elsewhere.planner.0);
        let longer = place(Wumpus { reach_m: 12.0, ..Wumpus::default() });
        assert!(Arc::ptr_eq(&first.lattice, &longer.lattice) && first.planner.0 == longer.planner.0);
        assert!(longer.targets.cells.len() > first.targets.cells.len());
        let greedy = place(Wumpus { heuristic_weight: 3.0, ..Wumpus::default() });
        assert!(Arc::ptr_eq(&first.targets, &greedy.targets) && first.planner.0 != greedy.planner.0);
        let larger = place(Wumpus { size_m: 6.0, ..Wumpus::default() });
        assert!(!Arc::ptr_eq(&first.lattice, &larger.lattice) && first.planner.0 != larger.planner.0);
    }

    #[test]
    fn targets_are_the_cells_near_a_point_that_can_be_walked_to() {
        let frame = FieldFrame { cols: 40, rows: 30, cell_m: 5.0 };
        let mut rng = rng::stream(2, "walk grounds");
        let cells = (0..frame.cell_count()).map(|_| rng.random_bool(0.55)).collect();
        let terrain = Terrain::from_occupied(frame, Grid::from_values(30, 40, cells));
        let mut grounds = WalkLattices::new(&terrain, terrain.bushes.clone());
        for start in 0..60 {
            let start_m = [2.5 + 3.3 * f64::from(start), 2.5 + 2.4 * f64::from(start)];
            let wumpus = Wumpus { start_m, size_m: 4.9, reach_m: 5.0, ..Wumpus::default() };
            let LatticePosition { lattice, point, targets, .. } = grounds.place(&wumpus).expect("there is room");
            let reached = lattice.reachable_from(point);
            for &cell in &terrain.bushes {
                let is_target = lattice.points_of_reach(cell, wumpus.reach_m).any(|point| reached[point]);
                assert_eq!(targets.contains(cell), is_target, "{cell} from {start_m:?}");
                assert_eq!(targets.walled_in.contains(&cell), !is_target);
            }
        }
        assert!(grounds.lattices[0].part_count > 3, "{} parts", grounds.lattices[0].part_count);
    }
}
