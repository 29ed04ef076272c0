use crate::collision::CollisionChecker;
use crate::geometry::Pose;
use crate::planning::GoalDisc;

use super::flood::Flood;
use super::passages::Passages;
use super::{CLEARANCE_M, LATTICES};

/// The floods from one root, each made when it is first asked for.
#[derive(Debug)]
pub struct Floods {
    checker: CollisionChecker,
    root: Pose,
    /// One for each of the [`LATTICES`].
    floods: [Option<Flood>; LATTICES.len()],
    passages: Option<Passages>,
}

impl Floods {
    pub fn new(checker: &CollisionChecker, root: Pose) -> Self {
        Self { checker: checker.clone(), root, floods: Default::default(), passages: None }
    }

    pub fn root(&self) -> Pose {
        self.root
    }

    /// The flood on a lattice, by its place among the [`LATTICES`].
    pub fn on(&mut self, rung: usize) -> &mut Flood {
        let Self { checker, root, floods, .. } = self;
        floods[rung].get_or_insert_with(|| Flood::new(checker, *root, LATTICES[rung], CLEARANCE_M))
    }

    /// Whether no way for the body's centre leads into a disc: proof that no lattice has one.
    pub fn exclude(&mut self, disc: GoalDisc) -> bool {
        self.passages.get_or_insert_with(|| Passages::new(&self.checker, self.root)).exclude(disc)
    }

    #[cfg(test)]
    pub fn has(&self, rung: usize) -> bool {
        self.floods[rung].is_some()
    }
}
