use super::flood::Flood;
use super::passages::Passages;
use super::{CLEARANCE_M, LATTICES};
use crate::collision::CollisionChecker;
use crate::geometry::{FieldFrame, Pose};
use crate::planning::GoalDisc;
use crate::planning::memory::MemoryMeter;

/// The floods from one root, each made when it is first asked for.
#[derive(Debug)]
pub struct Floods {
    checker: CollisionChecker,
    memory: MemoryMeter,
    root: Pose,
    /// One for each of the [`LATTICES`].
    floods: [Option<Flood>; LATTICES.len()],
    passages: Option<Passages>,
}

impl Floods {
    pub fn new(checker: &CollisionChecker, memory: &MemoryMeter, root: Pose) -> Self {
        Self { checker: checker.clone(), memory: memory.clone(), root, floods: Default::default(), passages: None }
    }

    /// The most bytes that the first few floods of a field take, each of which spreads from up to `limit` poses.
    pub fn most_bytes(frame: &FieldFrame, lattices: usize, limit: u32) -> u64 {
        let floods = LATTICES[..lattices].iter().map(|&lattice| Flood::most_bytes(frame, lattice, limit)).sum::<u64>();
        floods + if lattices > 1 { Passages::most_bytes(frame) } else { 0 }
    }

    pub fn root(&self) -> Pose {
        self.root
    }

    /// The flood on a lattice, by its place among the [`LATTICES`].
    pub fn on(&mut self, rung: usize) -> &mut Flood {
        let Self { checker, memory, root, floods, .. } = self;
        floods[rung].get_or_insert_with(|| Flood::new(checker, memory, *root, LATTICES[rung], CLEARANCE_M))
    }

    /// Whether no way for the body's centre leads into a disc: proof that no lattice has one.
    pub fn exclude(&mut self, disc: GoalDisc) -> bool {
        self.passages.get_or_insert_with(|| Passages::new(&self.checker, &self.memory, self.root)).exclude(disc)
    }

    #[cfg(test)]
    pub fn has(&self, rung: usize) -> bool {
        self.floods[rung].is_some()
    }
}
