//! A flood over a lattice of poses.
//!
//! It is no [`crate::kit::best_first`] search: it knows no costs, holds millions of poses in 16 bytes each, and
//! is grown again whenever more is asked. Only the motions are the same.

use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use glam::{DVec2, Vec2};

use crate::GoalDisc;
use crate::collision::CollisionChecker;
use crate::kit::clearance_profile::ClearanceProfile;
use crate::kit::lattice::{Lattice, motions};
use crate::memory::{CapacityBytes, MemoryKind, MemoryMeter, MemoryShare};
use wildfire_base::geometry::{FieldFrame, Pose};
use wildfire_base::vehicle::{Path, Segment};

use super::CLEARANCE_M;

/// The maximum number of poses of a flood.
pub const MAX_POSES: usize = 3_000_000;
/// The maximum number of bins of a flood; enough for bins of 5 m and 24 headings on a field of 5 km x 5 km.
pub const MAX_BINS: usize = 25_000_000;

const NONE: u32 = u32::MAX;

/// The poses reached from a root, breadth first: the first pose in a bin represents it.
///
/// It grows on demand. The order in which poses are found does not depend on what is asked.
#[derive(Debug)]
pub struct Flood {
    checker: CollisionChecker,
    root: Pose,
    profile: ClearanceProfile,
    motions: [Segment; 6],
    bins: BinPages,
    found: Vec<FoundPose>,
    /// Poses found and not yet spread from; the first belongs to `found[next]`.
    frontier: VecDeque<Pose>,
    next: usize,
    memory: MemoryShare,
    /// True if there was no memory for more poses.
    is_short: bool,
}

/// A pose found: the motion that found it, and where its body centre is, which is all that questions need.
#[derive(Clone, Copy, Debug)]
struct FoundPose {
    parent: u32,
    motion: u8,
    centre: PackedCentre,
}

/// In f32, exact to some 0.03 mm on a field of 250 m and 0.5 mm on the largest; discs are asked with a margin of 1 cm.
type PackedCentre = Vec2;

impl Flood {
    pub fn new(checker: &CollisionChecker, memory: &MemoryMeter, root: Pose, lattice: Lattice) -> Self {
        let mut flood = Self {
            checker: checker.clone(),
            root,
            profile: ClearanceProfile::from_start(CLEARANCE_M, root, checker.clearance(root)),
            motions: motions(checker.body(), lattice.step_m),
            bins: BinPages::new(checker.field().frame(), lattice),
            found: Vec::new(),
            frontier: VecDeque::new(),
            next: 0,
            memory: memory.holder(MemoryKind::Floods),
            is_short: false,
        };
        // No drive begins at a pose that collides: the flood stays empty.
        if checker.clearance(root) > 0.0 && flood.has_memory_for(1) {
            flood.keep(root, NONE, 0);
        }
        flood
    }

    /// Returns the first pose found whose body centre lies in a disc; the flood grows until there is one, but spreads
    /// from at most `limit` poses.
    pub fn pose_in(&mut self, disc: GoalDisc, limit: u32) -> Option<u32> {
        // The lowest index was found first, so the answer is the same whether the flood had grown before or not.
        self.found_in(disc, limit).min().or_else(|| self.grow_into(disc, limit))
    }

    /// Returns all known poses in a disc that are found by spreading from at most `limit` poses.
    pub fn found_in(&self, disc: GoalDisc, limit: u32) -> impl Iterator<Item = u32> + '_ {
        let reach = disc.radius_m + self.checker.body().centre_offset_m().abs();
        let nearby = self.bins.about(disc.centre, reach);
        nearby.filter(move |&pose| self.spreads_to(pose) <= limit && self.is_in(pose, disc))
    }

    /// Spreads from up to `limit` poses, and returns the number of poses from which it can spread.
    pub fn grow(&mut self, limit: u32) -> u32 {
        while (self.next as u32) < limit && self.spread_next() {}
        limit.min(self.next as u32)
    }

    /// Returns the number of poses from which the flood spreads until it finds a pose.
    pub fn spreads_to(&self, pose: u32) -> u32 {
        // The root has no parent: none.
        self.found[pose as usize].parent.wrapping_add(1)
    }

    /// Returns whether it stopped at its maximum of poses or bytes.
    pub fn is_full(&self) -> bool {
        self.found.len() == MAX_POSES || self.is_short
    }

    /// Returns whether there is memory for this number of further poses; once there is none, there never is.
    fn has_memory_for(&mut self, poses: usize) -> bool {
        let lists = self.found.bytes_after(poses) + self.frontier.bytes_after(poses);
        let bytes = self.bins.bytes_after(poses).map(|bins| bins + lists);
        self.is_short |= !bytes.is_some_and(|bytes| self.memory.cover(bytes));
        !self.is_short
    }

    fn is_in(&self, pose: u32, disc: GoalDisc) -> bool {
        self.found[pose as usize].centre.as_dvec2().distance(disc.centre) <= disc.radius_m
    }

    fn grow_into(&mut self, disc: GoalDisc, limit: u32) -> Option<u32> {
        loop {
            let first = self.found.len() as u32;
            if self.next as u32 >= limit || !self.spread_next() {
                return None;
            }
            if let Some(reached) = (first..self.found.len() as u32).find(|&new| self.is_in(new, disc)) {
                return Some(reached);
            }
        }
    }

    /// Spreads from the next pose, if there is one.
    fn spread_next(&mut self) -> bool {
        // For all motions at once, so that a pose is never spread from by halves.
        if !self.has_memory_for(self.motions.len()) {
            return false;
        }
        let Some(pose) = self.frontier.pop_front() else { return false };
        let parent = self.next as u32;
        self.next += 1;
        for (index, motion) in self.motions.into_iter().enumerate() {
            let end = motion.end(pose);
            // What is cheap to ask comes first; the sweep costs most by far.
            if self.found.len() < MAX_POSES
                && self.checker.field().frame().border_distance(end.position()) > 0.0
                && !self.bins.is_taken(end)
                && self.profile.motion_is_free(&self.checker, pose, motion)
            {
                self.keep(end, parent, index as u8);
            }
        }
        true
    }

    fn keep(&mut self, pose: Pose, parent: u32, motion: u8) {
        self.bins.set(pose, self.found.len() as u32);
        let centre = self.checker.body().body_centre(pose).as_vec2();
        self.found.push(FoundPose { parent, motion, centre });
        self.frontier.push_back(pose);
    }

    /// Returns the positions of poses that are found by spreading from up to `limit` poses, in order, each after its
    /// predecessor.
    pub fn reached(&self, limit: u32) -> impl Iterator<Item = [DVec2; 2]> {
        let mut poses: Vec<Pose> = Vec::new();
        // Poses are found in the order of their parents, so what follows is found by later spreads only.
        let found = self.found.iter().take_while(move |found| found.parent.wrapping_add(1) <= limit);
        found.map(move |found| {
            let (from, pose) = match poses.get(found.parent as usize) {
                Some(&parent) => (parent, self.motions[usize::from(found.motion)].end(parent)),
                None => (self.root, self.root),
            };
            poses.push(pose);
            [from, pose].map(Pose::position)
        })
    }

    /// Returns the path from the root to a pose of the flood.
    pub fn path_to(&self, pose: u32) -> Path {
        let mut segments = Vec::new();
        let mut index = pose as usize;
        while self.found[index].parent != NONE {
            segments.push(self.motions[usize::from(self.found[index].motion)]);
            index = self.found[index].parent as usize;
        }
        segments.reverse();
        Path { start: self.root, segments }.joined()
    }
}

/// Bins along the sides of a page.
const PAGE: usize = 8;
/// Pages along the sides of a block.
const BLOCK: usize = 64;

/// The pose that represents each bin, in pages, and these in blocks, which are made when they are first written to.
#[derive(Debug)]
struct BinPages {
    lattice: Lattice,
    /// Blocks along x, and bins along x and y.
    block_cols: usize,
    cols: usize,
    rows: usize,
    /// The index in `pages` at which each block begins.
    blocks: Vec<u32>,
    /// The index in `poses` at which each page begins.
    pages: Vec<u32>,
    poses: Vec<u32>,
    /// A bit for each of `poses`, set where it is one: small enough for the processor's cache, where `poses` is not,
    /// and all that most questions ask for.
    taken: Vec<u64>,
}

impl BinPages {
    fn new(frame: &FieldFrame, lattice: Lattice) -> Self {
        let [cols, rows] = bins_along(frame, lattice);
        let [block_cols, block_rows] = [cols, rows].map(|bins| bins.div_ceil(PAGE * BLOCK));
        let blocks = vec![NONE; block_cols * block_rows];
        Self { lattice, block_cols, cols, rows, blocks, pages: Vec::new(), poses: Vec::new(), taken: Vec::new() }
    }

    /// Returns the bytes that it takes with `more` further poses, each in a page and a block of its own; `None` if those are more
    /// bins than there may be.
    fn bytes_after(&self, more: usize) -> Option<usize> {
        let lists = self.pages.bytes_after(more * BLOCK * BLOCK) + self.blocks.bytes_after(0);
        let bins = self.bins_after(more * self.page_len())?;
        Some(4 * bins + bins / 4 + lists)
    }

    /// Returns the number of bins that there is memory for once there are `more` further ones: it doubles, up to the most that
    /// may be.
    fn bins_after(&self, more: usize) -> Option<usize> {
        let needed = self.poses.len() + more;
        let room = self.poses.capacity();
        let grown = if needed <= room { room } else { needed.max((2 * room).min(MAX_BINS)) };
        (needed <= MAX_BINS).then_some(grown)
    }

    fn page_len(&self) -> usize {
        PAGE * PAGE * self.lattice.headings as usize
    }

    /// Locates a bin, heading 0: its block, the place of its page there, and its own place in the page.
    fn locate(&self, col: usize, row: usize) -> [usize; 3] {
        let (page_col, page_row) = (col / PAGE, row / PAGE);
        let block = (page_row / BLOCK) * self.block_cols + page_col / BLOCK;
        let page = (page_row % BLOCK) * BLOCK + page_col % BLOCK;
        [block, page, ((row % PAGE) * PAGE + col % PAGE) * self.lattice.headings as usize]
    }

    fn locate_pose(&self, pose: Pose) -> [usize; 3] {
        let axis = |metres: f64| (metres / self.lattice.bin_m) as usize;
        let [block, page, place] = self.locate(axis(pose.x), axis(pose.y));
        let turn = (pose.heading + PI) / TAU * f64::from(self.lattice.headings);
        // A heading of exactly half a turn would be in the bin after the last.
        [block, page, place + (turn as usize).min(self.lattice.headings as usize - 1)]
    }

    /// Returns the index in `poses` at which a page begins, if it was ever written to.
    fn start_of(&self, block: usize, page: usize) -> Option<usize> {
        let pages = Some(self.blocks[block]).filter(|start: &u32| *start != NONE)? as usize;
        Some(self.pages[pages + page]).filter(|start: &u32| *start != NONE).map(|start| start as usize)
    }

    fn is_taken(&self, pose: Pose) -> bool {
        let [block, page, place] = self.locate_pose(pose);
        self.start_of(block, page).is_some_and(|start| {
            let bin = start + place;
            self.taken[bin / 64] >> (bin % 64) & 1 == 1
        })
    }

    fn set(&mut self, pose: Pose, index: u32) {
        let [block, page, place] = self.locate_pose(pose);
        if self.blocks[block] == NONE {
            self.blocks[block] = self.pages.len() as u32;
            self.pages.resize(self.pages.len() + BLOCK * BLOCK, NONE);
        }
        let page = self.blocks[block] as usize + page;
        if self.pages[page] == NONE {
            self.pages[page] = self.poses.len() as u32;
            // Reserved exactly: doubling would take memory that was not asked for.
            let room = self.bins_after(self.page_len()).expect("the flood asked before");
            self.poses.reserve_exact(room - self.poses.len());
            self.poses.resize(self.poses.len() + self.page_len(), NONE);
            self.taken.resize(self.poses.len().div_ceil(64), 0);
        }
        let bin = self.pages[page] as usize + place;
        self.poses[bin] = index;
        self.taken[bin / 64] |= 1 << (bin % 64);
    }

    /// Returns all poses in bins within `reach` of a place along both axes, and some more.
    fn about(&self, centre: DVec2, reach: f64) -> impl Iterator<Item = u32> + '_ {
        let range = |middle: f64, bins: usize| {
            // The cast clamps at 0, where the disc reaches beyond the field.
            let low = ((middle - reach) / self.lattice.bin_m) as usize;
            let high = ((middle + reach) / self.lattice.bin_m) as usize;
            low..high.saturating_add(1).min(bins)
        };
        let cols = range(centre.x, self.cols);
        range(centre.y, self.rows).flat_map(move |row| {
            cols.clone().flat_map(move |col| {
                let [block, page, place] = self.locate(col, row);
                let bins = self
                    .start_of(block, page)
                    .map_or(0..0, |start| start + place..start + place + self.lattice.headings as usize);
                self.poses[bins].iter().copied().filter(|&pose| pose != NONE)
            })
        })
    }
}

/// Returns the bins along x and y, one more than cover the field where they divide it evenly.
fn bins_along(frame: &FieldFrame, lattice: Lattice) -> [usize; 2] {
    [frame.width_m(), frame.height_m()].map(|side| (side / lattice.bin_m) as usize + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kit::floods::LATTICES;
    use crate::test_fields::TestField;

    fn flood(field: &TestField, memory: &MemoryMeter, lattice: Lattice) -> Flood {
        Flood::new(&field.checker, memory, field.start, lattice)
    }

    #[test]
    fn a_flood_counts_what_it_holds() {
        let field = TestField::random(1, 40);
        for lattice in LATTICES {
            let memory = MemoryMeter::unlimited();
            let mut flood = flood(&field, &memory, lattice);
            flood.grow(200_000);
            let BinPages { blocks, pages, poses, .. } = &flood.bins;
            let bins = size_of::<u32>() * (blocks.capacity() + pages.capacity() + poses.capacity());
            let lists = size_of::<FoundPose>() * flood.found.capacity() + size_of::<Pose>() * flood.frontier.capacity();
            let expected = (bins + lists) as u64;
            assert!(expected <= memory.reserved(), "{expected} of {}", memory.reserved());
            drop(flood);
            assert_eq!(memory.reserved(), 0);
        }
    }

    #[test]
    fn a_flood_without_memory_stops_and_keeps_what_it_found() {
        let field = TestField::random(1, 40);
        let ample = flood(&field, &MemoryMeter::unlimited(), LATTICES[2]).grow(u32::MAX);
        let memory = MemoryMeter::new(2_000_000);
        let mut flood = flood(&field, &memory, LATTICES[2]);
        let spread = flood.grow(u32::MAX);
        assert!(spread > 100 && spread < ample && flood.is_full(), "{spread} of {ample}");
        assert!(memory.overrun().is_some() && memory.reserved() <= 2_000_000);
        assert_eq!(flood.path_to(0), Path::standing(field.start));
    }

    #[test]
    fn a_flood_on_a_field_of_a_thousand_kilometres_takes_what_its_poses_take() {
        let frame = FieldFrame { cols: 1000, rows: 1000, cell_m: 1000.0 };
        for lattice in LATTICES {
            let empty = BinPages::new(&frame, lattice);
            assert!(empty.bytes_after(1).is_some_and(|bytes| bytes < 20_000_000), "{lattice:?}");
        }
    }
}
