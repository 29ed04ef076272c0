//! The open list of a best-first search, with deliberate tie-breaking.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// An entry of an open list.
pub trait Ranked {
    type Tie: Ord;

    /// Estimated cost of the whole way; the smallest comes first.
    fn priority(&self) -> f64;

    /// Cost so far; of equal priorities the largest comes first, because it is nearer to the goal.
    fn cost(&self) -> f64;

    /// Decides between equals, the smallest first.
    fn tie(&self) -> Self::Tie;
}

/// A priority queue that returns the best entry first.
#[derive(Debug)]
pub struct OpenList<T>(BinaryHeap<BestFirst<T>>);

impl<T: Ranked> Default for OpenList<T> {
    fn default() -> Self {
        Self(BinaryHeap::new())
    }
}

impl<T: Ranked> OpenList<T> {
    pub fn push(&mut self, entry: T) {
        self.0.push(BestFirst(entry));
    }

    pub fn pop(&mut self) -> Option<T> {
        self.0.pop().map(|BestFirst(entry)| entry)
    }

    /// Returns the number of entries.
    pub fn waiting(&self) -> usize {
        self.0.len()
    }

    /// Returns the number of entries that fit without another allocation.
    pub fn capacity(&self) -> usize {
        self.0.capacity()
    }

    /// Removes all entries and keeps their memory.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

/// The greatest is what a max-heap hands out first.
#[derive(Debug)]
struct BestFirst<T>(T);

impl<T: Ranked> Ord for BestFirst<T> {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        let (a, b) = (&self.0, &other.0);
        let by_priority = b.priority().total_cmp(&a.priority());
        by_priority.then_with(|| a.cost().total_cmp(&b.cost())).then_with(|| b.tie().cmp(&a.tie()))
    }
}

impl<T: Ranked> PartialOrd for BestFirst<T> {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T: Ranked> PartialEq for BestFirst<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<T: Ranked> Eq for BestFirst<T> {}

#[cfg(test)]
mod tests {
    use super::*;

    impl Ranked for (f64, f64, u32) {
        type Tie = u32;

        fn priority(&self) -> f64 {
            self.0
        }

        fn cost(&self) -> f64 {
            self.1
        }

        fn tie(&self) -> u32 {
            self.2
        }
    }

    #[test]
    fn the_best_comes_first_then_the_deepest_then_the_smallest_number() {
        let mut open = OpenList::default();
        let order = [(1.0, 0.0, 9), (2.0, 5.0, 1), (2.0, 5.0, 4), (2.0, 3.0, 0), (7.0, 9.0, 2)];
        for index in [3, 1, 4, 0, 2] {
            open.push(order[index]);
        }
        let popped: Vec<_> = std::iter::from_fn(|| open.pop()).collect();
        assert_eq!(popped, order);
    }
}
