//! Two-dimensional search over cells as a heuristic: the cost of avoiding bushes, whatever the steering.

use glam::DVec2;

use crate::GoalDisc;
use crate::collision::ClearanceField;
use crate::memory::{CapacityBytes, MemoryKind, MemoryMeter, MemoryShare};
use wildfire_base::geometry::FieldFrame;

use super::target::Target;

/// A truck drives at least this share of a walk over cells, however it cuts the corners of the grid.
const SHARE: f64 = 0.94;

/// Rows and columns from a cell to those that share a side with it, in their order round it.
const BESIDE: [(i32, i32); 4] = [(0, 1), (1, 0), (0, -1), (-1, 0)];

/// Costs of an orthogonal and of a diagonal move: 99 / 70 is the root of 2 to 0.005 %.
const MOVE_COSTS: (u32, u32) = (70, 99);
/// The number of buckets, more than a move adds to a key: its cost, and at most as much of the estimate.
const RING: usize = 256;

/// The mark of bushes, of what lies outside the field, and of pockets that no walk leads into; less than any cost.
const SHUT: u32 = 0;
/// The cost of the goal's cells. All costs are counted from here, so that none is [`SHUT`].
const GOAL_COST: u32 = 1;
/// The cost of a cell that was not reached yet.
const UNREACHED: u32 = u32::MAX;
/// The mark of unreached cells while it is found out whether they are a pocket.
const IN_QUESTION: u32 = u32::MAX - 1;

/// Cells along the sides of a tile, a power of two.
const TILE: usize = 32;
const TILE_BITS: u32 = TILE.trailing_zeros();
/// In the directory of tiles: not met yet. This page is [`SHUT`] all over.
const NO_PAGE: u32 = 0;
/// Tiles whose memory is kept for the next query; that of longer drives is given back.
const KEPT_TILES: usize = 64;

/// Cells that are expanded for one question before it is asked whether the cell lies in a pocket of the field, and the
/// most cells of such a pocket.
const PATIENCE: usize = 4096;

/// The holonomic heuristic: the distance to a goal by steps from cell to cell around the bushes.
///
/// It spreads from the goal towards the start of the drive, only as far as it is asked, and continues where it stopped:
/// reverse resumable A* (D. Silver, "Cooperative pathfinding", AIIDE 2005), with whole costs in R. Dial's buckets
/// ("Algorithm 360: shortest-path forest with topological ordering", Communications of the ACM 12(11), 1969). The estimate
/// is a walk without bushes to the start's cell, which changes along a move by no more than the move costs. So costs are
/// final in the order of their keys, and the answer for a cell is the length of a shortest walk, whatever was asked
/// before.
///
/// Costs are kept by tiles of the field, made when the search first meets them: time and memory follow the drive and
/// not the field.
#[derive(Debug)]
pub struct HolonomicHeuristic {
    /// The page of every tile, row by row; empty before the first query.
    directory: Vec<u32>,
    tile_cols: usize,
    /// Costs by page.
    costs: Vec<u32>,
    /// Tiles that have a page.
    met: Vec<u32>,
    /// Cells by their keys, modulo the ring.
    buckets: Vec<Vec<CellOrBorder>>,
    /// Cells of the goal that are in no bucket yet, with their keys, the highest first.
    goal_cells: Vec<(u32, CellOrBorder)>,
    /// Costs are final where their keys are no higher.
    settled: u32,
    /// Entries in all buckets.
    waiting: usize,
    /// The cell that the search spreads towards.
    target: CellOrBorder,
    memory: MemoryShare,
    /// True if there was no memory for a tile.
    is_short: bool,
}

/// A cell of the field or one beside its border: row and column, counted from 1, in the upper and the lower half.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct CellOrBorder(u32);

impl CellOrBorder {
    fn new(row: usize, col: usize) -> Self {
        Self((row as u32 + 1) << 16 | (col as u32 + 1))
    }

    /// Returns the cell of a position, of one outside the field the nearest cell.
    fn nearest(frame: &FieldFrame, position: DVec2) -> Self {
        let index = |metres: f64, count: u16| ((metres / frame.cell_m) as usize).min(usize::from(count) - 1);
        Self::new(index(position.y, frame.rows), index(position.x, frame.cols))
    }

    fn row(self) -> usize {
        (self.0 >> 16) as usize
    }

    fn col(self) -> usize {
        (self.0 & 0xffff) as usize
    }

    /// Only cells of the field are moved from, so that neither half runs over.
    fn moved(self, (rows, cols): (i32, i32)) -> Self {
        Self(self.0.wrapping_add_signed((rows << 16) + cols))
    }

    /// Returns the place at the corner between two of those [`BESIDE`] this one.
    fn moved_between(self, k: usize) -> Self {
        self.moved(BESIDE[k]).moved(BESIDE[(k + 1) % 4])
    }

    /// Returns the cost of a walk to another place if there were no bushes.
    fn walk_cost(self, other: Self) -> u32 {
        let rows = self.row().abs_diff(other.row()) as u32;
        let cols = self.col().abs_diff(other.col()) as u32;
        MOVE_COSTS.0 * rows.max(cols) + (MOVE_COSTS.1 - MOVE_COSTS.0) * rows.min(cols)
    }
}

/// A cell whose neighbours are offered.
struct ExpandedCell {
    place: CellOrBorder,
    /// Where its cost is kept.
    slot: usize,
    /// True away from the edges of its tile: the costs of those about it are at the same distances in memory.
    is_inside: bool,
}

impl HolonomicHeuristic {
    pub fn new(memory: &MemoryMeter) -> Self {
        Self::holding(memory.holder(MemoryKind::Searches))
    }

    fn holding(memory: MemoryShare) -> Self {
        Self {
            directory: Vec::new(),
            tile_cols: 0,
            costs: Vec::new(),
            met: Vec::new(),
            buckets: vec![Vec::new(); RING],
            goal_cells: Vec::new(),
            settled: 0,
            waiting: 0,
            target: CellOrBorder::new(0, 0),
            memory,
            is_short: false,
        }
    }

    /// Resets the search and begins at the target; the drive comes from `start`.
    pub fn begin(&mut self, field: &ClearanceField, target: Target<'_>, start: DVec2) {
        let [cols, rows] = tiles_along(field.frame());
        // A search over a whole field would hold on to its memory for good.
        if self.directory.len() != cols * rows || self.met.len() > KEPT_TILES {
            *self = Self::holding(self.memory.beside());
            self.directory = vec![NO_PAGE; cols * rows];
            self.tile_cols = cols;
        }
        // Only tiles that were used are reset.
        for tile in self.met.drain(..) {
            self.directory[tile as usize] = NO_PAGE;
        }
        self.costs.clear();
        self.costs.resize(TILE * TILE, SHUT);
        self.buckets.iter_mut().for_each(Vec::clear);
        self.waiting = 0;
        self.target = CellOrBorder::nearest(field.frame(), start);
        self.goal_cells.clear();
        for place in target_cells(field, target) {
            self.goal_cells.push((GOAL_COST + place.walk_cost(self.target), place));
        }
        // Descending, so that the next one is taken off the end.
        self.goal_cells.sort_unstable_by(|a, b| b.cmp(a));
        for number in 0..self.goal_cells.len() {
            let slot = self.slot(field, self.goal_cells[number].1);
            self.costs[slot] = GOAL_COST;
        }
        self.settle(self.goal_cells.last().map_or(0, |&(key, _)| key));
    }

    /// Returns approximately the least remaining metres from a position in the field; infinite where no path leads to
    /// the goal.
    pub fn cost_to_go_m(&mut self, field: &ClearanceField, position: DVec2) -> f64 {
        let Some(cell) = field.frame().cell_at(position) else { return f64::INFINITY };
        let Some(cost) = self.cost_of(field, CellOrBorder::new(cell.row.into(), cell.col.into())) else {
            return f64::INFINITY;
        };
        let cell_m = field.frame().cell_m;
        (SHARE * cell_m * f64::from(cost) / f64::from(MOVE_COSTS.0) - cell_m).max(0.0)
    }

    /// Returns the cost from a cell to the goal, if a walk leads there; the search goes on until it is final.
    fn cost_of(&mut self, field: &ClearanceField, place: CellOrBorder) -> Option<u32> {
        let queried = self.slot(field, place);
        let estimate = place.walk_cost(self.target);
        let mut expanded = 0;
        loop {
            let cost = self.costs[queried];
            if cost == SHUT || self.is_short {
                return None;
            }
            // Settled, as every cheaper way would have a smaller key.
            if cost != UNREACHED && (cost + estimate <= self.settled || cost == GOAL_COST) {
                return Some(cost - GOAL_COST);
            }
            let Some(from) = self.buckets[self.settled as usize % RING].pop() else {
                // All costs with this key are known, and no move adds as much to a key as there are buckets: the next
                // may be reused.
                match self.goal_cells.last() {
                    _ if self.waiting > 0 => self.settle(self.settled + 1),
                    Some(&(key, _)) => self.settle(key),
                    None => return None,
                }
                continue;
            };
            self.waiting -= 1;
            let slot = self.slot(field, from);
            let cost = self.costs[slot];
            if cost + from.walk_cost(self.target) != self.settled {
                // It was reached more cheaply after it had been put here.
                continue;
            }
            self.expand(field, from, slot, cost);
            expanded += 1;
            // Where the cell lies in a pocket, the search would flood all the rest of the field before it knew.
            if expanded == PATIENCE && self.costs[queried] == UNREACHED {
                self.shut_pocket(field, place);
            }
        }
    }

    /// Offers the cells round one, whose cost is kept in `slot`.
    fn expand(&mut self, field: &ClearanceField, place: CellOrBorder, slot: usize, cost: u32) {
        let is_inside = [place.row(), place.col()].into_iter().all(|place| (1..TILE - 1).contains(&(place % TILE)));
        let from = ExpandedCell { place, slot, is_inside };
        let beside = BESIDE.map(|step| self.offer(field, &from, place.moved(step), cost + MOVE_COSTS.0));
        for k in 0..4 {
            // Nothing passes between two bushes that touch at a corner.
            if beside[k] || beside[(k + 1) % 4] {
                self.offer(field, &from, place.moved_between(k), cost + MOVE_COSTS.1);
            }
        }
    }

    /// Reaches a cell from one beside it at a cost, unless a lower one is known; says whether it is open.
    fn offer(&mut self, field: &ClearanceField, from: &ExpandedCell, place: CellOrBorder, cost: u32) -> bool {
        let slot = if from.is_inside {
            (from.slot + place.row() * TILE + place.col()) - (from.place.row() * TILE + from.place.col())
        } else {
            self.slot(field, place)
        };
        let before = self.costs[slot];
        if cost < before {
            self.costs[slot] = cost;
            self.wait(place, cost + place.walk_cost(self.target));
        }
        before != SHUT
    }

    fn wait(&mut self, place: CellOrBorder, key: u32) {
        self.buckets[key as usize % RING].push(place);
        self.waiting += 1;
    }

    /// Goes on to the cells of this key, those of the goal among them.
    fn settle(&mut self, key: u32) {
        self.settled = key;
        while let Some((_, place)) = self.goal_cells.pop_if(|(goal_key, _)| *goal_key == key) {
            self.wait(place, key);
        }
    }

    /// Shuts all cells to which walks lead from an unreached one, if these are few and none of them was reached.
    fn shut_pocket(&mut self, field: &ClearanceField, place: CellOrBorder) {
        let first = self.slot(field, place);
        // Marked apart, so that a pocket that turns out open can be set back.
        self.costs[first] = IN_QUESTION;
        let mut found = vec![place];
        let mut mark = SHUT;
        let mut next = 0;
        while next < found.len() && mark == SHUT {
            let from = found[next];
            next += 1;
            let is_open = BESIDE.map(|step| {
                let slot = self.slot(field, from.moved(step));
                self.costs[slot] != SHUT
            });
            let beside = (0..4).filter(|&k| is_open[k]).map(|k| from.moved(BESIDE[k]));
            // The same moves as in `expand`, as a pocket is what the search could never enter.
            let corners = (0..4).filter(|&k| is_open[k] || is_open[(k + 1) % 4]).map(|k| from.moved_between(k));
            for to in beside.chain(corners) {
                let slot = self.slot(field, to);
                match self.costs[slot] {
                    SHUT | IN_QUESTION => {}
                    UNREACHED if found.len() < PATIENCE => {
                        self.costs[slot] = IN_QUESTION;
                        found.push(to);
                    }
                    // Somebody came here already, or it is too large to be called a pocket.
                    _ => mark = UNREACHED,
                }
            }
        }
        for place in found {
            let slot = self.slot(field, place);
            self.costs[slot] = mark;
        }
    }

    /// Returns where the cost of a place is kept.
    #[inline]
    fn slot(&mut self, field: &ClearanceField, place: CellOrBorder) -> usize {
        let (row, col) = (place.row(), place.col());
        let tile = (row >> TILE_BITS) * self.tile_cols + (col >> TILE_BITS);
        let page = match self.directory[tile] {
            NO_PAGE => self.open_tile(field, tile),
            page => page as usize,
        };
        (page * TILE + row % TILE) * TILE + col % TILE
    }

    /// Makes the page of a tile, in which bushes and what lies outside the field are shut; returns its number.
    fn open_tile(&mut self, field: &ClearanceField, tile: usize) -> usize {
        // Every cell may wait in the buckets besides.
        let bytes = 3 * self.costs.bytes_after(TILE * TILE) + self.directory.bytes_after(0) + self.met.bytes_after(1);
        // Once refused it stays so: a heuristic with gaps would mislead the search.
        if self.is_short || !self.memory.cover(bytes) {
            self.is_short = true;
            return NO_PAGE as usize;
        }
        let page = self.costs.len() / (TILE * TILE);
        self.costs.resize(self.costs.len() + TILE * TILE, SHUT);
        let frame = field.frame();
        let rows = usize::from(frame.rows);
        let cols = usize::from(frame.cols);
        // Places are counted from 1: the first is beside the field.
        let first = |tile: usize| (tile * TILE).max(1);
        let tile_row = tile / self.tile_cols;
        let tile_col = tile % self.tile_cols;
        let on_field = first(tile_col)..((tile_col + 1) * TILE).min(cols + 1);
        for row in first(tile_row)..((tile_row + 1) * TILE).min(rows + 1) {
            let bushes = &field.occupied().row(row - 1)[on_field.start - 1..on_field.end - 1];
            let begins = (page * TILE + row % TILE) * TILE + on_field.start % TILE;
            for (cost, &is_bush) in self.costs[begins..].iter_mut().zip(bushes) {
                *cost = if is_bush { SHUT } else { UNREACHED };
            }
        }
        self.directory[tile] = page as u32;
        self.met.push(tile as u32);
        page
    }
}

/// Returns the tiles that cover a field and the cells beside its border, along x and y.
fn tiles_along(frame: &FieldFrame) -> [usize; 2] {
    [frame.cols, frame.rows].map(|cells| (usize::from(cells) + 2).div_ceil(TILE))
}

/// Returns the free cells that a target meets, each once.
fn target_cells(field: &ClearanceField, target: Target<'_>) -> Vec<CellOrBorder> {
    match target {
        Target::Pose(end) => goal_cells(field, GoalDisc { centre: end.position(), radius_m: 0.0 }).collect(),
        Target::Discs(discs) => {
            let mut cells: Vec<CellOrBorder> = discs.iter().flat_map(|&disc| goal_cells(field, disc)).collect();
            cells.sort_unstable();
            cells.dedup();
            cells
        }
    }
}

/// Returns the free cells that a goal touches.
fn goal_cells(field: &ClearanceField, disc: GoalDisc) -> impl Iterator<Item = CellOrBorder> + '_ {
    let GoalDisc { centre, radius_m } = disc;
    let frame = field.frame();
    let range = move |middle: f64, count: u16| {
        let index = |metres: f64| (metres / frame.cell_m) as usize;
        // One cell more to each side: a disc also meets a cell whose edge it only touches.
        index(middle - radius_m).saturating_sub(1)..index(middle + radius_m).saturating_add(2).min(count.into())
    };
    let half = DVec2::splat(0.5 * frame.cell_m);
    let is_met = move |row: usize, col: usize| {
        let offset = ((DVec2::new(col as f64, row as f64) + 0.5) * frame.cell_m - centre).abs();
        !field.occupied()[(row, col)] && (offset - half).max(DVec2::ZERO).length() <= radius_m
    };
    let cols = range(centre.x, frame.cols);
    let cells = range(centre.y, frame.rows).flat_map(move |row| cols.clone().map(move |col| (row, col)));
    cells.filter(move |&(row, col)| is_met(row, col)).map(|(row, col)| CellOrBorder::new(row, col))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rand::RngExt;

    use super::*;
    use crate::GoalDisc;
    use crate::test_fields::{TestField, random_free_pose};
    use wildfire_base::geometry::Pose;
    use wildfire_base::rng::{self, Xoshiro256PlusPlus};
    use wildfire_grid::octile::{cost_to_go, legal_moves};
    use wildfire_grid::{Connectivity, CornerCutting, Grid};

    /// For every diagonal move the orthogonal ones beside it.
    const BESIDE_DIAGONAL: [(u8, u8); 4] = [(4, 0b0011), (5, 0b0110), (6, 0b1100), (7, 0b1001)];

    fn place(field: &ClearanceField, index: usize) -> CellOrBorder {
        let cell = field.frame().cell(index);
        CellOrBorder::new(cell.row.into(), cell.col.into())
    }

    /// The lengths of shortest walks from all cells to the goal, by another search.
    fn walks(field: &ClearanceField, target: Target<'_>) -> Grid<f64> {
        let mut moves = legal_moves(field.occupied(), Connectivity::Eight, CornerCutting::Allowed);
        for mask in moves.values_mut() {
            for (k, beside) in BESIDE_DIAGONAL {
                *mask &= if *mask & beside == 0 { !(1 << k) } else { u8::MAX };
            }
        }
        let cols = usize::from(field.frame().cols);
        let goals = target_cells(field, target).into_iter().map(|place| (place.row() - 1) * cols + place.col() - 1);
        cost_to_go(&moves, goals, (1.0, std::f64::consts::SQRT_2))
    }

    /// Asks for cells in any order and compares; returns how many were reached and how many were not.
    fn compare(
        walk: &mut HolonomicHeuristic,
        field: &ClearanceField,
        target: Target<'_>,
        (queries, rng): (u32, &mut Xoshiro256PlusPlus),
    ) -> [u32; 2] {
        let all = walks(field, target);
        let mut counts = [0; 2];
        for _ in 0..queries {
            let index = rng.random_range(0..all.values().len());
            let cost = walk.cost_of(field, place(field, index));
            let length = all.values()[index];
            match cost {
                Some(cost) => assert!((f64::from(cost) / 70.0 - length).abs() <= 1e-4 * length, "{cost}, {length}"),
                None => assert!(length.is_infinite(), "{length}"),
            }
            counts[usize::from(cost.is_none())] += 1;
        }
        counts
    }

    #[test]
    fn queried_in_any_order_it_returns_the_lengths_of_shortest_walks() {
        let mut reached = 0;
        for seed in 0..8 {
            let mut field = TestField::random(seed, 60);
            let mut rng = rng::stream(seed, "walks");
            let mut walk = HolonomicHeuristic::new(&MemoryMeter::unlimited());
            let discs = [(); 4].map(|()| field.random_goal());
            let pose = random_free_pose(&mut field, 0.1);
            for target in [Target::Discs(&discs[..1]), Target::Discs(&discs), Target::Pose(pose)] {
                let start = DVec2::new(rng.random_range(-10.0..160.0), rng.random_range(-10.0..160.0));
                walk.begin(field.checker.field(), target, start);
                reached += compare(&mut walk, field.checker.field(), target, (200, &mut rng))[0];
            }
        }
        assert!(reached > 1_500, "{reached}");
    }

    /// A field of many tiles that bushes cut into pockets, large and small.
    #[test]
    fn pockets_and_wide_goals_change_no_answer() {
        let mut rng = rng::stream(1, "pockets");
        let mut counts = [0; 2];
        for share in [0.2, 0.4, 0.5] {
            let frame = FieldFrame { cols: 150, rows: 110, cell_m: 2.0 };
            let occupied = (0..frame.cell_count()).map(|_| rng.random_bool(share)).collect();
            let field = Arc::new(ClearanceField::new(frame, &Grid::from_values(110, 150, occupied)));
            let mut walk = HolonomicHeuristic::new(&MemoryMeter::unlimited());
            for radius_m in [0.0, 10.0, 90.0] {
                let mut draw = || DVec2::new(rng.random_range(0.0..300.0), rng.random_range(0.0..220.0));
                let discs = [GoalDisc { centre: draw(), radius_m }];
                let start = draw();
                walk.begin(&field, Target::Discs(&discs), start);
                let found = compare(&mut walk, &field, Target::Discs(&discs), (300, &mut rng));
                counts = [counts[0] + found[0], counts[1] + found[1]];
            }
        }
        assert!(counts.iter().all(|&count| count > 300), "{counts:?}");
    }

    #[test]
    fn a_drive_meets_the_tiles_about_it_and_no_others() {
        let frame = FieldFrame { cols: 2000, rows: 2000, cell_m: 5.0 };
        let mut rng = rng::stream(1, "tiles");
        let occupied = (0..frame.cell_count()).map(|_| rng.random_bool(0.1)).collect();
        let field = ClearanceField::new(frame, &Grid::from_values(2000, 2000, occupied));
        let mut walk = HolonomicHeuristic::new(&MemoryMeter::unlimited());
        let start = DVec2::new(5002.5, 5002.5);
        let goal = Pose::new(5302.5, 5302.5, 0.0);
        walk.begin(&field, Target::Discs(&[GoalDisc { centre: goal.position(), radius_m: 10.0 }]), start);
        assert!(walk.cost_to_go_m(&field, start).is_finite());
        assert!(walk.met.len() <= 16, "{} tiles", walk.met.len());
    }

    #[test]
    fn without_memory_nothing_is_returned() {
        let field = TestField::random(1, 25);
        let memory = MemoryMeter::new(1000);
        let mut walk = HolonomicHeuristic::new(&memory);
        walk.begin(field.checker.field(), Target::Pose(field.start), DVec2::ZERO);
        assert_eq!(walk.cost_to_go_m(field.checker.field(), field.start.position()), f64::INFINITY);
        assert!(memory.overrun().is_some());
    }

    #[test]
    fn a_goal_disc_begins_at_the_free_cells_that_it_meets() {
        let mut field = TestField::random(2, 40);
        for _ in 0..20 {
            let disc = field.random_goal();
            let (field, frame) = (field.checker.field(), field.checker.field().frame());
            let found: Vec<CellOrBorder> = goal_cells(field, disc).collect();
            let corner = DVec2::splat(0.5 * frame.cell_m);
            let meets = |index: &usize| {
                let centre = frame.centre(frame.cell(*index));
                disc.centre.clamp(centre - corner, centre + corner).distance(disc.centre) <= disc.radius_m
            };
            let expected = (0..frame.cell_count()).filter(|&index| !field.occupied().values()[index]);
            assert_eq!(found, expected.filter(meets).map(|index| place(field, index)).collect::<Vec<_>>());
        }
    }
}
