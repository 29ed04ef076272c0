use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

use glam::{DVec2, Vec2};

use crate::collision::CollisionChecker;
use crate::geometry::{FieldFrame, Pose};
use crate::planning::primitives::{self, Floor};
use crate::planning::{GoalDisc, lattice_search};
use crate::vehicle::{Path, Segment};

use super::Lattice;

/// A flood holds no more poses; at 12 bytes each, and a bin of 4, it stays below 64 MB on any field.
pub const MAX_POSES: usize = 3_000_000;

const NONE: u32 = u32::MAX;

/// The poses reached from a root, breadth first: the first pose in a bin stands for it.
///
/// It grows on demand. The order in which poses are found does not depend on what is asked.
#[derive(Debug)]
pub struct Flood {
    checker: CollisionChecker,
    root: Pose,
    floor: Floor,
    motions: [Segment; 6],
    bins: BinPages,
    found: Vec<Found>,
    /// Poses found and not yet spread from; the first belongs to `found[next]`.
    frontier: VecDeque<Pose>,
    next: usize,
}

/// A pose found: how, and where its body centre is, which is all that questions need.
#[derive(Clone, Copy, Debug)]
struct Found {
    parent: u32,
    motion: u8,
    centre: PackedCentre,
}

/// In f32, exact to some 0.03 mm on a field of 250 m and 0.5 mm on the largest; discs are asked with a margin of 1 cm.
type PackedCentre = Vec2;

impl Flood {
    pub fn new(checker: &CollisionChecker, root: Pose, lattice: Lattice, clearance_m: f64) -> Self {
        let mut flood = Self {
            checker: checker.clone(),
            root,
            floor: Floor::new(clearance_m, root, checker.clearance(root)),
            motions: lattice_search::motions(checker.body(), lattice.step_m),
            bins: BinPages::new(checker.field().frame(), lattice),
            found: Vec::new(),
            frontier: VecDeque::new(),
            next: 0,
        };
        if checker.clearance(root) > 0.0 {
            flood.keep(root, NONE, 0);
        }
        flood
    }

    /// The first pose found whose body centre lies in a disc; the flood grows until there is one, but spreads from no
    /// more than `limit` poses.
    pub fn pose_in(&mut self, disc: GoalDisc, limit: u32) -> Option<u32> {
        self.known_in(disc, limit).min().or_else(|| self.grow_into(disc, limit))
    }

    /// All poses known in a disc that are found by spreading from no more than `limit` poses.
    pub fn known_in(&self, disc: GoalDisc, limit: u32) -> impl Iterator<Item = u32> + '_ {
        let reach = disc.radius_m + self.checker.body().centre_offset_m().abs();
        let known = self.bins.about(disc.centre, reach);
        known.filter(move |&pose| self.spreads_to(pose) <= limit && self.is_in(pose, disc))
    }

    /// Spreads from up to `limit` poses, and tells from how many there are to spread.
    pub fn grow(&mut self, limit: u32) -> u32 {
        while (self.next as u32) < limit && self.spread_next() {}
        limit.min(self.next as u32)
    }

    /// From how many poses the flood spreads until it finds a pose.
    pub fn spreads_to(&self, pose: u32) -> u32 {
        // The root has no parent: none.
        self.found[pose as usize].parent.wrapping_add(1)
    }

    /// Whether it stopped because it holds as many poses as it may.
    pub fn is_full(&self) -> bool {
        self.found.len() == MAX_POSES
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
            if let Some(entered) = (first..self.found.len() as u32).find(|&new| self.is_in(new, disc)) {
                return Some(entered);
            }
        }
    }

    /// Spreads from the next pose, if there is one.
    fn spread_next(&mut self) -> bool {
        let Some(pose) = self.frontier.pop_front() else { return false };
        let parent = self.next as u32;
        self.next += 1;
        self.spread(pose, parent);
        true
    }

    fn spread(&mut self, pose: Pose, parent: u32) {
        for (index, motion) in self.motions.into_iter().enumerate() {
            let end = motion.end(pose);
            let is_new = self.found.len() < MAX_POSES
                && self.checker.field().frame().border_distance(end.position()) > 0.0
                && !self.bins.is_taken(end);
            if is_new && self.floor.motion_is_free(&self.checker, pose, motion) {
                self.keep(end, parent, index as u8);
            }
        }
    }

    fn keep(&mut self, pose: Pose, parent: u32, motion: u8) {
        self.bins.set(pose, self.found.len() as u32);
        let centre = self.checker.body().body_centre(pose).as_vec2();
        self.found.push(Found { parent, motion, centre });
        self.frontier.push_back(pose);
    }

    /// Where the poses are that spreading from up to `limit` poses finds, in order, each after the one that it came from.
    pub fn reached(&self, limit: u32) -> impl Iterator<Item = [DVec2; 2]> {
        let mut poses: Vec<Pose> = Vec::new();
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

    /// The way from the root to a pose of the flood.
    pub fn path_to(&self, pose: u32) -> Path {
        let mut segments = Vec::new();
        let mut index = pose as usize;
        while self.found[index].parent != NONE {
            segments.push(self.motions[usize::from(self.found[index].motion)]);
            index = self.found[index].parent as usize;
        }
        segments.reverse();
        Path { start: self.root, segments: primitives::join(&segments) }
    }
}

/// Bins along the sides of a page.
const PAGE: usize = 8;

/// Which pose stands for a bin, in pages that are made when first written to.
#[derive(Debug)]
struct BinPages {
    lattice: Lattice,
    /// Pages along x and y.
    size: [usize; 2],
    /// Where each page begins in `poses`.
    pages: Vec<u32>,
    poses: Vec<u32>,
    /// A bit for each of `poses`, set where it is one: small enough for the processor's cache, where `poses` is not,
    /// and all that most questions ask for.
    taken: Vec<u64>,
}

impl BinPages {
    fn new(frame: &FieldFrame, lattice: Lattice) -> Self {
        let size = [frame.width_m(), frame.height_m()].map(|side| (side / lattice.bin_m) as usize / PAGE + 1);
        Self { lattice, size, pages: vec![NONE; size[0] * size[1]], poses: Vec::new(), taken: Vec::new() }
    }

    fn page_len(&self) -> usize {
        PAGE * PAGE * self.lattice.headings as usize
    }

    /// The page of a bin and the place in it, heading 0.
    fn locate(&self, col: usize, row: usize) -> (usize, usize) {
        let page = (row / PAGE) * self.size[0] + col / PAGE;
        (page, ((row % PAGE) * PAGE + col % PAGE) * self.lattice.headings as usize)
    }

    fn locate_pose(&self, pose: Pose) -> (usize, usize) {
        let axis = |metres: f64| (metres / self.lattice.bin_m) as usize;
        let (page, place) = self.locate(axis(pose.x), axis(pose.y));
        let turn = (pose.heading + PI) / TAU * f64::from(self.lattice.headings);
        (page, place + (turn as usize).min(self.lattice.headings as usize - 1))
    }

    fn is_taken(&self, pose: Pose) -> bool {
        let (page, place) = self.locate_pose(pose);
        let first = self.pages[page];
        let bin = first as usize + place;
        first != NONE && self.taken[bin / 64] >> (bin % 64) & 1 == 1
    }

    fn set(&mut self, pose: Pose, index: u32) {
        let (page, place) = self.locate_pose(pose);
        if self.pages[page] == NONE {
            self.pages[page] = self.poses.len() as u32;
            self.poses.resize(self.poses.len() + self.page_len(), NONE);
            self.taken.resize(self.poses.len().div_ceil(64), 0);
        }
        let bin = self.pages[page] as usize + place;
        self.poses[bin] = index;
        self.taken[bin / 64] |= 1 << (bin % 64);
    }

    /// All poses in bins within `reach` of a place along both axes, and some more.
    fn about(&self, centre: DVec2, reach: f64) -> impl Iterator<Item = u32> + '_ {
        let range = |middle: f64, pages: usize| {
            let low = ((middle - reach) / self.lattice.bin_m) as usize;
            let high = ((middle + reach) / self.lattice.bin_m) as usize;
            low..high.saturating_add(1).min(pages * PAGE)
        };
        let cols = range(centre.x, self.size[0]);
        range(centre.y, self.size[1]).flat_map(move |row| {
            cols.clone().flat_map(move |col| {
                let (page, place) = self.locate(col, row);
                let first = self.pages[page];
                let bin = first as usize + place;
                let bin = if first == NONE { 0..0 } else { bin..bin + self.lattice.headings as usize };
                self.poses[bin].iter().copied().filter(|&pose| pose != NONE)
            })
        })
    }
}
